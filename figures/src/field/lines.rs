//! Sets of horizontal and vertical lines with values, e.g. the joints of a blocky medium.

use super::colour_map::{ColourScale, SHADE_COUNT};
use super::figure::{FieldAxis, FieldFigure};
use super::legend::{FieldLegendEntry, build_entry, build_note};
use crate::picture::{Colour, INK, Picture, Rectangle, WHITE};
use crate::scale::format_number;

/// Style of a set of lines. Styles differ in shape, not in colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldLineStyle {
    /// Thin grey line of one width, omitted where parallel lines would be too close.
    Outline,
    /// Solid line; its thickness grows with the value, or its darkness where parallel lines are close.
    Solid,
    /// Dotted line; its thickness grows with the value, unless parallel lines are close.
    Dotted,
    /// Gap between two thin lines; its width grows with the value.
    Gap,
    /// Line of one width in the colour that its value has on the colour scale of the field, which covers the values of
    /// these lines, too; not drawn if its magnitude is less than about 5 % of the scale.
    Coloured,
}

/// Line parallel to an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldLine {
    /// Axis normal to the line: 0 for vertical, 1 for horizontal lines.
    pub axis: usize,
    /// Centre of the line, in the units of the axes.
    pub centre: [f64; 2],
    /// Length of the line, in the unit of the other axis.
    pub length: f64,
    /// Value, which determines the width.
    pub value: f64,
}

/// Lines of one style and legend entry.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldLineSet {
    /// Style of the lines.
    pub style: FieldLineStyle,
    /// Text of the legend entry, which is followed by the value of the widest line if there is a unit.
    pub label: String,
    /// Unit of the values; empty for lines without values.
    pub unit: String,
    /// Lines; adjacent lines are joined.
    pub lines: Vec<FieldLine>,
    /// Value of the widest line; without effect on outlines and coloured lines.
    pub limit: f64,
}

/// Smallest magnitude of the colour step of a coloured line that is drawn: paler lines would only cover outlines.
const MIN_COLOUR_STEP: u16 = SHADE_COUNT.unsigned_abs() / 20;
/// Number of distinct widths of lines.
const WIDTH_STEPS: i16 = 5;
/// Minimum distance of parallel lines at which outlines are drawn and lines differ in thickness, pixels.
const MIN_LINE_DISTANCE: f64 = 12.0;
const OUTLINE_COLOUR: Colour = plotters::style::RGBColor(125, 125, 125);
const OUTLINE_WIDTH: f64 = 1.4;
/// Width of the narrowest line, pixels.
const MIN_LINE_WIDTH: f64 = 2.2;
/// Width of the widest line if parallel lines are far apart, pixels.
const MAX_LINE_WIDTH: f64 = 9.0;
/// Share of the distance of parallel lines that the widest line covers.
const MAX_COVERED_SHARE: f64 = 0.4;
/// Width of the white rim of a line, pixels.
const RIM_WIDTH: f64 = 1.0;
/// Width of each of the two lines that enclose a gap, pixels.
const GAP_LINE_WIDTH: f64 = 1.3;

/// Adjacent lines of equal width joined to one line, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LineRun {
    /// Axis normal to the line: 0 for vertical, 1 for horizontal lines.
    axis: usize,
    /// Coordinate normal to the line.
    position: f64,
    from: f64,
    to: f64,
    /// Index of the width, from 1 to [`WIDTH_STEPS`]; for a coloured line the index of its colour.
    step: i16,
}

impl LineRun {
    /// Returns the area of the line with a half-width, lengthened by `extension` at both ends.
    fn area(&self, half: f64, extension: f64) -> Rectangle {
        let (from, to) = (self.from - extension, self.to + extension);
        match self.axis {
            0 => Rectangle {
                left: self.position - half,
                right: self.position + half,
                top: from,
                bottom: to,
            },
            _ => Rectangle {
                left: from,
                right: to,
                top: self.position - half,
                bottom: self.position + half,
            },
        }
    }

    /// Returns the dashes of the line. They start at multiples of the pattern, so that parallel lines are alike.
    fn dashes(self, [dash, gap]: [f64; 2]) -> impl Iterator<Item = Self> {
        let period = dash + gap;
        let first = (self.from / period).floor() as i64;
        let last = (self.to / period).ceil() as i64;
        (first..last).filter_map(move |index| {
            let start = index as f64 * period + 0.5 * gap;
            let (from, to) = (start.max(self.from), (start + dash).min(self.to));
            (from < to).then_some(Self { from, to, ..self })
        })
    }
}

/// Widths of lines, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LineWidths {
    /// Minimum distance of parallel lines of all sets; infinite for single lines.
    line_distance: f64,
}

impl LineWidths {
    fn is_dense(self) -> bool {
        self.line_distance < MIN_LINE_DISTANCE
    }

    /// Width of coloured lines.
    fn coloured_width(self) -> f64 {
        (0.35 * self.line_distance).clamp(1.5, 6.0)
    }

