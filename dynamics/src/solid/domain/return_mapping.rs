//! Return mapping of total stresses (initial stress included) in SIMD lanes, by the projection P or the reflection 2P −
//! I. The lanes of a block may have different yield sets: cones of the Mises type ([`Cone`]), polyhedra, others or
//! none.
//!
//! Every operation is that of the scalar projection ([`Medium::project`]), in the same order and in double precision:
//! results are equal bit for bit. Blocks in which no lane yields are skipped after the yield condition has been
//! evaluated. Newton's method runs on a batch of blocks: converged blocks do not wait for the others. Only cones are
//! solved in lanes. The scalar function projects stresses that may reach the apex of their cone, stresses beyond a
//! polyhedron, whose half-spaces are tested in lanes, and the stresses in all other sets.
//!
//! A block of eight stresses takes 16 to 19 divisions and 3 to 4 square roots in a classical solid with initial stress:
//! three divisions and one root per step of Newton's method, two divisions per evaluation of the stored energy.
//! Newton's method is limited by the division unit; the rest of the time is spent on about 400 additions,
//! multiplications and comparisons.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors, parts and lanes")]

mod batch;
mod trial;

use self::batch::{BATCH_SIZE, Batch, PendingBlocks, YieldingBlock};
use self::trial::{EnergyChange, TrialStress, is_symmetric_stress_inside};
use super::total_stress::{
    BLOCK_LANES, BlockConstants, DoubleLanes, InitialStress, StressTensors, TotalStressSets,
    load_cone, load_moduli, load_tensors, to_tensors,
};
use crate::simd::{InstructionSet, LaneGroup, Number, SimdKernel, Vector};
use crate::solid::cell_laws::{REFLECTION, map_stress};
use crate::solid::medium::Medium;
use models::solid::parameters::stored_energy;
use models::solid::stress::{Stress, StressShape};
use models::yield_set::return_mapping::{Cone, EIGENSPACE_COUNT, ReturnMappingResult};

/// Kernel: return mapping of adjacent blocks of a row.
pub(super) struct TotalStressKernel<'a> {
    pub(super) yield_sets: &'a TotalStressSets,
    pub(super) media: &'a [Medium],
    /// Field values from the first of these blocks on.
    pub(super) field_data: &'a mut [DoubleLanes],
    /// Distance between two fields in `field_data`, in blocks.
    pub(super) pitch: usize,
    /// By group, the index of its lane pattern.
    pub(super) lane_pattern_indices: &'a [u32],
    /// By lane pattern, whether any lane has a yield set.
    pub(super) has_yield_set: &'a [bool],
    /// Blocks per group: 1 in double, 2 in single precision.
    pub(super) blocks_per_group: usize,
    /// Initial stress: empty without one, one entry for all blocks, or one entry per block of the row.
    pub(super) initial_stress: &'a [InitialStress],
    pub(super) is_reflection: bool,
    /// Index of the first group in its row; number of lanes that hold cells in every group of the row; number of
    /// leading groups of the row that have one such lane more.
    pub(super) lane_occupancy: [usize; 3],
    /// Accumulated plastic dissipation by block and lane, J/m³.
    pub(super) dissipation: &'a mut [f64],
    /// Accumulated work of the initial stress by block and lane, J/m³; empty without initial stress.
    pub(super) initial_stress_work: &'a mut [f64],
    /// By group, mask of the lanes of owned cells; `None` if the row has no owned cells.
    pub(super) owned_lanes: Option<&'a [u16]>,
    /// Smallest ratio of plastic dissipation to stored energy over owned cells so far.
    pub(super) min_dissipation_ratio: &'a mut f64,
    /// Set to true if any block has lanes beyond their sets.
    pub(super) has_mapped: &'a mut bool,
}

/// Runs the kernel with an instruction set; not generic, so that it is compiled once, in this crate.
pub(super) fn map_in_lanes(instructions: InstructionSet, work: TotalStressKernel<'_>) {
    instructions.run_kernel::<f64>(work);
}

