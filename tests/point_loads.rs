//! Tests of point sources and point loads: against the exact wave of a plane source at any position in a cell, and
//! reduced models with planes of symmetry against the complete model; conditions of sides against those of all their faces.

use crate::support;

use std::collections::HashMap;
use std::f64::consts::PI;
use support::{create_run_options, read_arrays_by_name, run_case};

const MODEL_SECTION: &str = "[model]\nkind='classical'\nlambda=1e8\nmu=1e8\ndensity=3000\n";
/// Pressure wave speed √((λ + 2μ)/ρ), m/s.
const PRESSURE_SPEED: f64 = 316.227_766_016_837_94;

/// Runs a case and returns the arrays of a result file by name.
fn run_and_read_arrays(case: &str, file: &str) -> HashMap<String, Vec<f64>> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    run_case(&create_run_options(folder.path(), case)).expect("a sound case");
    read_arrays_by_name(&folder.path().join("out").join(file))
}

/// Verifies a force per area F f(t) across a strip against the exact velocity F f(t − |x − x₀|/c)/(2ρc). At Courant
/// number 1 propagation along the strip is exact; the error of source and receiver is of second order at any position
/// in a cell, since sources act once per step. A force on one cell has more than twice the error.
#[test]
fn plane_source_converges_at_second_order_at_any_position() {
    let frequency = 20.0;
    let wavelength = PRESSURE_SPEED / frequency;
    let error = |cells: usize, offset: f64, kernel: &str| {
        let h = wavelength / cells as f64;
        let length = 16 * cells;
        let (at, receiver) = (7.0 * wavelength + offset * h, 9.0 * wavelength + 0.71 * offset * h);
        let case = format!(
            "{MODEL_SECTION}[grid]\ncells=[{length}, 1]\nspacing={h:?}\n[time]\nduration={:?}\ncourant=1\n\
             [[boundary]]\nside='x2-'\nkind='periodic'\n[[boundary]]\nside='x2+'\nkind='periodic'\n\
             [[source]]\nkind='force'\namplitude=[{:?}, 0]\nat=[{at:?}, 0]\n{kernel}\n\
             time={{kind='ricker', frequency={frequency}}}\n\
             [[receiver]]\nname='r'\nat=[{receiver:?}, 0]\nfields=['v1']\n",
            5.5 / frequency,
            h * 2.0 * 3000.0 * PRESSURE_SPEED,
        );
        let found = run_and_read_arrays(&case, "receivers.npz");
        let ricker = |t: f64| {
            let a = (PI * (frequency * t - 1.5)).powi(2);
            (1.0 - 2.0 * a) * (-a).exp()
        };
        let exact = found["time"].iter().map(|t| {
            let t = t - (receiver - at) / PRESSURE_SPEED;
            if t > 0.0 { ricker(t) } else { 0.0 }
        });
        let (mut error, mut norm) = (0.0, 0.0);
        for (exact, found) in exact.zip(&found["r.v1"]) {
            error += (exact - found).powi(2);
            norm += exact * exact;
        }
        (error / norm).sqrt()
    };
    let mut coarse_error = 0.0;
    for offset in [0.0, 0.3, 0.86] {
        let errors = [20, 40].map(|cells| error(cells, offset, ""));
        println!("{offset}: {errors:?}");
        assert!((errors[0] / errors[1]).log2() > 1.8, "{offset}: {errors:?}");
        coarse_error = errors[0];
    }
    assert!(error(20, 0.86, "kernel='cell'") > 2.0 * coarse_error);
}

