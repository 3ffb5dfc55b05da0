//! Tests of `wellposed check`: predicted and measured rates agree, and disagreement is reported.

use agreement::solids::{BranchResult, SolverSettings};
use dynamics::problem::{PlasticStep, Splitting};
use serde_json::Value;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed::case::{Case, Parameter};
use wellposed::cli::{self, Error, Format, Options};
use wellposed::setup::check::solid::WavePlan;
use wellposed::study::check::Extent;
use wellposed::study::check::solid::rows;
use wellposed::study::{self, unwatched};

fn bundled(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(name)
}

fn options(file: PathBuf, sets: &[&str], out: Option<PathBuf>) -> Options {
    let sets = sets.iter().map(|set| (*set).to_owned()).collect();
    Options { case: file, sets, format: Format::Json, out, ..Options::default() }
}

/// Report printed by the verb, and its result.
fn checked(file: PathBuf, sets: &[&str]) -> (Value, Result<(), Error>) {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let mut printed = Vec::new();
    let out = folder.path().join("out");
    let ended = cli::check(&options(file, sets, Some(out.clone())), &mut printed);
    let report: Value = serde_json::from_slice(&printed).unwrap_or_default();
    if ended.is_ok() {
        assert_eq!(fs::read(out.join("check.json")).expect("a report"), printed);
        for name in ["check.png", "check.svg", "check.txt", "case.toml"] {
            assert!(out.join(name).is_file(), "{name}");
        }
    }
    (report, ended)
}

/// Norm of the relative error of a measured wave, relative to the predicted frequency.
fn off(row: &BranchResult) -> f64 {
    row.difference().expect("a measurement").max_norm()
}

/// Wave plan of a case with one medium.
fn plan(case: &Case, extent: Extent) -> WavePlan {
    WavePlan::new(case, &case.material, extent)
}

/// Plan with changed solver settings.
fn with(plan: &WavePlan, change: impl Fn(&mut SolverSettings)) -> WavePlan {
    let mut plan = plan.clone();
    change(&mut plan.settings);
    plan
}

/// Verifies all branches of every theory: relative error 10⁻⁴ in the limit of zero cell size and 1 % with 20 cells
/// per period, and the order of convergence of the scheme.
#[test]
fn elastic_waves_are_as_predicted() {
    let cases = [
        ("dynamics/lamb-2d.toml", 2),
        ("dynamics/lamb-3d.toml", 3),
        ("dynamics/driven-column.toml", 3),
        ("cosserat/forbidden-band.toml", 6),
        ("dynamics/plane-waves.toml", 3),
        ("check/cosserat-space.toml", 6),
        ("check/cubic-plane.toml", 3),
    ];
    for (name, branches) in cases {
        let case = Case::load(&bundled(name), &[]).expect("a case");
        let own = plan(&case, Extent::Short);
        let settings = &own.settings;
        assert_eq!((settings.splitting, settings.courant), (Splitting::Alternating, 0.9), "{name}");
        let two_cyclic = with(&own, |settings| {
            (settings.splitting, settings.courant) = (Splitting::TwoCyclic, 1.0);
        });
        let of = |plan| rows(&case.material, &case.material, plan, &unwatched).expect("a solver");
        let (first, second) = (of(&own), of(&two_cyclic));
        assert_eq!(first.len(), branches * own.waves.len(), "{name}");
        for row in first.into_iter().chain(second) {
            let of = format!("{name} {} at {:?}", row.branch, own.waves[row.wave]);
            assert_eq!(row.agrees(), Some(true), "{of}: {row:?}");
            assert!(off(&row) < 1e-4, "{of}: {:?}", row.difference());
            let measured = row.measured.as_ref().expect("a measurement");
            assert!(row.relative(measured.grids[0].measured).max_norm() < 1e-2, "{of}");
            // Errors of sweeps are of order h⁴, errors of splitting of order h², with either sign: where they cancel
            // on one of the grids the fitted order is arbitrary. Torsion without couple stress along an axis only
            // rotates, and is exact up to rounding.
            let is_exact = row.branch.starts_with("torsion") && off(&row) < 1e-12;
            let order = row.order();
            assert!(order.map_or(is_exact, |own| own > 1.5), "{of}: {order:?}");
        }
    }
}

