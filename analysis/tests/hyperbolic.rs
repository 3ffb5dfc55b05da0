//! Symmetric-hyperbolic systems, A symmetric positive definite and Bⁱ symmetric: Re ς is bounded by the symmetric part
//! of C for every wave, also where speeds coincide, so no verdict may be ill-posed.

mod support;

use models::LinearisedSystem;
use rayon::prelude::*;
use support::planted::{C, Part, T, X, Y, system};
use support::states::{Random, seeded};
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

fn judge(system: &LinearisedSystem<2>) -> Verdict {
    let mut pencil = Pencil::default();
    pencil.update(system).expect("finite coefficients");
    assess(&pencil).verdict
}

fn matrices(n: usize, parts: [(Part, &[f64]); 3]) -> LinearisedSystem<2> {
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
    system(n, n, &entries)
}

/// Random system of small integers, so that speeds coincide in many directions: dense, of low rank, in blocks, or
/// diagonal.
fn random(random: &mut Random, kind: usize) -> LinearisedSystem<2> {
    let n = 2 + (random.bits() % 5) as usize;
    let mut integer = || random.within(-2.5, 2.5).round();
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
    matrices(n, [(X, &first), (Y, &second), (C, &constant)])
}

/// Verifies 1500 systems of each kind: none is ill-posed, fewer than 5 % are marginal.
#[test]
fn symmetric_hyperbolic_systems_are_never_ill_posed() {
    const SYSTEMS: u64 = 1500;
    for kind in 0..4 {
        let verdicts: Vec<(u64, Verdict)> = (0..SYSTEMS)
            .into_par_iter()
            .map(|seed| (seed, judge(&random(&mut seeded(seed), kind))))
            .collect();
        let marginal = verdicts.iter().filter(|(_, v)| v.name() == "marginal").count() as u64;
        let wrong: Vec<_> = verdicts
            .iter()
            .filter(|(_, v)| !matches!(v, Verdict::WellPosed | Verdict::Marginal { .. }))
            .collect();
        println!("kind {kind}: {marginal} of {SYSTEMS} marginal");
        assert!(wrong.is_empty(), "kind {kind}: {wrong:?}");
        assert!(20 * marginal < SYSTEMS, "kind {kind}: {marginal} marginal");
    }
}
