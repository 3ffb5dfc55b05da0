//! Growth rates against the direction and against the wave number.

use plotters::style::RGBColor;

use crate::colour::CURVE_COLOURS;
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN, Swatch};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip_polyline,
    text_width,
};
use crate::scale::{self, FINITE_LIMIT, SymmetricLog, Tick};

/// Curve with a legend text, e.g. the growth rate of one model.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledCurve {
    /// Legend text. Lines with the same label in both panels share a style and are listed once.
    pub label: String,
    /// Points in the units of the axes. NaN interrupts the line; an infinite growth rate is drawn at the edge of the
    /// panel.
    pub points: Vec<[f64; 2]>,
}

impl LabelledCurve {
    /// Returns whether the curve has points to be drawn; a curve without any is not in the legend.
    pub(crate) fn is_drawn(&self) -> bool {
        self.points.iter().any(|[x, y]| x.is_finite() && !y.is_nan())
    }
}

/// Marked position on the horizontal axis, drawn as a thin vertical line.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisMark {
    /// Label of a few words, written above the panel.
    pub label: String,
    /// Position, in the unit of the horizontal axis.
    pub x: f64,
}

/// Panel of growth rates against one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthPanel {
    /// Name, symbol and unit of the horizontal axis.
    pub x_label: String,
    /// Name, symbol and unit of the growth rate.
    pub y_label: String,
    /// Whether the horizontal axis is logarithmic; points with non-positive abscissa are then omitted.
    pub is_x_log: bool,
    /// Lines, one per model; the first eight have distinct styles.
    pub curves: Vec<LabelledCurve>,
    /// Reference lines such as asymptotes, drawn wide and pale below the other lines in one style and listed once with
    /// the label of the first. They are omitted in the linear part of the vertical axis, where power laws are not
    /// straight.
    pub reference_lines: Vec<LabelledCurve>,
    /// Marked positions, e.g. characteristic directions.
    pub marks: Vec<AxisMark>,
    /// Whether the points of the curves are measured values, which are marked by discs.
    pub is_measured: bool,
}

/// Growth rates against the direction and against the wave number, in two panels side by side, in a narrow figure one
/// below the other.
///
/// A vertical axis is logarithmic if all its values have the same sign and the largest is at least twice the
/// smallest. Otherwise it is
/// symmetric logarithmic, that is linear near zero and logarithmic at larger magnitudes, so that growth and decay over
/// many decades are visible.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Left or upper panel: growth rates against the direction.
    pub by_direction: GrowthPanel,
    /// Right or lower panel: growth rates against the wave number.
    pub by_wave_number: GrowthPanel,
}

/// Colour of reference lines such as asymptotes.
const REFERENCE_LINE_COLOUR: Colour = RGBColor(203, 205, 214);
const REFERENCE_LINE_WIDTH: f64 = 11.0;

/// Style of a line; any two of the styles differ in colour and in greyscale. Lines have no markers: those would look like
/// data points.
#[derive(Clone, Copy)]
pub(crate) struct LineStyle {
    pub colour: Colour,
    pub dashes: &'static [f64],
    /// Width, pixels.
    pub width: f64,
}

/// Styles of lines.
pub(crate) const LINE_STYLES: [LineStyle; 8] = [
    LineStyle::new(CURVE_COLOURS[0], &[], LINE_WIDTH),
    LineStyle::new(CURVE_COLOURS[1], &[18.0, 8.0], LINE_WIDTH),
    LineStyle::new(CURVE_COLOURS[2], &[4.5, 6.0], 4.4),
    LineStyle::new(CURVE_COLOURS[3], &[20.0, 6.0, 4.0, 6.0], LINE_WIDTH),
    LineStyle::new(CURVE_COLOURS[4], &[], 1.8),
    LineStyle::new(CURVE_COLOURS[5], &[34.0, 7.0], 2.6),
    LineStyle::new(CURVE_COLOURS[6], &[9.0, 5.0], 5.2),
    LineStyle::new(CURVE_COLOURS[7], &[4.0, 5.0, 4.0, 5.0, 16.0, 5.0], LINE_WIDTH),
];

