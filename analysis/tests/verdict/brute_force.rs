//! Random small systems against brute force.

use crate::planted_systems::Entries;
use crate::support::brute::{brute, degenerate_directions};
use crate::support::exact::{DispersionReference, WideSystem};
use crate::support::planted::{C, T, X, Y, system};
use crate::support::states::seeded;
use crate::support::verdicts::{judge, name};
use models::LinearisedSystem;
use rayon::prelude::*;
use wellposed_analysis::growth::Verdict;

/// A random system of 2 to 4 equations with few entries, integers or not.
fn small(seed: u64, integers: bool) -> LinearisedSystem<2> {
    let random = &mut seeded(0x5a11 + seed);
    let n = 2 + (seed % 3) as usize;
    let mut entries: Entries = Vec::new();
    for i in 0..n {
        for j in 0..n {
            for part in [T, X, Y, C] {
                if random.chance(if part == T { 0.3 } else { 0.4 }) {
                    let value = if integers {
                        random.within(-3.49, 3.49).round()
                    } else {
                        random.signed(0.3, 3.0)
                    };
                    if value != 0.0 {
                        entries.push((i, j, part, value));
                    }
                }
            }
        }
    }
    system(n, n, &entries)
}

/// Verdicts on random small systems without physical meaning agree with brute force.
#[test]
fn small_random_systems_agree_with_brute_force() {
    agree_with_brute_force(false, 200);
}

/// Verdicts on random systems of small integers, in which many directions coincide, agree with brute force.
#[test]
fn small_integer_systems_agree_with_brute_force() {
    agree_with_brute_force(true, 200);
}

#[test]
#[ignore = "some minutes: cargo test --release -p wellposed-analysis --test verdict many -- --ignored"]
fn many_small_systems_agree_with_brute_force() {
    agree_with_brute_force(false, 500);
    agree_with_brute_force(true, 500);
}

/// Brute-force check of a verdict: a description of the error, if any; `fine` takes longer and misses less.
fn difference(verdict: &Verdict, p: &DispersionReference, fine: bool) -> Option<String> {
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
    let force = brute(p, &[1e8, 1e13], 60, &degenerate_directions(p), 3.2, fine);
    let wrong = match verdict {
        Verdict::WellPosed => force.blows_up || force.order().abs() > 0.05,
        Verdict::IllPosed { growth: None, .. } => !force.blows_up,
        Verdict::IllPosed { growth: Some(g), .. } => {
            let order = g.order.value();
            let ratio = force.coefficient(order) / g.coefficient;
            (force.order() - order).abs() > 0.05 || (ratio - 1.0).abs() > 0.02 || force.blows_up
        }
        _ => false,
    };
    wrong.then(|| format!("order {:.4} {force:?}", force.order()))
}

fn agree_with_brute_force(integers: bool, systems: u64) {
    let results: Vec<(String, Option<String>)> = (0..systems)
        .into_par_iter()
        .map(|seed| {
            let own = small(seed, integers);
            let verdict = judge(&own);
            let p = WideSystem::of(&own).polynomial();
            let problem =
                difference(&verdict, &p, false).and_then(|_| difference(&verdict, &p, true));
            (name(&verdict), problem.map(|p| format!("seed {seed}: {verdict:?}: {p}")))
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
    assert!(100 * marginal <= systems, "{marginal} of {systems} are called marginal");
}
