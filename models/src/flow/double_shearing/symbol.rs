//! The double-shearing equations linearised with frozen coefficients.
//!
//! The material rotation is the rotation rate Dψ/Dt of the principal stress axes (Spencer 1964; Mehrabadi & Cowin 1978
//! for ν > 0).

use super::parameters::DoubleShearing;
use crate::common::system::LinearisedSystem;
use crate::flow::balance::{
    EQUATIONS_WITH_ROTATION, write_shared_equations, write_stress_axes_rotation,
};
use crate::flow::state::DeformingFlow;

/// Writes the linearised system about `flow`.
pub fn write_symbol(
    model: &DoubleShearing,
    flow: &DeformingFlow,
    system: &mut LinearisedSystem<2>,
) {
    let rule = model.flow_rule();
    let columns = write_shared_equations(
        system,
        &EQUATIONS_WITH_ROTATION,
        false,
        &model.coulomb,
        &rule,
        flow,
    );
    write_stress_axes_rotation(system, 3, &columns, &rule, flow);
}
