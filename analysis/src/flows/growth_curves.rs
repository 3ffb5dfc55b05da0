//! Growth rates against direction and wave number, and the order fitted to them.

use super::FlowWorkspace;
use crate::growth::{Assessment, Verdict};
use crate::line_search::search_golden_section;
use models::common::elementary::Elementary;
use std::f64::consts::PI;

/// Number of intervals between the directions of a growth curve, two per degree; layers around degenerate directions
/// are sampled geometrically in addition.
const DIRECTION_INTERVALS: usize = 360;
/// Geometric samples in a layer: decimal exponents of the distance (degrees) from a degenerate direction, as first
/// exponent, step, count.
const LAYER_SAMPLES: (f64, f64, usize) = (-9.0, 0.1, 90);

/// Number of samples per decade of the wave number.
const SAMPLES_PER_DECADE: i32 = 12;
/// Number of times that the steps next to points where a growth curve turns are halved.
const REFINEMENTS: usize = 2;
/// Difference of the orders of growth on both sides of a point above which a growth curve turns there.
const MAX_TURN: f64 = 0.03;
/// Number of decades below the given wave number, and smallest number above it.
const DECADES_PER_SIDE: i32 = 4;
/// Maximum number of decades towards short waves, extended until the growth reaches its asymptote.
const MAX_DECADES: i32 = 8;
/// Relative difference from the asymptote below which growth counts as asymptotic.
const ASYMPTOTE_TOLERANCE: f64 = 0.02;
/// Decades at the end of a curve to which an order is fitted.
const FITTED_DECADES: i32 = 2;

/// Number of uniform directions at every wave number in the search for the largest growth rate.
const COARSE_DIRECTIONS: usize = 60;
/// Geometric samples in a layer in this search, as [`LAYER_SAMPLES`] but with distances in rad.
const COARSE_LAYER_SAMPLES: (f64, f64, usize) = (-10.0, 1.0 / 3.0, 28);
/// Number of peaks of the growth rate over the direction that are refined.
const REFINED_PEAKS: usize = 3;
/// Number of golden-section steps of a refinement.
const GOLDEN_SECTION_STEPS: usize = 28;

/// Growth rates of a state at one wave number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthPoint {
    /// Wave number k, 1/m.
    pub wave_number: f64,
    /// Largest Re ς over the roots in the given direction of the wave vector, 1/s; NaN without finite roots or outside
    /// the range of wave numbers.
    pub growth_rate: f64,
    /// Supremum of Re ς over all directions, 1/s; infinite where growth is unbounded, NaN outside the range of wave
    /// numbers.
    pub max_growth_rate: f64,
    /// Direction of the wave vector of the supremum, rad, in \[0, π).
    pub max_growth_direction: f64,
}

/// Order of growth in the wave number, fitted to a growth curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedOrder {
    /// Slope of log Re ς against log k.
    pub order: f64,
    /// Smallest and largest wave number of the fit, 1/m.
    pub wave_numbers: [f64; 2],
}

/// Growth rates at a wave number against the direction from 0° to 180°: (degrees, 1/s).
pub fn growth_by_direction(
    workspace: &FlowWorkspace,
    assessment: &Assessment,
    wave_number: f64,
) -> Vec<[f64; 2]> {
    let step = 180.0 / DIRECTION_INTERVALS as f64;
    let mut degrees: Vec<f64> = (0..=DIRECTION_INTERVALS).map(|i| i as f64 * step).collect();
    for centre in assessment.degenerate_directions.iter().map(|d| d.angle.to_degrees()) {
        degrees.extend(geometric_samples(centre, LAYER_SAMPLES));
    }
    degrees.retain(|d| (0.0..=180.0).contains(d));
    degrees.sort_by(f64::total_cmp);
    degrees.into_iter().map(|d| [d, workspace.growth_rate(wave_number, d.to_radians())]).collect()
}

/// Number of decades beyond the given wave number, from 4 to 8, after which the last two decades of the growth curve
/// follow the asymptote of the verdict; the largest number in range if they never do, 4 if the verdict has no
/// asymptote.
pub fn decades_to_asymptote(
    workspace: &FlowWorkspace,
    assessment: &Assessment,
    wave_number: f64,
) -> i32 {
    let Verdict::IllPosed { growth: Some(growth), .. } = assessment.verdict else {
        return DECADES_PER_SIDE;
    };
    let directions = sample_directions(assessment);
    let is_asymptotic = |decades: &i32| {
        let k = wave_number * 10f64.powi(decades - FITTED_DECADES);
        let [rate, _] = maximise(|direction| growth_rate(workspace, k, direction), &directions);
        let asymptote = growth.coefficient * k.cr_powf(growth.order.to_f64());
        (rate / asymptote - 1.0).abs() < ASYMPTOTE_TOLERANCE
    };
    let reached = (DECADES_PER_SIDE..=MAX_DECADES)
        .take_while(|&d| workspace.is_in_range(wave_number * 10f64.powi(d)));
    let decades: Vec<i32> = reached.collect();
    let first_asymptotic = decades.iter().find(|d| is_asymptotic(d)).or(decades.last());
    first_asymptotic.copied().unwrap_or(DECADES_PER_SIDE)
}

