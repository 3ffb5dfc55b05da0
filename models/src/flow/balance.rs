//! Linearised balance equations and flow rule shared by the granular-flow models.
//!
//! Harris & Grekova (2005), eqs (16)–(18), (41), (42), linearised about a background as in section 5 of the paper, with
//! the printed errors of eqs (83) and (86) corrected. For a dilatancy angle ν > 0 the density is an unknown. The
//! equations quoted below are the nonlinear ones, in lower-case symbols; capitals are values of the background.

use super::state::{DeformingFlow, FlowRule, MohrCoulomb};
use crate::common::rounding::Rounded;
use crate::common::system::{LinearisedSystem, Unknown};

const VELOCITY_1: Unknown = Unknown { name: "velocity 1", family: "velocity" };
const VELOCITY_2: Unknown = Unknown { name: "velocity 2", family: "velocity" };
const SPIN: Unknown = Unknown { name: "spin", family: "spin" };
const PRESSURE: Unknown = Unknown { name: "pressure", family: "stress" };
const STRESS_ANGLE: Unknown = Unknown { name: "stress angle", family: "stress" };
const DENSITY: Unknown = Unknown { name: "density", family: "density" };

// The density is the last unknown, so that it can be omitted for ν = 0.
const UNKNOWNS_WITHOUT_SPIN: &[Unknown] =
    &[VELOCITY_1, VELOCITY_2, PRESSURE, STRESS_ANGLE, DENSITY];
const UNKNOWNS_WITH_SPIN: &[Unknown] =
    &[VELOCITY_1, VELOCITY_2, SPIN, PRESSURE, STRESS_ANGLE, DENSITY];

/// Names of the equations of models whose flow rule contains a material rotation without its own balance equation.
pub const EQUATIONS_WITH_ROTATION: [&str; 5] =
    ["momentum 1", "momentum 2", "flow rule: volume", "flow rule: rotation", "mass"];

/// Column of the intrinsic spin ω in models with spin.
pub const SPIN_COLUMN: usize = 2;

/// Columns of the unknowns other than the spin.
#[derive(Clone, Copy, Debug)]
pub struct UnknownColumns {
    /// Columns of the velocity components v₁ and v₂.
    pub velocity: [usize; 2],
    /// Column of the pressure p.
    pub pressure: usize,
    /// Column of the stress angle ψ.
    pub stress_angle: usize,
    /// Column of the density ρ; `None` for ν = 0, where the density is constant.
    pub density: Option<usize>,
}

impl UnknownColumns {
    /// Resets `system` to the unknowns of a model with or without intrinsic spin and to `equations`, whose last entry
    /// is the balance of mass, and returns the columns. Without dilatancy the density and the balance of mass are
    /// omitted.
    pub fn reset_system(
        system: &mut LinearisedSystem<2>,
        has_spin: bool,
        equations: &'static [&'static str],
        rule: &FlowRule,
        flow: &DeformingFlow,
    ) -> Self {
        let omitted_count = usize::from(!rule.is_dilatant);
        let all = if has_spin { UNKNOWNS_WITH_SPIN } else { UNKNOWNS_WITHOUT_SPIN };
        let unknowns = &all[..all.len() - omitted_count];
        system.reset(unknowns, &equations[..equations.len() - omitted_count], flow.velocity);
        let pressure_column = if has_spin { SPIN_COLUMN + 1 } else { 2 };
        Self {
            velocity: [0, 1],
            pressure: pressure_column,
            stress_angle: pressure_column + 1,
            density: rule.is_dilatant.then_some(pressure_column + 2),
        }
    }
}

