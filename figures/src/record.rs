//! Records against time, in panels one above the other.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::{GRID_COLOUR, LINE_WIDTH, LineStyle};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN};
use crate::picture::{
    Anchor, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip_polyline, text_width,
};
use crate::scale::{self, FINITE_LIMIT, Tick};
use crate::verdict_map::format_percent;

/// Values of a record at the times of a figure.
#[derive(Clone, Copy)]
pub(crate) struct RecordSeries<'a> {
    /// Legend text; series with the same name share a style. Without name the series is drawn in a plain style.
    pub name: Option<&'a str>,
    pub values: &'a [f64],
}

/// A panel across the figure with its own vertical scale.
#[derive(Clone)]
pub(crate) struct RecordPanel<'a> {
    /// Name, symbol and unit of the values; the panel title.
    pub label: &'a str,
    /// Name of the only series, at the right end above the frame; empty for none.
    pub series_label: &'a str,
    /// Values that the scale includes beside those of the series.
    pub included_values: Vec<f64>,
    pub series: Vec<RecordSeries<'a>>,
    /// Minimum height of the frame, pixels.
    pub min_height: f64,
    /// Weight with which the panel shares the remaining height.
    pub height_weight: f64,
}

impl<'a> RecordPanel<'a> {
    /// Returns whether lines are drawn; a text stands for values that are all zero or not finite.
    fn has_lines(&self) -> bool {
        let mut all = self.series.iter().flat_map(|series| series.values);
        all.any(|value| is_plottable(*value) && *value != 0.0)
    }

    /// Returns the least and the largest value of all series, see [`value_range`].
    fn value_range(&self) -> Option<[f64; 2]> {
        value_range(self.series.iter().flat_map(|series| series.values))
    }

    /// Gives each very densely oscillating series a panel of its own, below the panel of the others and with the same
    /// scale, if there are several: drawn in one panel, the last would cover the others.
    fn separate_dense_series(self, times: &[f64]) -> Vec<Self> {
        let Some([low, high]) = self.value_range() else { return vec![self] };
        let is_dense = |series: &RecordSeries| {
            // Ripples of a curve cover nothing, whatever their own range is.
            let range = value_range(series.values).map_or(0.0, |[low, high]| high - low);
            let range = range.max(SMALLEST_SHARE * (high - low));
            is_dense(times, series.values, SEPARATING_VARIATION * range)
        };
        let (dense, others): (Vec<_>, Vec<_>) = self.series.iter().copied().partition(is_dense);
        if dense.len() < 2 {
            return vec![self];
        }
        let mut panels = Vec::new();
        match others[..] {
            [] => {}
            [only] => panels.push(self.with_series(only, [low, high])),
            _ => panels.push(Self { series: others, ..self.clone() }),
        }
        panels.extend(dense.into_iter().map(|series| Self {
            min_height: self.min_height.min(LOWEST_FRAME),
            height_weight: self.height_weight.min(1.0),
            ..self.with_series(series, [low, high])
        }));
        panels
    }

    /// Returns the panel with a single series, whose name is beside the title, and a scale that includes `range`.
    fn with_series(&self, series: RecordSeries<'a>, range: [f64; 2]) -> Self {
        Self {
            series_label: series.name.unwrap_or_default(),
            included_values: range.to_vec(),
            series: vec![RecordSeries { name: None, ..series }],
            ..self.clone()
        }
    }

    /// Returns the minimum height of the frame on the page, pixels; on a low page, texts need as much as on a high one.
    fn scaled_min_height(&self) -> f64 {
        page::scale_height(self.min_height).max(self.min_height.min(LOWEST_FRAME))
    }
}

/// Content of a figure of records.
pub(crate) struct RecordFigure<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub time_label: &'a str,
    pub times: &'a [f64],
    pub panels: Vec<RecordPanel<'a>>,
}

