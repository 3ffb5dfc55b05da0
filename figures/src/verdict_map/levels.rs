//! Range of the growth levels, and their contour lines.

use super::boundaries::Boundaries;
use super::colour_map::contrast_colour;
use super::figure::VerdictMap;
use super::raster::VerdictRaster;
use crate::contour;
use crate::picture::{Colour, Picture, Point, Rectangle};
use crate::scale::Tick;

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
        let mut logs: Vec<f64> = Vec::new();
        for level in levels.filter(|level| *level > 0.0) {
            if level.is_finite() {
                logs.push(level.log10());
            } else {
                has_infinite_levels = true;
            }
        }
        logs.sort_by(f64::total_cmp);
        let (Some(&min_log), Some(&max_log)) = (logs.first(), logs.last()) else {
            return has_infinite_levels.then_some(Self {
                low: 0.0,
                high: 1.0,
                has_clipped_levels: [false; 2],
                has_infinite_levels,
            });
        };
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
        let logs: Vec<f64> = raster.levels.iter().map(|level| level.log10()).collect();
        for (index, category) in self.categories.iter().enumerate() {
            if !category.fill_style.is_ill_posed() {
                continue;
            }
            let value = |column: usize, row: usize| {
                let cell = raster.cell_index(column, row);
                if usize::from(raster.categories[cell]) == index { logs[cell] } else { f64::NAN }
            };
            for ((tick, _), has_line) in ticks.iter().zip(&mut has_line) {
                let colour = contour_colour(range, *tick);
                for line in contour::trace_contours(raster.columns, raster.rows, value, *tick) {
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
