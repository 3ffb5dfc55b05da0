//! Return mapping of a domain: selection of the kernel, and the scalar mapping of single cells.

use super::layout::RowSegment;
use super::plastic::Correct;
use super::return_mapping::{MapStresses, map_in_lanes};
use super::total_stress::{InitialStress, WIDTH, Wide, blocks_per_group};
use super::{Domain, SolverReal};
use crate::simd::{Group, Real};
use crate::solid::cell_laws::correction;
use crate::solid::ledger::CellDissipation;
use crate::solid::medium::component;
use models::solid::stress::Stress;
use std::any::Any;
use std::ops::Range;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the initial stress in a cell, counted with the halo.
    pub(super) fn initial_stress(&self, cell: usize) -> Stress {
        let Some((axis, layers)) = &self.law.initial_stress else { return Stress::default() };
        let stride: usize = self.layout.cells[..*axis].iter().product();
        layers[cell / stride % layers.len()]
    }

    /// Applies the projection P onto the yield sets, or the reflection 2P − I if `reflects`, in a segment of the rows
    /// of some layers.
    pub(super) fn correct(&mut self, layers: &Range<usize>, tile: &RowSegment, reflects: bool) {
        if self.diagnostics.dissipation.plastic.is_empty() {
            return;
        }
        let is_plain = !reflects && self.law.initial_stress.is_none() && self.law.sets.is_some();
        for layer in layers.clone() {
            match (is_plain, self.law.maps_one_by_one) {
                (true, _) => self.correct_plain(layer, tile),
                (false, false) => self.map_stresses(layer, tile, reflects),
                (false, true) => {
                    for group in self.layout.groups_of(layer, tile).1 {
                        self.correct_lanes(group, u16::MAX, reflects);
                    }
                }
            }
        }
    }

    /// Applies P without initial stress, if all sets are of one kind.
    fn correct_plain(&mut self, layer: usize, tile: &RowSegment) {
        let Some(sets) = &self.law.sets else { return };
        let mut left = std::mem::take(&mut self.buffer.left);
        left.clear();
        let (first, groups) = self.layout.groups_of(layer, tile);
        let lanes = T::Lanes::COUNT;
        let dissipated = &mut self.diagnostics.dissipation.plastic;
        let mapping = Correct {
            data: &mut self.data[first..],
            patterns: &self.materials.patterns[groups.clone()],
            sets,
            yields: &self.law.yields,
            dissipated: &mut dissipated[groups.start * lanes..groups.end * lanes],
            left: &mut left,
        };
        T::correct(mapping, self.instructions);
        for &(index, lanes) in &left {
            self.correct_lanes(groups.start + index, lanes, false);
        }
        self.buffer.left = left;
    }

    /// Applies P or 2P − I to total stresses.
    fn map_stresses(&mut self, layer: usize, tile: &RowSegment, reflects: bool) {
        let (first, groups) = self.layout.groups_of(layer, tile);
        let lanes = T::Lanes::COUNT;
        let length = self.layout.cells[0];
        let uniform;
        let initial = match &self.law.initial_stress {
            None => &[],
            Some((0, _)) => self.law.initial_blocks.as_slice(),
            Some(_) => {
                let cell = (layer * self.layout.rows + tile.row) * length;
                uniform = [InitialStress::uniform(&self.initial_stress(cell))];
                &uniform
            }
        };
        let mut wide = std::mem::take(&mut self.buffer.wide);
        let (blocks_per_group, count) =
            (blocks_per_group::<T>(), groups.len() * blocks_per_group::<T>());
        let stresses = self.fields().iter().position(|own| component(*own, &NONE).is_some());
        let stresses = stresses.unwrap_or(0)..self.fields().len();
        let is_double = (&self.data as &dyn Any).is::<Vec<Wide>>();
        if !is_double {
            // In double precision, as is the scalar projection.
            for field in stresses.clone() {
                let own = &self.data[first + field * self.layout.pitch..][..groups.len()];
                widen::<T>(own, &mut wide[field * count..][..count]);
            }
        }
        let mut has_mapped = false;
        let CellDissipation { plastic, released, .. } = &mut self.diagnostics.dissipation;
        let of_tile = groups.start * lanes..groups.end * lanes;
        let is_own = self.layout.is_own_row(layer, tile.row);
        let (data, pitch) = match (&mut self.data as &mut dyn Any).downcast_mut::<Vec<Wide>>() {
            Some(data) => (&mut data[first..], self.layout.pitch),
            None => (wide.as_mut_slice(), count),
        };
        map_in_lanes(
            self.instructions,
            MapStresses {
                mapping: &self.law.whole,
                media: &self.materials.media,
                data,
                pitch,
                patterns: &self.materials.patterns[groups.clone()],
                yields: &self.law.yields,
                blocks_per_group,
                initial,
                reflects,
                row: [tile.groups.start, length / self.layout.groups, length % self.layout.groups],
                dissipated: &mut plastic[of_tile.clone()],
                released: released.get_mut(of_tile).unwrap_or(&mut []),
                own_lanes: is_own.then_some(&self.layout.own_lanes[tile.groups.clone()]),
                least_plastic: &mut self.diagnostics.work.least_plastic,
                has_mapped: &mut has_mapped,
            },
        );
        if !is_double && has_mapped {
            for field in stresses {
                let own = &mut self.data[first + field * self.layout.pitch..][..groups.len()];
                narrow::<T>(&wide[field * count..][..count], own);
            }
        }
        self.buffer.wide = wide;
    }

    /// Maps the cells in the masked lanes of a group by the scalar projection.
    fn correct_lanes(&mut self, group: usize, lanes: u16, reflects: bool) {
        if !self.law.yields[self.materials.patterns[group] as usize] {
            return;
        }
        for lane in (0..T::Lanes::COUNT).filter(|lane| lanes >> lane & 1 == 1) {
            if let Some(cell) = self.layout.cell_of(group, lane) {
                self.correct_cell(cell, reflects);
            }
        }
    }

    fn correct_cell(&mut self, cell: usize, reflects: bool) {
        let medium = self.materials.of(cell);
        if medium.yields.is_none() {
            return;
        }
        let initial = self.law.initial_stress.is_some().then(|| self.initial_stress(cell));
        let deviation = self.stress(cell);
        let Some(done) = correction(medium, &deviation, initial.as_ref(), reflects) else { return };
        let lane = self.layout.lane_of::<T>(cell);
        let CellDissipation { plastic, released, .. } = &mut self.diagnostics.dissipation;
        plastic[lane] += done.dissipated;
        if let Some(sum) = released.get_mut(lane) {
            *sum += done.released;
        }
        if self.layout.own_number(cell).is_some() {
            let least = &mut self.diagnostics.work.least_plastic;
            *least = least.min(done.share);
        }
        for index in 0..self.materials.media[0].fields.len() {
            if let Some(moved) = component(self.fields()[index], &done.stress) {
                *self.at_mut(cell, index * self.layout.pitch) = T::from_f64(moved);
            }
        }
    }
}

const NONE: Stress = Stress { force: [[0.0; 3]; 3], couple: [[0.0; 3]; 3] };

/// Converts groups to blocks in double precision.
fn widen<T: Real>(groups: &[T::Lanes], blocks: &mut [Wide]) {
    let lanes = groups.iter().flat_map(|group| group.lanes().chunks(WIDTH));
    for (block, own) in blocks.iter_mut().zip(lanes) {
        for (wide, own) in block.lanes_mut().iter_mut().zip(own) {
            *wide = own.to_f64();
        }
    }
}

/// Rounds blocks in double precision to the type of the groups.
fn narrow<T: Real>(blocks: &[Wide], groups: &mut [T::Lanes]) {
    let lanes = groups.iter_mut().flat_map(|group| group.lanes_mut().chunks_mut(WIDTH));
    for (block, own) in blocks.iter().zip(lanes) {
        for (own, wide) in own.iter_mut().zip(block.lanes()) {
            *own = T::from_f64(*wide);
        }
    }
}
