//! Range of the growth levels, and their contour lines.

use super::boundaries::Boundaries;
use super::colour_map::contrast_colour;
use super::figure::VerdictMap;
use super::raster::VerdictRaster;
use crate::contour;
use crate::picture::{Colour, Picture, Point, Rectangle};
use crate::scale::Tick;

/// Length of the steps in which contour lines are cut off at the boundary of their category, pixels.
const CONTOUR_STEP: f64 = 1.0;

/// Largest number of levels from which the range of the colour map is determined, apart from the extremes; even.
const MAX_SAMPLE_COUNT: usize = 1 << 20;

/// Range of the colour map, in log₁₀ of the growth level.
pub(super) struct LevelRange {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Whether some finite levels are below `low`, and whether some are above `high`.
    pub(super) has_clipped_levels: [bool; 2],
    /// Whether at least one level is infinite.
    pub(super) has_infinite_levels: bool,
}

impl LevelRange {
    /// Computes the range of the positive levels; a default range if all are infinite, `None` if there are none. The
    /// outermost 1 % of the levels at an end, e.g. near a singular line, are excluded if they extend it by more than
    /// the length of the remaining range, at least 0.3 decades.
    pub(super) fn from_levels(levels: impl Iterator<Item = f64>) -> Option<Self> {
        let mut has_infinite_levels = false;
        let (mut min_log, mut max_log) = (f64::INFINITY, f64::NEG_INFINITY);
        // Of many levels, equidistant ones determine the outermost 1 %.
        let (mut logs, mut count, mut stride) = (Vec::new(), 0_usize, 1);
        for level in levels.filter(|level| *level > 0.0) {
            if !level.is_finite() {
                has_infinite_levels = true;
                continue;
            }
            let log = level.log10();
            (min_log, max_log) = (min_log.min(log), max_log.max(log));
            if count.is_multiple_of(stride) {
                if logs.len() == MAX_SAMPLE_COUNT {
                    logs = logs.into_iter().step_by(2).collect();
                    stride *= 2;
                }
                logs.push(log);
            }
            count += 1;
        }
        logs.sort_by(f64::total_cmp);
        if logs.is_empty() {
            return has_infinite_levels.then_some(Self {
                low: 0.0,
                high: 1.0,
                has_clipped_levels: [false; 2],
                has_infinite_levels,
            });
        }
        let outlier_count = logs.len() / 100;
        let (inner_low, inner_high) = (logs[outlier_count], logs[logs.len() - 1 - outlier_count]);
        let inner = (inner_high - inner_low).max(0.3);
        let trim = |outer: f64, bound: f64| if outer > inner { bound } else { f64::NAN };
        let low = trim(inner_low - min_log, inner_low).max(min_log);
        let high = trim(max_log - inner_high, inner_high).min(max_log);
        let has_clipped_levels = [low > min_log, high < max_log];
        // Equal levels are extended to one decade, so that the bar has ticks.
        let (low, high) = if high - low < 1e-6 { (low - 0.5, high + 0.5) } else { (low, high) };
        Some(Self { low, high, has_clipped_levels, has_infinite_levels })
    }

    pub(super) fn fraction(&self, level: f64) -> f64 {
        (level.log10() - self.low) / (self.high - self.low)
    }
}

/// Growth levels of one category between the points of the raster. Levels are bilinear between points. Beyond the
/// boundary of the category, which lies between points, they are extrapolated linearly from the points inside, so that
/// levels and contour lines extend to the boundary; where the growth vanishes at the boundary, so do they.
pub(super) struct LevelField<'a> {
    raster: &'a VerdictRaster,
    category: u8,
    /// Levels at the points; NaN where there is neither a level nor one to be extrapolated.
    levels: Vec<f64>,
}

impl<'a> LevelField<'a> {
    /// `spacing` has the distances between points along x and y, pixels.
    pub(super) fn new(raster: &'a VerdictRaster, category: u8, spacing: [f64; 2]) -> Self {
        let points = (0..raster.rows).flat_map(|j| (0..raster.columns).map(move |i| [i, j]));
        let levels = points.map(|at| match own_level(raster, category, at) {
            Some(level) => level,
            None => extrapolate(raster, category, at, spacing),
        });
        Self { raster, category, levels: levels.collect() }
    }

    /// Returns the level at a position in units of the point spacing; between points without finite level that of the
    /// nearest point of the category.
    pub(super) fn level_at(&self, [x, y]: Point) -> f64 {
        let Self { raster, category, levels } = self;
        let lower =
            |place: f64, count: usize| (place.max(0.0) as usize).min(count.saturating_sub(2));
        let (i, j) = (lower(x, raster.columns), lower(y, raster.rows));
        let [u, v] = [x - i as f64, y - j as f64].map(|share| share.clamp(0.0, 1.0));
        let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
            .map(|(i, j)| raster.cell_index(i.min(raster.columns - 1), j.min(raster.rows - 1)));
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let own = corners.map(|cell| raster.categories[cell] == *category);
        let parts = corners.map(|cell| levels[cell]);
        // A point without level of the category itself, such as one with infinite growth, has a colour of its own.
        if parts.iter().all(|level| level.is_finite()) {
            return parts.iter().zip(weights).map(|(level, weight)| level * weight).sum();
        }
        let nearest = (0..4).filter(|&corner| own[corner]);
        let nearest = nearest.max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
        nearest.map_or(f64::NAN, |corner| raster.levels[corners[corner]])
    }

