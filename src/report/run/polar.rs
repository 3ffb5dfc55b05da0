//! Pictures and files of runs on polar grids in true geometry: Cartesian coordinates x = r cos θ, y = r sin θ.

use crate::case::dynamics::SolidGrid;
use figures::{FieldAxis, FieldBody};
use models::common::elementary::Elementary;

/// Number of raster cells along the longer side of a picture.
const RASTER_CELLS: f64 = 520.0;

/// Number of points of an arc of the outline per degree.
const POINTS_PER_DEGREE: f64 = 1.0;

/// Cells of a polar grid around the centre of a raster cell.
struct Sample {
    /// Indices and weights of the bilinear interpolation; they continue the field constantly beyond the grid.
    cells: [(usize, f64); 4],
    is_outside: bool,
}

impl Sample {
    fn nearest(&self) -> usize {
        let heavier = |one: (usize, f64), other: &(usize, f64)| {
            if other.1 > one.1 { *other } else { one }
        };
        self.cells.iter().fold(self.cells[0], heavier).0
    }
}

/// Raster of equal Cartesian cells over a polar grid.
pub(in crate::report) struct PolarRaster {
    pub(in crate::report) x: FieldAxis,
    pub(in crate::report) y: FieldAxis,
    pub(in crate::report) columns: usize,
    pub(in crate::report) rows: usize,
    /// By raster cell, x fastest, the first row the lowest.
    samples: Vec<Sample>,
    outline: Vec<Vec<[f64; 2]>>,
}

impl PolarRaster {
    /// Creates the raster; `None` if the grid is rectangular.
    pub(in crate::report) fn new(grid: &SolidGrid) -> Option<Self> {
        let [angles, [inner, outer]] = grid.polar_bounds?;
        let outline = compute_outline(grid, angles, [inner, outer]);
        let points = || outline.iter().flatten();
        let bounds = [0, 1].map(|axis| {
            points().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], point| {
                [least.min(point[axis]), greatest.max(point[axis])]
            })
        });
        let [width, height] = bounds.map(|[from, to]| to - from);
        let edge = width.max(height) / RASTER_CELLS;
        let [columns, rows] = [width, height].map(|length| (length / edge).round().max(1.0));
        let [step_x, step_y] = [width / columns, height / rows];
        let [columns, rows] = [columns, rows].map(|count| count as usize);
        let centre = |index: usize| {
            let [column, row] = [index % columns, index / columns].map(|own| own as f64 + 0.5);
            [bounds[0][0] + column * step_x, bounds[1][0] + row * step_y]
        };
        let samples = (0..columns * rows).map(|index| sample(grid, centre(index)));
        let axis = |name: &str, [start, end]: [f64; 2]| FieldAxis {
            label: format!("{name} (m)"),
            start,
            end,
        };
        Some(Self {
            x: axis("x", bounds[0]),
            y: axis("y", bounds[1]),
            columns,
            rows,
            samples: samples.collect(),
            outline,
        })
    }

    /// Interpolates the values of the cells of the grid.
    pub(in crate::report) fn interpolate(&self, values: &[f64]) -> Vec<f64> {
        let value = |sample: &Sample| sample.cells.iter().map(|(cell, w)| w * values[*cell]).sum();
        self.samples.iter().map(value).collect()
    }

    /// Returns the values of the nearest cells of the grid; `outside` beyond the grid.
    pub(in crate::report) fn nearest<V: Copy>(&self, values: &[V], outside: V) -> Vec<V> {
        let value = |sample: &Sample| match sample.is_outside {
            true => outside,
            false => values[sample.nearest()],
        };
        self.samples.iter().map(value).collect()
    }

    /// Returns the part of the raster that the grid fills.
    pub(in crate::report) fn body(&self) -> FieldBody {
        FieldBody {
            is_outside: self.samples.iter().map(|sample| sample.is_outside).collect(),
            outline: self.outline.clone(),
        }
    }
}

/// Computes the closed lines around a polar grid: two circles, or the boundary of a sector.
fn compute_outline(
    grid: &SolidGrid,
    [first, last]: [f64; 2],
    [inner, outer]: [f64; 2],
) -> Vec<Vec<[f64; 2]>> {
    let count = ((last - first) * POINTS_PER_DEGREE).ceil().max(2.0);
    let arc = |radius: f64| {
        (0..=count as usize).map(move |index| {
            let part = index as f64 / count;
            SolidGrid::to_cartesian([first + part * (last - first), radius])
        })
    };
    if grid.is_circle() {
        return vec![arc(inner).collect(), arc(outer).collect()];
    }
    let mut boundary: Vec<[f64; 2]> = arc(inner).chain(arc(outer).rev()).collect();
    boundary.extend(boundary.first().copied());
    vec![boundary]
}

