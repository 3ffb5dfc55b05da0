//! Growth rates against direction and wave number, and the order fitted to them.

use super::Workspace;
use crate::growth::{Assessment, Verdict};
use crate::search::golden_section;
use models::common::elementary::Elementary;
use std::f64::consts::PI;

/// Number of directions of a growth curve, two per degree; layers around degenerate directions are sampled
/// geometrically in addition.
const DIRECTIONS: usize = 360;
/// Geometric samples in a layer: decimal exponents of the distance (degrees) from a degenerate direction, as first
/// exponent, step, count.
const LAYER: (f64, f64, usize) = (-9.0, 0.1, 90);

/// Samples per decade of the wave number, and number of decades on both sides of the given wave number.
const PER_DECADE: i32 = 12;
const DECADES: i32 = 4;
/// Maximum number of decades towards short waves, extended until the growth reaches its asymptote.
const MAX_DECADES: i32 = 8;
/// Relative difference from the asymptote below which growth counts as asymptotic.
const ON_ASYMPTOTE: f64 = 0.02;
/// Decades at the end of a curve to which an order is fitted.
const FITTED_DECADES: i32 = 2;

/// Coarse samples of the direction at every wave number for the largest growth rate, refined between neighbours.
const COARSE_DIRECTIONS: usize = 60;
const COARSE_LAYER: (f64, f64, usize) = (-10.0, 1.0 / 3.0, 28);
/// Number of refined peaks, and of golden-section steps.
const PEAKS: usize = 3;
const STEPS: usize = 28;

/// Growth rates of a state at one wave number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtWaveNumber {
    /// Wave number k, 1/m.
    pub number: f64,
    /// Largest Re ς over the roots in the direction of the case, 1/s.
    pub growth_rate: f64,
    /// Supremum of Re ς over all directions, 1/s; infinite where growth is unbounded.
    pub greatest: f64,
    /// Direction of the wave vector of the supremum, rad, in \[0, π).
    pub direction: f64,
}

/// Order of growth in the wave number, fitted to a growth curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedOrder {
    /// Slope of log Re ς against log k.
    pub order: f64,
    /// Smallest and largest wave number of the fit, 1/m.
    pub numbers: [f64; 2],
}

/// Growth rates at a wave number against the direction from 0° to 180°: (degrees, 1/s).
pub fn by_direction(workspace: &Workspace, assessment: &Assessment, number: f64) -> Vec<[f64; 2]> {
    let step = 180.0 / DIRECTIONS as f64;
    let mut degrees: Vec<f64> = (0..=DIRECTIONS).map(|i| i as f64 * step).collect();
    for centre in assessment.degenerate.iter().map(|d| d.angle.to_degrees()) {
        degrees.extend(around(centre, LAYER));
    }
    degrees.retain(|d| (0.0..=180.0).contains(d));
    degrees.sort_by(f64::total_cmp);
    degrees.into_iter().map(|d| [d, workspace.growth(number, d.to_radians())]).collect()
}

/// Number of decades beyond the given wave number needed to reach the asymptotic growth of the verdict, at most 8.
pub fn decades(workspace: &Workspace, assessment: &Assessment, number: f64) -> i32 {
    let Verdict::IllPosed { growth: Some(growth), .. } = assessment.verdict else { return DECADES };
    let directions = directions(assessment);
    let is_seen = |decades: &i32| {
        let k = number * 10f64.powi(decades - FITTED_DECADES);
        let [rate, _] = maximise(|direction| rate(workspace, k, direction), &directions);
        let asymptote = growth.coefficient * k.cr_powf(growth.order.value());
        (rate / asymptote - 1.0).abs() < ON_ASYMPTOTE
    };
    let reached =
        (DECADES..=MAX_DECADES).take_while(|&d| workspace.reaches(number * 10f64.powi(d)));
    let decades: Vec<i32> = reached.collect();
    let seen = decades.iter().find(|d| is_seen(d)).or(decades.last());
    seen.copied().unwrap_or(DECADES)
}

