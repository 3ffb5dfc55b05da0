//! Drawing of a verdict map.

use super::axes::Extent;
use super::colour_map::{BAR, BAR_GAP};
use super::curves::draw_curve;
use super::figure::VerdictMap;
use super::levels::Range;
use super::raster::draw_borders;
use crate::error::FigureError;
use crate::format::Format;
use crate::page::{self, Legend, MARGIN, NAME, NUMBER, RULE};
use crate::picture::{INK, Picture, Point, Rectangle, clip};
use crate::scale::{self, Tick};

impl VerdictMap {
    /// Renders the map in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// An axis is not a uniform grid, a list does not have one value per cell, a cell has an undefined category, or
    /// rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture()?.render(format)
    }

    pub(super) fn picture(&self) -> Result<Picture, FigureError> {
        let (x, y) = (Extent::of(&self.x)?, Extent::of(&self.y)?);
        self.check_cells()?;
        let range = Range::of(self.levels().map(|(_, level)| level));
        let legend = Legend::new(self.legend(range.as_ref()), page::WIDTH - 2.0 * MARGIN);

        // The heading is laid out first to find its height; the figure grows with the legend.
        let top =
            page::heading(&mut Picture::new(page::WIDTH as u32, 1), &self.title, &self.subtitle);
        let below = page::BOTTOM_AXIS + 22.0 + legend.height() + MARGIN - 12.0;
        let height = page::HEIGHT.max(top + 480.0 + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);

        let bottom = height - below;
        let bar_ticks = match &range {
            Some(range) => {
                let most = ((bottom - top) / 60.0) as usize;
                scale::log_ticks(range.low, range.high, most)
            }
            None => Vec::new(),
        };
        let y_ticks = y.ticks(&self.y, bottom - top, true);
        let bar_room = range.as_ref().map_or(0.0, |_| {
            BAR_GAP + BAR + 18.0 + page::widest(&bar_ticks).max(NUMBER) + 1.5 * NAME
        });
        let frame = Rectangle {
            left: MARGIN + page::left_axis_width(&y_ticks),
            top,
            right: page::WIDTH - MARGIN - bar_room,
            bottom,
        };
        let x_ticks = x.ticks(&self.x, frame.width(), false);
        let place_x = |value: f64| frame.left + x.share(value) * frame.width();
        let place_y = |value: f64| frame.bottom - y.share(value) * frame.height();

        let raster = self.raster(frame, x.descending, y.descending);
        self.draw_cells(&mut picture, frame, &raster, range.as_ref());
        self.draw_hatches(&mut picture, frame, &raster);
        if let Some(range) = &range {
            self.draw_contours(&mut picture, frame, &raster, range, &bar_ticks);
        }
        draw_borders(&mut picture, frame, &raster);
        for (index, curve) in self.curves.iter().enumerate() {
            let points: Vec<Point> =
                curve.points.iter().map(|&[x, y]| [place_x(x), place_y(y)]).collect();
            for part in clip(&points, frame) {
                draw_curve(&mut picture, &part, self.first_of_label(index));
            }
        }
        picture.frame(frame, RULE, INK);

        let placed = |ticks: Vec<Tick>, place: &dyn Fn(f64) -> f64| -> Vec<Tick> {
            ticks.into_iter().map(|(value, label)| (place(value), label)).collect()
        };
        page::bottom_axis(&mut picture, frame, &placed(x_ticks, &place_x), &self.x.label);
        page::left_axis(&mut picture, frame, &placed(y_ticks, &place_y), &self.y.label);
        if let Some(range) = &range {
            self.draw_bar(&mut picture, frame, range, &bar_ticks);
        }
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS + 22.0);
        Ok(picture)
    }
}
