//! Growth rates against the direction of the wave vector, as a polar diagram.

use plotters::style::RGBColor;

use crate::directions::spread;
use crate::growth::{LINE_WIDTH, LINEAR, LOOKS, Line, MARKER_SPACING, draw_marker, legend_of};
use crate::page::{self, Entry, Legend, MARGIN, NUMBER};
use crate::picture::{
    Anchor, Colour, PALE_INK, Picture, Point, Rectangle, Text, WHITE, circle, clip, text_width,
};
use crate::scale::{SymmetricLog, Tick, plain};
use crate::{FigureError, Format};

/// What a spoke of a polar diagram belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpokeStyle {
    /// Normal to a characteristic of the steady equations: a wide pale band.
    CharacteristicNormal,
    /// A direction in which a leading coefficient vanishes: thin dashes, to be seen on a band too.
    Degenerate,
}

impl SpokeStyle {
    const ALL: [Self; 2] = [Self::CharacteristicNormal, Self::Degenerate];

    fn words(self) -> &'static str {
        match self {
            Self::CharacteristicNormal => "normal to a characteristic of the steady equations",
            Self::Degenerate => "degenerate direction",
        }
    }

    pub(crate) fn draw(self, picture: &mut Picture, points: &[Point]) {
        match self {
            Self::CharacteristicNormal => picture.line(points, 11.0, RGBColor(203, 205, 214)),
            Self::Degenerate => picture.dashed(points, &[11.0, 7.0], 2.0, PALE_INK),
        }
    }
}

/// A direction of note of the wave vector; opposite directions are the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Spoke {
    /// A few words, written behind the angle; may be empty. Spokes on one angle share a label.
    pub label: String,
    /// Angle from x₁, anticlockwise, in degrees. Directions that are not finite are left out.
    pub angle_deg: f64,
    /// What it belongs to.
    pub style: SpokeStyle,
}

/// Growth rates against the direction of the wave vector, over the full circle.
///
/// The radius is linear about zero and logarithmic on both sides beyond; a bold circle is where
/// waves neither grow nor decay.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarFigure {
    /// Headline.
    pub title: String,
    /// What is held fixed.
    pub subtitle: String,
    /// Symbol of the growth rate, for the legend.
    pub symbol: String,
    /// Its unit, written on the outermost ring.
    pub unit: String,
    /// The lines, one per model, over directions in degrees from 0 to 180; opposite directions grow
    /// alike.
    pub curves: Vec<Line>,
    /// Directions of note.
    pub spokes: Vec<Spoke>,
}

pub(crate) const RING: Colour = RGBColor(205, 205, 205);
pub(crate) const NEUTRAL: Colour = RGBColor(110, 110, 110);
pub(crate) const ROW: f64 = 1.4 * NUMBER;
/// Size of the numbers on rings and of the degrees around them.
pub(crate) const RING_LABEL: f64 = 22.0;
/// Share of the radius inside which nothing is drawn: circles there are too small to be read.
const HOLE: f64 = 0.12;
/// Distance from the rim to the middle of the degrees around it.
pub(crate) const DEGREES: f64 = 32.0;
/// Growth rates beyond are treated as infinite.
const FINITE: f64 = 1e300;

/// The radial scale: places of the symmetric logarithm and their radii.
struct Radial {
    scale: SymmetricLog,
    low: f64,
    high: f64,
    radius: f64,
}

impl Radial {
    fn of(curves: &[Line], radius: f64) -> Self {
        let growth = || curves.iter().flat_map(|line| &line.points).map(|point| point[1]);
        let finite = || growth().filter(|growth| growth.abs() < FINITE);
        let scale = SymmetricLog::for_values(finite());
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for place in finite().map(|growth| scale.forward(growth)) {
            (low, high) = (low.min(place), high.max(place));
        }
        // The neutral circle has both sides, and infinite values are drawn beyond all others.
        let room = 0.06 * (high - low).max(2.0);
        Self { scale, low: low.min(-1.0) - room, high: high.max(1.0) + room, radius }
    }

