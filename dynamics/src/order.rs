//! The axes in another order: sweeps along the first one are in a place of their own
//! ([`Splitting::Alternating`](crate::problem::Splitting)).

use crate::boundary::{Boundary, Condition, Load, Source};
use crate::problem::{Grid, Problem};

/// Axes in the order in which a domain has them, and cells by theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Order<const D: usize> {
    /// By axis of the domain, that of the problem.
    axes: [usize; D],
    /// Cells of the problem along its axes.
    cells: [usize; D],
}

impl<const D: usize> Order<D> {
    /// One of the axes first, then the others as they are.
    pub(crate) fn with_first(axis: usize, grid: &Grid<D>) -> Self {
        let axes = std::array::from_fn(|place| match place {
            0 => axis,
            _ if place <= axis => place - 1,
            _ => place,
        });
        Self { axes, cells: grid.cells }
    }

    /// Whether nothing moves.
    fn is_identity(&self) -> bool {
        self.axes.is_sorted()
    }

    /// Place along `from`, of which the first runs fastest, to that along `to`: the same axes in another order.
    fn moved(&self, index: usize, from: &[usize], to: &[usize]) -> usize {
        let mut along = [0; D];
        let mut rest = index;
        for &axis in from {
            along[axis] = rest % self.cells[axis];
            rest /= self.cells[axis];
        }
        to.iter().rev().fold(0, |index, &axis| index * self.cells[axis] + along[axis])
    }

    /// A cell of the problem in the domain.
    pub(crate) fn inner(&self, cell: usize) -> usize {
        self.moved(cell, &std::array::from_fn::<_, D, _>(|axis| axis), &self.axes)
    }

    /// A cell of the domain in the problem.
    pub(crate) fn outer(&self, cell: usize) -> usize {
        self.moved(cell, &self.axes, &std::array::from_fn::<_, D, _>(|axis| axis))
    }

    /// A face of a side across an axis of the problem, in the domain.
    fn inner_face(&self, axis: usize, face: usize) -> usize {
        let others = |axes: [usize; D]| axes.into_iter().filter(|own| *own != axis).collect();
        let [from, to]: [Vec<usize>; 2] = [std::array::from_fn(|own| own), self.axes].map(others);
        self.moved(face, &from, &to)
    }

    /// Values by cell of the problem, by cell of the domain; as they are unless there are as many as cells.
    pub(crate) fn arranged<V: Copy>(&self, values: &[V]) -> Vec<V> {
        if self.is_identity() || values.len() != self.cells.iter().product() {
            return values.to_vec();
        }
        (0..values.len()).map(|cell| values[self.outer(cell)]).collect()
    }

    /// Values by cell of the domain, by cell of the problem.
    pub(crate) fn restored<V: Copy>(&self, values: Vec<V>) -> Vec<V> {
        if self.is_identity() || values.len() != self.cells.iter().product() {
            return values;
        }
        (0..values.len()).map(|cell| values[self.inner(cell)]).collect()
    }

    /// A grid as a domain has it.
    pub(crate) fn grid(&self, own: &Grid<D>) -> Grid<D> {
        Grid {
            cells: self.axes.map(|axis| own.cells[axis]),
            spacing: self.axes.map(|axis| own.spacing[axis]),
        }
    }

    /// A sound problem as a domain has it. Fields keep their names, and accelerations are along the problem's axes.
    pub(crate) fn problem(&self, own: &Problem<D>) -> Problem<D> {
        if self.is_identity() {
            return own.clone();
        }
        let of_axis = |axis: usize| self.axes.iter().position(|own| *own == axis).unwrap_or(axis);
        let boundary = |axis: usize, own: &Boundary| {
            let Boundary::ByFace(pairs) = own else { return own.clone() };
            let by_face = |conditions: &Vec<Condition>| {
                let mut all = conditions.clone();
                for (face, condition) in conditions.iter().enumerate() {
                    all[self.inner_face(axis, face)] = *condition;
                }
                all
            };
            Boundary::ByFace(pairs.iter().map(by_face).collect())
        };
        let mut media = own.media.clone();
        for (medium, before) in media.iter_mut().zip(&own.media) {
            medium.pairs = self.axes.iter().map(|&axis| before.pairs[axis].clone()).collect();
        }
        let load = |load: &Load| {
            let faces = load.faces.iter();
            let faces = faces.map(|&(face, share)| (self.inner_face(load.axis, face), share));
            Load { axis: of_axis(load.axis), faces: faces.collect(), ..load.clone() }
        };
        let source = |source: &Source| {
            let cells = source.cells.iter().map(|&(cell, share)| (self.inner(cell), share));
            Source { cells: cells.collect(), ..source.clone() }
        };
        let initial_stress = own.initial_stress.clone();
        Problem {
            grid: self.grid(&own.grid),
            media,
            of_cell: self.arranged(&own.of_cell),
            boundaries: self
                .axes
                .map(|axis| own.boundaries[axis].each_ref().map(|side| boundary(axis, side))),
            loads: own.loads.iter().map(load).collect(),
            sources: own.sources.iter().map(source).collect(),
            initial_stress: initial_stress.map(|(axis, stress)| (of_axis(axis), stress)),
            ..own.clone()
        }
    }
}
