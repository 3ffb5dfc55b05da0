//! Drawing of a field figure.

use super::borders::draw_borders;
use super::colour_map::Scale;
use super::contours::{Levels, draw_level};
use super::figure::FieldFigure;
use super::layout::Layout;
use super::raster::{COARSE, Raster};
use crate::error::FigureError;
use crate::format::Format;
use crate::page::{self, Legend, MARGIN, RULE};
use crate::picture::{Colour, INK, Picture, Rectangle, WHITE};

/// Layout, legend and contours, determined before drawing.
pub(super) struct Arrangement {
    pub(super) layout: Layout,
    pub(super) legend: Legend,
    pub(super) levels: Levels,
    pub(super) has_borders: bool,
}

impl FieldFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// A list does not have one value per cell, the limit of the colour scale is not positive, or rendering or encoding
    /// fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture(format)?.render(format)
    }

    /// Determines the layout. The legend depends on the drawn elements, whose positions depend on the height of the
    /// legend; hence borders, lines and names are first placed for a legend of zero height.
    pub(super) fn arrange(&self, scale: &Scale, format: Format) -> Arrangement {
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle).ceil();
        let trial = self.layout(scale, top, 0.0);
        let has_borders = self.borders(&self.raster(&trial, format)).is_some();
        let levels = self.levels(scale, &trial);
        let left_out =
            |layout| self.place_names(layout).iter().filter(|place| place.is_none()).count();
        let list = |scale: &Scale, levels: &Levels, left_out| {
            let entries = self.legend(scale, levels, has_borders, left_out);
            let (mut listed, mut widest) = (Vec::new(), Vec::new());
            for entry in entries {
                widest.push(entry.widest);
                listed.push((entry.words, entry.swatch));
            }
            Legend::with_room(listed, &widest, page::WIDTH - 2.0 * MARGIN)
        };
        // Figures with a fixed scale reserve the legend height that other frames may need.
        let height = |legend: &Legend, left_out| {
            if !scale.is_fixed {
                return legend.height();
            }
            let all = Scale { unknown: scale.unknown.max(1), ..scale.clone() };
            let most =
                if self.has_curves(scale) { Levels::Lines(Vec::new()) } else { Levels::None };
            list(&all, &most, left_out).height().max(legend.height())
        };
        let count = left_out(&trial);
        let mut legend = list(scale, &levels, count);
        let mut layout = self.layout(scale, top, height(&legend, count));
        // A smaller field may have space for fewer names.
        let count = left_out(&layout);
        legend = list(scale, &levels, count);
        layout = self.layout(scale, top, height(&legend, count));
        let levels = match levels {
            Levels::Lines(_) => self.levels(scale, &layout),
            levels => levels,
        };
        Arrangement { layout, legend, levels, has_borders }
    }

    /// Returns all colours that cells of figures with the same scale may have.
    pub(crate) fn colours(&self) -> Vec<Colour> {
        Scale::of(self).colours()
    }

    pub(crate) fn picture(&self, format: Format) -> Result<Picture, FigureError> {
        self.check()?;
        let scale = Scale::of(self);
        let Arrangement { layout, legend, levels, has_borders } = self.arrange(&scale, format);
        let mut picture = Picture::new(page::WIDTH as u32, layout.height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let raster = self.raster(&layout, format);
        self.draw_cells(&mut picture, &scale, &raster);
        match &levels {
            Levels::Lines(lines) => {
                lines.iter().for_each(|(share, line)| draw_level(&mut picture, *share, line));
            }
            Levels::Ruled => self.rule_negative(&mut picture, &scale, &raster),
            Levels::TooMany | Levels::None => {}
        }
        if has_borders {
            draw_borders(&mut picture, self.borders(&raster).unwrap_or_default());
        }
        self.draw_plastic(&mut picture, layout.frame);
        if let Levels::Lines(lines) = &levels {
            for number in self.place_numbers(&scale, &layout, lines) {
                let bounds = number.bounds();
                let ground = Rectangle {
                    top: bounds.top + 1.0,
                    left: bounds.left - 3.0,
                    right: bounds.right + 3.0,
                    ..bounds
                };
                picture.fill(ground, WHITE);
                picture.text(number);
            }
        }
        picture.frame(layout.frame, RULE, INK);
        self.draw_axes(&mut picture, &layout);
        if let Some(bar) = layout.bar {
            self.draw_bar(&mut picture, &scale, &levels, bar, layout.bar_is_upright);
        }
        self.draw_marks(&mut picture, &layout);
        legend.draw(&mut picture, MARGIN, layout.legend_top);
        Ok(picture)
    }

    pub(super) fn raster(&self, layout: &Layout, format: Format) -> Raster {
        let pixels = [layout.frame.width() as usize, layout.frame.height() as usize];
        let most = match format {
            Format::Png => pixels,
            Format::Svg => pixels.map(|pixels| pixels.min(COARSE)),
        };
        Raster::new(self, layout.frame, most)
    }
}
