//! Sweeps along idle axes ([`Problem::is_idle`](crate::solid::problem::Problem)): all that is left of them is that they
//! turn negative zeros into positive ones, since they add differences of equal numbers. Fields stay equal bit for bit to
//! those of complete sweeps.

use super::layout::RowSegment;
use super::material_table::{MaterialTable, WavePair};
use super::{Domain, SolverReal};
use crate::simd::{Real, SimdKernel, Vector};
use std::ops::Range;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Sweeps rows, numbered over all layers, along an axis if it is idle. Returns whether it is.
    pub(super) fn sweep_if_idle(
        &mut self,
        axis: usize,
        rows: Range<usize>,
        half_step: usize,
    ) -> bool {
        if self.is_idle[axis] {
            for row in rows {
                self.sweep_idle_segment(axis, 0, &self.layout.row_segment(row), half_step);
            }
        }
        self.is_idle[axis]
    }

    /// Sweeps a segment of a row of some layers along the last axis, as [`Self::sweep_if_idle`] does.
    pub(super) fn sweep_last_axis_if_idle(
        &mut self,
        layers: &Range<usize>,
        tile: &RowSegment,
        half_step: usize,
    ) -> bool {
        if self.is_idle[D - 1] {
            for layer in layers.clone() {
                self.sweep_idle_segment(D - 1, layer, tile, half_step);
            }
        }
        self.is_idle[D - 1]
    }

    /// Sweeps a segment of a row of a layer along an idle axis.
    fn sweep_idle_segment(
        &mut self,
        axis: usize,
        layer: usize,
        tile: &RowSegment,
        half_step: usize,
    ) {
        let (first, groups) = self.layout.segment_groups(layer, tile);
        let mut field_data = std::mem::take(&mut self.field_data);
        self.instructions.run_kernel::<T>(IdleSweepKernel {
            field_data: &mut field_data[first..],
            waves: self.sweep_waves(axis, half_step),
            table: &self.materials.table,
            lane_pattern_indices: &self.materials.lane_pattern_indices[groups],
        });
        self.field_data = field_data;
    }
}

/// Kernel: adds a change of zero to the fields of adjacent groups.
struct IdleSweepKernel<'a, T: Real> {
    field_data: &'a mut [T::Lanes],
    waves: &'a [WavePair],
    table: &'a MaterialTable<T>,
    /// By group, the index of its lane pattern.
    lane_pattern_indices: &'a [u32],
}

impl<T: Real> SimdKernel<T> for IdleSweepKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { field_data, waves, table, lane_pattern_indices } = self;
        for wave in waves {
            for place in [wave.velocity, wave.stress] {
                for group in &mut field_data[place..][..lane_pattern_indices.len()] {
                    (V::load(group) + V::ZERO).store(group);
                }
            }
            for (index, &place) in wave.passive_stresses.iter().enumerate() {
                let groups = &mut field_data[place..][..lane_pattern_indices.len()];
                for (group, &pattern) in groups.iter_mut().zip(lane_pattern_indices) {
                    let ratio = V::load(table.coupling_ratio(pattern, wave, index));
                    (V::load(group) + ratio * V::ZERO).store(group);
                }
            }
        }
    }
}
