//! Polar diagram of characteristic speeds against the direction of the wave normal.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::LineStyle;
use crate::page::LegendEntry;
use crate::picture::{Colour, PALE_INK, Picture, Point, Rectangle, WHITE};
use crate::polar::{
    DiscPage, NEUTRAL_COLOUR, RING_COLOUR, Spoke, SpokeStyle, build_labels, draw_circle,
    full_circle_points, max_ring_numbers, polar_to_point, split_at_gaps,
};
use crate::scale::{self, FINITE_LIMIT, Tick};
use crate::verdict_map::{HatchLines, VERTICAL_DIRECTION, draw_hatch, is_inside};

/// Response of the solid: elastic or yielding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolidResponse {
    /// Elastic response: drawn grey and dotted.
    Elastic,
    /// Yielding response: drawn in colour, each speed with its own dashes.
    Yielding,
}

/// A characteristic speed against the direction of the wave normal.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedCurve {
    /// Legend text. Curves with the same label and response share a style; those that also have the same multiplicity
    /// are listed once.
    pub label: String,
    /// Pairs of direction of the normal, degrees from 0 to 180 (opposite normals have the same speeds), and speed. NaN
    /// interrupts the line; the magnitude of negative speeds is drawn.
    pub points: Vec<[f64; 2]>,
    /// Response, which determines the style.
    pub response: SolidResponse,
    /// Multiplicity of the speed: up to three parallel lines are drawn, and the legend states the multiplicity.
    pub multiplicity: usize,
}

/// A direction of the wave normal in which a characteristic speed is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroSpeedNormal {
    /// Label of a few words, written after the angle; may be empty.
    pub label: String,
    /// Angle from x₁, degrees anticlockwise. Directions with a non-finite angle are not drawn.
    pub angle_deg: f64,
}

/// Polar diagram of the characteristic speeds of the elastic and of the yielding solid against the direction of the
/// wave normal in a plane.
///
/// The radius is the speed. Sectors with complex (flutter) or imaginary speeds are shaded; directions in which a speed
/// is zero are dashed lines through the centre.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedsFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name and symbol of the speed, for the axis of the radius.
    pub speed_label: String,
    /// Unit of the speed.
    pub unit: String,
    /// Curves; the first eight labels of the yielding solid have distinct styles.
    pub curves: Vec<SpeedCurve>,
    /// Flutter sectors: first and last direction, degrees anticlockwise; the opposite sectors are shaded as well.
    pub flutter_sectors: Vec<[f64; 2]>,
    /// Sectors in which a speed is imaginary (growing shear bands): first and last direction, degrees anticlockwise;
    /// the opposite sectors are shaded as well.
    pub imaginary_sectors: Vec<[f64; 2]>,
    /// Directions of the wave normal in which a speed is zero.
    pub zero_speed_normals: Vec<ZeroSpeedNormal>,
}

const ELASTIC_COLOUR: Colour = RGBColor(110, 110, 110);
const ELASTIC_DASHES: &[f64] = &[3.0, 5.0];
const ELASTIC_WIDTH: f64 = 2.8;
/// Fill colour of flutter sectors, without hatching as in maps.
const FLUTTER_COLOUR: Colour = RGBColor(248, 208, 184);
/// Fill colour of sectors in which a speed is imaginary.
const IMAGINARY_SECTOR_COLOUR: Colour = RGBColor(222, 226, 238);
/// Hatching of sectors in which a speed is imaginary: vertical lines, as for shear bands in maps.
const SHEAR_BAND_HATCH: HatchLines = HatchLines {
    direction: VERTICAL_DIRECTION,
    spacing: 10.0,
    line_width: 1.2,
    colour: RGBColor(150, 158, 186),
};
/// Minimum width of a drawn sector, degrees.
const MIN_SECTOR_WIDTH: f64 = 0.4;

