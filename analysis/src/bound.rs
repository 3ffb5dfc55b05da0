//! The supremum of the growth rate over wave numbers and directions, where it is finite.
//!
//! The supremum is located numerically: on a grid in log k and direction, with further points near degenerate
//! directions θ_c in the stretched coordinate asinh(k(θ − θ_c)), then by simplex searches (Nelder & Mead 1965) from the largest
//! local maxima over the wave numbers of the grid.

use crate::direction_polynomial::DirectionPolynomial;
use crate::growth::{Assessment, Verdict};
use crate::list::StackList;
use crate::pencil::Pencil;
use models::common::elementary::Elementary;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Finite supremum of the growth rate over wave vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supremum {
    /// Supremum S of Re ς, 1/s.
    pub growth_rate: f64,
    /// Wave number at which the supremum is attained or approached.
    pub wave_number: SupremumWaveNumber,
    /// Direction of the wave vector at which the supremum is attained or approached, rad, in [0, π).
    pub direction: f64,
}

/// Wave number at which a supremum is attained or approached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SupremumWaveNumber {
    /// Attained at this wave number, 1/m.
    Attained(f64),
    /// Approached by the longest waves of the range.
    LongWaves,
    /// Approached as k → ∞.
    ShortWaves,
}

/// Relative tolerance to which the supremum is located.
pub const SUPREMUM_TOLERANCE: f64 = 1e-5;

/// Relative difference of the values of a small simplex at which its search ends.
const VALUE_SPREAD: f64 = 1e-6 * SUPREMUM_TOLERANCE;

/// Upper end of the searched wave numbers, in the scaled unit of the system. At larger wave numbers the rounding error
/// of the coefficients, times k², would appear as growth.
const MAX_WAVE_NUMBER: f64 = 1e5;
/// Lower end of the searched wave numbers, in the scaled unit, for a uniform background.
const MIN_WAVE_NUMBER: f64 = 1e-16;
/// Relative difference below which two growth rates are on one plateau over the wave numbers.
const PLATEAU: f64 = 1e-9;
/// Growth rate of the longest waves, in the scaled unit of the system, below which its limit k → 0 is zero.
const ZERO_RATE: f64 = 1e-12;
/// Largest step of the grid in log k.
const WAVE_NUMBER_STEP: f64 = 0.5;
/// The same for long waves, below [`LONG_WAVE`]: there the roots follow powers of k.
const LONG_WAVE_STEP: f64 = 2.0;
/// Wave number in the scaled unit below which waves are long.
const LONG_WAVE: f64 = 1e-4;
/// Number of directions of the grid.
const DIRECTION_COUNT: usize = 48;
/// Largest number of local maxima on the grid from which a maximum is searched.
const MAX_STARTS: usize = 4;
/// Least ratio of the growth rate at the nearest wave number of the grid to that of the peak 4x²/(1 + x²)² in x = k/k₀: 0.42
/// half a step of [`LONG_WAVE_STEP`] away.
const LEAST_SAMPLE: f64 = 0.4;
/// Largest distance from a degenerate direction at which its layer is searched, rad: the grid of directions covers the rest.
const MAX_LAYER_OFFSET: f64 = 0.5;

/// Locates the supremum of Re ς over all directions and k ≥ `min_wave_number` (1/m; 0 for a uniform background) of a
/// well-posed system. `None` for other verdicts, without dispersion roots, or if `min_wave_number` exceeds the range of
/// the search.
pub fn locate_supremum(
    pencil: &Pencil,
    assessment: &Assessment,
    min_wave_number: f64,
) -> Option<Supremum> {
    let directions: Vec<f64> =
        (0..DIRECTION_COUNT).map(|i| PI * i as f64 / DIRECTION_COUNT as f64).collect();
    search_supremum(pencil, assessment, min_wave_number, &directions)
}

/// Locates the supremum of Re ς over all k ≥ `min_wave_number` of waves along x₁; otherwise as [`locate_supremum`].
pub fn locate_supremum_on_line(
    pencil: &Pencil,
    assessment: &Assessment,
    min_wave_number: f64,
) -> Option<Supremum> {
    search_supremum(pencil, assessment, min_wave_number, &[0.0])
}

