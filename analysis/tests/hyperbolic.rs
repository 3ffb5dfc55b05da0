//! Symmetric-hyperbolic systems, A symmetric positive definite and Bⁱ symmetric: Re ς is bounded by the symmetric part
//! of C for every wave, also where speeds coincide, so no verdict may be ill-posed.

use crate::support::states::{RandomNumbers, seeded_generator};
use crate::support::system_entries::{C, DerivativeOperator, T, X, Y, build_system};
use crate::support::verdicts::compute_verdict;
use models::LinearisedSystem;
use rayon::prelude::*;
use wellposed_analysis::growth::Verdict;

fn system_from_matrices(n: usize, parts: [(DerivativeOperator, &[f64]); 3]) -> LinearisedSystem<2> {
    let mut entries = Vec::new();
    for i in 0..n {
        entries.push((i, i, T, 1.0));
        for (part, matrix) in parts {
            for j in 0..n {
                if matrix[n * i + j] != 0.0 {
                    entries.push((i, j, part, matrix[n * i + j]));
                }
            }
        }
    }
    build_system(n, n, &entries)
}

/// Random system of small integers, so that speeds coincide in many directions: dense, of low rank, in blocks, or
/// diagonal.
fn random_symmetric_system(random: &mut RandomNumbers, kind: usize) -> LinearisedSystem<2> {
    let n = 2 + (random.next_bits() % 5) as usize;
    let mut integer = || random.uniform(-2.5, 2.5).round();
    let mut first = vec![0.0; n * n];
    let mut second = vec![0.0; n * n];
    let vector: Vec<f64> = (0..n).map(|_| integer()).collect();
    for i in 0..n {
        for j in 0..=i {
            let same_block = i / 2 == j / 2;
            let (x, y) = match kind {
                0 => (integer(), integer()),
                1 => (vector[i] * vector[j], if i == j { integer().abs().min(1.0) } else { 0.0 }),
                2 if same_block => (integer(), integer()),
                3 if i == j => (integer(), integer()),
                _ => (0.0, 0.0),
            };
            (first[n * i + j], first[n * j + i]) = (x, x);
            (second[n * i + j], second[n * j + i]) = (y, y);
        }
    }
    let constant: Vec<f64> = (0..n * n).map(|_| integer()).collect();
    system_from_matrices(n, [(X, &first), (Y, &second), (C, &constant)])
}

/// Verifies that none of `count` random systems of each of the four kinds, all well-posed, is called ill-posed, and that
/// fewer than 5 % are marginal.
fn check_systems(count: u64) {
    for kind in 0..4 {
        let verdicts: Vec<(u64, Verdict)> = (0..count)
            .into_par_iter()
            .map(|seed| {
                (seed, compute_verdict(&random_symmetric_system(&mut seeded_generator(seed), kind)))
            })
            .collect();
        let marginal = verdicts.iter().filter(|(_, v)| v.name() == "marginal").count() as u64;
        println!("kind {kind}: {marginal} of {count} marginal");
        assert!(20 * marginal < count, "kind {kind}: {marginal} marginal");
        let is_right = |own: &Verdict| matches!(own, Verdict::WellPosed | Verdict::Marginal { .. });
        let wrong: Vec<_> = verdicts.iter().filter(|(_, own)| !is_right(own)).collect();
        assert!(wrong.is_empty(), "kind {kind}: {wrong:?}");
    }
}

#[test]
fn symmetric_hyperbolic_systems_are_never_ill_posed() {
    check_systems(4000);
}

#[test]
#[ignore = "takes minutes"]
fn many_symmetric_hyperbolic_systems_are_never_ill_posed() {
    check_systems(20_000);
}

/// Diagonal systems with five nearly colliding roots, found as clusters of three and two, or with a triple zero of a corner
/// coefficient, found as a double one.
#[test]
fn nearly_coinciding_speeds_do_not_grow() {
    for seed in [4764, 9023, 10_281, 10_956, 12_932, 18_693] {
        let found = compute_verdict(&random_symmetric_system(&mut seeded_generator(seed), 3));
        assert_eq!(found, Verdict::WellPosed, "seed {seed}");
    }
}
