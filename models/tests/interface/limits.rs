//! Layers between half-spaces in limits with a solution in closed form.

use crate::interface::support::{
    ELASTIC, History, IMPEDANCES, MASS_DISTRIBUTIONS, RandomLoad, initial_history, layer_materials,
    plastic_constants, step_interval,
};
use wellposed_models::interface::elastic::ElasticMaterial;
use wellposed_models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use wellposed_models::interface::parameters::{LayerMaterial, MassDistribution};
use wellposed_models::interface::{FaceLaw, FaceState, RiemannData};

/// Constants of a layer with the given mass per area and shear stiffness K.
fn elastic_material(mass: f64, stiffness: f64) -> ElasticMaterial {
    let speed = (stiffness / mass).sqrt();
    ElasticMaterial {
        thickness: 1.0,
        density: mass,
        longitudinal_speed: 2.0 * speed,
        shear_speed: speed,
    }
}

/// Advances a face by a step with equal impedances `z` on both sides; returns the shear states of both sides.
fn shear_step(
    law: &LayerLaw<f64>,
    impedance: f64,
    invariant: [f64; 2],
    number: usize,
    step: f64,
    history: &mut History,
) -> [FaceState<f64>; 2] {
    let incoming =
        [[0.0; 2], invariant].map(|invariant| RiemannData { impedance: [impedance; 2], invariant });
    law.advance(&incoming, &step_interval(number, step), history)[1]
}

#[test]
fn stiff_light_layers_are_welded_and_soft_light_layers_are_free() {
    for distribution in MASS_DISTRIBUTIONS {
        for speed in [1e7, 1e-11] {
            let material = ElasticMaterial {
                thickness: 1e-9,
                density: 1e-3,
                longitudinal_speed: speed,
                shear_speed: speed,
            };
            let law = LayerMaterial::Elastic(material).to_law(distribution);
            let mut load = RandomLoad::new(5);
            let mut history = initial_history(&law, [[0.0; 2]; 2]);
            let mut worst = 0.0f64;
            for number in 0..1000 {
                let incoming = load.next();
                let states = law.advance(&incoming, &step_interval(number, 0.1), &mut history);
                for (data, [lower, upper]) in incoming.iter().zip(states) {
                    let ([z, x], [r, s]) = (data.impedance, data.invariant);
                    let expected = if speed > 1.0 {
                        let velocity = (r + s) / (z + x);
                        [velocity, velocity]
                    } else {
                        [r / z, s / x]
                    };
                    let error =
                        (lower.velocity - expected[0]).abs() + (upper.velocity - expected[1]).abs();
                    worst = worst.max(error / (r.abs() + s.abs()));
                }
            }
            println!("{distribution:?}, speed {speed:e}: {worst:e}");
            assert!(worst < 1e-8, "{worst:e}");
        }
    }
}

/// A layer under an incident shear step v₀ transmits the velocity min(v₀, τ_s/z) and slips at the rate 2(v₀ − τ_s/z) if
/// this is positive.
#[test]
fn slipping_layer_transmits_its_strength() {
    let (z, strength) = (1.5, 0.6);
    for distribution in MASS_DISTRIBUTIONS {
        for velocity in [0.1, 0.39, 0.41, 1.0, 5.0] {
            let material = ElasticMaterial { thickness: 1e-3, ..ELASTIC };
            let plastic = plastic_constants(strength, 0.0, 0.0);
            let law = LayerMaterial::Plastic(material, plastic).to_law(distribution);
            let mut history = initial_history(&law, [[0.0; 2]; 2]);
            let (step, mut states, mut slip) = (0.01, Default::default(), 0.0);
            for number in 0..1000 {
                slip = law.to_face_record(&history).slip;
                let invariant = [2.0 * z * velocity, 0.0];
                states = Some(shear_step(&law, z, invariant, number, step, &mut history));
            }
            let [_, upper] = states.expect("steps");
            let transmitted = velocity.min(strength / z);
            let rate = (law.to_face_record(&history).slip - slip) / step;
            println!("v0 = {velocity}: v = {}, slip rate {rate}", upper.velocity);
            assert!((upper.velocity - transmitted).abs() < 1e-12);
            assert!((rate - 2.0 * (velocity - transmitted)).abs() < 1e-11);
        }
    }
}

