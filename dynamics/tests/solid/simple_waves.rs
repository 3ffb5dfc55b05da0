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
const STEPS: usize = 4000;

/// State at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Velocities v₁ and v₂, m/s.
    pub velocity: [f64; 2],
    /// Normal stress σ₁₁, Pa.
    pub normal: f64,
    /// Shear stress σ₁₂, Pa.
    pub shear: f64,
    /// Transverse stress σ₂₂ = σ₃₃, Pa.
    pub across: f64,
}

impl State {
    pub fn numbers(self) -> [f64; 5] {
        [self.velocity[0], self.velocity[1], self.normal, self.shear, self.across]
    }

    fn between(self, other: Self, share: f64) -> Self {
        let [a, b] = [self, other].map(Self::numbers);
        let [v1, v2, normal, shear, across] = std::array::from_fn(|i| a[i] + share * (b[i] - a[i]));
        Self { velocity: [v1, v2], normal, shear, across }
    }
}

/// Half-space and loading.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    pub solid: Isotropic,
    /// Shear strength k, Pa.
    pub strength: f64,
    /// Shear stress before the impact, Pa: at least 0 and below k.
    pub prestress: f64,
    /// Decrease of σ₁₁ in the fast wave, Pa.
    pub fast_fall: f64,
    /// Angle ψ at the end of the slow wave, rad: below π/2.
    pub last_angle: f64,
}

/// Self-similar solution, from the fastest to the slowest wave.
#[derive(Clone, Debug)]
pub struct Waves {
    /// ξ, m/s, non-increasing, and the state there; equal values of ξ are jumps.
    pub points: Vec<(f64, State)>,
    /// Index ranges of the points of the fast and of the slow simple wave.
    pub simple: [std::ops::Range<usize>; 2],
}

impl Impact {
    /// Computes a and b at the angle ψ, rad.
    fn direction(angle: f64) -> [f64; 2] {
        [-2.0 / 3f64.sqrt() * angle.cos(), angle.sin()]
    }

    /// Computes D₁₁, D₁₂, D₂₂ and both eigenvalues of D, the larger first, Pa.
    pub fn moduli(&self, angle: f64) -> ([f64; 3], [f64; 2]) {
        let [a, b] = Self::direction(angle);
        let Isotropic { lambda, mu, .. } = self.solid;
        let d = [lambda + 2.0 * mu - mu * a * a, -mu * a * b, mu * (1.0 - b * b)];
        let (mean, half) = (0.5 * (d[0] + d[2]), (0.5 * (d[0] - d[2])).hypot(d[1]));
        // The smaller eigenvalue from the determinant: it vanishes at ψ = π/2.
        (d, [mean + half, (d[0] * d[2] - d[1] * d[1]) / (mean + half)])
    }

    /// Computes dσ₁₂/dσ₁₁ in the fast wave.
    fn fast_slope(&self, angle: f64) -> f64 {
        let (d, [fast, _]) = self.moduli(angle);
        d[1] / (fast - d[2])
    }

    /// Computes dσ₁₁/dσ₁₂ in the slow wave.
    fn slow_slope(&self, angle: f64) -> f64 {
        let (d, [_, slow]) = self.moduli(angle);
        d[1] / (slow - d[0])
    }

    /// Returns the state on the yield surface at the angle ψ, with the given σ₁₁ and velocity.
    fn yielding(&self, angle: f64, normal: f64, velocity: [f64; 2]) -> State {
        let [a, b] = Self::direction(angle);
        // σ₁₁ − σ₂₂ = 3s₁₁/2.
        State {
            velocity,
            normal,
            shear: self.strength * b,
            across: normal - 1.5 * self.strength * a,
        }
    }

