//! State of a granular flow at a point, the Mohr–Coulomb yield condition, the flow rule, and the derived background.

use crate::common::elementary::Elementary;
use crate::common::input::{InputError, ensure, to_rounded_degrees};
use crate::common::range::AllowedRange;
use crate::common::rounding::Rounded;
use crate::flow::parameters::{COHESION, DILATANCY_ANGLE, FRICTION_ANGLE};

/// The Mohr–Coulomb yield condition `q ≤ p sin φ + c cos φ` for deviatoric stress q and pressure p (Harris & Grekova
/// 2005, eq. 13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb {
    /// Angle of internal friction φ, rad.
    pub friction_angle: f64,
    /// Cohesion c, Pa.
    pub cohesion: f64,
}

impl MohrCoulomb {
    /// Creates the yield condition after checking 0 < φ < π/2 (rad) and c ≥ 0 (Pa).
    ///
    /// # Errors
    /// A constant is out of range.
    pub fn new(friction_angle: f64, cohesion: f64) -> Result<Self, InputError> {
        FRICTION_ANGLE.check(
            friction_angle,
            "the friction angle must lie strictly between 0 and 90 degrees",
        )?;
        COHESION.check(cohesion, "the cohesion must be a finite stress of at least 0 Pa")?;
        Ok(Self { friction_angle, cohesion })
    }

    /// Computes the deviatoric stress q on yield at the pressure p (Pa), `p sin φ + c cos φ`, Pa.
    pub fn yield_deviator(&self, pressure: f64) -> Rounded {
        let phi = Rounded::from_angle(self.friction_angle);
        Rounded::from_rounded(pressure) * phi.sin()
            + Rounded::from_rounded(self.cohesion) * phi.cos()
    }
}

/// Checks the dilatancy angle: 0 ≤ ν < φ, with ν = `nu` and the friction angle φ in rad.
pub(crate) fn check_dilatancy(coulomb: &MohrCoulomb, nu: f64) -> Result<(), InputError> {
    let allowed = "the dilatancy angle must be at least 0 and below the friction angle";
    DILATANCY_ANGLE.check(nu, allowed)?;
    ensure(nu < coulomb.friction_angle, DILATANCY_ANGLE.name, to_rounded_degrees(nu), allowed)
}

/// Coefficients of the flow rule in the form shared by all flow models,
///
/// ```text
/// e_v tr d      = s_v [(d₁₁ − d₂₂) cos 2ψ + 2 d₁₂ sin 2ψ]
/// 2 e_r (ω − s₂₁) = c_r [(d₁₁ − d₂₂) sin 2ψ − 2 d₁₂ cos 2ψ]
/// ```
///
/// with the deformation rate d, the stress angle ψ, the half vorticity s₂₁ and the material rotation ω of the model,
/// 1/s (Harris & Grekova 2005, eqs 41, 42, multiplied out; with e_r = 0 the second line states coaxiality).
#[derive(Clone, Copy, Debug)]
pub struct FlowRule {
    /// Coefficient e_v of tr d: cos(φ − ν), or 1 for the plastic potential.
    pub volume_coefficient: Rounded,
    /// Coefficient s_v of the shear rate in the volume equation: sin ν.
    pub dilatancy_coefficient: Rounded,
    /// Coefficient e_r of the relative rotation ω − s₂₁: sin(φ − ν), or 0 for a coaxial model.
    pub rotation_coefficient: Rounded,
    /// Coefficient c_r of the shear rate in the rotation equation: cos ν, or 1 for the plastic potential.
    pub shear_coefficient: Rounded,
    /// Whether ν > 0, so that the density evolves.
    pub is_dilatant: bool,
}

impl FlowRule {
    /// Flow rule of double shearing with any material rotation (Harris & Grekova 2005, eqs 41, 42); angles φ and ν in
    /// rad.
    pub fn new_double_shearing(friction_angle: f64, dilatancy_angle: f64) -> Self {
        let nu = Rounded::from_angle(dilatancy_angle);
        let difference = Rounded::from_angle(friction_angle) - nu;
        Self {
            volume_coefficient: difference.cos(),
            dilatancy_coefficient: if dilatancy_angle == 0.0 { Rounded::ZERO } else { nu.sin() },
            rotation_coefficient: difference.sin(),
            shear_coefficient: nu.cos(),
            is_dilatant: dilatancy_angle > 0.0,
        }
    }

    /// Ratio e_r/c_r, so that sin 2(ψ − ψ_D) = (e_r/c_r) (ω − s₂₁)/Q_D with the angle ψ_D and the magnitude Q_D of the
    /// deviatoric deformation rate.
    pub fn rotation_ratio(&self) -> f64 {
        (self.rotation_coefficient / self.shear_coefficient).value
    }

