//! Verdicts over two parameters of a case.

use plotters::style::RGBColor;

use crate::page::{self, Entry, Legend, MARGIN, NAME, NUMBER, RULE};
use crate::picture::{Anchor, Colour, INK, Picture, Point, Rectangle, Text, WHITE, clip, dashes};
use crate::scale::{self, Tick};
use crate::{FigureError, Format, contour};

/// An axis of a map: a uniform grid of at least one point, in either order.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name, symbol and unit.
    pub label: String,
    /// The values at the grid points, in the unit of the label.
    pub values: Vec<f64>,
}

/// How the cells of a category are filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Nearly white.
    WellPosed,
    /// By the cell's level; plain orange without. A second and further category of this look is
    /// hatched, each in its own direction.
    IllPosed,
    /// Nearly black with white cross-hatching.
    UnboundedAtFiniteWaveNumber,
    /// Green with upright hatching.
    Marginal,
    /// Grey with dense falling hatching.
    Indeterminate,
    /// Pale grey with sparse rising hatching.
    OutsideModel,
}

/// A kind of answer that a cell may hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Category {
    /// The words of the legend.
    pub label: String,
    /// The fill.
    pub look: Look,
}

/// A line drawn over the map, such as a bound in closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The words of the legend. Curves of the same label look alike and are listed once.
    pub label: String,
    /// Points in the units of the axes; a point that is not finite interrupts the line.
    pub points: Vec<[f64; 2]>,
}

/// Verdict regions over two parameters, with growth levels where the verdict is ill-posed.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictMap {
    /// Headline.
    pub title: String,
    /// What is held fixed.
    pub subtitle: String,
    /// Parameter drawn to the right.
    pub x: Axis,
    /// Parameter drawn upwards.
    pub y: Axis,
    /// The kinds of answer; those that occur are listed with their share of the area.
    pub categories: Vec<Category>,
    /// Index into `categories` for each cell; x runs fastest.
    pub category: Vec<u8>,
    /// Growth level for each cell, positive, in the unit of `level_label`; not-a-number where
    /// there is none. x runs fastest. Used in cells that look [`Look::IllPosed`].
    pub level: Vec<f64>,
    /// Name and unit of the level.
    pub level_label: String,
    /// Lines on top.
    pub curves: Vec<Curve>,
}

/// Steps of the colour map. Few enough that equal neighbours merge, too many to be seen.
const SHADES: usize = 128;

/// Lightness falls evenly from one stop to the next.
const STOPS: [[f64; 3]; 6] = [
    [253.0, 211.0, 150.0],
    [250.0, 164.0, 91.0],
    [233.0, 104.0, 63.0],
    [192.0, 46.0, 62.0],
    [122.0, 18.0, 66.0],
    [58.0, 6.0, 52.0],
];

/// For a level without bound; below the darkest shade.
const INFINITE: Colour = RGBColor(14, 2, 22);
/// For a cell without level among others that have one.
pub(crate) const LEVEL_MISSING: Colour = RGBColor(196, 176, 180);
/// For all ill-posed cells of a map without levels.
const NO_LEVELS: Colour = RGBColor(236, 130, 80);

/// A colour of the colour map at a share of its length.
pub(crate) fn shade(share: f64) -> Colour {
    let step = (share.clamp(0.0, 1.0) * (SHADES - 1) as f64).round() / (SHADES - 1) as f64;
    let place = step * (STOPS.len() - 1) as f64;
    let below = (place as usize).min(STOPS.len() - 2);
    let mix = |channel: usize| {
        let (from, to) = (STOPS[below][channel], STOPS[below + 1][channel]);
        (from + (place - below as f64) * (to - from)).round() as u8
    };
    RGBColor(mix(0), mix(1), mix(2))
}

/// How bright a colour appears, from 0 to 255 (Rec. 601).
pub(crate) fn luminance(RGBColor(red, green, blue): Colour) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

/// A set of parallel lines over the cells of a category.
#[derive(Clone, Copy)]
struct Hatch {
    /// Direction of the lines, in pixels.
    along: [f64; 2],
    /// Distance between lines in pixels.
    spacing: f64,
    width: f64,
    colour: Colour,
}

const RISING: [f64; 2] = [1.0, -1.0];
const FALLING: [f64; 2] = [1.0, 1.0];
const LEVEL: [f64; 2] = [1.0, 0.0];
const UPRIGHT: [f64; 2] = [0.0, 1.0];

