//! Exact solutions against which runs are measured.

use num_complex::Complex64;
use std::f64::consts::PI;

/// Ricker function of time with its peak at 1.5/frequency: the default delay of cases.
#[derive(Clone, Copy, Debug)]
pub struct Ricker {
    /// Peak frequency, Hz.
    pub frequency: f64,
}

impl Ricker {
    /// Its `derivative`-th derivative (0 or 1), 1/s^derivative, at a complex time (s): it is entire.
    pub fn value(&self, t: Complex64, derivative: usize) -> Complex64 {
        let rate = PI * self.frequency;
        let x = (t - 1.5 / self.frequency) * rate;
        let a = x * x;
        if a.re > 700.0 {
            return Complex64::ZERO;
        }
        match derivative {
            0 => (1.0 - 2.0 * a) * (-a).exp(),
            _ => rate * x * (4.0 * a - 6.0) * (-a).exp(),
        }
    }
}

/// An elastic half-plane z ≥ 0 (z: depth) in plane strain, free but for a line force at x = z = 0.
#[derive(Clone, Copy, Debug)]
pub struct HalfPlane {
    /// First Lamé modulus, Pa.
    pub lambda: f64,
    /// Shear modulus, Pa.
    pub mu: f64,
    /// Density, kg/m³.
    pub density: f64,
}

impl HalfPlane {
    /// Speed of pressure waves, m/s.
    pub fn pressure_speed(&self) -> f64 {
        ((self.lambda + 2.0 * self.mu) / self.density).sqrt()
    }

    /// Speed of shear waves, m/s.
    pub fn shear_speed(&self) -> f64 {
        (self.mu / self.density).sqrt()
    }

    /// Rayleigh speed, m/s: the root of (2 − c²/c_s²)² = 4√(1 − c²/c_p²)√(1 − c²/c_s²), by bisection.
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

    /// Displacement (m; derivative 0) or velocity (m/s; derivative 1) along x and z at the times
    /// given (s), at (x, z) with x ≥ 0, z ≥ 0, x + z > 0, under the line force (F_x, F_z), N/m,
    /// times the Ricker function.
    ///
    /// Cagniard & de Hoop: u = Im ∫ E(p) f(t − τ(p)) dp / πμ with τ = px + az for pressure and
    /// px + bz for shear waves, a² = 1/c_p² − p², b² = 1/c_s² − p². As f is entire the path need not
    /// keep τ real: both integrals follow p = (x cosh θ + iz′ sinh θ)/(c_p √(x² + z′²)) with
    /// z′ = max(z, x/10), which starts below 1/c_p, where the integrand is real, and stays clear of
    /// the branch points and of the Rayleigh pole. The integrand is even and analytic in θ: the
    /// trapezoidal rule converges exponentially.
    pub fn lamb(
        &self,
        force: [f64; 2],
        [x, z]: [f64; 2],
        time: &[f64],
        ricker: Ricker,
        derivative: usize,
    ) -> [Vec<f64>; 2] {
        let [slow_p, slow_s] = [1.0 / self.pressure_speed(), 1.0 / self.shear_speed()];
        let path_z = z.max(0.1 * x);
        let r = x.hypot(path_z);
        let last = time.iter().fold(0f64, |last, t| last.max(*t)) + 2.0 / ricker.frequency;
        let end = 1.2 * (last / (r * slow_p)).max(1.5).acosh() + 1.0;
        let count = 3000;
        let step = end / f64::from(count);
        let mut sums = [vec![0.0; time.len()], vec![0.0; time.len()]];
        for index in 0..=count {
            let theta = f64::from(index) * step;
            let weight = if index == 0 { 0.5 } else { 1.0 } * step / (PI * self.mu);
            let p = Complex64::new(x * theta.cosh(), path_z * theta.sinh()) * slow_p / r;
            let dp = Complex64::new(x * theta.sinh(), path_z * theta.cosh()) * slow_p / r;
            let [a, b] = [slow_p, slow_s].map(|slow| {
                let root = (slow * slow - p * p).sqrt();
                if root.re < 0.0 { -root } else { root }
            });
            let g = slow_s * slow_s - 2.0 * p * p;
            let rayleigh = g * g + 4.0 * p * p * a * b;
            let [of_p, of_s] = [
                (force[1] * g + 2.0 * force[0] * p * b) / rayleigh,
                (force[0] * g - 2.0 * force[1] * p * a) / rayleigh,
            ];
            let factors = [[p * of_p, b * of_s], [a * of_p, -p * of_s]]
                .map(|row| row.map(|factor| factor * dp * weight));
            let arrivals = [p * x + a * z, p * x + b * z];
            for (index, t) in time.iter().enumerate() {
                let waves = arrivals.map(|tau| ricker.value(*t - tau, derivative));
                for (sum, row) in sums.iter_mut().zip(&factors) {
                    sum[index] += (row[0] * waves[0] + row[1] * waves[1]).im;
                }
            }
        }
        sums
    }
}

#[allow(dead_code, reason = "tests and benchmarks use a part each")]
/// A difference as a part of the exact record: by L2 norms over the record, and by greatest values.
#[derive(Clone, Copy, Debug)]
pub struct Error {
    pub l2: f64,
    pub max: f64,
}

/// How far a record is from the exact one.
pub fn error(record: &[f64], exact: &[f64]) -> Error {
    let difference: Vec<f64> = record.iter().zip(exact).map(|(a, b)| a - b).collect();
    let l2 = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
    let max = |values: &[f64]| values.iter().fold(0f64, |max, v| max.max(v.abs()));
    Error { l2: l2(&difference) / l2(exact), max: max(&difference) / max(exact) }
}
