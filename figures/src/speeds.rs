//! Polar diagram of characteristic speeds against the direction of the wave normal.

use plotters::style::RGBColor;

use crate::error::FigureError;
use crate::format::Format;
use crate::growth::{LINE_WIDTH, LOOKS, draw_marker};
use crate::page::{self, Entry, Legend, MARGIN};
use crate::picture::{Colour, PALE_INK, Picture, Point, Rectangle, WHITE};
use crate::polar::{
    DEGREES, Label, NEUTRAL, RING, RING_LABEL, ROW, Spoke, SpokeStyle, at, backing, best_numbers,
    draw_degrees, draw_labels, draw_markers, labels, most_numbers, parts, places, ring,
};
use crate::scale::{self, Tick};

/// Response of the solid: elastic or yielding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response {
    /// Elastic response: drawn grey and dotted.
    Elastic,
    /// Yielding response: drawn solid, in colour and with markers.
    Yielding,
}

/// A characteristic speed against the direction of the wave normal.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedCurve {
    /// Legend text. Curves with the same label, response and multiplicity share a style and are listed once.
    pub label: String,
    /// Pairs of direction of the normal, degrees from 0 to 180 (opposite normals have the same speeds), and speed. NaN
    /// interrupts the line; the magnitude of negative speeds is drawn.
    pub points: Vec<[f64; 2]>,
    /// Response, which determines the style.
    pub response: Response,
    /// Multiplicity of the speed: up to three parallel lines are drawn, and the legend states the multiplicity.
    pub multiplicity: usize,
}

/// A direction of the wave normal in which a characteristic speed is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Vanishing {
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
    /// Name and symbol of the speed, for the legend.
    pub speed_label: String,
    /// Unit of the speed, written on the outermost ring.
    pub unit: String,
    /// Curves; the first eight labels of the yielding solid have distinct styles.
    pub curves: Vec<SpeedCurve>,
    /// Flutter sectors: first and last direction, degrees anticlockwise; the opposite sectors are shaded as well.
    pub flutter: Vec<[f64; 2]>,
    /// Sectors in which a speed is imaginary (growing shear bands): first and last direction, degrees anticlockwise;
    /// the opposite sectors are shaded as well.
    pub imaginary: Vec<[f64; 2]>,
    /// Directions of the wave normal in which a speed is zero.
    pub vanishing: Vec<Vanishing>,
}

const ELASTIC: Colour = RGBColor(110, 110, 110);
const ELASTIC_DASHES: &[f64] = &[3.0, 5.0];
const ELASTIC_WIDTH: f64 = 2.8;
const FLUTTER: Colour = RGBColor(253, 226, 212);
/// Colour of the arcs that hatch flutter sectors, for greyscale.
const FLUTTER_ARC: Colour = RGBColor(240, 184, 160);
const IMAGINARY: Colour = RGBColor(222, 226, 238);
/// Colour of the rays that hatch sectors of imaginary speeds, for greyscale.
const IMAGINARY_RAY: Colour = RGBColor(150, 158, 186);
/// Minimum width of a drawn sector, degrees.
const NARROWEST: f64 = 0.4;
/// Magnitude above which speeds are treated as infinite.
const FINITE: f64 = 1e300;

