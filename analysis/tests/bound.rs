//! Tests of the supremum of the growth rate against the exact dispersion relation.

use models::common::system::{HigherTerm, Unknown};
use models::flow::Model;
use models::flow::state::{DeformingFlow, MaterialState};
use models::registry;
use models::{LinearisedSystem, Rounded};
use std::f64::consts::PI;
use testkit::flows::FlowParameters;
use wellposed_analysis::bound::{SUPREMUM_TOLERANCE, SupremumWaveNumber, locate_supremum};
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

fn build_model(friction_angle: f64) -> Model {
    let parameters = FlowParameters {
        friction_angle,
        dilatancy_angle: 0.0,
        cohesion: 30.0,
        moment_of_inertia: Some(2e-6),
        rotational_strength: Some(0.0),
    };
    parameters.build_model(registry::HARRIS_GREKOVA).unwrap()
}

fn build_pencil(model: &Model, state: &MaterialState) -> (DeformingFlow, Pencil) {
    let flow = *model.background(state).unwrap().flow().unwrap();
    let mut system = LinearisedSystem::default();
    model.write_symbol(&flow, &mut system);
    let mut pencil = Pencil::default();
    pencil.update(&system).unwrap();
    (flow, pencil)
}

/// Verifies the supremum on uniform incompressible Harris–Grekova states. With the unit wave vector ξ at the angle θ, n
/// at the angle 2Ψ − θ for the stress angle Ψ, the friction angle φ, G = ξ − sin φ n, and ⊥ for a rotation by 90°, the
/// exact dispersion relation has the root ς = −G⊥·(∇V ξ⊥)/(G·ξ) − k²r with r ≥ 0. The supremum is the maximum of the
/// first term over directions, approached as k → 0, or 0, the root of the neutral spin.
#[test]
fn supremum_of_uniform_incompressible_states_agrees_with_exact_relation() {
    for (index, phi) in [0.2f64, 0.5, 0.8, 1.1].into_iter().enumerate() {
        let i = index as f64;
        let state = MaterialState {
            density: 1300.0 + 200.0 * i,
            pressure: 700.0,
            stress_angle: 0.3 + 0.7 * i,
            shear_rate: 0.5 + i,
            half_vorticity: 0.9 - 0.5 * i,
            noncoaxiality: Some(0.2 * i - 0.25),
            velocity: [0.3, -0.8],
            ..MaterialState::default()
        };
        let model = build_model(phi);
        let (flow, pencil) = build_pencil(&model, &state);
        let assessment = assess(&pencil);
        assert_eq!(assessment.verdict, Verdict::WellPosed);
        let found = locate_supremum(&pencil, &assessment, 0.0).unwrap();

        let gradient = flow.velocity_gradient.map(|row| row.map(|x| x.value));
        let rate = |theta: f64| {
            let (sin, cos) = theta.sin_cos();
            let (n2, n1) = (2.0 * state.stress_angle - theta).sin_cos();
            let g = [cos - phi.sin() * n1, sin - phi.sin() * n2];
            let across = [-sin, cos];
            let v = gradient.map(|row| row[0] * across[0] + row[1] * across[1]);
            -(-g[1] * v[0] + g[0] * v[1]) / (g[0] * cos + g[1] * sin)
        };
        let steps = 200_000;
        let exact =
            (0..steps).map(|s| rate(PI * f64::from(s) / f64::from(steps))).fold(0.0, f64::max);
        let error = (found.growth_rate - exact).abs();
        assert!(
            error <= SUPREMUM_TOLERANCE * exact.max(state.shear_rate),
            "{} {exact}",
            found.growth_rate
        );
        assert_eq!(found.wave_number, SupremumWaveNumber::LongWaves);
    }
}

