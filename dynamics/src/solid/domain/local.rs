//! Operators that act in each cell on its own: rotation Q, return mapping P, flush of subnormals; and sums over
//! cells.

use super::law::SpinStressRotation;
use super::layout::Tile;
use super::whole_stress::combined;
use super::{Domain, MOST_FIELDS, SolverReal};
use crate::simd::{Group, MOST_LANES, Real, Vector, Work};
use crate::solid::ledger::Energy;
use models::solid::stress::Stress;
use models::solid::waves::Field;
use std::ops::Range;

/// Steps between flushes of subnormals: few, so that little decays below the least normal number in between.
const FLUSH_INTERVAL: usize = 16;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Adds so many steps to the integrals in time of some cells.
    pub(super) fn integrate(&mut self, cells: Range<usize>, steps: f64) {
        let mut integrals = std::mem::take(&mut self.diagnostics.integrals);
        for (place, sums) in &mut integrals {
            for (sum, cell) in sums[cells.clone()].iter_mut().zip(cells.clone()) {
                *sum += steps * self.step * self.at(cell, *place).wide();
            }
        }
        self.diagnostics.integrals = integrals;
    }

    /// The stress in a cell without the initial one.
    pub(super) fn stress(&self, cell: usize) -> Stress {
        let mut values = [T::ZERO; MOST_FIELDS];
        for (value, (_, place)) in values.iter_mut().zip(self.places()) {
            *value = self.at(cell, place);
        }
        self.stress_of(&values)
    }

    /// The stress of a state.
    pub(super) fn stress_of(&self, values: &[T; MOST_FIELDS]) -> Stress {
        let mut stress = Stress::default();
        for (&field, value) in self.fields().iter().zip(values) {
            let value = value.wide();
            match field {
                Field::Stress(i, j) => {
                    stress.force[i][j] = value;
                    // One field stands for both in classical solids.
                    if self.law.rotated.is_empty() {
                        stress.force[j][i] = value;
                    }
                }
                Field::Couple(k, j) => stress.couple[k][j] = value,
                Field::Velocity(_) | Field::Spin(_) | Field::ViscousStrain(..) => {}
            }
        }
        stress
    }

    /// The whole stress in a cell, the initial one included.
    pub fn whole_stress(&self, cell: usize) -> Stress {
        let cell = cell + self.layout.own_cells().start;
        combined(&self.stress(cell), &self.initial_stress(cell), 1.0)
    }

    /// Spins against antisymmetric stress, over a whole step (0) or a half (1).
    pub(super) fn rotate(&mut self, layers: &Range<usize>, tile: &Tile, part: usize) {
        if self.law.rotated.is_empty() {
            return;
        }
        for layer in layers.clone() {
            let (first, groups) = self.layout.groups_of(layer, tile);
            self.instructions.run::<T>(Rotate {
                data: &mut self.data[first..],
                patterns: &self.materials.patterns[groups],
                rotations: &self.law.rotations,
                rotated: &self.law.rotated,
                part,
            });
        }
    }

    /// Every [`FLUSH_INTERVAL`] steps, flushes values below 2⁴⁰ times the least normal number to zero, see [`crate::solid::domain`]. The factor leaves room for products with constants of
    /// the media.
    pub(super) fn flush_subnormals(
        &mut self,
        layer: usize,
        rows: &Range<usize>,
        steps_done: usize,
    ) {
        if !steps_done.is_multiple_of(FLUSH_INTERVAL) {
            return;
        }
        let stored = self.layout.stored(layer, rows);
        let limit = T::of(2.0f64.powi(40) * T::LEAST.wide());
        self.instructions.run::<T>(FlushSubnormals { data: &mut self.data[stored], limit });
        for stored in self.interfaces.stored(&self.layout, layer, rows) {
            let data = &mut self.interfaces.memory[stored];
            self.instructions.run::<T>(FlushSubnormals { data, limit });
        }
    }

    /// Energy by own layer across the last axis.
    pub(crate) fn energies(&self) -> Vec<Energy> {
        let mut energies = vec![Energy::default(); self.diagnostics.totals.len()];
        self.instructions.run::<T>(Energies { domain: self, energies: &mut energies });
        self.add_interlayer_energy(&mut energies);
        energies
    }
}

/// Q on groups that follow each other in a row.
struct Rotate<'a, T: Real> {
    /// From the first of the groups on.
    data: &'a mut [T::Lanes],
    patterns: &'a [u32],
    rotations: &'a [[SpinStressRotation<T::Lanes>; 2]],
    rotated: &'a [[usize; 3]],
    part: usize,
}

impl<T: Real> Work<T> for Rotate<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        for (index, &pattern) in self.patterns.iter().enumerate() {
            let group = &mut self.data[index..];
            let [cos, ratio_sin, sin_over_ratio] = &self.rotations[pattern as usize][self.part];
            let (cos, ratio_sin) = (V::load(cos), V::load(ratio_sin));
            let sin_over_ratio = V::load(sin_over_ratio);
            for &[spin, first, second] in self.rotated {
                let omega = V::load(&group[spin]);
                let (a, b) = (V::load(&group[first]), V::load(&group[second]));
                let half = V::HALF * (a - b);
                let turned = half * cos + ratio_sin * omega - half;
                (omega * cos - half * sin_over_ratio).store(&mut group[spin]);
                (a + turned).store(&mut group[first]);
                (b - turned).store(&mut group[second]);
            }
        }
    }
}

/// Flushes values below a limit to zero.
struct FlushSubnormals<'a, T: Real> {
    data: &'a mut [T::Lanes],
    limit: T,
}

impl<T: Real> Work<T> for FlushSubnormals<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let limit = <V as Vector<T>>::all(self.limit);
        for group in self.data {
            V::load(group).unless_below(limit).store(group);
        }
    }
}

/// The energy of layers.
struct Energies<'a, T: SolverReal, const D: usize> {
    domain: &'a Domain<T, D>,
    energies: &'a mut [Energy],
}

impl<T: SolverReal, const D: usize> Work<T> for Energies<'_, T, D> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Domain { layout, materials, data, .. } = self.domain;
        let (terms, patterns) = (&materials.energy_terms, &materials.patterns);
        let (rows, groups) = (layout.rows, layout.groups);
        let volume = self.domain.grid.volume();
        for (energy, layer) in self.energies.iter_mut().zip(layout.own_layers()) {
            // Sums of each lane on its own, in numbers of twice the digits where there are such.
            let mut sums = [[0.0f64; MOST_LANES]; 2];
            let rows = layer * rows..(layer + 1) * rows;
            for (row, group) in rows.flat_map(|row| (0..groups).map(move |group| (row, group))) {
                let index = layout.index(row, group);
                let factors = &terms.factors[patterns[index.group] as usize];
                let group = &data[index.data..];
                for (term, (&[one, other], factor)) in terms.places.iter().zip(factors).enumerate()
                {
                    let sums = &mut sums[usize::from(term >= terms.kinetic)];
                    let lanes = factor.lanes().iter().zip(group[one].lanes());
                    for (sum, ((factor, one), other)) in
                        sums.iter_mut().zip(lanes.zip(group[other].lanes()))
                    {
                        *sum += factor.wide() * one.wide() * other.wide();
                    }
                }
            }
            let [kinetic, stored] = sums.map(|lanes| volume * lanes.iter().sum::<f64>());
            *energy = Energy { kinetic, stored, ..Energy::default() };
        }
    }
}
