//! The Harris–Grekova equations linearised with frozen coefficients.
//!
//! Balances of momentum, spin and (for a dilatancy angle ν > 0) mass, and the two lines of the flow rule with the
//! intrinsic spin as the material rotation. For ν = 0 these are Harris & Grekova (2005), eqs (81)–(87), corrected; for
//! ν > 0, which the paper omits, the density is a further unknown.

use super::parameters::HarrisGrekova;
use crate::common::rounding::Rounded;
use crate::common::system::LinearisedSystem;
use crate::flow::balance::{SPIN_COLUMN, write_shared_equations};
use crate::flow::state::DeformingFlow;

const EQUATIONS: [&str; 6] =
    ["momentum 1", "momentum 2", "spin", "flow rule: volume", "flow rule: rotation", "mass"];
/// Row of the balance of spin.
const SPIN_ROW: usize = 2;

/// Writes the linearised system about `flow`.
pub fn write_symbol(model: &HarrisGrekova, flow: &DeformingFlow, system: &mut LinearisedSystem<2>) {
    let rule = model.flow_rule();
    let columns = write_shared_equations(system, &EQUATIONS, true, &model.coulomb, &rule, flow);
    system.c[(4, SPIN_COLUMN)] = 2.0 * rule.rotation_coefficient;

    // Balance of spin (eq. 9): ρ I Dω/Dt + ρ (DI/Dt) ω − 2r − ρG = 0. The velocity perturbation advects the background
    // gradients of spin and moment of inertia. The density perturbation is multiplied by I DΩ/Dt + Ω DI/Dt − G, which
    // equals 2R/ρ in the background with the rotational stress R.
    let rho = Rounded::from_rounded(flow.density);
    let inertia = Rounded::from_rounded(model.moment_of_inertia);
    let spin = flow.spin.unwrap_or_default();
    system.a[(SPIN_ROW, SPIN_COLUMN)] = rho * inertia;
    system.c[(SPIN_ROW, SPIN_COLUMN)] = rho * Rounded::from_rounded(flow.inertia_rate);
    for j in 0..2 {
        system.c[(SPIN_ROW, columns.velocity[j])] = rho
            * (inertia * Rounded::from_rounded(flow.spin_gradient[j])
                + spin * Rounded::from_rounded(flow.inertia_gradient[j]));
    }
    if let Some(density) = columns.density {
        system.c[(SPIN_ROW, density)] =
            2.0 * Rounded::from_rounded(flow.stress.rotational_stress) / rho;
    }
}
