//! Drawing of the cells with their colours and hatching.

use std::collections::HashMap;

use super::boundaries::{Boundaries, cut_to_area};
use super::colour_map::{INFINITE_LEVEL_COLOUR, MISSING_LEVEL_COLOUR, shade_colour};
use super::figure::VerdictMap;
use super::hatching::{category_fill, draw_hatch};
use super::levels::{LevelField, LevelRange};
use super::raster::VerdictRaster;
use crate::picture::{Colour, Picture, Point, Rectangle};

/// Largest width and height of the patches of one colour in which levels are drawn, pixels: little more than the width
/// of a shade where levels change over the width of the map.
const PATCH_SIZE: f64 = 4.0;

/// Colours of one category.
enum CategoryColour<'a> {
    Uniform(Colour),
    Graded { field: LevelField<'a>, range: &'a LevelRange },
}

impl CategoryColour<'_> {
    /// Returns the colour at a position in units of the point spacing.
    fn at(&self, place: Point) -> Colour {
        match self {
            Self::Uniform(colour) => *colour,
            Self::Graded { field, range } => match field.level_at(place) {
                f64::INFINITY => INFINITE_LEVEL_COLOUR,
                level if level.is_nan() => MISSING_LEVEL_COLOUR,
                // Between points, levels are extrapolated to zero and below next to a boundary where growth vanishes.
                level => shade_colour(range.fraction(level.max(f64::MIN_POSITIVE))),
            },
        }
    }
}

impl VerdictMap {
    /// Fills the cells in patches of one colour. Squares between four points of several categories are then split
    /// exactly at the boundary.
    pub(super) fn draw_cells(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &VerdictRaster,
        boundaries: &Boundaries,
        range: Option<&LevelRange>,
    ) {
        let spacing = raster.spacing(frame);
        let colours: Vec<CategoryColour<'_>> = (0_u8..)
            .zip(&self.categories)
            .map(|(index, category)| match range {
                Some(range) if category.fill_style.is_ill_posed() => {
                    let field = LevelField::new(raster, index, spacing);
                    CategoryColour::Graded { field, range }
                }
                _ => CategoryColour::Uniform(category_fill(category.fill_style).0),
            })
            .collect();
        let [nx, ny] = spacing.map(|length| (length / PATCH_SIZE).ceil().max(1.0));
        self.draw_patches(picture, frame, (raster, boundaries), &colours, [nx, ny]);
        for square in boundaries.squares() {
            let offset = square.map(|index| index as f64);
            let beyond = |[x, y]: Point| [x + offset[0], y + offset[1]];
            for piece in boundaries.pieces(square).unwrap_or_default() {
                let colour = &colours[usize::from(piece.category)];
                let mut fill = |part: &[Point], colour: Colour| {
                    let corners = part.iter().map(|&at| raster.place(frame, beyond(at)));
                    picture.fill_polygon(corners.collect(), colour);
                };
                if let CategoryColour::Uniform(colour) = colour {
                    fill(&piece.polygon, *colour);
                    continue;
                }
                for (j, i) in (0..ny as usize).flat_map(|j| (0..nx as usize).map(move |i| (j, i))) {
                    let low = [i as f64 / nx, j as f64 / ny];
                    let high = [(i + 1) as f64 / nx, (j + 1) as f64 / ny];
                    let part = cut_to_area(&piece.polygon, low, high);
                    if !part.is_empty() {
                        let middle = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
                        fill(&part, colour.at(beyond(middle)));
                    }
                }
            }
        }
    }

    /// Fills the frame in patches, `nx` by `ny` between neighbouring points; runs of one colour in a row are one patch.
    fn draw_patches(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        (raster, boundaries): (&VerdictRaster, &Boundaries),
        colours: &[CategoryColour<'_>],
        [nx, ny]: [f64; 2],
    ) {
        let counts = [(raster.columns, nx), (raster.rows, ny)]
            .map(|(points, parts)| points.saturating_sub(1).max(1) * parts as usize);
        // A single column or row of points is in the middle of the frame, at position 0.
        let position = |index: f64, parts: f64, points: usize| {
            if points > 1 { index / parts } else { 0.0 }
        };
        let [width, height] = [frame.width() / counts[0] as f64, frame.height() / counts[1] as f64];
        let mut patches: Vec<(Colour, Vec<Rectangle>)> = Vec::new();
        let mut index_of_colour: HashMap<[u8; 3], usize> = HashMap::new();
        for row in 0..counts[1] {
            let y = position(row as f64 + 0.5, ny, raster.rows);
            let colour = |column: usize| {
                let place = [position(column as f64 + 0.5, nx, raster.columns), y];
                colours[usize::from(boundaries.category_at(raster, place))].at(place)
            };
            let bottom = frame.bottom - row as f64 * height;
            let (mut start, mut ground) = (0, colour(0));
            for column in 1..=counts[0] {
                let next = if column < counts[0] { Some(colour(column)) } else { None };
                if next == Some(ground) {
                    continue;
                }
                let area = Rectangle {
                    left: frame.left + start as f64 * width,
                    right: frame.left + column as f64 * width,
                    top: bottom - height,
                    bottom,
                };
                let index =
                    *index_of_colour.entry([ground.0, ground.1, ground.2]).or_insert_with(|| {
                        patches.push((ground, Vec::new()));
                        patches.len() - 1
                    });
                patches[index].1.push(area);
                (start, ground) = (column, next.unwrap_or(ground));
            }
        }
        for (colour, areas) in patches {
            picture.fill_patches(areas, colour);
        }
    }

    pub(super) fn draw_hatching(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &VerdictRaster,
        boundaries: &Boundaries,
    ) {
        let [width, height] = raster.spacing(frame);
        let category_at = |[x, y]: Point| {
            boundaries.category_at(raster, [(x - frame.left) / width, (frame.bottom - y) / height])
        };
        for (index, category) in self.categories.iter().enumerate() {
            let present = raster.categories.iter().any(|&other| usize::from(other) == index);
            if !present {
                continue;
            }
            for hatch in category_fill(category.fill_style).1 {
                draw_hatch(picture, frame, hatch, |point| usize::from(category_at(point)) == index);
            }
        }
    }
}
