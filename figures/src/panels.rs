//! Curves in several panels with linear axes and one legend.

use plotters::style::RGBColor;

use crate::dispersion::DISAGREEMENT_COLOUR;
use crate::error::FigureError;
use crate::field::{
    FieldMarkKind, LOADED_LINE_TEXT, LOADED_LINE_WIDTH, draw_loaded_line, draw_mark,
};
use crate::format::FigureOutput;
use crate::growth::{GRID_COLOUR, LINE_WIDTH, LabelledCurve, LineStyle};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Rectangle, Text, clip_polyline, text_width,
};
use crate::scale::{self, FINITE_LIMIT, Tick};

/// Panel of curves with linear axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CurvePanel {
    /// Name, symbol and unit of the horizontal axis.
    pub x_label: String,
    /// Name, symbol and unit of the vertical axis.
    pub y_label: String,
    /// Curves; those of the same label in any panel share a style and a legend entry. Curves without label are solid and
    /// not listed. A point that is not finite interrupts a curve.
    pub curves: Vec<LabelledCurve>,
    /// Label of the curves that disagree with the reference lines and are drawn in red.
    pub disagreeing_label: Option<String>,
    /// Curves drawn wide and pale below the others, such as chords; listed once, with the label of the first.
    pub reference_lines: Vec<LabelledCurve>,
    /// Points marked by discs.
    pub points: Vec<[f64; 2]>,
    /// Legend text of the points; empty for none.
    pub point_label: String,
    /// Whether the values of the horizontal axis are decimal logarithms, whose ticks are written as powers of ten.
    pub is_x_log: bool,
    /// Ends of the horizontal axis; `None` for the range of the curves and points with a margin.
    pub x_ends: Option<[f64; 2]>,
    /// Least and greatest value of the vertical axis, such as those of all frames of an
    /// [`Animation`](crate::Animation); `None` for those of the curves and points.
    pub y_values: Option<[f64; 2]>,
    /// Sets of positions on the horizontal axis with a legend text each, such as borders between materials, drawn as
    /// thin vertical lines below the curves; the first three sets have distinct styles.
    pub positions: Vec<(String, Vec<f64>)>,
    /// Legend text and value of a level of the vertical axis, drawn as a thin dashed line below the curves.
    pub level: Option<(String, f64)>,
    /// Loaded points of the horizontal axis, drawn as wide lines along the frame outside its nearer end.
    pub loaded_ends: Vec<f64>,
    /// Sources and receivers at positions on the horizontal axis, drawn above the panel with their names.
    pub marks: Vec<CurveMark>,
}

/// Mark of a source or a receiver in a panel of curves.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveMark {
    /// Position, in the unit of the horizontal axis; marks outside the panel are not drawn.
    pub x: f64,
    /// Name written above the mark if there is room; may be empty.
    pub name: String,
    /// Kind of the mark.
    pub kind: FieldMarkKind,
}

/// Panels in rows of two, a single one and those of a narrow figure across the figure, with one legend.
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
/// Dashes of the vertical lines at sets of positions.
const POSITION_DASHES: [&[f64]; 3] = [&[], &[10.0, 6.0], &[3.0, 5.0]];
/// Dashes of levels.
const LEVEL_DASHES: &[f64] = &[14.0, 8.0];
/// Width of the lines at positions and levels, pixels.
const POSITION_LINE_WIDTH: f64 = 1.8;
/// Font size of the names of marks, pixels.
const MARK_NAME_SIZE: f64 = 22.0;
/// Height of the middle of a mark above the upper edge of the frame, pixels.
const MARK_HEIGHT: f64 = 16.0;
/// Height of the row of marks and names above a frame, pixels.
const MARK_ROW_HEIGHT: f64 = 2.0 * MARK_HEIGHT + 1.2 * MARK_NAME_SIZE;
/// Height of the frame of a panel, pixels.
const PANEL_HEIGHT: f64 = 400.0;
/// Height of the row of the letters of the panels, pixels.
const LETTER_ROW_HEIGHT: f64 = 26.0;
/// Distance between two panels beside each other, pixels.
const COLUMN_GAP: f64 = 30.0;

