//! Coaxial Mohr–Coulomb plasticity with a plastic potential, associated or not.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::ClosedFormVerdict;
use crate::flow::state::{DeformingFlow, FlowRule, MaterialRotation, MohrCoulomb};
use crate::flow::{FlowLaw, FlowModel, RotationKind, SHARED_PARAMETERS};
use parameters::PlasticPotential;
use std::sync::Arc;

/// Registry entry of the plastic-potential model.
pub static MODEL: FlowModel = FlowModel {
    name: "plastic-potential",
    title: "plastic potential",
    parameters: SHARED_PARAMETERS,
    rotation: RotationKind::None,
    constructor: |constants| Ok(Arc::new(PlasticPotential::from_constants(constants)?)),
};

impl FlowLaw for PlasticPotential {
    fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &MohrCoulomb {
        &self.coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        PlasticPotential::flow_rule(self)
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::None
    }

    fn write_symbol(&self, flow: &DeformingFlow, system: &mut LinearisedSystem<2>) {
        symbol::write_symbol(self, flow, system);
    }

    fn closed_form_verdict(&self, flow: &DeformingFlow) -> Option<ClosedFormVerdict> {
        closed_form::closed_form_verdict(self, flow)
    }

    fn box_conditions(
        &self,
        _flow: &DeformingFlow,
        constants: &[TaylorModel],
        _noncoaxiality: TaylorModel,
    ) -> Option<Vec<(&'static str, TaylorModel)>> {
        closed_form::box_conditions(constants)
    }
}