    /// The radius of a place on the scale.
    fn at_place(&self, place: f64) -> f64 {
        let share = (place.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        self.radius * (HOLE + (1.0 - HOLE) * share)
    }

    /// The radius of a growth rate; infinite ones run just inside the rim or the hole.
    fn at(&self, growth: f64) -> f64 {
        let inset = 0.015 * (self.high - self.low);
        self.at_place(self.scale.forward(growth).clamp(self.low + inset, self.high - inset))
    }
}

/// A point in polar coordinates about a centre, angles in degrees anticlockwise.
pub(crate) fn at(centre: Point, angle_deg: f64, radius: f64) -> Point {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    [centre[0] + radius * cos, centre[1] - radius * sin]
}

/// The label of one or several spokes on an angle.
pub(crate) struct Label {
    angle_deg: f64,
    /// The angle, and what is on it.
    words: Vec<String>,
}

impl Label {
    fn text(&self) -> String {
        match self.words.split_first() {
            Some((angle, names)) => format!("{angle} {}", names.join(", ")).trim_end().to_owned(),
            None => String::new(),
        }
    }
}

impl PolarFigure {
    /// Draws the figure into the bytes of a file.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    fn drawn(&self) -> impl Iterator<Item = &Spoke> {
        self.spokes.iter().filter(|spoke| spoke.angle_deg.is_finite())
    }

    fn legend(&self) -> Vec<Entry> {
        let labels: Vec<&str> = self.curves.iter().map(|line| line.label.as_str()).collect();
        let mut entries = legend_of(&labels);
        for style in SpokeStyle::ALL {
            if self.drawn().any(|spoke| spoke.style == style) {
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let middle = 0.5 * (area.top + area.bottom);
                    style.draw(picture, &[[area.left, middle], [area.right, middle]]);
                };
                entries.push((style.words().to_owned(), Box::new(swatch)));
            }
        }
        let neutral = |picture: &mut Picture, area: Rectangle| {
            let middle = 0.5 * (area.top + area.bottom);
            picture.line([[area.left, middle], [area.right, middle]], 3.4, NEUTRAL);
        };
        let words = format!("{} = 0: growth outside, decay inside", self.symbol);
        entries.push((words, Box::new(neutral)));
        let linear = |picture: &mut Picture, area: Rectangle| {
            picture.fill(area, LINEAR);
            picture.frame(area, 1.5, PALE_INK);
        };
        entries.push(("linear scale about 0".to_owned(), Box::new(linear)));
        entries
    }

    fn picture(&self) -> Picture {
        let legend = Legend::new(self.legend(), page::WIDTH - 2.0 * MARGIN);
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let sides = labels(self.drawn());
        let count = sides.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let plane = (count * ROW + 20.0).max(780.0);
        let height = (page::HEIGHT + 60.0).max(top + plane + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let area =
            Rectangle { left: MARGIN, top, right: page::WIDTH - MARGIN, bottom: height - below };
        self.draw_disc(&mut picture, area, &sides);
        legend.draw(&mut picture, MARGIN, area.bottom + 16.0);
        picture
    }

    fn draw_disc(&self, picture: &mut Picture, area: Rectangle, sides: &[Vec<Label>; 2]) {
        let radius = (0.5 * area.height() - DEGREES - 0.7 * RING_LABEL).min(440.0);
        let centre = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let radial = Radial::of(&self.curves, radius);

        let disc = |picture: &mut Picture, place: f64, colour| {
            picture.polygon(circle(centre, radial.at_place(place), 360), colour);
        };
        disc(picture, 1.0, LINEAR);
        disc(picture, -1.0, WHITE);
        for spoke in SpokeStyle::ALL
            .iter()
            .flat_map(|style| self.drawn().filter(move |spoke| spoke.style == *style))
        {
            // From the rim inwards, so that the dashes are the same on both sides.
            for end in [spoke.angle_deg, spoke.angle_deg + 180.0] {
                let points = [at(centre, end, radius), at(centre, end, HOLE * radius)];
                spoke.style.draw(picture, &points);
            }
        }
        let most = most_numbers((1.0 - HOLE) * radius);
        let rings: Vec<Tick> = radial
            .scale
            .ticks(radial.low, radial.high, most)
            .into_iter()
            .filter(|(place, _)| (radial.low..=radial.high).contains(place))
            .collect();
        for (place, label) in rings.iter().filter(|(place, _)| *place != 0.0) {
            let width = if label.is_empty() { 0.8 } else { 1.6 };
            ring(picture, centre, radial.at_place(*place), width, RING);
        }
        ring(picture, centre, HOLE * radius, 1.6, RING);
        ring(picture, centre, radius, 1.8, NEUTRAL);
        ring(picture, centre, radial.at_place(0.0), 3.4, NEUTRAL);
        let leaders: Vec<[Point; 2]> = sides
            .iter()
            .enumerate()
            .flat_map(|(side, labels)| {
                draw_labels(picture, area, centre, radius, labels, side == 0)
            })
            .collect();
        draw_degrees(picture, centre, radius, &leaders);

        let lines: Vec<Vec<(f64, Point)>> = self
            .curves
            .iter()
            .map(|line| places(&line.points, centre, |growth| radial.at(growth)))
            .collect();
        for (index, places) in lines.iter().enumerate() {
            draw_curve(picture, centre, index, places);
        }
        let rings: Vec<Tick> =
            rings.into_iter().map(|(place, label)| (radial.at_place(place), label)).collect();
        let spokes: Vec<f64> = self.drawn().map(|spoke| spoke.angle_deg).collect();
        for text in best_numbers(&rings, &self.unit, &spokes, centre, radius, &lines) {
            picture.fill(backing(&text), WHITE);
            picture.text(text);
        }
    }
}

