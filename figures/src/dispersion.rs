//! Frequencies and speeds of the waves of a medium against the wave number.

use plotters::style::RGBColor;

use crate::growth::{GRID, LINE_WIDTH, LINEAR};
use crate::page::{self, Entry, Legend, MARGIN, RULE};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip, text_width,
};
use crate::scale::{self, SymmetricLog, Tick};
use crate::{FigureError, Format};

/// A branch of the dispersion relation. Points are in the units of the axes; not-a-number
/// interrupts a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The words of the legend. The branch is numbered there and on its lines.
    pub label: String,
    /// Wave number and angular frequency; the phase speed is drawn from the same points.
    pub frequency: Vec<[f64; 2]>,
    /// Wave number and group speed; may be empty.
    pub group_speed: Vec<[f64; 2]>,
    /// Wave numbers and angular frequencies that were measured, drawn as rings; may be empty. Phase speeds
    /// are drawn from the same points.
    pub measured: Vec<[f64; 2]>,
    /// Wave number and growth rate or attenuation; may be empty. The panel of growth is drawn
    /// where some branch has any.
    pub growth: Vec<[f64; 2]>,
}

/// Frequencies at which no wave of some kind propagates, drawn as a shaded band.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// The words of the legend, such as `forbidden band`. Bands of one label are listed once.
    pub label: String,
    /// Least frequency.
    pub from: f64,
    /// Largest frequency; may be infinite.
    pub to: f64,
}

/// A value of note on a vertical axis, drawn as a thin level line with its label beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// A few words or a symbol with its value.
    pub label: String,
    /// Where, in the unit of the axis. Levels that are not finite are left out.
    pub value: f64,
}

/// Frequencies against the wave number, beside phase and group speeds, and growth rates below
/// where there are some.
///
/// The speeds have a linear axis that covers the group speeds, the limits and the phase speeds of
/// the shortest waves: phase speeds are without bound near a cut-off. Growth rates have a linear
/// axis, over a logarithmic one of wave numbers a linear one about zero and logarithmic beyond.
#[derive(Debug, Clone, PartialEq)]
pub struct DispersionFigure {
    /// Headline.
    pub title: String,
    /// What is held fixed.
    pub subtitle: String,
    /// Name, symbol and unit of the wave number.
    pub k_label: String,
    /// Name, symbol and unit of the frequency.
    pub frequency_label: String,
    /// Name, symbol and unit of the speeds.
    pub speed_label: String,
    /// Name, symbol and unit of the growth rate; unused without growth rates.
    pub growth_label: String,
    /// Whether the axis of wave numbers is logarithmic; points that are not positive are left out
    /// then.
    pub k_log: bool,
    /// Whether the axis of frequencies is logarithmic.
    pub frequency_log: bool,
    /// The branches; six have colours of their own.
    pub branches: Vec<Branch>,
    /// Frequencies at which waves do not propagate.
    pub bands: Vec<Band>,
    /// Cut-off frequencies, dashed.
    pub cutoffs: Vec<Level>,
    /// Speeds of note such as short-wave limits, dotted.
    pub speed_limits: Vec<Level>,
}

/// Colours after Okabe and Ito (2008), dark enough for lines. The numbers on the lines tell the
/// branches apart in grey.
const COLOURS: [Colour; 6] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 138, 100),
    RGBColor(176, 80, 140),
    RGBColor(150, 110, 0),
];

const BAND: Colour = RGBColor(228, 224, 214);
const GROUP: &[f64] = &[13.0, 7.0];
const CUTOFF: &[f64] = &[9.0, 6.0];
const LIMIT: &[f64] = &[2.5, 5.0];
const LEVEL_WIDTH: f64 = 2.0;
/// Size of the words beside levels and in bands.
const LABEL: f64 = 22.0;
/// Numbers beyond are treated as infinite: differences of larger ones overflow.
const FINITE: f64 = 1e300;

/// Radius of the ring about a measured point.
const RING: f64 = 9.0;

/// Radius of the disc that carries a number.
pub(crate) const TAG: f64 = 15.0;

/// A number on a disc, for lines and points whose words stand in the legend.
pub(crate) fn draw_tag(picture: &mut Picture, [x, y]: Point, number: usize, colour: Colour) {
    picture.disc([x, y], TAG + 1.5, WHITE);
    picture.disc([x, y], TAG, colour);
    picture.disc([x, y], TAG - 2.5, WHITE);
    let words = number.to_string();
    let size = (20.0_f64).min(20.0 * 1.3 * TAG / text_width(&words, 20.0, true).max(1.0));
    let text = Text::new([x, y + 0.36 * size], Anchor::Middle, size, words);
    picture.text(Text { bold: true, ..text });
}

