//! Constants of yield sets, their checks, yield functions and normals. The sets are convex, closed and contain zero
//! stress.
//!
//! A set is a list of conditions f(σ, m) ≤ 0 on the force stress σ and the couple stress m. The flow direction is the
//! gradient of the plastic potential, which is f with the dilatancy in place of the friction. If dilatancy and friction
//! are equal, flow is associated and obeys the variational inequality of
//! Sadovskii & Sadovskaya (2019, "Elastic-plastic Cosserat continuum").

use crate::common::input::{InputError, ensure};
use crate::common::parameter::define_parameters;
use crate::common::range::AllowedRange;
use crate::solid::stress::{Stress, StressComponent, split, squared_norm};
use nalgebra::DMatrix;

/// Error text for a constant without bounds.
const FINITE_REQUIRED: &str = "a finite number is needed";

define_parameters! {
    pub(super) SHEAR_STRENGTH = "shear_strength": "shear strength τ₀" ["Pa"], Required(1e6), NotNegative,
        "shear strength τ₀ of the layers without normal stress; ≥ 0";
    pub(super) SHEAR_FRICTION = "shear_friction": "friction of the layers" [""], Required(0.6), NotNegative,
        "friction κ_τ of the layers; ≥ 0";
    pub(super) SHEAR_DILATANCY = "shear_dilatancy": "dilatancy of the layers" [""], Required(0.1), Finite,
        "dilatancy κ̂_τ of the layers; associated if equal to the friction";
    pub(super) COUPLE_STRENGTH = "couple_strength": "couple strength μ₀" ["N/m"], Required(1e6), NotNegative,
        "couple strength μ₀ of the layers without normal stress; ≥ 0";
    pub(super) COUPLE_FRICTION = "couple_friction": "friction of rolling" ["m"], Required(0.6), NotNegative,
        "friction κ_μ of rolling; ≥ 0";
    pub(super) COUPLE_DILATANCY = "couple_dilatancy": "dilatancy of rolling" ["m"], Required(0.6), Finite,
        "dilatancy κ̂_μ of rolling; associated if equal to the friction";

    pub(super) STRENGTH = "strength": "shear strength k_Y" ["Pa"], Required(1e6), Positive,
        "strength k_Y in shear; > 0";
    pub(super) FRICTION = "friction": "friction" [""], Required(0.6), NotNegative,
        "friction κ of τ̄ + κ σ_m ≤ k_Y; ≥ 0";
    pub(super) DILATANCY = "dilatancy": "dilatancy" [""], Required(0.3), Finite,
        "dilatancy κ̂; associated if equal to the friction";
    pub(super) HARDENING = "hardening": "plastic modulus H" ["Pa"], Default(0.0), Finite,
        "plastic modulus H; 0 for ideal plasticity, negative while softening";
    pub(super) ANTISYMMETRIC_WEIGHT = "antisymmetric_weight": "antisymmetric weight h" [""], Required(1.0), NotNegative,
        "weight h of the antisymmetric stress; ≥ 0";
    pub(super) SYMMETRIC_LENGTH = "symmetric_length": "internal length ℓ_s" ["m"], Default(0.0), NotNegative,
        "internal length ℓ_s of the symmetric couple stress; 0: no limit to it";
    pub(super) ANTISYMMETRIC_LENGTH = "antisymmetric_length": "internal length ℓ_a" ["m"], Default(0.0), NotNegative,
        "internal length ℓ_a of the antisymmetric couple stress; 0: no limit to it";
}

/// Yielding controlled by the layers between blocks whose faces are normal to x₁ and x₂
/// (Sadovskii & Sadovskaya 2019, "Plane strain state"), tension positive:
///
/// ```text
/// |σ₂₁| ≤ τ₀ − κ_τ σ₁₁,  |σ₁₂| ≤ τ₀ − κ_τ σ₂₂,  |m₃₁| ≤ μ₀ − κ_μ σ₁₁,  |m₃₂| ≤ μ₀ − κ_μ σ₂₂.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterlayerYieldSet {
    /// Shear strength τ₀ without normal stress, Pa; ≥ 0.
    pub shear_strength: f64,
    /// Friction κ_τ; ≥ 0.
    pub shear_friction: f64,
    /// Dilatancy κ̂_τ, in place of κ_τ in the flow rule; flow is associated if both are equal.
    pub shear_dilatancy: f64,
    /// Limits of the couple stress; `None` in solids without couple stress.
    pub couple: Option<InterlayerCoupleLimits>,
}

