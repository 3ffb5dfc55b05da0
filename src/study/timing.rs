//! Time of a step of blocky media against the number of blocks, with ranks on threads of this process or in processes
//! of a launcher.

use crate::Error;
use crate::case::dynamics::{Precision, SolidRun};
use crate::case::{Case, TimeDomainRun};
use crate::setup::solid_run::{
    compute_time_steps, create_media, create_planned_problem, locate_domain_error,
};
use dynamics::SolverReal;
use dynamics::decomposition::communicator::{Communicator, SingleProcess, ThreadRank};
use dynamics::decomposition::{DecomposedDomain, RankCounts, RankPart, RankPlan};
use dynamics::problem::{DomainError, Problem};
use models::common::elementary::Elementary;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

/// Number of rounds of steps, of which the fastest counts.
const ROUNDS: usize = 3;

/// Amplitude of the initial noise, in SI units of the fields: so small that nothing yields or breaks.
const NOISE: f64 = 1e-9;

/// Lengths of the messages, bytes, that measure latency and bandwidth, and numbers of round trips.
const SHORT_MESSAGE: (usize, u32) = (8, 200);
const LONG_MESSAGE: (usize, u32) = (1 << 20, 10);

/// Tag of these messages; no halos are exchanged meanwhile.
const TAG: u16 = 0;

/// Relative deviation from the model above which a row is marked.
pub const MARKED_DEVIATION: f64 = 0.2;

/// Times of steps against the number of blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimingResult {
    /// Number of steps of a round.
    pub steps: usize,
    /// Number of threads of each rank.
    pub thread_count: usize,
    /// Rows by number of ranks, then of blocks.
    pub rows: Vec<TimingRow>,
    /// Exponent p of the fitted line T ∝ Nᵖ, by number of ranks; for at least two numbers of blocks.
    pub exponents: Vec<(usize, f64)>,
}

/// Time of a step with a number of blocks and of ranks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimingRow {
    /// Number of ranks.
    pub ranks: usize,
    /// Whether the ranks are processes of a launcher, instead of threads of one process.
    pub are_processes: bool,
    /// Number N of blocks along each axis.
    pub blocks: usize,
    /// Number of cells.
    pub cells: usize,
    /// Measured time of a step, s.
    pub step_time: f64,
    /// Time of a step by the model, s.
    pub model_time: f64,
    /// Time of a step per cell of the largest medium on one rank, s, measured in the same call.
    pub cell_time: f64,
    /// Number of steps in which the fastest wave crosses the medium along the first axis.
    pub crossing_steps: usize,
    /// Latency, s, and bandwidth, bytes/s, of messages between the first and the last rank; `None` for one rank.
    pub messages: Option<[f64; 2]>,
}

impl TimingRow {
    /// Returns the measured time in which a wave crosses the medium, s.
    pub fn crossing_time(&self) -> f64 {
        self.step_time * self.crossing_steps as f64
    }

    /// Returns the deviation of the measured time from that of the model, relative to it.
    pub fn deviation(&self) -> f64 {
        self.step_time / self.model_time - 1.0
    }
}

impl TimingResult {
    /// Adds the rows of an earlier result with other numbers of ranks, if it has the same numbers of steps and threads.
    pub fn add_earlier_rows(&mut self, earlier: Self) {
        if [earlier.steps, earlier.thread_count] != [self.steps, self.thread_count] {
            return;
        }
        let counts: Vec<usize> = self.rows.iter().map(|row| row.ranks).collect();
        let is_other = |ranks: usize| !counts.contains(&ranks);
        self.rows.extend(earlier.rows.into_iter().filter(|row| is_other(row.ranks)));
        self.rows.sort_by_key(|row| (row.ranks, row.blocks));
        self.exponents.extend(earlier.exponents.into_iter().filter(|own| is_other(own.0)));
        self.exponents.sort_by_key(|own| own.0);
    }
}

