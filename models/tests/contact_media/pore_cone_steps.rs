//! Steps of the law of pores whose walls transmit stresses in a friction cone, against the conditions of the projection
//! of the spring's stress at the total strain, the energy balance and the diagrams of uniaxial strain.

use crate::contact_media::tensor_law::{PathPressures, compare_paths};
use crate::contact_media::tensors::{
    Elasticity, Vector, combine, deviator, dot, norm, to_vector, trace,
};
use testkit::random::RandomNumbers;
use wellposed_models::common::number::Number;
use wellposed_models::porous::{PoreConeLaw, PoreContact, PorousMedium, PorousParameters};
use wellposed_models::rheology::relaxation::SymmetricTensor;

pub(super) const UNIT: Vector = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

pub(super) fn random_parameters(random: &mut RandomNumbers) -> PorousParameters {
    let bulk_modulus = random.log_uniform(1e6, 1e11);
    PorousParameters {
        density: 2700.0,
        bulk_modulus,
        shear_modulus: bulk_modulus * random.log_uniform(0.1, 2.0),
        yield_stress: None,
        intensity_coefficient: random.uniform(0.2, 0.6),
        contact_bulk_modulus: bulk_modulus * random.log_uniform(1e-2, 20.0),
        porosity: if random.bernoulli(0.2) { 0.0 } else { random.log_uniform(1e-4, 0.9) },
        contact: PoreContact::Frictional {
            shear_modulus: bulk_modulus * random.log_uniform(1e-2, 20.0),
            friction: if random.bernoulli(0.1) { 0.0 } else { random.log_uniform(0.05, 3.0) },
        },
    }
}

/// Stiffnesses of the skeleton and of the spring of collapsed pores.
pub(super) struct Springs {
    parameters: PorousParameters,
    pub(super) contact_shear_modulus: f64,
    pub(super) friction: f64,
}

impl Springs {
    pub(super) fn new(parameters: PorousParameters) -> Self {
        let PoreContact::Frictional { shear_modulus, friction } = parameters.contact else {
            panic!("{parameters:?}")
        };
        Self { parameters, contact_shear_modulus: shear_modulus, friction }
    }

    fn stress([bulk_modulus, shear_modulus]: [f64; 2], strain: Vector) -> Vector {
        let deviatoric = deviator(strain).map(|own| 2.0 * shear_modulus * own);
        combine(deviatoric, bulk_modulus * trace(strain), UNIT)
    }

    pub(super) fn skeleton(&self, strain: Vector) -> Vector {
        Self::stress([self.parameters.bulk_modulus, self.parameters.shear_modulus], strain)
    }

    pub(super) fn spring(&self, strain: Vector) -> Vector {
        Self::stress([self.parameters.contact_bulk_modulus, self.contact_shear_modulus], strain)
    }

    pub(super) fn spring_elasticity(&self) -> Elasticity {
        Elasticity::new(self.parameters.contact_bulk_modulus, self.contact_shear_modulus)
    }
}

/// Draws a strain of a size around that at which the pores collapse.
pub(super) fn draw_strain(random: &mut RandomNumbers, porosity: f64) -> Vector {
    let unit = porosity.max(1e-4) * random.log_uniform(1e-3, 1e2);
    let mut strain = [0.0; 6].map(|_: f64| unit * random.uniform(-1.0, 1.0));
    match random.uniform_index(4) {
        0 => strain = combine([0.0; 6], random.uniform(-3.0, 3.0) * unit, UNIT),
        1 => strain = combine(strain, -2.0 * unit, UNIT),
        _ => {}
    }
    strain
}

pub(super) fn to_tensor<N: Number>(vector: Vector) -> SymmetricTensor<N, 3> {
    let shear = |i: usize| N::from_f64(vector[i] / std::f64::consts::SQRT_2);
    SymmetricTensor {
        normal: [0, 1, 2].map(|i| N::from_f64(vector[i])),
        shear: [3, 4, 5].map(shear),
    }
}