/// The fill of a category without the levels: a ground, and lines on it. `variant` counts the
/// categories before it that look the same.
fn fill(look: Look, variant: usize) -> (Colour, Vec<Hatch>) {
    let hatch = |along, spacing, width, grey| Hatch {
        along,
        spacing,
        width,
        colour: RGBColor(grey, grey, grey),
    };
    match look {
        Look::WellPosed => (RGBColor(243, 248, 253), vec![]),
        Look::IllPosed => {
            // A light line beside a dark one shows on every shade.
            let along = [&[][..], &[RISING], &[FALLING], &[LEVEL], &[UPRIGHT], &[RISING, FALLING]];
            let pair =
                |&along: &[f64; 2]| [hatch(along, 30.0, 3.4, 255), hatch(along, 30.0, 1.4, 20)];
            (NO_LEVELS, along[variant % along.len()].iter().flat_map(pair).collect())
        }
        Look::UnboundedAtFiniteWaveNumber => {
            let ground = RGBColor(38, 38, 58);
            (ground, [RISING, FALLING].map(|along| hatch(along, 18.0, 1.6, 235)).to_vec())
        }
        Look::Marginal => (RGBColor(20, 160, 130), vec![hatch(UPRIGHT, 9.0, 1.8, 10)]),
        Look::Indeterminate => (RGBColor(150, 150, 155), vec![hatch(FALLING, 9.0, 1.8, 50)]),
        Look::OutsideModel => (RGBColor(222, 222, 222), vec![hatch(RISING, 24.0, 2.0, 150)]),
    }
}

/// Dashes and colours of the curves, in the order of their labels.
const CURVES: [(&[f64], Colour); 4] = [
    (&[22.0, 11.0], RGBColor(10, 10, 10)),
    (&[5.0, 8.0], RGBColor(0, 60, 150)),
    (&[34.0, 9.0, 5.0, 9.0], RGBColor(90, 0, 100)),
    (&[12.0, 6.0], RGBColor(0, 85, 65)),
];

fn draw_curve(picture: &mut Picture, points: &[Point], index: usize) {
    let (pattern, colour) = CURVES[index % CURVES.len()];
    // A white rim keeps the dashes readable on dark shades; the gaps show the cells below.
    for dash in dashes(points, pattern) {
        picture.line(lengthened(&dash, 2.0), 8.5, WHITE);
        picture.line(dash, 4.5, colour);
    }
}

/// A line made longer at both ends.
fn lengthened(line: &[Point], by: f64) -> Vec<Point> {
    let mut line = line.to_vec();
    let beyond = |end: Point, inner: Point| {
        let (dx, dy) = (end[0] - inner[0], end[1] - inner[1]);
        let scale = by / dx.hypot(dy).max(1e-9);
        [end[0] + scale * dx, end[1] + scale * dy]
    };
    if let [first, second, ..] = line[..] {
        line[0] = beyond(first, second);
    }
    if let [.., before, last] = line[..] {
        let end = line.len() - 1;
        line[end] = beyond(last, before);
    }
    line
}

/// The extent of an axis: whole cells around its points.
struct Extent {
    low: f64,
    high: f64,
    descending: bool,
}

impl Extent {
    fn of(axis: &Axis) -> Result<Self, FigureError> {
        let refuse = |problem| FigureError::Axis { label: axis.label.clone(), problem };
        let values = &axis.values;
        let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
            return Err(refuse("has no points"));
        };
        if values.iter().any(|value| !value.is_finite()) {
            return Err(refuse("has a point that is not a finite number"));
        }
        if values.len() == 1 {
            // A single cell has no natural width.
            let half = 0.5 * first.abs().max(1.0);
            return Ok(Self { low: first - half, high: first + half, descending: false });
        }
        let step = (last - first) / (values.len() - 1) as f64;
        if !(step.is_finite() && step != 0.0) {
            return Err(refuse("does not extend from a first to a different last value"));
        }
        let uniform = |(index, value): (usize, &f64)| {
            (value - (first + step * index as f64)).abs() <= 1e-3 * step.abs()
        };
        if !values.iter().enumerate().all(uniform) {
            return Err(refuse("is not uniformly spaced"));
        }
        let half = 0.5 * step.abs();
        let (low, high) = (first.min(last) - half, first.max(last) + half);
        Ok(Self { low, high, descending: step < 0.0 })
    }

    /// The share of the axis below a value.
    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn ticks(&self, axis: &Axis, length: f64, upright: bool) -> Vec<Tick> {
        if let [only] = axis.values[..] {
            return vec![(only, scale::plain(only))];
        }
        let degrees = axis.label.contains('°');
        page::spaced(length, upright, |most| scale::ticks(self.low, self.high, most, degrees))
    }
}

/// The map as it is drawn: both axes ascending, no more cells than pixels.
struct Raster {
    columns: usize,
    rows: usize,
    category: Vec<u8>,
    level: Vec<f64>,
}

impl Raster {
    fn at(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }
}