impl LineStyle {
    const fn new(colour: Colour, dashes: &'static [f64], width: f64) -> Self {
        Self { colour, dashes, width }
    }

    /// Returns the style of the line with this index in the legend. Beyond eight lines, all colours but black are combined
    /// with other dash patterns and widths.
    pub fn from_index(index: usize) -> Self {
        let count = LINE_STYLES.len();
        if index < count {
            return LINE_STYLES[index];
        }
        let (round, colour) =
            ((index - count) / (count - 1) + 1, (index - count) % (count - 1) + 1);
        let other = LINE_STYLES[(colour + round) % count];
        Self { colour: LINE_STYLES[colour].colour, ..other }
    }

    pub fn draw(&self, picture: &mut Picture, points: &[Point]) {
        picture.draw_curve(points, self.dashes, self.width, self.colour);
    }

    /// Draws the swatch of a line across the middle of an area.
    pub fn draw_swatch(&self, picture: &mut Picture, area: Rectangle) {
        let middle = 0.5 * (area.top + area.bottom);
        self.draw(picture, &[[area.left, middle], [area.right, middle]]);
    }
}

/// Background of the linear part of a symmetric logarithmic axis.
pub(crate) const LINEAR_RANGE_COLOUR: Colour = RGBColor(240, 240, 236);
pub(crate) const GRID_COLOUR: Colour = RGBColor(226, 226, 226);
pub(crate) const LINE_WIDTH: f64 = 3.4;
/// Radius of the discs of measured points, pixels.
const MEASURED_POINT_RADIUS: f64 = 6.5;
/// Font size of the labels above marks, pixels.
const MARK_LABEL_SIZE: f64 = 22.0;
const MARK_ROW_HEIGHT: f64 = 1.35 * MARK_LABEL_SIZE;

impl GrowthFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    fn to_picture(&self) -> Picture {
        let scales = [
            GrowthScales::from_panel(&self.by_direction),
            GrowthScales::from_panel(&self.by_wave_number),
        ];
        let legend = Legend::new(self.legend_entries(&scales), page::width() - 2.0 * MARGIN);

        let heading = page::heading_bottom(&self.title, &self.subtitle);
        let below = page::BOTTOM_AXIS_HEIGHT + 22.0 + legend.height() + MARGIN - 12.0;

