//! Verifies measured against predicted rates of waves and perturbations of a uniform flow with the plastic potential.

use dynamics::flow::{Closure, Problem};
use models::flow::Model;
use models::flow::state::{Background, State};
use models::registry;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use wellposed_agreement::flows::{
    ModeResult, Perturbation, UniformFlow, fastest_mode, wave_results,
};
use wellposed_agreement::{AgreementError, PlaneWave};

/// Uniform flow whose solver has the density `density` (kg/m³); the density of the model is 1600 kg/m³.
fn flow(density: f64) -> UniformFlow {
    let friction_angle = 30f64.to_radians();
    let constants = [friction_angle, 0.0, 0.0];
    let model = Model::new(registry::PLASTIC_POTENTIAL, &constants).expect("a model");
    let state = State { density: 1600.0, pressure: 1000.0, shear_rate: 1.0, ..State::default() };
    let Background::FullyDeforming(flow) = model.background(&state).expect("a flow") else {
        panic!("a flow that deforms");
    };
    let solver = Problem {
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
        least_shear_rate: 1e-3,
    };
    UniformFlow { model, state, flow, solver }
}

const WAVE: PlaneWave<2> = PlaneWave { number: 500.0, normal: [0.6, 0.8] };

fn results(density: f64) -> Vec<ModeResult> {
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    wave_results(&flow(density), &[WAVE], &go_on).expect("results")
}

#[test]
fn waves_agree() {
    let results = results(1600.0);
    assert_eq!(results.len(), 1);
    assert_eq!(results[0].agrees(), Some(true), "{results:?}");
    let rates = flow(1600.0).initial_rates(&WAVE).expect("rates");
    assert!((rates[0].re / results[0].predicted.growth - 1.0).abs() < 0.1, "{results:?}");
}

#[test]
fn a_wrong_density_is_caught() {
    let results = results(1600.0 * (1.0 + 1e-4));
    assert_eq!(results[0].agrees(), Some(false), "{results:?}");
}

#[test]
fn a_perturbation_grows_as_predicted() {
    let points = [16; 2];
    let (length, amplitude) = (0.1, 1e-7);
    let wave = |point: usize| {
        let [i, j] = [point % 16, point / 16].map(|index| (index as f64 + 0.5) / 16.0);
        amplitude * (TAU * (3.0 * i + 4.0 * j)).cos()
    };
    let velocity = [-0.8, 0.6].map(|own| (0..256).map(|point| own * wave(point)).collect());
    let perturbation =
        Perturbation { points, lengths: [length; 2], velocity, internal_variable: vec![0.0; 256] };
    let found = fastest_mode(&flow(1600.0), &perturbation).expect("a mode");
    assert_eq!(found.mode, [3, 4]);
    assert!((found.measured / found.predicted - 1.0).abs() < 1e-2, "{found:?}");
    let short = Perturbation { internal_variable: Vec::new(), ..perturbation.clone() };
    let refused = fastest_mode(&flow(1600.0), &short);
    assert!(matches!(refused, Err(AgreementError::Points { .. })), "{refused:?}");
    let none = [vec![0.0; 256], vec![0.0; 256]];
    let refused = fastest_mode(&flow(1600.0), &Perturbation { velocity: none, ..perturbation });
    assert_eq!(refused, Err(AgreementError::NothingMoves));
}
