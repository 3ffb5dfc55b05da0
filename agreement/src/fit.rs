//! Least-squares fits of complex frequencies to amplitudes, and their extrapolation to zero cell size.

use models::common::elementary::{Elementary, Modulus, cr_arg};
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::ops::Sub;

/// Complex frequency of an amplitude that evolves as exp((γ − iω)t).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// Frequency ω, rad/s.
    pub frequency: f64,
    /// Growth rate γ, 1/s.
    pub growth_rate: f64,
}

impl Rate {
    /// Maximum norm max(|ω|, |γ|), 1/s.
    pub fn max_norm(self) -> f64 {
        self.frequency.abs().max(self.growth_rate.abs())
    }
}

impl Sub for Rate {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            frequency: self.frequency - other.frequency,
            growth_rate: self.growth_rate - other.growth_rate,
        }
    }
}

/// Slope of the least-squares line through `values` at `abscissae`, which are centred and scaled for the fit; NaN if
/// undefined.
pub fn fit_slope(abscissae: &[f64], values: &[f64]) -> f64 {
    let low = abscissae.iter().copied().fold(f64::INFINITY, f64::min);
    let high = abscissae.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    if half.is_nan() || half <= 0.0 {
        return f64::NAN;
    }
    let scaled: Vec<f64> = abscissae.iter().map(|x| (x - centre) / half).collect();
    polyfit_rs::polyfit_rs::polyfit(&scaled, values, 1).map_or(f64::NAN, |found| found[1] / half)
}

/// Fits the complex frequency of amplitudes at `times` (s): slopes of the phase and of the logarithm of the modulus.
/// The phase must change by less than half a turn between adjacent times.
pub fn fit_rate(times: &[f64], amplitudes: &[Complex64]) -> Rate {
    let mut phase = 0.0;
    let mut phases = vec![0.0];
    for pair in amplitudes.windows(2) {
        phase += cr_arg(pair[1] / pair[0]);
        phases.push(phase);
    }
    // Normalised by the first modulus, so that the logarithms do not depend on the unit.
    let first = amplitudes.first().map_or(1.0, |own| own.modulus());
    let logarithms: Vec<f64> = amplitudes.iter().map(|a| (a.modulus() / first).cr_ln()).collect();
    Rate { frequency: -fit_slope(times, &phases), growth_rate: fit_slope(times, &logarithms) }
}

/// Maximum error of [`fit_rate`] over a `duration` (s), 1/s, for errors of phase and logarithm of the modulus up to
/// `error`: slope of the line fitted to +`error` on one half and −`error` on the other.
pub fn max_rate_error(error: f64, duration: f64) -> f64 {
    3.0 * error / duration
}

/// Exponents of the cell size h in the error expansion of a second-order scheme; with two grids only the first
/// exponent is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ErrorExponents {
    /// Exponents in the error of the frequency.
    pub frequency: &'static [i32],
    /// Exponents in the error of the growth rate.
    pub growth_rate: &'static [i32],
}

impl ErrorExponents {
    /// Time-symmetric step: even exponents in the frequency, odd exponents in the growth rate.
    pub const SYMMETRIC: Self = Self { frequency: &[2, 4], growth_rate: &[3] };

    /// Alternating sweeps: the first and the last sweep, of half length, contribute one error term in h³.
    pub const ALTERNATING: Self = Self { frequency: &[2, 3], growth_rate: &[3] };

    /// Steps that end with a projection Π: for a unit vector y and antisymmetric A, Π exp(Δt A) Π y is shorter than
    /// exp(Δt ΠAΠ) y by ½Δt²|(1 − Π)Ay|² to leading order, so the error of the growth rate begins with a term in h.
    pub const PROJECTED: Self = Self { frequency: &[2, 3], growth_rate: &[1, 2] };
}

