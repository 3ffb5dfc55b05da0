//! Why a question has no answer.

use crate::case::CaseError;
use crate::study::simulate::IllPosed;

/// Why a study was not carried out, or its result not reported.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case is wrong.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A flow that is not to be run in time unasked.
    #[error("{0}; Settings::accept_ill_posed runs it all the same")]
    IllPosed(IllPosed),
    /// No memory for the map.
    #[error("no memory for a map of {points} points: ask for fewer")]
    Memory {
        /// Number of points.
        points: usize,
    },
    /// A study was cancelled by whoever watched its progress.
    #[error("cancelled")]
    Cancelled,
    /// The recorder of a simulation ended it.
    #[error(transparent)]
    Recorder(Box<dyn std::error::Error + Send + Sync>),
    /// A result cannot be serialised.
    #[error("a result that cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
    /// A table could not be made.
    #[error(transparent)]
    Table(#[from] files::csv::RowLength),
    /// An archive of arrays could not be made.
    #[error(transparent)]
    Archive(#[from] files::npz::NpzError),
    /// A snapshot could not be made.
    #[error(transparent)]
    Snapshot(#[from] files::vti::VtiError),
}
