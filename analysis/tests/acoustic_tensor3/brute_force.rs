//! The search and all speeds of a direction against eigenvalues by nalgebra.

use super::directions::{fibonacci_directions, maximise_by_pattern_search};
use super::random_solids::{
    random_anisotropic, random_cosserat_mises, random_isotropic, random_stress, rank_one_update,
    search_extremes,
};
use crate::support::states::seeded_generator;
use models::common::rates::RateEquations;
use models::yield_set::parameters::Mises;
use nalgebra::{DMatrix, DVector, Vector3};
use wellposed_analysis::acoustic_tensor3::{AcousticTensor3, RankOneUpdate};

/// Eigenvalues (re, im) of M^(−½) G(n)ᵀ (D − a bᵀ) G(n) M^(−½) by nalgebra.
fn squared_speeds_by_nalgebra(
    elastic: &RateEquations<3>,
    update: &RankOneUpdate,
    n: [f64; 3],
) -> Vec<(f64, f64)> {
    let tangent = elastic.stiffness_values()
        - DVector::from_vec(update.flow_image.clone())
            * DVector::from_vec(update.normal_image.clone()).transpose();
    let mut g = DMatrix::zeros(elastic.stress_count(), elastic.velocity_count());
    for (gradient, component) in elastic.gradient.iter().zip(n) {
        g += gradient * component;
    }
    for (v, inertia) in elastic.inertia.iter().enumerate() {
        g.column_mut(v).scale_mut(1.0 / inertia.value.sqrt());
    }
    let acoustic = g.transpose() * tangent * g;
    acoustic.complex_eigenvalues().iter().map(|z| (z.re, z.im)).collect()
}

/// Smallest real c², and largest |Im c| of complex c². A double root is split by the square root of the rounding error,
/// so small imaginary parts count as zero.
fn extremes_from_speeds(speeds: &[(f64, f64)]) -> (f64, f64) {
    let size = speeds.iter().fold(0.0, |size: f64, (re, im)| size.max(re.abs()).max(im.abs()));
    let (mut least, mut growth) = (f64::INFINITY, 0.0_f64);
    for &(re, im) in speeds {
        if im.abs() < 1e-5 * size {
            least = least.min(re);
        } else {
            growth = growth.max((0.5 * (re.hypot(im) - re)).sqrt());
        }
    }
    (least, growth)
}

fn compare_with_brute_force(
    elastic: &RateEquations<3>,
    tensor: &AcousticTensor3,
    update: &RankOneUpdate,
    worst: &mut [f64; 2],
) -> bool {
    let found = search_extremes(tensor, update);
    let speeds = |n| extremes_from_speeds(&squared_speeds_by_nalgebra(elastic, update, n));
    let unit = fibonacci_directions(50)
        .flat_map(|n| squared_speeds_by_nalgebra(elastic, update, n))
        .fold(0.0, |size: f64, (re, im)| size.max(re.hypot(im)));
    let (mut slowest, mut flutter) = (([0.0; 3], f64::INFINITY), ([0.0; 3], 0.0));
    for n in fibonacci_directions(3000) {
        let (least, growth) = speeds(n);
        if least < slowest.1 {
            slowest = (n, least);
        }
        if growth > flutter.1 {
            flutter = (n, growth);
        }
    }
    let least = -maximise_by_pattern_search(slowest.0, 0.02, |n| -speeds(n).0).1;
    let own = &found.slowest;
    // The c² found by the search is not larger than that of brute force, and is an eigenvalue.
    let difference = (own.squared_speed - least) / unit;
    assert!(difference < 1e-9, "{own:?}, brute force {least:e} at {:?}", slowest.0);
    let nearest = |n, re: f64, im: f64| {
        let there = squared_speeds_by_nalgebra(elastic, update, n);
        there.iter().fold(f64::INFINITY, |d, z| d.min((z.0 - re).hypot(z.1 - im))) / unit
    };
    // nalgebra computes a double root to the square root of the rounding only.
    assert!(nearest(own.normal, own.squared_speed, 0.0) < 1e-6, "{own:?}");
    worst[0] = worst[0].max(difference.abs());
    let growth = if flutter.1 > 0.0 {
        maximise_by_pattern_search(flutter.0, 0.02, |n| speeds(n).1).1
    } else {
        0.0
    };
    let own = found.flutter.map_or(0.0, |flutter| flutter.max_imaginary_speed);
    let difference = (growth - own) / unit.sqrt();
    assert!(difference < 1e-8, "{:?}, brute force {growth:e} at {:?}", found.flutter, flutter.0);
    if let Some(flutter) = found.flutter {
        let z = flutter.squared_speed;
        let distance = nearest(flutter.normal, z.re, z.im);
        assert!(distance < 1e-6, "{flutter:?} is off by {distance:e}");
    }
    if growth > 0.0 {
        worst[1] = worst[1].max(difference.abs());
    }
    if let Some(certified) = tensor.certified_extremes(update).unwrap() {
        let own = &certified.slowest;
        assert!(growth == 0.0, "certified without flutter, brute force {growth:e}");
        let difference = (own.squared_speed - least) / unit;
        assert!(difference.abs() < 1e-9, "{own:?}, brute force {least:e} at {:?}", slowest.0);
        assert!(nearest(own.normal, own.squared_speed, 0.0) < 1e-6, "{own:?}");
    }
    found.flutter.is_some()
}

