//! Exact solutions, and the problems for which simulations with default settings are compared with them.

#![allow(dead_code, reason = "each test and benchmark uses a part")]

pub mod full_plane;
pub mod garvin;
pub mod half_plane;
pub mod half_space;
pub mod inside;
pub mod interface;
pub mod lamb;
pub mod oblique;
pub mod pekeris;
pub mod run;

use num_complex::Complex64;
use std::f64::consts::PI;

/// Ricker function of time, (1 − 2x²) exp(−x²) with x = π·frequency·(t − 1.5/frequency), i.e. the default delay of
/// cases.
#[derive(Clone, Copy, Debug)]
pub struct Ricker {
    /// Peak frequency, Hz.
    pub frequency: f64,
}

impl Ricker {
    /// Derivative of order `derivative` (0 to 3), 1/s^derivative, at a complex time (s); the function is entire.
    pub fn value(&self, t: Complex64, derivative: usize) -> Complex64 {
        let rate = PI * self.frequency;
        let x = (t - 1.5 / self.frequency) * rate;
        let a = x * x;
        if a.re > 700.0 {
            return Complex64::ZERO;
        }
        let polynomial = match derivative {
            0 => 1.0 - 2.0 * a,
            1 => rate * x * (4.0 * a - 6.0),
            2 => rate * rate * (24.0 * a - 6.0 - 8.0 * a * a),
            3 => rate.powi(3) * x * (60.0 - 80.0 * a + 16.0 * a * a),
            _ => unreachable!("derivatives up to the third"),
        };
        polynomial * (-a).exp()
    }

    /// Derivative of order `derivative` at a real time (s).
    pub fn real(&self, t: f64, derivative: usize) -> f64 {
        self.value(t.into(), derivative).re
    }

    /// Time, s, after which the value is below 10⁻⁶ of the peak.
    pub fn end(&self) -> f64 {
        1.5 / self.frequency + 1.35 / self.frequency
    }
}

/// Isotropic elastic solid.
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    /// First Lamé modulus, Pa.
    pub lambda: f64,
    /// Shear modulus, Pa.
    pub mu: f64,
    /// Density, kg/m³.
    pub density: f64,
}

/// Solid of all problems: Poisson's ratio ¼.
pub const SOLID: Solid = Solid { lambda: 8e7, mu: 8e7, density: 2000.0 };

/// Time function of all sources.
pub const RICKER: Ricker = Ricker { frequency: 20.0 };

impl Solid {
    /// Speed of pressure waves, m/s.
    pub fn pressure_speed(&self) -> f64 {
        ((self.lambda + 2.0 * self.mu) / self.density).sqrt()
    }

    /// Speed of shear waves, m/s.
    pub fn shear_speed(&self) -> f64 {
        (self.mu / self.density).sqrt()
    }

    /// Rayleigh speed c, m/s: root of (2 − c²/c_s²)² = 4√(1 − c²/c_p²)√(1 − c²/c_s²), by bisection.
    pub fn rayleigh_speed(&self) -> f64 {
        let [p, s] = [self.pressure_speed(), self.shear_speed()];
        let value = |c: f64| {
            let [p, s] = [p, s].map(|speed| 1.0 - (c / speed).powi(2));
            (1.0 + s).powi(2) - 4.0 * (p * s).sqrt()
        };
        let [mut below, mut above] = [0.5 * s, s];
        for _ in 0..60 {
            let middle = 0.5 * (below + above);
            if value(middle) < 0.0 { below = middle } else { above = middle }
        }
        below
    }
}

/// Error of a record relative to the exact record, in the L2 norm and in the maximum norm.
#[derive(Clone, Copy, Debug)]
pub struct Error {
    pub l2: f64,
    pub max: f64,
}

/// Relative error of a record against the exact record.
pub fn error(record: &[f64], exact: &[f64]) -> Error {
    assert_eq!(record.len(), exact.len());
    let difference: Vec<f64> = record.iter().zip(exact).map(|(a, b)| a - b).collect();
    let l2 = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
    let max = |values: &[f64]| values.iter().fold(0f64, |max, v| max.max(v.abs()));
    Error { l2: l2(&difference) / l2(exact), max: max(&difference) / max(exact) }
}

/// Error of one velocity component at a receiver.
#[derive(Clone, Debug)]
pub struct Row {
    /// Name of receiver and component, e.g. `surface.v2`.
    pub name: String,
    /// Distance from the source, in wavelengths.
    pub distance: f64,
    pub error: Error,
}

/// Problem with an exact solution.
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    pub name: &'static str,
    pub dimensions: usize,
    /// Runs the problem and returns the errors of all components.
    pub rows: fn(&run::Settings) -> Vec<Row>,
}

/// All problems.
pub const PROBLEMS: [Problem; 8] = [
    Problem { name: "lamb-vertical", dimensions: 2, rows: |s| lamb::rows(s, true) },
    Problem { name: "lamb-horizontal", dimensions: 2, rows: |s| lamb::rows(s, false) },
    Problem { name: "garvin", dimensions: 2, rows: garvin::rows },
    Problem { name: "inside-force", dimensions: 2, rows: |s| inside::rows(s, false) },
    Problem { name: "inside-explosion", dimensions: 2, rows: |s| inside::rows(s, true) },
    Problem { name: "oblique-p", dimensions: 2, rows: |s| oblique::rows(s, interface::Wave::P) },
    Problem { name: "oblique-s", dimensions: 2, rows: |s| oblique::rows(s, interface::Wave::S) },
    Problem { name: "pekeris", dimensions: 3, rows: pekeris::rows },
];