/// A point that was measured.
pub(crate) fn draw_ring(picture: &mut Picture, place: Point, colour: Colour) {
    picture.disc(place, RING + 1.5, WHITE);
    picture.disc(place, RING, colour);
    picture.disc(place, RING - 3.5, WHITE);
}

/// The room of a tag.
pub(crate) fn tag_area([x, y]: Point) -> Rectangle {
    let half = TAG + 2.0;
    Rectangle { left: x - half, top: y - half, right: x + half, bottom: y + half }
}

/// How values become places along an axis.
#[derive(Clone, Copy)]
enum Kind {
    Linear,
    Log,
    Symmetric(SymmetricLog),
}

/// An axis and its range, in places.
#[derive(Clone, Copy)]
struct Scale {
    kind: Kind,
    low: f64,
    high: f64,
}

impl Scale {
    fn forward(kind: Kind, value: f64) -> f64 {
        match kind {
            Kind::Linear => value,
            Kind::Log => value.log10(),
            Kind::Symmetric(scale) => scale.forward(value),
        }
    }

    /// The range of the values that can be shown, with a share of it left free at both ends.
    fn of(kind: Kind, values: impl Iterator<Item = f64>, room: [f64; 2]) -> Self {
        let places =
            values.map(|value| Self::forward(kind, value)).filter(|place| place.abs() < FINITE);
        let (mut low, mut high) = places
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
                (low.min(place), high.max(place))
            });
        if low > high {
            (low, high) = (0.0, 1.0);
        } else if high - low <= 1e-9 * low.abs().max(high.abs()) || low == high {
            let half = if matches!(kind, Kind::Log) { 0.5 } else { 0.5 * low.abs().max(1.0) };
            (low, high) = (low - half, high + half);
        }
        let extent = high - low;
        Self { kind, low: low - room[0] * extent, high: high + room[1] * extent }
    }

    fn share(&self, value: f64) -> f64 {
        (Self::forward(self.kind, value) - self.low) / (self.high - self.low)
    }

    /// Ticks by their share of the axis.
    fn ticks(&self, length: f64, upright: bool) -> Vec<Tick> {
        let (low, high) = (self.low, self.high);
        let mut ticks = match self.kind {
            Kind::Linear => {
                page::spaced(length, upright, |most| scale::ticks(low, high, most, false))
            }
            Kind::Log => page::spaced(length, upright, |most| scale::log_ticks(low, high, most)),
            Kind::Symmetric(scale) => scale.ticks(low, high, (length / 48.0) as usize),
        };
        ticks.retain(|(place, _)| (low - 1e-9..=high + 1e-9).contains(place));
        let share = |place: f64| (place - self.low) / (self.high - self.low);
        ticks.into_iter().map(|(place, label)| (share(place), label)).collect()
    }
}

/// What one panel shows.
struct Plot<'a> {
    frame: Rectangle,
    x: Scale,
    y: Scale,
    /// Points of the lines of each branch: solid ones, and dashed ones.
    solid: Vec<Vec<Point>>,
    dashed: Vec<Vec<Point>>,
    /// Points of each branch that stand alone.
    rings: Vec<Vec<Point>>,
    levels: &'a [Level],
    pattern: &'static [f64],
    bands: &'a [Band],
}

