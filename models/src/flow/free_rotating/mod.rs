//! Double-sliding free-rotating model (de Josselin de Jong 1959, 1977): the material rotation is not determined.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::flow::closed_form::ClosedForm;
use crate::flow::state::{Coulomb, Flow, FlowRule, MaterialRotation};
use crate::flow::{FAMILY, FlowLaw, FlowModel, RotationKind};
use parameters::FreeRotating;
use std::sync::Arc;

/// Registry entry of the double-sliding free-rotating model.
pub static MODEL: FlowModel = FlowModel {
    name: "free-rotating",
    title: "double-sliding free-rotating",
    parameters: FAMILY,
    rotation: RotationKind::Free,
    build: |constants| Ok(Arc::new(FreeRotating::from_constants(constants)?)),
};

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

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::Free
    }

    fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>) {
        symbol::write(&self.0, flow, system);
    }

    fn closed_form(&self, _flow: &Flow) -> Option<ClosedForm> {
        Some(closed_form::closed_form(&self.0))
    }
}
