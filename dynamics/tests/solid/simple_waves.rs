//! Exact waves of pressure–shear plate impact: an elastic–perfectly plastic half-space x₁ ≥ 0 whose boundary is
//! suddenly given a velocity (v₁, v₂).
//!
//! Plane waves along x₁ with Mises' set s:s/2 ≤ k². By symmetry s₂₂ = s₃₃ = −s₁₁/2, so that on the yield surface
//!
//! ```text
//! s₁₁ = k a,  σ₁₂ = k b,   a = −(2/√3) cos ψ,  b = sin ψ      (compression),
//! ```
//!
//! and with associated flow (σ̇₁₁, σ̇₁₂) = D (∂v₁, ∂v₂),
//!
//! ```text
//! D = ( λ + 2μ − μa²    −μab     )
//!     (   −μab        μ(1 − b²)  ).
//! ```
//!
//! The solution depends on ξ = x₁/t: an elastic pressure front up to the yield surface, then a fast and a slow simple
//! wave in which ρξ² is an eigenvalue of D and the stress moves along its eigenvector, dv = −dσ/(ρξ) (Ting & Nan 1969).
//! Their ordinary differential equations are integrated by the fourth-order Runge–Kutta method. The amplitudes of both
//! waves are prescribed; the velocity of the boundary is a result.

use models::solid::parameters::Isotropic;

/// Number of integration steps of each simple wave.
const STEPS_PER_WAVE: usize = 4000;

/// State of the half-space at a point and a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WaveState {
    /// Velocities v₁ and v₂, m/s.
    pub velocity: [f64; 2],
    /// Normal stress σ₁₁, Pa.
    pub normal_stress: f64,
    /// Shear stress σ₁₂, Pa.
    pub shear: f64,
    /// Transverse stress σ₂₂ = σ₃₃, Pa.
    pub transverse_stress: f64,
}

impl WaveState {
    pub fn to_array(self) -> [f64; 5] {
        [self.velocity[0], self.velocity[1], self.normal_stress, self.shear, self.transverse_stress]
    }

    fn interpolate(self, other: Self, share: f64) -> Self {
        let [a, b] = [self, other].map(Self::to_array);
        let [v1, v2, normal_stress, shear, transverse_stress] =
            std::array::from_fn(|i| a[i] + share * (b[i] - a[i]));
        Self { velocity: [v1, v2], normal_stress, shear, transverse_stress }
    }
}

/// Impact of a half-space: material, strength and amplitudes of both simple waves.
#[derive(Clone, Copy, Debug)]
pub struct PressureShearImpact {
    pub solid: Isotropic,
    /// Shear strength k, Pa.
    pub strength: f64,
    /// Shear stress before the impact, Pa: at least 0 and below k.
    pub initial_shear_stress: f64,
    /// Decrease of σ₁₁ in the fast wave, Pa.
    pub fast_wave_stress_drop: f64,
    /// Angle ψ at the end of the slow wave, rad: below π/2.
    pub final_angle: f64,
}

/// Self-similar solution, from the fastest to the slowest wave.
#[derive(Clone, Debug)]
pub struct SelfSimilarSolution {
    /// ξ, m/s, non-increasing, and the state there; equal values of ξ are jumps.
    pub points: Vec<(f64, WaveState)>,
    /// Index ranges of the points of the fast and of the slow simple wave.
    pub simple_wave_ranges: [std::ops::Range<usize>; 2],
}

impl PressureShearImpact {
    /// Computes a and b at the angle ψ, rad.
    fn yield_surface_point(angle: f64) -> [f64; 2] {
        [-2.0 / 3f64.sqrt() * angle.cos(), angle.sin()]
    }

    /// Computes D₁₁, D₁₂, D₂₂ and both eigenvalues of D, the larger first, Pa.
    pub fn moduli(&self, angle: f64) -> ([f64; 3], [f64; 2]) {
        let [a, b] = Self::yield_surface_point(angle);
        let Isotropic { lambda, mu, .. } = self.solid;
        let d = [lambda + 2.0 * mu - mu * a * a, -mu * a * b, mu * (1.0 - b * b)];
        let (mean, half) = (0.5 * (d[0] + d[2]), (0.5 * (d[0] - d[2])).hypot(d[1]));
        // The smaller eigenvalue from the determinant: it vanishes at ψ = π/2.
        (d, [mean + half, (d[0] * d[2] - d[1] * d[1]) / (mean + half)])
    }

    /// Computes dσ₁₂/dσ₁₁ in the fast wave at the angle ψ, rad.
    fn fast_slope(&self, angle: f64) -> f64 {
        let (d, [fast, _]) = self.moduli(angle);
        d[1] / (fast - d[2])
    }

    /// Computes dσ₁₁/dσ₁₂ in the slow wave at the angle ψ, rad.
    fn slow_slope(&self, angle: f64) -> f64 {
        let (d, [_, slow]) = self.moduli(angle);
        d[1] / (slow - d[0])
    }

