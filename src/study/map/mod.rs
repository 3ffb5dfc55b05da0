//! Map: the verdict over two parameters of a case.

mod boundaries;
mod certified;
mod distribution;
mod point_assessor;
mod points;
pub mod samples;
pub mod summary;

pub use boundaries::{MapBoundaries, STEP_PARTS};
pub use certified::{CELL_PARTS, CertifiedMap};
pub use point_assessor::{MapPoint, PointSpeeds, PointStatus};
pub use points::{MapCode, MapNumber, MapPoints};
pub use samples::{MapSamples, WaveSample, sample_map};
pub use summary::MapResult;

use super::available_memory::AvailableMemory;
use super::simulate::Bytes;
use super::{ProgressCallback, report_progress};
use crate::case::{Case, MapAxes, ModelKind, ParameterSweep};
use crate::{Error, setup};
use analysis::solids::AcousticTensorCache;
use certified::certify_map;
use distribution::Distribution;
use dynamics::decomposition::communicator::{Communicator, SingleProcess};
use models::InputError;
use point_assessor::PointAssessor;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Memory of the program, a block of points and two files of a picture, bytes, by measurement, which a map needs besides its
/// points.
const PROGRAM_MEMORY_BYTES: f64 = 81.0 * 1048576.0;

/// Bytes for each point that the picture has, by measurement, and the largest number of such points along each axis.
const PICTURE_BYTES_PER_POINT: usize = 50;
const MAX_PICTURE_POINTS: [usize; 2] = [1300, 900];

/// Bytes that a map stores for each point besides its numbers: three codes, the places of two boundaries, and whether it is
/// on a line; its category in the picture and two marks of lines while it is drawn.
const MARKS_PER_POINT: usize = 9;

/// Number of points that a thread assesses between progress reports.
const POINTS_PER_PROGRESS_REPORT: usize = 64;

/// Number of points that are assessed together, before they are stored in compact form and exchanged between ranks.
const POINTS_PER_BLOCK: usize = 1024 * POINTS_PER_PROGRESS_REPORT;

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
    /// Whether to prove verdicts for all states of the cells between points.
    #[serde(rename = "certified")]
    pub is_certified: bool,
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
/// The case has no map or is invalid at all of its points, memory is insufficient, or nothing can be proved over cells where
/// that is asked for; [`Error::Cancelled`].
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
    check_map_memory(case, options)?;
    compute_map_on_ranks(case, options, &SingleProcess, progress)
}

/// Assesses all states of the map of a case as [`compute_map`] does, on several ranks, each on the rayon thread pool in
/// which it is called. All ranks get the whole result, which does not depend on their number; proofs over cells are repeated
/// on every rank. All of them call it with
/// the same case and options, after [`check_map_memory`]. `progress` is that of this rank; with several ranks it must not
/// cancel.
///
/// # Errors
/// The case has no map or is invalid at all of its points; [`Error::Cancelled`].
pub fn compute_map_on_ranks(
    case: &Case,
    options: MapOptions,
    communicator: &dyn Communicator,
    progress: ProgressCallback,
) -> Result<MapResult, Error> {
    case.check_without_contacts()?;
    let map = case.require_map()?;
    let options = options.with_swept_wave(map);
    // The number of changes of the verdict is unknown before all points are assessed. One boundary across the map
    // changes the verdict on at most as many steps as the map has rows and columns.
    let (nx, ny) = (map.x.point_count, map.y.point_count);
    let boundary_share = boundaries::BISECTION_COUNT * (nx + ny);
    let certified_share = if options.is_certified { nx * ny } else { 0 };
    let all = certified_share + nx * ny + boundary_share;
    let certified = match options.is_certified {
        true => {
            Some(certify_map(case, &|done, count| progress(certified_share * done / count, all))?)
        }
        false => None,
    };
    let assessed = |done, _| progress(certified_share + done, all);
    let points = assess_points(case, map, options, communicator, &assessed)?;
    let located = |done: usize, changes: usize| {
        progress(certified_share + nx * ny + boundary_share * done / changes.max(1), all)
    };
    let boundaries = MapBoundaries::locate(case, map, options, &points, (communicator, &located))?;
    report_progress(progress, all, all)?;
    Ok(MapResult::new(case, map, options, points, boundaries, certified))
}