impl Plot<'_> {
    fn place(&self, [x, y]: Point) -> Point {
        let Rectangle { left, bottom, .. } = self.frame;
        let (x, y) = (self.x.share(x), self.y.share(y));
        [left + x * self.frame.width(), bottom - y * self.frame.height()]
    }

    fn height_of(&self, value: f64) -> f64 {
        self.frame.bottom - self.y.share(value) * self.frame.height()
    }

    fn inside(&self, lines: &[Vec<Point>]) -> Vec<Vec<Vec<Point>>> {
        let parts = |line: &Vec<Point>| {
            let points: Vec<Point> = line.iter().map(|&point| self.place(point)).collect();
            clip(&points, self.frame)
        };
        lines.iter().map(parts).collect()
    }

    /// The heights of a band inside the frame.
    fn band(&self, band: &Band) -> Option<Rectangle> {
        let frame = self.frame;
        let least = if matches!(self.y.kind, Kind::Log) { 0.0 } else { f64::NEG_INFINITY };
        let [bottom, top] = [band.from, band.to]
            .map(|value| self.height_of(value.max(least)).clamp(frame.top, frame.bottom));
        let known = !band.from.is_nan() && !band.to.is_nan() && top < bottom;
        known.then_some(Rectangle { top, bottom, ..frame })
    }

    fn draw(&self, picture: &mut Picture, x_label: Option<&str>, y_label: &str) {
        let frame = self.frame;
        let bands: Vec<(Rectangle, &Band)> =
            self.bands.iter().filter_map(|band| Some((self.band(band)?, band))).collect();
        if let Kind::Symmetric(_) = self.y.kind {
            let [bottom, top] = [-1.0, 1.0].map(|place: f64| {
                let share = (place - self.y.low) / (self.y.high - self.y.low);
                (frame.bottom - share * frame.height()).clamp(frame.top, frame.bottom)
            });
            picture.fill(Rectangle { top, bottom, ..frame }, LINEAR);
        }
        for (area, _) in &bands {
            picture.fill(*area, BAND);
        }
        let x_ticks: Vec<Tick> = self
            .x
            .ticks(frame.width(), false)
            .into_iter()
            .map(|(share, label)| (frame.left + share * frame.width(), label))
            .collect();
        let y_ticks: Vec<Tick> = self
            .y
            .ticks(frame.height(), true)
            .into_iter()
            .map(|(share, label)| (frame.bottom - share * frame.height(), label))
            .collect();
        for (x, _) in x_ticks.iter().filter(|(_, label)| !label.is_empty()) {
            picture.line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID);
        }
        for (y, _) in y_ticks.iter().filter(|(_, label)| !label.is_empty()) {
            picture.line([[frame.left, *y], [frame.right, *y]], 1.2, GRID);
        }
        let zero = self.height_of(0.0);
        if zero > frame.top + 1.0 && zero < frame.bottom - 1.0 {
            picture.line([[frame.left, zero], [frame.right, zero]], 2.0, RGBColor(110, 110, 110));
        }
        let levels: Vec<(f64, &str)> = self
            .levels
            .iter()
            .map(|level| (self.height_of(level.value), level.label.as_str()))
            .filter(|(y, _)| *y >= frame.top && *y <= frame.bottom)
            .collect();
        for (y, _) in &levels {
            let ends = [[frame.left, *y], [frame.right, *y]];
            picture.dashed(&ends, self.pattern, LEVEL_WIDTH, PALE_INK);
        }
        let (solid, dashed) = (self.inside(&self.solid), self.inside(&self.dashed));
        for (lines, pattern) in [(&dashed, GROUP), (&solid, &[])] {
            for (branch, parts) in lines.iter().enumerate() {
                for part in parts {
                    picture.dashed(part, pattern, LINE_WIDTH, COLOURS[branch % COLOURS.len()]);
                }
            }
        }
        for (branch, points) in self.rings.iter().enumerate() {
            for place in points.iter().map(|&point| self.place(point)) {
                let [x, y] = place;
                // One that the frame would cut is left out.
                if x > frame.left + RING
                    && x < frame.right - RING
                    && y > frame.top + RING
                    && y < frame.bottom - RING
                {
                    draw_ring(picture, place, COLOURS[branch % COLOURS.len()]);
                }
            }
        }
        picture.frame(frame, RULE, INK);

        // Words and numbers find their places one after the other, off all lines.
        let mut lines: Vec<Vec<Point>> =
            solid.iter().chain(&dashed).flatten().map(|part| densified(part)).collect();
        let places = self.rings.iter().flatten().map(|&point| self.place(point));
        let mut taken: Vec<Rectangle> = places.map(tag_area).collect();
        let level_lines =
            levels.iter().map(|(y, _)| vec![[frame.left, *y], [frame.right, *y]]).collect();
        lines.extend::<Vec<Vec<Point>>>(level_lines);
        for (y, label) in &levels {
            let baselines = [y - 0.24 * LABEL - 5.0, y + 0.76 * LABEL + 6.0];
            if let Some((hits, text)) = free_text(label, &baselines, frame, &lines, &taken) {
                if hits > 0.0 {
                    picture.fill(text.bounds(), WHITE);
                }
                taken.push(text.bounds());
                picture.text(Text { colour: PALE_INK, ..text });
            }
        }
        for (area, band) in &bands {
            let middle = 0.5 * (area.top + area.bottom) + 0.26 * LABEL;
            if area.height() < 1.2 * LABEL {
                continue;
            }
            // The legend has the words too.
            let text = free_text(&band.label, &[middle], frame, &lines, &taken);
            if let Some((_, text)) = text.filter(|(hits, _)| *hits == 0.0) {
                taken.push(text.bounds());
                picture.text(text);
            }
        }
        for (branch, parts) in solid.iter().enumerate() {
            // Dashed lines of the other branches are as near as solid ones.
            let others: Vec<Point> = [&solid, &dashed]
                .into_iter()
                .flat_map(|lines| lines.iter().enumerate())
                .filter(|(other, _)| *other != branch)
                .flat_map(|(_, parts)| parts.iter())
                .flat_map(|part| densified(part))
                .collect();
            if let Some(at) = tag_place(parts, &others, frame, &taken) {
                taken.push(tag_area(at));
                draw_tag(picture, at, branch + 1, COLOURS[branch % COLOURS.len()]);
            }
        }
        match x_label {
            Some(name) => page::bottom_axis(picture, frame, &x_ticks, name),
            None => {
                let bare: Vec<Tick> = x_ticks.iter().map(|(x, _)| (*x, String::new())).collect();
                page::bottom_axis(picture, frame, &bare, "");
            }
        }
        page::left_axis(picture, frame, &y_ticks, y_label);
    }
}

