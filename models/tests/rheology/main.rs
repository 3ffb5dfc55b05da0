//! Rheological schemes: closed forms, optimality of steps of random trees, comparison with a conic solver, refusals.

mod closed_forms;
mod conic;
mod optimality;
mod random_trees;
mod refusals;
mod viscous;

use wellposed_models::rheology::load_path::{LoadPath, ResponsePoint};
use wellposed_models::rheology::named::{self, find_named_scheme};
use wellposed_models::rheology::scheme::{LoadControl, RheologicalScheme};

/// Builds a named scheme from its constants.
fn build(name: &str, constants: &[f64]) -> RheologicalScheme {
    let scheme = find_named_scheme(name).expect("a name");
    scheme.build(constants).expect("valid constants")
}

/// Builds every named scheme with the example values of its constants.
fn build_examples() -> Vec<RheologicalScheme> {
    let example = |scheme: &&named::NamedScheme| {
        let values: Vec<f64> = scheme.parameters.iter().map(|own| own.example_value()).collect();
        scheme.build(&values).expect("valid examples")
    };
    named::NAMED_SCHEMES.iter().map(example).collect()
}

/// Traces a path of strain or stress and checks the energy ledger at every point.
fn compute_response(
    scheme: &RheologicalScheme,
    control: LoadControl,
    points: &[[f64; 2]],
    steps: usize,
) -> Vec<ResponsePoint> {
    let path = LoadPath::new(control, points.to_vec(), steps).expect("a valid path");
    let response = scheme.compute_response(&path).expect("a response");
    assert_ledger_is_closed(scheme, &response);
    response
}

/// Asserts that the residual of the energy ledger is at most 1e-12 of the largest energy, at every point.
fn assert_ledger_is_closed(scheme: &RheologicalScheme, response: &[ResponsePoint]) {
    let mut largest: f64 = 0.0;
    for point in response {
        let state = &point.state;
        let energies = [
            state.work.abs(),
            state.stored_energy(scheme),
            state.dissipated_energy(),
            state.step_loss(),
        ];
        largest = energies.into_iter().fold(largest, f64::max);
        let residual = state.ledger_residual(scheme);
        assert!(residual.abs() <= 1e-12 * largest, "{residual:e} of {largest:e}");
        assert!(state.elements.iter().all(|own| own.dissipated_energy >= -1e-15 * largest));
    }
}

/// Asserts that two numbers differ by at most `tolerance` times `scale`.
#[track_caller]
fn assert_near(found: f64, expected: f64, scale: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * scale, "{found:e}, expected {expected:e}");
}
