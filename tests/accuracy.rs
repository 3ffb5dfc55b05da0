//! Verifies simulations with default settings against exact solutions, with twenty cells per wavelength (ten in three
//! dimensions).

use crate::reference;

use reference::comparison::ReferenceSettings;
use reference::{ComponentError, REFERENCE_PROBLEMS};
use std::path::Path;

/// Bounds on the relative L2 error of each velocity component that is not zero, at all receivers (up to three
/// wavelengths from the source, for oblique pulses from the interface), by problem: 1.1 times the largest measured
/// error. `benches/accuracy.rs` prints all errors on three grids, also in three dimensions.
const ERROR_BOUNDS: [(&str, f64); 7] = [
    ("lamb-vertical", 0.069),
    ("lamb-horizontal", 0.073),
    ("garvin", 0.053),
    ("inside-force", 0.040),
    ("inside-explosion", 0.047),
    ("oblique-p", 0.035),
    ("oblique-s", 0.137),
];

fn program_path() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_wellposed"))
}

/// Runs a problem with settings and returns the errors of the velocity components at all receivers.
fn compute_errors(name: &str, settings: &ReferenceSettings) -> Vec<ComponentError> {
    let problem =
        REFERENCE_PROBLEMS.iter().find(|problem| problem.name == name).expect("a problem");
    (problem.compute_errors)(settings)
}

/// Runs a problem and checks the errors of the velocity components at all receivers against its bound.
fn check_errors(name: &str) {
    let (_, bound) = ERROR_BOUNDS.iter().find(|(problem, _)| *problem == name).expect("a bound");
    check_errors_within(name, *bound, &ReferenceSettings::new(program_path(), 20.0));
}

fn check_errors_within(name: &str, bound: f64, settings: &ReferenceSettings) {
    let mut failures = Vec::new();
    for row in compute_errors(name, settings) {
        println!("{name} {} at {:.2}: {:?}", row.name, row.distance, row.relative_error);
        if row.relative_error.l2_error.is_nan() || row.relative_error.l2_error > bound {
            failures.push(format!("{}: {:?}", row.name, row.relative_error));
        }
    }
    assert!(failures.is_empty(), "{name}: more than {bound} in {failures:#?}");
}

#[test]
fn lamb_problem_with_vertical_force_is_within_error_bound() {
    check_errors("lamb-vertical");
}

/// Verifies Lamb's problem with the first axis normal to the surface, where the last sweep along that axis is completed
/// for output by half a sweep.
#[test]
fn lamb_problem_normal_to_first_axis_is_within_error_bound() {
    check_errors_within(
        "lamb-vertical",
        0.076,
        &ReferenceSettings {
            surface_axis: Some(0),
            ..ReferenceSettings::new(program_path(), 20.0)
        },
    );
}

/// Verifies that both horizontal directions have nearly equal errors, since sweeps normal to the surface alternate
/// with sweeps along both other axes.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn errors_along_both_surface_axes_are_nearly_equal() {
    let rows = compute_errors("pekeris", &ReferenceSettings::new(program_path(), 10.0));
    let error = |name: &str| {
        rows.iter()
            .find(|row| row.name == name)
            .expect("a receiver and a component")
            .relative_error
            .l2_error
    };
    for [first, second] in [["surface3.v1", "across3.v2"], ["surface3.v3", "across3.v3"]] {
        let (first, second) = (error(first), error(second));
        assert!((first - second).abs() < 0.01 * first, "{first} and {second}");
        assert!(first < 0.6, "{first}");
    }
}

#[test]
fn lamb_problem_with_horizontal_force_is_within_error_bound() {
    check_errors("lamb-horizontal");
}

#[test]
fn garvin_problem_is_within_error_bound() {
    check_errors("garvin");
}

#[test]
fn line_force_in_full_plane_is_within_error_bound() {
    check_errors("inside-force");
}

#[test]
fn line_explosion_in_full_plane_is_within_error_bound() {
    check_errors("inside-explosion");
}

#[test]
fn oblique_p_pulse_is_within_error_bound() {
    check_errors("oblique-p");
}

#[test]
#[ignore = "takes as long as the oblique P pulse, which always runs"]
fn oblique_s_pulse_is_within_error_bound() {
    check_errors("oblique-s");
}