/// Limits of the couple stress in an [`InterlayerYieldSet`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterlayerCoupleLimits {
    /// Couple strength μ₀ without normal stress, N/m; ≥ 0.
    pub strength: f64,
    /// Couple friction κ_μ, m; ≥ 0.
    pub friction: f64,
    /// Couple dilatancy κ̂_μ, m, in place of κ_μ in the flow rule; flow is associated if both are equal.
    pub dilatancy: f64,
}

/// A cone or cylinder about the axis of hydrostatic stress,
///
/// ```text
/// τ̄ ≤ k_Y − κ σ_m,   τ̄² = ½|sˢ|² + ½ h |σᵃ|² + ½|mˢ|²/ℓ_s² + ½|mᵃ|²/ℓ_a²,
/// ```
///
/// with the mean stress σ_m = ⅓ tr σ, the deviator s of the force stress σ, the couple stress m, and superscripts s and
/// a for symmetric and antisymmetric parts. The von Mises set has the constant k_Y only; the Drucker–Prager set (1952;
/// the Mises–Schleicher condition linear in σ_m) also κ; the Cosserat–Mises set also h and the internal lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mises {
    /// Strength in shear k_Y, Pa; > 0.
    pub strength: f64,
    /// Friction κ; ≥ 0.
    pub friction: f64,
    /// Dilatancy κ̂, in place of κ in the flow rule; flow is associated if both are equal.
    pub dilatancy: f64,
    /// Weight h of the antisymmetric stress; ≥ 0.
    pub antisymmetric_weight: f64,
    /// Internal length ℓ_s of the symmetric couple stress, m; > 0, `None` for no limit.
    pub symmetric_internal_length: Option<f64>,
    /// Internal length ℓ_a of the antisymmetric couple stress, m; > 0, `None` for no limit.
    pub antisymmetric_internal_length: Option<f64>,
    /// Plastic modulus H, Pa: decrease of f per plastic multiplier at constant stress; 0 for ideal plasticity, negative
    /// while softening.
    pub hardening: f64,
}

/// An active yield condition (f = 0) at a given stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveCondition {
    /// Name of the condition.
    pub name: &'static str,
    /// Yield normal n: gradient of f with respect to force and couple stress.
    pub normal: Stress,
    /// Direction m of the plastic strain rate; equal to the normal n for associated flow.
    pub flow_direction: Stress,
    /// Plastic modulus H, Pa.
    pub hardening: f64,
}

impl InterlayerYieldSet {
    /// Checks that the constants are in range.
    ///
    /// # Errors
    /// A constant is out of range; the error names it.
    pub fn check(self) -> Result<Self, InputError> {
        SHEAR_STRENGTH.check(self.shear_strength, "the shear strength must be τ₀ ≥ 0, in Pa")?;
        SHEAR_FRICTION.check(self.shear_friction, "the friction must be κ_τ ≥ 0")?;
        SHEAR_DILATANCY.check(self.shear_dilatancy, FINITE_REQUIRED)?;
        if let Some(couple) = self.couple {
            COUPLE_STRENGTH.check(couple.strength, "the couple strength must be μ₀ ≥ 0, in N/m")?;
            COUPLE_FRICTION.check(couple.friction, "the friction must be κ_μ ≥ 0, in m")?;
            COUPLE_DILATANCY.check(couple.dilatancy, FINITE_REQUIRED)?;
        }
        Ok(self)
    }

