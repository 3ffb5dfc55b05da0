//! Particles with a parallel dashpot: closed forms of the scheme along a path of volumetric strain, and the conditions,
//! the energy and the strain of a release.

use crate::contact_media::tensors::{
    Elasticity, Vector, combine, deviator, norm, to_vector, trace,
};
use testkit::random::RandomNumbers;
use wellposed_models::granular_medium::{GranularMedium, GranularParameters, KelvinVoigtParticles};
use wellposed_models::rheology::relaxation::SymmetricTensor;

type Tensor = SymmetricTensor<f64, 3>;

const SAND: GranularParameters = GranularParameters {
    density: 1800.0,
    bulk_modulus: 1.5,
    shear_modulus: 0.9,
    friction: 0.5,
    yield_stress: None,
    intensity_coefficient: 0.375,
};

fn hydrostatic(value: f64) -> Tensor {
    SymmetricTensor { normal: [value; 3], shear: [0.0; 3] }
}

/// Compression at the rate r to −e₁, extension at the same rate to e₂, compression again. σ = −ke − ηr while closed; after
/// the turn σ jumps by 2ηr, and the contact opens at −ηr/k. Open particles creep as −(ηr/k)e^{−kt/η}, and the contact
/// closes where the strain meets theirs, with a jump to the viscous stress −ηr.
#[test]
fn volumetric_path_follows_the_closed_form() {
    let medium = GranularMedium::new(SAND).unwrap();
    let (eta, rate, k) = (0.6, 0.2, 1.5);
    let particles = KelvinVoigtParticles::new([None, Some(eta)]).unwrap();
    let (first, second) = (0.5, 0.45);
    let opening_strain = -eta * rate / k;
    let mut errors = Vec::new();
    for count in [200, 400, 800, 1600] {
        let step = (first + second + 0.4) / rate / f64::from(count);
        let law = particles.step(&medium, step);
        let zero = Tensor::ZERO;
        let (mut stress, mut excess, mut spring) = (zero, zero, zero);
        let (mut largest, mut closing, mut largest_opening) = (0.0f64, f64::NAN, 0.0f64);
        // Strain at a time, which is volumetric.
        let strain_at = |time: f64| match time * rate {
            s if s <= first => -s,
            s if s <= first + second => s - 2.0 * first,
            s => 2.0 * second - s,
        };
        let (turn, end) = (first / rate, (first + second) / rate);
        let opens = (2.0 * first + opening_strain) / rate;
        for index in 0..count {
            let time = f64::from(index) * step;
            let load = |stress: Tensor, excess: Tensor, from: f64, to: f64| {
                let change = law.contact.bulk_modulus * (strain_at(to) - strain_at(from));
                let after = law.contact.complete_step(stress.plus(hydrostatic(change)), excess);
                (after.stress, after.excess)
            };
            (stress, excess) = load(stress, excess, time, time + 0.5 * step);
            let released = law.release(stress, excess, spring);
            assert!(released.energy_loss >= -1e-15, "{released:?}");
            spring = released.spring_stress;
            (stress, excess) =
                load(released.stress, released.excess, time + 0.5 * step, time + step);
            let time = time + step;
            let particle = opening_strain * (-k * (time - opens) / eta).exp();
            let is_open = time > opens && (time < end || strain_at(time) > particle);
            let exact = match time {
                _ if is_open => 0.0,
                t if t <= turn => k * strain_at(t) - eta * rate,
                t if t <= opens => k * strain_at(t) + eta * rate,
                t => k * strain_at(t) - eta * rate,
            };
            // The steps in which the rate turns or the contact closes have a mean of both stresses.
            let near = |at: f64| (time - at).abs() < 1.5 * step;
            if is_open {
                let opening = excess.normal[0] / law.contact.bulk_modulus;
                largest_opening = largest_opening.max((opening - strain_at(time) + particle).abs());
            } else if time > end && closing.is_nan() {
                closing = time;
            } else if !near(turn) && !near(closing) {
                largest = largest.max((stress.normal[0] - exact).abs());
            }
        }
        assert!(closing.is_finite());
        errors.push([largest, largest_opening]);
    }
    println!("{errors:?}");
    // The stress of closed contacts is exact for constant rates.
    assert!(errors.iter().all(|own| own[0] < 1e-12), "{errors:?}");
    let ratios: Vec<f64> = errors.windows(2).map(|own| own[0][1] / own[1][1]).collect();
    assert!(ratios.iter().all(|own| *own > 1.7), "{errors:?}");
    assert!(errors[3][1] < 1e-4, "{errors:?}");
}

