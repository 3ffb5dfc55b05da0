//! Contact by cone beside a plastic skeleton, in lanes; see [`super::contacts`].

use super::component_offsets::ComponentOffsets;
use super::contacts::{granular_lanes, load_granular};
use crate::simd::{LaneGroup, Number, Real, Vector};
use crate::solid::contact_law::TensorPlaces;
use models::porous::{PlasticPoreConeLaw, PoreConeLaw};

/// Returns the constants of pores with contact by cone by lane.
pub(super) fn cone_lanes<T: Real>(
    law: impl Fn(usize) -> PoreConeLaw<f64>,
) -> PoreConeLaw<T::Lanes> {
    let lanes =
        |of: fn(&PoreConeLaw<f64>) -> f64| T::Lanes::from_lanes(|lane| T::from_f64(of(&law(lane))));
    PoreConeLaw {
        contact: granular_lanes::<T>(|lane| law(lane).contact),
        bulk_share: lanes(|own| own.bulk_share),
        shear_share: lanes(|own| own.shear_share),
        offset: lanes(|own| own.offset),
    }
}

/// Loads the constants of pores with contact by cone.
#[inline(always)]
pub(super) fn load_cone<T: Real, V: Vector<T>>(law: &PoreConeLaw<T::Lanes>) -> PoreConeLaw<V> {
    PoreConeLaw {
        contact: load_granular::<T, V>(&law.contact),
        bulk_share: V::load(&law.bulk_share),
        shear_share: V::load(&law.shear_share),
        offset: V::load(&law.offset),
    }
}

/// Returns the constants of the law by lane.
pub(super) fn plastic_cone_lanes<T: Real>(
    law: impl Fn(usize) -> PlasticPoreConeLaw<f64>,
) -> PlasticPoreConeLaw<T::Lanes> {
    let lanes = |of: fn(&PlasticPoreConeLaw<f64>) -> f64| {
        T::Lanes::from_lanes(|lane| T::from_f64(of(&law(lane))))
    };
    PlasticPoreConeLaw {
        elastic: cone_lanes::<T>(|lane| law(lane).elastic),
        yield_stress: lanes(|own| own.yield_stress),
        shear_modulus_and_compliance: [
            lanes(|own| own.shear_modulus_and_compliance[0]),
            lanes(|own| own.shear_modulus_and_compliance[1]),
        ],
        energy_compliance: lanes(|own| own.energy_compliance),
    }
}

/// Completes the step of a group and returns the plastic dissipation, J/m³. Fields: stress, excess, plastic strain.
#[inline(always)]
pub(super) fn complete_plastic_cone_step<T: Real, V: Vector<T>, const SHEAR_COUNT: usize>(
    group: &mut [T::Lanes],
    lanes: u16,
    (law, factor): (&PlasticPoreConeLaw<T::Lanes>, V),
    ([stress, excess, strain], extent): ([&TensorPlaces; 3], usize),
) -> T::Lanes {
    let [modulus, compliance] = &law.shear_modulus_and_compliance;
    let law = PlasticPoreConeLaw {
        elastic: load_cone::<T, V>(&law.elastic),
        yield_stress: V::load(&law.yield_stress),
        shear_modulus_and_compliance: [V::load(modulus), V::load(compliance)],
        energy_compliance: V::load(&law.energy_compliance),
    };
    let law = law.with_field_factor(factor);
    let [stress, excess, strain] = [
        ComponentOffsets::<SHEAR_COUNT>::new(stress, extent),
        ComponentOffsets::<SHEAR_COUNT>::new(excess, extent),
        ComponentOffsets::<SHEAR_COUNT>::new(strain, extent),
    ];
    let before = [stress.load::<T, V>(group), excess.load(group), strain.load(group)];
    let step = law.complete_step(before[0], before[1], before[2]);
    stress.store(group, lanes, &before[0], &step.stress);
    excess.store(group, lanes, &before[1], &step.excess);
    strain.store(group, lanes, &before[2], &step.plastic_strain);
    let mut dissipated = T::Lanes::ZERO;
    V::ZERO.blend_lanes(lanes, step.plastic_dissipation).store(&mut dissipated);
    dissipated
}
