//! A field over a plane domain, such as a final state of a motion.

use std::collections::BTreeMap;

use plotters::style::RGBColor;

use crate::page::{self, Legend, MARGIN, NAME, NUMBER, RULE};
use crate::picture::{
    Anchor, Colour, INK, Picture, Point, Rectangle, Text, WHITE, circle, dashes, text_width,
};
use crate::scale::{self, Tick, plain};
use crate::verdict_map::{ARROW, BAR, BAR_GAP, percent, runs};
use crate::{FigureError, Format, contour};

/// An axis of a field: the extent of the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldAxis {
    /// Name, symbol and unit.
    pub label: String,
    /// Place of the left or lower edge of the first cell, in the unit of the label.
    pub from: f64,
    /// Place of the right or upper edge of the last cell; it may be the smaller one.
    pub to: f64,
}

/// What is at a marked place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldMarkKind {
    /// Where the motion is excited, drawn as a star.
    Source,
    /// Where the motion is recorded, drawn as a triangle on its tip.
    Receiver,
}

/// A place of note in the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMark {
    /// Where, in the units of the axes. A mark outside the domain is counted in the legend.
    pub at: [f64; 2],
    /// A word or two, written beside the mark; may be empty.
    pub name: String,
    /// What is there.
    pub kind: FieldMarkKind,
}

/// One quantity over a plane domain, or over a plane through one of space, at one time.
///
/// The domain is drawn as it is, one unit to the right as long as one unit upwards, so that both
/// axes must be in the same unit; only a domain more than about fifteen times longer than wide is
/// stretched, and the name of the axis says so. Where there are more cells than can be shown, the
/// value of greatest magnitude stands for its neighbours.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldFigure {
    /// Headline.
    pub title: String,
    /// What is held fixed, such as time and plane.
    pub subtitle: String,
    /// The axis drawn to the right.
    pub x: FieldAxis,
    /// The axis drawn upwards.
    pub y: FieldAxis,
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// The value of each cell, in the unit of `label`. x runs fastest, the first row is the lowest.
    /// Numbers that are not finite have a look of their own.
    pub values: Vec<f64>,
    /// Name, symbol and unit of the quantity.
    pub label: String,
    /// Whether the quantity has a sign: the colours then are symmetric about zero, and lines of
    /// equal value are solid where it is positive and dashed where it is negative. Without a sign
    /// the colours start at zero. Values that are negative beyond round-off are shown as such in
    /// any case.
    pub is_signed: bool,
    /// The magnitude at which colours end, in the unit of `label`, where it is below the largest;
    /// values beyond are clipped, and the colour bar says so. The largest magnitude without.
    pub limit: Option<f64>,
    /// The magnitude at which colours end, in the unit of `label`, whatever the values are; `limit`
    /// does not matter then. Figures of one kind with the same scale have the same colours, colour
    /// bar and arrangement, as the frames of an [`crate::Animation`] must: without a sign, negative
    /// values then count as beyond the scale.
    pub scale: Option<f64>,
    /// Values on which lines of equal value are drawn, in the unit of `label`, with their numbers
    /// on them, in place of those at ¼ and ½ of the colours of a quantity with a sign. Values that
    /// are not finite or nowhere attained have no line.
    pub curves: Option<Vec<f64>>,
    /// Index of the material of each cell, ordered as the values; lines are drawn between
    /// different ones. Empty for a single material.
    pub outlines: Vec<u16>,
    /// Whether a cell has yielded, ordered as the values; such cells are dotted. Empty for none.
    pub plastic: Vec<bool>,
    /// Sources and receivers.
    pub marks: Vec<FieldMark>,
}

/// Steps of the colour map on either side of zero.
const SHADES: i16 = 96;
/// The step of a value that is not a finite number.
const UNKNOWN: i16 = i16::MIN;
const UNKNOWN_GROUND: Colour = RGBColor(150, 205, 120);
const UNKNOWN_HATCH: Colour = RGBColor(0, 75, 40);

/// From zero to the largest value without a sign; luminance falls evenly.
const SEQUENTIAL: [[f64; 3]; 7] = [
    [253.0, 252.0, 248.0],
    [253.0, 211.0, 150.0],
    [250.0, 164.0, 91.0],
    [233.0, 104.0, 63.0],
    [192.0, 46.0, 62.0],
    [122.0, 18.0, 66.0],
    [58.0, 6.0, 52.0],
];
/// From zero to the largest positive and negative value, both as dark as the other at each stop.
const POSITIVE: [[f64; 3]; 6] = [
    [252.0, 252.0, 252.0],
    [253.0, 206.0, 183.0],
    [242.0, 152.0, 116.0],
    [212.0, 92.0, 74.0],
    [170.0, 28.0, 44.0],
    [92.0, 2.0, 26.0],
];
const NEGATIVE: [[f64; 3]; 6] = [
    [252.0, 252.0, 252.0],
    [188.0, 227.0, 246.0],
    [129.0, 190.0, 222.0],
    [66.0, 142.0, 196.0],
    [30.0, 78.0, 150.0],
    [7.0, 33.0, 88.0],
];

/// Numbers beyond are treated as infinite: differences of larger ones overflow.
const FINITE: f64 = 1e300;
/// Negative values of this share of the largest are taken for round-off.
const ROUND_OFF: f64 = 1e-9;
/// The most cells along an axis of an SVG, and of the grid for lines of equal value.
const COARSE: usize = 400;
/// Shorter sides of the domain are stretched to this length in pixels.
const SHORTEST_SIDE: f64 = 84.0;
/// Frames at least this long hold the names of marks within; beside others there is room for them.
const ROOMY: f64 = 260.0;
/// Room for names beside a narrow frame, and above a low one.
const BESIDE: f64 = 200.0;
const ABOVE: f64 = 64.0;
/// Room for ticks that reach beyond the right end of the frame.
const OVERHANG: f64 = 20.0;
/// Room between a frame's axis and the colour bar below it.
const BAR_BELOW: f64 = 20.0;
/// Lines of equal value, as shares of the end of the colours.
const LEVELS: [f64; 4] = [-0.5, -0.25, 0.25, 0.5];
const LEVEL_WIDTH: f64 = 1.4;
const LEVEL_DASHES: [f64; 2] = [7.0, 5.0];
/// Lines on colours darker than this share of the scale are white.
const DARK: f64 = 0.6;
/// Size of the numbers on lines of equal value, and length of line for each of them.
const LEVEL_NUMBER: f64 = 20.0;
const LEVEL_REPEAT: f64 = 900.0;
/// Points of lines of equal value above which they are no help; each line counts for some more.
const MOST_LEVEL_POINTS: usize = 60_000;
/// Distance of the lines over negative values where lines of equal value would be too many.
const RULED: f64 = 8.0;
/// Distance of the dots over yielded cells.
const DOTS: f64 = 14.0;
const MARK_NAME: f64 = 22.0;
/// Distance from a mark's centre that is kept free.
const MARK_RADIUS: f64 = 15.0;

/// The colours of a field.
#[derive(Clone)]
pub(crate) struct Scale {
    is_signed: bool,
    /// Whether the colours are those of other figures, too, and not only of this one.
    is_fixed: bool,
    /// Magnitude of the darkest colour; zero where there is no other value.
    end: f64,
    /// The value of largest magnitude.
    extreme: f64,
    /// Number of cells beyond the end.
    clipped: usize,
    /// Whether the colours at the lower and upper end stand for values beyond.
    open: [bool; 2],
    /// Number of cells that hold no finite number.
    unknown: usize,
}

impl Scale {
    fn of(figure: &FieldFigure) -> Self {
        let finite = || figure.values.iter().copied().filter(|value| value.abs() < FINITE);
        let mut extreme = 0.0_f64;
        let mut lowest = 0.0_f64;
        for value in finite() {
            if value.abs() > extreme.abs() {
                extreme = value;
            }
            lowest = lowest.min(value);
        }
        let is_negative = lowest < -ROUND_OFF * extreme.abs();
        let (is_fixed, is_signed, end) = match figure.scale {
            Some(end) => (true, figure.is_signed, end),
            None => {
                let end = figure.limit.map_or(extreme.abs(), |limit| limit.min(extreme.abs()));
                (false, figure.is_signed || is_negative, end)
            }
        };
        let is_below = is_negative && !is_signed;
        let low = match () {
            () if is_signed => -end,
            () if is_below => 0.0,
            () => f64::NEG_INFINITY,
        };
        let clipped = finite().filter(|value| *value > end || *value < low).count();
        let is_open = clipped > 0 || is_fixed;
        Self {
            is_signed,
            is_fixed,
            end,
            extreme,
            clipped,
            open: [is_below || (is_signed && is_open), is_open],
            unknown: figure.values.len() - finite().count(),
        }
    }

    /// All colours that figures of such a scale may have, ink and paper apart.
    pub fn colours(&self) -> Vec<Colour> {
        let first = if self.is_signed { -SHADES } else { 0 };
        let steps = (first..=SHADES).map(|step| self.colour(step));
        steps.chain([UNKNOWN_GROUND, UNKNOWN_HATCH]).collect()
    }

    /// The step of the colour map that shows a value.
    fn step(&self, value: f64) -> i16 {
        if value.is_nan() {
            return UNKNOWN;
        }
        if self.end == 0.0 {
            return 0;
        }
        let low = if self.is_signed { -1.0 } else { 0.0 };
        ((value / self.end).clamp(low, 1.0) * f64::from(SHADES)).round() as i16
    }

    fn colour(&self, step: i16) -> Colour {
        if step == UNKNOWN {
            return UNKNOWN_GROUND;
        }
        let stops: &[[f64; 3]] = match (self.is_signed, step < 0) {
            (false, _) => &SEQUENTIAL,
            (true, false) => &POSITIVE,
            (true, true) => &NEGATIVE,
        };
        let place = f64::from(step.abs()) / f64::from(SHADES) * (stops.len() - 1) as f64;
        let below = (place as usize).min(stops.len() - 2);
        let mix = |channel: usize| {
            let (from, to) = (stops[below][channel], stops[below + 1][channel]);
            (from + (place - below as f64) * (to - from)).round() as u8
        };
        RGBColor(mix(0), mix(1), mix(2))
    }

    fn low(&self) -> f64 {
        if self.is_signed { -self.end } else { 0.0 }
    }

