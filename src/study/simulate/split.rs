//! Plan of the distribution of the cells of a solid over ranks: the one that a run on as many ranks makes.

use super::Bytes;
use super::solid::SolidJob;
use crate::Error;
use crate::case::dynamics::{Precision, SolidRun};
use crate::case::{Case, TimeDomainRun};
use crate::setup::solid_run::{create_planned_problem, locate_domain_error};
use dynamics::SolverReal;
use dynamics::decomposition::communicator::SingleProcess;
use dynamics::decomposition::{RankCounts, RankPart, RankPlan};
use serde::Serialize;

/// Distribution of the cells of a solid over ranks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SplitResult {
    /// Title of the case; empty if it has none.
    pub title: String,
    /// Number of cells along each axis.
    pub cell_counts: Vec<usize>,
    /// Numbers of parts along the axes.
    pub part_counts: Vec<usize>,
    /// Number of threads of each rank.
    pub thread_count: usize,
    /// Precision of the fields: `f64` or `f32`.
    pub precision: &'static str,
    /// Work of the rank with the most, relative to the mean of all ranks.
    pub work_imbalance: f64,
    /// Whether there are joints, whose work is not counted.
    pub has_joints: bool,
    /// Ranks in their order.
    pub ranks: Vec<RankRow>,
}

/// Part of a rank.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RankRow {
    /// Number of the rank.
    pub rank: usize,
    /// First cell and end of the cells along each axis.
    pub cells: Vec<[usize; 2]>,
    /// Number of cells.
    pub cell_count: usize,
    /// Number of cells of the solver, copies of neighbouring cells included.
    pub stored_cell_count: usize,
    /// Work of a step, relative to the mean of all ranks.
    pub relative_work: f64,
    /// Estimated peak memory, bytes.
    pub memory_bytes: f64,
    /// Number of faces of cells at cuts between this rank and others.
    pub surface_faces: usize,
    /// Number of ranks beyond these faces.
    pub neighbours: usize,
    /// Mean number of messages sent in a step.
    pub messages_per_step: f64,
    /// Mean number of bytes sent in a step.
    pub bytes_per_step: f64,
}

impl RankRow {
    /// Returns the estimated peak memory.
    pub const fn memory(&self) -> Bytes {
        Bytes(self.memory_bytes)
    }
}

/// Plans the distribution of the cells of a solid over `rank_count` ranks with `thread_count` threads each.
///
/// # Errors
/// The case is invalid or has no simulation of a solid, or the grid cannot be cut into so many parts.
///
/// # Examples
/// ```
/// let case = wellposed::load("cases/dynamics/lamb-2d.toml", wellposed::NO_SETTINGS)?;
/// let found = wellposed::study::simulate::plan_split(&case, 6, 1)?;
/// let cells: usize = found.ranks.iter().map(|own| own.cell_count).sum();
/// assert_eq!((found.ranks.len(), cells), (6, found.cell_counts.iter().product()));
/// assert!(found.work_imbalance < 1.05);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn plan_split(
    case: &Case,
    rank_count: usize,
    thread_count: usize,
) -> Result<SplitResult, Error> {
    let solid_run = match case.time_domain_run()? {
        TimeDomainRun::Solid(own) => own,
        TimeDomainRun::Flow(own) => {
            let found = "a flow, whose simulation runs in one process";
            return Err(own.key_error("grid", found, "a solid in time").into());
        }
    };
    let job = SolidJob::new(case, solid_run)?;
    let counts = (rank_count, thread_count);
    match (solid_run.grid.dimensions(), solid_run.scheme.precision) {
        (2, Precision::F64) => plan::<f64, 2>(&job, counts),
        (2, Precision::F32) => plan::<f32, 2>(&job, counts),
        (_, Precision::F64) => plan::<f64, 3>(&job, counts),
        (_, Precision::F32) => plan::<f32, 3>(&job, counts),
    }
}

fn plan<T: SolverReal, const D: usize>(
    job: &SolidJob,
    (ranks, threads): (usize, usize),
) -> Result<SplitResult, Error> {
    let solid_run: &SolidRun = job.solid_run;
    let problem = create_planned_problem::<D>(job.case, solid_run, job.media.clone())?;
    let located = |error| locate_domain_error(solid_run, &error);
    let counts = RankCounts { ranks, threads, parts: solid_run.part_counts.clone() };
    let plan = RankPlan::new(problem.first_axis(), &problem, &counts, &SingleProcess);
    let plan = plan.map_err(located)?;
    let parts = plan.parts::<T>(&problem).map_err(located)?;
    let work: Vec<f64> = parts.iter().map(|part| plan.work(&problem, part) as f64).collect();
    let [mean, greatest] = mean_and_greatest(&work);
    let total = problem.grid.count() as f64;
    let row = |(rank, (part, work)): (usize, (&RankPart<D>, f64))| {
        let cell_count = part.cells.iter().map(ExactSizeIterator::len).product::<usize>();
        let shares = [cell_count, part.stored_cells].map(|count| count as f64 / total);
        RankRow {
            rank,
            cells: part.cells.iter().map(|own| [own.start, own.end]).collect(),
            cell_count,
            stored_cell_count: part.stored_cells,
            relative_work: work / mean,
            // Nearly all messages of a step are in memory at the same time.
            memory_bytes: job.estimate_memory(false, shares).0 + part.bytes_per_step,
            surface_faces: part.surface,
            neighbours: part.neighbours,
            messages_per_step: part.messages_per_step,
            bytes_per_step: part.bytes_per_step,
        }
    };
    let ranks = parts.iter().zip(work.iter().copied()).enumerate();
    Ok(SplitResult {
        title: job.case.title.clone(),
        cell_counts: solid_run.grid.cells.clone(),
        part_counts: plan.part_counts().to_vec(),
        thread_count: plan.threads(),
        precision: solid_run.scheme.precision.name(),
        work_imbalance: greatest / mean,
        has_joints: !problem.interlayers.is_empty(),
        ranks: ranks.map(row).collect(),
    })
}

/// Returns the mean and the greatest of some numbers.
fn mean_and_greatest(numbers: &[f64]) -> [f64; 2] {
    let greatest = numbers.iter().copied().fold(0.0, f64::max);
    [numbers.iter().sum::<f64>() / numbers.len() as f64, greatest]
}
