//! Relaxation of stress deviators, a local law with memory variables: an elastic sweep sees the unrelaxed solid at constant
//! viscous strain, and the law lets stress and viscous strain relax exactly at constant strain in between.
//!
//! It stands where the rotation of spins stands, by a whole step or by halves on both sides of the middle, so that the
//! step remains symmetric and of second order. Both commute: relaxation changes the symmetric deviator alone, the rotation
//! the antisymmetric part. Constants are by pattern of media in lanes; a medium that does not relax has those of
//! [`Relaxation::NONE`], by which its viscous strain stays zero.

use super::layout::Tile;
use super::plastic::Matrix;
use super::{Domain, SolverReal};
use crate::simd::{Group, MOST_LANES, Number, Real, Vector, Work};
use crate::solid::medium::Medium;
use models::rheology::relaxation::{Increments, Relaxation, SymmetricTensor};
use models::solid::waves::Field;
use std::ops::Range;

/// The laws by pattern.
#[derive(Clone)]
pub(super) struct Relaxations<T: Real> {
    /// Places of normal stresses and viscous strains.
    normal: [[usize; 2]; 3],
    /// Places of both shear stresses, which may be one, and of the viscous strain.
    shear: Vec<[usize; 3]>,
    /// Over a whole step and a half; `None` where no lane relaxes.
    by_pattern: Vec<Option<[Relaxation<T::Lanes>; 2]>>,
}

impl<T: Real> Relaxations<T> {
    /// `None` where nothing relaxes. The place of a field is its index times `pitch`.
    pub(super) fn new(
        media: &[Medium],
        patterns: &[Vec<u16>],
        fields: &[Field],
        pitch: usize,
        step: f64,
    ) -> Option<Self> {
        let stress = Matrix::new(fields, pitch, Field::Stress);
        let strain = Matrix::new(fields, pitch, Field::ViscousStrain);
        let (normal, strains) = (stress.normal?, strain.normal?);
        let shear = stress.pairs.iter().zip(&strain.pairs);
        let by_pattern = patterns.iter().map(|pattern| {
            let law = |lane: usize| media[usize::from(pattern[lane])].relaxation;
            (0..pattern.len()).any(|lane| law(lane).is_some()).then(|| {
                [1.0, 0.5].map(|part| {
                    let own = |lane: usize| {
                        law(lane).map_or(Relaxation::NONE, |own| own.relaxation_over(part * step))
                    };
                    let lanes = |value: fn(&Relaxation<f64>) -> f64| {
                        T::Lanes::by_lane(|lane| T::of(value(&own(lane))))
                    };
                    Relaxation {
                        strain_per_stress: lanes(|own| own.strain_per_stress),
                        strain_per_strain: lanes(|own| own.strain_per_strain),
                        share: lanes(|own| own.share),
                        stress_per_strain: lanes(|own| own.stress_per_strain),
                        dissipation: lanes(|own| own.dissipation),
                    }
                })
            })
        });
        Some(Self {
            normal: [0, 1, 2].map(|i| [normal[i], strains[i]]),
            shear: shear.map(|(&[one, other], &[strain, _])| [one, other, strain]).collect(),
            by_pattern: by_pattern.collect(),
        })
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Relaxes stresses in a half step of the pass over a whole step (0) or a half (1).
    pub(super) fn relax(&mut self, layers: &Range<usize>, tile: &Tile, half: usize, part: usize) {
        let Some(relaxations) = &self.law.relaxations else { return };
        let volume = self.grid.volume();
        for layer in layers.clone() {
            let (first, groups) = self.layout.groups_of(layer, tile);
            let mut sum = 0.0;
            self.instructions.run::<T>(Relax {
                data: &mut self.data[first..],
                patterns: &self.materials.patterns[groups],
                relaxations,
                part,
                sum: &mut sum,
            });
            self.diagnostics.ledgers[half][layer].viscous += volume * sum;
        }
    }
}

/// The relaxation of groups that follow each other in a row.
struct Relax<'a, T: Real> {
    /// From the first of the groups on.
    data: &'a mut [T::Lanes],
    patterns: &'a [u32],
    relaxations: &'a Relaxations<T>,
    part: usize,
    /// Energy dissipated in these groups, J/m³: of each lane first.
    sum: &'a mut f64,
}

impl<T: Real> Work<T> for Relax<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        match self.relaxations.shear.as_slice() {
            [first] => self.each::<V, 1>([*first]),
            [first, second, third] => self.each::<V, 3>([*first, *second, *third]),
            _ => debug_assert!(false, "one shear stress in plane strain, three in space"),
        }
    }
}

impl<T: Real> Relax<'_, T> {
    #[inline(always)]
    fn each<V: Vector<T>, const SHEARS: usize>(self, shear: [[usize; 3]; SHEARS]) {
        let Relaxations { normal, by_pattern, .. } = self.relaxations;
        let mut sums = [0.0f64; MOST_LANES];
        for (index, &pattern) in self.patterns.iter().enumerate() {
            let Some(constants) = &by_pattern[pattern as usize] else { continue };
            let constants = load::<T, V>(&constants[self.part]);
            let group = &mut self.data[index..];
            let mut stress = SymmetricTensor::<V, SHEARS>::ZERO;
            let mut strain = SymmetricTensor::<V, SHEARS>::ZERO;
            for (i, &[own, viscous]) in normal.iter().enumerate() {
                stress.normal[i] = V::load(&group[own]);
                strain.normal[i] = V::load(&group[viscous]);
            }
            for (i, &[one, other, viscous]) in shear.iter().enumerate() {
                stress.shear[i] = V::HALF * (V::load(&group[one]) + V::load(&group[other]));
                strain.shear[i] = V::load(&group[viscous]);
            }
            let change: Increments<V, SHEARS> = constants.increments(stress, strain);
            for (i, &[own, viscous]) in normal.iter().enumerate() {
                (stress.normal[i] + change.stress.normal[i]).store(&mut group[own]);
                (strain.normal[i] + change.viscous_strain.normal[i]).store(&mut group[viscous]);
            }
            for (i, &[one, other, viscous]) in shear.iter().enumerate() {
                (V::load(&group[one]) + change.stress.shear[i]).store(&mut group[one]);
                if other != one {
                    (V::load(&group[other]) + change.stress.shear[i]).store(&mut group[other]);
                }
                (strain.shear[i] + change.viscous_strain.shear[i]).store(&mut group[viscous]);
            }
            let mut dissipated = T::Lanes::ZERO;
            change.dissipated.store(&mut dissipated);
            for (sum, own) in sums.iter_mut().zip(dissipated.lanes()) {
                *sum += own.wide();
            }
        }
        *self.sum = sums.iter().sum();
    }
}

/// Constants of a group.
#[inline(always)]
fn load<T: Real, V: Vector<T>>(from: &Relaxation<T::Lanes>) -> Relaxation<V> {
    Relaxation {
        strain_per_stress: V::load(&from.strain_per_stress),
        strain_per_strain: V::load(&from.strain_per_strain),
        share: V::load(&from.share),
        stress_per_strain: V::load(&from.stress_per_strain),
        dissipation: V::load(&from.dissipation),
    }
}