/// A line with points at most a few pixels apart.
fn densified(line: &[Point]) -> Vec<Point> {
    const STEP: f64 = 6.0;
    let mut dense: Vec<Point> = line.first().copied().into_iter().collect();
    for piece in line.windows(2) {
        let ([x0, y0], [x1, y1]) = (piece[0], piece[1]);
        let count = ((x1 - x0).hypot(y1 - y0) / STEP).ceil().max(1.0);
        let points = (1..=count as usize).map(|step| step as f64 / count);
        dense.extend(points.map(|share| [x0 + share * (x1 - x0), y0 + share * (y1 - y0)]));
    }
    dense
}

/// The length of a line.
pub(crate) fn length(line: &[Point]) -> f64 {
    line.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum()
}

/// Words at one of several heights in a frame, clear of other words and of lines as far as can
/// be, with the length of the lines behind them; none where other words leave no room.
fn free_text(
    words: &str,
    baselines: &[f64],
    frame: Rectangle,
    lines: &[Vec<Point>],
    taken: &[Rectangle],
) -> Option<(f64, Text)> {
    const STEPS: usize = 60;
    let (words, size) = page::fit(words, LABEL, frame.width() - 24.0);
    if words.is_empty() {
        return None;
    }
    let room = frame.width() - 24.0 - text_width(&words, size, false);
    let mut best: Option<(f64, Text)> = None;
    for step in (0..=STEPS).rev() {
        for baseline in baselines {
            let x = frame.left + 12.0 + room.max(0.0) * step as f64 / STEPS as f64;
            let text = Text::new([x, *baseline], Anchor::Start, size, words.clone());
            let bounds = text.bounds();
            let area = Rectangle {
                left: bounds.left - 6.0,
                top: bounds.top - 2.0,
                right: bounds.right + 6.0,
                bottom: bounds.bottom + 2.0,
            };
            let fits = bounds.top > frame.top + 2.0 && bounds.bottom < frame.bottom - 2.0;
            if !fits || taken.iter().any(|other| other.overlaps(&area)) {
                continue;
            }
            let hits: f64 =
                lines.iter().flat_map(|line| clip(line, area)).map(|l| length(&l)).sum();
            if best.as_ref().is_none_or(|(least, _)| hits < *least) {
                best = Some((hits, text));
            }
        }
    }
    best
}

