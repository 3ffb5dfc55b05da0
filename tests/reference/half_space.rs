//! Elastic half-space z ≥ 0 (z: depth) under a vertical point force on its surface: by the Cagniard–de Hoop method at
//! any point, and in closed form on the surface for Poisson's ratio ¼ (Pekeris 1955).

use super::half_plane::{
    add_wave_contributions, integration_end_time, integration_path, principal_sqrt,
};
use super::{IsotropicSolid, Ricker};
use std::f64::consts::PI;

/// Displacement (m; `derivative_order` 0) or velocity (m/s; 1), radial and downwards, at distance r > 0 from the axis
/// and depth z ≥ 0, due to a downward force F (N) times the Ricker function f.
///
/// The wave numbers along and across the radius are −isp and sq. For each q the integral over p is that of the
/// half-plane with p² replaced by P² = p² − q²: a² = 1/c_p² − P², b² = 1/c_s² − P², g = 1/c_s² − 2P²,
///
/// ```text
/// u_r = F/π ∫₀^∞ dq Im ∫ p (g f′(t − τ_p) − 2ab f′(t − τ_s)) dp / (πμ(g² + 4P²ab)),
/// u_z = F/π ∫₀^∞ dq Im ∫ a (g f′(t − τ_p) + 2P² f′(t − τ_s)) dp / (πμ(g² + 4P²ab)),    τ = pr + az or pr + bz.
/// ```
///
/// The integrand over q is even and analytic, too; the integral ends where waves arrive after the last time.
/// `interval_counts` are the numbers of intervals in q and p.
pub fn point_force_motion(
    solid: &IsotropicSolid,
    force: f64,
    [r, z]: [f64; 2],
    time: &[f64],
    (ricker, derivative_order): (Ricker, usize),
    interval_counts: [usize; 2],
) -> [Vec<f64>; 2] {
    let [slow_p, slow_s] = [1.0 / solid.pressure_speed(), 1.0 / solid.shear_speed()];
    let mut sums = [vec![0.0; time.len()], vec![0.0; time.len()]];
    let end = integration_end_time(time, ricker);
    let last_q = ((end / r.hypot(z)).powi(2) - slow_p * slow_p).max(0.0).sqrt();
    let step = last_q / interval_counts[0] as f64;
    for index in 0..=interval_counts[0] {
        let q = index as f64 * step;
        let weight = if index == 0 { 0.5 } else { 1.0 } * step * force / (PI * PI * solid.mu);
        for [p, dp] in integration_path([r, z], slow_p.hypot(q), end, interval_counts[1]) {
            let square = p * p - q * q;
            let [a, b] = [slow_p, slow_s].map(|slow| principal_sqrt(slow * slow - square));
            let g = slow_s * slow_s - 2.0 * square;
            let scale = dp * weight / (g * g + 4.0 * square * a * b);
            let waves = [
                (p * r + a * z, [p * g * scale, a * g * scale]),
                (p * r + b * z, [-2.0 * p * a * b * scale, 2.0 * square * a * scale]),
            ];
            add_wave_contributions(&mut sums, time, &waves, ricker, derivative_order + 1);
        }
    }
    sums
}

/// Downward displacement (m) on the surface at a distance r (m) and a time t (s), for λ = μ, due to a downward force
/// F (N) times the Ricker function f (Pekeris 1955).
///
/// For a step force it is F w(c_s t/r)/(πμr), with γ² = (3 + √3)/4 and
///
/// ```text
/// 32 w = 6 − √3/√(τ² − ¼) − √(3√3 + 5)/√(γ² − τ²) + √(3√3 − 5)/√(τ² − (3 − √3)/4),    1/√3 < τ < 1,
/// 16 w = 6 − √(3√3 + 5)/√(γ² − τ²),    1 < τ < γ;        16 w = 6,    γ < τ,
/// ```
///
/// and the response to f is its convolution with f′. The substitution τ = γ − y² removes the square-root singularity
/// at γ.
pub fn pekeris_displacement(
    solid: &IsotropicSolid,
    force: f64,
    r: f64,
    t: f64,
    ricker: Ricker,
) -> f64 {
    let three = 3f64.sqrt();
    let rayleigh = (0.75 + 0.25 * three).sqrt();
    let slowness = r / solid.shear_speed();
    let pole = |tau: f64| (3.0 * three + 5.0).sqrt() / (rayleigh * rayleigh - tau * tau).sqrt();
    let first = |tau: f64| {
        let square = tau * tau;
        (6.0 - three / (square - 0.25).sqrt() - pole(tau)
            + (3.0 * three - 5.0).sqrt() / (square - 0.75 + 0.25 * three).sqrt())
            / 32.0
    };
    let rate = |tau: f64| slowness * ricker.derivative_at(t - slowness * tau, 1);
    // The integral is computed by the midpoint rule.
    let integral = |from: f64, to: f64, value: &dyn Fn(f64) -> f64| {
        let count = 4000;
        let step = (to - from) / f64::from(count);
        (0..count).map(|i| value(from + (f64::from(i) + 0.5) * step)).sum::<f64>() * step
    };
    let mut sum = integral(1.0 / three, 1.0, &|tau| first(tau) * rate(tau));
    sum += integral(0.0, (rayleigh - 1.0).sqrt(), &|y| {
        let tau = rayleigh - y * y;
        2.0 * y * (6.0 - pole(tau)) / 16.0 * rate(tau)
    });
    // Contribution of τ > γ, where w is constant: ∫ f′ = f.
    sum += 6.0 / 16.0 * ricker.derivative_at(t - slowness * rayleigh, 0);
    force * sum / (PI * solid.mu * r)
}
