//! The linearised equations and the derived background against the nonlinear equations.
//!
//! The nonlinear equations (`support/equations.rs`) are written with the tensors of Harris & Grekova (2005) and
//! differentiated automatically in arithmetic of 31 digits. A wrong sign, factor or transpose or a missing term in any
//! entry of A, B or C of any model makes these tests fail.

use crate::support::equations::{linearise, residuals};
use crate::support::states::{self, RandomCase};
use crate::support::{DoubleDouble, RandomNumbers, dd};
use std::collections::HashMap;
use testkit::flows::MODEL_CASES;
use wellposed_models::Rounded;

const STATE_COUNT: usize = 300;

/// Every entry of A, Bⁱ + Vᵢ A and C is the derivative of the nonlinear equation named by its row with respect to the
/// time derivative, the space derivative ∂ᵢ or the value of the unknown named by its column.
///
/// Tolerance: the rounding bound of the entry, which must cover the reference value (computed from the same doubles),
/// plus the rounding error of the arithmetic of 31 digits. The bound itself must be below 1e-12 of the largest value of
/// the entry in the ensemble.
#[test]
fn symbol_equals_the_derivatives_of_the_nonlinear_equations() {
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(100 + seed as u64);
        // Map from (matrix, row, column) to the largest magnitude, deviation and rounding bound of the entry.
        let mut sizes: HashMap<(usize, usize, usize), [f64; 3]> = HashMap::new();
        for _ in 0..STATE_COUNT {
            let (parameters, model, state) = states::random_case(&mut random, kind, dilatancy);
            let flow = states::complete_flow(&model, &state);
            let system = states::assemble_symbol(&model, &flow);
            let (given, fields) =
                states::solve_background_fields(&mut random, &parameters, kind, &state, &flow);
            let truth = linearise(&given, &fields);

            assert_eq!(system.velocity, state.velocity);
            let (rows, columns) =
                (states::equation_indices(&system), states::unknown_indices(&system));
            for matrix in [&system.a, &system.b[0], &system.b[1], &system.c] {
                assert_eq!(matrix.shape(), (rows.len(), columns.len()));
            }
            for (i, &row) in rows.iter().enumerate() {
                for (j, &column) in columns.iter().enumerate() {
                    let exact = |x: Rounded| (dd(x.value), x.bound);
                    let convected = |d: usize| {
                        let (a, a_bound) = exact(system.a[(i, j)]);
                        let (b, b_bound) = exact(system.b[d][(i, j)]);
                        let v = system.velocity[d];
                        (b + dd(v) * a, b_bound + v.abs() * a_bound)
                    };
                    let entries = [
                        (exact(system.a[(i, j)]), truth.a[row][column]),
                        (convected(0), truth.b[0][row][column]),
                        (convected(1), truth.b[1][row][column]),
                        (exact(system.c[(i, j)]), truth.c[row][column]),
                    ];
                    for (number, ((value, bound), truth)) in entries.into_iter().enumerate() {
                        let deviation = (value - truth).to_f64().abs();
                        let noise = 1e-25 * (1.0 + state.density * 1e3);
                        assert!(
                            deviation <= bound + noise,
                            "{kind:?} {dilatancy:?}, matrix {number} of A, B1, B2, C, \
                             {} / {}: {} but the equations say {} (bound {bound:e})",
                            system.equations[i],
                            system.unknowns[j].name,
                            value.to_f64(),
                            truth.to_f64(),
                        );
                        let size = sizes.entry((number, i, j)).or_default();
                        for (s, x) in size.iter_mut().zip([truth.to_f64().abs(), deviation, bound])
                        {
                            *s = s.max(x);
                        }
                    }
                }
            }
        }
        let mut worst = [0.0f64; 2];
        for (place, [size, deviation, bound]) in &sizes {
            // Structural zeros have a zero bound, by which the analysis recognises them.
            let structural = *size < 1e-18;
            assert!(!structural || *bound == 0.0, "{kind:?} {dilatancy:?} {place:?}: {bound:e}");
            let natural = if structural { 1.0 } else { *size };
            assert!(
                *bound <= 1e-12 * natural,
                "{kind:?} {dilatancy:?} {place:?}: bound {bound:e} against size {size:e}"
            );
            worst[0] = worst[0].max(deviation / natural);
            worst[1] = worst[1].max(bound / natural);
        }
        println!("{kind:?} {dilatancy:?}: deviation {:.1e}, bound {:.1e}", worst[0], worst[1]);
        assert!(worst[0] <= 1e-12);
    }
}

