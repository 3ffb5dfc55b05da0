//! The shares of cells in what acts at a point: kernels with the moments of a point, folded at planes of symmetry.
//!
//! Far away a source of shares wᵢ in cells at xᵢ is felt as Σ wᵢ G(xᵢ), a quadrature for the value at the point of
//! a function G that is smooth on the medium's side of interfaces: moments decide the error. Along each axis the
//! kernel is
//!
//! ```text
//! K(u) = ¼ (B(u − 1) + 2 B(u) + B(u + 1)),    w(u) = (7/4) K(u) − ⅜ (K(u − 1) + K(u + 1)),
//! ```
//!
//! u in cells, with the quadratic B-spline B. Wherever the point is in the grid the moments of w are those of the point
//! up to the second; waves of two cells, which nothing damps, are absent, wherever the point is, and those next to them are of the second
//! order (Fourier transform of w: two zeros at π a cell). It reaches less than four cells.
//!
//! Beyond a side of symmetry or antisymmetry the kernel is folded back with the sign of the field's mirror image: what is
//! left is half (a quarter, an eighth) of the whole model with its images. Amplitudes are those of the whole model: a point
//! on such a plane is its own image, and half of what acts there acts on either side of it. Beyond any other side a
//! share goes by linear extrapolation to the two cells at the side, which keeps the sum and the first moments. A bell
//! is cut off there.

use models::common::elementary::Elementary;
use models::solid::waves::Field;
use nalgebra::{DMatrix, DVector};

/// Cells from that in front of the point, and one more behind it, within which the spline lies.
const REACH: isize = 3;

/// A point so near to a plane, in cells, is on it.
const ON_A_PLANE: f64 = 1e-6;

/// What is beyond an end of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The mirror image, by so much.
    Physical(f64),
    /// Nothing, or a body of its own.
    Open,
    /// The other end.
    Periodic,
}

impl End {
    /// A plane of symmetry normal to an axis, as what drives a field meets it.
    pub fn symmetry(field: Field, axis: usize) -> Self {
        Self::Physical(if is_odd(field, axis) { -1.0 } else { 1.0 })
    }

    /// A plane in which the solid is mirrored with the opposite sign.
    pub fn antisymmetry(field: Field, axis: usize) -> Self {
        Self::Physical(if is_odd(field, axis) { 1.0 } else { -1.0 })
    }
}

/// Coordinates, and the cell that stands for them with a factor, if there is one.
type Place = (Vec<f64>, Option<(usize, f64)>);

/// An axis as a point sees it.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Cells along it.
    pub cells: usize,
    /// What is beyond its lower and its upper end.
    pub ends: [End; 2],
    /// The point, in cells from the first centre.
    pub x: f64,
}

impl Axis {
    /// The end at which a place lies beyond the grid, and by how many cells.
    fn beyond(&self, place: isize) -> Option<(usize, isize)> {
        let count = self.cells as isize;
        match place {
            place if place < 0 => Some((0, -place)),
            place if place >= count => Some((1, place - count + 1)),
            _ => None,
        }
    }

    /// The cell that stands for a place, and by how much; none beyond an open end.
    fn cell(&self, mut place: isize) -> Option<(usize, f64)> {
        let mut factor = 1.0;
        while let Some((end, by)) = self.beyond(place) {
            place = match self.ends[end] {
                End::Physical(sign) => {
                    factor *= sign;
                    if end == 0 { by - 1 } else { self.cells as isize - by }
                }
                End::Periodic => place.rem_euclid(self.cells as isize),
                End::Open => return None,
            };
        }
        Some((place as usize, factor))
    }

    /// The part of what acts at the point that acts on the grid's side of planes of symmetry through the point: ½ for
    /// each.
    fn part(&self) -> f64 {
        let planes = [-0.5, self.cells as f64 - 0.5].into_iter().zip(self.ends);
        let is_on = |&(plane, end): &(f64, End)| {
            matches!(end, End::Physical(_)) && (self.x - plane).abs() <= ON_A_PLANE
        };
        0.5f64.powi(planes.filter(is_on).count() as i32)
    }

    /// Adds the share of a place to those of the cells.
    fn add(&self, place: isize, share: f64, shares: &mut Vec<(usize, f64)>) {
        let last = self.cells as isize - 1;
        match (self.cell(place), self.beyond(place)) {
            (Some((cell, factor)), _) => match shares.iter_mut().find(|own| own.0 == cell) {
                Some((_, own)) => *own += factor * share,
                None => shares.push((cell, factor * share)),
            },
            (None, Some((end, by))) if last > 0 && self.ends[end] == End::Open => {
                let [first, second] = if end == 0 { [0, 1] } else { [last, last - 1] };
                self.add(first, (1 + by) as f64 * share, shares);
                self.add(second, -by as f64 * share, shares);
            }
            // One cell, or the far end of one that is mirrored.
            (None, Some((end, _))) => self.add(if end == 0 { 0 } else { last }, share, shares),
            (None, None) => {}
        }
    }

