//! Constants of the double-shearing model, its flow rule and its leading growth rate.

use crate::common::elementary::Elementary;
use crate::common::input::InputError;
use crate::common::parameter::to_constant_array;
use crate::flow::state::{FlowRule, MohrCoulomb, check_dilatancy};

/// Double-shearing model with checked constants (Spencer 1964; Mehrabadi & Cowin 1978).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleShearing {
    /// Mohr–Coulomb yield condition.
    pub coulomb: MohrCoulomb,
    /// Angle of dilatancy ν, rad; 0 ≤ ν < φ.
    pub dilatancy_angle: f64,
}

impl DoubleShearing {
    /// Creates the model from its constants in the order of its registered parameters.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn from_constants(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion] = to_constant_array(given)?;
        let coulomb = MohrCoulomb::new(friction_angle, cohesion)?;
        Self::new(coulomb, dilatancy_angle)
    }

    /// Creates the model after checking 0 ≤ ν < φ; `dilatancy_angle` ν in rad.
    ///
    /// # Errors
    /// The dilatancy angle is out of range.
    pub fn new(coulomb: MohrCoulomb, dilatancy_angle: f64) -> Result<Self, InputError> {
        check_dilatancy(&coulomb, dilatancy_angle)?;
        Ok(Self { coulomb, dilatancy_angle })
    }

    /// Flow rule of double shearing (Harris & Grekova 2005, eqs 41, 42).
    pub fn flow_rule(&self) -> FlowRule {
        FlowRule::new_double_shearing(self.coulomb.friction_angle, self.dilatancy_angle)
    }

    /// Leading growth rate divided by the wave number k for ν = 0, m/s:
    /// `|cos β − sin φ| √(q / [ρ sin φ (1 − sin φ cos β)])`, β = 2(Ψ_Σ − ψ_K).
    ///
    /// `deviator` q in Pa, `density` ρ in kg/m³, `beta` β in rad; Ψ_Σ is the stress angle, ψ_K the angle of the wave
    /// vector.
    pub fn growth_coefficient(&self, deviator: f64, density: f64, beta: f64) -> f64 {
        let sin_phi = self.coulomb.friction_angle.cr_sin();
        (beta.cr_cos() - sin_phi).abs()
            * (deviator / (density * sin_phi * (1.0 - sin_phi * beta.cr_cos()))).sqrt()
    }
}
