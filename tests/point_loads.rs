//! Tests of point sources and point loads: against the exact wave of a plane source at any position in a cell, and
//! reduced models with planes of symmetry against the complete model.

use files::npz::{Values, read};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::fs;
use wellposed::cli::Options;
use wellposed::cli::{self, Control};

const CONTROL: Control = Control { checkpoint_every: 1e9 };
const MEDIUM: &str = "[model]\nkind='classical'\nlambda=1e8\nmu=1e8\ndensity=3000\n";
/// Pressure wave speed √((λ + 2μ)/ρ), m/s.
const SPEED: f64 = 316.227_766_016_837_94;

fn arrays(case: &str, file: &str) -> HashMap<String, Vec<f64>> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join("case.toml");
    fs::write(&path, case).expect("a scratch file");
    let out = folder.path().join("out");
    let options = Options { case: path, out: Some(out.clone()), ..Options::default() };
    cli::run(&options, CONTROL, &mut Vec::new()).expect("a sound case");
    let arrays = read(&fs::read(out.join(file)).expect("a file")).expect("arrays");
    let numbers = arrays.into_iter().filter_map(|array| match array.values {
        Values::F64(values) => Some((array.name, values)),
        _ => None,
    });
    numbers.collect()
}

/// Verifies a force per area F f(t) across a strip against the exact velocity F f(t − |x − x₀|/c)/(2ρc). At Courant
/// number 1 propagation along the strip is exact; the error of source and receiver is of second order at any position
/// in a cell, since sources act once per step. A force on one cell has more than twice the error.
#[test]
fn a_plane_source_is_where_it_is_put() {
    let frequency = 20.0;
    let wavelength = SPEED / frequency;
    let error = |cells: usize, part: f64, kernel: &str| {
        let h = wavelength / cells as f64;
        let length = 16 * cells;
        let (at, seen) = (7.0 * wavelength + part * h, 9.0 * wavelength + 0.71 * part * h);
        let case = format!(
            "{MEDIUM}[grid]\ncells=[{length}, 1]\nspacing={h:?}\n[time]\nduration={:?}\ncourant=1\n\
             [[side]]\nside='x2-'\nkind='periodic'\n[[side]]\nside='x2+'\nkind='periodic'\n\
             [[source]]\nkind='force'\namplitude=[{:?}, 0]\nat=[{at:?}, 0]\n{kernel}\n\
             time={{kind='ricker', frequency={frequency}}}\n\
             [[receiver]]\nname='r'\nat=[{seen:?}, 0]\nfields=['v1']\n",
            5.5 / frequency,
            h * 2.0 * 3000.0 * SPEED,
        );
        let found = arrays(&case, "receivers.npz");
        let ricker = |t: f64| {
            let a = (PI * (frequency * t - 1.5)).powi(2);
            (1.0 - 2.0 * a) * (-a).exp()
        };
        let exact = found["time"].iter().map(|t| {
            let t = t - (seen - at) / SPEED;
            if t > 0.0 { ricker(t) } else { 0.0 }
        });
        let (mut wrong, mut all) = (0.0, 0.0);
        for (exact, found) in exact.zip(&found["r.v1"]) {
            wrong += (exact - found).powi(2);
            all += exact * exact;
        }
        (wrong / all).sqrt()
    };
    for part in [0.0, 0.3, 0.5, 0.86] {
        let errors = [10, 20, 40].map(|cells| error(cells, part, ""));
        println!("{part}: {errors:?}; one cell {:?}", error(20, part, "kernel='cell'"));
        assert!((errors[1] / errors[2]).log2() > 1.8, "{part}: {errors:?}");
    }
    assert!(error(20, 0.86, "kernel='cell'") > 2.0 * error(20, 0.86, ""));
}

