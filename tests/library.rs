//! Tests of the public library from the view of a program that depends on no other crate.

use std::ops::ControlFlow;
use std::sync::Mutex;
use wellposed::study::check_map;
use wellposed::study::map::PointStatus;
use wellposed::study::simulate::SimulationSettings;
use wellposed::study::{MapOptions, ProgressCallback, ignore_progress};
use wellposed::{CASES, Error, NO_SETTINGS};

const FLOW_CASE_PATH: &str = "cases/granular-flow/double-shearing-against-harris-grekova.toml";
const SOLID_CASE_PATH: &str = "cases/cosserat/forbidden-band.toml";

/// Verifies that all crates are accessible through the crate `wellposed`.
#[test]
fn all_crates_are_reexported() {
    let solid = wellposed::models::registry::COSSERAT;
    let law = solid.build_example_law().expect("examples are in range");
    assert_eq!(law.theory(), solid.theory);
    let medium = wellposed::dynamics::medium::Medium::new(law, 2);
    assert!(medium.max_speed() > 0.0);
    assert_eq!(wellposed::analysis::flows::Route::ALL.len(), 2);
    let powers = wellposed::agreement::fit::ErrorExponents::SYMMETRIC;
    assert_eq!(powers.growth_rate.len(), 1);
    assert!(matches!(wellposed::figures::FigureFormat::Png, wellposed::figures::FigureFormat::Png));
    assert_eq!(wellposed::files::checksum(b""), wellposed::files::checksum(b""));
    let by_either: (wellposed::case::ModelKind, wellposed::cases::ModelKind) = {
        let kind = wellposed::case::ModelKind::from_name("cosserat").expect("a kind");
        (kind, kind)
    };
    assert_eq!(by_either.0, by_either.1);
    let (path, text) = CASES.iter().find(|case| case.0 == SOLID_CASE_PATH).expect("a shipped case");
    let shipped = wellposed::case::Case::parse(text, path, &[]).expect("a case");
    assert_eq!(shipped, wellposed::load(SOLID_CASE_PATH, NO_SETTINGS).expect("a case"));
}

#[test]
fn settings_accept_any_list_of_strings() {
    let number =
        |case: Result<wellposed::case::Case, Error>| case.expect("a case").number("wave.number");
    let owned = vec!["wave.number=2".to_owned()];
    assert_eq!(number(wellposed::load(SOLID_CASE_PATH, &owned)), Some(2.0));
    assert_eq!(number(wellposed::load(SOLID_CASE_PATH, ["wave.number=3"])), Some(3.0));
    assert_eq!(number(wellposed::load(SOLID_CASE_PATH, &["wave.number=4"][..])), Some(4.0));
    assert_eq!(number(wellposed::load(SOLID_CASE_PATH, [format!("wave.number={}", 5)])), Some(5.0));
    let error =
        wellposed::load(SOLID_CASE_PATH, ["wave.numbr=1"]).expect_err("no such key").to_string();
    assert!(error.contains("did you mean 'number'"), "{error}");
}

