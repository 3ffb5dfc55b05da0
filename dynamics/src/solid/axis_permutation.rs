//! Permutation of the axes: the first axis of a domain, along which rows lie in memory and which alternating sweeps treat
//! differently from the others ([`Splitting::Alternating`](crate::solid::problem::Splitting)), may be any axis of the problem.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use crate::solid::boundary::{Boundary, Condition, Load, Source};
use crate::solid::interlayers::Interlayers;
use crate::solid::problem::{DomainError, Grid, MediumFunction, Problem};

/// Permutation of the axes of a problem to those of a domain, with conversion of cell indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisPermutation<const D: usize> {
    /// Axis of the problem by axis of the domain.
    axes: [usize; D],
    /// Number of cells along each axis of the problem.
    cells: [usize; D],
}

impl<const D: usize> AxisPermutation<D> {
    /// Moves one axis to the front; the others keep their order.
    pub(crate) fn with_first_axis(axis: usize, grid: &Grid<D>) -> Self {
        let axes = std::array::from_fn(|place| match place {
            0 => axis,
            _ if place <= axis => place - 1,
            _ => place,
        });
        Self { axes, cells: grid.cells }
    }

    /// Whether the permutation is the identity.
    fn is_identity(&self) -> bool {
        self.axes.is_sorted()
    }

    /// Converts a linear index over the axes `from` (first of them fastest) to one over the same axes in the order
    /// `to`.
    fn reindex(&self, index: usize, from: &[usize], to: &[usize]) -> usize {
        let mut indices = [0; D];
        let mut remaining_index = index;
        for &axis in from {
            indices[axis] = remaining_index % self.cells[axis];
            remaining_index /= self.cells[axis];
        }
        to.iter().rev().fold(0, |index, &axis| index * self.cells[axis] + indices[axis])
    }

    /// Returns the index in the domain of a cell of the problem.
    pub(crate) fn permuted_cell(&self, cell: usize) -> usize {
        self.reindex(cell, &std::array::from_fn::<_, D, _>(|axis| axis), &self.axes)
    }

    /// Returns the index in the problem of a cell of the domain.
    pub(crate) fn original_cell(&self, cell: usize) -> usize {
        self.reindex(cell, &self.axes, &std::array::from_fn::<_, D, _>(|axis| axis))
    }

    /// Converts the index of a face, on a boundary of the problem normal to the problem's axis `axis`, to its index on
    /// the same boundary of the domain.
    fn permuted_face(&self, axis: usize, face: usize) -> usize {
        let others = |axes: [usize; D]| axes.into_iter().filter(|own| *own != axis).collect();
        let [from, to]: [Vec<usize>; 2] = [std::array::from_fn(|own| own), self.axes].map(others);
        self.reindex(face, &from, &to)
    }

