//! Boundary conditions of a domain in the form that its sweeps use.

use super::completion::ClosingBoundaries;
use super::layout::Layout;
use super::rows::RowEnds;
use crate::simd::{LaneGroup, Real};
use crate::solid::boundary::{Boundary, Load};
use crate::solid::ghosts::{BoundaryFaces, GhostRule, LaneIndex, set_times};
use crate::solid::problem::Problem;
use crate::solid::region::Region;

/// Boundary faces at both ends of all axes.
pub(super) type BoundaryFacesByAxis<T, const D: usize> = [[BoundaryFaces<T>; 2]; D];

/// Boundary conditions in the half steps of a pass.
#[derive(Clone)]
pub(super) struct Boundaries<T: Real, const D: usize> {
    /// Boundary faces by half step of the pass.
    pub(super) faces: Vec<BoundaryFacesByAxis<T, D>>,
    /// By step of the pass: boundaries of the first axis for completing the step for output, with alternating sweeps;
    /// else empty.
    pub(super) closing_boundaries: Vec<ClosingBoundaries<T>>,
    pub(super) row_ends: RowEnds<T>,
}

impl<T: Real, const D: usize> Boundaries<T, D> {
    /// Creates the boundary conditions of the problem of a region, for passes of at most `max_pass_steps` steps.
    pub(super) fn new(
        problem: &Problem<D>,
        region: &Region<D>,
        layout: &Layout<D>,
        max_pass_steps: usize,
    ) -> Self {
        let faces: BoundaryFacesByAxis<T, D> = std::array::from_fn(|axis| {
            std::array::from_fn(|end| create_faces(problem, (axis, end), region, layout))
        });
        let closing = if problem.scheme.is_alternating() { max_pass_steps } else { 0 };
        Self {
            closing_boundaries: vec![ClosingBoundaries::new(&faces[0]); closing],
            faces: vec![faces; 2 * max_pass_steps],
            row_ends: RowEnds::new(layout.cells[0], layout.groups, layout.ghosts),
        }
    }

    /// Evaluates the boundary values of half step `half` of the pass. `middles`: middles of the sweeps of longitudinal
    /// and of other waves, s; `first`: another time for the boundaries of the first axis, s (alternating sweeps).
    pub(super) fn set_times(&mut self, half: usize, middles: [f64; 2], first: Option<f64>) {
        for faces in &mut self.faces[half] {
            set_times(faces, middles);
        }
        if let Some(time) = first {
            set_times(&mut self.faces[half][0], [time; 2]);
        }
    }
}

/// Creates the boundary faces at an end of an axis.
fn create_faces<T: Real, const D: usize>(
    problem: &Problem<D>,
    (axis, end): (usize, usize),
    region: &Region<D>,
    layout: &Layout<D>,
) -> BoundaryFaces<T> {
    let boundary = &problem.boundaries[axis][end];
    if region.halo(axis)[end] > 0 {
        return BoundaryFaces::HaloEnd;
    }
    if *boundary == Boundary::Periodic {
        return BoundaryFaces::Periodic;
    }
    let position_in_layer = |cell: usize| {
        let (index, lane) = layout.lane_index(cell);
        (index.group, lane)
    };
    let (layers, layer) = (layout.layers(), layout.layer_cells());
    let faces_per_layer = layer / layout.cells[axis];
    // Storage position (group and lane) of a face. First axis: faces packed in the order of the rows. Other axes: lane
    // of the adjacent cell, and its group within a layer (last axis) or within a row, with one row of groups for each
    // layer (middle axis).
    let storage_position = |face: usize| match axis {
        0 => (face / T::Lanes::COUNT, face % T::Lanes::COUNT),
        _ if axis + 1 == D => position_in_layer(face),
        _ => {
            let (group, lane) = position_in_layer(face % faces_per_layer);
            (face / faces_per_layer * layout.groups + group, lane)
        }
    };
    let (count, groups) = match axis {
        0 => (layers * layout.rows, (layers * layout.rows).div_ceil(T::Lanes::COUNT)),
        _ if axis + 1 == D => (layer, layout.layer_groups()),
        _ => (layers * faces_per_layer, layers * layout.groups),
    };
    let faces: Vec<(usize, LaneIndex)> =
        (0..count).map(|face| (face, storage_position(face))).collect();
    let is_at_end = |load: &&Load| (load.axis, load.end) == (axis, end);
    let loads: Vec<&Load> = problem.loads.iter().filter(is_at_end).collect();
    let pairs = problem.media[0].pairs[axis].len();
    let is_loaded = !loads.is_empty();
    let slopes = problem.boundary_slopes();
    let mut rule = GhostRule::new(boundary, pairs, (&faces, groups), is_loaded, slopes);
    for load in loads {
        let is_longitudinal = problem.media[0].pairs[axis][load.pair].is_longitudinal();
        rule.add_load(load, is_longitudinal, &faces);
    }
    BoundaryFaces::Physical(rule)
}
