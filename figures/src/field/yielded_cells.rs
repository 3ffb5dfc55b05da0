//! The yielded zone: a dotted outline and sparse dots, which leave the field visible.

use std::collections::BTreeMap;

use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::outlines::{YIELDED_OUTLINE, draw_outline};
use crate::picture::{INK, Picture, Point, Rectangle, WHITE};

/// Spacing of the dots inside an outline, pixels.
const DOT_SPACING: f64 = 56.0;
/// Spacing of the dots of scattered cells, which have no outline, pixels.
const SCATTERED_DOT_SPACING: f64 = 20.0;

impl FieldFigure {
    /// Draws the outline of the yielded cells and one dot per block of cells that contains yielded cells, at the yielded
    /// cell nearest to the block's centre.
    pub(super) fn draw_yielded_cells(&self, picture: &mut Picture, layout: &FieldLayout) {
        let frame = layout.frame;
        let outlines = self.trace_outlines(layout, &self.has_yielded);
        let spacing = if outlines.is_some() { DOT_SPACING } else { SCATTERED_DOT_SPACING };
        let outlines = outlines.unwrap_or_default();
        outlines.iter().for_each(|line| draw_outline(picture, line, YIELDED_OUTLINE));
        let width = frame.width() / self.columns as f64;
        let height = frame.height() / self.rows as f64;
        // Blocks of whole cells, so that the dots are evenly spaced.
        let [across, up] = [width, height].map(|size| (spacing / size).round().max(1.0) as usize);
        let mut nearest: BTreeMap<(usize, usize), (usize, usize)> = BTreeMap::new();
        let yielded = self.has_yielded.iter().enumerate().filter(|(_, yielded)| **yielded);
        for (cell, _) in yielded {
            let (column, row) = (cell % self.columns, cell / self.columns);
            let away = (column % across).abs_diff(across / 2) + (row % up).abs_diff(up / 2);
            let best = nearest.entry((row / up, column / across)).or_insert((away, cell));
            *best = (*best).min((away, cell));
        }
        // Dots of blocks at the edge of an outlined zone would crowd along its outline.
        let max_away = if outlines.is_empty() { usize::MAX } else { (across + up) / 8 };
        let place = |cell: usize| {
            let (column, row) = (cell % self.columns, cell / self.columns);
            [frame.left + (column as f64 + 0.5) * width, frame.bottom - (row as f64 + 0.5) * height]
        };
        let places: Vec<Point> = nearest
            .values()
            .filter(|(away, _)| *away <= max_away)
            .map(|(_, cell)| place(*cell))
            .collect();
        draw_dots(picture, &places, frame);
    }
}

/// Draws the swatch of the yielded zone.
pub(super) fn draw_yielded_swatch(picture: &mut Picture, area: Rectangle) {
    let Rectangle { left, top, right, bottom } = area;
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
    draw_outline(picture, &corners, YIELDED_OUTLINE);
    let middle = 0.5 * (top + bottom);
    let dots = [0.25, 0.75].map(|share| [left + share * area.width(), middle]);
    draw_dots(picture, &dots, area);
}

/// Draws dots visible on light and dark colours, clipped to an area.
fn draw_dots(picture: &mut Picture, places: &[Point], area: Rectangle) {
    for (half, colour) in [(3.0, WHITE), (1.8, INK)] {
        let dot = |&[x, y]: &Point| Rectangle {
            left: (x - half).max(area.left),
            top: (y - half).max(area.top),
            right: (x + half).min(area.right),
            bottom: (y + half).min(area.bottom),
        };
        picture.fill_patches(places.iter().map(dot).collect(), colour);
    }
}
