//! Drawing of a verdict map.

use super::axes::AxisExtent;
use super::boundaries::{Boundaries, draw_borders, draw_line_sets};
use super::colour_bar::CONTOUR_WORD;
use super::colour_map::{BAR_GAP, BAR_WIDTH};
use super::curves::draw_curve;
use super::figure::VerdictMap;
use super::hatching::category_fill;
use super::levels::LevelRange;
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::page::{
    self, AXIS_NAME_SIZE, FRAME_LINE_WIDTH, Legend, MARGIN, MIN_TEXT_SIZE, TICK_LABEL_SIZE,
};
use crate::picture::{INK, Picture, Point, Rectangle, clip_polyline, text_width};
use crate::scale::{self, Tick};

/// Places of the parts of a map on the page, pixels.
struct MapLayout {
    axes: [AxisExtent; 2],
    ticks: [Vec<Tick>; 2],
    range: Option<LevelRange>,
    bar_ticks: Vec<Tick>,
    legend: Legend,
    /// Height of the page.
    height: f64,
    /// Area between the axes.
    frame: Rectangle,
}

impl VerdictMap {
    /// Renders the map in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// An axis is not a uniform grid, a list does not have one value per cell, a cell has an undefined category, or
    /// rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture())?.render(output)
    }

    /// Returns the area between the axes of the figure drawn with default options: left edge, top edge, width and height,
    /// as fractions of the width and the height of the figure. The first and last points of the axes are on its edges.
    ///
    /// # Errors
    /// An axis is not a uniform grid.
    pub fn plot_area(&self) -> Result<[f64; 4], FigureError> {
        let MapLayout { frame, height, .. } = self.lay_out()?;
        let width = page::width();
        Ok([frame.left / width, frame.top / height, frame.width() / width, frame.height() / height])
    }

    fn lay_out(&self) -> Result<MapLayout, FigureError> {
        let (x, y) = (AxisExtent::from_axis(&self.x)?, AxisExtent::from_axis(&self.y)?);
        self.validate()?;
        let range = LevelRange::from_levels(self.ill_posed_levels().map(|(_, level)| level));
        let legend = Legend::new(self.legend_entries(range.as_ref()), page::width() - 2.0 * MARGIN);

        // The heading is laid out first to find its height; the figure grows with the legend.
        let top = page::heading_bottom(&self.title, &self.subtitle);
        let below = page::BOTTOM_AXIS_HEIGHT + 22.0 + legend.height() + MARGIN - 12.0;
        let min_height = page::scale_height(if page::is_narrow() { 640.0 } else { 480.0 });
        let height = page::height().max(top + min_height + below).ceil();

        let bottom = height - below;
        let bar_ticks = match &range {
            Some(range) => {
                let max_count = ((bottom - top) / 60.0) as usize;
                scale::log_ticks(range.low, range.high, max_count)
            }
            None => Vec::new(),
        };
        let y_ticks = y.ticks(&self.y, bottom - top, true);
        // On a narrow page the name of the bar extends beside the word below it.
        let word_width = if page::is_narrow() {
            text_width(CONTOUR_WORD, MIN_TEXT_SIZE, false) - 12.0
        } else {
            TICK_LABEL_SIZE
        };
        let bar_width = range.as_ref().map_or(0.0, |_| {
            BAR_GAP
                + BAR_WIDTH
                + 18.0
                + page::max_label_width(&bar_ticks).max(word_width)
                + 1.5 * AXIS_NAME_SIZE
        });
        let frame = Rectangle {
            left: MARGIN + page::left_axis_width(&y_ticks),
            top,
            right: page::width() - MARGIN - bar_width,
            bottom,
        };
        let x_ticks = x.ticks(&self.x, frame.width(), false);
        let (axes, ticks) = ([x, y], [x_ticks, y_ticks]);
        Ok(MapLayout { axes, ticks, range, bar_ticks, legend, height, frame })
    }

    pub(super) fn to_picture(&self) -> Result<Picture, FigureError> {
        let layout = self.lay_out()?;
        let MapLayout { axes: [x, y], ticks: [x_ticks, y_ticks], range, .. } = layout;
        let MapLayout { bar_ticks, legend, height, frame, .. } = layout;
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let place_x = |value: f64| frame.left + x.fraction(value) * frame.width();
        let place_y = |value: f64| frame.bottom - y.fraction(value) * frame.height();

        let raster = self.build_raster(frame, x.is_descending, y.is_descending);
        let boundaries = Boundaries::new(&raster);
        self.draw_cells(&mut picture, frame, &raster, &boundaries, range.as_ref());
        self.draw_hatching(&mut picture, frame, &raster, &boundaries);
        let has_line = range.as_ref().map(|range| {
            self.draw_contours(&mut picture, frame, (&raster, &boundaries), range, &bar_ticks)
        });
        draw_borders(&mut picture, frame, &raster, &boundaries);
        let line_colour =
            |category: u8| category_fill(self.categories[usize::from(category)].fill_style).0;
        draw_line_sets(&mut picture, frame, &raster, line_colour);
        for (index, curve) in self.curves.iter().enumerate() {
            let points: Vec<Point> =
                curve.points.iter().map(|&[x, y]| [place_x(x), place_y(y)]).collect();
            for part in clip_polyline(&points, frame) {
                draw_curve(&mut picture, &part, self.style_index(index));
            }
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);

        let across = |share: f64| frame.left + share * frame.width();
        let upwards = |share: f64| frame.bottom - share * frame.height();
        let placed = |ticks: Vec<Tick>, place: &dyn Fn(f64) -> f64| -> Vec<Tick> {
            ticks.into_iter().map(|(share, label)| (place(share), label)).collect()
        };
        page::draw_bottom_axis(&mut picture, frame, &placed(x_ticks, &across), &self.x.label);
        page::draw_left_axis(&mut picture, frame, &placed(y_ticks, &upwards), &self.y.label);
        if let (Some(range), Some(has_line)) = (&range, &has_line) {
            self.draw_colour_bar(&mut picture, frame, range, (&bar_ticks, has_line));
        }
        legend.draw(&mut picture, MARGIN, frame.bottom + page::BOTTOM_AXIS_HEIGHT + 22.0);
        Ok(picture)
    }
}
