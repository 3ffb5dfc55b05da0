//! Map of a quantity over all wave normals in space, on a hemisphere.

use plotters::style::RGBColor;

use crate::contour;
use crate::dispersion::{NUMBER_DISC_RADIUS, draw_number_disc, number_disc_area};
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::hemisphere::HemisphereProjection;
use crate::page::{
    self, AXIS_NAME_SIZE, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN, TICK_LABEL_SIZE,
};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, polyline_length,
    text_width,
};
use crate::polar::{
    ANGLE_LABEL_DISTANCE, RING_LABEL_SIZE, draw_angle_labels, draw_circle, polar_to_point,
    text_background,
};
use crate::scale::{self, FINITE_LIMIT, Tick, format_number};
use crate::verdict_map::{
    BAR_GAP, BAR_WIDTH, MISSING_LEVEL_COLOUR, contrast_colour, draw_shades, find_runs, shade_colour,
};

/// Wave normal that is marked on the map.
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
    pub polar_angles_deg: Vec<f64>,
    /// Azimuths from x₁ towards x₂ over the full circle, degrees, ascending; the azimuth 360° may be omitted.
    pub azimuth_angles_deg: Vec<f64>,
    /// Value for each pair of angles, azimuth varying fastest; NaN if missing. Values are interpolated between the
    /// angles; with steps of one degree the edges of missing values are smooth.
    pub values: Vec<f64>,
    /// Name, symbol and unit of the values.
    pub value_label: String,
    /// Whether the colour scale is logarithmic; non-positive values are then missing.
    pub is_value_log: bool,
    /// Whether dark colours represent low values instead of high values.
    pub is_dark_low: bool,
    /// Legend text for normals with missing values.
    pub missing_label: String,
    /// Marked normals.
    pub marks: Vec<SphereMark>,
}

/// Edge of a cell of the map, pixels.
const CELL_SIZE: f64 = 3.0;
/// Minimum length of open contour lines, pixels.
const MIN_CONTOUR_LENGTH: f64 = 60.0;
/// Width of the angles around the rim on a narrow page, pixels.
const RIM_LABEL_WIDTH: f64 = 64.0;
/// Width from the rim to the end of the colour bar's name on a narrow page, pixels.
const COLOUR_BAR_SPACE: f64 =
    RIM_LABEL_WIDTH + 24.0 + BAR_GAP + BAR_WIDTH + 14.0 + 80.0 + 1.8 * AXIS_NAME_SIZE;
const GRATICULE_COLOUR: Colour = RGBColor(125, 125, 125);
const MISSING_COLOUR: Colour = MISSING_LEVEL_COLOUR;

/// Range of the colour scale, in values or their log₁₀.
struct SphereColourRange {
    low: f64,
    high: f64,
}