    /// The share of a bar below a value.
    fn share(&self, value: f64) -> f64 {
        if self.is_signed { 0.5 + 0.5 * (value / self.end) } else { value / self.end }
    }

    /// The ticks of a bar. Where values are clipped, its ends say that they stand for all beyond.
    fn ticks(&self, length: f64, upright: bool, degrees: bool) -> Vec<Tick> {
        if self.end == 0.0 {
            return Vec::new();
        }
        let low = self.low();
        let mut ticks =
            page::spaced(length, upright, |most| scale::ticks(low, self.end, most, degrees));
        let mut ends = Vec::new();
        if self.open[1] {
            ends.push((self.end, format!("≥ {}", plain(self.end))));
            if self.open[0] {
                ends.push((low, format!("≤ {}", plain(low))));
            }
        } else if ticks.len() < 2 {
            ends.push((self.end, plain(self.end)));
        }
        let apart = |(value, label): &Tick| {
            ends.iter().all(|(end, words)| {
                let room = if upright {
                    1.4 * NUMBER
                } else {
                    let widths = [label, words].map(|text| text_width(text, NUMBER, false));
                    0.5 * (widths[0] + widths[1]) + 0.6 * NUMBER
                };
                (self.share(*value) - self.share(*end)).abs() * length >= room
            })
        };
        ticks.retain(apart);
        ticks.extend(ends);
        ticks
    }
}

/// The cells along both axes as they are drawn, a number of true cells each.
struct Raster {
    /// For each axis the first true cell of each drawn one, and the number of all.
    edges: [Vec<usize>; 2],
    frame: Rectangle,
}

impl Raster {
    fn new(figure: &FieldFigure, frame: Rectangle, most: [usize; 2]) -> Self {
        let all = [figure.columns, figure.rows];
        let edges = [0, 1].map(|axis| {
            let drawn = all[axis].min(most[axis].max(1));
            (0..=drawn).map(|index| index * all[axis] / drawn).collect::<Vec<usize>>()
        });
        Self { edges, frame }
    }

    fn count(&self, axis: usize) -> usize {
        self.edges[axis].len() - 1
    }

    /// Place of the left edge of a drawn column, counted in true columns.
    fn x(&self, edge: f64) -> f64 {
        let all = self.edges[0][self.count(0)] as f64;
        self.frame.left + edge / all * self.frame.width()
    }

    fn y(&self, edge: f64) -> f64 {
        let all = self.edges[1][self.count(1)] as f64;
        self.frame.bottom - edge / all * self.frame.height()
    }

    /// The area of the drawn columns and rows from the first to behind the last. Where there are
    /// more cells than pixels, cells fill whole pixels, so that a single one keeps its colour.
    fn area(&self, columns: (usize, usize), rows: (usize, usize)) -> Rectangle {
        let [x, y] = [(0, columns), (1, rows)].map(|(axis, range)| {
            let length = if axis == 0 { self.frame.width() } else { self.frame.height() };
            let edges = &self.edges[axis];
            let all = edges[self.count(axis)] as f64;
            [range.0, range.1].map(|index| {
                let place = edges[index] as f64 / all * length;
                if all > length { (place - 1e-6).ceil() } else { place }
            })
        });
        Rectangle {
            left: self.frame.left + x[0],
            right: self.frame.left + x[1],
            top: self.frame.bottom - y[1],
            bottom: self.frame.bottom - y[0],
        }
    }

    /// A value for each drawn cell, from the indices of its true ones, row by row from below.
    fn gather<T>(&self, value: impl Fn(&mut dyn Iterator<Item = usize>) -> T) -> Vec<T> {
        let [x, y] = &self.edges;
        let all = x[self.count(0)];
        let mut values = Vec::with_capacity(self.count(0) * self.count(1));
        for rows in y.windows(2) {
            for columns in x.windows(2) {
                let (first, last) = (columns[0], columns[1]);
                let mut cells = (rows[0]..rows[1])
                    .flat_map(|row| (first..last).map(move |column| row * all + column));
                values.push(value(&mut cells));
            }
        }
        values
    }

    /// For each drawn cell the value of greatest magnitude; not-a-number where one is not finite.
    fn extremes(&self, values: &[f64]) -> Vec<f64> {
        self.gather(|cells| {
            let mut extreme = 0.0_f64;
            for value in cells.map(|cell| values[cell]) {
                if value.is_nan() || value.abs() >= FINITE {
                    return f64::NAN;
                }
                if value.abs() > extreme.abs() {
                    extreme = value;
                }
            }
            extreme
        })
    }

    /// The mean of each drawn cell; not-a-number where one is not finite.
    fn means(&self, values: &[f64]) -> Vec<f64> {
        self.gather(|cells| {
            let (mut sum, mut count) = (0.0, 0);
            for value in cells.map(|cell| values[cell]) {
                sum += if value.abs() < FINITE { value } else { f64::NAN };
                count += 1;
            }
            sum / f64::from(count)
        })
    }
}

/// Where everything lies on the sheet, in pixels.
struct Layout {
    height: f64,
    frame: Rectangle,
    /// How much longer a unit of each axis is drawn than true; one but for long thin domains.
    stretch: [f64; 2],
    /// The colour bar, unless the field is zero everywhere.
    bar: Option<Rectangle>,
    bar_is_upright: bool,
    /// Whether the name of the y axis stands above the frame, for want of room beside it.
    name_above: bool,
    /// Where the names of marks may stand.
    names: Rectangle,
    legend_top: f64,
}

/// All that is decided before drawing.
struct Arrangement {
    layout: Layout,
    legend: Legend,
    levels: Levels,
    has_borders: bool,
}

/// An entry of the legend, with the widest words that another figure of the same scale may have.
struct FieldEntry {
    words: String,
    widest: String,
    swatch: page::Swatch,
}

/// What tells positive and negative values apart in grey.
enum Levels {
    /// Lines of equal value with the share of the end of the colours that they belong to.
    Lines(Vec<(f64, Vec<Point>)>),
    /// None, or too many to be told apart: large negative values are ruled instead.
    Ruled,
    /// Too many of those asked for, of a quantity without a sign.
    TooMany,
    None,
}

