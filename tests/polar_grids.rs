//! Runs on polar grids: refusals, physical fields in all files, true geometry, symmetric halves.

use crate::support;

use files::vti::read_plain_values;
use std::fs;
use support::{
    column_values, create_run_options, parse_case, read_arrays_by_name, read_columns,
    replace_first, run_case,
};

/// A foam around a hole with two loaded arcs.
const CASE: &str = "
[model]
kind = 'classical'
dimensions = 2
lambda = 55.22e9
mu = 24.54e9
density = 2673

[porous]
porosity = 0.01
yield_stress = 37.8e6
contact_bulk_modulus = 4.256e9

[grid]
cells = [36, 20]
inner_radius = 0.1
outer_radius = 1

[time]
duration = 60e-6

[scheme]
ledger = 'full'

[[load]]
side = 'x2-'
field = 'sigma22'
from = -30
to = 30
amplitude = -945e6
time = { kind = 'step' }
[[load]]
side = 'x2-'
field = 'sigma22'
from = 150
to = 210
amplitude = -945e6
time = { kind = 'step' }

[[receiver]]
name = 'wall'
at = [5, 0.1225]

[output]
picture = 'sigma22'
snapshot_interval = 30e-6
";

#[test]
fn invalid_polar_grids_are_refused_with_line_key_and_remedy() {
    let source = "\n[[source]]\nat = [0, 0.5]\namplitude = [1, 0]\nkind = 'force'\ntime = { kind = 'step' }\n\n[output]";
    #[rustfmt::skip]
    let table: &[(&str, &str, &str)] = &[
        ("cells = [36, 20]", "cells = [36, 20, 4]", "15: grid.cells: found 3 axes of a polar grid; write two numbers, of cells along the angle and along the radius"),
        ("inner_radius = 0.1\n", "", "16: grid.outer_radius: found without inner_radius; add inner_radius, the other radius of a polar grid"),
        ("outer_radius = 1\n", "", "14: grid.outer_radius: missing; add outer_radius to [grid]: "),
        ("outer_radius = 1", "outer_radius = 0.1", "17: grid.outer_radius: found 0.1 with inner_radius = 0.1; outer_radius must be greater than inner_radius"),
        ("outer_radius = 1", "outer_radius = 1\nspacing = 0.1", "18: grid.spacing: found beside inner_radius; leave it out: the radii and angles_deg give the cells of a polar grid"),
        ("outer_radius = 1", "outer_radius = 1\nangles_deg = [0, 400]", "18: grid.angles_deg: found [0, 400]; the second angle must be greater than the first, by at most 360"),
        ("inner_radius = 0.1", "inner_radius = 0", "16: grid.inner_radius: found 0; expected a positive number in m"),
        ("from = -30\nto = 30", "at = 0", "28: load[0].at: found a point load on a polar grid; give from and to, the ends of an arc, instead of at"),
        ("[[load]]", "[[boundary]]\nside = 'x1-'\nkind = 'free'\n[[load]]", "26: boundary[0].side: found x1- on a polar grid of the whole circle; leave it out: "),
        ("[[load]]", "[[boundary]]\nside = 'x2-'\nkind = 'periodic'\n[[load]]", "27: boundary[0].kind: found periodic on x2-, a circle of a polar grid; expected another condition"),
        ("[[load]]", "[[region]]\nshape = 'circle'\ncenter = [0, 0.5]\nradius = 0.1\n[[load]]", "26: region[0].shape: found 'circle' on a polar grid; expected box or layer"),
        ("[output]", "[gravity]\nacceleration = [0, -9.81]\nbalanced = false\n[output]", ": gravity: found beside a polar grid; leave it out: loads on the sides drive runs on polar grids"),
        ("duration = 60e-6", "duration = 60e-6\ncourant_of = 's'", "21: time.courant_of: found beside a "),
        ("at = [5, 0.1225]", "at = [5, 0.05]", "42: receiver[0].at: found [5, 0.05], outside the grid; the grid has x1 from -90 to 270 degrees, x2 from 0.1 to 1 m"),
        ("ledger = 'full'", "splitting = 'alternating'", "23: scheme.splitting: found 'alternating'; "),
        ("\n[output]", source, "source: found beside a polar grid; "),
    ];
    for (old, new, expected) in table {
        let error = parse_case(&replace_first(CASE, old, new)).expect_err(new);
        assert!(error.contains(expected), "{new}:\n{error}\n{expected}");
    }
}

