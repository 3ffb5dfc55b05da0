//! Tests of interpolation at receivers between cells, of lines and grids of receivers, and of snapshots between
//! steps: against exact initial states and against the values of adjacent cells and steps.

use crate::support;

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use support::{
    Columns, column_values, create_run_options, format_periodic_boundaries, read_columns, run_case,
};
use wellposed::cli::Options;

/// Runs a case with a number of threads.
fn run_with_threads(folder: &Path, case: &str, threads: usize) {
    let options = Options { thread_count: Some(threads), ..create_run_options(folder, case) };
    run_case(&options).expect("a sound case");
}

/// Reads the receiver table of a run.
fn read_receivers(folder: &Path) -> Columns {
    read_columns(&folder.join("out/receivers.csv"))
}

/// Verifies fourth-order interpolation of a smooth initial state at any position: inside, on boundaries, in corners,
/// and next to periodic boundaries.
#[test]
fn receivers_interpolate_with_fourth_order() {
    let points =
        [[3.3, 2.71], [0.0, 2.2], [6.0, 4.0], [0.0, 0.0], [2.0, 4.0], [5.99, 0.013], [1.234, 3.9]];
    let receivers: String =
        points.iter().map(|at| format!("[[receiver]]\nat = {at:?}\nfields = ['v1']\n")).collect();
    for boundaries in [String::new(), format_periodic_boundaries(&["x1-", "x1+"])] {
        let errors = [60, 120].map(|cells: usize| {
            let folder = tempfile::tempdir().expect("a scratch folder");
            let h = 6.0 / cells as f64;
            let case = format!(
                "[model]\nkind='classical'\nlambda=1.2e8\nmu=8e7\ndensity=1900\n[grid]\n\
                 cells=[{cells}, {}]\nspacing={h:?}\n[time]\nduration=1e-6\n[[initial]]\n\
                 kind='pulse'\nfield='v1'\namplitude=1\nat=[2.5, 2.9]\nradius=1.5\n{boundaries}{receivers}",
                cells * 2 / 3
            );
            run_with_threads(folder.path(), &case, 1);
            let records = read_receivers(folder.path());
            let exact = |at: &[f64; 2]| {
                let mut x = at[0] - 2.5;
                if !boundaries.is_empty() {
                    x -= (x / 6.0).round() * 6.0;
                }
                (-(x * x + (at[1] - 2.9).powi(2)) / 2.25).exp()
            };
            let errors = points.iter().zip(&records[1..]);
            errors.map(|(at, record)| (record.1[0] - exact(at)).abs()).fold(0.0, f64::max)
        });
        println!("{errors:?}");
        // The periodic continuation of the bell has a kink half a period from its centre, at x₁ = 5.5, away from all
        // receivers; for it the bound is a coarse one.
        if boundaries.is_empty() {
            for (error, h) in errors.iter().zip([0.1f64, 0.05]) {
                // Extrapolation by half a cell from the outermost cell centres: (½·3/2·5/2·7/2)/4! h⁴ |f⁗| along one
                // axis, with |f⁗| ≤ 12/1.5⁴, and the same along the other axis times the sum of the magnitudes of the
                // weights, 6.
                let bound = 6.5625 / 24.0 * 12.0 / 1.5f64.powi(4) * 7.0 * h.powi(4);
                assert!(*error < bound, "{errors:?}: {bound}");
            }
        } else {
            assert!(errors[0] < 5e-3, "{errors:?}");
        }
    }
}

/// Verifies fourth-order interpolation of plane waves in a periodic box at points next to its boundaries.
#[test]
fn receivers_interpolate_across_periodic_boundaries() {
    let periodic = format_periodic_boundaries(&["x1-", "x1+", "x2-", "x2+"]);
    let errors = [20, 40].map(|cells: usize| {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let case = format!(
            "[model]\nkind='classical'\nlambda=1.2e8\nmu=8e7\ndensity=1900\n[grid]\n\
             cells=[{cells}, 3]\nspacing={:?}\n[time]\nduration=1e-6\n[[initial]]\n\
             kind='plane-wave'\nbranch=1\nwavelength=2\namplitude=1\n{periodic}\
             [[receiver]]\nat=[0.0, 0.05]\nfields=['v1']\n[[receiver]]\nat=[1.99, 0.01]\nfields=['v1']\n",
            2.0 / cells as f64
        );
        run_with_threads(folder.path(), &case, 1);
        let records = read_receivers(folder.path());
        let exact = [0.0, 1.99].map(|x: f64| (PI * x).cos());
        let errors = exact.iter().zip(&records[1..]);
        errors.map(|(a, b)| (a.abs() - b.1[0].abs()).abs()).fold(0.0, f64::max)
    });
    println!("{errors:?}");
    assert!(errors[0] < 1e-3 && errors[0] / errors[1] > 12.0, "{errors:?}");
}

