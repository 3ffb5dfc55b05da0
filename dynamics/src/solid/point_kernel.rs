//! Distribution of a point source over the cells around it: the shares of the cells have the same moments up to second
//! order as the point, and are mirrored at symmetry planes of the grid.
//!
//! In the far field, shares wᵢ in cells at xᵢ act as Σ wᵢ G(xᵢ), a quadrature for the value of G at the point, with a
//! function G that is smooth on one side of material interfaces: the moments of the shares determine the error. Along
//! each axis the kernel is
//!
//! ```text
//! K(u) = ¼ (B(u − 1) + 2 B(u) + B(u + 1)),    w(u) = (7/4) K(u) − ⅜ (K(u − 1) + K(u + 1)),
//! ```
//!
//! with u in cells and the quadratic B-spline B. For any position of the point in the grid, the moments of w equal
//! those of the point up to second order; waves with a wavelength of two cells, which nothing damps, are not excited,
//! and waves of nearby wavelengths to second order only (the Fourier transform of w has a double zero at π per cell).
//! The half-width is less than four cells.
//!
//! At a plane of symmetry or antisymmetry the kernel is folded back with the sign of the mirror image of the field: the
//! grid is half (a quarter, an eighth) of the whole model. Amplitudes refer to the whole model: a point on such a plane
//! is its own image, and half of the source acts on either side. At other boundaries, shares outside the grid are moved
//! to the two outermost cells by linear extrapolation, which preserves sum and first moments. The raised-cosine kernel
//! is cut off there.

use models::common::elementary::Elementary;
use models::solid::waves::SolidField;
use nalgebra::{DMatrix, DVector};

/// Reach of the spline kernel, in cells: along an axis, cells have shares from `SPLINE_HALF_WIDTH` cells below to
/// `SPLINE_HALF_WIDTH` + 1 cells above the last cell whose centre is not above the point.
const SPLINE_HALF_WIDTH: isize = 3;

/// Distance from a plane, in cells, below which a point counts as on it.
const PLANE_TOLERANCE: f64 = 1e-6;

/// Continuation of the grid at an end of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisEnd {
    /// Symmetry or antisymmetry plane: mirror image, multiplied by this sign.
    Mirror(f64),
    /// Open: nothing, or another solid, beyond the end.
    Open,
    /// Periodic: the grid continues at the opposite end of the axis.
    Periodic,
}

impl AxisEnd {
    /// Creates the end at a symmetry plane normal to an axis, for the source of a field.
    pub fn new_symmetry(field: SolidField, axis: usize) -> Self {
        Self::Mirror(if is_odd(field, axis) { -1.0 } else { 1.0 })
    }

    /// Creates the end at an antisymmetry plane normal to an axis, for the source of a field.
    pub fn new_antisymmetry(field: SolidField, axis: usize) -> Self {
        Self::Mirror(if is_odd(field, axis) { 1.0 } else { -1.0 })
    }
}

/// A grid position: offsets from the point along the axes, m, and the cell that represents the position, if any, with
/// the sign factor of its mirror images.
type BellPosition = (Vec<f64>, Option<(usize, f64)>);

/// Position of the point along an axis.
#[derive(Clone, Copy, Debug)]
pub struct PointPosition {
    /// Number of cells of the grid along the axis.
    pub cells: usize,
    /// Continuation of the grid at the lower and the upper end.
    pub ends: [AxisEnd; 2],
    /// Coordinate of the point, in cells from the centre of the first cell.
    pub x: f64,
}

impl PointPosition {
    /// Returns the end beyond which a position (cell index) lies, and the distance from the outermost cell, in cells;
    /// `None` inside the grid.
    fn distance_beyond_end(&self, place: isize) -> Option<(usize, isize)> {
        let count = self.cells as isize;
        match place {
            place if place < 0 => Some((0, -place)),
            place if place >= count => Some((1, place - count + 1)),
            _ => None,
        }
    }

    /// Maps a position (cell index) to the cell that represents it, and its sign factor; `None` beyond an open end.
    fn image_cell(&self, mut place: isize) -> Option<(usize, f64)> {
        let mut factor = 1.0;
        while let Some((end, cells_beyond)) = self.distance_beyond_end(place) {
            place = match self.ends[end] {
                AxisEnd::Mirror(sign) => {
                    factor *= sign;
                    if end == 0 { cells_beyond - 1 } else { self.cells as isize - cells_beyond }
                }
                AxisEnd::Periodic => place.rem_euclid(self.cells as isize),
                AxisEnd::Open => return None,
            };
        }
        Some((place as usize, factor))
    }