        // Widths first: they determine the number of rows of mark labels.
        const COLUMN_GAP: f64 = 40.0;
        let is_stacked = page::is_narrow();
        let content_width = page::width() - 2.0 * MARGIN;
        let panel_width =
            if is_stacked { content_width } else { 0.5 * (content_width - COLUMN_GAP) };
        let panels = [&self.by_direction, &self.by_wave_number];
        let mut frames = [0, 1].map(|side| {
            let column = if is_stacked { 0.0 } else { side as f64 };
            let left = MARGIN + column * (panel_width + COLUMN_GAP);
            let y_ticks = scales[side].y_ticks(600.0);
            let axis = page::left_axis_width(&y_ticks);
            Rectangle { left: left + axis, top: 0.0, right: left + panel_width - 16.0, bottom: 0.0 }
        });
        let marks = [0, 1].map(|side| place_marks(panels[side], &scales[side], frames[side]));
        let rows = |marks: &[PlacedMark]| marks.iter().map(|mark| mark.row + 1).max().unwrap_or(0);
        // Heights above the frames: of panels beside each other the larger one, in the order of stacked panels each.
        let mut above = [0, 1].map(|side| rows(&marks[side]) as f64 * MARK_ROW_HEIGHT + 14.0);
        let mut between = 0.0;
        if is_stacked {
            between = page::BOTTOM_AXIS_HEIGHT + above[1];
        } else {
            above = [above[0].max(above[1]); 2];
        }
        let top = heading + above[0];
        let min_height = page::scale_height(if is_stacked { 1000.0 } else { 480.0 });
        let height = page::height().max(top + min_height + between + below).ceil();
        let bottom = height - below;
        let ends = match is_stacked {
            true => {
                let frame_height = 0.5 * (bottom - top - between);
                [[top, top + frame_height], [bottom - frame_height, bottom]]
            }
            false => [[top, bottom]; 2],
        };

        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        for side in [0, 1] {
            [frames[side].top, frames[side].bottom] = ends[side];
            self.draw_panel(&mut picture, panels[side], &scales[side], frames[side], &marks[side]);
        }
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS_HEIGHT + 22.0);
        picture
    }

    /// Returns the labels of all lines that are drawn, in the order of their first occurrence.
    fn distinct_labels(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = Vec::new();
        let curves = self.by_direction.curves.iter().chain(&self.by_wave_number.curves);
        for line in curves.filter(|curve| curve.is_drawn()) {
            if !labels.contains(&line.label.as_str()) {
                labels.push(&line.label);
            }
        }
        labels
    }

    fn legend_entries(&self, scales: &[GrowthScales; 2]) -> Vec<LegendEntry> {
        let panels = [&self.by_direction, &self.by_wave_number];
        let labels = self.distinct_labels();
        let lines = build_line_entries(&labels).into_iter().enumerate();
        let mut entries: Vec<LegendEntry> = lines
            .map(|(index, (label, line))| {
                let is_measured = panels.iter().any(|panel| {
                    panel.is_measured && panel.curves.iter().any(|curve| curve.label == label)
                });
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    line(picture, area);
                    if is_measured {
                        let place =
                            [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
                        draw_measured_point(picture, place, LineStyle::from_index(index).colour);
                    }
                };
                (label, Box::new(swatch) as Swatch)
            })
            .collect();
        let guides =
            self.by_direction.reference_lines.iter().chain(&self.by_wave_number.reference_lines);
        if let Some(guide) = guides.into_iter().next() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let middle = 0.5 * (area.top + area.bottom);
                picture.draw_line(
                    [[area.left, middle], [area.right, middle]],
                    REFERENCE_LINE_WIDTH,
                    REFERENCE_LINE_COLOUR,
                );
            };
            entries.push((guide.label.clone(), Box::new(swatch)));
        }
        let swatch = |picture: &mut Picture, area: Rectangle| {
            picture.fill_rectangle(area, LINEAR_RANGE_COLOUR);
            picture.draw_frame(area, 1.5, PALE_INK);
        };
        if scales.iter().any(|scales| !scales.is_y_log) {
            entries.push(("linear scale about 0".to_owned(), Box::new(swatch)));
        }
        entries
    }

    fn draw_panel(
        &self,
        picture: &mut Picture,
        panel: &GrowthPanel,
        scales: &GrowthScales,
        frame: Rectangle,
        marks: &[PlacedMark],
    ) {
        let x_ticks =
            page::choose_ticks(frame.width(), false, |max_count| scales.x_ticks(panel, max_count));
        let placed_x: Vec<Tick> =
            x_ticks.into_iter().map(|(x, label)| (scales.x_position(x, frame), label)).collect();
        let placed_y: Vec<Tick> = scales
            .y_ticks(frame.height())
            .into_iter()
            .map(|(y, label)| (scales.y_position(y, frame), label))
            .collect();
        if !scales.is_y_log {
            let [bottom, top] = [-1.0_f64, 1.0]
                .map(|place| scales.y_position(place.clamp(scales.y_low, scales.y_high), frame));
            picture.fill_rectangle(Rectangle { top, bottom, ..frame }, LINEAR_RANGE_COLOUR);
        }
        for (x, _) in placed_x.iter().filter(|(_, label)| !label.is_empty()) {
            picture.draw_line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID_COLOUR);
        }
        for (y, _) in placed_y.iter().filter(|(_, label)| !label.is_empty()) {
            picture.draw_line([[frame.left, *y], [frame.right, *y]], 1.2, GRID_COLOUR);
        }
        if !scales.is_y_log {
            let y = scales.y_position(0.0, frame);
            picture.draw_line([[frame.left, y], [frame.right, y]], 3.4, RGBColor(110, 110, 110));
        }

        draw_marks(picture, frame, marks);

        // Infinite values are drawn just inside the frame, which would cover them.
        let inset = 0.012 * (scales.y_high - scales.y_low);
        let (lowest, highest) = (scales.y_low + inset, scales.y_high - inset);
        let places = |line: &LabelledCurve, lowest: f64, highest: f64| -> Vec<Point> {
            let places = line.points.iter().map(|&[x, y]| {
                let place = scales.y_scale.to_position(y).clamp(lowest, highest);
                let x = if panel.is_x_log { x.log10() } else { x };
                [scales.x_position(x, frame), scales.y_position(place, frame)]
            });
            places.collect()
        };
        for guide in &panel.reference_lines {
            let mut points = places(guide, f64::MIN, f64::MAX);
            for (point, [_, y]) in points.iter_mut().zip(&guide.points) {
                if scales.y_scale.to_position(*y).abs() < 1.0 {
                    *point = [f64::NAN; 2];
                }
            }
            for part in clip_polyline(&points, frame) {
                picture.draw_line(part, REFERENCE_LINE_WIDTH, REFERENCE_LINE_COLOUR);
            }
        }
        let labels = self.distinct_labels();
        let style = |line: &LabelledCurve| {
            let index = labels.iter().position(|label| *label == line.label).unwrap_or(0);
            LineStyle::from_index(index)
        };
        for line in &panel.curves {
            let points = places(line, lowest, highest);
            for part in clip_polyline(&points, frame) {
                style(line).draw(picture, &part);
            }
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        for line in panel.curves.iter().filter(|_| panel.is_measured) {
            let colour = style(line).colour;
            let inside = |at: &&Point| !clip_polyline(&[**at, **at], frame).is_empty();
            for place in places(line, lowest, highest).iter().filter(inside) {
                draw_measured_point(picture, *place, colour);
            }
        }
        page::draw_bottom_axis(picture, frame, &placed_x, &panel.x_label);
        page::draw_left_axis(picture, frame, &placed_y, &panel.y_label);
    }
}

