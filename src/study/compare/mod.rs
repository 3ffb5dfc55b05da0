//! Comparison of two runs of the same problem, such as a blocky medium and its equivalent Cosserat continuum: means over
//! blocks, positions of fronts, dissipated energy.
//!
//! [`Comparison`] takes one pair of snapshots after the other, so that one pair is in memory; [`compare_runs`] compares two
//! results of [`simulate`](super::simulate()).

mod averages;
mod fronts;
mod matching;

pub use averages::BlockMeans;
pub use fronts::{FRONT_SHARE, FrontRays, RAY_DIRECTIONS_DEG};

use crate::Error;
use crate::case::dynamics::SolidRun;
use crate::case::{Case, CaseError};
use crate::study::format::format_count;
use crate::study::simulate::{OutputFields, RecordTable, RunResult};
use averages::AveragingAreas;
use models::common::decimal::format_distinct;
use serde::Serialize;
use std::path::PathBuf;

/// Columns of the energy ledger that are dissipated energies: of yielding solids and of joints.
const DISSIPATION_COLUMNS: [&str; 5] = [
    "plastic_dissipation",
    "joint_plastic_dissipation",
    "joint_viscous_dissipation",
    "joint_released_energy",
    "joint_fracture_energy",
];

/// Differences between two runs. All relative differences refer to the first run.
#[derive(Clone, Debug, Serialize)]
pub struct ComparisonResult {
    /// The two runs.
    pub runs: [ComparedRun; 2],
    /// Areas over which fields are averaged.
    pub averaging: Averaging,
    /// Rays along which fronts are located.
    pub rays: FrontRays,
    /// Differences by time.
    pub snapshots: Vec<SnapshotDifference>,
    /// Largest dissipated energy of the first run, J/m; 0 if nothing yields.
    pub dissipated: f64,
    /// Dissipated energies against time.
    #[serde(skip)]
    pub dissipation: DissipationCurves,
    /// Fields of the means at the time of the last snapshot.
    #[serde(skip)]
    pub final_means: MeanFields,
}

/// Description of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparedRun {
    /// Title of the case.
    pub title: String,
    /// Kind of the model.
    pub model: &'static str,
    /// Number of blocks; `None` for a continuum.
    pub blocks: Option<usize>,
    /// Cells of the grid along each axis.
    pub cells: Vec<usize>,
    /// Checksum of the case without plot options, as in `program.json`.
    #[serde(rename = "case")]
    pub case_checksum: String,
    /// Folder of its results; `None` if it was not read from files.
    #[serde(skip)]
    pub folder: Option<PathBuf>,
}

/// Areas over which fields are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Averaging {
    /// `blocks`, or `cells` of the coarser grid if neither run has blocks.
    pub over: &'static str,
    /// Number of areas.
    pub count: usize,
    /// Edge lengths of the first area, m.
    pub size: [f64; 2],
}

/// Differences at one time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SnapshotDifference {
    /// Time, s.
    pub time: f64,
    /// Relative L2 difference of the means of σ₂₂; `None` while it vanishes in the first run.
    pub sigma22: Option<f64>,
    /// Relative L2 difference of the means of σ₁₂, of ½(σ₁₂ + σ₂₁) in a Cosserat solid.
    pub sigma12: Option<f64>,
    /// Relative L2 difference of the means of the rate of rotation ω₃; also `None` without a rate, see [`BlockMeans`].
    pub rotation_rate: Option<f64>,
    /// Positions of the fronts of both runs along each ray, m from its origin.
    pub fronts: [[Option<f64>; 2]; 2],
    /// Dissipated energies of both runs, J/m.
    pub dissipated: [f64; 2],
}

impl SnapshotDifference {
    /// Returns the difference of the front positions along a ray, relative to the first run.
    pub fn front_difference(&self, ray: usize) -> Option<f64> {
        let [first, second] = self.fronts[ray];
        Some(second? / first? - 1.0)
    }

    /// Returns the difference of the dissipated energies, relative to the first run; `None` without dissipation there.
    pub fn dissipation_difference(&self) -> Option<f64> {
        let [first, second] = self.dissipated;
        (first > 0.0).then(|| second / first - 1.0)
    }
}

/// Dissipated energies against time, at the times of the first ledger.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DissipationCurves {
    /// Times, s.
    pub times: Vec<f64>,
    /// Energies of both runs, J/m.
    pub energies: [Vec<f64>; 2],
}

/// Means spread over the cells of a grid, for pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeanFields {
    /// Time, s.
    pub time: f64,
    /// Cells of the grid along each axis.
    pub cells: [usize; 2],
    /// Lower and upper bound of the grid along each axis, m.
    pub bounds: [[f64; 2]; 2],
    /// Means of both runs by cell, first axis fastest.
    pub means: [BlockMeans; 2],
}

