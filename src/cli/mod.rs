//! Verbs of the command line. Each runs a study, renders its report and writes the results folder.

pub mod cases;
mod check;
mod compare;
mod dispersion;
mod error;
pub mod folder;
mod homogenise;
mod load;
mod map;
pub mod new;
mod options;
mod plot;
mod point;
pub mod progress;
mod resume;
mod run;
pub mod signals;
mod speeds;
mod verify;
mod write;

pub use check::run_check;
pub use compare::{CompareOptions, run_compare};
pub use dispersion::run_dispersion;
pub use error::CommandError;
pub use homogenise::run_homogenise;
pub use map::run_map;
pub use options::{Options, OutputFormat};
pub use plot::plot;
pub use point::run_point;
pub use resume::resume;
pub use run::{CheckpointSettings, DEFAULT_CHECKPOINT_INTERVAL, run_simulation};
pub use speeds::run_speeds;
pub use verify::verify;