/// Resets `system` and writes the equations that all flow models share: the balance of momentum in the first two rows,
/// the flow rule without the term of the material rotation and the balance of mass in the last three rows of
/// `equations`. Returns the columns.
pub fn write_shared_equations(
    system: &mut LinearisedSystem<2>,
    equations: &'static [&'static str],
    has_spin: bool,
    coulomb: &MohrCoulomb,
    rule: &FlowRule,
    flow: &DeformingFlow,
) -> UnknownColumns {
    let columns = UnknownColumns::reset_system(system, has_spin, equations, rule, flow);
    let volume_row = equations.len() - 3;
    write_momentum(system, &columns, coulomb, flow);
    write_flow_rule(system, volume_row, &columns, rule, flow);
    write_mass(system, volume_row + 2, &columns, flow);
    columns
}

/// Writes the term 2 e_r Dψ/Dt of a material that rotates with the principal stress axes, ω = Dψ/Dt, into `row`; e_r is
/// the rotation coefficient of the flow rule.
pub fn write_stress_axes_rotation(
    system: &mut LinearisedSystem<2>,
    row: usize,
    columns: &UnknownColumns,
    rule: &FlowRule,
    flow: &DeformingFlow,
) {
    let rotation = 2.0 * rule.rotation_coefficient;
    system.a[(row, columns.stress_angle)] = rotation;
    for j in 0..2 {
        system.c[(row, columns.velocity[j])] =
            rotation * Rounded::from_angle(flow.stress_angle_gradient[j]);
    }
}

/// (sin 2Ψ, cos 2Ψ) of the stress angle Ψ.
fn sin_cos_twice_stress_angle(flow: &DeformingFlow) -> [Rounded; 2] {
    let angle = 2.0 * Rounded::from_angle(flow.stress.angle);
    [angle.sin(), angle.cos()]
}

/// Writes the linearisation of the balance of momentum into rows 0 and 1:
///
/// ```text
/// ρ Dv₁/Dt + (1 − sin φ cos 2ψ) ∂₁p − sin φ sin 2ψ ∂₂p + 2q (sin 2ψ ∂₁ψ − cos 2ψ ∂₂ψ) = ρF₁
/// ρ Dv₂/Dt − sin φ sin 2ψ ∂₁p + (1 + sin φ cos 2ψ) ∂₂p − 2q (cos 2ψ ∂₁ψ + sin 2ψ ∂₂ψ) = ρF₂
/// ```
/// with `q = p sin φ + c cos φ` and the body force F per unit mass. The uniform rotational stress has zero divergence.
pub fn write_momentum(
    system: &mut LinearisedSystem<2>,
    columns: &UnknownColumns,
    coulomb: &MohrCoulomb,
    flow: &DeformingFlow,
) {
    let density = Rounded::from_rounded(flow.density);
    let sin_phi = Rounded::from_angle(coulomb.friction_angle).sin();
    let [s2, c2] = sin_cos_twice_stress_angle(flow);
    let (sin_s2, sin_c2) = (sin_phi * s2, sin_phi * c2);
    let twice_q = 2.0 * flow.stress.deviator;
    let [p1, p2] = flow.pressure_gradient.map(Rounded::from_rounded);
    let [a1, a2] = flow.stress_angle_gradient.map(Rounded::from_angle);
    let UnknownColumns { velocity, pressure, stress_angle: angle, .. } = *columns;

    system.b[0][(0, pressure)] = Rounded::ONE - sin_c2;
    system.b[1][(0, pressure)] = -sin_s2;
    system.b[0][(0, angle)] = twice_q * s2;
    system.b[1][(0, angle)] = -(twice_q * c2);
    system.b[0][(1, pressure)] = -sin_s2;
    system.b[1][(1, pressure)] = Rounded::ONE + sin_c2;
    system.b[0][(1, angle)] = -(twice_q * c2);
    system.b[1][(1, angle)] = -(twice_q * s2);

    // Derivatives of the coefficients above with respect to p and ψ, times the background gradients; ∂q/∂p = sin φ.
    let (sine_gradient, cosine_gradient) = (s2 * a1 - c2 * a2, c2 * a1 + s2 * a2);
    system.c[(0, pressure)] = 2.0 * (sin_phi * sine_gradient);
    system.c[(1, pressure)] = -(2.0 * (sin_phi * cosine_gradient));
    system.c[(0, angle)] = 2.0 * (sin_s2 * p1 - sin_c2 * p2) + 2.0 * (twice_q * cosine_gradient);
    system.c[(1, angle)] = -(2.0 * (sin_c2 * p1 + sin_s2 * p2)) + 2.0 * (twice_q * sine_gradient);

    for i in 0..2 {
        system.a[(i, velocity[i])] = density;
        for (column, gradient) in velocity.into_iter().zip(flow.velocity_gradient[i]) {
            system.c[(i, column)] = density * gradient;
        }
        if let Some(column) = columns.density {
            system.c[(i, column)] = flow.acceleration[i];
        }
    }
}

