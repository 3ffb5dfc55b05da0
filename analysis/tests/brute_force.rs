//! Verdicts against brute force in 256 bits, on equations of the models implemented independently in the tests.

mod support;

use rayon::prelude::*;
use support::brute::{Brute, brute, degenerate_directions};
use support::states::{Sample, VARIANTS, reference, seeded, tame};
use support::wide::Wide;
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

fn verdict(sample: &Sample) -> Verdict {
    let mut pencil = Pencil::default();
    pencil.update(&sample.system).expect("finite coefficients");
    assess(&pencil).verdict
}

/// Directions with cos β = sin φ or cos β = sin ν, from the closed form, and all zeros of leading
/// forms that a scan finds.
fn centres(sample: &Sample) -> Vec<Wide> {
    let p = reference(sample).polynomial();
    let mut found = degenerate_directions(&p);
    let psi = Wide::from(sample.state.stress_angle);
    for angle in [sample.parameters.friction_angle, sample.parameters.dilatancy_angle] {
        let half = Wide::pi().shifted(-2) - Wide::from(angle).shifted(-1);
        for centre in [psi - half, psi + half] {
            let pi = Wide::pi();
            let apart = |own: &Wide| {
                let turns = ((*own - centre).to_f64() / std::f64::consts::PI).round();
                (*own - centre - Wide::from(turns) * pi).abs().to_f64()
            };
            if !found.iter().any(|own| apart(own) < 1e-25) {
                found.push(centre);
            }
        }
    }
    found
}

/// Growth of a sample by brute force at the wave numbers `waves`.
fn force(sample: &Sample, waves: &[f64], dense: usize, fine: bool) -> Brute {
    brute(&reference(sample).polynomial(), waves, dense, &centres(sample), 1.6, fine)
}

/// Compares a verdict with brute force; returns a description of the difference.
fn agrees(verdict: &Verdict, force: &Brute) -> Result<(), String> {
    let seen = format!("brute force: order {:.4}, {:?}", force.order(), force.at);
    match verdict {
        Verdict::IllPosed { growth: None, .. } if force.blows_up => Ok(()),
        _ if force.blows_up => Err(format!("{verdict:?}, but unbounded at finite k")),
        Verdict::WellPosed if force.order().abs() < 0.02 => Ok(()),
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let order = growth.order.value();
            let coefficient = force.coefficient(order);
            if (force.order() - order).abs() > 0.05 {
                Err(format!("{verdict:?}: {seen}"))
            } else if (coefficient / growth.coefficient - 1.0).abs() > 0.02 {
                Err(format!("{verdict:?}: coefficient {coefficient:e}; {seen}"))
            } else {
                Ok(())
            }
        }
        other => Err(format!("{other:?}: {seen}")),
    }
}

/// Verifies the verdicts on 560 uniform and non-uniform states of all models against brute force: order within 0.05,
/// coefficient within 2 %.
#[test]
fn verdicts_agree_with_brute_force() {
    const STATES: u64 = 560;
    let results: Vec<(usize, Verdict, Result<(), String>)> = (0..STATES)
        .into_par_iter()
        .map(|seed| {
            let variant = seed as usize % VARIANTS.len();
            let (kind, dilatancy) = VARIANTS[variant];
            let gradients = !(seed as usize / VARIANTS.len()).is_multiple_of(3);
            let sample = tame(&mut seeded(0xb47e + seed), kind, dilatancy, gradients);
            let own = verdict(&sample);
            let check = |fine| agrees(&own, &force(&sample, &[1e14, 1e20], 60, fine));
            let result = check(false).or_else(|_| check(true));
            let result = result.map_err(|e| {
                let (p, s) = (&sample.parameters, &sample.state);
                format!("seed {seed}, {kind:?} {dilatancy:?}, gradients {gradients}: {e}\n  {p:?}\n  {s:?}")
            });
            (variant, own, result)
        })
        .collect();
    for (variant, (kind, dilatancy)) in VARIANTS.iter().enumerate() {
        let mut counts = std::collections::BTreeMap::<String, usize>::new();
        for (_, verdict, _) in results.iter().filter(|r| r.0 == variant) {
            let name = match verdict {
                Verdict::IllPosed { growth: Some(g), .. } => {
                    format!("order {}/{}", g.order.numerator, g.order.denominator)
                }
                Verdict::IllPosed { growth: None, .. } => "unbounded at finite k".into(),
                other => other.name().into(),
            };
            *counts.entry(name).or_default() += 1;
        }
        println!("{kind:?} {dilatancy:?}: {counts:?}");
    }
    let wrong: Vec<&String> = results.iter().filter_map(|r| r.2.as_ref().err()).collect();
    for message in &wrong {
        println!("{message}");
    }
    assert!(wrong.is_empty(), "{} of {STATES} disagree", wrong.len());
}

/// Verifies fractional orders and order 3 against brute force at three wave numbers over four decades.
#[test]
fn rare_orders_are_confirmed_over_four_decades() {
    let mut seen = std::collections::BTreeMap::<(i64, i64), usize>::new();
    for (kind, dilatancy) in VARIANTS {
        for seed in 0..60u64 {
            let random = &mut seeded(0x0dd + seed);
            let sample: Sample = tame(random, kind, dilatancy, seed % 2 == 1);
            let Verdict::IllPosed { growth: Some(growth), .. } = verdict(&sample) else { continue };
            let key = (growth.order.numerator, growth.order.denominator);
            if key == (2, 1) || key == (1, 1) || seen.get(&key).is_some_and(|&n| n >= 3) {
                continue;
            }
            *seen.entry(key).or_default() += 1;
            let force = force(&sample, &[1e18, 1e20, 1e22], 60, true);
            for pair in force.at.windows(2) {
                let order = (pair[1].1 / pair[0].1).ln() / (pair[1].0 / pair[0].0).ln();
                println!(
                    "{kind:?} {dilatancy:?} seed {seed}: order {}/{}, at k = {:e} … {:e}: {order:.5}, \
                     coefficient {:.5e} for {:.5e}",
                    key.0,
                    key.1,
                    pair[0].0,
                    pair[1].0,
                    pair[1].1 / pair[1].0.powf(growth.order.value()),
                    growth.coefficient
                );
                assert!((order - growth.order.value()).abs() < 0.02, "{growth:?}: {force:?}");
            }
        }
    }
    println!("{seen:?}");
}
