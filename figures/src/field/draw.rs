//! Drawing of a field figure.

use super::arrows::{ArrowScale, draw_arrow};
use super::borders::draw_borders;
use super::colour_map::ColourScale;
use super::contours::{Contours, draw_contour_line};
use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::lines::LineWidths;
use super::raster::{FieldRaster, MAX_COARSE_CELLS};
use crate::error::FigureError;
use crate::format::{FigureFormat, FigureOutput};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, MARGIN};
use crate::picture::{Colour, INK, Picture, Point, Rectangle, WHITE};

/// Radius of the area at the tip of an arrow that no text may cover, pixels.
const MARKED_TIP_RADIUS: f64 = 5.0;

/// Layout, legend and contours, determined before drawing.
pub(super) struct Arrangement {
    pub(super) layout: FieldLayout,
    pub(super) legend: Legend,
    pub(super) contours: Contours,
    pub(super) overlay: Overlay,
}

/// Properties of borders, lines and arrows that do not depend on the height of the legend.
#[derive(Clone, Copy)]
pub(super) struct Overlay {
    pub(super) has_borders: bool,
    pub(super) line_widths: LineWidths,
    pub(super) arrow_scale: Option<ArrowScale>,
}

impl FieldFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// An axis has no cells or no finite, positive length, a list does not have one value per cell, a limit of the
    /// colour scale is not positive and finite, or rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture(output.format))?.render(output)
    }

    /// Determines layout, legend, contours and borders. The legend depends on the drawn elements, whose positions
    /// depend on the height of the legend; hence borders, lines and names are first placed for a legend of zero height.
    pub(super) fn compute_arrangement(
        &self,
        scale: &ColourScale,
        format: FigureFormat,
    ) -> Arrangement {
        let top = page::heading_bottom(&self.title, &self.subtitle).ceil();
        let preliminary_layout = self.compute_layout(scale, top, 0.0);
        let overlay = Overlay {
            has_borders: self
                .material_borders(&self.build_raster(&preliminary_layout, format))
                .is_some(),
            line_widths: self.line_widths(preliminary_layout.frame),
            arrow_scale: self.arrow_scale(preliminary_layout.frame),
        };
        let contours = self.compute_contours(scale, &preliminary_layout);
        let count_omitted_names =
            |layout| self.place_mark_names(layout).iter().filter(|place| place.is_none()).count();
        let build_legend = |scale: &ColourScale, contours: &Contours, omitted_names| {
            let entries = self.legend_entries(scale, contours, overlay, omitted_names);
            let (mut listed, mut widest_texts) = (Vec::new(), Vec::new());
            for entry in entries {
                widest_texts.push(entry.widest_text);
                listed.push((entry.text, entry.swatch));
            }
            Legend::with_reserved_texts(listed, &widest_texts, page::width() - 2.0 * MARGIN)
        };
        // Figures with a fixed scale reserve the legend height that other frames may need.
        let legend_height = |legend: &Legend, omitted_names| {
            if !scale.is_fixed {
                return legend.height();
            }
            let full_scale =
                ColourScale { non_finite_count: scale.non_finite_count.max(1), ..scale.clone() };
            let most_contours =
                if self.has_contours(scale) { Contours::Lines(Vec::new()) } else { Contours::None };
            build_legend(&full_scale, &most_contours, omitted_names).height().max(legend.height())
        };
        let omitted_names = count_omitted_names(&preliminary_layout);
        let mut legend = build_legend(scale, &contours, omitted_names);
        let mut layout = self.compute_layout(scale, top, legend_height(&legend, omitted_names));
        // A smaller field may have space for fewer names.
        let omitted_names = count_omitted_names(&layout);
        legend = build_legend(scale, &contours, omitted_names);
        layout = self.compute_layout(scale, top, legend_height(&legend, omitted_names));
        let contours = match contours {
            Contours::Lines(_) => self.compute_contours(scale, &layout),
            contours => contours,
        };
        Arrangement { layout, legend, contours, overlay }
    }

    /// Returns all colours that cells of figures with the same scale may have.
    pub(crate) fn cell_colours(&self) -> Vec<Colour> {
        ColourScale::from_figure(self).all_colours()
    }

    pub(crate) fn to_picture(&self, format: FigureFormat) -> Result<Picture, FigureError> {
        self.validate()?;
        Ok(self.draw_with_scale(&ColourScale::from_figure(self), format))
    }

    /// Draws the figure, which must be valid, with a colour scale.
    pub(super) fn draw_with_scale(&self, scale: &ColourScale, format: FigureFormat) -> Picture {
        let Arrangement { layout, legend, contours, overlay } =
            self.compute_arrangement(scale, format);
        let mut picture = page::create_page(layout.height, &self.title, &self.subtitle);
        let raster = self.build_raster(&layout, format);
        self.draw_cells(&mut picture, scale, &raster);
        self.draw_sign_lines(&mut picture, scale, &raster);
        if let Contours::Lines(lines) = &contours {
            for (share, line) in lines {
                draw_contour_line(&mut picture, *share, line);
            }
        }
        let curves = self.magnitude_curves(&layout);
        self.draw_magnitude_curves(&mut picture, &curves);
        if overlay.has_borders {
            draw_borders(&mut picture, self.material_borders(&raster).unwrap_or_default());
        }
        self.draw_body_outline(&mut picture, &layout);
        self.draw_line_sets(&mut picture, layout.frame, scale, overlay.line_widths);
        let arrows = self.place_arrows(layout.frame, overlay.arrow_scale);
        for (at, vector) in &arrows {
            draw_arrow(&mut picture, *at, *vector);
            let tip = [at[0] + 0.5 * vector[0], at[1] + 0.5 * vector[1]];
            picture.mark_point(tip, MARKED_TIP_RADIUS);
        }
        self.draw_yielded_cells(&mut picture, &layout);
        self.draw_shape_outlines(&mut picture, &layout);
        let lines = match &contours {
            Contours::Lines(lines) if self.contour_levels.is_some() && self.arrows.is_none() => {
                let level = |(share, line): &(f64, Vec<Point>)| (share * scale.limit, line.clone());
                lines.iter().map(level).collect()
            }
            _ => curves,
        };
        for number in self.place_contour_numbers(&layout, &lines, &arrows) {
            let bounds = number.bounds();
            let ground = Rectangle {
                top: bounds.top + 1.0,
                left: bounds.left - 3.0,
                right: bounds.right + 3.0,
                ..bounds
            };
            picture.fill_rectangle(ground, WHITE);
            picture.draw_text(number);
        }
        picture.draw_frame(layout.frame, FRAME_LINE_WIDTH, INK);
        self.draw_axes(&mut picture, &layout);
        if let Some(bar) = layout.bar_area {
            self.draw_colour_bar(&mut picture, scale, &contours, bar, layout.is_bar_vertical);
        }
        self.draw_marks(&mut picture, &layout);
        legend.draw(&mut picture, MARGIN, layout.legend_top);
        picture
    }

    pub(super) fn build_raster(&self, layout: &FieldLayout, format: FigureFormat) -> FieldRaster {
        let pixels = [layout.frame.width() as usize, layout.frame.height() as usize];
        let max_cells = match format {
            FigureFormat::Png => pixels,
            FigureFormat::Svg | FigureFormat::Pdf => {
                pixels.map(|pixels| pixels.min(MAX_COARSE_CELLS))
            }
        };
        FieldRaster::new(self, layout.frame, max_cells)
    }
}
