//! Singular pencils and singular matrices A, densely filled.

use crate::planted_systems::Entries;
use crate::support::exact::WideSystem;
use crate::support::planted::{C, T, X, Y, system};
use crate::support::states::seeded;
use crate::support::verdicts::judge;
use wellposed_analysis::growth::Verdict;
use wellposed_analysis::pencil::Pencil;

/// Verifies exactly singular pencils with coefficients of 50 bits: products of three of them do not fit in twice the
/// working precision.
#[test]
fn dense_singular_pencils_are_recognised() {
    for seed in 0..200 {
        let random = &mut seeded(0x516 + seed);
        let n = 3 + (seed % 3) as usize;
        let mut integer = || (random.bits() >> 16) as f64 - (46f64).exp2();
        let mut entries: Entries = Vec::new();
        for part in [T, X, Y, C] {
            for j in 0..n {
                let mut last = 0.0;
                for i in 0..n - 1 {
                    let value = integer();
                    entries.push((i, j, part, value));
                    last += value;
                }
                entries.push((n - 1, j, part, last));
            }
        }
        let verdict = judge(&system(n, n, &entries));
        assert_eq!(verdict, Verdict::Indeterminate { rank: n - 1, unknowns: n }, "seed {seed}");
    }
}

/// Verifies a densely filled, exactly singular matrix A: one root fewer, and the verdict on the remaining roots.
#[test]
fn dense_singular_a_leaves_no_spurious_root() {
    for seed in 0..100 {
        let random = &mut seeded(0xa1 + seed);
        let mut integer = || (random.bits() >> 16) as f64 - (46f64).exp2();
        let n = 4;
        let mut entries: Entries = Vec::new();
        for j in 0..n {
            let mut last = 0.0;
            for i in 0..n - 1 {
                let value = integer();
                entries.push((i, j, T, value));
                last += value;
            }
            entries.push((n - 1, j, T, last));
            for i in 0..n {
                entries.push((i, j, C, integer()));
            }
        }
        let system = system(n, n, &entries);
        let mut pencil = Pencil::default();
        pencil.update(&system).expect("finite coefficients");
        let exact = WideSystem::of(&system).at_wave([1.0, 0.0]).len() - 1;
        assert_eq!(exact, n - 1);
        assert_eq!(pencil.polynomial.at_wave(1.0, 0.3).len() - 1, exact, "seed {seed}");
        assert_eq!(judge(&system), Verdict::WellPosed, "seed {seed}");
    }
}
