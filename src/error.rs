//! Errors of the studies and of their reports.

use crate::case::CaseError;
use crate::study::certified::BoxRangeError;
use crate::study::simulate::IllPosedness;
use dynamics::decomposition::ThreadStartError;
use dynamics::simulation::RunError;

/// Reason why a study failed or its result could not be reported.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case cannot be read or is invalid.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The equations of the flow are ill-posed, and `SimulationSettings::accept_ill_posed` is not set.
    #[error("{0}; SimulationSettings::accept_ill_posed runs it all the same")]
    IllPosed(IllPosedness),
    /// A range of a number over which a verdict is to be proved is empty, or nothing is proved over that number.
    #[error(transparent)]
    BoxRange(#[from] BoxRangeError),
    /// The points of the map cannot be allocated.
    #[error("no memory for a map of {points} points: ask for fewer")]
    Memory {
        /// Number of points of the map that does not fit into memory.
        points: usize,
    },
    /// The progress callback cancelled the study.
    #[error("cancelled")]
    Cancelled,
    /// The recorder of a simulation ended the simulation with this error.
    #[error(transparent)]
    Recorder(Box<dyn std::error::Error + Send + Sync>),
    /// The threads of a time step of a simulation cannot be started; earlier steps have been recorded.
    #[error(transparent)]
    Threads(#[from] ThreadStartError),
    /// A result cannot be serialised.
    #[error("a result that cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A picture cannot be drawn, for example since a list of its values has the wrong length.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
    /// A table cannot be created, for example since a row has more or fewer cells than the header.
    #[error(transparent)]
    Table(#[from] files::csv::TableError),
    /// A data file of another program cannot be created.
    #[error("a data file that cannot be written: {0}")]
    DataFile(#[from] std::io::Error),
    /// An NPZ archive of arrays cannot be created.
    #[error(transparent)]
    Archive(#[from] files::npz::NpzError),
    /// A snapshot (VTK file) or a list of snapshots cannot be created.
    #[error(transparent)]
    Snapshot(#[from] files::vti::VtiError),
}

impl From<RunError<Self>> for Error {
    fn from(error: RunError<Self>) -> Self {
        match error {
            RunError::Observer(own) => own,
            RunError::Threads(error) => Self::Threads(error),
        }
    }
}