impl FieldFigure {
    /// Draws the figure into the bytes of a file.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture(format)?.render(format)
    }

    fn check(&self) -> Result<(), FigureError> {
        for (axis, cells) in [(&self.x, self.columns), (&self.y, self.rows)] {
            let refuse = |problem| FigureError::Axis { label: axis.label.clone(), problem };
            if cells == 0 {
                return Err(refuse("has no cells"));
            }
            let length = (axis.to - axis.from).abs();
            if !(axis.from.is_finite() && axis.to.is_finite()) {
                return Err(refuse("has an end that is not a finite number"));
            }
            if !(length > 0.0 && length.is_finite()) {
                return Err(refuse("does not extend from a first to a different last value"));
            }
        }
        let (columns, rows) = (self.columns, self.rows);
        let lists = [
            ("values", self.values.len(), false),
            ("outlines", self.outlines.len(), self.outlines.is_empty()),
            ("plastic", self.plastic.len(), self.plastic.is_empty()),
        ];
        for (field, found, is_absent) in lists {
            if !is_absent && columns.checked_mul(rows) != Some(found) {
                return Err(FigureError::CellCount { field, found, columns, rows });
            }
        }
        match [self.limit, self.scale].into_iter().flatten().find(|end| !is_end(*end)) {
            Some(found) => Err(FigureError::Limit { found }),
            None => Ok(()),
        }
    }

    /// Decides what is drawn where. What the legend lists depends on what is drawn, and where that
    /// is on the legend's height: borders, lines and names are first placed without a legend.
    fn arrange(&self, scale: &Scale, format: Format) -> Arrangement {
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle).ceil();
        let trial = self.layout(scale, top, 0.0);
        let has_borders = self.borders(&self.raster(&trial, format)).is_some();
        let levels = self.levels(scale, &trial);
        let left_out =
            |layout| self.place_names(layout).iter().filter(|place| place.is_none()).count();
        let list = |scale: &Scale, levels: &Levels, left_out| {
            let entries = self.legend(scale, levels, has_borders, left_out);
            let (mut listed, mut widest) = (Vec::new(), Vec::new());
            for entry in entries {
                widest.push(entry.widest);
                listed.push((entry.words, entry.swatch));
            }
            Legend::with_room(listed, &widest, page::WIDTH - 2.0 * MARGIN)
        };
        // Figures of the same scale leave room for what others may have to say.
        let height = |legend: &Legend, left_out| {
            if !scale.is_fixed {
                return legend.height();
            }
            let all = Scale { unknown: scale.unknown.max(1), ..scale.clone() };
            let most =
                if self.has_curves(scale) { Levels::Lines(Vec::new()) } else { Levels::None };
            list(&all, &most, left_out).height().max(legend.height())
        };
        let count = left_out(&trial);
        let mut legend = list(scale, &levels, count);
        let mut layout = self.layout(scale, top, height(&legend, count));
        // Less room for the field may leave out more names.
        let count = left_out(&layout);
        legend = list(scale, &levels, count);
        layout = self.layout(scale, top, height(&legend, count));
        let levels = match levels {
            Levels::Lines(_) => self.levels(scale, &layout),
            levels => levels,
        };
        Arrangement { layout, legend, levels, has_borders }
    }

    /// Whether there are lines of equal value where the values let them.
    fn has_curves(&self, scale: &Scale) -> bool {
        self.curves.is_some() || scale.is_signed
    }

    /// The values with lines, as shares of the end of the colours.
    fn level_shares(&self, scale: &Scale) -> Vec<f64> {
        let Some(curves) = &self.curves else { return LEVELS.to_vec() };
        let mut shares: Vec<f64> = curves.iter().map(|level| level / scale.end).collect();
        shares.retain(|share| share.is_finite());
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        shares
    }

    /// The colours of the figure as those of all frames with the same scale.
    pub(crate) fn colours(&self) -> Vec<Colour> {
        Scale::of(self).colours()
    }

    pub(crate) fn picture(&self, format: Format) -> Result<Picture, FigureError> {
        self.check()?;
        let scale = Scale::of(self);
        let Arrangement { layout, legend, levels, has_borders } = self.arrange(&scale, format);
        let mut picture = Picture::new(page::WIDTH as u32, layout.height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let raster = self.raster(&layout, format);
        self.draw_cells(&mut picture, &scale, &raster);
        match &levels {
            Levels::Lines(lines) => {
                lines.iter().for_each(|(share, line)| draw_level(&mut picture, *share, line));
            }
            Levels::Ruled => self.rule_negative(&mut picture, &scale, &raster),
            Levels::TooMany | Levels::None => {}
        }
        if has_borders {
            draw_borders(&mut picture, self.borders(&raster).unwrap_or_default());
        }
        self.draw_plastic(&mut picture, layout.frame);
        if let Levels::Lines(lines) = &levels {
            for number in self.place_numbers(&scale, &layout, lines) {
                let bounds = number.bounds();
                let ground = Rectangle {
                    top: bounds.top + 1.0,
                    left: bounds.left - 3.0,
                    right: bounds.right + 3.0,
                    ..bounds
                };
                picture.fill(ground, WHITE);
                picture.text(number);
            }
        }
        picture.frame(layout.frame, RULE, INK);
        self.draw_axes(&mut picture, &layout);
        if let Some(bar) = layout.bar {
            self.draw_bar(&mut picture, &scale, &levels, bar, layout.bar_is_upright);
        }
        self.draw_marks(&mut picture, &layout);
        legend.draw(&mut picture, MARGIN, layout.legend_top);
        Ok(picture)
    }

    fn raster(&self, layout: &Layout, format: Format) -> Raster {
        let pixels = [layout.frame.width() as usize, layout.frame.height() as usize];
        let most = match format {
            Format::Png => pixels,
            Format::Svg => pixels.map(|pixels| pixels.min(COARSE)),
        };
        Raster::new(self, layout.frame, most)
    }

    /// Ticks of an axis in the axis's unit, for a length in pixels; both ends where there would be
    /// less than two.
    fn axis_ticks(axis: &FieldAxis, length: f64, upright: bool) -> Vec<Tick> {
        let (low, high) = (axis.from.min(axis.to), axis.from.max(axis.to));
        let degrees = axis.label.contains('°');
        let ticks = page::spaced(length, upright, |most| scale::ticks(low, high, most, degrees));
        let ends = [low, high].map(|end| (end, plain(end)));
        // Too close to each other to differ in few figures, they would say nothing.
        if ticks.len() < 2 && ends[0].1 != ends[1].1 { ends.to_vec() } else { ticks }
    }

    fn bar_ticks(&self, scale: &Scale, length: f64, upright: bool) -> Vec<Tick> {
        scale.ticks(length, upright, self.label.contains('°'))
    }

    /// Finds the arrangement in which the domain is largest: the colour bar beside or below.
    fn layout(&self, scale: &Scale, top: f64, legend: f64) -> Layout {
        let below = (page::BOTTOM_AXIS + 22.0 + legend + MARGIN - 12.0).ceil();
        let most = page::HEIGHT.max(top + 480.0 + below) - top - below;
        let [x, y] = [&self.x, &self.y].map(|axis| (axis.to - axis.from).abs());
        let ratio = x / y;
        let sheet = page::WIDTH - 2.0 * MARGIN;
        let about = (sheet / ratio).min(most).max(SHORTEST_SIDE);
        let axis = page::left_axis_width(&Self::axis_ticks(&self.y, about, true));
        let wide = sheet - axis - OVERHANG;
        let has_bar = scale.end > 0.0;
        let beside = if has_bar {
            let ticks = self.bar_ticks(scale, most, true);
            BAR_GAP + BAR + 14.0 + page::widest(&ticks) + 12.0 + NAME
        } else {
            0.0
        };
        let under = if has_bar { BAR_BELOW + BAR + page::BOTTOM_AXIS } else { 0.0 };
        let fitted =
            |width: f64, height: f64| [width.min(height * ratio), height.min(width / ratio)];
        let (upright, lying) = (fitted(wide - beside, most), fitted(wide, most - under));
        let bar_is_upright = !has_bar || upright[0] >= lying[0];
        let [true_width, true_height] = if bar_is_upright { upright } else { lying };
        let width = true_width.max(SHORTEST_SIDE).floor();
        let height = true_height.max(SHORTEST_SIDE).floor();

        let has_names = self.marks.iter().any(|mark| !mark.name.is_empty());
        let room_above = if has_names && height < ROOMY { ABOVE } else { 0.0 };
        let room_beside = if has_names && width < ROOMY { BESIDE } else { 0.0 };
        let name_above = height < 400.0 && text_width(&self.y.label, NAME, false) + 180.0 > height;
        let over = if name_above { room_above.max(1.5 * NAME) } else { room_above };
        let group = axis + width + room_beside + if bar_is_upright { beside } else { OVERHANG };
        let left = MARGIN + 0.5 * (sheet - group).max(0.0) + axis;
        let (left, top) = (left.round(), top + over.ceil());
        let frame = Rectangle { left, top, right: left + width, bottom: top + height };
        let bar = if bar_is_upright {
            let left = frame.right + room_beside + BAR_GAP;
            Rectangle { left, right: left + BAR, ..frame }
        } else {
            let top = frame.bottom + page::BOTTOM_AXIS + BAR_BELOW;
            Rectangle { top, bottom: top + BAR, ..frame }
        };
        let end = frame.bottom + if bar_is_upright { 0.0 } else { under };
        Layout {
            height: (end + below).ceil(),
            frame,
            stretch: [width / true_width, height / true_height],
            bar: has_bar.then_some(bar),
            bar_is_upright,
            name_above,
            names: Rectangle {
                top: frame.top - room_above,
                right: frame.right + room_beside,
                ..frame
            },
            legend_top: end + page::BOTTOM_AXIS + 22.0,
        }
    }

    /// Fills the cells, runs of one colour in a row at once.
    fn draw_cells(&self, picture: &mut Picture, scale: &Scale, raster: &Raster) {
        let columns = raster.count(0);
        let steps: Vec<i16> =
            raster.extremes(&self.values).into_iter().map(|value| scale.step(value)).collect();
        let mut areas: BTreeMap<i16, Vec<Rectangle>> = BTreeMap::new();
        for (row, steps) in steps.chunks_exact(columns).enumerate() {
            let mut start = 0;
            for run in steps.chunk_by(|a, b| a == b) {
                let end = start + run.len();
                areas.entry(run[0]).or_default().push(raster.area((start, end), (row, row + 1)));
                start = end;
            }
        }
        for (step, areas) in areas {
            picture.patches(areas, scale.colour(step));
        }
        let unknown = |column: usize, row: usize| steps[row * columns + column] == UNKNOWN;
        if scale.unknown > 0 {
            picture.patches(rules(raster, 6.0, 1.4, unknown), UNKNOWN_HATCH);
        }
    }

    /// Rules the negative values that are darker than a quarter of the scale.
    fn rule_negative(&self, picture: &mut Picture, scale: &Scale, raster: &Raster) {
        let values = raster.extremes(&self.values);
        let is_low =
            |column: usize, row: usize| values[row * raster.count(0) + column] < -0.25 * scale.end;
        picture.patches(rules(raster, RULED, 1.6, is_low), INK);
    }

    fn levels(&self, scale: &Scale, layout: &Layout) -> Levels {
        if !self.has_curves(scale) || scale.end == 0.0 {
            return Levels::None;
        }
        let frame = layout.frame;
        let raster = Raster::new(self, frame, [COARSE; 2]);
        let means = raster.means(&self.values);
        let [columns, rows] = [0, 1].map(|axis| raster.count(axis));
        // One cell more all around repeats the outermost values, so that lines reach the frame.
        let inner = |index: usize, count: usize| index.clamp(1, count) - 1;
        let value = |i: usize, j: usize| means[inner(j, rows) * columns + inner(i, columns)];
        // From places on the grid to cells: to the middle of each, or to an edge of the domain.
        let cell = |place: f64, axis: usize| {
            let (edges, count) = (&raster.edges[axis], raster.count(axis));
            let centre = |index: usize| match index {
                0 => 0.0,
                index if index > count => edges[count] as f64,
                index => 0.5 * (edges[index - 1] + edges[index]) as f64,
            };
            let below = (place.max(0.0) as usize).min(count);
            let (from, to) = (centre(below), centre(below + 1));
            from + (place - below as f64) * (to - from)
        };
        let mut lines = Vec::new();
        let mut effort = 0;
        for share in self.level_shares(scale) {
            for line in contour::lines(columns + 2, rows + 2, value, share * scale.end) {
                let points: Vec<Point> = line
                    .iter()
                    .map(|&[i, j]| [raster.x(cell(i, 0)), raster.y(cell(j, 1))])
                    .collect();
                // Specks tell nothing, but many of them that there is no line to follow.
                effort += 10 + points.len();
                if effort > MOST_LEVEL_POINTS {
                    return if scale.is_signed { Levels::Ruled } else { Levels::TooMany };
                }
                if length(&points) > 12.0 {
                    lines.push((share, points));
                }
            }
        }
        if !lines.is_empty() || self.curves.is_some() {
            Levels::Lines(lines)
        } else if self.values.iter().any(|value| *value < -0.25 * scale.end) {
            Levels::Ruled
        } else if scale.is_fixed {
            Levels::Lines(lines)
        } else {
            Levels::None
        }
    }

    /// The numbers on lines of equal value that were asked for, each on a level piece of its line
    /// and clear of marks, of other numbers and, as far as can be, of other lines.
    fn place_numbers(
        &self,
        scale: &Scale,
        layout: &Layout,
        lines: &[(f64, Vec<Point>)],
    ) -> Vec<Text> {
        if self.curves.is_none() {
            return Vec::new();
        }
        let frame = layout.frame;
        let mut taken: Vec<Rectangle> =
            self.places(frame).iter().map(|(at, _)| around(*at)).collect();
        taken.extend(self.place_names(layout).iter().flatten().map(padded));
        // The index of a line in each small square that it passes; two where several do.
        const SQUARE: f64 = 6.0;
        let square = |[x, y]: Point| ((x / SQUARE) as usize, (y / SQUARE) as usize);
        let mut passed: BTreeMap<(usize, usize), [usize; 2]> = BTreeMap::new();
        for (index, (_, line)) in lines.iter().enumerate() {
            for &point in line {
                let own = passed.entry(square(point)).or_insert([index; 2]);
                own[1] = if own[0] == index { own[1] } else { index };
            }
        }
        // Long lines first: they need their numbers most.
        let mut order: Vec<(f64, usize)> =
            lines.iter().enumerate().map(|(index, (_, line))| (length(line), index)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut numbers = Vec::new();
        for (whole, index) in order {
            let (share, line) = &lines[index];
            let words = plain(share * scale.end);
            let width = text_width(&words, LEVEL_NUMBER, false);
            // A number would hide the whole of a small ring.
            let least = if line.first() == line.last() { 4.5 } else { 1.6 };
            if whole < least * width {
                continue;
            }
            let mut own: Vec<Point> = Vec::new();
            let is_free = |text: &Text, taken: &[Rectangle]| {
                let pad = padded(text);
                pad.left > frame.left + 4.0
                    && pad.right < frame.right - 4.0
                    && pad.top > frame.top + 4.0
                    && pad.bottom < frame.bottom - 4.0
                    && !taken.iter().any(|other| other.overlaps(&pad))
            };
            let crossings = |area: Rectangle| {
                let (from, to) = (square([area.left, area.top]), square([area.right, area.bottom]));
                let squares = (from.0..=to.0).flat_map(|x| (from.1..=to.1).map(move |y| (x, y)));
                squares
                    .filter_map(|place| passed.get(&place))
                    .filter(|own| own.iter().any(|other| *other != index))
                    .count()
            };
            let count = 1 + (whole / LEVEL_REPEAT) as usize;
            // Along the line, of which each of its numbers has a part.
            let step = (line.len() / (60 * count)).max(1);
            for part in 0..count {
                let [first, last] = [part, part + 1].map(|edge| edge * (line.len() - 1) / count);
                let mut best: Option<(f64, Text)> = None;
                for middle in (first..=last).step_by(step) {
                    let [x, y] = line[middle];
                    let at = [x, y + 0.36 * LEVEL_NUMBER];
                    let text = Text::new(at, Anchor::Middle, LEVEL_NUMBER, &words);
                    let is_near = |&[a, b]: &Point| (a - x).hypot(b - y) < 0.25 * LEVEL_REPEAT;
                    if !is_free(&text, &taken) || own.iter().any(is_near) {
                        continue;
                    }
                    let area = padded(&text);
                    // How far the line leaves the middle of its number.
                    let reach = (middle.saturating_sub(200)..(middle + 200).min(line.len()))
                        .map(|other| line[other])
                        .filter(|point| {
                            (point[0] - x).abs() < 0.5 * width && (point[1] - y).abs() < 60.0
                        })
                        .map(|point| (point[1] - y).abs())
                        .fold(0.0, f64::max)
                        .min(LEVEL_NUMBER);
                    let place = (middle - first) as f64 / (last - first).max(1) as f64;
                    let cost = crossings(area) as f64 + 0.1 * reach + 2.0 * (place - 0.5).abs();
                    if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                        best = Some((cost, text));
                    }
                }
                if let Some((_, text)) = best {
                    own.push(text.at);
                    // Numbers in a row would be read as one.
                    let pad = padded(&text);
                    taken.push(Rectangle { left: pad.left - 8.0, right: pad.right + 8.0, ..pad });
                    numbers.push(text);
                }
            }
        }
        numbers
    }

    /// The lines between different materials as thin areas; none where they would cover the field.
    fn borders(&self, raster: &Raster) -> Option<Vec<Rectangle>> {
        if self.outlines.iter().all(|material| *material == self.outlines[0]) {
            return None;
        }
        let [columns, rows] = [0, 1].map(|axis| raster.count(axis));
        let middle = |axis: usize, index: usize| {
            let edges = &raster.edges[axis];
            (edges[index] + edges[index + 1] - 1) / 2
        };
        let material = |column: usize, row: usize| {
            self.outlines[middle(1, row) * self.columns + middle(0, column)]
        };
        let mut lines = Vec::new();
        let mut covered = 0.0;
        for column in 1..columns {
            for run in runs(rows, |row| material(column - 1, row) != material(column, row)) {
                lines.push(raster.area((column, column), run));
            }
        }
        for row in 1..rows {
            for run in runs(columns, |column| material(column, row - 1) != material(column, row)) {
                lines.push(raster.area(run, (row, row)));
            }
        }
        for line in &lines {
            covered += 6.0 * (line.width() + line.height());
        }
        let frame = raster.frame;
        (covered < 0.4 * frame.width() * frame.height()).then_some(lines)
    }

    /// Draws a dot for all yielded cells within some pixels, over the one nearest to their middle.
    fn draw_plastic(&self, picture: &mut Picture, frame: Rectangle) {
        let width = frame.width() / self.columns as f64;
        let height = frame.height() / self.rows as f64;
        // Whole cells, so that the dots of an area are evenly spaced.
        let [across, up] = [width, height].map(|size| (DOTS / size).round().max(1.0) as usize);
        let mut nearest: BTreeMap<(usize, usize), (usize, usize)> = BTreeMap::new();
        let yielded = self.plastic.iter().enumerate().filter(|(_, yielded)| **yielded);
        for (cell, _) in yielded {
            let (column, row) = (cell % self.columns, cell / self.columns);
            let away = (column % across).abs_diff(across / 2) + (row % up).abs_diff(up / 2);
            let best = nearest.entry((row / up, column / across)).or_insert((away, cell));
            *best = (*best).min((away, cell));
        }
        let place = |cell: usize| {
            let (column, row) = (cell % self.columns, cell / self.columns);
            [frame.left + (column as f64 + 0.5) * width, frame.bottom - (row as f64 + 0.5) * height]
        };
        let places: Vec<Point> = nearest.values().map(|(_, cell)| place(*cell)).collect();
        draw_dots(picture, &places, frame);
    }

    fn draw_axes(&self, picture: &mut Picture, layout: &Layout) {
        let frame = layout.frame;
        let share = |axis: &FieldAxis, value: f64| (value - axis.from) / (axis.to - axis.from);
        let x_ticks: Vec<Tick> = Self::axis_ticks(&self.x, frame.width(), false)
            .into_iter()
            .map(|(x, label)| (frame.left + share(&self.x, x) * frame.width(), label))
            .collect();
        let y_ticks: Vec<Tick> = Self::axis_ticks(&self.y, frame.height(), true)
            .into_iter()
            .map(|(y, label)| (frame.bottom - share(&self.y, y) * frame.height(), label))
            .collect();
        page::bottom_axis(picture, frame, &thinned(x_ticks, false), "");
        // The name may be longer than a narrow frame.
        let middle = 0.5 * (frame.left + frame.right);
        let room = 2.0 * (middle - MARGIN).min(page::WIDTH - MARGIN - middle);
        let (words, size) = page::fit(&stretched(&self.x.label, layout.stretch[0]), NAME, room);
        if !words.is_empty() {
            let at = [middle, frame.bottom + page::BOTTOM_AXIS - 0.3 * NAME];
            picture.text(Text::new(at, Anchor::Middle, size, words));
        }
        let y_ticks = thinned(y_ticks, true);
        match self.name_above(layout) {
            Some(name) => {
                page::left_axis(picture, frame, &y_ticks, "");
                picture.text(name);
            }
            None => {
                let name = stretched(&self.y.label, layout.stretch[1]);
                page::left_axis(picture, frame, &y_ticks, &name);
            }
        }
    }

    /// The name of the y axis where it stands above the frame.
    fn name_above(&self, layout: &Layout) -> Option<Text> {
        if !layout.name_above || self.y.label.is_empty() {
            return None;
        }
        let left = layout.frame.left - 60.0;
        let name = stretched(&self.y.label, layout.stretch[1]);
        let (words, size) = page::fit(&name, NAME, page::WIDTH - MARGIN - left);
        Some(Text::new([left, layout.frame.top - 0.7 * NAME], Anchor::Start, size, words))
    }

    fn draw_bar(
        &self,
        picture: &mut Picture,
        scale: &Scale,
        levels: &Levels,
        bar: Rectangle,
        upright: bool,
    ) {
        let length = if upright { bar.height() } else { bar.width() };
        let place = |share: f64| {
            if upright { bar.bottom - share * length } else { bar.left + share * length }
        };
        let across = |share: f64| {
            let place = place(share);
            if upright {
                [[bar.left, place], [bar.right, place]]
            } else {
                [[place, bar.top], [place, bar.bottom]]
            }
        };
        let first = if scale.is_signed { -SHADES } else { 0 };
        let count = f64::from(SHADES - first) + 1.0;
        for (index, step) in (first..=SHADES).enumerate() {
            let [from, to] = [index as f64, index as f64 + 1.0].map(|edge| place(edge / count));
            let part = if upright {
                Rectangle { top: to, bottom: from, ..bar }
            } else {
                Rectangle { left: from, right: to, ..bar }
            };
            picture.patches(vec![part], scale.colour(step));
        }
        match levels {
            Levels::Lines(_) => {
                for level in self.level_shares(scale) {
                    let share = scale.share(level * scale.end);
                    if (0.0..=1.0).contains(&share) {
                        draw_level(picture, level, &across(share));
                    }
                }
            }
            Levels::Ruled => {
                let end = place(scale.share(-0.25 * scale.end));
                let ruled = if upright {
                    Rectangle { top: end, ..bar }
                } else {
                    Rectangle { right: end, ..bar }
                };
                draw_ruled(picture, ruled);
            }
            Levels::TooMany | Levels::None => {}
        }
        // Arrows say that the colours at the ends stand for all values beyond.
        let ends: &[f64] = match scale.open {
            [false, false] => &[],
            [true, false] => &[0.0],
            [false, true] => &[1.0],
            [true, true] => &[0.0, 1.0],
        };
        for &end in ends {
            let base = across(end + (0.5 - end) * 2.0 * ARROW / length);
            let middle = across(end);
            let tip = [0, 1].map(|part| 0.5 * (middle[0][part] + middle[1][part]));
            for (corner, inner) in middle.into_iter().zip(base) {
                picture.polygon(vec![tip, corner, inner], WHITE);
            }
            picture.line([base[0], tip, base[1]], RULE, INK);
        }
        let outline = outline(bar, upright, ends, ARROW);
        picture.line(outline, RULE, INK);

        let ticks: Vec<Tick> = self
            .bar_ticks(scale, length, upright)
            .into_iter()
            .map(|(value, label)| (place(scale.share(value)), label))
            .collect();
        if !upright {
            return page::bottom_axis(picture, bar, &thinned(ticks, false), &self.label);
        }
        let ticks = thinned(ticks, true);
        for (y, label) in &ticks {
            picture.line([[bar.right, *y], [bar.right + 8.0, *y]], RULE, INK);
            if !label.is_empty() {
                let at = [bar.right + 14.0, y + 0.36 * NUMBER];
                picture.text(Text::new(at, Anchor::Start, NUMBER, label));
            }
        }
        let (name, size) = page::fit(&self.label, NAME, bar.height());
        if !name.is_empty() {
            let x = bar.right + 14.0 + page::widest(&ticks) + 12.0 + 0.76 * NAME;
            let at = [x, 0.5 * (bar.top + bar.bottom)];
            picture.text(Text { upwards: true, ..Text::new(at, Anchor::Middle, size, name) });
        }
    }

    /// The marks in the domain, with their places on the sheet.
    fn places(&self, frame: Rectangle) -> Vec<(Point, &FieldMark)> {
        let share = |axis: &FieldAxis, value: f64| (value - axis.from) / (axis.to - axis.from);
        let inside = |share: f64| (-1e-9..=1.0 + 1e-9).contains(&share);
        let shares = self
            .marks
            .iter()
            .map(|mark| ([share(&self.x, mark.at[0]), share(&self.y, mark.at[1])], mark));
        shares
            .filter(|([x, y], _)| inside(*x) && inside(*y))
            .map(|([x, y], mark)| {
                let x = frame.left + x * frame.width();
                ([x, frame.bottom - y * frame.height()], mark)
            })
            .collect()
    }

    /// A place for the name of each mark in the domain, none where there is no room.
    fn place_names(&self, layout: &Layout) -> Vec<Option<Text>> {
        let places = self.places(layout.frame);
        let mut taken: Vec<Rectangle> = places.iter().map(|(at, _)| around(*at)).collect();
        // Names stand on either side of the frame's lines, not on them.
        let (area, frame) = (layout.names, layout.frame);
        taken.extend([
            Rectangle { bottom: frame.top + 2.0, top: frame.top - 2.0, ..frame },
            Rectangle { left: frame.right - 2.0, right: frame.right + 2.0, ..frame },
        ]);
        taken.extend(self.name_above(layout).as_ref().map(padded));
        let mut names = Vec::new();
        for &([x, y], mark) in &places {
            let widest = (0.4 * area.width()).max(150.0);
            let (name, size) = page::fit(&mark.name, MARK_NAME, widest);
            let half = 0.5 * text_width(&name, size, false);
            let near = (0..14).flat_map(|step| {
                let distance = MARK_RADIUS + 7.0 + 14.0 * f64::from(step);
                // To the right and left first; the others turn away from there.
                [0.0_f64, 180.0, 45.0, 135.0, -45.0, -135.0, 90.0, -90.0].map(|turn| {
                    let (sin, cos) = turn.to_radians().sin_cos();
                    let middle = x + cos * (distance + half);
                    let baseline = y - sin * (distance + 0.4 * size) + 0.3 * size;
                    Text::new([middle, baseline], Anchor::Middle, size, &name)
                })
            });
            let free = |text: &Text| {
                let pad = padded(text);
                pad.left >= area.left + 2.0
                    && pad.right <= area.right - 2.0
                    && pad.top >= area.top + 2.0
                    && pad.bottom <= area.bottom - 2.0
                    && !taken.iter().any(|other| other.overlaps(&pad))
            };
            // A mark without a name needs no place for it.
            let place = if name.is_empty() {
                Some(Text::new([x, y], Anchor::Middle, size, ""))
            } else {
                near.into_iter().find(free)
            };
            if let Some(text) = place.as_ref().filter(|text| !text.content.is_empty()) {
                taken.push(padded(text));
            }
            names.push(place);
        }
        names
    }

    fn draw_marks(&self, picture: &mut Picture, layout: &Layout) {
        let places = self.places(layout.frame);
        let names = self.place_names(layout);
        let words = || names.iter().map(|name| name.as_ref().filter(|t| !t.content.is_empty()));
        for (&([x, y], _), text) in places.iter().zip(words()) {
            let Some(pad) = text.map(padded) else { continue };
            let end = [x.clamp(pad.left, pad.right), y.clamp(pad.top, pad.bottom)];
            if (end[0] - x).hypot(end[1] - y) > MARK_RADIUS + 12.0 {
                picture.line([[x, y], end], 4.4, WHITE);
                picture.line([[x, y], end], 1.6, INK);
            }
        }
        for &(at, mark) in &places {
            draw_mark(picture, at, mark.kind);
        }
        for text in words().flatten() {
            picture.fill(padded(text), WHITE);
            picture.text(text.clone());
        }
    }

    fn legend(
        &self,
        scale: &Scale,
        levels: &Levels,
        has_borders: bool,
        names_left_out: usize,
    ) -> Vec<FieldEntry> {
        let mut entries: Vec<FieldEntry> = Vec::new();
        let cells = self.values.len();
        // Words that differ between figures of the same scale are brief.
        const MOST: &str = ">99.9 %";
        let of_cells = if scale.is_fixed { "" } else { " of the cells" };
        let first = self.values[0];
        let is_constant = self.values.iter().all(|value| *value == first);
        let everywhere = if scale.end == 0.0 && scale.unknown == 0 {
            Some("zero everywhere".to_owned())
        } else if scale.end == 0.0 && scale.unknown < cells {
            Some("zero wherever it is finite".to_owned())
        } else {
            let is_said = is_constant && scale.unknown == 0;
            is_said.then(|| format!("{} everywhere", plain(first)))
        };
        // The colours say so where they are given.
        if let Some(words) = everywhere.filter(|_| !scale.is_fixed) {
            let colon = if self.label.is_empty() { "" } else { ": " };
            let ground = scale.colour(if scale.end == 0.0 { 0 } else { scale.step(first) });
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                picture.fill(area, ground);
                picture.frame(area, 1.5, INK);
            };
            entries.push(entry(format!("{}{colon}{words}", self.label), swatch));
        }
        if scale.clipped > 0 || scale.is_fixed {
            let sign = if scale.is_signed { "±" } else { "" };
            let share = percent(scale.clipped, cells);
            let end = plain(scale.end);
            let beyond = |share: &str| format!("beyond {sign}{end} ({share})");
            let [words, widest] = if scale.is_fixed {
                [&share, MOST].map(beyond)
            } else {
                let largest = plain(scale.extreme);
                let clipped =
                    format!("clipped at {sign}{end} (largest {largest}; {share}{of_cells})");
                [clipped.clone(), clipped]
            };
            let (low, high) = (scale.step(-scale.end), SHADES);
            let colours =
                [if scale.is_signed { low } else { high }, high].map(|step| scale.colour(step));
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let middle = 0.5 * (area.left + area.right);
                picture.fill(Rectangle { right: middle, ..area }, colours[0]);
                picture.fill(Rectangle { left: middle, ..area }, colours[1]);
                picture.frame(area, 1.5, INK);
            };
            entries.push(FieldEntry { words, widest, swatch: Box::new(swatch) });
        }
        match levels {
            Levels::Lines(_) if self.curves.is_some() => {
                let levels = self.level_shares(scale);
                for (sign, words) in
                    [(1.0, "equal value, as numbered"), (-1.0, "equal negative value")]
                {
                    if !levels.iter().any(|level| (*level < 0.0) == (sign < 0.0)) {
                        continue;
                    }
                    let swatch = move |picture: &mut Picture, area: Rectangle| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_level(picture, 0.5 * sign, &[[area.left, y], [area.right, y]]);
                    };
                    entries.push(entry(words.to_owned(), swatch));
                }
            }
            Levels::TooMany => {
                let words = "lines of equal value not drawn: too many";
                entries.push(entry(words.to_owned(), |_, _| {}));
            }
            Levels::Lines(_) => {
                for (sign, words) in [(1.0, "+¼ and +½"), (-1.0, "−¼ and −½")] {
                    let swatch = move |picture: &mut Picture, area: Rectangle| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_level(picture, 0.5 * sign, &[[area.left, y], [area.right, y]]);
                    };
                    entries.push(entry(format!("{words} of the scale"), swatch));
                }
            }
            Levels::Ruled => {
                let ground = scale.colour(-SHADES / 2);
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    picture.fill(area, ground);
                    draw_ruled(picture, area);
                    picture.frame(area, 1.5, INK);
                };
                entries.push(entry("below −¼ of the scale".to_owned(), swatch));
            }
            Levels::None => {}
        }
        if has_borders {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                draw_borders(picture, vec![Rectangle { top: y, bottom: y, ..area }]);
            };
            entries.push(entry("border between materials".to_owned(), swatch));
        } else if self.outlines.iter().any(|material| *material != self.outlines[0]) {
            let words = "borders between materials not drawn: too many";
            entries.push(entry(words.to_owned(), |_, _| {}));
        }
        let yielded = self.plastic.iter().filter(|yielded| **yielded).count();
        if yielded > 0 || (scale.is_fixed && !self.plastic.is_empty()) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                let place = |index: i32| [area.left + DOTS * (f64::from(index) + 0.5), y];
                let dots: Vec<Point> = (0..5)
                    .flat_map(|index| {
                        [-0.5, 0.5].map(|row| {
                            let [x, y] = place(index);
                            [x, y + row * DOTS]
                        })
                    })
                    .collect();
                draw_dots(picture, &dots, area);
            };
            let words = |share: &str| format!("yielded ({share}{of_cells})");
            let [words, widest] = [&percent(yielded, cells), MOST].map(words);
            entries.push(FieldEntry { words, widest, swatch: Box::new(swatch) });
        }
        let frame = Rectangle { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };
        let inside = self.places(frame);
        for (kind, word) in
            [(FieldMarkKind::Source, "source"), (FieldMarkKind::Receiver, "receiver")]
        {
            let all = self.marks.iter().filter(|mark| mark.kind == kind).count();
            let shown = inside.iter().filter(|(_, mark)| mark.kind == kind).count();
            if all > 0 {
                let outside = all - shown;
                let words = match outside {
                    0 => word.to_owned(),
                    _ => format!("{word} ({outside} of {all} outside the picture)"),
                };
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let middle = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
                    draw_mark(picture, middle, kind);
                };
                entries.push(entry(words, swatch));
            }
        }
        if names_left_out > 0 {
            let words = match names_left_out {
                1 => "1 name left out for want of room".to_owned(),
                count => format!("{count} names left out for want of room"),
            };
            entries.push(entry(words, |_, _| {}));
        }
        // Last, so that the others keep their places.
        if scale.unknown > 0 {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.fill(area, UNKNOWN_GROUND);
                let mut y = area.top + 3.0;
                let mut lines = Vec::new();
                while y < area.bottom {
                    lines.push(Rectangle { top: y, bottom: y + 1.4, ..area });
                    y += 6.0;
                }
                picture.patches(lines, UNKNOWN_HATCH);
                picture.frame(area, 1.5, INK);
            };
            let share = percent(scale.unknown, cells);
            let words = |share: &str| format!("not a finite number ({share}{of_cells})");
            let [words, widest] = [&share, MOST].map(words);
            entries.push(FieldEntry { words, widest, swatch: Box::new(swatch) });
        }
        if !scale.is_fixed {
            for FieldEntry { words, widest, .. } in &mut entries {
                widest.clone_from(words);
            }
        }
        entries
    }
}