    /// Computes the contour lines at a level, in units of the point spacing: the parts inside the category, in steps of
    /// at most `step` of a spacing.
    pub(super) fn trace_contours(
        &self,
        boundaries: &Boundaries,
        level: f64,
        step: f64,
    ) -> Vec<Vec<Point>> {
        let Self { raster, category, levels } = self;
        let value = |i: usize, j: usize| levels[raster.cell_index(i, j)];
        let whole = contour::trace_contours(raster.columns, raster.rows, value, level);
        let mut parts = Vec::new();
        for line in whole {
            let mut part: Vec<Point> = Vec::new();
            for piece in line.windows(2) {
                let [from, to] = [piece[0], piece[1]];
                let length = (to[0] - from[0]).hypot(to[1] - from[1]);
                let count = (length / step).ceil().max(1.0) as usize;
                let at = |index: f64| {
                    [0, 1].map(|axis| from[axis] + index / count as f64 * (to[axis] - from[axis]))
                };
                for index in 0..count {
                    let middle = at(index as f64 + 0.5);
                    if boundaries.category_at(raster, middle) == *category {
                        if part.is_empty() {
                            part.push(at(index as f64));
                        }
                        part.push(at(index as f64 + 1.0));
                    } else if !part.is_empty() {
                        parts.push(std::mem::take(&mut part));
                    }
                }
            }
            if !part.is_empty() {
                parts.push(part);
            }
        }
        parts
    }
}

/// Returns the level of a point of a category; `None` for points of other categories.
fn own_level(raster: &VerdictRaster, category: u8, [i, j]: [usize; 2]) -> Option<f64> {
    let cell = raster.cell_index(i, j);
    let level = raster.levels[cell];
    let is_level = level.is_finite() && level > 0.0;
    (raster.categories[cell] == category).then_some(if is_level { level } else { f64::NAN })
}

/// Extrapolates the levels of a category linearly from its points next to a point of another category. Directions are
/// weighted by the inverse square of the distance of points on the page.
fn extrapolate(
    raster: &VerdictRaster,
    category: u8,
    [i, j]: [usize; 2],
    [width, height]: [f64; 2],
) -> f64 {
    let level = |di: isize, dj: isize| {
        let at = [i.checked_add_signed(di)?, j.checked_add_signed(dj)?];
        let is_inside = at[0] < raster.columns && at[1] < raster.rows;
        own_level(raster, category, if is_inside { at } else { return None })
            .filter(|level| level.is_finite())
    };
    let (mut of_lines, mut of_points) = ([0.0; 2], [0.0; 2]);
    for (di, dj) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
        let Some(near) = level(di, dj) else { continue };
        let weight = 1.0 / ((di as f64 * width).powi(2) + (dj as f64 * height).powi(2));
        of_points = [of_points[0] + weight * near, of_points[1] + weight];
        if let Some(far) = level(2 * di, 2 * dj) {
            of_lines = [of_lines[0] + weight * (2.0 * near - far), of_lines[1] + weight];
        }
    }
    let [sum, weight] = if of_lines[1] > 0.0 { of_lines } else { of_points };
    sum / weight
}

impl VerdictMap {
    /// Draws the contour lines at the ticks of the colour bar, separately for each category, since levels of different
    /// categories may be different quantities. Lines that nowhere leave the neighbourhood of a boundary are omitted:
    /// the points do not resolve them. Returns for each tick whether it has a line.
    pub(super) fn draw_contours(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        (raster, boundaries): (&VerdictRaster, &Boundaries),
        range: &LevelRange,
        ticks: &[Tick],
    ) -> Vec<bool> {
        let mut has_line = vec![false; ticks.len()];
        let spacing = raster.spacing(frame);
        let step = CONTOUR_STEP / spacing[0].max(spacing[1]);
        for (index, category) in (0_u8..).zip(&self.categories) {
            if !category.fill_style.is_ill_posed() {
                continue;
            }
            let field = LevelField::new(raster, index, spacing);
            for ((tick, _), has_line) in ticks.iter().zip(&mut has_line) {
                let colour = contour_colour(range, *tick);
                for line in field.trace_contours(boundaries, 10_f64.powf(*tick), step) {
                    let square = |[x, y]: Point| [x as usize, y as usize];
                    if line.iter().all(|&at| boundaries.is_near(square(at))) {
                        continue;
                    }
                    let place = |at: Point| raster.place(frame, at);
                    picture.draw_line(line.into_iter().map(place).collect::<Vec<_>>(), 1.6, colour);
                    *has_line = true;
                }
            }
        }
        has_line
    }
}

pub(super) fn contour_colour(range: &LevelRange, log: f64) -> Colour {
    contrast_colour((log - range.low) / (range.high - range.low))
}
