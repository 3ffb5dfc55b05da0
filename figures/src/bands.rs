//! Band diagrams: frequencies of waves in a periodic medium along a path of the Brillouin zone.

use crate::colour::CURVE_COLOURS;
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::{GRID_COLOUR, LINE_WIDTH};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip_polyline,
    text_width,
};
use crate::scale::{self, FINITE_LIMIT, Tick};
use plotters::style::RGBColor;

/// Line style of a family of curves in a band diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BandStyle {
    /// First family of Bloch waves: solid blue lines.
    FirstFamily,
    /// Second family of Bloch waves: solid orange lines.
    SecondFamily,
    /// Third family of Bloch waves: solid green lines.
    ThirdFamily,
    /// Curves of a comparison, such as a continuum: dashed black lines.
    Comparison,
    /// Curves of a reference, such as a closed form: grey dots.
    Reference,
}

/// Family of curves of a band diagram, with one style and legend entry.
#[derive(Debug, Clone, PartialEq)]
pub struct BandFamily {
    /// Legend text.
    pub label: String,
    /// Line style.
    pub style: BandStyle,
    /// Curves: pairs of distance along the path and value; NaN interrupts a line.
    pub curves: Vec<Vec<[f64; 2]>>,
}

/// Band diagram: frequencies along a path of the Brillouin zone and, in a panel below, decay rates if waves are damped.
#[derive(Debug, Clone, PartialEq)]
pub struct BandFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name of the path axis.
    pub path_label: String,
    /// Name, symbol and unit of the frequency.
    pub frequency_label: String,
    /// Name, symbol and unit of the decay rate; unused without `decay_rates`.
    pub decay_label: String,
    /// Vertices of the path: distance and name, ascending; at least two.
    pub vertices: Vec<(f64, String)>,
    /// Curves of frequencies. The axis ends at the largest frequency of the families with solid lines.
    pub frequencies: Vec<BandFamily>,
    /// Curves of decay rates; empty without damping.
    pub decay_rates: Vec<BandFamily>,
    /// Band gaps: lower and upper frequency of each.
    pub gaps: Vec<[f64; 2]>,
    /// Legend text of the band gaps.
    pub gap_label: String,
    /// Unit of the frequencies, written after those in band gaps.
    pub gap_unit: String,
}

const GAP_COLOUR: Colour = RGBColor(228, 224, 214);
const COMPARISON_DASHES: &[f64] = &[13.0, 8.0];
const REFERENCE_DASHES: &[f64] = &[3.0, 8.0];
/// Font size of the frequencies written into band gaps, pixels.
const GAP_LABEL_SIZE: f64 = 22.0;

impl BandStyle {
    const fn colour(self) -> Colour {
        match self {
            Self::FirstFamily => CURVE_COLOURS[2],
            Self::SecondFamily => CURVE_COLOURS[1],
            Self::ThirdFamily => CURVE_COLOURS[3],
            Self::Comparison => CURVE_COLOURS[0],
            Self::Reference => RGBColor(90, 90, 90),
        }
    }

    const fn dashes(self) -> &'static [f64] {
        match self {
            Self::FirstFamily | Self::SecondFamily | Self::ThirdFamily => &[],
            Self::Comparison => COMPARISON_DASHES,
            Self::Reference => REFERENCE_DASHES,
        }
    }

    /// Line width, pixels: the families differ in greyscale.
    const fn width(self) -> f64 {
        match self {
            Self::FirstFamily => LINE_WIDTH + 1.5,
            Self::SecondFamily | Self::Reference => LINE_WIDTH,
            Self::ThirdFamily => 0.6 * LINE_WIDTH,
            Self::Comparison => 0.75 * LINE_WIDTH,
        }
    }

    const fn is_solid(self) -> bool {
        matches!(self, Self::FirstFamily | Self::SecondFamily | Self::ThirdFamily)
    }
}

/// Panel of a band diagram with its axes.
struct BandPanel<'a> {
    frame: Rectangle,
    /// Ends of the path axis.
    path_ends: [f64; 2],
    /// Upper end of the vertical axis, which begins at zero.
    upper_end: f64,
    families: &'a [BandFamily],
}

