//! Cost of a run besides memory: time, files and bytes, estimated to within a factor of a few, and limits above which
//! it is refused.

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
/// Estimated bytes of a number in a table.
const BYTES_PER_TABLE_NUMBER: f64 = 20.0;

/// Limit of single-thread time, s: thirty days.
const MAX_TIME: f64 = 30.0 * 86400.0;
/// Limit of the number of steps.
const MAX_STEPS: f64 = 1e10;
/// Limit of the number of snapshots.
const MAX_SNAPSHOTS: f64 = 1e5;
/// Limit of the bytes of all tables, and of the bytes of all snapshots.
const MAX_BYTES: f64 = 1e12;

/// Estimated cost of a run; for a flow a lower bound, since steps may be shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Number of steps.
    pub steps: f64,
    /// Estimated time of a single thread, s.
    pub time: f64,
    /// Number of snapshot files.
    pub snapshots: f64,
    /// Bytes of all snapshots.
    pub snapshot_bytes: Bytes,
    /// Bytes of the tables.
    pub table_bytes: Bytes,
}

/// Cost above its limit, which is presumably unintended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostExcess {
    /// Key of the case that determines the amount, such as `time.duration`.
    pub key: &'static str,
    /// Estimated amount.
    pub found: CostAmount,
    /// Largest amount that is not refused.
    pub allowed: CostAmount,
}

/// Amount of one kind of cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CostAmount {
    /// Number of steps.
    Steps(f64),
    /// Single-thread time, s.
    Time(f64),
    /// Number of snapshot files.
    Snapshots(f64),
    /// Bytes of all snapshots.
    SnapshotBytes(Bytes),
    /// Bytes of tables.
    TableBytes(Bytes),
}

/// Amount of output that a run writes to files.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutputVolume {
    /// Number of snapshot files.
    pub(super) snapshots: f64,
    /// Numbers stored per snapshot.
    pub(super) numbers_per_snapshot: f64,
    /// Numbers in all tables.
    pub(super) table_numbers: f64,
}

impl Cost {
    fn new(steps: f64, time: f64, written: OutputVolume) -> Self {
        let OutputVolume { snapshots, numbers_per_snapshot, table_numbers } = written;
        Self {
            steps,
            time,
            snapshots,
            snapshot_bytes: Bytes(snapshots * numbers_per_snapshot * size_of::<f64>() as f64),
            table_bytes: Bytes(table_numbers * BYTES_PER_TABLE_NUMBER),
        }
    }

    /// Estimates the cost of `steps` steps of a solid with `numbers` field values in all cells; `is_full` stands for a
    /// ledger with numerical dissipation.
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
        self.find_excess().map_or(Ok(()), |CostExcess { key, found, allowed }| {
            let allowed = format!("at most {allowed}; --force runs it all the same");
            Err(located(key, format!("found {found}"), allowed).into())
        })
    }

    /// Returns the first amount of the cost that exceeds its limit; `None` if none does.
    pub fn find_excess(&self) -> Option<CostExcess> {
        use CostAmount::{SnapshotBytes, Snapshots, Steps, TableBytes, Time};
        let all = [
            ("time.duration", Steps(self.steps), Steps(MAX_STEPS)),
            ("output.snapshot_interval", Snapshots(self.snapshots), Snapshots(MAX_SNAPSHOTS)),
            (
                "output.snapshot_interval",
                SnapshotBytes(self.snapshot_bytes),
                SnapshotBytes(Bytes(MAX_BYTES)),
            ),
            ("output.ledger_interval", TableBytes(self.table_bytes), TableBytes(Bytes(MAX_BYTES))),
            ("time.duration", Time(self.time), Time(MAX_TIME)),
        ];
        let excess =
            |(key, found, allowed): (_, CostAmount, CostAmount)| CostExcess { key, found, allowed };
        // NaN counts as above the limit.
        let is_too_much = |own: &CostExcess| {
            own.found.value().is_nan() || own.found.value() > own.allowed.value()
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