/// Growth rates against the wave number, from four decades below the given one to `decades` above it.
pub fn by_wave_number(
    workspace: &Workspace,
    assessment: &Assessment,
    number: f64,
    direction: f64,
    decades: i32,
) -> Vec<AtWaveNumber> {
    let directions = directions(assessment);
    let unbounded = match assessment.verdict {
        Verdict::IllPosed { growth: None, direction } => Some(direction),
        _ => None,
    };
    (-DECADES * PER_DECADE..=decades * PER_DECADE)
        .map(|step| {
            let number = number * 10f64.cr_powf(f64::from(step) / f64::from(PER_DECADE));
            let [greatest, worst] = match unbounded {
                Some(direction) => [f64::INFINITY, direction],
                None => maximise(|direction| rate(workspace, number, direction), &directions),
            };
            AtWaveNumber {
                number,
                growth_rate: workspace.growth(number, direction),
                greatest,
                direction: worst,
            }
        })
        .collect()
}

/// Largest Re ς, 1/s; zero if it is below the rounding of the largest root.
fn rate(workspace: &Workspace, k: f64, direction: f64) -> f64 {
    if !workspace.reaches(k) {
        return f64::NAN;
    }
    let roots = workspace.pencil.polynomial.roots(k, direction, &[]);
    let rate = roots.iter().map(|root| root.re).fold(f64::NAN, f64::max);
    let size = roots.iter().map(|root| root.re.abs()).fold(0.0, f64::max);
    if rate.abs() <= 8.0 * f64::EPSILON * size { 0.0 } else { rate }
}

/// Sample directions, rad, ascending, dense enough in the layers around degenerate directions at all wave numbers.
fn directions(assessment: &Assessment) -> Vec<f64> {
    let step = PI / COARSE_DIRECTIONS as f64;
    let mut directions: Vec<f64> = (0..COARSE_DIRECTIONS).map(|i| i as f64 * step).collect();
    for degenerate in &assessment.degenerate {
        directions.extend(around(degenerate.angle, COARSE_LAYER));
    }
    // Include the direction of the verdict, so that a narrow sector is not missed.
    if let Verdict::IllPosed { direction, .. } = assessment.verdict {
        directions.push(direction);
    }
    for direction in &mut directions {
        *direction = direction.rem_euclid(PI);
    }
    directions.sort_by(f64::total_cmp);
    directions.dedup();
    directions
}

/// A direction and geometrically spaced directions on both sides of it.
fn around(centre: f64, (first, step, number): (f64, f64, usize)) -> impl Iterator<Item = f64> {
    let offsets = (0..number).map(move |i| 10f64.cr_powf(first + step * i as f64));
    offsets.flat_map(move |offset| [centre - offset, centre + offset]).chain([centre])
}

/// Maximum and its position of a function of period π: the highest peaks of the ascending `samples`, refined by golden
/// sections between their neighbours.
fn maximise(f: impl Fn(f64) -> f64, samples: &[f64]) -> [f64; 2] {
    let values: Vec<f64> = samples.iter().map(|&x| f(x)).collect();
    let count = samples.len();
    let is_peak = |&i: &usize| {
        let [before, after] = [values[(i + count - 1) % count], values[(i + 1) % count]];
        values[i] >= before && values[i] >= after
    };
    let mut peaks: Vec<usize> = (0..count).filter(is_peak).collect();
    peaks.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    peaks.truncate(PEAKS);
    let refined = peaks.into_iter().flat_map(|i| {
        let before = if i == 0 { samples[count - 1] - PI } else { samples[i - 1] };
        let after = if i + 1 == count { samples[0] + PI } else { samples[i + 1] };
        [[values[i], samples[i]], golden_section(&f, [before, after], STEPS, None).best()]
    });
    let [value, place] = refined.fold([f64::NAN, 0.0], |best: [f64; 2], found| {
        if found[0] > best[0] || best[0].is_nan() { found } else { best }
    });
    [value, place.rem_euclid(PI)]
}

