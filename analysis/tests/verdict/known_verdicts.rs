//! Verdicts of systems whose growth is known by construction.

use super::known_systems::{ExpectedVerdict, known_systems};
use crate::support::states::seeded_generator;
use crate::support::system_entries::{C, T, X, Y, build_system};
use crate::support::verdicts::{angular_distance, compute_verdict, expect_growth};
use ExpectedVerdict::{Bounded, Growth, Indeterminate, UnboundedAtFiniteWaveNumber};
use wellposed_analysis::growth::Verdict;

/// Whether a verdict is the wanted one; `None` for a marginal verdict.
fn is_expected(verdict: &Verdict, wanted: ExpectedVerdict) -> Option<bool> {
    Some(match (verdict, wanted) {
        (Verdict::Marginal { .. }, _) => return None,
        (Verdict::WellPosed, Bounded) => true,
        (Verdict::IllPosed { growth: Some(g), direction }, Growth(order, coefficient, at)) => {
            g.order.to_f64() == order
                && (g.coefficient / coefficient - 1.0).abs() < 1e-9
                && at.is_none_or(|at| angular_distance(at.to_radians(), *direction) < 1e-4)
        }
        (Verdict::IllPosed { growth: None, direction }, UnboundedAtFiniteWaveNumber(at)) => {
            angular_distance(at.to_radians(), *direction) < 1e-12
        }
        (Verdict::Indeterminate { rank, .. }, Indeterminate(wanted)) => *rank == wanted,
        _ => false,
    })
}

/// Verifies the verdicts on all systems whose growth is known.
#[test]
fn known_systems_have_expected_verdicts() {
    let (mut wrong, mut marginal) = (Vec::new(), Vec::new());
    for (name, system, wanted) in known_systems() {
        let verdict = compute_verdict(&system);
        let message = format!("{name}: wanted {wanted:?}, found {verdict:?}");
        match is_expected(&verdict, wanted) {
            Some(true) => {}
            Some(false) => wrong.push(message),
            None => marginal.push(message),
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    assert!(marginal.is_empty(), "{} marginal:\n{}", marginal.len(), marginal.join("\n"));
}

/// Verifies growth of dispersive waves at the order next to the leading one: order 1, coefficient within 2 %.
#[test]
fn growth_next_to_neutral_roots_is_detected() {
    let (_, system, _) = known_systems()
        .into_iter()
        .find(|(name, _, _)| *name == "beam with growth of order 1")
        .expect("a known system");
    let (order, coefficient, _) = expect_growth(&compute_verdict(&system));
    assert!(order == 1.0 && (coefficient / 0.25 - 1.0).abs() < 0.02, "{order}, {coefficient}");
}

/// Verifies that imaginary roots are not assessed as growth if their computed real parts are rounding errors.
#[test]
fn neutral_waves_are_not_assessed_as_growth() {
    for (name, system, _) in known_systems() {
        if ["acoustics", "acoustics carried along", "beam", "waves of order 3"].contains(&name) {
            assert_ne!(compute_verdict(&system).name(), "ill-posed", "{name}");
        }
    }
}

/// Verifies growth in a sector of width w only: ς = k² sin(θ − a) sin(a + w − θ).
#[test]
fn thin_sectors_of_growth_are_found() {
    for width in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
        for a in [0.4, 1.1, 2.3, 3.0] {
            let b: f64 = a + width;
            let entries = [
                (0, 0, T, 1.0),
                (1, 1, C, 1.0),
                (0, 1, X, -f64::sin(a)),
                (0, 1, Y, f64::cos(a)),
                (1, 0, X, -b.sin()),
                (1, 0, Y, b.cos()),
            ];
            let (order, coefficient, direction) =
                expect_growth(&compute_verdict(&build_system(2, 2, &entries)));
            assert_eq!(order, 2.0);
            let wanted = (0.5 * width).sin().powi(2);
            // The entries determine both directions to about ε, so the relative error of `width` is about ε/`width`.
            let error = (coefficient / wanted - 1.0).abs();
            assert!(error < 1e-12 + 8.0 * f64::EPSILON / width, "{width:e}: {error:e}");
            assert!(angular_distance(direction, a + 0.5 * width) < 0.5 * width, "{width:e}");
        }
    }
}

/// Verifies that systems whose growth is known have the same verdicts in other units.
#[test]
fn known_systems_have_the_same_verdicts_in_other_units() {
    let random = &mut seeded_generator(77);
    for (name, system, wanted) in known_systems() {
        let mut scaled = system.clone();
        let (rows, columns) = scaled.a.shape();
        let (rate, length) = (
            (random.uniform(-20.0, 20.0)).round().exp2(),
            random.uniform(-20.0, 20.0).round().exp2(),
        );
        let factors: Vec<f64> =
            (0..rows + columns).map(|_| random.uniform(-30.0, 30.0).round().exp2()).collect();
        for i in 0..rows {
            for j in 0..columns {
                let f = factors[i] * factors[rows + j];
                for (matrix, unit) in [(&mut scaled.a, rate), (&mut scaled.c, 1.0)] {
                    matrix[(i, j)].value *= f * unit;
                }
                for b in &mut scaled.b {
                    b[(i, j)].value *= f * length;
                }
            }
        }
        let wanted = match wanted {
            // Substitute ς = ς̂ `rate` and k = k̂ `length`.
            Growth(m, c, at) => Growth(m, c / rate * length.powf(m), at),
            other => other,
        };
        let verdict = compute_verdict(&scaled);
        assert_ne!(is_expected(&verdict, wanted), Some(false), "{name}: {wanted:?}, {verdict:?}");
        assert_eq!(verdict.name(), compute_verdict(&system).name(), "{name}");
    }
}