#[test]
fn search_agrees_with_brute_force_for_yielding_solids() {
    compare_yielding_solids(24);
}

/// Checks `count` random solids.
fn compare_yielding_solids(count: u32) {
    let random = &mut seeded_generator(2);
    let (mut worst, mut flutter, mut total) = ([0.0; 2], 0u32, 0);
    for case in 0..count {
        let is_cosserat = case % 2 == 1;
        let mut solid = random_isotropic(random, is_cosserat);
        // Torsion waves with 0.9 to 1.6 times the squared speed of pressure waves, for which flutter occurs.
        if case % 4 == 1 {
            let couple = solid.couple().unwrap();
            let fast = couple.beta + 2.0 * couple.gamma;
            let longitudinal = (solid.lambda + 2.0 * solid.mu) / solid.density;
            let microrotation = solid.microrotation.as_mut().unwrap();
            microrotation.inertia = fast / (longitudinal * random.uniform(0.9, 1.6));
        }
        let mut set = random_cosserat_mises(random);
        if !is_cosserat {
            set = Mises::new_drucker_prager(1.0, set.friction, set.dilatancy);
        } else if case % 4 == 1 {
            set.friction = 1.5;
            set.dilatancy = -0.5;
        }
        let condition = set.condition(&random_stress(random, is_cosserat)).unwrap();
        let Ok(update) = rank_one_update(&solid, &condition) else { continue };
        let elastic = solid.rates();
        let tensor = AcousticTensor3::new(&elastic).unwrap();
        flutter += u32::from(compare_with_brute_force(&elastic, &tensor, &update, &mut worst));
        total += 1;
    }
    println!("{flutter} of {total} flutter; worst {worst:?}");
    assert!(20 * flutter >= count && 3 * total >= 2 * count);
}

#[test]
fn search_agrees_with_brute_force_for_any_gradients() {
    compare_any_gradients(28);
}

/// Checks `count` random solids.
fn compare_any_gradients(count: u32) {
    let random = &mut seeded_generator(3);
    let (mut worst, mut flutter, mut total) = ([0.0; 2], 0u32, 0);
    for case in 0..count {
        let is_cosserat = case % 2 == 1;
        let elastic = if case % 4 < 2 {
            random_isotropic(random, is_cosserat).rates()
        } else {
            random_anisotropic(random, is_cosserat)
        };
        let size = elastic.stress_count();
        let mut gradient =
            || -> Vec<f64> { (0..size).map(|_| random.uniform(-1.0, 1.0)).collect() };
        let (normal, other) = (gradient(), gradient());
        let part = random.uniform(0.0, 1.2);
        let flow: Vec<f64> = normal.iter().zip(&other).map(|(n, o)| n + part * o).collect();
        let Ok(update) = RankOneUpdate::new(&elastic, &normal, &flow, 0.0) else { continue };
        let tensor = AcousticTensor3::new(&elastic).unwrap();
        flutter += u32::from(compare_with_brute_force(&elastic, &tensor, &update, &mut worst));
        total += 1;
    }
    println!("{flutter} of {total} flutter; worst {worst:?}");
    assert!(4 * flutter >= count && 4 * total >= 3 * count);
}

#[test]
fn squared_speeds_agree_with_nalgebra() {
    let random = &mut seeded_generator(4);
    let mut worst: f64 = 0.0;
    for case in 0..40 {
        let is_cosserat = case % 2 == 1;
        let elastic = random_anisotropic(random, is_cosserat);
        let tensor = AcousticTensor3::new(&elastic).unwrap();
        for _ in 0..50 {
            let size = elastic.stress_count();
            let mut vector = || -> Vec<f64> {
                (0..size).map(|_| random.signed_log_uniform(1e-3, 3.0)).collect()
            };
            let update = RankOneUpdate { flow_image: vector(), normal_image: vector() };
            let n = Vector3::from_fn(|_, _| random.uniform(-1.0, 1.0)).normalize().into();
            let own = tensor.squared_speeds(&update, n).unwrap();
            let brute = squared_speeds_by_nalgebra(&elastic, &update, n);
            let unit = brute.iter().fold(0.0, |size: f64, z| size.max(z.0.hypot(z.1)));
            assert_eq!(own.len(), brute.len());
            for z in own {
                let distance = brute
                    .iter()
                    .fold(f64::INFINITY, |d, other| d.min((z.re - other.0).hypot(z.im - other.1)));
                worst = worst.max(distance / unit);
            }
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-7);
}

#[test]
#[ignore = "takes a quarter of a minute"]
fn search_agrees_with_brute_force_for_many_solids() {
    compare_yielding_solids(60);
    compare_any_gradients(80);
}
