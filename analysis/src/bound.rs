//! The supremum of the growth rate over wave numbers and directions, where it is finite.
//!
//! The supremum is located numerically: on a grid in log k and direction, with further points near degenerate
//! directions θ_c in the stretched coordinate asinh(k(θ − θ_c)), then by a simplex search (Nelder & Mead 1965).

use crate::growth::{Assessment, Verdict};
use crate::pencil::Pencil;
use models::common::elementary::Elementary;
use num_complex::Complex64;
use std::cell::RefCell;
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

/// Upper end of the searched wave numbers, in the scaled unit of the system. At larger wave numbers the rounding error
/// of the coefficients, times k², would appear as growth.
const MAX_WAVE_NUMBER: f64 = 1e5;
/// Lower end of the searched wave numbers, in the scaled unit, for a uniform background.
const MIN_WAVE_NUMBER: f64 = 1e-16;
/// Relative difference below which two growth rates are on one plateau over the wave numbers.
const PLATEAU: f64 = 1e-9;
/// Growth rate of the longest waves, in the scaled unit of the system, below which its limit k → 0 is zero.
const ZERO_RATE: f64 = 1e-12;
/// Number of steps of the grid in log k.
const WAVE_NUMBER_STEPS: usize = 96;
/// Number of directions of the grid.
const DIRECTION_COUNT: usize = 48;

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
    // Neighbouring waves have similar roots.
    let nearby_roots = RefCell::new(Vec::new());
    let rate = |log_k: f64, direction: f64| {
        growth_rate_at(pencil, log_k, direction, &mut nearby_roots.borrow_mut())
    };
    // Search coordinates (log k, position): the position is the direction θ, or asinh(k(θ − θ_c)) around a degenerate
    // direction θ_c.
    let mut centres = vec![None];
    centres.extend(assessment.degenerate_directions.iter().map(|d| Some(d.angle)));
    let mut best: Option<(f64, f64, f64)> = None;
    for centre in centres {
        let angle = |log_k: f64, position: f64| match centre {
            None if directions.len() == 1 => directions[0],
            None => position,
            Some(angle) => angle + (position.cr_sinh() / log_k.cr_exp()).clamp(-0.5, 0.5),
        };
        let value = |x: [f64; 2]| {
            let log_k = x[0].clamp(low, high);
            rate(log_k, angle(log_k, x[1]))
        };
        let positions: Vec<f64> = match centre {
            None => directions.to_vec(),
            Some(_) => (-12..=12).map(f64::from).collect(),
        };
        let mut start = (f64::NEG_INFINITY, [low, 0.0]);
        for step in 0..=WAVE_NUMBER_STEPS {
            let log_k = low + (high - low) * step as f64 / WAVE_NUMBER_STEPS as f64;
            for &position in &positions {
                let found = value([log_k, position]);
                if found > start.0 {
                    start = (found, [log_k, position]);
                }
            }
        }
        let (found, [log_k, position]) = maximise_by_simplex(value, start.1, [0.2, 0.05]);
        let log_k = log_k.clamp(low, high);
        if found > f64::NEG_INFINITY && best.is_none_or(|b| found > b.0) {
            best = Some((found, log_k, angle(log_k, position)));
        }
    }
    let (found, log_k, direction) = best?;
    let wave_number = |log_k: f64| unit * log_k.cr_exp();
    let has_equal_rate = |log_k: f64| found - rate(log_k, direction) <= PLATEAU * found.abs();
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
        let certain = pencil.polynomial.growth_rate_beyond_rounding(wave_number(log_k), direction);
        if certain < 0.5 * found {
            growth_rate = certain;
        }
    }
    let is_limit = location == SupremumWaveNumber::LongWaves && min_wave_number == 0.0;
    if is_limit && growth_rate.abs() <= ZERO_RATE * pencil.polynomial.rate_unit {
        growth_rate = 0.0;
    }
    Some(Supremum { growth_rate, wave_number: location, direction: direction.rem_euclid(PI) })
}

/// Largest Re ς, 1/s, at the logarithm of the wave number in the scaled unit and a direction (rad). Starts from the roots
/// `nearby_roots` (1/s), if there is one per root, and replaces them by those found.
fn growth_rate_at(
    pencil: &Pencil,
    log_k: f64,
    direction: f64,
    nearby_roots: &mut Vec<Complex64>,
) -> f64 {
    let wave_number = pencil.polynomial.wave_number_unit * log_k.cr_exp();
    *nearby_roots = pencil.polynomial.roots(wave_number, direction, nearby_roots);
    nearby_roots.iter().map(|root| root.re).fold(f64::NEG_INFINITY, f64::max)
}

/// Largest Re ς, 1/s, in a direction (rad) at `count` wave numbers from the smallest to the largest one of the search.
pub(crate) fn sample_growth(pencil: &Pencil, direction: f64, count: usize) -> f64 {
    let (low, high) = (MIN_WAVE_NUMBER.cr_ln(), MAX_WAVE_NUMBER.cr_ln());
    let log_k = |index: usize| low + (high - low) * (index as f64 + 0.5) / count as f64;
    let mut roots = Vec::new();
    let rates = (0..count).map(|index| growth_rate_at(pencil, log_k(index), direction, &mut roots));
    rates.fold(f64::NEG_INFINITY, f64::max)
}

/// Local maximum near `start` by the simplex method (Nelder & Mead 1965): value and position.
fn maximise_by_simplex(
    f: impl Fn([f64; 2]) -> f64,
    start: [f64; 2],
    step: [f64; 2],
) -> (f64, [f64; 2]) {
    let vertex = |x: [f64; 2]| (f(x), x);
    let mut s = [
        vertex(start),
        vertex([start[0] + step[0], start[1]]),
        vertex([start[0], start[1] + step[1]]),
    ];
    for _ in 0..200 {
        s.sort_by(|a, b| b.0.total_cmp(&a.0));
        let spread = (s[0].1[0] - s[2].1[0]).root_sum_square(s[0].1[1] - s[2].1[1]);
        if spread < 1e-9 {
            break;
        }
        let centre = [0, 1].map(|i| 0.5 * (s[0].1[i] + s[1].1[i]));
        let at = |t: f64| vertex([0, 1].map(|i| centre[i] + t * (s[2].1[i] - centre[i])));
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