/// Estimates the peak memory of the map of a case and of its output, bytes: that of the program with a block of points and
/// a picture, and of each point its numbers, codes and marks. Files are written row by row. A map all of whose steps change
/// the verdict needs more while the changes are located.
///
/// # Errors
/// The case has no map.
pub fn estimate_map_memory(case: &Case, options: MapOptions) -> Result<Bytes, Error> {
    let map = case.require_map()?;
    let points = map.x.point_count as f64 * map.y.point_count as f64;
    let MapOptions { computes_bound, computes_growth_rate, .. } = options.with_swept_wave(map);
    // Order, coefficient and directions of the growth; the bound on the non-coaxiality, or the speeds.
    let number_count = match case.material.kind {
        ModelKind::Flow(_) => 4,
        ModelKind::Equations | ModelKind::Rheology => 5,
        ModelKind::Solid(_) => 8,
    } + usize::from(computes_bound)
        + usize::from(computes_growth_rate);
    let parts = if options.is_certified { CELL_PARTS * CELL_PARTS } else { 0 };
    let of_point = size_of::<f64>() * number_count + MARKS_PER_POINT + parts;
    let [columns, rows] = MAX_PICTURE_POINTS;
    let drawn = map.x.point_count.min(columns) * map.y.point_count.min(rows);
    let picture = PROGRAM_MEMORY_BYTES + (PICTURE_BYTES_PER_POINT * drawn) as f64;
    Ok(Bytes(picture + points * of_point as f64))
}