impl SpeedsFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    fn spokes(&self) -> Vec<Spoke> {
        let known = self.zero_speed_normals.iter().filter(|ray| ray.angle_deg.is_finite());
        known
            .map(|ray| Spoke {
                label: ray.label.clone(),
                angle_deg: ray.angle_deg,
                style: SpokeStyle::DegenerateDirection,
            })
            .collect()
    }

    /// Converts sectors from first and last direction to first angle and width, degrees; the width is at least
    /// [`MIN_SECTOR_WIDTH`] and at most 180°. Sectors with a non-finite direction are omitted.
    fn to_start_and_width(ends: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let known = ends.iter().filter(|ends| ends.iter().all(|end| end.is_finite()));
        known
            .map(|&[from, to]| {
                let width = (to - from).rem_euclid(360.0);
                let width = if width == 0.0 && to != from { 180.0 } else { width.min(180.0) };
                let wider = width.max(MIN_SECTOR_WIDTH);
                [from.rem_euclid(360.0) - 0.5 * (wider - width), wider]
            })
            .collect()
    }

    /// Returns the index of a curve's label among the distinct labels of its response, which determines the style.
    fn style_index(&self, index: usize) -> usize {
        let response = self.curves[index].response;
        let mut labels: Vec<&str> = Vec::new();
        for curve in self.curves[..=index].iter().filter(|other| other.response == response) {
            if !labels.contains(&curve.label.as_str()) {
                labels.push(&curve.label);
            }
        }
        let label = &self.curves[index].label;
        labels.iter().position(|other| other == label).unwrap_or(0)
    }

    fn legend_entries(&self) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        let middle = |area: Rectangle| 0.5 * (area.top + area.bottom);
        for (index, curve) in self.curves.iter().enumerate() {
            let known = |other: &SpeedCurve| {
                other.label == curve.label
                    && other.response == curve.response
                    && other.multiplicity == curve.multiplicity
            };
            if self.curves[..index].iter().any(known) {
                continue;
            }
            let (style, response, multiplicity) =
                (self.style_index(index), curve.response, curve.multiplicity);
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let y = middle(area);
                let ends = [[area.left, y], [area.right, y]];
                draw_parallel_lines(picture, &ends, response, style, multiplicity);
            };
            let label_text = match curve.multiplicity {
                0 | 1 => curve.label.clone(),
                2 => format!("{} (double)", curve.label),
                3 => format!("{} (triple)", curve.label),
                count => format!("{} ({count}-fold)", curve.label),
            };
            entries.push((label_text, Box::new(swatch)));
        }
        if !Self::to_start_and_width(&self.flutter_sectors).is_empty() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.fill_rectangle(area, FLUTTER_COLOUR);
                picture.draw_frame(area, 1.5, PALE_INK);
            };
            entries.push(("flutter: complex speeds".to_owned(), Box::new(swatch)));
        }
        if !Self::to_start_and_width(&self.imaginary_sectors).is_empty() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.fill_rectangle(area, IMAGINARY_SECTOR_COLOUR);
                draw_hatch(picture, area, SHEAR_BAND_HATCH, |_| true);
                picture.draw_frame(area, 1.5, PALE_INK);
            };
            entries.push(("shear bands: imaginary speeds".to_owned(), Box::new(swatch)));
        }
        if !self.spokes().is_empty() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let ends = [[area.left, middle(area)], [area.right, middle(area)]];
                SpokeStyle::DegenerateDirection.draw(picture, &ends);
            };
            entries.push(("normal with zero speed, as named".to_owned(), Box::new(swatch)));
        }
        entries
    }

    fn to_picture(&self) -> Picture {
        let spokes = self.spokes();
        let labels = build_labels(spokes.iter());
        let mut page = DiscPage::new([&self.title, &self.subtitle], self.legend_entries(), labels);
        self.draw_disc(&mut page, &spokes);
        page.into_picture()
    }

    /// Returns the speed at the rim.
    fn rim_speed(&self) -> f64 {
        let speeds = self.curves.iter().flat_map(|curve| &curve.points).map(|point| point[1].abs());
        let largest = speeds.filter(|speed| *speed < FINITE_LIMIT).fold(0.0, f64::max);
        // If no speed exceeds 1/FINITE_LIMIT, all are treated as zero.
        if largest > 1.0 / FINITE_LIMIT { 1.08 * largest } else { 1.0 }
    }

    fn draw_disc(&self, page: &mut DiscPage, spokes: &[Spoke]) {
        let (centre, radius) = (page.centre, page.radius);
        let picture = &mut page.picture;
        let rim_speed = self.rim_speed();
        // Infinite speeds are drawn just inside the rim.
        let to_radius = |speed: f64| radius * (speed.abs() / rim_speed).min(0.985);

        for (ends, ground) in [
            (&self.imaginary_sectors, IMAGINARY_SECTOR_COLOUR),
            (&self.flutter_sectors, FLUTTER_COLOUR),
        ] {
            for [from, width] in Self::to_start_and_width(ends) {
                for turn in [0.0, 180.0] {
                    let sector = sector_polygon(centre, radius, from + turn, width);
                    picture.fill_polygon(sector.clone(), ground);
                    if ground == IMAGINARY_SECTOR_COLOUR {
                        let [x, y] = centre;
                        let [left, top, right, bottom] =
                            [x - radius, y - radius, x + radius, y + radius];
                        let disc = Rectangle { left, top, right, bottom };
                        draw_hatch(picture, disc, SHEAR_BAND_HATCH, |at| is_inside(&sector, at));
                    }
                }
            }
        }
        let max_count = max_ring_numbers(radius).min(7);
        let rings: Vec<Tick> = scale::linear_ticks(0.0, rim_speed, max_count, false)
            .into_iter()
            .map(|(speed, label)| (radius * speed / rim_speed, label))
            .collect();
        for (size, _) in rings.iter().filter(|(size, _)| *size > 0.0) {
            draw_circle(picture, centre, *size, 1.4, RING_COLOUR);
        }
        for turn in [0.0, 90.0] {
            let ends = [
                polar_to_point(centre, turn, radius),
                polar_to_point(centre, turn + 180.0, radius),
            ];
            picture.draw_line(ends, 1.4, RING_COLOUR);
        }
        for spoke in spokes {
            // Each half is drawn from the rim inwards, so that the dashes are symmetric about the centre.
            for end in [spoke.angle_deg, spoke.angle_deg + 180.0] {
                spoke.style.draw(picture, &[polar_to_point(centre, end, radius), centre]);
            }
        }
        draw_circle(picture, centre, radius, 1.8, NEUTRAL_COLOUR);
        page.draw_labels();
        let picture = &mut page.picture;

        let lines: Vec<Vec<(f64, Point)>> = self
            .curves
            .iter()
            .map(|curve| full_circle_points(&curve.points, centre, to_radius))
            .collect();
        // Elastic speeds are drawn below the speeds of the yielding solid.
        for response in [SolidResponse::Elastic, SolidResponse::Yielding] {
            let has_response = |index: &usize| self.curves[*index].response == response;
            for index in (0..lines.len()).filter(has_response) {
                let style = self.style_index(index);
                for part in split_at_gaps(&lines[index]) {
                    let multiplicity = self.curves[index].multiplicity;
                    draw_parallel_lines(picture, &part, response, style, multiplicity);
                }
            }
        }
        page.draw_radius_axis(&rings, &format!("{} ({})", self.speed_label, self.unit), 0.0);
    }
}