impl SimdKernel<f64> for TotalStressKernel<'_> {
    #[inline(always)]
    fn run<V: Vector<f64>>(mut self) {
        const PLANE_SHAPE: StressShape =
            StressShape { is_symmetric: true, is_plane: true, has_couples: false };
        const SPACE_SHAPE: StressShape = StressShape { is_plane: false, ..PLANE_SHAPE };
        const COSSERAT_PLANE_SHAPE: StressShape =
            StressShape { is_plane: true, ..StressShape::GENERAL };
        const DEVIATOR_ONLY: [bool; EIGENSPACE_COUNT] = [true, false, false, false, false];
        let active = self.yield_sets.active_eigenspaces;
        match self.yield_sets.shape {
            PLANE_SHAPE => self.map_blocks::<V>(PLANE_SHAPE, &DEVIATOR_ONLY),
            SPACE_SHAPE => self.map_blocks::<V>(SPACE_SHAPE, &DEVIATOR_ONLY),
            COSSERAT_PLANE_SHAPE => self.map_blocks::<V>(COSSERAT_PLANE_SHAPE, &active),
            _ => self.map_blocks::<V>(StressShape::GENERAL, &active),
        }
    }
}

impl<'a> TotalStressKernel<'a> {
    #[inline(always)]
    fn map_blocks<V: Vector<f64>>(
        &mut self,
        shape: StressShape,
        active: &[bool; EIGENSPACE_COUNT],
    ) {
        let count = self.lane_pattern_indices.len() * self.blocks_per_group;
        // Stored energy of the initial stress, and the index of the block constants for which it was computed;
        // `usize::MAX` before the first.
        let mut initial_energy = (V::ZERO, usize::MAX);
        let mut batch =
            Batch { count: 0, blocks: [YieldingBlock::EMPTY; BATCH_SIZE], has_last_yielded: false };
        for first in (0..count).step_by(BATCH_SIZE) {
            batch.count = 0;
            let mut pending = PendingBlocks { count: 0, indices: [0; BATCH_SIZE] };
            for block_index in first..count.min(first + BATCH_SIZE) {
                if self.has_yield_set[self.lane_pattern_indices
                    [block_index >> self.log2_blocks_per_group()]
                    as usize]
                {
                    self.collect_yielding_block(
                        (shape, active),
                        block_index,
                        &mut batch,
                        &mut pending,
                    );
                }
            }
            self.iterate_newton(active, &mut batch, pending);
            for index in 0..batch.count {
                self.map_block((shape, active), &batch.blocks[index], &mut initial_energy);
            }
            if batch.count > 0 {
                *self.has_mapped = true;
            }
        }
    }

    /// Returns log₂ of the number of blocks per group.
    #[inline(always)]
    const fn log2_blocks_per_group(&self) -> u32 {
        self.blocks_per_group.trailing_zeros()
    }

    /// Returns the constants of the block at a place of the row, and the index of these constants.
    #[inline(always)]
    fn block_constants(&self, block_index: usize) -> (usize, &'a BlockConstants) {
        let pattern =
            self.lane_pattern_indices[block_index >> self.log2_blocks_per_group()] as usize;
        let number = pattern * self.blocks_per_group + (block_index & (self.blocks_per_group - 1));
        (number, &self.yield_sets.blocks[number])
    }

