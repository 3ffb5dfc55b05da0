//! Tests of time-domain simulations without files: same values as in the files of the program, and early ends.

use crate::support;

use files::npz::{ArrayValues, read_arrays};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use support::run_case;
use wellposed::Error;
use wellposed::case::Case;
use wellposed::cli::Options;
use wellposed::report;
use wellposed::study::ignore_progress;
use wellposed::study::simulate::{OutputFields, RecordTable, RunResult, SimulationSettings};

/// Plane of two yielding media, loaded on one boundary.
const SOLID_CASE: &str = include_str!("data/two-media.toml");

/// Loads a flow case with a receiver and snapshots.
fn load_flow_case() -> Case {
    let sets = [
        "grid.cells=[64, 64]",
        "time.duration=2e-4",
        "output.snapshot_interval=1e-4",
        "output.ledger_interval=1e-5",
    ];
    wellposed::load("cases/flow/decay.toml", &sets).expect("a shipped case")
}

fn parse_solid_case() -> Case {
    Case::parse(SOLID_CASE, "solid.toml", &[]).expect("a sound case")
}

fn simulate_case(case: &Case) -> RunResult {
    wellposed::simulate(case, SimulationSettings::default(), &ignore_progress)
        .expect("a sound case")
}

/// Runs the program, which writes the files of a case to `out`.
fn write_run_files(case: &Case, out: &Path) {
    let file = out.with_extension("toml");
    fs::write(&file, case.to_toml()).expect("a scratch file");
    let options =
        Options { case_path: file, output_folder: Some(out.to_owned()), ..Options::default() };
    run_case(&options).expect("a sound case");
}

/// Checks that a CSV file has the columns of a table.
fn assert_table_equals_file(table: &RecordTable, path: &Path) {
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

/// Checks that an NPZ file has the coordinates and quantities of fields.
fn assert_fields_equal_archive(fields: &OutputFields, path: &Path) {
    let arrays = read_arrays(&fs::read(path).expect("an archive")).expect("an archive");
    let array = |name: &str| arrays.iter().find(|array| array.name == name).expect("an array");
    for (axis, along) in fields.coordinates.iter().enumerate() {
        assert_eq!(array(&format!("x{}", axis + 1)).values, ArrayValues::F64(along.clone()));
    }
    assert_eq!(array("time").values, ArrayValues::F64(vec![fields.time]));
    let names = fields.quantities.iter().map(|quantity| quantity.name.clone()).collect();
    assert_eq!(array("names").values, ArrayValues::Text(names));
    let units = fields.quantities.iter().map(|quantity| quantity.unit.to_owned()).collect();
    assert_eq!(array("units").values, ArrayValues::Text(units));
    for quantity in &fields.quantities {
        assert_eq!(
            array(&quantity.name).values,
            ArrayValues::F64(quantity.values.clone()),
            "{}",
            quantity.name
        );
    }
}

#[test]
fn simulated_values_equal_written_files() {
    for case in [parse_solid_case(), load_flow_case()] {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let out = folder.path().join("out");
        write_run_files(&case, &out);
        let found = simulate_case(&case);
        assert!(found.stop_report.is_none() && found.step_count > 1);

        let json = fs::read_to_string(out.join("run.json")).expect("a report");
        assert_eq!(format!("{:#}\n", report::to_json(&found).expect("JSON")), json);
        assert!(json.starts_with("{\n  \"schema\": 1,\n  \"title\""), "{json}");
        assert_fields_equal_archive(&found.fields, &out.join("fields.npz"));
        assert_table_equals_file(&found.records.ledger, &out.join("ledger.csv"));
        let receivers = found.records.receivers.as_ref().expect("receivers");
        assert_table_equals_file(receivers, &out.join("receivers.csv"));
        if let Some(spectrum) = &found.records.spectrum {
            assert_table_equals_file(spectrum, &out.join("spectrum.csv"));
        }
        let list = fs::read_to_string(out.join("snapshots.pvd")).expect("a list");
        let names = files::vti::parse_collection(&list);
        assert_eq!(names.len(), found.records.snapshots.len());
        for (name, snapshot) in names.iter().zip(&found.records.snapshots) {
            let image = fs::read(out.join(name)).expect("a snapshot");
            assert_eq!(
                report::run::create_image(&case, snapshot).expect("an image").to_bytes(),
                image
            );
        }
        assert_eq!(found.records.snapshots.last(), Some(&found.fields));
        // The last row of the ledger is the final state.
        for column in &found.records.ledger.columns[1..] {
            assert_eq!(found.final_ledger.term(&column.name), column.values.last().copied());
        }
        assert_eq!(
            found.records.ledger.get("time").and_then(<[f64]>::last),
            Some(&found.final_time)
        );
    }
}

#[test]
fn columns_have_units() {
    let found = simulate_case(&parse_solid_case());
    let receivers = found.records.receivers.expect("receivers");
    let unit = |name: &str| {
        receivers.columns.iter().find(|column| column.name == name).map(|column| column.unit)
    };
    assert_eq!(unit("time"), Some("s"));
    assert_eq!(unit("r1.sigma12"), Some("Pa"));
    assert_eq!(unit("deep.u2"), Some("m"));
    assert!(found.records.ledger.columns[1..].iter().all(|column| column.unit == "J/m"));
    assert!(found.fields.plastic_dissipation.iter().any(|dissipated| *dissipated > 0.0));
    assert!(found.fields.region_indices.contains(&0) && found.fields.region_indices.contains(&1));
    let power = simulate_case(&load_flow_case()).records.ledger.columns.pop().expect("columns");
    assert_eq!((power.name.as_str(), power.unit), ("power", "W/m3"));
}

#[test]
fn results_are_bit_identical_for_any_number_of_threads() {
    for case in [parse_solid_case(), load_flow_case()] {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| simulate_case(&case))
        });
        assert!(one.fields == two.fields && one.records == two.records);
    }
}

