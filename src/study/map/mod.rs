//! Map: the verdict over two parameters of a case.

mod boundaries;
mod point_assessor;
pub mod samples;
pub mod summary;

pub use boundaries::MapBoundaries;
pub use point_assessor::{MapPoint, PointSpeeds, PointStatus};
pub use samples::{MapSamples, WaveSample, sample_map};
pub use summary::MapResult;

use super::available_memory::AvailableMemory;
use super::simulate::Bytes;
use super::{ProgressCallback, report_progress};
use crate::case::{Case, MapAxes, ParameterSweep};
use crate::{Error, setup};
use analysis::solids::AcousticTensorCache;
use models::InputError;
use point_assessor::PointAssessor;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Memory of the program and the picture, bytes, which a map needs in addition to its points and one table column.
const PROGRAM_MEMORY_BYTES: f64 = 60.0 * 1048576.0;

/// Number of points that a thread assesses between progress reports.
const POINTS_PER_PROGRESS_REPORT: usize = 64;

/// Quantities to be computed on a map besides the verdicts. Growth rates and their suprema need the dispersion
/// polynomial of every state; if they are computed, no verdict is by closed form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MapOptions {
    /// Whether to compute the supremum of the growth rate over all waves, for flows over those with at least the wave
    /// number of the background gradients, at well-posed points.
    #[serde(rename = "bound")]
    pub computes_bound: bool,
    /// Whether to compute the growth rate at the wave of the case; always done if the map sweeps the wave.
    #[serde(rename = "growth_rate")]
    pub computes_growth_rate: bool,
    /// Whether to derive every verdict from the linearised equations, none by closed form.
    #[serde(rename = "model_blind")]
    pub is_model_blind: bool,
}

impl MapOptions {
    /// Returns the options with growth rates if the map sweeps the wave.
    fn with_swept_wave(self, map: &MapAxes) -> Self {
        let sweeps_wave =
            [map.x, map.y].iter().any(|sweep| sweep.parameter.key().name.starts_with("wave."));
        Self { computes_growth_rate: self.computes_growth_rate || sweeps_wave, ..self }
    }

    fn admits_closed_forms(self) -> bool {
        !(self.computes_bound || self.computes_growth_rate || self.is_model_blind)
    }
}

/// Assesses all states of the map of a case on the rayon thread pool in which it is called. Points are independent,
/// hence the result does not depend on the number of threads.
///
/// # Errors
/// The case has no map or is invalid at all of its points, or memory is insufficient; [`Error::Cancelled`].
///
/// # Examples
/// Harris–Grekova without rotational strength is well-posed up to a non-coaxiality of 45°:
/// ```
/// use wellposed::case::Case;
/// use wellposed::study::{MapOptions, ignore_progress};
///
/// let case = Case::parse(
///     "
/// [model]
/// kind = 'harris-grekova'
/// friction_angle_deg = 30
/// moment_of_inertia = 1.25e-7
/// rotational_strength = 0
/// [background]
/// density = 1600
/// pressure = 1000
/// shear_rate = 2
/// stress_angle_deg = 0
/// [wave]
/// number = 500
/// [map]
/// x = { parameter = 'background.noncoaxiality_deg', from = 0, to = 90, points = 10 }
/// y = { parameter = 'background.pressure', from = 500, to = 1000, points = 2 }
/// ",
///     "map.toml",
///     &[],
/// )?;
/// let found = wellposed::compute_map(&case, MapOptions::default(), &ignore_progress)?;
/// assert_eq!(found.points.len(), 20);
/// let well_posed = &found.well_posed_intervals[0];
/// assert_eq!((well_posed.y, well_posed.x.as_slice()), (500.0, &[[0.0, 40.0]][..]));
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn compute_map(
    case: &Case,
    options: MapOptions,
    progress: ProgressCallback,
) -> Result<MapResult, Error> {
    case.check_without_contacts()?;
    let map = case.require_map()?;
    check_memory(case, map)?;
    let options = options.with_swept_wave(map);
    // The number of changes of the verdict is unknown before all points are assessed. One boundary across the map
    // changes the verdict on at most as many steps as the map has rows and columns.
    let (nx, ny) = (map.x.point_count, map.y.point_count);
    let boundary_share = boundaries::BISECTION_COUNT * (nx + ny);
    let all = nx * ny + boundary_share;
    let points = assess_points(case, map, options, &|done, _| progress(done, all))?;
    let boundaries = MapBoundaries::locate(case, map, options, &points, &|done, changes| {
        progress(nx * ny + boundary_share * done / changes, all)
    })?;
    report_progress(progress, all, all)?;
    Ok(MapResult::new(case, map, options, points, boundaries))
}

