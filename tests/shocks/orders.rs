//! Orders of convergence of the solver to the exact waves behind a piston, over five grids: of the pressure in L1 over the
//! whole profile, and near compaction shocks.
//!
//! Sweeps have the impedance of collapsed pores and an elastic skeleton wherever the skeleton may yield, so that the scheme
//! is of first order in all waves of such media. A shock then has a steady width of w cells and converges at order 1, but
//! only once it has travelled so far that diffusion over N cells, √N, would exceed w. The speed of a discontinuity of the
//! precursor or of a plastic wave does not depend on its amplitude: nothing steepens it, diffusion widens it like √N, and
//! it converges at order ½. The compaction shocks of aluminium foam are less than 1 % faster than the plastic waves ahead
//! of them; their width, from 10 to 90 %, is still growing on 3200 cells (45 cells, of 61 at last), and order 0.9 is
//! reached on 25,600 cells.

use super::case_path;
use polyfit_rs::polyfit_rs::polyfit;
use rayon::prelude::*;
use testkit::random::RandomNumbers;
use wellposed::setup::check::CheckPlan;
use wellposed::study::check::CheckExtent;
use wellposed::study::check::shocks::{ColumnCheck, check_shocks};
use wellposed::study::ignore_progress;

const GRIDS: [usize; 5] = [200, 400, 800, 1600, 3200];

/// Half of the width of the window about a compaction shock, relative to its position.
const WINDOW: f64 = 0.05;

/// Porous cases with compaction shocks or solitary waves, and one without, with the least orders over the whole profile and
/// near compaction shocks.
const CASES: [(&str, [f64; 2]); 7] = [
    ("foam-low-porosity.toml", [0.6, 0.9]),
    ("foam-collapse.toml", [0.55, 0.5]),
    ("foam-open.toml", [0.45, 0.0]),
    ("foam-high-porosity.toml", [0.55, 0.5]),
    ("foam-cone.toml", [0.6, 0.9]),
    ("strong-foam.toml", [0.9, 0.8]),
    ("strong-foam-precursor.toml", [0.7, 0.75]),
];

/// The least orders of random strong foams: ½, less the scatter of the fit, where precursors dominate the error (0.48 to
/// 0.84 in the five media); between ½ and 1 where the compaction shock has not yet reached its steady width.
const RANDOM_MEDIA: [f64; 2] = [0.45, 0.6];

/// Integral over an interval of |pressure − exact mean of the cell|.
fn error_between(column: &ColumnCheck, [from, to]: [f64; 2]) -> f64 {
    let spacing = 2.0 * column.measured_profile[0][0];
    // Integral of the exact pressure from 0: steps between the points of the profile.
    let exact_integral = |x: f64| {
        let pieces = column.exact_profile.windows(2);
        let piece = |pair: &[wellposed::study::shocks::ProfilePoint]| {
            let [start, end] = [pair[0].position, pair[1].position];
            pair[0].state.pressure * (x.min(end) - start).max(0.0)
        };
        pieces.map(piece).sum::<f64>()
    };
    let cells = column.measured_profile.iter().filter(|own| (from..to).contains(&own[0]));
    cells
        .map(|[x, _, pressure]| {
            let [low, high] = [x - 0.5 * spacing, x + 0.5 * spacing];
            (pressure * spacing - (exact_integral(high) - exact_integral(low))).abs()
        })
        .sum()
}

fn fit_order(errors: &[f64]) -> f64 {
    let x: Vec<f64> = GRIDS.iter().map(|count| (*count as f64).ln()).collect();
    let y: Vec<f64> = errors.iter().map(|error| error.ln()).collect();
    -polyfit(&x, &y, 1).expect("a fit")[1]
}

/// Orders over the whole profile, and in the windows about compaction shocks if there are any.
fn orders(name: &str, sets: &[String]) -> (f64, Option<f64>) {
    let grids = format!("check.cells={GRIDS:?}");
    let sets: Vec<&str> = std::iter::once(&grids).chain(sets).map(String::as_str).collect();
    let case = wellposed::load(case_path(name), &sets).unwrap();
    let CheckPlan::Shocks(plan) = CheckPlan::new(&case, CheckExtent::Full).unwrap() else {
        panic!("{name}")
    };
    let found = check_shocks(&case, &plan, &ignore_progress).unwrap().unwrap();
    let mut errors = [Vec::new(), Vec::new()];
    for column in &found.columns {
        let end = column.measured_profile.last().map_or(0.0, |own| own[0]) * 2.0;
        errors[0].push(error_between(column, [0.0, end]));
        let is_shock = |name: &str| name.contains("compaction shock") || name.contains("solitary");
        let shocks = column
            .quantity_checks
            .iter()
            .filter(|own| own.quantity.starts_with("speed of") && is_shock(&own.quantity));
        let windows = shocks.map(|own| {
            let position = own.predicted * column.time;
            error_between(column, [1.0 - WINDOW, 1.0 + WINDOW].map(|own| own * position))
        });
        let sum: f64 = windows.sum();
        if sum > 0.0 {
            errors[1].push(sum);
        }
    }
    let [whole, windows] = errors;
    (fit_order(&whole), (windows.len() == GRIDS.len()).then(|| fit_order(&windows)))
}

#[test]
#[ignore = "14 minutes of processor time: columns of up to 3200 cells"]
fn orders_of_convergence_of_compaction_shocks() {
    let mut problems: Vec<_> =
        CASES.map(|(name, least_orders)| (name, Vec::new(), least_orders)).to_vec();
    let mut random = RandomNumbers::new(1);
    for _ in 0..5 {
        let mut of = |key: &str, least: f64, greatest: f64| {
            format!("{key}={:?}", random.log_uniform(least, greatest))
        };
        let sets = vec![
            of("model.mu", 0.1e9, 0.4e9),
            of("porous.porosity", 0.05, 0.3),
            of("porous.contact_bulk_modulus", 2e9, 20e9),
            of("porous.yield_stress", 2e6, 8e6),
            of("piston.pressure", 200e6, 600e6),
        ];
        problems.push(("strong-foam.toml", sets, RANDOM_MEDIA));
    }
    // Columns of one row use one thread.
    let wrong: Vec<_> = problems
        .into_par_iter()
        .filter_map(|(name, sets, [least, least_at_shocks])| {
            let (whole, windows) = orders(name, &sets);
            println!("{name} {sets:?}: {whole:.2}, at compaction shocks {windows:.2?}");
            let is_wrong = whole < least || windows.is_some_and(|own| own < least_at_shocks);
            is_wrong.then_some((name, sets, whole, windows))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
