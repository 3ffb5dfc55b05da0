//! Diagram of directions in the physical plane.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::Format;
use crate::page::{self, Legend, MARGIN, NAME, NUMBER};
use crate::picture::{Anchor, Colour, PALE_INK, Picture, Point, Rectangle, Text, circle};

/// Kind of a direction, which determines its line style.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A characteristic direction of the steady equations: solid.
    Characteristic,
    /// A principal axis of stress: dashed.
    StressAxis,
    /// The direction of the velocity: dotted.
    Velocity,
    /// A principal axis of the deformation rate: dash-dotted.
    DeformationAxis,
}

impl Style {
    const ALL: [Self; 4] =
        [Self::Characteristic, Self::StressAxis, Self::DeformationAxis, Self::Velocity];

    fn words(self) -> &'static str {
        match self {
            Self::Characteristic => "characteristic direction",
            Self::StressAxis => "principal axis of stress",
            Self::Velocity => "velocity",
            Self::DeformationAxis => "principal axis of deformation rate",
        }
    }

    fn look(self) -> (&'static [f64], f64, Colour) {
        match self {
            Self::Characteristic => (&[], 5.0, RGBColor(0, 0, 0)),
            Self::StressAxis => (&[22.0, 10.0], 4.0, RGBColor(213, 94, 0)),
            Self::Velocity => (&[4.0, 7.0], 4.5, RGBColor(0, 138, 100)),
            Self::DeformationAxis => (&[26.0, 8.0, 5.0, 8.0], 4.0, RGBColor(0, 114, 178)),
        }
    }
}

/// A direction in the physical plane; opposite directions are equivalent.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// Name or symbol; may be empty.
    pub label: String,
    /// Angle from x₁, degrees anticlockwise. Directions with a non-finite angle are not drawn.
    pub angle_deg: f64,
    /// Multiplicity; written beside the direction if greater than 1.
    pub multiplicity: usize,
    /// Kind, which determines the line style.
    pub style: Style,
}

/// Diagram of directions through a common point in the physical plane.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionsFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// The directions.
    pub directions: Vec<Direction>,
}

const GUIDE: Colour = RGBColor(190, 190, 190);
const LINE: f64 = 1.45 * NUMBER;
/// Vertical distance of the centre of a label from the circle, pixels.
const CLEARANCE: f64 = 32.0;

