//! Growth rates against the direction and against the wave number.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::Format;
use crate::page::{self, Entry, Legend, MARGIN, RULE};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip, text_width,
};
use crate::scale::{self, SymmetricLog, Tick};

/// Growth rate of one model.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Legend text. Lines with the same label in both panels share a style and are listed once.
    pub label: String,
    /// Points in the units of the axes. NaN interrupts the line; an infinite growth rate is drawn at the edge of the
    /// panel.
    pub points: Vec<[f64; 2]>,
}

/// A marked position on the horizontal axis, drawn as a thin vertical line.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Label of a few words, written above the panel.
    pub label: String,
    /// Position, in the unit of the horizontal axis.
    pub x: f64,
}

/// Panel of growth rates against one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Name, symbol and unit of the horizontal axis.
    pub x_label: String,
    /// Name, symbol and unit of the growth rate.
    pub y_label: String,
    /// Whether the horizontal axis is logarithmic; points with non-positive abscissa are then omitted.
    pub x_log: bool,
    /// Lines, one per model; the first eight have distinct styles.
    pub curves: Vec<Line>,
    /// Reference lines such as asymptotes, drawn wide and pale below the other lines in one style and listed once with
    /// the label of the first. They are omitted in the linear part of the vertical axis, where power laws are not
    /// straight.
    pub guides: Vec<Line>,
    /// Marked positions, e.g. characteristic directions.
    pub marks: Vec<Mark>,
}

/// Growth rates against the direction and against the wave number, in two panels side by side.
///
/// The vertical axes are symmetric logarithmic: linear about zero and logarithmic beyond, so that growth and decay over
/// many decades are visible.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Left panel: growth rates against the direction.
    pub by_direction: Panel,
    /// Right panel: growth rates against the wave number.
    pub by_wave_number: Panel,
}

/// Colour of reference lines such as asymptotes.
const GUIDE: Colour = RGBColor(203, 205, 214);
const GUIDE_WIDTH: f64 = 11.0;

/// Style of a line; styles differ in colour and in greyscale.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub colour: Colour,
    pub dashes: &'static [f64],
    marker: Marker,
}

#[derive(Clone, Copy)]
enum Marker {
    None,
    Disc,
    Square,
    Triangle,
    Diamond,
    Ring,
    Plummet,
    Window,
}

/// Styles of lines; colours after Okabe and Ito (2008), distinguishable by colour-blind readers.
pub(crate) const LOOKS: [Look; 8] = [
    Look { colour: RGBColor(0, 0, 0), dashes: &[], marker: Marker::None },
    Look { colour: RGBColor(213, 94, 0), dashes: &[16.0, 8.0], marker: Marker::Disc },
    Look { colour: RGBColor(0, 114, 178), dashes: &[4.0, 6.0], marker: Marker::Square },
    Look {
        colour: RGBColor(0, 138, 100),
        dashes: &[20.0, 6.0, 4.0, 6.0],
        marker: Marker::Triangle,
    },
    Look { colour: RGBColor(176, 80, 140), dashes: &[], marker: Marker::Diamond },
    Look { colour: RGBColor(150, 110, 0), dashes: &[28.0, 7.0], marker: Marker::Ring },
    Look { colour: RGBColor(70, 150, 205), dashes: &[9.0, 5.0], marker: Marker::Plummet },
    Look {
        colour: RGBColor(112, 112, 112),
        dashes: &[3.0, 5.0, 12.0, 5.0],
        marker: Marker::Window,
    },
];

impl Look {
    /// Returns the style of the line with this index in the legend. Beyond eight lines, colours are combined with other
    /// dash patterns and markers.
    pub fn of(index: usize) -> Self {
        let count = LOOKS.len();
        let other = LOOKS[(index + index / count) % count];
        Self { colour: LOOKS[index % count].colour, ..other }
    }
}

/// Background of the linear part of a symmetric logarithmic axis.
pub(crate) const LINEAR: Colour = RGBColor(240, 240, 236);
pub(crate) const GRID: Colour = RGBColor(226, 226, 226);
pub(crate) const LINE_WIDTH: f64 = 3.4;
const MARKER_RADIUS: f64 = 8.0;
/// Distance between the markers of a line, pixels.
pub(crate) const MARKER_SPACING: f64 = 84.0;
/// Font size of the labels above marks, pixels.
const MARK_LABEL: f64 = 22.0;
const MARK_ROW: f64 = 1.35 * MARK_LABEL;

