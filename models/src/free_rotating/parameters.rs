//! Constants of the double-sliding free-rotating model.

use super::{closed_form, symbol};
use crate::closed_form::ClosedForm;
use crate::double_shearing::parameters::DoubleShearing;
use crate::granular_flow::state::{Coulomb, Flow, FlowRule, Rotation};
use crate::granular_flow::{FAMILY, FlowLaw, FlowModel, RotationKind, constants};
use crate::input::InputError;
use crate::system::LinearisedSystem;

/// The entry in the registry.
pub static MODEL: FlowModel = FlowModel {
    name: "free-rotating",
    title: "double-sliding free-rotating",
    parameters: FAMILY,
    rotation: RotationKind::Free,
    is_coaxial: false,
    build: |constants| Ok(Box::new(FreeRotating::from_constants(constants)?)),
};

/// Checked constants, which are those of double shearing (de Josselin de Jong 1977).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRotating(pub DoubleShearing);

impl FreeRotating {
    /// From the constants in the order of the model's parameters.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn from_constants(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion] = constants(given)?;
        let coulomb = Coulomb::new(friction_angle, cohesion)?;
        Ok(Self(DoubleShearing::new(coulomb, dilatancy_angle)?))
    }
}

impl FlowLaw for FreeRotating {
    fn set(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &Coulomb {
        self.0.coulomb()
    }

    fn flow_rule(&self) -> FlowRule {
        self.0.flow_rule()
    }

    fn rotation(&self) -> Rotation {
        Rotation::Free
    }

    fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>) {
        symbol::write(&self.0, flow, system);
    }

    fn closed_form(&self, _flow: &Flow) -> Option<ClosedForm> {
        Some(closed_form::closed_form(&self.0))
    }
}
