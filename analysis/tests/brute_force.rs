//! Verdicts against brute force in 256 bits, on equations of the models implemented independently in the tests.

use crate::support::brute_force::{
    BruteForceGrowth, compute_growth_by_brute_force, find_degenerate_directions,
};
use crate::support::real256::Real256;
use crate::support::states::{FlowSample, reference_system, sample_order_one, seeded_generator};
use crate::support::verdicts::{compute_verdict, verdict_label};
use rayon::prelude::*;
use testkit::flows::SQUARE_MODEL_CASES;
use wellposed_analysis::growth::Verdict;

/// Directions θ with cos β = sin φ or cos β = sin ν, β = 2(ψ − θ), from the closed form for the stress angle ψ,
/// friction angle φ and dilatancy angle ν; and all zeros of leading forms that a scan finds.
fn candidate_directions(sample: &FlowSample) -> Vec<Real256> {
    let p = reference_system(sample).polynomial();
    let mut found = find_degenerate_directions(&p);
    let psi = Real256::from(sample.state.stress_angle);
    for angle in [sample.parameters.friction_angle, sample.parameters.dilatancy_angle] {
        let half = Real256::pi().multiply_by_power_of_two(-2)
            - Real256::from(angle).multiply_by_power_of_two(-1);
        for centre in [psi - half, psi + half] {
            let pi = Real256::pi();
            let apart = |own: &Real256| {
                let turns = ((*own - centre).to_f64() / std::f64::consts::PI).round();
                (*own - centre - Real256::from(turns) * pi).abs().to_f64()
            };
            if !found.iter().any(|own| apart(own) < 1e-25) {
                found.push(centre);
            }
        }
    }
    found
}

/// Growth of a sample by brute force at the wave numbers `wave_numbers` (1/m) over `dense` uniform directions and
/// clusters around the candidates; `fine` is `is_fine` of [`compute_growth_by_brute_force`].
fn compute_brute_force(
    sample: &FlowSample,
    wave_numbers: &[f64],
    dense: usize,
    fine: bool,
) -> BruteForceGrowth {
    compute_growth_by_brute_force(
        &reference_system(sample).polynomial(),
        wave_numbers,
        dense,
        &candidate_directions(sample),
        1.6,
        fine,
    )
}

/// Compares a verdict with brute force; returns a description of the difference.
fn compare_with_brute_force(verdict: &Verdict, force: &BruteForceGrowth) -> Result<(), String> {
    let summary = format!("brute force: order {:.4}, {:?}", force.order(), force.samples);
    match verdict {
        Verdict::IllPosed { growth: None, .. } if force.is_unbounded_at_finite_k => Ok(()),
        _ if force.is_unbounded_at_finite_k => {
            Err(format!("{verdict:?}, but unbounded at finite k"))
        }
        Verdict::WellPosed if force.order().abs() < 0.02 => Ok(()),
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let order = growth.order.to_f64();
            let coefficient = force.coefficient(order);
            if (force.order() - order).abs() > 0.05 {
                Err(format!("{verdict:?}: {summary}"))
            } else if (coefficient / growth.coefficient - 1.0).abs() > 0.02 {
                Err(format!("{verdict:?}: coefficient {coefficient:e}; {summary}"))
            } else {
                Ok(())
            }
        }
        other => Err(format!("{other:?}: {summary}")),
    }
}

/// Verifies the verdicts on uniform and non-uniform states of all models against brute force: three states of each model
/// and dilatancy, one of them uniform.
#[test]
fn verdicts_agree_with_brute_force() {
    assert_agreement_with_brute_force(21);
}

#[test]
#[ignore = "takes minutes"]
fn many_verdicts_agree_with_brute_force() {
    assert_agreement_with_brute_force(1120);
}

