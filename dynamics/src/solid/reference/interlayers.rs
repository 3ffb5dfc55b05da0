//! Interlayers of the reference solver: faces, laws and history variables.

use super::sweep::GridLine;
use crate::simd::Real;
use crate::solid::boundary::Boundary;
use crate::solid::fluid_network::{FluidNetwork, NetworkGrid};
use crate::solid::interface::Interlayer;
use crate::solid::interlayers::{
    InterlayerFace, InterlayerLaw, face_energy, initialise_history, lower_neighbour,
};
use crate::solid::ledger::InterlayerSums;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use models::solid::waves::SolidField;

/// All interlayers, in the order of [`Problem::interlayer_faces`].
#[derive(Clone)]
pub(super) struct InterlayerFaces<T, const D: usize> {
    faces: Vec<InterlayerFace>,
    history: Vec<T>,
    /// Laws of interlayers, by axis.
    laws: [Vec<InterlayerLaw<T>>; D],
    /// By axis and cell, index in `faces` of its lower face, `None` at faces without interlayer; empty if the axis has
    /// no interlayers.
    lower_faces: [Vec<Option<usize>>; D],
    is_periodic: [bool; D],
    /// Network of the saturated faces, and their indices in `faces`; `None` if there are none.
    fluid: Option<(FluidNetwork<T>, Vec<usize>)>,
}

impl<T: Real, const D: usize> InterlayerFaces<T, D> {
    /// Creates the interlayers of a problem, at rest.
    pub(super) fn new(problem: &Problem<D>) -> Self {
        let across: [_; D] = std::array::from_fn(|axis| problem.interlayers_across(axis));
        let faces = problem.interlayer_faces();
        let count = problem.grid.count();
        let mut lower_faces = across.map(|own| vec![None; if own.is_some() { count } else { 0 }]);
        for (index, face) in faces.iter().enumerate() {
            lower_faces[face.axis][face.cell] = Some(index);
        }
        let end = faces.last().map_or(0, |face| face.history.end);
        let laws = across.map(|own| {
            own.map_or(Vec::new(), |own| own.laws.iter().map(|law| law.map(T::from_f64)).collect())
        });
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        let mut interlayers = Self {
            faces,
            history: vec![T::ZERO; end],
            laws,
            lower_faces,
            is_periodic,
            fluid: None,
        };
        interlayers.fluid = interlayers.fluid_network(problem);
        interlayers
    }

    /// Returns the network of the saturated faces; `None` if there are none.
    fn fluid_network(&self, problem: &Problem<D>) -> Option<(FluidNetwork<T>, Vec<usize>)> {
        if !problem.has_fluid() {
            return None;
        }
        let grid = NetworkGrid {
            cells: [problem.grid.cells[0], problem.grid.cells[1]],
            spacing: [problem.grid.spacing[0], problem.grid.spacing[1]],
            is_periodic: [self.is_periodic[0], self.is_periodic[1]],
            is_open: [0, 1].map(|axis| {
                let is_open = !self.is_periodic[axis] && problem.has_open_layers_along(axis);
                [is_open; 2]
            }),
        };
        let law = |face: &InterlayerFace| match self.laws[face.axis][face.law] {
            InterlayerLaw::Plane(law, _) if law.fluid().is_some() => Some(law),
            _ => None,
        };
        let saturated = (0..self.faces.len()).filter(|index| law(&self.faces[*index]).is_some());
        let saturated: Vec<usize> = saturated.collect();
        let faces = saturated.iter().filter_map(|index| {
            let face = &self.faces[*index];
            let coordinates = [face.cell % grid.cells[0], face.cell / grid.cells[0]];
            Some(((face.axis, coordinates), law(face)?))
        });
        Some((FluidNetwork::new(faces, &grid, problem.step), saturated))
    }

    /// Advances the flow of the fluid along saturated interlayers by `step`, s.
    pub(super) fn advance_fluid(&mut self, step: f64) {
        let Some((network, saturated)) = &mut self.fluid else { return };
        for (history, index) in network.history_mut().iter_mut().zip(&*saturated) {
            let range = self.faces[*index].history.clone();
            history[..range.len()].copy_from_slice(&self.history[range]);
        }
        network.advance(step);
        for (history, index) in network.history_mut().iter().zip(&*saturated) {
            let range = self.faces[*index].history.clone();
            self.history[range.clone()].copy_from_slice(&history[..range.len()]);
        }
    }

    /// Returns the history variables of all interlayers.
    pub(super) fn history(&self) -> &[T] {
        &self.history
    }

