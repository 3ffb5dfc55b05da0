//! Harris–Grekova model (Harris & Grekova 2005): double shearing of a reduced Cosserat continuum with intrinsic spin.

pub mod closed_form;
pub mod parameters;
pub mod symbol;

use crate::common::input::InputError;
use crate::common::system::LinearisedSystem;
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::ClosedFormVerdict;
use crate::flow::state::{DeformingFlow, FlowRule, MaterialRotation, MohrCoulomb};
use crate::flow::{COHESION, DILATANCY_ANGLE, FRICTION_ANGLE, FlowLaw, FlowModel, RotationKind};
use parameters::{HarrisGrekova, MOMENT_OF_INERTIA, ROTATIONAL_STRENGTH};
use std::sync::Arc;

/// Registry entry of the Harris–Grekova model.
pub static MODEL: FlowModel = FlowModel {
    name: "harris-grekova",
    title: "Harris–Grekova",
    parameters: &[
        FRICTION_ANGLE,
        DILATANCY_ANGLE,
        COHESION,
        MOMENT_OF_INERTIA,
        ROTATIONAL_STRENGTH,
    ],
    rotation: RotationKind::IntrinsicSpin,
    constructor: |constants| Ok(Arc::new(HarrisGrekova::from_constants(constants)?)),
};

impl FlowLaw for HarrisGrekova {
    fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError> {
        *self = Self::from_constants(constants)?;
        Ok(())
    }

    fn coulomb(&self) -> &MohrCoulomb {
        &self.coulomb
    }

    fn flow_rule(&self) -> FlowRule {
        HarrisGrekova::flow_rule(self)
    }

    fn rotation(&self) -> MaterialRotation {
        MaterialRotation::IntrinsicSpin {
            moment_of_inertia: self.moment_of_inertia,
            strength: self.rotational_strength,
        }
    }

    fn write_symbol(&self, flow: &DeformingFlow, system: &mut LinearisedSystem<2>) {
        symbol::write_symbol(self, flow, system);
    }

    fn closed_form_verdict(&self, flow: &DeformingFlow) -> Option<ClosedFormVerdict> {
        closed_form::closed_form_verdict(self, flow)
    }

    fn box_conditions(
        &self,
        flow: &DeformingFlow,
        constants: &[TaylorModel],
        noncoaxiality: TaylorModel,
    ) -> Option<Vec<(&'static str, TaylorModel)>> {
        closed_form::box_conditions(flow, constants, noncoaxiality)
    }

    fn noncoaxiality_bound(&self) -> Option<f64> {
        Some(HarrisGrekova::noncoaxiality_bound(self))
    }

    fn box_noncoaxiality_bound(&self, constants: &[TaylorModel]) -> Option<TaylorModel> {
        let &[phi, nu, ..] = constants else { return None };
        Some(parameters::noncoaxiality_bound(phi, nu))
    }
}
