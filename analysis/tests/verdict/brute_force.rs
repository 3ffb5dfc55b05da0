//! Verdicts on random small systems against brute force.

use super::known_systems::SystemEntries;
use crate::support::brute_force::{compute_growth_by_brute_force, find_degenerate_directions};
use crate::support::exact::{DispersionReference, System256};
use crate::support::states::seeded_generator;
use crate::support::system_entries::{C, T, X, Y, build_system};
use crate::support::verdicts::{compute_verdict, verdict_label};
use models::LinearisedSystem;
use rayon::prelude::*;
use wellposed_analysis::growth::Verdict;

/// A random system of 2 to 4 equations with few entries, integers or not.
fn random_small_system(seed: u64, integers: bool) -> LinearisedSystem<2> {
    let random = &mut seeded_generator(0x5a11 + seed);
    let n = 2 + (seed % 3) as usize;
    let mut entries: SystemEntries = Vec::new();
    for i in 0..n {
        for j in 0..n {
            for part in [T, X, Y, C] {
                if random.bernoulli(if part == T { 0.3 } else { 0.4 }) {
                    let value = if integers {
                        random.uniform(-3.49, 3.49).round()
                    } else {
                        random.signed_log_uniform(0.3, 3.0)
                    };
                    if value != 0.0 {
                        entries.push((i, j, part, value));
                    }
                }
            }
        }
    }
    build_system(n, n, &entries)
}

/// Verifies that verdicts on random small systems without physical meaning agree with brute force: four
/// systems of each size.
#[test]
fn small_random_systems_agree_with_brute_force() {
    assert_agreement_with_brute_force(false, 12);
}

/// Verifies that verdicts on random systems of small integers, in which degenerate directions of different coefficients
/// often coincide, agree with brute force.
#[test]
fn small_integer_systems_agree_with_brute_force() {
    assert_agreement_with_brute_force(true, 12);
}

#[test]
#[ignore = "some minutes: cargo test --release -p wellposed-analysis --test analysis verdict::brute_force::many -- --ignored"]
fn many_small_systems_agree_with_brute_force() {
    assert_agreement_with_brute_force(false, 500);
    assert_agreement_with_brute_force(true, 500);
}

/// Brute-force check of a verdict on the system with dispersion polynomial `p`: a description of the error, if any;
/// with `fine` the check takes longer and misses less.
fn describe_difference(verdict: &Verdict, p: &DispersionReference, fine: bool) -> Option<String> {
    match verdict {
        Verdict::Indeterminate { .. } => {
            return (!p.terms.is_empty()).then(|| "not singular".to_string());
        }
        _ if p.terms.is_empty() => return Some("singular".to_string()),
        Verdict::Marginal { .. } => return None,
        _ if p.degree() == 0 => {
            return (*verdict != Verdict::WellPosed).then(|| "no roots at all".to_string());
        }
        _ => {}
    }
    let force = compute_growth_by_brute_force(
        p,
        &[1e8, 1e13],
        60,
        &find_degenerate_directions(p),
        3.2,
        fine,
    );
    let wrong = match verdict {
        Verdict::WellPosed => force.is_unbounded_at_finite_k || force.order().abs() > 0.05,
        Verdict::IllPosed { growth: None, .. } => !force.is_unbounded_at_finite_k,
        Verdict::IllPosed { growth: Some(g), .. } => {
            let order = g.order.to_f64();
            let ratio = force.coefficient(order) / g.coefficient;
            (force.order() - order).abs() > 0.05
                || (ratio - 1.0).abs() > 0.02
                || force.is_unbounded_at_finite_k
        }
        _ => false,
    };
    wrong.then(|| format!("order {:.4} {force:?}", force.order()))
}

fn assert_agreement_with_brute_force(integers: bool, systems: u64) {
    let results: Vec<(String, Option<String>)> = (0..systems)
        .into_par_iter()
        .map(|seed| {
            let own = random_small_system(seed, integers);
            let verdict = compute_verdict(&own);
            let p = System256::from_linearised(&own).polynomial();
            let problem = describe_difference(&verdict, &p, false)
                .and_then(|_| describe_difference(&verdict, &p, true));
            (verdict_label(&verdict), problem.map(|p| format!("seed {seed}: {verdict:?}: {p}")))
        })
        .collect();
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    for (name, _) in &results {
        *counts.entry(name).or_default() += 1;
    }
    println!("{counts:?}");
    let wrong: Vec<&String> = results.iter().filter_map(|r| r.1.as_ref()).collect();
    wrong.iter().for_each(|w| println!("{w}"));
    assert!(wrong.is_empty(), "{} of {systems} disagree", wrong.len());
    let marginal = counts.get("marginal").copied().unwrap_or(0) as u64;
    // At most one in a hundred systems may be marginal, or a single one if there are fewer than a hundred.
    assert!(100 * marginal <= systems.max(100), "{marginal} of {systems} are called marginal");
}
