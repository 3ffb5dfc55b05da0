//! Double-shearing model (Spencer 1964; for ν > 0 Mehrabadi & Cowin 1978): the material rotates with the principal
//! stress axes.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::flow::closed_form::ClosedForm;
use crate::flow::state::{Coulomb, Flow, FlowRule, MaterialRotation};
use crate::flow::{FAMILY, FlowLaw, FlowModel, RotationKind};
use parameters::DoubleShearing;
use std::sync::Arc;

/// Registry entry of the double-shearing model.
pub static MODEL: FlowModel = FlowModel {
    name: "double-shearing",
    title: "double shearing",
    parameters: FAMILY,
    rotation: RotationKind::StressAxes,
    build: |constants| Ok(Arc::new(DoubleShearing::from_constants(constants)?)),
};

impl FlowLaw for DoubleShearing {
    fn set(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &Coulomb {
        &self.coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        DoubleShearing::flow_rule(self)
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::StressAxes
    }

    fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>) {
        symbol::write(self, flow, system);
    }

    fn closed_form(&self, flow: &Flow) -> Option<ClosedForm> {
        closed_form::closed_form(self, flow)
    }
}