    /// The shares of the cells in the spline.
    fn spline(&self) -> Vec<(usize, f64)> {
        let middle = self.x.floor() as isize;
        let mut shares = Vec::new();
        for place in middle - REACH..=middle + REACH + 1 {
            let share = spline(place as f64 - self.x);
            if share != 0.0 {
                self.add(place, share, &mut shares);
            }
        }
        shares
    }
}

/// The quadratic B-spline, in cells.
fn quadratic(u: f64) -> f64 {
    match u.abs() {
        u if u <= 0.5 => 0.75 - u * u,
        u if u < 1.5 => 0.5 * (1.5 - u).powi(2),
        _ => 0.0,
    }
}

/// The kernel along an axis, in cells.
fn spline(u: f64) -> f64 {
    let wide = |u: f64| 0.25 * (quadratic(u - 1.0) + 2.0 * quadratic(u) + quadratic(u + 1.0));
    1.75 * wide(u) - 0.375 * (wide(u - 1.0) + wide(u + 1.0))
}

/// A bell over a radius: 1 in the middle, 0 beyond, without corners.
fn bell(distance: f64, radius: f64) -> f64 {
    if distance < radius {
        0.5 + 0.5 * (std::f64::consts::PI * distance / radius).cr_cos()
    } else {
        0.0
    }
}

/// Whether the mirror image of a field, in a plane normal to an axis, has the opposite sign.
fn is_odd(field: Field, axis: usize) -> bool {
    match field {
        Field::Velocity(i) => i == axis,
        Field::Spin(k) => k != axis,
        Field::Stress(i, j) | Field::ViscousStrain(i, j) => (i == axis) != (j == axis),
        Field::Couple(k, j) => (k != axis) != (j == axis),
    }
}

/// The part on the grid's side of planes of symmetry through the point: half of all shares for each.
fn on_this_side(along: &[Axis], mut shares: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let part: f64 = along.iter().map(Axis::part).product();
    shares.iter_mut().for_each(|own| own.1 *= part);
    shares
}

/// Shares of cells in the source of a field at a point of a grid of these axes, or of faces of a side of which these are
/// the axes; by index, the first axis fastest. They add up to 1 but for odd mirror images, and to half of that for
/// each plane of symmetry through the point. The kernel is the spline.
pub fn spline_shares(along: &[Axis]) -> Vec<(usize, f64)> {
    on_this_side(along, product(along))
}

/// The same with a bell of that radius, m; `spacing` are the edges of a cell along the axes, m.
pub fn bell_shares(along: &[Axis], spacing: &[f64], radius: f64) -> Vec<(usize, f64)> {
    on_this_side(along, within(along, spacing, radius))
}

/// The same with the one cell or face that is nearest to the point.
pub fn nearest_share(along: &[Axis]) -> Vec<(usize, f64)> {
    on_this_side(along, vec![(nearest(along), 1.0)])
}

/// The cell that holds the point.
fn nearest(along: &[Axis]) -> usize {
    along.iter().rev().fold(0, |cell, axis| {
        let index = (axis.x + 0.5).floor().max(0.0) as usize;
        cell * axis.cells + index.min(axis.cells - 1)
    })
}

