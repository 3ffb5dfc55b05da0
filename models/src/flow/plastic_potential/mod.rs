//! Coaxial Mohr–Coulomb plasticity with a plastic potential, associated or not.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::flow::closed_form::ClosedForm;
use crate::flow::state::{Coulomb, Flow, FlowRule, MaterialRotation};
use crate::flow::{FAMILY, FlowLaw, FlowModel, RotationKind};
use parameters::PlasticPotential;
use std::sync::Arc;

/// Registry entry of the plastic-potential model.
pub static MODEL: FlowModel = FlowModel {
    name: "plastic-potential",
    title: "plastic potential",
    parameters: FAMILY,
    rotation: RotationKind::None,
    build: |constants| Ok(Arc::new(PlasticPotential::from_constants(constants)?)),
};

impl FlowLaw for PlasticPotential {
    fn set(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &Coulomb {
        &self.coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        PlasticPotential::flow_rule(self)
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::None
    }

    fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>) {
        symbol::write(self, flow, system);
    }

    fn closed_form(&self, flow: &Flow) -> Option<ClosedForm> {
        closed_form::closed_form(self, flow)
    }
}
