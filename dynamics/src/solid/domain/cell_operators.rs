//! Operators that act in each cell: rotation of spins, flush of subnormals, time integrals; sums of energies over
//! cells.

use super::diagnostics::Diagnostics;
use super::layout::RowSegment;
use super::{Domain, MAX_FIELDS, SolverReal};
use crate::exact_sum::ExactSum;
use crate::simd::{LaneGroup, MAX_LANES, Real, SimdKernel, Vector};
use crate::solid::cell_laws::{
    LawInterval, SpinStressRotation, add_scaled, flush_limit, rotate_spin_stress,
    stress_from_fields,
};
use crate::solid::ledger::{EnergySums, LedgerSums};
use models::solid::stress::Stress;
use std::ops::Range;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Adds the present values of `cells` to their time integrals, weighted by `steps`·Δt: `steps` = 0.5 for the first
    /// value of the trapezoidal rule and, with alternating sweeps, for both values of a step; else 1.
    pub(super) fn accumulate_integrals(&mut self, cells: Range<usize>, steps: f64) {
        let mut integrals = std::mem::take(&mut self.diagnostics.time_integrals);
        for (place, sums) in &mut integrals {
            for (sum, cell) in sums[cells.clone()].iter_mut().zip(cells.clone()) {
                *sum += steps * self.step * self.value_at(cell, *place).to_f64();
            }
        }
        self.diagnostics.time_integrals = integrals;
    }

    /// Returns the values of all fields of a cell, given by its index with halo; unused entries are zero.
    pub(super) fn cell_state(&self, cell: usize) -> [T; MAX_FIELDS] {
        let mut values = [T::ZERO; MAX_FIELDS];
        for (value, (_, place)) in values.iter_mut().zip(self.field_offsets()) {
            *value = self.value_at(cell, place);
        }
        values
    }

    /// Returns the stress in a cell as deviation from the initial stress, Pa.
    pub(super) fn stress_deviation(&self, cell: usize) -> Stress {
        self.stress_from_fields(&self.cell_state(cell))
    }

    /// Converts the field values of a state to stress tensors.
    pub(super) fn stress_from_fields(&self, values: &[T; MAX_FIELDS]) -> Stress {
        stress_from_fields(self.fields(), values)
    }

    /// Returns the total stress in an owned cell, Pa: the initial stress plus the deviation from it.
    pub fn total_stress(&self, cell: usize) -> Stress {
        let cell = self.layout.local_cell(cell);
        add_scaled(&self.stress_deviation(cell), &self.initial_stress(cell), 1.0)
    }

    /// Rotates spins against antisymmetric stress over `interval`.
    pub(super) fn rotate_spins(
        &mut self,
        layers: &Range<usize>,
        tile: &RowSegment,
        interval: LawInterval,
    ) {
        if self.lane_laws.rotated_offsets.is_empty() {
            return;
        }
        for layer in layers.clone() {
            let (first, groups) = self.layout.segment_groups(layer, tile);
            self.instructions.run_kernel::<T>(SpinRotationKernel {
                field_data: &mut self.field_data[first..],
                lane_pattern_indices: &self.materials.lane_pattern_indices[groups],
                rotations: &self.lane_laws.spin_rotations,
                rotated_offsets: &self.lane_laws.rotated_offsets,
                interval,
            });
        }
    }

    /// Sets values of magnitude below [`flush_limit`] to zero after every 16th step, in fields and in history variables
    /// of interlayers.
    pub(super) fn flush_subnormals(
        &mut self,
        layer: usize,
        rows: &Range<usize>,
        steps_done: usize,
    ) {
        let Some(limit) = flush_limit::<T>(steps_done) else { return };
        let stored = self.layout.data_range(layer, rows);
        self.instructions
            .run_kernel::<T>(FlushKernel { values: &mut self.field_data[stored], limit });
        for stored in self.interfaces.history_ranges(&self.layout, layer, rows) {
            let values = &mut self.interfaces.history[stored];
            self.instructions.run_kernel::<T>(FlushKernel { values, limit });
        }
    }

    /// Returns the sums of the energy in owned cells and faces.
    pub(crate) fn energy_sums(&self) -> EnergySums {
        let mut sums = T::energy_sums(self);
        sums.interlayers = self.sum_interlayer_energies();
        sums
    }

    /// Returns the sums of the energy in owned cells.
    pub(super) fn sum_energies(&self) -> EnergySums {
        let mut sums = EnergySums::default();
        let row_lanes = self.layout.groups * T::Lanes::COUNT;
        let [mut kinetic, mut stored] = [vec![0.0; row_lanes], vec![0.0; row_lanes]];
        for row in self.layout.owned_rows() {
            let lane_energies = [kinetic.as_mut_slice(), stored.as_mut_slice()];
            let sums = [&mut sums.kinetic, &mut sums.stored];
            self.instructions.run_kernel::<T>(EnergyKernel {
                domain: self,
                row,
                lane_energies,
                sums,
            });
        }
        sums
    }

    /// Returns the sums of all terms of the energy ledger over owned cells and faces, for all steps so far.
    pub(crate) fn ledger_sums(&self) -> LedgerSums {
        let Diagnostics { work, dissipation, .. } = &self.diagnostics;
        let dissipation = dissipation.lists().map(|values| self.sum_owned_lanes(values));
        let interlayers = self.sum_interlayer_energies();
        LedgerSums { work: work.clone(), dissipation, interlayers }
    }

    /// Returns the sum over owned cells of a list by group and lane; zero for an empty list.
    fn sum_owned_lanes(&self, values: &[f64]) -> ExactSum {
        let (mut sum, lanes) = (ExactSum::default(), T::Lanes::COUNT);
        let row = self.layout.groups * lanes;
        let rows =
            self.layout.owned_rows().filter_map(|index| values.get(index * row..)?.get(..row));
        for row in rows {
            for (group, own) in row.chunks_exact(lanes).zip(&self.layout.owned_lanes) {
                for (lane, value) in group.iter().enumerate() {
                    if *value != 0.0 && own >> lane & 1 == 1 {
                        sum.add(*value);
                    }
                }
            }
        }
        sum
    }
}

