//! Equations for the stress angle ψ at a point (ν = 0).

use super::FlowField;
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
    pub fn from_kind(kind: FlowKind) -> Option<Self> {
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
    pub fn internal_variable(self) -> Option<FlowField> {
        match self {
            Self::HarrisGrekova => Some(FlowField::Spin),
            Self::DoubleShearing => Some(FlowField::StressAngle),
            Self::PlasticPotential => None,
        }
    }

    /// Returns the output fields, velocities first.
    pub fn output_fields(self) -> Vec<FlowField> {
        let spin = (self == Self::HarrisGrekova).then_some(FlowField::Spin);
        [FlowField::Velocity(0), FlowField::Velocity(1)]
            .into_iter()
            .chain(spin)
            .chain([FlowField::StressAngle, FlowField::Pressure, FlowField::ShearRate])
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
    fn double_angle(&self) -> [f64; 2] {
        let twice = 2.0 * self.shear_rate();
        self.deviator.map(|part| part / twice)
    }
}

/// Computes cos 2ψ and sin 2ψ of Harris & Grekova at spin `spin`, rad/s; `branch`: sign of cos 2(ψ − ψ_D).
/// `None` if `rotation_ratio` |ω − s₂₁| > Q_D, or if the result is NaN.
#[inline(always)]
pub(super) fn harris_grekova_double_angle(
    deformation: &Deformation,
    rotation_ratio: f64,
    branch: f64,
    spin: f64,
) -> Option<[f64; 2]> {
    let sine = rotation_ratio * (spin - deformation.half_vorticity) / deformation.shear_rate();
    let square = 1.0 - sine * sine;
    let cosine = branch * square.sqrt();
    let [cos, sin] = deformation.double_angle();
    (square >= 0.0).then_some([cos * cosine - sin * sine, sin * cosine + cos * sine])
}

/// Returns cos 2ψ_D and sin 2ψ_D; `None` if Q_D < `least`, 1/s.
#[inline(always)]
pub(super) fn coaxial_double_angle(deformation: &Deformation, least: f64) -> Option<[f64; 2]> {
    (deformation.shear_rate() >= least).then(|| deformation.double_angle())
}

/// Computes Dψ/Dt of double shearing, rad/s, from cos 2ψ and sin 2ψ; `ratio`: e_r/c_r.
#[inline(always)]
pub(super) fn double_shearing_rate(
    deformation: &Deformation,
    ratio: f64,
    [cos, sin]: [f64; 2],
) -> f64 {
    let [one, other] = deformation.deviator;
    deformation.half_vorticity + 0.5 * (one * sin - other * cos) / ratio
}
