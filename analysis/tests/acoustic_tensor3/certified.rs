//! Extremes with a certificate against the search and against the quadratic equation of classical solids.

use super::random_solids::{
    random_cosserat_mises, random_isotropic, random_rotation, random_stress, rank_one_update,
    rotate_tensor,
};
use crate::support::states::{RandomNumbers, seeded_generator};
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::yield_set::parameters::Mises;
use wellposed_analysis::acoustic_tensor3::{
    AcousticTensor3, ExtremesMethod, NormalSearchWorkspace,
};

/// Kinds of solids in the comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SolidKind {
    Classical,
    ReducedCosserat,
    /// Rotation waves slower than pressure waves.
    SlowRotation,
    /// Torsion and rotation waves faster than pressure waves.
    FastRotation,
    AnyCosserat,
}

const KINDS: [SolidKind; 5] = [
    SolidKind::Classical,
    SolidKind::ReducedCosserat,
    SolidKind::SlowRotation,
    SolidKind::FastRotation,
    SolidKind::AnyCosserat,
];

fn random_solid(random: &mut RandomNumbers, kind: SolidKind) -> Isotropic {
    let mut solid = random_isotropic(random, kind != SolidKind::Classical);
    let longitudinal = solid.speeds().longitudinal.powi(2);
    let Some(microrotation) = &mut solid.microrotation else { return solid };
    match (kind, &mut microrotation.couple) {
        (SolidKind::ReducedCosserat, couple) => *couple = None,
        (SolidKind::SlowRotation | SolidKind::FastRotation, Some(couple)) => {
            couple.beta = couple.beta.max(couple.eta - couple.gamma);
            let [torsion, rotation] = [couple.beta + 2.0 * couple.gamma, couple.gamma + couple.eta];
            microrotation.inertia = match kind {
                SolidKind::SlowRotation => torsion / (longitudinal * random.uniform(0.1, 1.0)),
                _ => rotation / (longitudinal * random.uniform(1.0, 8.0)),
            };
        }
        _ => {}
    }
    solid
}

