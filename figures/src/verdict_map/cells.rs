//! Drawing of the cells with their colours and hatching.

use super::boundaries::{Boundaries, CORNERS, quarter_of};
use super::colour_map::{INFINITE_LEVEL_COLOUR, MISSING_LEVEL_COLOUR, shade_colour};
use super::figure::VerdictMap;
use super::hatching::{category_fill, draw_hatch};
use super::levels::LevelRange;
use super::raster::VerdictRaster;
use crate::picture::{Colour, Picture, Point, Rectangle};

impl VerdictMap {
    /// Fills the cells; runs of one colour in a row are filled as one rectangle. Squares between four points of several
    /// categories are split at the boundary.
    pub(super) fn draw_cells(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &VerdictRaster,
        boundaries: &Boundaries,
        range: Option<&LevelRange>,
    ) {
        let grounds: Vec<(Colour, bool)> = self
            .categories
            .iter()
            .map(|category| {
                (category_fill(category.fill_style).0, category.fill_style.is_ill_posed())
            })
            .collect();
        let colour = |cell: usize| {
            let (ground, ill_posed) = grounds[usize::from(raster.categories[cell])];
            match range {
                Some(range) if ill_posed => {
                    let level = raster.levels[cell];
                    if level == f64::INFINITY {
                        INFINITE_LEVEL_COLOUR
                    } else if level > 0.0 {
                        shade_colour(range.fraction(level))
                    } else {
                        MISSING_LEVEL_COLOUR
                    }
                }
                _ => ground,
            }
        };
        // A cell extends half way to the neighbouring points.
        let lower_edge = |index: usize| index as f64 - 0.5;
        for row in (0..raster.rows).rev() {
            let mut start = 0;
            while start < raster.columns {
                let ground = colour(raster.cell_index(start, row));
                let run = (start + 1..raster.columns)
                    .find(|&column| colour(raster.cell_index(column, row)) != ground)
                    .unwrap_or(raster.columns);
                let [left, bottom] = raster.place(frame, [lower_edge(start), lower_edge(row)]);
                let [right, top] = raster.place(frame, [lower_edge(run), lower_edge(row + 1)]);
                // Each area extends below the following cells, which prevents hairlines between cells in scaled
                // pictures.
                let area = Rectangle {
                    left: left.max(frame.left),
                    top: top.max(frame.top),
                    right: (right + 2.0).min(frame.right),
                    bottom: (bottom + 2.0).min(frame.bottom),
                };
                picture.fill_rectangle(area, ground);
                start = run;
            }
        }
        for square in boundaries.squares() {
            for piece in boundaries.pieces(square).unwrap_or_default() {
                for corner in 0..4 {
                    let quarter = quarter_of(&piece.polygon, corner);
                    // A quarter next to a point of another category has the colour of the nearest point of its own.
                    let distance = |other: &&usize| (**other + 4 - corner) % 4 % 3;
                    let nearest = piece.corners.iter().min_by_key(distance);
                    let Some(&nearest) = nearest.filter(|_| !quarter.is_empty()) else { continue };
                    let [x, y] = CORNERS[nearest];
                    let cell = raster.cell_index(square[0] + x, square[1] + y);
                    let offset = square.map(|index| index as f64);
                    let place = |[x, y]: Point| raster.place(frame, [x + offset[0], y + offset[1]]);
                    picture.fill_polygon(quarter.into_iter().map(place).collect(), colour(cell));
                }
            }
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
