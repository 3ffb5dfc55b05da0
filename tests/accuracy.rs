//! Verifies simulations with default settings against exact solutions, with twenty cells per wavelength.

mod reference;

use reference::run::Settings;
use reference::{PROBLEMS, Row};
use std::path::Path;

/// Bounds on the relative L2 error of components up to three wavelengths from the source, by problem: 1.1 times the
/// present errors. `benches/accuracy.rs` prints all errors on three grids, also in three dimensions.
const BOUNDS: [(&str, f64); 7] = [
    ("lamb-vertical", 0.069),
    ("lamb-horizontal", 0.073),
    ("garvin", 0.053),
    ("inside-force", 0.040),
    ("inside-explosion", 0.047),
    ("oblique-p", 0.035),
    ("oblique-s", 0.137),
];

fn program() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_wellposed"))
}

fn rows(name: &str, settings: &Settings) -> Vec<Row> {
    let problem = PROBLEMS.iter().find(|problem| problem.name == name).expect("a problem");
    (problem.rows)(settings)
}

/// Runs a problem and checks the errors of all components against its bound.
fn check(name: &str) {
    let (_, bound) = BOUNDS.iter().find(|own| own.0 == name).expect("a bound");
    check_within(name, *bound, &Settings::new(program(), 20.0));
}

fn check_within(name: &str, bound: f64, settings: &Settings) {
    let mut faults = Vec::new();
    for row in rows(name, settings) {
        println!("{name} {} at {:.2}: {:?}", row.name, row.distance, row.error);
        if row.error.l2.is_nan() || row.error.l2 > bound {
            faults.push(format!("{}: {:?}", row.name, row.error));
        }
    }
    assert!(faults.is_empty(), "{name}: more than {bound} in {faults:#?}");
}

#[test]
fn lamb_vertical() {
    check("lamb-vertical");
}

/// Verifies Lamb's problem with the first axis normal to the surface, where output is completed by half a sweep.
#[test]
fn lamb_vertical_across_the_first_axis() {
    check_within(
        "lamb-vertical",
        0.076,
        &Settings { up: Some(0), ..Settings::new(program(), 20.0) },
    );
}

/// Verifies that both horizontal directions have nearly equal errors, since sweeps normal to the surface alternate
/// with sweeps along both other axes.
#[test]
fn directions_on_a_surface_in_space_are_alike() {
    let rows = rows("pekeris", &Settings::new(program(), 10.0));
    let error = |name: &str| {
        rows.iter().find(|row| row.name == name).expect("a receiver and a component").error.l2
    };
    for [one, other] in [["surface3.v1", "across3.v2"], ["surface3.v3", "across3.v3"]] {
        let (one, other) = (error(one), error(other));
        assert!((one - other).abs() < 0.01 * one, "{one} and {other}");
        assert!(one < 0.6, "{one}");
    }
}

#[test]
fn lamb_horizontal() {
    check("lamb-horizontal");
}

#[test]
fn garvin() {
    check("garvin");
}

#[test]
fn a_force_inside() {
    check("inside-force");
}

#[test]
fn an_explosion_inside() {
    check("inside-explosion");
}

#[test]
fn an_oblique_p_pulse() {
    check("oblique-p");
}

#[test]
fn an_oblique_s_pulse() {
    check("oblique-s");
}