    /// Half-spaces n·s ≤ k of the set: condition (name, normal n, flow direction) and strength k.
    pub fn half_spaces(&self) -> impl Iterator<Item = (ActiveCondition, f64)> {
        const SHEAR_NAMES: [[&str; 2]; 2] = [
            [
                "shear of the layer normal to x1, σ21 > 0",
                "shear of the layer normal to x1, σ21 < 0",
            ],
            [
                "shear of the layer normal to x2, σ12 > 0",
                "shear of the layer normal to x2, σ12 < 0",
            ],
        ];
        const COUPLE_NAMES: [[&str; 2]; 2] = [
            [
                "couple on the layer normal to x1, m31 > 0",
                "couple on the layer normal to x1, m31 < 0",
            ],
            [
                "couple on the layer normal to x2, m32 > 0",
                "couple on the layer normal to x2, m32 < 0",
            ],
        ];
        let set = *self;
        let faces = (0..2).flat_map(|face| [(face, 0, 1.0), (face, 1, -1.0)]);
        let shear = faces.clone().map(move |(face, index, sign)| {
            let gradient = |friction: f64| {
                let mut gradient = Stress::default();
                gradient.force[face][face] = friction;
                gradient.force[1 - face][face] = sign;
                gradient
            };
            let condition = ActiveCondition {
                name: SHEAR_NAMES[face][index],
                normal: gradient(set.shear_friction),
                flow_direction: gradient(set.shear_dilatancy),
                hardening: 0.0,
            };
            (condition, set.shear_strength)
        });
        let couple = set.couple.into_iter().flat_map(move |couple| {
            faces.clone().map(move |(face, index, sign)| {
                let gradient = |friction: f64| {
                    let mut gradient = Stress::default();
                    gradient.force[face][face] = friction;
                    gradient.couple[2][face] = sign;
                    gradient
                };
                let condition = ActiveCondition {
                    name: COUPLE_NAMES[face][index],
                    normal: gradient(couple.friction),
                    flow_direction: gradient(couple.dilatancy),
                    hardening: 0.0,
                };
                (condition, couple.strength)
            })
        });
        shear.chain(couple)
    }
}

impl Mises {
    /// von Mises yield set (1913): √(½ s:s) ≤ k_Y with the stress deviator s; `strength` k_Y in Pa.
    pub const fn new_von_mises(strength: f64) -> Self {
        Self {
            strength,
            friction: 0.0,
            dilatancy: 0.0,
            antisymmetric_weight: 0.0,
            symmetric_internal_length: None,
            antisymmetric_internal_length: None,
            hardening: 0.0,
        }
    }

    /// Drucker–Prager cone (1952): √(½ s:s) + κ σ_m ≤ k_Y with the stress deviator s and the mean stress σ_m; `strength`
    /// k_Y in Pa, `friction` κ, and `dilatancy` κ̂ in place of κ in the flow rule.
    pub const fn new_drucker_prager(strength: f64, friction: f64, dilatancy: f64) -> Self {
        Self { friction, dilatancy, ..Self::new_von_mises(strength) }
    }