/// The range of the colour map, in log₁₀ of the level.
struct Range {
    low: f64,
    high: f64,
    /// Whether finite levels lie below `low` or above `high`.
    beyond: [bool; 2],
    /// Whether some level is infinite.
    infinite: bool,
}

impl Range {
    /// The range of the positive levels. A few cells far from all others, such as those that
    /// touch a singular line, do not take the colours from the rest.
    fn of(levels: impl Iterator<Item = f64>) -> Option<Self> {
        let mut infinite = false;
        let mut logs: Vec<f64> = Vec::new();
        for level in levels.filter(|level| *level > 0.0) {
            if level.is_finite() {
                logs.push(level.log10());
            } else {
                infinite = true;
            }
        }
        logs.sort_by(f64::total_cmp);
        let (Some(&least), Some(&most)) = (logs.first(), logs.last()) else {
            return infinite.then_some(Self { low: 0.0, high: 1.0, beyond: [false; 2], infinite });
        };
        let aside = logs.len() / 100;
        let (inner_low, inner_high) = (logs[aside], logs[logs.len() - 1 - aside]);
        let inner = (inner_high - inner_low).max(0.3);
        let trim = |outer: f64, bound: f64| if outer > inner { bound } else { f64::NAN };
        let low = trim(inner_low - least, inner_low).max(least);
        let high = trim(most - inner_high, inner_high).min(most);
        let beyond = [low > least, high < most];
        // Equal levels are given a decade, so that the bar has ticks.
        let (low, high) = if high - low < 1e-6 { (low - 0.5, high + 0.5) } else { (low, high) };
        Some(Self { low, high, beyond, infinite })
    }

    fn share(&self, level: f64) -> f64 {
        (level.log10() - self.low) / (self.high - self.low)
    }
}