#[test]
fn loading_and_unloading_waves_are_as_predicted() {
    for name in
        ["check/slipping-layers.toml", "check/yielding-cone.toml", "check/yielding-plane.toml"]
    {
        let case = Case::load(&bundled(name), &[]).expect("a case");
        let own = plan(&case, Extent::Short);
        // With return mapping, of first order, the error of the limit is larger.
        let two_cyclic = with(&own, |settings| settings.splitting = Splitting::TwoCyclic);
        let second =
            with(&two_cyclic, |settings| settings.plastic_step = PlasticStep::MidpointReflection);
        let of = |plan: &WavePlan, most: f64| {
            let all = rows(&case.material, &case.material, plan, &unwatched).expect("a solver");
            for row in &all {
                assert_eq!(row.agrees(), Some(true), "{name}: {row:?}");
                assert!(off(row) < most, "{name}: {row:?}");
            }
            all
        };
        of(&second, 1e-3);
        if name.contains("plane") {
            of(&two_cyclic, 1e-2);
        }
        let rows = of(&own, 1e-2);
        // Wave speeds during loading interlace with the elastic ones from below.
        let of = |name: &str| -> f64 {
            rows.iter().filter(|row| row.response.name() == name).map(|row| row.predicted).sum()
        };
        assert!(of("loading") < 0.999 * of("unloading"), "{name}");
    }
}

/// Verifies the speed √((λ + μ)/ρ) of a loading pressure wave in plane strain, and √((λ + 2μ)/ρ) of an unloading one.
#[test]
fn speeds_of_a_yielding_metal() {
    let case = Case::load(&bundled("check/yielding-plane.toml"), &[]).expect("a case");
    // Midpoint reflection, whose limit of three grids is as accurate.
    let plan = with(&plan(&case, Extent::Short), |settings| {
        (settings.plastic_step, settings.splitting) =
            (PlasticStep::MidpointReflection, Splitting::TwoCyclic);
    });
    let rows = rows(&case.material, &case.material, &plan, &unwatched).expect("a solver");
    for (response, modulus) in [("unloading", 2.32e11), ("loading", 1.52e11)] {
        let speed = (modulus / 7815.0f64).sqrt();
        let row = rows
            .iter()
            .find(|row| {
                let wave = plan.waves[row.wave];
                row.response.name() == response && wave.direction_deg == 0.0
            })
            .expect("a pressure wave");
        let limit = row.measured.as_ref().expect("a measurement").limit;
        let measured = limit.measured.frequency / plan.waves[row.wave].number;
        assert!((measured / speed - 1.0).abs() < 1e-6, "{response}: {measured} for {speed}");
    }
}

/// Verifies that a solver with a different modulus than the analysis is detected, for every modulus and on every
/// grid.
#[test]
fn a_wrong_modulus_is_caught() {
    let case = Case::load(&bundled("dynamics/plane-waves.toml"), &[]).expect("a case");
    let plan = plan(&case, Extent::Short);
    for name in ["lambda", "mu", "alpha", "gamma", "eta", "density", "inertia"] {
        let parameter = Parameter::find(&format!("model.{name}")).expect("a number");
        let mut other = case.clone();
        other.set(
            parameter,
            parameter.get(&case.material.numbers).expect("a number") * (1.0 + 1e-9),
        );
        let rows = rows(&case.material, &other.material, &plan, &unwatched).expect("a solver");
        assert!(rows.iter().any(|row| row.agrees() == Some(false)), "{name}");
        assert!(rows.iter().all(|row| off(row) < 1e-4), "{name}");
    }
}

/// Verifies that a solver with slightly different friction and dilatancy than the analysis is detected.
#[test]
fn a_wrong_yield_set_is_caught() {
    let file = bundled("check/slipping-layers.toml");
    let case = Case::load(&file, &[]).expect("a case");
    let sets = ["yield.shear_friction=0.601", "yield.shear_dilatancy=0.601"].map(str::to_owned);
    let other = Case::load(&file, &sets).expect("a case");
    let rows = rows(&case.material, &other.material, &plan(&case, Extent::Short), &unwatched)
        .expect("a solver");
    for row in rows.iter().filter(|row| row.response.name() == "unloading") {
        assert_eq!(row.agrees(), Some(true), "{row:?}");
    }
    assert!(rows.iter().any(|row| row.agrees() == Some(false)));
}

#[test]
fn the_report_has_the_forbidden_band() {
    let sets = ["check.numbers=[0.3, 2.6]", "check.directions_deg=[25]", "model.dimensions=2"];
    let (report, ended) = checked(bundled("cosserat/forbidden-band.toml"), &sets);
    ended.expect("agreement");
    assert_eq!(report["agrees"], true);
    let medium = &report["media"][0];
    assert_eq!(medium["rows"].as_array().expect("rows").len(), 6);
    let band = &medium["forbidden_bands"][0];
    let at = |value: &Value| value.as_f64().expect("a number");
    let natural = (4.0 * 1.005e9 / 2700.0f64).sqrt();
    assert!((at(&band["to"]) / natural - 1.0).abs() < 1e-9);
    assert!(at(&band["nearest"][0]) <= at(&band["from"]));
    assert!(at(&band["nearest"][1]) >= at(&band["to"]));
    let first = &medium["rows"][0];
    let ratio = at(&first["limit"]["frequency"]) / at(&first["predicted"]["frequency"]);
    assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
}