/// Two random steps from the natural state: the stress must be that of the total strain, by the conditions of the
/// projection r of q + q⁰ onto the cone K: r in K, (q + q⁰ − r):b:r = 0, and (q + q⁰ − r):b:r̃ ≤ 0 for r̃ in K, which is
/// dual to τ ≤ æp: with the strain e = b:(q + q⁰ − r), tr e ≥ æ|dev e|/c.
fn check_steps<N: Number + Into<f64>>(seed: u64, tolerance: f64) {
    let mut random = RandomNumbers::new(seed);
    let (mut largest, mut counts) = ([0.0f64; 4], [0; 3]);
    for _ in 0..10_000 {
        let own = random_parameters(&mut random);
        let springs = Springs::new(own);
        let law = PoreConeLaw::new(&PorousMedium::new(own).unwrap()).unwrap().map(N::from_f64);
        let (mut stress, mut excess) = (SymmetricTensor::<N, 3>::ZERO, SymmetricTensor::ZERO);
        let mut before: Vector = [0.0; 6];
        let mut size = own.porosity;
        for _ in 0..2 {
            let strain = draw_strain(&mut random, own.porosity);
            let change = combine(strain, -1.0, before);
            let closed_change = combine(springs.skeleton(change), 1.0, springs.spring(change));
            let elastic = stress.plus(to_tensor(closed_change));
            let step = law.complete_step(elastic, excess);
            size += norm(strain) + norm(change);

            // Stress r of the contact by the skeleton's stress at the total strain.
            let found = to_vector(&step.stress);
            let contact = combine(found, -1.0, springs.skeleton(strain));
            let offset = own.contact_bulk_modulus * own.porosity;
            let trial = combine(springs.spring(strain), offset, UNIT);
            let elasticity = springs.spring_elasticity();
            let opening = elasticity.strain(combine(trial, -1.0, contact));
            let modulus = own.bulk_modulus
                + own.contact_bulk_modulus
                + own.shear_modulus
                + springs.contact_shear_modulus;
            let factor = own.intensity_coefficient.sqrt();
            let in_cone =
                factor * norm(deviator(contact)) + springs.friction * trace(contact) / 3.0;
            let dual = springs.friction * norm(deviator(opening)) / factor - trace(opening);
            let weak = own.contact_bulk_modulus.min(springs.contact_shear_modulus);
            let errors = [
                in_cone / (modulus * size * (1.0 + springs.friction)),
                dual * weak / (modulus * size * (1.0 + springs.friction)),
                dot(opening, contact).abs() * weak / (modulus * size).powi(2),
                {
                    let energy = |strain: Vector, contact: Vector| {
                        0.5 * dot(strain, springs.skeleton(strain)) + elasticity.energy(contact)
                    };
                    let old = to_vector(&stress);
                    let old_contact = combine(old, -1.0, springs.skeleton(before));
                    let work = dot(old, change) + 0.5 * dot(change, closed_change);
                    let balance = energy(before, old_contact) + work - energy(strain, contact);
                    let loss: f64 = step.energy_loss.into();
                    assert!(loss >= -tolerance * modulus * size * size, "{loss:e} {own:?}");
                    (balance - loss).abs() / (modulus * modulus / weak * size * size)
                },
            ];
            for (index, error) in errors.into_iter().enumerate() {
                assert!(error <= tolerance, "{index}: {error:e} {own:?} {strain:?} {step:?}");
                largest[index] = largest[index].max(error);
            }
            let contact_size = norm(contact);
            let kind = if contact_size <= 1e-6 * modulus * size {
                0
            } else if norm(combine(trial, -1.0, contact)) <= 1e-6 * contact_size {
                1
            } else {
                2
            };
            counts[kind] += 1;
            (stress, excess, before) = (step.stress, step.excess, strain);
        }
    }
    println!("{largest:?}; open, closed, on the cone: {counts:?}");
    assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
}

#[test]
fn steps_end_at_the_stress_of_the_total_strain_and_balance_energy() {
    check_steps::<f64>(1, 1e-14);
    check_steps::<f32>(2, 1e-5);
}

/// A path of uniaxial strain: the diagrams of loading and of unloading (which are one line, as the skeleton is elastic).
#[test]
fn uniaxial_paths_follow_the_diagrams() {
    let mut random = RandomNumbers::new(3);
    let mut largest = 0.0f64;
    for index in 0..1000 {
        let mut parameters = random_parameters(&mut random);
        let unit = parameters.bulk_modulus;
        parameters.bulk_modulus = 1.0;
        parameters.shear_modulus /= unit;
        parameters.contact_bulk_modulus /= unit;
        parameters.porosity = random.uniform(0.0, 0.9);
        if let PoreContact::Frictional { shear_modulus, .. } = &mut parameters.contact {
            *shear_modulus /= unit;
        }
        let springs = Springs::new(parameters);
        let medium = PorousMedium::new(parameters).unwrap();
        let law = PoreConeLaw::new(&medium).unwrap();
        let range = [random.uniform(0.3, 4.0), -random.uniform(0.0, 2.0)];
        let follow = |strains: &[f64]| {
            let (mut stress, mut excess) = (SymmetricTensor::<f64, 3>::ZERO, SymmetricTensor::ZERO);
            let mut before = 0.0;
            let mut pressures = Vec::new();
            for &strain in strains {
                let change = [before - strain, 0.0, 0.0, 0.0, 0.0, 0.0];
                let closed = combine(springs.skeleton(change), 1.0, springs.spring(change));
                let step = law.complete_step(stress.plus(to_tensor(closed)), excess);
                (stress, excess, before) = (step.stress, step.excess, strain);
                pressures.push(-stress.normal[0]);
            }
            PathPressures {
                pressures,
                error_bound: 1e-12 * parameters.contact_bulk_modulus.max(1.0),
            }
        };
        let (loading, unloading) = (medium.loading_diagram(), medium.unloading_diagram(range[0]));
        let [error, bound] = compare_paths(follow, &loading, &unloading, range);
        assert!(error <= bound, "{index}: {error:e} {parameters:?}");
        largest = largest.max(error);
    }
    println!("pressures within {largest:e}");
}
