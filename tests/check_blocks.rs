//! Tests of `wellposed check` for blocky media: predicted and measured Bloch waves agree, layers without linear state
//! are not measurable, and a law of the solver that differs from that of the analysis is reported.

use agreement::blocks::compare_blocks;
use models::interface::layer::LayerLaw;
use std::ops::ControlFlow;
use wellposed::case::Case;
use wellposed::report::Report;
use wellposed::setup::check::CheckPlan;
use wellposed::setup::check::blocks::BlockyMediumPlan;
use wellposed::study::check::solid::SolidCheck;
use wellposed::study::check::{CheckExtent, CheckOutcome, CheckResult};
use wellposed::study::ignore_progress;

/// Keys of an elastic layer in a `[[joint]]` section.
const ELASTIC_JOINT_KEYS: &str =
    "thickness = 5e-3\ndensity = 1500\nlongitudinal_speed = 1000\nshear_speed = 500\n";

/// Creates a case of two by two blocks, with additional keys of the block and of the joint.
fn create_case(block: &str, joint: &str) -> Case {
    let text = format!(
        "[model]
kind = 'classical'
lambda = 1.89e10
mu = 2.43e10
density = 2700
[[block]]
cells = [6, 6]
size = [0.05, 0.05]
repeat = [2, 2]
{block}
[[joint]]
every = 'all'
{joint}
[time]
duration = 1e-4
[check]
cells = [12, 16]
numbers = [10]
directions_deg = [30]
"
    );
    Case::parse(&text, "blocks.toml", &[]).expect("a case")
}

fn run_short_check(case: &Case) -> CheckResult {
    wellposed::check_agreement(case, CheckExtent::Short, &ignore_progress).expect("a result")
}

fn solid_check(result: &CheckResult) -> &SolidCheck {
    match &result.outcome {
        CheckOutcome::Solid(own) => own,
        other => panic!("no solid: {other:?}"),
    }
}

#[test]
fn bloch_waves_of_elastic_layers_agree() {
    let case = create_case("", &format!("kind = 'elastic'\n{ELASTIC_JOINT_KEYS}"));
    let result = run_short_check(&case);
    assert_eq!(result.is_in_agreement, Some(true), "{}", result.to_text(&case));
    let solid = solid_check(&result);
    assert_eq!(solid.blocky_medium_checks.len(), 1);
    let blocks = &solid.blocky_medium_checks[0];
    // Expected branches: of chains, 2 axes × 2 polarisations × 2 branches; of waves in the plane, 2 wave vectors × 2
    // branches.
    assert_eq!(blocks.branch_checks.len(), 12);
    let chains = blocks.branch_checks.iter().filter(|row| row.branch_label.starts_with("chain"));
    for row in chains {
        let tolerance = row.extrapolated_result.expect("a measurement").tolerance;
        assert!(tolerance < 1e-10 * row.predicted_frequency.angular_frequency, "{row:?}");
    }
    // Branches of the block material and of the blocky medium.
    assert_eq!(result.item_and_failure_counts(), [14, 0]);
    let text = result.to_text(&case);
    for words in ["block[0]: blocks of 0.05 × 0.05 m, elastic layers", "12 waves", "all agree"] {
        assert!(text.contains(words), "{text}");
    }
    let report = serde_json::to_value(&result).expect("a report");
    assert_eq!(report["blocks"][0]["rows"][0]["branch"], "chain, longitudinal, branch 1");
    assert_eq!(report["blocks"][0]["agrees"], true);
}

#[test]
fn layers_without_linear_state_are_not_measurable() {
    for (kind, reason) in [
        ("kind = 'cracked'", "cracked"),
        ("kind = 'elastic-plastic'\nshear_strength = 0\nshear_friction = 0.5", "without strength"),
    ] {
        let case = create_case("", &format!("{kind}\n{ELASTIC_JOINT_KEYS}"));
        let result = run_short_check(&case);
        // Waves in the homogeneous block material agree.
        assert_eq!(result.is_in_agreement, Some(true));
        assert_eq!(result.unmeasured_count(), 1);
        let found = solid_check(&result).blocky_medium_checks[0]
            .unmeasured_reason
            .clone()
            .expect("a reason");
        assert!(found.contains(reason), "{found}");
        assert!(result.to_text(&case).contains("not measurable: "));
    }
}

#[test]
fn joints_and_patterns_determine_periodic_media() {
    let plans = |block: &str, joint: &str| -> Vec<BlockyMediumPlan> {
        let case = create_case(block, &format!("kind = 'elastic'\n{ELASTIC_JOINT_KEYS}\n{joint}"));
        match CheckPlan::new(&case, CheckExtent::Full).expect("a plan") {
            CheckPlan::Solid { blocky_medium_plans: blocks, .. } => blocks,
            other => panic!("no solid: {other:?}"),
        }
    };
    let blocks = |plan: &BlockyMediumPlan| {
        let own = plan.experiment.as_ref().expect("an experiment");
        (
            own.analysis_medium.blocks,
            own.analysis_medium.row_shift,
            own.analysis_medium.materials.len(),
        )
    };
    let own = plans("", "");
    assert_eq!(own.iter().map(blocks).collect::<Vec<_>>(), [([1, 1], 0.0, 1)]);
    let own = plans("row_shift = 0.025", "");
    assert_eq!(own.iter().map(blocks).collect::<Vec<_>>(), [([1, 2], 0.5, 2)]);
    let two = "materials = [{ model = { mu = 2e10 } }, { model = { mu = 3e10 } }]";
    let own = plans(two, "");
    assert_eq!(own.iter().map(blocks).collect::<Vec<_>>(), [([2, 2], 0.0, 4)]);
    let own = plans(&format!("{two}\npattern = 'list'\nlist = [0, 1, 1, 1]"), "");
    assert_eq!(own.len(), 2);
    // The joints normal to x₁ have a different law.
    let other = format!(
        "[[joint]]\nat = [0.05, 0.025]\nkind = 'elastic'\n{}",
        ELASTIC_JOINT_KEYS.replace("5e-3", "1e-3")
    );
    let own = plans("", &other);
    assert_eq!(own.len(), 2);
}

/// Verifies that a joint law of the solver with 1.01 times the compliance of the analysis makes the branches of chains
/// disagree.
#[test]
fn wrong_compliance_in_solver_is_detected() {
    let case = create_case("", &format!("kind = 'elastic'\n{ELASTIC_JOINT_KEYS}"));
    let CheckPlan::Solid { blocky_medium_plans: blocks, .. } =
        CheckPlan::new(&case, CheckExtent::Short).expect("a plan")
    else {
        panic!("no solid");
    };
    let mut own = blocks[0].experiment.clone().expect("an experiment");
    for law in own.solver_medium.laws.iter_mut().flatten() {
        let LayerLaw::Elastic(law) = law else { panic!("an elastic law") };
        law.components[1].compliance *= 1.01;
    }
    let continue_check = |_: usize, _: usize| ControlFlow::Continue(());
    let found =
        compare_blocks(&own.analysis_medium, &own.solver_medium, &own.settings, &continue_check)
            .expect("results");
    let failed = found.iter().filter(|row| row.is_within_tolerance() == Some(false)).count();
    assert!(failed >= 4, "{failed}");
}
