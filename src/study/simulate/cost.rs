//! Estimated cost of a run in time, files and bytes, correct to within a factor of a few, and the limits above which a
//! run is refused.

use super::Bytes;
use crate::Error;
use crate::case::CaseError;

/// Throughput of the solid solver per thread: field values advanced by half a step, which has one sweep along each
/// axis, 1/s.
const FIELD_UPDATE_RATE: f64 = 1e9;
/// Factor by which a ledger with numerical dissipation (`TotalsAndDissipation`) slows down the solid solver.
const FULL_LEDGER_SLOWDOWN: f64 = 50.0;
/// Overhead of a time step of a solid, or of an evaluation of the right-hand side of a flow, s.
const STEP_OVERHEAD: f64 = 5e-6;
/// Throughput of the flow solver per thread: evaluations of the right-hand side at a point, pressure iterations
/// included, 1/s.
const POINT_EVALUATION_RATE: f64 = 7e5;
/// Estimated size of a number in a table, bytes.
const BYTES_PER_TABLE_NUMBER: f64 = 20.0;

/// Limit of single-thread time, s: thirty days.
const MAX_SINGLE_THREAD_TIME: f64 = 30.0 * 86400.0;
/// Limit of the number of time steps.
const MAX_STEPS: f64 = 1e10;
/// Limit of the number of snapshots.
const MAX_SNAPSHOTS: f64 = 1e5;
/// Limit of the bytes of all tables, and of the bytes of all snapshots.
const MAX_BYTES: f64 = 1e12;

/// Estimated cost of a run; for a flow a lower bound, since steps may be shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Number of time steps of the run.
    pub step_count: f64,
    /// Estimated computing time of a single thread, s.
    pub single_thread_time: f64,
    /// Number of snapshot files.
    pub snapshot_count: f64,
    /// Total size of all snapshots.
    pub snapshot_bytes: Bytes,
    /// Total size of all tables.
    pub table_bytes: Bytes,
}

/// Cost above its limit, which is presumably unintended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostExcess {
    /// Key of the case that determines the amount, such as `time.duration`.
    pub key: &'static str,
    /// Estimated amount of this run.
    pub estimated_amount: CostAmount,
    /// Limit above which a run is refused.
    pub largest_amount: CostAmount,
}

/// Amount of one kind of cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CostAmount {
    /// Number of time steps.
    Steps(f64),
    /// Computing time of a single thread, s.
    Time(f64),
    /// Number of snapshot files.
    Snapshots(f64),
    /// Total size of all snapshots, bytes.
    SnapshotBytes(Bytes),
    /// Total size of all tables, bytes.
    TableBytes(Bytes),
}

/// Amount of output that a run writes to its files.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutputVolume {
    /// Number of snapshot files.
    pub(super) snapshot_count: f64,
    /// Number of values stored per snapshot.
    pub(super) numbers_per_snapshot: f64,
    /// Number of values in all tables.
    pub(super) numbers_in_tables: f64,
}

impl Cost {
    fn new(steps: f64, time: f64, written: OutputVolume) -> Self {
        let OutputVolume {
            snapshot_count: snapshots,
            numbers_per_snapshot,
            numbers_in_tables: table_numbers,
        } = written;
        Self {
            step_count: steps,
            single_thread_time: time,
            snapshot_count: snapshots,
            snapshot_bytes: Bytes(snapshots * numbers_per_snapshot * size_of::<f64>() as f64),
            table_bytes: Bytes(table_numbers * BYTES_PER_TABLE_NUMBER),
        }
    }

    /// Estimates the cost of `steps` time steps of a solid with `numbers` field values in all cells; `is_full` states
    /// whether the ledger includes numerical dissipation.
    pub(super) fn estimate_solid_cost(
        steps: f64,
        numbers: f64,
        is_full: bool,
        written: OutputVolume,
    ) -> Self {
        let slower = if is_full { FULL_LEDGER_SLOWDOWN } else { 1.0 };
        // A step has two sweeps along each axis.
        let step = STEP_OVERHEAD + 2.0 * numbers * slower / FIELD_UPDATE_RATE;
        Self::new(steps, steps * step, written)
    }

    /// Estimates the cost of a flow from the numbers of steps, of evaluations of the right-hand side and of grid
    /// points.
    pub(super) fn estimate_flow_cost(
        [steps, evaluations]: [f64; 2],
        points: f64,
        written: OutputVolume,
    ) -> Self {
        Self::new(steps, evaluations * (STEP_OVERHEAD + points / POINT_EVALUATION_RATE), written)
    }

    /// Checks that no amount of the cost exceeds its limit.
    ///
    /// # Errors
    /// An amount exceeds its limit; the error is the result of `located` for the responsible key, the amount and the
    /// limit.
    pub(super) fn refuse_excess(
        &self,
        located: impl FnOnce(&str, String, String) -> CaseError,
    ) -> Result<(), Error> {
        self.find_excess().map_or(
            Ok(()),
            |CostExcess { key, estimated_amount: found, largest_amount: allowed }| {
                let allowed = format!("expected at most {allowed}; --force runs it all the same");
                Err(located(key, format!("found {found}"), allowed).into())
            },
        )
    }

    /// Returns the first amount of the cost that exceeds its limit; `None` if none does.
    pub fn find_excess(&self) -> Option<CostExcess> {
        use CostAmount::{SnapshotBytes, Snapshots, Steps, TableBytes, Time};
        let all = [
            ("time.duration", Steps(self.step_count), Steps(MAX_STEPS)),
            ("output.snapshot_interval", Snapshots(self.snapshot_count), Snapshots(MAX_SNAPSHOTS)),
            (
                "output.snapshot_interval",
                SnapshotBytes(self.snapshot_bytes),
                SnapshotBytes(Bytes(MAX_BYTES)),
            ),
            ("output.ledger_interval", TableBytes(self.table_bytes), TableBytes(Bytes(MAX_BYTES))),
            ("time.duration", Time(self.single_thread_time), Time(MAX_SINGLE_THREAD_TIME)),
        ];
        let excess = |(key, found, allowed): (_, CostAmount, CostAmount)| CostExcess {
            key,
            estimated_amount: found,
            largest_amount: allowed,
        };
        // NaN counts as above the limit.
        let is_too_much = |own: &CostExcess| {
            own.estimated_amount.value().is_nan()
                || own.estimated_amount.value() > own.largest_amount.value()
        };
        all.into_iter().map(excess).find(is_too_much)
    }
}

impl CostAmount {
    fn value(self) -> f64 {
        match self {
            Self::Steps(own) | Self::Time(own) | Self::Snapshots(own) => own,
            Self::SnapshotBytes(Bytes(own)) | Self::TableBytes(Bytes(own)) => own,
        }
    }
}