/// Verifies that a condition and a velocity load of a whole side act as those of all its faces, given one by one, and that a
/// condition of a whole side replaces earlier ones of its faces.
#[test]
fn sides_move_like_all_their_faces() {
    let run = |sides: &str| {
        run_and_read_arrays(
            &format!(
                "{MODEL_SECTION}[grid]\ncells=[12, 9]\nspacing=0.5\n[time]\nduration=0.025\n{sides}"
            ),
            "fields.npz",
        )
    };
    let (all, some) = ("from=-1.0\nto=10.0\n", "from=1.0\nto=2.0\n");
    let fixed = |area: &str| format!("[[boundary]]\nside='x1+'\nkind='fixed'\n{area}");
    let push = |area: &str| {
        format!(
            "[[load]]\nside='x1-'\nfield='v1'\namplitude=0.1\n{area}time={{kind='pulse', duration=0.02}}\n"
        )
    };
    let open = "[[boundary]]\nside='x1+'\nkind='non-reflecting'\n";
    let expected = run(&(fixed(all) + &push(all)));
    let different = run(&(fixed(some) + &push(some)));
    let free = run(&push(all));
    for sides in [
        fixed("") + &push(""),
        fixed(all) + &push(""),
        open.to_owned() + &fixed(some) + &fixed("") + &push(all),
    ] {
        let found = run(&sides);
        for name in ["v1", "v2", "sigma11", "sigma12", "sigma22"] {
            assert!(found[name] == expected[name], "{name}: {sides}");
        }
    }
    assert!(different["v1"] != expected["v1"] && free["v1"] != expected["v1"]);
    // A fixed side reflects a pulse with the opposite velocity: behind it the side does not move.
    let last = expected["v1"].iter().skip(11).step_by(12);
    let moved = free["v1"].iter().skip(11).step_by(12);
    let greatest =
        |values: &mut dyn Iterator<Item = &f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
    assert!(greatest(&mut last.clone()) < 0.5 * greatest(&mut moved.clone()));
}