impl GrowthFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    fn picture(&self) -> Picture {
        let legend = Legend::new(self.legend(), page::WIDTH - 2.0 * MARGIN);
        let scales = [Scales::of(&self.by_direction), Scales::of(&self.by_wave_number)];

        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let heading = page::heading(&mut sheet, &self.title, &self.subtitle);
        let below = page::BOTTOM_AXIS + 22.0 + legend.height() + MARGIN - 12.0;

        // Widths first: they determine the number of rows of mark labels.
        let half = 0.5 * (page::WIDTH - 2.0 * MARGIN - 40.0);
        let panels = [&self.by_direction, &self.by_wave_number];
        let mut frames = [0, 1].map(|side| {
            let left = MARGIN + side as f64 * (half + 40.0);
            let y_ticks = scales[side].y_ticks(600.0);
            let axis = page::left_axis_width(&y_ticks);
            Rectangle { left: left + axis, top: 0.0, right: left + half - 16.0, bottom: 0.0 }
        });
        let marks = [0, 1].map(|side| place_marks(panels[side], &scales[side], frames[side]));
        let rows = marks.iter().flatten().map(|mark| mark.row + 1).max().unwrap_or(0);
        let top = heading + rows as f64 * MARK_ROW + 14.0;
        let height = page::HEIGHT.max(top + 480.0 + below).ceil();

        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        for side in [0, 1] {
            frames[side].top = top;
            frames[side].bottom = height - below;
            self.draw_panel(&mut picture, panels[side], &scales[side], frames[side], &marks[side]);
        }
        legend.draw(&mut picture, MARGIN, height - below + page::BOTTOM_AXIS + 22.0);
        picture
    }

    /// Returns the labels of all lines, in the order of their first occurrence.
    fn labels(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = Vec::new();
        for line in self.by_direction.curves.iter().chain(&self.by_wave_number.curves) {
            if !labels.contains(&line.label.as_str()) {
                labels.push(&line.label);
            }
        }
        labels
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = legend_of(&self.labels());
        let guides = self.by_direction.guides.iter().chain(&self.by_wave_number.guides);
        if let Some(guide) = guides.into_iter().next() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let middle = 0.5 * (area.top + area.bottom);
                picture.line([[area.left, middle], [area.right, middle]], GUIDE_WIDTH, GUIDE);
            };
            entries.push((guide.label.clone(), Box::new(swatch)));
        }
        let swatch = |picture: &mut Picture, area: Rectangle| {
            picture.fill(area, LINEAR);
            picture.frame(area, 1.5, PALE_INK);
        };
        entries.push(("linear scale about 0".to_owned(), Box::new(swatch)));
        entries
    }

    fn draw_panel(
        &self,
        picture: &mut Picture,
        panel: &Panel,
        scales: &Scales,
        frame: Rectangle,
        marks: &[PlacedMark],
    ) {
        let x_ticks = page::spaced(frame.width(), false, |most| scales.x_ticks(panel, most));
        let placed_x: Vec<Tick> =
            x_ticks.into_iter().map(|(x, label)| (scales.place_x(x, frame), label)).collect();
        let placed_y: Vec<Tick> = scales
            .y_ticks(frame.height())
            .into_iter()
            .map(|(y, label)| (scales.place_y(y, frame), label))
            .collect();
        let [below, above] = [-1.0_f64, 1.0]
            .map(|place| scales.place_y(place.clamp(scales.low, scales.high), frame));
        picture.fill(Rectangle { top: above, bottom: below, ..frame }, LINEAR);
        for (x, _) in placed_x.iter().filter(|(_, label)| !label.is_empty()) {
            picture.line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID);
        }
        for (y, _) in placed_y.iter().filter(|(_, label)| !label.is_empty()) {
            picture.line([[frame.left, *y], [frame.right, *y]], 1.2, GRID);
        }
        let zero = scales.place_y(0.0, frame);
        picture.line([[frame.left, zero], [frame.right, zero]], 3.4, RGBColor(110, 110, 110));

        let baseline = |row: usize| frame.top - 8.0 - row as f64 * MARK_ROW - 0.24 * MARK_LABEL;
        for PlacedMark { x, row, label, left } in marks {
            // The line of a mark extends to the full height of its label if it is beside the label.
            let beside = *x < *left || *x > left + text_width(label, MARK_LABEL, false);
            let end = baseline(*row) + MARK_LABEL * if beside { -0.76 } else { 0.3 };
            picture.dashed(&[[*x, frame.bottom], [*x, end]], &[8.0, 5.0], 1.6, PALE_INK);
        }
        for PlacedMark { row, label, left, .. } in marks {
            let text = Text::new([*left, baseline(*row)], Anchor::Start, MARK_LABEL, label);
            // If a line has to pass through a label, the label covers it.
            picture.fill(text.bounds(), WHITE);
            picture.text(Text { colour: PALE_INK, ..text });
        }

        // Infinite values are drawn just inside the frame, which would cover them.
        let inset = 0.012 * (scales.high - scales.low);
        let (lowest, highest) = (scales.low + inset, scales.high - inset);
        let places = |line: &Line, lowest: f64, highest: f64| -> Vec<Point> {
            let places = line.points.iter().map(|&[x, y]| {
                let place = scales.y.forward(y).clamp(lowest, highest);
                let x = if panel.x_log { x.log10() } else { x };
                [scales.place_x(x, frame), scales.place_y(place, frame)]
            });
            places.collect()
        };
        for guide in &panel.guides {
            let mut points = places(guide, f64::MIN, f64::MAX);
            for (point, [_, y]) in points.iter_mut().zip(&guide.points) {
                if scales.y.forward(*y).abs() < 1.0 {
                    *point = [f64::NAN; 2];
                }
            }
            for part in clip(&points, frame) {
                picture.line(part, GUIDE_WIDTH, GUIDE);
            }
        }
        let labels = self.labels();
        for line in &panel.curves {
            let index = labels.iter().position(|label| *label == line.label).unwrap_or(0);
            let look = &LOOKS[index % LOOKS.len()];
            let points = places(line, lowest, highest);
            for part in clip(&points, frame) {
                picture.dashed(&part, look.dashes, LINE_WIDTH, look.colour);
            }
            // The first marker of each line is shifted, so that markers of coincident lines are all visible.
            let mut next = frame.left + MARKER_SPACING * (0.25 + 0.28 * index as f64);
            let inside = |[x, y]: Point| {
                x >= frame.left && x <= frame.right && y >= frame.top && y <= frame.bottom
            };
            for &point in points.iter().filter(|&&point| inside(point)) {
                if point[0] >= next {
                    draw_marker(picture, point, look);
                    next = point[0] + MARKER_SPACING;
                }
            }
        }
        picture.frame(frame, RULE, INK);
        page::bottom_axis(picture, frame, &placed_x, &panel.x_label);
        page::left_axis(picture, frame, &placed_y, &panel.y_label);
    }
}