/// The labels on the right and on the left of the disc, from top to bottom: at the upper ends
/// of the spokes, those on one angle together.
pub(crate) fn labels<'a>(spokes: impl Iterator<Item = &'a Spoke>) -> [Vec<Label>; 2] {
    let mut labels: Vec<Label> = Vec::new();
    let mut spokes: Vec<&Spoke> = spokes.collect();
    spokes.sort_by(|a, b| a.upper_angle().total_cmp(&b.upper_angle()));
    for spoke in spokes {
        let angle = spoke.words();
        let known = labels.iter().position(|label| label.words[0] == angle);
        let index = known.unwrap_or_else(|| {
            let angle_deg = spoke.upper_angle();
            labels.push(Label { angle_deg, words: vec![angle] });
            labels.len() - 1
        });
        let words = &mut labels[index].words;
        if !spoke.label.is_empty() && !words.contains(&spoke.label) {
            words.push(spoke.label.clone());
        }
    }
    let (mut right, mut left): (Vec<Label>, Vec<Label>) =
        labels.into_iter().partition(|label| label.angle_deg <= 90.0);
    for side in [&mut right, &mut left] {
        side.sort_by(|a, b| {
            let height = |label: &Label| label.angle_deg.to_radians().sin();
            height(b).total_cmp(&height(a))
        });
    }
    [right, left]
}

/// The points of a line over the full circle, with their angles; not-a-number where it is
/// interrupted. `radius` gives the radius of a value.
pub(crate) fn places(
    line: &[[f64; 2]],
    centre: Point,
    radius: impl Fn(f64) -> f64,
) -> Vec<(f64, Point)> {
    let place = |&[angle, value]: &[f64; 2], turn: f64| {
        let is_drawn = angle.is_finite() && !value.is_nan();
        let angle = angle + turn;
        (angle, if is_drawn { at(centre, angle, radius(value)) } else { GAP })
    };
    let half = |turn: f64| line.iter().map(move |point| (*point, turn));
    // The two halves meet where the line covers all directions.
    let ends = line.first().zip(line.last());
    let meets = ends.is_some_and(|(first, last)| last[0] - first[0] >= 180.0 - 1e-9);
    let gap = (!meets).then_some(([f64::NAN; 2], 0.0));
    half(0.0).chain(gap).chain(half(180.0)).map(|(point, turn)| place(&point, turn)).collect()
}

/// The numbers of rings, each given by its radius, where a ray crosses them, the unit beside the
/// outermost.
fn numbers(rings: &[Tick], unit: &str, centre: Point, rim: f64, ray: f64) -> Vec<Text> {
    let labelled = || rings.iter().filter(|(_, label)| !label.is_empty());
    let outermost = labelled().map(|(radius, _)| *radius).fold(f64::NEG_INFINITY, f64::max);
    let number = |(radius, label): &Tick| {
        let unit = if *radius == outermost { unit } else { "" };
        let words = format!("{label} {unit}");
        let (words, size) = page::fit(words.trim_end(), RING_LABEL, 0.5 * rim);
        let [x, y] = at(centre, ray, *radius);
        Text::new([x, y + 0.36 * size], Anchor::Middle, size, words)
    };
    labelled().map(number).collect()
}