/// Verifies that interpolation next to an interface uses cells of one medium only, so that a jump has no effect.
#[test]
fn receivers_do_not_interpolate_across_interfaces() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let case = "[model]\nkind='classical'\nlambda=1.2e8\nmu=8e7\ndensity=1900\n[grid]\n\
        cells=[20, 20]\nspacing=0.5\n[time]\nduration=1e-6\n\
        [[region]]\nshape='layer'\naxis=2\nfrom=0\nto=5\nmodel={mu=4e7}\n[[region]]\nshape='rest'\n\
        [[initial]]\nkind='uniform'\nshape='layer'\naxis=2\nfrom=0\nto=5\nfield='sigma11'\namplitude=3\n\
        [[receiver]]\nname='down'\nfrom=[1.1, 0]\nto=[9.3, 4.999]\ncount=40\nfields=['sigma11']\n\
        [[receiver]]\nname='up'\nfrom=[1.1, 5.0]\nto=[9.3, 10]\ncount=40\nfields=['sigma11']\n\
        [[receiver]]\nname='cell'\nat=[1.1, 4.9]\ninterpolation='none'\nfields=['sigma11']\n";
    run_with_threads(folder.path(), case, 1);
    let records = read_receivers(folder.path());
    assert_eq!(records.len(), 82);
    for (name, values) in &records[1..] {
        let value = values[0];
        let exact = if name.starts_with("up") { 0.0 } else { 3.0 };
        assert!((value - exact).abs() < 1e-13, "{name}: {value}");
    }
}

const YIELDING_CASE: &str = "[model]\nkind='classical'\nlambda=1.2e8\nmu=8e7\ndensity=1900\n\
    [yield]\nkind='von-mises'\nstrength=2e4\n[grid]\ncells=[24, 20]\nspacing=0.5\n[time]\nduration=0.012\n\
    [[load]]\nside='x2+'\nfield='sigma22'\nfrom=3\nto=7\namplitude=-1e5\ntime={kind='pulse', duration=0.02}\n\
    [[receiver]]\nname='cell'\nat=[5.1, 8.3]\ninterpolation='none'\n\
    [[receiver]]\nname='plane'\nfrom=[1.1, 5.2]\nto=[[11, 5.2], [1.1, 10]]\ncount=[3, 2]\n";

/// Verifies that snapshots have the requested times and are linear interpolations between the adjacent steps, that no
/// other result depends on them, and that stresses at receivers are in the yield set.
#[test]
fn snapshots_have_requested_times() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let fields = |interval: &str, threads: usize| {
        let case = format!("{YIELDING_CASE}[output]\n{interval}\n");
        run_with_threads(folder.path(), &case, threads);
        ["fields.npz", "receivers.csv"]
            .map(|name| fs::read(folder.path().join("out").join(name)).unwrap())
    };
    let without = fields("", 1);
    // The interval 7e-4 s is shorter than a step, so that several snapshots are within one step.
    for (interval, threads) in [(5e-3, 1), (7e-4, 3), (3.1e-3, 3)] {
        assert!(fields(&format!("snapshot_interval={interval}"), threads) == without);
        let records = read_receivers(folder.path());
        let (times, values) =
            (column_values(&records, "time"), column_values(&records, "cell.sigma22"));
        let cell = 16 * 24 + 10;
        let mut index = 0;
        loop {
            let path = folder.path().join(format!("out/snapshot-{index:08}.vti"));
            let Ok(image) = fs::read(path) else { break };
            let time = files::vti::read_plain_time(&image).expect("a time");
            let expected = f64::from(index) * interval;
            assert_eq!(time, expected.min(0.012));
            let found =
                files::vti::read_plain_values(&image, "sigma22 [Pa]").expect("values")[cell];
            let next = times.partition_point(|step_time| *step_time < time).max(1);
            let fraction = (time - times[next - 1]) / (times[next] - times[next - 1]);
            let exact = values[next - 1] + fraction * (values[next] - values[next - 1]);
            assert!((found - exact).abs() < 1e-6, "{time}: {found} {exact}");
            index += 1;
        }
        assert_eq!(index, (0.012 / interval).ceil() as i32 + 1);
    }
    let records = read_receivers(folder.path());
    let mut yields = false;
    for point in ["1-1", "2-1", "3-1", "1-2", "2-2", "3-2"] {
        let [a, b, c, d] = ["11", "22", "33", "12"]
            .map(|name| column_values(&records, &format!("plane-{point}.sigma{name}")));
        for index in 0..a.len() {
            let mean = (a[index] + b[index] + c[index]) / 3.0;
            let normal = [a[index], b[index], c[index]].map(|stress| (stress - mean).powi(2));
            let shear = (0.5 * normal.iter().sum::<f64>() + d[index].powi(2)).sqrt();
            assert!(shear <= 2e4 * (1.0 + 1e-12), "{point}: {shear}");
            yields |= shear > 2e4 * (1.0 - 1e-9);
        }
    }
    assert!(yields);
}

