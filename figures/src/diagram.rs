//! Stress–strain diagrams with arrows in the direction of time, beside energies against time.

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::{GRID_COLOUR, LINE_WIDTH, LineStyle};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN};
use crate::picture::{INK, PALE_INK, Picture, Point, Rectangle, WHITE, clip_polyline, text_width};
use crate::scale::{self, FINITE_LIMIT, Tick};
use plotters::style::RGBColor;

/// Curve of a diagram, with a legend text.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramCurve {
    /// Legend text.
    pub label: String,
    /// Points in the units of the axes; NaN interrupts the line.
    pub points: Vec<[f64; 2]>,
}

/// Stress–strain diagram of a load path, and curves such as energies against time.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name and unit of the strain.
    pub strain_label: String,
    /// Name and unit of the stress.
    pub stress_label: String,
    /// Strain and stress in the order of time. Arrows along the line show its direction; a ring marks its start and a
    /// disc its end.
    pub path: Vec<[f64; 2]>,
    /// Name and unit of the time.
    pub time_label: String,
    /// Name and unit of the curves against time.
    pub curve_label: String,
    /// Curves against time.
    pub curves: Vec<DiagramCurve>,
    /// Legend text of the start of the path.
    pub start_label: String,
    /// Legend text of the end of the path.
    pub end_label: String,
}

const PATH_COLOUR: RGBColor = RGBColor(0, 114, 178);
const ZERO_LINE_COLOUR: RGBColor = RGBColor(150, 150, 150);
/// Length of an arrowhead, pixels.
const ARROW_LENGTH: f64 = 24.0;
/// Half the width of an arrowhead, pixels.
const ARROW_HALF_WIDTH: f64 = 9.0;
/// Distance of arrowheads along the path, pixels.
const ARROW_SPACING: f64 = 170.0;
/// Maximum number of arrowheads, so that they stay legible on paths of many cycles.
const MAX_ARROWS: f64 = 24.0;
const END_RADIUS: f64 = 9.0;
/// Gap between the panels, pixels.
const PANEL_GAP: f64 = 44.0;

/// Panel with linear scales.
struct Panel {
    frame: Rectangle,
    x_ends: [f64; 2],
    y_ends: [f64; 2],
}

fn is_plottable(point: &[f64; 2]) -> bool {
    point.iter().all(|value| value.abs() < FINITE_LIMIT)
}

/// Ends of an axis: the range of the values with a margin on either side; `margins` are its shares of the range. A range
/// without extent is widened.
fn axis_ends(values: impl Iterator<Item = f64>, margins: f64) -> [f64; 2] {
    let [low, high] =
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    if low > high {
        return [0.0, 1.0];
    }
    let size = low.abs().max(high.abs());
    if high - low <= 1e-9 * size || size < 1e-300 {
        let half = if size < 1e-300 { 1.0 } else { 0.5 * size };
        return [low - half, high + half];
    }
    let margin = margins * (high - low);
    [low - margin, high + margin]
}

impl Panel {
    fn to_point(&self, [x, y]: Point) -> Point {
        let fraction = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [
            self.frame.left + fraction(x, self.x_ends) * self.frame.width(),
            self.frame.bottom - fraction(y, self.y_ends) * self.frame.height(),
        ]
    }

    /// Ticks of the horizontal and the vertical axis, in pixels, and their common factors.
    fn ticks(&self) -> ([Vec<Tick>; 2], [String; 2]) {
        let [[left, right], [bottom, top]] = [self.x_ends, self.y_ends];
        let within = |[low, high]: [f64; 2], ticks: Vec<Tick>| {
            ticks.into_iter().filter(move |(value, _)| (low..=high).contains(value))
        };
        let width = self.frame.width();
        let (x, x_factor) = page::choose_ticks_with_multiplier(width, false, |max_count| {
            scale::linear_ticks_with_multiplier(left, right, max_count)
        });
        let height = self.frame.height();
        let (y, y_factor) = page::choose_ticks_with_multiplier(height, true, |max_count| {
            scale::linear_ticks_with_multiplier(bottom, top, max_count.min(10))
        });
        let x = within(self.x_ends, x).map(|(x, label)| (self.to_point([x, bottom])[0], label));
        let y = within(self.y_ends, y).map(|(y, label)| (self.to_point([left, y])[1], label));
        ([omit_overlapping_labels(x.collect()), y.collect()], [x_factor, y_factor])
    }