/// The numbers of the rings on the steep ray in the lower half on which they cover the least of
/// the lines, and then that is farthest from all `spokes`, given by their angles in degrees.
pub(crate) fn best_numbers(
    rings: &[Tick],
    unit: &str,
    spokes: &[f64],
    centre: Point,
    rim: f64,
    lines: &[Vec<(f64, Point)>],
) -> Vec<Text> {
    let mut lines: Vec<Vec<Point>> =
        lines.iter().map(|line| line.iter().map(|(_, point)| *point).collect()).collect();
    // Nor the rim, behind which the degrees stand.
    lines.push(circle(centre, rim, 360));
    let room = |ray: f64| {
        spokes
            .iter()
            .map(|spoke| (ray - spoke).rem_euclid(180.0))
            .map(|gap| gap.min(180.0 - gap))
            .fold(MOST_ROOM, f64::min)
    };
    let best = (0..=28).map(|step| STEEP[0] + 2.0 * f64::from(step)).map(|ray| {
        let numbers = numbers(rings, unit, centre, rim, ray);
        let covered = numbers
            .iter()
            .map(backing)
            .filter(|area| lines.iter().any(|line| !clip(line, *area).is_empty()));
        // A spoke behind the numbers is as bad as a covered line.
        let cost = covered.count() as f64 + numbers.len() as f64 * (1.0 - room(ray) / MOST_ROOM);
        (cost, numbers)
    });
    best.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Vec::new, |(_, numbers)| numbers)
}

/// As many numbers as find room on a steep ray over a length.
pub(crate) fn most_numbers(length: f64) -> usize {
    (length * STEEP[0].to_radians().sin().abs() / (1.3 * RING_LABEL)) as usize
}

/// Draws a full circle.
pub(crate) fn ring(picture: &mut Picture, centre: Point, radius: f64, width: f64, colour: Colour) {
    let mut rim = circle(centre, radius, 360);
    rim.extend_from_within(..2);
    picture.line(rim, width, colour);
}

/// Where a line is interrupted.
const GAP: Point = [f64::NAN; 2];
/// Numbers stand on a ray between these degrees, so that they find room above each other; one that
/// is this far from all spokes is far enough.
const STEEP: [f64; 2] = [242.0, 298.0];
const MOST_ROOM: f64 = 12.0;

/// The ground of a number on a ring.
pub(crate) fn backing(text: &Text) -> Rectangle {
    let bounds = text.bounds();
    Rectangle { left: bounds.left - 4.0, right: bounds.right + 4.0, ..bounds }
}

fn draw_curve(picture: &mut Picture, centre: Point, index: usize, places: &[(f64, Point)]) {
    let look = &LOOKS[index % LOOKS.len()];
    for part in parts(places) {
        picture.dashed(&part, look.dashes, LINE_WIDTH, look.colour);
    }
    draw_markers(picture, centre, index, places);
}

/// The uninterrupted parts of a line.
pub(crate) fn parts(places: &[(f64, Point)]) -> Vec<Vec<Point>> {
    let parts = places.split(|(_, point)| point[0].is_nan()).filter(|part| part.len() > 1);
    parts.map(|part| part.iter().map(|(_, point)| *point).collect()).collect()
}

/// Draws the markers along a line.
pub(crate) fn draw_markers(
    picture: &mut Picture,
    centre: Point,
    index: usize,
    places: &[(f64, Point)],
) {
    let look = &LOOKS[index % LOOKS.len()];
    // By the angle that the line has turned, so that spikes carry no crowd of markers.
    let step = |[x, y]: Point| {
        let radius = (x - centre[0]).hypot(y - centre[1]).max(1.0);
        (1.4 * MARKER_SPACING / radius).to_degrees()
    };
    let mut next = f64::NEG_INFINITY;
    for &(angle, point) in places.iter().filter(|(_, point)| !point[0].is_nan()) {
        if next == f64::NEG_INFINITY {
            // Each line's markers start elsewhere, so that lines on top of each other show all.
            next = angle + step(point) * (0.25 + 0.28 * index as f64);
        }
        if angle >= next {
            draw_marker(picture, point, look);
            next = angle + step(point);
        }
    }
}

impl Spoke {
    /// The angle of the end in the upper half, in degrees; one that rounds to 180° is 0°.
    fn upper_angle(&self) -> f64 {
        let angle = self.angle_deg.rem_euclid(180.0);
        if angle >= 179.995 { 0.0 } else { angle }
    }

    /// The angle in words, to a hundredth of a degree.
    fn words(&self) -> String {
        format!("{}°", plain((100.0 * self.upper_angle()).round() / 100.0))
    }
}

