//! Tests of the public library from the view of a program that depends on no other crate.

use std::ops::ControlFlow;
use std::sync::Mutex;
use wellposed::study::check_map;
use wellposed::study::map::PointStatus;
use wellposed::study::simulate::Settings;
use wellposed::study::{MapOptions, OnProgress, unwatched};
use wellposed::{CASES, Error, NO_SETTINGS};

const FLOW: &str = "cases/granular-flow/double-shearing-against-harris-grekova.toml";
const SOLID: &str = "cases/cosserat/forbidden-band.toml";

/// Verifies that all crates are accessible through this one.
#[test]
fn no_other_dependency_is_needed() {
    let solid = wellposed::models::registry::COSSERAT;
    let law = solid.example().expect("examples are in range");
    assert_eq!(law.theory(), solid.theory);
    let medium = wellposed::dynamics::medium::Medium::new(law, 2);
    assert!(medium.greatest_speed() > 0.0);
    assert_eq!(wellposed::analysis::flows::Route::ALL.len(), 2);
    let powers = wellposed::agreement::fit::Powers::SYMMETRIC;
    assert_eq!(powers.growth.len(), 1);
    assert!(matches!(wellposed::figures::Format::Png, wellposed::figures::Format::Png));
    assert_eq!(wellposed::files::checksum(b""), wellposed::files::checksum(b""));
    let by_either: (wellposed::case::Kind, wellposed::cases::Kind) = {
        let kind = wellposed::case::Kind::from_name("cosserat").expect("a kind");
        (kind, kind)
    };
    assert_eq!(by_either.0, by_either.1);
    let (path, text) = CASES.iter().find(|own| own.0 == SOLID).expect("a shipped case");
    let shipped = wellposed::case::Case::parse(text, path, &[]).expect("a case");
    assert_eq!(shipped, wellposed::load(SOLID, NO_SETTINGS).expect("a case"));
}

#[test]
fn settings_are_any_list_of_texts() {
    let number =
        |case: Result<wellposed::case::Case, Error>| case.expect("a case").get("wave.number");
    let owned = vec!["wave.number=2".to_owned()];
    assert_eq!(number(wellposed::load(SOLID, &owned)), Some(2.0));
    assert_eq!(number(wellposed::load(SOLID, ["wave.number=3"])), Some(3.0));
    assert_eq!(number(wellposed::load(SOLID, &["wave.number=4"][..])), Some(4.0));
    assert_eq!(number(wellposed::load(SOLID, [format!("wave.number={}", 5)])), Some(5.0));
    let error = wellposed::load(SOLID, ["wave.numbr=1"]).expect_err("no such key").to_string();
    assert!(error.contains("did you mean 'number'"), "{error}");
}

/// Checks that a study reports monotonic progress up to the total, and ends whenever the callback cancels it.
fn is_watched<T: std::fmt::Debug>(name: &str, study: impl Fn(OnProgress) -> Result<T, Error>) {
    let told = Mutex::new(Vec::new());
    let answer = study(&|done, all| {
        told.lock().expect("no panic").push((done, all));
        ControlFlow::Continue(())
    });
    assert!(answer.is_ok(), "{name}: {answer:?}");
    let told = told.into_inner().expect("no panic");
    let all = told.first().expect("a step").1;
    assert!(told.iter().all(|own| own.1 == all && own.0 <= all), "{name}: {told:?}");
    assert!(told.is_sorted(), "{name}: {told:?}");
    assert_eq!(told.last().expect("a step").0, all, "{name}");
    for step in 0..told.len() {
        let calls = Mutex::new(0);
        let ended = study(&|_, _| {
            let mut calls = calls.lock().expect("no panic");
            *calls += 1;
            if *calls > step { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(matches!(ended, Err(Error::Cancelled)), "{name} at {step}: {ended:?}");
        assert_eq!(calls.into_inner().expect("no panic"), step + 1, "{name}");
    }
}

#[test]
fn short_studies_are_watched_and_cancelled() {
    let flow = wellposed::load(FLOW, NO_SETTINGS).expect("a case");
    let models = 1 + flow.compare.as_ref().expect("models to compare").len();
    assert!(models > 1);
    is_watched("point of a flow", |own| wellposed::point(&flow, own));
    // A state within yield has no curves but the same number of steps.
    let still = wellposed::load(FLOW, ["background.deviatoric_stress=1"]).expect("a case");
    is_watched("point of a rigid state", |own| wellposed::point(&still, own));
    let solid = wellposed::load(SOLID, NO_SETTINGS).expect("a case");
    is_watched("point of a solid", |own| wellposed::point(&solid, own));
    is_watched("dispersion", |own| wellposed::dispersion(&solid, own));
}

/// Verifies progress and cancellation of `check_map`, which checks every state of an invalid map.
#[test]
fn the_check_of_a_map_is_watched_and_cancelled() {
    let file = "cases/granular-flow/noncoaxiality-bound.toml";
    let settings = ["model.friction_angle_deg=30", "background.density=-1"];
    let case = wellposed::load(file, settings).expect("a case");
    let count = Mutex::new(0);
    let refused = check_map(&case, &|_, _| {
        *count.lock().expect("no panic") += 1;
        ControlFlow::Continue(())
    });
    assert!(matches!(refused, Err(Error::Case(_))), "{refused:?}");
    let map = case.required_map().expect("a map");
    assert_eq!(count.into_inner().expect("no panic"), map.x.points * map.y.points);
    let ended = check_map(&case, &|done, _| match done {
        0..5 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    });
    assert!(matches!(ended, Err(Error::Cancelled)), "{ended:?}");
    check_map(&wellposed::load(file, NO_SETTINGS).expect("a case"), &unwatched).expect("a map");
}

/// Verifies that every result serialises with `serde`, including values that reports omit.
#[test]
fn answers_serialise() {
    let to_json = |value: Result<serde_json::Value, serde_json::Error>| value.expect("a value");
    let settings = [
        "grid.cells=[32, 32]",
        "initial[0].to=6",
        "time.duration=1e-5",
        "output.snapshot_interval=1e-5",
    ];
    let case = wellposed::load("cases/flow/decay.toml", settings).expect("a case");
    let run = wellposed::simulate(&case, Settings::default(), &unwatched).expect("a run");
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
    let map = wellposed::map(&case, MapOptions::default(), &unwatched).expect("a map");
    let points = to_json(serde_json::to_value(&map.points));
    assert_eq!(points[0]["status"], map.points[0].status.name());
    assert_eq!(points[0]["route"], "model-blind");
    assert!(points[0]["speeds"]["hyperbolicity"].is_string());
    // Not-a-number is serialised as null.
    let well_posed = map.points.iter().position(|own| own.status == PointStatus::WellPosed);
    assert!(points[well_posed.expect("a well-posed state")]["order"].is_null());
    assert_eq!(to_json(serde_json::to_value(map.options))["bound"], false);

    let solid = wellposed::load(SOLID, NO_SETTINGS).expect("a case");
    let speeds = wellposed::speeds(&solid, &unwatched).expect("speeds");
    let hemisphere = to_json(serde_json::to_value(&speeds.hemisphere));
    assert!(hemisphere.is_null() || hemisphere["slowest"].is_array());
}