/// Font size of panel titles, pixels.
const PANEL_TITLE_SIZE: f64 = 26.0;
/// Height of the row of a panel title, pixels.
const PANEL_TITLE_HEIGHT: f64 = 1.4 * PANEL_TITLE_SIZE;
/// Height of a frame with three or four tick labels above each other, pixels.
const LOWEST_FRAME: f64 = 110.0;
/// Gap between panels, pixels.
const PANEL_GAP: f64 = 12.0;
/// Fraction of the time axis over which the variation of a line is measured.
const DENSITY_WINDOW: f64 = 0.04;
/// Variation within the window, in ranges of the panel, above which a line is drawn thin and solid, since its dashes would
/// be lost: more than one full oscillation in the window.
const DENSE_VARIATION: f64 = 2.0;
/// Variation within the window, in ranges of a line, above which it fills the panel and covers others: more than two full
/// oscillations in the window.
const SEPARATING_VARIATION: f64 = 4.0;
/// Smallest range of a line that covers others, as a share of the range of the panel.
const SMALLEST_SHARE: f64 = 0.05;
/// Width of a densely oscillating line, pixels.
const DENSE_LINE_WIDTH: f64 = 1.8;
/// Minimum vertical distance of labelled ticks, pixels.
const MIN_TICK_DISTANCE: f64 = 1.15 * page::TICK_LABEL_SIZE;
/// Relative change below which values are regarded as constant up to round-off.
const ROUND_OFF_TOLERANCE: f64 = 1e-9;
const ZERO_LINE_COLOUR: RGBColor = RGBColor(110, 110, 110);

/// Returns whether a value is finite and small enough to be drawn on a scale.
fn is_plottable(value: f64) -> bool {
    value.abs() < FINITE_LIMIT
}

/// Returns the least and the largest value that can be drawn; `None` if there is none.
fn value_range<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<[f64; 2]> {
    let values = values.into_iter().filter(|value| is_plottable(**value));
    values
        .map(|value| [*value, *value])
        .reduce(|[low, high], [other, _]| [low.min(other), high.max(other)])
}

/// Vertical scale of a panel.
#[derive(Debug, Clone, PartialEq)]
struct RecordScale {
    low: f64,
    high: f64,
    ticks: Vec<Tick>,
    /// Factor and offset of the numbers at the ticks, appended to the panel title: ` (×10⁻⁶)`.
    multiplier: String,
    /// Text shown in place of a scale, e.g. for missing values.
    message: Option<String>,
}

impl RecordScale {
    fn from_panel(panel: &RecordPanel, height: f64) -> Self {
        let all = || panel.series.iter().flat_map(|series| series.values.iter().copied());
        let range = panel.value_range();
        let with_message = |message: &str, ticks: Vec<Tick>| {
            let message = Some(message.to_owned());
            Self { low: -1.0, high: 1.0, ticks, multiplier: String::new(), message }
        };
        let Some([low, high]) = range else {
            let is_empty = all().next().is_none();
            return with_message(
                if is_empty { "no values" } else { "no finite values" },
                Vec::new(),
            );
        };
        let is_partial = all().any(|value| !is_plottable(value));
        if [low, high] == [0.0; 2] {
            let message = if is_partial { "zero wherever it is finite" } else { "zero" };
            return with_message(message, vec![(0.0, "0".to_owned())]);
        }
        let included = panel.included_values.iter();
        let [low, high] =
            included.fold([low, high], |[low, high], value| [low.min(*value), high.max(*value)]);
        let size = low.abs().max(high.abs());
        if high - low <= ROUND_OFF_TOLERANCE * size {
            let middle = 0.5 * (low + high);
            let ends = [middle - 0.5 * size, middle + 0.5 * size];
            let ticks = vec![(middle, scale::format_number(middle))];
            let multiplier = String::new();
            return Self { low: ends[0], high: ends[1], ticks, multiplier, message: None };
        }
        // Zero is included if it is near the range.
        let near = 0.5 * (high - low);
        let low = if low > 0.0 && low <= near { 0.0 } else { low };
        let high = if high < 0.0 && high >= -near { 0.0 } else { high };
        // Larger margins or one more tick may allow round numbers at both ends.
        let max_ticks = ((height / 46.0) as usize).clamp(3, 7);
        let candidates = [0.06, 0.12, 0.2, 0.3].into_iter().flat_map(|margin| {
            let margin = margin * (high - low);
            let (low, high) = (low - margin, high + margin);
            [max_ticks, max_ticks + 1].map(|max_count| {
                let (ticks, multiplier) = scale::linear_ticks_with_multiplier(low, high, max_count);
                Self { low, high, ticks, multiplier, message: None }
            })
        });
        let has_separate_ticks = |range: &Self| {
            let places: Vec<f64> =
                range.ticks.iter().map(|(value, _)| range.fraction(*value) * height).collect();
            places.windows(2).all(|pair| pair[1] - pair[0] > MIN_TICK_DISTANCE)
        };
        let candidates: Vec<Self> = candidates.filter(has_separate_ticks).collect();
        let with =
            |min_ticks: usize| candidates.iter().find(|range| range.ticks.len() >= min_ticks);
        let best = with(3).or_else(|| with(2)).or_else(|| with(0)).cloned();
        let multiplier = String::new();
        best.unwrap_or(Self { low, high, ticks: Vec::new(), multiplier, message: None })
    }

    fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn y_position(&self, value: f64, frame: Rectangle) -> f64 {
        frame.bottom - self.fraction(value) * frame.height()
    }
}

/// Reduces a line to at most four points per pixel column (first, lowest, highest, last), so that no peak is lost. The
/// line is split into parts where values are non-finite.
fn decimate(
    times: &[f64],
    values: &[f64],
    to_point: impl Fn(f64, f64) -> Point,
    is_same_column: impl Fn(Point, Point) -> bool,
) -> Vec<Vec<Point>> {
    /// First, lowest, highest and last point of a pixel column, each with its index.
    struct PixelColumn([(usize, Point); 4]);

    impl PixelColumn {
        fn append_to(self, part: &mut Vec<Point>) {
            let Self(mut points) = self;
            points.sort_by_key(|(index, _)| *index);
            let mut last = None;
            for (index, point) in points {
                if last != Some(index) {
                    part.push(point);
                }
                last = Some(index);
            }
        }
    }

    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut part: Vec<Point> = Vec::new();
    let mut column: Option<PixelColumn> = None;
    // Gaps within a pixel column are not visible: the line continues.
    let mut is_broken = false;
    for (index, (time, value)) in times.iter().zip(values).enumerate() {
        if !is_plottable(*value) {
            is_broken = true;
            continue;
        }
        let point = to_point(*time, *value);
        match &mut column {
            Some(PixelColumn(points)) if is_same_column(points[0].1, point) => {
                is_broken = false;
                // The y coordinate of the picture increases downwards.
                if point[1] > points[1].1[1] {
                    points[1] = (index, point);
                }
                if point[1] < points[2].1[1] {
                    points[2] = (index, point);
                }
                points[3] = (index, point);
            }
            _ => {
                if let Some(column) = column.take() {
                    column.append_to(&mut part);
                }
                if is_broken && !part.is_empty() {
                    parts.push(std::mem::take(&mut part));
                }
                is_broken = false;
                column = Some(PixelColumn([(index, point); 4]));
            }
        }
    }
    if let Some(column) = column {
        column.append_to(&mut part);
    }
    if !part.is_empty() {
        parts.push(part);
    }
    parts
}

