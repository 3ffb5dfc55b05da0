//! Drawing of a dispersion figure.

use super::axes::AxisScale;
use super::figure::{DispersionBranch, DispersionFigure};
use super::plot::{DispersionPanel, level_labels_width};
use super::styles::{CUTOFF_DASHES, SPEED_LIMIT_DASHES};
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::page::{self, Legend, MARGIN};
use crate::picture::{Picture, Point, Rectangle};

impl DispersionFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    pub(super) fn to_picture(&self) -> Picture {
        let legend = Legend::new(self.legend_entries(), page::width() - 2.0 * MARGIN);
        let heading = page::heading_bottom(&self.title, &self.subtitle);
        let top = heading + 14.0;
        let below = page::BOTTOM_AXIS_HEIGHT + 22.0 + legend.height() + MARGIN - 12.0;
        let is_stacked = page::is_narrow();
        let min_height = match (self.has_growth(), is_stacked) {
            (true, true) => 1200.0,
            (false, true) => 900.0,
            (true, false) => 780.0,
            (false, false) => 560.0,
        };
        // Height between the axes of panels one above the other: without and with axis.
        let between = 34.0;
        let below_axis = page::BOTTOM_AXIS_HEIGHT + 20.0;
        let spare = if is_stacked { below_axis } else { 0.0 };
        let height =
            page::height().max(top + page::scale_height(min_height) + spare + below).ceil();
        let bottom = height - below;
        let mut picture = page::create_page(height, &self.title, &self.subtitle);

        // The panels of frequencies and of growth rates share the wave-number axis; that of speeds is beside them, on a
        // narrow page below them.
        let [k_scale, frequency, speed, growth] = self.axis_scales();
        let [left_bottom, right_top] = match is_stacked {
            true => {
                let share = if self.has_growth() { 0.64 } else { 0.5 };
                let left_bottom = top + share * (bottom - top - below_axis);
                [left_bottom, left_bottom + below_axis]
            }
            false => [bottom, top],
        };
        let split = if self.has_growth() { top + 0.58 * (left_bottom - top) } else { left_bottom };
        let axis =
            |scale: &AxisScale, length: f64| page::left_axis_width(&scale.ticks(length, true));
        let mut left_axis = axis(&frequency, split - top);
        if self.has_growth() {
            left_axis = left_axis.max(axis(&growth, left_bottom - split - between));
        }
        let axis_right = axis(&speed, bottom - right_top);
        let content_right = page::width() - MARGIN;
        let half = 0.5 * (content_right - MARGIN - 30.0);
        // Panels beside each other have the same width, and hence the same ticks.
        let [mut beside_left, mut beside_right] =
            [&self.cutoffs, &self.speed_limits].map(|levels| level_labels_width(levels));
        if !is_stacked {
            let [left_width, right_width] = [left_axis + beside_left, axis_right + beside_right];
            beside_left += (right_width - left_width).max(0.0);
            beside_right += (left_width - right_width).max(0.0);
        }
        let left_right = if is_stacked { content_right } else { MARGIN + half };
        let left = Rectangle {
            left: MARGIN + left_axis,
            top,
            right: left_right - 16.0 - beside_left,
            bottom: split,
        };
        let right_left = if is_stacked { MARGIN } else { MARGIN + half + 30.0 };
        let right = Rectangle {
            left: right_left + axis_right,
            top: right_top,
            right: content_right - 16.0 - beside_right,
            bottom,
        };
        let lines =
            |of: &dyn Fn(&DispersionBranch) -> Vec<Point>| self.branches.iter().map(of).collect();
        let plot = |frame: Rectangle, y: AxisScale, solid: Vec<Vec<Point>>| DispersionPanel {
            frame,
            x_scale: k_scale,
            y_scale: y,
            solid_lines: solid,
            styles: (0..self.branches.len()).map(|branch| self.branch_style(branch)).collect(),
            dashed_lines: Vec::new(),
            measured_points: Vec::new(),
            disagreeing_points: Vec::new(),
            levels: &[],
            level_dashes: CUTOFF_DASHES,
            bands: &[],
        };
        let disagreeing: Vec<Point> = self
            .branches
            .iter()
            .flat_map(|branch| &branch.disagreeing_frequency)
            .copied()
            .collect();
        let frequencies = DispersionPanel {
            measured_points: self
                .branches
                .iter()
                .map(|branch| branch.measured_frequency.clone())
                .collect(),
            disagreeing_points: disagreeing.clone(),
            levels: &self.cutoffs,
            bands: &self.bands,
            ..plot(left, frequency, lines(&|branch| branch.frequency.clone()))
        };
        let has_growth_panel = self.has_growth();
        let name = (!has_growth_panel).then_some(self.wave_number_label.as_str());
        frequencies.draw(&mut picture, name, &self.frequency_label);
        if has_growth_panel {
            let frame = Rectangle { top: split + between, bottom: left_bottom, ..left };
            let plot = plot(frame, growth, lines(&|branch| branch.growth_rate.clone()));
            plot.draw(&mut picture, Some(&self.wave_number_label), &self.growth_label);
        }
        let speeds = DispersionPanel {
            dashed_lines: lines(&|branch| branch.group_speed.clone()),
            measured_points: lines(&|branch| Self::phase_speeds(&branch.measured_frequency)),
            disagreeing_points: Self::phase_speeds(&disagreeing),
            levels: &self.speed_limits,
            level_dashes: SPEED_LIMIT_DASHES,
            ..plot(right, speed, lines(&Self::branch_phase_speeds))
        };
        speeds.draw(&mut picture, Some(&self.wave_number_label), &self.speed_label);
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS_HEIGHT + 22.0);
        picture
    }
}
