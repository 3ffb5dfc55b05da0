//! Tests of `wellposed check` on models given as equations: their waves in time agree with the roots.

use crate::support::bundled_case;
use wellposed::case::Case;
use wellposed::report::Report;
use wellposed::study::check::equations::EquationsCheck;
use wellposed::study::check::{CheckExtent, CheckOutcome, check_agreement};
use wellposed::study::ignore_progress;

fn check(name: &str) -> (EquationsCheck, String) {
    let case = Case::load(&bundled_case(&format!("equations/{name}.toml")), &[]).expect("a case");
    let found = check_agreement(&case, CheckExtent::Short, &ignore_progress).expect("a state");
    assert_eq!(found.is_in_agreement, Some(true), "{name}");
    let text = found.to_text(&case);
    match found.outcome {
        CheckOutcome::Equations(own) => (own, text),
        other => panic!("{name}: {other:?}"),
    }
}

/// Finite roots and constraints that must be differentiated, by model.
#[test]
fn waves_in_time_agree_with_the_roots() {
    for (name, roots, constraints) in [
        ("mu-of-i", 1, 1),
        ("corotational-maxwell", 4, 1),
        ("biot", 5, 0),
        ("two-layers", 2, 1),
        ("zener", 3, 0),
        ("heat", 1, 0),
    ] {
        let (found, text) = check(name);
        assert_eq!(found.singular_count, 0, "{name}");
        for own in &found.wave_checks {
            let evolution = own.evolution.as_ref().expect("followed");
            let counts = [evolution.root_count, evolution.solution_count];
            assert_eq!(counts, [roots; 2], "{name}");
            assert_eq!(evolution.differentiation_count, constraints, "{name}");
            assert!(evolution.constraint_residual < 1e-10, "{name}: {evolution:?}");
            assert!(evolution.max_relative_difference < 1e-8, "{name}: {evolution:?}");
        }
        assert_eq!(text.contains("constraints differentiated"), constraints > 0, "{name}: {text}");
        assert!(text.contains("3 waves in time") && !text.contains("DISAGREES"), "{name}: {text}");
    }
}

#[test]
fn equations_that_do_not_determine_the_evolution_are_not_measured() {
    let (found, text) = check("typed-free-rotating");
    assert_eq!(found.singular_count, 3);
    assert!(found.wave_checks.iter().all(|own| own.evolution.is_none()));
    assert!(text.contains("not measured: evolution in time of 3 waves"), "{text}");
}
