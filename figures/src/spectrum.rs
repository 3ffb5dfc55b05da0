//! Spectra: a quantity against the mode number, on logarithmic axes.

use crate::dispersion::{draw_disagreement, draw_ring, draw_rings};
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::{GRID_COLOUR, LabelledCurve, LineStyle, build_line_entries};
use crate::page::{self, FRAME_LINE_WIDTH, Legend, LegendEntry, MARGIN};
use crate::picture::{Colour, INK, Picture, Point, Rectangle};
use crate::scale::{self, Tick};

/// Spectra of a positive quantity at several times, against the mode number; both axes are logarithmic.
///
/// Values more than 14 decades below the largest value are rounding errors and are omitted; so are values below a gap of
/// three decades without values, which would take most of the axis: the legend says so.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name and unit of the horizontal axis.
    pub x_label: String,
    /// Name and unit of the quantity.
    pub y_label: String,
    /// Spectra, one per time; the first eight have distinct styles. Points that are non-positive or non-finite
    /// interrupt a line; a point between two such points is drawn as a disc. Spectra without any point are not listed.
    pub spectra: Vec<LabelledCurve>,
    /// Measured points of each line, drawn as rings in its colour; may have fewer lists than there are lines.
    pub measured_points: Vec<Vec<[f64; 2]>>,
    /// Those of the measured points that disagree with the lines, marked by red crosses.
    pub disagreeing_points: Vec<[f64; 2]>,
    /// Remarks on what is not drawn, such as a model without positive values; listed last, in parentheses.
    pub remarks: Vec<String>,
}

/// Maximum number of decades of the vertical axis.
const MAX_DECADES: f64 = 14.0;
/// Decades without values below which values are omitted.
const MAX_EMPTY_DECADES: f64 = 3.0;
/// Radius of a disc at a point, pixels.
const POINT_RADIUS: f64 = 5.0;
/// Number of points of a line above which they have no discs: these would touch each other.
const MAX_DISC_COUNT: usize = 64;

/// Decimal logarithms of the coordinates of a spectrum and of its measured points.
struct Series<'a> {
    label: &'a str,
    points: Vec<[f64; 2]>,
    rings: Vec<[f64; 2]>,
}

impl Series<'_> {
    fn all(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.points.iter().chain(&self.rings)
    }
}