    /// Computes the elastic front and both simple waves.
    pub fn waves(&self) -> Waves {
        let (k, density) = (self.strength, self.solid.density);
        let Isotropic { lambda, mu, .. } = self.solid;
        let elastic = lambda + 2.0 * mu;
        let speed = (elastic / density).sqrt();
        let rest = State { shear: self.prestress, ..State::default() };
        let mut angle = (self.prestress / k).asin();
        let mut normal = 1.5 * k * Self::direction(angle)[0] * elastic / (2.0 * mu);
        let mut velocity = [-normal / (density * speed), 0.0];
        let mut points = vec![(speed, rest), (speed, self.yielding(angle, normal, velocity))];
        let wave_speed = |angle: f64, which: usize| (self.moduli(angle).1[which] / density).sqrt();
        let first = points.len();
        points.push((wave_speed(angle, 0), points[1].1));
        // Derivatives of ψ and of the velocities with respect to σ₁₁.
        let rate = |angle: f64| {
            let slope = self.fast_slope(angle);
            let inverse = -1.0 / (density * wave_speed(angle, 0));
            [slope / (k * angle.cos()), inverse, slope * inverse]
        };
        let step = -self.fast_fall / STEPS as f64;
        for _ in 0..STEPS {
            let change = runge_kutta(rate, angle, step);
            angle += change[0];
            normal += step;
            velocity = [velocity[0] + change[1], velocity[1] + change[2]];
            points.push((wave_speed(angle, 0), self.yielding(angle, normal, velocity)));
        }
        let second = points.len();
        points.push((wave_speed(angle, 1), points[second - 1].1));
        // Derivatives of ψ, σ₁₁ and the velocities with respect to ψ, the integration variable.
        let rate = |angle: f64| {
            let shear = k * angle.cos();
            let inverse = -shear / (density * wave_speed(angle, 1));
            let slope = self.slow_slope(angle);
            [1.0, slope * shear, slope * inverse, inverse]
        };
        let step = (self.last_angle - angle) / STEPS as f64;
        for _ in 0..STEPS {
            let change = runge_kutta(rate, angle, step);
            angle += change[0];
            normal += change[1];
            velocity = [velocity[0] + change[2], velocity[1] + change[3]];
            points.push((wave_speed(angle, 1), self.yielding(angle, normal, velocity)));
        }
        let end = points.len();
        Waves { points, simple: [first..second, second..end] }
    }
}

/// Computes the increments of one fourth-order Runge–Kutta step; all rates depend on the first quantity only.
fn runge_kutta<const N: usize>(rate: impl Fn(f64) -> [f64; N], at: f64, step: f64) -> [f64; N] {
    let a = rate(at);
    let b = rate(at + 0.5 * step * a[0]);
    let c = rate(at + 0.5 * step * b[0]);
    let d = rate(at + step * c[0]);
    std::array::from_fn(|i| step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
}

impl Waves {
    /// Returns the state of the boundary.
    pub fn last(&self) -> State {
        self.points[self.points.len() - 1].1
    }

    /// Returns the state at ξ = x₁/t, interpolated linearly.
    pub fn at(&self, speed: f64) -> State {
        let next = self.points.partition_point(|point| point.0 >= speed);
        if next == 0 {
            return self.points[0].1;
        }
        let Some(&(slower, behind)) = self.points.get(next) else { return self.last() };
        let (faster, ahead) = self.points[next - 1];
        ahead.between(behind, (faster - speed) / (faster - slower))
    }

    /// Computes the mean state over an interval of x₁ at a time.
    pub fn mean(&self, from: f64, to: f64, time: f64) -> State {
        const SAMPLES: usize = 32;
        let mut sum = [0.0; 5];
        for sample in 0..SAMPLES {
            let x = from + (sample as f64 + 0.5) / SAMPLES as f64 * (to - from);
            let own = self.at(x / time).numbers();
            for (sum, own) in sum.iter_mut().zip(own) {
                *sum += own / SAMPLES as f64;
            }
        }
        State { velocity: [sum[0], sum[1]], normal: sum[2], shear: sum[3], across: sum[4] }
    }
}
