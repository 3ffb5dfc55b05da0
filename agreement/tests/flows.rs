//! Verifies measured against predicted rates of waves and perturbations of a uniform flow with the plastic potential.

use dynamics::flow::{Closure, FlowProblem};
use models::flow::Model;
use models::flow::state::{Background, MaterialState};
use models::registry;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed_agreement::flows::{
    ModeResult, Perturbation, UniformFlow, compare_fastest_mode, compare_waves,
};
use wellposed_agreement::{AgreementError, PlaneWave};

/// Uniform flow whose solver has the density `density` (kg/m³); the density of the model is 1600 kg/m³.
fn uniform_flow(density: f64) -> UniformFlow {
    let friction_angle = 30f64.to_radians();
    let constants = [friction_angle, 0.0, 0.0];
    let model = Model::new(registry::PLASTIC_POTENTIAL, &constants).expect("a model");
    let state = MaterialState {
        density: 1600.0,
        pressure: 1000.0,
        shear_rate: 1.0,
        ..MaterialState::default()
    };
    let Background::FullyDeforming(flow) = model.background(&state).expect("a flow") else {
        panic!("a flow that deforms");
    };
    let solver = FlowProblem {
        closure: Closure::PlasticPotential,
        density,
        friction_angle,
        rotation_ratio: 0.0,
        cohesion: 0.0,
        pressure: state.pressure,
        velocity_gradient: flow.velocity_gradient.map(|row| row.map(|entry| entry.value)),
        stress_angle: flow.stress.angle,
        spin: 0.0,
        spin_acceleration: 0.0,
        points: [4; 2],
        lengths: [1.0; 2],
        tolerance: 1e-5,
        pressure_tolerance: 1e-9,
        min_shear_rate: 1e-3,
    };
    UniformFlow { model, state, flow, solver_problem: solver }
}

const WAVE: PlaneWave<2> = PlaneWave { wave_number: 500.0, normal: [0.6, 0.8] };

fn go_on(_done: usize, _all: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn compare_with_solver_density(density: f64) -> Vec<ModeResult> {
    compare_waves(&uniform_flow(density), &[WAVE], &go_on).expect("results")
}

#[test]
fn measured_rate_agrees_with_prediction() {
    let results = compare_with_solver_density(1600.0);
    assert_eq!(results.len(), 1);
    assert_eq!(results[0].is_within_tolerance(), Some(true), "{results:?}");
    let rates = uniform_flow(1600.0).initial_rates(&WAVE).expect("rates");
    assert!((rates[0].re / results[0].predicted_rate.growth_rate - 1.0).abs() < 0.1, "{results:?}");
}

#[test]
fn wrong_solver_density_is_detected() {
    let results = compare_with_solver_density(1600.0 * (1.0 + 1e-4));
    assert_eq!(results[0].is_within_tolerance(), Some(false), "{results:?}");
}

/// Perturbation that is a single wave of mode numbers 3 and 4, on a grid of 16 × 16 points.
fn wave_perturbation() -> Perturbation {
    let amplitude = 1e-7;
    let wave = |point: usize| {
        let [i, j] = [point % 16, point / 16].map(|index| (index as f64 + 0.5) / 16.0);
        amplitude * (TAU * (3.0 * i + 4.0 * j)).cos()
    };
    Perturbation {
        points: [16; 2],
        lengths: [0.1; 2],
        velocity: [-0.8, 0.6].map(|own| (0..256).map(|point| own * wave(point)).collect()),
        internal_variable: vec![0.0; 256],
    }
}

#[test]
fn perturbation_grows_at_predicted_rate() {
    let flow = uniform_flow(1600.0);
    let perturbation = wave_perturbation();
    let found = compare_fastest_mode(&flow, &perturbation, &go_on).expect("a mode");
    assert_eq!(found.mode, [3, 4]);
    assert!((found.measured_growth / found.predicted_growth - 1.0).abs() < 1e-2, "{found:?}");
    let short = Perturbation { internal_variable: Vec::new(), ..perturbation.clone() };
    let refused = compare_fastest_mode(&flow, &short, &go_on);
    assert!(matches!(refused, Err(AgreementError::PointCount { .. })), "{refused:?}");
    let none = Perturbation { velocity: [vec![0.0; 256], vec![0.0; 256]], ..perturbation };
    let refused = compare_fastest_mode(&flow, &none, &go_on);
    assert_eq!(refused, Err(AgreementError::NoVelocity));
}

/// Verifies that the progress of a measurement is reported for each evaluation of the right-hand side, up to the end,
/// and that a measurement can be cancelled at any time.
#[test]
fn each_evaluation_of_a_measurement_reports_progress() {
    let (flow, perturbation) = (uniform_flow(1600.0), wave_perturbation());
    let calls = Mutex::new(Vec::new());
    let record = |done: usize, all: usize| {
        calls.lock().expect("no panic").push([done, all]);
        ControlFlow::Continue(())
    };
    compare_fastest_mode(&flow, &perturbation, &record).expect("a mode");
    let calls = calls.into_inner().expect("no panic");
    assert!(calls.iter().all(|own| own[1] == 1000) && calls.is_sorted(), "{calls:?}");
    assert_eq!(calls.last(), Some(&[1000, 1000]));
    // At least one step between two of the 9 samples, with several evaluations each; no call advances by more.
    assert!(calls.len() > 64, "{} calls", calls.len());
    let greatest = calls.windows(2).map(|pair| pair[1][0] - pair[0][0]).max();
    assert!(greatest <= Some(1 + 900 / 8), "{greatest:?}");
    for limit in [1, 10, calls.len() / 2, calls.len()] {
        let count = AtomicUsize::new(0);
        let cancel = |_: usize, _: usize| match count.fetch_add(1, Ordering::Relaxed) + 1 {
            found if found >= limit => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let result = compare_fastest_mode(&flow, &perturbation, &cancel);
        assert_eq!(result, Err(AgreementError::Cancelled), "{limit}");
        assert_eq!(count.into_inner(), limit);
    }
}
