//! Polynomial interpolation of cell values at a point.
//!
//! Along each axis the Lagrange polynomial of degree 3 through the four cells nearest to the point, and their
//! tensor product: the error is O(h⁴), below that of the scheme. Next to a side the four cells stay inside and
//! the polynomial extrapolates, by half a cell at most; round a periodic axis they wrap round. All cells are of
//! the medium of the cell that holds the point, since fields have kinks or jumps at an interface: where
//! it is near, the polynomials extrapolate to it, and have fewer cells if the medium is thinner.

use super::setup::{cell_at, is_periodic};
use crate::case::dynamics::{Dynamics, Grid, Interpolation, Receiver};

/// Cells along an axis, at most.
const MOST: usize = 4;

/// Distance from the centre of a cell, in cells, that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Cells and weights of a point; the weights add up to 1.
pub(super) type Stencil = Vec<(usize, f64)>;

/// Cells that follow each other along an axis, by the index of the first one, which may lie before the grid
/// where that is periodic.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: isize,
    count: usize,
    /// How much is lost without more cells: 0 where the point is at a centre.
    lacking: usize,
    /// Distance of the middle from the point, in cells.
    distance: f64,
}

/// The runs along an axis that may hold the point at `x`, in cells from the centre of the first one, which is in
/// the cell `home`.
fn runs(cells: usize, is_periodic: bool, home: usize, x: f64) -> Vec<Run> {
    let home = home as isize;
    if (x - home as f64).abs() < ROUNDING {
        return vec![Run { first: home, count: 1, lacking: 0, distance: 0.0 }];
    }
    let mut runs = Vec::new();
    for count in 1..=MOST.min(cells) {
        for first in home + 1 - count as isize..=home {
            if is_periodic || (first >= 0 && first as usize + count <= cells) {
                let distance = (first as f64 + 0.5 * (count as f64 - 1.0) - x).abs();
                runs.push(Run { first, count, lacking: MOST - count, distance });
            }
        }
    }
    runs
}

/// Lagrange weights at `x` of the cells of a run.
fn weights(run: &Run, x: f64) -> Vec<f64> {
    let places: Vec<f64> =
        (0..run.count).map(|index| (run.first + index as isize) as f64).collect();
    if run.lacking == 0 && run.count == 1 {
        return vec![1.0];
    }
    let weight = |own: &f64| {
        let others = places.iter().filter(|other| *other != own);
        others.map(|other| (x - other) / (own - other)).product()
    };
    places.iter().map(weight).collect()
}

/// Index of the cell at a place along an axis.
fn wrapped(place: isize, cells: usize) -> usize {
    place.rem_euclid(cells as isize) as usize
}

/// The cells of a box, the first axis fastest, by their indices along the axes.
fn cells_of(grid: &Grid, runs: &[Run]) -> Vec<usize> {
    let mut cells = vec![0];
    for (axis, run) in runs.iter().enumerate().rev() {
        cells = cells
            .iter()
            .flat_map(|cell| {
                (0..run.count).map(move |index| {
                    cell * grid.cells[axis] + wrapped(run.first + index as isize, grid.cells[axis])
                })
            })
            .collect();
    }
    cells
}

/// The cells that a receiver needs, and their weights; `of_cell` are the media.
pub(super) fn stencil(dynamics: &Dynamics, of_cell: &[u16], receiver: &Receiver) -> Stencil {
    let grid = &dynamics.grid;
    let home = cell_at(dynamics, &receiver.at);
    if receiver.interpolation == Interpolation::Nearest {
        return vec![(home, 1.0)];
    }
    let mut rest = home;
    let along: Vec<(f64, Vec<Run>)> = receiver
        .at
        .iter()
        .enumerate()
        .map(|(axis, at)| {
            let index = rest % grid.cells[axis];
            rest /= grid.cells[axis];
            let x = (at - grid.origin[axis]) / grid.spacing[axis] - 0.5;
            (x, runs(grid.cells[axis], is_periodic(dynamics, axis), index, x))
        })
        .collect();
    // The best box of one medium: the lowest degree as high as can be, then the others, then centred.
    let mut boxes: Vec<Vec<Run>> = vec![Vec::new()];
    for (_, runs) in &along {
        boxes = boxes
            .iter()
            .flat_map(|own| runs.iter().map(move |run| [own.as_slice(), &[*run]].concat()))
            .collect();
    }
    let rank = |runs: &[Run]| {
        let lacking = || runs.iter().map(|run| run.lacking);
        let distance: f64 = runs.iter().map(|run| run.distance).sum();
        (lacking().max().unwrap_or(0), lacking().sum::<usize>(), distance)
    };
    boxes.sort_by(|one, other| {
        let (one, other) = (rank(one), rank(other));
        (one.0, one.1).cmp(&(other.0, other.1)).then(one.2.total_cmp(&other.2))
    });
    let is_alike = |runs: &Vec<Run>| {
        cells_of(grid, runs).into_iter().all(|cell| of_cell[cell] == of_cell[home])
    };
    // The cell alone is always one.
    let Some(runs) = boxes.into_iter().find(is_alike) else { return vec![(home, 1.0)] };
    let mut products = vec![1.0];
    for (run, (x, _)) in runs.iter().zip(&along).rev() {
        let own = weights(run, *x);
        products = products.iter().flat_map(|all| own.iter().map(move |own| all * own)).collect();
    }
    cells_of(grid, &runs).into_iter().zip(products).collect()
}

/// The sum over a stencil, in its order, of values by cell; one cell alone keeps its bits.
pub(super) fn interpolated(stencil: &Stencil, value: impl Fn(usize) -> f64) -> f64 {
    let terms = stencil.iter().map(|(cell, weight)| weight * value(*cell));
    terms.reduce(|sum, term| sum + term).unwrap_or(0.0)
}