/// Growth rates against the wave number, from four decades below `wave_number` (1/m) to `decades` decades above it; the
/// `direction` (rad) is that of [`GrowthPoint::growth_rate`].
pub fn growth_by_wave_number(
    workspace: &FlowWorkspace,
    assessment: &Assessment,
    wave_number: f64,
    direction: f64,
    decades: i32,
) -> Vec<GrowthPoint> {
    let directions = sample_directions(assessment);
    let unbounded = match assessment.verdict {
        Verdict::IllPosed { growth: None, direction } => Some(direction),
        _ => None,
    };
    let sample = |exponent: f64| {
        let wave_number = wave_number * 10f64.cr_powf(exponent);
        let [max_growth_rate, worst] = match unbounded {
            Some(direction) => [f64::INFINITY, direction],
            None => {
                maximise(|direction| growth_rate(workspace, wave_number, direction), &directions)
            }
        };
        GrowthPoint {
            wave_number,
            growth_rate: workspace.growth_rate(wave_number, direction),
            max_growth_rate,
            max_growth_direction: worst,
        }
    };
    let steps = -DECADES_PER_SIDE * SAMPLES_PER_DECADE..=decades * SAMPLES_PER_DECADE;
    let exponents = steps.map(|step| f64::from(step) / f64::from(SAMPLES_PER_DECADE));
    let mut curve: Vec<(f64, GrowthPoint)> = exponents.map(|at| (at, sample(at))).collect();
    for _ in 0..REFINEMENTS {
        let is_bent: Vec<bool> = (0..curve.len()).map(|index| is_bent(&curve, index)).collect();
        let mut refined = Vec::with_capacity(curve.len());
        for (index, point) in curve.iter().enumerate() {
            if index > 0 && (is_bent[index - 1] || is_bent[index]) {
                let middle = 0.5 * (curve[index - 1].0 + point.0);
                refined.push((middle, sample(middle)));
            }
            refined.push(*point);
        }
        curve = refined;
    }
    curve.into_iter().map(|(_, point)| point).collect()
}

/// Returns whether a curve turns at a point: whether the orders of growth, or of decay, before and after it differ by
/// more than [`MAX_TURN`], or the sign changes on one side.
fn is_bent(curve: &[(f64, GrowthPoint)], index: usize) -> bool {
    if index == 0 || index + 1 == curve.len() {
        return false;
    }
    let order = |from: usize| {
        let [(x0, a), (x1, b)] = [curve[from], curve[from + 1]];
        let [a, b] = [a.max_growth_rate, b.max_growth_rate];
        let ratio = b / a;
        if ratio <= 0.0 { f64::INFINITY } else { ratio.cr_log10() / (x1 - x0) }
    };
    (order(index) - order(index - 1)).abs() > MAX_TURN
}

/// Largest Re ς, 1/s; zero if it is below the rounding of the largest |Re ς|, NaN outside the range of wave numbers.
fn growth_rate(workspace: &FlowWorkspace, k: f64, direction: f64) -> f64 {
    if !workspace.is_in_range(k) {
        return f64::NAN;
    }
    let roots = workspace.pencil.polynomial.roots(k, direction, &[]);
    let rate = roots.iter().map(|root| root.re).fold(f64::NAN, f64::max);
    let size = roots.iter().map(|root| root.re.abs()).fold(0.0, f64::max);
    if rate.abs() <= 8.0 * f64::EPSILON * size { 0.0 } else { rate }
}