/// Draws a line as `multiplicity` parallel lines, at most three.
fn draw_parallel_lines(
    picture: &mut Picture,
    line: &[Point],
    response: SolidResponse,
    style: usize,
    multiplicity: usize,
) {
    let (dashes, width, colour) = match response {
        SolidResponse::Elastic => (ELASTIC_DASHES, ELASTIC_WIDTH, ELASTIC_COLOUR),
        SolidResponse::Yielding => {
            let style = LineStyle::from_index(style);
            (style.dashes, style.width, style.colour)
        }
    };
    let gap = 3.0;
    let (outer, inner) = match multiplicity {
        0 | 1 => (0.0, width),
        2 => (0.75 * width * 2.0 + gap, 0.0),
        _ => (0.75 * width * 3.0 + 2.0 * gap, 0.75 * width),
    };
    if outer > 0.0 {
        picture.draw_curve(line, dashes, outer, colour);
        picture.draw_dashed_line(line, &[], outer - 1.5 * width, WHITE);
    }
    if inner > 0.0 {
        picture.draw_curve(line, dashes, inner, colour);
    }
}

/// Computes points along an arc; angles in degrees, radius in pixels.
fn arc_points(centre: Point, radius: f64, start: f64, width: f64) -> Vec<Point> {
    let steps = width.ceil().max(2.0);
    (0..=steps as usize)
        .map(|step| polar_to_point(centre, start + width * step as f64 / steps, radius))
        .collect()
}

