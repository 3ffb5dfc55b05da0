//! Growth rates against direction and wave number, and the order fitted to them.

use super::Workspace;
use crate::growth::{Assessment, Verdict};
use crate::search::golden_section;
use models::common::elementary::Elementary;
use std::f64::consts::PI;

/// Samples of the growth rate over directions, two per degree; layers around the degenerate ones are
/// sampled in steps of equal ratio.
const DIRECTIONS: usize = 360;
/// Exponents of ten of the distances from a degenerate direction, degrees: first, step, number.
const LAYER: (f64, f64, usize) = (-9.0, 0.1, 90);

/// Samples per decade of the wave number, and how many decades they reach to both sides of the given
/// one.
const PER_DECADE: i32 = 12;
const DECADES: i32 = 4;
/// How many decades they reach at most to the side of short waves, where the growth is to be seen on
/// its asymptote.
const MOST_DECADES: i32 = 8;
/// The growth is on its asymptote where their ratio differs from one by less than this.
const ON_ASYMPTOTE: f64 = 0.02;
/// Decades at the end of a curve to which an order is fitted.
const FITTED_DECADES: i32 = 2;

/// Directions at every wave number, and distances from a degenerate direction, rad, for the greatest
/// growth rate: it is refined between them.
const COARSE_DIRECTIONS: usize = 60;
const COARSE_LAYER: (f64, f64, usize) = (-10.0, 1.0 / 3.0, 28);
/// Peaks that are refined, and the number of steps.
const PEAKS: usize = 3;
const STEPS: usize = 28;

/// The growth rates of a state at a wave number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtWaveNumber {
    /// The wave number, 1/m.
    pub number: f64,
    /// Greatest Re ς of all roots in the direction of the case, 1/s.
    pub growth_rate: f64,
    /// Supremum of Re ς over all directions, 1/s; infinite where growth is unbounded.
    pub greatest: f64,
    /// Direction of the wave vector in which it is found, rad, in \[0, π).
    pub direction: f64,
}

/// An order of growth in the wave number that was fitted to a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedOrder {
    /// Slope of log Re ς against log k.
    pub order: f64,
    /// The least and the greatest wave number of the fit, 1/m.
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

/// Decades of short waves beyond the given wave number that show the growth of the verdict on its
/// asymptote, as far as can be.
pub fn decades(workspace: &Workspace, assessment: &Assessment, number: f64) -> i32 {
    let Verdict::IllPosed { growth: Some(growth), .. } = assessment.verdict else { return DECADES };
    let directions = directions(assessment);
    let is_seen = |decades: &i32| {
        let k = number * 10f64.powi(decades - FITTED_DECADES);
        let [rate, _] = greatest(|direction| rate(workspace, k, direction), &directions);
        let asymptote = growth.coefficient * k.cr_powf(growth.order.value());
        (rate / asymptote - 1.0).abs() < ON_ASYMPTOTE
    };
    let reached =
        (DECADES..=MOST_DECADES).take_while(|&d| workspace.reaches(number * 10f64.powi(d)));
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
                None => greatest(|direction| rate(workspace, number, direction), &directions),
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

/// Greatest Re ς, 1/s; zero where it is no more than the rounding of the greatest root.
fn rate(workspace: &Workspace, k: f64, direction: f64) -> f64 {
    if !workspace.reaches(k) {
        return f64::NAN;
    }
    let roots = workspace.pencil.polynomial.roots(k, direction, &[]);
    let rate = roots.iter().map(|root| root.re).fold(f64::NAN, f64::max);
    let size = roots.iter().map(|root| root.re.abs()).fold(0.0, f64::max);
    if rate.abs() <= 8.0 * f64::EPSILON * size { 0.0 } else { rate }
}

/// Directions, rad, ascending, that tell the layers around degenerate directions at all wave numbers.
fn directions(assessment: &Assessment) -> Vec<f64> {
    let step = PI / COARSE_DIRECTIONS as f64;
    let mut directions: Vec<f64> = (0..COARSE_DIRECTIONS).map(|i| i as f64 * step).collect();
    for degenerate in &assessment.degenerate {
        directions.extend(around(degenerate.angle, COARSE_LAYER));
    }
    // The verdict's own direction, lest a narrow sector is missed.
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

/// A direction and others on both sides of it at distances of equal ratio.
fn around(centre: f64, (first, step, number): (f64, f64, usize)) -> impl Iterator<Item = f64> {
    let offsets = (0..number).map(move |i| 10f64.cr_powf(first + step * i as f64));
    offsets.flat_map(move |offset| [centre - offset, centre + offset]).chain([centre])
}

/// The greatest value of a function of period π, and where it is taken: the highest of its `samples`
/// (ascending) refined between their neighbours.
fn greatest(f: impl Fn(f64) -> f64, samples: &[f64]) -> [f64; 2] {
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

/// The order m of Re ς ∝ k^m over the last decades of the greatest growth rate; `None` unless there
/// is finite growth all along them.
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
    // Centred and scaled to [−1, 1]: the fit is by monomials as they stand.
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
        // Before the asymptote is reached: d log(k^m + a)/d log k = m/(1 + a k^−m), between its
        // values at both ends.
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
            // A layer beside the direction, over a broad lower hill.
            let f = |x: f64| {
                let offset = (x - at) / width;
                0.9 * (x - 2.0).cos().powi(2) + 2.0 * offset / (1.0 + offset * offset)
            };
            let [value, place] = greatest(f, &samples);
            assert!((place - at - width).abs() < 0.5 * width, "{place} at {width}");
            assert!(value >= f(at + width) * (1.0 - 1e-6), "{value}");
        }
        // Across the ends of the period.
        let [value, place] = greatest(|x| (2.0 * (x - 3.13)).cos(), &samples);
        assert!(value > 1.0 - 1e-9 && (place - 3.13).abs() < 1e-4);
    }
}