impl SpectrumFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    fn to_picture(&self) -> Picture {
        // Decimal logarithms of the coordinates; NaN for non-positive numbers.
        let place = |value: f64| if value > 0.0 { value.log10() } else { f64::NAN };
        let places = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            points.iter().map(|point| point.map(place)).collect()
        };
        let mut series: Vec<Series> = Vec::new();
        for (index, line) in self.spectra.iter().enumerate() {
            let rings = self.measured_points.get(index).map_or(&[][..], Vec::as_slice);
            let label = line.label.as_str();
            series.push(Series { label, points: places(&line.points), rings: places(rings) });
        }
        let heights = || series.iter().flat_map(Series::all).map(|point| point[1]);
        let finite = heights().filter(|height| height.is_finite());
        // Smaller values are rounding errors of modes without energy.
        let rounding = finite.fold(f64::NEG_INFINITY, f64::max) - MAX_DECADES;
        // Measured points are shown wherever they are.
        let is_measured = self.measured_points.iter().any(|own| !own.is_empty());
        let lowest =
            if is_measured { rounding } else { find_gap(heights().collect()).max(rounding) };
        let omitted = heights().filter(|height| (rounding..lowest).contains(height));
        let largest_omitted = omitted.fold(f64::NEG_INFINITY, f64::max);
        let is_drawn = |point: &[f64; 2]| {
            point.iter().all(|coordinate| coordinate.is_finite()) && point[1] >= lowest
        };
        series.retain(|own| own.all().any(is_drawn));

        let labels: Vec<&str> = series.iter().map(|own| own.label).collect();
        let mut entries = build_line_entries(&labels);
        if series.iter().any(|own| own.rings.iter().any(is_drawn)) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let middle = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
                draw_ring(picture, middle, INK);
            };
            entries.push(("measured in time".to_owned(), Box::new(swatch)));
        }
        let disagreeing = places(&self.disagreeing_points);
        if disagreeing.iter().any(is_drawn) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let middle = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
                draw_disagreement(picture, middle);
            };
            entries.push(("disagrees with the prediction".to_owned(), Box::new(swatch)));
        }
        if largest_omitted.is_finite() {
            let text = format!(
                "(values up to {} omitted)",
                scale::format_scientific(10_f64.powf(largest_omitted), 0)
            );
            entries.push((text, Box::new(|_, _| {})));
        }
        let remarks = self.remarks.iter().map(|text| -> LegendEntry {
            (format!("({text})"), Box::new(|_: &mut Picture, _| {}))
        });
        entries.extend(remarks);
        let legend = Legend::new(entries, page::width() - 2.0 * MARGIN);
        let below = page::BOTTOM_AXIS_HEIGHT + 22.0 + legend.height() + MARGIN - 12.0;
        let mut picture = page::create_page(page::height(), &self.title, &self.subtitle);
        let top = page::heading_bottom(&self.title, &self.subtitle) + 14.0;
        let bottom = page::height() - below;

        let drawn = || series.iter().flat_map(Series::all).filter(|point| is_drawn(point));
        let [x, y] = [0, 1].map(|axis| axis_range(drawn().map(|point| point[axis])));
        let ticks =
            |[low, high]: [f64; 2], max_count: usize| scale::log_ticks(low, high, max_count);
        let y_ticks = ticks(y, ((bottom - top) / 48.0) as usize);
        let left = MARGIN + page::left_axis_width(&y_ticks);
        let frame = Rectangle { left, top, right: page::width() - MARGIN, bottom };

        let at = |[a, b]: [f64; 2]| {
            let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
            [frame.left + share(a, x) * frame.width(), frame.bottom - share(b, y) * frame.height()]
        };
        let x_ticks = page::choose_ticks(frame.width(), false, |max_count| ticks(x, max_count));
        let across: Vec<Tick> =
            x_ticks.into_iter().map(|(value, name)| (at([value, y[0]])[0], name)).collect();
        let upwards: Vec<Tick> =
            y_ticks.into_iter().map(|(value, name)| (at([x[0], value])[1], name)).collect();
        for (place, _) in &across {
            picture.draw_line([[*place, frame.top], [*place, frame.bottom]], 1.2, GRID_COLOUR);
        }
        for (place, _) in &upwards {
            picture.draw_line([[frame.left, *place], [frame.right, *place]], 1.2, GRID_COLOUR);
        }
        for (index, own) in series.iter().enumerate() {
            let style = LineStyle::from_index(index);
            for part in own.points.split(|point| !is_drawn(point)) {
                let part: Vec<[f64; 2]> = part.iter().map(|point| at(*point)).collect();
                if part.len() > 1 {
                    style.draw(&mut picture, &part);
                }
                if own.points.len() <= MAX_DISC_COUNT || part.len() == 1 {
                    part.iter().for_each(|at| picture.fill_disc(*at, POINT_RADIUS, style.colour));
                }
            }
        }
        let rings: Vec<(Point, Colour)> = series
            .iter()
            .enumerate()
            .flat_map(|(index, own)| own.rings.iter().map(move |point| (index, point)))
            .filter(|(_, point)| is_drawn(point))
            .map(|(index, point)| (at(*point), LineStyle::from_index(index).colour))
            .collect();
        draw_rings(&mut picture, &rings, frame);
        for point in disagreeing.iter().filter(|point| is_drawn(point)) {
            draw_disagreement(&mut picture, at(*point));
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        page::draw_bottom_axis(&mut picture, frame, &across, &self.x_label);
        page::draw_left_axis(&mut picture, frame, &upwards, &self.y_label);
        legend.draw(&mut picture, MARGIN, bottom + page::BOTTOM_AXIS_HEIGHT + 22.0);
        picture
    }
}

/// Computes the range of the finite positions with margins; a default range if there are none.
fn axis_range(places: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = places.filter(|place| place.is_finite());
    let ends = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
        [low.min(place), high.max(place)]
    });
    match ends {
        [low, high] if low > high => [0.0, 1.0],
        [low, high] => {
            let margin = (0.03 * (high - low)).max(0.05);
            [low - margin, high + margin]
        }
    }
}