impl VerdictMap {
    /// Draws the map into the bytes of a file.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture()?.render(format)
    }

    fn picture(&self) -> Result<Picture, FigureError> {
        let (x, y) = (Extent::of(&self.x)?, Extent::of(&self.y)?);
        self.check_cells()?;
        let range = Range::of(self.levels().map(|(_, level)| level));
        let legend = Legend::new(self.legend(range.as_ref()), page::WIDTH - 2.0 * MARGIN);

        // The heading's height is known once it is written; the sheet grows with the legend.
        let top =
            page::heading(&mut Picture::new(page::WIDTH as u32, 1), &self.title, &self.subtitle);
        let below = page::BOTTOM_AXIS + 22.0 + legend.height() + MARGIN - 12.0;
        let height = page::HEIGHT.max(top + 480.0 + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);

        let bottom = height - below;
        let bar_ticks = match &range {
            Some(range) => {
                let most = ((bottom - top) / 60.0) as usize;
                scale::log_ticks(range.low, range.high, most)
            }
            None => Vec::new(),
        };
        let y_ticks = y.ticks(&self.y, bottom - top, true);
        let bar_room = range.as_ref().map_or(0.0, |_| {
            BAR_GAP + BAR + 18.0 + page::widest(&bar_ticks).max(NUMBER) + 1.5 * NAME
        });
        let frame = Rectangle {
            left: MARGIN + page::left_axis_width(&y_ticks),
            top,
            right: page::WIDTH - MARGIN - bar_room,
            bottom,
        };
        let x_ticks = x.ticks(&self.x, frame.width(), false);
        let place_x = |value: f64| frame.left + x.share(value) * frame.width();
        let place_y = |value: f64| frame.bottom - y.share(value) * frame.height();

        let raster = self.raster(frame, x.descending, y.descending);
        self.draw_cells(&mut picture, frame, &raster, range.as_ref());
        self.draw_hatches(&mut picture, frame, &raster);
        if let Some(range) = &range {
            self.draw_contours(&mut picture, frame, &raster, range, &bar_ticks);
        }
        draw_borders(&mut picture, frame, &raster);
        for (index, curve) in self.curves.iter().enumerate() {
            let points: Vec<Point> =
                curve.points.iter().map(|&[x, y]| [place_x(x), place_y(y)]).collect();
            for part in clip(&points, frame) {
                draw_curve(&mut picture, &part, self.first_of_label(index));
            }
        }
        picture.frame(frame, RULE, INK);

        let placed = |ticks: Vec<Tick>, place: &dyn Fn(f64) -> f64| -> Vec<Tick> {
            ticks.into_iter().map(|(value, label)| (place(value), label)).collect()
        };
        page::bottom_axis(&mut picture, frame, &placed(x_ticks, &place_x), &self.x.label);
        page::left_axis(&mut picture, frame, &placed(y_ticks, &place_y), &self.y.label);
        if let Some(range) = &range {
            self.draw_bar(&mut picture, frame, range, &bar_ticks);
        }
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS + 22.0);
        Ok(picture)
    }

    fn check_cells(&self) -> Result<(), FigureError> {
        let (columns, rows) = (self.x.values.len(), self.y.values.len());
        for (field, found) in [("category", self.category.len()), ("level", self.level.len())] {
            if found != columns * rows {
                return Err(FigureError::CellCount { field, found, columns, rows });
            }
        }
        let known = self.categories.len();
        match self.category.iter().find(|&&category| usize::from(category) >= known) {
            Some(&found) => Err(FigureError::UnknownCategory { found, known }),
            None => Ok(()),
        }
    }

    /// The cells coloured by level, each with its level.
    fn levels(&self) -> impl Iterator<Item = (usize, f64)> {
        let ill_posed =
            |category: u8| self.categories[usize::from(category)].look == Look::IllPosed;
        let cells = self.category.iter().zip(&self.level).enumerate();
        cells
            .filter(move |(_, (category, _))| ill_posed(**category))
            .map(|(cell, (_, l))| (cell, *l))
    }

    /// Number of categories before this one that look the same.
    fn variant(&self, category: usize) -> usize {
        let look = self.categories[category].look;
        self.categories[..category].iter().filter(|other| other.look == look).count()
    }

    /// The curve whose look this one shares, counted without repetitions.
    fn first_of_label(&self, index: usize) -> usize {
        let mut labels: Vec<&str> = Vec::new();
        for curve in &self.curves[..=index] {
            if !labels.contains(&curve.label.as_str()) {
                labels.push(&curve.label);
            }
        }
        let label = &self.curves[index].label;
        labels.iter().position(|other| other == label).unwrap_or(0)
    }

    fn legend(&self, range: Option<&Range>) -> Vec<Entry> {
        let mut counts = vec![0_usize; self.categories.len()];
        self.category.iter().for_each(|&category| counts[usize::from(category)] += 1);
        let cells = self.category.len();
        let mut entries: Vec<Entry> = Vec::new();
        let has_levels = range.is_some();
        for (index, category) in self.categories.iter().enumerate() {
            if counts[index] == 0 {
                continue;
            }
            let (ground, hatches) = fill(category.look, self.variant(index));
            let graded = has_levels && category.look == Look::IllPosed;
            let label = format!("{} ({})", category.label, percent(counts[index], cells));
            entries.push((
                label,
                Box::new(move |picture, area| {
                    if graded {
                        draw_shades(picture, area, true, false);
                    } else {
                        picture.fill(area, ground);
                    }
                    for hatch in &hatches {
                        draw_hatch(picture, area, *hatch, |_| true);
                    }
                    picture.frame(area, 1.5, INK);
                }),
            ));
        }
        if has_levels && self.levels().any(|(_, level)| level.is_nan() || level <= 0.0) {
            entries.push((
                "ill-posed, no level known".to_owned(),
                Box::new(|picture, area| {
                    picture.fill(area, LEVEL_MISSING);
                    picture.frame(area, 1.5, INK);
                }),
            ));
        }
        for (index, curve) in self.curves.iter().enumerate() {
            let look = self.first_of_label(index);
            if self.curves[..index].iter().all(|other| other.label != curve.label) {
                entries.push((
                    curve.label.clone(),
                    Box::new(move |picture, area| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_curve(picture, &[[area.left, y], [area.right, y]], look);
                    }),
                ));
            }
        }
        entries
    }

    fn raster(&self, frame: Rectangle, flip_x: bool, flip_y: bool) -> Raster {
        let (all_columns, all_rows) = (self.x.values.len(), self.y.values.len());
        let columns = all_columns.min(frame.width() as usize);
        let rows = all_rows.min(frame.height() as usize);
        // The cell below the middle of a drawn one.
        let nearest = |index: usize, drawn: usize, all: usize, flip: bool| {
            let cell = (2 * index + 1) * all / (2 * drawn);
            if flip { all - 1 - cell } else { cell }
        };
        let cells = (0..rows).flat_map(|row| {
            let row = nearest(row, rows, all_rows, flip_y) * all_columns;
            (0..columns).map(move |column| row + nearest(column, columns, all_columns, flip_x))
        });
        let (category, level) = cells.map(|cell| (self.category[cell], self.level[cell])).unzip();
        Raster { columns, rows, category, level }
    }

    /// Fills the cells, runs of one colour in a row at once.
    fn draw_cells(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &Raster,
        range: Option<&Range>,
    ) {
        let grounds: Vec<(Colour, bool)> = self
            .categories
            .iter()
            .map(|category| (fill(category.look, 0).0, category.look == Look::IllPosed))
            .collect();
        let colour = |cell: usize| {
            let (ground, ill_posed) = grounds[usize::from(raster.category[cell])];
            match range {
                Some(range) if ill_posed => {
                    let level = raster.level[cell];
                    if level == f64::INFINITY {
                        INFINITE
                    } else if level > 0.0 {
                        shade(range.share(level))
                    } else {
                        LEVEL_MISSING
                    }
                }
                _ => ground,
            }
        };
        let (width, height) = cell_size(frame, raster);
        for row in (0..raster.rows).rev() {
            let mut start = 0;
            while start < raster.columns {
                let ground = colour(raster.at(start, row));
                let run = (start + 1..raster.columns)
                    .find(|&column| colour(raster.at(column, row)) != ground)
                    .unwrap_or(raster.columns);
                // Reaching under the next cells keeps hairlines from showing between cells when
                // a viewer scales the picture.
                let area = Rectangle {
                    left: frame.left + start as f64 * width,
                    top: frame.bottom - (row + 1) as f64 * height,
                    right: (frame.left + run as f64 * width + 2.0).min(frame.right),
                    bottom: (frame.bottom - row as f64 * height + 2.0).min(frame.bottom),
                };
                picture.fill(area, ground);
                start = run;
            }
        }
    }

    fn draw_hatches(&self, picture: &mut Picture, frame: Rectangle, raster: &Raster) {
        let (width, height) = cell_size(frame, raster);
        let category_at = |[x, y]: Point| {
            let column = ((x - frame.left) / width) as usize;
            let row = ((frame.bottom - y) / height) as usize;
            raster.category[raster.at(column.min(raster.columns - 1), row.min(raster.rows - 1))]
        };
        for (index, category) in self.categories.iter().enumerate() {
            let present = raster.category.iter().any(|&other| usize::from(other) == index);
            if !present {
                continue;
            }
            for hatch in fill(category.look, self.variant(index)).1 {
                draw_hatch(picture, frame, hatch, |point| usize::from(category_at(point)) == index);
            }
        }
    }

    /// Draws the lines of equal level at the ticks of the bar. Levels of different categories may
    /// be of different kinds and are not joined.
    fn draw_contours(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &Raster,
        range: &Range,
        ticks: &[Tick],
    ) {
        let (width, height) = cell_size(frame, raster);
        let logs: Vec<f64> = raster.level.iter().map(|level| level.log10()).collect();
        for (index, category) in self.categories.iter().enumerate() {
            if category.look != Look::IllPosed {
                continue;
            }
            let value = |column: usize, row: usize| {
                let cell = raster.at(column, row);
                if usize::from(raster.category[cell]) == index { logs[cell] } else { f64::NAN }
            };
            for (tick, _) in ticks {
                let colour = contour_colour(range, *tick);
                for line in contour::lines(raster.columns, raster.rows, value, *tick) {
                    let place = |[x, y]: Point| {
                        [frame.left + (x + 0.5) * width, frame.bottom - (y + 0.5) * height]
                    };
                    picture.line(line.into_iter().map(place).collect::<Vec<_>>(), 1.6, colour);
                }
            }
        }
    }

    fn draw_bar(&self, picture: &mut Picture, frame: Rectangle, range: &Range, ticks: &[Tick]) {
        let left = frame.right + BAR_GAP;
        let mut bar = Rectangle { left, right: left + BAR, ..frame };
        if range.infinite {
            let cap = Rectangle { bottom: bar.top + 34.0, ..bar };
            picture.fill(cap, INFINITE);
            picture.frame(cap, RULE, INK);
            let at = [cap.right + 14.0, 0.5 * (cap.top + cap.bottom) + 0.36 * NUMBER];
            picture.text(Text::new(at, Anchor::Start, NUMBER, "∞"));
            bar.top = cap.bottom + 0.6 * NUMBER;
        }
        // Arrows say that the colours at the ends stand for all levels beyond.
        let middle = 0.5 * (bar.left + bar.right);
        for (end, beyond) in range.beyond.into_iter().enumerate() {
            if beyond {
                let (share, tip, base) = if end == 0 {
                    (0.0, bar.bottom, bar.bottom - ARROW)
                } else {
                    (1.0, bar.top, bar.top + ARROW)
                };
                let corners = vec![[bar.left, base], [bar.right, base], [middle, tip]];
                picture.polygon(corners.clone(), shade(share));
                picture.line([&corners[..], &corners[..2]].concat(), RULE, INK);
                if end == 0 {
                    bar.bottom = base;
                } else {
                    bar.top = base;
                }
            }
        }
        draw_shades(picture, bar, false, false);
        for (tick, label) in ticks {
            let share = (tick - range.low) / (range.high - range.low);
            let y = bar.bottom - share.clamp(0.0, 1.0) * bar.height();
            picture.line([[bar.left, y], [bar.right, y]], 1.6, contour_colour(range, *tick));
            picture.line([[bar.right, y], [bar.right + 8.0, y]], RULE, INK);
            let at = [bar.right + 14.0, y + 0.36 * NUMBER];
            picture.text(Text::new(at, Anchor::Start, NUMBER, label));
        }
        picture.frame(bar, RULE, INK);
        let (name, size) = page::fit(&self.level_label, NAME, frame.height());
        let at = [page::WIDTH - MARGIN - 0.3 * NAME, 0.5 * (frame.top + frame.bottom)];
        picture.text(Text { upwards: true, ..Text::new(at, Anchor::Middle, size, name) });
    }
}

