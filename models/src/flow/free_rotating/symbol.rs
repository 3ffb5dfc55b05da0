//! The double-sliding free-rotating equations linearised with frozen coefficients (de Josselin de Jong 1977): the
//! Harris–Grekova equations without the balance of spin, so one equation fewer than unknowns.

use crate::common::system::LinearisedSystem;
use crate::flow::balance::{
    SPIN_COLUMN, UnknownColumns, write_flow_rule, write_mass, write_momentum,
};
use crate::flow::double_shearing::parameters::DoubleShearing;
use crate::flow::state::DeformingFlow;

const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: rotation", "mass"];

/// Writes the linearised system about `flow`: one row fewer than columns.
pub fn write_symbol(
    model: &DoubleShearing,
    flow: &DeformingFlow,
    system: &mut LinearisedSystem<2>,
) {
    let rule = model.flow_rule();
    let columns = UnknownColumns::reset_system(system, true, &EQUATIONS, &rule, flow);

    write_momentum(system, &columns, &model.coulomb, flow);
    write_flow_rule(system, 2, &columns, &rule, flow);
    system.c[(3, SPIN_COLUMN)] = 2.0 * rule.rotation_coefficient;
    write_mass(system, 4, &columns, flow);
}