impl SpeedsFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    fn spokes(&self) -> Vec<Spoke> {
        let known = self.vanishing.iter().filter(|ray| ray.angle_deg.is_finite());
        known
            .map(|ray| Spoke {
                label: ray.label.clone(),
                angle_deg: ray.angle_deg,
                style: SpokeStyle::Degenerate,
            })
            .collect()
    }

    /// Converts sectors from first and last direction to first angle and width, degrees.
    fn sectors(ends: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let known = ends.iter().filter(|ends| ends.iter().all(|end| end.is_finite()));
        known
            .map(|&[from, to]| {
                let width = (to - from).rem_euclid(360.0);
                let width = if width == 0.0 && to != from { 180.0 } else { width.min(180.0) };
                let wider = width.max(NARROWEST);
                [from.rem_euclid(360.0) - 0.5 * (wider - width), wider]
            })
            .collect()
    }

    /// Returns the index of a curve's label among the distinct labels of its response, which determines the style.
    fn look_of(&self, index: usize) -> usize {
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

    fn legend(&self) -> Vec<Entry> {
        let mut entries: Vec<Entry> = Vec::new();
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
            let (look, response, multiplicity) =
                (self.look_of(index), curve.response, curve.multiplicity);
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let y = middle(area);
                let ends = [[area.left, y], [area.right, y]];
                stroke(picture, &ends, response, look, multiplicity);
                if response == Response::Yielding {
                    let at = [0.5 * (area.left + area.right), y];
                    draw_marker(picture, at, &LOOKS[look % LOOKS.len()]);
                }
            };
            let words = match curve.multiplicity {
                0 | 1 => curve.label.clone(),
                2 => format!("{} (double)", curve.label),
                3 => format!("{} (triple)", curve.label),
                count => format!("{} ({count}-fold)", curve.label),
            };
            entries.push((words, Box::new(swatch)));
        }
        if !Self::sectors(&self.flutter).is_empty() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.fill(area, FLUTTER);
                for share in [0.25, 0.5, 0.75] {
                    let y = area.top + share * area.height();
                    picture.line([[area.left, y], [area.right, y]], 1.2, FLUTTER_ARC);
                }
                picture.frame(area, 1.5, PALE_INK);
            };
            entries.push(("flutter: complex speeds".to_owned(), Box::new(swatch)));
        }
        if !Self::sectors(&self.imaginary).is_empty() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                picture.fill(area, IMAGINARY);
                for share in [0.2, 0.4, 0.6, 0.8] {
                    let x = area.left + share * area.width();
                    picture.line([[x, area.top], [x, area.bottom]], 1.2, IMAGINARY_RAY);
                }
                picture.frame(area, 1.5, PALE_INK);
            };
            entries.push(("shear bands: imaginary speeds".to_owned(), Box::new(swatch)));
        }
        if !self.spokes().is_empty() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let ends = [[area.left, middle(area)], [area.right, middle(area)]];
                SpokeStyle::Degenerate.draw(picture, &ends);
            };
            entries.push(("normal with vanishing speed".to_owned(), Box::new(swatch)));
        }
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            let (y, half) = (middle(area), 0.5 * area.width());
            picture.line([[area.left, y], [area.right, y]], 1.8, NEUTRAL);
            let head = |side: f64| [area.right - 0.35 * half, y + side];
            picture.polygon(vec![[area.right, y], head(7.0), head(-7.0)], NEUTRAL);
        };
        entries.push((format!("radius: {}", self.speed_label), Box::new(swatch)));
        entries
    }

    fn picture(&self) -> Picture {
        let legend = Legend::new(self.legend(), page::WIDTH - 2.0 * MARGIN);
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let spokes = self.spokes();
        let sides = labels(spokes.iter());
        let count = sides.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let plane = (count * ROW + 20.0).max(780.0);
        let height = (page::HEIGHT + 60.0).max(top + plane + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let area =
            Rectangle { left: MARGIN, top, right: page::WIDTH - MARGIN, bottom: height - below };
        self.draw_disc(&mut picture, area, &spokes, &sides);
        legend.draw(&mut picture, MARGIN, area.bottom + 16.0);
        picture
    }

    /// Returns the speed at the rim.
    fn range(&self) -> f64 {
        let speeds = self.curves.iter().flat_map(|curve| &curve.points).map(|point| point[1].abs());
        let largest = speeds.filter(|speed| *speed < FINITE).fold(0.0, f64::max);
        // Smaller speeds are treated as zero.
        if largest > 1.0 / FINITE { 1.08 * largest } else { 1.0 }
    }

    fn draw_disc(
        &self,
        picture: &mut Picture,
        area: Rectangle,
        spokes: &[Spoke],
        sides: &[Vec<Label>; 2],
    ) {
        let radius = (0.5 * area.height() - DEGREES - 0.7 * RING_LABEL).min(440.0);
        let centre = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let range = self.range();
        // Infinite speeds are drawn just inside the rim.
        let radius_of = |speed: f64| radius * (speed.abs() / range).min(0.985);

        for (ends, ground) in [(&self.imaginary, IMAGINARY), (&self.flutter, FLUTTER)] {
            for [from, width] in Self::sectors(ends) {
                for turn in [0.0, 180.0] {
                    let sector = sector(centre, radius, from + turn, width);
                    picture.polygon(sector, ground);
                    match ground {
                        FLUTTER => draw_arcs(picture, centre, radius, from + turn, width),
                        _ => draw_rays(picture, centre, radius, from + turn, width),
                    }
                }
            }
        }
        let most = most_numbers(radius).min(7);
        let rings: Vec<Tick> = scale::ticks(0.0, range, most, false)
            .into_iter()
            .filter(|(speed, _)| *speed > 0.0)
            .map(|(speed, label)| (radius * speed / range, label))
            // Numbers near the centre would cover the curves and are omitted.
            .map(|(size, label)| (size, if size < 0.2 * radius { String::new() } else { label }))
            .collect();
        for (size, _) in &rings {
            ring(picture, centre, *size, 1.4, RING);
        }
        for turn in [0.0, 90.0] {
            let ends = [at(centre, turn, radius), at(centre, turn + 180.0, radius)];
            picture.line(ends, 1.4, RING);
        }
        for spoke in spokes {
            // From the rim inwards, so that the dashes are symmetric.
            for end in [spoke.angle_deg, spoke.angle_deg + 180.0] {
                spoke.style.draw(picture, &[at(centre, end, radius), centre]);
            }
        }
        ring(picture, centre, radius, 1.8, NEUTRAL);
        let leaders: Vec<[Point; 2]> = sides
            .iter()
            .enumerate()
            .flat_map(|(side, labels)| {
                draw_labels(picture, area, centre, radius, labels, side == 0)
            })
            .collect();
        draw_degrees(picture, centre, radius, &leaders);

        let lines: Vec<Vec<(f64, Point)>> =
            self.curves.iter().map(|curve| places(&curve.points, centre, radius_of)).collect();
        // Elastic speeds are drawn below the speeds of the yielding solid.
        for response in [Response::Elastic, Response::Yielding] {
            let of_it = |index: &usize| self.curves[*index].response == response;
            for index in (0..lines.len()).filter(of_it) {
                let look = self.look_of(index);
                for part in parts(&lines[index]) {
                    let multiplicity = self.curves[index].multiplicity;
                    stroke(picture, &part, response, look, multiplicity);
                }
            }
        }
        for (index, curve) in self.curves.iter().enumerate() {
            if curve.response == Response::Yielding {
                draw_markers(picture, centre, self.look_of(index), &lines[index]);
            }
        }
        let angles: Vec<f64> = spokes.iter().map(|spoke| spoke.angle_deg).collect();
        for text in best_numbers(&rings, &self.unit, &angles, centre, radius, &lines) {
            picture.fill(backing(&text), WHITE);
            picture.text(text);
        }
    }
}

