//! Tests of time-domain simulations without files: same values as in the files of the program, and early ends.

use files::npz::{Values, read};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use wellposed::Error;
use wellposed::case::Case;
use wellposed::cli::Options;
use wellposed::cli::{self, Control};
use wellposed::report;
use wellposed::study::simulate::{Fields, RunResult, Settings, Table};
use wellposed::study::unwatched;

/// Plane of two yielding media, loaded on one boundary.
const SOLID: &str = "
title = 'Two media'
[model]
kind = 'classical'
lambda = 1.2e8
mu = 8e7
density = 1900
[yield]
kind = 'von-mises'
strength = 1e4
[grid]
cells = [24, 16]
spacing = 0.5
[time]
duration = 0.04
[[region]]
shape = 'half-plane'
point = [6, 0]
normal = [1, 0]
model = { mu = 4e7 }
[[region]]
shape = 'rest'
[[load]]
side = 'x2+'
field = 'sigma22'
amplitude = -3e4
time = { kind = 'step' }
[[receiver]]
at = [3.1, 4.2]
[[receiver]]
name = 'deep'
at = [8, 1]
fields = ['v1', 'u2']
[output]
snapshot_interval = 0.013
integrals = ['u2']
";

/// Flow with a receiver and snapshots.
fn flow() -> Case {
    let sets = [
        "grid.cells=[64, 64]",
        "time.duration=2e-4",
        "output.snapshot_interval=1e-4",
        "output.ledger_interval=1e-5",
    ];
    wellposed::load("cases/flow/decay.toml", &sets).expect("a shipped case")
}

fn solid() -> Case {
    Case::parse(SOLID, "solid.toml", &[]).expect("a sound case")
}

fn simulated(case: &Case) -> RunResult {
    wellposed::simulate(case, Settings::default(), &unwatched).expect("a sound case")
}

/// Runs the program, which writes the files of a case to `out`.
fn written(case: &Case, out: &Path) {
    let file = out.with_extension("toml");
    fs::write(&file, case.to_toml()).expect("a scratch file");
    let options = Options { case: file, out: Some(out.to_owned()), ..Options::default() };
    cli::run(&options, Control { checkpoint_every: 1e9 }, &mut Vec::new()).expect("a sound case");
}

fn assert_is_table(table: &Table, path: &Path) {
    let text = fs::read_to_string(path).expect("a table");
    let mut lines = text.lines();
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(lines.next().expect("a header"), names.join(","));
    let mut rows = 0;
    for (row, line) in lines.enumerate() {
        let numbers = line.split(',').map(|cell| cell.parse::<f64>().expect("a number"));
        assert!(numbers.eq(table.columns.iter().map(|column| column.values[row])), "{line}");
        rows += 1;
    }
    assert!(rows > 2 && table.columns.iter().all(|column| column.values.len() == rows));
}

fn assert_is_archive(fields: &Fields, path: &Path) {
    let arrays = read(&fs::read(path).expect("an archive")).expect("an archive");
    let of = |name: &str| arrays.iter().find(|array| array.name == name).expect("an array");
    for (axis, along) in fields.coordinates.iter().enumerate() {
        assert_eq!(of(&format!("x{}", axis + 1)).values, Values::F64(along.clone()));
    }
    assert_eq!(of("time").values, Values::F64(vec![fields.time]));
    let names = fields.quantities.iter().map(|own| own.name.clone()).collect();
    assert_eq!(of("names").values, Values::Text(names));
    let units = fields.quantities.iter().map(|own| own.unit.to_owned()).collect();
    assert_eq!(of("units").values, Values::Text(units));
    for own in &fields.quantities {
        assert_eq!(of(&own.name).values, Values::F64(own.values.clone()), "{}", own.name);
    }
}