    /// Dilatation ratio tr d / (2 Q_D cos 2Δ) = s_v/e_v, with the shear rate Q_D and the non-coaxiality Δ.
    pub fn dilatation(&self) -> Rounded {
        self.dilatancy_coefficient / self.volume_coefficient
    }
}

/// Material rotation ω of a model in the second line of its [`FlowRule`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialRotation {
    /// Intrinsic spin with its own balance equation.
    IntrinsicSpin {
        /// Moment of inertia per unit mass I, m².
        moment_of_inertia: f64,
        /// Rotational yield strength m, Pa.
        strength: f64,
    },
    /// Rotation rate of the principal stress axes.
    StressAxes,
    /// Rotation without an equation that determines it.
    Free,
    /// No rotation: the model is coaxial.
    None,
}

/// State of a flow at a point as input; SI units, rad. Absent quantities are derived.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialState {
    /// Density ρ, kg/m³; > 0.
    pub density: f64,
    /// Pressure p, Pa, compression-positive; > −c cot φ.
    pub pressure: f64,
    /// Deviatoric stress q, Pa; ≥ 0; absent: its value on yield.
    pub deviatoric_stress: Option<f64>,
    /// Rotational stress r = ½(σ₁₂ − σ₂₁) in the index order of Harris & Grekova, Pa; absent:
    /// −m sign(ω − s₂₁), for which the rotational power is never negative.
    pub rotational_stress: Option<f64>,
    /// Angle Ψ_Σ from x₁ of the algebraically greater principal stress (tension-positive), rad.
    pub stress_angle: f64,
    /// Magnitude Q_D of the deviatoric deformation rate, 1/s; > 0.
    pub shear_rate: f64,
    /// Velocity V, m/s.
    pub velocity: [f64; 2],
    /// Half the vorticity s₂₁ = ½(∂₁V₂ − ∂₂V₁), 1/s.
    pub half_vorticity: f64,
    /// Non-coaxiality Δ = Ψ_D − Ψ_Σ, rad, with the angle Ψ_D from x₁ of the greater principal deformation rate; absent:
    /// from the spin, or 0 if the spin is absent too; 0 or absent in a coaxial model.
    pub noncoaxiality: Option<f64>,
    /// Intrinsic spin Ω, rad/s; absent: from the non-coaxiality. Only in models with spin.
    pub spin: Option<f64>,
    /// Gradient of the pressure, Pa/m.
    pub pressure_gradient: [f64; 2],
    /// Gradient of the stress angle, rad/m.
    pub stress_angle_gradient: [f64; 2],
    /// Gradient of the spin, rad/(s·m).
    pub spin_gradient: [f64; 2],
    /// Gradient of the density, kg/m⁴; only where ν > 0.
    pub density_gradient: [f64; 2],
    /// Material rate DΩ/Dt of the spin, rad/s²; enters only the body moment.
    pub spin_acceleration: f64,
    /// Material rate DI/Dt of the moment of inertia, m²/s.
    pub inertia_rate: f64,
    /// Gradient of the moment of inertia, m.
    pub inertia_gradient: [f64; 2],
    /// Velocity gradient, entry \[i\]\[j\] = ∂ⱼVᵢ, 1/s. Redundant: if given, it must agree with the gradient that
    /// follows from the other fields.
    pub velocity_gradient: Option<[[f64; 2]; 2]>,
    /// Material acceleration minus body force, DV/Dt − F, m/s². Redundant: if given, it must satisfy the balance of
    /// momentum.
    pub acceleration: Option<[f64; 2]>,
    /// Body moment per unit mass G, m²/s². Redundant: if given, it must satisfy the balance of spin; only in models
    /// with that balance.
    pub body_moment: Option<f64>,
    /// Material rate of the stress angle, rad/s. Redundant: if given, it must satisfy the flow rule; only in double
    /// shearing.
    pub stress_angle_rate: Option<f64>,
}

impl MaterialState {
    /// Allowed range of the density.
    pub const DENSITY: AllowedRange = AllowedRange::Positive;
    /// Allowed range of the shear rate.
    pub const SHEAR_RATE: AllowedRange = AllowedRange::Positive;
    /// Allowed range of the deviatoric stress.
    pub const DEVIATORIC_STRESS: AllowedRange = AllowedRange::NotNegative;
}

/// Position of a state relative to the yield conditions (Harris & Grekova 2005, section 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum YieldRegion {
    /// Fully deforming: q = p sin φ + c cos φ, and r = ±m or 0, with the deviatoric stress q, the rotational stress r
    /// and the rotational strength m.
    FullyDeforming,
    /// Rigid, or deformation not determined: q below yield or 0 < |r| < m, and neither q nor r outside yield.
    RigidOrIndeterminate,
    /// Not admissible: q above yield or |r| > m.
    OutsideYield,
}

