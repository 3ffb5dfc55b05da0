//! Interlayers of a domain: input and output of their history variables.

use super::interlayer_faces::HistorySite;
use super::{Domain, SolverReal};
use crate::solid::interlayers::{
    HISTORY_VARIABLES, lower_neighbour, non_finite_field, stress_free_history,
};
use crate::solid::ledger::EnergySums;
use models::solid::waves::SolidField;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the history variables (mean velocity V, m/s, and mean traction S, Pa) of all interlayers at the lower
    /// faces of owned cells: by layer across the last axis, axis normal to the face, cell above the face, and pair of
    /// waves.
    pub fn interlayer_history(&self) -> Vec<[T; HISTORY_VARIABLES]> {
        self.located_history().into_iter().map(|own| own.1).collect()
    }

    /// Returns the history variables of [`Self::interlayer_history`] with axis normal to the face, index of the owned
    /// cell above the face, and pair of waves.
    pub(crate) fn located_history(&self) -> Vec<([usize; 3], [T; HISTORY_VARIABLES])> {
        let sites = self.interfaces.owned_sites(&self.layout).into_iter();
        let own = |site: HistorySite| {
            let cell = self.layout.owned_index(site.cell)?;
            Some(([site.axis, cell, site.pair], self.interfaces.history(&site)))
        };
        sites.filter_map(own).collect()
    }

    /// Sets the history variables in the order of [`Self::interlayer_history`]; if `memory` is shorter, the remaining
    /// ones are unchanged.
    pub fn set_interlayer_history(
        &mut self,
        memory: &mut impl Iterator<Item = [T; HISTORY_VARIABLES]>,
    ) {
        for (site, own) in self.interfaces.owned_sites(&self.layout).iter().zip(memory) {
            self.interfaces.set_history(site, own);
        }
        self.interfaces.synchronise_copies(&self.layout);
    }

    /// Initialises interlayers with the mean velocity of the adjacent cells and without stress, so that a rigid motion
    /// causes no waves.
    pub fn initialise_interlayers(&mut self) {
        let (cells, layout) = (self.grid.cells, self.layout.clone());
        let place = |field: SolidField| self.field_offset(field);
        let value = |field: SolidField, cell: usize| {
            place(field).map_or(T::ZERO, |place| self.value_at(layout.local_cell(cell), place))
        };
        let memory = self.initial_interlayer_history(&cells, |cell| cell, value);
        self.set_interlayer_history(&mut memory.into_iter());
    }

    /// Returns the initial history variables of [`Self::initialise_interlayers`], from the values `value` of fields in
    /// a grid of `cells` cells, in which an owned cell has the index `in_grid(cell)`.
    pub(crate) fn initial_interlayer_history(
        &self,
        cells: &[usize; D],
        in_grid: impl Fn(usize) -> usize,
        value: impl Fn(SolidField, usize) -> T,
    ) -> Vec<[T; HISTORY_VARIABLES]> {
        let at_start = |([axis, cell, pair], _): ([usize; 3], [T; HISTORY_VARIABLES])| {
            let field = self.materials.media[0].pairs[axis][pair].velocity;
            let around = [lower_neighbour(cells, axis, in_grid(cell)), in_grid(cell)];
            stress_free_history(around.map(|cell| value(field, cell)))
        };
        self.located_history().into_iter().map(at_start).collect()
    }

    /// Returns the first interlayer with a non-finite history variable: the corresponding field of its pair of waves,
    /// and the owned cell above it.
    pub(super) fn first_non_finite_interlayer(&self) -> Option<(SolidField, usize)> {
        self.located_history().into_iter().find_map(|([axis, cell, pair], memory)| {
            let pair = &self.materials.media[0].pairs[axis][pair];
            Some((non_finite_field(pair, memory)?, cell))
        })
    }

    /// Adds the energy of interlayers at the lower faces of owned cells.
    pub(super) fn add_interlayer_energy(&self, sums: &mut EnergySums) {
        let area = self.grid.spacing.map(|spacing| self.grid.volume() / spacing);
        self.interfaces.add_energy(&self.layout, area, sums);
    }
}