/// Draws a line as `multiplicity` parallel lines, at most three.
fn stroke(
    picture: &mut Picture,
    line: &[Point],
    response: Response,
    look: usize,
    multiplicity: usize,
) {
    let (dashes, width, colour) = match response {
        Response::Elastic => (ELASTIC_DASHES, ELASTIC_WIDTH, ELASTIC),
        Response::Yielding => (&[][..], LINE_WIDTH, LOOKS[look % LOOKS.len()].colour),
    };
    let gap = 3.0;
    let (outer, inner) = match multiplicity {
        0 | 1 => (0.0, width),
        2 => (0.75 * width * 2.0 + gap, 0.0),
        _ => (0.75 * width * 3.0 + 2.0 * gap, 0.75 * width),
    };
    if outer > 0.0 {
        picture.dashed(line, dashes, outer, colour);
        picture.dashed(line, &[], outer - 1.5 * width, WHITE);
    }
    if inner > 0.0 {
        picture.dashed(line, dashes, inner, colour);
    }
}

/// Computes points along an arc; angles in degrees, radius in pixels.
fn arc(centre: Point, radius: f64, from: f64, width: f64) -> Vec<Point> {
    let steps = width.ceil().max(2.0);
    (0..=steps as usize)
        .map(|step| at(centre, from + width * step as f64 / steps, radius))
        .collect()
}

/// Computes the polygon of a circular sector.
fn sector(centre: Point, radius: f64, from: f64, width: f64) -> Vec<Point> {
    let mut sector = arc(centre, radius, from, width);
    sector.push(centre);
    sector
}

/// Draws the hatching of flutter sectors, visible in greyscale.
fn draw_arcs(picture: &mut Picture, centre: Point, radius: f64, from: f64, width: f64) {
    let mut size = 14.0;
    while size < radius {
        picture.line(arc(centre, size, from, width), 1.2, FLUTTER_ARC);
        size += 12.0;
    }
}

/// Draws the hatching of sectors of imaginary speeds, visible in greyscale.
fn draw_rays(picture: &mut Picture, centre: Point, radius: f64, from: f64, width: f64) {
    let count = (width / 3.0).ceil().max(2.0);
    for ray in 0..=count as usize {
        let angle = from + width * ray as f64 / count;
        picture.line(
            [at(centre, angle, 0.2 * radius), at(centre, angle, radius)],
            1.2,
            IMAGINARY_RAY,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, odd_curves};

    fn figure(points: &[[f64; 2]], flutter: &[[f64; 2]], rays: &[f64]) -> SpeedsFigure {
        let curve = |response, multiplicity| SpeedCurve {
            label: format!("wave {multiplicity}"),
            points: points.to_vec(),
            response,
            multiplicity,
        };
        let ray = |&angle_deg: &f64| Vanishing { label: "shear band".to_owned(), angle_deg };
        SpeedsFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            speed_label: "characteristic speed c".to_owned(),
            unit: "m/s".to_owned(),
            curves: (0..5)
                .flat_map(|multiplicity| {
                    [Response::Elastic, Response::Yielding].map(|of| curve(of, multiplicity))
                })
                .collect(),
            flutter: flutter.to_vec(),
            imaginary: flutter.iter().map(|ends| ends.map(|end| end + 60.0)).collect(),
            vanishing: rays.iter().map(ray).collect(),
        }
    }

    fn check(figure: &SpeedsFigure) {
        check_drawing(&figure.picture(), |format| figure.draw(format));
    }

    #[test]
    fn any_points_are_drawn() {
        for points in odd_curves() {
            check(&figure(&points, &[[10.0, 20.0], [f64::NAN, 3.0]], &[15.0, 75.0]));
        }
        let mut empty = figure(&[], &[], &[]);
        empty.curves.clear();
        check(&empty);
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
            check(&figure(&points, &sectors, rays));
        }
        let figure = figure(&points, &[[-10.0, 20.0], [30.0, 30.0], [0.0, 360.0]], &[]);
        let sectors = SpeedsFigure::sectors(&figure.flutter);
        assert_eq!([sectors[0], sectors[2]], [[350.0, 30.0], [0.0, 180.0]]);
        assert!((sectors[1][1] - NARROWEST).abs() < 1e-12 && sectors[1][0] < 30.0);
    }
}
