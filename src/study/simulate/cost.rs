//! What a run takes beside memory: time, files and bytes, from rates that hold within a factor of a few; and how much of
//! it is taken for a mistake.

use super::Bytes;
use crate::Error;
use crate::case::CaseError;

/// Numbers of fields of solids that a thread advances by a sweep along each axis, 1/s.
const FIELD_UPDATES: f64 = 1e9;
/// How many times longer the full ledger takes.
const FULL_LEDGER: f64 = 50.0;
/// What a step of a solid takes at least, s.
const STEP: f64 = 5e-6;
/// Points of a flow that a thread evaluates, the iterations of the pressure included, 1/s.
const POINT_EVALUATIONS: f64 = 7e5;
/// Bytes of a number in a table.
const CELL: f64 = 20.0;

/// Most time of one thread, s: thirty days.
const MOST_TIME: f64 = 30.0 * 86400.0;
/// Most steps.
const MOST_STEPS: f64 = 1e10;
/// Most snapshots.
const MOST_SNAPSHOTS: f64 = 1e5;
/// Most bytes of the tables, or of all snapshots.
const MOST_BYTES: f64 = 1e12;

/// What a run takes. Of a flow it is the least: steps may have to be shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Steps.
    pub steps: f64,
    /// Time of one thread, s.
    pub time: f64,
    /// Files of snapshots.
    pub snapshots: f64,
    /// Their bytes.
    pub snapshot_bytes: Bytes,
    /// Bytes of the tables.
    pub table_bytes: Bytes,
}

/// A cost that is taken for a mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// The key that asks for it.
    pub key: &'static str,
    /// What it takes.
    pub found: Amount,
    /// The most that is taken for meant.
    pub allowed: Amount,
}

/// An amount of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Steps.
    Steps(f64),
    /// Time of one thread, s.
    Time(f64),
    /// Files of snapshots.
    Snapshots(f64),
    /// Bytes of all snapshots.
    SnapshotBytes(Bytes),
    /// Bytes of tables.
    TableBytes(Bytes),
}

/// What goes to files.
#[derive(Clone, Copy, Debug)]
pub(super) struct Written {
    /// Files of snapshots.
    pub(super) snapshots: f64,
    /// Numbers in each of them.
    pub(super) numbers: f64,
    /// Numbers in all tables.
    pub(super) cells: f64,
}

impl Cost {
    fn new(steps: f64, time: f64, written: Written) -> Self {
        let Written { snapshots, numbers, cells } = written;
        Self {
            steps,
            time,
            snapshots,
            snapshot_bytes: Bytes(snapshots * numbers * size_of::<f64>() as f64),
            table_bytes: Bytes(cells * CELL),
        }
    }

    /// Of so many steps of a solid with so many numbers in all cells.
    pub(super) fn of_solid(steps: f64, numbers: f64, is_full: bool, written: Written) -> Self {
        let slower = if is_full { FULL_LEDGER } else { 1.0 };
        // A step is two sweeps along each axis.
        let step = STEP + 2.0 * numbers * slower / FIELD_UPDATES;
        Self::new(steps, steps * step, written)
    }

    /// Of so many steps of a flow, and evaluations of its equations in so many points.
    pub(super) fn of_flow([steps, evaluations]: [f64; 2], points: f64, written: Written) -> Self {
        Self::new(steps, evaluations * (STEP + points / POINT_EVALUATIONS), written)
    }

    /// That none of its parts is too much.
    ///
    /// # Errors
    /// One is: what `located` makes of its key, what was found and what is allowed.
    pub(super) fn refuse_excess(
        &self,
        located: impl FnOnce(&str, String, String) -> CaseError,
    ) -> Result<(), Error> {
        self.excess().map_or(Ok(()), |Excess { key, found, allowed }| {
            let allowed = format!("at most {allowed}; --force runs it all the same");
            Err(located(key, format!("found {found}"), allowed).into())
        })
    }

    /// The first of its parts that is too much.
    pub fn excess(&self) -> Option<Excess> {
        use Amount::{SnapshotBytes, Snapshots, Steps, TableBytes, Time};
        let all = [
            ("time.duration", Steps(self.steps), Steps(MOST_STEPS)),
            ("output.snapshot_interval", Snapshots(self.snapshots), Snapshots(MOST_SNAPSHOTS)),
            (
                "output.snapshot_interval",
                SnapshotBytes(self.snapshot_bytes),
                SnapshotBytes(Bytes(MOST_BYTES)),
            ),
            ("output.ledger_interval", TableBytes(self.table_bytes), TableBytes(Bytes(MOST_BYTES))),
            ("time.duration", Time(self.time), Time(MOST_TIME)),
        ];
        let excess = |(key, found, allowed): (_, Amount, Amount)| Excess { key, found, allowed };
        // What is no number is too much as well.
        let is_too_much =
            |own: &Excess| own.found.value().is_nan() || own.found.value() > own.allowed.value();
        all.into_iter().map(excess).find(is_too_much)
    }
}

impl Amount {
    fn value(self) -> f64 {
        match self {
            Self::Steps(own) | Self::Time(own) | Self::Snapshots(own) => own,
            Self::SnapshotBytes(Bytes(own)) | Self::TableBytes(Bytes(own)) => own,
        }
    }
}