    /// Returns the state on the yield surface at the angle ψ, with the given σ₁₁ and velocity.
    fn state_at_yield(&self, angle: f64, normal_stress: f64, velocity: [f64; 2]) -> WaveState {
        let [a, b] = Self::yield_surface_point(angle);
        // σ₁₁ − σ₂₂ = 3s₁₁/2.
        WaveState {
            velocity,
            normal_stress,
            shear: self.strength * b,
            transverse_stress: normal_stress - 1.5 * self.strength * a,
        }
    }

    /// Computes the elastic front and both simple waves.
    pub fn solve(&self) -> SelfSimilarSolution {
        let (k, density) = (self.strength, self.solid.density);
        let Isotropic { lambda, mu, .. } = self.solid;
        let elastic = lambda + 2.0 * mu;
        let speed = (elastic / density).sqrt();
        let initial = WaveState { shear: self.initial_shear_stress, ..WaveState::default() };
        let mut angle = (self.initial_shear_stress / k).asin();
        let mut normal_stress =
            1.5 * k * Self::yield_surface_point(angle)[0] * elastic / (2.0 * mu);
        let mut velocity = [-normal_stress / (density * speed), 0.0];
        let mut points =
            vec![(speed, initial), (speed, self.state_at_yield(angle, normal_stress, velocity))];
        let wave_speed = |angle: f64, which: usize| (self.moduli(angle).1[which] / density).sqrt();
        let first = points.len();
        points.push((wave_speed(angle, 0), points[1].1));
        // Derivatives of ψ and of the velocities with respect to σ₁₁.
        let rate = |angle: f64| {
            let slope = self.fast_slope(angle);
            let inverse = -1.0 / (density * wave_speed(angle, 0));
            [slope / (k * angle.cos()), inverse, slope * inverse]
        };
        let step = -self.fast_wave_stress_drop / STEPS_PER_WAVE as f64;
        for _ in 0..STEPS_PER_WAVE {
            let change = runge_kutta_step(rate, angle, step);
            angle += change[0];
            normal_stress += step;
            velocity = [velocity[0] + change[1], velocity[1] + change[2]];
            points
                .push((wave_speed(angle, 0), self.state_at_yield(angle, normal_stress, velocity)));
        }
        let second = points.len();
        points.push((wave_speed(angle, 1), points[second - 1].1));
        // Derivatives of ψ, σ₁₁ and both velocities with respect to ψ, the integration variable.
        let rate = |angle: f64| {
            let shear = k * angle.cos();
            let inverse = -shear / (density * wave_speed(angle, 1));
            let slope = self.slow_slope(angle);
            [1.0, slope * shear, slope * inverse, inverse]
        };
        let step = (self.final_angle - angle) / STEPS_PER_WAVE as f64;
        for _ in 0..STEPS_PER_WAVE {
            let change = runge_kutta_step(rate, angle, step);
            angle += change[0];
            normal_stress += change[1];
            velocity = [velocity[0] + change[2], velocity[1] + change[3]];
            points
                .push((wave_speed(angle, 1), self.state_at_yield(angle, normal_stress, velocity)));
        }
        let end = points.len();
        SelfSimilarSolution { points, simple_wave_ranges: [first..second, second..end] }
    }
}

/// Computes the increments of one fourth-order Runge–Kutta step; all rates depend on the first quantity only.
fn runge_kutta_step<const N: usize>(
    rate: impl Fn(f64) -> [f64; N],
    start: f64,
    step: f64,
) -> [f64; N] {
    let a = rate(start);
    let b = rate(start + 0.5 * step * a[0]);
    let c = rate(start + 0.5 * step * b[0]);
    let d = rate(start + step * c[0]);
    std::array::from_fn(|i| step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
}

impl SelfSimilarSolution {
    /// Returns the state of the boundary.
    pub fn boundary_state(&self) -> WaveState {
        self.points[self.points.len() - 1].1
    }

    /// Returns the state at ξ = x₁/t, interpolated linearly.
    pub fn state_at(&self, speed: f64) -> WaveState {
        let next = self.points.partition_point(|point| point.0 >= speed);
        if next == 0 {
            return self.points[0].1;
        }
        let Some(&(slower, behind)) = self.points.get(next) else { return self.boundary_state() };
        let (faster, faster_state) = self.points[next - 1];
        faster_state.interpolate(behind, (faster - speed) / (faster - slower))
    }

    /// Computes the mean state over an interval of x₁ (m) at a time (s) from samples.
    pub fn mean_state(&self, from: f64, to: f64, time: f64) -> WaveState {
        const SAMPLE_COUNT: usize = 32;
        let mut sum = [0.0; 5];
        for sample in 0..SAMPLE_COUNT {
            let x = from + (sample as f64 + 0.5) / SAMPLE_COUNT as f64 * (to - from);
            let state = self.state_at(x / time).to_array();
            for (sum, value) in sum.iter_mut().zip(state) {
                *sum += value / SAMPLE_COUNT as f64;
            }
        }
        WaveState {
            velocity: [sum[0], sum[1]],
            normal_stress: sum[2],
            shear: sum[3],
            transverse_stress: sum[4],
        }
    }
}
