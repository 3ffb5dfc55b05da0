//! Drawing of text and lines, which differs between PNG and SVG.

use plotters::backend::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, TextStyle};

use super::fonts::{BITMAP_SIZE_PER_EM, font, run_width, split_into_runs, text_width};
use super::geometry::{Point, Rectangle, circle_points};
use super::text::{Anchor, Colour, Text};
use crate::error::FigureError;

/// Supersampling factor: fine pixels per pixel along each axis.
pub(super) const SUPERSAMPLING: u32 = 3;

/// Conventions of an output format for text and lines. The two backends of plotters interpret font size and text
/// position differently; the corrections make both formats agree.
pub(super) struct BackendConventions {
    /// Font size of the backend for an em square of one pixel.
    font_size_per_em: f64,
    /// Distance from the position passed to the backend to the baseline, in em.
    baseline_offset: f64,
    /// Whether the format is SVG: a line is passed to the backend as a whole, and patches are written as paths.
    pub(super) is_svg: bool,
}

/// Bitmap backend. Its polygon of a thick line has holes where the line reverses direction, so lines are drawn segment
/// by segment.
pub(super) const BITMAP_CONVENTIONS: BackendConventions = BackendConventions {
    font_size_per_em: BITMAP_SIZE_PER_EM,
    baseline_offset: 0.582,
    is_svg: false,
};
pub(super) const SVG_CONVENTIONS: BackendConventions =
    BackendConventions { font_size_per_em: 1.24, baseline_offset: 0.76, is_svg: true };

pub(super) fn to_figure_error(error: impl std::fmt::Display) -> FigureError {
    FigureError::Drawing(error.to_string())
}

impl BackendConventions {
    pub(super) fn draw_text<B: DrawingBackend>(
        &self,
        backend: &mut B,
        text: &Text,
    ) -> Result<(), FigureError> {
        let runs = split_into_runs(&text.content);
        if let [_] = runs[..] {
            return self.draw_run(backend, text, &text.content, text.font_size, [0.0; 2]);
        }
        let whole = text_width(&text.content, text.font_size, text.is_bold);
        let mut offset = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * whole,
            Anchor::End => -whole,
        };
        let from_start = Text { anchor: Anchor::Start, ..text.clone() };
        for run in runs {
            let size = run.scale * text.font_size;
            let end = offset + run_width(&run.content, size, text.is_bold);
            // Viewers of SVG ignore spaces at the start of an element.
            let visible = run.content.trim_start();
            let start = end - run_width(visible, size, text.is_bold);
            self.draw_run(backend, &from_start, visible, size, [start, run.rise * text.font_size])?;
            offset = end;
        }
        Ok(())
    }

    /// Draws a part of a text in its font size at an offset along and above the baseline, pixels.
    fn draw_run<B: DrawingBackend>(
        &self,
        backend: &mut B,
        text: &Text,
        content: &str,
        font_size: f64,
        [along, above]: [f64; 2],
    ) -> Result<(), FigureError> {
        let drop = self.baseline_offset * font_size + above;
        let [x, y] = text.anchor_point;
        let (at, turn) = if text.is_vertical {
            ([x - drop, y - along], FontTransform::Rotate270)
        } else {
            ([x + along, y - drop], FontTransform::None)
        };
        let across = match text.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let size = font_size * self.font_size_per_em * f64::from(SUPERSAMPLING);
        let font = font(size, text.is_bold).transform(turn);
        let style = TextStyle::from(font).color(&text.colour).pos(Pos::new(across, VPos::Top));
        backend.draw_text(content, &style, to_fine_pixels(at)).map_err(to_figure_error)
    }

    pub(super) fn draw_polyline<B: DrawingBackend>(
        &self,
        backend: &mut B,
        points: &[Point],
        width: f64,
        colour: Colour,
    ) -> Result<(), FigureError> {
        let fine_width = width * f64::from(SUPERSAMPLING);
        if self.is_svg {
            use plotters::style::Color;
            let style = colour.stroke_width(fine_width.round().max(1.0) as u32);
            let points = points.iter().map(|&point| to_fine_pixels(point));
            return backend.draw_path(points, &style).map_err(to_figure_error);
        }
        for (index, piece) in points.windows(2).enumerate() {
            let ([x0, y0], [x1, y1]) = (piece[0], piece[1]);
            let length = (x1 - x0).hypot(y1 - y0);
            if length > 0.0 {
                let half = 0.5 * width / length;
                let (dx, dy) = (half * (y1 - y0), half * (x0 - x1));
                let corners = [
                    [x0 + dx, y0 + dy],
                    [x1 + dx, y1 + dy],
                    [x1 - dx, y1 - dy],
                    [x0 - dx, y0 - dy],
                ];
                backend
                    .fill_polygon(corners.map(to_fine_pixels), &colour)
                    .map_err(to_figure_error)?;
            }
            // A disc closes the notch between two segments.
            if index > 0 && width > 1.0 {
                let joint =
                    circle_points(piece[0], 0.5 * width, 12).into_iter().map(to_fine_pixels);
                backend.fill_polygon(joint, &colour).map_err(to_figure_error)?;
            }
        }
        Ok(())
    }
}

pub(super) fn to_fine_pixels([x, y]: Point) -> (i32, i32) {
    let scale = f64::from(SUPERSAMPLING);
    ((scale * x).round() as i32, (scale * y).round() as i32)
}

/// First coordinate of the placeholder polygons of patches in an SVG, far outside the picture.
pub(super) const PATCH_PLACEHOLDER_X: i32 = -1_000_000;

/// Returns the corners of a patch in fine pixels; `None` if its width or height rounds to 0.
pub(super) fn fine_patch_corners(area: &Rectangle) -> Option<([i32; 2], [i32; 2])> {
    let (from, to) =
        (to_fine_pixels([area.left, area.top]), to_fine_pixels([area.right, area.bottom]));
    (from.0 < to.0 && from.1 < to.1).then_some(([from.0, from.1], [to.0, to.1]))
}