/// The derived background (velocity gradient, spin, acceleration, body moment, stress angle rate) satisfies every
/// nonlinear equation of its model.
///
/// Scale of a residual: the sum of the absolute values of (coefficient × derivative of an unknown) over all
/// derivatives, and of the source 2r in the balance of spin. Tolerance: 1e-13 of this scale, for about ten roundings of
/// doubles in the derived quantities; the residual is computed in 31 digits.
#[test]
fn derived_background_satisfies_the_nonlinear_equations() {
    let mut worst = 0.0f64;
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(200 + seed as u64);
        for number in 0..STATE_COUNT {
            let (parameters, model, mut state) = states::random_case(&mut random, kind, dilatancy);
            // In turn the default and the three admissible rotational stresses ±m and 0.
            if let Some(m) = parameters.rotational_strength {
                state.rotational_stress = [None, Some(m), Some(-m), Some(0.0)][number % 4];
            }
            let flow = states::complete_flow(&model, &state);
            let system = states::assemble_symbol(&model, &flow);
            let (given, fields) =
                states::assemble_background_fields(&mut random, &parameters, kind, &state, &flow);
            let residuals = residuals(&given, &fields);
            let derivatives = linearise(&given, &fields);
            for row in states::equation_indices(&system) {
                let mut size: f64 = (0..6)
                    .map(|u| {
                        let term = |a: DoubleDouble, b: DoubleDouble| (a * b).to_f64().abs();
                        term(derivatives.a[row][u], fields.time_derivatives[u])
                            + term(derivatives.b[0][row][u], fields.space_derivatives[0][u])
                            + term(derivatives.b[1][row][u], fields.space_derivatives[1][u])
                    })
                    .sum();
                if row == 2 {
                    size += 2.0 * flow.stress.rotational_stress.abs();
                }
                let relative = residuals[row].to_f64().abs() / size;
                worst = worst.max(relative);
                assert!(
                    relative < 1e-13,
                    "{kind:?} {dilatancy:?}: equation {} is left with {:e} of {size:e}",
                    crate::support::equations::EQUATIONS[row],
                    residuals[row].to_f64(),
                );
            }
        }
    }
    println!("largest relative residual of a background: {worst:.1e}");
}

/// The derived velocity gradient has the given magnitude Q_D and angle Ψ_D of the deviatoric deformation rate (eqs 84,
/// 85), the given half vorticity, and Δ = Ψ_D − Ψ_Σ including its sign.
#[test]
fn velocity_gradient_has_the_given_rate_angle_and_vorticity() {
    states::for_random_cases(300, STATE_COUNT, |_, case| {
        let RandomCase { kind, model, state, .. } = case;
        let flow = states::complete_flow(&model, &state);
        let g = flow.velocity_gradient.map(|row| row.map(|x| x.value));
        let (normal, shear) = (g[0][0] - g[1][1], g[0][1] + g[1][0]);
        let rate = 0.5 * normal.hypot(shear);
        let angle = 0.5 * shear.atan2(normal);
        // Angles modulo π; the tolerance allows for a few roundings of numbers of order ten.
        let wrong = (angle - state.stress_angle - state.noncoaxiality.unwrap_or(0.0)).sin();
        assert!((rate / state.shear_rate - 1.0).abs() < 1e-13);
        assert!(wrong.abs() < 1e-13, "{kind:?}: Ψ_D is off by {wrong:e}");
        let vorticity = 0.5 * (g[1][0] - g[0][1]);
        assert!((vorticity - state.half_vorticity).abs() < 1e-13);
    });
}