fn entry(words: String, swatch: impl Fn(&mut Picture, Rectangle) + 'static) -> FieldEntry {
    FieldEntry { widest: words.clone(), words, swatch: Box::new(swatch) }
}

/// The name of an axis, with the factor by which it is drawn too long.
fn stretched(label: &str, factor: f64) -> String {
    let round = if factor < 9.95 { (10.0 * factor).round() / 10.0 } else { factor.round() };
    if factor < 1.05 {
        label.to_owned()
    } else if round < 1e6 {
        format!("{label}, stretched ×{}", plain(round))
    } else {
        format!("{label}, not to scale")
    }
}

/// Level lines `spacing` pixels apart over the drawn cells that are selected, as thin areas.
fn rules(
    raster: &Raster,
    spacing: f64,
    width: f64,
    selected: impl Fn(usize, usize) -> bool,
) -> Vec<Rectangle> {
    let frame = raster.frame;
    let edges = &raster.edges[1];
    let mut lines = Vec::new();
    let mut row = 0;
    for count in 0..(frame.height() / spacing) as usize {
        let y = frame.bottom - (count as f64 + 0.5) * spacing;
        while row + 1 < raster.count(1) && raster.y(edges[row + 1] as f64) > y {
            row += 1;
        }
        for run in runs(raster.count(0), |column| selected(column, row)) {
            let area = raster.area(run, (row, row + 1));
            lines.push(Rectangle { top: y - 0.5 * width, bottom: y + 0.5 * width, ..area });
        }
    }
    lines
}

