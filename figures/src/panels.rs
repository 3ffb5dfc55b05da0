//! Curves in several panels with linear axes and one legend.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::{GRID_COLOUR, LINE_WIDTH, LabelledCurve, LineStyle};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN};
use crate::picture::{Colour, INK, Picture, Rectangle, clip_polyline};
use crate::scale::{self, FINITE_LIMIT, Tick};

/// Panel of curves with linear axes.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePanel {
    /// Name, symbol and unit of the horizontal axis.
    pub x_label: String,
    /// Name, symbol and unit of the vertical axis.
    pub y_label: String,
    /// Curves; those of the same label in any panel share a style and a legend entry. Curves without label are solid and
    /// not listed. A point that is not finite interrupts a curve.
    pub curves: Vec<LabelledCurve>,
    /// Curves drawn wide and pale below the others, such as chords; listed once, with the label of the first.
    pub reference_lines: Vec<LabelledCurve>,
    /// Points marked by discs.
    pub points: Vec<[f64; 2]>,
}

/// Panels in rows of two, a single one across the figure, with one legend.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelsFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Panels, row by row.
    pub panels: Vec<CurvePanel>,
}

const REFERENCE_LINE_COLOUR: Colour = RGBColor(203, 205, 214);
const REFERENCE_LINE_WIDTH: f64 = 12.0;
const POINT_RADIUS: f64 = 7.0;
/// Height of the frame of a panel, pixels.
const PANEL_HEIGHT: f64 = 400.0;
/// Distance between two panels beside each other, pixels.
const COLUMN_GAP: f64 = 30.0;

impl PanelsFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        self.to_picture().render(output)
    }

    fn to_picture(&self) -> Picture {
        let labels = self.distinct_labels();
        let legend = Legend::new(self.legend_entries(&labels), page::WIDTH - 2.0 * MARGIN);
        let row_height = PANEL_HEIGHT + page::BOTTOM_AXIS_HEIGHT + 30.0;
        let rows = self.panels.len().div_ceil(2).max(1) as f64;
        let top = page::heading_bottom(&self.title, &self.subtitle) + 14.0;
        let height = (top + rows * row_height + legend.height() + MARGIN).ceil();
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let width = match self.panels.len() {
            1 => page::WIDTH - 2.0 * MARGIN,
            _ => 0.5 * (page::WIDTH - 2.0 * MARGIN - COLUMN_GAP),
        };
        for (index, panel) in self.panels.iter().enumerate() {
            let left = MARGIN + (index % 2) as f64 * (width + COLUMN_GAP);
            let top = top + (index / 2) as f64 * row_height;
            let area = Rectangle { left, top, right: left + width, bottom: top + PANEL_HEIGHT };
            panel.draw(&mut picture, area, &labels);
        }
        legend.draw(&mut picture, MARGIN, top + rows * row_height);
        picture
    }

    /// Returns the labels of all curves, in the order of their first occurrence.
    fn distinct_labels(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = Vec::new();
        for curve in self.panels.iter().flat_map(|panel| &panel.curves) {
            if !curve.label.is_empty() && !labels.contains(&curve.label.as_str()) {
                labels.push(&curve.label);
            }
        }
        labels
    }

    fn legend_entries(&self, labels: &[&str]) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for (index, label) in labels.iter().enumerate() {
            let style = LineStyle::from_index(index);
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                style.draw_swatch(picture, area);
            };
            entries.push(((*label).to_owned(), Box::new(swatch)));
        }
        if let Some(first) = self.panels.iter().find_map(|panel| panel.reference_lines.first()) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.draw_line(swatch_line(area), REFERENCE_LINE_WIDTH, REFERENCE_LINE_COLOUR);
            };
            entries.push((first.label.clone(), Box::new(swatch)));
        }
        entries
    }
}

fn swatch_line(area: Rectangle) -> [[f64; 2]; 2] {
    let middle = 0.5 * (area.top + area.bottom);
    [[area.left, middle], [area.right, middle]]
}