/// The tensor product of splines.
fn product(along: &[Axis]) -> Vec<(usize, f64)> {
    let mut all = vec![(0, 1.0)];
    for axis in along.iter().rev() {
        let own = axis.spline();
        let next = |(cell, share): &(usize, f64)| {
            let (cell, share) = (cell * axis.cells, *share);
            own.iter().map(move |(index, own)| (cell + index, share * own)).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(next).collect();
    }
    all.sort_by_key(|own| own.0);
    all
}

/// A bell of a radius (m), normalised; unless a side cuts it off, with the point as its centre of mass.
fn within(along: &[Axis], spacing: &[f64], radius: f64) -> Vec<(usize, f64)> {
    // Offsets from the point (m), the cell and its factor, by place.
    let mut places: Vec<Place> = vec![(Vec::new(), Some((0, 1.0)))];
    for (axis, h) in along.iter().zip(spacing).rev() {
        let reach = radius / h;
        let range = (axis.x - reach).ceil() as isize..=(axis.x + reach).floor() as isize;
        places = places
            .iter()
            .flat_map(|own| range.clone().map(move |place| (own, place)))
            .map(|((offsets, cell), place)| {
                let mut offsets = offsets.clone();
                offsets.insert(0, (place as f64 - axis.x) * h);
                let cell = cell.zip(axis.cell(place)).map(|((cell, factor), (index, own))| {
                    (cell * axis.cells + index, factor * own)
                });
                (offsets, cell)
            })
            .collect();
    }
    let mut is_whole = true;
    let mut all: Vec<(Vec<f64>, usize, f64, f64)> = Vec::new();
    for (offsets, cell) in places {
        let share = bell(offsets.iter().fold(0.0, |sum: f64, x| sum.root_sum_square(*x)), radius);
        match cell {
            Some((cell, factor)) if share > 0.0 => all.push((offsets, cell, factor, share)),
            None if share > 0.0 => is_whole = false,
            _ => {}
        }
    }
    if all.is_empty() {
        return vec![(nearest(along), 1.0)];
    }
    let sum: f64 = all.iter().map(|own| own.3).sum();
    all.iter_mut().for_each(|own| own.3 /= sum);
    if is_whole && spacing.iter().all(|h| radius >= 2.0 * h) {
        centre(&mut all);
    }
    let mut shares: Vec<(usize, f64)> = all.iter().map(|own| (own.1, own.2 * own.3)).collect();
    shares.sort_by_key(|own| own.0);
    // A cell and its mirror images.
    let mut merged: Vec<(usize, f64)> = Vec::new();
    for (cell, share) in shares {
        match merged.last_mut().filter(|last| last.0 == cell) {
            Some(last) => last.1 += share,
            None => merged.push((cell, share)),
        }
    }
    merged
}

/// Makes the centre of mass of shares the point: with its offset m and the covariance C by the factors
/// 1 − (x − m)·C⁻¹m, whose mean is 1.
fn centre(all: &mut [(Vec<f64>, usize, f64, f64)]) {
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

    fn axis(cells: usize, ends: [End; 2], x: f64) -> Axis {
        Axis { cells, ends, x }
    }

    fn moment(shares: &[(usize, f64)], x: f64, power: i32) -> f64 {
        shares.iter().map(|(cell, share)| share * (*cell as f64 - x).powi(power)).sum()
    }

    /// Moments are those of the point, and no wave of two cells is made, wherever the point is.
    #[test]
    fn splines_have_exact_moments() {
        for step in 0..=200 {
            let x = 10.0 + 0.01 * f64::from(step);
            let shares = axis(30, [End::Open; 2], x).spline();
            for (power, exact) in [(0, 1.0), (1, 0.0), (2, 0.0)] {
                let found = moment(&shares, x, power);
                assert!((found - exact).abs() < 1e-13, "{x}: {found} of power {power}");
            }
            let sign = |cell: usize| if cell.is_multiple_of(2) { 1.0 } else { -1.0 };
            let sawtooth: f64 = shares.iter().map(|(cell, share)| sign(*cell) * share).sum();
            assert!(sawtooth.abs() < 1e-13, "{x}: {sawtooth}");
        }
    }

    /// Next to sides: sums and first moments stay where nothing is mirrored, sums where the image has the same
    /// sign; a grid of few cells holds everything.
    #[test]
    fn splines_end_at_sides() {
        for cells in [1, 2, 3, 5, 20] {
            for step in 0..=40 {
                let x = -0.5 + 0.025 * f64::from(step) * cells as f64;
                let open = axis(cells, [End::Open; 2], x).spline();
                assert!((moment(&open, x, 0) - 1.0).abs() < 1e-12);
                if cells > 1 {
                    assert!(moment(&open, x, 1).abs() < 1e-11, "{x}: {open:?}");
                }
                for ends in [End::Physical(1.0), End::Periodic] {
                    let own = axis(cells, [ends; 2], x).spline();
                    assert!((moment(&own, x, 0) - 1.0).abs() < 1e-12, "{x}: {own:?}");
                }
            }
        }
        // On the plane half of the whole kernel, twice; of odd fields nothing.
        let whole = axis(20, [End::Open; 2], 9.5).spline();
        let half = axis(10, [End::Physical(1.0), End::Open], -0.5).spline();
        for (cell, share) in &half {
            let full = whole.iter().find(|own| own.0 == cell + 10).expect("the cell").1;
            assert!((share - 2.0 * full).abs() < 1e-14);
        }
        let odd = axis(10, [End::Physical(-1.0), End::Open], -0.5).spline();
        assert!(odd.iter().all(|own| own.1.abs() < 1e-15), "{odd:?}");
    }

    /// Bells that lie inside have the sum 1 and the point as their centre; those cut off by a side the sum 1.
    #[test]
    fn bells_are_centred() {
        for step in 0..50 {
            let at = [7.0 + 0.02 * f64::from(step), 8.3];
            let along = at.map(|x| axis(20, [End::Open; 2], x));
            let shares = within(&along, &[0.5, 0.25], 1.1);
            let sum: f64 = shares.iter().map(|own| own.1).sum();
            assert!((sum - 1.0).abs() < 1e-13);
            let first: f64 = shares.iter().map(|own| own.1 * ((own.0 % 20) as f64 - at[0])).sum();
            let second: f64 = shares.iter().map(|own| own.1 * ((own.0 / 20) as f64 - at[1])).sum();
            assert!(first.abs() < 1e-13 && second.abs() < 1e-13, "{first:e} {second:e}");
            let cut = [-0.3, 8.3].map(|x| axis(20, [End::Open; 2], x));
            let sum: f64 = within(&cut, &[0.5, 0.25], 1.1).iter().map(|own| own.1).sum();
            assert!((sum - 1.0).abs() < 1e-13);
        }
    }
}