    /// Returns the fraction of the source that acts inside the grid: a factor of ½ for each end with a symmetry or
    /// antisymmetry plane through the point.
    fn inside_fraction(&self) -> f64 {
        let planes = [-0.5, self.cells as f64 - 0.5].into_iter().zip(self.ends);
        let is_on = |&(plane, end): &(f64, AxisEnd)| {
            matches!(end, AxisEnd::Mirror(_)) && (self.x - plane).abs() <= PLANE_TOLERANCE
        };
        0.5f64.powi(planes.filter(is_on).count() as i32)
    }

    /// Adds the share of a position (cell index) to those of the cells that represent it.
    fn add_share(&self, place: isize, share: f64, shares: &mut Vec<(usize, f64)>) {
        let last = self.cells as isize - 1;
        match (self.image_cell(place), self.distance_beyond_end(place)) {
            (Some((cell, factor)), _) => match shares.iter_mut().find(|own| own.0 == cell) {
                Some((_, own)) => *own += factor * share,
                None => shares.push((cell, factor * share)),
            },
            (None, Some((end, cells_beyond))) if last > 0 && self.ends[end] == AxisEnd::Open => {
                let [first, second] = if end == 0 { [0, 1] } else { [last, last - 1] };
                self.add_share(first, (1 + cells_beyond) as f64 * share, shares);
                self.add_share(second, -cells_beyond as f64 * share, shares);
            }
            // A grid of one cell, or an open end that is reached through a mirror plane.
            (None, Some((end, _))) => {
                self.add_share(if end == 0 { 0 } else { last }, share, shares)
            }
            (None, None) => {}
        }
    }

    /// Computes the shares of the spline kernel along the axis.
    fn axis_shares(&self) -> Vec<(usize, f64)> {
        let middle = self.x.floor() as isize;
        let mut shares = Vec::new();
        for place in middle - SPLINE_HALF_WIDTH..=middle + SPLINE_HALF_WIDTH + 1 {
            let share = spline_kernel(place as f64 - self.x);
            if share != 0.0 {
                self.add_share(place, share, &mut shares);
            }
        }
        shares
    }
}

/// Computes the quadratic B-spline B(u); u in cells.
fn quadratic_spline(u: f64) -> f64 {
    match u.abs() {
        u if u <= 0.5 => 0.75 - u * u,
        u if u < 1.5 => 0.5 * (1.5 - u).powi(2),
        _ => 0.0,
    }
}

/// Computes the kernel w(u) along an axis; u in cells.
fn spline_kernel(u: f64) -> f64 {
    let wide = |u: f64| {
        0.25 * (quadratic_spline(u - 1.0) + 2.0 * quadratic_spline(u) + quadratic_spline(u + 1.0))
    };
    1.75 * wide(u) - 0.375 * (wide(u - 1.0) + wide(u + 1.0))
}

/// Computes the raised cosine: 1 at distance 0, 0 from `radius` on, continuously differentiable; `distance` and
/// `radius` in m.
fn raised_cosine(distance: f64, radius: f64) -> f64 {
    if distance < radius {
        0.5 + 0.5 * (std::f64::consts::PI * distance / radius).cr_cos()
    } else {
        0.0
    }
}

/// Whether the mirror image of a field in a plane normal to an axis has the opposite sign.
fn is_odd(field: SolidField, axis: usize) -> bool {
    match field {
        SolidField::Velocity(i) => i == axis,
        SolidField::Spin(k) => k != axis,
        SolidField::Stress(i, j)
        | SolidField::ViscousStrain(i, j)
        | SolidField::ExcessStress(i, j)
        | SolidField::SpringStress(i, j)
        | SolidField::PlasticStrain(i, j) => (i == axis) != (j == axis),
        SolidField::VolumetricStrain | SolidField::PoreClosure => false,
        SolidField::Couple(k, j) => (k != axis) != (j == axis),
    }
}

/// Scales shares by the fraction inside the grid: ½ for each symmetry or antisymmetry plane through the point.
fn scale_to_inside(along: &[PointPosition], mut shares: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let inside_fraction: f64 = along.iter().map(PointPosition::inside_fraction).product();
    shares.iter_mut().for_each(|own| own.1 *= inside_fraction);
    shares
}

/// Computes the shares of cells in a point source of a field, or of faces of a boundary (with the two axes of the
/// boundary), by index (first axis fastest), with the spline kernel. Their sum is 1, unless mirror images of odd sign
/// contribute, and is halved for each plane of symmetry or antisymmetry through the point.
pub fn spline_shares(along: &[PointPosition]) -> Vec<(usize, f64)> {
    scale_to_inside(along, spline_product(along))
}