/// Ranks whose steps are measured.
#[derive(Clone, Copy, Debug)]
enum TimedRanks<'a> {
    /// So many ranks on threads of this process.
    Threads(usize),
    /// Ranks in processes that a launcher has started.
    Processes(&'a Arc<dyn Communicator>),
}

impl TimedRanks<'_> {
    fn count(self) -> usize {
        match self {
            Self::Threads(count) => count,
            Self::Processes(communicator) => communicator.size(),
        }
    }
}

/// Time of a step of one run, and what the model needs.
struct Measurement {
    ranks: usize,
    are_processes: bool,
    step_time: f64,
    /// Greatest number of cells in the memory of a rank.
    stored_cells: f64,
    /// Greatest numbers of messages and bytes that a rank sends in a step.
    sent: [f64; 2],
    messages: Option<[f64; 2]>,
}

/// Measures the time of a step of the media `cases`, each with its number of blocks along each axis, in ascending order,
/// on numbers of ranks, on threads of this process.
///
/// The model is T = cells·t_cell + messages·latency + bytes/bandwidth of the rank with the most, halos included, with all
/// constants measured in the same call: t_cell on one rank with the largest number of blocks.
///
/// # Errors
/// A case is invalid or no solid in the plane, or its grid cannot be cut into so many parts.
pub fn time_blocks(
    cases: &[(usize, Case)],
    rank_counts: &[usize],
    (threads, steps): (usize, usize),
) -> Result<TimingResult, Error> {
    let mut measured = Vec::new();
    for &ranks in rank_counts {
        for (blocks, case) in cases {
            let ranks = TimedRanks::Threads(ranks);
            measured.push((*blocks, case, measure_case(case, ranks, threads, steps)?));
        }
    }
    create_result(cases, &measured, (threads, steps))
}

/// Measures as [`time_blocks`] does, on the ranks of `communicator`. All of them call it; `None` at others than the root,
/// which alone measures t_cell at the end.
///
/// # Errors
/// As [`time_blocks`].
pub fn time_blocks_on_ranks(
    cases: &[(usize, Case)],
    communicator: &Arc<dyn Communicator>,
    (threads, steps): (usize, usize),
) -> Result<Option<TimingResult>, Error> {
    let mut measured = Vec::new();
    for (blocks, case) in cases {
        let ranks = TimedRanks::Processes(communicator);
        measured.push((*blocks, case, measure_case(case, ranks, threads, steps)?));
    }
    match communicator.is_root() {
        true => create_result(cases, &measured, (threads, steps)).map(Some),
        false => Ok(None),
    }
}

/// Measures t_cell and compares measured times with the model.
fn create_result(
    cases: &[(usize, Case)],
    measured: &[(usize, &Case, Measurement)],
    (threads, steps): (usize, usize),
) -> Result<TimingResult, Error> {
    let mut cell_time = 0.0;
    if let Some((_, case)) = cases.last() {
        let single = measure_case(case, TimedRanks::Threads(1), threads, steps)?;
        cell_time = single.step_time / single.stored_cells;
    }
    let mut rows: Vec<TimingRow> = Vec::new();
    for (blocks, case, found) in measured {
        let [latency, bandwidth] = found.messages.unwrap_or([0.0, f64::INFINITY]);
        let solid_run = require_solid(case)?;
        let media = create_media(case, solid_run)?;
        let step = compute_time_steps(solid_run, &media)?.step;
        let speed = media.iter().map(|own| own.max_speed()).fold(0.0, f64::max);
        let [first, last] = solid_run.grid.axis_bounds(0);
        rows.push(TimingRow {
            ranks: found.ranks,
            are_processes: found.are_processes,
            blocks: *blocks,
            cells: solid_run.grid.cell_count(),
            step_time: found.step_time,
            model_time: found.stored_cells * cell_time
                + found.sent[0] * latency
                + found.sent[1] / bandwidth,
            cell_time,
            crossing_steps: ((last - first) / (speed * step)).ceil() as usize,
            messages: found.messages,
        });
    }
    let mut counts: Vec<usize> = rows.iter().map(|row| row.ranks).collect();
    counts.dedup();
    let exponent = |ranks: &usize| {
        let own = rows.iter().filter(|row| row.ranks == *ranks);
        let points: Vec<[f64; 2]> = own
            .map(|row| [row.blocks as f64, row.crossing_time()].map(Elementary::cr_log10))
            .collect();
        fit_slope(&points).map(|slope| (*ranks, slope))
    };
    let exponents = counts.iter().filter_map(exponent).collect();
    Ok(TimingResult { steps, thread_count: threads, rows, exponents })
}

