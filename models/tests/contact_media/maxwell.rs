//! Relaxation of particles in contact: closed forms of the scheme spring, dashpot and contact in series along a path of
//! volumetric strain and in pure relaxation, and the conditions of the implicit step.

use crate::contact_media::tensors::{Elasticity, combine, deviator, norm, to_vector, trace};
use testkit::random::RandomNumbers;
use wellposed_models::granular_medium::{
    GranularContact, GranularMedium, GranularParameters, MaxwellParticles,
};
use wellposed_models::rheology::relaxation::SymmetricTensor;

type Tensor = SymmetricTensor<f64, 3>;

fn medium(parameters: GranularParameters) -> GranularContact<f64> {
    GranularContact::new(&GranularMedium::new(parameters).unwrap())
}

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

/// Compression at a constant rate from rest, then extension at the same rate: with the modulus k and the viscosity η of
/// volume, σ = −ηr(1 − e^{−kt/η}), and the contact opens (η/k) ln(1 + |σ₁|/(ηr)) after the rate has turned. The opening
/// that follows grows with the strain.
#[test]
fn volumetric_path_follows_the_closed_form() {
    let law = medium(SAND);
    let (viscosity, rate) = (0.6, 0.2);
    let particles = MaxwellParticles::new(&law, 0.9, [None, Some(viscosity)]).unwrap();
    let (k, turn) = (1.5, 0.8);
    let limit = viscosity * rate;
    let turned = limit * (1.0 - (-k * turn / viscosity).exp());
    let opening = turn + viscosity / k * (1.0 + turned / limit).ln();
    let end = opening + 0.3;
    let mut errors = Vec::new();
    for count in [200, 400, 800] {
        let step = end / f64::from(count);
        let half = particles.step(&law, 0.5 * step);
        let (mut stress, mut excess) = (Tensor::ZERO, Tensor::ZERO);
        let (mut largest, mut opened) = (0.0f64, 0.0);
        for index in 0..count {
            let time = f64::from(index) * step;
            // The strain of a step in which the rate turns.
            let before = (turn - time).clamp(0.0, step);
            let strain = rate * ((step - before) - before);
            let relaxed = half.relax(stress, excess);
            let elastic = relaxed.stress.plus(hydrostatic(k * strain));
            let result = law.complete_step(elastic, relaxed.excess);
            let relaxed = half.relax(result.stress, result.excess);
            (stress, excess) = (relaxed.stress, relaxed.excess);
            let time = time + step;
            let exact = match time {
                t if t <= turn => -limit * (1.0 - (-k * t / viscosity).exp()),
                t if t <= opening => limit - (limit + turned) * (-k * (t - turn) / viscosity).exp(),
                _ => 0.0,
            };
            largest = largest.max((stress.normal[0] - exact).abs());
            opened = excess.normal[0] / k;
        }
        let error = (opened - rate * (end - opening)).abs();
        errors.push([largest, error]);
    }
    println!("{errors:?}");
    for [stress, opening] in &errors {
        assert!(*stress < 1e-3 * limit && *opening < 2e-3 * rate, "{errors:?}");
    }
    assert!(errors[2][0] < 0.6 * errors[0][0], "{errors:?}");
}

/// Within the cone the deviator decays by exp(−μt/η) in steps of any size, and the mean stress does not change.
#[test]
fn closed_contacts_relax_exponentially() {
    let law = medium(SAND);
    let particles = MaxwellParticles::new(&law, 0.9, [Some(0.45), None]).unwrap();
    let start = SymmetricTensor { normal: [-1.1, -1.0, -0.9], shear: [0.05, -0.02, 0.1] };
    let mut state = (start, Tensor::ZERO);
    let mut loss = 0.0;
    for _ in 0..7 {
        let relaxed = particles.step(&law, 0.3).relax(state.0, state.1);
        loss += relaxed.energy_loss;
        state = (relaxed.stress, relaxed.excess);
    }
    let kept = (-0.9 / 0.45 * 2.1f64).exp();
    let expected = combine([-1.0, -1.0, -1.0, 0.0, 0.0, 0.0], kept, deviator(to_vector(&start)));
    let error = norm(combine(to_vector(&state.0), -1.0, expected));
    assert!(error < 1e-15, "{error:e}");
    assert_eq!(state.1, Tensor::ZERO);
    let elasticity = Elasticity::new(1.5, 0.9);
    let lost = elasticity.energy(to_vector(&start)) - elasticity.energy(to_vector(&state.0));
    assert!((loss - lost).abs() < 1e-16, "{loss} {lost}");
}

