//! Diagram of directions in the physical plane.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::page::{self, AXIS_NAME_SIZE, Legend, MARGIN, TICK_LABEL_SIZE};
use crate::picture::{
    Anchor, Colour, PALE_INK, Picture, Point, Rectangle, Text, circle_points, text_width,
};

/// Kind of a direction, which determines its line style.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DirectionKind {
    /// A characteristic direction of the steady equations: solid.
    Characteristic,
    /// A principal axis of stress: dashed.
    StressAxis,
    /// The direction of the velocity: dotted.
    Velocity,
    /// A principal axis of the deformation rate: dash-dotted.
    DeformationAxis,
}

impl DirectionKind {
    const ALL: [Self; 4] =
        [Self::Characteristic, Self::StressAxis, Self::DeformationAxis, Self::Velocity];

    fn description(self) -> &'static str {
        match self {
            Self::Characteristic => "characteristic direction",
            Self::StressAxis => "principal axis of stress",
            Self::Velocity => "velocity",
            Self::DeformationAxis => "principal axis of deformation rate",
        }
    }

    fn line_style(self) -> (&'static [f64], f64, Colour) {
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
    pub kind: DirectionKind,
}

/// Diagram of directions through a common point in the physical plane.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionsFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Directions, each drawn as a diameter of the circle.
    pub directions: Vec<Direction>,
}

const GUIDE_COLOUR: Colour = RGBColor(190, 190, 190);
const LABEL_HEIGHT: f64 = 1.45 * TICK_LABEL_SIZE;
/// Radial distance from the circle of the point whose height is the preferred height of a label, pixels.
const LABEL_CLEARANCE: f64 = 32.0;
/// Height above and below the circle for labels and arrow heads, pixels.
const RIM_HEIGHT: f64 = 76.0;