/// Verifies cases that cannot be measured: exit code 0, and the reason in the report, in the text and in the plot.
#[test]
fn what_has_no_solver_is_not_measurable() {
    let cases: [(&str, &[&str], &str); 5] = [
        ("granular-flow/characteristic-directions.toml", &[], "model.dilatancy_angle_deg"),
        (
            "granular-flow/noncoaxiality-bound.toml",
            &["background.pressure_gradient=[1, 0]"],
            "gradient",
        ),
        ("granular-flow/plastic-potential.toml", &["model.dilatancy_angle_deg=5"], "dilatancy"),
        ("cosserat/flutter.toml", &[], "yield.shear_dilatancy"),
        ("check/yielding-cone.toml", &["yield.plastic_rate=0.1"], "yield.plastic_rate"),
    ];
    for (name, sets, key) in cases {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let mut printed = Vec::new();
        let out = folder.path().join("out");
        cli::check(&options(bundled(name), sets, Some(out.clone())), &mut printed)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(fs::read(out.join("check.json")).expect("a report"), printed);
        let report: Value = serde_json::from_slice(&printed).expect("a report");
        let reason = report["not_measurable"].as_str().expect("a reason");
        assert!(reason.contains(key) && reason.contains("analysis alone"), "{reason}");
        assert!(report["agrees"].is_null());
        let drawn = fs::read_to_string(out.join("check.svg")).expect("a picture");
        assert!(drawn.contains("not measurable: ") && out.join("check.png").is_file(), "{name}");
        let words = fs::read_to_string(out.join("check.txt")).expect("words");
        assert!(words.contains(&format!("not measurable: {reason}")), "{words}");
    }
}

/// Verifies that a wave which exceeds the number of stages is measured with shorter steps.
#[test]
fn stiff_waves_are_measured() {
    let sets = ["check.numbers=[16000]", "check.directions_deg=[0]"];
    let (report, ended) = checked(bundled("granular-flow/noncoaxiality-bound.toml"), &sets);
    ended.expect("agreement");
    let rows = report["rows"].as_array().expect("rows");
    assert!(rows.iter().all(|row| row["agrees"] == true && row["not_measurable"].is_null()));
}

/// Verifies that a wave for which longer steps fail is measured with shorter steps.
#[test]
fn waves_of_flows_that_turn_fast_are_measured() {
    for vorticity in [20, -20] {
        let vorticity = format!("background.half_vorticity={vorticity}");
        let sets = [&vorticity, "check.numbers=[1000]", "check.directions_deg=[30, 105]"];
        let (report, ended) = checked(bundled("granular-flow/noncoaxiality-bound.toml"), &sets);
        ended.unwrap_or_else(|error| panic!("{error}: {report:#}"));
        assert_eq!(report["agrees"], true);
    }
}

/// Verifies the reason for a missing measurement: rounding errors of the fastest decay dominate such short waves.
#[test]
fn a_wave_without_measurement_says_why() {
    let sets = ["check.numbers=[1e9]", "check.directions_deg=[0]"];
    let (report, ended) = checked(bundled("granular-flow/noncoaxiality-bound.toml"), &sets);
    ended.expect("no disagreement");
    let rows = report["rows"].as_array().expect("rows");
    let reasons = || rows.iter().filter_map(|row| row["not_measurable"].as_str());
    assert!(reasons().all(|own| own.contains("the solver stops")), "{report:#}");
    assert!(reasons().count() > 0, "{report:#}");
    for row in rows {
        assert_eq!(row["limit"].is_null(), row["not_measurable"].is_string());
        assert_eq!(row["agrees"].is_null(), row["not_measurable"].is_string());
    }
}

/// Verifies waves in double shearing with rotating stress axes: ψ̇ = −49 rad/s, with Q_D = 1/s.
#[test]
fn waves_of_turning_stress_axes_are_as_predicted() {
    let sets = [
        "model.friction_angle_deg=24",
        "background.noncoaxiality_deg=16",
        "background.half_vorticity=-9",
    ];
    let (report, ended) = checked(bundled("flow/double-shearing.toml"), &sets);
    ended.unwrap_or_else(|error| panic!("{error}: {report:#}"));
    let rows = report["rows"].as_array().expect("rows");
    assert!(rows.len() >= 12);
    assert!(rows.iter().all(|row| row["agrees"] == true));
}