    fn width(self, step: i16) -> f64 {
        if self.is_dense() {
            return (0.22 * self.line_distance).clamp(1.2, 2.0);
        }
        let widest = (MAX_COVERED_SHARE * self.line_distance).min(MAX_LINE_WIDTH);
        MIN_LINE_WIDTH + step_share(step) * (widest - MIN_LINE_WIDTH)
    }

    /// Colour of a solid line.
    fn colour(self, step: i16) -> Colour {
        const PALEST_GREY: f64 = 165.0;
        let share = if self.is_dense() { step_share(step) } else { 1.0 };
        let grey = (PALEST_GREY + share * (f64::from(INK.0) - PALEST_GREY)).round() as u8;
        plotters::style::RGBColor(grey, grey, grey)
    }

    /// Lengths of a dot and of the gap after it. Dashes would look like contour lines at negative levels.
    fn dots(self, step: i16) -> [f64; 2] {
        // Two dots per distance give an even pattern.
        if self.is_dense() { [0.25 * self.line_distance; 2] } else { [self.width(step); 2] }
    }
}

/// Returns the position of a step from the first to the last, in \[0, 1\].
fn step_share(step: i16) -> f64 {
    f64::from(step.clamp(1, WIDTH_STEPS) - 1) / f64::from(WIDTH_STEPS - 1)
}

/// Returns the width step of a value.
fn width_step(value: f64, limit: f64) -> i16 {
    let share = value / limit;
    // A share that is not a number, as for a limit of 0, gives the narrowest line.
    (f64::from(WIDTH_STEPS) * share).ceil().clamp(1.0, f64::from(WIDTH_STEPS)) as i16
}

impl FieldFigure {
    /// Determines the widths of lines in a frame.
    pub(super) fn line_widths(&self, frame: Rectangle) -> LineWidths {
        let mut distance = f64::INFINITY;
        for axis in 0..2 {
            let lines = self.line_sets.iter().flat_map(|set| &set.lines);
            let own = lines.filter(|line| line.axis == axis);
            let mut positions: Vec<f64> =
                own.map(|line| self.pixel(frame, axis, line.centre[axis])).collect();
            positions.sort_by(f64::total_cmp);
            // Equal coordinates may differ by rounding.
            let steps =
                positions.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.05);
            distance = steps.fold(distance, f64::min);
        }
        LineWidths { line_distance: distance }
    }

    /// Returns the position of a coordinate along an axis, in pixels.
    pub(super) fn pixel(&self, frame: Rectangle, axis: usize, value: f64) -> f64 {
        let share = |own: &FieldAxis| (value - own.start) / (own.end - own.start);
        match axis {
            0 => frame.left + share(&self.x) * frame.width(),
            _ => frame.bottom - share(&self.y) * frame.height(),
        }
    }

    /// Joins adjacent lines of equal width and clips them to the frame.
    fn join_lines(
        &self,
        set: &FieldLineSet,
        scale: &ColourScale,
        frame: Rectangle,
    ) -> Vec<LineRun> {
        let to_run = |line: &FieldLine| {
            let along = 1 - line.axis;
            let ends = [-0.5, 0.5].map(|part| {
                let end = self.pixel(frame, along, line.centre[along] + part * line.length);
                match along {
                    0 => end.clamp(frame.left, frame.right),
                    _ => end.clamp(frame.top, frame.bottom),
                }
            });
            let position = self.pixel(frame, line.axis, line.centre[line.axis]);
            let is_inside = match line.axis {
                0 => (frame.left..=frame.right).contains(&position),
                _ => (frame.top..=frame.bottom).contains(&position),
            };
            let (from, to) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let step = match set.style {
                FieldLineStyle::Outline => 1,
                FieldLineStyle::Coloured => scale.colour_step(line.value),
                _ => width_step(line.value, set.limit),
            };
            let is_drawn =
                set.style != FieldLineStyle::Coloured || step.unsigned_abs() > MIN_COLOUR_STEP;
            (is_inside && from < to && is_drawn).then_some(LineRun {
                axis: line.axis,
                position,
                from,
                to,
                step,
            })
        };
        let mut runs: Vec<LineRun> = set.lines.iter().filter_map(to_run).collect();
        // Places that differ by rounding only must not separate lines.
        let key = |run: &LineRun| (run.axis, (20.0 * run.position).round() as i64);
        runs.sort_by(|a, b| key(a).cmp(&key(b)).then(a.from.total_cmp(&b.from)));
        let mut joined: Vec<LineRun> = Vec::new();
        for run in runs {
            match joined.last_mut() {
                Some(last)
                    if key(last) == key(&run)
                        && last.step == run.step
                        && (run.from - last.to).abs() < 0.05 =>
                {
                    last.to = run.to;
                }
                _ => joined.push(run),
            }
        }
        joined
    }

    /// Draws all sets in order; later sets cover earlier ones.
    pub(super) fn draw_line_sets(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        scale: &ColourScale,
        widths: LineWidths,
    ) {
        for set in &self.line_sets {
            if set.style != FieldLineStyle::Outline || !widths.is_dense() {
                let runs = self.join_lines(set, scale, frame);
                draw_runs(picture, set.style, &runs, (scale, widths));
            }
        }
    }

    /// Builds one legend entry per set. With a fixed scale, sets without lines have one as well, since other frames may
    /// have lines.
    pub(super) fn line_entries(
        &self,
        scale: &ColourScale,
        widths: LineWidths,
    ) -> Vec<FieldLegendEntry> {
        let shown = self.line_sets.iter().filter(|set| scale.is_fixed || !set.lines.is_empty());
        let entry = |set: &FieldLineSet| {
            let style = set.style;
            if style == FieldLineStyle::Outline && widths.is_dense() {
                return build_note(format!("{} not drawn: too close together", set.label));
            }
            let scale = scale.clone();
            let scale_limit = scale.limit;
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let position = 0.5 * (area.top + area.bottom);
                let steps: &[i16] = match style {
                    FieldLineStyle::Outline => &[1],
                    FieldLineStyle::Coloured if scale.is_signed => {
                        &[-SHADE_COUNT, -SHADE_COUNT / 2, SHADE_COUNT / 2, SHADE_COUNT]
                    }
                    FieldLineStyle::Coloured => {
                        &[SHADE_COUNT / 3, 2 * SHADE_COUNT / 3, SHADE_COUNT]
                    }
                    _ => &[1, 3, 5],
                };
                let length = area.width() / steps.len() as f64;
                let runs: Vec<LineRun> = steps
                    .iter()
                    .enumerate()
                    .map(|(index, &step)| {
                        let from = area.left + index as f64 * length;
                        LineRun { axis: 1, position, from, to: from + length, step }
                    })
                    .collect();
                draw_runs(picture, style, &runs, (&scale, widths));
            };
            let FieldLineSet { label, unit, limit, .. } = set;
            let text = match () {
                () if style == FieldLineStyle::Coloured => {
                    let least = format_number(0.05 * scale_limit);
                    format!("{label}, above {least}{}", self.unit_suffix())
                }
                () if unit.is_empty() || !limit.is_finite() => label.clone(),
                () => format!("{label} up to {} {unit}", format_number(*limit)),
            };
            build_entry(text, swatch)
        };
        shown.map(entry).collect()
    }
}

