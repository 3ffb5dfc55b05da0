//! One function per study.

use crate::arrays::convert_fields;
use crate::result::{RawCase, RawResult};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use wellposed::case::ContinuumOptions;
use wellposed::models::interface::continuum::OpeningLimit;
use wellposed::report::point::CertifiedPoint;
use wellposed::setup::check::CheckExtent;
use wellposed::study::simulate::{
    OutputFields, SimulationSettings, simulate, simulate_with_snapshots,
};
use wellposed::study::{self, BoxRange, MapOptions};

type Progress<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Analyses the state of a case; with ranges of numbers, also proves the verdict for all states in them, or for this state
/// if there are none.
#[pyfunction]
#[pyo3(signature = (case, ranges, progress, threads))]
pub fn point(
    py: Python<'_>,
    case: &RawCase,
    ranges: Option<Vec<(String, f64, f64)>>,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    let Some(ranges) = ranges else {
        return case.compute(py, progress, threads, study::analyse_point);
    };
    let range = |(key, low, high)| BoxRange { key, ends: [low, high] };
    let ranges: Vec<BoxRange> = ranges.into_iter().map(range).collect();
    case.compute(py, progress, threads, |case, progress| {
        let certified = study::certify_state(case, &ranges)?;
        Ok(CertifiedPoint { point: study::analyse_point(case, progress)?, certified })
    })
}

/// Computes the verdict over two parameters.
#[pyfunction]
#[pyo3(signature = (case, bound, growth_rate, model_blind, certified, progress, threads))]
pub fn map(
    py: Python<'_>,
    case: &RawCase,
    bound: bool,
    growth_rate: bool,
    model_blind: bool,
    certified: bool,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    let options = MapOptions {
        computes_bound: bound,
        computes_growth_rate: growth_rate,
        is_model_blind: model_blind,
        is_certified: certified,
    };
    case.compute(py, progress, threads, |case, progress| {
        study::compute_map(case, options, progress)
    })
}

/// Computes the dispersion relation of a solid or, for a blocky medium, its Bloch waves.
#[pyfunction]
#[pyo3(signature = (case, progress, threads))]
pub fn dispersion(
    py: Python<'_>,
    case: &RawCase,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    match case.case.has_joints() {
        true => case.compute(py, progress, threads, study::compute_bloch_waves),
        false => case.compute(py, progress, threads, study::compute_dispersion),
    }
}

/// Computes the characteristic speeds of a solid by direction.
#[pyfunction]
#[pyo3(signature = (case, progress, threads))]
pub fn speeds(
    py: Python<'_>,
    case: &RawCase,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    case.compute(py, progress, threads, study::compute_speeds)
}

/// Computes exact plane waves in a granular or porous medium.
#[pyfunction]
pub fn shocks(py: Python<'_>, case: &RawCase) -> PyResult<RawResult> {
    case.compute(py, None, None, |case, _| study::compute_shocks(case))
}

/// Computes the uniaxial diagram of a rheological scheme.
#[pyfunction]
pub fn diagram(py: Python<'_>, case: &RawCase) -> PyResult<RawResult> {
    case.compute(py, None, None, |case, _| study::compute_diagram(case))
}

/// Computes the equivalent continuum of a blocky medium; returns the result and the text of the case of the continuum.
#[pyfunction]
#[pyo3(signature = (case, cells_per_block, overturning))]
pub fn homogenise(
    py: Python<'_>,
    case: &RawCase,
    cells_per_block: usize,
    overturning: bool,
) -> PyResult<(RawResult, String)> {
    let run = case.supervise(None, None);
    let case = &case.case;
    let opening_limit = match overturning {
        true => OpeningLimit::Overturning,
        false => OpeningLimit::FirstOpening,
    };
    let options = ContinuumOptions { cells_per_block, opening_limit };
    let found = run.run(py, |_| study::homogenise(case, &options))?;
    Ok((RawResult::new(py, &found, case)?, found.continuum_case.toml))
}

/// Compares predicted with simulated frequencies and growth rates.
#[pyfunction]
#[pyo3(signature = (case, quick, progress, threads))]
pub fn check(
    py: Python<'_>,
    case: &RawCase,
    quick: bool,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    let extent = if quick { CheckExtent::Short } else { CheckExtent::Full };
    case.compute(py, progress, threads, |case, progress| {
        study::check_agreement(case, extent, progress)
    })
}

/// Simulates a solid or a flow; `on_snapshot` is called with the arrays of each snapshot.
#[pyfunction]
#[pyo3(signature = (case, accept_ill_posed, on_snapshot, progress, threads))]
pub fn run(
    py: Python<'_>,
    case: &RawCase,
    accept_ill_posed: bool,
    on_snapshot: Option<Py<PyAny>>,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    let settings = SimulationSettings { accept_ill_posed };
    let run = case.supervise(progress, threads);
    let case = &case.case;
    let found = match on_snapshot {
        None => run.run(py, |progress| simulate(case, settings, progress))?,
        Some(callable) => {
            let call = |py: Python<'_>, fields: OutputFields| {
                callable.call1(py, (convert_fields(py, fields)?,)).map(drop)
            };
            run.run_with_snapshots(py, &call, |progress, sender| {
                // The calling thread receives as long as the study runs.
                let mut send = |fields: OutputFields| match sender.send(fields) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(_) => ControlFlow::Break(()),
                };
                simulate_with_snapshots(case, settings, progress, &mut send)
            })?
        }
    };
    RawResult::from_run(py, found, case)
}

/// Simulates two cases of the same problem and compares the results.
#[pyfunction]
#[pyo3(signature = (first, second, progress, threads))]
pub fn compare(
    py: Python<'_>,
    first: &RawCase,
    second: &RawCase,
    progress: Progress,
    threads: Option<usize>,
) -> PyResult<RawResult> {
    let run = first.supervise(progress, threads);
    let cases = [&first.case, &second.case];
    let found = run.run(py, |progress| {
        let simulate_one = |index: usize| {
            simulate(cases[index], SimulationSettings::default(), &|done, all| {
                progress(index * all + done, 2 * all)
            })
        };
        study::compare_runs(cases, [&simulate_one(0)?, &simulate_one(1)?])
    })?;
    RawResult::new(py, &found, cases[0])
}

/// Returns names and texts of the bundled cases.
#[pyfunction]
pub fn bundled_cases() -> Vec<(&'static str, &'static str)> {
    wellposed::CASES.to_vec()
}

/// Returns the unit of a column of the table of a report.
#[pyfunction]
pub fn column_unit(file: &str, column: &str) -> Option<&'static str> {
    wellposed::report::column_unit(file, column)
}
