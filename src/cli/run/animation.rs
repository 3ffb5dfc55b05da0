//! The animation of the snapshots in a folder of results.

use crate::case::Case;
use crate::cli::Error;
use crate::cli::folder::{OutputError, ResultFolder, SNAPSHOTS, is_snapshot};
use crate::report::run::{Frame, Frames};
use files::read_regular;
use std::path::Path;

/// The name of its file.
pub(in crate::cli) const ANIMATION: &str = "animation.gif";

/// What becomes of the animation of a folder.
pub(in crate::cli) enum Animation {
    /// The case asks for none.
    None,
    /// Nothing is seen in its picture: there may be one of another picture, which is to go.
    Empty,
    /// The bytes of its file.
    Drawn(Vec<u8>),
}

/// Draws the snapshots of a run one after the other, in one scale of colours, if the case asks for any.
///
/// # Errors
/// A snapshot is missing or no snapshot of this case, or the animation cannot be made.
pub(in crate::cli) fn animation(case: &Case, folder: &ResultFolder) -> Result<Animation, Error> {
    let Some(frames) = Frames::new(case)? else { return Ok(Animation::None) };
    let list = folder.path().join(SNAPSHOTS);
    let unreadable = |path: &Path, error| OutputError::unreadable(path, &error);
    let bytes = read_regular(&list).map_err(|error| unreadable(&list, error))?;
    let names = files::vti::collected(&String::from_utf8_lossy(&bytes));
    // A list that leads elsewhere is none of this program's.
    if let Some(odd) = names.iter().find(|name| !is_snapshot(name)) {
        return Err(OutputError::unusable(&list, format!("names '{odd}', no snapshot")).into());
    }
    if names.len() < 2 {
        return Ok(Animation::None);
    }
    // Twice through all, not to hold them all.
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