/// Draws joined lines in a style.
fn draw_runs(
    picture: &mut Picture,
    style: FieldLineStyle,
    runs: &[LineRun],
    (scale, widths): (&ColourScale, LineWidths),
) {
    let areas = |more: f64, extension: f64| -> Vec<Rectangle> {
        let area = |run: &LineRun| run.area(0.5 * widths.width(run.step) + more, extension);
        runs.iter().map(area).collect()
    };
    match style {
        FieldLineStyle::Outline => {
            let area = |run: &LineRun| run.area(0.5 * OUTLINE_WIDTH, 0.0);
            picture.fill_patches(runs.iter().map(area).collect(), OUTLINE_COLOUR);
        }
        FieldLineStyle::Solid => {
            if !widths.is_dense() {
                picture.fill_patches(areas(RIM_WIDTH, 0.0), WHITE);
            }
            for step in 1..=WIDTH_STEPS {
                let own = runs.iter().filter(|run| run.step == step);
                let area = |run: &LineRun| run.area(0.5 * widths.width(step), 0.0);
                picture.fill_patches(own.map(area).collect(), widths.colour(step));
            }
        }
        FieldLineStyle::Dotted => {
            picture.fill_patches(areas(RIM_WIDTH, 0.0), WHITE);
            let dashes = runs.iter().flat_map(|run| run.dashes(widths.dots(run.step)));
            let area = |run: LineRun| run.area(0.5 * widths.width(run.step), 0.0);
            picture.fill_patches(dashes.map(area).collect(), INK);
        }
        FieldLineStyle::Coloured => {
            // Larger magnitudes cover smaller ones where lines cross.
            let mut steps: Vec<i16> = runs.iter().map(|run| run.step).collect();
            steps.sort_unstable_by_key(|step| (step.unsigned_abs(), *step));
            steps.dedup();
            for step in steps {
                let own = runs.iter().filter(|run| run.step == step);
                let area = |run: &LineRun| run.area(0.5 * widths.coloured_width(), 0.0);
                picture.fill_patches(own.map(area).collect(), scale.step_colour(step));
            }
        }
        FieldLineStyle::Gap => {
            picture.fill_patches(areas(GAP_LINE_WIDTH, 0.5 * GAP_LINE_WIDTH), INK);
            picture.fill_patches(areas(0.0, -0.5 * GAP_LINE_WIDTH), WHITE);
        }
    }
}
