//! Fits to what was measured: polynomials in centred, scaled abscissae.

use num_complex::Complex64;

/// A complex frequency: exp((γ − iω)t).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// ω, rad/s.
    pub frequency: f64,
    /// γ, 1/s.
    pub growth: f64,
}

impl Rate {
    /// The difference to another one.
    pub fn less(self, other: Self) -> Self {
        Self { frequency: self.frequency - other.frequency, growth: self.growth - other.growth }
    }

    /// The greater of both parts, rad/s.
    pub fn size(self) -> f64 {
        self.frequency.abs().max(self.growth.abs())
    }
}

/// A polynomial of that degree through or between points, at `place`; with `slope` its slope there. Not a
/// number where there is none.
fn polynomial(places: &[f64], values: &[f64], degree: usize, place: f64, slope: bool) -> f64 {
    let low = places.iter().copied().fold(f64::INFINITY, f64::min);
    let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    let scaled: Vec<f64> = places.iter().map(|x| (x - centre) / half).collect();
    let Ok(found) = polyfit_rs::polyfit_rs::polyfit(&scaled, values, degree) else {
        return f64::NAN;
    };
    let x = (place - centre) / half;
    // Horner's scheme.
    match slope {
        false => found.iter().rev().fold(0.0, |sum, own| sum * x + own),
        true => {
            let terms = found.iter().enumerate().skip(1).rev();
            terms.fold(0.0, |sum, (power, own)| sum * x + power as f64 * own) / half
        }
    }
}

/// The slope of the line that fits values at places best.
pub fn slope(places: &[f64], values: &[f64]) -> f64 {
    polynomial(places, values, 1, 0.0, true)
}

/// The complex frequency of an amplitude: slopes of its phase and of the logarithm of its modulus. From one
/// time to the next the phase changes by less than half a turn.
pub fn rate(times: &[f64], amplitudes: &[Complex64]) -> Rate {
    let mut phase = 0.0;
    let mut phases = vec![0.0];
    for pair in amplitudes.windows(2) {
        phase += (pair[1] / pair[0]).arg();
        phases.push(phase);
    }
    let logarithms: Vec<f64> = amplitudes.iter().map(|a| a.norm().ln()).collect();
    Rate { frequency: -slope(times, &phases), growth: slope(times, &logarithms) }
}

/// The greatest error of [`rate`] over a time (s) if phase and logarithm are off by at most `error`: the
/// slope of the line that fits ±`error` on both halves.
pub fn error_of_rate(error: f64, duration: f64) -> f64 {
    3.0 * error / duration
}

/// Rates on cells of edges that go like 1/n, n as in `cells`, in the limit of small cells. Of the scheme's
/// errors the even powers of h turn the phase, h² and h⁴, and the odd ones lower the amplitude, h³ above all.
pub fn extrapolated(cells: &[usize], rates: &[Rate]) -> Rate {
    let powers =
        |power: i32| cells.iter().map(|&n| (cells[0] as f64 / n as f64).powi(power)).collect();
    let (squares, cubes): (Vec<f64>, Vec<f64>) = (powers(2), powers(3));
    let of = |part: &dyn Fn(&Rate) -> f64| rates.iter().map(part).collect::<Vec<f64>>();
    let degree = (cells.len() - 1).min(2);
    Rate {
        frequency: polynomial(&squares, &of(&|r| r.frequency), degree, 0.0, false),
        growth: polynomial(&cubes, &of(&|r| r.growth), degree.min(1), 0.0, false),
    }
}

/// The greatest error of [`extrapolated`] if rates on these grids are off by at most `errors`: it is linear.
pub fn error_of_extrapolated(cells: &[usize], errors: &[f64]) -> f64 {
    let sum = |part: fn(&Rate) -> f64| -> f64 {
        (0..cells.len())
            .map(|own| {
                let unit = |index: usize| f64::from(u8::from(index == own));
                let rates: Vec<Rate> = (0..cells.len())
                    .map(|index| Rate { frequency: unit(index), growth: unit(index) })
                    .collect();
                (part(&extrapolated(cells, &rates)) * errors[own]).abs()
            })
            .sum()
    };
    sum(|rate| rate.frequency).max(sum(|rate| rate.growth))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_rates_are_found() {
        let planted = Rate { frequency: 431.0, growth: -2.5 };
        let times: Vec<f64> = (0..40).map(|i| 1e-3 * f64::from(i)).collect();
        let of = |t: &f64| Complex64::new(planted.growth * t, 0.7 - planted.frequency * t).exp();
        let found = rate(&times, &times.iter().map(of).collect::<Vec<_>>());
        assert!(found.less(planted).size() < 1e-11 * planted.frequency, "{found:?}");
    }

    #[test]
    fn powers_of_the_cell_are_taken_away() {
        let cells = [20, 30, 40];
        let rates = cells.map(|n| {
            let h = 1.0 / n as f64;
            Rate { frequency: 7.0 + 3.0 * h * h - 50.0 * h.powi(4), growth: 0.1 - 9.0 * h.powi(3) }
        });
        let found = extrapolated(&cells, &rates);
        assert!(found.less(Rate { frequency: 7.0, growth: 0.1 }).size() < 1e-12, "{found:?}");
        assert!(error_of_extrapolated(&cells, &[1.0; 3]) > 1.0);
    }
}