/// Locates the supremum, starting from `directions`; from a single one the direction is not varied.
fn search_supremum(
    pencil: &Pencil,
    assessment: &Assessment,
    min_wave_number: f64,
    directions: &[f64],
) -> Option<Supremum> {
    if assessment.verdict != Verdict::WellPosed {
        return None;
    }
    let unit = pencil.polynomial.wave_number_unit;
    let (low, high) =
        ((min_wave_number / unit).max(MIN_WAVE_NUMBER).cr_ln(), MAX_WAVE_NUMBER.cr_ln());
    if low >= high {
        return None;
    }
    let polynomial = &pencil.polynomial;
    let wave_number = |log_k: f64| unit * log_k.cr_exp();
    let mut log_k_grid = uniform_steps(low, LONG_WAVE.cr_ln().max(low), LONG_WAVE_STEP);
    log_k_grid.extend(uniform_steps(LONG_WAVE.cr_ln().max(low), high, WAVE_NUMBER_STEP));
    log_k_grid.push(high);
    // Search coordinates (log k, position): the position is the direction θ, or asinh(k(θ − θ_c)) around a degenerate
    // direction θ_c.
    let mut centres = vec![None];
    centres.extend(assessment.degenerate_directions.iter().map(|d| Some(d.angle)));
    let mut best: Option<(f64, f64, f64)> = None;
    for centre in centres {
        let angle = |log_k: f64, position: f64| match centre {
            None if directions.len() == 1 => directions[0],
            None => position,
            Some(angle) => {
                let offset = position.cr_sinh() / log_k.cr_exp();
                angle + offset.clamp(-MAX_LAYER_OFFSET, MAX_LAYER_OFFSET)
            }
        };
        // By wave number, the largest growth rate over the positions: value, log k and position.
        let mut profile: Vec<(f64, [f64; 2])> =
            log_k_grid.iter().map(|&log_k| (f64::NEG_INFINITY, [log_k, 0.0])).collect();
        match centre {
            None => {
                for &direction in directions {
                    let along = polynomial.along(direction);
                    let mut roots = ContinuedRoots::default();
                    for (greatest, [log_k, position]) in &mut profile {
                        let found = roots.continue_to(&along, wave_number(*log_k));
                        if found > *greatest {
                            (*greatest, *position) = (found, direction);
                        }
                    }
                }
            }
            Some(_) => {
                // Neighbouring waves have similar roots.
                let mut roots = StackList::new();
                for (greatest, [log_k, best_position]) in &mut profile {
                    let log_k = *log_k;
                    let is_within = |position: &f64| {
                        position.cr_sinh().abs() <= MAX_LAYER_OFFSET * log_k.cr_exp()
                    };
                    for position in (-12..=12).map(f64::from).filter(is_within) {
                        let along = polynomial.along(angle(log_k, position));
                        roots = along.scaled_roots(wave_number(log_k), &roots);
                        let found = along.largest_real_part(&roots);
                        if found > *greatest {
                            (*greatest, *best_position) = (found, position);
                        }
                    }
                }
            }
        }
        let mut roots = StackList::new();
        let mut value = |x: [f64; 2]| {
            let log_k = x[0].clamp(low, high);
            let along = polynomial.along(angle(log_k, x[1]));
            roots = along.scaled_roots(wave_number(log_k), &roots);
            along.largest_real_part(&roots)
        };
        for start in starting_points(&profile) {
            let (found, [log_k, position]) = maximise_by_simplex(&mut value, start, [0.2, 0.05]);
            let log_k = log_k.clamp(low, high);
            if found > f64::NEG_INFINITY && best.is_none_or(|b| found > b.0) {
                best = Some((found, log_k, angle(log_k, position)));
            }
        }
    }
    let (found, log_k, direction) = best?;
    let along = polynomial.along(direction);
    let has_equal_rate =
        |log_k: f64| found - along.growth_rate(wave_number(log_k)) <= PLATEAU * found.abs();
    let location = if log_k <= low + 0.1 || has_equal_rate(low) {
        SupremumWaveNumber::LongWaves
    } else if log_k >= high - 0.7 || has_equal_rate(high) {
        SupremumWaveNumber::ShortWaves
    } else {
        SupremumWaveNumber::Attained(wave_number(log_k))
    };
    let mut growth_rate = found;
    if found > 0.0 {
        // Neutral roots have real parts of the size of the rounding errors.
        let certain = along.growth_rate_beyond_rounding(wave_number(log_k));
        if certain < 0.5 * found {
            growth_rate = certain;
        }
    }
    let is_limit = location == SupremumWaveNumber::LongWaves && min_wave_number == 0.0;
    if is_limit && growth_rate.abs() <= ZERO_RATE * polynomial.rate_unit {
        growth_rate = 0.0;
    }
    Some(Supremum { growth_rate, wave_number: location, direction: direction.rem_euclid(PI) })
}

/// Positions of the largest local maxima of a profile of values at ascending wave numbers, the largest first: between two
/// wave numbers any of them may belong to the largest peak.
fn starting_points(profile: &[(f64, [f64; 2])]) -> StackList<[f64; 2]> {
    let value = |index: Option<usize>| {
        index.and_then(|index| profile.get(index)).map_or(f64::NEG_INFINITY, |own| own.0)
    };
    let greatest = profile.iter().map(|own| own.0).fold(f64::NEG_INFINITY, f64::max);
    let limit = if greatest > 0.0 { LEAST_SAMPLE * greatest } else { greatest };
    let mut peaks: Vec<(f64, [f64; 2])> = (0..profile.len())
        .filter(|&index| {
            let own = profile[index].0;
            own > value(index.checked_sub(1)) && own >= value(Some(index + 1)) && own >= limit
        })
        .map(|index| profile[index])
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    peaks.into_iter().take(MAX_STARTS).map(|own| own.1).collect()
}

