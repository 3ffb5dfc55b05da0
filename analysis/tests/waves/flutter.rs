//! One slipping layer: onset of flutter, and zero speeds.

use crate::support::slipping_layer::SlippingLayer;
use models::LinearisedSystem;
use models::common::rates::RateEquations;
use std::f64::consts::{FRAC_PI_2, PI};
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;
use wellposed_analysis::waves::squared_speeds;

fn is_ill_posed(equations: &RateEquations<2>) -> bool {
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    equations.linearise(&mut system);
    pencil.update(&system).expect("finite");
    matches!(assess(&pencil).verdict, Verdict::IllPosed { .. })
}

/// The dilatancy between `low` and `high` at which `holds` changes.
fn bisect_onset(holds: impl Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    let at_low = holds(low);
    assert_ne!(at_low, holds(high));
    for _ in 0..45 {
        let middle = 0.5 * (low + high);
        if holds(middle) == at_low { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Minimum over the directions, by golden section from the best of 720 samples.
fn minimise_over_directions(f: impl Fn(f64) -> f64) -> f64 {
    let steps = 720;
    let step = PI / f64::from(steps);
    let start = (0..steps)
        .map(|i| (f64::from(i) + 0.5) * step)
        .min_by(|&x, &y| f(x).total_cmp(&f(y)))
        .expect("some");
    let (mut low, mut high) = (start - step, start + step);
    for _ in 0..100 {
        let (x, y) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if f(x) < f(y) { high = y } else { low = x }
    }
    f(0.5 * (low + high))
}

#[test]
fn flutter_sets_in_where_the_discriminant_vanishes() {
    for (lambda, alpha, friction) in [(1.0, 0.3, 0.6), (1.0, 0.3, 0.9), (3.0, 0.3, 0.9)] {
        let with = |dilatancy| SlippingLayer { lambda, alpha, friction, dilatancy };
        // Associated flow is well-posed, flow without dilatancy is not.
        let by_verdict = bisect_onset(|x| is_ill_posed(&with(x).equations()), 0.0, friction);
        let discriminant = |x: f64| {
            minimise_over_directions(|angle| {
                let [trace, determinant] = with(x).acoustic_invariants(angle);
                trace * trace - 4.0 * determinant
            })
        };
        let by_discriminant = bisect_onset(|x| discriminant(x) < 0.0, 0.0, friction);
        println!("flutter below the dilatancy {by_verdict}, by the discriminant {by_discriminant}");
        assert!((by_verdict - by_discriminant).abs() < 1e-8);
    }
    // For a dilatancy just above the onset no speed is complex; without dilatancy some are, around 45°.
    let complex = |dilatancy: f64| {
        let with = SlippingLayer { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy };
        (0..1800).map(|i| f64::from(i) * PI / 1800.0).filter(move |&angle| {
            squared_speeds(&with.equations(), [angle.cos(), angle.sin()])[0].im.abs() > 1e-6
        })
    };
    assert_eq!(complex(0.297).count(), 0);
    assert!(complex(0.0).any(|angle| (angle - 0.25 * PI).abs() < 0.02));
    assert!(complex(0.0).all(|angle| angle < FRAC_PI_2));
}

/// Verifies that along the normal of the layer one speed is zero for every dilatancy (slip, no loss of well-posedness).
/// In other directions θ a speed vanishes where det Γ/sin²θ, without the double zero due to slip, vanishes: a
/// stationary discontinuity.
#[test]
fn a_speed_vanishes_where_the_determinant_does() {
    for (lambda, alpha, friction) in [(0.0, 0.1, 1.5), (0.0, 0.1, 2.0), (0.2, 0.05, 1.6)] {
        let with = |dilatancy| SlippingLayer { lambda, alpha, friction, dilatancy };
        for dilatancy in [0.0, 0.5 * friction, friction] {
            let along = squared_speeds(&with(dilatancy).equations(), [1.0, 0.0]);
            assert!(along[along.len() - 1].norm() < 1e-15);
        }
        let by_verdict = bisect_onset(|x| is_ill_posed(&with(x).equations()), 0.0, friction);
        let determinant = |x: f64| {
            minimise_over_directions(|angle| {
                with(x).acoustic_invariants(angle)[1] / angle.sin().powi(2)
            })
        };
        let by_determinant = bisect_onset(|x| determinant(x) < 0.0, 0.0, friction);
        println!(
            "zero speed below the dilatancy {by_verdict}, by the determinant {by_determinant}"
        );
        assert!((by_verdict - by_determinant).abs() < 1e-8);
    }
}