impl PanelsFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    pub(crate) fn to_picture(&self) -> Picture {
        let labels = self.distinct_labels();
        let positions = self.distinct_positions();
        let legend = Legend::new(self.legend_entries(&labels), page::width() - 2.0 * MARGIN);
        let has_marks = self.panels.iter().any(|panel| !panel.marks.is_empty());
        let marks_height = if has_marks { MARK_ROW_HEIGHT } else { 0.0 };
        let panel_height = page::scale_height(PANEL_HEIGHT);
        let letter_height = if self.panels.len() > 1 { LETTER_ROW_HEIGHT } else { 0.0 };
        let above = marks_height + letter_height;
        let row_height = panel_height + page::BOTTOM_AXIS_HEIGHT + 30.0 + above;
        let columns = if page::is_narrow() { 1 } else { self.panels.len().clamp(1, 2) };
        let rows = self.panels.len().div_ceil(columns).max(1) as f64;
        let top = page::heading_bottom(&self.title, &self.subtitle) + 14.0;
        let height = (top + rows * row_height + legend.height() + MARGIN).ceil();
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let width = match columns {
            1 => page::width() - 2.0 * MARGIN,
            _ => 0.5 * (page::width() - 2.0 * MARGIN - COLUMN_GAP),
        };
        // Frames below each other are aligned.
        let axis_width = |column: usize| {
            let panels = self.panels.iter().skip(column).step_by(columns);
            let widths = panels.map(|panel| page::left_axis_width(&panel.y_axis(panel_height).1));
            widths.fold(0.0, f64::max)
        };
        let axis_widths: Vec<f64> = (0..columns).map(axis_width).collect();
        for (index, panel) in self.panels.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let left = MARGIN + column as f64 * (width + COLUMN_GAP);
            let top = top + row as f64 * row_height + above;
            let frame = Rectangle {
                left: left + axis_widths[column],
                top,
                right: left + width - 16.0,
                bottom: top + panel_height,
            };
            panel.draw(&mut picture, frame, [&labels, &positions]);
            if self.panels.len() > 1 {
                let at = [frame.left, frame.top - marks_height - 9.0];
                let text = format!("({})", panel_letter(index));
                picture.draw_text(Text::new(at, Anchor::Start, page::TICK_LABEL_SIZE, text));
            }
        }
        legend.draw(&mut picture, MARGIN, top + rows * row_height);
        picture
    }

    /// Adds the letters of the panels with an element to its legend text, unless all panels have it.
    fn with_letters(&self, text: &str, has_element: impl Fn(&CurvePanel) -> bool) -> String {
        let panels = self.panels.iter().enumerate().filter(|(_, panel)| has_element(panel));
        let letters: Vec<String> =
            panels.map(|(index, _)| panel_letter(index).to_string()).collect();
        match letters.len() == self.panels.len() {
            true => text.to_owned(),
            false => format!("{text} ({})", letters.join(", ")),
        }
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
            let is_disagreeing =
                self.panels.iter().any(|panel| panel.disagreeing_label.as_deref() == Some(label));
            let style = curve_style(index, is_disagreeing);
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                style.draw_swatch(picture, area);
            };
            let has_label =
                |panel: &CurvePanel| panel.curves.iter().any(|curve| curve.label == *label);
            entries.push((self.with_letters(label, has_label), Box::new(swatch)));
        }
        if let Some(first) = self.panels.iter().find_map(|panel| panel.reference_lines.first()) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.draw_line(swatch_line(area), REFERENCE_LINE_WIDTH, REFERENCE_LINE_COLOUR);
            };
            let text = self.with_letters(&first.label, |panel| !panel.reference_lines.is_empty());
            entries.push((text, Box::new(swatch)));
        }
        for (index, label) in self.distinct_positions().into_iter().enumerate() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                draw_position(picture, index, 0.5 * (area.left + area.right), area);
            };
            let has_set = |panel: &CurvePanel| panel.positions.iter().any(|own| own.0 == label);
            entries.push((self.with_letters(label, has_set), Box::new(swatch)));
        }
        if let Some((label, _)) = self.panels.iter().find_map(|panel| panel.level.as_ref()) {
            let swatch =
                |picture: &mut Picture, area: Rectangle| draw_level(picture, swatch_line(area));
            let text = self.with_letters(label, |panel| panel.level.is_some());
            entries.push((text, Box::new(swatch)));
        }
        let is_labelled =
            |panel: &&CurvePanel| !panel.points.is_empty() && !panel.point_label.is_empty();
        if let Some(panel) = self.panels.iter().find(is_labelled) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let [from, to] = swatch_line(area);
                picture.fill_disc([0.5 * (from[0] + to[0]), from[1]], POINT_RADIUS, INK);
            };
            let text = self.with_letters(&panel.point_label, |own| is_labelled(&own));
            entries.push((text, Box::new(swatch)));
        }
        if self.panels.iter().any(|panel| !panel.loaded_ends.is_empty()) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                draw_loaded_line(picture, &swatch_line(area));
            };
            entries.push((LOADED_LINE_TEXT.to_owned(), Box::new(swatch)));
        }
        for (kind, label) in
            [(FieldMarkKind::Source, "source or load"), (FieldMarkKind::Receiver, "receiver")]
        {
            let mut marks = self.panels.iter().flat_map(|panel| &panel.marks);
            if marks.any(|mark| mark.kind == kind) {
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let [from, to] = swatch_line(area);
                    draw_mark(picture, [0.5 * (from[0] + to[0]), from[1]], kind);
                };
                entries.push((label.to_owned(), Box::new(swatch)));
            }
        }
        entries
    }

    /// Returns the legend texts of all sets of positions, in the order of their first occurrence.
    fn distinct_positions(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = Vec::new();
        for (label, _) in self.panels.iter().flat_map(|panel| &panel.positions) {
            if !labels.contains(&label.as_str()) {
                labels.push(label);
            }
        }
        labels
    }
}