/// Verifies sources on planes of symmetry: half and quarter models move like the complete model with the same
/// sections; sources next to a plane move like the complete model with their image.
#[test]
fn parts_of_a_symmetric_model_move_as_the_whole() {
    let time = "time={kind='ricker', frequency=60}";
    let model = |cells: [usize; 2], origin: [f64; 2], sides: &str, acting: &str| {
        let case = format!(
            "{MEDIUM}[grid]\ncells=[{}, {}, 6]\nspacing=0.5\norigin=[{:?}, {:?}, -3]\n\
             [time]\nduration=0.025\n{sides}{acting}",
            cells[0], cells[1], origin[0], origin[1]
        );
        arrays(&case, "fields.npz")
    };
    let plane = |side: &str| format!("[[side]]\nside='{side}'\nkind='symmetry'\n");
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
            let most = whole[name].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            assert!(most > 0.0, "{name}");
            for (cell, value) in whole[name].iter().enumerate() {
                let [a, b, c] = [cell % 12, cell / 12 % 12, cell / 144];
                if a < 6 {
                    continue;
                }
                let found = half[name][(c * 12 + b) * 6 + a - 6];
                assert!((found - value).abs() < 1e-9 * most, "{name} of the half at {a}, {b}, {c}");
                if b >= 6 {
                    let found = quarter[name][(c * 6 + b - 6) * 6 + a - 6];
                    assert!((found - value).abs() < 1e-9 * most, "{name} of the quarter");
                }
            }
        }
    }
}

/// Verifies sources at the corner of all planes: a quarter model in two dimensions and an eighth in three, with the
/// sections of the complete model. Forces need a plane of antisymmetry normal to them.
#[test]
fn corners_of_planes_of_symmetry_take_their_part() {
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
        let model = |is_part: bool| {
            let mut case = format!(
                "[model]\n{}\n[grid]\ncells={:?}\nspacing=0.5\norigin={:?}\n[time]\nduration=0.02\n",
                solids[medium],
                vec![if is_part { 6 } else { 12 }; dimensions],
                vec![if is_part { 0.0 } else { -3.0 }; dimensions],
            );
            for axis in (1..=dimensions).filter(|_| is_part) {
                let kind = if is_force && axis == 1 { "antisymmetry" } else { "symmetry" };
                case += &format!("[[side]]\nside='x{axis}-'\nkind='{kind}'\n");
            }
            let at = vec![0.0; dimensions];
            case += &if is_force { force(&at) } else { explosion(&at) };
            arrays(&case, "fields.npz")
        };
        let (whole, part) = (model(false), model(true));
        for name in ["v1", "v2", "sigma11", "sigma12", "sigma22"] {
            let most = whole[name].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            assert!(most > 0.0, "{name}");
            for (cell, found) in part[name].iter().enumerate() {
                let (mut rest, mut place, mut stride) = (cell, 0, 1);
                for _ in 0..dimensions {
                    place += (rest % 6 + 6) * stride;
                    rest /= 6;
                    stride *= 12;
                }
                let value = whole[name][place];
                let case = (solids[medium], dimensions, is_force);
                assert!((found - value).abs() < 1e-9 * most, "{case:?}, {name}: {found}, {value}");
            }
        }
    }
}

/// Verifies that a force normal to a plane of symmetry is refused, since its image cancels it.
#[test]
fn forces_across_a_plane_of_symmetry_are_refused() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join("case.toml");
    let case = format!(
        "{MEDIUM}[grid]\ncells=[8, 8]\nspacing=1\n[time]\nduration=0.01\n[[side]]\nside='x1-'\n\
         kind='symmetry'\n[[source]]\nkind='force'\namplitude=[1, 0]\nat=[0, 4]\n\
         time={{kind='pulse', duration=0.01}}\n"
    );
    fs::write(&path, case).expect("a scratch file");
    let out = Some(folder.path().join("out"));
    let options = Options { case: path, out, ..Options::default() };
    let error = cli::run(&options, CONTROL, &mut Vec::new()).expect_err("nothing acts").to_string();
    assert!(error.contains("source[0].at: what drives v1 is on a plane of symmetry"), "{error}");
}
