//! Verdicts on states whose gradients balance, so that the acceleration is zero.

use super::backgrounds::{ALL_FLAGS, Inside, Outside, ROTATIONAL_STRESS, sample_harris_grekova};
use super::brute_force::describe_difference;
use crate::support::exact::System256;
use crate::support::real256::Real256;
use crate::support::states::{
    DilatancyKind, FlowSample, reference_system, sample_order_one, seeded_generator,
};
use crate::support::verdicts::{compute_verdict, verdict_label};
use models::LinearisedSystem;
use models::Rounded;
use models::flow::state::MaterialState;
use models::registry;
use rayon::prelude::*;
use wellposed_analysis::growth::Verdict;

/// A state whose gradients of pressure and stress angle balance, so that the acceleration is zero, with a system and a
/// reference in which it is zero to the last bit.
///
/// The balance −∇p + ∇·(q N) = 0 reads (1 − sin φ N) ∇p = q N′·∇ψ and is solved with N² = 1; N(ψ) and q are those of
/// [`reference_system`].
fn balance_gradients(sample: &FlowSample) -> (FlowSample, LinearisedSystem<2>, System256) {
    let sin_phi = sample.parameters.friction_angle.sin();
    let q = sample.flow.stress.deviator.value;
    let (s, c) = (2.0 * sample.state.stress_angle).sin_cos();
    let [a1, a2] = sample.state.stress_angle_gradient;
    let force = [2.0 * q * (-s * a1 + c * a2), 2.0 * q * (c * a1 + s * a2)];
    let along = [c * force[0] + s * force[1], s * force[0] - c * force[1]];
    let pressure_gradient =
        [0, 1].map(|i| (force[i] + sin_phi * along[i]) / (1.0 - sin_phi * sin_phi));
    let state = MaterialState { pressure_gradient, ..sample.state };
    let sample = FlowSample::new(sample.kind(), sample.parameters, state);
    let size = force[0].hypot(force[1]) / sample.flow.density;
    for a in sample.flow.acceleration {
        assert!(a.value.abs() < 1e-12 * size, "{a:?} next to {size:e}");
    }
    let (mut system, mut wide) = (sample.system.clone(), reference_system(&sample));
    let density = system.unknowns.len() - 1;
    assert_eq!(system.unknowns[density].name, "density");
    for row in 0..2 {
        assert!(system.equations[row].starts_with("momentum"));
        system.c[(row, density)] = Rounded::ZERO;
        wide.entries[row][density][3] = Real256::ZERO;
    }
    (sample, system, wide)
}

/// Verifies that the acceleration and not the gradients as such makes layers grow like k^(1/2): in the zone [`Inside`]
/// the verdict for balanced gradients is the verdict without gradients. In the zone [`Outside`] the gradient of the
/// stress angle still makes growth finite.
#[test]
fn balanced_gradients_give_the_uniform_verdict_inside() {
    check_balanced_gradients(150);
}

/// Checks `count` random states of each kind.
fn check_balanced_gradients(count: u64) {
    let cases = [
        (ALL_FLAGS & !ROTATIONAL_STRESS, Inside, "well-posed"),
        (ALL_FLAGS, Inside, "order 2/5"),
        (ALL_FLAGS, Outside, "order 3/1"),
    ];
    for (parts, zone, wanted) in cases {
        let wrong: Vec<String> = (0..count)
            .into_par_iter()
            .filter_map(|seed| {
                let random = &mut seeded_generator(0xb5_0000 + seed);
                let drawn = sample_harris_grekova(random, parts, zone, true);
                let (_, system, wide) = balance_gradients(&drawn.sample);
                let verdict = compute_verdict(&system);
                let found = verdict_label(&verdict);
                let difference = (seed < 2)
                    .then(|| describe_difference(&wide.polynomial(), &verdict, drawn.distance))
                    .flatten();
                (found != wanted || difference.is_some())
                    .then(|| format!("seed {seed}: {found}: {difference:?}"))
            })
            .collect();
        assert!(wrong.is_empty(), "{parts:#b}, {zone:?}: {wrong:#?}");
    }
    let wrong: Vec<String> = (0..count)
        .into_par_iter()
        .filter_map(|seed| {
            let random = &mut seeded_generator(0xb6_0000 + seed);
            let sample = sample_order_one(
                random,
                registry::PLASTIC_POTENTIAL,
                DilatancyKind::Associated,
                true,
            );
            let (_, system, wide) = balance_gradients(&sample);
            let verdict = compute_verdict(&system);
            let difference = (seed < 2)
                .then(|| describe_difference(&wide.polynomial(), &verdict, 1.0))
                .flatten();
            (verdict != Verdict::WellPosed || difference.is_some())
                .then(|| format!("seed {seed}: {verdict:?}: {difference:?}"))
        })
        .collect();
    assert!(wrong.is_empty(), "associated: {wrong:#?}");
}

#[test]
#[ignore = "takes some seconds"]
fn many_balanced_gradients_give_the_uniform_verdict_inside() {
    check_balanced_gradients(500);
}