impl DirectionsFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    fn finite_directions(&self) -> impl Iterator<Item = &Direction> {
        self.directions.iter().filter(|direction| direction.angle_deg.is_finite())
    }

    /// Returns the legend text of a kind; on a narrow page, where only angles are beside the circle, with the labels of
    /// its directions.
    fn describe_kind(&self, kind: DirectionKind) -> String {
        let description = kind.description();
        let own =
            self.finite_directions().filter(|own| own.kind == kind && own.label != description);
        let mut labels: Vec<String> = Vec::new();
        let mut last = "";
        for direction in own.filter(|_| page::is_narrow()) {
            // A label that several directions have is written once.
            labels.push(match direction.label == last {
                true => direction.format_angle(),
                false => direction.format_label(),
            });
            last = &direction.label;
        }
        let separator = if labels.is_empty() { "" } else { ": " };
        format!("{description}{separator}{}", labels.join(", "))
    }

    fn to_picture(&self) -> Picture {
        let present = |style: &DirectionKind| {
            self.finite_directions().any(|direction| direction.kind == *style)
        };
        let entries = DirectionKind::ALL.into_iter().filter(present).map(|style| {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let (dashes, width, colour) = style.line_style();
                let y = 0.5 * (area.top + area.bottom);
                picture.draw_dashed_line(&[[area.left, y], [area.right, y]], dashes, width, colour);
            };
            (self.describe_kind(style), Box::new(swatch) as _)
        });
        let legend = Legend::new(entries.collect(), page::width() - 2.0 * MARGIN);

        let top = page::heading_bottom(&self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        // The area of the circle must be high enough for the columns of labels on its left and right.
        let sides = self.place_labels([0.0, 0.0], 1.0);
        let count = sides.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let plane = (count * LABEL_HEIGHT + 20.0).max(page::scale_height(700.0));
        let max_height = 2.0 * (self.max_radius() + RIM_HEIGHT);
        let usual_height = match page::is_narrow() {
            true => page::height().min(top + max_height + below),
            false => page::height(),
        };
        let height = usual_height.max(top + plane + below).ceil();
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let area =
            Rectangle { left: MARGIN, top, right: page::width() - MARGIN, bottom: height - below };
        self.draw_plane(&mut picture, area);
        legend.draw(&mut picture, MARGIN, area.bottom + 16.0);
        picture
    }

    /// Returns the largest radius of the circle, pixels.
    fn max_radius(&self) -> f64 {
        if !page::is_narrow() {
            return 420.0;
        }
        let widths = self
            .finite_directions()
            .map(|own| text_width(&own.format_label_beside_circle(), TICK_LABEL_SIZE, false));
        0.5 * page::width()
            - MARGIN
            - widths.fold(2.0 * TICK_LABEL_SIZE, f64::max)
            - LABEL_CLEARANCE
    }

    fn draw_plane(&self, picture: &mut Picture, area: Rectangle) {
        let radius = (0.5 * area.height() - RIM_HEIGHT).min(self.max_radius());
        let centre = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let at = |angle_deg: f64, radius: f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            [centre[0] + radius * cos, centre[1] - radius * sin]
        };

        let mut rim = circle_points(centre, radius, 180);
        rim.extend_from_within(..2);
        picture.draw_line(rim, 1.8, GUIDE_COLOUR);
        for step in 0..24 {
            let angle = 15.0 * f64::from(step);
            let length = if step % 3 == 0 { 16.0 } else { 9.0 };
            picture.draw_line([at(angle, radius), at(angle, radius - length)], 1.8, GUIDE_COLOUR);
        }
        for angle in [0.0, 90.0] {
            let tip = radius + 22.0;
            picture.draw_line([at(angle + 180.0, radius), at(angle, tip - 10.0)], 2.2, PALE_INK);
            let head = |turn: f64| {
                let [x, y] = at(angle, tip);
                let (sin, cos) = (angle + turn).to_radians().sin_cos();
                [x - 24.0 * cos, y + 24.0 * sin]
            };
            picture.fill_polygon(vec![at(angle, tip), head(18.0), head(-18.0)], PALE_INK);
        }

        // Wide lines first, so that narrower lines in the same direction remain visible.
        let mut directions: Vec<&Direction> = self.finite_directions().collect();
        directions.sort_by_key(|direction| direction.kind != DirectionKind::Characteristic);
        for direction in directions {
            let (dashes, width, colour) = direction.kind.line_style();
            let angle = direction.angle_deg;
            // Each half is drawn from the circle towards the centre, so that the dashes are symmetric about the centre.
            for end in [angle, angle + 180.0] {
                picture.draw_curve(&[at(end, radius), centre], dashes, width, colour);
            }
        }
        picture.fill_disc(centre, 8.0, RGBColor(0, 0, 0));

        for (side, labels) in self.place_labels(centre, radius).into_iter().enumerate() {
            let preferred: Vec<f64> = labels.iter().map(|label| label.preferred_height).collect();
            let heights = spread_heights(
                &preferred,
                LABEL_HEIGHT,
                [area.top + 0.5 * LABEL_HEIGHT, area.bottom - 0.5 * LABEL_HEIGHT],
            );
            for (label, y) in labels.iter().zip(heights) {
                label.draw(picture, area, centre, radius, y, side == 0);
            }
        }
    }

    /// Computes the labels on the right and on the left of the circle, from top to bottom. A direction is labelled at
    /// its upper end unless another label is near, otherwise at the end with more space.
    fn place_labels(&self, centre: Point, radius: f64) -> [Vec<DirectionLabel>; 2] {
        let place = |angle_deg: f64, clearance: f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            let line_end = [centre[0] + radius * cos, centre[1] - radius * sin];
            let preferred_height = centre[1] - (radius + clearance) * sin;
            (usize::from(cos < -1e-9), line_end, preferred_height)
        };
        let mut sides: [Vec<DirectionLabel>; 2] = [Vec::new(), Vec::new()];
        for (angle, name) in [(0.0, "x₁"), (90.0, "x₂")] {
            let (side, line_end, preferred_height) = place(angle, LABEL_CLEARANCE + 12.0);
            sides[side].push(DirectionLabel {
                line_end,
                preferred_height,
                text: name.to_owned(),
                colour: PALE_INK,
                is_axis: true,
            });
        }
        let mut directions: Vec<&Direction> = self.finite_directions().collect();
        directions.sort_by(|a, b| a.upper_angle().total_cmp(&b.upper_angle()));
        for direction in directions {
            let angle = direction.upper_angle();
            let ends = [angle, angle + 180.0].map(|angle| place(angle, LABEL_CLEARANCE));
            let label_distance = |&(side, _, preferred_height): &(usize, Point, f64)| {
                let distances = sides[side]
                    .iter()
                    .map(|other| (other.preferred_height - preferred_height).abs());
                distances.fold(f64::INFINITY, f64::min)
            };
            let [upper, lower] = ends;
            let lower_is_freer = label_distance(&upper) < LABEL_HEIGHT
                && label_distance(&lower) > label_distance(&upper);
            let (side, line_end, preferred_height) = if lower_is_freer { lower } else { upper };
            let (text, colour) =
                (direction.format_label_beside_circle(), direction.kind.line_style().2);
            sides[side].push(DirectionLabel {
                line_end,
                preferred_height,
                text,
                colour,
                is_axis: false,
            });
        }
        for side in &mut sides {
            side.sort_by(|a, b| a.preferred_height.total_cmp(&b.preferred_height));
        }
        sides
    }
}

