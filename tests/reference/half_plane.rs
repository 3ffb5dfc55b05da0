//! Elastic half-plane z ≥ 0 (z: depth) in plane strain, with a line force on its surface (Lamb) or a line explosion
//! inside (Garvin), by the Cagniard–de Hoop method.
//!
//! With the Laplace transform in time (variable s) every wave has the form Im ∫ A(p) exp(−sτ(p)) dp along p from 0 to
//! i∞, with τ = px + (sum of depths times a or b), a² = 1/c_p² − p², b² = 1/c_s² − p². In the time domain exp(−sτ)
//! times the transform of the source is f(t − τ). Since f is entire, τ need not be real on the path; see
//! [`integration_path`].

use super::full_plane;
use super::{IsotropicSolid, Ricker};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Nodes p and weights times dp/dθ on the path p = (x cosh θ + iz′ sinh θ)·slowness/√(x² + z′²), with θ ≥ 0 and
/// z′ = max(z, x/10).
///
/// The path starts below `slowness`, where the integrands are real up to a factor, and avoids the branch points and
/// the Rayleigh pole. The integrands are even and analytic in θ, so the trapezoidal rule converges exponentially. The
/// path ends where waves arrive after `end_time` (s).
pub fn integration_path(
    [x, z]: [f64; 2],
    slowness: f64,
    end_time: f64,
    interval_count: usize,
) -> impl Iterator<Item = [Complex64; 2]> {
    let z = z.max(0.1 * x);
    let r = x.hypot(z);
    let end = 1.2 * (end_time / (r * slowness)).max(1.5).acosh() + 1.0;
    let step = end / interval_count as f64;
    (0..=interval_count).map(move |index| {
        let theta = index as f64 * step;
        let weight = if index == 0 { 0.5 } else { 1.0 } * step * slowness / r;
        let p = Complex64::new(x * theta.cosh(), z * theta.sinh()) * slowness / r;
        let dp = Complex64::new(x * theta.sinh(), z * theta.cosh()) * weight;
        [p, dp]
    })
}

/// Square root with non-negative real part.
pub fn principal_sqrt(square: Complex64) -> Complex64 {
    let root = square.sqrt();
    if root.re < 0.0 { -root } else { root }
}

/// Adds Im(factor · f(t − τ)), or its derivative, of each wave (τ, factors along x and z) to the sums at the given
/// times.
pub fn add_wave_contributions(
    sums: &mut [Vec<f64>; 2],
    time: &[f64],
    waves: &[(Complex64, [Complex64; 2])],
    ricker: Ricker,
    derivative_order: usize,
) {
    for (index, t) in time.iter().enumerate() {
        for (tau, factors) in waves {
            let value = ricker.derivative_at_complex_time(*t - tau, derivative_order);
            if value != Complex64::ZERO {
                for (sum, factor) in sums.iter_mut().zip(factors) {
                    sum[index] += (factor * value).im;
                }
            }
        }
    }
}

/// Last time of a record plus two periods of the Ricker function, s.
pub fn integration_end_time(time: &[f64], ricker: Ricker) -> f64 {
    time.iter().fold(0f64, |end_time, t| end_time.max(*t)) + 2.0 / ricker.frequency
}

/// Lamb's problem: displacement (m; `derivative_order` 0) or velocity (m/s; 1) along x and z at (x, z), x ≥ 0, z ≥ 0,
/// x + z > 0, due to a line force (F_x, F_z) (N/m) at the origin times the Ricker function f.
///
/// u = Im Σ ∫ e(p) f(t − τ) dp / πμ over both waves, with the amplitude vector e(p) of a wave, τ = px + az for pressure
/// waves and τ = px + bz for shear waves.
pub fn lamb_motion(
    solid: &IsotropicSolid,
    force: [f64; 2],
    [x, z]: [f64; 2],
    time: &[f64],
    ricker: Ricker,
    derivative_order: usize,
) -> [Vec<f64>; 2] {
    let [slow_p, slow_s] = [1.0 / solid.pressure_speed(), 1.0 / solid.shear_speed()];
    let mut sums = [vec![0.0; time.len()], vec![0.0; time.len()]];
    for [p, dp] in integration_path([x, z], slow_p, integration_end_time(time, ricker), 3000) {
        let [a, b] = [slow_p, slow_s].map(|slow| principal_sqrt(slow * slow - p * p));
        let g = slow_s * slow_s - 2.0 * p * p;
        let scale = dp / ((g * g + 4.0 * p * p * a * b) * PI * solid.mu);
        let of_p = (force[1] * g + 2.0 * force[0] * p * b) * scale;
        let of_s = (force[0] * g - 2.0 * force[1] * p * a) * scale;
        let waves = [(p * x + a * z, [p * of_p, a * of_p]), (p * x + b * z, [b * of_s, -p * of_s])];
        add_wave_contributions(&mut sums, time, &waves, ricker, derivative_order);
    }
    sums
}

/// Garvin's problem: displacement (m; `derivative_order` 0) or velocity (m/s; 1) along x and z at (x, z), x ≥ 0, z ≥ 0,
/// due to a line explosion at (0, `depth`): an isotropic moment M (N·m/m) times the Ricker function f, i.e. the body
/// force −M f ∇δ.
///
/// To the field in the unbounded plane, with potential A exp(−s(px + a|depth − z|)), A = −M/(2πρc_p²a), the surface
/// adds φ = R_p A exp(−s(px + a(depth + z))) and ψ = R_s A exp(−s(px + a depth + bz)), with
/// R_p = (4p²ab − g²)/(4p²ab + g²), R_s = −4pag/(4p²ab + g²), g = 1/c_s² − 2p²; u = ∇φ + (−∂ψ/∂z, ∂ψ/∂x).
pub fn garvin_motion(
    solid: &IsotropicSolid,
    moment: f64,
    depth: f64,
    [x, z]: [f64; 2],
    time: &[f64],
    ricker: Ricker,
    derivative_order: usize,
) -> [Vec<f64>; 2] {
    let [slow_p, slow_s] = [1.0 / solid.pressure_speed(), 1.0 / solid.shear_speed()];
    let mut sums =
        full_plane::explosion_motion(solid, moment, [x, z - depth], time, ricker, derivative_order);
    let scale = -moment * slow_p * slow_p / (2.0 * PI * solid.density);
    for [p, dp] in
        integration_path([x, z + depth], slow_p, integration_end_time(time, ricker), 3000)
    {
        let [a, b] = [slow_p, slow_s].map(|slow| principal_sqrt(slow * slow - p * p));
        let g = slow_s * slow_s - 2.0 * p * p;
        let product = 4.0 * p * p * a * b;
        let potential = scale * dp / (a * (product + g * g));
        let of_p = (product - g * g) * potential;
        let of_s = -4.0 * p * a * g * potential;
        let waves = [
            (p * x + a * (depth + z), [-p * of_p, -a * of_p]),
            (p * x + a * depth + b * z, [b * of_s, -p * of_s]),
        ];
        add_wave_contributions(&mut sums, time, &waves, ricker, derivative_order + 1);
    }
    sums
}
