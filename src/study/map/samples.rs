//! Growth rates against the direction, and dispersion roots, at a coarse grid of the points of a map.

use super::point_assessor::PointAssessor;
use super::{MapOptions, MapResult};
use crate::Error;
use crate::case::Case;
use crate::study::{ProgressCallback, report_progress};
use analysis::flows::Route;
use analysis::solids::AcousticTensorCache;
use rayon::prelude::*;

/// Largest number of sampled points along an axis.
pub const MAX_SAMPLES_PER_AXIS: usize = 41;

/// Number of intervals between the sampled directions.
const DIRECTION_INTERVALS: usize = 36;

/// Number of waves that are sampled on any map: they take less time than its picture.
const MIN_WAVE_COUNT: usize = 12_000;
/// Number of waves that are sampled in addition for each point whose verdict is from the linearised equations, which takes
/// several times as long.
const WAVES_PER_ASSESSED_POINT: usize = 2;

/// Number of samples between progress reports.
const SAMPLES_PER_PROGRESS_REPORT: usize = 128;

/// Waves at a coarse grid of the points of a map.
#[derive(Clone, Debug)]
pub struct MapSamples {
    /// Indices of the sampled values of x, ascending.
    pub columns: Vec<usize>,
    /// Indices of the sampled values of y, ascending.
    pub rows: Vec<usize>,
    /// Directions of the wave vector from x₁, degrees, from 0 to 180.
    pub directions_deg: Vec<f64>,
    /// Samples with x varying fastest; `None` where there is no state.
    pub points: Vec<Option<WaveSample>>,
}

/// Waves in one state.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveSample {
    /// Wave number of the case, 1/m.
    pub wave_number: f64,
    /// Direction of the wave vector of the case from x₁, degrees.
    pub direction_deg: f64,
    /// Largest Re ς at this wave number in each direction, 1/s; NaN without finite roots.
    pub growth_rates: Vec<f64>,
    /// Finite dispersion roots at this wave vector, Re ς and Im ς, 1/s.
    pub roots: Vec<[f64; 2]>,
}

/// Samples growth rates and roots at no more than [`MAX_SAMPLES_PER_AXIS`] points of a map along each axis, on the rayon
/// thread pool in which it is called; fewer if that took long beside the map. The result does not depend on the number of
/// threads.
///
/// # Errors
/// The case has no map; [`Error::Cancelled`].
pub fn sample_map(
    case: &Case,
    map: &MapResult,
    on_progress: ProgressCallback,
) -> Result<MapSamples, Error> {
    let axes = case.require_map()?;
    let assessed_count = map.route_counts[Route::ModelBlind as usize].1;
    let wave_count = MIN_WAVE_COUNT + WAVES_PER_ASSESSED_POINT * assessed_count;
    let counts = [map.x.point_count, map.y.point_count];
    let [columns, rows] = select_grid(counts, wave_count / DIRECTION_INTERVALS);
    let directions_deg: Vec<f64> = (0..=DIRECTION_INTERVALS)
        .map(|index| 180.0 * index as f64 / DIRECTION_INTERVALS as f64)
        .collect();
    let cache = AcousticTensorCache::default();
    let places: Vec<[usize; 2]> =
        rows.iter().flat_map(|&row| columns.iter().map(move |&column| [column, row])).collect();
    let mut points = Vec::with_capacity(places.len());
    for part in places.chunks(SAMPLES_PER_PROGRESS_REPORT) {
        report_progress(on_progress, points.len(), places.len())?;
        points.par_extend(part.par_iter().map_init(
            || PointAssessor::new(case, axes, MapOptions::default(), &cache),
            |assessor, &[column, row]| {
                let point = map.points.get(row * map.x.point_count + column);
                // A point outside the range of the model has no state.
                let sample = point.status.has_state().then(|| {
                    assessor.sample_position([column as f64, row as f64], &directions_deg).ok()
                });
                sample.flatten()
            },
        ));
    }
    Ok(MapSamples { columns, rows, directions_deg, points })
}

/// Selects indices along both axes, so that their grid has about `max_points` points at most.
fn select_grid(counts: [usize; 2], max_points: usize) -> [Vec<usize>; 2] {
    let mut selected = counts.map(|count| count.min(MAX_SAMPLES_PER_AXIS));
    while selected[0] * selected[1] > max_points.max(4) {
        let longer = usize::from(selected[1] > selected[0]);
        selected[longer] -= 1;
    }
    [0, 1].map(|axis| select_indices(counts[axis], selected[axis]))
}

/// Selects `selected` of `count` indices from the first to the last, as evenly as possible.
fn select_indices(count: usize, selected: usize) -> Vec<usize> {
    let last = selected.saturating_sub(1).max(1);
    (0..selected).map(|index| (index * (count - 1) + last / 2) / last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_extend_from_first_to_last() {
        assert_eq!(select_indices(1, 1), [0]);
        assert_eq!(select_indices(3, 3), [0, 1, 2]);
        for count in [41, 42, 80, 81, 1000] {
            let own = select_indices(count, 41);
            assert_eq!((own.len(), own[0], own[40]), (41, 0, count - 1));
            let steps: Vec<usize> = own.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
            assert!(*least > 0 && most - least <= 1, "{count}: {steps:?}");
        }
    }

    #[test]
    fn grids_have_at_most_the_points_of_the_map() {
        let counts = |counts, max| select_grid(counts, max).map(|own| own.len());
        assert_eq!(counts([1000, 500], 5000), [41, 41]);
        assert_eq!(counts([1000, 500], 333), [18, 18]);
        assert_eq!(counts([1000, 3], 333), [41, 3]);
        assert_eq!(counts([3, 1], 0), [3, 1]);
        assert_eq!(counts([9, 9], 40), [6, 6]);
    }
}