/// Checks that memory suffices for the points of a map, twice if they are transposed, and for one table column.
fn check_memory(case: &Case, map: &MapAxes) -> Result<(), Error> {
    let points = map.x.point_count as f64 * map.y.point_count as f64;
    let of_point = size_of::<MapPoint>() * if is_transposed(case, map) { 2 } else { 1 };
    let needed = Bytes(PROGRAM_MEMORY_BYTES + points * (of_point + size_of::<f64>()) as f64);
    let Some(available) = AvailableMemory::find_shortage(needed) else { return Ok(()) };
    let found = format!("found {points} points, memory {needed}, more than {available}");
    Err(case
        .locate_error(InputError {
            input: "map.x.points",
            rejected_value: found,
            allowed_values: "expected fewer points".into(),
        })
        .into())
}

/// Returns whether points are assessed column by column, with y fastest: if x sweeps a constant of the elastic law, y
/// does not, and the solid has a yield set. The acoustic tensor of the elastic moduli then depends on x alone and is
/// reused within a column.
fn is_transposed(case: &Case, map: &MapAxes) -> bool {
    let is_modulus = |sweep: &ParameterSweep| sweep.parameter.name().starts_with("model.");
    is_modulus(&map.x) && !is_modulus(&map.y) && case.material.yield_set.is_some()
}

/// Checks that at least one state of the map can be assessed. States are assessed in order until one succeeds; progress
/// counts those that fail.
///
/// # Errors
/// The case has no map or is invalid at all of its points, or memory is insufficient; [`Error::Cancelled`].
pub fn check_map(case: &Case, on_progress: ProgressCallback) -> Result<(), Error> {
    let map = case.require_map()?;
    check_memory(case, map)?;
    let cache = AcousticTensorCache::default();
    let mut assessor = PointAssessor::new(case, map, MapOptions::default(), &cache);
    let (nx, ny) = (map.x.point_count, map.y.point_count);
    let mut first_error = None;
    for index in 0..nx * ny {
        match assessor.assess_point(index % nx, index / nx) {
            Ok(_) => return Ok(()),
            Err(error) => _ = first_error.get_or_insert(error),
        }
        report_progress(on_progress, index + 1, nx * ny)?;
    }
    match first_error {
        Some(error) => Err(setup::locate_map_point_error(case, error)),
        None => Ok(()),
    }
}

/// Assesses all points of a map and returns them with x fastest.
fn assess_points(
    case: &Case,
    map: &MapAxes,
    options: MapOptions,
    progress: ProgressCallback,
) -> Result<Vec<MapPoint>, Error> {
    let (nx, ny) = (map.x.point_count, map.y.point_count);
    let mut points: Vec<MapPoint> = Vec::new();
    points.try_reserve_exact(nx * ny).map_err(|_| Error::Memory { points: nx * ny })?;
    points.resize(nx * ny, MapPoint::with_status(PointStatus::OutsideModel));

    let is_transposed = is_transposed(case, map);
    let grid_indices = |index: usize| match is_transposed {
        true => [index / ny, index % ny],
        false => [index % nx, index / nx],
    };
    let cache = AcousticTensorCache::default();
    let (done, is_cancelled) = (AtomicUsize::new(0), AtomicBool::new(false));
    let first_error = points
        .par_chunks_mut(POINTS_PER_PROGRESS_REPORT)
        .enumerate()
        .map_init(
            || PointAssessor::new(case, map, options, &cache),
            |assessor, (chunk, block)| {
                let mut first_error = None;
                if is_cancelled.load(Ordering::Relaxed) {
                    return first_error;
                }
                for (offset, point) in block.iter_mut().enumerate() {
                    let index = chunk * POINTS_PER_PROGRESS_REPORT + offset;
                    let [x, y] = grid_indices(index);
                    match assessor.assess_point(x, y) {
                        Ok(assessed) => *point = assessed,
                        Err(error) => {
                            first_error.get_or_insert((index, error));
                        }
                    }
                }
                let steps = done.fetch_add(block.len(), Ordering::Relaxed) + block.len();
                if progress(steps, nx * ny).is_break() {
                    is_cancelled.store(true, Ordering::Relaxed);
                }
                first_error
            },
        )
        .flatten()
        .min_by_key(|(index, _)| *index);
    if is_cancelled.into_inner() {
        return Err(Error::Cancelled);
    }
    if is_transposed {
        let by_column = points.clone();
        for (index, point) in by_column.into_iter().enumerate() {
            let [x, y] = grid_indices(index);
            points[y * nx + x] = point;
        }
    }
    // A map may extend outside the range of the model; only a map that is entirely outside is an error.
    match first_error {
        Some((_, error)) if points.iter().all(|p| p.status == PointStatus::OutsideModel) => {
            Err(setup::locate_map_point_error(case, error))
        }
        _ => Ok(points),
    }
}