/// Writes the degrees around the rim, but for those that the leader of a label passes.
pub(crate) fn draw_degrees(
    picture: &mut Picture,
    centre: Point,
    radius: f64,
    leaders: &[[Point; 2]],
) {
    for step in 0..24 {
        let angle = 15.0 * f64::from(step);
        let length = if step % 2 == 0 { 11.0 } else { 6.0 };
        let ends = [at(centre, angle, radius), at(centre, angle, radius + length)];
        picture.line(ends, 1.8, NEUTRAL);
        let words = format!("{angle}°");
        // The nearest point of the text is as far from the rim at all angles.
        let (sin, cos) = angle.to_radians().sin_cos();
        let half = 0.5 * text_width(&words, RING_LABEL, false);
        let away = radius + 18.0 + half * cos.abs() + 0.38 * RING_LABEL * sin.abs();
        let [x, y] = at(centre, angle, away);
        let text = Text::new([x, y + 0.36 * RING_LABEL], Anchor::Middle, RING_LABEL, words);
        let is_free = leaders.iter().all(|leader| clip(leader, backing(&text)).is_empty());
        if step % 2 == 0 && is_free {
            picture.text(Text { colour: PALE_INK, ..text });
        }
    }
}

/// Writes labels beside the disc, tied to the ends of their spokes; gives the ties.
pub(crate) fn draw_labels(
    picture: &mut Picture,
    area: Rectangle,
    centre: Point,
    radius: f64,
    labels: &[Label],
    right: bool,
) -> Vec<[Point; 2]> {
    let mut leaders = Vec::new();
    let sign = if right { 1.0 } else { -1.0 };
    // Beyond the degrees around the rim.
    let away = radius + 2.0 * DEGREES + 12.0;
    let wanted: Vec<f64> =
        labels.iter().map(|label| at(centre, label.angle_deg, away)[1]).collect();
    let heights = spread(&wanted, ROW, [area.top + 0.5 * ROW, area.bottom - 0.5 * ROW]);
    for (label, y) in labels.iter().zip(heights) {
        let inner = ((y - centre[1]).abs() - 0.5 * ROW).max(0.0);
        let end = at(centre, label.angle_deg, radius + 4.0);
        let reach = (away * away - inner * inner).max(0.0).sqrt();
        let x = centre[0] + sign * reach.max(sign * (end[0] - centre[0]) + 34.0);
        let leader = [end, [x - sign * 8.0, y]];
        picture.line(leader, 1.4, PALE_INK);
        leaders.push(leader);
        let room = if right { area.right - x } else { x - area.left };
        let anchor = if right { Anchor::Start } else { Anchor::End };
        let (words, size) = page::fit(&label.text(), NUMBER - 2.0, room);
        let text = Text::new([x, y + 0.36 * size], anchor, size, words);
        picture.text(text);
    }
    leaders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, odd_curves};

    fn figure(points: &[[f64; 2]], spokes: &[f64]) -> PolarFigure {
        let spoke = |(index, &angle_deg): (usize, &f64)| Spoke {
            label: format!("spoke {index}"),
            angle_deg,
            style: SpokeStyle::ALL[index % 2],
        };
        PolarFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            symbol: "Re ς".to_owned(),
            unit: "1/s".to_owned(),
            curves: vec![Line { label: "model".to_owned(), points: points.to_vec() }],
            spokes: spokes.iter().enumerate().map(spoke).collect(),
        }
    }

    fn check(figure: &PolarFigure) {
        check_drawing(&figure.picture(), |format| figure.draw(format));
    }

    fn circle_of(growth: f64) -> Vec<[f64; 2]> {
        (0..=180).map(|angle| [f64::from(angle), growth]).collect()
    }

    #[test]
    fn any_points_are_drawn() {
        for points in odd_curves() {
            check(&figure(&points, &[15.0, 75.0]));
        }
    }

    #[test]
    fn labels_keep_apart_whatever_the_spokes() {
        let points = [[0.0, -1e6], [180.0, 1e4]];
        let sets: [&[f64]; 6] = [
            &[],
            &[f64::NAN, f64::INFINITY, 1e300, -720.0],
            &[0.0, 0.0, 90.0, 180.0, -90.0],
            &[14.95, 15.0, 75.0, 75.05, 30.0, 29.0],
            &[85.0, 88.0, 89.0, 90.0, 91.0, 92.0, 95.0],
            &[15.0, 15.0, 45.0, 75.0, 75.0, 111.8, 135.0],
        ];
        for spokes in sets {
            check(&figure(&points, spokes));
        }
        let many: Vec<f64> = (0..60).map(|angle| 3.0 * f64::from(angle)).collect();
        check(&figure(&points, &many));
        let mut long = figure(&points, &[10.0, 20.0, 100.0]);
        long.spokes[0].label = "a direction of some kind ".repeat(30);
        long.unit = "metres ".repeat(100);
        check(&long);
    }

    #[test]
    fn spokes_on_one_angle_share_a_label() {
        let [right, left] = labels(figure(&[], &[15.0, 195.0, 105.0, -1e-9]).drawn());
        let words = |labels: &[Label]| -> Vec<String> { labels.iter().map(Label::text).collect() };
        assert_eq!(words(&right), ["15° spoke 0, spoke 1", "0° spoke 3"]);
        assert_eq!(words(&left), ["105° spoke 2"]);
    }

    #[test]
    fn growth_lies_outside_the_neutral_circle_and_decay_inside() {
        let curve = Line { label: String::new(), points: vec![[0.0, 1e5], [90.0, -1e3]] };
        let radial = Radial::of(&[curve], 400.0);
        let neutral = radial.at(0.0);
        let radii = [f64::NEG_INFINITY, -1e3, -10.0, 0.0, 10.0, 1e5, f64::INFINITY];
        let radii = radii.map(|growth| radial.at(growth));
        assert!(radii.windows(2).all(|pair| pair[0] < pair[1]), "{radii:?}");
        assert!(radii[0] > HOLE * 400.0 && radii[6] < 400.0 && radii[3] == neutral);
        // Decades are as far apart on both sides.
        let step = radial.at(1e5) - radial.at(1e4);
        assert!((radial.at(1e4) - radial.at(1e3) - step).abs() < 1e-9);
    }

    #[test]
    fn the_angle_is_anticlockwise_and_the_circle_is_full() {
        // Growth in a sector about 45° alone: black in the upper right and the lower left quarter.
        let points: Vec<[f64; 2]> = (35..=55).map(|angle| [f64::from(angle), 1e3]).collect();
        let figure = figure(&points, &[]);
        let (width, pixels) = crate::tests::pixels(&figure.draw(Format::Png).unwrap());
        let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] < 20;
        let count = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
            columns
                .flat_map(|x| rows.clone().map(move |y| (x, y)))
                .filter(|&(x, y)| dark(x, y))
                .count()
        };
        // Between the heading and the legend, about the middle of the sheet's plane.
        let (upper, lower) = (160..540, 620..960);
        assert!(count(810..1200, upper.clone()) > 200 && count(400..790, lower.clone()) > 200);
        assert_eq!(count(400..790, upper), 0);
        assert_eq!(count(810..1200, lower), 0);
    }

    #[test]
    fn numbers_stand_clear_of_lines_and_spokes() {
        // A line that runs along the ray at 270°, and spokes beside it.
        let mut figure = figure(&circle_of(-2.0), &[60.0, 75.0, 105.0]);
        for [angle, growth] in &mut figure.curves[0].points {
            if *angle >= 90.0 {
                *growth = 1e3;
            }
        }
        check(&figure);
        let (centre, radius) = ([800.0, 600.0], 350.0);
        let radial = Radial::of(&figure.curves, radius);
        let rings = radial.scale.ticks(radial.low, radial.high, 9).into_iter();
        let rings: Vec<Tick> =
            rings.map(|(place, label)| (radial.at_place(place), label)).collect();
        let place = |line: &Line| places(&line.points, centre, |growth| radial.at(growth));
        let lines: Vec<_> = figure.curves.iter().map(place).collect();
        let spokes = [60.0, 75.0, 105.0];
        let numbers = best_numbers(&rings, "1/s", &spokes, centre, radius, &lines);
        assert!(numbers.len() >= 4 && numbers.iter().any(|n| n.content.ends_with(" 1/s")));
        for number in &numbers {
            let [x, y] = [number.bounds(); 2]
                .map(|b| [0.5 * (b.left + b.right), 0.5 * (b.top + b.bottom)])[0];
            let ray = (centre[1] - y).atan2(x - centre[0]).to_degrees().rem_euclid(180.0);
            for spoke in [60.0, 75.0, 90.0, 105.0] {
                assert!((ray - spoke).abs() > 5.0, "{ray} at {spoke}");
            }
        }
    }
}
