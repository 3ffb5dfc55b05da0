//! Animation of the snapshots in a results folder.

use crate::case::Case;
use crate::cli::Error;
use crate::cli::folder::{OutputError, ResultFolder, SNAPSHOTS, is_snapshot};
use crate::report::run::{Frame, Frames};
use files::read_regular;
use std::path::Path;

/// File name of the animation.
pub(in crate::cli) const ANIMATION: &str = "animation.gif";

/// Animation to be written to a folder.
pub(in crate::cli) enum Animation {
    /// The case requests no animation, or there are fewer than two snapshots.
    None,
    /// All values are zero: an existing animation, of another quantity, must be removed.
    Empty,
    /// Content of the GIF file.
    Drawn(Vec<u8>),
}

/// Draws the snapshots of a run as an animation with a common colour scale, if the case requests snapshots.
///
/// # Errors
/// A snapshot is missing or not of this case, or the animation cannot be drawn.
pub(in crate::cli) fn animation(case: &Case, folder: &ResultFolder) -> Result<Animation, Error> {
    let Some(frames) = Frames::new(case)? else { return Ok(Animation::None) };
    let list = folder.path().join(SNAPSHOTS);
    let unreadable = |path: &Path, error| OutputError::unreadable(path, &error);
    let bytes = read_regular(&list).map_err(|error| unreadable(&list, error))?;
    let names = files::vti::collected(&String::from_utf8_lossy(&bytes));
    // A list with other names was not written by this program.
    if let Some(odd) = names.iter().find(|name| !is_snapshot(name)) {
        return Err(OutputError::unusable(&list, format!("names '{odd}', no snapshot")).into());
    }
    if names.len() < 2 {
        return Ok(Animation::None);
    }
    // Snapshots are read twice, for the scale and for the frames, to limit memory.
    let all = || {
        names.iter().map(|name| -> Result<Frame, Error> {
            let path = folder.path().join(name);
            let bytes = read_regular(&path).map_err(|error| unreadable(&path, error))?;
            Ok(frames.frame(&bytes).map_err(|cause| OutputError::unusable(&path, cause))?)
        })
    };
    let greatest =
        all().try_fold(0.0f64, |sum, frame| Ok::<_, Error>(sum.max(frame?.greatest())))?;
    if greatest == 0.0 {
        return Ok(Animation::Empty);
    }
    Ok(Animation::Drawn(frames.animation(greatest, all())?))
}
