//! Interlayers of a domain: their state from outside, and their sweeps.

use super::interfaces::MEMORY;
use super::{Domain, SolverReal};
use crate::solid::interface::Interlayer;
use crate::solid::ledger::Energy;
use crate::solid::reconstruction::GHOSTS;
use models::interface::elastic::ElasticInterlayer;
use models::solid::waves::Field;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// V and S of all faces with interlayers: by layer across the last axis, axis of the face, cell behind it, and pair of
    /// waves.
    pub fn interlayer_memory(&self) -> Vec<[T; MEMORY]> {
        let layers = self.layout.own_layers();
        let sites = layers.flat_map(|layer| self.interfaces.sites(&self.layout, layer));
        sites.map(|site| self.interfaces.get(&site)).collect()
    }

    /// Sets them from such a list, as far as it goes.
    pub fn set_interlayer_memory(&mut self, memory: &mut impl Iterator<Item = [T; MEMORY]>) {
        for layer in self.layout.own_layers() {
            for site in self.interfaces.sites(&self.layout, layer) {
                let Some(own) = memory.next() else { break };
                self.interfaces.set(&site, own);
            }
        }
        self.interfaces.copy_to_other_places(&self.layout);
    }

    /// Lets interlayers move with the cells beside them, V being the mean of their velocities, without stress: so that a
    /// rigid motion stays one.
    pub fn initialise_interlayers(&mut self) {
        let own = self.layout.own_cells();
        let place = |field: Field| self.place(field);
        let value = |field: Field, cell: usize| {
            place(field).map_or(T::ZERO, |place| self.at(own.start + cell, place))
        };
        let memory = self.interlayers_at_start(0, self.grid.cells[D - 1], value);
        self.set_interlayer_memory(&mut memory.into_iter());
    }

    /// The memories of [`Self::initialise_interlayers`], where the own cells begin with `first` of a domain with so many
    /// layers, in whose cells fields have these values.
    pub(crate) fn interlayers_at_start(
        &self,
        first: usize,
        layers: usize,
        value: impl Fn(Field, usize) -> T,
    ) -> Vec<[T; MEMORY]> {
        let own = self.layout.own_cells();
        let mut memory = Vec::new();
        for layer in self.layout.own_layers() {
            for site in self.interfaces.sites(&self.layout, layer) {
                let stride: usize = self.layout.cells[..site.axis].iter().product();
                let count = if site.axis + 1 == D { layers } else { self.layout.cells[site.axis] };
                let cell = first + site.cell - own.start;
                // In front of the first one is the last one.
                let before = match cell / stride % count {
                    0 => cell + (count - 1) * stride,
                    _ => cell - stride,
                };
                let field = self.materials.media[0].pairs[site.axis][site.pair].velocity;
                memory.push([T::HALF * (value(field, before) + value(field, cell)), T::ZERO]);
            }
        }
        memory
    }

    /// The first interlayer whose memory is not finite: a field of its pair, and the cell behind it.
    pub(super) fn first_non_finite_interlayer(&self) -> Option<(Field, usize)> {
        let layers = self.layout.own_layers();
        let mut sites = layers.flat_map(|layer| self.interfaces.sites(&self.layout, layer));
        let broken = sites.find_map(|site| {
            let [velocity, stress] = self.interfaces.get(&site).map(|own| own.wide().is_finite());
            let pair = &self.materials.media[0].pairs[site.axis][site.pair];
            match (velocity, stress) {
                (true, true) => None,
                (false, _) => Some((pair.velocity, site.cell)),
                (true, false) => Some((pair.stress, site.cell)),
            }
        });
        broken.map(|(field, cell)| (field, cell - self.layout.own_cells().start))
    }

    /// Adds the energy of interlayers to those of own layers.
    pub(super) fn add_interlayer_energy(&self, energies: &mut [Energy]) {
        let area = self.grid.spacing.map(|spacing| self.grid.volume() / spacing);
        for (layer, energy) in self.layout.own_layers().zip(energies) {
            self.interfaces.add_energy(&self.layout, layer, area, energy);
        }
    }

    /// The interlayers of a line for a pair of waves, whose first cell is at a coordinate along the axis, ghosts included:
    /// for the sweep cell by cell.
    pub(super) fn interlayers_of_line(
        &self,
        pair: (usize, usize),
        line: (usize, usize),
        first: usize,
        length: usize,
    ) -> Vec<Interlayer<T, ElasticInterlayer<T>>> {
        let own = |index: usize| {
            let place = (first + index) as isize - GHOSTS as isize;
            let (law, memory, _) = self.interfaces.at(&self.layout, pair, place, line)?;
            Some(Interlayer { place: index, law, memory })
        };
        (0..length + 2 * GHOSTS).filter_map(own).collect()
    }

    /// Takes over their memories, as far as they are the own ones of faces of the line.
    pub(super) fn keep_interlayers(
        &mut self,
        pair: (usize, usize),
        line: (usize, usize),
        first: usize,
        (length, interlayers): (usize, Vec<Interlayer<T, ElasticInterlayer<T>>>),
    ) {
        for own in interlayers {
            if (GHOSTS..GHOSTS + length).contains(&own.place) {
                let place = first + own.place - GHOSTS;
                self.interfaces.set_at(&self.layout, pair, place, line, own.memory);
            }
        }
    }
}