/// Verifies sources on planes of symmetry: half and quarter models move like the complete model with the same
/// sections; sources next to a plane move like the complete model with their image.
#[test]
fn symmetric_submodels_move_like_complete_model() {
    let time = "time={kind='ricker', frequency=60}";
    let model = |cells: [usize; 2], origin: [f64; 2], sides: &str, acting: &str| {
        let case = format!(
            "{MODEL_SECTION}[grid]\ncells=[{}, {}, 6]\nspacing=0.5\norigin=[{:?}, {:?}, -3]\n\
             [time]\nduration=0.025\n{sides}{acting}",
            cells[0], cells[1], origin[0], origin[1]
        );
        run_and_read_arrays(&case, "fields.npz")
    };
    let plane = |side: &str| format!("[[boundary]]\nside='{side}'\nkind='symmetry'\n");
    for kernel in ["", "radius=1.3"] {
        let load = |at: [f64; 2], amplitude: f64| {
            format!(
                "[[load]]\nside='x3+'\nfield='sigma33'\namplitude={amplitude:?}\nat={at:?}\n{kernel}\n{time}\n"
            )
        };
        let force = |at: [f64; 3], amplitude: [f64; 3]| {
            format!(
                "[[source]]\nkind='force'\namplitude={amplitude:?}\nat={at:?}\n{kernel}\n{time}\n"
            )
        };
        let [x1, x2] = ["x1-", "x2-"].map(plane);
        // A load and a force along x₃ on the axis; next to the axis an oblique force, with its mirror images.
        let near = [0.2, 0.6, -1.4];
        let images = |signs: &[[f64; 2]]| -> String {
            signs
                .iter()
                .map(|[a, b]| force([a * near[0], b * near[1], near[2]], [a * 2e3, b * 1e3, 5e2]))
                .collect()
        };
        let whole = model(
            [12, 12],
            [-3.0, -3.0],
            "",
            &(load([0.0, 0.0], -4e3)
                + &force([0.0, 0.0, -1.0], [0.0, 0.0, 2e3])
                + &images(&[[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])),
        );
        let half = model(
            [6, 12],
            [0.0, -3.0],
            &x1,
            &(load([0.0, 0.0], -4e3)
                + &force([0.0, 0.0, -1.0], [0.0, 0.0, 2e3])
                + &images(&[[1.0, 1.0], [1.0, -1.0]])),
        );
        let quarter = model(
            [6, 6],
            [0.0, 0.0],
            &(x1 + &x2),
            &(load([0.0, 0.0], -4e3)
                + &force([0.0, 0.0, -1.0], [0.0, 0.0, 2e3])
                + &images(&[[1.0, 1.0]])),
        );
        for name in ["v1", "v2", "v3", "sigma11", "sigma12", "sigma33"] {
            let largest = whole[name].iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            assert!(largest > 0.0, "{name}");
            for (cell, value) in whole[name].iter().enumerate() {
                let [a, b, c] = [cell % 12, cell / 12 % 12, cell / 144];
                if a < 6 {
                    continue;
                }
                let found = half[name][(c * 12 + b) * 6 + a - 6];
                assert!(
                    (found - value).abs() < 1e-9 * largest,
                    "{name} of the half at {a}, {b}, {c}"
                );
                if b >= 6 {
                    let found = quarter[name][(c * 6 + b - 6) * 6 + a - 6];
                    assert!((found - value).abs() < 1e-9 * largest, "{name} of the quarter");
                }
            }
        }
    }
}

/// Verifies sources at the corner of all planes: a quarter model in two dimensions and an eighth in three, with the
/// sections of the complete model. Forces need a plane of antisymmetry normal to them.
#[test]
fn sources_at_symmetry_corners_act_as_in_complete_model() {
    let time = "time={kind='ricker', frequency=60}";
    let explosion =
        |at: &[f64]| format!("[[source]]\nkind='explosion'\namplitude=3e4\nat={at:?}\n{time}\n");
    let force = |at: &[f64]| {
        let mut amplitude = vec![0.0; at.len()];
        amplitude[0] = 2e3;
        format!("[[source]]\nkind='force'\namplitude={amplitude:?}\nat={at:?}\n{time}\n")
    };
    let solids = [
        "kind='classical'\nlambda=1e8\nmu=1e8\ndensity=3000",
        "kind='cosserat'\nlambda=1e8\nmu=1e8\nalpha=3e7\nbeta=0\ngamma=2e7\neta=1e7\ndensity=3000\ninertia=200",
    ];
    for (medium, dimensions, is_force) in
        [(0, 2, false), (0, 2, true), (1, 2, false), (0, 3, false), (0, 3, true), (1, 3, true)]
    {
        let model = |is_reduced: bool| {
            let mut case = format!(
                "[model]\n{}\n[grid]\ncells={:?}\nspacing=0.5\norigin={:?}\n[time]\nduration=0.02\n",
                solids[medium],
                vec![if is_reduced { 6 } else { 12 }; dimensions],
                vec![if is_reduced { 0.0 } else { -3.0 }; dimensions],
            );
            for axis in (1..=dimensions).filter(|_| is_reduced) {
                let kind = if is_force && axis == 1 { "antisymmetry" } else { "symmetry" };
                case += &format!("[[boundary]]\nside='x{axis}-'\nkind='{kind}'\n");
            }
            let at = vec![0.0; dimensions];
            case += &if is_force { force(&at) } else { explosion(&at) };
            run_and_read_arrays(&case, "fields.npz")
        };
        let (whole, reduced) = (model(false), model(true));
        for name in ["v1", "v2", "sigma11", "sigma12", "sigma22"] {
            let largest = whole[name].iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            assert!(largest > 0.0, "{name}");
            for (cell, found) in reduced[name].iter().enumerate() {
                let (mut rest, mut place, mut stride) = (cell, 0, 1);
                for _ in 0..dimensions {
                    place += (rest % 6 + 6) * stride;
                    rest /= 6;
                    stride *= 12;
                }
                let value = whole[name][place];
                let case = (solids[medium], dimensions, is_force);
                assert!(
                    (found - value).abs() < 1e-9 * largest,
                    "{case:?}, {name}: {found}, {value}"
                );
            }
        }
    }
}

/// Verifies that a force normal to a plane of symmetry is refused, since its image cancels it.
#[test]
fn forces_normal_to_symmetry_plane_are_refused() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let case = format!(
        "{MODEL_SECTION}[grid]\ncells=[8, 8]\nspacing=1\n[time]\nduration=0.01\n[[boundary]]\nside='x1-'\n\
         kind='symmetry'\n[[source]]\nkind='force'\namplitude=[1, 0]\nat=[0, 4]\n\
         time={{kind='pulse', duration=0.01}}\n"
    );
    let options = create_run_options(folder.path(), &case);
    let error = run_case(&options).expect_err("nothing acts").to_string();
    assert!(error.contains("source[0].at: what drives v1 is on a plane of symmetry"), "{error}");
}
