//! Line sources in an unbounded plane (plane strain).
//!
//! The Laplace transform of Green's function of the wave equation with speed c is K₀(sr/c)/2π, with
//! K₀(z) = ∫₀^∞ exp(−z cosh θ) dθ, K₀″(z) = ∫ cosh²θ exp(−z cosh θ) dθ and −K₀′(z)/z = ∫ sinh²θ exp(−z cosh θ) dθ.
//! In the time domain exp(−s(r/c) cosh θ) delays the source by (r/c) cosh θ. The integrands are even and analytic in
//! θ, so the trapezoidal rule converges exponentially.

use super::half_plane::integration_end_time;
use super::{IsotropicSolid, Ricker};
use std::f64::consts::PI;

/// ∫₀^∞ [cosh θ, cosh²θ, sinh²θ] f⁽ⁿ⁾(t − delay cosh θ) dθ with the Ricker function f and n = `derivative_order`.
fn compute_source_integrals(
    delay: f64,
    t: f64,
    end_time: f64,
    ricker: Ricker,
    derivative_order: usize,
) -> [f64; 3] {
    let end = (end_time / delay).max(1.5).acosh();
    let count = 1000;
    let step = end / f64::from(count);
    let mut sums = [0.0; 3];
    for index in 0..=count {
        let theta = f64::from(index) * step;
        let weight = if index == 0 { 0.5 } else { 1.0 } * step;
        let [cosh, sinh] = [theta.cosh(), theta.sinh()];
        let value = weight * ricker.derivative_at(t - delay * cosh, derivative_order);
        for (sum, factor) in sums.iter_mut().zip([cosh, cosh * cosh, sinh * sinh]) {
            *sum += factor * value;
        }
    }
    sums
}

/// Displacement (m; `derivative_order` 0) or velocity (m/s; 1) at a point ≠ 0, due to an isotropic moment M (N·m/m) at
/// the origin times the Ricker function f (body force −M f ∇δ): u = ∇φ with φ = −M K₀(sr/c_p) f/(2πρc_p²).
pub fn explosion_motion(
    solid: &IsotropicSolid,
    moment: f64,
    [x, z]: [f64; 2],
    time: &[f64],
    ricker: Ricker,
    derivative_order: usize,
) -> [Vec<f64>; 2] {
    let (r, c) = (x.hypot(z), solid.pressure_speed());
    let scale = moment / (2.0 * PI * solid.density * c.powi(3));
    let end = integration_end_time(time, ricker);
    let radial =
        |t: &f64| scale * compute_source_integrals(r / c, *t, end, ricker, derivative_order + 1)[0];
    let radial: Vec<f64> = time.iter().map(radial).collect();
    [x, z].map(|x| radial.iter().map(|u| u * x / r).collect())
}

/// Displacement (m; `derivative_order` 0) or velocity (m/s; 1) at a point ≠ 0, due to a line force F (N/m) at the
/// origin times the Ricker function: u = F g_s/μ − ∇∇·F (g_s − g_p)/(ρs²), with g = K₀(sr/c)/2π for each wave speed c.
/// The radial component is F_r (I_p[cosh²]/c_p² − I_s[sinh²]/c_s²)/(2πρ), the transverse component F_t
/// (I_s[cosh²]/c_s² − I_p[sinh²]/c_p²)/(2πρ), with the integrals I of [`compute_source_integrals`] for the delay r/c.
pub fn force_motion(
    solid: &IsotropicSolid,
    force: [f64; 2],
    [x, z]: [f64; 2],
    time: &[f64],
    ricker: Ricker,
    derivative_order: usize,
) -> [Vec<f64>; 2] {
    let r = x.hypot(z);
    let along = [x / r, z / r];
    let across = [-along[1], along[0]];
    let component = |n: [f64; 2]| (force[0] * n[0] + force[1] * n[1]) / (2.0 * PI * solid.density);
    let end = integration_end_time(time, ricker);
    let mut sums = [Vec::new(), Vec::new()];
    for t in time {
        let [p, s] = [solid.pressure_speed(), solid.shear_speed()].map(|c| {
            compute_source_integrals(r / c, *t, end, ricker, derivative_order)
                .map(|value| value / (c * c))
        });
        let [radial, transverse] =
            [component(along) * (p[1] - s[2]), component(across) * (s[1] - p[2])];
        for (axis, sum) in sums.iter_mut().enumerate() {
            sum.push(radial * along[axis] + transverse * across[axis]);
        }
    }
    sums
}