impl DirectionsFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    fn drawn(&self) -> impl Iterator<Item = &Direction> {
        self.directions.iter().filter(|direction| direction.angle_deg.is_finite())
    }

    fn picture(&self) -> Picture {
        let present = |style: &Style| self.drawn().any(|direction| direction.style == *style);
        let entries = Style::ALL.into_iter().filter(present).map(|style| {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let (dashes, width, colour) = style.look();
                let y = 0.5 * (area.top + area.bottom);
                picture.dashed(&[[area.left, y], [area.right, y]], dashes, width, colour);
            };
            (style.words().to_owned(), Box::new(swatch) as _)
        });
        let legend = Legend::new(entries.collect(), page::WIDTH - 2.0 * MARGIN);

        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        // The circle must be high enough for the column of labels on either side.
        let sides = self.labels([0.0, 0.0], 1.0);
        let count = sides.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let plane = (count * LINE + 20.0).max(700.0);
        let height = page::HEIGHT.max(top + plane + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let area =
            Rectangle { left: MARGIN, top, right: page::WIDTH - MARGIN, bottom: height - below };
        self.draw_plane(&mut picture, area);
        legend.draw(&mut picture, MARGIN, area.bottom + 16.0);
        picture
    }

    fn draw_plane(&self, picture: &mut Picture, area: Rectangle) {
        // Margin for the labels above the circle and for the arrow heads.
        let radius = (0.5 * area.height() - 76.0).min(420.0);
        let centre = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let at = |angle_deg: f64, radius: f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            [centre[0] + radius * cos, centre[1] - radius * sin]
        };

        let mut rim = circle(centre, radius, 180);
        rim.extend_from_within(..2);
        picture.line(rim, 1.8, GUIDE);
        for step in 0..24 {
            let angle = 15.0 * f64::from(step);
            let length = if step % 3 == 0 { 16.0 } else { 9.0 };
            picture.line([at(angle, radius), at(angle, radius - length)], 1.8, GUIDE);
        }
        for angle in [0.0, 90.0] {
            let tip = radius + 22.0;
            picture.line([at(angle + 180.0, radius), at(angle, tip - 10.0)], 2.2, PALE_INK);
            let head = |turn: f64| {
                let [x, y] = at(angle, tip);
                let (sin, cos) = (angle + turn).to_radians().sin_cos();
                [x - 24.0 * cos, y + 24.0 * sin]
            };
            picture.polygon(vec![at(angle, tip), head(18.0), head(-18.0)], PALE_INK);
        }

        // Wide lines first, so that narrower lines in the same direction remain visible.
        let mut directions: Vec<&Direction> = self.drawn().collect();
        directions.sort_by_key(|direction| direction.style != Style::Characteristic);
        for direction in directions {
            let (dashes, width, colour) = direction.style.look();
            let angle = direction.angle_deg;
            // From the circle towards the centre, so that the dashes are symmetric.
            for end in [angle, angle + 180.0] {
                picture.dashed(&[at(end, radius), centre], dashes, width, colour);
            }
        }
        picture.disc(centre, 8.0, RGBColor(0, 0, 0));

        for (side, labels) in self.labels(centre, radius).into_iter().enumerate() {
            let wanted: Vec<f64> = labels.iter().map(|label| label.wanted).collect();
            let heights = spread(&wanted, LINE, [area.top + 0.5 * LINE, area.bottom - 0.5 * LINE]);
            for (label, y) in labels.iter().zip(heights) {
                label.draw(picture, area, centre, radius, y, side == 0);
            }
        }
    }

    /// Computes the labels on the right and on the left of the circle, from top to bottom. A direction is labelled at
    /// its upper end unless another label is near, otherwise at the end with more space.
    fn labels(&self, centre: Point, radius: f64) -> [Vec<Label>; 2] {
        let place = |angle_deg: f64, clearance: f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            let end = [centre[0] + radius * cos, centre[1] - radius * sin];
            let wanted = centre[1] - (radius + clearance) * sin;
            (usize::from(cos < -1e-9), end, wanted)
        };
        let mut sides: [Vec<Label>; 2] = [Vec::new(), Vec::new()];
        for (angle, name) in [(0.0, "x₁"), (90.0, "x₂")] {
            let (side, end, wanted) = place(angle, CLEARANCE + 12.0);
            sides[side].push(Label {
                end,
                wanted,
                text: name.to_owned(),
                colour: PALE_INK,
                axis: true,
            });
        }
        let mut directions: Vec<&Direction> = self.drawn().collect();
        directions.sort_by(|a, b| a.upper_angle().total_cmp(&b.upper_angle()));
        for direction in directions {
            let angle = direction.upper_angle();
            let ends = [angle, angle + 180.0].map(|angle| place(angle, CLEARANCE));
            let room = |&(side, _, wanted): &(usize, Point, f64)| {
                let distances = sides[side].iter().map(|other| (other.wanted - wanted).abs());
                distances.fold(f64::INFINITY, f64::min)
            };
            let [upper, lower] = ends;
            let lower_is_freer = room(&upper) < LINE && room(&lower) > room(&upper);
            let (side, end, wanted) = if lower_is_freer { lower } else { upper };
            let (text, colour) = (direction.words(), direction.style.look().2);
            sides[side].push(Label { end, wanted, text, colour, axis: false });
        }
        for side in &mut sides {
            side.sort_by(|a, b| a.wanted.total_cmp(&b.wanted));
        }
        sides
    }
}

impl Direction {
    /// Returns the angle of the upper end, degrees in [0, 180).
    fn upper_angle(&self) -> f64 {
        self.angle_deg.rem_euclid(180.0)
    }

    fn words(&self) -> String {
        // Equivalent angles have the same text; an angle that rounds to 180° is written as 0°.
        let angle = (10.0 * self.upper_angle()).round() / 10.0;
        let angle = if angle >= 180.0 { 0.0 } else { angle };
        let times = if self.multiplicity > 1 {
            format!(" (×{})", self.multiplicity)
        } else {
            String::new()
        };
        format!("{} {angle:.1}°{times}", self.label).trim_start().to_owned()
    }
}

/// A label at the end of a direction.
struct Label {
    /// Point at which the direction meets the circle.
    end: Point,
    /// Preferred vertical position of the label's centre, pixels.
    wanted: f64,
    text: String,
    colour: Colour,
    /// Whether the label names an axis, which needs space for its arrow head.
    axis: bool,
}

