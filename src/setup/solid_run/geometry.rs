//! Conversion of positions of a case to cells of its grid, and distances on periodic grids.

use crate::case::dynamics::{
    BoundaryConditionKind, BoundaryFace, FaceCondition, Interpolation, ReceiverPoint,
    RecordedQuantity, SolidRun,
};
use dynamics::probe::Probe;
use models::common::elementary::Elementary;

/// Returns the coordinates of the centre of the cell of index `cell`, m.
pub(crate) fn cell_centre(solid_run: &SolidRun, cell: usize) -> Vec<f64> {
    let mut rest = cell;
    let along = solid_run.grid.cells.iter().enumerate();
    along
        .map(|(axis, &count)| {
            let index = rest % count;
            rest /= count;
            solid_run.grid.cell_centre(axis, index)
        })
        .collect()
}

/// Returns the index of the cell that contains a point: for a point on the face between two cells the upper cell, for a
/// point outside of the grid the nearest cell.
pub(crate) fn find_containing_cell(solid_run: &SolidRun, point: &[f64]) -> usize {
    let mut cell = 0;
    for (axis, x) in point.iter().enumerate().rev() {
        let grid = &solid_run.grid;
        let index = ((x - grid.origin[axis]) / grid.spacing[axis]).floor().max(0.0) as usize;
        cell = cell * grid.cells[axis] + index.min(grid.cells[axis] - 1);
    }
    cell
}

/// Returns the difference a − b of coordinates along an axis, m; on a periodic axis the one of smallest magnitude.
pub(super) fn coordinate_difference(solid_run: &SolidRun, axis: usize, a: f64, b: f64) -> f64 {
    let [first, last] = solid_run.grid.axis_bounds(axis);
    match is_periodic(solid_run, axis) {
        true => (a - b) - ((a - b) / (last - first)).round() * (last - first),
        false => a - b,
    }
}

/// Returns the distance of two points, m; `a` and `b` are their coordinates along `axes`.
pub(super) fn distance(solid_run: &SolidRun, axes: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let parts = axes.iter().zip(a.iter().zip(b));
    parts.fold(0.0, |sum, (axis, (a, b))| {
        Elementary::root_sum_square(sum, coordinate_difference(solid_run, *axis, *a, *b))
    })
}

/// Returns whether the grid is periodic along an axis.
pub(super) fn is_periodic(solid_run: &SolidRun, axis: usize) -> bool {
    find_whole_boundary_condition(solid_run, BoundaryFace { axis, is_upper: false })
        .is_some_and(|entry| entry.condition == BoundaryConditionKind::Periodic)
}

/// Returns the last condition of the case that is set on the whole of `boundary`, not only on a rectangle of it.
pub(super) fn find_whole_boundary_condition(
    solid_run: &SolidRun,
    boundary: BoundaryFace,
) -> Option<&FaceCondition> {
    solid_run
        .boundary_conditions
        .iter()
        .rev()
        .find(|entry| entry.face == boundary && entry.rectangle.is_none())
}

/// Creates the probe of a receiver; `medium_index` returns the index of the medium of a cell.
pub(crate) fn create_probe(
    solid_run: &SolidRun,
    medium_index: impl Fn(usize) -> usize,
    receiver: &ReceiverPoint<RecordedQuantity>,
) -> Probe {
    let grid = &solid_run.grid;
    let home = find_containing_cell(solid_run, &receiver.position);
    if receiver.interpolation == Interpolation::Nearest {
        return Probe::from_cell(home);
    }
    let axes = || 0..grid.dimensions();
    let grid_coordinate =
        |axis: usize| (receiver.position[axis] - grid.origin[axis]) / grid.spacing[axis] - 0.5;
    let at: Vec<f64> = axes().map(grid_coordinate).collect();
    let is_periodic: Vec<bool> = axes().map(|axis| is_periodic(solid_run, axis)).collect();
    Probe::with_interpolation(&grid.cells, &is_periodic, medium_index, home, &at)
}
