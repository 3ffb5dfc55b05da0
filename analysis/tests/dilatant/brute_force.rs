//! Verdicts with dilatancy against brute force in 256 bits.

use super::backgrounds::{
    ALL_FLAGS, BackgroundFlags, Inside, NoncoaxialityZone, Outside, Reversed, UNIFORM,
    expected_verdict, sample_harris_grekova,
};
use crate::support::brute_force::{compute_growth_by_brute_force, find_degenerate_directions};
use crate::support::exact::DispersionReference;
use crate::support::states::{DilatancyKind, reference_system, sample_order_one, seeded_generator};
use crate::support::verdicts::{compute_verdict, verdict_label};
use models::registry;
use rayon::prelude::*;
use std::collections::BTreeMap;
use wellposed_analysis::growth::Verdict;

/// Brute-force check of a verdict: growth at three wave numbers over four decades.
///
/// The relative deviation e of growth of order m in layers from its asymptote is c k^(−m). At the smallest of these
/// wave numbers k^(−m) is 6e-8 for order 2/5 and 1e-9 for order 1/2; the constant c of the state is up to 6e4 in these
/// samples. There, e must be below 1e-3. At the larger wave numbers e must have decreased as k^(−m), to within 10 e²
/// for the next term of the expansion. Integer orders converge faster. The tolerance also contains 1e-14/`distance`,
/// since the relative rounding error is about ε divided by the relative distance from a bound, and 1e-8 for the search
/// of brute force, which stops within 1e-8 of a maximum.
pub fn describe_difference(
    polynomial: &DispersionReference,
    verdict: &Verdict,
    distance: f64,
) -> Option<String> {
    let waves = [1e18, 1e20, 1e22];
    let force = compute_growth_by_brute_force(
        polynomial,
        &waves,
        60,
        &find_degenerate_directions(polynomial),
        1.6,
        true,
    );
    let agrees = match verdict {
        Verdict::WellPosed => {
            // Bounded: no larger at the last wave number than at the first.
            let size = force.samples.iter().map(|x| x.1.abs()).fold(1.0, f64::max);
            !force.is_unbounded_at_finite_k && force.samples[2].1 - force.samples[0].1 < 1e-3 * size
        }
        Verdict::IllPosed { growth: None, .. } => force.is_unbounded_at_finite_k,
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let order = growth.order.to_f64();
            let deviation = |n: usize| {
                let (k, s, _) = force.samples[n];
                s / k.powf(order) / growth.coefficient - 1.0
            };
            let first = deviation(0);
            let floor = 10.0 * first * first + 1e-14 / distance + 1e-8;
            let declines = |n: usize| {
                let expected = first * (force.samples[n].0 / force.samples[0].0).powf(-order);
                (deviation(n) - expected).abs() < floor
            };
            !force.is_unbounded_at_finite_k && first.abs() < 1e-3 && declines(1) && declines(2)
        }
        _ => false,
    };
    (!agrees).then(|| format!("{verdict:?}: {force:?}"))
}

/// Verifies the verdicts on backgrounds with one flag, none and all, in all zones, against brute force: one state
/// in each zone.
#[test]
fn brute_force_confirms_harris_grekova_with_dilatancy() {
    confirm_harris_grekova(1, 1);
}

#[test]
#[ignore = "takes minutes"]
fn brute_force_confirms_many_states_of_harris_grekova() {
    confirm_harris_grekova(8, 3);
}

/// Confirms `inside` states of each background in the zone [`Inside`] and `outside` states in each other zone.
fn confirm_harris_grekova(inside: u64, outside: u64) {
    let backgrounds = [UNIFORM, 1, 2, 4, 8, 16, 32, ALL_FLAGS];
    let cases: Vec<(BackgroundFlags, NoncoaxialityZone, u64)> = backgrounds
        .into_iter()
        .flat_map(|parts| {
            [(Inside, inside), (Outside, outside), (Reversed, outside)]
                .into_iter()
                .flat_map(move |(zone, count)| (0..count).map(move |n| (parts, zone, n)))
        })
        .collect();
    let wrong: Vec<String> = cases
        .into_par_iter()
        .filter_map(|(parts, zone, n)| {
            let seed = 0xbf_0000 + 0x100 * u64::from(parts) + 0x10 * zone as u64 + n;
            let drawn = sample_harris_grekova(&mut seeded_generator(seed), parts, zone, true);
            let verdict = compute_verdict(&drawn.sample.system);
            assert_eq!(verdict_label(&verdict), expected_verdict(parts, zone));
            let polynomial = reference_system(&drawn.sample).polynomial();
            let problem = describe_difference(&polynomial, &verdict, drawn.distance)?;
            Some(format!("parts {parts:#b}, {zone:?}, {n}: {problem}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{} differ: {wrong:#?}", wrong.len());
}

/// Verifies the verdicts on the associated plastic potential and on dilatant double shearing, with accelerations and
/// gradients, against brute force: two states of each.
#[test]
fn brute_force_confirms_plastic_potential_and_double_shearing() {
    confirm_plastic_potential_and_double_shearing(2);
}

#[test]
#[ignore = "takes minutes"]
fn brute_force_confirms_many_states_of_plastic_potential_and_double_shearing() {
    confirm_plastic_potential_and_double_shearing(12);
}

/// Confirms `states` states of each model.
fn confirm_plastic_potential_and_double_shearing(states: u64) {
    let kinds = [
        (registry::PLASTIC_POTENTIAL, DilatancyKind::Associated, "order 1/2"),
        (registry::DOUBLE_SHEARING, DilatancyKind::Positive, "order 1/1"),
    ];
    let mut counts = BTreeMap::<String, usize>::new();
    let found: Vec<(String, Option<String>)> = (0..2 * states)
        .into_par_iter()
        .map(|index| {
            let (kind, dilatancy, wanted) = kinds[index as usize % 2];
            let sample =
                sample_order_one(&mut seeded_generator(0xd5 + index), kind, dilatancy, true);
            let verdict = compute_verdict(&sample.system);
            assert_eq!(verdict_label(&verdict), wanted, "{kind:?}");
            let problem =
                describe_difference(&reference_system(&sample).polynomial(), &verdict, 1.0);
            (format!("{kind:?}: {wanted}"), problem)
        })
        .collect();
    for (name, problem) in found {
        assert!(problem.is_none(), "{name}: {problem:?}");
        *counts.entry(name).or_default() += 1;
    }
    println!("{counts:?}");
}