/// Returns the sample of a Cartesian point.
fn sample(grid: &SolidGrid, [x, y]: [f64; 2]) -> Sample {
    let [angles, radii] = [0, 1].map(|axis| grid.axis_bounds(axis));
    let radius = x.root_sum_square(y);
    let middle = 0.5 * (angles[0] + angles[1]);
    // The angle nearest to the middle of the grid, so that a sector is not cut.
    let angle = y.cr_atan2(x).to_degrees();
    let angle = angle + 360.0 * ((middle - angle) / 360.0).round();
    let is_outside = !(radii[0]..=radii[1]).contains(&radius)
        || !(grid.is_circle() || (angles[0]..=angles[1]).contains(&angle));
    let mut along = [[(0, 1.0), (0, 0.0)]; 2];
    for (axis, coordinate) in [angle, radius].into_iter().enumerate() {
        let count = grid.cells[axis];
        let place = (coordinate - grid.origin[axis]) / grid.spacing[axis] - 0.5;
        let is_periodic = axis == 0 && grid.is_circle();
        let place = if is_periodic { place } else { place.clamp(0.0, (count - 1) as f64) };
        let (below, part) = (place.floor(), place - place.floor());
        let index = |own: f64| match is_periodic {
            true => own.rem_euclid(count as f64) as usize % count,
            false => (own as usize).min(count - 1),
        };
        along[axis] = [(index(below), 1.0 - part), (index(below + 1.0), part)];
    }
    let [columns, rows] = along;
    let cell =
        |i: usize, j: usize| (rows[j].0 * grid.cells[0] + columns[i].0, rows[j].1 * columns[i].1);
    Sample { cells: [cell(0, 0), cell(1, 0), cell(0, 1), cell(1, 1)], is_outside }
}

/// Replaces the axis numbers in the symbol of a quantity by θ and r: `σ₁₁` becomes `σ_θθ`.
pub(super) fn polar_label(label: &str) -> String {
    let mut named = String::new();
    let mut is_index = false;
    for character in label.chars() {
        let name = match character {
            '₁' => 'θ',
            '₂' => 'r',
            '₃' => 'z',
            other => {
                is_index = false;
                named.push(other);
                continue;
            }
        };
        if !is_index {
            named.push('_');
        }
        is_index = true;
        named.push(name);
    }
    named
}

/// Converts the components along the angle and the radius of a vector in a cell to Cartesian components. The map is a
/// reflection, so that it also converts Cartesian components back.
pub(super) fn reflect_components(grid: &SolidGrid, cell: usize, [a, b]: [f64; 2]) -> [f64; 2] {
    let angle = grid.cell_centre(0, cell % grid.cells[0]);
    let [cos, sin] = SolidGrid::to_cartesian([angle, 1.0]);
    [b * cos - a * sin, a * cos + b * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn create_grid(angles: [f64; 2]) -> SolidGrid {
        let cells = vec![90, 40];
        let spacing = vec![(angles[1] - angles[0]) / 90.0, 0.9 / 40.0];
        let (origin, polar_bounds) = (vec![angles[0], 0.1], Some([angles, [0.1, 1.0]]));
        SolidGrid { cells, spacing, origin, polar_bounds }
    }

    /// Verifies that interpolated values of a linear function of x and y are those of the function, to second order, and
    /// that the area inside is that of the annulus or the sector.
    #[test]
    fn raster_has_the_true_geometry() {
        for angles in [[-90.0, 270.0], [0.0, 180.0], [100.0, 190.0]] {
            let grid = create_grid(angles);
            let function = |[x, y]: [f64; 2]| 3.0 * x - 2.0 * y;
            let centre =
                |cell: usize| [grid.cell_centre(0, cell % 90), grid.cell_centre(1, cell / 90)];
            let values: Vec<f64> =
                (0..3600).map(|cell| function(SolidGrid::to_cartesian(centre(cell)))).collect();
            let raster = PolarRaster::new(&grid).expect("a polar grid");
            let (found, body) = (raster.interpolate(&values), raster.body());
            let step = (raster.x.end - raster.x.start) / raster.columns as f64;
            let mut inside = 0;
            for (index, found) in found.into_iter().enumerate() {
                let place = [index % raster.columns, index / raster.columns];
                let x = raster.x.start + (place[0] as f64 + 0.5) * step;
                let y = raster.y.start + (place[1] as f64 + 0.5) * step;
                if body.is_outside[index] {
                    continue;
                }
                inside += 1;
                // Half a cell beside the boundaries the field is continued constantly.
                assert!((found - function([x, y])).abs() < 0.15, "{angles:?} [{x}, {y}]: {found}");
            }
            let area = f64::from(inside) * step * step;
            let expected = (angles[1] - angles[0]).to_radians() * 0.5 * (1.0 - 0.01);
            assert!((area / expected - 1.0).abs() < 0.01, "{area} {expected}");
        }
    }

    #[test]
    fn components_become_cartesian_and_return() {
        let grid = create_grid([-90.0, 270.0]);
        // The first cell is at the angle −88°, where the radius points down.
        let [x, y] = reflect_components(&grid, 0, [0.0, 1.0]);
        assert!((x - (-88f64).to_radians().cos()).abs() < 1e-14 && y < -0.99, "{x} {y}");
        for cell in [0, 17, 3000] {
            let there = reflect_components(&grid, cell, [0.3, -0.8]);
            let [a, b] = reflect_components(&grid, cell, there);
            assert!((a - 0.3).abs() < 1e-15 && (b + 0.8).abs() < 1e-15, "{a} {b}");
        }
    }

    #[test]
    fn symbols_have_polar_indices() {
        assert_eq!(polar_label("stress σ₁₂ (Pa)"), "stress σ_θr (Pa)");
        assert_eq!(polar_label("velocity v₂ (m/s)"), "velocity v_r (m/s)");
        assert_eq!(polar_label("speed |v| (m/s)"), "speed |v| (m/s)");
    }
}