impl SphereFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Angles are not finite and ascending, there is not one value per pair of angles, or rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture())?.render(output)
    }

    fn validate(&self) -> Result<(), FigureError> {
        for (label, angles) in
            [("polar angle", &self.polar_angles_deg), ("azimuth", &self.azimuth_angles_deg)]
        {
            let refuse = |problem| FigureError::Axis { label: label.to_owned(), problem };
            if angles.iter().any(|angle| !angle.is_finite()) {
                return Err(refuse("has a point that is not a finite number"));
            }
            if angles.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(refuse("does not ascend"));
            }
        }
        let (rows, columns) = (self.polar_angles_deg.len(), self.azimuth_angles_deg.len());
        if self.values.len() == rows * columns {
            return Ok(());
        }
        let found = self.values.len();
        Err(FigureError::CellCount { field: "values", found, columns, rows })
    }

    /// Returns the level of a value, i.e. the value or its log₁₀; NaN if missing.
    fn to_level(&self, value: f64) -> f64 {
        match self.is_value_log {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value,
        }
    }

    fn level_range(&self) -> SphereColourRange {
        let levels = self.values.iter().map(|&value| self.to_level(value));
        let known = levels.filter(|level| level.abs() < FINITE_LIMIT);
        let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| {
            (low.min(level), high.max(level))
        });
        if low > high {
            return SphereColourRange { low: 0.0, high: 1.0 };
        }
        if high - low <= 1e-9 * low.abs().max(high.abs()) {
            let half = if self.is_value_log { 0.5 } else { 0.5 * low.abs().max(1.0) };
            return SphereColourRange { low: low - half, high: high + half };
        }
        SphereColourRange { low, high }
    }

    /// Interpolates the level in a direction bilinearly between the four nearest grid directions, without those with
    /// missing values; NaN if the sum of the remaining weights is less than `min_weight`. If one of the four levels is
    /// infinite, the level of the nearest of the four directions is returned.
    fn interpolate_level(&self, [polar, azimuth]: [f64; 2], min_weight: f64) -> f64 {
        let (Some(&first), Some(&last)) =
            (self.azimuth_angles_deg.first(), self.azimuth_angles_deg.last())
        else {
            return f64::NAN;
        };
        if self.polar_angles_deg.is_empty() {
            return f64::NAN;
        }
        let interpolation_weight = |low: f64, high: f64, angle: f64| {
            if high > low { ((angle - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 }
        };
        let row = self.polar_angles_deg.partition_point(|angle| *angle <= polar).saturating_sub(1);
        let next_row = (row + 1).min(self.polar_angles_deg.len() - 1);
        let down = interpolation_weight(
            self.polar_angles_deg[row],
            self.polar_angles_deg[next_row],
            polar,
        );
        let azimuth = first + (azimuth - first).rem_euclid(360.0);
        let column =
            self.azimuth_angles_deg.partition_point(|angle| *angle <= azimuth).saturating_sub(1);
        // The first azimuth follows the last azimuth.
        let (next_column, next_angle) = match self.azimuth_angles_deg.get(column + 1) {
            Some(angle) => (column + 1, *angle),
            None => (0, (first + 360.0).max(last)),
        };
        let right = interpolation_weight(self.azimuth_angles_deg[column], next_angle, azimuth);
        let value = |row: usize, column: usize| {
            self.to_level(self.values[row * self.azimuth_angles_deg.len() + column])
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
        if corners.iter().any(|corner| corner.abs() >= FINITE_LIMIT) {
            return corners[2 * usize::from(down >= 0.5) + usize::from(right >= 0.5)];
        }
        let known = || corners.iter().zip(weights).filter(|(corner, _)| !corner.is_nan());
        let share: f64 = known().map(|(_, weight)| weight).sum();
        if share < min_weight - 1e-9 {
            return f64::NAN;
        }
        known().map(|(corner, weight)| corner * weight / share).sum()
    }

    /// Returns the marks with finite, non-zero normals: angles (degrees), unit normal with x₃ ≥ 0, and label.
    fn finite_marks(&self) -> Vec<([f64; 2], [f64; 3], &str)> {
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

    fn legend_entries(&self, has_missing: bool) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for (index, (_, normal, label)) in self.finite_marks().into_iter().enumerate() {
            // Adding 0.0 converts a negative zero to a positive zero.
            let parts = normal.map(|part| format_number((1000.0 * part).round() / 1000.0 + 0.0));
            let comma = if label.is_empty() { "" } else { ", " };
            let label_text = format!("{label}{comma}n = ({})", parts.join(", "));
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                let tag = [area.left + NUMBER_DISC_RADIUS + 4.0, y];
                let point = [area.right - 10.0, y];
                picture.draw_line([tag, point], 1.8, INK);
                draw_point(picture, point);
                draw_number_disc(picture, tag, index + 1, INK);
            };
            entries.push((label_text, Box::new(swatch)));
        }
        if has_missing {
            entries.push((
                self.missing_label.clone(),
                Box::new(|picture, area| {
                    picture.fill_rectangle(area, MISSING_COLOUR);
                    picture.draw_frame(area, 1.5, PALE_INK);
                }),
            ));
        }
        let dashes = |picture: &mut Picture, area: Rectangle| {
            let y = 0.5 * (area.top + area.bottom);
            picture.draw_dashed_line(
                &[[area.left, y], [area.right, y]],
                &[3.0, 5.0],
                1.6,
                GRATICULE_COLOUR,
            );
        };
        entries.push(("30° and 60° from x₃; around the rim: from x₁".to_owned(), Box::new(dashes)));
        entries
    }

    fn to_picture(&self) -> Result<Picture, FigureError> {
        self.validate()?;
        let range = self.level_range();
        let is_missing = |value: &f64| self.to_level(*value).is_nan();
        let has_missing = self.values.is_empty() || self.values.iter().any(is_missing);
        let legend = Legend::new(self.legend_entries(has_missing), page::width() - 2.0 * MARGIN);
        let top = page::heading_bottom(&self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let rim_height = ANGLE_LABEL_DISTANCE + 0.7 * RING_LABEL_SIZE;
        let is_narrow = page::is_narrow();
        let max_radius = match is_narrow {
            true => 0.5 * (page::width() - 2.0 * MARGIN - RIM_LABEL_WIDTH - COLOUR_BAR_SPACE),
            false => 440.0,
        };
        let usual_height = page::disc_page_height(top + 2.0 * (max_radius + rim_height) + below);
        let height = usual_height.max(top + page::scale_height(780.0) + below).ceil();
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let bottom = height - below;
        let radius = (0.5 * (bottom - top) - rim_height).min(max_radius);
        let beside = MARGIN + RIM_LABEL_WIDTH;
        let centre_x = if is_narrow { beside + radius } else { 0.5 * page::width() - 90.0 };
        let disc = HemisphereProjection { centre: [centre_x, 0.5 * (top + bottom)], radius };

        let max_count = ((2.0 * radius) / 90.0) as usize;
        let ticks = if self.is_value_log {
            scale::log_ticks(range.low, range.high, max_count)
        } else {
            scale::linear_ticks(range.low, range.high, max_count, false)
        };
        self.draw_cells(&mut picture, disc, &range);
        self.draw_contours(&mut picture, disc, &range, &ticks);
        draw_graticule(&mut picture, disc);
        self.draw_marks(&mut picture, disc);
        let left = disc.centre[0] + radius + 2.0 * ANGLE_LABEL_DISTANCE + 24.0 + BAR_GAP;
        let bar = Rectangle {
            left,
            top: disc.centre[1] - 0.9 * radius,
            right: left + BAR_WIDTH,
            bottom: disc.centre[1] + 0.9 * radius,
        };
        self.draw_colour_bar(&mut picture, bar, &range, &ticks);
        legend.draw(&mut picture, MARGIN, bottom + 16.0);
        Ok(picture)
    }

    fn shade_fraction(&self, range: &SphereColourRange, level: f64) -> f64 {
        let share = ((level - range.low) / (range.high - range.low)).clamp(0.0, 1.0);
        if self.is_dark_low { 1.0 - share } else { share }
    }

    fn draw_cells(
        &self,
        picture: &mut Picture,
        disc: HemisphereProjection,
        range: &SphereColourRange,
    ) {
        let HemisphereProjection { centre, radius } = disc;
        let count = (2.0 * radius / CELL_SIZE).ceil() as usize;
        let corner = [centre[0] - radius, centre[1] - radius];
        for row in 0..count {
            let y = corner[1] + (row as f64 + 0.5) * CELL_SIZE;
            let half = (radius * radius - (y - centre[1]).powi(2)).max(0.0).sqrt();
            let colours: Vec<Colour> = (0..count)
                .map(|column| {
                    let x = corner[0] + (column as f64 + 0.5) * CELL_SIZE;
                    let level = self.interpolate_level(disc.unproject([x, y]), 0.5);
                    if level.is_nan() {
                        MISSING_COLOUR
                    } else {
                        shade_colour(self.shade_fraction(range, level))
                    }
                })
                .collect();
            let mut start = 0;
            while start < count {
                let run = (start + 1..count)
                    .find(|&column| colours[column] != colours[start])
                    .unwrap_or(count);
                // Each area extends below the following cells, which prevents hairlines between cells.
                let area = Rectangle {
                    left: (corner[0] + start as f64 * CELL_SIZE).max(centre[0] - half),
                    top: y - 0.5 * CELL_SIZE,
                    right: (corner[0] + run as f64 * CELL_SIZE + 2.0).min(centre[0] + half),
                    bottom: (y + 0.5 * CELL_SIZE + 2.0).min(centre[1] + radius),
                };
                if area.left < area.right {
                    picture.fill_rectangle(area, colours[start]);
                }
                start = run;
            }
        }
    }

    /// Draws the contour lines at the ticks of the colour bar.
    fn draw_contours(
        &self,
        picture: &mut Picture,
        disc: HemisphereProjection,
        range: &SphereColourRange,
        ticks: &[Tick],
    ) {
        let HemisphereProjection { centre, radius } = disc;
        // One additional cell on each side, so that the lines reach the rim.
        let count = (2.0 * radius / CELL_SIZE).ceil() as usize + 3;
        let place = |[x, y]: Point| {
            [centre[0] - radius + (x - 1.0) * CELL_SIZE, centre[1] - radius + (y - 1.0) * CELL_SIZE]
        };
        let mut levels = vec![f64::NAN; count * count];
        for row in 0..count {
            let inside = |&column: &usize| {
                let [x, y] = place([column as f64, row as f64]);
                (x - centre[0]).hypot(y - centre[1]) <= radius + 1.5 * CELL_SIZE
            };
            for column in (0..count).filter(inside) {
                // Only complete cells have contour lines, so that there are none along the edges of missing values.
                let angles = disc.unproject(place([column as f64, row as f64]));
                levels[row * count + column] = self.interpolate_level(angles, 1.0);
            }
        }
        for (tick, _) in ticks {
            let colour = contrast_colour(self.shade_fraction(range, *tick));
            let value = |column: usize, row: usize| levels[row * count + column];
            for line in contour::trace_contours(count, count, value, *tick) {
                let points: Vec<Point> = line.into_iter().map(place).collect();
                let outside = |&[x, y]: &Point| (x - centre[0]).hypot(y - centre[1]) > radius;
                for (from, to) in find_runs(points.len(), |index| !outside(&points[index])) {
                    // Short pieces along the edges of missing values are omitted.
                    let scrap =
                        from + 1 >= to || polyline_length(&points[from..to]) < MIN_CONTOUR_LENGTH;
                    let closed = points.first() == points.last();
                    if !scrap || (closed && to - from == points.len()) {
                        picture.draw_line(&points[from..to], 1.6, colour);
                    }
                }
            }
        }
    }

    fn draw_marks(&self, picture: &mut Picture, disc: HemisphereProjection) {
        let marks = self.finite_marks();
        let points: Vec<Point> =
            marks.iter().map(|(angles, _, _)| disc.project(angles[0], angles[1])).collect();
        let around = |[x, y]: Point, half: f64| Rectangle {
            left: x - half,
            top: y - half,
            right: x + half,
            bottom: y + half,
        };
        let name = centre_label(disc);
        let mut occupied: Vec<Rectangle> =
            points.iter().map(|&point| around(point, 10.0)).collect();
        occupied.extend([text_background(&name), around(disc.centre, 10.0)]);
        let mut number_discs = Vec::new();
        for &point in &points {
            let places = (0..60).flat_map(|step| {
                let distance = 36.0 + 14.0 * f64::from(step);
                (0..16)
                    .map(move |turn| polar_to_point(point, 45.0 + 22.5 * f64::from(turn), distance))
            });
            let is_free = |&[x, y]: &Point| {
                let away = (x - disc.centre[0]).hypot(y - disc.centre[1]);
                away < disc.radius - NUMBER_DISC_RADIUS - 4.0
                    && !occupied.iter().any(|area| area.is_overlapping(&number_disc_area([x, y])))
            };
            let place = places.into_iter().find(is_free);
            occupied.extend(place.map(number_disc_area));
            number_discs.push(place);
        }
        for (&point, tag) in points.iter().zip(&number_discs) {
            if let Some(tag) = tag {
                picture.draw_line([point, *tag], 4.4, WHITE);
                picture.draw_line([point, *tag], 1.8, INK);
            }
        }
        for (&[x, y], (angles, _, _)) in points.iter().zip(&marks) {
            draw_point(picture, [x, y]);
            // A normal on the rim is drawn at both of its ends.
            if angles[0] > 89.9 {
                draw_point(picture, [2.0 * disc.centre[0] - x, 2.0 * disc.centre[1] - y]);
            }
        }
        for (index, tag) in number_discs.iter().enumerate() {
            if let Some(tag) = tag {
                draw_number_disc(picture, *tag, index + 1, INK);
            }
        }
        picture.fill_rectangle(text_background(&name), WHITE);
        picture.draw_text(name);
    }

    fn draw_colour_bar(
        &self,
        picture: &mut Picture,
        bar: Rectangle,
        range: &SphereColourRange,
        ticks: &[Tick],
    ) {
        draw_shades(picture, bar, false, self.is_dark_low);
        for (tick, label) in ticks {
            let along = ((tick - range.low) / (range.high - range.low)).clamp(0.0, 1.0);
            let y = bar.bottom - along * bar.height();
            let colour = contrast_colour(self.shade_fraction(range, *tick));
            picture.draw_line([[bar.left, y], [bar.right, y]], 1.6, colour);
            picture.draw_line([[bar.right, y], [bar.right + 8.0, y]], FRAME_LINE_WIDTH, INK);
            let at = [bar.right + 14.0, y + 0.36 * TICK_LABEL_SIZE];
            picture.draw_text(Text::new(at, Anchor::Start, TICK_LABEL_SIZE, label));
        }
        picture.draw_frame(bar, FRAME_LINE_WIDTH, INK);
        let x = bar.right
            + 14.0
            + page::max_label_width(ticks).max(TICK_LABEL_SIZE)
            + 1.5 * AXIS_NAME_SIZE;
        page::draw_vertical_name(picture, x, [bar.top, bar.bottom], &self.value_label);
    }
}

fn draw_point(picture: &mut Picture, at: Point) {
    picture.mark_point(at, 8.0);
    picture.fill_disc(at, 8.0, WHITE);
    picture.fill_disc(at, 5.5, INK);
}

/// Returns the label x₃ of the axis at the centre.
fn centre_label(disc: HemisphereProjection) -> Text {
    let [x, y] = disc.centre;
    let at =
        [x + 12.0 + 0.5 * text_width("x₃", RING_LABEL_SIZE, false), y + 12.0 + RING_LABEL_SIZE];
    Text::new(at, Anchor::Middle, RING_LABEL_SIZE, "x₃")
}

/// Draws the rim with angles and axis names, and the circles at 30° and 60° from x₃.
fn draw_graticule(picture: &mut Picture, disc: HemisphereProjection) {
    let HemisphereProjection { centre, radius } = disc;
    for polar in [30.0, 60.0] {
        let circle: Vec<Point> =
            (0..=360).map(|angle| disc.project(polar, f64::from(angle))).collect();
        picture.draw_dashed_line(&circle, &[3.0, 5.0], 1.6, GRATICULE_COLOUR);
    }
    let [x, y] = centre;
    for (width, colour) in [(5.0, WHITE), (2.0, INK)] {
        let arm = 7.0 + 0.5 * width;
        picture.draw_line([[x - arm, y], [x + arm, y]], width, colour);
        picture.draw_line([[x, y - arm], [x, y + arm]], width, colour);
    }
    // A white ring covers the edges of cells that extend beyond the rim.
    draw_circle(picture, centre, radius + 3.0, 6.0, WHITE);
    draw_circle(picture, centre, radius, 2.4, INK);
    let turns = [0.0, 90.0, 180.0, 270.0];
    let occupied = turns.map(|turn| {
        [polar_to_point(centre, turn, radius + 6.0), polar_to_point(centre, turn, radius + 60.0)]
    });
    draw_angle_labels(picture, centre, radius, &occupied);
    for (turn, name) in turns.into_iter().zip(["x₁", "x₂", "−x₁", "−x₂"]) {
        let [x, y] = polar_to_point(centre, turn, radius + ANGLE_LABEL_DISTANCE + 2.0);
        let text =
            Text::new([x, y + 0.36 * TICK_LABEL_SIZE], Anchor::Middle, TICK_LABEL_SIZE, name);
        picture.draw_text(Text { is_bold: true, ..text });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FigureFormat;
    use crate::tests::check_drawing;

    fn sample_figure(polar: &[f64], azimuth: &[f64], values: &[f64]) -> SphereFigure {
        SphereFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            polar_angles_deg: polar.to_vec(),
            azimuth_angles_deg: azimuth.to_vec(),
            values: values.to_vec(),
            value_label: "speed c (m/s)".to_owned(),
            is_value_log: false,
            is_dark_low: false,
            missing_label: "no value".to_owned(),
            marks: Vec::new(),
        }
    }

    fn check_figure(figure: &SphereFigure) {
        check_drawing(&figure.to_picture().unwrap(), |format| figure.draw(format));
    }

    const POLAR_ANGLES: [f64; 3] = [0.0, 45.0, 90.0];
    const AZIMUTHS: [f64; 4] = [0.0, 90.0, 180.0, 270.0];

    #[test]
    fn any_values_are_drawn() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let mut sets = vec![[nan; 12], [0.0; 12], [7.0; 12], [inf; 12], [-3.0; 12]];
        sets.push([nan, 1.0, inf, -inf, 0.0, -1.0, 1e-300, 5e-324, 2.0, 3.0, 4.0, 5.0]);
        sets.push([f64::MAX, f64::MIN, 1e299, -1e299, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        for (index, values) in sets.iter().enumerate() {
            let mut figure = sample_figure(&POLAR_ANGLES, &AZIMUTHS, values);
            figure.is_value_log = index % 2 == 0;
            figure.is_dark_low = index % 3 == 0;
            check_figure(&figure);
            // Equal values have one colour on either scale.
            if index > 4 {
                figure.is_value_log = !figure.is_value_log;
                check_figure(&figure);
            }
        }
        check_figure(&sample_figure(&[], &[], &[]));
        check_figure(&sample_figure(&[30.0], &[10.0], &[1.0]));
        check_figure(&sample_figure(&[], &AZIMUTHS, &[]));
    }

    #[test]
    fn invalid_grids_are_refused() {
        assert!(
            sample_figure(&POLAR_ANGLES, &AZIMUTHS, &[1.0; 11]).draw(FigureFormat::Png).is_err()
        );
        assert!(sample_figure(&[0.0, 0.0], &[1.0], &[1.0; 2]).draw(FigureFormat::Png).is_err());
        assert!(sample_figure(&[f64::NAN], &[1.0], &[1.0]).draw(FigureFormat::Png).is_err());
    }

    #[test]
    fn mark_numbers_do_not_overlap() {
        let mut figure = sample_figure(&POLAR_ANGLES, &AZIMUTHS, &[1.0; 12]);
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
        check_figure(&figure);
        figure.marks[0].label = "normal ".repeat(100);
        figure.value_label = "value ".repeat(100);
        check_figure(&figure);
    }

    #[test]
    fn levels_are_interpolated_around_the_circle() {
        let values: Vec<f64> = (0..12).map(f64::from).collect();
        let figure = sample_figure(&POLAR_ANGLES, &AZIMUTHS, &values);
        assert_eq!(figure.interpolate_level([45.0, 90.0], 1.0), 5.0);
        assert_eq!(figure.interpolate_level([22.5, 45.0], 1.0), 2.5);
        assert_eq!(figure.interpolate_level([90.0, -45.0], 1.0), 9.5);
        assert_eq!(figure.interpolate_level([90.0, 675.0], 1.0), 9.5);
    }
}
