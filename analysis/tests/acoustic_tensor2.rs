//! Flutter and shear bands in the plane, against closed forms, brute force and the exact polynomial.

use crate::support::slipping_layer::SlippingLayer;
use crate::support::states::{RandomNumbers, seeded_generator};
use models::LinearisedSystem;
use models::common::rates::RateEquations;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{
    ActiveCondition, InterlayerCoupleLimits, InterlayerYieldSet, Mises,
};
use models::yield_set::tangent::tangent_stiffness;
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_analysis::acoustic_tensor2::AcousticTensor2;
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;
use wellposed_analysis::waves::squared_speeds;

/// Random isotropic solid, classical or Cosserat, with or without couple stress.
fn random_solid(random: &mut RandomNumbers) -> Isotropic {
    let microrotation = random.bernoulli(0.67).then(|| Microrotation {
        alpha: random.log_uniform(0.02, 2.0),
        inertia: random.log_uniform(0.1, 10.0),
        couple: random.bernoulli(0.5).then(|| CoupleModuli {
            beta: random.uniform(-0.5, 1.0),
            gamma: random.uniform(1.0, 2.0),
            eta: random.uniform(0.1, 1.0),
        }),
    });
    Isotropic::new(random.uniform(-0.5, 3.0), 1.0, 1.0, microrotation).expect("sound moduli")
}

/// Rate equations of a random yielding solid whose friction and dilatancy differ: Mises-type, or slipping layers with
/// any number of active conditions. `None` if the rate response is not defined.
fn random_yielding_equations(random: &mut RandomNumbers) -> Option<RateEquations<2>> {
    let solid = random_solid(random);
    let layout = solid.layout::<2>();
    let list: Vec<_> = layout.all_stresses().collect();
    let active: Vec<ActiveCondition> = if random.bernoulli(0.5) {
        let set = InterlayerYieldSet {
            shear_strength: 1.0,
            shear_friction: random.uniform(0.0, 1.5),
            shear_dilatancy: random.uniform(-0.3, 1.5),
            couple: solid.couple().map(|_| InterlayerCoupleLimits {
                strength: 1.0,
                friction: random.uniform(0.0, 1.5),
                dilatancy: random.uniform(-0.3, 1.5),
            }),
        };
        let all: Vec<ActiveCondition> = set.half_spaces().map(|(c, _)| c).collect();
        let pairs = all.len() / 2;
        let chosen: Vec<usize> = (0..pairs).filter(|_| random.bernoulli(0.4)).collect();
        chosen.iter().map(|pair| all[2 * pair + usize::from(random.bernoulli(0.5))]).collect()
    } else {
        let mut entry = || random.uniform(-1.0, 1.0);
        let mut force: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| entry()));
        let couple = std::array::from_fn(|_| std::array::from_fn(|_| entry()));
        if solid.microrotation.is_none() {
            force[1][0] = force[0][1];
        }
        let set = Mises {
            antisymmetric_weight: random.uniform(0.0, 2.0),
            symmetric_internal_length: Some(1.0),
            antisymmetric_internal_length: Some(0.7),
            hardening: random.uniform(-0.2, 0.3),
            ..Mises::new_drucker_prager(1.0, random.uniform(0.0, 1.2), random.uniform(-0.3, 1.2))
        };
        set.condition(&Stress { force, couple }).into_iter().collect()
    };
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    let stiffness =
        tangent_stiffness(&solid.stiffness(layout.all_stresses()), &list, &active).ok()?;
    Some(layout.rates(&stiffness, 1.0, inertia))
}

/// Verifies the squared speeds against the squared speeds of plane waves.
#[test]
fn speeds_agree_with_plane_waves() {
    let random = &mut seeded_generator(1);
    let mut worst = 0.0f64;
    for _ in 0..2000 {
        let Some(equations) = random_yielding_equations(random) else { continue };
        let tensor = AcousticTensor2::new(&equations);
        let angle = random.uniform(0.0, PI);
        let found = tensor.squared_speeds(angle);
        let expected = squared_speeds(&equations, [angle.cos(), angle.sin()]);
        // The spin of a reduced solid carries no waves.
        let largest = expected.iter().map(|c| c.norm()).fold(0.0, f64::max);
        for value in &found {
            let near = expected.iter().map(|c| (c - value).norm()).fold(f64::INFINITY, f64::min);
            worst = worst.max(near / largest);
        }
        let sum = |list: &[Complex64]| list.iter().sum::<Complex64>();
        assert!((sum(&found) - sum(&expected)).norm() < 1e-12 * largest);
    }
    println!("{worst:e}");
    // Near double roots half of the digits are lost.
    assert!(worst < 1e-7);
}

