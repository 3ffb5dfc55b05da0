//! The plastic-potential equations linearised with frozen coefficients: momentum, dilatancy
//! `tr d = sin ν [(d₁₁ − d₂₂) cos 2ψ + 2 d₁₂ sin 2ψ]`, coaxiality, and mass where ν > 0.

use super::parameters::PlasticPotential;
use crate::common::system::LinearisedSystem;
use crate::flow::balance::{Columns, flow_rule, mass, momentum};
use crate::flow::state::Flow;

const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: coaxiality", "mass"];

/// Writes the linearised system about `flow`.
pub fn write(model: &PlasticPotential, flow: &Flow, system: &mut LinearisedSystem<2>) {
    let rule = model.flow_rule();
    let columns = Columns::reset(system, false, &EQUATIONS, &rule, flow);

    momentum(system, &columns, &model.coulomb, flow);
    flow_rule(system, 2, &columns, &rule, flow);
    mass(system, 4, &columns, flow);
}