/// Comparison in progress.
pub struct Comparison<'a> {
    cases: [&'a Case; 2],
    runs: [&'a SolidRun; 2],
    areas: AveragingAreas,
    rays: FrontRays,
    snapshots: Vec<SnapshotDifference>,
    last_means: [BlockMeans; 2],
}

impl<'a> Comparison<'a> {
    /// Prepares the comparison of runs of two cases.
    ///
    /// # Errors
    /// The cases are not of solids in plane strain, differ in extent, duration, loads, sources, initial state or snapshot
    /// interval, or the blocks of one run are not whole numbers of cells of the other.
    pub fn new(cases: [&'a Case; 2]) -> Result<Self, Error> {
        let runs = matching::match_cases(cases)?;
        let areas = AveragingAreas::new(runs)?;
        let rays = FrontRays::new(runs[0], &areas);
        let last_means = Default::default();
        Ok(Self { cases, runs, areas, rays, snapshots: Vec::new(), last_means })
    }

    /// Compares the fields of both runs at one time, later than those before.
    ///
    /// # Errors
    /// The times differ, or the fields are not those of the grids.
    pub fn add_snapshot(&mut self, fields: [&OutputFields; 2]) -> Result<(), Error> {
        let [first, second] = fields.map(|own| own.time);
        if (first - second).abs() > 1e-6 * self.runs[0].time.duration {
            let [first, second] = format_distinct([first, second]);
            let found = format!("found a snapshot at {second} s");
            let allowed =
                format!("expected {first} s, as in the first run: both must reach their end");
            return Err(self.runs[1].key_error("time.duration", found, allowed).into());
        }
        let means = [0, 1].map(|run| BlockMeans::new(&self.areas, run, fields[run]));
        let difference = |select: fn(&BlockMeans) -> &Vec<f64>| {
            let [first, second] = [select(&means[0]), select(&means[1])];
            let is_comparable = first.len() == self.areas.count() && second.len() == first.len();
            is_comparable.then(|| self.areas.relative_difference([first, second])).flatten()
        };
        let fronts = [0, 1].map(|run| self.rays.locate_fronts(&self.runs[run].grid, fields[run]));
        self.snapshots.push(SnapshotDifference {
            time: first,
            sigma22: difference(|means| &means.normal_stress),
            sigma12: difference(|means| &means.shear_stress),
            rotation_rate: difference(|means| &means.rotation_rate),
            fronts: [0, 1].map(|ray| [fronts[0][ray], fronts[1][ray]]),
            dissipated: [0.0; 2],
        });
        self.last_means = means;
        Ok(())
    }

    /// Adds the dissipated energies from the ledgers of both runs and returns the result.
    pub fn finish(self, ledgers: [&RecordTable; 2]) -> ComparisonResult {
        let Self { cases, runs, areas, rays, mut snapshots, last_means } = self;
        let curves = ledgers.map(sum_dissipation);
        for snapshot in &mut snapshots {
            snapshot.dissipated =
                [0, 1].map(|run| interpolate(&curves[run].0, &curves[run].1, snapshot.time));
        }
        let describe = |index: usize| ComparedRun {
            title: match cases[index].title.as_str() {
                "" => cases[index].name.clone(),
                title => title.to_owned(),
            },
            model: cases[index].material.kind.name(),
            blocks: runs[index].blocks.as_ref().map(|blocks| blocks.blocks.len()),
            cells: runs[index].grid.cells.clone(),
            case_checksum: format!(
                "{:08x}",
                files::checksum(cases[index].without_plot_options().to_toml().as_bytes())
            ),
            folder: None,
        };
        let grid = &runs[areas.raster_run()].grid;
        let spread = |means: &BlockMeans| {
            let over = |list: &Vec<f64>| match list.len() == areas.count() {
                true => areas.spread_over_cells(list, grid.cells[0], grid.cell_count()),
                false => Vec::new(),
            };
            BlockMeans {
                normal_stress: over(&means.normal_stress),
                shear_stress: over(&means.shear_stress),
                rotation_rate: over(&means.rotation_rate),
            }
        };
        let [(times, first), (second_times, second)] = curves;
        let second = times.iter().map(|time| interpolate(&second_times, &second, *time)).collect();
        ComparisonResult {
            runs: [describe(0), describe(1)],
            averaging: Averaging {
                over: if areas.are_blocks { "blocks" } else { "cells" },
                count: areas.count(),
                size: areas.size(),
            },
            rays,
            dissipated: first.iter().fold(0.0, |max: f64, energy| max.max(*energy)),
            final_means: MeanFields {
                time: snapshots.last().map_or(0.0, |last| last.time),
                cells: [grid.cells[0], grid.cells[1]],
                bounds: [0, 1].map(|axis| grid.axis_bounds(axis)),
                means: [spread(&last_means[0]), spread(&last_means[1])],
            },
            snapshots,
            dissipation: DissipationCurves { times, energies: [first, second] },
        }
    }
}

/// Returns times and the sum of all dissipated energies of a ledger.
fn sum_dissipation(ledger: &RecordTable) -> (Vec<f64>, Vec<f64>) {
    let times = ledger.get("time").unwrap_or_default().to_vec();
    let mut sum = vec![0.0; times.len()];
    for column in DISSIPATION_COLUMNS.iter().filter_map(|name| ledger.get(name)) {
        sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += value);
    }
    (times, sum)
}

/// Interpolates a table linearly; constant beyond its ends, 0 if it is empty.
fn interpolate(times: &[f64], values: &[f64], time: f64) -> f64 {
    let upper = times.partition_point(|own| *own < time);
    match (upper.checked_sub(1), times.get(upper)) {
        (_, None) => values.last().copied().unwrap_or(0.0),
        (None, _) => values.first().copied().unwrap_or(0.0),
        (Some(lower), Some(end)) => {
            let share = (time - times[lower]) / (end - times[lower]);
            values[lower] + share * (values[upper] - values[lower])
        }
    }
}

/// Compares two simulations of solids in plane strain at the times of their snapshots, or at their end without snapshots.
///
/// # Errors
/// The cases do not match (see [`Comparison::new`]), or a simulation stopped early.
///
/// # Examples
/// ```
/// use wellposed::study::simulate::SimulationSettings;
/// use wellposed::study::{compare_runs, ignore_progress};
///
/// let path = "cases/blocky/pulse-breaking.toml";
/// let settings = [
///     "block[0].repeat=[20, 10]",
///     "block[0].origin=[-0.5, -0.5]",
///     "receiver[0].at=[0.025, -0.125]",
///     "time.duration=1e-4",
/// ];
/// let first = wellposed::load(path, settings)?;
/// let second = wellposed::load(path, settings.into_iter().chain(["joint[0].fracture=false"]))?;
/// let run = |case| wellposed::simulate(case, SimulationSettings::default(), &ignore_progress);
/// let found = compare_runs([&first, &second], [&run(&first)?, &run(&second)?])?;
/// assert_eq!(found.averaging.count, 20 * 10);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn compare_runs(
    cases: [&Case; 2],
    results: [&RunResult; 2],
) -> Result<ComparisonResult, Error> {
    let mut comparison = Comparison::new(cases)?;
    let snapshots = results.map(|result| match result.records.snapshots.is_empty() {
        true => std::slice::from_ref(&result.fields),
        false => &result.records.snapshots[..],
    });
    if snapshots[0].len() != snapshots[1].len() {
        return Err(comparison.snapshot_count_error(snapshots.map(<[_]>::len)).into());
    }
    for (first, second) in snapshots[0].iter().zip(snapshots[1]) {
        comparison.add_snapshot([first, second])?;
    }
    Ok(comparison.finish(results.map(|result| &result.records.ledger)))
}