/// The ruling of negative values over an area.
fn draw_ruled(picture: &mut Picture, area: Rectangle) {
    let count = ((area.height() / RULED) as usize).max(1);
    let spacing = area.height() / count as f64;
    let line = |index: usize| {
        let y = area.top + (index as f64 + 0.5) * spacing;
        Rectangle { top: y - 0.8, bottom: y + 0.8, ..area }
    };
    picture.patches((0..count).map(line).collect(), INK);
}

fn draw_level(picture: &mut Picture, share: f64, points: &[Point]) {
    let colour = if share.abs() > DARK { WHITE } else { INK };
    let pattern: &[f64] = if share < 0.0 { &LEVEL_DASHES } else { &[] };
    if pattern.is_empty() {
        return picture.line(points, LEVEL_WIDTH, colour);
    }
    for dash in dashes(points, pattern) {
        picture.line(dash, LEVEL_WIDTH, colour);
    }
}

/// Draws upright and level lines, given as areas without width, dark with a light rim.
fn draw_borders(picture: &mut Picture, lines: Vec<Rectangle>) {
    for (half, colour) in [(3.0, WHITE), (1.8, INK)] {
        let widened = |line: &Rectangle| {
            let (x, y) = if line.height() > line.width() { (half, 0.0) } else { (0.0, half) };
            // Corners close.
            let (x, y) =
                (x + if x == 0.0 { 1.0 } else { 0.0 }, y + if y == 0.0 { 1.0 } else { 0.0 });
            Rectangle {
                left: line.left - x,
                top: line.top - y,
                right: line.right + x,
                bottom: line.bottom + y,
            }
        };
        picture.patches(lines.iter().map(widened).collect(), colour);
    }
}