#[test]
fn simulation_reports_progress_and_can_be_cancelled() {
    for case in [parse_solid_case(), load_flow_case()] {
        let calls = Mutex::new(Vec::new());
        let progress = |done, total| {
            calls.lock().expect("a lock").push((done, total));
            if done < 500 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let error =
            wellposed::simulate(&case, SimulationSettings::default(), &progress).unwrap_err();
        assert!(matches!(error, Error::Cancelled), "{error}");
        let calls = calls.into_inner().expect("a lock");
        assert!(calls.len() > 1 && calls[0] == (0, 1000), "{calls:?}");
        let (last, before) = calls.split_last().expect("calls");
        assert!(last.0 >= 500 && before.iter().all(|call| call.0 < 500 && call.1 == 1000));
    }
}

#[test]
fn ill_posed_flows_run_only_if_accepted() {
    let sets = ["grid.cells=[64, 64]", "time.duration=1e-5"];
    let file = "cases/flow/plastic-potential-in-time.toml";
    let case = wellposed::load(file, &sets).expect("a shipped case");
    let error =
        wellposed::simulate(&case, SimulationSettings::default(), &ignore_progress).unwrap_err();
    assert!(matches!(error, Error::IllPosed(_)), "{error}");
    let accepted = SimulationSettings { accept_ill_posed: true };
    let found = wellposed::simulate(&case, accepted, &ignore_progress).expect("accepted");
    assert!(found.final_time > 0.0);
}

/// Verifies that a case without a grid is refused.
#[test]
fn cases_without_grid_are_refused() {
    let case = wellposed::load("cases/cosserat/forbidden-band.toml", wellposed::NO_SETTINGS)
        .expect("a shipped case");
    let error =
        wellposed::simulate(&case, SimulationSettings::default(), &ignore_progress).unwrap_err();
    assert!(matches!(error, Error::Case(_)) && error.to_string().contains("grid"), "{error}");
}

/// Verifies that a simulation which stops because of non-finite values returns a result with the cause.
#[test]
fn stopped_run_returns_result_with_cause() {
    // The phase of the sine overflows; amplitudes that overflow are refused.
    let sets = ["load[0].time={ kind = 'sine', frequency = 1e308, start = 0.01 }".to_owned()];
    let case = Case::parse(SOLID_CASE, "solid.toml", &sets).expect("a sound case");
    let found = simulate_case(&case);
    let stopped = found.stop_report.as_ref().expect("not finite");
    assert!(
        stopped.detection_time > stopped.last_valid_time
            && stopped.last_valid_time == found.final_time,
        "{stopped}"
    );
    let json = report::to_json(&found).expect("JSON");
    assert_eq!(json["stopped"], stopped.to_string());
    assert!(
        found.fields.quantities.iter().flat_map(|quantity| &quantity.values).all(|v| v.is_finite())
    );
}