/// Verifies the points of lines and grids of receivers, their unique names, and messages for invalid ones.
#[test]
fn receiver_lines_and_grids_have_expected_points_and_names() {
    let grid = "[model]\nkind='classical'\nlambda=1.2e8\nmu=8e7\ndensity=1900\n[grid]\ncells=[8, 8]\n\
        spacing=0.3\n[time]\nduration=0.01\n";
    let parse = |text: &str| {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let file = folder.path().join("case.toml");
        fs::write(&file, format!("{grid}{text}")).expect("a scratch file");
        wellposed::case::Case::load_simulation(&file, &[]).map_err(|error| error.to_string())
    };
    let case = parse(
        "[[receiver]]\nname='a'\nfrom=[0, 0.1]\nto=[2.4, 2.4]\ncount=4\n\
         [[receiver]]\nname='b'\nfrom=[0, 0]\nto=[[2.4, 0], [0, 2.4]]\ncount=[3, 2]\n",
    )
    .expect("a sound case");
    let receivers = &case.solid_run.as_ref().expect("a run").receivers;
    let names: Vec<&str> = receivers.iter().map(|receiver| receiver.name.as_str()).collect();
    let grid_names = ["b-1-1", "b-2-1", "b-3-1", "b-1-2", "b-2-2", "b-3-2"];
    assert_eq!(names, [["a-1", "a-2", "a-3", "a-4"].as_slice(), &grid_names].concat());
    assert_eq!(receivers[3].position, [2.4, 2.4]);
    assert_eq!(receivers[9].position, [2.4, 2.4]);
    assert_eq!(receivers[5].position, [1.2, 0.0]);
    // 100 × 0.29 is less than 29 in floating-point arithmetic; 29 is accepted as the end of this boundary.
    let wide =
        grid.replace("cells=[8, 8]", "cells=[100, 4]").replace("spacing=0.3", "spacing=0.29");
    let case = wellposed::case::Case::parse(
        &format!("{wide}[[receiver]]\nat=[29, 1.16]\n[[load]]\nside='x2+'\nfield='sigma22'\nat=29\namplitude=1\n\
                  time={{kind='step'}}\n"),
        "case.run.toml",
        &[],
    )
    .expect("a sound case");
    assert_eq!(case.solid_run.expect("a run").receivers[0].position[0], 0.29 * 100.0);
    for (text, expected) in [
        (
            "[[receiver]]\nat=[2.5, 0]\n",
            "receiver[0].at: found [2.5, 0], outside the grid; the grid has x1 from 0 to 2.4 m",
        ),
        ("[[receiver]]\nto=[1, 1]\n", "receiver[0].to: found without from; add from"),
        (
            "[[receiver]]\nat=[1, 1]\nfrom=[0, 0]\n",
            "receiver[0].at: found beside from; give either at (a point) or from (a line or grid of points), not both",
        ),
        (
            "[[receiver]]\nfrom=[0, 0]\nto=[1, 1]\ncount=1\n",
            "receiver[0].count: found 1; expected a whole number of at least 2",
        ),
        (
            "[[receiver]]\nfrom=[0, 0]\nto=[1, 9]\ncount=3\n",
            "receiver[0].to: found [0.5, 4.5], outside the grid",
        ),
        (
            "[[receiver]]\nfrom=[0, 0]\nto=[1, 1]\ncount=20000\n",
            "receiver[0].count: found 20000; expected at most 10000 points",
        ),
        (
            "[[receiver]]\nname='a-1'\nat=[0, 0]\n[[receiver]]\nname='a'\nfrom=[0, 0]\nto=[1, 1]\ncount=2\n",
            "found 'a-1', the name of receiver[0]",
        ),
        (
            "[[receiver]]\nat=[0, 0]\ninterpolation='linear'\n",
            "receiver[0].interpolation: found 'linear'; allowed: cubic, none",
        ),
    ] {
        let error = parse(text).expect_err("a wrong case");
        assert!(error.contains(expected), "{error}");
    }
}