/// Draws the disc of a measured point, with a white rim.
fn draw_measured_point(picture: &mut Picture, place: Point, colour: Colour) {
    picture.mark_point(place, MEASURED_POINT_RADIUS);
    picture.fill_disc(place, MEASURED_POINT_RADIUS + 1.5, WHITE);
    picture.fill_disc(place, MEASURED_POINT_RADIUS, colour);
}

/// Draws the lines and labels of marks.
fn draw_marks(picture: &mut Picture, frame: Rectangle, marks: &[PlacedMark]) {
    let baseline =
        |row: usize| frame.top - 8.0 - row as f64 * MARK_ROW_HEIGHT - 0.24 * MARK_LABEL_SIZE;
    for PlacedMark { line_x: x, row, label, label_left: left } in marks {
        // The line of a mark extends to the full height of its label if it is beside the label.
        let beside = *x < *left || *x > left + text_width(label, MARK_LABEL_SIZE, false);
        let end = baseline(*row) + MARK_LABEL_SIZE * if beside { -0.76 } else { 0.3 };
        picture.draw_dashed_line(&[[*x, frame.bottom], [*x, end]], &[8.0, 5.0], 1.6, PALE_INK);
    }
    for PlacedMark { row, label, label_left: left, .. } in marks {
        let text = Text::new([*left, baseline(*row)], Anchor::Start, MARK_LABEL_SIZE, label);
        // If a line has to pass through a label, the label covers it.
        picture.fill_rectangle(text.bounds(), WHITE);
        picture.draw_text(Text { colour: PALE_INK, ..text });
    }
}

/// Builds the legend entries of lines with these labels.
pub(crate) fn build_line_entries(labels: &[&str]) -> Vec<LegendEntry> {
    let mut entries: Vec<LegendEntry> = Vec::new();
    for (index, label) in labels.iter().enumerate() {
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            LineStyle::from_index(index).draw_swatch(picture, area);
        };
        entries.push(((*label).to_owned(), Box::new(swatch)));
    }
    entries
}