impl BandPanel<'_> {
    fn to_point(&self, [x, y]: Point) -> Point {
        let Rectangle { left, bottom, .. } = self.frame;
        let [start, end] = self.path_ends;
        [
            left + (x - start) / (end - start) * self.frame.width(),
            bottom - y / self.upper_end * self.frame.height(),
        ]
    }

    fn ticks(&self) -> Vec<Tick> {
        let ticks = page::choose_ticks(self.frame.height(), true, |max_count| {
            scale::linear_ticks(0.0, self.upper_end, max_count, false)
        });
        let inside = ticks.into_iter().filter(|(value, _)| (0.0..=self.upper_end).contains(value));
        inside.map(|(value, label)| (self.to_point([self.path_ends[0], value])[1], label)).collect()
    }

    fn draw(&self, picture: &mut Picture, vertices: &[Tick], gaps: &[[f64; 2]], label: &str) {
        let frame = self.frame;
        let ticks = self.ticks();
        for area in gaps.iter().filter_map(|gap| self.gap_area(*gap)) {
            picture.fill_rectangle(area, GAP_COLOUR);
        }
        for (y, _) in &ticks {
            picture.draw_line([[frame.left, *y], [frame.right, *y]], 1.2, GRID_COLOUR);
        }
        for (x, _) in vertices {
            picture.draw_line([[*x, frame.top], [*x, frame.bottom]], FRAME_LINE_WIDTH, PALE_INK);
        }
        // Solid lines first, so that dashes and dots stay visible.
        for is_solid in [true, false] {
            for family in self.families.iter().filter(|own| own.style.is_solid() == is_solid) {
                for curve in &family.curves {
                    let points: Vec<Point> =
                        curve.iter().map(|point| self.to_point(*point)).collect();
                    for part in clip_polyline(&points, frame) {
                        let style = family.style;
                        picture.draw_curve(&part, style.dashes(), style.width(), style.colour());
                    }
                }
            }
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        page::draw_left_axis(picture, frame, &ticks, label);
    }

    /// Area of a band gap in the panel; `None` if it is outside the range of the axis.
    fn gap_area(&self, [low, high]: [f64; 2]) -> Option<Rectangle> {
        let [bottom, top] = [low, high].map(|value| self.to_point([self.path_ends[0], value])[1]);
        let area = Rectangle {
            top: top.clamp(self.frame.top, self.frame.bottom),
            bottom: bottom.clamp(self.frame.top, self.frame.bottom),
            ..self.frame
        };
        (low < high && area.height() > 0.0).then_some(area)
    }
}

impl BandFigure {
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
        let has_decay = !self.decay_rates.is_empty();
        let min_height = if has_decay { 960.0 } else { 620.0 };
        let height = page::height().max(top + page::scale_height(min_height) + below).ceil();
        let bottom = height - below;
        let mut picture = page::create_page(height, &self.title, &self.subtitle);
        let split = if has_decay { top + 0.62 * (bottom - top) } else { bottom };
        let path_ends = self.path_ends();
        let panel = |top: f64, bottom: f64, left: f64, families| {
            let frame = Rectangle { left, top, right: page::width() - MARGIN - 16.0, bottom };
            BandPanel { frame, path_ends, upper_end: axis_upper_end(families), families }
        };
        let panels = |left: f64| {
            let mut all = vec![panel(top, split, left, self.frequencies.as_slice())];
            if has_decay {
                all.push(panel(split + 30.0, bottom, left, self.decay_rates.as_slice()));
            }
            all
        };
        let left_axis = |panel: &BandPanel| page::left_axis_width(&panel.ticks());
        let left = MARGIN + panels(MARGIN).iter().map(left_axis).fold(0.0, f64::max);
        let panels = panels(left);
        let vertices: Vec<Tick> = self
            .vertices
            .iter()
            .map(|(x, name)| (panels[0].to_point([*x, 0.0])[0], name.clone()))
            .filter(|(x, _)| (left - 1.0..=page::width()).contains(x))
            .collect();
        let labels = [&self.frequency_label, &self.decay_label];
        for (index, panel) in panels.iter().enumerate() {
            let gaps = if index == 0 { self.gaps.as_slice() } else { &[] };
            panel.draw(&mut picture, &vertices, gaps, labels[index]);
        }
        self.draw_gap_labels(&mut picture, &panels[0]);
        let lowest = panels.last().map_or(panels[0].frame, |panel| panel.frame);
        page::draw_bottom_axis(&mut picture, lowest, &vertices, &self.path_label);
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS_HEIGHT + 22.0);
        picture
    }

    /// Writes the edges of each band gap into its area, if the area is high enough for a line of text; of gaps that
    /// overlap, those of the first.
    fn draw_gap_labels(&self, picture: &mut Picture, panel: &BandPanel) {
        let mut labelled: Vec<Rectangle> = Vec::new();
        for gap in &self.gaps {
            let Some(area) =
                panel.gap_area(*gap).filter(|area| area.height() > 1.7 * GAP_LABEL_SIZE)
            else {
                continue;
            };
            let [low, high] = gap.map(format_frequency);
            let text = format!("{low} to {high} {}", self.gap_unit);
            let width = text_width(&text, GAP_LABEL_SIZE, false);
            let middle = [area.right - 0.5 * width - 24.0, 0.5 * (area.top + area.bottom)];
            let label = Text::new(
                [middle[0], middle[1] + 0.36 * GAP_LABEL_SIZE],
                Anchor::Middle,
                GAP_LABEL_SIZE,
                text,
            );
            let bounds = label.bounds();
            let area = Rectangle {
                left: bounds.left - 8.0,
                top: bounds.top - 4.0,
                right: bounds.right + 8.0,
                bottom: bounds.bottom + 4.0,
            };
            if labelled.iter().any(|other| other.top < area.bottom && area.top < other.bottom) {
                continue;
            }
            picture.fill_rectangle(area, WHITE);
            picture.draw_text(label);
            labelled.push(area);
        }
    }

    fn path_ends(&self) -> [f64; 2] {
        let finite = self.vertices.iter().map(|own| own.0).filter(|x| x.abs() < FINITE_LIMIT);
        let range = finite
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        if range[0] < range[1] { range } else { [0.0, 1.0] }
    }

    fn legend_entries(&self) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for family in self.frequencies.iter().filter(|own| !own.curves.is_empty()) {
            let style = family.style;
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                let ends = [[area.left, y], [area.right, y]];
                picture.draw_dashed_line(&ends, style.dashes(), style.width(), style.colour());
            };
            entries.push((family.label.clone(), Box::new(swatch)));
        }
        if !self.gaps.is_empty() {
            entries.push((
                self.gap_label.clone(),
                Box::new(|picture, area| {
                    picture.fill_rectangle(area, GAP_COLOUR);
                    picture.draw_frame(area, 1.5, PALE_INK);
                }),
            ));
        }
        entries
    }
}

