//! Return mapping of a domain: selection of the kernel, and scalar return mapping of single cells.

use super::layout::RowSegment;
use super::plastic::ProjectionKernel;
use super::return_mapping::{TotalStressKernel, map_in_lanes};
use super::total_stress::{BLOCK_LANES, DoubleLanes, InitialStress, blocks_per_group};
use super::{Domain, SolverReal};
use crate::simd::{LaneGroup, Real};
use crate::solid::cell_laws::map_scaled_stress;
use crate::solid::ledger::CellDissipation;
use crate::solid::medium::stress_component;
use models::solid::stress::Stress;
use std::any::Any;
use std::ops::Range;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the initial stress in a cell, given its index among all cells, halo included; zero if the problem has
    /// none.
    pub(super) fn initial_stress(&self, cell: usize) -> Stress {
        let Some((axis, layers)) = &self.lane_laws.initial_stress else {
            return Stress::default();
        };
        let stride: usize = self.layout.cells[..*axis].iter().product();
        layers[cell / stride % layers.len()]
    }

    /// Applies the projection P onto the yield sets, or the reflection 2P − I if `reflects`, in a segment of the rows
    /// of some layers.
    pub(super) fn apply_return_mapping(
        &mut self,
        layers: &Range<usize>,
        tile: &RowSegment,
        reflects: bool,
    ) {
        if !self.lane_laws.has_yield_set.contains(&true) {
            return;
        }
        let is_plain = !reflects
            && self.lane_laws.initial_stress.is_none()
            && self.lane_laws.yield_sets.is_some();
        for layer in layers.clone() {
            match (is_plain, self.lane_laws.uses_scalar_mapping) {
                (true, _) => self.project_stresses(layer, tile),
                (false, false) => self.map_total_stresses(layer, tile, reflects),
                (false, true) => {
                    for group in self.layout.segment_groups(layer, tile).1 {
                        self.map_lanes(group, u16::MAX, reflects);
                    }
                }
            }
        }
    }

    /// Applies P without initial stress, by the kernel for yield sets of one kind.
    fn project_stresses(&mut self, layer: usize, tile: &RowSegment) {
        let Some(yield_sets) = &self.lane_laws.yield_sets else { return };
        let mut scalar_lanes = std::mem::take(&mut self.buffers.scalar_lanes);
        scalar_lanes.clear();
        let (first, groups) = self.layout.segment_groups(layer, tile);
        let lanes = T::Lanes::COUNT;
        let dissipation = &mut self.diagnostics.dissipation.plastic_dissipation;
        let mapping = ProjectionKernel {
            field_data: &mut self.field_data[first..],
            lane_pattern_indices: &self.materials.lane_pattern_indices[groups.clone()],
            yield_sets,
            has_yield_set: &self.lane_laws.has_yield_set,
            field_factor: T::from_f64(self.lane_laws.field_factor(layer)),
            dissipation: &mut dissipation[groups.start * lanes..groups.end * lanes],
            scalar_lanes: &mut scalar_lanes,
        };
        T::map_stresses(mapping, self.instructions);
        for &(index, lanes) in &scalar_lanes {
            self.map_lanes(groups.start + index, lanes, false);
        }
        self.buffers.scalar_lanes = scalar_lanes;
    }

    /// Applies P, or 2P − I if `reflects`, to total stresses.
    fn map_total_stresses(&mut self, layer: usize, tile: &RowSegment, reflects: bool) {
        let (first, groups) = self.layout.segment_groups(layer, tile);
        let lanes = T::Lanes::COUNT;
        let length = self.layout.cells[0];
        let uniform;
        let initial = match &self.lane_laws.initial_stress {
            None => &[],
            Some((0, _)) => self.lane_laws.initial_stress_blocks.as_slice(),
            Some(_) => {
                let cell = (layer * self.layout.rows + tile.row) * length;
                uniform = [InitialStress::from_uniform(&self.initial_stress(cell))];
                &uniform
            }
        };
        let mut double_row = std::mem::take(&mut self.buffers.double_row);
        let (blocks_per_group, count) =
            (blocks_per_group::<T>(), groups.len() * blocks_per_group::<T>());
        let stresses =
            self.fields().iter().position(|own| stress_component(*own, &ZERO_STRESS).is_some());
        let stresses = stresses.unwrap_or(0)..self.fields().len();
        let is_double = (&self.field_data as &dyn Any).is::<Vec<DoubleLanes>>();
        if !is_double {
            // Stresses are mapped in double precision, as by the scalar projection.
            for field in stresses.clone() {
                let groups_of_field =
                    &self.field_data[first + field * self.layout.pitch..][..groups.len()];
                convert_to_double::<T>(groups_of_field, &mut double_row[field * count..][..count]);
            }
        }
        let mut has_mapped = false;
        let CellDissipation { plastic_dissipation, initial_stress_work, .. } =
            &mut self.diagnostics.dissipation;
        let tile_lanes = groups.start * lanes..groups.end * lanes;
        let is_owned = self.layout.is_owned_row(layer, tile.row);
        let (field_data, pitch) =
            match (&mut self.field_data as &mut dyn Any).downcast_mut::<Vec<DoubleLanes>>() {
                Some(field_data) => (&mut field_data[first..], self.layout.pitch),
                None => (double_row.as_mut_slice(), count),
            };
        map_in_lanes(
            self.instructions,
            TotalStressKernel {
                yield_sets: &self.lane_laws.total_stress_sets,
                media: &self.materials.media,
                field_data,
                pitch,
                lane_pattern_indices: &self.materials.lane_pattern_indices[groups.clone()],
                has_yield_set: &self.lane_laws.has_yield_set,
                blocks_per_group,
                initial_stress: initial,
                is_reflection: reflects,
                lane_occupancy: [
                    tile.groups.start,
                    length / self.layout.groups,
                    length % self.layout.groups,
                ],
                dissipation: &mut plastic_dissipation[tile_lanes.clone()],
                initial_stress_work: initial_stress_work.get_mut(tile_lanes).unwrap_or(&mut []),
                owned_lanes: is_owned.then_some(&self.layout.owned_lanes[tile.groups.clone()]),
                min_dissipation_ratio: &mut self.diagnostics.work.min_dissipation_ratio,
                has_mapped: &mut has_mapped,
            },
        );
        if !is_double && has_mapped {
            for field in stresses {
                let groups_of_field =
                    &mut self.field_data[first + field * self.layout.pitch..][..groups.len()];
                round_from_double::<T>(&double_row[field * count..][..count], groups_of_field);
            }
        }
        self.buffers.double_row = double_row;
    }

    /// Maps the cells in the masked lanes of a group by the scalar projection.
    fn map_lanes(&mut self, group: usize, lanes: u16, reflects: bool) {
        if !self.lane_laws.has_yield_set[self.materials.lane_pattern_indices[group] as usize] {
            return;
        }
        for lane in (0..T::Lanes::COUNT).filter(|lane| lanes >> lane & 1 == 1) {
            if let Some(cell) = self.layout.cell_in_lane(group, lane) {
                self.map_cell(cell, reflects);
            }
        }
    }

    fn map_cell(&mut self, cell: usize, reflects: bool) {
        let medium = self.materials.medium(cell);
        if medium.yield_set.is_none() {
            return;
        }
        let initial = self.lane_laws.initial_stress.is_some().then(|| self.initial_stress(cell));
        let deviation = self.stress_deviation(cell);
        let weight = medium.mapping_weight(reflects, self.step);
        let layer = cell / self.layout.layer_cells();
        let factor = self.lane_laws.field_factor(layer);
        let Some(mapped) = map_scaled_stress(medium, factor, &deviation, initial.as_ref(), weight)
        else {
            return;
        };
        let lane = self.layout.flat_lane_index::<T>(cell);
        let CellDissipation { plastic_dissipation, initial_stress_work, .. } =
            &mut self.diagnostics.dissipation;
        plastic_dissipation[lane] += mapped.dissipation;
        if let Some(sum) = initial_stress_work.get_mut(lane) {
            *sum += mapped.initial_stress_work;
        }
        if self.layout.owned_index(cell).is_some() {
            let min_ratio = &mut self.diagnostics.work.min_dissipation_ratio;
            *min_ratio = min_ratio.min(mapped.dissipation_ratio);
        }
        for index in 0..self.materials.media[0].fields.len() {
            if let Some(value) = stress_component(self.fields()[index], &mapped.stress) {
                *self.value_at_mut(cell, index * self.layout.pitch) = T::from_f64(value);
            }
        }
    }
}

const ZERO_STRESS: Stress = Stress { force: [[0.0; 3]; 3], couple: [[0.0; 3]; 3] };

/// Converts groups to blocks in double precision.
fn convert_to_double<T: Real>(groups: &[T::Lanes], blocks: &mut [DoubleLanes]) {
    let lanes = groups.iter().flat_map(|group| group.lanes().chunks(BLOCK_LANES));
    for (block, own) in blocks.iter_mut().zip(lanes) {
        for (wide, own) in block.lanes_mut().iter_mut().zip(own) {
            *wide = own.to_f64();
        }
    }
}

/// Rounds blocks in double precision to the type of the groups.
fn round_from_double<T: Real>(blocks: &[DoubleLanes], groups: &mut [T::Lanes]) {
    let lanes = groups.iter_mut().flat_map(|group| group.lanes_mut().chunks_mut(BLOCK_LANES));
    for (block, own) in blocks.iter().zip(lanes) {
        for (own, wide) in own.iter_mut().zip(block.lanes()) {
            *own = T::from_f64(*wide);
        }
    }
}
