//! Records against time, in panels one above the other.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::Format;
use crate::growth::{GRID, LINE_WIDTH, Look, draw_marker_of};
use crate::page::{self, Entry, Legend, MARGIN, RULE};
use crate::picture::{
    Anchor, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip, polyline_length,
    text_width,
};
use crate::scale::{self, Tick};
use crate::verdict_map::percent;

/// Values of a record at the times of a figure.
pub(crate) struct Series<'a> {
    /// Legend text; series with the same name share a style. A series without name is drawn plain and is named by the
    /// panel title.
    pub name: Option<&'a str>,
    pub values: &'a [f64],
}

/// A panel across the figure with its own vertical scale.
pub(crate) struct Strip<'a> {
    /// Name, symbol and unit of the values; the panel title.
    pub label: &'a str,
    pub series: Vec<Series<'a>>,
    /// Minimum height of the frame, pixels.
    pub least: f64,
    /// Weight with which the panel shares the remaining height.
    pub weight: f64,
}

/// Content of a figure of records.
pub(crate) struct Sheet<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub time_label: &'a str,
    pub times: &'a [f64],
    pub strips: Vec<Strip<'a>>,
}

/// Font size of panel titles, pixels.
const LABEL: f64 = 26.0;
/// Height of the row of a panel title, and gap between panels, pixels.
const LABEL_ROW: f64 = 1.4 * LABEL;
const BETWEEN: f64 = 12.0;
/// Ratio of line length to window width above which a line is drawn thin, width of the window and width of the thin
/// line; widths in pixels.
const DENSE: f64 = 4.0;
const WINDOW: f64 = 50.0;
const DENSE_WIDTH: f64 = 1.8;
/// Width, pixels, of the thin solid line drawn along a dashed line, so that no peak is lost in a gap.
const THREAD: f64 = 1.0;
/// Minimum vertical distance of labelled ticks, pixels.
const TICKS_APART: f64 = 1.15 * page::NUMBER;
const MARKER: f64 = 6.5;
/// Distance between the markers of one line, and between the markers of neighbouring lines, pixels.
const MARKERS_APART: f64 = 160.0;
const MARKERS_BESIDE: f64 = 56.0;
/// Magnitude above which numbers are treated as infinite, since differences would overflow.
const FINITE: f64 = 1e300;
/// Relative change below which values are regarded as constant up to round-off.
const ROUND_OFF: f64 = 1e-9;

const ZERO: RGBColor = RGBColor(110, 110, 110);

fn is_finite(value: f64) -> bool {
    value.abs() < FINITE
}

/// Vertical scale of a panel.
#[derive(Debug, Clone, PartialEq)]
struct Range {
    low: f64,
    high: f64,
    ticks: Vec<Tick>,
    /// Text shown in place of a scale, e.g. for missing values.
    words: Option<String>,
}