/// Checks that memory suffices for the map of a case.
///
/// # Errors
/// The case has no map, or memory is insufficient.
pub fn check_map_memory(case: &Case, options: MapOptions) -> Result<(), Error> {
    let map = case.require_map()?;
    let needed = estimate_map_memory(case, options)?;
    let Some(available) = AvailableMemory::find_shortage(needed) else { return Ok(()) };
    let points = map.x.point_count as f64 * map.y.point_count as f64;
    let found = format!("{points} points, memory {needed}, more than {available}");
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
/// The case has no map or is invalid at all of its points; [`Error::Cancelled`].
pub fn check_map(case: &Case, on_progress: ProgressCallback) -> Result<(), Error> {
    let map = case.require_map()?;
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

/// Assesses all points of a map, of which each rank assesses a part, and returns them with x fastest.
fn assess_points(
    case: &Case,
    map: &MapAxes,
    options: MapOptions,
    communicator: &dyn Communicator,
    progress: ProgressCallback,
) -> Result<MapPoints, Error> {
    let (nx, ny) = (map.x.point_count, map.y.point_count);
    let count = nx * ny;
    let mut points = MapPoints::new(count)?;
    let is_transposed = is_transposed(case, map);
    let grid_indices = |index: usize| match is_transposed {
        true => [index / ny, index % ny],
        false => [index % nx, index / nx],
    };
    let cache = AcousticTensorCache::default();
    let (done, is_cancelled) = (AtomicUsize::new(0), AtomicBool::new(false));
    let distribution = Distribution::new(communicator, POINTS_PER_PROGRESS_REPORT);
    let block_starts = || (0..count).step_by(POINTS_PER_BLOCK);
    let block_length = |start: usize| POINTS_PER_BLOCK.min(count - start);
    let own_count: usize =
        block_starts().map(|start| distribution.own_count(block_length(start))).sum();
    let mut first_invalid = None;
    for start in block_starts() {
        let mut block = vec![MapPoint::with_status(PointStatus::OutsideModel); block_length(start)];
        let invalid = block
            .par_chunks_mut(POINTS_PER_PROGRESS_REPORT)
            .enumerate()
            .filter(|(chunk, _)| distribution.is_own(*chunk))
            .map_init(
                || PointAssessor::new(case, map, options, &cache),
                |assessor, (chunk, part)| {
                    let mut first_invalid = None;
                    if is_cancelled.load(Ordering::Relaxed) {
                        return first_invalid;
                    }
                    for (offset, point) in part.iter_mut().enumerate() {
                        let index = start + chunk * POINTS_PER_PROGRESS_REPORT + offset;
                        let [x, y] = grid_indices(index);
                        match assessor.assess_point(x, y) {
                            Ok(assessed) => *point = assessed,
                            Err(_) => _ = first_invalid.get_or_insert(index),
                        }
                    }
                    let steps = done.fetch_add(part.len(), Ordering::Relaxed) + part.len();
                    if progress(steps * count / own_count, count).is_break() {
                        is_cancelled.store(true, Ordering::Relaxed);
                    }
                    first_invalid
                },
            )
            .flatten()
            .min();
        if is_cancelled.load(Ordering::Relaxed) {
            return Err(Error::Cancelled);
        }
        first_invalid = first_invalid.or(invalid);
        distribution.exchange(&mut block, MapPoint::numbers, MapPoint::from_numbers);
        for (offset, point) in block.iter().enumerate() {
            let [x, y] = grid_indices(start + offset);
            points.set(y * nx + x, point)?;
        }
    }
    // A map may extend outside the range of the model; only a map that is entirely outside is an error.
    let is_outside = (0..count).all(|point| points.has_status(point, PointStatus::OutsideModel));
    if let Some(index) = distribution.find_least(first_invalid).filter(|_| is_outside) {
        let [x, y] = grid_indices(index);
        PointAssessor::new(case, map, options, &cache)
            .assess_point(x, y)
            .map_err(|error| setup::locate_map_point_error(case, error))?;
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::ignore_progress;
    use dynamics::decomposition::communicator::ThreadRank;

    /// Bundled cases with smaller maps: a flow, and a yielding solid whose points are assessed by columns.
    const CASES: [(&str, &[&str]); 2] = [
        ("granular-flow/noncoaxiality-bound.toml", &["map.x.points=31", "map.y.points=17"]),
        (
            "cosserat/flutter.toml",
            &[
                "map.x={ parameter = 'model.alpha', from = 0.1, to = 0.5, points = 15 }",
                "map.y.points=13",
            ],
        ),
    ];

    /// Map all of whose points are out of range of the model.
    const INVALID_CASE: (&str, &[&str]) = (
        "granular-flow/noncoaxiality-bound.toml",
        &["background.density=-1", "map.x.points=19", "map.y.points=11"],
    );

    /// Computes the map of a case on `size` ranks and returns the results of all, or their errors.
    fn compute_on_ranks(case: &Case, size: usize) -> Vec<Result<MapResult, String>> {
        std::thread::scope(|scope| {
            let start = |rank: ThreadRank| {
                scope.spawn(move || {
                    let options = MapOptions::default();
                    compute_map_on_ranks(case, options, &rank, &ignore_progress)
                        .map_err(|error| error.to_string())
                })
            };
            let ranks: Vec<_> = ThreadRank::create_all(size).into_iter().map(start).collect();
            ranks.into_iter().map(|own| own.join().expect("no panic")).collect()
        })
    }

    fn load(name: &str, settings: &[&str]) -> Case {
        let path = format!("{}/cases/{name}", env!("CARGO_MANIFEST_DIR"));
        let settings: Vec<String> = settings.iter().map(|own| (*own).to_owned()).collect();
        Case::load(path.as_ref(), &settings).expect("a case")
    }

    #[test]
    fn maps_do_not_depend_on_ranks() {
        for (name, settings) in CASES {
            let case = load(name, settings);
            let expected = compute_map(&case, MapOptions::default(), &ignore_progress);
            let expected = expected.expect("a map");
            let bits = |map: &MapResult| -> Vec<u64> {
                let points = map.points.iter().flat_map(|point| point.numbers());
                let places = map.boundaries.step_parts.iter().flat_map(|own| own.iter().copied());
                points.map(f64::to_bits).chain(places.map(u64::from)).collect()
            };
            for size in [2, 3, 40] {
                for found in compute_on_ranks(&case, size) {
                    let found = found.expect("a map");
                    assert!(bits(&found) == bits(&expected), "{name}, {size} ranks");
                    assert_eq!(found.status_counts, expected.status_counts);
                }
            }
        }
    }

    #[test]
    fn all_ranks_refuse_a_map_without_valid_point() {
        let (name, settings) = INVALID_CASE;
        let case = load(name, settings);
        let expected = compute_map(&case, MapOptions::default(), &ignore_progress);
        let expected = expected.expect_err("no valid point").to_string();
        for found in compute_on_ranks(&case, 3) {
            assert_eq!(found.expect_err("no valid point"), expected);
        }
    }
}