/// Verifies waves in the model of Harris & Grekova with a time-dependent spin, which changes Δ.
#[test]
fn waves_of_a_changing_spin_are_as_predicted() {
    let sets = [
        "background.spin_acceleration=0.5",
        "check.numbers=[1000]",
        "check.directions_deg=[30, 105]",
    ];
    let (report, ended) = checked(bundled("granular-flow/noncoaxiality-bound.toml"), &sets);
    ended.unwrap_or_else(|error| panic!("{error}: {report:#}"));
}

#[test]
fn numbers_that_overflow_are_located() {
    for set in [
        "background.pressure=1e200",
        "background.shear_rate=1e160",
        "wave.number=1e155",
        "check.numbers=[1e155]",
        "model.moment_of_inertia=1e-200",
        "background.density=1e300",
    ] {
        let (_, ended) = checked(bundled("granular-flow/noncoaxiality-bound.toml"), &[set]);
        let error = ended.expect_err(set);
        let (words, key) = (error.to_string(), set.split('=').next().expect("a key"));
        assert_eq!(error.exit_code(), 2, "{words}");
        assert!(words.contains(key) && words.contains("1e60"), "{set}: {words}");
    }
}

#[test]
fn wrong_sections_are_located() {
    let wrong = [
        ("check.numbers=[]", "wave numbers"),
        ("check.numbers=[-1]", "wave numbers"),
        ("check.directions_deg=['a']", "degrees"),
        ("check.cells=[20, 10]", "ascending"),
        ("check.cells=[20]", "two to 5"),
        ("check.cells=[4, 8]", "at least 8"),
        ("check.cell=[20, 30]", "cells"),
        // Too many steps: the natural rotation is much faster than such a wave.
        ("check.numbers=[2e-6]", "cell-updates"),
    ];
    for (set, words) in wrong {
        let (_, ended) = checked(bundled("dynamics/plane-waves.toml"), &[set]);
        let error = ended.expect_err(set);
        assert_eq!(error.exit_code(), 2, "{set}");
        assert!(error.to_string().contains(words), "{set}: {error}");
    }
}

#[test]
fn wrong_grids_of_flows_are_located() {
    let case = "check/grid-dependence.toml";
    let wrong: [(&str, &[&str], &str); 3] = [
        (case, &["check.cells=[65, 129]"], "even numbers"),
        (case, &["initial[0].field=w"], "which all of them have"),
        ("granular-flow/noncoaxiality-bound.toml", &["check.cells=[64, 128]"], "[[initial]]"),
    ];
    for (name, sets, words) in wrong {
        let (_, ended) = checked(bundled(name), sets);
        let error = ended.expect_err(words);
        assert_eq!(error.exit_code(), 2, "{words}");
        assert!(error.to_string().contains(words), "{words}: {error}");
    }
}

/// Verifies that cases in nested folders are checked; those without solver are listed and do not affect the exit
/// code.
#[test]
fn a_folder_is_walked() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    fs::create_dir(folder.path().join("inside")).expect("a folder");
    for (from, to) in [
        ("dynamics/plane-waves.toml", "inside/waves.toml"),
        ("cosserat/flutter.toml", "flutter.toml"),
        ("granular-flow/plastic-potential.toml", "flow.toml"),
    ] {
        fs::copy(bundled(from), folder.path().join(to)).expect("a copy");
    }
    let mut printed = Vec::new();
    cli::check(&options(folder.path().to_owned(), &[], None), &mut printed).expect("agreement");
    let report: Value = serde_json::from_slice(&printed).expect("a report");
    assert_eq!(report["schema"], 1);
    let cases = report["cases"].as_array().expect("cases");
    let left: Vec<bool> = cases.iter().map(|own| own["not_measurable"].is_string()).collect();
    assert_eq!(left, [true, true, false]);
    assert_eq!(cases[2]["agrees"], true);
    assert_eq!(cases[2]["waves"], 6);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let bits = [1, 3].map(|threads| {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let mut printed = Vec::new();
        let out = Some(folder.path().join("out"));
        let own = options(bundled("check/cubic-plane.toml"), &[], out);
        cli::check(&Options { threads: Some(threads), ..own }, &mut printed).expect("agreement");
        printed
    });
    assert_eq!(bits[0], bits[1]);
}

