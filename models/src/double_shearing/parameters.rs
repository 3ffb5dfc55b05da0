//! Constants of the double-shearing model and what is known of it in closed form.

use super::{closed_form, symbol};
use crate::closed_form::ClosedForm;
use crate::elementary::Elementary;
use crate::granular_flow::state::{Coulomb, Flow, FlowRule, Rotation, check_dilatancy};
use crate::granular_flow::{FAMILY, FlowLaw, FlowModel, RotationKind, constants};
use crate::input::InputError;
use crate::system::LinearisedSystem;

/// The entry in the registry.
pub static MODEL: FlowModel = FlowModel {
    name: "double-shearing",
    title: "double shearing",
    parameters: FAMILY,
    rotation: RotationKind::StressAxes,
    is_coaxial: false,
    build: |constants| Ok(Box::new(DoubleShearing::from_constants(constants)?)),
};

/// Checked constants (Spencer 1964; Mehrabadi & Cowin 1978).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleShearing {
    /// Yield condition.
    pub coulomb: Coulomb,
    /// Angle of dilatancy ν, rad; 0 ≤ ν < φ.
    pub dilatancy_angle: f64,
}

impl DoubleShearing {
    /// From the constants in the order of the model's parameters.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn from_constants(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion] = constants(given)?;
        let coulomb = Coulomb::new(friction_angle, cohesion)?;
        Self::new(coulomb, dilatancy_angle)
    }

    /// Checks the constants.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn new(coulomb: Coulomb, dilatancy_angle: f64) -> Result<Self, InputError> {
        check_dilatancy(
            dilatancy_angle,
            coulomb.friction_angle,
            "the dilatancy angle must be at least 0 and below the friction angle",
        )?;
        Ok(Self { coulomb, dilatancy_angle })
    }

    /// Leading growth rate over k for ν = 0, m/s:
    /// `|cos β − sin φ| √(q / [ρ sin φ (1 − sin φ cos β)])`, β = 2(Ψ_Σ − ψ_K).
    ///
    /// `deviator` q in Pa, `density` in kg/m³.
    pub fn leading_coefficient(&self, deviator: f64, density: f64, beta: f64) -> f64 {
        let sin_phi = self.coulomb.friction_angle.cr_sin();
        (beta.cr_cos() - sin_phi).abs()
            * (deviator / (density * sin_phi * (1.0 - sin_phi * beta.cr_cos()))).sqrt()
    }
}

impl FlowLaw for DoubleShearing {
    fn set(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &Coulomb {
        &self.coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        FlowRule::double_shearing(self.coulomb.friction_angle, self.dilatancy_angle)
    }

    fn rotation(&self) -> Rotation {
        Rotation::StressAxes
    }

    fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>) {
        symbol::write(self, flow, system);
    }

    fn closed_form(&self, flow: &Flow) -> Option<ClosedForm> {
        closed_form::closed_form(self, flow)
    }
}
