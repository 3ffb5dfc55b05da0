//! Interlayers of a domain: input and output of their history variables.

use super::{Domain, SolverReal};
use crate::solid::interlayers::{initialise_history, lower_neighbour};
use crate::solid::ledger::InterlayerSums;
use models::solid::waves::SolidField;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the history variables of all interlayers at the lower faces of owned cells: by layer across the last
    /// axis, axis normal to the face, and cell above the face. Their number and meaning is that of the laws of the
    /// axis.
    pub fn interlayer_history(&self) -> Vec<T> {
        let mut history = Vec::new();
        for site in self.interfaces.owned_sites(&self.layout) {
            history.extend(self.interfaces.history(&site));
        }
        history
    }

    /// Returns the faces of [`Self::interlayer_history`]: axis normal to the face, index of the owned cell above the
    /// face, and number of history variables.
    pub(crate) fn interlayer_faces(&self) -> Vec<[usize; 3]> {
        let sites = self.interfaces.owned_sites(&self.layout).into_iter();
        let face = |site: super::interlayer_faces::HistorySite| {
            let cell = self.layout.owned_index(site.cell)?;
            Some([site.axis, cell, self.interfaces.variables(site.axis)])
        };
        sites.filter_map(face).collect()
    }

    /// Sets the history variables in the order of [`Self::interlayer_history`]; if `history` is shorter, the remaining
    /// ones are unchanged.
    pub fn set_interlayer_history(&mut self, history: &mut impl Iterator<Item = T>) {
        for site in self.interfaces.owned_sites(&self.layout) {
            self.interfaces.set_history(&site, history);
        }
        self.interfaces.synchronise_copies(&self.layout);
    }

    /// Initialises interlayers with the mean velocity of the adjacent cells and without stress, so that a rigid motion
    /// causes no waves.
    pub fn initialise_interlayers(&mut self) {
        let (cells, layout) = (self.grid.cells, self.layout.clone());
        let offset = |field: SolidField| self.field_offset(field);
        let value = |field: SolidField, cell: usize| {
            offset(field).map_or(T::ZERO, |offset| self.value_at(layout.local_cell(cell), offset))
        };
        let history = self.initial_interlayer_history(&cells, |cell| cell, value);
        self.set_interlayer_history(&mut history.into_iter());
    }

    /// Returns the initial history variables of [`Self::initialise_interlayers`], from the values `value` of fields in
    /// a grid of `cells` cells, in which an owned cell has the index `in_grid(cell)`.
    pub(crate) fn initial_interlayer_history(
        &self,
        cells: &[usize; D],
        grid_index: impl Fn(usize) -> usize,
        value: impl Fn(SolidField, usize) -> T,
    ) -> Vec<T> {
        let mut history = Vec::new();
        for site in self.interfaces.owned_sites(&self.layout) {
            let start = history.len();
            history.resize(start + self.interfaces.variables(site.axis), T::ZERO);
            let cell = self.layout.owned_index(site.cell).map(&grid_index);
            let (Some(cell), Some(law)) = (cell, self.interfaces.law(&site)) else { continue };
            let adjacent_cells = [lower_neighbour(cells, site.axis, cell), cell];
            let pairs = &self.materials.media[0].pairs[site.axis];
            let velocity = |pair: usize, side: usize| {
                pairs.get(pair).map_or(T::ZERO, |pair| value(pair.velocity, adjacent_cells[side]))
            };
            initialise_history(law, pairs.len(), velocity, &mut history[start..]);
        }
        history
    }

    /// Returns the owned cell above the first interlayer with a non-finite history variable, and the velocity normal to
    /// the face.
    pub(super) fn first_non_finite_interlayer(&self) -> Option<(SolidField, usize)> {
        self.interfaces.owned_sites(&self.layout).into_iter().find_map(|site| {
            let is_finite = self.interfaces.history(&site).all(|own| own.to_f64().is_finite());
            let cell = self.layout.owned_index(site.cell)?;
            (!is_finite).then_some((SolidField::Velocity(site.axis), cell))
        })
    }

    /// Returns the sums of the energies of interlayers at the lower faces of owned cells.
    pub(super) fn sum_interlayer_energies(&self) -> InterlayerSums {
        let area = self.grid.spacing.map(|spacing| self.grid.volume() / spacing);
        self.interfaces.sum_energies(&self.layout, area)
    }
}
