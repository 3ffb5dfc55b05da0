//! Verdicts on the dilatant Harris–Grekova model on both sides of its bounds on the non-coaxiality Δ.

use super::backgrounds::{
    ALL_FLAGS, BackgroundFlags, Inside, Outside, ROTATIONAL_STRESS, Reversed,
    STRESS_ANGLE_GRADIENT, UNIFORM, expected_verdict, sample_harris_grekova,
};
use crate::support::states::{FlowSample, seeded_generator, with_noncoaxiality};
use crate::support::verdicts::{compute_verdict, verdict_label};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_4;

/// Verifies the verdicts for all 64 sets of flags in all zones: 100 states for one flag, none and all, 10 states
/// otherwise. Half of the states are of order one, half have densities, pressures, rates and inertias over decades and
/// φ up to 86°.
#[test]
fn harris_grekova_has_expected_verdicts_in_all_zones() {
    check_all_zones(10);
}

#[test]
#[ignore = "takes long"]
fn harris_grekova_has_expected_verdicts_in_many_states() {
    check_all_zones(100);
}

/// Checks `count` states of each set of flags in each zone, ten times as many for one flag, none and all.
fn check_all_zones(count: u64) {
    let mut states = 0;
    let mut problems = Vec::new();
    for parts in UNIFORM..=ALL_FLAGS {
        for zone in [Inside, Outside, Reversed] {
            let is_basic = parts.count_ones() <= 1 || parts == ALL_FLAGS;
            let count = if is_basic { 10 * count } else { count };
            states += count;
            let mut wrong: Vec<String> = (0..count)
                .into_par_iter()
                .filter_map(|seed| {
                    let random = &mut seeded_generator(seed);
                    let drawn = sample_harris_grekova(random, parts, zone, seed % 2 == 0);
                    let found = verdict_label(&compute_verdict(&drawn.sample.system));
                    (found != expected_verdict(parts, zone)).then(|| {
                        format!(
                            "parts {parts:#b}, {zone:?}, seed {seed}: {found}: {:?}",
                            drawn.sample
                        )
                    })
                })
                .collect();
            problems.append(&mut wrong);
        }
    }
    println!("{states} states");
    assert!(problems.is_empty(), "{} of {states} differ: {problems:#?}", problems.len());
}

/// Descriptions of unexpected verdicts on `count` states near |Δ| = 45° ± ν/2 (dilatancy angle ν), most at log-uniform
/// distances in the range `offsets`, relative to the half width of the zone [`Outside`]. Expected are
/// [`expected_verdict`] at finite distance and ill-posedness at zero distance.
fn wrong_verdicts_near_coincidence(
    parts: [BackgroundFlags; 2],
    offsets: [f64; 2],
    count: u64,
) -> Vec<String> {
    (0..count)
        .into_par_iter()
        .filter_map(|seed| {
            let random = &mut seeded_generator(0xb3_0000 + seed);
            let parts = parts[seed as usize % 2];
            let sample = sample_harris_grekova(random, parts, Outside, seed / 2 % 2 == 0).sample;
            let bound = sample.model.noncoaxiality_bound().expect("the model has one");
            let half = 0.5 * sample.parameters.dilatancy_angle;
            let offset = if random.bernoulli(0.1) {
                0.0
            } else {
                random.signed_log_uniform(offsets[0], offsets[1])
            };
            // Distance from 45°, not beyond the bound.
            let from_middle = half + offset * (FRAC_PI_4 - bound);
            if from_middle > (FRAC_PI_4 - bound) * (1.0 - 1e-9) {
                return None;
            }
            let size = FRAC_PI_4 + if random.bernoulli(0.5) { from_middle } else { -from_middle };
            let sample =
                with_noncoaxiality(&sample, if random.bernoulli(0.5) { size } else { -size });
            let verdict = compute_verdict(&sample.system);
            let is_right = if offset == 0.0 {
                verdict.name() == "ill-posed"
            } else {
                verdict_label(&verdict) == expected_verdict(parts, Outside)
            };
            (!is_right).then(|| {
                let FlowSample { parameters, state, .. } = &sample;
                format!(
                    "seed {seed}, {parts:#b}, {offset:e}: {verdict:?}: {parameters:?} {state:?}"
                )
            })
        })
        .collect()
}

/// Verifies unbounded growth at |Δ| = 45° ± ν/2. The coefficient of ς³ k² vanishes there in two directions. In one of
/// them cos β = sin φ, with β twice the angle from the wave vector to the major principal stress, so the numerator of
/// the root vanishes too and no root passes through infinity; a root does so in the other direction.
#[test]
fn growth_is_unbounded_where_zeros_coincide_with_the_numerator() {
    check_coincident_zeros(300);
}

/// Checks `count` random states.
fn check_coincident_zeros(count: u64) {
    let wrong = wrong_verdicts_near_coincidence([UNIFORM, ROTATIONAL_STRESS], [1e-15, 1e-3], count);
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}

/// Verifies that next to |Δ| = 45° ± ν/2 a gradient of the stress angle makes growth finite, of order 3. At this |Δ|
/// itself the coefficient of ς³ k, due to the gradient, vanishes in the same direction as that of ς³ k².
#[test]
fn gradients_near_coincident_zeros_give_order_three() {
    check_gradients_near_coincidence(300);
}

/// Checks `count` random states.
fn check_gradients_near_coincidence(count: u64) {
    let wrong =
        wrong_verdicts_near_coincidence([STRESS_ANGLE_GRADIENT, ALL_FLAGS], [1e-5, 1e-3], count);
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}

/// Verifies order 3 at distances from |Δ| = 45° ± ν/2 down to 1e-11 of the half width of the zone: the zeros of both
/// coefficients may be less than 1e-9 rad apart, yet far more than their rounding.
#[test]
fn gradients_very_near_coincident_zeros_give_order_three() {
    check_gradients_very_near_coincidence(300);
}

/// Checks `count` random states.
fn check_gradients_very_near_coincidence(count: u64) {
    let wrong =
        wrong_verdicts_near_coincidence([STRESS_ANGLE_GRADIENT, ALL_FLAGS], [1e-11, 1e-5], count);
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}

#[test]
#[ignore = "takes ten seconds"]
fn many_states_near_coincident_zeros_have_expected_verdicts() {
    check_coincident_zeros(1000);
    check_gradients_near_coincidence(1000);
    check_gradients_very_near_coincidence(1000);
}
