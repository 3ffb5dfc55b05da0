//! Exact solutions, and the problems for which simulations with default settings are compared with them.

#![allow(dead_code, reason = "each test and benchmark uses a part")]

pub mod comparison;
pub mod full_plane;
pub mod garvin;
pub mod half_plane;
pub mod half_space;
pub mod interface;
pub mod lamb;
pub mod line_source;
pub mod oblique;
pub mod pekeris;

use num_complex::Complex64;
use std::f64::consts::PI;

/// Ricker function of time, (1 − 2x²) exp(−x²) with x = π·frequency·(t − 1.5/frequency), i.e. the default delay of
/// cases.
#[derive(Clone, Copy, Debug)]
pub struct Ricker {
    /// Peak frequency of the spectrum, Hz.
    pub frequency: f64,
}

impl Ricker {
    /// Derivative of order `derivative_order` (0 to 3), 1/s to this power, at a complex time (s); the function is
    /// entire.
    pub fn derivative_at_complex_time(&self, t: Complex64, derivative_order: usize) -> Complex64 {
        let rate = PI * self.frequency;
        let x = (t - 1.5 / self.frequency) * rate;
        let a = x * x;
        if a.re > 700.0 {
            return Complex64::ZERO;
        }
        let polynomial = match derivative_order {
            0 => 1.0 - 2.0 * a,
            1 => rate * x * (4.0 * a - 6.0),
            2 => rate * rate * (24.0 * a - 6.0 - 8.0 * a * a),
            3 => rate.powi(3) * x * (60.0 - 80.0 * a + 16.0 * a * a),
            _ => unreachable!("derivatives up to the third"),
        };
        polynomial * (-a).exp()
    }

    /// Derivative of order `derivative_order` at a real time (s).
    pub fn derivative_at(&self, t: f64, derivative_order: usize) -> f64 {
        self.derivative_at_complex_time(t.into(), derivative_order).re
    }
}

/// Isotropic elastic solid of a reference problem.
#[derive(Clone, Copy, Debug)]
pub struct IsotropicSolid {
    /// First Lamé modulus, Pa.
    pub lambda: f64,
    /// Shear modulus, Pa.
    pub mu: f64,
    /// Density, kg/m³.
    pub density: f64,
}

/// Solid of all problems (oblique pulses: above the interface): Poisson's ratio ¼.
pub const REFERENCE_SOLID: IsotropicSolid =
    IsotropicSolid { lambda: 8e7, mu: 8e7, density: 2000.0 };

/// Time function of the sources of all reference problems.
pub const RICKER: Ricker = Ricker { frequency: 20.0 };

impl IsotropicSolid {
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
pub struct RelativeError {
    pub l2_error: f64,
    pub max_error: f64,
}

/// Relative error of a record against the exact record.
pub fn compute_relative_error(record: &[f64], exact: &[f64]) -> RelativeError {
    assert_eq!(record.len(), exact.len());
    let difference: Vec<f64> = record.iter().zip(exact).map(|(a, b)| a - b).collect();
    let l2 = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
    let max = |values: &[f64]| values.iter().fold(0f64, |max, v| max.max(v.abs()));
    RelativeError {
        l2_error: l2(&difference) / l2(exact),
        max_error: max(&difference) / max(exact),
    }
}

/// Error of one velocity component at a receiver.
#[derive(Clone, Debug)]
pub struct ComponentError {
    /// Name of receiver and component, e.g. `surface.v2`.
    pub name: String,
    /// Distance of the receiver from the source (oblique pulses: from the interface), in wavelengths of the problem.
    pub distance: f64,
    pub relative_error: RelativeError,
}

/// Reference problem: a simulation with a known exact solution.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceProblem {
    pub name: &'static str,
    pub dimensions: usize,
    /// Runs the problem and returns the errors of all velocity components that are not zero, at all receivers.
    pub compute_errors: fn(&comparison::ReferenceSettings) -> Vec<ComponentError>,
}

/// All reference problems.
pub const REFERENCE_PROBLEMS: [ReferenceProblem; 8] = [
    ReferenceProblem {
        name: "lamb-vertical",
        dimensions: 2,
        compute_errors: |s| lamb::compute_errors(s, true),
    },
    ReferenceProblem {
        name: "lamb-horizontal",
        dimensions: 2,
        compute_errors: |s| lamb::compute_errors(s, false),
    },
    ReferenceProblem { name: "garvin", dimensions: 2, compute_errors: garvin::compute_errors },
    ReferenceProblem {
        name: "inside-force",
        dimensions: 2,
        compute_errors: |s| line_source::compute_errors(s, false),
    },
    ReferenceProblem {
        name: "inside-explosion",
        dimensions: 2,
        compute_errors: |s| line_source::compute_errors(s, true),
    },
    ReferenceProblem {
        name: "oblique-p",
        dimensions: 2,
        compute_errors: |s| oblique::compute_errors(s, interface::BodyWave::P),
    },
    ReferenceProblem {
        name: "oblique-s",
        dimensions: 2,
        compute_errors: |s| oblique::compute_errors(s, interface::BodyWave::S),
    },
    ReferenceProblem { name: "pekeris", dimensions: 3, compute_errors: pekeris::compute_errors },
];