/// Draws dots that show on light and dark, cut at the edges of an area.
fn draw_dots(picture: &mut Picture, places: &[Point], area: Rectangle) {
    for (half, colour) in [(3.0, WHITE), (1.8, INK)] {
        let dot = |&[x, y]: &Point| Rectangle {
            left: (x - half).max(area.left),
            top: (y - half).max(area.top),
            right: (x + half).min(area.right),
            bottom: (y + half).min(area.bottom),
        };
        picture.patches(places.iter().map(dot).collect(), colour);
    }
}

fn draw_mark(picture: &mut Picture, [x, y]: Point, kind: FieldMarkKind) {
    for (more, colour) in [(3.0, WHITE), (0.0, INK)] {
        match kind {
            FieldMarkKind::Source => {
                let (outer, inner) = (13.0 + 1.4 * more, 5.4 + more);
                let tip = |corner: usize| {
                    let radius = if corner.is_multiple_of(2) { outer } else { inner };
                    let angle = std::f64::consts::PI * (0.2 * corner as f64 - 0.5);
                    [x + radius * angle.cos(), y + radius * angle.sin()]
                };
                picture.polygon((0..10).map(tip).collect(), colour);
            }
            FieldMarkKind::Receiver => {
                let radius = 12.0 + 1.6 * more;
                let corners = circle([x, y - 1.5], radius, 12);
                // The corners at 30°, 150° and 270°, counted downwards, with the tip below.
                picture.polygon([3, 7, 11].map(|corner: usize| corners[corner]).to_vec(), colour);
            }
        }
    }
}

