//! Equations for the stress angle ψ at a point, at constant volume (dilatancy angle ν = 0).
//!
//! Symbols: ψ, ψ_D: angles of the major principal stress and deformation rate from x₁; Q_D: shear rate, 1/s; s₂₁: half
//! the vorticity, 1/s; ω: spin, rad/s; e_r/c_r: coefficient ratio of the flow rule, see
//! [`FlowProblem::rotation_ratio`](super::FlowProblem::rotation_ratio).

use super::FlowField;
use models::flow::{FlowKind, RotationKind};

/// Closure of a granular flow model: the equation for the stress angle ψ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closure {
    /// sin 2(ψ − ψ_D) = (e_r/c_r) (ω − s₂₁)/Q_D with evolving spin ω (Harris & Grekova 2005, eq. 42).
    HarrisGrekova,
    /// Dψ/Dt = s₂₁ + Q_D sin 2(ψ − ψ_D)/(e_r/c_r) (Spencer 1964).
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

    /// Returns the field that evolves in addition to the velocity, if any.
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

/// Deviatoric deformation rate and vorticity of a velocity gradient.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deformation {
    /// d₁₁ − d₂₂ and 2d₁₂, 1/s, with the deformation rate d.
    pub(super) deviator: [f64; 2],
    /// Half the vorticity, s₂₁ = ½(∂₁v₂ − ∂₂v₁), 1/s.
    pub(super) half_vorticity: f64,
}

impl Deformation {
    /// Computes deviatoric deformation rate and vorticity of a velocity gradient with entries \[i\]\[j\] = ∂ⱼvᵢ, 1/s.
    #[inline(always)]
    pub(super) fn new([[g11, g12], [g21, g22]]: [[f64; 2]; 2]) -> Self {
        Self { deviator: [g11 - g22, g12 + g21], half_vorticity: 0.5 * (g21 - g12) }
    }

    /// Computes the shear rate Q_D = ½√((d₁₁ − d₂₂)² + (2d₁₂)²), 1/s.
    #[inline(always)]
    pub(super) fn shear_rate(&self) -> f64 {
        let [normal_difference, shear_rate_12] = self.deviator;
        0.5 * (normal_difference * normal_difference + shear_rate_12 * shear_rate_12).sqrt()
    }

    /// Computes cos 2ψ_D and sin 2ψ_D of the angle ψ_D of the major principal deformation rate.
    #[inline(always)]
    fn double_angle(&self) -> [f64; 2] {
        let twice = 2.0 * self.shear_rate();
        self.deviator.map(|part| part / twice)
    }
}

/// Computes cos 2ψ and sin 2ψ of the closure of Harris & Grekova at spin ω = `spin`, rad/s; `rotation_ratio`: e_r/c_r;
/// `branch`: sign of cos 2(ψ − ψ_D). `None` if (e_r/c_r) |ω − s₂₁| > Q_D, or if the result is NaN.
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

/// Computes cos 2ψ_D and sin 2ψ_D; `None` if the shear rate Q_D is below `least`, 1/s, or NaN.
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
    let [normal_difference, shear_rate_12] = deformation.deviator;
    deformation.half_vorticity + 0.5 * (normal_difference * sin - shear_rate_12 * cos) / ratio
}
