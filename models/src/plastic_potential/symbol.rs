//! The plastic-potential equations linearised with frozen coefficients: momentum, dilatancy
//! `tr d = sin ν [(d₁₁ − d₂₂) cos 2ψ + 2 d₁₂ sin 2ψ]`, coaxiality, and mass where ν > 0.

use super::parameters::PlasticPotential;
use crate::granular_flow::balance::{Columns, flow_rule, mass, momentum};
use crate::granular_flow::state::Flow;
use crate::system::{LinearisedSystem, Unknown};

const UNKNOWNS: [Unknown; 5] = [
    Unknown { name: "velocity 1", family: "velocity" },
    Unknown { name: "velocity 2", family: "velocity" },
    Unknown { name: "pressure", family: "stress" },
    Unknown { name: "stress angle", family: "stress" },
    Unknown { name: "density", family: "density" },
];
const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: coaxiality", "mass"];

/// Writes the linearised system about `flow`.
pub fn write(model: &PlasticPotential, flow: &Flow, system: &mut LinearisedSystem<2>) {
    let rule = model.flow_rule();
    let size = if rule.dilatant { 5 } else { 4 };
    let density = rule.dilatant.then_some(4);
    let columns = Columns { velocity: [0, 1], density, pressure: 2, angle: 3 };
    system.reset(&UNKNOWNS[..size], &EQUATIONS[..size], flow.velocity);

    momentum(system, &columns, &model.coulomb, flow);
    flow_rule(system, 2, &columns, &rule, flow);
    mass(system, 4, &columns, flow);
}