/// A release keeps the total strain, ends at a state of the law, and loses energy of the spring and of the dashpot.
#[test]
fn releases_keep_the_strain_and_lose_energy() {
    let mut random = RandomNumbers::new(1);
    let mut moved = 0;
    for _ in 0..5000 {
        let own = GranularParameters {
            shear_modulus: random.log_uniform(0.1, 3.0),
            friction: random.log_uniform(0.05, 3.0),
            yield_stress: random.bernoulli(0.3).then(|| random.log_uniform(0.05, 1.0)),
            ..SAND
        };
        let medium = GranularMedium::new(own).unwrap();
        let viscosities =
            [(); 2].map(|()| random.bernoulli(0.7).then(|| random.log_uniform(0.01, 100.0)));
        let particles = KelvinVoigtParticles::new(viscosities).unwrap();
        let [bulk_modulus, shear_modulus] = particles.moduli(&medium, 0.3);
        let expected = [viscosities[1], viscosities[0]].map(|own| own.unwrap_or(0.0) / 0.15);
        assert!((bulk_modulus - 1.5 - expected[0]).abs() <= 1e-15 * bulk_modulus);
        assert!((shear_modulus - own.shear_modulus - expected[1]).abs() <= 1e-15 * shear_modulus);
        let law = particles.step(&medium, 0.3);
        let mut tensor = || {
            let mut component = || random.uniform(-1.0, 1.0);
            let normal = [component(), component(), component()];
            SymmetricTensor { normal, shear: [component(), component(), component()] }
        };
        let first = law.contact.complete_step(tensor().plus(hydrostatic(-0.5)), Tensor::ZERO);
        let spring = tensor();
        let after = law.release(first.stress, first.excess, spring);
        let kept = law.contact.complete_step(after.stress, after.excess);
        let vector = |own: &Tensor| to_vector(own);
        let [stress, excess, spring] = [&first.stress, &first.excess, &spring].map(vector);
        let [new, new_excess, new_spring] =
            [&after.stress, &after.excess, &after.spring_stress].map(vector);
        let size = norm(stress) + norm(excess) + norm(spring) + norm(new_excess);
        let projection = norm(combine(vector(&kept.stress), -1.0, new));
        assert!(projection <= 1e-13 * size, "{projection:e} {own:?}");

        let elastic = Elasticity::new(1.5, own.shear_modulus);
        let stiff = Elasticity::new(bulk_modulus, shear_modulus);
        // Strain of the particles C⁻¹:b and since the release C*⁻¹:(σ − b), and opening C*⁻¹:x.
        let strain = |stress: Vector, excess: Vector, spring: Vector| {
            let since = stiff.strain(combine(stress, -1.0, spring));
            combine(combine(elastic.strain(spring), 1.0, since), 1.0, stiff.strain(excess))
        };
        let change =
            combine(strain(new, new_excess, new_spring), -1.0, strain(stress, excess, spring));
        let strains = size / own.shear_modulus.min(1.0);
        // Hinges in series change the deviator alone.
        assert!(trace(change).abs() <= 1e-13 * strains, "{change:?} {own:?}");
        if own.yield_stress.is_none() {
            assert!(norm(deviator(change)) <= 1e-13 * strains, "{change:?} {own:?}");
        }
        let energy = |stress: Vector, spring: Vector| {
            stiff.energy(stress) + elastic.energy(spring) - stiff.energy(spring)
        };
        let lost = energy(stress, spring) - energy(new, new_spring);
        let energies = size * strains;
        assert!((after.energy_loss - lost).abs() <= 1e-14 * energies, "{lost:e} {own:?}");
        assert!(lost >= -1e-14 * energies, "{lost:e} {own:?}");
        moved += usize::from(norm(combine(new, -1.0, stress)) > 0.1 * norm(stress));
    }
    assert!(moved > 1000, "{moved}");
}

/// In the longest step a wave with the moduli of the step travels the given distance; it is found for any viscosity.
#[test]
fn longest_step_has_the_given_distance() {
    let medium = GranularMedium::new(SAND).unwrap();
    for viscosity in [1e-12, 1e-3, 1.0, 1e3, 1e12] {
        let particles = KelvinVoigtParticles::new([Some(viscosity), None]).unwrap();
        let step = particles.longest_step(&medium, 0.02);
        let [bulk_modulus, shear_modulus] = particles.moduli(&medium, step);
        let modulus = bulk_modulus + 4.0 / 3.0 * shear_modulus;
        let distance = (modulus / SAND.density).sqrt() * step;
        assert!((distance - 0.02).abs() < 1e-15, "{viscosity}: {distance}");
    }
}

#[test]
fn viscosities_out_of_range_are_refused() {
    for (viscosities, key) in [
        ([Some(0.0), None], "shear_viscosity"),
        ([None, Some(-1.0)], "bulk_viscosity"),
        ([Some(f64::NAN), None], "shear_viscosity"),
    ] {
        assert_eq!(KelvinVoigtParticles::new(viscosities).unwrap_err().input, key);
    }
}