/// Computes the polygon of a circular sector.
fn sector_polygon(centre: Point, radius: f64, start: f64, width: f64) -> Vec<Point> {
    let mut sector = arc_points(centre, radius, start, width);
    sector.push(centre);
    sector
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, edge_case_curves};

    fn sample_figure(points: &[[f64; 2]], flutter: &[[f64; 2]], rays: &[f64]) -> SpeedsFigure {
        let curve = |response, multiplicity| SpeedCurve {
            label: format!("wave {multiplicity}"),
            points: points.to_vec(),
            response,
            multiplicity,
        };
        let ray = |&angle_deg: &f64| ZeroSpeedNormal { label: "shear band".to_owned(), angle_deg };
        SpeedsFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            speed_label: "characteristic speed c".to_owned(),
            unit: "m/s".to_owned(),
            curves: (0..5)
                .flat_map(|multiplicity| {
                    [SolidResponse::Elastic, SolidResponse::Yielding]
                        .map(|of| curve(of, multiplicity))
                })
                .collect(),
            flutter_sectors: flutter.to_vec(),
            imaginary_sectors: flutter.iter().map(|ends| ends.map(|end| end + 60.0)).collect(),
            zero_speed_normals: rays.iter().map(ray).collect(),
        }
    }

    fn check_figure(figure: &SpeedsFigure) {
        check_drawing(&figure.to_picture(), |format| figure.draw(format));
    }

    #[test]
    fn any_points_are_drawn() {
        for points in edge_case_curves() {
            check_figure(&sample_figure(&points, &[[10.0, 20.0], [f64::NAN, 3.0]], &[15.0, 75.0]));
        }
        let mut empty = sample_figure(&[], &[], &[]);
        empty.curves.clear();
        check_figure(&empty);
    }

    #[test]
    fn any_directions_are_drawn() {
        let points = [[0.0, 1000.0], [90.0, 2000.0], [180.0, 1000.0]];
        let sets: [&[f64]; 4] = [
            &[f64::NAN, f64::INFINITY, 1e300, -720.0],
            &[0.0, 0.0, 90.0, 180.0, -90.0],
            &[85.0, 88.0, 89.0, 90.0, 91.0, 92.0, 95.0],
            &[14.95, 15.0, 75.0, 75.05, 30.0, 29.0],
        ];
        for rays in sets {
            let sectors: Vec<[f64; 2]> = rays.iter().map(|&ray| [ray, ray + 7.0]).collect();
            check_figure(&sample_figure(&points, &sectors, rays));
        }
        let figure = sample_figure(&points, &[[-10.0, 20.0], [30.0, 30.0], [0.0, 360.0]], &[]);
        let sectors = SpeedsFigure::to_start_and_width(&figure.flutter_sectors);
        assert_eq!([sectors[0], sectors[2]], [[350.0, 30.0], [0.0, 180.0]]);
        assert!((sectors[1][1] - MIN_SECTOR_WIDTH).abs() < 1e-12 && sectors[1][0] < 30.0);
    }
}
