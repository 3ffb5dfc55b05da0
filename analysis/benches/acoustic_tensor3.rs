//! Milliseconds per point of a map of flutter and shear bands, on one thread: a classical and two Cosserat solids with
//! varied dilatancy and a random stress at each point.

#[path = "../tests/support/mod.rs"]
mod support;

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::Stress;
use models::yield_set::parameters::Mises;
use std::hint::black_box;
use std::time::Instant;
use support::states::seeded_generator;
use wellposed_analysis::acoustic_tensor3::{AcousticTensor3, RankOneUpdate};

/// Number of points of the map for each solid.
const MAP_POINTS: usize = 60;

fn main() {
    let rotation = |inertia: f64| Microrotation {
        alpha: 0.3,
        inertia,
        couple: Some(CoupleModuli { beta: 0.2, gamma: 0.6, eta: 0.4 }),
    };
    let solids = [
        ("classical", None),
        ("Cosserat, rotation waves slower than pressure waves", Some(rotation(1.0))),
        ("Cosserat, rotation waves faster than pressure waves", Some(rotation(0.1))),
    ];
    for (name, microrotation) in solids {
        let solid = Isotropic { lambda: 1.0, mu: 1.0, density: 1.0, microrotation };
        let elastic = solid.rates::<3>();
        let start = Instant::now();
        let Ok(tensor) = AcousticTensor3::new(&elastic) else { continue };
        let setup = start.elapsed().as_secs_f64();
        let mut workspace = tensor.new_workspace();
        let components: Vec<_> = solid.layout::<3>().all_stresses().collect();
        let mut random = seeded_generator(7);
        let (mut seconds, mut worst, mut flutter) = (0.0, 0.0_f64, 0);
        for point in 0..MAP_POINTS {
            let mut entry = || random.uniform(-1.0, 1.0);
            let mut force: [[f64; 3]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| entry()));
            let mut couple = [[0.0; 3]; 3];
            if microrotation.is_some() {
                couple = std::array::from_fn(|_| std::array::from_fn(|_| 0.3 * entry()));
            } else {
                for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                    force[j][i] = force[i][j];
                }
            }
            let dilatancy = 0.6 * (point % 10) as f64 / 10.0;
            let set = Mises {
                antisymmetric_weight: 0.5,
                symmetric_internal_length: Some(0.5),
                antisymmetric_internal_length: Some(0.5),
                ..Mises::new_drucker_prager(1.0, 0.6, dilatancy)
            };
            let Some(condition) = set.condition(&Stress { force, couple }) else { continue };
            let vector = |gradient: &Stress| -> Vec<f64> {
                components.iter().map(|c| c.derivative(gradient)).collect()
            };
            let update = RankOneUpdate::new(
                &elastic,
                &vector(&condition.normal),
                &vector(&condition.flow_direction),
                0.0,
            );
            let Ok(update) = update else { continue };
            let start = Instant::now();
            let found = black_box(tensor.search_extremes(black_box(&update), &mut workspace));
            let own = start.elapsed().as_secs_f64();
            seconds += own;
            worst = worst.max(own);
            flutter += usize::from(found.is_ok_and(|found| found.flutter.is_some()));
        }
        println!(
            "{name}: {:.3} ms per point, {:.3} ms at most, {:.0} ms once; flutter at {flutter} of {MAP_POINTS}",
            1e3 * seconds / MAP_POINTS as f64,
            1e3 * worst,
            1e3 * setup
        );
    }
}
