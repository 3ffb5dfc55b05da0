//! The double-sliding free-rotating equations linearised with frozen coefficients (de Josselin de Jong 1977): the
//! Harris–Grekova equations without the balance of spin, so one equation fewer than unknowns.

use crate::common::system::LinearisedSystem;
use crate::flow::balance::{EQUATIONS_WITH_ROTATION, SPIN_COLUMN, write_shared_equations};
use crate::flow::double_shearing::parameters::DoubleShearing;
use crate::flow::state::DeformingFlow;

/// Writes the linearised system about `flow`: one row fewer than columns.
pub fn write_symbol(
    model: &DoubleShearing,
    flow: &DeformingFlow,
    system: &mut LinearisedSystem<2>,
) {
    let rule = model.flow_rule();
    write_shared_equations(system, &EQUATIONS_WITH_ROTATION, true, &model.coulomb, &rule, flow);
    system.c[(3, SPIN_COLUMN)] = 2.0 * rule.rotation_coefficient;
}
