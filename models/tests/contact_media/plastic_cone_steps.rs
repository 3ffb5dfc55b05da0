//! Steps of pores with contact by cone beside a plastic skeleton, against the conditions of both projections at the total
//! strain, a conic solver, the energy balance and the diagrams of uniaxial strain.

use crate::contact_media::pore_cone_steps::{
    Springs, UNIT, draw_strain, random_parameters, to_tensor,
};
use crate::contact_media::tensor_law::{PathPressures, ProjectionLaw, compare_paths};
use crate::contact_media::tensors::{
    Elasticity, Vector, combine, deviator, dot, norm, to_vector, trace,
};
use testkit::random::RandomNumbers;
use wellposed_models::common::number::Number;
use wellposed_models::porous::{PlasticPoreConeLaw, PoreContact, PorousMedium, PorousParameters};
use wellposed_models::rheology::relaxation::SymmetricTensor;

/// Draws a yield stress around the deviator that a strain of the size of the porosity causes.
fn random_plastic(random: &mut RandomNumbers) -> PorousParameters {
    let own = random_parameters(random);
    let unit = own.shear_modulus * own.porosity.max(1e-4);
    PorousParameters { yield_stress: Some(unit * random.log_uniform(1e-2, 10.0)), ..own }
}

/// Three random steps from the natural state. With the plastic strain εᵖ after a step, s = C_a:(ε − εᵖ) is within the yield
/// limit; εᵖ grows by a deviator e with e:s = max e:s̃ over τ(s̃) ≤ τ_s, and only where τ = τ_s; r = σ − s obeys the conditions of its projection, which
/// are those of the contact beside an elastic skeleton: r in K, the strain e = b:(q + q⁰ − r) in the dual cone, e:r = 0.
fn check_steps<N: Number + Into<f64>>(seed: u64, tolerance: f64) {
    let mut random = RandomNumbers::new(seed);
    let (mut largest, mut counts) = ([0.0f64; 7], [[0; 2]; 2]);
    for _ in 0..5000 {
        let own = random_plastic(&mut random);
        let springs = Springs::new(own);
        let medium = PorousMedium::new(own).unwrap();
        let law = PlasticPoreConeLaw::new(&medium).unwrap().map(N::from_f64);
        let limit = own.yield_stress.unwrap();
        let factor = own.intensity_coefficient.sqrt();
        let modulus = own.bulk_modulus
            + own.contact_bulk_modulus
            + own.shear_modulus
            + springs.contact_shear_modulus;
        let weak = own.contact_bulk_modulus.min(springs.contact_shear_modulus);
        let (mut stress, mut excess) = (SymmetricTensor::<N, 3>::ZERO, SymmetricTensor::ZERO);
        let mut plastic = SymmetricTensor::<N, 3>::ZERO;
        let mut before: Vector = [0.0; 6];
        let mut size = own.porosity;
        for _ in 0..3 {
            let strain = draw_strain(&mut random, own.porosity);
            let change = combine(strain, -1.0, before);
            let closed_change = combine(springs.skeleton(change), 1.0, springs.spring(change));
            let elastic = stress.plus(to_tensor(closed_change));
            let step = law.complete_step(elastic, excess, plastic);
            size += norm(strain) + norm(change);

            let [old_plastic, new_plastic] =
                [plastic, step.plastic_strain].map(|own| to_vector(&own));
            let flow = combine(new_plastic, -1.0, old_plastic);
            let skeleton = springs.skeleton(combine(strain, -1.0, new_plastic));
            let direction = deviator(skeleton);
            let intensity = factor * norm(direction);
            // Rounding of the stress, as a strain of the skeleton.
            let strains = size * modulus / own.shear_modulus;
            let yielding = norm(flow) > 1e-9 * strains;

            let contact = combine(to_vector(&step.stress), -1.0, skeleton);
            let offset = own.contact_bulk_modulus * own.porosity;
            let trial = combine(springs.spring(strain), offset, UNIT);
            let elasticity = springs.spring_elasticity();
            let opening = elasticity.strain(combine(trial, -1.0, contact));
            let in_cone =
                factor * norm(deviator(contact)) + springs.friction * trace(contact) / 3.0;
            let dual = springs.friction * norm(deviator(opening)) / factor - trace(opening);
            let stresses = modulus * size * (1.0 + springs.friction);

            let old = to_vector(&stress);
            let old_skeleton = springs.skeleton(combine(before, -1.0, old_plastic));
            let of_skeleton = Elasticity::new(own.bulk_modulus, own.shear_modulus);
            let energy = |skeleton: Vector, contact: Vector| {
                of_skeleton.energy(skeleton) + elasticity.energy(contact)
            };
            let work = dot(old, change) + 0.5 * dot(change, closed_change);
            let lost = energy(old_skeleton, combine(old, -1.0, old_skeleton)) + work
                - energy(skeleton, contact);
            let [dissipated, other]: [f64; 2] =
                [step.plastic_dissipation.into(), step.other_loss.into()];
            let energies = modulus * modulus / weak.min(own.shear_modulus) * size * size;
            assert!(dissipated >= 0.0 && other >= -tolerance * energies, "{own:?}");
            let errors = [
                (intensity - limit) / (modulus * size),
                // Flow along the normal: no stress within the limit dissipates more.
                (norm(flow) * limit / factor - dot(flow, skeleton)) / (modulus * size * strains),
                // Only at the limit.
                if yielding { (intensity - limit).abs() / (modulus * size) } else { 0.0 },
                in_cone / stresses,
                dual * weak / stresses,
                dot(opening, contact).abs() * weak / (modulus * size).powi(2),
                (lost - dissipated - other).abs() / energies,
            ];
            // Dissipation is that of the flow in the final stress.
            let expected = dot(skeleton, flow);
            assert!((dissipated - expected).abs() <= tolerance * energies, "{own:?}");
            for (index, error) in errors.into_iter().enumerate() {
                assert!(error <= tolerance, "{index}: {error:e} {own:?} {strain:?} {step:?}");
                largest[index] = largest[index].max(error);
            }
            counts[usize::from(yielding)][usize::from(norm(contact) > 1e-6 * modulus * size)] += 1;
            (stress, excess, before) = (step.stress, step.excess, strain);
            plastic = step.plastic_strain;
        }
    }
    println!("{largest:?}; elastic or yielding, open or in contact: {counts:?}");
    assert!(counts.as_flattened().iter().all(|&count| count > 300), "{counts:?}");
}

