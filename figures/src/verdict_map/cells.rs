//! Drawing of the cells with their colours and hatching.

use super::colour_map::{INFINITE_LEVEL_COLOUR, MISSING_LEVEL_COLOUR, shade_colour};
use super::figure::{FillStyle, VerdictMap};
use super::hatching::{category_fill, draw_hatch};
use super::levels::LevelRange;
use super::raster::{VerdictRaster, cell_size};
use crate::picture::{Colour, Picture, Point, Rectangle};

impl VerdictMap {
    /// Fills the cells; runs of one colour in a row are filled as one rectangle.
    pub(super) fn draw_cells(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &VerdictRaster,
        range: Option<&LevelRange>,
    ) {
        let grounds: Vec<(Colour, bool)> = self
            .categories
            .iter()
            .map(|category| {
                (
                    category_fill(category.fill_style, 0).0,
                    category.fill_style == FillStyle::IllPosed,
                )
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
        let (width, height) = cell_size(frame, raster);
        for row in (0..raster.rows).rev() {
            let mut start = 0;
            while start < raster.columns {
                let ground = colour(raster.cell_index(start, row));
                let run = (start + 1..raster.columns)
                    .find(|&column| colour(raster.cell_index(column, row)) != ground)
                    .unwrap_or(raster.columns);
                // Each area extends below the following cells, which prevents hairlines between cells in scaled
                // pictures.
                let area = Rectangle {
                    left: frame.left + start as f64 * width,
                    top: frame.bottom - (row + 1) as f64 * height,
                    right: (frame.left + run as f64 * width + 2.0).min(frame.right),
                    bottom: (frame.bottom - row as f64 * height + 2.0).min(frame.bottom),
                };
                picture.fill_rectangle(area, ground);
                start = run;
            }
        }
    }

    pub(super) fn draw_hatching(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &VerdictRaster,
    ) {
        let (width, height) = cell_size(frame, raster);
        let category_at = |[x, y]: Point| {
            let column = ((x - frame.left) / width) as usize;
            let row = ((frame.bottom - y) / height) as usize;
            raster.categories
                [raster.cell_index(column.min(raster.columns - 1), row.min(raster.rows - 1))]
        };
        for (index, category) in self.categories.iter().enumerate() {
            let present = raster.categories.iter().any(|&other| usize::from(other) == index);
            if !present {
                continue;
            }
            for hatch in category_fill(category.fill_style, self.variant_index(index)).1 {
                draw_hatch(picture, frame, hatch, |point| usize::from(category_at(point)) == index);
            }
        }
    }
}
