//! Elastic-plastic layers: the tractions stay in the yield set, also at its apex; return mapping; slip.

use crate::interface::support::{
    ELASTIC, MASS_DISTRIBUTIONS, RandomLoad, initial_history, plastic_constants, step_interval,
};
use testkit::random::RandomNumbers;
use wellposed_models::interface::FaceLaw;
use wellposed_models::interface::history;
use wellposed_models::interface::parameters::LayerMaterial;
use wellposed_models::interface::plastic::YieldCone;

#[test]
fn tractions_stay_in_the_yield_set() {
    let constants = [
        plastic_constants(0.4, 0.5, 0.0),
        plastic_constants(0.4, 0.5, 0.002),
        plastic_constants(0.4, 0.0, 0.0),
        plastic_constants(0.0, 0.5, 0.0),
        plastic_constants(0.0, 0.0, 0.0),
        plastic_constants(0.3, 1e-9, 0.0),
        plastic_constants(0.3, 1e3, 1e-3),
    ];
    for distribution in MASS_DISTRIBUTIONS {
        for plastic in constants {
            let law = LayerMaterial::Plastic(ELASTIC, plastic).to_law(distribution);
            let mut load = RandomLoad::new(3);
            let mut history = initial_history(&law, [[0.0; 2]; 2]);
            let (mut worst, mut slipping, mut apex) = (0.0f64, 0, 0);
            for number in 0..20_000 {
                let before = history[history::SLIP];
                law.advance(&load.next(), &step_interval(number, 0.21), &mut history);
                let (normal, shear) =
                    (history[history::NORMAL_STATE], history[history::SHEAR_STRESS]);
                let slip = history[history::SLIP];
                assert!(slip >= before);
                let strength = plastic.shear_strength + plastic.hardening * slip;
                let friction = plastic.friction;
                let size = strength + (friction * normal).abs() + shear.abs();
                if size > 0.0 {
                    worst = worst.max((shear.abs() + friction * normal - strength) / size);
                }
                slipping += usize::from(slip > before);
                apex += usize::from(shear == 0.0 && slip > before);
            }
            println!("{plastic:?}: {worst:e}, slip in {slipping} steps, apex in {apex}");
            assert!(worst <= 4.0 * f64::EPSILON, "{plastic:?}: {worst:e}");
            assert!(slipping > 100);
            assert!(plastic.friction < 0.1 || plastic.hardening > 0.0 || apex > 20);
        }
    }
}

/// The returned traction is the point of the yield set closest to the trial in the weighted norm: it is in the set, no
/// random point of the set is closer, and its distance agrees with the multiplier.
#[test]
fn returned_traction_is_the_closest_point_of_the_yield_set() {
    let mut random = RandomNumbers::new(4);
    let (mut regular, mut apex) = (0, 0);
    for _ in 0..2000 {
        let friction = if random.bernoulli(0.2) { 0.0 } else { random.log_uniform(0.05, 5.0) };
        let strength = random.uniform(0.0, 1.0);
        let yield_cone = YieldCone { strength, friction, hardening: 0.0 };
        let stiffness = [random.log_uniform(0.1, 10.0), random.log_uniform(0.1, 10.0)];
        let trial = [random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)];
        let found = yield_cone.return_traction(trial, stiffness, strength, 0.0);
        let distance = |[normal, shear]: [f64; 2]| {
            stiffness[0] * (normal - trial[0]).powi(2) + stiffness[1] * (shear - trial[1]).powi(2)
        };
        let excess = |[normal, shear]: [f64; 2]| shear.abs() + friction * normal - strength;
        assert!(excess(found.stress) < 1e-14 && found.multiplier >= 0.0);
        if excess(trial) <= 0.0 {
            assert_eq!((found.stress, found.multiplier), (trial, 0.0));
            continue;
        }
        match found.stress[1] == 0.0 {
            true => apex += 1,
            false => regular += 1,
        }
        for _ in 0..200 {
            let size = random.log_uniform(1e-6, 3.0);
            let other = found.stress.map(|x| x + random.uniform(-size, size));
            if excess(other) <= 0.0 {
                assert!(distance(other) >= distance(found.stress) * (1.0 - 1e-9));
            }
        }
    }
    println!("{regular} on the faces, {apex} at the apex");
    assert!(regular > 500 && apex > 50);
}

/// For slip in one direction the slip is the jump of the displacement minus its elastic part.
#[test]
fn slip_is_the_jump_of_displacement_beyond_the_elastic_one() {
    let law = LayerMaterial::Plastic(ELASTIC, plastic_constants(0.4, 0.0, 0.3))
        .to_law(Default::default());
    let mut history = initial_history(&law, [[0.0; 2]; 2]);
    let mut displacement = 0.0;
    let mut load = RandomLoad::new(3).next();
    for number in 0..200 {
        load[1].invariant = [1.0 + 0.01 * number as f64, 0.0];
        let [_, [before, after]] = law.advance(&load, &step_interval(number, 0.05), &mut history);
        displacement += 0.05 * (after.velocity - before.velocity);
    }
    let record = law.to_face_record(&history);
    let elastic = ELASTIC.tangential_compliance() * record.shear_stress;
    println!("{displacement} {elastic} {}", record.slip);
    assert!((displacement - elastic + record.slip).abs() < 1e-12 * record.slip);
    assert!(record.slip > 1.0 && record.slip_time > 0.05);
}
