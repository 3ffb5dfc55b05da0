//! Sweeps along idle axes ([`Problem::is_idle`](crate::solid::problem::Problem)): all that is left of them is that they
//! turn negative zeros into positive ones, since they add differences of equal numbers. Fields stay equal bit for bit to
//! those of complete sweeps.

use super::layout::RowSegment;
use super::material_table::{MaterialTable, WavePair};
use super::{Domain, SolverReal};
use crate::simd::{Real, SimdKernel, Vector};
use crate::solid::problem::Problem;
use std::ops::Range;

/// Axes along which sweeps change nothing.
#[derive(Clone, Debug)]
pub(super) struct IdleAxes<const D: usize> {
    pub(super) is_idle: [bool; D],
    /// Idle axes that the scheme sweeps before the first one, in this order.
    pub(super) before_first: Vec<usize>,
    /// Whether sweeps along the first of these alternate with the others: the last one is in the middle of the step.
    pub(super) is_first_alternating: bool,
}

impl<const D: usize> IdleAxes<D> {
    pub(super) fn new(problem: &Problem<D>) -> Self {
        Self {
            is_idle: std::array::from_fn(|axis| problem.is_idle(axis)),
            before_first: Vec::new(),
            is_first_alternating: false,
        }
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Sets the idle axes that the scheme sweeps before the first one, in this order, and whether sweeps along the first of
    /// them alternate with the others.
    pub(crate) fn set_idle_axes_before_first(&mut self, axes: Vec<usize>, is_alternating: bool) {
        let is_first_alternating = is_alternating && !axes.is_empty();
        self.halves_cell_laws |= is_first_alternating;
        self.idle_axes.is_first_alternating = is_first_alternating;
        self.idle_axes.before_first = axes;
    }

    /// Sweeps rows, numbered over all layers, along the idle axes that come before the first one.
    pub(super) fn sweep_idle_axes_before_first(&mut self, rows: Range<usize>, half_step: usize) {
        let skipped = self.idle_axes.is_first_alternating && half_step % 2 == 1;
        for index in usize::from(skipped)..self.idle_axes.before_first.len() {
            self.sweep_idle_rows(self.idle_axes.before_first[index], rows.clone(), half_step);
        }
    }

    /// Sweeps rows, numbered over all layers, along an axis if it is idle, unless it comes before the first one. Returns
    /// whether it is idle.
    pub(super) fn sweep_if_idle(
        &mut self,
        axis: usize,
        rows: Range<usize>,
        half_step: usize,
    ) -> bool {
        if self.is_idle_after_first(axis) {
            self.sweep_idle_rows(axis, rows, half_step);
        }
        self.idle_axes.is_idle[axis]
    }

    /// Sweeps a segment of a row of some layers along the last axis, as [`Self::sweep_if_idle`] does.
    pub(super) fn sweep_last_axis_if_idle(
        &mut self,
        layers: &Range<usize>,
        tile: &RowSegment,
        half_step: usize,
    ) -> bool {
        if self.is_idle_after_first(D - 1) {
            for layer in layers.clone() {
                self.sweep_idle_segment(D - 1, layer, tile, half_step);
            }
        }
        self.idle_axes.is_idle[D - 1]
    }

    /// Whether an axis is idle and does not come before the first one.
    fn is_idle_after_first(&self, axis: usize) -> bool {
        self.idle_axes.is_idle[axis] && !self.idle_axes.before_first.contains(&axis)
    }

    /// Sweeps rows, numbered over all layers, along an idle axis.
    pub(super) fn sweep_idle_rows(&mut self, axis: usize, rows: Range<usize>, half_step: usize) {
        for row in rows {
            let tile = self.layout.row_segment(row);
            self.sweep_idle_segment(axis, 0, &tile, half_step);
        }
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
