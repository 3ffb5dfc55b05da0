//! Boundaries between the verdicts of neighbouring points of a map.

use super::distribution::Distribution;
use super::point_assessor::PointAssessor;
use super::{MapOptions, MapPoint, MapPoints, POINTS_PER_PROGRESS_REPORT, PointStatus};
use crate::Error;
use crate::case::{Case, MapAxes};
use crate::study::{ProgressCallback, report_progress};
use analysis::solids::AcousticTensorCache;
use dynamics::decomposition::communicator::Communicator;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Number of bisections of a step: a boundary is known to 1/16 of the step.
pub(super) const BISECTION_COUNT: usize = 4;
/// Number of parts of a step in which places of boundaries are whole numbers: bisection ends in the middle of an interval.
pub const STEP_PARTS: u8 = 2 << BISECTION_COUNT;
/// Number of parts of a step on which the verdict does not change.
const NO_CHANGE: u8 = u8::MAX;
/// Distance of boundaries from a point on both sides, as a fraction of the step, up to which the points with the verdict
/// in between are regarded as a set without area.
const LINE_TOLERANCE: f64 = 0.125;

/// Places where the verdict changes between neighbouring points of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapBoundaries {
    /// For each point the place of the change between it and the next point along x, and along y, as a number of parts of
    /// the step, of which there are [`STEP_PARTS`]; a larger number without change. Points are in the order of the map,
    /// with x varying fastest.
    pub step_parts: [Arc<Vec<u8>>; 2],
    /// Whether each point belongs to a set of equal verdicts without area, such as the states on a curve: the verdict
    /// changes at the point itself on both sides along x or along y.
    pub is_on_line: Arc<Vec<bool>>,
}

impl MapBoundaries {
    /// Locates the boundaries by bisection, of which each rank locates a part, on the rayon thread pool in which it is
    /// called; progress counts the changes of the verdict that this rank locates.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(super) fn locate(
        case: &Case,
        map: &MapAxes,
        options: MapOptions,
        points: &MapPoints,
        (communicator, progress): (&dyn Communicator, ProgressCallback),
    ) -> Result<Self, Error> {
        let counts = [map.x.point_count, map.y.point_count];
        let steps = [1, counts[0]];
        let position = |point: usize| [point % counts[0], point / counts[0]];
        let has_next = |point: usize, axis: usize| position(point)[axis] + 1 < counts[axis];
        let changes: Vec<(usize, usize)> = (0..2)
            .flat_map(|axis| (0..points.len()).map(move |point| (point, axis)))
            .filter(|&(point, axis)| {
                has_next(point, axis) && !points.have_same_verdict(point, point + steps[axis])
            })
            .collect();
        let cache = AcousticTensorCache::default();
        // The verdicts alone, by the route of the points.
        let options = MapOptions {
            is_model_blind: !options.admits_closed_forms(),
            computes_bound: false,
            computes_growth_rate: false,
            is_certified: false,
        };
        let done = AtomicUsize::new(0);
        let chunk_length = POINTS_PER_PROGRESS_REPORT / BISECTION_COUNT;
        let distribution = Distribution::new(communicator, chunk_length);
        let own_count = distribution.own_count(changes.len());
        let mut located = vec![f64::NAN; changes.len()];
        located
            .par_chunks_mut(chunk_length)
            .zip(changes.par_chunks(chunk_length))
            .enumerate()
            .filter(|(chunk, _)| distribution.is_own(*chunk))
            .map_init(
                || PointAssessor::new(case, map, options, &cache),
                |assessor, (_, (places, changes))| {
                    for (place, &(point, axis)) in places.iter_mut().zip(changes) {
                        *place = bisect(assessor, position(point), axis, &points.get(point));
                    }
                    let count = done.fetch_add(changes.len(), Ordering::Relaxed) + changes.len();
                    report_progress(progress, count, own_count)
                },
            )
            .collect::<Result<(), Error>>()?;
        distribution.exchange(&mut located, |place| [*place], |[place]| place);
        let mut step_parts = [0, 1].map(|_| vec![NO_CHANGE; points.len()]);
        for ((point, axis), fraction) in changes.into_iter().zip(located) {
            step_parts[axis][point] = (fraction * f64::from(STEP_PARTS)) as u8;
        }
        let step_parts = step_parts.map(Arc::new);
        let own = Self { step_parts, is_on_line: Arc::default() };
        let is_thin = |point: usize, axis: usize| {
            let after = has_next(point, axis).then(|| own.step_fraction(axis, point));
            let before = (position(point)[axis] > 0)
                .then(|| 1.0 - own.step_fraction(axis, point - steps[axis]));
            let mut sides = before.into_iter().chain(after).peekable();
            sides.peek().is_some() && sides.all(|distance| distance <= LINE_TOLERANCE)
        };
        let is_on_line: Vec<bool> =
            (0..points.len()).map(|point| is_thin(point, 0) || is_thin(point, 1)).collect();
        Ok(Self { is_on_line: Arc::new(is_on_line), ..own })
    }

    /// Returns the place of the change between a point and the next along an axis, as a fraction of the step; NaN without
    /// change.
    pub fn step_fraction(&self, axis: usize, point: usize) -> f64 {
        match self.step_parts[axis][point] {
            NO_CHANGE => f64::NAN,
            parts => f64::from(parts) / f64::from(STEP_PARTS),
        }
    }

    /// Returns whether points with a status exist and all of them belong to sets without area.
    pub fn is_status_on_lines(&self, points: &MapPoints, status: PointStatus) -> bool {
        let mut own = self
            .is_on_line
            .iter()
            .enumerate()
            .filter(|(point, _)| points.has_status(*point, status))
            .peekable();
        own.peek().is_some() && own.all(|(_, is_on_line)| *is_on_line)
    }
}

/// Finds where the verdict of a point ends on the step to the next point along an axis, as a fraction of the step.
fn bisect(
    assessor: &mut PointAssessor,
    position: [usize; 2],
    axis: usize,
    point: &MapPoint,
) -> f64 {
    let (mut inside, mut outside) = (0.0, 1.0);
    for _ in 0..BISECTION_COUNT {
        let middle = 0.5 * (inside + outside);
        let mut place = position.map(|index| index as f64);
        place[axis] += middle;
        let found = assessor
            .assess_position(place)
            .unwrap_or(MapPoint::with_status(PointStatus::OutsideModel));
        if found.has_verdict_of(point) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    0.5 * (inside + outside)
}
