//! Fills of the categories: background colours and hatching.

use plotters::style::RGBColor;

use super::colour_map::ILL_POSED_COLOUR;
use super::figure::{FillStyle, Hatching};
use super::raster::find_runs;
use crate::picture::{Colour, Picture, Point, Rectangle, clip_polyline};

/// A set of parallel lines over the cells of a category.
#[derive(Clone, Copy)]
pub(crate) struct HatchLines {
    /// Direction of the lines; y increases downwards.
    pub(crate) direction: [f64; 2],
    /// Distance between the lines, pixels.
    pub(crate) spacing: f64,
    /// Width of the lines, pixels.
    pub(crate) line_width: f64,
    pub(crate) colour: Colour,
}

const RISING_DIRECTION: [f64; 2] = [1.0, -1.0];
const FALLING_DIRECTION: [f64; 2] = [1.0, 1.0];
const HORIZONTAL_DIRECTION: [f64; 2] = [1.0, 0.0];
pub(crate) const VERTICAL_DIRECTION: [f64; 2] = [0.0, 1.0];

/// Returns the fill of a category without levels: background colour and hatching.
pub(crate) fn category_fill(style: FillStyle) -> (Colour, Vec<HatchLines>) {
    let hatch = |direction, spacing, line_width, grey| HatchLines {
        direction,
        spacing,
        line_width,
        colour: RGBColor(grey, grey, grey),
    };
    match style {
        FillStyle::WellPosed => (RGBColor(243, 248, 253), vec![]),
        FillStyle::IllPosed(hatching) => {
            let directions: &[[f64; 2]] = match hatching {
                Hatching::Plain => &[],
                Hatching::Rising => &[RISING_DIRECTION],
                Hatching::Falling => &[FALLING_DIRECTION],
                Hatching::Horizontal => &[HORIZONTAL_DIRECTION],
                Hatching::Vertical => &[VERTICAL_DIRECTION],
                Hatching::Grid => &[HORIZONTAL_DIRECTION, VERTICAL_DIRECTION],
            };
            let pair =
                |&along: &[f64; 2]| [hatch(along, 30.0, 3.4, 255), hatch(along, 30.0, 1.4, 20)];
            (ILL_POSED_COLOUR, directions.iter().flat_map(pair).collect())
        }
        FillStyle::UnboundedAtFiniteWaveNumber => {
            let ground = RGBColor(38, 38, 58);
            (
                ground,
                [RISING_DIRECTION, FALLING_DIRECTION]
                    .map(|direction| hatch(direction, 18.0, 1.6, 235))
                    .to_vec(),
            )
        }
        FillStyle::Marginal => {
            (RGBColor(20, 160, 130), vec![hatch(VERTICAL_DIRECTION, 9.0, 1.8, 10)])
        }
        FillStyle::Indeterminate => {
            (RGBColor(150, 150, 155), vec![hatch(FALLING_DIRECTION, 9.0, 1.8, 50)])
        }
        FillStyle::OutsideModel => {
            (RGBColor(222, 222, 222), vec![hatch(RISING_DIRECTION, 24.0, 2.0, 150)])
        }
    }
}

/// Draws the lines of a hatching over the points of an area that `is_covered` selects.
pub(crate) fn draw_hatch(
    picture: &mut Picture,
    area: Rectangle,
    hatch: HatchLines,
    is_covered: impl Fn(Point) -> bool,
) {
    let length = hatch.direction[0].hypot(hatch.direction[1]);
    let [dx, dy] = hatch.direction.map(|part| part / length);
    // Lines are numbered by their distance from the corner of the picture, so that the hatching of separate areas is
    // aligned.
    let distance = |[x, y]: Point| (dx * y - dy * x) / hatch.spacing;
    let corners = [
        [area.left, area.top],
        [area.right, area.top],
        [area.left, area.bottom],
        [area.right, area.bottom],
    ];
    let distances = corners.map(distance);
    let first = distances.iter().copied().fold(f64::INFINITY, f64::min).ceil() as i64;
    let last = distances.iter().copied().fold(f64::NEG_INFINITY, f64::max).floor() as i64;
    let reach = f64::from(picture.width + picture.height);
    for count in first..=last {
        let offset = (count as f64) * hatch.spacing;
        let [x, y] = [-dy * offset, dx * offset];
        let whole = [[x - reach * dx, y - reach * dy], [x + reach * dx, y + reach * dy]];
        for part in clip_polyline(&whole, area) {
            let (from, to) = (part[0], part[1]);
            let steps = (to[0] - from[0]).hypot(to[1] - from[1]).floor();
            let at = |step: f64| [from[0] + step * dx, from[1] + step * dy];
            for (begin, end) in find_runs(steps as usize, |step| is_covered(at(step as f64 + 0.5)))
            {
                picture.draw_line(
                    [at(begin as f64), at(end as f64)],
                    hatch.line_width,
                    hatch.colour,
                );
            }
        }
    }
}