/// Whether colours can end at a number.
fn is_end(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

/// The room of a mark.
fn around([x, y]: Point) -> Rectangle {
    Rectangle {
        left: x - MARK_RADIUS,
        top: y - MARK_RADIUS,
        right: x + MARK_RADIUS,
        bottom: y + MARK_RADIUS,
    }
}

/// The ground of a name.
fn padded(text: &Text) -> Rectangle {
    let bounds = text.bounds();
    Rectangle {
        left: bounds.left - 4.0,
        right: bounds.right + 4.0,
        top: bounds.top - 1.0,
        bottom: bounds.bottom + 1.0,
    }
}

/// The outline of a bar, closed, with an arrow at the ends given as shares of its length.
fn outline(bar: Rectangle, upright: bool, ends: &[f64], arrow: f64) -> Vec<Point> {
    let Rectangle { left, top, right, bottom } = bar;
    let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
    let [low, high] = [0.0, 1.0].map(|end| ends.contains(&end));
    let cut = |is_cut: bool| if is_cut { arrow } else { 0.0 };
    let corners: [(Point, bool); 6] = if upright {
        [
            ([left, bottom - cut(low)], true),
            ([x, bottom], low),
            ([right, bottom - cut(low)], true),
            ([right, top + cut(high)], true),
            ([x, top], high),
            ([left, top + cut(high)], true),
        ]
    } else {
        [
            ([left + cut(low), top], true),
            ([left, y], low),
            ([left + cut(low), bottom], true),
            ([right - cut(high), bottom], true),
            ([right, y], high),
            ([right - cut(high), top], true),
        ]
    };
    let mut points: Vec<Point> =
        corners.into_iter().filter(|(_, is_there)| *is_there).map(|(point, _)| point).collect();
    points.extend_from_within(..2);
    points
}

/// The ticks with the labels left out that would touch the one before; places are in pixels.
fn thinned(mut ticks: Vec<Tick>, upright: bool) -> Vec<Tick> {
    ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut end = f64::NEG_INFINITY;
    for (place, label) in &mut ticks {
        let half =
            if upright { 0.55 * NUMBER } else { 0.5 * text_width(label, NUMBER, false) + 4.0 };
        if *place - half < end {
            label.clear();
        } else {
            end = *place + half;
        }
    }
    ticks
}

fn length(points: &[Point]) -> f64 {
    points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(columns: usize, rows: usize, value: impl Fn(f64, f64) -> f64) -> FieldFigure {
        let axis = |label: &str, cells: usize| FieldAxis {
            label: label.to_owned(),
            from: 0.0,
            to: 0.1 * cells as f64,
        };
        let centre = |cell: usize| {
            [(cell % columns) as f64 + 0.5, (cell / columns) as f64 + 0.5].map(|place| 0.1 * place)
        };
        FieldFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            x: axis("x (m)", columns),
            y: axis("height y (m)", rows),
            columns,
            rows,
            values: (0..columns * rows)
                .map(|cell| {
                    let [x, y] = centre(cell);
                    value(x, y)
                })
                .collect(),
            label: "velocity v₂ (m/s)".to_owned(),
            is_signed: true,
            limit: None,
            scale: None,
            curves: None,
            outlines: Vec::new(),
            plastic: Vec::new(),
            marks: Vec::new(),
        }
    }

    fn mark(x: f64, y: f64, name: &str, kind: FieldMarkKind) -> FieldMark {
        FieldMark { at: [x, y], name: name.to_owned(), kind }
    }

    fn texts(figure: &FieldFigure) -> Vec<String> {
        let picture = figure.picture(Format::Png).unwrap();
        picture.texts().map(|text| text.content.clone()).collect()
    }

    fn says(figure: &FieldFigure, words: &str) -> bool {
        texts(figure).iter().any(|text| text.contains(words))
    }

    /// Draws in both formats and checks what holds for every figure.
    fn check(figure: &FieldFigure) {
        for format in [Format::Png, Format::Svg] {
            figure.picture(format).unwrap().assert_texts_are_apart();
        }
        let png = figure.draw(Format::Png).unwrap();
        assert_eq!(crate::tests::png_size(&png)[0], 1600);
        let svg = String::from_utf8(figure.draw(Format::Svg).unwrap()).unwrap();
        assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
        assert!(!svg.contains("-1000000,"));
    }

    fn arranged(figure: &FieldFigure) -> (Scale, Arrangement) {
        let scale = Scale::of(figure);
        let arrangement = figure.arrange(&scale, Format::Png);
        (scale, arrangement)
    }

    /// The colours of a finished picture.
    struct Drawn {
        width: usize,
        pixels: Vec<u8>,
        frame: Rectangle,
    }

    impl Drawn {
        fn new(figure: &FieldFigure) -> Self {
            let (width, pixels) = crate::tests::pixels(&figure.draw(Format::Png).unwrap());
            Self { width, pixels, frame: arranged(figure).1.layout.frame }
        }

        fn pixel(&self, x: f64, y: f64) -> [u8; 3] {
            let start = 3 * (y as usize * self.width + x as usize);
            [0, 1, 2].map(|channel| self.pixels[start + channel])
        }

        /// The colour at shares of the frame, from its lower left corner.
        fn at(&self, right: f64, up: f64) -> [u8; 3] {
            let frame = self.frame;
            self.pixel(frame.left + right * frame.width(), frame.bottom - up * frame.height())
        }

        fn count(&self, chosen: impl Fn([u8; 3]) -> bool) -> usize {
            let Rectangle { left, top, right, bottom } = self.frame;
            let rows = top as usize + 3..bottom as usize - 3;
            rows.flat_map(|y| (left as usize + 3..right as usize - 3).map(move |x| (x, y)))
                .filter(|&(x, y)| chosen(self.pixel(x as f64, y as f64)))
                .count()
        }
    }

    const fn channels(RGBColor(red, green, blue): Colour) -> [u8; 3] {
        [red, green, blue]
    }

    #[test]
    fn cells_lie_where_the_axes_say_and_have_their_colours() {
        let mut figure = figure(10, 8, |_, _| 0.0);
        figure.is_signed = false;
        figure.values[10 + 2] = 4.0;
        figure.values[7 * 10 + 9] = 2.0;
        figure.values[50] = f64::NAN;
        let scale = Scale::of(&figure);
        let drawn = Drawn::new(&figure);
        assert_eq!(drawn.at(0.25, 1.5 / 8.0), channels(scale.colour(SHADES)));
        assert_eq!(drawn.at(0.95, 7.5 / 8.0), channels(scale.colour(SHADES / 2)));
        assert_eq!(drawn.at(0.55, 0.55), channels(scale.colour(0)));
        // The cell without a number shows its ground between the lines over it.
        let unknown = drawn.count(|colour| colour == channels(UNKNOWN_GROUND));
        let cell = drawn.frame.width() * drawn.frame.height() / 80.0;
        assert!(unknown as f64 > 0.5 * cell && (unknown as f64) < cell, "{unknown}");
        assert!(says(&figure, "not a finite number (1.2 % of the cells)"));

        // Negative values in their own colours, where the axes run downwards.
        figure.is_signed = true;
        figure.values[10 + 2] = -4.0;
        (figure.y.from, figure.y.to) = (figure.y.to, figure.y.from);
        let drawn = Drawn::new(&figure);
        assert_eq!(drawn.at(0.25, 1.5 / 8.0), NEGATIVE[5].map(|part| part as u8));
    }

    #[test]
    fn the_domain_keeps_its_shape() {
        for (columns, rows) in [(40, 40), (100, 30), (20, 90), (150, 15), (7, 5)] {
            let figure = figure(columns, rows, |x, y| x - y);
            let layout = arranged(&figure).1.layout;
            let ratio = layout.frame.width() / layout.frame.height();
            let expected = columns as f64 / rows as f64;
            assert!((ratio / expected - 1.0).abs() < 0.02, "{ratio} {expected}");
            assert!(!says(&figure, "stretched"));
            check(&figure);
        }
        assert_eq!(
            crate::tests::png_size(&figure(40, 40, |x, _| x).draw(Format::Png).unwrap())[1],
            1100
        );
        assert!(says(&figure(900, 1, |x, _| x), "height y (m), stretched ×"));
        // A short axis says at least where it ends.
        assert!(texts(&figure(900, 4, |x, _| x)).contains(&"0.4".to_owned()));
        assert!(says(&figure(1, 900, |_, y| y), "x (m), stretched ×"));
    }

    #[test]
    fn a_single_cell_among_many_is_not_lost() {
        let mut figure = figure(3000, 2500, |_, _| 0.0);
        figure.values[1701 * 3000 + 1234] = -7.0;
        figure.values[1700 * 3000 + 1234] = 1.0;
        let darkest = channels(Scale::of(&figure).colour(-SHADES));
        let drawn = Drawn::new(&figure);
        let near = (-4..=4).flat_map(|x| (-4..=4).map(move |y| (f64::from(x), f64::from(y))));
        let found = near
            .filter(|(x, y)| drawn.at((1234.5 + x) / 3000.0, (1701.5 + y) / 2500.0) == darkest)
            .count();
        assert!(found > 0);
        let svg = String::from_utf8(figure.draw(Format::Svg).unwrap()).unwrap();
        assert!(svg.matches("fill=\"#072158\"").count() >= 2);
    }

    #[test]
    fn borders_are_drawn_unless_they_would_cover_the_field() {
        let mut figure = figure(100, 80, |_, _| 1.0);
        figure.is_signed = false;
        figure.outlines = (0..8000).map(|cell| u16::from(cell % 100 >= 50)).collect();
        let drawn = Drawn::new(&figure);
        assert_eq!(drawn.at(0.5, 0.3), channels(INK));
        assert_eq!(drawn.at(0.25, 0.3), channels(Scale::of(&figure).colour(SHADES)));
        assert!(says(&figure, "border between materials"));
        check(&figure);
        figure.outlines.fill(3);
        assert!(!says(&figure, "border"));
        figure.outlines = (0..8000).map(|cell| (cell * 7919 % 13) as u16).collect();
        assert!(says(&figure, "borders between materials not drawn"));
        check(&figure);
    }

    #[test]
    fn every_yielded_cell_is_near_a_dot() {
        for size in [12, 400] {
            let mut figure = figure(size, size, |_, _| 0.0);
            figure.plastic = vec![false; size * size];
            assert!(!says(&figure, "yielded"));
            figure.plastic[(size / 3) * size + size / 2] = true;
            let drawn = Drawn::new(&figure);
            let half = 0.5 / size as f64;
            let [x, y] = [size / 2, size / 3].map(|index| index as f64 / size as f64 + half);
            assert_eq!(drawn.at(x, y), channels(INK));
            assert!((4..40).contains(&drawn.count(|colour| colour == channels(INK))));
            assert!(says(&figure, "yielded"));
            figure.plastic.fill(true);
            assert!(Drawn::new(&figure).count(|colour| colour == channels(INK)) > 500);
            check(&figure);
        }
    }

    #[test]
    fn colours_end_at_the_limit_and_say_so() {
        let mut figure = figure(60, 40, |x, _| x - 3.0);
        figure.limit = Some(1.5);
        for words in ["≥ 1.5", "≤ −1.5", "clipped at ±1.5", "50.0 %"] {
            assert!(says(&figure, words), "{words}: {:?}", texts(&figure));
        }
        assert_eq!(Drawn::new(&figure).at(0.9, 0.5), POSITIVE[5].map(|part| part as u8));
        check(&figure);
        figure.limit = Some(1e9);
        assert!(!says(&figure, "clipped"));
        assert_eq!(Scale::of(&figure).end, 2.95);
        figure.values.iter_mut().for_each(|value| *value = value.abs());
        (figure.is_signed, figure.limit) = (false, Some(0.7));
        assert!(says(&figure, "≥ 0.7") && !says(&figure, "≤") && says(&figure, "clipped at 0.7"));
        check(&figure);
    }

    #[test]
    fn a_fixed_scale_gives_all_fields_the_same_colours_and_places() {
        let fixed = |is_signed: bool, value: &dyn Fn(f64) -> f64| {
            let mut figure = figure(60, 40, |x, _| value(x));
            figure.values[0] = 0.8;
            (figure.is_signed, figure.scale, figure.limit) = (is_signed, Some(2.0), Some(0.1));
            figure.plastic = figure.values.iter().map(|value| *value > 1.0).collect();
            figure
        };
        let values: [&dyn Fn(f64) -> f64; 5] =
            [&|_| 0.0, &|x| x, &|x| -0.3 * x, &|_| f64::NAN, &|x| (40.0 * x).sin()];
        for is_signed in [false, true] {
            let first = arranged(&fixed(is_signed, values[0]));
            for value in values {
                let figure = fixed(is_signed, value);
                let (scale, arrangement) = arranged(&figure);
                assert_eq!(scale.end, 2.0);
                let own = &arrangement.layout;
                assert_eq!(own.frame, first.1.layout.frame);
                assert_eq!(own.bar, first.1.layout.bar);
                assert_eq!(own.height, first.1.layout.height);
                assert_eq!(
                    channels(scale.colour(scale.step(0.8))),
                    Drawn::new(&figure).at(0.5 / 60.0, 0.5 / 40.0)
                );
                assert!(says(&figure, "≥ 2") && !says(&figure, "everywhere"));
                assert_eq!(says(&figure, "≤ −2"), is_signed);
                check(&figure);
            }
        }
        assert!(says(&fixed(true, &|x| x), "beyond ±2 (66.7 %)"));
        assert!(says(&fixed(true, &|_| 0.0), "beyond ±2 (0 %)"));
        // Without a sign, negative values are told of and not shown as positive ones.
        assert!(says(&fixed(false, &|x| -0.3 * x), "≤ 0"));
        assert!(says(&fixed(false, &|x| -0.3 * x), "beyond 2 (>99.9 %)"));
    }

    #[test]
    fn lines_asked_for_carry_their_numbers() {
        let mut wave = figure(120, 80, |x, y| 10.0 * (0.6 * x).sin() * (0.5 * y).cos());
        wave.curves = Some(vec![-7.5, -2.5, 0.0, 5.0, 5.0, f64::NAN, f64::INFINITY, 77.0]);
        let said = texts(&wave);
        let number = |words: &str| said.iter().filter(|text| *text == words).count();
        for words in ["−7.5", "−2.5"] {
            assert!(number(words) >= 1, "{words} {said:?}");
        }
        assert!(says(&wave, "equal value, as numbered") && says(&wave, "equal negative value"));
        assert!(!says(&wave, "of the scale") && !says(&wave, "77"));
        check(&wave);
        // Crowded with marks and lines.
        wave.marks = (0..80)
            .map(|index| {
                let place = f64::from(index);
                mark(0.15 * place, 4.0 + 3.0 * place.sin(), "name", FieldMarkKind::Receiver)
            })
            .collect();
        wave.curves = Some((-40..40).map(|level| 0.25 * f64::from(level)).collect());
        check(&wave);
        // A quantity without a sign has lines only where they are asked for.
        let mut hill = figure(90, 90, |x, y| 9.0 * (-0.1 * (x - 4.0).hypot(y - 4.0)).exp());
        hill.is_signed = false;
        assert!(matches!(arranged(&hill).1.levels, Levels::None));
        hill.curves = Some(vec![8.0, 7.0]);
        assert!(matches!(arranged(&hill).1.levels, Levels::Lines(_)));
        assert!(!says(&hill, "negative"));
        check(&hill);
        for curves in [Vec::new(), vec![0.0], vec![1e-320, -1e300]] {
            hill.curves = Some(curves);
            check(&hill);
        }
        let mut noise =
            figure(400, 400, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract().abs());
        (noise.is_signed, noise.curves) = (false, Some(vec![0.5]));
        assert!(says(&noise, "not drawn: too many"));
        check(&noise);
        let mut zero = figure(20, 10, |_, _| 0.0);
        zero.curves = Some(vec![0.0, 1.0]);
        check(&zero);
    }

    #[test]
    fn constant_fields_say_so() {
        for is_signed in [false, true] {
            for (value, words) in [
                (0.0, "velocity v₂ (m/s): zero everywhere"),
                (-0.0, "zero everywhere"),
                (3.2, "velocity v₂ (m/s): 3.2 everywhere"),
                (f64::NAN, "not a finite number (100 % of the cells)"),
            ] {
                let mut figure = figure(30, 20, |_, _| value);
                figure.is_signed = is_signed;
                assert!(says(&figure, words), "{value} {:?}", texts(&figure));
                check(&figure);
            }
        }
        let mut figure = figure(30, 20, |_, _| 0.0);
        figure.values[0] = f64::INFINITY;
        assert!(says(&figure, "zero wherever it is finite"));
        check(&figure);
    }

    #[test]
    fn the_sign_shows_in_grey() {
        let wave = figure(80, 60, |x, _| x.sin());
        assert!(matches!(arranged(&wave).1.levels, Levels::Lines(_)));
        assert!(says(&wave, "−¼ and −½ of the scale"));
        // Neither a constant nor noise has lines to follow.
        let constant = figure(30, 20, |_, _| -1.0);
        let noise = figure(400, 400, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract());
        for figure in [constant, noise] {
            assert!(matches!(arranged(&figure).1.levels, Levels::Ruled));
            assert!(says(&figure, "below −¼ of the scale"));
            check(&figure);
        }
        assert!(matches!(arranged(&figure(30, 20, |_, _| 1.0)).1.levels, Levels::None));
    }

    #[test]
    fn negative_values_are_shown_whatever_is_said_about_signs() {
        let mut figure = figure(20, 10, |x, _| 1.0 + x);
        figure.is_signed = false;
        figure.values[3] = -1e-14;
        assert!(!Scale::of(&figure).is_signed);
        check(&figure);
        figure.values[3] = -0.1;
        assert!(Scale::of(&figure).is_signed);
        check(&figure);
    }

    #[test]
    fn shades_grow_darker_evenly_and_alike_on_both_sides() {
        for is_signed in [false, true] {
            let scale = Scale {
                is_signed,
                is_fixed: false,
                end: 1.0,
                extreme: 1.0,
                clipped: 0,
                open: [false; 2],
                unknown: 0,
            };
            let light = |step: i16| crate::verdict_map::luminance(scale.colour(step));
            for step in 1..=SHADES {
                let fall = light(step - 1) - light(step);
                assert!(fall > 0.5 && fall < 4.0, "{step} {fall}");
                if is_signed {
                    assert!(light(1 - step) - light(-step) > 0.5);
                    assert!((light(step) - light(-step)).abs() < 2.0, "{step}");
                }
            }
        }
    }

    #[test]
    fn any_values_on_any_grid_are_drawn() {
        let values = [1e-3, f64::MAX, f64::MIN, 9e299, 5e-324, f64::NAN, f64::NEG_INFINITY, -1e12];
        for (columns, rows) in [(1, 1), (1, 2), (2, 1), (3, 40), (1700, 2), (2, 1700)] {
            for kinds in [0, 1, 4, 6, 8] {
                let mut figure = figure(columns, rows, |_, _| 5e-324);
                for (cell, value) in
                    figure.values.iter_mut().enumerate().skip(usize::from(kinds < 4))
                {
                    *value = values[cell % kinds.max(1)];
                }
                figure.plastic = (0..columns * rows).map(|cell| cell % 3 == 0).collect();
                figure.outlines = (0..columns * rows).map(|cell| (cell / 7) as u16).collect();
                figure.marks = vec![mark(0.05, 0.05, "here", FieldMarkKind::Source)];
                for format in [Format::Png, Format::Svg] {
                    figure.picture(format).unwrap().assert_texts_are_apart();
                }
                if kinds % 4 == 0 {
                    check(&figure);
                }
            }
        }
    }

    #[test]
    fn any_extent_is_drawn() {
        for (from, to) in
            [(0.0, 1e-300), (-1e300, 1e300), (5.0, -2.0), (1e9, 1e9 + 1.0), (0.0, 1e5), (0.0, 1e-9)]
        {
            let mut figure = figure(30, 20, |x, y| x - y);
            (figure.x.from, figure.x.to) = (from, to);
            check(&figure);
            std::mem::swap(&mut figure.x, &mut figure.y);
            figure.marks = vec![mark(1.0, from, "edge", FieldMarkKind::Receiver)];
            check(&figure);
        }
    }

    #[test]
    fn marks_may_hold_anything_and_crowd() {
        use FieldMarkKind::{Receiver, Source};
        let mut figure = figure(60, 40, |x, y| (x * y).sin());
        figure.marks = (0..60)
            .map(|index| mark(0.1 * f64::from(index), 2.0, &format!("R{index}"), Receiver))
            .collect();
        check(&figure);
        figure.marks = vec![mark(3.0, 2.0, "a long name of a receiver", Receiver); 90];
        assert!(says(&figure, "names left out for want of room"));
        check(&figure);
        let long = "one name ".repeat(100);
        figure.marks = vec![
            mark(0.0, 0.0, &long, Source),
            mark(6.0, 4.0, "corner", Receiver),
            mark(f64::NAN, 1.0, "nowhere", Receiver),
            mark(1.0, f64::INFINITY, "far", Receiver),
            mark(7.0, 1.0, "outside", Receiver),
            mark(2.0, 2.0, "", Source),
        ];
        assert!(says(&figure, "receiver (3 of 4 outside the picture)"));
        assert!(says(&figure, "corner") && !says(&figure, "nowhere"));
        check(&figure);
        let mut only = self::figure(60, 40, |_, _| 0.0);
        only.marks = vec![mark(3.0, 2.0, "", Source)];
        let drawn = Drawn::new(&only);
        assert_eq!(drawn.at(0.5, 0.5), channels(INK));
    }

    #[test]
    fn long_labels_stay_on_the_sheet() {
        let long = "a rather long description of what is meant ".repeat(40);
        for (columns, rows) in [(60, 40), (900, 10), (10, 900)] {
            let mut figure = figure(columns, rows, |x, y| (x + y).sin());
            figure.limit = Some(0.5);
            let empty = |figure: &mut FieldFigure, words: &str| {
                let FieldFigure { title, subtitle, label, x, y, .. } = figure;
                for text in [title, subtitle, label, &mut x.label, &mut y.label] {
                    words.clone_into(text);
                }
            };
            empty(&mut figure, &long);
            check(&figure);
            empty(&mut figure, "");
            check(&figure);
        }
    }

    #[test]
    fn files_stay_small_and_equal_figures_give_equal_bytes() {
        let mut noise = figure(1000, 1000, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract());
        noise.outlines = (0..1_000_000).map(|cell| (cell % 1000 / 10) as u16).collect();
        noise.plastic = noise.values.iter().map(|value| *value > 0.0).collect();
        for (format, most) in [(Format::Png, 2_500_000), (Format::Svg, 4_500_000)] {
            let bytes = noise.draw(format).unwrap();
            assert!(bytes.len() < most, "{format:?}: {}", bytes.len());
            assert_eq!(bytes, noise.draw(format).unwrap());
        }
        let wave = figure(1000, 1000, |x, y| (0.9 * (x - 50.0).hypot(y - 40.0)).sin());
        assert!(wave.draw(Format::Svg).unwrap().len() < 3_000_000);
    }

    #[test]
    fn wrong_input_is_refused() {
        let refused = |change: &dyn Fn(&mut FieldFigure)| {
            let mut figure = figure(4, 3, |x, y| x - y);
            change(&mut figure);
            figure.draw(Format::Svg).unwrap_err().to_string()
        };
        assert!(
            refused(&|figure| {
                figure.values.pop();
            })
            .contains("values has 11 values for 4 × 3 cells")
        );
        assert!(refused(&|figure| figure.outlines = vec![0; 13]).contains("outlines has 13"));
        assert!(refused(&|figure| figure.plastic = vec![true]).contains("plastic has 1"));
        assert!(refused(&|figure| figure.columns = usize::MAX).contains("12 values for"));
        assert!(refused(&|figure| figure.rows = 0).contains("has no cells"));
        assert!(refused(&|figure| figure.x.to = f64::NAN).contains("not a finite number"));
        assert!(refused(&|figure| figure.x.to = figure.x.from).contains("does not extend"));
        assert!(
            refused(&|figure| (figure.y.from, figure.y.to) = (-1e308, 1e308))
                .contains("does not extend")
        );
        for limit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refused(&|figure| figure.limit = Some(limit)).contains("limit of the colours"));
            assert!(refused(&|figure| figure.scale = Some(limit)).contains("limit of the colours"));
        }
    }
}
