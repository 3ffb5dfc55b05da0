//! Relaxation of stress deviators, a cell law with history variables: a sweep treats the solid as unrelaxed at
//! constant viscous strain, and between sweeps stress and viscous strain relax exactly at constant total strain.
//!
//! Relaxation is applied where the rotation of spins is, over a whole step, or over two halves before and after the
//! middle, so that the step remains symmetric and of second order. The two commute: relaxation changes the symmetric
//! deviator only, the rotation the antisymmetric part only. Constants are by lane pattern; a medium without relaxation
//! has the constants [`Relaxation::ELASTIC`], for which its viscous strain stays zero.

use super::layout::RowSegment;
use super::{Domain, SolverReal};
use crate::simd::{LaneGroup, Number, Real, SimdKernel, Vector};
use crate::solid::cell_laws::{
    LawInterval, RelaxedFields, find_relaxed_fields, relax, relaxation_coefficients,
};
use crate::solid::medium::Medium;
use models::rheology::relaxation::Relaxation;
use models::solid::waves::SolidField;
use std::ops::Range;

/// Relaxation laws by lane pattern.
#[derive(Clone)]
pub(super) struct LaneRelaxations<T: Real> {
    /// Offsets of the stresses that relax and of their viscous strains.
    fields: RelaxedFields,
    /// By lane pattern, the relaxation of its lanes; `None` if no lane relaxes.
    by_pattern: Vec<Option<PatternRelaxation<T>>>,
}

/// Mask of the lanes that relax, and constants over a whole step and over half a step.
type PatternRelaxation<T> = (u16, [Relaxation<<T as Real>::Lanes>; 2]);

impl<T: Real> LaneRelaxations<T> {
    /// Creates the laws for a time step `step`, s; `None` if no medium relaxes. The offset of a field is its index
    /// times `pitch`.
    pub(super) fn new(
        media: &[Medium],
        patterns: &[Vec<u16>],
        fields: &[SolidField],
        pitch: usize,
        step: f64,
    ) -> Option<Self> {
        let (normal, shear) = find_relaxed_fields(fields)?;
        let normal = normal.map(|own| own.map(|index| index * pitch));
        let shear = shear.into_iter().map(|own| own.map(|index| index * pitch)).collect();
        let by_pattern = patterns.iter().map(|pattern| {
            let medium = |lane: usize| &media[usize::from(pattern[lane])];
            let relaxes = |lane: usize| u16::from(medium(lane).relaxation.is_some()) << lane;
            let relaxing_lanes = (0..pattern.len()).map(relaxes).sum();
            (relaxing_lanes != 0).then(|| {
                let lanes = |value: &dyn Fn(&Medium) -> f64| {
                    T::Lanes::from_lanes(|lane| T::from_f64(value(medium(lane))))
                };
                (
                    relaxing_lanes,
                    LawInterval::evaluate_both(|step_fraction| {
                        relaxation_coefficients(lanes, step_fraction, step)
                    }),
                )
            })
        });
        Some(Self { fields: (normal, shear), by_pattern: by_pattern.collect() })
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Relaxes stresses over `interval` in a segment of the rows of some layers.
    pub(super) fn relax(
        &mut self,
        layers: &Range<usize>,
        tile: &RowSegment,
        interval: LawInterval,
    ) {
        let Some(relaxations) = &self.lane_laws.relaxations else { return };
        let lanes = T::Lanes::COUNT;
        for layer in layers.clone() {
            let (first, groups) = self.layout.segment_groups(layer, tile);
            let tile_lanes = groups.start * lanes..groups.end * lanes;
            self.instructions.run_kernel::<T>(RelaxationKernel {
                field_data: &mut self.field_data[first..],
                lane_pattern_indices: &self.materials.lane_pattern_indices[groups],
                relaxations,
                interval,
                dissipation: &mut self.diagnostics.dissipation.viscous_dissipation[tile_lanes],
            });
        }
    }
}

/// Kernel: relaxation of stresses in adjacent groups of a row.
struct RelaxationKernel<'a, T: Real> {
    /// Field values from the first of these groups on.
    field_data: &'a mut [T::Lanes],
    lane_pattern_indices: &'a [u32],
    relaxations: &'a LaneRelaxations<T>,
    interval: LawInterval,
    /// Accumulated viscous dissipation by group and lane, J/m³.
    dissipation: &'a mut [f64],
}

impl<T: Real> SimdKernel<T> for RelaxationKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        match self.relaxations.fields.1.as_slice() {
            [first] => self.relax_groups::<V, 1>([*first]),
            [first, second, third] => self.relax_groups::<V, 3>([*first, *second, *third]),
            _ => debug_assert!(false, "one shear stress in plane strain, three in space"),
        }
    }
}

impl<T: Real> RelaxationKernel<'_, T> {
    #[inline(always)]
    fn relax_groups<V: Vector<T>, const SHEAR_COUNT: usize>(
        self,
        shear_offsets: [[usize; 3]; SHEAR_COUNT],
    ) {
        let LaneRelaxations { fields: (normal_places, _), by_pattern } = self.relaxations;
        let count = T::Lanes::COUNT;
        for (index, &pattern) in self.lane_pattern_indices.iter().enumerate() {
            let Some((lanes, constants)) = &by_pattern[pattern as usize] else { continue };
            let constants = load_relaxation::<T, V>(&constants[self.interval as usize]);
            let group = &mut self.field_data[index..];
            let (mut normal, mut shear) = ([[V::ZERO; 2]; 3], [[V::ZERO; 3]; SHEAR_COUNT]);
            for (values, &[own, viscous]) in normal.iter_mut().zip(normal_places) {
                *values = [V::load(&group[own]), V::load(&group[viscous])];
            }
            for (values, &[one, other, viscous]) in shear.iter_mut().zip(&shear_offsets) {
                *values = [V::load(&group[one]), V::load(&group[other]), V::load(&group[viscous])];
            }
            let energy_loss = relax(&constants, &mut normal, &mut shear);
            for (values, &[own, viscous]) in normal.iter().zip(normal_places) {
                store_lanes(group, own, *lanes, values[0]);
                store_lanes(group, viscous, *lanes, values[1]);
            }
            for (values, &[one, other, viscous]) in shear.iter().zip(&shear_offsets) {
                store_lanes(group, one, *lanes, values[0]);
                store_lanes(group, other, *lanes, values[1]);
                store_lanes(group, viscous, *lanes, values[2]);
            }
            let mut lane_losses = T::Lanes::ZERO;
            V::ZERO.blend_lanes(*lanes, energy_loss).store(&mut lane_losses);
            let sums = &mut self.dissipation[index * count..][..count];
            for (sum, own) in sums.iter_mut().zip(lane_losses.lanes()) {
                *sum += own.to_f64();
            }
        }
    }
}

/// Sets the masked lanes of a field; all others are unchanged, the sign of zeros included.
#[inline(always)]
fn store_lanes<T: Real, V: Vector<T>>(group: &mut [T::Lanes], offset: usize, lanes: u16, value: V) {
    V::load(&group[offset]).blend_lanes(lanes, value).store(&mut group[offset]);
}

/// Loads the relaxation constants of a group.
#[inline(always)]
fn load_relaxation<T: Real, V: Vector<T>>(from: &Relaxation<T::Lanes>) -> Relaxation<V> {
    Relaxation {
        strain_per_stress: V::load(&from.strain_per_stress),
        strain_per_strain: V::load(&from.strain_per_strain),
        relaxed_fraction: V::load(&from.relaxed_fraction),
        stress_per_strain: V::load(&from.stress_per_strain),
        dissipation: V::load(&from.dissipation),
    }
}