/// An elastic layer with the box scheme transmits an incident velocity step v₀ as v⁺ = v₀[1 − e^(−2zt/m) − e^(−2Kt/z)],
/// which begins with −v₀.
#[test]
fn velocity_step_through_a_layer_has_the_closed_form() {
    let (z, mass, stiffness) = (1.3, 0.7, 2.1);
    let law =
        LayerMaterial::Elastic(elastic_material(mass, stiffness)).to_law(MassDistribution::Box);
    let mut errors = vec![];
    for steps in [200, 400, 800] {
        let step = 2.0 / steps as f64;
        let mut history = [0.0; MAX_HISTORY_VARIABLES];
        let mut worst = 0.0f64;
        for number in 0..steps {
            let [_, upper] = shear_step(&law, z, [2.0 * z, 0.0], number, step, &mut history);
            let time = (number as f64 + 0.5) * step;
            let exact = 1.0 - (-2.0 * z * time / mass).exp() - (-2.0 * stiffness * time / z).exp();
            worst = worst.max((upper.velocity - exact).abs());
            if number == 0 {
                assert!(upper.velocity < -0.9);
            }
        }
        errors.push(worst);
    }
    println!("{errors:?}");
    assert!(errors[2] < 1e-4);
    assert!(errors[0] / errors[1] > 3.9 && errors[1] / errors[2] > 3.9);
}

/// With lumped masses the velocity transmitted for an incident step is never negative.
#[test]
fn lumped_layer_has_no_reversed_precursor() {
    // Impedance above √(mK), so that the response is monotone.
    let (z, mass, stiffness) = (5.0, 0.7, 2.1);
    let law =
        LayerMaterial::Elastic(elastic_material(mass, stiffness)).to_law(MassDistribution::Lumped);
    let mut history = [0.0; MAX_HISTORY_VARIABLES];
    let mut before = 0.0;
    for number in 0..2000 {
        let [_, upper] = shear_step(&law, z, [2.0 * z, 0.0], number, 0.01, &mut history);
        assert!(upper.velocity > before - 1e-14);
        before = upper.velocity;
    }
    assert!((before - 1.0).abs() < 1e-6, "{before}");
}

/// Measures the transmission coefficient T, the complex amplitude of v⁺ per incident velocity, in the steady state of a
/// sine load of angular frequency ω at time steps Δt; returns its real and imaginary part.
fn transmission(law: &LayerLaw<f64>, z: f64, omega: f64, step: f64) -> [f64; 2] {
    let steps = 20_000;
    let mut histories = [[0.0; MAX_HISTORY_VARIABLES]; 2];
    let mut velocity = [0.0; 2];
    let mut phase = 0.0;
    for number in 0..steps {
        phase = omega * step * (number as f64 + 0.5);
        for (index, load) in [phase.cos(), phase.sin()].into_iter().enumerate() {
            let invariant = [2.0 * z * load, 0.0];
            velocity[index] =
                shear_step(law, z, invariant, number, step, &mut histories[index])[1].velocity;
        }
    }
    // v⁺ = Re and Im of T e^{iωt}.
    let (sin, cos) = phase.sin_cos();
    [velocity[0] * cos + velocity[1] * sin, velocity[1] * cos - velocity[0] * sin]
}

