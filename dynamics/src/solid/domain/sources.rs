//! Sources inside the domain, and gravity.

use super::layout::{Layout, RowSegment};
use super::{Domain, SolverReal};
use crate::simd::LaneGroup;
use crate::solid::boundary::{Signal, Source};
use crate::solid::cell_laws::{accelerate, apply_source, integrate_signal};
use models::solid::waves::SolidField;
use std::ops::Range;

/// Source distributed over cells of a domain.
#[derive(Clone)]
pub(super) struct CellSource {
    /// Group, lane and share of the source of each cell, in ascending order of group and lane.
    cells: Vec<(usize, usize, f64)>,
    /// Offset of each field on which the source acts, and amplitude.
    amplitudes: Vec<(usize, f64)>,
    signal: Signal,
    /// By half step of the pass: integral of the signal by the midpoint rule, s, and change of the signal.
    signal_integrals: Vec<[f64; 2]>,
}

/// Sources and gravity.
#[derive(Clone)]
pub(super) struct Sources<const D: usize> {
    pub(super) cell_sources: Vec<CellSource>,
    /// Acceleration of gravity, m/s².
    pub(super) acceleration: [f64; D],
}

impl CellSource {
    /// Creates a source of the problem of a subdomain; `halves` is the number of half steps of a pass.
    pub(super) fn new<const D: usize>(
        source: &Source,
        fields: &[SolidField],
        layout: &Layout<D>,
        halves: usize,
    ) -> Self {
        let position_in_lanes = |&(cell, share): &(usize, f64)| {
            let (index, lane) = layout.lane_index(cell);
            (index.group, lane, share)
        };
        let mut cells: Vec<_> = source.cells.iter().map(position_in_lanes).collect();
        cells.sort_by_key(|&(group, lane, _)| (group, lane));
        let field_offset =
            |field| Some(fields.iter().position(|own| *own == field)? * layout.pitch);
        let amplitudes = source.amplitudes.iter();
        let amplitudes = amplitudes.filter_map(|&(f, a)| Some((field_offset(f)?, a))).collect();
        Self {
            cells,
            amplitudes,
            signal: source.signal.clone(),
            signal_integrals: vec![[0.0; 2]; halves],
        }
    }

    /// Evaluates the signal over half step `half` of the pass; `interval`: start and end of the half step, s.
    pub(super) fn set_time(&mut self, half: usize, interval: [f64; 2]) {
        self.signal_integrals[half] = integrate_signal(&self.signal, interval);
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Applies sources and gravity over a half step of the pass.
    pub(super) fn apply_sources(&mut self, layers: &Range<usize>, tile: &RowSegment, half: usize) {
        let sources = std::mem::take(&mut self.sources.cell_sources);
        for source in &sources {
            self.apply_source(source, layers, tile, half);
        }
        self.sources.cell_sources = sources;
        for (axis, acceleration) in self.sources.acceleration.into_iter().enumerate() {
            if acceleration != 0.0 {
                self.apply_gravity(axis, acceleration, layers, tile);
            }
        }
    }

    fn apply_source(
        &mut self,
        source: &CellSource,
        layers: &Range<usize>,
        tile: &RowSegment,
        half: usize,
    ) {
        let volume = self.grid.volume();
        let signal_integrals = source.signal_integrals[half];
        for layer in layers.clone() {
            let groups = self.layout.segment_groups(layer, tile).1;
            let [from, to] = [groups.start, groups.end]
                .map(|group| source.cells.partition_point(|cell| cell.0 < group));
            for &(group, lane, share) in &source.cells[from..to] {
                let Some(cell) = self.layout.cell_in_lane(group, lane) else { continue };
                for &(place, amplitude) in &source.amplitudes {
                    let (mut state, field) = (self.cell_state(cell), place / self.layout.pitch);
                    let (medium, strength) = (self.materials.medium(cell), amplitude * share);
                    let work =
                        apply_source(medium, &mut state, field, strength, signal_integrals, volume);
                    *self.value_at_mut(cell, place) = state[field];
                    if self.layout.owned_index(cell).is_some() {
                        self.diagnostics.work.source_work.add(work);
                    }
                }
            }
        }
    }

    fn apply_gravity(
        &mut self,
        axis: usize,
        acceleration: f64,
        layers: &Range<usize>,
        tile: &RowSegment,
    ) {
        let Some(offset) = self.field_offset(SolidField::Velocity(axis)) else { return };
        let change = acceleration * 0.5 * self.step;
        for layer in layers.clone() {
            let (first, groups) = self.layout.segment_groups(layer, tile);
            let is_owned = self.layout.is_owned_row(layer, tile.row);
            for (index, group) in groups.enumerate() {
                let owned_lanes = self.layout.owned_lanes[tile.groups.start + index];
                for lane in 0..T::Lanes::COUNT {
                    let Some(cell) = self.layout.cell_in_lane(group, lane) else { continue };
                    let inertia = self.materials.medium(cell).inertia(SolidField::Velocity(axis));
                    let value = &mut self.field_data[first + index + offset].lanes_mut()[lane];
                    let work = inertia * accelerate(value, change);
                    if is_owned && owned_lanes >> lane & 1 == 1 {
                        self.diagnostics.work.source_work.add(work);
                    }
                }
            }
        }
    }
}
