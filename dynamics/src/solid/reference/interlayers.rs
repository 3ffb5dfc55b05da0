//! Faces with interlayers: history variables for each face and wave pair.

use super::sweep::GridLine;
use crate::simd::Real;
use crate::solid::boundary::Boundary;
use crate::solid::interface::Interlayer;
use crate::solid::interlayers::{
    HISTORY_VARIABLES, interlayer_energy, lower_neighbour, non_finite_field, stress_free_history,
};
use crate::solid::ledger::EnergySums;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use models::interface::elastic::ElasticInterlayer;
use models::solid::waves::{SolidField, VelocityStressPair};

/// A face with an interlayer, for one wave pair.
#[derive(Clone)]
struct InterlayerFace<T> {
    axis: usize,
    pair: usize,
    /// Cell above the face.
    cell: usize,
    law: ElasticInterlayer<T>,
    history: [T; HISTORY_VARIABLES],
}

/// All interlayers, ordered by layer across the last axis, axis of the face, cell above it, and wave pair.
#[derive(Clone)]
pub(super) struct InterlayerFaces<T, const D: usize> {
    faces: Vec<InterlayerFace<T>>,
    /// By axis and cell above the face, index in `faces` of the first wave pair of the face, `None` at faces without
    /// interlayer; empty if the axis has no interlayers.
    first_pair: [Vec<Option<usize>>; D],
    is_periodic: [bool; D],
}

impl<T: Real, const D: usize> InterlayerFaces<T, D> {
    /// Creates the interlayers of a problem, at rest.
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
                    if !own.has_interlayer_at(cell / stride % grid.cells[axis]) {
                        continue;
                    }
                    *number = Some(all.len());
                    all.extend(own.laws.iter().enumerate().map(|(pair, law)| InterlayerFace {
                        axis,
                        pair,
                        cell,
                        law: law.to_number(),
                        history: [T::ZERO; HISTORY_VARIABLES],
                    }));
                }
            }
        }
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        Self { faces: all, first_pair: first, is_periodic }
    }

    /// Returns the history variables of all interlayers: mean velocity V and mean traction S.
    pub(super) fn history(&self) -> Vec<[T; HISTORY_VARIABLES]> {
        self.faces.iter().map(|own| own.history).collect()
    }

    /// Sets the history variables of all interlayers: mean velocity V and mean traction S.
    pub(super) fn set_history(&mut self, history: &[[T; HISTORY_VARIABLES]]) {
        self.faces.iter_mut().zip(history).for_each(|(face, own)| face.history = *own);
    }

    /// Computes the initial history variables of all interlayers from the field values of the adjacent cells.
    pub(super) fn initial_history(
        &self,
        problem: &Problem<D>,
        value: impl Fn(SolidField, usize) -> T,
    ) -> Vec<[T; HISTORY_VARIABLES]> {
        let history = |face: &InterlayerFace<T>| {
            let field = wave_pair(face, problem).velocity;
            let front = lower_neighbour(&problem.grid.cells, face.axis, face.cell);
            stress_free_history([front, face.cell].map(|cell| value(field, cell)))
        };
        self.faces.iter().map(history).collect()
    }

    /// Sets history variables of magnitude below `limit` to zero.
    pub(super) fn flush_below(&mut self, limit: T) {
        for value in self.faces.iter_mut().flat_map(|face| &mut face.history) {
            *value = value.flush_below(limit);
        }
    }

    /// Adds the energy of all interlayers to `sums`.
    pub(super) fn add_energy(&self, problem: &Problem<D>, sums: &mut EnergySums) {
        for face in &self.faces {
            let area = problem.grid.volume() / problem.grid.spacing[face.axis];
            let [kinetic, stored] = interlayer_energy(&face.law, face.history, area);
            sums.interlayer_kinetic.add(kinetic);
            sums.interlayer_stored.add(stored);
        }
    }

    /// Returns the first interlayer with a non-finite history variable: the corresponding field and the cell above the
    /// face.
    pub(super) fn non_finite_field(&self, problem: &Problem<D>) -> Option<(SolidField, usize)> {
        self.faces.iter().find_map(|face| {
            Some((non_finite_field(wave_pair(face, problem), face.history)?, face.cell))
        })
    }

    /// Returns the interlayers of a line, ghosts included.
    pub(super) fn line_interlayers(
        &self,
        pair: usize,
        line: GridLine,
    ) -> Vec<Interlayer<T, ElasticInterlayer<T>>> {
        if self.first_pair[line.axis].is_empty() {
            return Vec::new();
        }
        let (count, ghosts) = (line.count as isize, GHOSTS as isize);
        let at = |place: isize| {
            let around = match self.is_periodic[line.axis] {
                true => place.rem_euclid(count),
                false => place,
            };
            let around = usize::try_from(around).ok().filter(|own| *own < line.count)?;
            let face = &self.faces[self.first_pair[line.axis][line.cell(around)]? + pair];
            let upper_cell = (place + ghosts) as usize;
            Some(Interlayer { upper_cell, law: face.law, history: face.history })
        };
        (-ghosts..count + ghosts).filter_map(at).collect()
    }

    /// Stores the history variables of the interlayers of a line after its sweep.
    pub(super) fn store_line(
        &mut self,
        pair: usize,
        line: GridLine,
        interlayers: &[Interlayer<T, ElasticInterlayer<T>>],
    ) {
        // Interlayers among the ghosts are copies.
        let own = GHOSTS..GHOSTS + line.count;
        for interlayer in interlayers.iter().filter(|other| own.contains(&other.upper_cell)) {
            let cell = line.cell(interlayer.upper_cell - GHOSTS);
            if let Some(first) = self.first_pair[line.axis][cell] {
                self.faces[first + pair].history = interlayer.history;
            }
        }
    }
}

fn wave_pair<'a, T, const D: usize>(
    face: &InterlayerFace<T>,
    problem: &'a Problem<D>,
) -> &'a VelocityStressPair {
    &problem.media[0].pairs[face.axis][face.pair]
}