/// Distance of the colour bar from the map, its width, and the length of its arrows.
pub(crate) const BAR_GAP: f64 = 34.0;
pub(crate) const BAR: f64 = 36.0;
pub(crate) const ARROW: f64 = 30.0;

fn cell_size(frame: Rectangle, raster: &Raster) -> (f64, f64) {
    (frame.width() / raster.columns as f64, frame.height() / raster.rows as f64)
}

fn contour_colour(range: &Range, log: f64) -> Colour {
    colour_on_shade((log - range.low) / (range.high - range.low))
}

/// The colour of lines on a shade.
pub(crate) fn colour_on_shade(share: f64) -> Colour {
    let ground = shade(share);
    if luminance(ground) > 95.0 { RGBColor(70, 25, 20) } else { WHITE }
}

/// Draws the colour map, from its low end on the left or below.
pub(crate) fn draw_shades(picture: &mut Picture, area: Rectangle, lying: bool, dark_is_low: bool) {
    for step in 0..SHADES {
        let [from, to] = [step, step + 1].map(|step| step as f64 / SHADES as f64);
        let part = if lying {
            let left = area.left + from * area.width();
            let right = (area.left + to * area.width() + 2.0).min(area.right);
            Rectangle { left, right, ..area }
        } else {
            let top = (area.bottom - to * area.height() - 2.0).max(area.top);
            Rectangle { top, bottom: area.bottom - from * area.height(), ..area }
        };
        let share = step as f64 / (SHADES - 1) as f64;
        picture.fill(part, shade(if dark_is_low { 1.0 - share } else { share }));
    }
}

