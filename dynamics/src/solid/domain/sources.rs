//! Sources inside the domain, and gravity.

use super::layout::{Layout, Tile};
use super::{Domain, SolverReal};
use crate::simd::{Group, Real};
use crate::solid::boundary::{Signal, Source};
use models::solid::waves::Field;
use std::collections::BTreeMap;
use std::ops::Range;

/// A source on the cells of a domain.
#[derive(Clone)]
pub(super) struct CellSource {
    /// Groups, lanes and shares, in order.
    cells: Vec<(usize, usize, f64)>,
    /// Place of the field, and amplitude.
    amplitudes: Vec<(usize, f64)>,
    signal: Signal,
    /// By half step of the pass: the mean of the signal times its duration, and its change.
    now: Vec<[f64; 2]>,
}

/// All that acts inside.
#[derive(Clone)]
pub(super) struct Sources<const D: usize> {
    pub(super) list: Vec<CellSource>,
    /// m/s².
    pub(super) acceleration: [f64; D],
}

impl CellSource {
    /// A source of a problem on the layers of a part of it; `halves` are the half steps of a pass.
    pub(super) fn new<const D: usize>(
        source: &Source,
        fields: &[Field],
        layers: &[usize],
        layout: &Layout<D>,
        halves: usize,
    ) -> Self {
        // Where each layer of the whole stands.
        let mut standing: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, &layer) in layers.iter().enumerate() {
            standing.entry(layer).or_default().push(index);
        }
        let layer = layout.layer_cells();
        let mut cells = Vec::new();
        for &(cell, share) in &source.cells {
            for index in standing.get(&(cell / layer)).into_iter().flatten() {
                let (index, lane) = layout.slot(index * layer + cell % layer);
                cells.push((index.group, lane, share));
            }
        }
        cells.sort_by_key(|&(group, lane, _)| (group, lane));
        let place = |field| Some(fields.iter().position(|own| *own == field)? * layout.pitch);
        let amplitudes = source.amplitudes.iter();
        let amplitudes = amplitudes.filter_map(|&(f, a)| Some((place(f)?, a))).collect();
        Self { cells, amplitudes, signal: source.signal.clone(), now: vec![[0.0; 2]; halves] }
    }

    /// Integrates the signal over a half step of the pass, s.
    pub(super) fn set_time(&mut self, half: usize, [from, to]: [f64; 2]) {
        // Before the beginning there is none: what is there at once comes with the first step.
        let before = if from > 0.0 { (self.signal)(from) } else { 0.0 };
        let mean = (self.signal)(0.5 * (from + to));
        self.now[half] = [mean * (to - from), (self.signal)(to) - before];
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Sources and gravity over a half step of the pass.
    pub(super) fn apply_sources(&mut self, layers: &Range<usize>, tile: &Tile, half: usize) {
        let sources = std::mem::take(&mut self.sources.list);
        for source in &sources {
            self.apply_source(source, layers, tile, half);
        }
        self.sources.list = sources;
        for (axis, acceleration) in self.sources.acceleration.into_iter().enumerate() {
            if acceleration != 0.0 {
                self.apply_gravity(axis, acceleration, (layers, tile), half);
            }
        }
    }

    fn apply_source(
        &mut self,
        source: &CellSource,
        layers: &Range<usize>,
        tile: &Tile,
        half: usize,
    ) {
        let volume = self.grid.volume();
        let [impulse, moment] = source.now[half];
        for layer in layers.clone() {
            let groups = self.layout.groups_of(layer, tile).1;
            let [from, to] = [groups.start, groups.end]
                .map(|group| source.cells.partition_point(|cell| cell.0 < group));
            for &(group, lane, share) in &source.cells[from..to] {
                let Some(cell) = self.layout.cell_of(group, lane) else { continue };
                for &(place, amplitude) in &source.amplitudes {
                    let inertia =
                        self.materials.of(cell).inertia(self.fields()[place / self.layout.pitch]);
                    let work = if inertia > 0.0 {
                        let change = amplitude * share * impulse / (inertia * volume);
                        push(self.at_mut(cell, place), change) * inertia
                    } else {
                        let before = self.materials.of(cell).stored_energy(&self.stress(cell));
                        let value =
                            self.at(cell, place).wide() - amplitude * share * moment / volume;
                        *self.at_mut(cell, place) = T::of(value);
                        self.materials.of(cell).stored_energy(&self.stress(cell)) - before
                    };
                    self.diagnostics.ledgers[half][layer].sources += volume * work;
                }
            }
        }
    }

    fn apply_gravity(
        &mut self,
        axis: usize,
        acceleration: f64,
        (layers, tile): (&Range<usize>, &Tile),
        half: usize,
    ) {
        let volume = self.grid.volume();
        let Some(place) = self.place(Field::Velocity(axis)) else { return };
        let change = acceleration * 0.5 * self.step;
        for layer in layers.clone() {
            let (first, groups) = self.layout.groups_of(layer, tile);
            for (index, group) in groups.enumerate() {
                for lane in 0..T::Lanes::COUNT {
                    let Some(cell) = self.layout.cell_of(group, lane) else { continue };
                    let inertia = self.materials.of(cell).inertia(Field::Velocity(axis));
                    let value = &mut self.data[first + index + place].lanes_mut()[lane];
                    let work = volume * inertia * push(value, change);
                    self.diagnostics.ledgers[half][layer].sources += work;
                }
            }
        }
    }
}

/// Adds to a velocity; the energy that it takes, per inertia.
fn push<T: Real>(value: &mut T, change: f64) -> f64 {
    let before = value.wide();
    *value = T::of(before + change);
    let after = value.wide();
    (after - before) * 0.5 * (after + before)
}
