//! The plastic-potential equations linearised with frozen coefficients: momentum, dilatancy
//! `tr d = sin ν [(d₁₁ − d₂₂) cos 2ψ + 2 d₁₂ sin 2ψ]`, coaxiality, and mass if the dilatancy angle ν is positive.

use super::parameters::PlasticPotential;
use crate::common::system::LinearisedSystem;
use crate::flow::balance::write_shared_equations;
use crate::flow::state::DeformingFlow;

const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: coaxiality", "mass"];

/// Writes the linearised system about `flow`.
pub fn write_symbol(
    model: &PlasticPotential,
    flow: &DeformingFlow,
    system: &mut LinearisedSystem<2>,
) {
    write_shared_equations(system, &EQUATIONS, false, &model.coulomb, &model.flow_rule(), flow);
}
