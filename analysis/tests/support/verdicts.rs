//! Verdicts of the analysis, and the quantities that tests compare.

use models::LinearisedSystem;
use std::f64::consts::PI;
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

/// Verdict on a linearised system.
pub fn compute_verdict(system: &LinearisedSystem<2>) -> Verdict {
    let mut pencil = Pencil::default();
    pencil.update(system).expect("finite coefficients");
    assess(&pencil).verdict
}

/// (order, coefficient, direction) of an ill-posed verdict.
pub fn expect_growth(verdict: &Verdict) -> (f64, f64, f64) {
    match verdict {
        Verdict::IllPosed { growth: Some(g), direction } => {
            (g.order.to_f64(), g.coefficient, *direction)
        }
        other => panic!("{other:?}"),
    }
}

/// Angle between two directions modulo π, rad.
pub fn angular_distance(a: f64, b: f64) -> f64 {
    let gap = (a - b).rem_euclid(PI);
    gap.min(PI - gap)
}

/// Name of a verdict, with its order if ill-posed.
pub fn verdict_label(verdict: &Verdict) -> String {
    match verdict {
        Verdict::IllPosed { growth: Some(g), .. } => {
            format!("order {}/{}", g.order.numerator, g.order.denominator)
        }
        Verdict::IllPosed { growth: None, .. } => "unbounded at finite k".into(),
        other => other.name().into(),
    }
}

/// Coefficient of growth of an ill-posed verdict.
pub fn growth_coefficient(verdict: &Verdict) -> f64 {
    match verdict {
        Verdict::IllPosed { growth: Some(g), .. } => g.coefficient,
        other => panic!("no coefficient: {other:?}"),
    }
}