/// Returns the slope of the line of least squares; `None` for fewer than two abscissas.
fn fit_slope(points: &[[f64; 2]]) -> Option<f64> {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|own| own[axis]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let moment = |axis: usize, middle: f64| -> f64 {
        points.iter().map(|own| (own[0] - x) * (own[axis] - middle)).sum()
    };
    let spread = moment(0, x);
    (spread > 0.0).then(|| moment(1, y) / spread)
}

fn require_solid(case: &Case) -> Result<&SolidRun, Error> {
    match case.time_domain_run()? {
        TimeDomainRun::Solid(own) if own.grid.dimensions() == 2 => Ok(own),
        TimeDomainRun::Solid(own) => {
            Err(own.key_error("grid", "a grid in space", "a blocky medium").into())
        }
        TimeDomainRun::Flow(own) => Err(own.key_error("grid", "a flow", "a blocky medium").into()),
    }
}

fn measure_case(
    case: &Case,
    ranks: TimedRanks,
    threads: usize,
    steps: usize,
) -> Result<Measurement, Error> {
    let solid_run = require_solid(case)?;
    let media = create_media(case, solid_run)?;
    let problem = create_planned_problem::<2>(case, solid_run, media)?;
    let found = match solid_run.scheme.precision {
        Precision::F64 => measure::<f64>(&problem, ranks, threads, steps),
        Precision::F32 => measure::<f32>(&problem, ranks, threads, steps),
    };
    Ok(found.map_err(|error| locate_domain_error(solid_run, &error))?)
}

fn measure<T: SolverReal>(
    problem: &Problem<2>,
    ranks: TimedRanks,
    threads: usize,
    steps: usize,
) -> Result<Measurement, DomainError> {
    let counts = RankCounts { ranks: ranks.count(), threads, parts: None };
    let plan = RankPlan::new(problem.first_axis(), problem, &counts, &SingleProcess)?;
    let parts = plan.parts::<T>(problem)?;
    let run =
        |communicator: Arc<dyn Communicator>| -> Result<(f64, Option<[f64; 2]>), DomainError> {
            let own = Arc::clone(&communicator);
            let mut domain = DecomposedDomain::<T, 2>::with_rank_plan(problem, plan.clone(), own)?;
            let cells: usize = domain.own_cells().iter().map(ExactSizeIterator::len).product();
            for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
                let values = (0..cells).map(|cell| T::from_f64(NOISE * noise(cell, index)));
                domain.set_field(field, &values.collect::<Vec<T>>());
            }
            domain.initialise_interlayers();
            let mut fastest = f64::INFINITY;
            // The first round fills caches.
            for round in 0..=ROUNDS {
                communicator.broadcast(Vec::new());
                let start = Instant::now();
                if let Err(error) = domain.advance(steps) {
                    communicator.abort(&error.to_string());
                }
                // The root waits for the slowest rank.
                communicator.gather(Vec::new(), &mut |_, _| {});
                if round > 0 {
                    fastest = fastest.min(start.elapsed().as_secs_f64() / steps as f64);
                }
            }
            Ok((fastest, measure_messages(&*communicator)))
        };
    let (step_time, messages) = match ranks {
        TimedRanks::Processes(communicator) => run(Arc::clone(communicator))?,
        TimedRanks::Threads(count) => std::thread::scope(|scope| {
            let run = &run;
            let started: Vec<_> = ThreadRank::create_all(count)
                .into_iter()
                .map(|rank| scope.spawn(move || run(Arc::new(rank))))
                .collect();
            let join = |own: std::thread::ScopedJoinHandle<_>| {
                own.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            let found: Vec<(f64, Option<[f64; 2]>)> =
                started.into_iter().map(join).collect::<Result<_, DomainError>>()?;
            Ok(found[0])
        })?,
    };
    let greatest = |value: fn(&RankPart<2>) -> f64| parts.iter().map(value).fold(0.0, f64::max);
    Ok(Measurement {
        ranks: ranks.count(),
        are_processes: matches!(ranks, TimedRanks::Processes(_)),
        step_time,
        stored_cells: greatest(|own| own.stored_cells as f64),
        sent: [greatest(|own| own.messages_per_step), greatest(|own| own.bytes_per_step)],
        messages,
    })
}

