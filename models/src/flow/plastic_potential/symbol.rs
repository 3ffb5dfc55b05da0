//! The plastic-potential equations linearised with frozen coefficients: momentum, dilatancy
//! `tr d = sin ν [(d₁₁ − d₂₂) cos 2ψ + 2 d₁₂ sin 2ψ]`, coaxiality, and mass if the dilatancy angle ν is positive.

use super::parameters::PlasticPotential;
use crate::common::system::LinearisedSystem;
use crate::flow::balance::{UnknownColumns, write_flow_rule, write_mass, write_momentum};
use crate::flow::state::DeformingFlow;

const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: coaxiality", "mass"];

/// Writes the linearised system about `flow`.
pub fn write_symbol(
    model: &PlasticPotential,
    flow: &DeformingFlow,
    system: &mut LinearisedSystem<2>,
) {
    let rule = model.flow_rule();
    let columns = UnknownColumns::reset_system(system, false, &EQUATIONS, &rule, flow);

    write_momentum(system, &columns, &model.coulomb, flow);
    write_flow_rule(system, 2, &columns, &rule, flow);
    write_mass(system, 4, &columns, flow);
}