/// Verifies the verdict from the exact polynomial of the first-order equations against flutter and shear bands from the
/// acoustic tensor: growth of order k with the same coefficient.
#[test]
fn verdict_agrees_with_flutter_and_shear_bands() {
    check_verdicts(1000);
}

/// Checks `count` random yielding solids.
fn check_verdicts(count: u32) {
    let random = &mut seeded_generator(2);
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    let [mut assessed, mut ill, mut flutter, mut marginal, mut lower] = [0; 5];
    let mut worst = 0.0f64;
    while assessed < count {
        let Some(equations) = random_yielding_equations(random) else { continue };
        assessed += 1;
        equations.linearise(&mut system);
        pencil.update(&system).expect("finite");
        let verdict = assess(&pencil).verdict;
        let hint = match verdict {
            Verdict::IllPosed { direction, .. } => Some(direction),
            _ => None,
        };
        let extremes = AcousticTensor2::new(&equations).search_extremes(hint.as_slice());
        flutter += u32::from(extremes.flutter.is_some());
        let shear_band = extremes.slowest.squared_speed < -extremes.slowest.rounding;
        let grows = extremes.flutter.is_some() || shear_band;
        match verdict {
            Verdict::IllPosed { growth: Some(growth), .. } if growth.order.to_f64() == 1.0 => {
                ill += 1;
                assert!(grows, "{growth:?} without complex or imaginary speeds");
                // The coefficient is the square root of a discriminant: small coefficients lose digits.
                let difference = (extremes.max_imaginary_speed() - growth.coefficient).abs();
                worst = worst.max(difference * growth.coefficient);
            }
            Verdict::IllPosed { .. } => lower += 1,
            Verdict::WellPosed => assert!(!grows, "well-posed with {extremes:?}"),
            _ => marginal += 1,
        }
    }
    println!(
        "{ill} ill-posed, {flutter} with flutter, {marginal} marginal, {lower} of lower order, \
         squares of coefficients agree to {worst:e}"
    );
    assert!(10 * ill > count && 30 * flutter > count);
    assert_eq!(lower, 0);
    assert!(marginal <= assessed / 50);
    assert!(worst < 1e-11);
}

#[test]
fn sectors_of_flutter_end_where_the_discriminant_vanishes() {
    let mut sectors = 0;
    for dilatancy in [-0.3, -0.1, 0.0, 0.1, 0.2, 0.25] {
        let layer = SlippingLayer { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy };
        // Discriminant relative to the squared trace.
        let discriminant = |angle: f64| {
            let [trace, determinant] = layer.acoustic_invariants(angle);
            (trace * trace - 4.0 * determinant) / (trace * trace)
        };
        for [from, to] in AcousticTensor2::new(&layer.equations()).flutter_sectors() {
            sectors += 1;
            for (edge, inwards) in [(from, 1e-6), (to, -1e-6)] {
                assert!(discriminant(edge + inwards) < 0.0, "{edge} of dilatancy {dilatancy}");
                assert!(discriminant(edge - inwards) > 0.0, "{edge} of dilatancy {dilatancy}");
            }
        }
    }
    assert!(sectors >= 6, "{sectors}");
    let associated = SlippingLayer { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy: 0.6 };
    assert!(AcousticTensor2::new(&associated.equations()).flutter_sectors().is_empty());
}