impl Range {
    fn of(strip: &Strip, height: f64) -> Self {
        let all = || strip.series.iter().flat_map(|series| series.values.iter().copied());
        let finite = || all().filter(|value| is_finite(*value));
        let (low, high) = finite()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let size = low.abs().max(high.abs());
        let said = |words: &str, ticks: Vec<Tick>| {
            let words = Some(words.to_owned());
            Self { low: -1.0, high: 1.0, ticks, words }
        };
        if low > high {
            let is_empty = all().next().is_none();
            return said(if is_empty { "no values" } else { "no finite values" }, Vec::new());
        }
        let is_partial = all().any(|value| !is_finite(value));
        if size == 0.0 {
            let words = if is_partial { "zero wherever it is finite" } else { "zero" };
            return said(words, vec![(0.0, "0".to_owned())]);
        }
        if high - low <= ROUND_OFF * size {
            let middle = 0.5 * (low + high);
            let ends = [middle - 0.5 * size, middle + 0.5 * size];
            let ticks = vec![(middle, scale::plain(middle))];
            return Self { low: ends[0], high: ends[1], ticks, words: None };
        }
        // Zero is included if it is near the range.
        let near = 0.5 * (high - low);
        let low = if low > 0.0 && low <= near { 0.0 } else { low };
        let high = if high < 0.0 && high >= -near { 0.0 } else { high };
        // Larger margins or one more tick may allow round numbers at both ends.
        let most = ((height / 46.0) as usize).clamp(3, 7);
        let tried = [0.06, 0.12, 0.2, 0.3].into_iter().flat_map(|room| {
            let room = room * (high - low);
            let (low, high) = (low - room, high + room);
            [most, most + 1].map(|most| {
                let ticks = scale::ticks(low, high, most, false);
                Self { low, high, ticks, words: None }
            })
        });
        let stand_apart = |range: &Self| {
            let places: Vec<f64> =
                range.ticks.iter().map(|(value, _)| range.share(*value) * height).collect();
            places.windows(2).all(|pair| pair[1] - pair[0] > TICKS_APART)
        };
        let tried: Vec<Self> = tried.filter(stand_apart).collect();
        let with = |least: usize| tried.iter().find(|range| range.ticks.len() >= least);
        let best = with(3).or_else(|| with(2)).or_else(|| with(0)).cloned();
        best.unwrap_or(Self { low, high, ticks: Vec::new(), words: None })
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn place(&self, value: f64, frame: Rectangle) -> f64 {
        frame.bottom - self.share(value) * frame.height()
    }
}

/// Reduces a line to at most four points per pixel column (first, lowest, highest, last), so that no peak is lost. The
/// line is split into parts where values are non-finite.
fn reduced(
    times: &[f64],
    values: &[f64],
    place: impl Fn(f64, f64) -> Point,
    is_same_column: impl Fn(Point, Point) -> bool,
) -> Vec<Vec<Point>> {
    /// First, lowest, highest and last point of a pixel column, each with its index.
    struct Column([(usize, Point); 4]);

    impl Column {
        fn finish(self, part: &mut Vec<Point>) {
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
    let mut column: Option<Column> = None;
    // Gaps within a pixel column are not visible: the line continues.
    let mut is_broken = false;
    for (index, (time, value)) in times.iter().zip(values).enumerate() {
        if !is_finite(*value) {
            is_broken = true;
            continue;
        }
        let point = place(*time, *value);
        match &mut column {
            Some(Column(kept)) if is_same_column(kept[0].1, point) => {
                is_broken = false;
                // The y coordinate of the picture increases downwards.
                if point[1] > kept[1].1[1] {
                    kept[1] = (index, point);
                }
                if point[1] < kept[2].1[1] {
                    kept[2] = (index, point);
                }
                kept[3] = (index, point);
            }
            _ => {
                if let Some(column) = column.take() {
                    column.finish(&mut part);
                }
                if is_broken && !part.is_empty() {
                    parts.push(std::mem::take(&mut part));
                }
                is_broken = false;
                column = Some(Column([(index, point); 4]));
            }
        }
    }
    if let Some(column) = column {
        column.finish(&mut part);
    }
    if !part.is_empty() {
        parts.push(part);
    }
    parts
}

impl Sheet<'_> {
    /// Renders the figure in a file format and returns the bytes of the file.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture()?.render(format)
    }

    fn check(&self) -> Result<(), FigureError> {
        let refuse =
            |problem| Err(FigureError::Axis { label: self.time_label.to_owned(), problem });
        if self.times.is_empty() {
            return refuse("has no values");
        }
        if !self.times.iter().all(|time| is_finite(*time)) {
            return refuse("has a value that is not a finite number");
        }
        if self.times.windows(2).any(|pair| pair[1] < pair[0]) {
            return refuse("has values that decrease");
        }
        let all = self.strips.iter().flat_map(|strip| {
            strip.series.iter().map(|series| (series.name.unwrap_or(strip.label), series.values))
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

    /// Returns the names of the legend, in the order of their first occurrence.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.strips.iter().flat_map(|strip| &strip.series).filter_map(|own| own.name) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    fn legend(&self, names: &[&str]) -> Legend {
        let mut entries: Vec<Entry> = Vec::new();
        for (index, name) in names.iter().enumerate() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let look = Look::of(index);
                let middle = 0.5 * (area.top + area.bottom);
                let ends = [[area.left, middle], [area.right, middle]];
                picture.dashed(&ends, look.dashes, LINE_WIDTH, look.colour);
                draw_marker_of(picture, [0.5 * (area.left + area.right), middle], &look, MARKER);
            };
            entries.push(((*name).to_owned(), Box::new(swatch)));
        }
        let values = || {
            let series = self.strips.iter().flat_map(|strip| &strip.series);
            series.flat_map(|series| series.values)
        };
        let unknown = values().filter(|value| !is_finite(**value)).count();
        if unknown > 0 {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                for [from, to] in [[0.0, 0.3], [0.7, 1.0]] {
                    let place = |share: f64| [area.left + share * area.width(), y];
                    picture.line([place(from), place(to)], LINE_WIDTH, PALE_INK);
                }
            };
            let share = percent(unknown, values().count());
            entries.push((format!("not a finite number ({share})"), Box::new(swatch)));
        }
        Legend::new(entries, page::WIDTH - 2.0 * MARGIN)
    }

