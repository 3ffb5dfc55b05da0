//! Faces with memory: memory variables for each face and wave pair.

use super::sweep::LineOfCells;
use crate::simd::Real;
use crate::solid::boundary::Boundary;
use crate::solid::interface::Interlayer;
use crate::solid::interlayers::{
    MEMORY, cell_in_front, energy_of, first_non_finite, memory_at_start,
};
use crate::solid::ledger::EnergySums;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use models::interface::elastic::ElasticInterlayer;
use models::solid::waves::{Field, Pair};

/// A face with an interlayer, for one wave pair.
#[derive(Clone)]
struct Face<T> {
    axis: usize,
    pair: usize,
    /// Cell above the face.
    cell: usize,
    law: ElasticInterlayer<T>,
    memory: [T; MEMORY],
}

/// All interlayers, ordered by layer across the last axis, axis of the face, cell above it, and wave pair.
#[derive(Clone)]
pub(super) struct Faces<T, const D: usize> {
    all: Vec<Face<T>>,
    /// By axis and cell above the face, index of its first wave pair; empty if the axis has no interlayers.
    first: [Vec<Option<usize>>; D],
    is_periodic: [bool; D],
}

impl<T: Real, const D: usize> Faces<T, D> {
    /// Interlayers of a problem, at rest.
    pub(super) fn new(problem: &Problem<D>) -> Self {
        let (grid, layer) = (&problem.grid, problem.grid.faces(D - 1));
        let across: [_; D] = std::array::from_fn(|axis| problem.interlayers_across(axis));
        let mut all = Vec::new();
        let mut first = across.map(|own| vec![None; if own.is_some() { grid.count() } else { 0 }]);
        for start in (0..grid.count()).step_by(layer) {
            for (axis, own) in across.iter().enumerate() {
                let Some(own) = own else { continue };
                let stride: usize = grid.cells[..axis].iter().product();
                for (index, number) in first[axis][start..start + layer].iter_mut().enumerate() {
                    let cell = start + index;
                    if !own.is_in_front_of(cell / stride % grid.cells[axis]) {
                        continue;
                    }
                    *number = Some(all.len());
                    all.extend(own.laws.iter().enumerate().map(|(pair, law)| Face {
                        axis,
                        pair,
                        cell,
                        law: law.to_number(),
                        memory: [T::ZERO; MEMORY],
                    }));
                }
            }
        }
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        Self { all, first, is_periodic }
    }

    /// Returns V and S of all interlayers.
    pub(super) fn memory(&self) -> Vec<[T; MEMORY]> {
        self.all.iter().map(|own| own.memory).collect()
    }

    /// Sets V and S of all interlayers.
    pub(super) fn set_memory(&mut self, memory: &[[T; MEMORY]]) {
        self.all.iter_mut().zip(memory).for_each(|(face, own)| face.memory = *own);
    }

    /// Computes the initial memory of all interlayers from the field values of the adjacent cells.
    pub(super) fn at_start(
        &self,
        problem: &Problem<D>,
        value: impl Fn(Field, usize) -> T,
    ) -> Vec<[T; MEMORY]> {
        let memory = |face: &Face<T>| {
            let field = pair_of(face, problem).velocity;
            let front = cell_in_front(&problem.grid.cells, face.axis, face.cell);
            memory_at_start([front, face.cell].map(|cell| value(field, cell)))
        };
        self.all.iter().map(memory).collect()
    }

    /// Sets memory variables of magnitude below `limit` to zero.
    pub(super) fn flush_below(&mut self, limit: T) {
        for value in self.all.iter_mut().flat_map(|face| &mut face.memory) {
            *value = value.flush_below(limit);
        }
    }

    /// Adds the energy of all interlayers to `sums`.
    pub(super) fn add_energy(&self, problem: &Problem<D>, sums: &mut EnergySums) {
        for face in &self.all {
            let area = problem.grid.volume() / problem.grid.spacing[face.axis];
            let [kinetic, stored] = energy_of(&face.law, face.memory, area);
            sums.interlayer_kinetic.add(kinetic);
            sums.interlayer_stored.add(stored);
        }
    }

    /// Returns field and cell above the face of the first interlayer with non-finite memory.
    pub(super) fn first_non_finite(&self, problem: &Problem<D>) -> Option<(Field, usize)> {
        self.all.iter().find_map(|face| {
            Some((first_non_finite(pair_of(face, problem), face.memory)?, face.cell))
        })
    }

    /// Returns the interlayers of a line, ghosts included.
    pub(super) fn of_line(
        &self,
        pair: usize,
        line: LineOfCells,
    ) -> Vec<Interlayer<T, ElasticInterlayer<T>>> {
        if self.first[line.axis].is_empty() {
            return Vec::new();
        }
        let (count, ghosts) = (line.count as isize, GHOSTS as isize);
        let at = |place: isize| {
            let around = match self.is_periodic[line.axis] {
                true => place.rem_euclid(count),
                false => place,
            };
            let around = usize::try_from(around).ok().filter(|own| *own < line.count)?;
            let face = &self.all[self.first[line.axis][line.cell(around)]? + pair];
            let place = (place + ghosts) as usize;
            Some(Interlayer { place, law: face.law, memory: face.memory })
        };
        (-ghosts..count + ghosts).filter_map(at).collect()
    }

    /// Stores the memory of the interlayers of a line after its sweep.
    pub(super) fn keep(
        &mut self,
        pair: usize,
        line: LineOfCells,
        interlayers: &[Interlayer<T, ElasticInterlayer<T>>],
    ) {
        // Interlayers among the ghosts are copies.
        let own = GHOSTS..GHOSTS + line.count;
        for interlayer in interlayers.iter().filter(|other| own.contains(&other.place)) {
            let cell = line.cell(interlayer.place - GHOSTS);
            if let Some(first) = self.first[line.axis][cell] {
                self.all[first + pair].memory = interlayer.memory;
            }
        }
    }
}

fn pair_of<'a, T, const D: usize>(face: &Face<T>, problem: &'a Problem<D>) -> &'a Pair {
    &problem.media[0].pairs[face.axis][face.pair]
}