/// Verifies waves advected by the mean flow in the models of Harris & Grekova (inside and outside the bound), of
/// double shearing and of the plastic potential: error 10⁻⁴ relative to the rate or the shear rate; the difference
/// from the frozen rate remains of the order of the shear rate while the rate grows.
#[test]
fn waves_in_flows_are_as_predicted() {
    for (name, order) in [
        ("granular-flow/noncoaxiality-bound.toml", 2),
        ("flow/outside-the-bound.toml", 2),
        ("flow/double-shearing.toml", 1),
        ("flow/plastic-potential-in-time.toml", 2),
    ] {
        let sets = ["check.numbers=[500, 2000]", "check.directions_deg=[20, 105]"];
        let (report, ended) = checked(bundled(name), &sets);
        ended.unwrap_or_else(|error| panic!("{name}: {error}"));
        let number = |value: &Value| value.as_f64().expect("a number");
        let rate = |value: &Value| number(&value["growth_rate"]).hypot(number(&value["frequency"]));
        let case = Case::load(&bundled(name), &[]).expect("a case");
        let shear_rate = case.get("background.shear_rate").expect("a shear rate");
        let rows = report["rows"].as_array().expect("rows");
        for row in rows {
            let [limit, predicted] = ["limit", "predicted"].map(|own| &row[own]);
            let difference = (number(&limit["growth_rate"]) - number(&predicted["growth_rate"]))
                .hypot(number(&limit["frequency"]) - number(&predicted["frequency"]));
            let scale = rate(predicted).max(shear_rate);
            assert!(difference < 1e-4 * scale, "{name}: {row}");
            let frozen =
                (number(&row["frozen"]["growth_rate"]) - number(&predicted["growth_rate"])).abs();
            assert!(frozen < 20.0 * shear_rate, "{name}: {row}");
        }
        // Order from wave numbers with ratio 4 in the same direction.
        let fastest = |k: f64| {
            let own = |row: &&Value| number(&row["wave"]["number"]) == k;
            rows.iter().filter(own).map(|row| rate(&row["predicted"])).fold(0.0, f64::max)
        };
        let found = (fastest(2000.0) / fastest(500.0)).ln() / 4f64.ln();
        assert!((found - f64::from(order)).abs() < 0.15, "{name}: order {found}");
    }
}

/// Verifies one perturbation under grid refinement: rates of the fastest waves as predicted, orders 2 and 1, and no
/// order with an intrinsic spin.
#[test]
fn finer_grids_make_of_a_perturbation_what_is_predicted() {
    let sets = ["check.cells=[16, 32, 64]", "check.numbers=[500]", "check.directions_deg=[20]"];
    let (report, ended) = checked(bundled("check/grid-dependence.toml"), &sets);
    ended.unwrap();
    let all = report["refinements"].as_array().expect("refinements");
    let names: Vec<&str> = all.iter().map(|own| own["model"].as_str().expect("a name")).collect();
    assert_eq!(names, ["harris-grekova", "double-shearing", "plastic-potential"]);
    for (own, order) in all.iter().zip([0.0, 1.0, 2.0]) {
        assert_eq!(own["limit_of_the_order"], order);
        let orders = &own["orders"];
        if order == 0.0 {
            assert!(orders.is_null());
            continue;
        }
        for which in ["predicted", "measured"] {
            let found = orders[which].as_f64().expect("an order");
            assert!((found - order).abs() < 0.1, "{own}");
        }
    }
}

/// Verifies that studies report all their steps and end when cancelled.
#[test]
fn progress_is_told_and_cancels() {
    type Study = fn(&Case, study::OnProgress) -> Result<(), wellposed::Error>;
    let check: Study =
        |case, on_progress| wellposed::check(case, Extent::Short, on_progress).map(drop);
    let speeds: Study = |case, on_progress| wellposed::speeds(case, on_progress).map(drop);
    for (name, study) in [
        ("check/cubic-plane.toml", check),
        ("granular-flow/noncoaxiality-bound.toml", check),
        ("dynamics/lamb-3d.toml", speeds),
    ] {
        let case = Case::load(&bundled(name), &[]).expect("a case");
        let (calls, steps) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let counted = |done: usize, all: usize| {
            calls.fetch_add(1, Ordering::Relaxed);
            steps.store(all, Ordering::Relaxed);
            assert!(done <= all, "{name}: {done} of {all}");
            ControlFlow::Continue(())
        };
        study(&case, &counted).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(calls.into_inner(), steps.into_inner() + 1, "{name}");
        for last in [0, 1] {
            let stopped = |done: usize, _: usize| match done < last {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            };
            let ended = study(&case, &stopped);
            assert!(matches!(ended, Err(wellposed::Error::Cancelled)), "{name}: {ended:?}");
        }
    }
}
