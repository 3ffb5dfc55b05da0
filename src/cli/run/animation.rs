//! The animation of the snapshots in a folder of results.

use crate::case::Case;
use crate::cli::Error;
use crate::cli::folder::{OutputError, ResultFolder, SNAPSHOTS};
use crate::report::run::{Frame, Frames};

/// Draws the snapshots of a run one after the other, in one scale of colours, if the case asks for any.
///
/// # Errors
/// A snapshot is missing or no snapshot of this case, or the animation cannot be written.
pub(in crate::cli) fn animation(case: &Case, folder: &ResultFolder) -> Result<(), Error> {
    const ANIMATION: &str = "animation.gif";
    let Some(frames) = Frames::new(case)? else { return Ok(()) };
    let list = folder.path().join(SNAPSHOTS);
    let text = std::fs::read_to_string(&list).map_err(|e| OutputError::unreadable(&list, &e))?;
    let names = files::vti::collected(&text);
    if names.len() < 2 {
        return Ok(());
    }
    // Twice through all, not to hold them all.
    let all = || {
        names.iter().map(|name| -> Result<Frame, Error> {
            let path = folder.path().join(name);
            let bytes = std::fs::read(&path).map_err(|e| OutputError::unreadable(&path, &e))?;
            Ok(frames.frame(&bytes).map_err(|cause| OutputError::unusable(&path, cause))?)
        })
    };
    let greatest =
        all().try_fold(0.0f64, |sum, frame| Ok::<_, Error>(sum.max(frame?.greatest())))?;
    if greatest == 0.0 {
        // There may be one of another picture.
        return Ok(folder.remove_result(ANIMATION)?);
    }
    Ok(folder.write(ANIMATION, &frames.animation(greatest, all())?)?)
}
