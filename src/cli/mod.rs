//! The verbs of the command line: from arguments to a study, its report and the folder of results.

mod check;
mod dispersion;
mod map;
mod plot;
mod point;
pub mod progress;
mod resume;
mod run;
mod speeds;

pub use check::{Disagreement, check};
pub use dispersion::dispersion;
pub use map::map;
pub use plot::plot;
pub use point::point;
pub use resume::resume;
pub use run::{CHECKPOINT_EVERY, Control, run};
pub use speeds::speeds;

use crate::Error;
use crate::output::ResultFolder;
use std::io::Write;

/// Says which files would be written.
fn would_write(folder: &ResultFolder, names: &[&str], stdout: &mut dyn Write) -> Result<(), Error> {
    for name in names {
        writeln!(stdout, "would write {}", folder.path().join(name).display())?;
    }
    Ok(())
}