/// Sample directions, rad, ascending, dense enough in the layers around degenerate directions at all wave numbers.
fn sample_directions(assessment: &Assessment) -> Vec<f64> {
    let step = PI / COARSE_DIRECTIONS as f64;
    let mut directions: Vec<f64> = (0..COARSE_DIRECTIONS).map(|i| i as f64 * step).collect();
    for degenerate in &assessment.degenerate_directions {
        directions.extend(geometric_samples(degenerate.angle, COARSE_LAYER_SAMPLES));
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
fn geometric_samples(
    centre: f64,
    (first, step, count): (f64, f64, usize),
) -> impl Iterator<Item = f64> {
    let offsets = (0..count).map(move |i| 10f64.cr_powf(first + step * i as f64));
    offsets.flat_map(move |offset| [centre - offset, centre + offset]).chain([centre])
}

/// Maximum and its position, in [0, π), of a function of period π: the three highest peaks at the ascending `samples`,
/// refined by golden sections between their neighbours.
fn maximise(f: impl Fn(f64) -> f64, samples: &[f64]) -> [f64; 2] {
    let values: Vec<f64> = samples.iter().map(|&x| f(x)).collect();
    let count = samples.len();
    let is_peak = |&i: &usize| {
        let [before, after] = [values[(i + count - 1) % count], values[(i + 1) % count]];
        values[i] >= before && values[i] >= after
    };
    let mut peaks: Vec<usize> = (0..count).filter(is_peak).collect();
    peaks.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    peaks.truncate(REFINED_PEAKS);
    let refined = peaks.into_iter().flat_map(|i| {
        let before = if i == 0 { samples[count - 1] - PI } else { samples[i - 1] };
        let after = if i + 1 == count { samples[0] + PI } else { samples[i + 1] };
        [
            [values[i], samples[i]],
            search_golden_section(&f, [before, after], GOLDEN_SECTION_STEPS, None).best_point(),
        ]
    });
    let [value, place] = refined.fold([f64::NAN, 0.0], |best: [f64; 2], found| {
        if found[0] > best[0] || best[0].is_nan() { found } else { best }
    });
    [value, place.rem_euclid(PI)]
}

/// Fits the order m of Re ς ∝ k^m to the last two decades of the largest growth rate; `None` unless there are at least
/// two samples, all finite and positive.
pub fn fit_order(curve: &[GrowthPoint]) -> Option<FittedOrder> {
    let last = curve.last()?.wave_number;
    let first = last / 10f64.powi(FITTED_DECADES) * (1.0 - 1e-9);
    let fitted: Vec<&GrowthPoint> = curve.iter().filter(|at| at.wave_number >= first).collect();
    if !fitted.iter().all(|at| at.max_growth_rate > 0.0 && at.max_growth_rate.is_finite()) {
        return None;
    }
    let wave_numbers = [fitted.first()?.wave_number, last];
    let logarithms = |f: fn(&GrowthPoint) -> f64| -> Vec<f64> {
        fitted.iter().map(|at| f(at).cr_log10()).collect()
    };
    let mut abscissae = logarithms(|at| at.wave_number);
    let ordinates = logarithms(|at| at.max_growth_rate);
    // Centre and scale the abscissae to [−1, 1]: `polyfit` fits unscaled monomials.
    let [low, high] = wave_numbers.map(Elementary::cr_log10);
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    if half <= 0.0 {
        return None;
    }
    for x in &mut abscissae {
        *x = (*x - centre) / half;
    }
    let line = polyfit_rs::polyfit_rs::polyfit(&abscissae, &ordinates, 1).ok()?;
    Some(FittedOrder { order: line.get(1)? / half, wave_numbers })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn growth_curve(growth: impl Fn(f64) -> f64) -> Vec<GrowthPoint> {
        let at = |step: i32| {
            let wave_number = 10f64.powf(f64::from(step) / 12.0);
            let max_growth_rate = growth(wave_number);
            GrowthPoint {
                wave_number,
                growth_rate: f64::NAN,
                max_growth_rate,
                max_growth_direction: 0.0,
            }
        };
        (-12..=96).map(at).collect()
    }

    #[test]
    fn orders_of_power_laws_are_recovered() {
        for order in [2.0, 1.0, 0.5, 0.4, 0.0, -0.6] {
            let fit = fit_order(&growth_curve(|k| 3e-7 * k.powf(order))).unwrap();
            assert!((fit.order - order).abs() < 1e-12, "{} for {order}", fit.order);
            assert!((fit.wave_numbers[0] / 1e6 - 1.0).abs() < 1e-9 && fit.wave_numbers[1] == 1e8);
        }
        // Not yet asymptotic, growth k^m + a: the fitted order lies between the local orders m/(1 + a k^−m) at both
        // ends.
        let slope = |k: f64| 0.4 / (1.0 + 50.0 * k.powf(-0.4));
        let fit = fit_order(&growth_curve(|k| k.powf(0.4) + 50.0)).unwrap();
        assert!((slope(1e6)..slope(1e8)).contains(&fit.order), "{}", fit.order);
    }

    /// A curve is refined where growth turns into decay and where decay turns, as where growth turns.
    #[test]
    fn curves_turn_at_changes_of_sign() {
        let rates = [1.0, 0.5, -0.5, -1.0, -1.0, -1.0, 0.0, 0.0, 0.0, f64::NAN, 1.0];
        let point = |(index, max_growth_rate): (usize, f64)| {
            let wave_number = index as f64;
            let growth_rate = max_growth_rate;
            (
                wave_number,
                GrowthPoint {
                    wave_number,
                    growth_rate,
                    max_growth_rate,
                    max_growth_direction: 0.0,
                },
            )
        };
        let curve: Vec<(f64, GrowthPoint)> = rates.into_iter().enumerate().map(point).collect();
        let bent: Vec<usize> = (0..curve.len()).filter(|index| is_bent(&curve, *index)).collect();
        assert_eq!(bent, [1, 2, 3, 5]);
    }

    #[test]
    fn without_finite_growth_there_is_no_fitted_order() {
        assert_eq!(fit_order(&[]), None);
        for last in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let growth = |k: f64| if k > 9.9e7 { last } else { k };
            assert_eq!(fit_order(&growth_curve(growth)), None, "{last}");
        }
    }

    #[test]
    fn maximum_is_located_in_thin_layers() {
        let at = 0.7;
        let mut samples: Vec<f64> = (0..60).map(|i| PI * f64::from(i) / 60.0).collect();
        samples.extend(geometric_samples(at, COARSE_LAYER_SAMPLES));
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