/// Kernel: rotation of spins against antisymmetric stress in adjacent groups of a row.
struct SpinRotationKernel<'a, T: Real> {
    /// Field values from the first of these groups on.
    field_data: &'a mut [T::Lanes],
    lane_pattern_indices: &'a [u32],
    rotations: &'a [[SpinStressRotation<T::Lanes>; 2]],
    rotated_offsets: &'a [[usize; 3]],
    interval: LawInterval,
}

impl<T: Real> SimdKernel<T> for SpinRotationKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        for (index, &pattern) in self.lane_pattern_indices.iter().enumerate() {
            let group = &mut self.field_data[index..];
            let [cos, ratio_sin, sin_over_ratio] =
                &self.rotations[pattern as usize][self.interval as usize];
            let rotation = [V::load(cos), V::load(ratio_sin), V::load(sin_over_ratio)];
            for &[spin, first, second] in self.rotated_offsets {
                let before =
                    [V::load(&group[spin]), V::load(&group[first]), V::load(&group[second])];
                let [omega, first_stress, second_stress] = rotate_spin_stress(rotation, before);
                omega.store(&mut group[spin]);
                first_stress.store(&mut group[first]);
                second_stress.store(&mut group[second]);
            }
        }
    }
}

/// Kernel: flush to zero of magnitudes below a limit.
struct FlushKernel<'a, T: Real> {
    values: &'a mut [T::Lanes],
    limit: T,
}

impl<T: Real> SimdKernel<T> for FlushKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let limit = <V as Vector<T>>::splat(self.limit);
        for group in self.values {
            V::load(group).flush_below(limit).store(group);
        }
    }
}

/// Kernel: adds kinetic and stored energy of the owned cells of a row, J/m³, to exact sums.
struct EnergyKernel<'a, T: SolverReal, const D: usize> {
    domain: &'a Domain<T, D>,
    row: usize,
    /// Buffers of both energies by group and lane; zero in lanes without owned cells.
    lane_energies: [&'a mut [f64]; 2],
    sums: [&'a mut ExactSum; 2],
}

impl<T: SolverReal, const D: usize> SimdKernel<T> for EnergyKernel<'_, T, D> {
    #[inline(always)]
    fn run<V: Vector<T>>(mut self) {
        let Domain { layout, materials, field_data, .. } = self.domain;
        let (terms, lane_pattern_indices) =
            (&materials.energy_terms, &materials.lane_pattern_indices);
        for (group_index, own) in layout.owned_lanes.iter().enumerate() {
            let index = layout.group_index(self.row, group_index);
            let factors = &terms.factors[lane_pattern_indices[index.group] as usize];
            let group = &field_data[index.start..];
            // Kinetic terms come first. Sums are in double precision.
            let mut lane_energies = [[0.0f64; MAX_LANES]; 2];
            let kinds = [0..terms.kinetic_count, terms.kinetic_count..terms.field_offsets.len()];
            for (of_kind, kind) in lane_energies.iter_mut().zip(kinds) {
                // A local array, not `lane_energies` itself, so that the compiler keeps the sums in registers.
                let mut sums = [0.0f64; MAX_LANES];
                for (&[one, other], factor) in
                    terms.field_offsets[kind.clone()].iter().zip(&factors[kind])
                {
                    let lanes = factor.lanes().iter().zip(group[one].lanes());
                    for (sum, ((factor, one), other)) in
                        sums.iter_mut().zip(lanes.zip(group[other].lanes()))
                    {
                        *sum += factor.to_f64() * one.to_f64() * other.to_f64();
                    }
                }
                *of_kind = sums;
            }
            let (count, first_lane) = (T::Lanes::COUNT, group_index * T::Lanes::COUNT);
            for (row_energies, owned_lanes) in self.lane_energies.iter_mut().zip(lane_energies) {
                for (lane, value) in
                    row_energies[first_lane..first_lane + count].iter_mut().enumerate()
                {
                    *value = if own >> lane & 1 == 1 { owned_lanes[lane] } else { 0.0 };
                }
            }
        }
        let [kinetic, stored] = self.sums;
        let [kinetic_of_lanes, stored_of_lanes] = self.lane_energies;
        kinetic.add_terms(kinetic_of_lanes);
        stored.add_terms(stored_of_lanes);
    }
}
