//! Double-sliding free-rotating model (de Josselin de Jong 1959, 1977): the material rotation is not determined.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::flow::closed_form::ClosedFormVerdict;
use crate::flow::state::{DeformingFlow, FlowRule, MaterialRotation, MohrCoulomb};
use crate::flow::{FlowLaw, FlowModel, RotationKind, SHARED_PARAMETERS};
use parameters::FreeRotating;
use std::sync::Arc;

/// Registry entry of the double-sliding free-rotating model.
pub static MODEL: FlowModel = FlowModel {
    name: "free-rotating",
    title: "double-sliding free-rotating",
    parameters: SHARED_PARAMETERS,
    rotation: RotationKind::Free,
    constructor: |constants| Ok(Arc::new(FreeRotating::from_constants(constants)?)),
};

impl FlowLaw for FreeRotating {
    fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &MohrCoulomb {
        self.0.coulomb()
    }

    fn flow_rule(&self) -> FlowRule {
        self.0.flow_rule()
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::Free
    }

    fn write_symbol(&self, flow: &DeformingFlow, system: &mut LinearisedSystem<2>) {
        symbol::write_symbol(&self.0, flow, system);
    }

    fn closed_form_verdict(&self, _flow: &DeformingFlow) -> Option<ClosedFormVerdict> {
        Some(closed_form::closed_form_verdict(&self.0))
    }
}
