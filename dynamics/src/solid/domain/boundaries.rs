//! The boundary conditions of a domain as its sweeps see them.

use super::complete::ClosingBoundaries;
use super::layout::Layout;
use super::rows::RowEnds;
use crate::simd::{Group, Real};
use crate::solid::boundary::{Boundary, Load};
use crate::solid::ghosts::{BoundaryFaces, GhostRule, Slot, set_time};
use crate::solid::problem::Problem;

/// Both ends of all axes.
pub(super) type Faces<T, const D: usize> = [[BoundaryFaces<T>; 2]; D];

/// Boundary conditions in the half steps of a pass.
#[derive(Clone)]
pub(super) struct Boundaries<T: Real, const D: usize> {
    /// By half step.
    pub(super) faces: Vec<Faces<T, D>>,
    /// Where sweeps alternate: those of the first axis when each step of a pass is completed.
    pub(super) closing: Vec<ClosingBoundaries<T>>,
    pub(super) row_ends: RowEnds<T>,
}

impl<T: Real, const D: usize> Boundaries<T, D> {
    /// Those of these layers of a problem, for passes of so many steps at most.
    pub(super) fn new(
        problem: &Problem<D>,
        layers: &[usize],
        layout: &Layout<D>,
        most_steps: usize,
    ) -> Self {
        let faces: Faces<T, D> = std::array::from_fn(|axis| {
            std::array::from_fn(|end| faces_of(problem, (axis, end), layers, layout))
        });
        let closing = if problem.scheme.alternates() { most_steps } else { 0 };
        Self {
            closing: vec![ClosingBoundaries::new(&faces[0]); closing],
            faces: vec![faces; 2 * most_steps],
            row_ends: RowEnds::new(layout.cells[0], layout.groups),
        }
    }

    /// Evaluates the boundary values of a half step of the pass at its middle; `start` is the time at the
    /// beginning of its step, and `first` overrides the time of the first axis (alternating sweeps).
    pub(super) fn set_time(&mut self, half: usize, start: f64, step: f64, first: Option<f64>) {
        for faces in &mut self.faces[half] {
            set_time(faces, start + [0.25, 0.75][half % 2] * step);
        }
        if let Some(time) = first {
            set_time(&mut self.faces[half][0], time);
        }
    }
}

/// The faces at an end of an axis.
fn faces_of<T: Real, const D: usize>(
    problem: &Problem<D>,
    (axis, end): (usize, usize),
    layers: &[usize],
    layout: &Layout<D>,
) -> BoundaryFaces<T> {
    let boundary = &problem.boundaries[axis][end];
    if axis + 1 == D && layout.halo[end] > 0 {
        return BoundaryFaces::Exchange;
    }
    if *boundary == Boundary::Periodic {
        return BoundaryFaces::Periodic;
    }
    let layer = layout.layer_cells();
    let slot = |cell: usize| {
        let (index, lane) = layout.slot(cell);
        (index.group, lane)
    };
    let mut faces: Vec<(usize, Slot)> = if axis + 1 == D {
        (0..layer).map(|face| (face, slot(face))).collect()
    } else {
        // Those of the layer, and how they stand together.
        let own = layer / layout.cells[axis];
        let of_face = |index: usize, face: usize| match axis {
            0 => {
                let row = index * own + face;
                (row / T::Lanes::COUNT, row % T::Lanes::COUNT)
            }
            _ => (index * layout.groups + slot(face).0, slot(face).1),
        };
        let of_layer = |(index, &layer): (usize, &usize)| {
            (0..own).map(move |face| (layer * own + face, of_face(index, face)))
        };
        layers.iter().enumerate().flat_map(of_layer).collect()
    };
    faces.sort_unstable();
    let groups = match axis {
        0 => (layers.len() * layout.rows).div_ceil(T::Lanes::COUNT),
        _ if axis + 1 == D => layout.layer_groups(),
        _ => layers.len() * layout.groups,
    };
    let own = |load: &&Load| (load.axis, load.end) == (axis, end);
    let loads: Vec<&Load> = problem.loads.iter().filter(own).collect();
    let pairs = problem.media[0].pairs[axis].len();
    let is_loaded = !loads.is_empty();
    let slopes = problem.scheme.slopes;
    let mut rule = GhostRule::new(boundary, pairs, (&faces, groups), is_loaded, slopes);
    loads.into_iter().for_each(|load| rule.add(load, &faces));
    BoundaryFaces::Mirror(rule)
}