/// Computes shares as [`spline_shares`] does, with a raised cosine of radius `radius`, m, as kernel; `spacing`: cell
/// edges, m.
pub fn bell_shares(along: &[PointPosition], spacing: &[f64], radius: f64) -> Vec<(usize, f64)> {
    scale_to_inside(along, compute_bell_shares(along, spacing, radius))
}

/// Computes shares as [`spline_shares`] does, with the nearest cell or face only.
pub fn nearest_share(along: &[PointPosition]) -> Vec<(usize, f64)> {
    scale_to_inside(along, vec![(nearest_cell(along), 1.0)])
}

/// Returns the cell that contains the point; outside the grid, the nearest one.
fn nearest_cell(along: &[PointPosition]) -> usize {
    along.iter().rev().fold(0, |cell, axis| {
        let index = (axis.x + 0.5).floor().max(0.0) as usize;
        cell * axis.cells + index.min(axis.cells - 1)
    })
}

/// Computes the tensor product of the spline kernels.
fn spline_product(along: &[PointPosition]) -> Vec<(usize, f64)> {
    let mut products = vec![(0, 1.0)];
    for axis in along.iter().rev() {
        let axis_shares = axis.axis_shares();
        let next = |(cell, share): &(usize, f64)| {
            let (cell, share) = (cell * axis.cells, *share);
            axis_shares
                .iter()
                .map(move |(index, own)| (cell + index, share * own))
                .collect::<Vec<_>>()
        };
        products = products.iter().flat_map(next).collect();
    }
    products.sort_by_key(|own| own.0);
    products
}

/// Computes the normalised shares of a raised cosine of radius `radius`, m; unless it is cut off, or `radius` is less
/// than two cell edges along some axis, its centre of mass is at the point. If no position lies within the radius, the
/// nearest cell has the share 1.
fn compute_bell_shares(along: &[PointPosition], spacing: &[f64], radius: f64) -> Vec<(usize, f64)> {
    // Offsets from the point, m, with cell and sign factor, by position.
    let mut positions: Vec<BellPosition> = vec![(Vec::new(), Some((0, 1.0)))];
    for (axis, h) in along.iter().zip(spacing).rev() {
        let reach = radius / h;
        let range = (axis.x - reach).ceil() as isize..=(axis.x + reach).floor() as isize;
        positions = positions
            .iter()
            .flat_map(|position| range.clone().map(move |place| (position, place)))
            .map(|((offsets, cell), place)| {
                let mut offsets = offsets.clone();
                offsets.insert(0, (place as f64 - axis.x) * h);
                let cell =
                    cell.zip(axis.image_cell(place)).map(|((cell, factor), (index, position))| {
                        (cell * axis.cells + index, factor * position)
                    });
                (offsets, cell)
            })
            .collect();
    }
    let mut is_whole = true;
    let mut weighted_cells: Vec<(Vec<f64>, usize, f64, f64)> = Vec::new();
    for (offsets, cell) in positions {
        let share =
            raised_cosine(offsets.iter().fold(0.0, |sum: f64, x| sum.root_sum_square(*x)), radius);
        match cell {
            Some((cell, factor)) if share > 0.0 => {
                weighted_cells.push((offsets, cell, factor, share))
            }
            None if share > 0.0 => is_whole = false,
            _ => {}
        }
    }
    if weighted_cells.is_empty() {
        return vec![(nearest_cell(along), 1.0)];
    }
    let sum: f64 = weighted_cells.iter().map(|own| own.3).sum();
    weighted_cells.iter_mut().for_each(|own| own.3 /= sum);
    if is_whole && spacing.iter().all(|h| radius >= 2.0 * h) {
        centre_shares(&mut weighted_cells);
    }
    let mut shares: Vec<(usize, f64)> =
        weighted_cells.iter().map(|own| (own.1, own.2 * own.3)).collect();
    shares.sort_by_key(|own| own.0);
    // Merge the contributions of a cell and its mirror images.
    let mut merged: Vec<(usize, f64)> = Vec::new();
    for (cell, share) in shares {
        match merged.last_mut().filter(|last| last.0 == cell) {
            Some(last) => last.1 += share,
            None => merged.push((cell, share)),
        }
    }
    merged
}

