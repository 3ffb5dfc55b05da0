//! The double-shearing equations linearised with frozen coefficients.
//!
//! The material rotation is the rotation rate Dψ/Dt of the principal stress axes (Spencer 1964; Mehrabadi & Cowin 1978
//! for ν > 0).

use super::parameters::DoubleShearing;
use crate::common::rounding::Rounded;
use crate::common::system::LinearisedSystem;
use crate::flow::balance::{UnknownColumns, write_flow_rule, write_mass, write_momentum};
use crate::flow::state::DeformingFlow;

const EQUATIONS: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: rotation", "mass"];

/// Writes the linearised system about `flow`.
pub fn write_symbol(
    model: &DoubleShearing,
    flow: &DeformingFlow,
    system: &mut LinearisedSystem<2>,
) {
    let rule = model.flow_rule();
    let columns = UnknownColumns::reset_system(system, false, &EQUATIONS, &rule, flow);

    write_momentum(system, &columns, &model.coulomb, flow);
    write_flow_rule(system, 2, &columns, &rule, flow);
    write_mass(system, 4, &columns, flow);

    // Material rotation ω = Dψ/Dt: the term 2 e_r Dψ/Dt, where e_r is the rotation coefficient of the flow rule.
    let rotation = 2.0 * rule.rotation_coefficient;
    system.a[(3, columns.angle)] = rotation;
    for j in 0..2 {
        system.c[(3, columns.velocity[j])] =
            rotation * Rounded::from_angle(flow.stress_angle_gradient[j]);
    }
}