impl CurvePanel {
    /// Draws the panel with its axes; the styles of curves follow from the positions of their labels in `labels`.
    fn draw(&self, picture: &mut Picture, area: Rectangle, labels: &[&str]) {
        let all = || {
            let curves = self.curves.iter().chain(&self.reference_lines);
            curves.flat_map(|curve| &curve.points).chain(&self.points)
        };
        let [x, y] = [0, 1].map(|axis| axis_range(all().map(|point| point[axis])));
        let y_ticks = page::choose_ticks(area.height(), true, |count| {
            scale::linear_ticks(y[0], y[1], count, false)
        });
        let left = area.left + page::left_axis_width(&y_ticks);
        let frame = Rectangle { left, right: area.right - 16.0, ..area };
        let at = |[a, b]: [f64; 2]| {
            let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
            [frame.left + share(a, x) * frame.width(), frame.bottom - share(b, y) * frame.height()]
        };
        let x_ticks = page::choose_ticks(frame.width(), false, |count| {
            scale::linear_ticks(x[0], x[1], count, false)
        });
        let across: Vec<Tick> =
            x_ticks.into_iter().map(|(value, name)| (at([value, y[0]])[0], name)).collect();
        let upwards: Vec<Tick> =
            y_ticks.into_iter().map(|(value, name)| (at([x[0], value])[1], name)).collect();
        for (place, _) in &across {
            picture.draw_line([[*place, frame.top], [*place, frame.bottom]], 1.2, GRID_COLOUR);
        }
        for (place, _) in &upwards {
            picture.draw_line([[frame.left, *place], [frame.right, *place]], 1.2, GRID_COLOUR);
        }
        let parts = |curve: &LabelledCurve| {
            let finite = |p: &[f64; 2]| p.iter().all(|own| own.abs() < FINITE_LIMIT);
            let place = |p: &[f64; 2]| if finite(p) { at(*p) } else { [f64::NAN; 2] };
            let points: Vec<[f64; 2]> = curve.points.iter().map(place).collect();
            clip_polyline(&points, frame)
        };
        for line in &self.reference_lines {
            for part in parts(line) {
                picture.draw_line(part, REFERENCE_LINE_WIDTH, REFERENCE_LINE_COLOUR);
            }
        }
        for curve in &self.curves {
            let index = labels.iter().position(|label| *label == curve.label);
            let plain = LineStyle { colour: INK, dashes: &[], width: LINE_WIDTH };
            let style = index.map_or(plain, LineStyle::from_index);
            for part in parts(curve) {
                style.draw(picture, &part);
            }
        }
        for point in self.points.iter().filter(|p| p.iter().all(|own| own.abs() < FINITE_LIMIT)) {
            picture.fill_disc(at(*point), POINT_RADIUS, INK);
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        page::draw_bottom_axis(picture, frame, &across, &self.x_label);
        page::draw_left_axis(picture, frame, &upwards, &self.y_label);
    }
}

/// Computes the range of the finite coordinates with margins; a default range if there are none.
fn axis_range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.abs() < FINITE_LIMIT);
    let ends = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    match ends {
        [low, high] if low > high => [0.0, 1.0],
        [low, high] => {
            let size = low.abs().max(high.abs());
            let margin = 0.04 * (high - low);
            let margin = match margin > 1e-9 * size {
                true => margin,
                // A constant; zero is in the middle of an axis from −1 to 1.
                false if size < 1e-300 => 1.0,
                false => 0.5 * size,
            };
            [low - margin, high + margin]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, edge_case_curves};

    fn panel(curves: Vec<Vec<[f64; 2]>>) -> CurvePanel {
        let label =
            |index: usize| if index == 1 { String::new() } else { format!("curve {index}") };
        let labelled = |(index, points)| LabelledCurve { label: label(index), points };
        CurvePanel {
            x_label: "compression strain ε, %".into(),
            y_label: "pressure p, MPa".into(),
            curves: curves.into_iter().enumerate().map(labelled).collect(),
            reference_lines: vec![LabelledCurve {
                label: "chords".into(),
                points: vec![[0.0, 0.0], [1.0, 1.0]],
            }],
            points: vec![[0.5, 0.5], [f64::NAN, 1.0]],
        }
    }

    #[test]
    fn panels_of_any_number_and_edge_cases_are_drawn() {
        for count in 0..=5 {
            let panels = (0..count).map(|_| panel(edge_case_curves())).collect();
            let figure = PanelsFigure { title: "Title".into(), subtitle: "sub".into(), panels };
            check_drawing(&figure.to_picture(), |format| figure.draw(format));
        }
        for curve in edge_case_curves() {
            let mut own = panel(vec![curve]);
            own.reference_lines.clear();
            own.points.clear();
            let figure =
                PanelsFigure { title: "Title".into(), subtitle: String::new(), panels: vec![own] };
            check_drawing(&figure.to_picture(), |format| figure.draw(format));
        }
    }
}
