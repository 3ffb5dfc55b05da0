//! Verdicts on the dilatant Harris–Grekova model on both sides of the bounds.

use crate::backgrounds::{
    ALL, Inside, Outside, Parts, ROTATIONAL_STRESS, Reversed, STRESS_ANGLE_GRADIENT, UNIFORM,
    harris_grekova, wanted,
};
use crate::support::states::{Sample, seeded, turned};
use crate::support::verdicts::{judge, name};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_4;

/// Verifies the verdicts for all 64 sets of parts in all zones: 1000 states for one part, none and all, 100 states
/// otherwise. Half of the states are tame, half have densities, pressures, rates and inertias over decades and φ up to
/// 86°.
#[test]
fn harris_grekova_on_both_sides_of_its_bound() {
    let mut states = 0;
    let mut problems = Vec::new();
    for parts in UNIFORM..=ALL {
        for zone in [Inside, Outside, Reversed] {
            let count = if parts.count_ones() <= 1 || parts == ALL { 1000 } else { 100u64 };
            states += count;
            let mut wrong: Vec<String> = (0..count)
                .into_par_iter()
                .filter_map(|seed| {
                    let random = &mut seeded(seed);
                    let drawn = harris_grekova(random, parts, zone, seed % 2 == 0);
                    let found = name(&judge(&drawn.sample.system));
                    (found != wanted(parts, zone)).then(|| {
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

/// Verdicts on 1000 states near |Δ| = 45° ± ν/2, most at log-uniform distances in the range `offsets` relative to the
/// width outside; returns descriptions of verdicts that differ from `wanted`, or that are not ill-posed at zero
/// distance.
fn near_coincidence(parts: [Parts; 2], offsets: [f64; 2]) -> Vec<String> {
    (0..1000u64)
        .into_par_iter()
        .filter_map(|seed| {
            let random = &mut seeded(0xb3_0000 + seed);
            let parts = parts[seed as usize % 2];
            let sample = harris_grekova(random, parts, Outside, seed / 2 % 2 == 0).sample;
            let bound = sample.model.noncoaxiality_bound().expect("the model has one");
            let half = 0.5 * sample.parameters.dilatancy_angle;
            let offset =
                if random.chance(0.1) { 0.0 } else { random.signed(offsets[0], offsets[1]) };
            // Distance from 45°, not beyond the bound.
            let from_middle = half + offset * (FRAC_PI_4 - bound);
            if from_middle > (FRAC_PI_4 - bound) * (1.0 - 1e-9) {
                return None;
            }
            let size = FRAC_PI_4 + if random.chance(0.5) { from_middle } else { -from_middle };
            let sample = turned(&sample, if random.chance(0.5) { size } else { -size });
            let verdict = judge(&sample.system);
            let is_right = if offset == 0.0 {
                verdict.name() == "ill-posed"
            } else {
                name(&verdict) == wanted(parts, Outside)
            };
            (!is_right).then(|| {
                let Sample { parameters, state, .. } = &sample;
                format!(
                    "seed {seed}, {parts:#b}, {offset:e}: {verdict:?}: {parameters:?} {state:?}"
                )
            })
        })
        .collect()
}

/// Verifies unbounded growth at |Δ| = 45° ± ν/2. The coefficient of ς³ k² vanishes there in a direction in which 𝒜 =
/// cos β − sin φ vanishes too, so that no root passes through infinity; a root does so in the other direction.
#[test]
fn zeros_that_coincide_with_those_of_the_numerator() {
    let wrong = near_coincidence([UNIFORM, ROTATIONAL_STRESS], [1e-15, 1e-3]);
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}

/// At this Δ the coefficient of ς³ k, due to a gradient of the stress angle, vanishes in the same direction. Verifies
/// that next to it, where the two zeros are separate, growth is finite, of order 3.
#[test]
fn gradients_next_to_where_the_zeros_coincide() {
    let wrong = near_coincidence([STRESS_ANGLE_GRADIENT, ALL], [1e-5, 1e-3]);
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}

/// Verifies order 3 at relative distances down to 1e-11: the zeros may be less than 1e-9 rad apart, yet far more than
/// their rounding.
#[test]
fn gradients_very_near_where_the_zeros_coincide() {
    let wrong = near_coincidence([STRESS_ANGLE_GRADIENT, ALL], [1e-11, 1e-5]);
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}
