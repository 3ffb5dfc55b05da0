//! Outlines of parts of the domain: shapes of the initial state, and the yielded zone.

use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::raster::{FieldRaster, MAX_COARSE_CELLS};
use crate::picture::{INK, Picture, Point, WHITE, polyline_length};

/// Part of the domain with an outline, such as the shape of an initial state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldOutline {
    /// Legend text.
    pub label: String,
    /// Whether each cell is inside, in the order of the values.
    pub is_inside: Vec<bool>,
}

/// Width and dashes of a kind of outline, pixels. Both differ from those of contour lines and borders.
#[derive(Clone, Copy)]
pub(super) struct OutlineStyle {
    width: f64,
    dashes: &'static [f64],
}

/// Outline of a shape: dash-dotted.
pub(super) const SHAPE_OUTLINE: OutlineStyle =
    OutlineStyle { width: 2.4, dashes: &[16.0, 5.0, 3.0, 5.0] };
/// Outline of the yielded zone: dotted.
pub(super) const YIELDED_OUTLINE: OutlineStyle = OutlineStyle { width: 3.0, dashes: &[3.0, 5.0] };

/// Maximum number of points of the outlines of a part; that of scattered cells would cover the field.
const MAX_OUTLINE_POINTS: usize = 12_000;

impl FieldFigure {
    /// Traces the outlines of the cells that are `inside`, up to the frame; `None` if the cells are scattered.
    pub(super) fn trace_outlines(
        &self,
        layout: &FieldLayout,
        inside: &[bool],
    ) -> Option<Vec<Vec<Point>>> {
        if !inside.contains(&true) {
            return Some(Vec::new());
        }
        let raster = FieldRaster::new(self, layout.frame, [MAX_COARSE_CELLS; 2]);
        let shares: Vec<f64> = inside.iter().map(|own| f64::from(u8::from(*own))).collect();
        let lines = raster.trace_contours(&raster.mean_values(&shares), 0.5);
        let points: usize = lines.iter().map(Vec::len).sum();
        if points > MAX_OUTLINE_POINTS {
            return None;
        }
        let smooth = lines.into_iter().map(|line| smooth_line(&line));
        let parts = smooth.flat_map(|line| self.clip_to_body(layout, line));
        Some(parts.filter(|part| polyline_length(part) > 12.0).collect())
    }

    /// Draws the outlines of the shapes.
    pub(super) fn draw_shape_outlines(&self, picture: &mut Picture, layout: &FieldLayout) {
        for outline in &self.outlines {
            for line in self.trace_outlines(layout, &outline.is_inside).into_iter().flatten() {
                draw_outline(picture, &line, SHAPE_OUTLINE);
            }
        }
    }
}

/// Replaces each point of a line along cells by the mean of up to two neighbours on either side, which moves it by less
/// than a cell; ends of open lines are kept.
fn smooth_line(line: &[Point]) -> Vec<Point> {
    const REACH: usize = 2;
    let last = line.len().saturating_sub(1);
    let is_closed = last > 2 * REACH && line[0] == line[last];
    let mean = |index: usize| {
        let reach = if is_closed { REACH } else { REACH.min(index).min(last - index) };
        let neighbours = (0..=2 * reach).map(|offset| match is_closed {
            // The last point repeats the first one.
            true => line[(index + last + offset - reach) % last],
            false => line[index + offset - reach],
        });
        let sum = neighbours.fold([0.0; 2], |sum, point| [sum[0] + point[0], sum[1] + point[1]]);
        sum.map(|own| own / (2 * reach + 1) as f64)
    };
    (0..line.len()).map(mean).collect()
}

/// Draws an outline with a white rim.
pub(super) fn draw_outline(picture: &mut Picture, line: &[Point], style: OutlineStyle) {
    picture.draw_line(line, style.width + 2.0, WHITE);
    picture.draw_dashed_line(line, style.dashes, style.width, INK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_lines_stay_near_their_cells() {
        let stairs: Vec<Point> =
            (0..40).map(|index| [f64::from(index / 2), f64::from((index + 1) / 2)]).collect();
        let smooth = smooth_line(&stairs);
        assert_eq!([smooth[0], smooth[39]], [stairs[0], stairs[39]]);
        for [x, y] in &smooth[2..38] {
            assert!((y - x - 0.5).abs() < 0.11, "{x} {y}");
        }
        let mut closed: Vec<Point> = (0..12).map(f64::from).map(|a| [a.cos(), a.sin()]).collect();
        closed.push(closed[0]);
        let smooth = smooth_line(&closed);
        assert!(smooth[0] == smooth[12] && smooth.len() == 13);
        assert_eq!(smooth_line(&[]), Vec::<Point>::new());
        assert_eq!(smooth_line(&stairs[..2]), stairs[..2]);
    }
}
