//! Interlayers of a domain: their state from outside.

use super::interfaces::Site;
use super::{Domain, SolverReal};
use crate::solid::interlayers::{MEMORY, cell_in_front, first_non_finite, memory_at_start};
use crate::solid::ledger::EnergySums;
use models::solid::waves::Field;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// V and S of all faces with interlayers in front of own cells: by layer across the last axis, axis of the face, cell
    /// behind it, and pair of waves.
    pub fn interlayer_memory(&self) -> Vec<[T; MEMORY]> {
        self.interlayers().into_iter().map(|own| own.1).collect()
    }

    /// The same memories with their places: the axis of the face, the number of the own cell behind it, the pair of waves.
    pub(crate) fn interlayers(&self) -> Vec<([usize; 3], [T; MEMORY])> {
        let sites = self.interfaces.own_sites(&self.layout).into_iter();
        let own = |site: Site| {
            let cell = self.layout.own_number(site.cell)?;
            Some(([site.axis, cell, site.pair], self.interfaces.get(&site)))
        };
        sites.filter_map(own).collect()
    }

    /// Sets them from such a list, as far as it goes.
    pub fn set_interlayer_memory(&mut self, memory: &mut impl Iterator<Item = [T; MEMORY]>) {
        for (site, own) in self.interfaces.own_sites(&self.layout).iter().zip(memory) {
            self.interfaces.set(site, own);
        }
        self.interfaces.copy_to_other_places(&self.layout);
    }

    /// Lets interlayers move with the cells beside them, V being the mean of their velocities, without stress: so that a
    /// rigid motion stays one.
    pub fn initialise_interlayers(&mut self) {
        let (cells, layout) = (self.grid.cells, self.layout.clone());
        let place = |field: Field| self.place(field);
        let value = |field: Field, cell: usize| {
            place(field).map_or(T::ZERO, |place| self.at(layout.own_cell(cell), place))
        };
        let memory = self.interlayers_at_start(&cells, |cell| cell, value);
        self.set_interlayer_memory(&mut memory.into_iter());
    }

    /// The memories of [`Self::initialise_interlayers`], where own cells are cells of a grid with so many, in which fields
    /// have these values.
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

    /// The first interlayer whose memory is not finite: a field of its pair, and the own cell behind it.
    pub(super) fn first_non_finite_interlayer(&self) -> Option<(Field, usize)> {
        self.interlayers().into_iter().find_map(|([axis, cell, pair], memory)| {
            let pair = &self.materials.media[0].pairs[axis][pair];
            Some((first_non_finite(pair, memory)?, cell))
        })
    }

    /// Adds the energy of interlayers in front of own cells.
    pub(super) fn add_interlayer_energy(&self, sums: &mut EnergySums) {
        let area = self.grid.spacing.map(|spacing| self.grid.volume() / spacing);
        self.interfaces.add_energy(&self.layout, area, sums);
    }
}