impl YieldRegion {
    /// Name of the region in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FullyDeforming => "fully-deforming",
            Self::RigidOrIndeterminate => "rigid-or-indeterminate",
            Self::OutsideYield => "outside-yield",
        }
    }
}

/// Planar stress by its invariants and the angle of its principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarStress {
    /// Pressure p, Pa.
    pub pressure: f64,
    /// Deviatoric stress q, Pa.
    pub deviator: Rounded,
    /// Rotational stress r, Pa (sign as in [`MaterialState::rotational_stress`]).
    pub rotational_stress: f64,
    /// Angle Ψ_Σ from x₁ of the greater principal stress of the symmetric part, rad.
    pub angle: f64,
}

impl PlanarStress {
    /// The stress tensor, second index = face normal, Pa.
    ///
    /// It is the transpose of the tensor of Harris & Grekova (first index = face normal, eq. 6), by whose index order
    /// the rotational stress r is defined.
    pub fn to_tensor(&self) -> [[f64; 2]; 2] {
        let (p, q, r) = (self.pressure, self.deviator.value, self.rotational_stress);
        let (sin, cos) = (2.0 * self.angle).cr_sin_cos();
        [[-p + q * cos, q * sin - r], [q * sin + r, -p - q * cos]]
    }
}

/// Background state of a flow analysis.
#[expect(clippy::large_enum_variant, reason = "copied once per state, and most states flow")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// Fully deforming flow, which can be analysed.
    FullyDeforming(DeformingFlow),
    /// Rigid, indeterminate or inadmissible: no flow to analyse.
    NotDeforming {
        /// Position relative to the yield conditions.
        region: YieldRegion,
        /// Stress of the state.
        stress: PlanarStress,
    },
}

impl Background {
    /// Position of the state relative to the yield conditions.
    pub fn region(&self) -> YieldRegion {
        match self {
            Self::FullyDeforming(_) => YieldRegion::FullyDeforming,
            Self::NotDeforming { region, .. } => *region,
        }
    }

    /// Stress of the state, whether fully deforming or not.
    pub fn stress(&self) -> &PlanarStress {
        match self {
            Self::FullyDeforming(flow) => &flow.stress,
            Self::NotDeforming { stress, .. } => stress,
        }
    }

    /// The flow if fully deforming, else `None`.
    pub fn flow(&self) -> Option<&DeformingFlow> {
        match self {
            Self::FullyDeforming(flow) => Some(flow),
            Self::NotDeforming { .. } => None,
        }
    }
}

/// Fully deforming background: given and derived quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeformingFlow {
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Stress of the flow, on yield.
    pub stress: PlanarStress,
    /// Magnitude Q_D of the deviatoric deformation rate, 1/s.
    pub shear_rate: f64,
    /// Non-coaxiality Δ = Ψ_D − Ψ_Σ, rad.
    pub noncoaxiality: f64,
    /// Rounding bound of `noncoaxiality`, rad: large if it is derived from a spin near the largest admissible one.
    pub noncoaxiality_rounding: f64,
    /// Velocity V, m/s.
    pub velocity: [f64; 2],
    /// Velocity gradient, entry \[i\]\[j\] = ∂ⱼVᵢ, 1/s.
    pub velocity_gradient: [[Rounded; 2]; 2],
    /// Rotation rate ω − s₂₁ of the material relative to half the vorticity, 1/s; 0 for a coaxial model.
    pub relative_rotation: Rounded,
    /// Half the vorticity s₂₁, 1/s.
    pub half_vorticity: f64,
    /// Intrinsic spin Ω, rad/s; `None` in models without spin.
    pub spin: Option<Rounded>,
    /// Material acceleration minus body force, DV/Dt − F, m/s².
    pub acceleration: [Rounded; 2],
    /// Body moment per unit mass G, m²/s², from the balance of spin; `None` in models without it.
    pub body_moment: Option<f64>,
    /// Material rate of the stress angle, rad/s; `None` unless the flow rule determines it (double shearing).
    pub stress_angle_rate: Option<f64>,
    /// Gradient of the pressure, Pa/m.
    pub pressure_gradient: [f64; 2],
    /// Gradient of the stress angle, rad/m.
    pub stress_angle_gradient: [f64; 2],
    /// Gradient of the spin, rad/(s·m).
    pub spin_gradient: [f64; 2],
    /// Gradient of the density, kg/m⁴.
    pub density_gradient: [f64; 2],
    /// Material rate of the moment of inertia, m²/s.
    pub inertia_rate: f64,
    /// Gradient of the moment of inertia, m.
    pub inertia_gradient: [f64; 2],
    /// Internal power per unit volume, W/m³.
    pub internal_power: f64,
}

impl DeformingFlow {
    /// Non-coaxiality Δ with its rounding bound, rad.
    pub fn rounded_noncoaxiality(&self) -> Rounded {
        Rounded { value: self.noncoaxiality, bound: self.noncoaxiality_rounding }
    }
}