    /// Returns the ends of the time axis.
    fn ends(&self) -> [f64; 2] {
        let [from, to] = [self.times[0], self.times[self.times.len() - 1]];
        if to - from > ROUND_OFF * from.abs().max(to.abs()) {
            [from, to]
        } else {
            let half = 0.5 * from.abs().max(1.0);
            [from - half, to + half]
        }
    }

    pub fn picture(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let names = self.names();
        let legend = self.legend(&names);
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, self.title, self.subtitle);
        let below = page::BOTTOM_AXIS + 22.0 + legend.height() + MARGIN - 12.0;
        let rows = LABEL_ROW * self.strips.len() as f64
            + BETWEEN * self.strips.len().saturating_sub(1) as f64;
        let least: f64 = self.strips.iter().map(|strip| strip.least).sum();
        let height = page::HEIGHT.max(top + rows + least + below).ceil();
        let spare = height - top - rows - least - below;
        let weights: f64 = self.strips.iter().map(|strip| strip.weight).sum();

        let mut y = top;
        let mut frames = Vec::new();
        for strip in &self.strips {
            let high = strip.least + spare * strip.weight / weights;
            let top = (y + LABEL_ROW).round();
            y += LABEL_ROW + high + BETWEEN;
            frames.push([top, (y - BETWEEN).round()]);
        }
        let ranges: Vec<Range> = self
            .strips
            .iter()
            .zip(&frames)
            .map(|(strip, [top, bottom])| Range::of(strip, bottom - top))
            .collect();
        let widest = ranges.iter().map(|range| page::widest(&range.ticks)).fold(0.0, f64::max);
        // The rightmost tick label of the time axis extends beyond the frame.
        let left = (MARGIN + widest + 24.0).round();
        let right = page::WIDTH - MARGIN - 36.0;

        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, self.title, self.subtitle);
        let [from, to] = self.ends();
        let x_ticks: Vec<Tick> =
            page::spaced(right - left, false, |most| scale::ticks(from, to, most.min(10), false))
                .into_iter()
                .map(|(time, label)| (left + (time - from) / (to - from) * (right - left), label))
                .collect();
        let count = self.strips.len();
        for (index, (strip, range)) in self.strips.iter().zip(&ranges).enumerate() {
            let [top, bottom] = frames[index];
            let frame = Rectangle { left, top, right, bottom };
            self.draw_strip(&mut picture, strip, range, frame, (&x_ticks, &names));
            if index + 1 == count {
                page::bottom_axis(&mut picture, frame, &x_ticks, self.time_label);
            } else {
                let bare: Vec<Tick> = x_ticks.iter().map(|(x, _)| (*x, String::new())).collect();
                page::bottom_axis(&mut picture, frame, &bare, "");
            }
        }
        if count == 0 {
            let at = [MARGIN, top + LABEL_ROW];
            picture.text(Text::new(at, Anchor::Start, LABEL, "nothing recorded"));
        }
        legend.draw(&mut picture, MARGIN, height - below + page::BOTTOM_AXIS + 22.0);
        Ok(picture)
    }

    fn draw_strip(
        &self,
        picture: &mut Picture,
        strip: &Strip,
        range: &Range,
        frame: Rectangle,
        (x_ticks, names): (&[Tick], &[&str]),
    ) {
        let (label, size) = page::fit(strip.label, LABEL, frame.width());
        if !label.is_empty() {
            let at = [frame.left, frame.top - 0.36 * LABEL];
            picture.text(Text::new(at, Anchor::Start, size, label));
        }
        for (x, _) in x_ticks {
            picture.line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID);
        }
        let y_ticks: Vec<Tick> = range
            .ticks
            .iter()
            .map(|(value, label)| (range.place(*value, frame), label.clone()))
            .collect();
        for (y, _) in &y_ticks {
            picture.line([[frame.left, *y], [frame.right, *y]], 1.2, GRID);
        }
        if range.low < 0.0 && range.high > 0.0 && !range.ticks.is_empty() {
            let zero = range.place(0.0, frame);
            picture.line([[frame.left, zero], [frame.right, zero]], 2.0, ZERO);
        }
        let [from, to] = self.ends();
        let place = |time: f64, value: f64| {
            let x = frame.left + (time - from) / (to - from) * frame.width();
            [x, range.place(value, frame)]
        };
        let is_same_column = |a: Point, b: Point| a[0].floor() == b[0].floor();
        let lines: Vec<(Option<usize>, Vec<Vec<Point>>)> = strip
            .series
            .iter()
            .map(|series| {
                let own = series.name.and_then(|name| names.iter().position(|own| *own == name));
                (own, reduced(self.times, series.values, place, is_same_column))
            })
            .collect();
        if range.words.is_none() {
            for (own, parts) in &lines {
                draw_line(picture, own.map(Look::of), parts, frame);
            }
            // The first marker of each line is shifted, so that markers of coincident lines are all visible.
            let apart = MARKERS_APART.max(MARKERS_BESIDE * lines.len() as f64);
            for (index, (own, parts)) in lines.iter().enumerate() {
                let Some(look) = own.map(Look::of) else { continue };
                let mut next = frame.left + apart * (index as f64 + 0.5) / lines.len() as f64;
                for &point in parts.iter().flatten() {
                    if point[0] >= next {
                        draw_marker_of(picture, point, &look, MARKER);
                        next += apart * ((point[0] - next) / apart + 1.0).floor();
                    }
                }
            }
        }
        picture.frame(frame, RULE, INK);
        if let Some(words) = &range.words {
            let middle = [0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom)];
            let at = [middle[0], middle[1] + 0.26 * LABEL];
            let text = Text::new(at, Anchor::Middle, LABEL, words);
            let half = 0.5 * text_width(words, LABEL, false) + 14.0;
            let ground =
                Rectangle { left: middle[0] - half, right: middle[0] + half, ..text.bounds() };
            picture.fill(ground, WHITE);
            picture.text(Text { colour: PALE_INK, ..text });
        }
        page::left_axis(picture, frame, &y_ticks, "");
    }
}