/// Verifies that for a stress angle that varies in space the frozen growth rate grows like 1/k as k → 0, next to the
/// direction of ξ in which c_G·ξ vanishes (c_G is linear in the gradient of the stress angle). A supremum over all k >
/// 0 does not exist there even for a state that is well-posed, so the search for the supremum takes a smallest wave
/// number.
#[test]
fn the_frozen_growth_rate_has_a_pole_for_long_waves() {
    let state = MaterialState {
        density: 1600.0,
        pressure: 1000.0,
        shear_rate: 1.0,
        noncoaxiality: Some(0.1),
        stress_angle_gradient: [1.0, 0.35],
        pressure_gradient: [100.0, 2000.0],
        ..MaterialState::default()
    };
    let model = build_model(0.5);
    let (flow, pencil) = build_pencil(&model, &state);
    let assessment = assess(&pencil);
    assert_eq!(assessment.verdict, Verdict::WellPosed);

    // For the stress angle Ψ = 0, c_G = 2 sin φ (−∂₂Ψ, −∂₁Ψ), so c_G·ξ = 0 at tan θ = −∂₂Ψ/∂₁Ψ.
    let pole = (-0.35f64).atan2(1.0);
    let greatest = |k: f64| {
        (-60..=60)
            .map(|s| pole + 1e-2 * k * f64::from(s))
            .flat_map(|theta| pencil.polynomial.roots(k, theta, &[]))
            .map(|root| root.re)
            .fold(0.0, f64::max)
    };
    let growth = [1e-2, 1e-3, 1e-4, 1e-5].map(greatest);
    for pair in growth.windows(2) {
        assert!(pair[1] > 8.0 * pair[0], "grows like 1/k: {growth:?}");
    }

    let least = model.gradient_wave_number(&flow);
    let found = locate_supremum(&pencil, &assessment, least).unwrap();
    assert!(found.growth_rate < growth[0], "{found:?}");
}

/// Verifies that of two peaks of nearly the same height, the lower one at a wave number of the grid and the higher one far
/// from any, the higher one is found. The growth rates of two independent equations are 4a x²/(1 + x²)² with x = k/k₀:
/// (1 − κ²/k₀²)² ς = −4a κ²/k₀², κ = ik.
#[test]
fn higher_of_two_peaks_is_found() {
    const UNKNOWNS: [Unknown; 2] = [Unknown { name: "", family: "" }; 2];
    for exponent in [-9.0f64, -7.6, -6.3, -5.1, -3.2] {
        for offset in [0.0f64, 0.25, 0.5, 0.75, 1.0, 1.5] {
            let peaks = [(0.95, 1.0), (1.0, 10f64.powf(exponent) * offset.exp())];
            let mut system = LinearisedSystem::default();
            system.reset(&UNKNOWNS, &["", ""], [0.0; 2]);
            for (row, (height, wave_number)) in peaks.into_iter().enumerate() {
                let inverse_square = f64::powi(wave_number, -2);
                let mut add = |time_power, space_powers, value| {
                    system.higher_terms.push(HigherTerm {
                        row,
                        column: row,
                        time_power,
                        space_powers,
                        coefficient: Rounded::from_rounded(value),
                    });
                };
                add(1, [0, 0], 1.0);
                for [first, second] in [[2, 0], [0, 2]] {
                    add(1, [first, second], -2.0 * inverse_square);
                    add(1, [2 * first, 2 * second], inverse_square * inverse_square);
                    add(0, [first, second], 4.0 * height * inverse_square);
                }
                add(1, [2, 2], 2.0 * inverse_square * inverse_square);
            }
            let mut pencil = Pencil::default();
            pencil.update(&system).unwrap();
            let assessment = assess(&pencil);
            assert_eq!(assessment.verdict, Verdict::WellPosed);
            let found = locate_supremum(&pencil, &assessment, 0.0).unwrap();
            let error = (found.growth_rate - 1.0).abs();
            assert!(error <= SUPREMUM_TOLERANCE, "{exponent} {offset}: {found:?}");
        }
    }
}