#[test]
fn steps_obey_the_conditions_of_both_projections_and_balance_energy() {
    check_steps::<f64>(1, 1e-14);
    check_steps::<f32>(2, 1e-5);
}

/// In principal strains both projections by a conic solver.
#[test]
fn steps_are_those_of_a_conic_solver() {
    let mut random = RandomNumbers::new(4);
    let mut largest = 0.0f64;
    for index in 0..300 {
        let own = scaled(random_plastic(&mut random), &mut random);
        let springs = Springs::new(own);
        let law = PlasticPoreConeLaw::new(&PorousMedium::new(own).unwrap()).unwrap();
        let project = |[bulk_modulus, shear_modulus]: [f64; 2], friction, yield_stress, trial| {
            let law = ProjectionLaw {
                bulk_modulus,
                shear_modulus,
                intensity_coefficient: own.intensity_coefficient,
                friction,
                yield_stress,
            };
            law.project(trial)
        };
        let (mut stress, mut excess) = (SymmetricTensor::<f64, 3>::ZERO, SymmetricTensor::ZERO);
        let (mut plastic, mut before) = (SymmetricTensor::<f64, 3>::ZERO, [0.0; 6]);
        for _ in 0..2 {
            // Of order one, as the solver requires.
            let mut strain = [0.0; 6];
            strain[..3].fill_with(|| own.porosity.max(0.1) * random.uniform(-3.0, 1.5));
            let change = combine(strain, -1.0, before);
            let closed = combine(springs.skeleton(change), 1.0, springs.spring(change));
            let principal = |vector: Vector| [vector[0], vector[1], vector[2]];
            let skeleton = springs.skeleton(combine(strain, -1.0, to_vector(&plastic)));
            let offset = own.contact_bulk_modulus * own.porosity;
            let spring = combine(springs.spring(strain), offset, UNIT);
            let first = project(
                [own.bulk_modulus, own.shear_modulus],
                None,
                own.yield_stress,
                principal(skeleton),
            );
            // Without friction the cone has no interior, which the solver needs.
            if springs.friction == 0.0 {
                continue;
            }
            let moduli = [own.contact_bulk_modulus, springs.contact_shear_modulus];
            let second = project(moduli, Some(springs.friction), None, principal(spring));
            let step = law.complete_step(stress.plus(to_tensor(closed)), excess, plastic);
            let bound =
                first.error_bound + second.error_bound + 1e-12 * (norm(skeleton) + norm(spring));
            for i in 0..3 {
                let error = (step.stress.normal[i] - first.stress[i] - second.stress[i]).abs();
                assert!(error <= bound, "{index}: {error:e} {bound:e} {own:?}");
                largest = largest.max(error);
            }
            (stress, excess, before) = (step.stress, step.excess, strain);
            plastic = step.plastic_strain;
        }
    }
    println!("stresses within {largest:e}");
}

/// Returns constants in units of the bulk modulus, with a porosity of order one.
fn scaled(mut own: PorousParameters, random: &mut RandomNumbers) -> PorousParameters {
    let unit = own.bulk_modulus;
    own.bulk_modulus = 1.0;
    own.shear_modulus /= unit;
    own.contact_bulk_modulus /= unit;
    own.porosity = random.uniform(0.0, 0.9);
    own.yield_stress = Some(own.shear_modulus * random.log_uniform(0.05, 3.0));
    if let PoreContact::Frictional { shear_modulus, .. } = &mut own.contact {
        *shear_modulus /= unit;
    }
    own
}

/// A path of uniaxial strain: the diagrams of loading and of unloading.
#[test]
fn uniaxial_paths_follow_the_diagrams() {
    let mut random = RandomNumbers::new(3);
    let mut largest = 0.0f64;
    for index in 0..1000 {
        let parameters = scaled(random_plastic(&mut random), &mut random);
        let springs = Springs::new(parameters);
        let medium = PorousMedium::new(parameters).unwrap();
        let law = PlasticPoreConeLaw::new(&medium).unwrap();
        let range = [random.uniform(0.3, 4.0), -random.uniform(0.0, 2.0)];
        let follow = |strains: &[f64]| {
            let zero = SymmetricTensor::<f64, 3>::ZERO;
            let (mut stress, mut excess, mut plastic) = (zero, zero, zero);
            let mut before = 0.0;
            let mut pressures = Vec::new();
            for &strain in strains {
                let change = [before - strain, 0.0, 0.0, 0.0, 0.0, 0.0];
                let closed = combine(springs.skeleton(change), 1.0, springs.spring(change));
                let step = law.complete_step(stress.plus(to_tensor(closed)), excess, plastic);
                (stress, excess, before) = (step.stress, step.excess, strain);
                plastic = step.plastic_strain;
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