impl Direction {
    /// Returns the angle of the upper end, degrees in [0, 180).
    fn upper_angle(&self) -> f64 {
        self.angle_deg.rem_euclid(180.0)
    }

    /// Formats the text beside the circle: on a narrow page without the label.
    fn format_label_beside_circle(&self) -> String {
        match page::is_narrow() {
            true => self.format_angle(),
            false => self.format_label(),
        }
    }

    fn format_label(&self) -> String {
        format!("{} {}", self.label, self.format_angle()).trim_start().to_owned()
    }

    /// Formats angle and multiplicity.
    fn format_angle(&self) -> String {
        // Equivalent angles have the same text; an angle that rounds to 180° is written as 0°.
        let angle = (10.0 * self.upper_angle()).round() / 10.0;
        let angle = if angle >= 180.0 { 0.0 } else { angle };
        let times = if self.multiplicity > 1 {
            format!(" (×{})", self.multiplicity)
        } else {
            String::new()
        };
        format!("{angle:.1}°{times}")
    }
}

/// A label at the end of a direction.
struct DirectionLabel {
    /// Point at which the direction meets the circle.
    line_end: Point,
    /// Preferred vertical position of the label's centre, pixels.
    preferred_height: f64,
    text: String,
    colour: Colour,
    /// Whether the label names an axis, which needs space for its arrow head.
    is_axis: bool,
}

impl DirectionLabel {
    /// Draws the label outside the circle at height `y`, with a leader line to the end of its direction.
    fn draw(
        &self,
        picture: &mut Picture,
        area: Rectangle,
        centre: Point,
        radius: f64,
        y: f64,
        is_right: bool,
    ) {
        let sign = if is_right { 1.0 } else { -1.0 };
        // Keep the corner of the label nearest to the circle outside the circle.
        let (away, inner) = (radius + 18.0, ((y - centre[1]).abs() - 0.5 * LABEL_HEIGHT).max(0.0));
        let reach = (away * away - inner * inner).max(0.0).sqrt();
        let beside = sign * (self.line_end[0] - centre[0]) + if self.is_axis { 18.0 } else { 10.0 };
        let x = centre[0] + sign * reach.max(beside);
        if !self.is_axis {
            picture.draw_line([self.line_end, [x - sign * 8.0, y]], 1.4, self.colour);
        }
        let x = if self.is_axis && inner == 0.0 { x + 18.0 } else { x };
        let size = if self.is_axis { AXIS_NAME_SIZE } else { TICK_LABEL_SIZE };
        let (text, size) =
            page::fit_text(&self.text, size, if is_right { area.right - x } else { x - area.left });
        let anchor = if is_right { Anchor::Start } else { Anchor::End };
        let text = Text::new([x, y + 0.36 * size], anchor, size, text);
        picture.draw_text(Text { colour: self.colour, ..text });
    }
}