/// The transmission coefficient is T = 1/[cos ψ + (i/2)(z/z′ + z′/z) sin ψ] with ψ = 2 arctan(½ω̃√(m/K)), z′ = √(mK)
/// and the frequency ω̃ = (2/Δt) tan(½ωΔt) of the midpoint rule.
#[test]
fn transmission_has_the_closed_form() {
    let (z, mass, stiffness, step) = (1.3f64, 0.7f64, 2.1f64, 0.1);
    let material = LayerMaterial::Elastic(elastic_material(mass, stiffness));
    let own = (mass * stiffness).sqrt();
    for omega in [0.05, 0.5, 1.0, 3.0, 10.0, 25.0] {
        let discrete = 2.0 / step * (0.5f64 * omega * step).tan();
        let psi = 2.0 * (0.5 * discrete * (mass / stiffness).sqrt()).atan();
        let (re, im) = (psi.cos(), 0.5 * (z / own + own / z) * psi.sin());
        let square = re * re + im * im;
        let found = transmission(&material.to_law(MassDistribution::Box), z, omega, step);
        let error = (found[0] - re / square).abs().max((found[1] + im / square).abs());
        println!("omega {omega}: {found:?}, error {error:e}");
        assert!(error < 1e-10);
        if omega < 0.1 {
            let lumped = transmission(&material.to_law(MassDistribution::Lumped), z, omega, step);
            let difference = (lumped[0] - found[0]).abs().max((lumped[1] - found[1]).abs());
            println!("lumped differs by {difference:e}");
            assert!(difference < omega.powi(2));
        }
    }
}

/// For long waves the transmission coefficients of the lumped and the box scheme differ only in third order of ω.
#[test]
fn lumped_and_box_layers_agree_for_long_waves() {
    let material = LayerMaterial::Elastic(elastic_material(0.7, 2.1));
    let difference = |omega: f64| {
        let [one, other] =
            MASS_DISTRIBUTIONS.map(|mass| transmission(&material.to_law(mass), 1.3, omega, 0.1));
        (one[0] - other[0]).hypot(one[1] - other[1])
    };
    let [one, other] = [0.2, 0.1].map(difference);
    println!("{one:e}, {other:e}, order {}", (one / other).log2());
    assert!((one / other).log2() > 1.9);
}

/// Under constant incoming waves that belong to a state at rest with the traction σ every layer comes to rest with σ.
#[test]
fn layers_take_the_static_traction() {
    for (name, material) in layer_materials() {
        let law = material.to_law(Default::default());
        let mut history = initial_history(&law, [[0.0; 2]; 2]);
        // Small compression and shear, so that nothing yields in layers with strength: σ = S at v = 0.
        let target = [-0.05, 0.01];
        let incoming = std::array::from_fn(|i| RiemannData {
            impedance: IMPEDANCES[i],
            invariant: [-target[i], target[i]],
        });
        for number in 0..4000 {
            law.advance(&incoming, &step_interval(number, 0.05), &mut history);
        }
        let record = law.to_face_record(&history);
        let has_strength = !name.contains("no shear");
        println!("{name}: {} {}", record.normal_stress, record.shear_stress);
        assert!((record.normal_stress - target[0]).abs() < 1e-9, "{name}");
        assert!(!has_strength || (record.shear_stress - target[1]).abs() < 1e-9, "{name}");
    }
}

/// Verifies that the tails of waves, whose squares and reciprocals leave the range of numbers, keep all laws finite.
#[test]
fn laws_stay_finite_for_subnormal_waves() {
    for (name, material) in layer_materials() {
        let law = material.to_law(MassDistribution::Box);
        for exponent in [-150, -200, -290, -300, -304, -306, -307, -308, -310, -315, -320, -323] {
            let scale = 10f64.powi(exponent);
            let mut waves = RandomLoad::new(5);
            let mut history = initial_history(&law, [[0.0; 2]; 2]);
            for number in 0..400 {
                let incoming = waves.next().map(|own| RiemannData {
                    invariant: own.invariant.map(|value| value * scale),
                    ..own
                });
                let states = law.advance(&incoming, &step_interval(number, 0.1), &mut history);
                let mut all =
                    states.as_flattened().iter().flat_map(|own| [own.velocity, own.stress]);
                assert!(
                    all.all(f64::is_finite) && history.iter().all(|own| own.is_finite()),
                    "{name}, 1e{exponent}, step {number}: {states:?}"
                );
            }
        }
    }
}