/// Verifies that files contain the physical fields: near the wall σ_rr is minus the pressure of the load, receivers
/// record the values of their cell, and the ledger is closed.
#[test]
fn files_contain_physical_fields_in_true_geometry() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    run_case(&create_run_options(folder.path(), CASE)).expect("a sound case");
    let out = folder.path().join("out");
    let arrays = read_arrays_by_name(&out.join("fields.npz"));
    let (angles, radii) = (&arrays["x1"], &arrays["x2"]);
    assert!((angles[0] + 85.0).abs() < 1e-12 && (radii[0] - 0.1225).abs() < 1e-12);
    let stress = &arrays["sigma22"];
    // The cell at 5°, in the middle of the loaded arc from −30° to 30°.
    // At r = 1.225 a the radial stress has fallen about as a²/r².
    assert!((stress[9] / -945e6 - 1.0 / 1.225f64.powi(2)).abs() < 0.1, "{}", stress[9]);
    let records = read_columns(&out.join("receivers.csv"));
    let last = *column_values(&records, "wall.sigma22").last().expect("a value");
    assert!((last / stress[9] - 1.0).abs() < 1e-12, "{last} {}", stress[9]);
    let ledger = read_columns(&out.join("ledger.csv"));
    let last = |name: &str| *column_values(&ledger, name).last().expect("a value");
    assert!(last("plastic_dissipation") > 0.01 * last("boundary_work"));
    assert!(last("residual").abs() < 1e-12 * last("boundary_work"));
    // Dissipation by cell is per volume: its integral over the annulus is the term of the ledger.
    let areas = |cell: usize| radii[cell / 36] * 10f64.to_radians() * 0.045;
    let total: f64 =
        arrays["dissipation"].iter().enumerate().map(|(cell, own)| own * areas(cell)).sum();
    assert!((total / last("plastic_dissipation") - 1.0).abs() < 1e-12, "{total}");

    // The last snapshot is a structured grid with Cartesian nodes and velocities.
    let bytes = fs::read(out.join("snapshot-00000002.vts")).expect("a snapshot");
    assert!(String::from_utf8_lossy(&bytes).contains("<StructuredGrid"));
    let velocity = read_plain_values(&bytes, "velocity [m/s]").expect("velocities");
    let (v1, v2) = (&arrays["v1"], &arrays["v2"]);
    for cell in [0, 40, 300, 719] {
        let (sin, cos) = angles[cell % 36].to_radians().sin_cos();
        let expected = [v2[cell] * cos - v1[cell] * sin, v2[cell] * sin + v1[cell] * cos];
        for axis in 0..2 {
            let size = 1e-12 * (v1[cell].abs() + v2[cell].abs());
            assert!((velocity[3 * cell + axis] - expected[axis]).abs() <= size, "{cell}");
        }
    }
    for picture in ["run.png", "dissipation.png", "animation.gif"] {
        assert!(out.join(picture).exists(), "{picture}");
    }
}

/// Verifies that a half with planes of symmetry has the fields of the whole.
#[test]
fn half_with_symmetry_equals_the_whole() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let read = |case: &str| {
        run_case(&create_run_options(folder.path(), case)).expect("a sound case");
        read_arrays_by_name(&folder.path().join("out").join("fields.npz"))
    };
    let whole = read(CASE);
    let half = replace_first(CASE, "cells = [36, 20]", "cells = [18, 20]\nangles_deg = [0, 180]");
    let half = replace_first(
        &half,
        "[scheme]",
        "[[boundary]]\nside = 'x1-'\nkind = 'symmetry'\n[[boundary]]\nside = 'x1+'\nkind = 'symmetry'\n[scheme]",
    );
    let half = read(&half);
    for name in ["v1", "v2", "sigma11", "sigma22", "sigma12", "volumetric_strain", "dissipation"] {
        let size = whole[name].iter().fold(0.0f64, |size, value| size.max(value.abs()));
        for row in 0..20 {
            for column in 0..18 {
                // The whole starts at −90°.
                let (own, other) =
                    (half[name][18 * row + column], whole[name][36 * row + 9 + column]);
                assert!((own - other).abs() < 1e-9 * size, "{name} {row} {column}: {own} {other}");
            }
        }
    }
}