/// Returns the letter of the panel with this index: a, b, c …
fn panel_letter(index: usize) -> char {
    ('a'..='z').nth(index).unwrap_or('z')
}

/// Returns the style of the curves whose label has this index.
fn curve_style(index: usize, is_disagreeing: bool) -> LineStyle {
    let style = LineStyle::from_index(index);
    if is_disagreeing { LineStyle { colour: DISAGREEMENT_COLOUR, ..style } } else { style }
}

/// Draws the vertical line of the set of positions with this index across an area.
fn draw_position(picture: &mut Picture, index: usize, x: f64, area: Rectangle) {
    let dashes = POSITION_DASHES[index % POSITION_DASHES.len()];
    let ends = [[x, area.top], [x, area.bottom]];
    picture.draw_curve(&ends, dashes, POSITION_LINE_WIDTH, PALE_INK);
}

/// Draws the line of a level.
fn draw_level(picture: &mut Picture, ends: [[f64; 2]; 2]) {
    picture.draw_curve(&ends, LEVEL_DASHES, POSITION_LINE_WIDTH, PALE_INK);
}

fn swatch_line(area: Rectangle) -> [[f64; 2]; 2] {
    let middle = 0.5 * (area.top + area.bottom);
    [[area.left, middle], [area.right, middle]]
}

impl CurvePanel {
    /// Iterates over all points.
    fn all_points(&self) -> impl Iterator<Item = &[f64; 2]> {
        let curves = self.curves.iter().chain(&self.reference_lines);
        curves.flat_map(|curve| &curve.points).chain(&self.points)
    }

    fn level_value(&self) -> Option<f64> {
        self.level.as_ref().map(|(_, value)| *value)
    }

    /// Returns the ends of the vertical axis of a frame of some height, its ticks and their common factor.
    fn y_axis(&self, height: f64) -> ([f64; 2], Vec<Tick>, String) {
        let ends = match self.y_values {
            Some(ends) => axis_range(ends.into_iter()),
            None => axis_range(self.all_points().map(|point| point[1]).chain(self.level_value())),
        };
        let (ticks, factor) = page::choose_ticks_with_multiplier(height, true, |count| {
            scale::linear_ticks_with_multiplier(ends[0], ends[1], count)
        });
        (ends, ticks, factor)
    }