#[test]
fn speeds_vanish_along_the_layer_and_where_the_determinant_does() {
    for dilatancy in [0.0, 0.3, 0.6, 0.9, 1.2, 1.5] {
        let layer = SlippingLayer { lambda: 0.0, alpha: 0.1, friction: 1.5, dilatancy };
        let found = AcousticTensor2::new(&layer.equations()).zero_speed_directions();
        // Count zeros by sign changes of the determinant divided by the double zero along the layer.
        let reduced = |i: i32| {
            let angle = (f64::from(i) + 0.5) * PI / 20_000.0;
            layer.acoustic_invariants(angle)[1] / angle.sin().powi(2)
        };
        let changes = (0..19_999).filter(|&i| (reduced(i) > 0.0) != (reduced(i + 1) > 0.0)).count();
        assert!(found[0] < 1e-6, "{found:?}");
        assert_eq!(found.len(), 1 + changes, "dilatancy {dilatancy}: {found:?}");
        for angle in &found[1..] {
            let [trace, determinant] = layer.acoustic_invariants(*angle);
            assert!(determinant.abs() < 1e-10 * trace * trace, "{determinant:e}");
        }
    }
}

#[test]
fn search_finds_extremes_of_brute_force() {
    compare_with_brute_force(20);
}

/// Checks `count` random yielding solids.
fn compare_with_brute_force(count: usize) {
    let random = &mut seeded_generator(3);
    let mut cases = 0;
    while cases < count {
        let Some(equations) = random_yielding_equations(random) else { continue };
        cases += 1;
        let extremes = AcousticTensor2::new(&equations).search_extremes(&[]);
        let (mut growth, mut least) = (0.0f64, f64::INFINITY);
        for i in 0..2000 {
            let angle = PI * (f64::from(i) + 0.37) / 2000.0;
            let moving =
                equations.velocity_count().min(2 + usize::from(equations.stress_count() > 4));
            let speeds = squared_speeds(&equations, [angle.cos(), angle.sin()]);
            for c in &speeds {
                if c.im.abs() > 1e-4 {
                    growth = growth.max(c.sqrt().im.abs());
                } else if c.re < -1e-9 || moving == equations.velocity_count() {
                    least = least.min(c.re);
                }
            }
        }
        let found = extremes.flutter.map_or(0.0, |flutter| flutter.max_imaginary_speed);
        assert!(found >= growth * (1.0 - 1e-9), "{found} {growth}");
        if least.is_finite() {
            let slowest = extremes.slowest.squared_speed;
            assert!(slowest <= least + 1e-9, "{slowest} {least}");
        }
    }
}

#[test]
fn von_mises_yielding_in_pure_shear_has_zero_speeds_at_45_degrees() {
    // An elastic solid: two speeds, no zero speed, no flutter.
    let solid = Isotropic::new(1.0, 1.0, 1.0, None).expect("sound moduli");
    let tensor = AcousticTensor2::new(&solid.rates::<2>());
    let extremes = tensor.search_extremes(&[]);
    assert!(extremes.flutter.is_none());
    assert!((extremes.slowest.squared_speed - 1.0).abs() < 1e-14);
    assert!(tensor.zero_speed_directions().is_empty() && tensor.flutter_sectors().is_empty());
    // Ideal von Mises yielding in pure shear: c² = 0 at ±45° from the axes, a double zero, since the flow is
    // associated.
    let mut stress = Stress::default();
    (stress.force[0][0], stress.force[1][1]) = (1.0, -1.0);
    let set = YieldSet::from(Mises::new_von_mises(1.0));
    let active = set.active_conditions(&stress, 1e-9);
    let layout = solid.layout::<2>();
    let list: Vec<_> = layout.all_stresses().collect();
    let stiffness = tangent_stiffness(&solid.stiffness(layout.all_stresses()), &list, &active);
    let equations: RateEquations<2> = layout.rates(&stiffness.expect("response"), 1.0, 0.0);
    let vanishing = AcousticTensor2::new(&equations).zero_speed_directions();
    assert_eq!(vanishing.len(), 2, "{vanishing:?}");
    for (angle, expected) in vanishing.iter().zip([0.25 * PI, 0.75 * PI]) {
        assert!((angle - expected).abs() < 1e-6, "{angle}");
    }
}

#[test]
#[ignore = "takes a quarter of a minute"]
fn verdicts_and_searches_agree_for_many_solids() {
    check_verdicts(3000);
    compare_with_brute_force(60);
}