    fn draw_grid(&self, picture: &mut Picture, [x_ticks, y_ticks]: &[Vec<Tick>; 2]) {
        let frame = self.frame;
        for (x, _) in x_ticks {
            picture.draw_line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID_COLOUR);
        }
        for (y, _) in y_ticks {
            picture.draw_line([[frame.left, *y], [frame.right, *y]], 1.2, GRID_COLOUR);
        }
        let zero = self.to_point([0.0, 0.0]);
        let is_inside = |[low, high]: [f64; 2]| low < 0.0 && high > 0.0;
        if is_inside(self.x_ends) {
            let ends = [[zero[0], frame.top], [zero[0], frame.bottom]];
            picture.draw_line(ends, 2.0, ZERO_LINE_COLOUR);
        }
        if is_inside(self.y_ends) {
            let ends = [[frame.left, zero[1]], [frame.right, zero[1]]];
            picture.draw_line(ends, 2.0, ZERO_LINE_COLOUR);
        }
    }

    fn draw_axes(
        &self,
        picture: &mut Picture,
        ([x_ticks, y_ticks], factors): &([Vec<Tick>; 2], [String; 2]),
        labels: [&str; 2],
    ) {
        let label = |axis: usize| scale::label_with_multiplier(labels[axis], &factors[axis]);
        picture.draw_frame(self.frame, FRAME_LINE_WIDTH, INK);
        page::draw_bottom_axis(picture, self.frame, x_ticks, &label(0));
        page::draw_left_axis(picture, self.frame, y_ticks, &label(1));
    }

    /// Lines through the plottable points, without points that coincide in the picture.
    fn lines(&self, points: &[[f64; 2]]) -> Vec<Vec<Point>> {
        let mut lines = Vec::new();
        for run in points.split(|point| !is_plottable(point)).filter(|run| !run.is_empty()) {
            let mut line: Vec<Point> = Vec::new();
            for point in run.iter().map(|point| self.to_point(*point)) {
                let is_near = |last: &Point| distance(*last, point) < 0.3;
                if !line.last().is_some_and(is_near) {
                    line.push(point);
                }
            }
            lines.push(line);
        }
        lines
    }
}

