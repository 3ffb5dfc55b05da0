//! The double-sliding free-rotating equations linearised with frozen coefficients (de Josselin de
//! Jong 1977): those of Harris & Grekova without a balance of spin, so one equation too few.

use crate::double_shearing::parameters::DoubleShearing;
use crate::granular_flow::balance::{Columns, flow_rule, mass, momentum};
use crate::granular_flow::state::Flow;
use crate::system::{LinearisedSystem, Unknown};

const UNKNOWNS: [Unknown; 6] = [
    Unknown { name: "velocity 1", family: "velocity" },
    Unknown { name: "velocity 2", family: "velocity" },
    Unknown { name: "spin", family: "spin" },
    Unknown { name: "pressure", family: "stress" },
    Unknown { name: "stress angle", family: "stress" },
    Unknown { name: "density", family: "density" },
];
const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: rotation", "mass"];
const SPIN: usize = 2;

/// Writes the linearised system about `flow`: one row fewer than columns.
pub fn write(model: &DoubleShearing, flow: &Flow, system: &mut LinearisedSystem<2>) {
    let rule = model.flow_rule();
    let size = if rule.dilatant { 6 } else { 5 };
    let density = rule.dilatant.then_some(5);
    let columns = Columns { velocity: [0, 1], density, pressure: 3, angle: 4 };
    system.reset(&UNKNOWNS[..size], &EQUATIONS[..size - 1], flow.velocity);

    momentum(system, &columns, &model.coulomb, flow);
    flow_rule(system, 2, &columns, &rule, flow);
    system.c[(3, SPIN)] = 2.0 * rule.rotation;
    mass(system, 4, &columns, flow);
}
