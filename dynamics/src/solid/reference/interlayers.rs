//! Faces with memory: one memory for each face and pair of waves.

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

/// A face with an interlayer, as a pair of waves sees it.
#[derive(Clone)]
struct Face<T> {
    axis: usize,
    pair: usize,
    /// The cell behind it.
    cell: usize,
    law: ElasticInterlayer<T>,
    memory: [T; MEMORY],
}

/// All of them: by layer across the last axis, axis of the face, cell behind it, and pair of waves.
#[derive(Clone)]
pub(super) struct Faces<T, const D: usize> {
    all: Vec<Face<T>>,
    /// By axis and cell behind the face, the number of its first pair; empty where there is none across the axis.
    first: [Vec<Option<usize>>; D],
    is_periodic: [bool; D],
}

impl<T: Real, const D: usize> Faces<T, D> {
    /// Those of a problem, at rest.
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

    /// V and S.
    pub(super) fn memory(&self) -> Vec<[T; MEMORY]> {
        self.all.iter().map(|own| own.memory).collect()
    }

    /// Sets as many.
    pub(super) fn set_memory(&mut self, memory: &[[T; MEMORY]]) {
        self.all.iter_mut().zip(memory).for_each(|(face, own)| face.memory = *own);
    }

    /// Memories of interlayers that move with the cells beside them, in which fields have these values.
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

    /// Sets to zero what is near the subnormal numbers.
    pub(super) fn flush_below(&mut self, limit: T) {
        for value in self.all.iter_mut().flat_map(|face| &mut face.memory) {
            *value = value.flush_below(limit);
        }
    }

    /// Adds their energy.
    pub(super) fn add_energy(&self, problem: &Problem<D>, sums: &mut EnergySums) {
        for face in &self.all {
            let area = problem.grid.volume() / problem.grid.spacing[face.axis];
            let [kinetic, stored] = energy_of(&face.law, face.memory, area);
            sums.interlayer_kinetic.add(kinetic);
            sums.interlayer_stored.add(stored);
        }
    }

    /// The first one whose memory is not finite: a field of its pair, and the cell behind it.
    pub(super) fn first_non_finite(&self, problem: &Problem<D>) -> Option<(Field, usize)> {
        self.all.iter().find_map(|face| {
            Some((first_non_finite(pair_of(face, problem), face.memory)?, face.cell))
        })
    }

    /// The interlayers that the sweep of a line with its ghosts sees.
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

    /// Takes over their memories after the sweep.
    pub(super) fn keep(
        &mut self,
        pair: usize,
        line: LineOfCells,
        interlayers: &[Interlayer<T, ElasticInterlayer<T>>],
    ) {
        // What stands among the ghosts is a copy.
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