/// Splits a line into pieces of low and high density, each with whether it is dense, i.e. oscillates so fast that its
/// strokes would merge.
fn by_density(part: Vec<Point>) -> Vec<(bool, Vec<Point>)> {
    let mut pieces: Vec<(bool, Vec<Point>)> = Vec::new();
    let mut start = 0;
    for end in 1..part.len() {
        let is_last = end + 1 == part.len();
        if part[end][0] - part[start][0] < WINDOW && !is_last {
            continue;
        }
        let piece = &part[start..=end];
        let is_dense = polyline_length(piece) > DENSE * WINDOW.max(part[end][0] - part[start][0]);
        match pieces.last_mut() {
            Some((kind, line)) if *kind == is_dense => line.extend(&piece[1..]),
            _ => pieces.push((is_dense, piece.to_vec())),
        }
        start = end;
    }
    pieces
}

fn draw_line(picture: &mut Picture, look: Option<Look>, parts: &[Vec<Point>], frame: Rectangle) {
    let (colour, dashes) = look.map_or((INK, &[][..]), |look| (look.colour, look.dashes));
    for part in parts {
        if let [point] = part[..] {
            picture.disc(point, 0.7 * LINE_WIDTH, colour);
        }
        // Rounding may place points slightly outside the frame.
        for (is_dense, piece) in clip(part, frame).into_iter().flat_map(by_density) {
            if is_dense {
                picture.line(piece, DENSE_WIDTH, colour);
            } else {
                picture.dashed(&piece, dashes, LINE_WIDTH, colour);
                if !dashes.is_empty() {
                    picture.line(piece, THREAD, colour);
                }
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::tests::check_drawing;

    /// Checks a figure of records as [`check_drawing`] does.
    pub(crate) fn check(sheet: &Sheet) {
        check_drawing(&sheet.picture().unwrap(), |format| sheet.draw(format));
    }

    pub(crate) fn texts(sheet: &Sheet) -> Vec<String> {
        sheet.picture().unwrap().texts().map(|text| text.content.clone()).collect()
    }

    fn parts(times: &[f64], values: &[f64]) -> Vec<Vec<Point>> {
        reduced(times, values, |t, v| [t, -v], |a, b| a[0].floor() == b[0].floor())
    }

    #[test]
    fn columns_keep_their_ends_and_extremes() {
        let times: Vec<f64> = (0..100_000).map(|index| 1e-3 * f64::from(index)).collect();
        let mut values: Vec<f64> = times.iter().map(|time| (900.0 * time).sin()).collect();
        values[54_321] = 40.0;
        values[54_329] = -30.0;
        let parts = parts(&times, &values);
        assert_eq!(parts.len(), 1);
        assert!(parts[0].len() <= 400 && parts[0].len() > 300, "{}", parts[0].len());
        for index in [54_321, 54_329, 0, 99_999] {
            assert!(parts[0].contains(&[times[index], -values[index]]));
        }
        assert!(parts[0].windows(2).all(|pair| pair[0][0] < pair[1][0]));
        // A line with few points is unchanged.
        let times = [0.0, 0.4, 0.9, 1.1, 2.7];
        let values = [1.0, 3.0, 2.0, 2.0, 5.0];
        assert_eq!(super::tests::parts(&times, &values)[0].len(), 5);
    }

    #[test]
    fn lines_break_where_values_are_not_finite() {
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let times: Vec<f64> = (0..8).map(f64::from).collect();
        let lengths = |values: [f64; 8]| -> Vec<usize> {
            parts(&times, &values).iter().map(Vec::len).collect()
        };
        assert_eq!(lengths([1.0, 2.0, nan, 3.0, 3.0, infinite, 1.0, nan]), [2, 2, 1]);
        assert_eq!(lengths([nan; 8]), []);
        assert_eq!(lengths([nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -infinite]), [6]);
    }

    #[test]
    fn only_where_a_line_swings_often_it_is_dense() {
        let place = |index: u32| {
            let x = f64::from(index);
            [x, if (300..600).contains(&index) { 60.0 * x.powi(2).sin() } else { 0.05 * x }]
        };
        let line: Vec<Point> = (0..1000).map(place).collect();
        let pieces = by_density(line.clone());
        let kinds: Vec<bool> = pieces.iter().map(|(is_dense, _)| *is_dense).collect();
        assert_eq!(kinds, [false, true, false]);
        assert!((250.0..=301.0).contains(&pieces[1].1[0][0]));
        // Neighbouring pieces share a point, and no point is lost.
        let joined = pieces.iter().flat_map(|(_, piece)| &piece[1..]);
        assert!(line[1..].iter().eq(joined));
        assert!(pieces.windows(2).all(|pair| pair[0].1.last() == pair[1].1.first()));
        assert!(by_density(Vec::new()).is_empty());
    }

    #[test]
    fn every_range_has_ticks() {
        for exponent in [-300, -12, -3, 0, 5, 200] {
            for step in 0..60 {
                let size = (1.0 + 0.15 * f64::from(step)) * 10_f64.powi(exponent);
                for [low, high] in [[-1.0, 1.0], [0.0, 1.0], [-0.3, 1.0], [5.0, 6.0], [-9.0, -8.7]]
                {
                    let values = [low * size, high * size];
                    let series = vec![Series { name: None, values: &values }];
                    let strip = Strip { label: "", series, least: 0.0, weight: 1.0 };
                    let range = Range::of(&strip, 110.0);
                    assert!((2..=5).contains(&range.ticks.len()), "{range:?}");
                    assert!(range.low <= values[0] && range.high >= values[1]);
                }
            }
        }
    }

    #[test]
    fn wrong_input_is_refused() {
        let refused = |times: &[f64], values: &[f64]| {
            let strip = Strip {
                label: "velocity",
                series: vec![Series { name: Some("R1"), values }],
                least: 100.0,
                weight: 1.0,
            };
            let strips = vec![strip];
            let sheet = Sheet { title: "", subtitle: "", time_label: "time", times, strips };
            sheet.draw(Format::Svg).unwrap_err().to_string()
        };
        assert_eq!(refused(&[0.0, 1.0], &[1.0]), "the record \"R1\" has 1 values for 2 times");
        assert!(refused(&[], &[]).contains("\"time\" has no values"));
        assert!(refused(&[1.0, 0.0], &[0.0, 0.0]).contains("decrease"));
        assert!(refused(&[0.0, f64::NAN], &[0.0, 0.0]).contains("not a finite number"));
    }
}
