//! Double-shearing model (Spencer 1964; for ν > 0 Mehrabadi & Cowin 1978): the material rotates with the principal
//! stress axes.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::ClosedFormVerdict;
use crate::flow::state::{DeformingFlow, FlowRule, MaterialRotation, MohrCoulomb};
use crate::flow::{FlowLaw, FlowModel, RotationKind, SHARED_PARAMETERS};
use parameters::DoubleShearing;
use std::sync::Arc;

/// Registry entry of the double-shearing model.
pub static MODEL: FlowModel = FlowModel {
    name: "double-shearing",
    title: "double shearing",
    parameters: SHARED_PARAMETERS,
    rotation: RotationKind::StressAxes,
    constructor: |constants| Ok(Arc::new(DoubleShearing::from_constants(constants)?)),
};

impl FlowLaw for DoubleShearing {
    fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &MohrCoulomb {
        &self.coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        DoubleShearing::flow_rule(self)
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::StressAxes
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
