//! Steps of the law of collapsing pores against the total volumetric strain, the energy balance and the diagrams of
//! uniaxial strain.

use crate::contact_media::tensor_law::{PathPressures, compare_paths};
use testkit::random::RandomNumbers;
use wellposed_models::common::number::Number;
use wellposed_models::porous::{PoreContact, PoreLaw, PoreState, PorousMedium, PorousParameters};

fn random_parameters(random: &mut RandomNumbers) -> PorousParameters {
    let bulk_modulus = random.log_uniform(1e6, 1e11);
    PorousParameters {
        density: 2700.0,
        bulk_modulus,
        shear_modulus: bulk_modulus,
        yield_stress: None,
        intensity_coefficient: 0.375,
        contact_bulk_modulus: match random.bernoulli(0.1) {
            true => 0.0,
            false => bulk_modulus * random.log_uniform(1e-2, 20.0),
        },
        porosity: if random.bernoulli(0.1) { 0.0 } else { random.log_uniform(1e-4, 0.9) },
        contact: PoreContact::Spherical,
    }
}

/// Mean stress and energy of a volumetric strain: a spring, and another one that acts below the strain −θ₀.
fn stress_and_energy(own: &PorousParameters, strain: f64) -> [f64; 2] {
    let beyond = if strain < -own.porosity { strain + own.porosity } else { 0.0 };
    let [skeleton, contact] = [own.bulk_modulus * strain, own.contact_bulk_modulus * beyond];
    [skeleton + contact, 0.5 * (skeleton * strain + contact * beyond)]
}

/// Draws a strain: anywhere, close to the collapse of the pores, at it, or zero.
fn draw_strain(random: &mut RandomNumbers, porosity: f64) -> f64 {
    let unit = porosity.max(1e-4);
    match random.uniform_index(5) {
        0 | 1 => unit * random.signed_log_uniform(1e-6, 1e6),
        2 => -porosity * (1.0 + random.signed_log_uniform(1e-16, 1.0)),
        3 => -porosity,
        _ => 0.0,
    }
}

/// Checks random steps between two strains; returns the largest errors of stress and of energy, and the least loss,
/// relative to the elastic stress and energy.
fn check_steps<N: Number + Into<f64>>(seed: u64, tolerance: f64) {
    let mut random = RandomNumbers::new(seed);
    let (mut largest, mut least, mut collapsed) = ([0.0f64; 2], 0.0f64, 0);
    for _ in 0..20_000 {
        let own = random_parameters(&mut random);
        let law = PoreLaw::new(&PorousMedium::new(own).unwrap()).map(N::from_f64);
        let [before, after] = [(); 2].map(|()| draw_strain(&mut random, own.porosity));
        let state = PoreState {
            volumetric_strain: N::from_f64(before),
            closure: N::from_f64((own.porosity + before).min(0.0)),
        };
        let closed_modulus = own.bulk_modulus + own.contact_bulk_modulus;
        let [stress, energy] = stress_and_energy(&own, before);
        let change = after - before;
        let elastic = N::from_f64(stress + closed_modulus * change);
        let step = law.complete_step(elastic, state);

        let size = before.abs() + after.abs() + own.porosity;
        let [new_stress, new_energy] = stress_and_energy(&own, after);
        let found = (elastic + step.mean_stress_change).into();
        let strain_error = (step.state.volumetric_strain.into() - after).abs();
        let closure = step.state.closure.into() - (own.porosity + after).min(0.0);
        let stress_error = (found - new_stress).abs() / closed_modulus;
        let error = strain_error.max(closure.abs()).max(stress_error) / size.max(1e-300);
        assert!(error <= tolerance, "stress {error:e}: {own:?} {before:e} {after:e} {step:?}");
        let work = stress * change + 0.5 * closed_modulus * change * change;
        let unit = (closed_modulus * size * size).max(1e-300);
        let loss = step.energy_loss.into();
        let energy_error = (energy + work - new_energy - loss).abs() / unit;
        assert!(energy_error <= tolerance, "energy {energy_error:e}: {own:?} {before:e} {after:e}");
        assert!(loss >= 0.0, "{loss:e} {own:?} {before:e} {after:e}");
        if state.closure.into() < 0.0 && step.state.closure.into() < 0.0 {
            assert_eq!((step.mean_stress_change.into(), loss), (0.0, 0.0), "{own:?}");
            collapsed += 1;
        }
        largest = [largest[0].max(error), largest[1].max(energy_error)];
        least = least.min(loss / unit);
    }
    println!("{largest:?}, least loss {least:e}, {collapsed} collapsed");
    assert!(collapsed > 500, "{collapsed}");
}