/// Builds the legend entries of lines with these labels.
pub(crate) fn legend_of(labels: &[&str]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for (index, label) in labels.iter().enumerate() {
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            let look = &LOOKS[index % LOOKS.len()];
            let middle = 0.5 * (area.top + area.bottom);
            let ends = [[area.left, middle], [area.right, middle]];
            picture.dashed(&ends, look.dashes, LINE_WIDTH, look.colour);
            draw_marker(picture, [0.5 * (area.left + area.right), middle], look);
        };
        entries.push(((*label).to_owned(), Box::new(swatch)));
    }
    entries
}

pub(crate) fn draw_marker(picture: &mut Picture, at: Point, look: &Look) {
    draw_marker_of(picture, at, look, MARKER_RADIUS);
}

/// Draws a marker with a radius in pixels.
pub(crate) fn draw_marker_of(picture: &mut Picture, [x, y]: Point, look: &Look, radius: f64) {
    let turned = |r: f64, sign: f64| {
        vec![
            [x, y - sign * r],
            [x + 0.9 * r, y + sign * 0.6 * r],
            [x - 0.9 * r, y + sign * 0.6 * r],
        ]
    };
    let square = |r: f64| vec![[x - r, y - r], [x + r, y - r], [x + r, y + r], [x - r, y + r]];
    let shape = |radius: f64| match look.marker {
        Marker::None => None,
        Marker::Disc | Marker::Ring => Some(crate::picture::circle([x, y], radius, 24)),
        Marker::Square | Marker::Window => Some(square(0.88 * radius)),
        Marker::Triangle => Some(turned(1.2 * radius, 1.0)),
        Marker::Plummet => Some(turned(1.2 * radius, -1.0)),
        Marker::Diamond => {
            let r = 1.2 * radius;
            Some(vec![[x, y - r], [x + r, y], [x, y + r], [x - r, y]])
        }
    };
    if let (Some(rim), Some(body)) = (shape(radius + 2.0), shape(radius)) {
        picture.polygon(rim, WHITE);
        picture.polygon(body, look.colour);
    }
    if let (Marker::Ring | Marker::Window, Some(hole)) = (look.marker, shape(0.5 * radius)) {
        picture.polygon(hole, WHITE);
    }
}

/// Ranges of a panel: horizontally in the unit of the axis or its log₁₀, vertically in positions of the symmetric
/// logarithm.
struct Scales {
    left: f64,
    right: f64,
    y: SymmetricLog,
    low: f64,
    high: f64,
}