/// Moves the centre of mass of shares to the point, by factors 1 − (x − m)·C⁻¹m with mean 1 at the offsets x from the
/// point; m: offset of the centre of mass, C: covariance of the offsets.
fn centre_shares(all: &mut [(Vec<f64>, usize, f64, f64)]) {
    let d = all.first().map_or(0, |own| own.0.len());
    let mean: DVector<f64> =
        DVector::from_fn(d, |i, _| all.iter().map(|own| own.3 * own.0[i]).sum::<f64>());
    let covariance: DMatrix<f64> = DMatrix::from_fn(d, d, |i, j| {
        all.iter().map(|own| own.3 * (own.0[i] - mean[i]) * (own.0[j] - mean[j])).sum::<f64>()
    });
    let Some(tilt) = covariance.lu().solve(&mean) else { return };
    for (offsets, _, _, share) in all {
        let along: f64 = (0..d).map(|i| (offsets[i] - mean[i]) * tilt[i]).sum();
        *share *= 1.0 - along;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point_position(cells: usize, ends: [AxisEnd; 2], x: f64) -> PointPosition {
        PointPosition { cells, ends, x }
    }

    fn moment(shares: &[(usize, f64)], x: f64, power: i32) -> f64 {
        shares.iter().map(|(cell, share)| share * (*cell as f64 - x).powi(power)).sum()
    }

    /// Verifies that the moments of the shares equal those of the point, and that waves with a wavelength of two cells
    /// are not excited, for many positions of the point.
    #[test]
    fn spline_shares_have_exact_moments_up_to_second_order() {
        for step in 0..=200 {
            let x = 10.0 + 0.01 * f64::from(step);
            let shares = point_position(30, [AxisEnd::Open; 2], x).axis_shares();
            for (power, exact) in [(0, 1.0), (1, 0.0), (2, 0.0)] {
                let found = moment(&shares, x, power);
                assert!((found - exact).abs() < 1e-13, "{x}: {found} of power {power}");
            }
            let sign = |cell: usize| if cell.is_multiple_of(2) { 1.0 } else { -1.0 };
            let sawtooth: f64 = shares.iter().map(|(cell, share)| sign(*cell) * share).sum();
            assert!(sawtooth.abs() < 1e-13, "{x}: {sawtooth}");
        }
    }

    /// Verifies sums near open and on periodic boundaries and with even mirror images, in grids of one cell or more,
    /// and first moments near open boundaries, in grids of several cells.
    #[test]
    fn splines_near_boundaries_keep_sum_and_first_moment() {
        for cells in [1, 2, 3, 5, 20] {
            for step in 0..=40 {
                let x = -0.5 + 0.025 * f64::from(step) * cells as f64;
                let open = point_position(cells, [AxisEnd::Open; 2], x).axis_shares();
                assert!((moment(&open, x, 0) - 1.0).abs() < 1e-12);
                if cells > 1 {
                    assert!(moment(&open, x, 1).abs() < 1e-11, "{x}: {open:?}");
                }
                for ends in [AxisEnd::Mirror(1.0), AxisEnd::Periodic] {
                    let shares = point_position(cells, [ends; 2], x).axis_shares();
                    assert!((moment(&shares, x, 0) - 1.0).abs() < 1e-12, "{x}: {shares:?}");
                }
            }
        }
        // With a symmetry plane through the point, shares before scaling are twice those of the whole kernel; for odd
        // fields they vanish.
        let whole = point_position(20, [AxisEnd::Open; 2], 9.5).axis_shares();
        let half = point_position(10, [AxisEnd::Mirror(1.0), AxisEnd::Open], -0.5).axis_shares();
        for (cell, share) in &half {
            let full = whole.iter().find(|own| own.0 == cell + 10).expect("the cell").1;
            assert!((share - 2.0 * full).abs() < 1e-14);
        }
        let odd = point_position(10, [AxisEnd::Mirror(-1.0), AxisEnd::Open], -0.5).axis_shares();
        assert!(odd.iter().all(|own| own.1.abs() < 1e-15), "{odd:?}");
    }

    /// Verifies sum 1 and the centre of mass of raised cosines inside the grid, and sum 1 of those that are cut off.
    #[test]
    fn bell_shares_have_unit_sum_and_centre_of_mass_at_the_point() {
        for step in 0..50 {
            let position = [7.0 + 0.02 * f64::from(step), 8.3];
            let along = position.map(|x| point_position(20, [AxisEnd::Open; 2], x));
            let shares = compute_bell_shares(&along, &[0.5, 0.25], 1.1);
            let sum: f64 = shares.iter().map(|own| own.1).sum();
            assert!((sum - 1.0).abs() < 1e-13);
            let first: f64 =
                shares.iter().map(|own| own.1 * ((own.0 % 20) as f64 - position[0])).sum();
            let second: f64 =
                shares.iter().map(|own| own.1 * ((own.0 / 20) as f64 - position[1])).sum();
            assert!(first.abs() < 1e-13 && second.abs() < 1e-13, "{first:e} {second:e}");
            let cut = [-0.3, 8.3].map(|x| point_position(20, [AxisEnd::Open; 2], x));
            let sum: f64 =
                compute_bell_shares(&cut, &[0.5, 0.25], 1.1).iter().map(|own| own.1).sum();
            assert!((sum - 1.0).abs() < 1e-13);
        }
    }
}
