//! Fills of the categories: background colours and hatching.

use plotters::style::RGBColor;

use super::colour_map::NO_LEVELS;
use super::figure::Look;
use super::raster::runs;
use crate::picture::{Colour, Picture, Point, Rectangle, clip};

/// A set of parallel lines over the cells of a category.
#[derive(Clone, Copy)]
pub(super) struct Hatch {
    /// Direction of the lines; y increases downwards.
    pub(super) along: [f64; 2],
    /// Distance between the lines, pixels.
    spacing: f64,
    pub(super) width: f64,
    pub(super) colour: Colour,
}

const RISING: [f64; 2] = [1.0, -1.0];
const FALLING: [f64; 2] = [1.0, 1.0];
const LEVEL: [f64; 2] = [1.0, 0.0];
const UPRIGHT: [f64; 2] = [0.0, 1.0];

/// Returns the fill of a category without levels: background colour and hatching. `variant` is the number of preceding
/// categories with the same style.
pub(super) fn fill(look: Look, variant: usize) -> (Colour, Vec<Hatch>) {
    let hatch = |along, spacing, width, grey| Hatch {
        along,
        spacing,
        width,
        colour: RGBColor(grey, grey, grey),
    };
    match look {
        Look::WellPosed => (RGBColor(243, 248, 253), vec![]),
        Look::IllPosed => {
            // Pairs of a white and a dark line are visible on every shade.
            let along = [&[][..], &[RISING], &[FALLING], &[LEVEL], &[UPRIGHT], &[RISING, FALLING]];
            let pair =
                |&along: &[f64; 2]| [hatch(along, 30.0, 3.4, 255), hatch(along, 30.0, 1.4, 20)];
            (NO_LEVELS, along[variant % along.len()].iter().flat_map(pair).collect())
        }
        Look::UnboundedAtFiniteWaveNumber => {
            let ground = RGBColor(38, 38, 58);
            (ground, [RISING, FALLING].map(|along| hatch(along, 18.0, 1.6, 235)).to_vec())
        }
        Look::Marginal => (RGBColor(20, 160, 130), vec![hatch(UPRIGHT, 9.0, 1.8, 10)]),
        Look::Indeterminate => (RGBColor(150, 150, 155), vec![hatch(FALLING, 9.0, 1.8, 50)]),
        Look::OutsideModel => (RGBColor(222, 222, 222), vec![hatch(RISING, 24.0, 2.0, 150)]),
    }
}

/// Draws the lines of a hatching over the points of an area that `covers` selects.
pub(super) fn draw_hatch(
    picture: &mut Picture,
    area: Rectangle,
    hatch: Hatch,
    covers: impl Fn(Point) -> bool,
) {
    let length = hatch.along[0].hypot(hatch.along[1]);
    let [dx, dy] = hatch.along.map(|part| part / length);
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
        for part in clip(&whole, area) {
            let (from, to) = (part[0], part[1]);
            let steps = (to[0] - from[0]).hypot(to[1] - from[1]).floor();
            let at = |step: f64| [from[0] + step * dx, from[1] + step * dy];
            for (begin, end) in runs(steps as usize, |step| covers(at(step as f64 + 0.5))) {
                picture.line([at(begin as f64), at(end as f64)], hatch.width, hatch.colour);
            }
        }
    }
}
