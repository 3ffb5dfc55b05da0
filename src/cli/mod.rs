//! Verbs of the command line: each runs a study, renders its report and writes the results folder.

pub mod cases;
mod check;
mod dispersion;
mod error;
pub mod folder;
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

pub use check::check;
pub use dispersion::dispersion;
pub use error::Error;
pub use map::map;
pub use options::{Format, Options};
pub use plot::plot;
pub use point::point;
pub use resume::resume;
pub use run::{CHECKPOINT_EVERY, Control, run};
pub use speeds::speeds;
pub use verify::verify;