/// Checks the verdicts on `count` states against brute force: order within 0.05 (0.02 if well-posed), coefficient
/// within 2 %.
fn assert_agreement_with_brute_force(count: u64) {
    let results: Vec<(usize, Verdict, Result<(), String>)> = (0..count)
        .into_par_iter()
        .map(|seed| {
            let variant = seed as usize % SQUARE_MODEL_CASES.len();
            let (kind, dilatancy) = SQUARE_MODEL_CASES[variant];
            let gradients = !(seed as usize / SQUARE_MODEL_CASES.len()).is_multiple_of(3);
            let sample =
                sample_order_one(&mut seeded_generator(0xb47e + seed), kind, dilatancy, gradients);
            let own = compute_verdict(&sample.system);
            let check = |fine| {
                compare_with_brute_force(
                    &own,
                    &compute_brute_force(&sample, &[1e14, 1e20], 60, fine),
                )
            };
            let result = check(false).or_else(|_| check(true));
            let result = result.map_err(|e| {
                let (p, s) = (&sample.parameters, &sample.state);
                format!(
                    "seed {seed}, {kind:?} {dilatancy:?}, gradients {gradients}: {e}\n  {p:?}\n  \
                     {s:?}"
                )
            });
            (variant, own, result)
        })
        .collect();
    for (variant, (kind, dilatancy)) in SQUARE_MODEL_CASES.iter().enumerate() {
        let mut counts = std::collections::BTreeMap::<String, usize>::new();
        for (_, verdict, _) in results.iter().filter(|r| r.0 == variant) {
            *counts.entry(verdict_label(verdict)).or_default() += 1;
        }
        println!("{kind:?} {dilatancy:?}: {counts:?}");
    }
    let wrong: Vec<&String> = results.iter().filter_map(|r| r.2.as_ref().err()).collect();
    for message in &wrong {
        println!("{message}");
    }
    assert!(wrong.is_empty(), "{} of {count} disagree", wrong.len());
}

/// Verifies verdicts of orders other than 1 and 2 against brute force at three wave numbers over four decades: the first
/// state of each order.
#[test]
fn rare_orders_are_confirmed_over_four_decades() {
    confirm_rare_orders(1);
}

#[test]
#[ignore = "takes minutes"]
fn more_states_of_rare_orders_are_confirmed_over_four_decades() {
    confirm_rare_orders(3);
}

/// Confirms the first `states` states of each order other than 1 and 2.
fn confirm_rare_orders(states: usize) {
    let mut counts = std::collections::BTreeMap::<(i64, i64), usize>::new();
    for (kind, dilatancy) in SQUARE_MODEL_CASES {
        for seed in 0..60u64 {
            let random = &mut seeded_generator(0x0dd + seed);
            let sample: FlowSample = sample_order_one(random, kind, dilatancy, seed % 2 == 1);
            let Verdict::IllPosed { growth: Some(growth), .. } = compute_verdict(&sample.system)
            else {
                continue;
            };
            let key = (growth.order.numerator, growth.order.denominator);
            if key == (2, 1) || key == (1, 1) || counts.get(&key).is_some_and(|&n| n >= states) {
                continue;
            }
            *counts.entry(key).or_default() += 1;
            let force = compute_brute_force(&sample, &[1e18, 1e20, 1e22], 60, true);
            for pair in force.samples.windows(2) {
                let order = (pair[1].1 / pair[0].1).ln() / (pair[1].0 / pair[0].0).ln();
                println!(
                    "{kind:?} {dilatancy:?} seed {seed}: order {}/{}, at k = {:e} … {:e}: {order:.5}, \
                     coefficient {:.5e} for {:.5e}",
                    key.0,
                    key.1,
                    pair[0].0,
                    pair[1].0,
                    pair[1].1 / pair[1].0.powf(growth.order.to_f64()),
                    growth.coefficient
                );
                assert!((order - growth.order.to_f64()).abs() < 0.02, "{growth:?}: {force:?}");
            }
        }
    }
    println!("{counts:?}");
}
