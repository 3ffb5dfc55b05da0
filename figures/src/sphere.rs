//! Map of a quantity over all wave normals in space, on a hemisphere.

use std::f64::consts::SQRT_2;

use plotters::style::RGBColor;

use crate::contour;
use crate::dispersion::{TAG, draw_tag, tag_area};
use crate::error::FigureError;
use crate::format::Format;
use crate::page::{self, Entry, Legend, MARGIN, NAME, NUMBER, RULE};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, polyline_length,
    text_width,
};
use crate::polar::{DEGREES, RING_LABEL, at, backing, draw_degrees, ring};
use crate::scale::{self, Tick, plain};
use crate::verdict_map::{BAR, BAR_GAP, LEVEL_MISSING, colour_on_shade, draw_shades, runs, shade};

/// A marked wave normal.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereMark {
    /// Legend text, followed by the components of the normal. The number of the mark is shown in the legend and on the
    /// map.
    pub label: String,
    /// Normal vector, of any length; opposite normals are equivalent. Zero and non-finite vectors are not drawn.
    pub normal: [f64; 3],
}

/// Map of a quantity over all wave normals, on a hemisphere in Lambert's azimuthal equal-area projection: x₃ at the
/// centre, x₁ to the right and x₂ upwards on the rim. Opposite normals describe the same wave, so that a hemisphere
/// suffices.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Polar angles from x₃, degrees from 0 to 90, ascending.
    pub polar_deg: Vec<f64>,
    /// Azimuths from x₁ towards x₂ over the full circle, degrees, ascending; the azimuth 360° may be omitted.
    pub azimuth_deg: Vec<f64>,
    /// Value for each pair of angles, azimuth varying fastest; NaN if missing. Values are interpolated between the
    /// angles; with steps of one degree the edges of missing values are smooth.
    pub values: Vec<f64>,
    /// Name, symbol and unit of the values.
    pub value_label: String,
    /// Whether the colour scale is logarithmic; non-positive values are then missing.
    pub value_log: bool,
    /// Whether dark colours represent low values instead of high values.
    pub dark_is_low: bool,
    /// Legend text for normals with missing values.
    pub missing_label: String,
    /// Marked normals.
    pub marks: Vec<SphereMark>,
}

/// Edge of a cell of the map, pixels.
const CELL: f64 = 3.0;
/// Minimum length of open contour lines, pixels.
const SHORTEST: f64 = 60.0;
const GRATICULE: Colour = RGBColor(125, 125, 125);
/// Magnitude above which values are treated as infinite, since differences would overflow.
const FINITE: f64 = 1e300;
const MISSING: Colour = LEVEL_MISSING;

/// Projection of the hemisphere to a disc.
#[derive(Clone, Copy)]
struct Disc {
    centre: Point,
    radius: f64,
}

impl Disc {
    /// Projects a direction, given by its angles in degrees, to a point.
    fn place(self, polar_deg: f64, azimuth_deg: f64) -> Point {
        let radius = self.radius * SQRT_2 * (0.5 * polar_deg.to_radians()).sin();
        at(self.centre, azimuth_deg, radius)
    }

    /// Computes the angles (degrees, from x₃ and from x₁) of the direction projected to a point; outside the rim the
    /// angles of the opposite direction, which is in the hemisphere.
    fn angles(self, [x, y]: Point) -> [f64; 2] {
        let (dx, dy) = (x - self.centre[0], self.centre[1] - y);
        let half_sine = (dx.hypot(dy) / (SQRT_2 * self.radius)).min(1.0);
        let polar = 2.0 * half_sine.asin().to_degrees();
        let azimuth = dy.atan2(dx).to_degrees();
        if polar > 90.0 { [180.0 - polar, azimuth + 180.0] } else { [polar, azimuth] }
    }
}

/// Range of the colour scale, in values or their log₁₀.
struct Range {
    low: f64,
    high: f64,
}