/// Ranges of a panel: horizontally in the unit of the axis or its log₁₀, vertically in positions of the symmetric
/// logarithm.
struct GrowthScales {
    x_low: f64,
    x_high: f64,
    y_scale: SymmetricLog,
    /// Whether the vertical range is in the logarithmic part of the scale, on one side of zero.
    is_y_log: bool,
    y_low: f64,
    y_high: f64,
}

/// Number of decades of growth rates against the wave number: powers of the wave number span more decades.
const WAVE_NUMBER_DECADES: i32 = 24;

impl GrowthScales {
    fn from_panel(panel: &GrowthPanel) -> Self {
        let points = || panel.curves.iter().flat_map(|line| &line.points);
        let place = |x: f64| if panel.is_x_log { x.log10() } else { x };
        let marks = panel.marks.iter().map(|mark| mark.x);
        let (mut x_low, mut x_high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in points().map(|point| point[0]).chain(marks).map(place) {
            if x.abs() < FINITE_LIMIT {
                (x_low, x_high) = (x_low.min(x), x_high.max(x));
            }
        }
        if x_low > x_high {
            (x_low, x_high) = (0.0, 1.0);
        } else if x_high - x_low <= 1e-9 * x_high.abs().max(x_low.abs()) || x_low == x_high {
            let half = 0.5 * x_low.abs().max(1.0);
            (x_low, x_high) = (x_low - half, x_high + half);
        }

        if panel.is_x_log {
            // An end just short of a power of ten is extended to it, where there is a tick.
            let slack = 0.02 * (x_high - x_low);
            let extend =
                |end: f64, whole: f64| if (whole - end).abs() <= slack { whole } else { end };
            (x_low, x_high) = (extend(x_low, x_low.floor()), extend(x_high, x_high.ceil()));
        }

        let growth = || points().map(|point| point[1]).filter(|growth| growth.abs() < FINITE_LIMIT);
        let decades =
            if panel.is_x_log { WAVE_NUMBER_DECADES } else { SymmetricLog::DEFAULT_DECADES };
        let sizes = growth().map(f64::abs);
        let (least, greatest) =
            sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), size| (a.min(size), b.max(size)));
        let is_one_sign = growth().all(|own| own > 0.0) || growth().all(|own| own < 0.0);
        let is_y_log = is_one_sign && greatest >= 2.0 * least;
        let y_scale = match is_y_log {
            true => SymmetricLog { threshold_exponent: least.log10().floor() as i32 - 1 },
            false => SymmetricLog::from_values_with_decades(growth(), decades),
        };
        let (mut y_low, mut y_high) =
            if is_y_log { (f64::INFINITY, f64::NEG_INFINITY) } else { (0.0_f64, 0.0_f64) };
        for place in growth().map(|growth| y_scale.to_position(growth)) {
            (y_low, y_high) = (y_low.min(place), y_high.max(place));
        }
        if y_low == y_high {
            (y_low, y_high) = (-1.0, 1.0);
        }
        // Margins at both ends; infinite values are drawn in them.
        let margin = 0.05 * (y_high - y_low);
        Self { x_low, x_high, y_scale, is_y_log, y_low: y_low - margin, y_high: y_high + margin }
    }

    fn x_position(&self, x: f64, frame: Rectangle) -> f64 {
        frame.left + (x - self.x_low) / (self.x_high - self.x_low) * frame.width()
    }

    fn y_position(&self, scale_position: f64, frame: Rectangle) -> f64 {
        frame.bottom - (scale_position - self.y_low) / (self.y_high - self.y_low) * frame.height()
    }

    fn x_ticks(&self, panel: &GrowthPanel, max_count: usize) -> Vec<Tick> {
        if panel.is_x_log {
            scale::log_ticks(self.x_low, self.x_high, max_count)
        } else {
            scale::linear_ticks(self.x_low, self.x_high, max_count, panel.x_label.contains('°'))
        }
    }

    fn y_ticks(&self, length: f64) -> Vec<Tick> {
        if self.is_y_log {
            // Positions differ from logarithms by a constant.
            let offset = 1.0 - f64::from(self.y_scale.threshold_exponent);
            let is_negative = self.y_high < 0.0;
            let (low, high) =
                if is_negative { (-self.y_high, -self.y_low) } else { (self.y_low, self.y_high) };
            let ticks = scale::log_ticks(low - offset, high - offset, (length / 48.0) as usize);
            return ticks
                .into_iter()
                .map(|(log, label)| match is_negative {
                    true => (-(log + offset), format!("−{label}")),
                    false => (log + offset, label),
                })
                .collect();
        }
        let ticks = self.y_scale.ticks(self.y_low, self.y_high, (length / 48.0) as usize);
        ticks.into_iter().filter(|(place, _)| (self.y_low..=self.y_high).contains(place)).collect()
    }
}