/// Measures latency, s, and bandwidth, bytes/s, of messages between the first and the last rank; all ranks call it, and
/// the root gets them.
fn measure_messages(communicator: &dyn Communicator) -> Option<[f64; 2]> {
    let (rank, last) = (communicator.rank(), communicator.size() - 1);
    if last == 0 || (rank != 0 && rank != last) {
        return None;
    }
    let [short, long] = [SHORT_MESSAGE, LONG_MESSAGE].map(|(length, trips)| {
        let mut message = vec![0; length];
        let start = Instant::now();
        for _ in 0..trips {
            if rank == 0 {
                communicator.begin_send(last, TAG, message.clone());
                communicator.receive(last, TAG, &mut message);
            } else {
                communicator.receive(0, TAG, &mut message);
                communicator.begin_send(0, TAG, message.clone());
            }
        }
        start.elapsed().as_secs_f64() / f64::from(2 * trips)
    });
    let transfer = (long - short).max(f64::MIN_POSITIVE);
    Some([short, LONG_MESSAGE.0 as f64 / transfer])
}

/// Returns a number in [−1, 1) that looks random.
fn noise(cell: usize, index: usize) -> f64 {
    let mut state = (cell as u64) ^ ((index as u64 + 1) << 40);
    state = (state ^ (state >> 31)).wrapping_mul(0x7fb5_d329_728e_a185);
    state = (state ^ (state >> 27)).wrapping_mul(0x81da_def4_bc2d_d44d);
    ((state ^ (state >> 33)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_other_numbers_of_ranks_are_added() {
        let row = |ranks: usize, are_processes: bool| TimingRow {
            ranks,
            are_processes,
            blocks: 5,
            cells: 400,
            step_time: 1.0,
            model_time: 1.0,
            cell_time: 1e-8,
            crossing_steps: 3,
            messages: None,
        };
        let result = |rows: Vec<TimingRow>| TimingResult {
            steps: 20,
            thread_count: 1,
            exponents: rows.iter().map(|row| (row.ranks, 3.0)).collect(),
            rows,
        };
        let earlier = result(vec![row(1, false), row(2, false), row(8, true)]);
        let mut own = result(vec![row(2, true)]);
        let mut other = TimingResult { steps: 10, ..own.clone() };
        own.add_earlier_rows(earlier.clone());
        assert_eq!(own, result(vec![row(1, false), row(2, true), row(8, true)]));
        // Times of other rounds are not comparable.
        other.add_earlier_rows(earlier);
        assert_eq!(other.rows, [row(2, true)]);
    }

    #[test]
    fn slopes_are_those_of_power_laws() {
        let points: Vec<[f64; 2]> =
            (1..6).map(|x| [f64::from(x), 3.0 * f64::from(x) - 7.0]).collect();
        assert!((fit_slope(&points).expect("a slope") - 3.0).abs() < 1e-12);
        assert_eq!(fit_slope(&points[..1]), None);
        assert!((0..1000).all(|cell| (-1.0..1.0).contains(&noise(cell, 3))));
    }
}