/// Number of decades of growth rates against the wave number: powers of the wave number span more decades.
const POWER_DECADES: i32 = 24;

/// Magnitude above which numbers are treated as infinite, since differences would overflow.
const FINITE: f64 = 1e300;

impl Scales {
    fn of(panel: &Panel) -> Self {
        let points = || panel.curves.iter().flat_map(|line| &line.points);
        let place = |x: f64| if panel.x_log { x.log10() } else { x };
        let marks = panel.marks.iter().map(|mark| mark.x);
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in points().map(|point| point[0]).chain(marks).map(place) {
            if x.abs() < FINITE {
                (left, right) = (left.min(x), right.max(x));
            }
        }
        if left > right {
            (left, right) = (0.0, 1.0);
        } else if right - left <= 1e-9 * right.abs().max(left.abs()) || left == right {
            let half = 0.5 * left.abs().max(1.0);
            (left, right) = (left - half, right + half);
        }

        let growth = || points().map(|point| point[1]).filter(|growth| growth.abs() < FINITE);
        let decades = if panel.x_log { POWER_DECADES } else { SymmetricLog::DECADES };
        let y = SymmetricLog::for_values_within(growth(), decades);
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for place in growth().map(|growth| y.forward(growth)) {
            (low, high) = (low.min(place), high.max(place));
        }
        if low == high {
            (low, high) = (-1.0, 1.0);
        }
        // Margins at both ends; infinite values are drawn in them.
        let room = 0.05 * (high - low);
        Self { left, right, y, low: low - room, high: high + room }
    }

    fn place_x(&self, x: f64, frame: Rectangle) -> f64 {
        frame.left + (x - self.left) / (self.right - self.left) * frame.width()
    }

    fn place_y(&self, place: f64, frame: Rectangle) -> f64 {
        frame.bottom - (place - self.low) / (self.high - self.low) * frame.height()
    }

    fn x_ticks(&self, panel: &Panel, most: usize) -> Vec<Tick> {
        if panel.x_log {
            scale::log_ticks(self.left, self.right, most)
        } else {
            scale::ticks(self.left, self.right, most, panel.x_label.contains('°'))
        }
    }

    fn y_ticks(&self, length: f64) -> Vec<Tick> {
        let ticks = self.y.ticks(self.low, self.high, (length / 48.0) as usize);
        ticks.into_iter().filter(|(place, _)| (self.low..=self.high).contains(place)).collect()
    }
}

/// A mark with the position of its label: row above the panel and left end.
struct PlacedMark {
    x: f64,
    row: usize,
    label: String,
    left: f64,
}

