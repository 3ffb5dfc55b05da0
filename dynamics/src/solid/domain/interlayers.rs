//! Interlayers of a domain: input and output of their history variables.

use super::interfaces::Site;
use super::{Domain, SolverReal};
use crate::solid::interlayers::{MEMORY, cell_in_front, first_non_finite, memory_at_start};
use crate::solid::ledger::EnergySums;
use models::solid::waves::Field;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns V and S of all interlayers at the lower faces of own cells: by layer across the last axis, axis of the
    /// face, upper cell, and pair of waves.
    pub fn interlayer_memory(&self) -> Vec<[T; MEMORY]> {
        self.interlayers().into_iter().map(|own| own.1).collect()
    }

    /// Returns the same history variables with axis of the face, index of the own cell above it, and pair of waves.
    pub(crate) fn interlayers(&self) -> Vec<([usize; 3], [T; MEMORY])> {
        let sites = self.interfaces.own_sites(&self.layout).into_iter();
        let own = |site: Site| {
            let cell = self.layout.own_number(site.cell)?;
            Some(([site.axis, cell, site.pair], self.interfaces.get(&site)))
        };
        sites.filter_map(own).collect()
    }

    /// Sets the history variables in the order of [`Self::interlayer_memory`]; if the list is shorter, the others are
    /// unchanged.
    pub fn set_interlayer_memory(&mut self, memory: &mut impl Iterator<Item = [T; MEMORY]>) {
        for (site, own) in self.interfaces.own_sites(&self.layout).iter().zip(memory) {
            self.interfaces.set(site, own);
        }
        self.interfaces.copy_to_other_places(&self.layout);
    }

    /// Initialises interlayers without stress and with V, the mean velocity of the adjacent cells, so that a rigid
    /// motion remains one.
    pub fn initialise_interlayers(&mut self) {
        let (cells, layout) = (self.grid.cells, self.layout.clone());
        let place = |field: Field| self.place(field);
        let value = |field: Field, cell: usize| {
            place(field).map_or(T::ZERO, |place| self.at(layout.own_cell(cell), place))
        };
        let memory = self.interlayers_at_start(&cells, |cell| cell, value);
        self.set_interlayer_memory(&mut memory.into_iter());
    }

    /// Returns the history variables of [`Self::initialise_interlayers`] from the field values `value` in a grid of
    /// `cells` cells, in which the index of an own cell is `in_grid(cell)`.
    pub(crate) fn interlayers_at_start(
        &self,
        cells: &[usize; D],
        in_grid: impl Fn(usize) -> usize,
        value: impl Fn(Field, usize) -> T,
    ) -> Vec<[T; MEMORY]> {
        let at_start = |([axis, cell, pair], _): ([usize; 3], [T; MEMORY])| {
            let field = self.materials.media[0].pairs[axis][pair].velocity;
            let around = [cell_in_front(cells, axis, in_grid(cell)), in_grid(cell)];
            memory_at_start(around.map(|cell| value(field, cell)))
        };
        self.interlayers().into_iter().map(at_start).collect()
    }

    /// Returns the first interlayer with a history variable that is not finite: a field of its pair, and the own cell
    /// above it.
    pub(super) fn first_non_finite_interlayer(&self) -> Option<(Field, usize)> {
        self.interlayers().into_iter().find_map(|([axis, cell, pair], memory)| {
            let pair = &self.materials.media[0].pairs[axis][pair];
            Some((first_non_finite(pair, memory)?, cell))
        })
    }

    /// Adds the energy of interlayers at the lower faces of own cells.
    pub(super) fn add_interlayer_energy(&self, sums: &mut EnergySums) {
        let area = self.grid.spacing.map(|spacing| self.grid.volume() / spacing);
        self.interfaces.add_energy(&self.layout, area, sums);
    }
}
