//! Equations for the stress angle ψ at a point (ν = 0).

use super::Field;
use models::flow::{FlowKind, RotationKind};

/// Equation for the stress angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closure {
    /// sin 2(ψ − ψ_D) = sin φ (ω − s₂₁)/Q_D with evolving spin ω (Harris & Grekova 2005, eq. 42).
    HarrisGrekova,
    /// Dψ/Dt = s₂₁ + Q_D sin 2(ψ − ψ_D)/sin φ (Spencer 1964).
    DoubleShearing,
    /// ψ = ψ_D: stress and deformation rate are coaxial.
    PlasticPotential,
}

impl Closure {
    /// Returns the closure of a model, if it has one.
    pub fn of(kind: FlowKind) -> Option<Self> {
        Self::from_rotation(kind.rotation())
    }

    /// Returns the closure of models with a kind of rotation; `None` if the rotation is undetermined.
    pub fn from_rotation(rotation: RotationKind) -> Option<Self> {
        match rotation {
            RotationKind::IntrinsicSpin => Some(Self::HarrisGrekova),
            RotationKind::StressAxes => Some(Self::DoubleShearing),
            RotationKind::None => Some(Self::PlasticPotential),
            RotationKind::Free => None,
        }
    }

    /// Returns the field that evolves in addition to the velocity.
    pub fn internal_variable(self) -> Option<Field> {
        match self {
            Self::HarrisGrekova => Some(Field::Spin),
            Self::DoubleShearing => Some(Field::StressAngle),
            Self::PlasticPotential => None,
        }
    }

    /// Returns the output fields, velocities first.
    pub fn fields(self) -> Vec<Field> {
        let spin = (self == Self::HarrisGrekova).then_some(Field::Spin);
        [Field::Velocity(0), Field::Velocity(1)]
            .into_iter()
            .chain(spin)
            .chain([Field::StressAngle, Field::Pressure, Field::ShearRate])
            .collect()
    }
}

/// Deviatoric part and vorticity of a velocity gradient.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deformation {
    /// d₁₁ − d₂₂ and 2d₁₂, 1/s.
    pub(super) deviator: [f64; 2],
    /// s₂₁ = ½(∂₁v₂ − ∂₂v₁), 1/s.
    pub(super) half_vorticity: f64,
}

impl Deformation {
    /// Deformation of a velocity gradient with entries \[i\]\[j\] = ∂ⱼvᵢ.
    #[inline(always)]
    pub(super) fn new([[g11, g12], [g21, g22]]: [[f64; 2]; 2]) -> Self {
        Self { deviator: [g11 - g22, g12 + g21], half_vorticity: 0.5 * (g21 - g12) }
    }

    /// Computes Q_D, 1/s.
    #[inline(always)]
    pub(super) fn shear_rate(&self) -> f64 {
        let [one, other] = self.deviator;
        0.5 * (one * one + other * other).sqrt()
    }

    /// Computes cos 2ψ_D and sin 2ψ_D.
    #[inline(always)]
    fn direction(&self) -> [f64; 2] {
        let twice = 2.0 * self.shear_rate();
        self.deviator.map(|part| part / twice)
    }
}

/// Computes cos 2ψ and sin 2ψ of Harris & Grekova at spin `spin`, rad/s; `branch`: sign of cos 2(ψ − ψ_D).
/// `None` if `ratio` |ω − s₂₁| > Q_D, or if the result is NaN.
#[inline(always)]
pub(super) fn harris_grekova(
    deformation: &Deformation,
    ratio: f64,
    branch: f64,
    spin: f64,
) -> Option<[f64; 2]> {
    let sine = ratio * (spin - deformation.half_vorticity) / deformation.shear_rate();
    let square = 1.0 - sine * sine;
    let cosine = branch * square.sqrt();
    let [cos, sin] = deformation.direction();
    (square >= 0.0).then_some([cos * cosine - sin * sine, sin * cosine + cos * sine])
}

/// Returns cos 2ψ_D and sin 2ψ_D; `None` if Q_D < `least`, 1/s.
#[inline(always)]
pub(super) fn plastic_potential(deformation: &Deformation, least: f64) -> Option<[f64; 2]> {
    (deformation.shear_rate() >= least).then(|| deformation.direction())
}

/// Computes Dψ/Dt of double shearing, rad/s, from cos 2ψ and sin 2ψ; `ratio`: e_r/c_r.
#[inline(always)]
pub(super) fn double_shearing(deformation: &Deformation, ratio: f64, [cos, sin]: [f64; 2]) -> f64 {
    let [one, other] = deformation.deviator;
    deformation.half_vorticity + 0.5 * (one * sin - other * cos) / ratio
}
