//! Drawing of a dispersion figure.

use super::axes::Scale;
use super::figure::{Branch, DispersionFigure};
use super::looks::{CUTOFF, LIMIT};
use super::plot::Plot;
use crate::error::FigureError;
use crate::format::Format;
use crate::page::{self, Legend, MARGIN};
use crate::picture::{Picture, Point, Rectangle};

impl DispersionFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    pub(super) fn picture(&self) -> Picture {
        let legend = Legend::new(self.legend(), page::WIDTH - 2.0 * MARGIN);
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let heading = page::heading(&mut sheet, &self.title, &self.subtitle);
        let top = heading + 14.0;
        let below = page::BOTTOM_AXIS + 22.0 + legend.height() + MARGIN - 12.0;
        let least = if self.has_growth() { 780.0 } else { 560.0 };
        let height = page::HEIGHT.max(top + least + below).ceil();
        let bottom = height - below;
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);

        // The panels of frequencies and of growth rates share the wave-number axis.
        let [k, frequency, speed, growth] = self.scales();
        let between = 34.0;
        let split = if self.has_growth() { top + 0.58 * (bottom - top) } else { bottom };
        let axis = |scale: &Scale, length: f64| page::left_axis_width(&scale.ticks(length, true));
        let mut left_axis = axis(&frequency, split - top);
        if self.has_growth() {
            left_axis = left_axis.max(axis(&growth, bottom - split - between));
        }
        let half = 0.5 * (page::WIDTH - 2.0 * MARGIN - 30.0);
        let left =
            Rectangle { left: MARGIN + left_axis, top, right: MARGIN + half - 16.0, bottom: split };
        let right_axis = axis(&speed, bottom - top);
        let right = Rectangle {
            left: MARGIN + half + 30.0 + right_axis,
            top,
            right: page::WIDTH - MARGIN - 16.0,
            bottom,
        };
        let lines = |of: &dyn Fn(&Branch) -> Vec<Point>| self.branches.iter().map(of).collect();
        let plot = |frame: Rectangle, y: Scale, solid: Vec<Vec<Point>>| Plot {
            frame,
            x: k,
            y,
            solid,
            dashed: Vec::new(),
            rings: Vec::new(),
            levels: &[],
            pattern: CUTOFF,
            bands: &[],
        };
        let frequencies = Plot {
            rings: self.branches.iter().map(|branch| branch.measured.clone()).collect(),
            levels: &self.cutoffs,
            bands: &self.bands,
            ..plot(left, frequency, lines(&|branch| branch.frequency.clone()))
        };
        let below_it = self.has_growth();
        let name = (!below_it).then_some(self.k_label.as_str());
        frequencies.draw(&mut picture, name, &self.frequency_label);
        if below_it {
            let frame = Rectangle { top: split + between, bottom, ..left };
            let plot = plot(frame, growth, lines(&|branch| branch.growth.clone()));
            plot.draw(&mut picture, Some(&self.k_label), &self.growth_label);
        }
        let speeds = Plot {
            dashed: lines(&|branch| branch.group_speed.clone()),
            rings: lines(&|branch| Self::phases(&branch.measured)),
            levels: &self.speed_limits,
            pattern: LIMIT,
            ..plot(right, speed, lines(&Self::phase))
        };
        speeds.draw(&mut picture, Some(&self.k_label), &self.speed_label);
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS + 22.0);
        picture
    }
}
