//! Constants of the Harris–Grekova model, its flow rule, non-coaxiality bound and leading growth rate.

use crate::common::elementary::Elementary;
use crate::common::input::{InputError, ensure, to_rounded_degrees};
use crate::common::parameter::{define_parameters, to_constant_array};
use crate::common::scalar::{Function, Scalar};
use crate::flow::DILATANCY_ANGLE;
use crate::flow::state::{FlowRule, MohrCoulomb, check_dilatancy};

define_parameters! {
    pub(super) MOMENT_OF_INERTIA = "moment_of_inertia": "moment of inertia I" ["m²"], Required(1.25e-7), Positive,
        "moment of inertia per unit mass I; > 0, for discs of diameter d it is d²/8";
    pub(super) ROTATIONAL_STRENGTH = "rotational_strength": "rotational strength m" ["Pa"], Required(0.0), NotNegative,
        "rotational yield strength m; ≥ 0";
}

/// Harris–Grekova model with checked constants (Harris & Grekova 2005, section 2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HarrisGrekova {
    /// Mohr–Coulomb yield condition of the symmetric part of the stress.
    pub coulomb: MohrCoulomb,
    /// Angle of dilatancy ν, rad; 0 ≤ ν < φ.
    pub dilatancy_angle: f64,
    /// Moment of inertia per unit mass I, m²; > 0.
    pub moment_of_inertia: f64,
    /// Rotational yield strength m, Pa; ≥ 0.
    pub rotational_strength: f64,
}

impl HarrisGrekova {
    /// Creates the model from its constants in the order of its registered parameters.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn from_constants(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion, moment_of_inertia, rotational_strength] =
            to_constant_array(given)?;
        let coulomb = MohrCoulomb::new(friction_angle, cohesion)?;
        let model =
            HarrisGrekova::new(coulomb, dilatancy_angle, moment_of_inertia, rotational_strength)?;
        Ok(model)
    }

    /// Creates the model after checking 0 ≤ ν < φ, I > 0 (m²) and m ≥ 0 (Pa).
    ///
    /// # Errors
    /// A constant is out of range.
    pub fn new(
        coulomb: MohrCoulomb,
        dilatancy_angle: f64,
        moment_of_inertia: f64,
        rotational_strength: f64,
    ) -> Result<Self, InputError> {
        ensure(
            dilatancy_angle != coulomb.friction_angle,
            DILATANCY_ANGLE.name,
            to_rounded_degrees(dilatancy_angle),
            "the dilatancy angle must be below the friction angle; where they are equal, Harris & Grekova (2005, eqs \
             43–45) have coaxial flow, the spin ω = s₂₁ and the rotational stress r as a reaction: the model \
             plastic-potential with equal angles has this flow rule",
        )?;
        check_dilatancy(&coulomb, dilatancy_angle)?;
        MOMENT_OF_INERTIA.check(
            moment_of_inertia,
            "the moment of inertia per unit mass must be positive, in m²",
        )?;
        ROTATIONAL_STRENGTH.check(
            rotational_strength,
            "the rotational strength must be a finite stress of at least 0 Pa",
        )?;
        Ok(Self { coulomb, dilatancy_angle, moment_of_inertia, rotational_strength })
    }

    /// Flow rule (Harris & Grekova 2005, eqs 41, 42).
    pub fn flow_rule(&self) -> FlowRule {
        FlowRule::new_double_shearing(self.coulomb.friction_angle, self.dilatancy_angle)
    }

    /// Bound on the non-coaxiality |Δ|, rad, below which the leading growth rate is not positive in any direction.
    ///
    /// For ν = 0 the bound is π/4 (Harris & Grekova 2005, eq. 152). For ν > 0, with e = φ − ν and β = 2(Ψ_Σ − ψ_K)
    /// (stress angle Ψ_Σ, angle ψ_K of the wave vector), the coefficient of the highest power of ς in the dispersion
    /// polynomial is proportional to
    /// `cos 2Δ cos ν [cos e + sin ν sin φ − (sin φ cos e + sin ν) cos β] + sin 2Δ sin ν cos φ cos e sin β`,
    /// which has the same sign in all directions if and only if
    ///
    /// ```text
    /// |tan 2Δ| < cot ν √(cos φ cos(φ − 2ν)) / cos(φ − ν).
    /// ```
    ///
    /// For ν > 0 and |Δ| between the bound and π/2 minus the bound the growth rate is unbounded at finite wave numbers,
    /// or of order 3 if the stress angle has a gradient; for larger |Δ| up to π/2 it is of order 2.
    pub fn noncoaxiality_bound(&self) -> f64 {
        noncoaxiality_bound(self.coulomb.friction_angle, self.dilatancy_angle)
    }

    /// Computes the leading growth rate divided by k² for ν = 0, `lim ς/k²` as k → ∞, m²/s (Harris & Grekova 2005,
    /// eq. 149, with the printed factor corrected):
    ///
    /// ```text
    /// −q (cos β − sin φ)² / [2 ρ Q_D cos 2Δ (1 − sin φ cos β)],  β = 2(Ψ_Σ − ψ_K).
    /// ```
    ///
    /// `deviator` q in Pa, `density` ρ in kg/m³, `shear_rate` Q_D in 1/s, `noncoaxiality` Δ and `beta` β in rad; Ψ_Σ is
    /// the stress angle, ψ_K the angle of the wave vector.
    pub fn growth_coefficient(
        &self,
        deviator: f64,
        density: f64,
        shear_rate: f64,
        noncoaxiality: f64,
        beta: f64,
    ) -> f64 {
        let sin_phi = self.coulomb.friction_angle.cr_sin();
        let cosine_difference = beta.cr_cos() - sin_phi;
        -deviator * cosine_difference * cosine_difference
            / (2.0
                * density
                * shear_rate
                * (2.0 * noncoaxiality).cr_cos()
                * (1.0 - sin_phi * beta.cr_cos()))
    }
}

/// [`HarrisGrekova::noncoaxiality_bound`] for angles φ and ν of any number type.
pub(super) fn noncoaxiality_bound<T: Scalar>(phi: T, nu: T) -> T {
    let (cos, sin) = (|x: T| x.apply(Function::Cos), |x: T| x.apply(Function::Sin));
    let opposite = (cos(phi) * cos(phi - (nu + nu))).apply(Function::Sqrt) * cos(nu);
    T::from_exact(0.5) * opposite.atan2(sin(nu) * cos(phi - nu))
}