    /// Tests a block for lanes beyond their sets, and adds it to the batch if there are any.
    #[inline(always)]
    fn collect_yielding_block<V: Vector<f64>>(
        &self,
        (shape, active): (StressShape, &[bool; EIGENSPACE_COUNT]),
        block_index: usize,
        batch: &mut Batch<V>,
        pending: &mut PendingBlocks,
    ) {
        let (_, block) = self.block_constants(block_index);
        let initial_stress = self.block_initial_stress(block_index);
        let cone = load_cone::<V>(&block.cone);
        let stress = self.load_stress::<V>(shape, block_index, initial_stress);
        let is_plain = block.half_spaces.is_empty() && block.other_lanes == 0;
        // If the previous block yielded, this one probably does too: skip the cheaper test.
        if is_plain
            && shape.is_symmetric
            && !batch.has_last_yielded
            && is_symmetric_stress_inside(shape, &cone, &stress[0])
        {
            return;
        }
        batch.has_last_yielded = false;
        let trial = TrialStress::new(shape, active, &cone, stress);
        if is_plain && trial.is_inside() {
            return;
        }
        let cell_lanes = self.cell_lanes(block_index);
        let mut scalar_lanes = block.other_lanes & cell_lanes;
        if !is_plain {
            scalar_lanes |=
                self.lanes_beyond_half_spaces::<V>(block_index, block, initial_stress) & cell_lanes;
        }
        let shear = trial.squared_shear.max(V::MIN_POSITIVE).sqrt();
        let yielding_lanes =
            trial.yielding_lanes(shape, &cone, shear) & block.cone_lanes & cell_lanes;
        let apex_lanes = trial.lanes_beyond_apex() & yielding_lanes;
        let (scalar_lanes, lanes) = (scalar_lanes | apex_lanes, yielding_lanes & !apex_lanes);
        if scalar_lanes | lanes == 0 {
            return;
        }
        let yielding_block = &mut batch.blocks[batch.count];
        (yielding_block.block_index, yielding_block.lanes, yielding_block.scalar_lanes) =
            (block_index, lanes, scalar_lanes);
        yielding_block.shear_capacity = trial.shear_capacity.max(V::ZERO);
        yielding_block.iterate.shear = shear;
        for part in 0..EIGENSPACE_COUNT {
            if active[part] {
                yielding_block.squares[part] = trial.weighted_invariants[part];
            }
        }
        if shape.is_symmetric {
            let (mean, deviator, _) = &trial.parts.force;
            let diagonal = [deviator[0][0], deviator[1][1], deviator[2][2]];
            yielding_block.symmetric_parts = (*mean, diagonal, trial.parts.squares[0]);
        }
        pending.push(batch.count, lanes != 0);
        batch.has_last_yielded = true;
        batch.count += 1;
    }

    /// Iterates Newton's method until all blocks have converged; converged blocks do not wait for the others.
    #[inline(always)]
    fn iterate_newton<V: Vector<f64>>(
        &self,
        active: &[bool; EIGENSPACE_COUNT],
        batch: &mut Batch<V>,
        mut pending: PendingBlocks,
    ) {
        let mut remaining = PendingBlocks { count: 0, indices: [0; BATCH_SIZE] };
        for &index in &pending.indices[..pending.count] {
            let yielding_block = &mut batch.blocks[usize::from(index)];
            let cone = load_cone::<V>(&self.block_constants(yielding_block.block_index).1.cone);
            let (equation, iterate) = yielding_block.equation(active, &cone);
            let iterate =
                equation.iterate_at(equation.newton_step(&equation.iterate_at_zero(iterate.shear)));
            yielding_block.set_iterate(active, &iterate);
            remaining.push(index.into(), iterate.residual.any_gt(V::ZERO));
        }
        pending = remaining;
        while pending.count > 0 {
            let mut remaining = PendingBlocks { count: 0, indices: [0; BATCH_SIZE] };
            for &index in &pending.indices[..pending.count] {
                let yielding_block = &mut batch.blocks[usize::from(index)];
                let cone = load_cone::<V>(&self.block_constants(yielding_block.block_index).1.cone);
                let (equation, iterate) = yielding_block.equation(active, &cone);
                let next = equation.fast_newton_step(&iterate);
                if !next.any_gt(iterate.x) {
                    continue;
                }
                let iterate = equation.iterate_at(next);
                yielding_block.set_iterate(active, &iterate);
                remaining.push(index.into(), iterate.residual.any_gt(V::ZERO));
            }
            pending = remaining;
        }
    }