/// Fits the order m of Re ς ∝ k^m to the last decades of the largest growth rate; `None` unless all samples there are
/// finite and positive.
pub fn fitted_order(curve: &[AtWaveNumber]) -> Option<FittedOrder> {
    let last = curve.last()?.number;
    let first = last / 10f64.powi(FITTED_DECADES) * (1.0 - 1e-9);
    let fitted: Vec<&AtWaveNumber> = curve.iter().filter(|at| at.number >= first).collect();
    if !fitted.iter().all(|at| at.greatest > 0.0 && at.greatest.is_finite()) {
        return None;
    }
    let numbers = [fitted.first()?.number, last];
    let logarithms = |f: fn(&AtWaveNumber) -> f64| -> Vec<f64> {
        fitted.iter().map(|at| f(at).cr_log10()).collect()
    };
    let mut abscissae = logarithms(|at| at.number);
    let ordinates = logarithms(|at| at.greatest);
    // Centre and scale the abscissae to [−1, 1]: `polyfit` fits unscaled monomials.
    let [low, high] = numbers.map(Elementary::cr_log10);
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    if half <= 0.0 {
        return None;
    }
    for x in &mut abscissae {
        *x = (*x - centre) / half;
    }
    let line = polyfit_rs::polyfit_rs::polyfit(&abscissae, &ordinates, 1).ok()?;
    Some(FittedOrder { order: line.get(1)? / half, numbers })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(growth: impl Fn(f64) -> f64) -> Vec<AtWaveNumber> {
        let at = |step: i32| {
            let number = 10f64.powf(f64::from(step) / 12.0);
            let greatest = growth(number);
            AtWaveNumber { number, growth_rate: f64::NAN, greatest, direction: 0.0 }
        };
        (-12..=96).map(at).collect()
    }

    #[test]
    fn planted_orders_are_fitted() {
        for order in [2.0, 1.0, 0.5, 0.4, 0.0, -0.6] {
            let fit = fitted_order(&curve(|k| 3e-7 * k.powf(order))).unwrap();
            assert!((fit.order - order).abs() < 1e-12, "{} for {order}", fit.order);
            assert!((fit.numbers[0] / 1e6 - 1.0).abs() < 1e-9 && fit.numbers[1] == 1e8);
        }
        // Not yet asymptotic, growth k^m + a: the fitted order lies between the local orders m/(1 + a k^−m) at both
        // ends.
        let slope = |k: f64| 0.4 / (1.0 + 50.0 * k.powf(-0.4));
        let fit = fitted_order(&curve(|k| k.powf(0.4) + 50.0)).unwrap();
        assert!((slope(1e6)..slope(1e8)).contains(&fit.order), "{}", fit.order);
    }

    #[test]
    fn without_finite_growth_there_is_no_fitted_order() {
        assert_eq!(fitted_order(&[]), None);
        for last in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let growth = |k: f64| if k > 9.9e7 { last } else { k };
            assert_eq!(fitted_order(&curve(growth)), None, "{last}");
        }
    }

    #[test]
    fn the_greatest_value_is_found_in_thin_layers() {
        let at = 0.7;
        let mut samples: Vec<f64> = (0..60).map(|i| PI * f64::from(i) / 60.0).collect();
        samples.extend(around(at, COARSE_LAYER));
        samples.sort_by(f64::total_cmp);
        for width in [1e-8, 3e-6, 2e-3, 0.05] {
            // A narrow peak at the distance `width` from the degenerate direction, over a broad lower maximum.
            let f = |x: f64| {
                let offset = (x - at) / width;
                0.9 * (x - 2.0).cos().powi(2) + 2.0 * offset / (1.0 + offset * offset)
            };
            let [value, place] = maximise(f, &samples);
            assert!((place - at - width).abs() < 0.5 * width, "{place} at {width}");
            assert!(value >= f(at + width) * (1.0 - 1e-6), "{value}");
        }
        // A maximum next to the end of the period.
        let [value, place] = maximise(|x| (2.0 * (x - 3.13)).cos(), &samples);
        assert!(value > 1.0 - 1e-9 && (place - 3.13).abs() < 1e-4);
    }
}
