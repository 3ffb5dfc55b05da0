//! Runs with default settings against exact solutions, at twenty cells to the wavelength.

mod reference;

use reference::PROBLEMS;
use reference::run::Settings;
use std::path::Path;

/// Greatest L2 error of a component up to three wavelengths away, by problem: a tenth above today's errors. `benches/accuracy.rs`
/// prints all errors on three grids, and those in space.
const BOUNDS: [(&str, f64); 7] = [
    ("lamb-vertical", 0.069),
    ("lamb-horizontal", 0.073),
    ("garvin", 0.053),
    ("inside-force", 0.040),
    ("inside-explosion", 0.047),
    ("oblique-p", 0.035),
    ("oblique-s", 0.137),
];

/// Runs a problem and compares all its components.
fn check(name: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_wellposed"));
    let problem = PROBLEMS.iter().find(|problem| problem.name == name).expect("a problem");
    let (_, bound) = BOUNDS.iter().find(|own| own.0 == name).expect("a bound");
    let mut faults = Vec::new();
    for row in (problem.rows)(&Settings::new(program, 20.0)) {
        println!("{name} {} at {:.2}: {:?}", row.name, row.distance, row.error);
        if row.error.l2.is_nan() || row.error.l2 > *bound {
            faults.push(format!("{}: {:?}", row.name, row.error));
        }
    }
    assert!(faults.is_empty(), "{name}: more than {bound} in {faults:#?}");
}

#[test]
fn lamb_vertical() {
    check("lamb-vertical");
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