/// Checks that a study reports monotonic progress up to the total, and ends whenever the callback cancels it.
fn check_progress_and_cancellation<T: std::fmt::Debug>(
    name: &str,
    study: impl Fn(ProgressCallback) -> Result<T, Error>,
) {
    let calls = Mutex::new(Vec::new());
    let result = study(&|done, total| {
        calls.lock().expect("no panic").push((done, total));
        ControlFlow::Continue(())
    });
    assert!(result.is_ok(), "{name}: {result:?}");
    let calls = calls.into_inner().expect("no panic");
    let total = calls.first().expect("a step").1;
    assert!(calls.iter().all(|call| call.1 == total && call.0 <= total), "{name}: {calls:?}");
    assert!(calls.is_sorted(), "{name}: {calls:?}");
    assert_eq!(calls.last().expect("a step").0, total, "{name}");
    for step in 0..calls.len() {
        let calls = Mutex::new(0);
        let result = study(&|_, _| {
            let mut calls = calls.lock().expect("no panic");
            *calls += 1;
            if *calls > step { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(matches!(result, Err(Error::Cancelled)), "{name} at {step}: {result:?}");
        assert_eq!(calls.into_inner().expect("no panic"), step + 1, "{name}");
    }
}

#[test]
fn short_studies_report_progress_and_can_be_cancelled() {
    let flow = wellposed::load(FLOW_CASE_PATH, NO_SETTINGS).expect("a case");
    let models = 1 + flow.compared_kinds.as_ref().expect("models to compare").len();
    assert!(models > 1);
    check_progress_and_cancellation("point of a flow", |on_progress| {
        wellposed::analyse_point(&flow, on_progress)
    });
    // A state inside the yield set has no growth curves but the same number of steps.
    let rigid =
        wellposed::load(FLOW_CASE_PATH, ["background.deviatoric_stress=1"]).expect("a case");
    check_progress_and_cancellation("point of a rigid state", |on_progress| {
        wellposed::analyse_point(&rigid, on_progress)
    });
    let solid = wellposed::load(SOLID_CASE_PATH, NO_SETTINGS).expect("a case");
    check_progress_and_cancellation("point of a solid", |on_progress| {
        wellposed::analyse_point(&solid, on_progress)
    });
    check_progress_and_cancellation("dispersion", |on_progress| {
        wellposed::compute_dispersion(&solid, on_progress)
    });
}

/// Verifies that the search for the boundaries of a map is part of its progress.
#[test]
fn map_progress_includes_its_boundaries() {
    let settings = ["map.x.points=9", "map.y.points=2"];
    let case =
        wellposed::load("cases/granular-flow/noncoaxiality-bound.toml", settings).expect("a case");
    let compute = |on_progress: ProgressCallback| {
        wellposed::compute_map(&case, MapOptions::default(), on_progress)
    };
    check_progress_and_cancellation("map", compute);
    let after_points = Mutex::new(None);
    compute(&|done, total| {
        after_points.lock().expect("no panic").get_or_insert([done, total]);
        ControlFlow::Continue(())
    })
    .expect("a map");
    let [points, total] = after_points.into_inner().expect("no panic").expect("a step");
    assert!(points == 18 && total > 18, "{points} of {total}");
}

/// Verifies progress and cancellation of `check_map`, which checks every state of an invalid map.
#[test]
fn map_check_reports_progress_and_can_be_cancelled() {
    let file = "cases/granular-flow/noncoaxiality-bound.toml";
    let settings = ["model.friction_angle_deg=30", "background.density=-1"];
    let case = wellposed::load(file, settings).expect("a case");
    let count = Mutex::new(0);
    let refused = check_map(&case, &|_, _| {
        *count.lock().expect("no panic") += 1;
        ControlFlow::Continue(())
    });
    assert!(matches!(refused, Err(Error::Case(_))), "{refused:?}");
    let map = case.require_map().expect("a map");
    assert_eq!(count.into_inner().expect("no panic"), map.x.point_count * map.y.point_count);
    let result = check_map(&case, &|done, _| match done {
        0..5 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    });
    assert!(matches!(result, Err(Error::Cancelled)), "{result:?}");
    check_map(&wellposed::load(file, NO_SETTINGS).expect("a case"), &ignore_progress)
        .expect("a map");
}

/// Verifies that every result serialises with `serde`, including values that reports omit.
#[test]
fn study_results_serialise() {
    let to_json = |value: Result<serde_json::Value, serde_json::Error>| value.expect("a value");
    let settings = [
        "grid.cells=[32, 32]",
        "initial[0].to=6",
        "time.duration=1e-5",
        "output.snapshot_interval=1e-5",
    ];
    let case = wellposed::load("cases/flow/decay.toml", settings).expect("a case");
    let run =
        wellposed::simulate(&case, SimulationSettings::default(), &ignore_progress).expect("a run");
    let fields = to_json(serde_json::to_value(&run.fields));
    assert_eq!(fields["quantities"][0]["name"], "v1");
    assert_eq!(fields["quantities"][0]["values"].as_array().map(Vec::len), Some(32 * 32));
    let records = to_json(serde_json::to_value(&run.records));
    assert_eq!(records["snapshots"].as_array().map(Vec::len), Some(2));
    let ledger = to_json(serde_json::to_value(&run.records.ledger));
    assert_eq!(ledger["columns"][0]["name"], "time");
    assert!(to_json(serde_json::to_value(&run)).is_object());

    let settings = ["map.x.points=3", "map.y.points=3"];
    let case = wellposed::load("cases/cosserat/flutter.toml", settings).expect("a case");
    let map =
        wellposed::compute_map(&case, MapOptions::default(), &ignore_progress).expect("a map");
    let points = to_json(serde_json::to_value(&map.points));
    assert_eq!(points[0]["status"], map.points.get(0).status.name());
    assert_eq!(points[0]["route"], "model-blind");
    assert!(points[0]["speeds"]["hyperbolicity"].is_string());
    // Not-a-number is serialised as null.
    let well_posed = map.points.iter().position(|point| point.status == PointStatus::WellPosed);
    assert!(points[well_posed.expect("a well-posed state")]["order"].is_null());
    assert_eq!(to_json(serde_json::to_value(map.options))["bound"], false);

    let solid = wellposed::load(SOLID_CASE_PATH, NO_SETTINGS).expect("a case");
    let speeds = wellposed::compute_speeds(&solid, &ignore_progress).expect("speeds");
    let hemisphere = to_json(serde_json::to_value(&speeds.hemisphere));
    assert!(hemisphere.is_null() || hemisphere["slowest"].is_array());
}