/// Draws the lines of a hatch over the part of an area that `covers` selects.
fn draw_hatch(
    picture: &mut Picture,
    area: Rectangle,
    hatch: Hatch,
    covers: impl Fn(Point) -> bool,
) {
    let length = hatch.along[0].hypot(hatch.along[1]);
    let [dx, dy] = hatch.along.map(|part| part / length);
    // Lines are counted by their distance from the corner of the sheet, so that those of one
    // direction continue across separate areas.
    let distance = |[x, y]: Point| (dx * y - dy * x) / hatch.spacing;
    let corners = [
        [area.left, area.top],
        [area.right, area.top],
        [area.left, area.bottom],
        [area.right, area.bottom],
    ];
    let distances = corners.map(distance);
    let first = distances.iter().copied().fold(f64::INFINITY, f64::min).ceil() as i64;
    let last = distances.iter().copied().fold(f64::NEG_INFINITY, f64::max).floor() as i64;
    let reach = f64::from(picture.width + picture.height);
    for count in first..=last {
        let offset = (count as f64) * hatch.spacing;
        let [x, y] = [-dy * offset, dx * offset];
        let whole = [[x - reach * dx, y - reach * dy], [x + reach * dx, y + reach * dy]];
        for part in clip(&whole, area) {
            let (from, to) = (part[0], part[1]);
            let steps = (to[0] - from[0]).hypot(to[1] - from[1]).floor();
            let at = |step: f64| [from[0] + step * dx, from[1] + step * dy];
            for (begin, end) in runs(steps as usize, |step| covers(at(step as f64 + 0.5))) {
                picture.line([at(begin as f64), at(end as f64)], hatch.width, hatch.colour);
            }
        }
    }
}

/// Draws the lines between cells of different categories.
fn draw_borders(picture: &mut Picture, frame: Rectangle, raster: &Raster) {
    let (width, height) = cell_size(frame, raster);
    let category = |column: usize, row: usize| raster.category[raster.at(column, row)];
    let place = |column: usize, row: usize| {
        [frame.left + column as f64 * width, frame.bottom - row as f64 * height]
    };
    // A line leaves the colour of cells one pixel or a few wide visible.
    let thickness = |size: f64| (0.3 * size).clamp(0.7, 2.4);
    for column in 1..raster.columns {
        let differs = |row| category(column - 1, row) != category(column, row);
        for (from, to) in runs(raster.rows, differs) {
            picture.line([place(column, from), place(column, to)], thickness(width), INK);
        }
    }
    for row in 1..raster.rows {
        let differs = |column| category(column, row - 1) != category(column, row);
        for (from, to) in runs(raster.columns, differs) {
            picture.line([place(from, row), place(to, row)], thickness(height), INK);
        }
    }
}

