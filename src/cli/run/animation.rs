//! Animation of the snapshots in a results folder.

use crate::case::Case;
use crate::cli::CommandError;
use crate::cli::folder::{
    OutputError, ResultFolder, SNAPSHOT_LIST_FILE, is_snapshot_name, joint_snapshot_file_name,
};
use crate::report::PictureOptions;
use crate::report::run::{AnimationFrame, FrameConverter, FrameScale};
use files::read_regular_file;
use std::path::Path;

/// File name of the animation.
pub(in crate::cli) const ANIMATION_FILE: &str = "animation.gif";

/// Animation that is to be written to a results folder, if any.
pub(in crate::cli) enum AnimationOutput {
    /// The case requests no snapshots, there are fewer than two, or no pictures are drawn.
    NoAnimation,
    /// All values are zero. An existing animation, which shows another quantity, must be removed.
    AllZero,
    /// Content of the GIF file.
    Gif(Vec<u8>),
}

/// Draws the snapshots of a run as an animation with a common colour scale, if the case requests snapshots.
///
/// # Errors
/// A snapshot is missing or not of this case, or the animation cannot be drawn.
pub(in crate::cli) fn draw_animation(
    case: &Case,
    folder: &ResultFolder,
    pictures: &PictureOptions,
) -> Result<AnimationOutput, CommandError> {
    if pictures.formats.is_empty() {
        return Ok(AnimationOutput::NoAnimation);
    }
    let Some(frames) = FrameConverter::new(case)? else { return Ok(AnimationOutput::NoAnimation) };
    let list = folder.path().join(SNAPSHOT_LIST_FILE);
    let unreadable = |path: &Path, error| OutputError::from_read_error(path, &error);
    let bytes = read_regular_file(&list).map_err(|error| unreadable(&list, error))?;
    let names = files::vti::parse_collection(&String::from_utf8_lossy(&bytes));
    // A list with other names was not written by this program.
    if let Some(odd) = names.iter().find(|name| !is_snapshot_name(name)) {
        return Err(OutputError::from_invalid_content(
            &list,
            format!("names '{odd}', no snapshot"),
        )
        .into());
    }
    if names.len() < 2 {
        return Ok(AnimationOutput::NoAnimation);
    }
    // Snapshots are read twice, for the scale and for the frames, to limit memory.
    let all = || {
        names.iter().enumerate().map(|(index, name)| -> Result<AnimationFrame, CommandError> {
            let read =
                |path: &Path| read_regular_file(path).map_err(|error| unreadable(path, error));
            let path = folder.path().join(name);
            let mut frame = frames
                .read_frame(&read(&path)?)
                .map_err(|cause| OutputError::from_invalid_content(&path, cause))?;
            if frames.has_joints() {
                let path = folder.path().join(joint_snapshot_file_name(index));
                frames
                    .read_joints(&mut frame, &read(&path)?)
                    .map_err(|cause| OutputError::from_invalid_content(&path, cause))?;
            }
            Ok(frame)
        })
    };
    let scale = all().try_fold(FrameScale::default(), |scale, frame| {
        Ok::<_, CommandError>(scale.max(frame?.scale()))
    })?;
    if scale.max_magnitude == 0.0 {
        return Ok(AnimationOutput::AllZero);
    }
    Ok(AnimationOutput::Gif(frames.draw_animation(scale, names.len(), all())?))
}