/// Writes the linearisation of the balance of mass, `Dρ/Dt + ρ ∇·v = 0`, into `row`; writes nothing for ν = 0.
pub fn write_mass(
    system: &mut LinearisedSystem<2>,
    row: usize,
    columns: &UnknownColumns,
    flow: &DeformingFlow,
) {
    let Some(density) = columns.density else { return };
    system.a[(row, density)] = Rounded::ONE;
    system.c[(row, density)] = flow.velocity_gradient[0][0] + flow.velocity_gradient[1][1];
    for j in 0..2 {
        system.b[j][(row, columns.velocity[j])] = Rounded::from_rounded(flow.density);
        system.c[(row, columns.velocity[j])] = Rounded::from_rounded(flow.density_gradient[j]);
    }
}

/// Writes the linearisation of both equations of [`FlowRule`] into the rows `row` (volume) and `row + 1` (rotation),
/// without the term 2 e_r ω of the material rotation, which the caller adds:
///
/// ```text
/// e_v tr d − s_v [(d₁₁ − d₂₂) cos 2ψ + 2 d₁₂ sin 2ψ] = 0
/// 2 e_r ω + e_r (∂₂v₁ − ∂₁v₂) − c_r [(d₁₁ − d₂₂) sin 2ψ − 2 d₁₂ cos 2ψ] = 0
/// ```
pub fn write_flow_rule(
    system: &mut LinearisedSystem<2>,
    row: usize,
    columns: &UnknownColumns,
    rule: &FlowRule,
    flow: &DeformingFlow,
) {
    let [s2, c2] = sin_cos_twice_stress_angle(flow);
    let [v1, v2] = columns.velocity;
    let (volume, rotation) = (row, row + 1);

    system.b[0][(volume, v1)] = rule.volume_coefficient - rule.dilatancy_coefficient * c2;
    system.b[1][(volume, v1)] = -(rule.dilatancy_coefficient * s2);
    system.b[0][(volume, v2)] = -(rule.dilatancy_coefficient * s2);
    system.b[1][(volume, v2)] = rule.volume_coefficient + rule.dilatancy_coefficient * c2;

    system.b[0][(rotation, v1)] = -(rule.shear_coefficient * s2);
    system.b[1][(rotation, v1)] = rule.rotation_coefficient + rule.shear_coefficient * c2;
    system.b[0][(rotation, v2)] = -rule.rotation_coefficient + rule.shear_coefficient * c2;
    system.b[1][(rotation, v2)] = rule.shear_coefficient * s2;

    // With D₁₁ − D₂₂ = 2 Q_D cos 2Ψ_D, 2 D₁₂ = 2 Q_D sin 2Ψ_D and Δ = Ψ_D − Ψ_Σ the derivatives of the square brackets
    // with respect to ψ are 4 Q_D sin 2Δ and 4 Q_D cos 2Δ.
    let twice_delta = 2.0 * flow.rounded_noncoaxiality();
    let rate = 4.0 * Rounded::from_rounded(flow.shear_rate);
    system.c[(volume, columns.stress_angle)] =
        -(rule.dilatancy_coefficient * rate * twice_delta.sin());
    system.c[(rotation, columns.stress_angle)] =
        -(rule.shear_coefficient * rate * twice_delta.cos());
}
