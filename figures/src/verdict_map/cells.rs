//! Drawing of the cells with their colours and hatching.

use super::colour_map::{INFINITE, LEVEL_MISSING, shade};
use super::figure::{Look, VerdictMap};
use super::hatching::{draw_hatch, fill};
use super::levels::Range;
use super::raster::{Raster, cell_size};
use crate::picture::{Colour, Picture, Point, Rectangle};

impl VerdictMap {
    /// Fills the cells; runs of one colour in a row are filled as one rectangle.
    pub(super) fn draw_cells(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        raster: &Raster,
        range: Option<&Range>,
    ) {
        let grounds: Vec<(Colour, bool)> = self
            .categories
            .iter()
            .map(|category| (fill(category.look, 0).0, category.look == Look::IllPosed))
            .collect();
        let colour = |cell: usize| {
            let (ground, ill_posed) = grounds[usize::from(raster.category[cell])];
            match range {
                Some(range) if ill_posed => {
                    let level = raster.level[cell];
                    if level == f64::INFINITY {
                        INFINITE
                    } else if level > 0.0 {
                        shade(range.share(level))
                    } else {
                        LEVEL_MISSING
                    }
                }
                _ => ground,
            }
        };
        let (width, height) = cell_size(frame, raster);
        for row in (0..raster.rows).rev() {
            let mut start = 0;
            while start < raster.columns {
                let ground = colour(raster.at(start, row));
                let run = (start + 1..raster.columns)
                    .find(|&column| colour(raster.at(column, row)) != ground)
                    .unwrap_or(raster.columns);
                // Each area extends below the following cells, which prevents hairlines between cells in scaled
                // pictures.
                let area = Rectangle {
                    left: frame.left + start as f64 * width,
                    top: frame.bottom - (row + 1) as f64 * height,
                    right: (frame.left + run as f64 * width + 2.0).min(frame.right),
                    bottom: (frame.bottom - row as f64 * height + 2.0).min(frame.bottom),
                };
                picture.fill(area, ground);
                start = run;
            }
        }
    }

    pub(super) fn draw_hatches(&self, picture: &mut Picture, frame: Rectangle, raster: &Raster) {
        let (width, height) = cell_size(frame, raster);
        let category_at = |[x, y]: Point| {
            let column = ((x - frame.left) / width) as usize;
            let row = ((frame.bottom - y) / height) as usize;
            raster.category[raster.at(column.min(raster.columns - 1), row.min(raster.rows - 1))]
        };
        for (index, category) in self.categories.iter().enumerate() {
            let present = raster.category.iter().any(|&other| usize::from(other) == index);
            if !present {
                continue;
            }
            for hatch in fill(category.look, self.variant(index)).1 {
                draw_hatch(picture, frame, hatch, |point| usize::from(category_at(point)) == index);
            }
        }
    }
}
