//! Constants of the plastic-potential model, its flow rule and its leading growth rate.

use crate::common::elementary::Elementary;
use crate::common::input::InputError;
use crate::common::parameter::to_constant_array;
use crate::common::rounding::Rounded;
use crate::flow::parameters::DILATANCY_ANGLE;
use crate::flow::state::{FlowRule, MohrCoulomb};

/// Plastic-potential model with checked constants; the flow is associated if ν = φ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticPotential {
    /// Mohr–Coulomb yield condition.
    pub coulomb: MohrCoulomb,
    /// Angle of dilatancy ν, rad; 0 ≤ ν < π/2.
    pub dilatancy_angle: f64,
}

impl PlasticPotential {
    /// Creates the model from its constants in the order of its registered parameters.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn from_constants(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion] = to_constant_array(given)?;
        let coulomb = MohrCoulomb::new(friction_angle, cohesion)?;
        Self::new(coulomb, dilatancy_angle)
    }

    /// Creates the model after checking 0 ≤ ν < π/2; `dilatancy_angle` ν in rad.
    ///
    /// # Errors
    /// The dilatancy angle is out of range.
    pub fn new(coulomb: MohrCoulomb, dilatancy_angle: f64) -> Result<Self, InputError> {
        DILATANCY_ANGLE.check(
            dilatancy_angle,
            "the dilatancy angle of a plastic potential must be at least 0 and below 90 degrees",
        )?;
        Ok(Self { coulomb, dilatancy_angle })
    }

    /// The coaxial flow rule tr d = 2 Q_D sin ν, with the shear rate Q_D.
    pub fn flow_rule(&self) -> FlowRule {
        let dilatant = self.dilatancy_angle > 0.0;
        FlowRule {
            volume_coefficient: Rounded::ONE,
            dilatancy_coefficient: if dilatant {
                Rounded::from_angle(self.dilatancy_angle).sin()
            } else {
                Rounded::ZERO
            },
            rotation_coefficient: Rounded::ZERO,
            shear_coefficient: Rounded::ONE,
            is_dilatant: dilatant,
        }
    }

    /// Computes the leading growth rate, that of wave numbers k → ∞, divided by k², m²/s, in the direction with β =
    /// 2(Ψ_Σ − ψ_K) = `beta`, rad (stress angle Ψ_Σ, angle ψ_K of the wave vector):
    ///
    /// ```text
    /// −q (cos β − sin ν)(cos β − sin φ) / {2 ρ Q_D [1 + sin ν sin φ − (sin ν + sin φ) cos β]}
    /// ```
    ///
    /// which is positive exactly if cos β lies between sin ν and sin φ. `deviator` q in Pa, `density` ρ in kg/m³,
    /// `shear_rate` Q_D in 1/s.
    pub fn growth_coefficient(
        &self,
        deviator: f64,
        density: f64,
        shear_rate: f64,
        beta: f64,
    ) -> f64 {
        let (sin_phi, sin_nu) =
            (self.coulomb.friction_angle.cr_sin(), self.dilatancy_angle.cr_sin());
        let cos = beta.cr_cos();
        -deviator * (cos - sin_nu) * (cos - sin_phi)
            / (2.0 * density * shear_rate * (1.0 + sin_nu * sin_phi - (sin_nu + sin_phi) * cos))
    }

    /// Ends of the open interval of |β|, rad, that contains the unstable directions: π/2 − max(φ, ν) and
    /// π/2 − min(φ, ν), with β = 2(Ψ_Σ − ψ_K) as in [`growth_coefficient`](Self::growth_coefficient), in (−π, π]. The
    /// interval is empty for associated flow, φ = ν, where both ends are equal.
    pub fn unstable_sector(&self) -> [f64; 2] {
        let (phi, nu) = (self.coulomb.friction_angle, self.dilatancy_angle);
        [phi.max(nu), phi.min(nu)].map(|angle| std::f64::consts::FRAC_PI_2 - angle)
    }

    /// Computes the maximum over all directions of the growth rate divided by k² in the limit k → ∞ of the wave number
    /// k, `q tan²((φ − ν)/2) / (2 ρ Q_D)` in m²/s, and `cos β = sin((φ + ν)/2) / cos((φ − ν)/2)` of its direction, with
    /// β = 2(Ψ_Σ − ψ_K) as in [`growth_coefficient`](Self::growth_coefficient), the friction angle φ and the dilatancy
    /// angle ν. `deviator` q in Pa, `density` ρ in kg/m³, `shear_rate` Q_D in 1/s.
    pub fn fastest_growth(&self, deviator: f64, density: f64, shear_rate: f64) -> (f64, f64) {
        let half_difference = 0.5 * (self.coulomb.friction_angle - self.dilatancy_angle);
        let half_sum = 0.5 * (self.coulomb.friction_angle + self.dilatancy_angle);
        let rate = deviator * half_difference.cr_tan().powi(2) / (2.0 * density * shear_rate);
        (rate, half_sum.cr_sin() / half_difference.cr_cos())
    }
}
