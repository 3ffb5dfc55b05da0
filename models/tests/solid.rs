//! Elastic laws by moduli and by compliances, and stresses scaled onto yield.

use wellposed_models::elastoplastic::{PlasticState, Solid, scale_onto_yield};
use wellposed_models::solid::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances,
};
use wellposed_models::solid::stress::Stress;
use wellposed_models::solid::{ElasticLaw, Elasticity};
use wellposed_models::yield_set::YieldSet;
use wellposed_models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};

fn cosserat_solid() -> Isotropic {
    let couple = CoupleModuli { beta: 1e3, gamma: 2e3, eta: 3e3 };
    let rotation = Microrotation { alpha: 5e8, inertia: 0.7, couple: Some(couple) };
    Isotropic::new(2e9, 1.5e9, 2000.0, Some(rotation)).unwrap()
}

fn stress_direction() -> Stress {
    let mut stress = Stress::default();
    stress.force[0] = [2.0, 3.0, 0.0];
    stress.force[1] = [1.0, -2.0, 0.0];
    stress.couple[2] = [0.5, -0.25, 0.0];
    stress
}

fn interlayer_set() -> InterlayerYieldSet {
    let couple = InterlayerCoupleLimits { strength: 4e3, friction: 0.01, dilatancy: 0.01 };
    let (shear_strength, shear_friction, shear_dilatancy) = (1e5, 0.4, 0.4);
    let couple = Some(couple);
    InterlayerYieldSet { shear_strength, shear_friction, shear_dilatancy, couple }.check().unwrap()
}

fn yield_sets() -> [YieldSet; 3] {
    [
        YieldSet::from(interlayer_set()),
        YieldSet::from(Mises::new_von_mises(1e5)),
        YieldSet::from(Mises::new_drucker_prager(1e5, 0.5, 0.2)),
    ]
}

/// A Cosserat solid by moduli and the same solid by compliances have equal properties and rate equations.
#[test]
fn moduli_and_equivalent_compliances_give_the_same_law() {
    let moduli = ElasticLaw::from(cosserat_solid());
    let compliances =
        ElasticLaw::from(PlaneCompliances::from_isotropic(&cosserat_solid()).unwrap());
    let quantities: [fn(&dyn Elasticity) -> f64; 4] = [
        |law| law.density(),
        |law| law.inertia(),
        |law| law.antisymmetric_modulus(),
        |law| law.characteristic_wave_number().unwrap(),
    ];
    for quantity in quantities {
        let [one, other] = [&moduli, &compliances].map(|law| quantity(&**law));
        assert!((one - other).abs() <= 1e-13 * one, "{one} {other}");
    }
    assert_eq!(moduli.theory(), compliances.theory());
    assert_eq!(moduli.state_fields(2), compliances.state_fields(2));
    let [one, other] = [&moduli, &compliances].map(|law| law.rates::<2>().stiffness_values());
    assert!((&one - &other).amax() <= 1e-13 * one.amax());
    assert_eq!(Solid::new(compliances, 3, None).dimensions, 2);
}

/// A classical solid has no microrotation and no internal length.
#[test]
fn classical_solid_has_no_internal_length() {
    let solid = Isotropic::new(2e9, 1.5e9, 2000.0, None).unwrap();
    let law = ElasticLaw::from(solid);
    assert_eq!(law.characteristic_wave_number(), None);
    assert_eq!((law.inertia(), law.antisymmetric_modulus()), (0.0, 0.0));
    assert!(law.rotation().is_none());
}

/// A scaled stress is on the yield surface and does not depend on the magnitude of the direction.
#[test]
fn scaled_stresses_lie_on_the_yield_surface() {
    for set in yield_sets() {
        for pressure in [0.0, 3e4, 2e6] {
            let stress = scale_onto_yield(&set, pressure, &stress_direction()).unwrap();
            let size = stress.force.as_flattened().iter().fold(0.0f64, |a, x| a.max(x.abs()));
            assert!(set.yield_function(&stress).abs() <= 1e-12 * size, "{set:?} {pressure}");
            // Doubling the direction does not change the scaled stress.
            let mut doubled = stress_direction();
            doubled.force = doubled.force.map(|row| row.map(|x| 2.0 * x));
            doubled.couple = doubled.couple.map(|row| row.map(|x| 2.0 * x));
            assert_eq!(scale_onto_yield(&set, pressure, &doubled), Ok(stress));
            let plastic =
                PlasticState::from_stress(set.clone(), pressure, &stress_direction(), 0.0).unwrap();
            assert_eq!(
                (plastic.stress, plastic.active_conditions.is_empty()),
                (Some(stress), false)
            );
        }
    }
}

/// A zero direction, which never yields, a negative rate, a pressure outside the yield set, and a set without strength
/// at zero pressure are rejected.
#[test]
fn stresses_that_never_yield_are_rejected() {
    let assert_rejected =
        |set: YieldSet, pressure: f64, direction: &Stress, rate: f64, expected_text: &str| {
            let error = PlasticState::from_stress(set, pressure, direction, rate).unwrap_err();
            assert!(error.to_string().contains(expected_text), "{error}");
        };
    for set in yield_sets() {
        assert_rejected(set.clone(), 1e4, &Stress::default(), 0.0, "never yield");
        assert_rejected(set, 1e4, &stress_direction(), -1.0, "Λ ≥ 0");
    }
    for set in [yield_sets()[0].clone(), yield_sets()[2].clone()] {
        assert_rejected(set, -1e6, &stress_direction(), 0.0, "a pressure within the yield set");
    }
    let without_strength =
        YieldSet::from(InterlayerYieldSet { shear_strength: 0.0, ..interlayer_set() });
    assert_rejected(
        without_strength,
        0.0,
        &stress_direction(),
        0.0,
        "no strength under this pressure",
    );
}

/// Active interlayer conditions are selected by index.
#[test]
fn active_interlayer_conditions_are_selected_by_index() {
    let plastic = PlasticState::with_active(interlayer_set().into(), &[0, 3]).unwrap();
    let all: Vec<_> = interlayer_set().half_spaces().map(|(condition, _)| condition).collect();
    assert_eq!(plastic.active_conditions, [all[0], all[3]]);
    assert!(PlasticState::with_active(interlayer_set().into(), &[8]).is_err());
    let solid = Solid::new(cosserat_solid().into(), 2, Some(plastic));
    assert!(solid.is_associated() && solid.is_symmetric_hyperbolic());
    assert!(solid.rates::<2>().is_ok() && solid.damped_rates::<2>().unwrap().is_none());
}
