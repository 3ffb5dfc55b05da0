//! Positions of a case in its grid.

use crate::case::dynamics::{
    Condition, Dynamics, Interpolation, Receiver, Recorded, Side, SideCondition,
};
use dynamics::probe::Probe;
use models::common::elementary::Elementary;

/// Returns the centre of a cell, m.
pub(crate) fn centre(dynamics: &Dynamics, cell: usize) -> Vec<f64> {
    let mut rest = cell;
    let along = dynamics.grid.cells.iter().enumerate();
    along
        .map(|(axis, &count)| {
            let index = rest % count;
            rest /= count;
            dynamics.grid.centre(axis, index)
        })
        .collect()
}

/// Returns the index of the cell that contains a point, the upper cell for points on a face, the nearest cell outside
/// of the grid.
pub(crate) fn cell_at(dynamics: &Dynamics, point: &[f64]) -> usize {
    let mut cell = 0;
    for (axis, x) in point.iter().enumerate().rev() {
        let grid = &dynamics.grid;
        let index = ((x - grid.origin[axis]) / grid.spacing[axis]).floor().max(0.0) as usize;
        cell = cell * grid.cells[axis] + index.min(grid.cells[axis] - 1);
    }
    cell
}

/// Returns a − b along an axis, m; in the periodic case the shortest difference.
pub(super) fn along(dynamics: &Dynamics, axis: usize, a: f64, b: f64) -> f64 {
    let [first, last] = dynamics.grid.extent(axis);
    match is_periodic(dynamics, axis) {
        true => (a - b) - ((a - b) / (last - first)).round() * (last - first),
        false => a - b,
    }
}

/// Returns the distance of two points in the space of `axes`, m.
pub(super) fn distance(dynamics: &Dynamics, axes: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let parts = axes.iter().zip(a.iter().zip(b));
    parts.fold(0.0, |sum, (axis, (a, b))| {
        Elementary::root_sum_square(sum, along(dynamics, *axis, *a, *b))
    })
}

/// Returns whether the grid is periodic along an axis.
pub(super) fn is_periodic(dynamics: &Dynamics, axis: usize) -> bool {
    whole_side(dynamics, Side { axis, is_upper: false })
        .is_some_and(|entry| entry.condition == Condition::Periodic)
}

/// Returns the last condition set on a whole side.
pub(super) fn whole_side(dynamics: &Dynamics, side: Side) -> Option<&SideCondition> {
    dynamics.sides.iter().rev().find(|entry| entry.side == side && entry.part.is_none())
}

/// Creates the probe of a receiver; `of_cell` holds the medium index of each cell.
pub(crate) fn probe(dynamics: &Dynamics, of_cell: &[u16], receiver: &Receiver<Recorded>) -> Probe {
    let grid = &dynamics.grid;
    let home = cell_at(dynamics, &receiver.at);
    if receiver.interpolation == Interpolation::Nearest {
        return Probe::nearest(home);
    }
    let axes = || 0..grid.dimensions();
    let place = |axis: usize| (receiver.at[axis] - grid.origin[axis]) / grid.spacing[axis] - 0.5;
    let at: Vec<f64> = axes().map(place).collect();
    let is_periodic: Vec<bool> = axes().map(|axis| is_periodic(dynamics, axis)).collect();
    Probe::interpolating(&grid.cells, &is_periodic, of_cell, home, &at)
}