    /// Maps the yielding lanes of a block into their sets and accumulates their energies.
    #[inline(always)]
    fn map_block<V: Vector<f64>>(
        &mut self,
        (shape, active): (StressShape, &[bool; EIGENSPACE_COUNT]),
        yielding_block: &YieldingBlock<V>,
        (initial_energy, known): &mut (V, usize),
    ) {
        let block_index = yielding_block.block_index;
        let (number, block) = self.block_constants(block_index);
        let initial_stress = self.block_initial_stress(block_index);
        let mut energy_change = EnergyChange::ZERO;
        let mut scalar_lanes = yielding_block.scalar_lanes;
        if yielding_block.lanes != 0 {
            let moduli = load_moduli::<V>(&block.moduli);
            if let Some(initial_stress) = initial_stress
                && (*known != number || self.initial_stress.len() > 1)
            {
                let [force, couple] = load_tensors::<V>(&initial_stress.0);
                (*initial_energy, *known) =
                    (stored_energy(shape, &force, &couple, &moduli), number);
            }
            let cone = load_cone::<V>(&block.cone);
            scalar_lanes |= self.map_lanes(
                (shape, active),
                yielding_block,
                (&cone, &moduli),
                (initial_stress, *initial_energy),
                &mut energy_change,
            );
        }
        if scalar_lanes != 0 {
            let mut scalar_change = EnergyChange::ZERO;
            self.map_scalar(
                (block_index, scalar_lanes),
                &block.media,
                initial_stress,
                &mut scalar_change,
            );
            energy_change.dissipation = energy_change
                .dissipation
                .blend_lanes(scalar_lanes, V::load(&scalar_change.dissipation));
            energy_change.initial_stress_work = energy_change
                .initial_stress_work
                .blend_lanes(scalar_lanes, V::load(&scalar_change.initial_stress_work));
            energy_change.dissipation_ratios = energy_change
                .dissipation_ratios
                .blend_lanes(scalar_lanes, V::load(&scalar_change.dissipation_ratios));
        }
        add_to_lanes(
            &mut self.dissipation[block_index * BLOCK_LANES..][..BLOCK_LANES],
            energy_change.dissipation,
        );
        if let Some(initial_stress_work) = self
            .initial_stress_work
            .get_mut(block_index * BLOCK_LANES..(block_index + 1) * BLOCK_LANES)
        {
            add_to_lanes(initial_stress_work, energy_change.initial_stress_work);
        }
        if V::ZERO.any_gt(energy_change.dissipation_ratios) {
            self.update_min_dissipation_ratio(block_index, energy_change.dissipation_ratios);
        }
    }

    /// Updates the smallest ratio of plastic dissipation to stored energy over owned cells.
    #[inline(never)]
    fn update_min_dissipation_ratio<V: Vector<f64>>(
        &mut self,
        block_index: usize,
        dissipation_ratios: V,
    ) {
        let Some(row_lanes) = self.owned_lanes else { return };
        let half = block_index & (self.blocks_per_group - 1);
        let row_lanes =
            row_lanes[block_index >> self.log2_blocks_per_group()] >> (half * BLOCK_LANES);
        let mut lanes_value = DoubleLanes::ZERO;
        dissipation_ratios.store(&mut lanes_value);
        for lane in (0..BLOCK_LANES).filter(|lane| row_lanes >> lane & 1 == 1) {
            *self.min_dissipation_ratio = self.min_dissipation_ratio.min(lanes_value.lanes()[lane]);
        }
    }

