//! Laws of a cell between sweeps: sources, gravity, spin–stress rotation, relaxation, return mapping with its energies,
//! and flushing of subnormal numbers. Shared by the fused solver and [`Reference`](crate::solid::reference::Reference).

use crate::simd::{Number, Real};
use crate::solid::boundary::Signal;
use crate::solid::medium::Medium;
use models::common::elementary::Elementary;
use models::rheology::relaxation::{Relaxation, RelaxationIncrements, SymmetricTensor};
use models::solid::stress::Stress;
use models::solid::waves::SolidField;

/// Time interval over which a cell law acts; the constants of a law are stored for both intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LawInterval {
    /// A whole time step Δt.
    Step,
    /// Half a time step, Δt/2.
    HalfStep,
}

impl LawInterval {
    /// Evaluates `value` for both intervals, given as fractions of Δt.
    pub(crate) fn evaluate_both<R>(value: impl FnMut(f64) -> R) -> [R; 2] {
        [1.0, 0.5].map(value)
    }
}

/// Maximum number of fields: three velocities, three spins, nine stresses, nine couple stresses, six viscous strains; more
/// than in media with contacts.
pub(crate) const MAX_FIELDS: usize = 30;

/// Number of steps between two flushes of subnormal numbers: so few that values rarely become subnormal in between.
const FLUSH_INTERVAL: usize = 16;

/// Returns the magnitude below which values are set to zero, 2⁴⁰·MIN_POSITIVE, if `steps_done` is a multiple of
/// [`FLUSH_INTERVAL`]; else `None`. The factor 2⁴⁰ is a margin for products with constants of the media.
pub(crate) fn flush_limit<T: Real>(steps_done: usize) -> Option<T> {
    steps_done
        .is_multiple_of(FLUSH_INTERVAL)
        .then(|| T::from_f64(2.0f64.powi(40) * T::MIN_POSITIVE.to_f64()))
}

/// Converts the values of a state, in the order of `fields`, to stress tensors.
pub(crate) fn stress_from_fields<T: Real>(fields: &[SolidField], values: &[T]) -> Stress {
    // In classical solids one field represents both symmetric components.
    let is_symmetric = !fields.iter().any(|field| matches!(field, SolidField::Spin(_)));
    let mut stress = Stress::default();
    for (&field, value) in fields.iter().zip(values) {
        let value = value.to_f64();
        match field {
            SolidField::Stress(i, j) => {
                stress.force[i][j] = value;
                if is_symmetric {
                    stress.force[j][i] = value;
                }
            }
            SolidField::Couple(k, j) => stress.couple[k][j] = value,
            _ => {}
        }
    }
    stress
}

/// Computes a + `factor`·b for two stresses a and b, Pa.
pub(crate) fn add_scaled(a: &Stress, b: &Stress, factor: f64) -> Stress {
    let part = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
    };
    Stress { force: part(a.force, b.force), couple: part(a.couple, b.couple) }
}

/// Adds `change` to a velocity or spin; returns the change of kinetic energy per inertia, computed from the rounded
/// values.
pub(crate) fn accelerate<T: Real>(value: &mut T, change: f64) -> f64 {
    let before = value.to_f64();
    *value = T::from_f64(before + change);
    let after = value.to_f64();
    (after - before) * 0.5 * (after + before)
}

/// Integrates the signal of a source over an interval, s: returns the midpoint value times the duration, s, and the
/// change of the signal (from 0, if the interval starts at time 0).
pub(crate) fn integrate_signal(signal: &Signal, [from, to]: [f64; 2]) -> [f64; 2] {
    // The signal is zero before time 0, so that an initial jump acts in the first step.
    let before = if from > 0.0 { signal(from) } else { 0.0 };
    let mean = signal(0.5 * (from + to));
    [mean * (to - from), signal(to) - before]
}

/// Applies a source to a field of a cell over an interval; returns its work, J/m³. `strength`: amplitude times share of
/// the cell; `impulse` and `moment`: results of [`integrate_signal`]; `volume` of the cell, m³. Forces and couples
/// change velocities and spins, moments reduce stresses.
pub(crate) fn apply_source<T: Real>(
    medium: &Medium,
    state: &mut [T],
    field: usize,
    strength: f64,
    [impulse, moment]: [f64; 2],
    volume: f64,
) -> f64 {
    let fields = &medium.fields;
    let inertia = medium.inertia(fields[field]);
    if inertia > 0.0 {
        let change = strength * impulse / (inertia * volume);
        accelerate(&mut state[field], change) * inertia
    } else {
        let before = medium.stored_energy(&stress_from_fields(fields, state));
        state[field] = T::from_f64(state[field].to_f64() - strength * moment / volume);
        medium.stored_energy(&stress_from_fields(fields, state)) - before
    }
}