/// s′ = s − (f − 1)σ′ with σ′ = π_K(s′), for random states and steps; energy decreases.
#[test]
fn random_steps_are_implicit_steps_of_the_law() {
    let mut random = RandomNumbers::new(1);
    let mut moved = 0;
    for _ in 0..5000 {
        let own = GranularParameters {
            shear_modulus: random.log_uniform(0.1, 3.0),
            friction: random.log_uniform(0.05, 3.0),
            ..SAND
        };
        let law = medium(own);
        let viscosities =
            [(); 2].map(|()| random.bernoulli(0.7).then(|| random.log_uniform(0.01, 100.0)));
        let particles = MaxwellParticles::new(&law, own.shear_modulus, viscosities).unwrap();
        let mut tensor = || {
            let mut component = || random.uniform(-1.0, 1.0);
            let normal = [component(), component(), component()];
            SymmetricTensor { normal, shear: [component(), component(), component()] }
        };
        let first = law.complete_step(tensor().plus(hydrostatic(-0.5)), Tensor::ZERO);
        let step = particles.step(&law, 0.3);
        let result = step.relax(first.stress, first.excess);
        let [stress, excess] = [first.stress, first.excess].map(|own| to_vector(&own));
        let [new, new_excess] = [result.stress, result.excess].map(|own| to_vector(&own));
        // σ′ is the projection of s′: its law, without increment, keeps it.
        let kept = law.complete_step(result.stress, result.excess);
        let projection = norm(combine(to_vector(&kept.stress), -1.0, new));
        let mean = [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0, 0.0, 0.0].map(|own| own * trace(new));
        let [rate_s, rate_v] = [(viscosities[0], own.shear_modulus), (viscosities[1], 1.5)].map(
            |(viscosity, modulus)| {
                viscosity.map_or(0.0, |own| (0.3 * modulus / own).min(6.0).exp() - 1.0)
            },
        );
        let change = combine(deviator(new).map(|own| own * rate_s), rate_v, mean);
        let expected = combine(combine(stress, 1.0, excess), -1.0, change);
        let residual = norm(combine(combine(new, 1.0, new_excess), -1.0, expected));
        let size = norm(stress) + norm(excess) + norm(new_excess) + norm(change);
        // The rounding of the mean stress enters the excess of the deviator, f times as large.
        let rounding = 1e-15 * (step.shear_factor + step.bulk_factor) * size;
        assert!(residual <= rounding, "{residual:e} {rounding:e} {own:?} {step:?}");
        assert!(projection <= rounding, "{projection:e} {own:?} {first:?} {result:?}");
        let elasticity = Elasticity::new(1.5, own.shear_modulus);
        let lost = elasticity.energy(stress) - elasticity.energy(new);
        assert!(
            (result.energy_loss - lost).abs() <= 1e-14 * size * size / own.shear_modulus.min(1.0)
        );
        assert!(lost >= -1e-15 * size * size, "{lost:e}");
        moved += usize::from(norm(new) < 0.9 * norm(stress));
    }
    assert!(moved > 1000, "{moved}");
}

#[test]
fn viscosities_out_of_range_are_refused() {
    let law = medium(SAND);
    for (viscosities, key) in [
        ([Some(0.0), None], "shear_viscosity"),
        ([None, Some(-1.0)], "bulk_viscosity"),
        ([Some(f64::NAN), None], "shear_viscosity"),
    ] {
        assert_eq!(MaxwellParticles::new(&law, 0.9, viscosities).unwrap_err().input, key);
    }
}
