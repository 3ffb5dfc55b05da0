//! The animation of the snapshots in a folder of results.

use super::{flow, solid};
use crate::Error;
use crate::case::{Case, InTime};
use crate::output::{OutputError, ResultFolder, SNAPSHOTS};
use figures::{Animation, FieldFigure};

/// Draws the snapshots of a run one after the other, in one scale of colours, if the case asks for any.
///
/// # Errors
/// A snapshot is missing or no snapshot of this case, or the animation cannot be written.
pub fn animation(case: &Case, folder: &ResultFolder) -> Result<(), Error> {
    match case.in_time()? {
        InTime::Solid(dynamics) if dynamics.output.snapshot_interval > 0.0 => {
            let section = solid::Section::new(dynamics);
            let picture = dynamics.output.picture;
            let of_snapshot = |bytes: &[u8]| section.of_snapshot(bytes, picture);
            animate(folder, of_snapshot, |time, values| section.figure(case, picture, time, values))
        }
        InTime::Flow(run) if run.output.snapshot_interval > 0.0 => {
            let of_snapshot = |bytes: &[u8]| flow::of_snapshot(bytes, run);
            animate(folder, of_snapshot, |time, values| flow::figure(case, run, time, values))
        }
        _ => Ok(()),
    }
}

/// The values of a snapshot, or why there are none, and the figure of these at a time.
fn animate(
    folder: &ResultFolder,
    of_snapshot: impl Fn(&[u8]) -> Result<Vec<f64>, String>,
    figure: impl Fn(f64, Vec<f64>) -> FieldFigure,
) -> Result<(), Error> {
    const SECONDS_PER_FRAME: f64 = 0.1;
    const WIDTH: u32 = 800;
    const ANIMATION: &str = "animation.gif";
    let list = folder.path().join(SNAPSHOTS);
    let text = std::fs::read_to_string(&list).map_err(|e| OutputError::unreadable(&list, &e))?;
    let names = files::vti::collected(&text);
    if names.len() < 2 {
        return Ok(());
    }
    // Twice through all, not to hold them all.
    let values = |name: &str| -> Result<(f64, Vec<f64>), Error> {
        let path = folder.path().join(name);
        let unusable = |cause: String| OutputError::unusable(&path, cause);
        let bytes = std::fs::read(&path).map_err(|e| OutputError::unreadable(&path, &e))?;
        let time =
            files::vti::plain_time(&bytes).ok_or_else(|| unusable("has no time".to_owned()))?;
        Ok((time, of_snapshot(&bytes).map_err(unusable)?))
    };
    let mut greatest = 0.0f64;
    for name in &names {
        greatest = values(name)?.1.iter().fold(greatest, |sum, value| sum.max(value.abs()));
    }
    if greatest == 0.0 {
        // There may be one of another picture.
        return Ok(folder.remove_result(ANIMATION)?);
    }
    let mut animation = Animation::new(Vec::new(), SECONDS_PER_FRAME, WIDTH)?;
    for name in &names {
        let (time, values) = values(name)?;
        let mut figure = figure(time, values);
        figure.scale = Some(greatest);
        animation.add(&figure)?;
    }
    Ok(folder.write(ANIMATION, &animation.finish()?)?)
}

/// So many numbers of each cell in a snapshot by the name of the array, or why there are none.
pub(super) fn array(bytes: &[u8], name: &str, cells: usize) -> Result<Vec<f64>, String> {
    match files::vti::plain_values(bytes, name) {
        None => Err(format!("no array {name}")),
        Some(all) if all.len() < cells => Err(format!("too few values of {name}")),
        Some(all) => Ok(all),
    }
}