/// Returns, for each spin k, the field indices of the spin and of the stresses ij and ji (ijk cyclic) whose
/// antisymmetric part rotates with it.
pub(crate) fn rotated_fields(fields: &[SolidField]) -> Vec<[usize; 3]> {
    let index = |field: SolidField| fields.iter().position(|own| *own == field);
    let triple = |k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        Some([
            index(SolidField::Spin(k))?,
            index(SolidField::Stress(i, j))?,
            index(SolidField::Stress(j, i))?,
        ])
    };
    (0..3).filter_map(triple).collect()
}

/// Coefficients of the rotation of a spin and antisymmetric stress over a time t: cos(Ωt), r sin(Ωt) and sin(Ωt)/r,
/// with the frequency Ω, rad/s, and the amplitude ratio r, Pa·s, of
/// [`SpinRotation`](models::solid::waves::SpinRotation).
pub(crate) type SpinStressRotation<N> = [N; 3];

/// Computes the rotation coefficients of a medium over `step_fraction`·`step`, s; for a medium without rotation, those
/// of the identity.
pub(crate) fn spin_stress_rotation(
    medium: &Medium,
    step_fraction: f64,
    step: f64,
) -> SpinStressRotation<f64> {
    let Some(rotation) = medium.rotation else { return [1.0, 0.0, 0.0] };
    let (sin, cos) = (rotation.frequency * step_fraction * step).cr_sin_cos();
    [cos, rotation.ratio * sin, sin / rotation.ratio]
}

/// Rotates a spin ω and the antisymmetric part a = ½(first − second) of two stresses, with r of [`SpinStressRotation`]:
/// a ← a cos + r ω sin, ω ← ω cos − a sin/r.
#[inline(always)]
pub(crate) fn rotate_spin_stress<N: Number>(
    [cos, ratio_sin, sin_over_ratio]: SpinStressRotation<N>,
    [omega, first, second]: [N; 3],
) -> [N; 3] {
    let half = N::HALF * (first - second);
    let stress_change = half * cos + ratio_sin * omega - half;
    [omega * cos - half * sin_over_ratio, first + stress_change, second - stress_change]
}

/// Indices of the fields that relax: \[normal stress, viscous strain\] by axis; \[shear stress ij, shear stress ji (may
/// be the same field), viscous strain\] by plane.
pub(crate) type RelaxedFields = ([[usize; 2]; 3], Vec<[usize; 3]>);

/// Finds the fields that relax in a list of fields; `None` if nothing relaxes.
pub(crate) fn find_relaxed_fields(fields: &[SolidField]) -> Option<RelaxedFields> {
    let index = |field: SolidField| fields.iter().position(|own| *own == field);
    let normal = |i: usize| {
        Some([index(SolidField::Stress(i, i))?, index(SolidField::ViscousStrain(i, i))?])
    };
    let shear = [[0, 1], [0, 2], [1, 2]].into_iter().filter_map(|[i, j]| {
        let [upper, lower] = [index(SolidField::Stress(i, j)), index(SolidField::Stress(j, i))];
        Some([upper.or(lower)?, lower.or(upper)?, index(SolidField::ViscousStrain(i, j))?])
    });
    Some(([normal(0)?, normal(1)?, normal(2)?], shear.collect()))
}

/// Computes the coefficients of relaxation over `step_fraction`·`step`, s; `collect` converts a coefficient, given as a
/// function of the medium, to a number `N`, whose lanes may belong to different media.
pub(crate) fn relaxation_coefficients<N>(
    collect: impl Fn(&dyn Fn(&Medium) -> f64) -> N,
    step_fraction: f64,
    step: f64,
) -> Relaxation<N> {
    let constant = |of: fn(&Relaxation<f64>) -> f64| {
        collect(&|medium| {
            of(&medium
                .relaxation
                .map_or(Relaxation::ELASTIC, |own| own.compute_relaxation(step_fraction * step)))
        })
    };
    Relaxation {
        strain_per_stress: constant(|own| own.strain_per_stress),
        strain_per_strain: constant(|own| own.strain_per_strain),
        relaxed_fraction: constant(|own| own.relaxed_fraction),
        stress_per_strain: constant(|own| own.stress_per_strain),
        dissipation: constant(|own| own.dissipation),
    }
}