fn format_frequency(value: f64) -> String {
    match value.abs() {
        size if !(1e-3..1e6).contains(&size) => format!("{value:.3e}"),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

/// Upper end of an axis: 4 % above the largest finite value of the families with solid lines; 1 without positive
/// values.
fn axis_upper_end(families: &[BandFamily]) -> f64 {
    let solid = families.iter().filter(|family| family.style.is_solid());
    let values = solid.flat_map(|family| family.curves.iter().flatten()).map(|point| point[1]);
    let largest = values.filter(|value| *value < FINITE_LIMIT).fold(0.0, f64::max);
    if largest > 1e-300 { 1.04 * largest } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{check_drawing, edge_case_curves};

    fn sample_figure(points: &[[f64; 2]], gaps: &[[f64; 2]], is_damped: bool) -> BandFigure {
        let family = |style, label: &str| BandFamily {
            label: label.to_owned(),
            style,
            curves: vec![points.to_vec()],
        };
        let families = vec![
            family(BandStyle::FirstFamily, "P-like"),
            family(BandStyle::SecondFamily, "S-like"),
            family(BandStyle::ThirdFamily, "mixed"),
            family(BandStyle::Comparison, "continuum"),
            family(BandStyle::Reference, "chain"),
        ];
        BandFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            path_label: "wave vector κ".to_owned(),
            frequency_label: "frequency f (kHz)".to_owned(),
            decay_label: "decay rate Im ω (1/s)".to_owned(),
            vertices: vec![
                (0.0, "Γ".into()),
                (1.0, "X".into()),
                (2.0, "M".into()),
                (3.4, "Γ".into()),
            ],
            decay_rates: if is_damped { families.clone() } else { Vec::new() },
            frequencies: families,
            gaps: gaps.to_vec(),
            gap_label: "band gap".to_owned(),
            gap_unit: "kHz".to_owned(),
        }
    }

    #[test]
    fn any_points_are_drawn() {
        let check = |points: &[Point], is_damped: bool| {
            let gaps = [[0.5, 0.7], [2.0, 1.0], [f64::NAN, 1.0], [0.1, f64::INFINITY]];
            let figure = sample_figure(points, &gaps, is_damped);
            check_drawing(&figure.to_picture(), |format| figure.draw(format));
        };
        // Damped waves have frequencies and, in a panel of their own, decay rates.
        edge_case_curves().iter().for_each(|points| check(points, true));
        check(&[[0.0, 0.0], [1.0, 2.0], [3.4, 0.0]], false);
    }

    #[test]
    fn vertices_of_any_kind_are_drawn() {
        let points = [[0.0, 0.0], [1.0, 2.0], [3.4, 0.0]];
        for vertices in [vec![], vec![(1.0, "Γ".to_owned())], vec![(f64::NAN, "X".to_owned())]] {
            let figure = BandFigure { vertices, ..sample_figure(&points, &[], false) };
            check_drawing(&figure.to_picture(), |format| figure.draw(format));
        }
    }

    /// Verifies that the range of the axis depends on the families with solid lines only.
    #[test]
    fn axis_range_ignores_comparison_curves() {
        let mut figure = sample_figure(&[[0.0, 0.0], [1.0, 2.0]], &[], false);
        figure.frequencies[3].curves = vec![vec![[0.0, 0.0], [1.0, 500.0]]];
        assert_eq!(axis_upper_end(&figure.frequencies), 2.08);
    }
}