/// Omits each label that would overlap the one before or extend beyond the page.
fn omit_overlapping_labels(mut ticks: Vec<Tick>) -> Vec<Tick> {
    let mut last_end = f64::NEG_INFINITY;
    for (x, label) in &mut ticks {
        let half = 0.5 * text_width(label, page::TICK_LABEL_SIZE, false) + 4.0;
        if *x - half < last_end || *x + half > page::width() {
            label.clear();
        } else if !label.is_empty() {
            last_end = *x + half;
        }
    }
    ticks
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Arrowhead whose middle is at a point of a line, with the direction of the line.
fn draw_arrowhead(picture: &mut Picture, middle: Point, [dx, dy]: Point) {
    let at = |along: f64, across: f64| {
        [middle[0] + along * dx - across * dy, middle[1] + along * dy + across * dx]
    };
    let half = 0.5 * ARROW_LENGTH;
    let head = vec![at(half, 0.0), at(-half, ARROW_HALF_WIDTH), at(-half, -ARROW_HALF_WIDTH)];
    picture.fill_polygon(head, PATH_COLOUR);
}

/// Positions and unit directions of arrowheads at equal distances along a line, without those that would lie across a
/// corner.
fn place_arrows(line: &[Point], spacing: f64) -> Vec<(Point, Point)> {
    let mut distances = vec![0.0];
    for pair in line.windows(2) {
        distances.push(distances[distances.len() - 1] + distance(pair[0], pair[1]));
    }
    let length = distances[distances.len() - 1];
    // The end of the segment with a point of the line, and the point.
    let at = |along: f64| {
        let end = distances.partition_point(|own| *own < along).clamp(1, line.len() - 1);
        let share = (along - distances[end - 1]) / (distances[end] - distances[end - 1]);
        (end, [0, 1].map(|i| line[end - 1][i] + share * (line[end][i] - line[end - 1][i])))
    };
    let count = (length / spacing + 0.5) as usize;
    let arrow = |index: usize| {
        let along = (index as f64 + 0.5) * spacing;
        let (end, middle) = at(along);
        let ends = [-0.5, 0.5].map(|half| at((along + half * ARROW_LENGTH).clamp(0.0, length)).1);
        let [from, to] = [line[end - 1], line[end]];
        let direction = [0, 1].map(|i| (to[i] - from[i]) / distance(from, to));
        let is_straight = distance(ends[0], ends[1]) > 0.97 * ARROW_LENGTH;
        is_straight.then_some((middle, direction))
    };
    (0..count).filter_map(arrow).collect()
}

impl DiagramFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    fn to_picture(&self) -> Picture {
        let legend = Legend::new(self.legend_entries(), page::width() - 2.0 * MARGIN);
        let top = page::heading_bottom(&self.title, &self.subtitle) + 14.0;
        let below = page::BOTTOM_AXIS_HEIGHT + 22.0 + legend.height() + MARGIN - 12.0;
        let height = page::height().max(top + page::scale_height(560.0) + below).ceil();
        let bottom = height - below;
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let path = || self.path.iter().filter(|point| is_plottable(point));
        let curves = || {
            let points = self.curves.iter().flat_map(|curve| &curve.points);
            points.filter(|point| is_plottable(point))
        };
        let ends = [
            [axis_ends(path().map(|p| p[0]), 0.06), axis_ends(path().map(|p| p[1]), 0.06)],
            [axis_ends(curves().map(|p| p[0]), 0.0), axis_ends(curves().map(|p| p[1]), 0.06)],
        ];
        let panel = |index: usize, left: f64, right: f64| {
            let [x_ends, y_ends] = ends[index];
            Panel { frame: Rectangle { left, top, right, bottom }, x_ends, y_ends }
        };
        // The width of the tick labels does not depend on the horizontal position.
        let axis_width = |index: usize| {
            let ([_, y_ticks], _) = panel(index, MARGIN, page::width() - MARGIN).ticks();
            page::left_axis_width(&y_ticks)
        };
        let [first_axis, second_axis] = [axis_width(0), axis_width(1)];
        let right = page::width() - MARGIN - 20.0;
        let left = MARGIN + first_axis;
        let free = right - left - PANEL_GAP - second_axis;
        let middle = left + 0.52 * free;
        let diagram = panel(0, left, middle);
        let history = panel(1, middle + PANEL_GAP + second_axis, right);
        self.draw_path(&mut picture, &diagram);
        self.draw_curves(&mut picture, &history);
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS_HEIGHT + 22.0);
        picture
    }

    fn draw_path(&self, picture: &mut Picture, panel: &Panel) {
        let ticks = panel.ticks();
        panel.draw_grid(picture, &ticks.0);
        let lines = panel.lines(&self.path);
        let length = lines.iter().flat_map(|line| line.windows(2));
        let length: f64 = length.map(|pair| distance(pair[0], pair[1])).sum();
        let spacing = ARROW_SPACING.max(length / MAX_ARROWS);
        for line in &lines {
            for piece in clip_polyline(line, panel.frame) {
                picture.draw_curve(&piece, &[], LINE_WIDTH, PATH_COLOUR);
            }
            for (middle, direction) in place_arrows(line, spacing) {
                draw_arrowhead(picture, middle, direction);
            }
        }
        if let Some(start) = lines.first().and_then(|line| line.first()) {
            draw_ring(picture, *start);
        }
        if let Some(end) = lines.last().and_then(|line| line.last()) {
            picture.mark_point(*end, END_RADIUS);
            picture.fill_disc(*end, 0.75 * END_RADIUS, INK);
        }
        panel.draw_axes(picture, &ticks, [&self.strain_label, &self.stress_label]);
    }

    fn draw_curves(&self, picture: &mut Picture, panel: &Panel) {
        let ticks = panel.ticks();
        panel.draw_grid(picture, &ticks.0);
        for (index, curve) in self.curves.iter().enumerate() {
            let style = LineStyle::from_index(index);
            for line in panel.lines(&curve.points) {
                for piece in clip_polyline(&line, panel.frame) {
                    style.draw(picture, &piece);
                }
            }
        }
        panel.draw_axes(picture, &ticks, [&self.time_label, &self.curve_label]);
    }

    fn legend_entries(&self) -> Vec<LegendEntry> {
        let middle =
            |area: Rectangle| [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let mut entries: Vec<LegendEntry> = vec![
            (
                self.start_label.clone(),
                Box::new(move |picture, area| draw_ring(picture, middle(area))),
            ),
            (
                self.end_label.clone(),
                Box::new(move |picture, area| {
                    picture.fill_disc(middle(area), 0.75 * END_RADIUS, INK);
                }),
            ),
        ];
        let path = |picture: &mut Picture, area: Rectangle| {
            let y = 0.5 * (area.top + area.bottom);
            picture.draw_curve(&[[area.left, y], [area.right, y]], &[], LINE_WIDTH, PATH_COLOUR);
        };
        entries.push(("stress against strain".to_owned(), Box::new(path)));
        for (index, curve) in self.curves.iter().enumerate() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                LineStyle::from_index(index).draw_swatch(picture, area);
            };
            entries.push((curve.label.clone(), Box::new(swatch)));
        }
        entries
    }
}