/// Divides the interval from `low` to `high` into steps of equal length, at most `step`; returns their lower ends.
fn uniform_steps(low: f64, high: f64, step: f64) -> Vec<f64> {
    let count = ((high - low) / step).ceil() as usize;
    (0..count).map(|index| low + (high - low) * index as f64 / count as f64).collect()
}

/// Roots at ascending wave numbers of constant ratio along a direction: where they follow powers of k, the last two of each
/// give the next one.
#[derive(Default)]
struct ContinuedRoots {
    last: StackList<Complex64>,
    before_last: StackList<Complex64>,
}

impl ContinuedRoots {
    /// Computes the roots at the next wave number `k` (1/m); returns the largest Re ς, 1/s.
    fn continue_to(&mut self, along: &DirectionPolynomial, k: f64) -> f64 {
        let guesses: StackList<Complex64> = match self.before_last.len() == self.last.len() {
            true => self.last.iter().zip(&self.before_last).map(|(a, b)| a * (a / b)).collect(),
            false => self.last.clone(),
        };
        let roots = along.scaled_roots(k, &guesses);
        self.before_last = std::mem::replace(&mut self.last, roots);
        along.largest_real_part(&self.last)
    }
}

/// Largest Re ς, 1/s, in a direction (rad) at `count` wave numbers from the smallest to the largest one of the search.
pub(crate) fn sample_growth(pencil: &Pencil, direction: f64, count: usize) -> f64 {
    let (low, high) = (MIN_WAVE_NUMBER.cr_ln(), MAX_WAVE_NUMBER.cr_ln());
    let log_k = |index: usize| low + (high - low) * (index as f64 + 0.5) / count as f64;
    let along = pencil.polynomial.along(direction);
    let mut roots = ContinuedRoots::default();
    let wave_number = |index: usize| pencil.polynomial.wave_number_unit * log_k(index).cr_exp();
    let rates = (0..count).map(|index| roots.continue_to(&along, wave_number(index)));
    rates.fold(f64::NEG_INFINITY, f64::max)
}

/// Local maximum near `start` by the simplex method (Nelder & Mead 1965): value and position.
fn maximise_by_simplex(
    mut f: impl FnMut([f64; 2]) -> f64,
    start: [f64; 2],
    step: [f64; 2],
) -> (f64, [f64; 2]) {
    let mut vertex = |x: [f64; 2]| (f(x), x);
    let mut s = [
        vertex(start),
        vertex([start[0] + step[0], start[1]]),
        vertex([start[0], start[1] + step[1]]),
    ];
    for _ in 0..200 {
        s.sort_by(|a, b| b.0.total_cmp(&a.0));
        let spread = (s[0].1[0] - s[2].1[0]).root_sum_square(s[0].1[1] - s[2].1[1]);
        // Next to a maximum values differ by the square of the distance: this difference, far below the tolerance of the
        // supremum, also bounds the distance of the maximum.
        let is_flat = s[0].0 - s[2].0 <= VALUE_SPREAD * s[0].0.abs();
        if spread < 1e-9 || spread < 1e-3 && is_flat {
            break;
        }
        let centre = [0, 1].map(|i| 0.5 * (s[0].1[i] + s[1].1[i]));
        let mut at = |t: f64| vertex([0, 1].map(|i| centre[i] + t * (s[2].1[i] - centre[i])));
        let reflected = at(-1.0);
        s[2] = if reflected.0 > s[0].0 {
            let expanded = at(-2.0);
            if expanded.0 > reflected.0 { expanded } else { reflected }
        } else if reflected.0 > s[1].0 {
            reflected
        } else {
            let inner = at(if reflected.0 > s[2].0 { -0.5 } else { 0.5 });
            if inner.0 > s[2].0 {
                inner
            } else {
                let best = s[0].1;
                s[1] = vertex([0, 1].map(|i| 0.5 * (best[i] + s[1].1[i])));
                vertex([0, 1].map(|i| 0.5 * (best[i] + s[2].1[i])))
            }
        };
    }
    s.into_iter().fold((f64::NEG_INFINITY, start), |a, b| if b.0 > a.0 { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simplex_search_converges_along_a_curved_ridge() {
        let f = |[x, y]: [f64; 2]| 3.0 - (x - 1.0).powi(2) - 40.0 * (y - x * x).powi(2);
        let (value, at) = maximise_by_simplex(f, [-0.5, 0.4], [0.2, 0.2]);
        assert!((value - 3.0).abs() < 1e-10 && (at[0] - 1.0).abs() < 1e-4, "{value} at {at:?}");
    }
}
