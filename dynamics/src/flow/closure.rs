//! What determines the stress angle ψ at a point (ν = 0).

use super::Field;
use models::flow::{FlowKind, RotationKind};

/// What determines the stress angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closure {
    /// sin 2(ψ − ψ_D) = sin φ (ω − s₂₁)/Q_D, and the spin ω evolves (Harris & Grekova 2005, eq. 42).
    HarrisGrekova,
    /// Dψ/Dt = s₂₁ + Q_D sin 2(ψ − ψ_D)/sin φ (Spencer 1964).
    DoubleShearing,
    /// ψ = ψ_D: stress and deformation rate are coaxial.
    PlasticPotential,
}

impl Closure {
    /// That of a model, if it has one.
    pub fn of(kind: FlowKind) -> Option<Self> {
        Self::from_rotation(kind.rotation())
    }

    /// That of a model of such a rotation; `None` where the rotation is undetermined.
    pub fn from_rotation(rotation: RotationKind) -> Option<Self> {
        match rotation {
            RotationKind::IntrinsicSpin => Some(Self::HarrisGrekova),
            RotationKind::StressAxes => Some(Self::DoubleShearing),
            RotationKind::None => Some(Self::PlasticPotential),
            RotationKind::Free => None,
        }
    }

    /// The field that evolves beside the velocity.
    pub fn inner(self) -> Option<Field> {
        match self {
            Self::HarrisGrekova => Some(Field::Spin),
            Self::DoubleShearing => Some(Field::StressAngle),
            Self::PlasticPotential => None,
        }
    }

    /// Fields of a flow, velocities first.
    pub fn fields(self) -> Vec<Field> {
        let spin = (self == Self::HarrisGrekova).then_some(Field::Spin);
        [Field::Velocity(0), Field::Velocity(1)]
            .into_iter()
            .chain(spin)
            .chain([Field::StressAngle, Field::Pressure, Field::ShearRate])
            .collect()
    }
}

/// The velocity gradient in invariants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deformation {
    /// d₁₁ − d₂₂ and 2d₁₂, 1/s.
    pub(super) deviator: [f64; 2],
    /// s₂₁ = ½(∂₁v₂ − ∂₂v₁), 1/s.
    pub(super) half_vorticity: f64,
}

impl Deformation {
    /// Of ∂ⱼvᵢ, entry \[i\]\[j\].
    #[inline(always)]
    pub(super) fn new([[g11, g12], [g21, g22]]: [[f64; 2]; 2]) -> Self {
        Self { deviator: [g11 - g22, g12 + g21], half_vorticity: 0.5 * (g21 - g12) }
    }

    /// Q_D, 1/s.
    #[inline(always)]
    pub(super) fn shear_rate(&self) -> f64 {
        let [one, other] = self.deviator;
        0.5 * (one * one + other * other).sqrt()
    }

    /// cos 2ψ_D and sin 2ψ_D.
    #[inline(always)]
    fn direction(&self) -> [f64; 2] {
        let twice = 2.0 * self.shear_rate();
        self.deviator.map(|part| part / twice)
    }
}

/// cos 2ψ and sin 2ψ of Harris & Grekova at a spin ω; `branch` is the sign of cos 2(ψ − ψ_D).
///
/// # Errors
/// There is none where ratio |ω − s₂₁| > Q_D; not a number at its end.
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

/// cos 2ψ and sin 2ψ where they are those of the deformation rate, if that is not below `least`.
#[inline(always)]
pub(super) fn plastic_potential(deformation: &Deformation, least: f64) -> Option<[f64; 2]> {
    (deformation.shear_rate() >= least).then(|| deformation.direction())
}

/// Dψ/Dt of double shearing, rad/s; cos 2ψ and sin 2ψ are given.
#[inline(always)]
pub(super) fn double_shearing(deformation: &Deformation, ratio: f64, [cos, sin]: [f64; 2]) -> f64 {
    let [one, other] = deformation.deviator;
    deformation.half_vorticity + 0.5 * (one * sin - other * cos) / ratio
}
