//! Invariance under rotations, threads and workspaces.

use super::random_solids::{
    Tensor, random_anisotropic, random_isotropic, random_rotation, random_stress, rank_one_update,
    rotate_tensor, search_extremes,
};
use crate::support::states::seeded_generator;
use models::solid::stress::Stress;
use models::yield_set::parameters::ActiveCondition;
use wellposed_analysis::acoustic_tensor3::{AcousticTensor3, RankOneUpdate, WaveExtremes};

#[test]
fn extremes_are_invariant_under_rotation() {
    check_rotations(28);
}

/// Checks `count` random solids with ten conditions each.
fn check_rotations(count: usize) {
    let random = &mut seeded_generator(8);
    let (mut worst, mut flutter) = ([0.0_f64; 2], 0);
    for case in 0..count {
        let is_cosserat = case % 2 == 1;
        let solid = random_isotropic(random, is_cosserat);
        let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
        for _ in 0..10 {
            let part = random.uniform(0.1, 0.8);
            let [normal, other] = [0, 1].map(|_| random_stress(random, is_cosserat));
            let mix = |x: &Tensor, y: &Tensor| -> Tensor {
                std::array::from_fn(|i| std::array::from_fn(|j| x[i][j] + part * y[i][j]))
            };
            let flow = Stress {
                force: mix(&normal.force, &other.force),
                couple: mix(&normal.couple, &other.couple),
            };
            let q = random_rotation(random);
            let turn = |s: &Stress| Stress {
                force: rotate_tensor(&q, &s.force),
                couple: rotate_tensor(&q, &s.couple),
            };
            let of = |normal: Stress, flow: Stress| {
                let condition =
                    ActiveCondition { name: "", normal, flow_direction: flow, hardening: 0.1 };
                rank_one_update(&solid, &condition).map(|update| search_extremes(&tensor, &update))
            };
            let (Ok(first), Ok(second)) = (of(normal, flow), of(turn(&normal), turn(&flow))) else {
                continue;
            };
            let size = solid.speeds().longitudinal.powi(2);
            let difference = (first.slowest.squared_speed - second.slowest.squared_speed) / size;
            worst[0] = worst[0].max(difference.abs());
            assert_eq!(first.flutter.is_some(), second.flutter.is_some());
            if let (Some(first), Some(second)) = (first.flutter, second.flutter) {
                let difference = (first.max_imaginary_speed - second.max_imaginary_speed)
                    / first.max_imaginary_speed;
                worst[1] = worst[1].max(difference.abs());
                flutter += 1;
            }
        }
    }
    println!("{flutter} flutter; worst {worst:?}");
    assert!(worst[0] < 1e-11 && worst[1] < 1e-9 && flutter > 20);
}

#[test]
fn threads_and_workspaces_give_equal_bits() {
    let random = &mut seeded_generator(11);
    let elastic = random_anisotropic(random, true);
    let tensor = AcousticTensor3::new(&elastic).unwrap();
    let updates: Vec<RankOneUpdate> = (0..16)
        .filter_map(|_| {
            let mut vector = || -> Vec<f64> {
                (0..elastic.stress_count()).map(|_| random.uniform(-1.0, 1.0)).collect()
            };
            let (normal, mut flow) = (vector(), vector());
            flow.iter_mut().zip(&normal).for_each(|(f, n)| *f += n);
            RankOneUpdate::new(&elastic, &normal, &flow, 0.0).ok()
        })
        .collect();
    assert!(updates.len() > 8);
    let mut workspace = tensor.new_workspace();
    let one: Vec<WaveExtremes> = updates
        .iter()
        .map(|update| tensor.search_extremes(update, &mut workspace).unwrap())
        .collect();
    let many: Vec<WaveExtremes> = std::thread::scope(|scope| {
        let threads: Vec<_> =
            updates.iter().map(|update| scope.spawn(|| search_extremes(&tensor, update))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let bits = |list: &[WaveExtremes]| format!("{list:?}");
    assert_eq!(bits(&one), bits(&many));
}

#[test]
#[ignore = "takes some seconds"]
fn extremes_of_many_solids_are_invariant_under_rotation() {
    check_rotations(80);
}
