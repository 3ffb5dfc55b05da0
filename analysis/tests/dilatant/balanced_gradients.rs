//! Verdicts on states whose gradients balance, so that the acceleration is zero.

use crate::backgrounds::{ALL, Inside, Outside, ROTATIONAL_STRESS, harris_grekova};
use crate::brute_force::differs;
use crate::support::exact::WideSystem;
use crate::support::states::{Dilatancy, Sample, reference, seeded, tame};
use crate::support::verdicts::{judge, name};
use crate::support::wide::Wide;
use models::LinearisedSystem;
use models::Rounded;
use models::flow::state::State;
use models::registry;
use rayon::prelude::*;
use wellposed_analysis::growth::Verdict;

/// A state whose gradients of pressure and stress angle balance, so that the acceleration is zero, with a system and a
/// reference in which it is zero to the last bit.
///
/// The balance −∇p + ∇·(q N) = 0 reads (1 − sin φ N) ∇p = q N′·∇ψ and is solved with N² = 1.
fn balanced(sample: &Sample) -> (Sample, LinearisedSystem<2>, WideSystem) {
    let sin_phi = sample.parameters.friction_angle.sin();
    let q = sample.flow.stress.deviator.value;
    let (s, c) = (2.0 * sample.state.stress_angle).sin_cos();
    let [a1, a2] = sample.state.stress_angle_gradient;
    let force = [2.0 * q * (-s * a1 + c * a2), 2.0 * q * (c * a1 + s * a2)];
    let along = [c * force[0] + s * force[1], s * force[0] - c * force[1]];
    let pressure_gradient =
        [0, 1].map(|i| (force[i] + sin_phi * along[i]) / (1.0 - sin_phi * sin_phi));
    let state = State { pressure_gradient, ..sample.state };
    let sample = Sample::new(sample.kind(), sample.parameters, state);
    let size = force[0].hypot(force[1]) / sample.flow.density;
    for a in sample.flow.acceleration {
        assert!(a.value.abs() < 1e-12 * size, "{a:?} next to {size:e}");
    }
    let (mut system, mut wide) = (sample.system.clone(), reference(&sample));
    let density = system.unknowns.len() - 1;
    assert_eq!(system.unknowns[density].name, "density");
    for row in 0..2 {
        assert!(system.equations[row].starts_with("momentum"));
        system.c[(row, density)] = Rounded::ZERO;
        wide.entries[row][density][3] = Wide::ZERO;
    }
    (sample, system, wide)
}

/// Verifies that the acceleration and not the gradients as such makes layers grow like k^(1/2): with balanced gradients
/// the verdict inside is the verdict without gradients. Outside, the gradient of the stress angle still makes growth
/// finite.
#[test]
fn gradients_that_balance_do_no_harm_inside() {
    let cases = [
        (ALL & !ROTATIONAL_STRESS, Inside, "well-posed"),
        (ALL, Inside, "order 2/5"),
        (ALL, Outside, "order 3/1"),
    ];
    for (parts, zone, wanted) in cases {
        let wrong: Vec<String> = (0..500u64)
            .into_par_iter()
            .filter_map(|seed| {
                let random = &mut seeded(0xb5_0000 + seed);
                let drawn = harris_grekova(random, parts, zone, true);
                let (_, system, wide) = balanced(&drawn.sample);
                let verdict = judge(&system);
                let found = name(&verdict);
                let difference = (seed < 2)
                    .then(|| differs(&wide.polynomial(), &verdict, drawn.distance))
                    .flatten();
                (found != wanted || difference.is_some())
                    .then(|| format!("seed {seed}: {found}: {difference:?}"))
            })
            .collect();
        assert!(wrong.is_empty(), "{parts:#b}, {zone:?}: {wrong:#?}");
    }
    let wrong: Vec<String> = (0..500u64)
        .into_par_iter()
        .filter_map(|seed| {
            let random = &mut seeded(0xb6_0000 + seed);
            let sample = tame(random, registry::PLASTIC_POTENTIAL, Dilatancy::Associated, true);
            let (_, system, wide) = balanced(&sample);
            let verdict = judge(&system);
            let difference =
                (seed < 2).then(|| differs(&wide.polynomial(), &verdict, 1.0)).flatten();
            (verdict != Verdict::WellPosed || difference.is_some())
                .then(|| format!("seed {seed}: {verdict:?}: {difference:?}"))
        })
        .collect();
    assert!(wrong.is_empty(), "associated: {wrong:#?}");
}