/// The place on a line for its number: away from the frame, from all words and, as far as it
/// matters, from other lines.
fn tag_place(
    parts: &[Vec<Point>],
    others: &[Point],
    frame: Rectangle,
    taken: &[Rectangle],
) -> Option<Point> {
    const FAR: f64 = 40.0;
    let inside = |[x, y]: Point| {
        let edge = TAG + 4.0;
        x > frame.left + edge
            && x < frame.right - edge
            && y > frame.top + edge
            && y < frame.bottom - edge
    };
    let points = parts.iter().flat_map(|part| densified(part)).filter(|&point| inside(point));
    let free: Vec<Point> =
        points.filter(|&point| !taken.iter().any(|area| area.overlaps(&tag_area(point)))).collect();
    // Near two thirds of the width, where branches have left each other.
    let wanted = frame.left + 0.66 * frame.width();
    let cost = |&[x, y]: &Point| {
        let near = |[a, b]: &Point| (a - x).hypot(b - y);
        let nearest = others.iter().map(near).fold(FAR, f64::min);
        (FAR - nearest) / FAR + 0.25 * (x - wanted).abs() / frame.width().max(1.0)
    };
    free.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

impl DispersionFigure {
    /// Draws the figure into the bytes of a file.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    fn has_growth(&self) -> bool {
        self.branches.iter().any(|branch| !branch.growth.is_empty())
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries: Vec<Entry> = Vec::new();
        let middle = |area: Rectangle| 0.5 * (area.top + area.bottom);
        for (index, branch) in self.branches.iter().enumerate() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let (y, colour) = (middle(area), COLOURS[index % COLOURS.len()]);
                picture.line([[area.left, y], [area.right, y]], LINE_WIDTH, colour);
                draw_tag(picture, [0.5 * (area.left + area.right), y], index + 1, colour);
            };
            entries.push((branch.label.clone(), Box::new(swatch)));
        }
        let mut line = |words: &str, pattern: &'static [f64], width: f64, colour: Colour| {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let ends = [[area.left, middle(area)], [area.right, middle(area)]];
                picture.dashed(&ends, pattern, width, colour);
            };
            entries.push((words.to_owned(), Box::new(swatch)));
        };
        if self.branches.iter().any(|branch| !branch.group_speed.is_empty()) {
            line("phase speed ω/k", &[], LINE_WIDTH, INK);
            line("group speed dω/dk", GROUP, LINE_WIDTH, INK);
        }
        let has_measured = self.branches.iter().any(|branch| !branch.measured.is_empty());
        if !self.cutoffs.is_empty() {
            line("cut-off frequency", CUTOFF, LEVEL_WIDTH, PALE_INK);
        }
        if !self.speed_limits.is_empty() {
            line("limit of the speed", LIMIT, LEVEL_WIDTH, PALE_INK);
        }
        if has_measured {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let place = [0.5 * (area.left + area.right), middle(area)];
                draw_ring(picture, place, INK);
            };
            entries.push(("measured in time".to_owned(), Box::new(swatch)));
        }
        for (index, band) in self.bands.iter().enumerate() {
            if self.bands[..index].iter().all(|other| other.label != band.label) {
                entries.push((
                    band.label.clone(),
                    Box::new(|picture, area| {
                        picture.fill(area, BAND);
                        picture.frame(area, 1.5, PALE_INK);
                    }),
                ));
            }
        }
        if self.has_growth() && self.k_log {
            entries.push((
                "linear scale about 0".to_owned(),
                Box::new(|picture, area| {
                    picture.fill(area, LINEAR);
                    picture.frame(area, 1.5, PALE_INK);
                }),
            ));
        }
        entries
    }

    /// The phase speeds of a branch.
    fn phase(branch: &Branch) -> Vec<Point> {
        Self::phases(&branch.frequency)
    }

    /// Phase speeds from wave numbers and frequencies.
    fn phases(points: &[Point]) -> Vec<Point> {
        points.iter().map(|&[k, omega]| [k, omega / k]).collect()
    }

    /// The axes of wave numbers, frequencies, speeds and growth rates.
    fn scales(&self) -> [Scale; 4] {
        let branches = || self.branches.iter();
        let kind = |log: bool| if log { Kind::Log } else { Kind::Linear };
        let numbers = || {
            branches()
                .flat_map(|b| {
                    b.frequency.iter().chain(&b.group_speed).chain(&b.growth).chain(&b.measured)
                })
                .map(|point| point[0])
        };
        let mut k = Scale::of(kind(self.k_log), numbers(), [0.0; 2]);
        if !self.k_log && k.low > 0.0 && k.low < 0.2 * k.high {
            k.low = 0.0;
        }

        let edges = self.bands.iter().flat_map(|band| [band.from, band.to]);
        let cutoffs = self.cutoffs.iter().map(|level| level.value);
        let frequencies =
            branches().flat_map(|b| b.frequency.iter().chain(&b.measured)).map(|point| point[1]);
        let values = frequencies.chain(cutoffs).chain(edges);
        let frequency = if self.frequency_log {
            Scale::of(Kind::Log, values, [0.04, 0.04])
        } else {
            from_zero(Scale::of(Kind::Linear, values.chain([0.0]), [0.0, 0.05]))
        };

        let group = branches().flat_map(|b| &b.group_speed).map(|point| point[1]);
        let limits = self.speed_limits.iter().map(|level| level.value);
        let shortest = branches().filter_map(|branch| {
            let known = Self::phase(branch).into_iter().filter(|[k, c]| (k + c).abs() < FINITE);
            known.max_by(|a, b| a[0].total_cmp(&b[0])).map(|[_, c]| c)
        });
        let values = group.chain(limits).chain(shortest).chain([0.0]);
        let speed = from_zero(Scale::of(Kind::Linear, values, [0.0, 0.25]));

        let growth = || branches().flat_map(|b| &b.growth).map(|point| point[1]).chain([0.0]);
        let kind = if self.k_log {
            Kind::Symmetric(SymmetricLog::for_values(growth().filter(|v| v.abs() < FINITE)))
        } else {
            Kind::Linear
        };
        [k, frequency, speed, Scale::of(kind, growth(), [0.06, 0.06])]
    }

    fn picture(&self) -> Picture {
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

        // The growth rates share the axis of wave numbers with the frequencies above.
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

/// A range that starts at zero where no value is negative, and else has room below.
fn from_zero(scale: Scale) -> Scale {
    let low = if scale.low < 0.0 { scale.low - 0.05 * (scale.high - scale.low) } else { scale.low };
    Scale { low, ..scale }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, odd_curves};

    fn figure(points: &[[f64; 2]], levels: &[f64], log: bool) -> DispersionFigure {
        let branch = |index: usize| Branch {
            label: format!("branch {index}"),
            frequency: points.to_vec(),
            group_speed: points.to_vec(),
            measured: points.to_vec(),
            growth: points.to_vec(),
        };
        let level = |&value: &f64| Level { label: format!("ω* = {value} rad/s"), value };
        let band = |pair: &[f64]| Band {
            label: "forbidden band".to_owned(),
            from: pair[0],
            to: pair[pair.len() - 1],
        };
        DispersionFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            k_label: "wave number k (1/m)".to_owned(),
            frequency_label: "angular frequency ω (rad/s)".to_owned(),
            speed_label: "speed (m/s)".to_owned(),
            growth_label: "growth rate Re ς (1/s)".to_owned(),
            k_log: log,
            frequency_log: log,
            branches: (0..3).map(branch).collect(),
            bands: levels.chunks(2).map(band).collect(),
            cutoffs: levels.iter().map(level).collect(),
            speed_limits: levels.iter().map(level).collect(),
        }
    }

    fn check(figure: &DispersionFigure) {
        check_drawing(&figure.picture(), |format| figure.draw(format));
    }

    #[test]
    fn any_points_are_drawn() {
        for points in odd_curves() {
            for log in [false, true] {
                check(&figure(&points, &[1.0, 3.0], log));
            }
        }
    }

    #[test]
    fn labels_of_levels_keep_apart() {
        let points = [[0.1, 1.0], [10.0, 100.0], [20.0, 110.0]];
        let sets: [&[f64]; 4] = [
            &[],
            &[f64::NAN, f64::INFINITY, -3.0, 0.0],
            &[50.0, 50.0, 50.1, 50.2, 51.0, 110.0],
            &[100.0, 20.0, 20.0, f64::INFINITY],
        ];
        for levels in sets {
            check(&figure(&points, levels, false));
            check(&figure(&points, levels, true));
        }
        let mut long = figure(&points, &[20.0, 60.0], false);
        for text in [&mut long.cutoffs[0].label, &mut long.bands[0].label, &mut long.k_label] {
            *text = "a frequency of some kind ".repeat(30);
        }
        long.branches = (0..30).map(|index| long.branches[index % 3].clone()).collect();
        check(&long);
        long.branches.clear();
        check(&long);
    }

    #[test]
    fn phase_speeds_near_a_cutoff_do_not_stretch_the_axis() {
        let points: Vec<Point> =
            (1..=1000).map(|i| 0.01 * f64::from(i)).map(|k| [k, (100.0 + k * k).sqrt()]).collect();
        let mut figure = figure(&points, &[], false);
        for branch in &mut figure.branches {
            branch.group_speed = points.iter().map(|&[k, omega]| [k, k / omega]).collect();
        }
        let [_, _, speed, _] = figure.scales();
        assert!(speed.high > 1.4 && speed.high < 2.0 && speed.low == 0.0, "{}", speed.high);
    }
}
