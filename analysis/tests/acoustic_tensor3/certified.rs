//! Extremes with a certificate against the search and against the quadratic equation of classical solids.

use super::random_solids::{
    random_cosserat_mises, random_isotropic, random_rotation, random_stress, rank_one_update,
    rotate_tensor,
};
use crate::support::states::{RandomNumbers, seeded_generator};
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::yield_set::parameters::Mises;
use wellposed_analysis::acoustic_tensor3::{AcousticTensor3, NormalSearchWorkspace};

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
#[ignore = "takes a minute"]
fn certified_extremes_of_many_solids_agree_with_the_search() {
    compare_with_search(100);
}

/// Checks `count` random solids of each kind, each with 12 yield sets.
fn compare_with_search(count: usize) {
    let random = &mut seeded_generator(21);
    for kind in KINDS {
        let (mut worst, mut certified, mut calm, mut total) = (0.0_f64, 0, 0, 0);
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
            "{kind:?}: {certified} of {calm} without flutter, {total} in all; worst {worst:e}; \
             {:.1} and {:.1} µs",
            1e6 * own_seconds[0] / f64::from(total),
            1e6 * own_seconds[1] / f64::from(total)
        );
        let share = match kind {
            SolidKind::Classical => 1.0,
            _ => 0.0,
        };
        assert!(f64::from(certified) >= share * calm as f64);
    }
}