/// Weights of the values at h = 1/n, n in `cells`, in their Richardson extrapolation to h → 0 by a least-squares fit
/// of 1, h^p, h^q …, with exponents p, q … in `powers`.
fn extrapolation_weights(cells: &[usize], powers: &[i32]) -> Vec<f64> {
    let powers = &powers[..powers.len().min(cells.len().saturating_sub(1))];
    let edge = |row: usize| cells[0] as f64 / cells[row] as f64;
    let matrix = DMatrix::from_fn(cells.len(), 1 + powers.len(), |row, column| match column {
        0 => 1.0,
        _ => edge(row).powi(powers[column - 1]),
    });
    let (normal, transposed) = (matrix.transpose() * &matrix, matrix.transpose());
    match normal.lu().solve(&transposed) {
        Some(all) => all.row(0).iter().copied().collect(),
        None => vec![f64::NAN; cells.len()],
    }
}

/// Richardson extrapolation of rates to zero cell size h ∝ 1/n, n in `cells`.
pub fn extrapolate(cells: &[usize], rates: &[Rate], powers: ErrorExponents) -> Rate {
    let sum = |powers: &[i32], part: fn(&Rate) -> f64| -> f64 {
        extrapolation_weights(cells, powers)
            .iter()
            .zip(rates)
            .map(|(weight, rate)| weight * part(rate))
            .sum()
    };
    Rate {
        frequency: sum(powers.frequency, |rate| rate.frequency),
        growth_rate: sum(powers.growth_rate, |rate| rate.growth_rate),
    }
}

/// Maximum error of [`extrapolate`], 1/s, for errors of the individual rates up to `errors` (1/s).
pub fn max_extrapolation_error(cells: &[usize], errors: &[f64], powers: ErrorExponents) -> f64 {
    let sum = |powers: &[i32]| -> f64 {
        extrapolation_weights(cells, powers)
            .iter()
            .zip(errors)
            .map(|(own, error)| own.abs() * error)
            .sum()
    };
    sum(powers.frequency).max(sum(powers.growth_rate))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fit_recovers_prescribed_rate() {
        let planted = Rate { frequency: 431.0, growth_rate: -2.5 };
        let times: Vec<f64> = (0..40).map(|i| 1e-3 * f64::from(i)).collect();
        let of =
            |t: &f64| Complex64::new(planted.growth_rate * t, 0.7 - planted.frequency * t).exp();
        let found = fit_rate(&times, &times.iter().map(of).collect::<Vec<_>>());
        assert!((found - planted).max_norm() < 1e-11 * planted.frequency, "{found:?}");
    }

    #[test]
    fn slope_is_nan_for_fewer_than_two_abscissae() {
        for abscissae in [&[2.0, 2.0][..], &[2.0], &[], &[f64::NAN, 1.0]] {
            assert!(fit_slope(abscissae, &vec![1.0; abscissae.len()]).is_nan(), "{abscissae:?}");
        }
    }

    #[test]
    fn extrapolation_removes_error_terms_of_given_exponents() {
        for powers in
            [ErrorExponents::SYMMETRIC, ErrorExponents::ALTERNATING, ErrorExponents::PROJECTED]
        {
            let cells = [20, 30, 40];
            let rates = cells.map(|n| {
                let sum = |factors: [f64; 2], powers: &[i32]| -> f64 {
                    let terms = factors.iter().zip(powers);
                    terms.map(|(factor, power)| factor * (n as f64).powi(-power)).sum()
                };
                Rate {
                    frequency: 7.0 + sum([3.0, -50.0], powers.frequency),
                    growth_rate: 0.1 + sum([-9.0, 20.0], powers.growth_rate),
                }
            });
            let found = extrapolate(&cells, &rates, powers);
            let off = (found - Rate { frequency: 7.0, growth_rate: 0.1 }).max_norm();
            assert!(off < 1e-11, "{powers:?}: {found:?}");
            assert!(max_extrapolation_error(&cells, &[1.0; 3], powers) > 1.0);
        }
    }
}