impl Comparison<'_> {
    /// Creates the error that the runs have different numbers of snapshots.
    pub fn snapshot_count_error(&self, [first, second]: [usize; 2]) -> CaseError {
        let found = format!("found {}", format_count(second, "snapshot"));
        let allowed = format!("expected {first}, as in the first run: both must reach their end");
        self.runs[1].key_error("time.duration", found, allowed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::simulate::RecordColumn;

    #[test]
    fn dissipated_energies_are_summed_and_interpolated() {
        let column = |name: &str, values: &[f64]| RecordColumn {
            name: name.to_owned(),
            unit: "J/m",
            values: values.to_vec(),
        };
        let ledger = RecordTable {
            columns: vec![
                column("time", &[0.0, 1.0, 3.0]),
                column("kinetic", &[9.0, 9.0, 9.0]),
                column("joint_plastic_dissipation", &[0.0, 2.0, 4.0]),
                column("joint_fracture_energy", &[0.0, 1.0, 1.0]),
            ],
        };
        let (times, sum) = sum_dissipation(&ledger);
        assert_eq!(sum, [0.0, 3.0, 5.0]);
        for (time, expected) in [(-1.0, 0.0), (0.5, 1.5), (1.0, 3.0), (2.0, 4.0), (7.0, 5.0)] {
            assert_eq!(interpolate(&times, &sum, time), expected, "{time}");
        }
        assert_eq!(interpolate(&[], &[], 1.0), 0.0);
    }
}