impl RecordFigure<'_> {
    /// Renders the figure and returns the bytes of the file.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture())?.render(output)
    }

    fn validate(&self) -> Result<(), FigureError> {
        let refuse =
            |problem| Err(FigureError::Axis { label: self.time_label.to_owned(), problem });
        if self.times.is_empty() {
            return refuse("has no values");
        }
        if !self.times.iter().all(|time| is_plottable(*time)) {
            return refuse("has a value that is not a finite number");
        }
        if self.times.windows(2).any(|pair| pair[1] < pair[0]) {
            return refuse("has values that decrease");
        }
        let all = self.panels.iter().flat_map(|panel| {
            panel.series.iter().map(|series| (series.name.unwrap_or(panel.label), series.values))
        });
        for (name, values) in all {
            if values.len() != self.times.len() {
                return Err(FigureError::RecordLength {
                    name: name.to_owned(),
                    found: values.len(),
                    times: self.times.len(),
                });
            }
        }
        Ok(())
    }

    /// Returns the style of a record by its name: the same in all panels and in the legend.
    fn line_style(&self, name: Option<&str>, names: &[&str]) -> LineStyle {
        let index = name.and_then(|name| names.iter().position(|other| *other == name));
        // A line without name is not in the legend and differs from all lines that are.
        let colour = if names.is_empty() { INK } else { PALE_INK };
        let plain = LineStyle { colour, dashes: &[], width: LINE_WIDTH };
        let style = index.map_or(plain, LineStyle::from_index);
        let is_dense_in = |panel: &RecordPanel| {
            let mut own = panel.series.iter().filter(|series| series.name == name);
            panel.value_range().is_some_and(|[low, high]| {
                high > low
                    && own.any(|series| {
                        is_dense(self.times, series.values, DENSE_VARIATION * (high - low))
                    })
            })
        };
        match self.panels.iter().any(is_dense_in) {
            true => LineStyle { dashes: &[], width: DENSE_LINE_WIDTH, ..style },
            false => style,
        }
    }

    /// Returns the names of the legend, in the order of their first occurrence: those of the drawn lines.
    fn series_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for panel in self.panels.iter().filter(|panel| panel.has_lines()) {
            for RecordSeries { name, values } in &panel.series {
                let Some(name) = name.filter(|name| !names.contains(name)) else { continue };
                if values.iter().any(|value| is_plottable(*value)) {
                    names.push(name);
                }
            }
        }
        names
    }

    fn build_legend(&self, names: &[&str]) -> Legend {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for name in names {
            let style = self.line_style(Some(name), names);
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                style.draw_swatch(picture, area);
            };
            entries.push(((*name).to_owned(), Box::new(swatch)));
        }
        let values = || {
            let series = self.panels.iter().flat_map(|panel| &panel.series);
            series.flat_map(|series| series.values)
        };
        let non_finite = values().filter(|value| !is_plottable(**value)).count();
        if non_finite > 0 {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                for [from, to] in [[0.0, 0.3], [0.7, 1.0]] {
                    let place = |share: f64| [area.left + share * area.width(), y];
                    picture.draw_line([place(from), place(to)], LINE_WIDTH, PALE_INK);
                }
            };
            let share = format_percent(non_finite, values().count());
            entries.push((format!("not a finite number ({share})"), Box::new(swatch)));
        }
        Legend::new(entries, page::width() - 2.0 * MARGIN)
    }

    /// Returns the ends of the time axis.
    fn time_range(&self) -> [f64; 2] {
        let [from, to] = [self.times[0], self.times[self.times.len() - 1]];
        if to - from > ROUND_OFF_TOLERANCE * from.abs().max(to.abs()) {
            [from, to]
        } else {
            let half = 0.5 * from.abs().max(1.0);
            [from - half, to + half]
        }
    }

    pub fn to_picture(&self) -> Result<Picture, FigureError> {
        self.validate()?;
        let panels = self.panels.iter().cloned();
        let panels = panels.flat_map(|panel| panel.separate_dense_series(self.times)).collect();
        Ok(RecordFigure { panels, ..*self }.to_picture_of_panels())
    }

    /// Draws the panels as they are.
    fn to_picture_of_panels(&self) -> Picture {
        let names = self.series_names();
        let legend = self.build_legend(&names);
        let top = page::heading_bottom(self.title, self.subtitle);
        let below = page::BOTTOM_AXIS_HEIGHT + 22.0 + legend.height() + MARGIN - 12.0;
        let rows = PANEL_TITLE_HEIGHT * self.panels.len() as f64
            + PANEL_GAP * self.panels.len().saturating_sub(1) as f64;
        let min_height: f64 = self.panels.iter().map(RecordPanel::scaled_min_height).sum();
        let height = page::height().max(top + rows + min_height + below).ceil();
        let spare = height - top - rows - min_height - below;
        let weights: f64 = self.panels.iter().map(|panel| panel.height_weight).sum();

        let mut y = top;
        let mut frames = Vec::new();
        for panel in &self.panels {
            let high = panel.scaled_min_height() + spare * panel.height_weight / weights;
            let top = (y + PANEL_TITLE_HEIGHT).round();
            y += PANEL_TITLE_HEIGHT + high + PANEL_GAP;
            frames.push([top, (y - PANEL_GAP).round()]);
        }
        let ranges: Vec<RecordScale> = self
            .panels
            .iter()
            .zip(&frames)
            .map(|(panel, [top, bottom])| RecordScale::from_panel(panel, bottom - top))
            .collect();
        let widest =
            ranges.iter().map(|range| page::max_label_width(&range.ticks)).fold(0.0, f64::max);
        // The rightmost tick label of the time axis extends beyond the frame.
        let left = (MARGIN + widest + 24.0).round();
        let right = page::width() - MARGIN - 36.0;

        let mut picture = page::create_page(height, self.title, self.subtitle);
        let [from, to] = self.time_range();
        let x_ticks: Vec<Tick> = page::choose_ticks(right - left, false, |max_count| {
            scale::linear_ticks(from, to, max_count.min(10), false)
        })
        .into_iter()
        .map(|(time, label)| (left + (time - from) / (to - from) * (right - left), label))
        .collect();
        let count = self.panels.len();
        for (index, (panel, range)) in self.panels.iter().zip(&ranges).enumerate() {
            let [top, bottom] = frames[index];
            let frame = Rectangle { left, top, right, bottom };
            self.draw_panel(&mut picture, panel, range, frame, (&x_ticks, &names));
            if index + 1 == count {
                page::draw_bottom_axis(&mut picture, frame, &x_ticks, self.time_label);
            } else {
                let bare: Vec<Tick> = x_ticks.iter().map(|(x, _)| (*x, String::new())).collect();
                page::draw_bottom_axis(&mut picture, frame, &bare, "");
            }
        }
        if count == 0 {
            let at = [MARGIN, top + PANEL_TITLE_HEIGHT];
            picture.draw_text(Text::new(at, Anchor::Start, PANEL_TITLE_SIZE, "nothing recorded"));
        }
        legend.draw(&mut picture, MARGIN, height - below + page::BOTTOM_AXIS_HEIGHT + 22.0);
        picture
    }

    fn draw_panel(
        &self,
        picture: &mut Picture,
        panel: &RecordPanel,
        scale: &RecordScale,
        frame: Rectangle,
        (x_ticks, names): (&[Tick], &[&str]),
    ) {
        let label = scale::label_with_multiplier(panel.label, &scale.multiplier);
        let baseline = frame.top - 0.36 * PANEL_TITLE_SIZE;
        let (name, size) =
            page::fit_text(panel.series_label, PANEL_TITLE_SIZE, 0.5 * frame.width());
        let mut free_width = frame.width();
        if !name.is_empty() {
            free_width -= text_width(&name, size, false) + PANEL_TITLE_SIZE;
            picture.draw_text(Text::new([frame.right, baseline], Anchor::End, size, name));
        }
        let (label, size) = page::fit_text(&label, PANEL_TITLE_SIZE, free_width);
        if !label.is_empty() {
            picture.draw_text(Text::new([frame.left, baseline], Anchor::Start, size, label));
        }
        for (x, _) in x_ticks {
            picture.draw_line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID_COLOUR);
        }
        let y_ticks: Vec<Tick> = scale
            .ticks
            .iter()
            .map(|(value, label)| (scale.y_position(*value, frame), label.clone()))
            .collect();
        for (y, _) in &y_ticks {
            picture.draw_line([[frame.left, *y], [frame.right, *y]], 1.2, GRID_COLOUR);
        }
        if scale.low < 0.0 && scale.high > 0.0 && !scale.ticks.is_empty() {
            let zero = scale.y_position(0.0, frame);
            picture.draw_line([[frame.left, zero], [frame.right, zero]], 2.0, ZERO_LINE_COLOUR);
        }
        let [from, to] = self.time_range();
        let place = |time: f64, value: f64| {
            let x = frame.left + (time - from) / (to - from) * frame.width();
            [x, scale.y_position(value, frame)]
        };
        let is_same_column = |a: Point, b: Point| a[0].floor() == b[0].floor();
        if scale.message.is_none() {
            for series in &panel.series {
                let parts = decimate(self.times, series.values, place, is_same_column);
                draw_line(picture, self.line_style(series.name, names), &parts, frame);
            }
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        if let Some(label_text) = &scale.message {
            let middle = [0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom)];
            let at = [middle[0], middle[1] + 0.26 * PANEL_TITLE_SIZE];
            let text = Text::new(at, Anchor::Middle, PANEL_TITLE_SIZE, label_text);
            let half = 0.5 * text_width(label_text, PANEL_TITLE_SIZE, false) + 14.0;
            let ground =
                Rectangle { left: middle[0] - half, right: middle[0] + half, ..text.bounds() };
            picture.fill_rectangle(ground, WHITE);
            picture.draw_text(Text { colour: PALE_INK, ..text });
        }
        page::draw_left_axis(picture, frame, &y_ticks, "");
    }
}

/// Returns whether the variation of values within some window of the time axis exceeds `limit`.
fn is_dense(times: &[f64], values: &[f64], limit: f64) -> bool {
    let duration = DENSITY_WINDOW * (times[times.len() - 1] - times[0]);
    let step = |index: usize| {
        let step = (values[index + 1] - values[index]).abs();
        if is_plottable(step) { step } else { 0.0 }
    };
    let (mut start, mut variation) = (0, 0.0);
    (0..values.len().saturating_sub(1)).any(|index| {
        variation += step(index);
        while times[index + 1] - times[start] > duration && start < index {
            variation -= step(start);
            start += 1;
        }
        index > start && variation > limit
    })
}

fn draw_line(picture: &mut Picture, style: LineStyle, parts: &[Vec<Point>], frame: Rectangle) {
    for part in parts {
        if let [point] = part[..] {
            picture.fill_disc(point, 0.7 * LINE_WIDTH, style.colour);
        }
        // Rounding may place points slightly outside the frame.
        for piece in clip_polyline(part, frame) {
            style.draw(picture, &piece);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