    /// Returns the initial stress of a block, if there is one.
    #[inline(always)]
    fn block_initial_stress(&self, block_index: usize) -> Option<&'a InitialStress> {
        match self.initial_stress {
            [] => None,
            [one] => Some(one),
            all => all.get(self.lane_occupancy[0] * self.blocks_per_group + block_index),
        }
    }

    /// Returns the mask of the lanes of a block that hold cells.
    #[inline(always)]
    fn cell_lanes(&self, block_index: usize) -> u16 {
        let [first, lane_count, longer_groups] = self.lane_occupancy;
        let (index, half) = (
            block_index >> self.log2_blocks_per_group(),
            block_index & (self.blocks_per_group - 1),
        );
        let cell_count = lane_count + usize::from(first + index < longer_groups);
        let cell_count = cell_count.saturating_sub(half * BLOCK_LANES).min(BLOCK_LANES);
        (1 << cell_count) - 1
    }

    /// Loads the total stress of a block.
    #[inline(always)]
    fn load_stress<V: Vector<f64>>(
        &self,
        shape: StressShape,
        block_index: usize,
        initial_stress: Option<&InitialStress>,
    ) -> StressTensors<V> {
        let mut stress = [[[V::ZERO; 3]; 3]; 2];
        for which in 0..if shape.has_couples { 2 } else { 1 } {
            for i in 0..3 {
                for j in 0..3 {
                    if which == 0 && shape.is_symmetric && j < i {
                        stress[0][i][j] = stress[0][j][i];
                    } else if shape.has_component(which, i, j) {
                        stress[which][i][j] =
                            self.load_component([which, i, j], block_index, initial_stress);
                    }
                }
            }
        }
        stress
    }

    /// Loads a component of the total stress of a block.
    #[inline(always)]
    fn load_component<V: Vector<f64>>(
        &self,
        [which, i, j]: [usize; 3],
        block_index: usize,
        initial_stress: Option<&InitialStress>,
    ) -> V {
        let loaded = match self.yield_sets.component_fields[which][i][j] {
            Some(field) => V::load(&self.field_data[field * self.pitch + block_index]),
            None => V::ZERO,
        };
        match initial_stress {
            Some(initial_stress) => loaded + V::load(&initial_stress.0[which][i][j]),
            None => loaded + V::ZERO,
        }
    }

    /// Returns the mask of the lanes beyond a half-space, even if only by rounding.
    #[inline(always)]
    fn lanes_beyond_half_spaces<V: Vector<f64>>(
        &self,
        block_index: usize,
        block: &BlockConstants,
        initial_stress: Option<&InitialStress>,
    ) -> u16 {
        let mut lanes = 0;
        for half_space in &block.half_spaces {
            let mut value = V::ZERO;
            for (component, normal) in &half_space.normal {
                value = value
                    + V::load(normal)
                        * self.load_component(*component, block_index, initial_stress);
            }
            lanes |= value.greater_lanes(V::load(&half_space.strength));
        }
        lanes
    }

    /// Maps the yielding lanes of a block; returns the mask of those left to the scalar projection.
    #[inline(always)]
    fn map_lanes<V: Vector<f64>>(
        &mut self,
        (shape, active): (StressShape, &[bool; EIGENSPACE_COUNT]),
        yielding_block: &YieldingBlock<V>,
        (cone, moduli): (&Cone<V>, &[[V; 3]; 2]),
        (initial_stress, initial_energy): (Option<&InitialStress>, V),
        energy_change: &mut EnergyChange<V>,
    ) -> u16 {
        let YieldingBlock { block_index, lanes, .. } = *yielding_block;
        let (_, root) = yielding_block.equation(active, cone);
        let stress = self.load_stress::<V>(shape, block_index, initial_stress);
        let parts = yielding_block.stress_parts(shape, &stress);
        let mean = parts.force.0;
        let mapped = ReturnMappingResult::new(
            cone,
            &parts.squares,
            [V::ONE, root.x],
            root.reciprocal,
            root.scale_factors,
            active,
        );
        // In these lanes the scalar function computes the mean stress from the yield condition. The factor of τ̄ allows
        // for the rounding of 1/(1/τ̄), by which that function computes τ̄.
        let capacity_bound = cone.strength + root.shear * V::from_f64(1.0 - 4.0 * f64::EPSILON);
        let size = cone.friction * (mean.max(-mean) + mapped.mean_drop);
        let remaining_lanes = size.greater_lanes(capacity_bound) & lanes;
        let (force, couple) =
            parts.scale_parts(shape, &mapped.scale_factors, mean - mapped.mean_drop);
        let mapped_stress = [force, couple];
        let mut plastic = [[[V::ZERO; 3]; 3]; 2];
        let mut max_change = V::ZERO;
        for which in 0..if shape.has_couples { 2 } else { 1 } {
            for i in 0..3 {
                for j in 0..3 {
                    if shape.has_component(which, i, j) {
                        let change = stress[which][i][j] - mapped_stress[which][i][j];
                        plastic[which][i][j] = change;
                        max_change = max_change.max(change.max(-change));
                    }
                }
            }
        }
        let lanes = lanes & !remaining_lanes & max_change.greater_lanes(V::ZERO);
        let plastic_energy = match self.is_reflection || initial_stress.is_some() {
            true => stored_energy(shape, &plastic[0], &plastic[1], moduli),
            false => V::ZERO,
        };
        let factor = if self.is_reflection { V::ONE + V::ONE } else { V::ONE };
        let reflection_loss = if self.is_reflection { plastic_energy } else { V::ZERO };
        let dissipation = factor * (mapped.energy_lost - reflection_loss);
        energy_change.dissipation = V::ZERO.blend_lanes(lanes, dissipation);
        if V::ZERO.greater_lanes(dissipation) & lanes != 0 {
            let initial_energy = stored_energy(shape, &stress[0], &stress[1], moduli);
            let ratio = dissipation / initial_energy.max(V::MIN_POSITIVE);
            energy_change.dissipation_ratios = V::ZERO.blend_lanes(lanes, ratio.min(V::ZERO));
        }
        if let Some(initial_stress) = initial_stress {
            let mut combined = plastic;
            for which in 0..if shape.has_couples { 2 } else { 1 } {
                for i in 0..3 {
                    for j in 0..3 {
                        if shape.has_component(which, i, j) {
                            combined[which][i][j] =
                                plastic[which][i][j] + V::load(&initial_stress.0[which][i][j]);
                        }
                    }
                }
            }
            let combined_energy = stored_energy(shape, &combined[0], &combined[1], moduli);
            let initial_stress_work = factor * (combined_energy - plastic_energy - initial_energy);
            energy_change.initial_stress_work = V::ZERO.blend_lanes(lanes, initial_stress_work);
        }
        self.store_stress(shape, (block_index, lanes), (&mapped_stress, &plastic), initial_stress);
        remaining_lanes
    }

    /// Stores the mapped stress, or its reflection, minus the initial stress.
    #[inline(always)]
    fn store_stress<V: Vector<f64>>(
        &mut self,
        shape: StressShape,
        (block_index, lanes): (usize, u16),
        (mapped_stress, plastic): (&StressTensors<V>, &StressTensors<V>),
        initial_stress: Option<&InitialStress>,
    ) {
        for which in 0..if shape.has_couples { 2 } else { 1 } {
            for i in 0..3 {
                for j in 0..3 {
                    if !shape.has_component(which, i, j) || (shape.is_symmetric && j < i) {
                        continue;
                    }
                    let Some(field) = self.yield_sets.stored_fields[which][i][j] else { continue };
                    let mut stored = mapped_stress[which][i][j];
                    if self.is_reflection {
                        stored = stored - plastic[which][i][j];
                    }
                    if let Some(initial_stress) = initial_stress {
                        stored = stored - V::load(&initial_stress.0[which][i][j]);
                    }
                    let block = &mut self.field_data[field * self.pitch + block_index];
                    V::load(block).blend_lanes(lanes, stored).store(block);
                }
            }
        }
    }

    /// Maps the masked lanes of a block by the scalar function.
    #[inline(never)]
    fn map_scalar(
        &mut self,
        (block_index, lanes): (usize, u16),
        media: &[u16; BLOCK_LANES],
        initial_stress: Option<&InitialStress>,
        energy_change: &mut EnergyChange<DoubleLanes>,
    ) {
        for lane in (0..BLOCK_LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let mut deviation = [[[0.0; 3]; 3]; 2];
            for which in 0..2 {
                for i in 0..3 {
                    for j in 0..3 {
                        if let Some(field) = self.yield_sets.component_fields[which][i][j] {
                            let block = &self.field_data[field * self.pitch + block_index];
                            deviation[which][i][j] = block.lanes()[lane];
                        }
                    }
                }
            }
            let [force, couple] = deviation;
            let (medium, initial_stress) = (
                &self.media[usize::from(media[lane])],
                initial_stress.map(|own| own.lane_stress(lane)),
            );
            let deviation = Stress { force, couple };
            // Media whose overstress relaxes are mapped cell by cell.
            let weight = if self.is_reflection { REFLECTION } else { 0.0 };
            let Some(result) = map_stress(medium, &deviation, initial_stress.as_ref(), weight)
            else {
                continue;
            };
            energy_change.dissipation.lanes_mut()[lane] = result.dissipation;
            energy_change.initial_stress_work.lanes_mut()[lane] = result.initial_stress_work;
            energy_change.dissipation_ratios.lanes_mut()[lane] = result.dissipation_ratio.min(0.0);
            for which in 0..2 {
                for i in 0..3 {
                    for j in 0..3 {
                        if let Some(field) = self.yield_sets.stored_fields[which][i][j] {
                            let block = &mut self.field_data[field * self.pitch + block_index];
                            block.lanes_mut()[lane] = to_tensors(&result.stress)[which][i][j];
                        }
                    }
                }
            }
        }
    }
}

/// Adds `addend` to a list, lane by lane.
#[inline(always)]
fn add_to_lanes<V: Vector<f64>>(to: &mut [f64], addend: V) {
    let mut lanes_value = DoubleLanes::ZERO;
    lanes_value.lanes_mut().copy_from_slice(to);
    (V::load(&lanes_value) + addend).store(&mut lanes_value);
    to.copy_from_slice(lanes_value.lanes());
}
