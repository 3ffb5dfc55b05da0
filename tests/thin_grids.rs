//! Thin grids: rows lie along a long axis in memory, and results do not depend on which axis that is.

use crate::support::{create_run_options, read_arrays_by_name, run_case};
use std::collections::HashMap;

/// Runs a strip of `cells` cells with a load and a source; `side`, `traction`, `force`: side of the load, its stress, and the
/// force, along the strip.
fn run_strip(cells: [usize; 2], names: [&str; 2], force: [f64; 2]) -> HashMap<String, Vec<f64>> {
    let [side, traction] = names;
    let middle = cells.map(|count| 0.31 * count as f64);
    let case = format!(
        "[model]\nkind = 'cosserat'\nlambda = 1.2e8\nmu = 8e7\ndensity = 1900\nalpha = 3e7\nbeta = 2e7\n\
         gamma = 2e7\neta = 2e7\ninertia = 300\n\
         [grid]\ncells = {cells:?}\nspacing = 1\n[time]\nduration = 0.05\n\
         [[load]]\nside = '{side}'\nfield = '{traction}'\namplitude = 1e3\n\
         time = {{ kind = 'ricker', frequency = 40 }}\n\
         [[source]]\nkind = 'force'\nat = {middle:?}\namplitude = {force:?}\n\
         time = {{ kind = 'ricker', frequency = 40 }}\n"
    );
    let folder = tempfile::tempdir().expect("a scratch folder");
    run_case(&create_run_options(folder.path(), &case)).expect("a sound case");
    read_arrays_by_name(&folder.path().join("out/fields.npz"))
}

#[test]
fn strips_along_both_axes_move_alike() {
    for across in [1, 5] {
        let along_x1 = run_strip([40, across], ["x1+", "sigma11"], [700.0, 300.0]);
        let along_x2 = run_strip([across, 40], ["x2+", "sigma22"], [300.0, 700.0]);
        let pairs = [
            ("v1", "v2", 1.0),
            ("v2", "v1", 1.0),
            ("w3", "w3", -1.0),
            ("sigma11", "sigma22", 1.0),
            ("sigma12", "sigma21", 1.0),
            ("m31", "m32", -1.0),
        ];
        for (name, mirrored, sign) in pairs {
            let expected = &along_x1[name];
            let largest = expected.iter().fold(0.0, |largest: f64, own| largest.max(own.abs()));
            assert!(largest > 0.0, "{name}");
            for (cell, value) in expected.iter().enumerate() {
                let found = sign * along_x2[mirrored][cell % 40 * across + cell / 40];
                assert!(
                    (found - value).abs() < 1e-9 * largest,
                    "{name} in cell {cell} of {across}"
                );
            }
        }
    }
}