    /// Sets the history variables of all interlayers.
    pub(super) fn set_history(&mut self, history: &[T]) {
        self.history.copy_from_slice(history);
    }

    /// Sets the history variables of all interlayers to zero.
    pub(super) fn clear(&mut self) {
        self.history.fill(T::ZERO);
    }

    /// Initialises all interlayers without stress, from the field values of the adjacent cells.
    pub(super) fn initialise(
        &mut self,
        problem: &Problem<D>,
        value: impl Fn(SolidField, usize) -> T,
    ) {
        for face in &self.faces {
            let pairs = &problem.media[0].pairs[face.axis];
            let adjacent_cells =
                [lower_neighbour(&problem.grid.cells, face.axis, face.cell), face.cell];
            let velocity = |pair: usize, side: usize| {
                pairs.get(pair).map_or(T::ZERO, |pair| value(pair.velocity, adjacent_cells[side]))
            };
            let law = &self.laws[face.axis][face.law];
            let history = &mut self.history[face.history.clone()];
            initialise_history(law, pairs.len(), velocity, history);
        }
    }

    /// Sets history variables of magnitude below `limit` to zero.
    pub(super) fn flush_below(&mut self, limit: T) {
        for value in &mut self.history {
            *value = value.flush_below(limit);
        }
    }

    /// Returns the sums of the energies of all interlayers.
    pub(super) fn sum_energies(&self, problem: &Problem<D>) -> InterlayerSums {
        let mut sums = InterlayerSums::default();
        for face in &self.faces {
            let area = problem.grid.volume() / problem.grid.spacing[face.axis];
            let law = self.laws[face.axis][face.law].map(T::to_f64);
            let history: Vec<f64> =
                self.history[face.history.clone()].iter().map(|own| own.to_f64()).collect();
            let pairs = problem.media[0].pairs[face.axis].len();
            sums.add(&face_energy(&law, pairs, &history), area);
        }
        sums
    }

    /// Returns the cell above the first interlayer with a non-finite history variable, and the velocity normal to the
    /// face.
    pub(super) fn first_non_finite(&self) -> Option<(SolidField, usize)> {
        self.faces.iter().find_map(|face| {
            let history = &self.history[face.history.clone()];
            let is_finite = history.iter().all(|own| own.to_f64().is_finite());
            (!is_finite).then_some((SolidField::Velocity(face.axis), face.cell))
        })
    }

    /// Whether there are interlayers normal to an axis.
    pub(super) fn has_interlayers_across(&self, axis: usize) -> bool {
        !self.lower_faces[axis].is_empty()
    }

    /// Returns the interlayers of a line, ghosts included.
    pub(super) fn line_interlayers(&self, line: GridLine) -> Vec<Interlayer<T, InterlayerLaw<T>>> {
        let (count, ghosts) = (line.count as isize, GHOSTS as isize);
        let interlayer_at = |position: isize| {
            let index = match self.is_periodic[line.axis] {
                true => position.rem_euclid(count),
                false => position,
            };
            let index = usize::try_from(index).ok().filter(|own| *own < line.count)?;
            let face = &self.faces[self.lower_faces[line.axis][line.cell(index)]?];
            let law = self.laws[line.axis][face.law];
            let history = self.history[face.history.clone()].to_vec();
            Some(Interlayer { upper_cell: (position + ghosts) as usize, law, history })
        };
        (-ghosts..count + ghosts).filter_map(interlayer_at).collect()
    }

    /// Stores the history variables of the interlayers of a line after its sweep; `holds_shear`: only those of normal
    /// components, since the sweep leaves shear waves unchanged.
    pub(super) fn store_line(
        &mut self,
        line: GridLine,
        interlayers: &[Interlayer<T, InterlayerLaw<T>>],
        holds_shear: bool,
    ) {
        // Interlayers among the ghosts are copies.
        let interior = GHOSTS..GHOSTS + line.count;
        for interlayer in interlayers.iter().filter(|other| interior.contains(&other.upper_cell)) {
            let cell = line.cell(interlayer.upper_cell - GHOSTS);
            if let Some(face) = self.lower_faces[line.axis][cell] {
                let normal = interlayer.law.normal_variable_count().filter(|_| holds_shear);
                let advanced = &interlayer.history[..normal.unwrap_or(interlayer.history.len())];
                let start = self.faces[face].history.start;
                self.history[start..start + advanced.len()].copy_from_slice(advanced);
            }
        }
    }
}
