//! Animation of the snapshots in a results folder.

use crate::case::Case;
use crate::cli::CommandError;
use crate::cli::folder::{
    OutputError, ResultFolder, SNAPSHOT_LIST_FILE, is_snapshot_name, joint_snapshot_file_name,
};
use crate::cli::progress::DelayedProgressBar;
use crate::report::PictureOptions;
use crate::report::run::{AnimationFrame, FrameConverter, FrameScale};
use figures::AnimationFormat;
use files::read_regular_file;
use std::path::Path;

/// Returns the file name of the animation in a format.
pub(in crate::cli) fn animation_file_name(format: AnimationFormat) -> String {
    format!("animation.{}", format.extension())
}

/// Animation that is to be written to a results folder, if any.
pub(in crate::cli) enum AnimationOutput {
    /// The case requests no snapshots, there are fewer than two, or no animations are drawn.
    NoAnimation,
    /// All values are zero. Existing animations, with these names, which show another quantity, must be removed.
    AllZero([String; 2]),
    /// Names and contents of the files.
    Files(Vec<(String, Vec<u8>)>),
}

/// Draws the snapshots of a run as animations with common scales, if the case requests snapshots, and shows the
/// progress.
///
/// # Errors
/// A snapshot is missing or not of this case, or the animation cannot be drawn.
pub(in crate::cli) fn draw_animation(
    case: &Case,
    folder: &ResultFolder,
    pictures: &PictureOptions,
) -> Result<AnimationOutput, CommandError> {
    let formats = pictures.animation_formats();
    if formats.is_empty() {
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
    let progress = DelayedProgressBar::new("animation", 0);
    let step_count = (names.len() * (1 + formats.len())) as u64;
    let (progress, frames, unreadable) = (&progress, &frames, &unreadable);
    // Snapshots are read for the scale and for the frames of each file, to limit memory; `first` is the number of steps
    // before.
    let all = |first: usize| {
        let read_frame =
            move |(index, name): (usize, &String)| -> Result<AnimationFrame, CommandError> {
                progress.advance_to((first + index) as u64, step_count);
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
            };
        names.iter().enumerate().map(read_frame)
    };
    let scale = all(0).try_fold(FrameScale::default(), |scale, frame| {
        Ok::<_, CommandError>(scale.and_later(frame?.scale()))
    })?;
    if scale.max_magnitude() == 0.0 {
        let formats = [AnimationFormat::Gif, AnimationFormat::Apng];
        return Ok(AnimationOutput::AllZero(formats.map(animation_file_name)));
    }
    let draw = |(index, format): (usize, &AnimationFormat)| {
        let snapshots = all((1 + index) * names.len());
        let bytes = frames.draw_animation(*format, scale, names.len(), snapshots)?;
        Ok((animation_file_name(*format), bytes))
    };
    let files: Result<_, CommandError> = formats.iter().enumerate().map(draw).collect();
    Ok(AnimationOutput::Files(files?))
}
