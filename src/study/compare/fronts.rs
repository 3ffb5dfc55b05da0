//! Position of the wave front along two rays: the farthest point where the speed |v| is above a share of its maximum along
//! the ray.

use super::averages::AveragingAreas;
use crate::case::dynamics::{FaceLoad, LoadProfile, LoadedArea, SolidGrid, SolidRun};
use crate::study::simulate::OutputFields;
use models::common::elementary::Elementary;
use serde::Serialize;
use std::f64::consts::FRAC_1_SQRT_2;

/// Share of the maximum speed along a ray above which a point is behind the front.
pub const FRONT_SHARE: f64 = 0.1;

/// Directions of the rays, degrees from the first direction.
pub const RAY_DIRECTIONS_DEG: [f64; 2] = [0.0, 45.0];

/// Rays along which fronts are located.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrontRays {
    /// Direction of the ray at 0°, in words.
    pub reference: String,
    /// Common start, m: the centre of the first load, else the first source, else the middle of the domain.
    pub origin: [f64; 2],
    /// Unit vectors: along the inward normal of the loaded side, else along x₁; and at 45° to it, towards the upper end
    /// of the other axis.
    pub directions: [[f64; 2]; 2],
    /// Edge lengths of the rectangle over which velocities are averaged about each point, m: those of a block.
    pub window: [f64; 2],
}

impl FrontRays {
    /// Determines the rays of a run, with averages over rectangles of the size of a block.
    pub(super) fn new(run: &SolidRun, areas: &AveragingAreas) -> Self {
        let bounds = [0, 1].map(|axis| run.grid.axis_bounds(axis));
        let middle = bounds.map(|[from, to]| 0.5 * (from + to));
        let mut reference = "x1".to_owned();
        let (origin, axis, sign) = match (run.loads.first(), run.sources.first()) {
            (Some(load), _) => {
                let face = load.face;
                reference = format!("inward normal of {}", face.name());
                let mut origin = middle;
                origin[face.axis] = bounds[face.axis][usize::from(face.is_upper)];
                origin[1 - face.axis] = load_centre(load).unwrap_or(middle[1 - face.axis]);
                (origin, face.axis, if face.is_upper { -1.0 } else { 1.0 })
            }
            (None, Some(source)) => match source.position[..] {
                [x1, x2, ..] => ([x1, x2], 0, 1.0),
                _ => (middle, 0, 1.0),
            },
            (None, None) => (middle, 0, 1.0),
        };
        let mut directions = [[0.0; 2]; 2];
        directions[0][axis] = sign;
        directions[1][axis] = sign * FRAC_1_SQRT_2;
        directions[1][1 - axis] = FRAC_1_SQRT_2;
        Self { reference, origin, directions, window: areas.size() }
    }

    /// Locates the front along each ray, m from the origin; `None` where nothing moves, or the front is beyond the domain.
    pub(super) fn locate_fronts(
        &self,
        grid: &SolidGrid,
        fields: &OutputFields,
    ) -> [Option<f64>; 2] {
        let velocity = ["v1", "v2"].map(|name| fields.get(name).unwrap_or_default());
        // Two samples per block.
        let step = 0.5 * self.window[0].min(self.window[1]);
        self.directions.map(|direction| {
            let point = |index: usize| {
                [0, 1].map(|axis| self.origin[axis] + index as f64 * step * direction[axis])
            };
            let speeds: Vec<f64> = (0..)
                .map(point)
                .take_while(|point| grid.contains(point))
                .map(|point| {
                    let [v1, v2] =
                        velocity.map(|values| window_mean(grid, values, point, self.window));
                    v1.root_sum_square(v2)
                })
                .collect();
            Some(step * last_crossing(&speeds, FRONT_SHARE)?)
        })
    }
}

/// Returns the coordinate of the centre of a load along its side; `None` if it acts on the whole side.
fn load_centre(load: &FaceLoad) -> Option<f64> {
    match (&load.loaded_area, &load.profile) {
        (LoadedArea::Point { position, .. }, _) => position.first().copied(),
        (_, Some(LoadProfile::Bell { centre, .. })) => centre.first().copied(),
        (LoadedArea::Rectangle(part), _) => {
            Some(0.5 * (part.lower_corner.first()? + part.upper_corner.first()?))
        }
        (LoadedArea::WholeFace, _) => None,
    }
}

/// Computes the mean over a rectangle about a point, as far as it is inside the grid.
fn window_mean(grid: &SolidGrid, values: &[f64], point: [f64; 2], window: [f64; 2]) -> f64 {
    let [columns, rows] = [0, 1].map(|axis| {
        let place = |coordinate: f64| {
            let place = (coordinate - grid.origin[axis]) / grid.spacing[axis];
            place.clamp(0.0, grid.cells[axis] as f64)
        };
        let [from, to] = [-0.5, 0.5].map(|side| place(point[axis] + side * window[axis]));
        let cells = from.floor() as usize..(to.ceil() as usize).min(grid.cells[axis]);
        cells.map(move |cell| (cell, to.min(cell as f64 + 1.0) - from.max(cell as f64)))
    });
    let [mut sum, mut weights] = [0.0, 0.0];
    for (j, height) in rows {
        for (i, width) in columns.clone() {
            let weight = width * height;
            sum += weight * values.get(grid.cells[0] * j + i).copied().unwrap_or(0.0);
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// Returns the last place, in samples, where the values fall below a share of their maximum, interpolated linearly; `None`
/// if all vanish or the last value is above.
fn last_crossing(values: &[f64], share: f64) -> Option<f64> {
    let threshold = share * values.iter().fold(0.0, |max: f64, value| max.max(*value));
    let last = values.iter().rposition(|value| *value >= threshold && *value > 0.0)?;
    let [above, below] = [values[last], *values.get(last + 1)?];
    Some(last as f64 + (above - threshold) / (above - below))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_is_the_last_crossing() {
        let crossing = |values: &[f64]| last_crossing(values, 0.1);
        assert_eq!(crossing(&[0.0, 10.0, 0.5, 4.0, 0.5, 0.0]), Some(3.0 + 3.0 / 3.5));
        assert_eq!(crossing(&[0.0; 4]), None);
        assert_eq!(crossing(&[0.0, 0.0, 1.0]), None);
        assert_eq!(crossing(&[]), None);
    }

    /// Verifies that window means of a linear field are its values at the centre of the window, clipped at the boundary.
    #[test]
    fn window_means_of_a_linear_field_are_exact() {
        let grid = SolidGrid {
            cells: vec![10, 6],
            spacing: vec![0.1, 0.2],
            origin: vec![-0.5, 1.0],
            polar_bounds: None,
        };
        let values: Vec<f64> = (0..60)
            .map(|cell| 2.0 * grid.cell_centre(0, cell % 10) - 3.0 * grid.cell_centre(1, cell / 10))
            .collect();
        // Windows whose edges are faces between cells, and windows of two halves of cells that cancel.
        let mean = |point| window_mean(&grid, &values, point, [0.2, 0.4]);
        for [x, y] in [[0.1, 1.6], [-0.05, 1.5], [0.0, 1.8]] {
            assert!((mean([x, y]) - (2.0 * x - 3.0 * y)).abs() < 1e-12, "{x} {y}");
        }
        assert!((mean([-0.5, 1.6]) - (2.0 * -0.45 - 4.8)).abs() < 1e-12);
    }
}