    /// Reorders values by cell of the problem to the order of the cells of the domain. A list of another length (no
    /// values, or one value for all cells) is returned unchanged.
    pub(crate) fn permute<'a, V: Copy>(&self, values: &'a [V]) -> Cow<'a, [V]> {
        if self.is_identity() || values.len() != self.cells.iter().product::<usize>() {
            return Cow::Borrowed(values);
        }
        (0..values.len()).map(|cell| values[self.original_cell(cell)]).collect()
    }

    /// Reorders values by cell of the domain to the order of the cells of the problem; a list of another length is
    /// returned unchanged.
    pub(crate) fn unpermute<V: Copy>(&self, values: Vec<V>) -> Vec<V> {
        if self.is_identity() || values.len() != self.cells.iter().product::<usize>() {
            return values;
        }
        (0..values.len()).map(|cell| values[self.permuted_cell(cell)]).collect()
    }

    /// Returns the same permutation for a box of the grid; `ranges`: cells of the box along the axes of the domain.
    pub(crate) fn restrict_to_box(&self, ranges: &[Range<usize>; D]) -> Self {
        let counts = ranges.each_ref().map(ExactSizeIterator::len);
        Self { cells: self.unpermute_axis_values(counts), ..*self }
    }

    /// Reorders one value per axis of the domain to the order of the axes of the problem.
    pub(crate) fn unpermute_axis_values<V: Clone>(&self, values: [V; D]) -> [V; D] {
        let mut ordered = values.clone();
        for (value, &axis) in values.into_iter().zip(&self.axes) {
            ordered[axis] = value;
        }
        ordered
    }

    /// Reorders one value per axis of the problem to the order of the axes of the domain.
    pub(crate) fn permute_axis_values<V: Copy>(&self, values: [V; D]) -> [V; D] {
        self.axes.map(|axis| values[axis])
    }

    /// Reorders one range per axis of the problem to the order of the axes of the domain.
    pub(crate) fn permute_axis_ranges(&self, ranges: &[Range<usize>; D]) -> [Range<usize>; D] {
        self.axes.map(|axis| ranges[axis].clone())
    }

    /// Returns the grid with permuted axes.
    pub(crate) fn permute_grid(&self, own: &Grid<D>) -> Grid<D> {
        Grid {
            cells: self.axes.map(|axis| own.cells[axis]),
            spacing: self.axes.map(|axis| own.spacing[axis]),
        }
    }

    /// Checks a problem and permutes its axes.
    ///
    /// # Errors
    /// See [`DomainError`]; also if the problem has a metric and the axes are permuted, since the layers of a metric
    /// are normal to the second axis.
    pub(crate) fn check_and_permute<'a>(
        &self,
        own: &'a Problem<D>,
    ) -> Result<Cow<'a, Problem<D>>, DomainError> {
        own.validate()?;
        if own.metric.is_some() && !self.is_identity() {
            return Err(DomainError::Metric("the first axis must be swept first"));
        }
        Ok(self.permute_problem(own))
    }

    /// Returns the axis of the domain that is an axis of the problem.
    fn permuted_axis(&self, axis: usize) -> usize {
        self.axes.iter().position(|own| *own == axis).unwrap_or(axis)
    }

    /// Permutes the axes of a checked problem. The indices of velocities and stress components, and of the components
    /// of the acceleration, still refer to the axes of the given problem.
    fn permute_problem<'a>(&self, own: &'a Problem<D>) -> Cow<'a, Problem<D>> {
        if self.is_identity() {
            return Cow::Borrowed(own);
        }
        let permuted_axis = |axis: usize| self.permuted_axis(axis);
        let boundary = |axis: usize, own: &Boundary| {
            let Boundary::ByFace(pairs) = own else { return own.clone() };
            let by_face = |conditions: &Vec<Condition>| {
                let mut permuted = conditions.clone();
                for (face, condition) in conditions.iter().enumerate() {
                    permuted[self.permuted_face(axis, face)] = *condition;
                }
                permuted
            };
            Boundary::ByFace(pairs.iter().map(by_face).collect())
        };
        let mut media = own.media.clone();
        for (medium, before) in media.iter_mut().zip(&own.media) {
            medium.pairs = self.axes.iter().map(|&axis| before.pairs[axis].clone()).collect();
        }
        let load = |load: &Load| {
            let faces = load.faces.iter();
            let faces = faces.map(|&(face, share)| (self.permuted_face(load.axis, face), share));
            Load { axis: permuted_axis(load.axis), faces: faces.collect(), ..load.clone() }
        };
        let source = |source: &Source| {
            let cells = source.cells.iter().map(|&(cell, share)| (self.permuted_cell(cell), share));
            Source { cells: cells.collect(), ..source.clone() }
        };
        let interlayers = own.interlayers.iter();
        let interlayers =
            interlayers.map(|own| Interlayers { axis: permuted_axis(own.axis), ..own.clone() });
        let initial_stress = own.initial_stress.clone();
        Cow::Owned(Problem {
            grid: self.permute_grid(&own.grid),
            media,
            cell_media: self.permute(&own.cell_media).into_owned(),
            medium_function: own.medium_function.clone().map(|function| {
                let own = *self;
                Arc::new(move |cell| function(own.original_cell(cell))) as MediumFunction
            }),
            boundaries: self
                .axes
                .map(|axis| own.boundaries[axis].each_ref().map(|side| boundary(axis, side))),
            loads: own.loads.iter().map(load).collect(),
            sources: own.sources.iter().map(source).collect(),
            interlayers: interlayers.collect(),
            initial_stress: initial_stress.map(|(axis, stress)| (permuted_axis(axis), stress)),
            ..own.clone()
        })
    }
}