impl Label {
    /// Draws the label outside the circle at height `y`, with a leader line to the end of its direction.
    fn draw(
        &self,
        picture: &mut Picture,
        area: Rectangle,
        centre: Point,
        radius: f64,
        y: f64,
        right: bool,
    ) {
        let sign = if right { 1.0 } else { -1.0 };
        // Keep the corner of the label nearest to the circle outside the circle.
        let (away, inner) = (radius + 18.0, ((y - centre[1]).abs() - 0.5 * LINE).max(0.0));
        let reach = (away * away - inner * inner).max(0.0).sqrt();
        let beside = sign * (self.end[0] - centre[0]) + if self.axis { 18.0 } else { 10.0 };
        let x = centre[0] + sign * reach.max(beside);
        if !self.axis {
            picture.line([self.end, [x - sign * 8.0, y]], 1.4, self.colour);
        }
        let x = if self.axis && inner == 0.0 { x + 18.0 } else { x };
        let size = if self.axis { NAME } else { NUMBER };
        let (text, size) =
            page::fit(&self.text, size, if right { area.right - x } else { x - area.left });
        let anchor = if right { Anchor::Start } else { Anchor::End };
        let text = Text::new([x, y + 0.36 * size], anchor, size, text);
        picture.text(Text { colour: self.colour, ..text });
    }
}

/// Shifts ascending heights so that neighbours are at least `gap` apart, with the least sum of squared shifts (pool
/// adjacent violators), and into `bounds` if there is enough space.
pub(crate) fn spread(wanted: &[f64], gap: f64, bounds: [f64; 2]) -> Vec<f64> {
    // Blocks of adjacent labels: sum of their preferred start positions, and number of labels.
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for (index, height) in wanted.iter().enumerate() {
        let mut group = (height - index as f64 * gap, 1);
        while let Some(&(sum, count)) = groups.last()
            && sum / count as f64 > group.0 / group.1 as f64
        {
            group = (group.0 + sum, group.1 + count);
            groups.pop();
        }
        groups.push(group);
    }
    let starts =
        groups.iter().flat_map(|&(sum, count)| std::iter::repeat_n(sum / count as f64, count));
    let highest = bounds[1] - wanted.len().saturating_sub(1) as f64 * gap;
    starts
        .enumerate()
        .map(|(index, start)| start.min(highest).max(bounds[0]) + index as f64 * gap)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::check_drawing;

    fn figure(angles: &[f64]) -> DirectionsFigure {
        let direction = |(index, &angle_deg): (usize, &f64)| Direction {
            label: format!("direction {index}"),
            angle_deg,
            multiplicity: 1 + index % 3,
            style: Style::ALL[index % 4],
        };
        DirectionsFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            directions: angles.iter().enumerate().map(direction).collect(),
        }
    }

    fn check(figure: &DirectionsFigure) {
        check_drawing(&figure.picture(), |format| figure.draw(format));
    }

    #[test]
    fn labels_keep_apart_whatever_the_directions() {
        check(&figure(&[]));
        check(&figure(&[0.0]));
        check(&figure(&[f64::NAN, f64::INFINITY, 1e300, -720.0]));
        check(&figure(&[0.0, 0.0, 90.0, 90.0, 180.0, -90.0]));
        check(&figure(&[88.0, 89.0, 90.0, 91.0, 92.0, 45.0, 45.0, 45.0]));
        let many: Vec<f64> = (0..70).map(f64::from).collect();
        check(&figure(&many));
        let mut long = figure(&[10.0, 20.0, 100.0]);
        long.directions[0].label = "a direction of some kind ".repeat(30);
        long.directions[2].label = "y".repeat(500);
        check(&long);
    }

    #[test]
    fn a_direction_and_its_opposite_are_drawn_alike() {
        let one = figure(&[30.0, 100.0]).draw(Format::Svg).unwrap();
        let other = figure(&[210.0, -80.0]).draw(Format::Svg).unwrap();
        let words = |svg: &[u8]| {
            let text = String::from_utf8(svg.to_vec()).unwrap();
            text.lines()
                .filter(|line| line.contains("direction"))
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(words(&one), words(&other));
        assert!(words(&one).len() >= 2);
    }

    #[test]
    fn heights_are_spread_no_more_than_needed() {
        let bounds = [0.0, 1000.0];
        assert_eq!(spread(&[100.0, 200.0, 300.0], 30.0, bounds), [100.0, 200.0, 300.0]);
        assert_eq!(spread(&[100.0, 100.0, 300.0], 30.0, bounds), [85.0, 115.0, 300.0]);
        assert_eq!(spread(&[5.0, 5.0], 30.0, bounds), [0.0, 30.0]);
        assert_eq!(spread(&[995.0, 999.0], 30.0, bounds), [970.0, 1000.0]);
        assert!(spread(&[], 30.0, bounds).is_empty());
    }

    #[test]
    fn words_name_a_direction_once() {
        let direction = |angle_deg, multiplicity| Direction {
            label: "α".to_owned(),
            angle_deg,
            multiplicity,
            style: Style::Characteristic,
        };
        assert_eq!(direction(-30.0, 1).words(), "α 150.0°");
        assert_eq!(direction(330.0, 2).words(), "α 150.0° (×2)");
        assert_eq!(direction(-1e-9, 1).words(), "α 0.0°");
    }
}
