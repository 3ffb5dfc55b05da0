//! Dots on cells that have yielded.

use std::collections::BTreeMap;

use super::figure::FieldFigure;
use crate::picture::{INK, Picture, Point, Rectangle, WHITE};

/// Spacing of the dots, pixels.
pub(super) const DOT_SPACING: f64 = 14.0;

impl FieldFigure {
    /// Draws one dot per block of cells that contains yielded cells, at the yielded cell nearest to the block's centre.
    pub(super) fn draw_yielded_cells(&self, picture: &mut Picture, frame: Rectangle) {
        let width = frame.width() / self.columns as f64;
        let height = frame.height() / self.rows as f64;
        // Blocks of whole cells, so that the dots are evenly spaced.
        let [across, up] =
            [width, height].map(|size| (DOT_SPACING / size).round().max(1.0) as usize);
        let mut nearest: BTreeMap<(usize, usize), (usize, usize)> = BTreeMap::new();
        let yielded = self.has_yielded.iter().enumerate().filter(|(_, yielded)| **yielded);
        for (cell, _) in yielded {
            let (column, row) = (cell % self.columns, cell / self.columns);
            let away = (column % across).abs_diff(across / 2) + (row % up).abs_diff(up / 2);
            let best = nearest.entry((row / up, column / across)).or_insert((away, cell));
            *best = (*best).min((away, cell));
        }
        let place = |cell: usize| {
            let (column, row) = (cell % self.columns, cell / self.columns);
            [frame.left + (column as f64 + 0.5) * width, frame.bottom - (row as f64 + 0.5) * height]
        };
        let places: Vec<Point> = nearest.values().map(|(_, cell)| place(*cell)).collect();
        draw_dots(picture, &places, frame);
    }
}

/// Draws dots visible on light and dark colours, clipped to an area.
pub(super) fn draw_dots(picture: &mut Picture, places: &[Point], area: Rectangle) {
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