impl SphereFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Angles are not ascending, there is not one value per pair of angles, or rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture()?.render(format)
    }

    fn check(&self) -> Result<(), FigureError> {
        for (label, angles) in [("polar angle", &self.polar_deg), ("azimuth", &self.azimuth_deg)] {
            let refuse = |problem| FigureError::Axis { label: label.to_owned(), problem };
            if angles.iter().any(|angle| !angle.is_finite()) {
                return Err(refuse("has a point that is not a finite number"));
            }
            if angles.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(refuse("does not ascend"));
            }
        }
        let (rows, columns) = (self.polar_deg.len(), self.azimuth_deg.len());
        if self.values.len() == rows * columns {
            return Ok(());
        }
        let found = self.values.len();
        Err(FigureError::CellCount { field: "values", found, columns, rows })
    }

    /// Returns the level of a value, i.e. the value or its log₁₀; NaN if missing.
    fn level(&self, value: f64) -> f64 {
        match self.value_log {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value,
        }
    }

    fn range(&self) -> Range {
        let levels = self.values.iter().map(|&value| self.level(value));
        let known = levels.filter(|level| level.abs() < FINITE);
        let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| {
            (low.min(level), high.max(level))
        });
        if low > high {
            return Range { low: 0.0, high: 1.0 };
        }
        if high - low <= 1e-9 * low.abs().max(high.abs()) {
            let half = if self.value_log { 0.5 } else { 0.5 * low.abs().max(1.0) };
            return Range { low: low - half, high: high + half };
        }
        Range { low, high }
    }

    /// Interpolates the level in a direction bilinearly between the four nearest grid directions, without those with
    /// missing values; NaN if the sum of the remaining weights is less than `least`. If one of the four levels is
    /// infinite, the nearest of them is returned.
    fn level_at(&self, [polar, azimuth]: [f64; 2], least: f64) -> f64 {
        let (Some(&first), Some(&last)) = (self.azimuth_deg.first(), self.azimuth_deg.last())
        else {
            return f64::NAN;
        };
        if self.polar_deg.is_empty() {
            return f64::NAN;
        }
        let between = |low: f64, high: f64, angle: f64| {
            if high > low { ((angle - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 }
        };
        let row = self.polar_deg.partition_point(|angle| *angle <= polar).saturating_sub(1);
        let next_row = (row + 1).min(self.polar_deg.len() - 1);
        let down = between(self.polar_deg[row], self.polar_deg[next_row], polar);
        let azimuth = first + (azimuth - first).rem_euclid(360.0);
        let column = self.azimuth_deg.partition_point(|angle| *angle <= azimuth).saturating_sub(1);
        // The first azimuth follows the last azimuth.
        let (next_column, next_angle) = match self.azimuth_deg.get(column + 1) {
            Some(angle) => (column + 1, *angle),
            None => (0, (first + 360.0).max(last)),
        };
        let right = between(self.azimuth_deg[column], next_angle, azimuth);
        let value = |row: usize, column: usize| {
            self.level(self.values[row * self.azimuth_deg.len() + column])
        };
        let corners =
            [(row, column), (row, next_column), (next_row, column), (next_row, next_column)]
                .map(|(row, column)| value(row, column));
        let weights = [
            (1.0 - down) * (1.0 - right),
            (1.0 - down) * right,
            down * (1.0 - right),
            down * right,
        ];
        if corners.iter().any(|corner| corner.abs() >= FINITE) {
            return corners[2 * usize::from(down >= 0.5) + usize::from(right >= 0.5)];
        }
        let known = || corners.iter().zip(weights).filter(|(corner, _)| !corner.is_nan());
        let share: f64 = known().map(|(_, weight)| weight).sum();
        if share < least - 1e-9 {
            return f64::NAN;
        }
        known().map(|(corner, weight)| corner * weight / share).sum()
    }

    /// Returns the drawable marks: angles (degrees), unit normal and label.
    fn known_marks(&self) -> Vec<([f64; 2], [f64; 3], &str)> {
        let known = self.marks.iter().filter_map(|mark| {
            let largest = mark.normal.iter().fold(0.0_f64, |size, part| size.max(part.abs()));
            let finite = mark.normal.iter().all(|part| part.is_finite());
            if !finite || largest == 0.0 {
                return None;
            }
            let scaled = mark.normal.map(|part| part / largest);
            let size = scaled.iter().map(|part| part * part).sum::<f64>().sqrt();
            let sign = if scaled[2] < 0.0 { -1.0 } else { 1.0 };
            let [x, y, z] = scaled.map(|part| sign * part / size);
            let angles = [x.hypot(y).atan2(z).to_degrees(), y.atan2(x).to_degrees()];
            Some((angles, [x, y, z], mark.label.as_str()))
        });
        known.collect()
    }

    fn legend(&self, has_missing: bool) -> Vec<Entry> {
        let mut entries: Vec<Entry> = Vec::new();
        for (index, (_, normal, label)) in self.known_marks().into_iter().enumerate() {
            // Adding 0.0 converts a negative zero to a positive zero.
            let parts = normal.map(|part| plain((1000.0 * part).round() / 1000.0 + 0.0));
            let comma = if label.is_empty() { "" } else { ", " };
            let words = format!("{label}{comma}n = ({})", parts.join(", "));
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                let tag = [area.left + TAG + 4.0, y];
                let point = [area.right - 10.0, y];
                picture.line([tag, point], 1.8, INK);
                draw_point(picture, point);
                draw_tag(picture, tag, index + 1, INK);
            };
            entries.push((words, Box::new(swatch)));
        }
        if has_missing {
            entries.push((
                self.missing_label.clone(),
                Box::new(|picture, area| {
                    picture.fill(area, MISSING);
                    picture.frame(area, 1.5, PALE_INK);
                }),
            ));
        }
        let dashes = |picture: &mut Picture, area: Rectangle| {
            let y = 0.5 * (area.top + area.bottom);
            picture.dashed(&[[area.left, y], [area.right, y]], &[3.0, 5.0], 1.6, GRATICULE);
        };
        entries.push(("30° and 60° from x₃; around the rim: from x₁".to_owned(), Box::new(dashes)));
        entries
    }

    fn picture(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let range = self.range();
        let is_missing = |value: &f64| self.level(*value).is_nan();
        let has_missing = self.values.is_empty() || self.values.iter().any(is_missing);
        let legend = Legend::new(self.legend(has_missing), page::WIDTH - 2.0 * MARGIN);
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let height = (page::HEIGHT + 60.0).max(top + 780.0 + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let bottom = height - below;
        let radius = (0.5 * (bottom - top) - DEGREES - 0.7 * RING_LABEL).min(440.0);
        let disc = Disc { centre: [0.5 * page::WIDTH - 90.0, 0.5 * (top + bottom)], radius };

        let most = ((2.0 * radius) / 90.0) as usize;
        let ticks = if self.value_log {
            scale::log_ticks(range.low, range.high, most)
        } else {
            scale::ticks(range.low, range.high, most, false)
        };
        self.draw_cells(&mut picture, disc, &range);
        self.draw_contours(&mut picture, disc, &range, &ticks);
        draw_graticule(&mut picture, disc);
        self.draw_marks(&mut picture, disc);
        let left = disc.centre[0] + radius + 2.0 * DEGREES + 24.0 + BAR_GAP;
        let bar = Rectangle {
            left,
            top: disc.centre[1] - 0.9 * radius,
            right: left + BAR,
            bottom: disc.centre[1] + 0.9 * radius,
        };
        self.draw_bar(&mut picture, bar, &range, &ticks);
        legend.draw(&mut picture, MARGIN, bottom + 16.0);
        Ok(picture)
    }

    fn share(&self, range: &Range, level: f64) -> f64 {
        let share = ((level - range.low) / (range.high - range.low)).clamp(0.0, 1.0);
        if self.dark_is_low { 1.0 - share } else { share }
    }

    fn draw_cells(&self, picture: &mut Picture, disc: Disc, range: &Range) {
        let Disc { centre, radius } = disc;
        let count = (2.0 * radius / CELL).ceil() as usize;
        let corner = [centre[0] - radius, centre[1] - radius];
        for row in 0..count {
            let y = corner[1] + (row as f64 + 0.5) * CELL;
            let half = (radius * radius - (y - centre[1]).powi(2)).max(0.0).sqrt();
            let colours: Vec<Colour> = (0..count)
                .map(|column| {
                    let x = corner[0] + (column as f64 + 0.5) * CELL;
                    let level = self.level_at(disc.angles([x, y]), 0.5);
                    if level.is_nan() { MISSING } else { shade(self.share(range, level)) }
                })
                .collect();
            let mut start = 0;
            while start < count {
                let run = (start + 1..count)
                    .find(|&column| colours[column] != colours[start])
                    .unwrap_or(count);
                // Each area extends below the following cells, which prevents hairlines between cells.
                let area = Rectangle {
                    left: (corner[0] + start as f64 * CELL).max(centre[0] - half),
                    top: y - 0.5 * CELL,
                    right: (corner[0] + run as f64 * CELL + 2.0).min(centre[0] + half),
                    bottom: (y + 0.5 * CELL + 2.0).min(centre[1] + radius),
                };
                if area.left < area.right {
                    picture.fill(area, colours[start]);
                }
                start = run;
            }
        }
    }

    /// Draws the contour lines at the ticks of the colour bar.
    fn draw_contours(&self, picture: &mut Picture, disc: Disc, range: &Range, ticks: &[Tick]) {
        let Disc { centre, radius } = disc;
        // One additional cell on each side, so that the lines reach the rim.
        let count = (2.0 * radius / CELL).ceil() as usize + 3;
        let place = |[x, y]: Point| {
            [centre[0] - radius + (x - 1.0) * CELL, centre[1] - radius + (y - 1.0) * CELL]
        };
        let mut levels = vec![f64::NAN; count * count];
        for row in 0..count {
            let inside = |&column: &usize| {
                let [x, y] = place([column as f64, row as f64]);
                (x - centre[0]).hypot(y - centre[1]) <= radius + 1.5 * CELL
            };
            for column in (0..count).filter(inside) {
                // Only complete cells have contour lines, so that there are none along the edges of missing values.
                let angles = disc.angles(place([column as f64, row as f64]));
                levels[row * count + column] = self.level_at(angles, 1.0);
            }
        }
        for (tick, _) in ticks {
            let colour = colour_on_shade(self.share(range, *tick));
            let value = |column: usize, row: usize| levels[row * count + column];
            for line in contour::lines(count, count, value, *tick) {
                let points: Vec<Point> = line.into_iter().map(place).collect();
                let outside = |&[x, y]: &Point| (x - centre[0]).hypot(y - centre[1]) > radius;
                for (from, to) in runs(points.len(), |index| !outside(&points[index])) {
                    // Short pieces along the edges of missing values are omitted.
                    let scrap = from + 1 >= to || polyline_length(&points[from..to]) < SHORTEST;
                    let closed = points.first() == points.last();
                    if !scrap || (closed && to - from == points.len()) {
                        picture.line(&points[from..to], 1.6, colour);
                    }
                }
            }
        }
    }

    fn draw_marks(&self, picture: &mut Picture, disc: Disc) {
        let marks = self.known_marks();
        let points: Vec<Point> =
            marks.iter().map(|(angles, _, _)| disc.place(angles[0], angles[1])).collect();
        let around = |[x, y]: Point, half: f64| Rectangle {
            left: x - half,
            top: y - half,
            right: x + half,
            bottom: y + half,
        };
        let name = centre_name(disc);
        let mut taken: Vec<Rectangle> = points.iter().map(|&point| around(point, 10.0)).collect();
        taken.extend([backing(&name), around(disc.centre, 10.0)]);
        let mut tags = Vec::new();
        for &point in &points {
            let places = (0..60).flat_map(|step| {
                let distance = 36.0 + 14.0 * f64::from(step);
                (0..16).map(move |turn| at(point, 45.0 + 22.5 * f64::from(turn), distance))
            });
            let free = |&[x, y]: &Point| {
                let away = (x - disc.centre[0]).hypot(y - disc.centre[1]);
                away < disc.radius - TAG - 4.0
                    && !taken.iter().any(|area| area.overlaps(&tag_area([x, y])))
            };
            let place = places.into_iter().find(free);
            taken.extend(place.map(tag_area));
            tags.push(place);
        }
        for (&point, tag) in points.iter().zip(&tags) {
            if let Some(tag) = tag {
                picture.line([point, *tag], 4.4, WHITE);
                picture.line([point, *tag], 1.8, INK);
            }
        }
        for (&[x, y], (angles, _, _)) in points.iter().zip(&marks) {
            draw_point(picture, [x, y]);
            // A normal on the rim is drawn at both of its ends.
            if angles[0] > 89.9 {
                draw_point(picture, [2.0 * disc.centre[0] - x, 2.0 * disc.centre[1] - y]);
            }
        }
        for (index, tag) in tags.iter().enumerate() {
            if let Some(tag) = tag {
                draw_tag(picture, *tag, index + 1, INK);
            }
        }
        picture.fill(backing(&name), WHITE);
        picture.text(name);
    }

    fn draw_bar(&self, picture: &mut Picture, bar: Rectangle, range: &Range, ticks: &[Tick]) {
        draw_shades(picture, bar, false, self.dark_is_low);
        for (tick, label) in ticks {
            let along = ((tick - range.low) / (range.high - range.low)).clamp(0.0, 1.0);
            let y = bar.bottom - along * bar.height();
            let colour = colour_on_shade(self.share(range, *tick));
            picture.line([[bar.left, y], [bar.right, y]], 1.6, colour);
            picture.line([[bar.right, y], [bar.right + 8.0, y]], RULE, INK);
            let at = [bar.right + 14.0, y + 0.36 * NUMBER];
            picture.text(Text::new(at, Anchor::Start, NUMBER, label));
        }
        picture.frame(bar, RULE, INK);
        let (name, size) = page::fit(&self.value_label, NAME, bar.height());
        let x = bar.right + 14.0 + page::widest(ticks).max(NUMBER) + 1.5 * NAME;
        let at = [x, 0.5 * (bar.top + bar.bottom)];
        picture.text(Text { upwards: true, ..Text::new(at, Anchor::Middle, size, name) });
    }
}

fn draw_point(picture: &mut Picture, at: Point) {
    picture.disc(at, 8.0, WHITE);
    picture.disc(at, 5.5, INK);
}

/// Returns the label x₃ of the axis at the centre.
fn centre_name(disc: Disc) -> Text {
    let [x, y] = disc.centre;
    let at = [x + 12.0 + 0.5 * text_width("x₃", RING_LABEL, false), y + 12.0 + RING_LABEL];
    Text::new(at, Anchor::Middle, RING_LABEL, "x₃")
}

/// Draws the rim with angles and axis names, and the circles at 30° and 60° from x₃.
fn draw_graticule(picture: &mut Picture, disc: Disc) {
    let Disc { centre, radius } = disc;
    for polar in [30.0, 60.0] {
        let circle: Vec<Point> =
            (0..=360).map(|angle| disc.place(polar, f64::from(angle))).collect();
        picture.dashed(&circle, &[3.0, 5.0], 1.6, GRATICULE);
    }
    let [x, y] = centre;
    for (width, colour) in [(5.0, WHITE), (2.0, INK)] {
        let arm = 7.0 + 0.5 * width;
        picture.line([[x - arm, y], [x + arm, y]], width, colour);
        picture.line([[x, y - arm], [x, y + arm]], width, colour);
    }
    // Covers the edges of cells that extend beyond the rim.
    ring(picture, centre, radius + 3.0, 6.0, WHITE);
    ring(picture, centre, radius, 2.4, INK);
    let turns = [0.0, 90.0, 180.0, 270.0];
    let taken = turns.map(|turn| [at(centre, turn, radius + 6.0), at(centre, turn, radius + 60.0)]);
    draw_degrees(picture, centre, radius, &taken);
    for (turn, name) in turns.into_iter().zip(["x₁", "x₂", "−x₁", "−x₂"]) {
        let [x, y] = at(centre, turn, radius + DEGREES + 2.0);
        let text = Text::new([x, y + 0.36 * NUMBER], Anchor::Middle, NUMBER, name);
        picture.text(Text { bold: true, ..text });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::check_drawing;

    fn figure(polar: &[f64], azimuth: &[f64], values: &[f64]) -> SphereFigure {
        SphereFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            polar_deg: polar.to_vec(),
            azimuth_deg: azimuth.to_vec(),
            values: values.to_vec(),
            value_label: "speed c (m/s)".to_owned(),
            value_log: false,
            dark_is_low: false,
            missing_label: "no value".to_owned(),
            marks: Vec::new(),
        }
    }

    fn check(figure: &SphereFigure) {
        check_drawing(&figure.picture().unwrap(), |format| figure.draw(format));
    }

    const POLAR: [f64; 3] = [0.0, 45.0, 90.0];
    const AZIMUTH: [f64; 4] = [0.0, 90.0, 180.0, 270.0];

    #[test]
    fn any_values_are_drawn() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let mut sets = vec![[nan; 12], [0.0; 12], [7.0; 12], [inf; 12], [-3.0; 12]];
        sets.push([nan, 1.0, inf, -inf, 0.0, -1.0, 1e-300, 5e-324, 2.0, 3.0, 4.0, 5.0]);
        sets.push([f64::MAX, f64::MIN, 1e299, -1e299, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        for (index, values) in sets.iter().enumerate() {
            let mut figure = figure(&POLAR, &AZIMUTH, values);
            figure.value_log = index % 2 == 0;
            figure.dark_is_low = index % 3 == 0;
            check(&figure);
            figure.value_log = !figure.value_log;
            check(&figure);
        }
        check(&figure(&[], &[], &[]));
        check(&figure(&[30.0], &[10.0], &[1.0]));
        check(&figure(&[], &AZIMUTH, &[]));
    }

    #[test]
    fn unfit_grids_are_refused() {
        assert!(figure(&POLAR, &AZIMUTH, &[1.0; 11]).draw(Format::Png).is_err());
        assert!(figure(&[0.0, 0.0], &[1.0], &[1.0; 2]).draw(Format::Png).is_err());
        assert!(figure(&[f64::NAN], &[1.0], &[1.0]).draw(Format::Png).is_err());
    }

    #[test]
    fn numbers_of_marks_keep_apart() {
        let mut figure = figure(&POLAR, &AZIMUTH, &[1.0; 12]);
        let mut normals = vec![
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -5.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 0.01],
            [0.0; 3],
            [f64::NAN, 0.0, 1.0],
            [1e300, -1e300, 0.0],
            [5e-324, 0.0, 0.0],
        ];
        normals.extend([[0.3, 0.4, 0.5]; 12]);
        let mark = |normal| SphereMark { label: "a normal".to_owned(), normal };
        figure.marks = normals.into_iter().map(mark).collect();
        check(&figure);
        figure.marks[0].label = "normal ".repeat(100);
        figure.value_label = "value ".repeat(100);
        check(&figure);
    }

    #[test]
    fn the_map_keeps_areas_and_directions() {
        let disc = Disc { centre: [500.0, 500.0], radius: 400.0 };
        for [polar, azimuth] in [[0.0, 0.0], [30.0, 40.0], [60.0, -120.0], [90.0, 90.0]] {
            let [x, y] = disc.place(polar, azimuth);
            let back = disc.angles([x, y]);
            assert!((back[0] - polar).abs() < 1e-6, "{back:?}");
            assert!(polar == 0.0 || (back[1] - azimuth).abs() < 1e-6, "{back:?}");
        }
        // Equal areas: half of the area of the hemisphere is within 60° of the pole.
        let [x, _] = disc.place(60.0, 0.0);
        assert!((((x - 500.0) / 400.0).powi(2) - 0.5).abs() < 1e-12);
        // Outside the rim are the opposite directions.
        let [polar, azimuth] = disc.angles([905.0, 500.0]);
        assert!(polar < 90.0 && (azimuth - 180.0).abs() < 1e-9);
    }

    #[test]
    fn levels_are_interpolated_around_the_circle() {
        let values: Vec<f64> = (0..12).map(f64::from).collect();
        let figure = figure(&POLAR, &AZIMUTH, &values);
        assert_eq!(figure.level_at([45.0, 90.0], 1.0), 5.0);
        assert_eq!(figure.level_at([22.5, 45.0], 1.0), 2.5);
        assert_eq!(figure.level_at([90.0, -45.0], 1.0), 9.5);
        assert_eq!(figure.level_at([90.0, 675.0], 1.0), 9.5);
    }
}
