//! Checks that two cases of solids in plane strain describe the same problem: extent, duration, loads.

use crate::case::dynamics::{FaceLoad, InitialStateTerm, SolidRun, StateComponent};
use crate::case::{Case, CaseError, TimeDomainRun};
use crate::study::format::format_count;
use models::common::decimal::format_distinct;
use models::solid::waves::SolidField;

/// Largest difference of coordinates and times, relative to the extent and the duration.
const TOLERANCE: f64 = 1e-9;

/// Returns the simulations of two cases that can be compared.
///
/// # Errors
/// A case is not that of a solid in plane strain; or extent, duration, loads, sources, initial state or snapshot interval
/// differ. Errors name the key of the second case.
pub(super) fn match_cases(cases: [&Case; 2]) -> Result<[&SolidRun; 2], CaseError> {
    let runs = [plane_run(cases[0])?, plane_run(cases[1])?];
    check_extent(runs)?;
    let [first, second] = runs.map(|run| run.time.duration);
    if !is_close(first, second, first) {
        let [first, second] = format_distinct([first, second]);
        let allowed = format!("expected {first} s, as in the first run");
        return Err(runs[1].key_error("time.duration", format!("found {second} s"), allowed));
    }
    let lists = [
        ("load", runs.map(format_loads)),
        (
            "source",
            runs.map(|run| run.sources.iter().map(|source| format!("{source:?}")).collect()),
        ),
        ("initial", runs.map(format_initial_terms)),
    ];
    for (section, [first, second]) in &lists {
        check_equal_lists(runs[1], section, first, second)?;
    }
    let [first, second] = runs.map(|run| run.output.snapshot_interval);
    if !is_close(first, second, first) {
        let [first, second] = format_distinct([first, second]);
        let allowed =
            format!("expected {first} s, as in the first run: run both cases with the same one");
        let found = format!("found {second} s");
        return Err(runs[1].key_error("output.snapshot_interval", found, allowed));
    }
    Ok(runs)
}

/// Returns the simulation of a solid in plane strain.
fn plane_run(case: &Case) -> Result<&SolidRun, CaseError> {
    match case.time_domain_run()? {
        TimeDomainRun::Solid(run) if run.grid.is_polar() => {
            let allowed = "a rectangular grid: runs on such grids can be compared";
            Err(run.key_error("grid.inner_radius", "found a polar grid", allowed))
        }
        TimeDomainRun::Solid(run) if run.grid.dimensions() == 2 => Ok(run),
        TimeDomainRun::Solid(run) => {
            let allowed = "expected two axes: only runs of solids in plane strain can be compared";
            Err(run.key_error("grid.cells", "found three axes", allowed))
        }
        TimeDomainRun::Flow(run) => {
            let allowed = "expected a solid: only runs of solids in plane strain can be compared";
            Err(run.key_error(
                "model.kind",
                format!("found {}", case.material.kind.name()),
                allowed,
            ))
        }
    }
}

fn check_extent(runs: [&SolidRun; 2]) -> Result<(), CaseError> {
    for axis in 0..2 {
        let [first, second] = runs.map(|run| run.grid.axis_bounds(axis));
        let extent = first[1] - first[0];
        if !(0..2).all(|end| is_close(first[end], second[end], extent)) {
            let key = if runs[1].blocks.is_some() { "block" } else { "grid.origin" };
            let [starts, ends] = [0, 1].map(|end| format_distinct([first[end], second[end]]));
            let describe = |run: usize| format!("from {} to {} m", starts[run], ends[run]);
            let found = format!("found x{} {}", axis + 1, describe(1));
            let allowed = format!("expected x{} {}, as in the first run", axis + 1, describe(0));
            return Err(runs[1].key_error(key, found, allowed));
        }
    }
    Ok(())
}

/// Checks that two lists of formatted sections are equal; errors are reported at the first entry that differs.
fn check_equal_lists(
    run: &SolidRun,
    section: &str,
    first: &[String],
    second: &[String],
) -> Result<(), CaseError> {
    if first.len() != second.len() {
        let found = format!("found {} of [[{section}]]", format_count(second.len(), "section"));
        let allowed = format!("expected {}, as in the first run", first.len());
        return Err(run.key_error(section, found, allowed));
    }
    match first.iter().zip(second).position(|(first, second)| first != second) {
        None => Ok(()),
        Some(index) => {
            let path = format!("{section}[{index}]");
            let allowed =
                "expected the section of the first run: only runs of the same load can be compared";
            Err(run.key_error(&path, "found other values than in the first run", allowed))
        }
    }
}

fn is_close(first: f64, second: f64, scale: f64) -> bool {
    first == second || (first - second).abs() <= TOLERANCE * scale.abs()
}

/// Sorts the indices of a shear stress: in classical solids σ₂₁ = σ₁₂, and on a face only one of them is a traction.
fn symmetrise(component: StateComponent) -> StateComponent {
    match component.0 {
        SolidField::Stress(i, j) => StateComponent(SolidField::Stress(i.min(j), i.max(j))),
        _ => component,
    }
}

fn format_loads(run: &SolidRun) -> Vec<String> {
    let format = |load: &FaceLoad| {
        let component = symmetrise(load.component);
        format!("{:?}", FaceLoad { component, ..load.clone() })
    };
    run.loads.iter().map(format).collect()
}

/// Formats the terms of the initial state; both shear stresses of a Cosserat solid count as the one of a classical solid.
fn format_initial_terms(run: &SolidRun) -> Vec<String> {
    let format = |term: &InitialStateTerm| {
        let mut term = term.clone();
        if let InitialStateTerm::Pulse { component, .. }
        | InitialStateTerm::Uniform { component, .. } = &mut term
        {
            *component = symmetrise(*component);
        }
        format!("{term:?}")
    };
    let mut terms: Vec<String> = run.initial_terms.iter().map(format).collect();
    terms.dedup();
    terms
}
