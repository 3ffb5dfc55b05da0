//! Runs with default settings against exact solutions, at twenty cells to the wavelength.

mod reference;

use reference::PROBLEMS;
use reference::run::Settings;
use std::path::Path;

/// Greatest L2 error of a component up to three wavelengths away, by problem: bounds on gross faults. `benches/accuracy.rs`
/// prints all errors on three grids.
const BOUNDS: [(&str, f64); 7] = [
    ("lamb-vertical", 0.30),
    ("lamb-horizontal", 0.30),
    ("garvin", 0.20),
    ("inside-force", 0.20),
    ("inside-explosion", 0.10),
    ("oblique-p", 0.15),
    ("oblique-s", 0.30),
];

#[test]
fn twenty_cells_to_the_wavelength() {
    let program = Path::new(env!("CARGO_BIN_EXE_wellposed"));
    let mut faults = Vec::new();
    for (name, bound) in BOUNDS {
        let problem = PROBLEMS.iter().find(|problem| problem.name == name).expect("a problem");
        for row in (problem.rows)(&Settings::new(program, 20.0)) {
            println!("{name} {} at {:.2}: {:?}", row.name, row.distance, row.error);
            if row.error.l2.is_nan() || row.error.l2 > bound {
                faults.push(format!("{name} {}: {:?}, at most {bound}", row.name, row.error));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