/// Shifts ascending heights so that neighbours are at least `gap` apart, with the least sum of squared shifts, and into
/// `bounds` if there is enough space. Pool-adjacent-violators algorithm: labels that would be too close are merged into
/// a group at distances `gap`, which moves as a whole to its mean preferred position.
pub(crate) fn spread_heights(preferred: &[f64], gap: f64, bounds: [f64; 2]) -> Vec<f64> {
    // Groups of adjacent labels: sum of the preferred heights of the first label, one from each label; number of
    // labels.
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for (index, height) in preferred.iter().enumerate() {
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
    let highest = bounds[1] - preferred.len().saturating_sub(1) as f64 * gap;
    starts
        .enumerate()
        .map(|(index, start)| start.min(highest).max(bounds[0]) + index as f64 * gap)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FigureFormat;
    use crate::tests::check_drawing;

    fn sample_figure(angles: &[f64]) -> DirectionsFigure {
        let direction = |(index, &angle_deg): (usize, &f64)| Direction {
            label: format!("direction {index}"),
            angle_deg,
            multiplicity: 1 + index % 3,
            kind: DirectionKind::ALL[index % 4],
        };
        DirectionsFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            directions: angles.iter().enumerate().map(direction).collect(),
        }
    }

    fn check_figure(figure: &DirectionsFigure) {
        check_drawing(&figure.to_picture(), |format| figure.draw(format));
    }

    #[test]
    fn labels_do_not_overlap_for_any_directions() {
        check_figure(&sample_figure(&[]));
        check_figure(&sample_figure(&[0.0]));
        check_figure(&sample_figure(&[f64::NAN, f64::INFINITY, 1e300, -720.0]));
        check_figure(&sample_figure(&[0.0, 0.0, 90.0, 90.0, 180.0, -90.0]));
        check_figure(&sample_figure(&[88.0, 89.0, 90.0, 91.0, 92.0, 45.0, 45.0, 45.0]));
        let many: Vec<f64> = (0..70).map(f64::from).collect();
        check_figure(&sample_figure(&many));
        let mut long = sample_figure(&[10.0, 20.0, 100.0]);
        long.directions[0].label = "a direction of some kind ".repeat(30);
        long.directions[2].label = "y".repeat(500);
        check_figure(&long);
    }

    #[test]
    fn opposite_directions_are_drawn_alike() {
        let one = sample_figure(&[30.0, 100.0]).draw(FigureFormat::Svg).unwrap();
        let other = sample_figure(&[210.0, -80.0]).draw(FigureFormat::Svg).unwrap();
        let label_text = |svg: &[u8]| {
            let text = String::from_utf8(svg.to_vec()).unwrap();
            text.lines()
                .filter(|line| line.contains("direction"))
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(label_text(&one), label_text(&other));
        assert!(label_text(&one).len() >= 2);
    }

    #[test]
    fn heights_are_shifted_no_more_than_needed() {
        let bounds = [0.0, 1000.0];
        assert_eq!(spread_heights(&[100.0, 200.0, 300.0], 30.0, bounds), [100.0, 200.0, 300.0]);
        assert_eq!(spread_heights(&[100.0, 100.0, 300.0], 30.0, bounds), [85.0, 115.0, 300.0]);
        assert_eq!(spread_heights(&[5.0, 5.0], 30.0, bounds), [0.0, 30.0]);
        assert_eq!(spread_heights(&[995.0, 999.0], 30.0, bounds), [970.0, 1000.0]);
        assert!(spread_heights(&[], 30.0, bounds).is_empty());
    }

    #[test]
    fn equivalent_directions_have_equal_labels() {
        let direction = |angle_deg, multiplicity| Direction {
            label: "α".to_owned(),
            angle_deg,
            multiplicity,
            kind: DirectionKind::Characteristic,
        };
        assert_eq!(direction(-30.0, 1).format_label(), "α 150.0°");
        assert_eq!(direction(330.0, 2).format_label(), "α 150.0° (×2)");
        assert_eq!(direction(-1e-9, 1).format_label(), "α 0.0°");
    }
}