/// Relaxes stresses and viscous strains: `normal` by axis, `shear` by plane, in the order of [`RelaxedFields`]. Returns
/// the energy dissipated, J/m³.
#[inline(always)]
pub(crate) fn relax<N: Number, const SHEAR_COUNT: usize>(
    constants: &Relaxation<N>,
    normal: &mut [[N; 2]; 3],
    shear: &mut [[N; 3]; SHEAR_COUNT],
) -> N {
    let mut stress = SymmetricTensor::<N, SHEAR_COUNT>::ZERO;
    let mut strain = SymmetricTensor::<N, SHEAR_COUNT>::ZERO;
    for (i, &[own, viscous]) in normal.iter().enumerate() {
        stress.normal[i] = own;
        strain.normal[i] = viscous;
    }
    for (i, &[one, other, viscous]) in shear.iter().enumerate() {
        stress.shear[i] = N::HALF * (one + other);
        strain.shear[i] = viscous;
    }
    let change: RelaxationIncrements<N, SHEAR_COUNT> = constants.compute_increments(stress, strain);
    for (i, [own, viscous]) in normal.iter_mut().enumerate() {
        *own = *own + change.stress.normal[i];
        *viscous = *viscous + change.viscous_strain.normal[i];
    }
    for (i, [one, other, viscous]) in shear.iter_mut().enumerate() {
        *one = *one + change.stress.shear[i];
        *other = *other + change.stress.shear[i];
        *viscous = *viscous + change.viscous_strain.shear[i];
    }
    change.dissipated_energy
}

/// Result of the return mapping of a cell's stress.
pub(crate) struct MappedStress {
    /// Stress after the return mapping, as deviation from the initial stress, Pa.
    pub(crate) stress: Stress,
    /// Plastic dissipation of the mapping, J/m³.
    pub(crate) dissipation: f64,
    /// Work of the initial stress on the plastic strain, J/m³; 0 without initial stress.
    pub(crate) initial_stress_work: f64,
    /// Plastic dissipation divided by the energy stored by the trial stress (total stress before the mapping).
    pub(crate) dissipation_ratio: f64,
}

/// Weight w of a reflection, 2P − I, in [`map_stress`].
pub(crate) const REFLECTION: f64 = -1.0;

/// Returns whether a stress is outside the yield set of its medium, if the fields are `factor` times the physical fields.
pub(crate) fn is_outside_yield_set(medium: &Medium, factor: f64, stress: &Stress) -> bool {
    let physical = add_scaled(&Stress::default(), stress, 1.0 / factor);
    medium.project(&physical).stress != physical
}

/// Maps a stress as [`map_stress`] does, if the fields are `factor` times the physical fields.
pub(crate) fn map_scaled_stress(
    medium: &Medium,
    factor: f64,
    deviation: &Stress,
    initial: Option<&Stress>,
    weight: f64,
) -> Option<MappedStress> {
    if factor == 1.0 {
        return map_stress(medium, deviation, initial, weight);
    }
    let zero = Stress::default();
    let physical = add_scaled(&zero, deviation, 1.0 / factor);
    let mapped = map_stress(medium, &physical, initial, weight)?;
    Some(MappedStress {
        stress: add_scaled(&zero, &mapped.stress, factor),
        dissipation: factor * factor * mapped.dissipation,
        initial_stress_work: factor * factor * mapped.initial_stress_work,
        dissipation_ratio: mapped.dissipation_ratio,
    })
}

/// Applies the return mapping P + w(I − P) to the stress given by its deviation from the initial stress; w = 0 is the
/// projection P, w = −1 the reflection 2P − I, and 0 < w < 1 leaves the part w of the overstress. `None` if P leaves the
/// total stress unchanged, since it is in its yield set.
pub(crate) fn map_stress(
    medium: &Medium,
    deviation: &Stress,
    initial: Option<&Stress>,
    weight: f64,
) -> Option<MappedStress> {
    let zero = Stress::default();
    let offset = initial.unwrap_or(&zero);
    let trial = add_scaled(deviation, offset, 1.0);
    let projection = medium.project(&trial);
    if projection.stress == trial {
        return None;
    }
    let factor = 1.0 - weight;
    let plastic = add_scaled(&trial, &projection.stress, -1.0);
    let energy = |stress: &Stress| medium.stored_energy(stress);
    // With the trial stress s̄, its projection s, d = s̄ − s and the energy norm |·|: ½|s̄|² − ½|s + wd|² = (1 − w)(½|s̄|² −
    // ½|s|² + ½w|d|²).
    let energy_of_rest = if weight == 0.0 { 0.0 } else { weight * energy(&plastic) };
    let dissipation = factor * (projection.energy_lost + energy_of_rest);
    // Inner product, in the energy norm, of the plastic stress change and the initial stress.
    let initial_stress_work = initial.map_or(0.0, |initial| {
        let combined = add_scaled(&plastic, initial, 1.0);
        factor * (energy(&combined) - energy(&plastic) - energy(initial))
    });
    let dissipation_ratio = dissipation / energy(&trial).max(f64::MIN_POSITIVE);
    debug_assert!(
        dissipation_ratio >= -1e-14,
        "the correction adds energy: {dissipation_ratio:e} of what is there"
    );
    let mapped = match weight == 0.0 {
        true => projection.stress,
        false => add_scaled(&projection.stress, &plastic, weight),
    };
    Some(MappedStress {
        stress: add_scaled(&mapped, offset, -1.0),
        dissipation,
        initial_stress_work,
        dissipation_ratio,
    })
}