/// Places the labels of marks so that no label overlaps another label or the line of another mark.
fn place_marks(panel: &Panel, scales: &Scales, frame: Rectangle) -> Vec<PlacedMark> {
    let mut marks: Vec<(f64, &str)> = panel
        .marks
        .iter()
        .map(|mark| (if panel.x_log { mark.x.log10() } else { mark.x }, mark.label.as_str()))
        .filter(|(x, _)| x.abs() < FINITE)
        .map(|(x, label)| (scales.place_x(x, frame), label))
        .collect();
    // From right to left: a label to the right of its line is then above the labels that it would otherwise cover, and
    // its line passes to the left of them.
    marks.sort_by(|a, b| b.0.total_cmp(&a.0));
    const APART: f64 = 7.0;
    let mut placed: Vec<(PlacedMark, f64)> = Vec::new();
    for (index, &(x, label)) in marks.iter().enumerate() {
        let to_come = &marks[index + 1..];
        let label = page::wrap(label, MARK_LABEL, false, 0.7 * frame.width(), 1);
        let label = label.into_iter().next().unwrap_or_default();
        let width = text_width(&label, MARK_LABEL, false);
        let lefts = [x + APART, x - 0.5 * width, x - APART - width]
            .map(|left| left.clamp(frame.left, (frame.right - width).max(frame.left)));
        let crosses =
            |at: f64, from: f64, to: f64| at > from - 0.9 * APART && at < to + 0.9 * APART;
        let free = |row: usize, left: f64| {
            let right = left + width;
            placed.iter().all(|(other, other_right)| match row.cmp(&other.row) {
                std::cmp::Ordering::Equal => {
                    right + 2.0 * APART < other.left || left > other_right + 2.0 * APART
                }
                // The line of the higher label passes beside the text of the lower label.
                std::cmp::Ordering::Less => !crosses(other.x, left, right),
                std::cmp::Ordering::Greater => !crosses(x, other.left, *other_right),
            })
        };
        // The heights of the following lines are not yet known. A label that would cover one of them is placed above
        // all of them, as is a label for which there is no lower position.
        let covers = |left: f64| to_come.iter().any(|other| crosses(other.0, left, left + width));
        let count = marks.len();
        let rows = (0..count).chain((count..=2 * count).rev()).chain(2 * count + 1..=3 * count);
        let mut places = rows.flat_map(|row| lefts.map(|left| (row, left)));
        let (row, left) = places
            .find(|&(row, left)| free(row, left) && (row >= count || !covers(left)))
            .unwrap_or((3 * count + 1 + index, lefts[0]));
        placed.push((PlacedMark { x, row, label, left }, left + width));
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
mod tests {
    use super::*;
    use crate::tests::{check_drawing, odd_curves};

    fn panel(x_log: bool, points: &[[f64; 2]], marks: &[f64]) -> Panel {
        Panel {
            x_label: if x_log { "wave number k (1/m)" } else { "direction θ (°)" }.to_owned(),
            y_label: "growth rate Re ς (1/s)".to_owned(),
            x_log,
            curves: vec![Line { label: "model".to_owned(), points: points.to_vec() }],
            guides: vec![Line { label: "asymptote".to_owned(), points: points.to_vec() }],
            marks: marks.iter().map(|&x| Mark { label: format!("θ = {x}°"), x }).collect(),
        }
    }

    fn figure(points: &[[f64; 2]], marks: &[f64]) -> GrowthFigure {
        GrowthFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            by_direction: panel(false, points, marks),
            by_wave_number: panel(true, points, &[]),
        }
    }

    fn check(figure: &GrowthFigure) {
        check_drawing(&figure.picture(), |format| figure.draw(format));
    }

    #[test]
    fn any_points_are_drawn() {
        for points in odd_curves() {
            check(&figure(&points, &[]));
        }
    }

    #[test]
    fn labels_of_marks_keep_apart() {
        let points = [[0.0, -1e6], [180.0, 1e4]];
        check(&figure(&points, &[0.0, 27.5, 57.5, 62.0, 117.5, 152.5, 180.0]));
        check(&figure(&points, &[90.0, 90.0, 90.5, 91.0, 170.0, 171.0]));
        check(&figure(&[], &[f64::NAN, 45.0, f64::INFINITY]));
        let mut long = figure(&points, &[10.0, 20.0]);
        for mark in &mut long.by_direction.marks {
            mark.label = "a characteristic direction of the steady equations ".repeat(5);
        }
        long.by_direction.curves[0].label = "model ".repeat(100);
        long.by_direction.y_label = "growth rate ".repeat(50);
        check(&long);
    }

    #[test]
    fn the_line_of_a_mark_crosses_no_label() {
        let panel = panel(false, &[[0.0, 0.0], [180.0, 1.0]], &[27.5, 57.5, 62.0, 117.5, 152.5]);
        let frame = Rectangle { left: 0.0, top: 0.0, right: 600.0, bottom: 600.0 };
        let placed = place_marks(&panel, &Scales::of(&panel), frame);
        assert_eq!(placed.len(), 5);
        for mark in &placed {
            for other in placed.iter().filter(|other| other.row < mark.row) {
                let right = other.left + text_width(&other.label, MARK_LABEL, false);
                assert!(mark.x < other.left || mark.x > right, "{} {}", mark.label, other.label);
            }
        }
    }

    #[test]
    fn infinite_growth_is_drawn_at_the_upper_edge() {
        let drawn = |last: f64| {
            let figure = figure(&[[1.0, 1.0], [2.0, 100.0], [3.0, last], [4.0, last]], &[]);
            let (width, pixels) = crate::tests::pixels(&figure.draw(Format::Png).unwrap());
            // Counts black pixels in the left panel just below the upper edge of the frame.
            let frame_top = (0..).find(|y| pixels[3 * (y * width + 400)] < 60 && *y > 150).unwrap();
            let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] < 60;
            (300..750).filter(|&x| (4..12).any(|below| dark(x, frame_top + below))).count()
        };
        assert!(drawn(f64::INFINITY) > drawn(f64::NAN) + 100);
    }

    #[test]
    fn lines_of_one_label_share_their_look() {
        let mut figure = figure(&[[1.0, 1.0], [2.0, 3.0]], &[]);
        figure.by_wave_number.curves.push(Line { label: "other".to_owned(), points: vec![] });
        assert_eq!(figure.labels(), ["model", "other"]);
        for count in [0, 1, 4, 9] {
            figure.by_direction.curves = (0..count)
                .map(|index| Line { label: format!("model {index}"), points: vec![[1.0, 2.0]] })
                .collect();
            check(&figure);
        }
    }
}