/// A mark with the position of its label: row above the panel and left end.
struct PlacedMark {
    line_x: f64,
    row: usize,
    label: String,
    label_left: f64,
}

/// Places the labels of marks so that no label overlaps another label or the line of another mark.
fn place_marks(panel: &GrowthPanel, scales: &GrowthScales, frame: Rectangle) -> Vec<PlacedMark> {
    let mut marks: Vec<(f64, &str)> = panel
        .marks
        .iter()
        .map(|mark| (if panel.is_x_log { mark.x.log10() } else { mark.x }, mark.label.as_str()))
        .filter(|(x, _)| x.abs() < FINITE_LIMIT)
        .map(|(x, label)| (scales.x_position(x, frame), label))
        .collect();
    // From right to left: a label to the right of its line is then above the labels that it would otherwise cover, and
    // its line passes to the left of them.
    marks.sort_by(|a, b| b.0.total_cmp(&a.0));
    const LABEL_GAP: f64 = 7.0;
    let mut placed: Vec<(PlacedMark, f64)> = Vec::new();
    for (index, &(x, label)) in marks.iter().enumerate() {
        let following_marks = &marks[index + 1..];
        let label = page::wrap_text(label, MARK_LABEL_SIZE, false, 0.7 * frame.width(), 1);
        let label = label.into_iter().next().unwrap_or_default();
        let width = text_width(&label, MARK_LABEL_SIZE, false);
        let lefts = [x + LABEL_GAP, x - 0.5 * width, x - LABEL_GAP - width]
            .map(|left| left.clamp(frame.left, (frame.right - width).max(frame.left)));
        let crosses =
            |at: f64, from: f64, to: f64| at > from - 0.9 * LABEL_GAP && at < to + 0.9 * LABEL_GAP;
        let is_free = |row: usize, left: f64| {
            let right = left + width;
            placed.iter().all(|(other, other_right)| match row.cmp(&other.row) {
                std::cmp::Ordering::Equal => {
                    right + 2.0 * LABEL_GAP < other.label_left
                        || left > other_right + 2.0 * LABEL_GAP
                }
                // The line of the higher label passes beside the text of the lower label.
                std::cmp::Ordering::Less => !crosses(other.line_x, left, right),
                std::cmp::Ordering::Greater => !crosses(x, other.label_left, *other_right),
            })
        };
        // The heights of the following lines are not yet known. A label that would cover one of them is placed above
        // all of them, as is a label for which there is no lower position.
        let covers =
            |left: f64| following_marks.iter().any(|other| crosses(other.0, left, left + width));
        let count = marks.len();
        let rows = (0..count).chain((count..=2 * count).rev()).chain(2 * count + 1..=3 * count);
        let mut places = rows.flat_map(|row| lefts.map(|left| (row, left)));
        let (row, left) = places
            .find(|&(row, left)| is_free(row, left) && (row >= count || !covers(left)))
            .unwrap_or((3 * count + 1 + index, lefts[0]));
        placed.push((PlacedMark { line_x: x, row, label, label_left: left }, left + width));
    }
    let mut used: Vec<usize> = placed.iter().map(|(mark, _)| mark.row).collect();
    used.sort_unstable();
    used.dedup();
    for (mark, _) in &mut placed {
        mark.row = used.binary_search(&mark.row).unwrap_or(0);
    }
    placed.into_iter().map(|(mark, _)| mark).collect()
}

#[cfg(test)]
mod tests;