/// The runs of indices below `count` that are selected, each from its first to behind its last.
pub(crate) fn runs(count: usize, selected: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    let mut start = None;
    for index in 0..=count {
        match start {
            None if index < count && selected(index) => start = Some(index),
            Some(first) if index == count || !selected(index) => {
                runs.push((first, index));
                start = None;
            }
            _ => {}
        }
    }
    runs
}

/// A share of the area in words that never claim all or nothing wrongly.
pub(crate) fn percent(part: usize, whole: usize) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    if part == whole {
        "100 %".to_owned()
    } else if part == 0 {
        "0 %".to_owned()
    } else if share < 0.05 {
        "<0.1 %".to_owned()
    } else if share >= 99.95 {
        ">99.9 %".to_owned()
    } else {
        format!("{share:.1} %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::check_drawing;

    /// Half of the map well-posed, half ill-posed with a level that rises to the right.
    fn map(columns: usize, rows: usize) -> VerdictMap {
        let axis = |label: &str, points: usize| Axis {
            label: label.to_owned(),
            values: (0..points).map(|index| 10.0 * index as f64).collect(),
        };
        let ill_posed = |cell: usize| 2 * (cell % columns) >= columns;
        let level = |cell: usize| {
            if ill_posed(cell) { 1.3_f64.powi((cell % columns) as i32) } else { f64::NAN }
        };
        VerdictMap {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            x: axis("non-coaxiality Δ (°)", columns),
            y: axis("friction angle φ (°)", rows),
            categories: vec![
                Category { label: "well-posed".to_owned(), look: Look::WellPosed },
                Category { label: "ill-posed, order 1".to_owned(), look: Look::IllPosed },
                Category { label: "indeterminate".to_owned(), look: Look::Indeterminate },
            ],
            category: (0..columns * rows).map(|cell| u8::from(ill_posed(cell))).collect(),
            level: (0..columns * rows).map(level).collect(),
            level_label: "growth rate (1/s)".to_owned(),
            curves: vec![Curve {
                label: "bound".to_owned(),
                points: vec![[45.0, -1e3], [45.0, 1e3]],
            }],
        }
    }

    fn texts(map: &VerdictMap) -> Vec<String> {
        map.picture().unwrap().texts().map(|text| text.content.clone()).collect()
    }

    /// Draws in both formats and checks what holds for every map.
    fn check(map: &VerdictMap) {
        check_drawing(&map.picture().unwrap(), |format| map.draw(format));
    }

    #[test]
    fn the_legend_lists_what_is_present_with_its_share() {
        let texts = texts(&map(20, 6));
        for expected in ["well-posed (50.0 %)", "ill-posed, order 1 (50.0 %)", "bound"] {
            assert!(texts.iter().any(|text| text == expected), "{expected} not in {texts:?}");
        }
        assert!(texts.iter().all(|text| !text.contains("indeterminate")));
        assert_eq!(percent(1, 100_000), "<0.1 %");
        assert_eq!(percent(99_999, 100_000), ">99.9 %");
        assert_eq!(percent(7, 7), "100 %");
    }

    #[test]
    fn cells_lie_where_the_axes_say() {
        // The cell at x = 10, y = 20, whatever the order in which the axes are given.
        let mut map = map(4, 3);
        map.curves.clear();
        map.category.fill(0);
        map.category[2 * 4 + 1] = 2;
        let mut turned = map.clone();
        turned.x.values.reverse();
        turned.y.values.reverse();
        turned.category.reverse();
        turned.level.reverse();
        let drawn = map.draw(Format::Png).unwrap();
        assert_eq!(drawn, turned.draw(Format::Png).unwrap());
        let (width, pixels) = crate::tests::pixels(&drawn);
        let grey = |x: usize, y: usize| pixels[3 * (y * width + x)];
        // In the row of y = 20, which is the uppermost, only the second column is dark.
        let dark = |from: usize, to: usize| {
            (from..to).filter(|&x| (200..280).any(|y| grey(x, y) < 200)).count()
        };
        assert!(dark(540, 800) > 200);
        assert_eq!(dark(200, 450) + dark(950, 1400), 0);
    }

    #[test]
    fn any_number_of_points_is_drawn() {
        for (columns, rows) in [(1, 1), (1, 2), (2, 1), (2, 2), (3, 40), (1700, 2)] {
            check(&map(columns, rows));
        }
    }

    #[test]
    fn any_level_is_drawn() {
        for level in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 5e-324, 7.0, f64::MAX]
        {
            let mut equal = map(8, 5);
            equal.level.fill(level);
            check(&equal);
            let mut mixed = map(8, 5);
            mixed.level[6] = level;
            check(&mixed);
        }
        let mut wide = map(60, 2);
        for (cell, level) in wide.level.iter_mut().enumerate() {
            *level = 10_f64.powi(10 * (cell as i32 % 60) - 300);
        }
        check(&wide);
    }

    #[test]
    fn every_look_is_drawn_and_differs_in_grey() {
        use Look::*;
        let looks = [
            WellPosed,
            IllPosed,
            IllPosed,
            IllPosed,
            IllPosed,
            IllPosed,
            UnboundedAtFiniteWaveNumber,
            Marginal,
            Indeterminate,
            OutsideModel,
        ];
        let mut map = map(looks.len(), 2);
        map.categories = looks.map(|look| Category { label: format!("{look:?}"), look }).to_vec();
        map.category = (0..2 * looks.len()).map(|cell| (cell % looks.len()) as u8).collect();
        check(&map);
        let fills: Vec<(f64, usize, [f64; 2])> = (0..looks.len())
            .map(|index| {
                let (ground, hatches) = fill(looks[index], map.variant(index));
                let along = hatches.first().map_or([0.0; 2], |hatch| hatch.along);
                (luminance(ground), hatches.len(), along)
            })
            .collect();
        for (index, one) in fills.iter().enumerate() {
            for other in &fills[..index] {
                let same_hatch = (one.1, one.2) == (other.1, other.2);
                assert!(!same_hatch || (one.0 - other.0).abs() > 40.0, "{one:?} {other:?}");
            }
        }
    }

    #[test]
    fn shades_grow_darker_evenly() {
        let steps: Vec<f64> =
            (0..SHADES).map(|step| luminance(shade(step as f64 / (SHADES - 1) as f64))).collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]));
        assert!(steps.windows(2).all(|pair| pair[0] - pair[1] < 4.0));
        assert!(luminance(INFINITE) < steps[SHADES - 1] - 8.0);
    }

    #[test]
    fn a_few_far_levels_do_not_take_the_colours() {
        let mut levels: Vec<f64> = (1..=1000).map(f64::from).collect();
        let range = Range::of(levels.iter().copied()).unwrap();
        assert_eq!((range.low, range.high, range.beyond), (0.0, 3.0, [false; 2]));
        levels.push(1e16);
        let range = Range::of(levels.iter().copied()).unwrap();
        assert!(range.high <= 3.0 && range.beyond == [false, true]);
        assert!(Range::of([f64::NAN, 0.0, -3.0].into_iter()).is_none());
    }

    #[test]
    fn long_labels_stay_on_the_sheet() {
        let long = "a rather long description of what is meant ".repeat(40);
        let mut map = map(12, 7);
        map.categories[0].label = long.clone();
        map.categories[1].label = "x".repeat(3000);
        for text in [&mut map.title, &mut map.subtitle, &mut map.level_label] {
            text.clone_from(&long);
        }
        map.x.label.clone_from(&long);
        map.y.label.clone_from(&long);
        check(&map);
        for text in [&mut map.title, &mut map.subtitle, &mut map.level_label] {
            text.clear();
        }
        check(&map);
    }

    #[test]
    fn curves_may_hold_anything() {
        let mut map = map(12, 7);
        let odd = [
            vec![],
            vec![[1.0, 1.0]],
            vec![[0.0, 0.0], [f64::NAN, 1.0], [f64::INFINITY, 2.0], [50.0, 20.0], [1e308, -1e308]],
        ];
        map.curves = odd.map(|points| Curve { label: "odd".to_owned(), points }).to_vec();
        check(&map);
    }

    #[test]
    fn wrong_input_is_refused() {
        let refused = |change: &dyn Fn(&mut VerdictMap)| {
            let mut map = map(4, 3);
            change(&mut map);
            map.draw(Format::Svg).unwrap_err().to_string()
        };
        assert!(
            refused(&|map| {
                map.level.pop();
            })
            .contains("11 values for 4 × 3 cells")
        );
        assert!(refused(&|map| map.category[5] = 3).contains("category 3"));
        assert!(refused(&|map| map.categories.clear()).contains("0 categories"));
        assert!(refused(&|map| map.x.values.clear()).contains("has no points"));
        assert!(refused(&|map| map.x.values[1] = f64::NAN).contains("not a finite number"));
        assert!(refused(&|map| map.y.values[1] = 11.0).contains("not uniformly spaced"));
        assert!(refused(&|map| map.y.values.fill(1.0)).contains("does not extend"));
        assert!(
            refused(&|map| map.y.values = vec![-1e308, 0.0, 1e308]).contains("does not extend")
        );
    }

    #[test]
    fn equal_maps_give_equal_bytes() {
        for format in [Format::Png, Format::Svg] {
            let map = map(30, 20);
            assert_eq!(map.draw(format).unwrap(), map.draw(format).unwrap());
        }
    }
}