/// Returns the lowest of the decimal logarithms above the highest gap of [`MAX_EMPTY_DECADES`]; −∞ without gap.
fn find_gap(mut heights: Vec<f64>) -> f64 {
    heights.retain(|height| height.is_finite());
    heights.sort_by(|a, b| b.total_cmp(a));
    let gap = heights.windows(2).find(|pair| pair[0] - pair[1] > MAX_EMPTY_DECADES);
    gap.map_or(f64::NEG_INFINITY, |pair| pair[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FigureFormat;
    use crate::tests::png_size;

    fn sample_figure(times: usize, value: impl Fn(f64, usize) -> f64) -> SpectrumFigure {
        let line = |time: usize| LabelledCurve {
            label: format!("t = {time} s"),
            points: (1..=64).map(f64::from).map(|n| [n, value(n, time)]).collect(),
        };
        SpectrumFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            x_label: "mode number n".to_owned(),
            y_label: "energy, J/m³".to_owned(),
            spectra: (0..times).map(line).collect(),
            measured_points: vec![(1..4).map(f64::from).map(|n| [n, value(n, 0)]).collect()],
            disagreeing_points: vec![[2.0, value(2.0, 0)]],
            remarks: vec!["nothing grows".to_owned()],
        }
    }

    #[test]
    fn spectra_of_all_kinds_are_drawn() {
        for times in [0, 1, 6, 9] {
            for value in [
                |n: f64, time: usize| 1e-3 * n.powi(-3) * (time as f64).exp(),
                |n: f64, _: usize| (-n).exp() * 1e300,
                |_: f64, _: usize| 0.0,
                |n: f64, time: usize| if time == 1 { f64::NAN } else { n - 3.0 },
                |n: f64, _: usize| if n > 5.0 { f64::INFINITY } else { 2.0 },
            ] {
                let figure = sample_figure(times, value);
                assert_eq!(png_size(&figure.draw(FigureFormat::Png).unwrap()), [1600, 1100]);
                let svg = figure.draw(FigureFormat::Svg).unwrap();
                assert!(!String::from_utf8(svg).unwrap().contains("NaN"));
            }
        }
    }

    /// Shells without energy are not drawn, and a spectrum without any other shell is not in the legend.
    #[test]
    fn empty_shells_and_spectra_are_left_out() {
        let energy = |n: f64, time: usize| match (time, n as usize) {
            (0, _) => 0.0,
            (1, 20) => 1.0,
            (2, 1..=9) => 0.1 / n,
            (2, 30..) => 1e-20,
            _ => f64::NEG_INFINITY,
        };
        let figure = sample_figure(3, energy);
        let picture = figure.to_picture();
        let texts: Vec<&str> = picture.texts().map(|own| own.content.as_str()).collect();
        assert!(texts.contains(&"t = 1 s") && texts.contains(&"t = 2 s"), "{texts:?}");
        assert!(!texts.contains(&"t = 0 s") && !texts.contains(&"10⁻²⁰"), "{texts:?}");
        let expected =
            sample_figure(3, |n, time| if n > 20.0 { f64::NAN } else { energy(n, time) });
        assert!(
            figure.draw(FigureFormat::Svg).unwrap() == expected.draw(FigureFormat::Svg).unwrap()
        );
        let mut without = figure;
        without.spectra[1].points.retain(|point| point[0] != 20.0);
        let texts: Vec<String> =
            without.to_picture().texts().map(|own| own.content.clone()).collect();
        assert!(!texts.contains(&"t = 1 s".to_owned()), "{texts:?}");
    }

    #[test]
    fn rounding_and_gaps_do_not_stretch_the_axis() {
        let text = |small: f64, is_measured: bool| {
            let mut figure = sample_figure(1, |n, _| if n < 9.0 { 1.0 / n } else { small });
            if !is_measured {
                figure.measured_points.clear();
            }
            String::from_utf8(figure.draw(FigureFormat::Svg).unwrap()).unwrap()
        };
        assert!(text(1e-12, true).contains("10⁻¹⁰") && !text(1e-40, true).contains("10⁻³⁰"));
        // From 1/8 to 10⁻³ it is two decades, to 10⁻⁶ five.
        let [near, far] = [1e-3, 1e-6].map(|small| text(small, false));
        assert!(near.contains("10⁻³") && !near.contains("omitted"));
        assert!(far.contains("(values up to 10⁻⁶ omitted)") && !far.contains("10⁻⁵"));
    }
}