#[test]
fn values_are_those_of_the_files() {
    for case in [solid(), flow()] {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let out = folder.path().join("out");
        written(&case, &out);
        let found = simulated(&case);
        assert!(found.stopped.is_none() && found.steps > 1);

        let json = fs::read_to_string(out.join("run.json")).expect("a report");
        assert_eq!(format!("{:#}\n", report::json(&found).expect("JSON")), json);
        assert!(json.starts_with("{\n  \"schema\": 1,\n  \"title\""), "{json}");
        assert_is_archive(&found.fields, &out.join("fields.npz"));
        assert_is_table(&found.records.ledger, &out.join("ledger.csv"));
        let receivers = found.records.receivers.as_ref().expect("receivers");
        assert_is_table(receivers, &out.join("receivers.csv"));
        if let Some(spectrum) = &found.records.spectrum {
            assert_is_table(spectrum, &out.join("spectrum.csv"));
        }
        let list = fs::read_to_string(out.join("snapshots.pvd")).expect("a list");
        let names = files::vti::collected(&list);
        assert_eq!(names.len(), found.records.snapshots.len());
        for (name, snapshot) in names.iter().zip(&found.records.snapshots) {
            let image = fs::read(out.join(name)).expect("a snapshot");
            assert_eq!(report::run::image(&case, snapshot).expect("an image").bytes(), image);
        }
        assert_eq!(found.records.snapshots.last(), Some(&found.fields));
        // The last row of the ledger is the final state.
        for column in &found.records.ledger.columns[1..] {
            assert_eq!(found.ledger.get(&column.name), column.values.last().copied());
        }
        assert_eq!(found.records.ledger.get("time").and_then(<[f64]>::last), Some(&found.time));
    }
}

#[test]
fn units_stand_beside_names() {
    let found = simulated(&solid());
    let receivers = found.records.receivers.expect("receivers");
    let unit = |name: &str| {
        receivers.columns.iter().find(|column| column.name == name).map(|column| column.unit)
    };
    assert_eq!(unit("time"), Some("s"));
    assert_eq!(unit("r1.sigma12"), Some("Pa"));
    assert_eq!(unit("deep.u2"), Some("m"));
    assert!(found.records.ledger.columns[1..].iter().all(|column| column.unit == "J/m"));
    assert!(found.fields.dissipation.iter().any(|dissipated| *dissipated > 0.0));
    assert!(found.fields.regions.contains(&0) && found.fields.regions.contains(&1));
    let power = simulated(&flow()).records.ledger.columns.pop().expect("columns");
    assert_eq!((power.name.as_str(), power.unit), ("power", "W/m3"));
}

#[test]
fn threads_change_no_bit() {
    for case in [solid(), flow()] {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| simulated(&case))
        });
        assert!(one.fields == two.fields && one.records == two.records);
    }
}

#[test]
fn progress_is_told_and_ends_a_run() {
    for case in [solid(), flow()] {
        let told = Mutex::new(Vec::new());
        let progress = |done, all| {
            told.lock().expect("a lock").push((done, all));
            if done < 500 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let error = wellposed::simulate(&case, Settings::default(), &progress).unwrap_err();
        assert!(matches!(error, Error::Cancelled), "{error}");
        let told = told.into_inner().expect("a lock");
        assert!(told.len() > 1 && told[0] == (0, 1000), "{told:?}");
        let (last, before) = told.split_last().expect("calls");
        assert!(last.0 >= 500 && before.iter().all(|own| own.0 < 500 && own.1 == 1000));
    }
}

#[test]
fn ill_posed_flows_run_where_they_are_accepted() {
    let sets = ["grid.cells=[64, 64]", "time.duration=1e-5"];
    let file = "cases/flow/plastic-potential-in-time.toml";
    let case = wellposed::load(file, &sets).expect("a shipped case");
    let error = wellposed::simulate(&case, Settings::default(), &unwatched).unwrap_err();
    assert!(matches!(error, Error::IllPosed(_)), "{error}");
    let accepted = Settings { accept_ill_posed: true };
    let found = wellposed::simulate(&case, accepted, &unwatched).expect("accepted");
    assert!(found.time > 0.0);
}

/// Verifies that a case without a grid is refused.
#[test]
fn cases_of_states_are_refused() {
    let case = wellposed::load("cases/cosserat/forbidden-band.toml", wellposed::NO_SETTINGS)
        .expect("a shipped case");
    let error = wellposed::simulate(&case, Settings::default(), &unwatched).unwrap_err();
    assert!(matches!(error, Error::Case(_)) && error.to_string().contains("grid"), "{error}");
}

/// A simulation stopped by its own state returns a result with the cause.
#[test]
fn a_run_that_stops_is_a_result() {
    let sets = ["load[0].amplitude=-1e300".to_owned()];
    let case = Case::parse(SOLID, "solid.toml", &sets).expect("a sound case");
    let found = simulated(&case);
    let stopped = found.stopped.as_ref().expect("not finite");
    assert!(stopped.time > stopped.saved && stopped.saved == found.time, "{stopped}");
    let json = report::json(&found).expect("JSON");
    assert_eq!(json["stopped"], stopped.to_string());
    assert!(found.fields.quantities.iter().flat_map(|own| &own.values).all(|v| v.is_finite()));
}