fn draw_ring(picture: &mut Picture, centre: Point) {
    picture.mark_point(centre, END_RADIUS);
    picture.fill_disc(centre, END_RADIUS, PALE_INK);
    picture.fill_disc(centre, 0.55 * END_RADIUS, WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, edge_case_curves};

    fn sample_figure(points: &[[f64; 2]]) -> DiagramFigure {
        let curve = |index: usize| DiagramCurve {
            label: format!("energy {index}"),
            points: points.to_vec(),
        };
        DiagramFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            strain_label: "strain ε".to_owned(),
            stress_label: "stress σ (Pa)".to_owned(),
            path: points.to_vec(),
            time_label: "time t (s)".to_owned(),
            curve_label: "energy per volume (J/m³)".to_owned(),
            curves: (0..6).map(curve).collect(),
            start_label: "start".to_owned(),
            end_label: "end".to_owned(),
        }
    }

    #[test]
    fn any_points_are_drawn() {
        for points in edge_case_curves() {
            let figure = sample_figure(&points);
            check_drawing(&figure.to_picture(), |format| figure.draw(format));
        }
    }

    /// Arrows are at equal distances along the line and have its direction; none lies across a corner.
    #[test]
    fn arrows_follow_the_line() {
        let arrows = |line: &[Point]| place_arrows(line, 100.0);
        assert_eq!(arrows(&[[0.0, 0.0]]), []);
        assert_eq!(arrows(&[[0.0, 0.0], [49.0, 0.0]]), []);
        assert_eq!(arrows(&[[0.0, 0.0], [70.0, 0.0]]), [([50.0, 0.0], [1.0, 0.0])]);
        let line = [[0.0, 0.0], [30.0, 0.0], [30.0, 40.0], [300.0, 40.0]];
        let expected = [[30.0, 20.0], [110.0, 40.0], [210.0, 40.0]];
        let directions = [[0.0, 1.0], [1.0, 0.0], [1.0, 0.0]];
        assert!(arrows(&line).into_iter().eq(expected.into_iter().zip(directions)));
        // The first arrow would lie on the corner.
        let corner = [[0.0, 0.0], [45.0, 0.0], [45.0, 300.0]];
        let middles: Vec<Point> = arrows(&corner).into_iter().map(|arrow| arrow.0).collect();
        assert_eq!(middles, [[45.0, 105.0], [45.0, 205.0]]);
    }
}