    /// Checks that the constants are in range.
    ///
    /// # Errors
    /// A constant is out of range; the error names it.
    pub fn check(self) -> Result<Self, InputError> {
        STRENGTH.check(self.strength, "the strength must be k_Y > 0, in Pa")?;
        FRICTION.check(self.friction, "the friction must be κ ≥ 0")?;
        DILATANCY.check(self.dilatancy, FINITE_REQUIRED)?;
        ANTISYMMETRIC_WEIGHT.check(self.antisymmetric_weight, "the weight must be h ≥ 0")?;
        // Input lengths of 0 have been converted to `None`, so a length must be positive here.
        let positive = |key: &'static str, value: f64, allowed: &str| {
            ensure(AllowedRange::Positive.contains(value), key, value, allowed)
        };
        if let Some(length) = self.symmetric_internal_length {
            positive(SYMMETRIC_LENGTH.name, length, "the length must be ℓ_s > 0, in m")?;
        }
        if let Some(length) = self.antisymmetric_internal_length {
            positive(ANTISYMMETRIC_LENGTH.name, length, "the length must be ℓ_a > 0, in m")?;
        }
        HARDENING.check(self.hardening, FINITE_REQUIRED)?;
        Ok(self)
    }

    /// Weights 1/ℓ_s² and 1/ℓ_a² of the couple stresses mˢ and mᵃ in τ̄², 1/m²; 0 for no limit.
    pub(super) fn couple_weights(&self) -> [f64; 2] {
        [self.symmetric_internal_length, self.antisymmetric_internal_length]
            .map(|length| length.map_or(0.0, |l| 1.0 / (l * l)))
    }

    /// Gradient of ½τ̄² with respect to the stress: ½(sˢ + h σᵃ) and ½(mˢ/ℓ_s² + mᵃ/ℓ_a²).
    fn half_gradient(&self, stress: &Stress) -> Stress {
        let [symmetric, antisymmetric] = self.couple_weights();
        let (_, deviator, antisymmetric_part) = split(&stress.force);
        let (mean, couple_deviator, couple_antisymmetric) = split(&stress.couple);
        let mut gradient = Stress::default();
        for i in 0..3 {
            for j in 0..3 {
                let force = deviator[i][j] + self.antisymmetric_weight * antisymmetric_part[i][j];
                let spherical = if i == j { mean } else { 0.0 };
                let couple = symmetric * (couple_deviator[i][j] + spherical)
                    + antisymmetric * couple_antisymmetric[i][j];
                (gradient.force[i][j], gradient.couple[i][j]) = (0.5 * force, 0.5 * couple);
            }
        }
        gradient
    }

    /// Equivalent shear stress τ̄, Pa, as defined at [`Mises`].
    pub fn equivalent_shear(&self, stress: &Stress) -> f64 {
        let [symmetric, antisymmetric] = self.couple_weights();
        let (_, deviator, antisymmetric_part) = split(&stress.force);
        let (mean, couple_deviator, couple_antisymmetric) = split(&stress.couple);
        let force =
            squared_norm(&deviator) + self.antisymmetric_weight * squared_norm(&antisymmetric_part);
        let couple = symmetric * (squared_norm(&couple_deviator) + 3.0 * mean * mean)
            + antisymmetric * squared_norm(&couple_antisymmetric);
        (0.5 * (force + couple)).sqrt()
    }

    /// Hessian of τ̄ with respect to `components` (1/Pa between force stresses): symmetric positive semidefinite.
    /// `None` where τ̄ = 0, on the axis of the cone.
    pub fn curvature(
        &self,
        stress: &Stress,
        components: &[StressComponent],
    ) -> Option<DMatrix<f64>> {
        let shear = self.equivalent_shear(stress);
        if shear <= 0.0 {
            return None;
        }
        // With τ̄² = ½ s·Ws, where s is the stress and W the matrix of weights: ∇τ̄ = ½Ws/τ̄ and
        // ∇²τ̄ = ½W/τ̄ − ∇τ̄ ∇τ̄ᵀ/τ̄.
        let slope = self.half_gradient(stress);
        let slopes: Vec<f64> = components.iter().map(|c| c.derivative(&slope) / shear).collect();
        Some(DMatrix::from_fn(components.len(), components.len(), |i, j| {
            let mut unit = Stress::default();
            components[j].set(&mut unit, 1.0);
            let image = components[i].derivative(&self.half_gradient(&unit));
            (image - slopes[i] * slopes[j]) / shear
        }))
    }

    /// The condition with its normal at `stress`; `None` where τ̄ = 0, on the axis of the cone, which has no unique
    /// normal there.
    pub fn condition(&self, stress: &Stress) -> Option<ActiveCondition> {
        let shear = self.equivalent_shear(stress);
        if shear <= 0.0 {
            return None;
        }
        let half = self.half_gradient(stress);
        let gradient = |friction: f64| {
            let scaled = |t: [[f64; 3]; 3]| t.map(|row| row.map(|x| x / shear));
            let mut gradient = Stress { force: scaled(half.force), couple: scaled(half.couple) };
            for i in 0..3 {
                gradient.force[i][i] += friction / 3.0;
            }
            gradient
        };
        Some(ActiveCondition {
            name: "yield",
            normal: gradient(self.friction),
            flow_direction: gradient(self.dilatancy),
            hardening: self.hardening,
        })
    }
}

/// Mean stress σ_m = ⅓ tr σ, Pa, tension-positive.
pub fn mean_stress(stress: &Stress) -> f64 {
    (stress.force[0][0] + stress.force[1][1] + stress.force[2][2]) / 3.0
}

/// Full contraction of a gradient with a stress: the sum over all force and couple components.
pub fn contract(gradient: &Stress, stress: &Stress) -> f64 {
    let parts = [(&gradient.force, &stress.force), (&gradient.couple, &stress.couple)];
    let products = |(a, b): (&[[f64; 3]; 3], &[[f64; 3]; 3])| {
        a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| x * y).sum::<f64>()
    };
    parts.into_iter().map(products).sum()
}

/// Stress of the absolute values of all components.
pub(crate) fn absolute_values(stress: &Stress) -> Stress {
    let absolute_values = |t: [[f64; 3]; 3]| t.map(|row| row.map(f64::abs));
    Stress { force: absolute_values(stress.force), couple: absolute_values(stress.couple) }
}