#[test]
fn steps_end_at_the_stress_of_the_total_strain_and_balance_energy() {
    check_steps::<f64>(1, 1e-14);
    check_steps::<f32>(2, 1e-5);
}

#[test]
fn mean_stress_determines_strain_and_closure() {
    let mut random = RandomNumbers::new(3);
    for _ in 0..10_000 {
        let own = random_parameters(&mut random);
        let law = PoreLaw::new(&PorousMedium::new(own).unwrap());
        let strain = draw_strain(&mut random, own.porosity);
        let state = law.state_of_mean_stress(stress_and_energy(&own, strain)[0]);
        let tolerance = 1e-14 * (strain.abs() + own.porosity);
        assert!(
            (state.volumetric_strain - strain).abs() <= tolerance,
            "{state:?} {own:?} {strain}"
        );
        let closure = (own.porosity + strain).min(0.0);
        assert!((state.closure - closure).abs() <= tolerance, "{state:?} {own:?} {strain}");
    }
}

/// The law with a skeleton whose deviator in uniaxial strain, of the share `intensity_ratio` of the front stress, is
/// limited by the yield stress.
fn integrate(medium: &PorousMedium, strains: &[f64]) -> PathPressures {
    let own = medium.parameters();
    let law = PoreLaw::new(medium);
    let closed_modulus = own.bulk_modulus + own.contact_bulk_modulus;
    let limit = own
        .yield_stress
        .map_or(f64::INFINITY, |limit| limit / (1.5 * own.intensity_coefficient).sqrt());
    let mut state = law.state_of_mean_stress(0.0);
    let (mut mean, mut deviator, mut before) = (0.0, 0.0, 0.0);
    let mut pressures = Vec::new();
    for &strain in strains {
        let change = before - strain;
        let elastic = mean + closed_modulus * change;
        let step = law.complete_step(elastic, state);
        (mean, state) = (elastic + step.mean_stress_change, step.state);
        deviator = (deviator + 4.0 / 3.0 * own.shear_modulus * change).clamp(-limit, limit);
        pressures.push(-(mean + deviator));
        before = strain;
    }
    PathPressures { pressures, error_bound: 1e-12 }
}

#[test]
fn uniaxial_paths_follow_the_diagrams() {
    let mut random = RandomNumbers::new(4);
    let mut largest = 0.0f64;
    for index in 0..1000 {
        let parameters = PorousParameters {
            density: 2673.0,
            bulk_modulus: 1.0,
            shear_modulus: random.uniform(0.2, 1.6),
            yield_stress: (index % 5 != 0).then(|| random.uniform(0.2, 0.8)),
            intensity_coefficient: random.uniform(0.2, 0.6),
            contact_bulk_modulus: random.uniform(0.1, 3.0),
            porosity: random.uniform(0.0, 0.9),
            contact: PoreContact::Spherical,
        };
        let medium = PorousMedium::new(parameters).unwrap();
        let range = [random.uniform(0.3, 4.0), -random.uniform(0.0, 2.0)];
        let (loading, unloading) = (medium.loading_diagram(), medium.unloading_diagram(range[0]));
        let follow = |strains: &[f64]| integrate(&medium, strains);
        let [error, bound] = compare_paths(follow, &loading, &unloading, range);
        assert!(error <= bound, "{index}: {error:e} {parameters:?}");
        largest = largest.max(error);

        // An elastic skeleton returns to the diagram after a step of any size.
        if parameters.yield_stress.is_none() {
            let strains: Vec<f64> = (0..30).map(|_| random.uniform(-2.0, 2.0)).collect();
            for (strain, own) in strains.iter().zip(follow(&strains).pressures) {
                let error = (own - loading.pressure(*strain)).abs();
                assert!(error <= bound, "{index}: {error:e} at {strain}, {parameters:?}");
                largest = largest.max(error);
            }
        }
    }
    println!("pressures within {largest:e}");
}