/// Stress of a kind that `case` selects: any, with two equal principal values, with a small deviator, or without couple
/// stress or antisymmetric stress.
fn stress_of_case(random: &mut RandomNumbers, is_cosserat: bool, case: usize) -> Stress {
    let mut stress = random_stress(random, is_cosserat);
    match case % 5 {
        1 => {
            let [first, other] = [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
            let mut principal = [[0.0; 3]; 3];
            for (axis, value) in [first, other, other].into_iter().enumerate() {
                principal[axis][axis] = value;
            }
            stress.force = rotate_tensor(&random_rotation(random), &principal);
        }
        2 => {
            for (i, row) in stress.force.iter_mut().enumerate() {
                row.iter_mut().for_each(|x| *x *= 1e-6);
                row[i] -= 1.0;
            }
        }
        3 => {
            for i in 0..3 {
                for j in 0..i {
                    stress.force[i][j] = stress.force[j][i];
                }
            }
            stress.couple = [[0.0; 3]; 3];
        }
        4 => stress.couple.iter_mut().flatten().for_each(|x| *x *= 0.2),
        _ => {}
    }
    stress
}

#[test]
fn certified_extremes_agree_with_the_search() {
    compare_with_search(6);
}

#[test]
#[ignore = "takes half a minute"]
fn certified_extremes_of_many_solids_agree_with_the_search() {
    compare_with_search(100);
}

/// The least c² of a classical solid by formulas in principal stresses: in the plane of the greatest and the least
/// deviator s₁ and s₃, waves have w_p = k (d + a)(d + b) and w_s = k (s₁ − d)(d − s₃), with d = ν·sν and factors from the
/// definitions of D, n and m. Returns the least root over a million values of d.
fn least_squared_speed_in_plane(solid: &Isotropic, set: &Mises, principal: [f64; 3]) -> f64 {
    let mean = principal.iter().sum::<f64>() / 3.0;
    let s = principal.map(|x| x - mean);
    let shear = (0.5 * s.iter().map(|x| x * x).sum::<f64>()).sqrt();
    let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
    let response = set.hardening + solid.mu + bulk * set.friction * set.dilatancy;
    // α = (μ s/τ + K κ̂)ν/(H + n·Dm), β = (μ s/τ + K κ)ν.
    let [high, low] = [f64::max, f64::min].map(|pick| s.into_iter().reduce(pick).unwrap());
    let [high, low] = [high, low].map(|x| solid.mu * x / shear);
    let (c_p, c_s) = ((solid.lambda + 2.0 * solid.mu) / solid.density, solid.mu / solid.density);
    let scale = 1.0 / (response * solid.density);
    let root_at = |share: f64| {
        let d = low + share * (high - low);
        let along = scale * (d + bulk * set.dilatancy) * (d + bulk * set.friction);
        let across = scale * (high - d) * (d - low);
        let (first, second) = (c_p - along, c_s - across);
        let half = 0.5 * (first - second);
        0.5 * (first + second) - (half * half + along * across).sqrt()
    };
    let samples = 1000;
    let (mut low_share, mut high_share) = (0.0, 1.0);
    let mut least = f64::INFINITY;
    for _ in 0..6 {
        let step = (high_share - low_share) / f64::from(samples);
        let at = |i: i32| low_share + step * f64::from(i);
        let best =
            (0..=samples).min_by(|&i, &j| root_at(at(i)).total_cmp(&root_at(at(j)))).unwrap();
        least = root_at(at(best));
        (low_share, high_share) =
            ((at(best) - 2.0 * step).max(0.0), (at(best) + 2.0 * step).min(1.0));
    }
    least
}

#[test]
fn slowest_waves_of_classical_solids_are_in_the_plane_of_extreme_stresses() {
    let random = &mut seeded_generator(22);
    let mut worst: f64 = 0.0;
    for case in 0..300 {
        let solid = random_isotropic(random, false);
        let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
        let mut principal = [0.0; 3].map(|_: f64| random.uniform(-1.0, 1.0));
        match case % 4 {
            1 => principal[2] = principal[1],
            2 => principal = principal.map(|x| 1e-5 * x - 1.0),
            _ => {}
        }
        let axes = random_rotation(random);
        let mut force = [[0.0; 3]; 3];
        (0..3).for_each(|axis| force[axis][axis] = principal[axis]);
        let stress = Stress { force: rotate_tensor(&axes, &force), couple: [[0.0; 3]; 3] };
        let set = Mises {
            hardening: random.uniform(-0.4, 0.4) * solid.mu,
            ..Mises::new_drucker_prager(1.0, random.uniform(0.0, 1.5), random.uniform(-0.5, 1.5))
        };
        let Ok(update) = rank_one_update(&solid, &set.condition(&stress).unwrap()) else {
            continue;
        };
        let found = tensor.certified_extremes(&update).unwrap().expect("always decided");
        let fastest = (solid.lambda + 2.0 * solid.mu) / solid.density;
        let expected = least_squared_speed_in_plane(&solid, &set, principal);
        let difference = (found.slowest.squared_speed - expected).abs() / fastest;
        worst = worst.max(difference);
        assert!(difference < 1e-10, "{difference:e}: {found:?}, {expected:e}, {principal:?}");
        // The wave normal is perpendicular to the axis of the middle principal stress.
        if case % 4 != 1 {
            let mut order = [0, 1, 2];
            order.sort_by(|&i, &j| principal[i].total_cmp(&principal[j]));
            let middle: f64 = (0..3).map(|i| axes[i][order[1]] * found.slowest.normal[i]).sum();
            assert!(middle.abs() < 1e-6, "{middle:e}: {found:?}, {principal:?}");
        }
    }
    println!("worst {worst:e}");
}

/// Checks `count` random solids of each kind, each with 12 yield sets.
fn compare_with_search(count: usize) {
    let random = &mut seeded_generator(21);
    for kind in KINDS {
        let (mut worst, mut worst_flutter) = (0.0_f64, 0.0_f64);
        let (mut certified, mut calm, mut total) = (0, 0, 0);
        let mut own_seconds = [0.0; 2];
        for _ in 0..count {
            let solid = random_solid(random, kind);
            let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
            let mut workspace = NormalSearchWorkspace::default();
            let fastest = {
                let speeds = solid.speeds();
                [Some(speeds.longitudinal), Some(speeds.shear), speeds.torsion, speeds.rotation]
                    .into_iter()
                    .flatten()
                    .fold(0.0, f64::max)
                    .powi(2)
            };
            for case in 0..12 {
                let mut set = random_cosserat_mises(random);
                if case % 3 == 1 {
                    set.dilatancy = set.friction + random.uniform(-1e-3, 1e-3);
                }
                if kind == SolidKind::Classical {
                    set = Mises::new_drucker_prager(1.0, set.friction, set.dilatancy);
                }
                set.hardening = random.uniform(-0.3, 0.3) * solid.mu;
                let stress = stress_of_case(random, kind != SolidKind::Classical, case);
                let Ok(update) = rank_one_update(&solid, &set.condition(&stress).unwrap()) else {
                    continue;
                };
                let start = std::time::Instant::now();
                let found = tensor.certified_extremes(&update).unwrap();
                own_seconds[0] += start.elapsed().as_secs_f64();
                let start = std::time::Instant::now();
                let expected = tensor.search_extremes(&update, &mut workspace).unwrap();
                own_seconds[1] += start.elapsed().as_secs_f64();
                total += 1;
                calm += usize::from(expected.flutter.is_none());
                let (either, method) = tensor.find_extremes(&update, &mut workspace).unwrap();
                let slower = either.slowest.squared_speed - expected.slowest.squared_speed;
                assert!(slower.abs() < 1e-9 * fastest, "{either:?} {expected:?} {solid:?} {set:?}");
                assert_eq!(either.flutter.is_some(), expected.flutter.is_some());
                if let (Some(own), Some(other)) = (either.flutter, expected.flutter) {
                    let difference = own.max_imaginary_speed - other.max_imaginary_speed;
                    worst_flutter = worst_flutter.max(difference.abs() / fastest.sqrt());
                    assert!(
                        difference.abs() < 1e-8 * fastest.sqrt(),
                        "{own:?} {other:?} {solid:?}"
                    );
                }
                assert_eq!(method == ExtremesMethod::Certified, found.is_some());
                let Some(found) = found else { continue };
                certified += 1;
                assert_eq!(expected.flutter, None, "{kind:?} {solid:?} {set:?} {stress:?}");
                let difference =
                    (found.slowest.squared_speed - expected.slowest.squared_speed) / fastest;
                assert!(
                    difference.abs() < 1e-9,
                    "{difference:e}: {found:?} {expected:?} {kind:?} {solid:?} {set:?} {stress:?}"
                );
                assert_eq!(found.slowest.rounding, expected.slowest.rounding);
                worst = worst.max(difference.abs());
                let there = tensor.squared_speeds(&update, found.slowest.normal).unwrap();
                assert!((there[0].re - found.slowest.squared_speed).abs() < 1e-12 * fastest);
            }
        }
        println!(
            "{kind:?}: {certified} of {calm} without flutter, {total} in all; worst {worst:e}, \
             of flutter {worst_flutter:e}; {:.1} and {:.1} µs",
            1e6 * own_seconds[0] / f64::from(total),
            1e6 * own_seconds[1] / f64::from(total)
        );
        // The others have shear waves faster than pressure waves, rotation waves faster than torsion waves, or no
        // certificate.
        let share = match kind {
            SolidKind::Classical => 1.0,
            SolidKind::ReducedCosserat => 0.5,
            SolidKind::SlowRotation | SolidKind::FastRotation => 0.35,
            SolidKind::AnyCosserat => 0.2,
        };
        assert!(f64::from(certified) >= share * calm as f64);
    }
}