    /// Draws the panel with its axes; the styles of curves and of sets of positions follow from the indices of their
    /// labels in `labels` and `positions`.
    fn draw(&self, picture: &mut Picture, frame: Rectangle, [labels, positions]: [&[&str]; 2]) {
        let level = self.level_value();
        let is_valid = |[from, to]: &[f64; 2]| from < to && to - from < FINITE_LIMIT;
        let x = match self.x_ends.filter(is_valid) {
            Some(ends) => ends,
            None => axis_range(self.all_points().map(|point| point[0])),
        };
        let (y, y_ticks, y_factor) = self.y_axis(frame.height());
        let at = |[a, b]: [f64; 2]| {
            let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
            [frame.left + share(a, x) * frame.width(), frame.bottom - share(b, y) * frame.height()]
        };
        let (x_ticks, x_factor) =
            page::choose_ticks_with_multiplier(frame.width(), false, |count| match self.is_x_log {
                true => (scale::log_ticks(x[0], x[1], count), String::new()),
                false => scale::linear_ticks_with_multiplier(x[0], x[1], count),
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
        for (label, places) in &self.positions {
            let index = positions.iter().position(|own| own == label).unwrap_or(0);
            for place in places.iter().filter(|place| (x[0]..=x[1]).contains(place)) {
                draw_position(picture, index, at([*place, y[0]])[0], frame);
            }
        }
        if let Some(level) = level.filter(|level| (y[0]..=y[1]).contains(level)) {
            let height = at([x[0], level])[1];
            draw_level(picture, [[frame.left, height], [frame.right, height]]);
        }
        for line in &self.reference_lines {
            for part in parts(line) {
                picture.draw_line(part, REFERENCE_LINE_WIDTH, REFERENCE_LINE_COLOUR);
            }
        }
        for curve in &self.curves {
            let index = labels.iter().position(|label| *label == curve.label);
            let plain = LineStyle { colour: INK, dashes: &[], width: LINE_WIDTH };
            let is_disagreeing = self.disagreeing_label.as_ref() == Some(&curve.label);
            let style = index.map_or(plain, |index| curve_style(index, is_disagreeing));
            for part in parts(curve) {
                style.draw(picture, &part);
            }
        }
        for point in self.points.iter().filter(|p| p.iter().all(|own| own.abs() < FINITE_LIMIT)) {
            picture.mark_point(at(*point), POINT_RADIUS);
            picture.fill_disc(at(*point), POINT_RADIUS, INK);
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        page::draw_bottom_axis(
            picture,
            frame,
            &across,
            &scale::label_with_multiplier(&self.x_label, &x_factor),
        );
        page::draw_left_axis(
            picture,
            frame,
            &upwards,
            &scale::label_with_multiplier(&self.y_label, &y_factor),
        );
        for position in &self.loaded_ends {
            let is_left = at([*position, y[0]])[0] < 0.5 * (frame.left + frame.right);
            let x = match is_left {
                true => frame.left - 0.5 * LOADED_LINE_WIDTH,
                false => frame.right + 0.5 * LOADED_LINE_WIDTH,
            };
            draw_loaded_line(picture, &[[x, frame.top], [x, frame.bottom]]);
        }
        self.draw_marks(picture, frame, |place| at([place, y[0]])[0]);
    }

    /// Draws the marks above the frame, each with its name if that covers no other name. Names at the ends of the row are
    /// moved inwards.
    fn draw_marks(&self, picture: &mut Picture, frame: Rectangle, to_pixel: impl Fn(f64) -> f64) {
        // Names may extend into the margins of the page.
        let [left_end, right_end] = [frame.left - MARGIN, frame.right + MARGIN];
        let mut names_end = left_end;
        let mut marks: Vec<(f64, &CurveMark)> =
            self.marks.iter().map(|mark| (to_pixel(mark.x), mark)).collect();
        marks.retain(|(x, _)| (frame.left..=frame.right).contains(x));
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (x, mark) in marks {
            draw_mark(picture, [x, frame.top - MARK_HEIGHT], mark.kind);
            let half = 0.5 * text_width(&mark.name, MARK_NAME_SIZE, false) + 4.0;
            let middle = x.min(right_end - half).max(left_end + half);
            if middle - half >= names_end && !mark.name.is_empty() {
                let at = [middle, frame.top - 2.0 * MARK_HEIGHT];
                picture.draw_text(Text::new(at, Anchor::Middle, MARK_NAME_SIZE, &mark.name));
                names_end = middle + half;
            }
        }
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
            y_label: "pressure p (MPa)".into(),
            curves: curves.into_iter().enumerate().map(labelled).collect(),
            reference_lines: vec![LabelledCurve {
                label: "chords".into(),
                points: vec![[0.0, 0.0], [1.0, 1.0]],
            }],
            points: vec![[0.5, 0.5], [f64::NAN, 1.0]],
            ..CurvePanel::default()
        }
    }

    /// Every set of positions and every kind of mark is listed once; a mark without room for its name is drawn.
    #[test]
    fn positions_and_marks_are_listed_once() {
        let mark = |x: f64, name: &str, kind| CurveMark { x, name: name.into(), kind };
        let mut own = panel(vec![vec![[0.0, 0.0], [10.0, 1.0]]]);
        own.positions =
            vec![("border".into(), vec![2.0, 5.0, 99.0]), ("slipped".into(), vec![3.0])];
        own.marks = vec![
            mark(4.0, "R1", FieldMarkKind::Receiver),
            mark(4.01, "R2", FieldMarkKind::Receiver),
            mark(7.0, "force", FieldMarkKind::Source),
            mark(-70.0, "outside", FieldMarkKind::Source),
        ];
        own.loaded_ends = vec![10.0];
        let panels = vec![own.clone(), own];
        let figure = PanelsFigure { title: "Title".into(), subtitle: "sub".into(), panels };
        let picture = figure.to_picture();
        check_drawing(&picture, |format| figure.draw(format));
        let count = |text: &str| picture.texts().filter(|own| own.content == text).count();
        let counts =
            ["border", "slipped", "receiver", "source or load", "R1", "R2", "force", "outside"];
        assert_eq!(counts.map(count), [1, 1, 1, 1, 2, 0, 2, 0]);
        assert_eq!(count(LOADED_LINE_TEXT), 1);
    }

    /// The vertical axis covers the given values, whatever the curve is.
    #[test]
    fn vertical_axis_follows_the_given_values() {
        let axis_names = |scale: f64| {
            let mut own = panel(vec![vec![[0.0, 0.0], [10.0, scale]]]);
            own.reference_lines.clear();
            own.points.clear();
            own.y_values = Some([-30.0, 50.0]);
            let figure =
                PanelsFigure { title: "T".into(), subtitle: String::new(), panels: vec![own] };
            figure.to_picture().texts().map(|own| own.content.clone()).collect::<Vec<_>>()
        };
        assert!(axis_names(1.0).contains(&"40".to_owned()));
        assert_eq!(axis_names(1.0), axis_names(20.0));
        // Large numbers have a common factor, and given ends of the horizontal axis are exact.
        let mut own = panel(vec![vec![[0.5, -4e6], [7.5, 0.0]]]);
        own.reference_lines.clear();
        own.points.clear();
        own.x_ends = Some([0.0, 8.0]);
        let figure = PanelsFigure { title: "T".into(), subtitle: String::new(), panels: vec![own] };
        let picture = figure.to_picture();
        let texts: Vec<&str> = picture.texts().map(|own| own.content.as_str()).collect();
        assert!(texts.contains(&"pressure p (10⁶ MPa)") && texts.contains(&"−4"), "{texts:?}");
        let end = picture.texts().find(|own| own.content == "8.0").unwrap();
        assert!((end.anchor_point[0] - (page::WIDTH - MARGIN - 16.0)).abs() < 1e-9);
    }

    #[test]
    fn marks_at_the_ends_have_their_names() {
        let mut own = panel(vec![vec![[0.0, 0.0], [10.0, 1.0]]]);
        own.x_ends = Some([0.0, 10.0]);
        let mark = |x: f64, name: &str| CurveMark {
            x,
            name: name.to_owned(),
            kind: FieldMarkKind::Receiver,
        };
        own.marks = vec![mark(0.0, "bottom of the column"), mark(10.0, "surface of the column")];
        let figure = PanelsFigure { title: "T".into(), subtitle: String::new(), panels: vec![own] };
        let picture = figure.to_picture();
        picture.assert_texts_do_not_overlap();
        for name in ["bottom of the column", "surface of the column"] {
            let text = picture.texts().find(|own| own.content == name).unwrap();
            assert!(text.bounds().left >= 0.0 && text.bounds().right <= page::WIDTH, "{name}");
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
