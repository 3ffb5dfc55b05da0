//! Singular pencils and singular matrices A, densely filled.

use super::known_systems::SystemEntries;
use crate::support::exact::System256;
use crate::support::states::seeded_generator;
use crate::support::system_entries::{C, DerivativeOperator, T, X, Y, build_system};
use crate::support::verdicts::compute_verdict;
use wellposed_analysis::growth::Verdict;
use wellposed_analysis::pencil::Pencil;

/// Adds a column of integers whose last entry is the sum of the others.
fn push_dependent_column(
    entries: &mut SystemEntries,
    (column, operator): (usize, DerivativeOperator),
    rows: usize,
    mut integer: impl FnMut() -> f64,
) {
    let mut sum = 0.0;
    for row in 0..rows - 1 {
        let value = integer();
        entries.push((row, column, operator, value));
        sum += value;
    }
    entries.push((rows - 1, column, operator, sum));
}

/// Verifies exactly singular pencils with coefficients of up to 50 bits: products of three of them do not fit in twice
/// the working precision.
#[test]
fn dense_singular_pencils_are_recognised() {
    for seed in 0..200 {
        let random = &mut seeded_generator(0x516 + seed);
        let n = 3 + (seed % 3) as usize;
        let mut integer = || (random.next_bits() >> 16) as f64 - (46f64).exp2();
        let mut entries: SystemEntries = Vec::new();
        for operator in [T, X, Y, C] {
            for column in 0..n {
                push_dependent_column(&mut entries, (column, operator), n, &mut integer);
            }
        }
        let verdict = compute_verdict(&build_system(n, n, &entries));
        assert_eq!(verdict, Verdict::Indeterminate { rank: n - 1, unknowns: n }, "seed {seed}");
    }
}

/// Verifies a densely filled, exactly singular matrix A: one root fewer, and the verdict on the remaining roots.
#[test]
fn dense_singular_a_leaves_no_spurious_root() {
    for seed in 0..100 {
        let random = &mut seeded_generator(0xa1 + seed);
        let mut integer = || (random.next_bits() >> 16) as f64 - (46f64).exp2();
        let n = 4;
        let mut entries: SystemEntries = Vec::new();
        for j in 0..n {
            push_dependent_column(&mut entries, (j, T), n, &mut integer);
            for i in 0..n {
                entries.push((i, j, C, integer()));
            }
        }
        let system = build_system(n, n, &entries);
        let mut pencil = Pencil::default();
        pencil.update(&system).expect("finite coefficients");
        let exact = System256::from_linearised(&system).coefficients_at_wave([1.0, 0.0]).len() - 1;
        assert_eq!(exact, n - 1);
        assert_eq!(pencil.polynomial.coefficients_at(1.0, 0.3).len() - 1, exact, "seed {seed}");
        assert_eq!(compute_verdict(&system), Verdict::WellPosed, "seed {seed}");
    }
}
