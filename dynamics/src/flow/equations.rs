//! The right-hand side: from vorticity and ω or ψ to their rates of change.
//!
//! With v = Γx + v′, v′ free of divergence, and ζ = ∂₁v′₂ − ∂₂v′₁, the curl of the momentum balance is
//!
//! ```text
//! ∂ₜζ = (∂₁² − ∂₂²) T₁₂ − ∂₁∂₂ (T₁₁ − T₂₂),   T = q N(ψ)/ρ − v′ ⊗ v′,   q = p sin φ + c cos φ
//! ```
//!
//! in coordinates that move with Γx. What Γ advects, and the force that keeps Γ, have no part in it: the
//! vorticity of an incompressible plane flow is neither stretched nor turned.

use super::closure::{Closure, Deformation, double_shearing, harris_grekova, plastic_potential};
use super::pressure::{Equation, Solver, right_hand_side};
use super::spectral::{Series, Waves};
use super::{Left, Problem};
use num_complex::Complex64;
use rayon::prelude::*;

/// Points that a task takes at once.
const PART: usize = 4096;

/// exp(Γt) of a traceless Γ: Γ² = −det Γ.
pub(super) fn exponential(gradient: [[f64; 2]; 2], time: f64) -> [[f64; 2]; 2] {
    let [[a, b], [c, d]] = gradient;
    let square = b * c - a * d;
    let turn = square.abs().sqrt() * time;
    // F = even + odd Γ
    let (even, odd) = if turn.abs() < 1e-4 {
        // The next terms are below rounding.
        let z = square * time * time;
        (1.0 + z / 2.0, time * (1.0 + z / 6.0))
    } else if square > 0.0 {
        (turn.cosh(), turn.sinh() / turn * time)
    } else {
        (turn.cos(), turn.sin() / turn * time)
    };
    [[even + odd * a, odd * b], [odd * c, even + odd * d]]
}

/// Fields at the points, the last ones that were evaluated.
#[derive(Default)]
pub(super) struct Points {
    /// v′, m/s.
    pub(super) velocity: [Vec<f64>; 2],
    /// ∂₁v′₁ = −∂₂v′₂, ∂₁v′₂ and ∂₂v′₁, 1/s.
    gradient: [Vec<f64>; 3],
    /// ω or ψ, all of it.
    pub(super) inner: Vec<f64>,
    /// cos 2ψ and sin 2ψ.
    pub(super) direction: [Vec<f64>; 2],
    /// p − P₀, Pa.
    pub(super) pressure: Vec<f64>,
    /// What is transformed.
    product: [Vec<f64>; 2],
}

/// Means of the last state that was evaluated, W/m³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Powers {
    /// −ρ⟨v′·Γv′⟩.
    pub(super) background: f64,
    /// −⟨qN : ∇v′⟩.
    pub(super) stress: f64,
    /// ⟨2Q_D q cos 2Δ⟩.
    pub(super) internal: f64,
}

/// The right-hand side and its memory.
pub(super) struct Equations {
    pub(super) problem: Problem,
    pub(super) series: Series,
    solver: Solver,
    pub(super) points: Points,
    pub(super) powers: Powers,
    /// Modes of p − P₀: the next solution starts from there.
    pub(super) pressure: Vec<Complex64>,
    /// Modes of what is transformed.
    modes: [Vec<Complex64>; 3],
    right: Vec<Complex64>,
    sin_phi: f64,
    /// c cos φ, Pa.
    cohesion: f64,
    /// Sign of cos 2(ψ − ψ_D) of the background.
    branch: f64,
    /// Least Q_D, 1/s.
    least: f64,
    /// Evaluations, and iterations of their pressures.
    pub(super) effort: [usize; 2],
    /// Of the last pressure, relative.
    pub(super) residual: f64,
}

impl Equations {
    pub(super) fn new(problem: Problem) -> Self {
        let series = Series::new(problem.points);
        let count: usize = problem.points.iter().product();
        let values = || vec![0.0; count];
        let modes = || vec![Complex64::ZERO; series.count()];
        let background = Deformation::new(problem.velocity_gradient);
        let [cos, sin] = cos_sin(problem.stress_angle);
        let [one, other] = background.deviator;
        let inner = if problem.closure.inner().is_some() { values() } else { Vec::new() };
        Self {
            sin_phi: problem.friction_angle.sin(),
            cohesion: problem.cohesion * problem.friction_angle.cos(),
            branch: (one * cos + other * sin).signum(),
            least: problem.least_shear_rate * background.shear_rate(),
            points: Points {
                velocity: [values(), values()],
                gradient: [values(), values(), values()],
                inner,
                direction: [values(), values()],
                pressure: values(),
                product: [values(), values()],
            },
            powers: Powers::default(),
            pressure: modes(),
            modes: [modes(), modes(), modes()],
            right: modes(),
            solver: Solver::new(&series),
            series,
            problem,
            effort: [0; 2],
            residual: 0.0,
        }
    }

    /// Numbers of the state: ζ, then ω or ψ, then the works of background and stress.
    pub(super) fn size(&self) -> usize {
        self.series.count() * (1 + usize::from(self.problem.closure.inner().is_some())) + 1
    }

    pub(super) fn waves(&self, time: f64) -> Waves {
        Waves::new(self.problem.lengths, exponential(self.problem.velocity_gradient, time))
    }

    /// The rates of change of a state.
    ///
    /// # Errors
    /// A point has no stress, or there is no pressure.
    pub(super) fn rates(
        &mut self,
        time: f64,
        state: &[Complex64],
        rates: &mut [Complex64],
    ) -> Result<(), Left> {
        let waves = self.waves(time);
        self.evaluate(&waves, state);
        self.direct().map_err(|(point, what)| self.left(what, point, time))?;
        self.press(&waves, time)?;
        self.fluxes().map_err(|(point, what)| self.left(what, point, time))?;
        let [shear, difference] = &mut self.modes.split_at_mut(2).0 else { unreachable!() };
        self.series.forward(&self.points.product[0], shear);
        self.series.forward(&self.points.product[1], difference);
        let count = self.series.count();
        self.series.fill(&mut rates[..count], &waves, |[k1, k2], i| {
            k1 * k2 * difference[i] - (k1 * k1 - k2 * k2) * shear[i]
        });
        if self.problem.closure.inner().is_some() {
            self.advect(&waves, state[count].re, &mut rates[count..2 * count]);
        }
        let Powers { background, stress, .. } = self.powers;
        rates[self.size() - 1] = Complex64::new(background, stress);
        Ok(())
    }

    fn left(&self, what: String, point: usize, time: f64) -> Left {
        let columns = self.problem.points[0];
        let index = [point % columns, point / columns];
        let at = [0, 1].map(|axis| {
            (index[axis] as f64 + 0.5) * self.problem.lengths[axis]
                / self.problem.points[axis] as f64
        });
        Left { what, at, time }
    }

    /// Velocity, its gradient, and ω or ψ at the points.
    fn evaluate(&mut self, waves: &Waves, state: &[Complex64]) {
        let (vorticity, rest) = state.split_at(self.series.count());
        let Points { velocity, gradient, inner, .. } = &mut self.points;
        let series = &mut self.series;
        // v̂ = iζ̂ (k₂, −k₁)/k².
        let inverse = |k: [f64; 2]| {
            let square = k[0] * k[0] + k[1] * k[1];
            if square == 0.0 { 0.0 } else { 1.0 / square }
        };
        let i = Complex64::I;
        let [v1, v2] = velocity;
        series.inverse(vorticity, waves, |k| i * (k[1] * inverse(k)), v1);
        series.inverse(vorticity, waves, |k| -i * (k[0] * inverse(k)), v2);
        let [g11, g21, g12] = gradient;
        let real = |value: f64| Complex64::new(value, 0.0);
        series.inverse(vorticity, waves, |k| real(-k[0] * k[1] * inverse(k)), g11);
        series.inverse(vorticity, waves, |k| real(k[0] * k[0] * inverse(k)), g21);
        series.inverse(vorticity, waves, |k| real(-k[1] * k[1] * inverse(k)), g12);
        if !inner.is_empty() {
            series.inverse(&rest[..series.count()], waves, |_| Complex64::ONE, inner);
        }
    }

    /// The velocity gradient, Γ included.
    #[inline(always)]
    fn deformation(&self, point: usize) -> Deformation {
        let [[g11, g12], [g21, g22]] = self.problem.velocity_gradient;
        let [a, b, c] = self.points.gradient.each_ref().map(|own| own[point]);
        Deformation::new([[g11 + a, g12 + c], [g21 + b, g22 - a]])
    }

    /// Q_D at the points, 1/s.
    pub(super) fn shear_rates(&self) -> Vec<f64> {
        (0..self.points.pressure.len()).map(|point| self.deformation(point).shear_rate()).collect()
    }

    /// The direction of stress at the points, and −ρ ∂ᵢvⱼ∂ⱼvᵢ there, less what balances Γ.
    fn direct(&mut self) -> Result<(), (usize, String)> {
        let mut direction = std::mem::take(&mut self.points.direction);
        let mut source = std::mem::take(&mut self.points.product[0]);
        let [cosines, sines] = &mut direction;
        let own = &*self;
        let [[g11, g12], [g21, g22]] = self.problem.velocity_gradient;
        let first = cosines
            .par_chunks_mut(PART)
            .zip(sines.par_chunks_mut(PART).zip(source.par_chunks_mut(PART)))
            .enumerate()
            .filter_map(|(part, (cosines, (sines, source)))| {
                let mut first = None;
                let outputs = cosines.iter_mut().zip(sines.iter_mut().zip(source));
                for (point, (cos, (sin, source))) in (PART * part..).zip(outputs) {
                    match own.direction(point) {
                        Some(found) => [*cos, *sin] = found,
                        None => first = first.or(Some(point)),
                    }
                    let [a, b, c] = own.points.gradient.each_ref().map(|own| own[point]);
                    let mixed = (g11 - g22) * a + g12 * b + g21 * c;
                    *source = -2.0 * own.problem.density * (mixed + a * a + b * c);
                }
                first
            })
            .min();
        (self.points.direction, self.points.product[0]) = (direction, source);
        first.map_or(Ok(()), |point| Err((point, self.undirected(point))))
    }

    #[inline(always)]
    fn direction(&self, point: usize) -> Option<[f64; 2]> {
        let deformation = self.deformation(point);
        match self.problem.closure {
            Closure::HarrisGrekova => {
                let spin = self.points.inner[point];
                harris_grekova(&deformation, self.sin_phi, self.branch, spin)
            }
            Closure::DoubleShearing => {
                let found = cos_sin(self.points.inner[point]);
                found[0].is_finite().then_some(found)
            }
            Closure::PlasticPotential => plastic_potential(&deformation, self.least),
        }
    }

    /// Why a point has no direction of stress.
    fn undirected(&self, point: usize) -> String {
        let deformation = self.deformation(point);
        let rate = deformation.shear_rate();
        match self.problem.closure {
            Closure::HarrisGrekova => {
                let spin = self.points.inner[point];
                let needed = self.sin_phi * (spin - deformation.half_vorticity).abs();
                format!(
                    "no stress angle: sin φ |ω − s₂₁| = {needed:.6e} exceeds Q_D = {rate:.6e} 1/s"
                )
            }
            Closure::DoubleShearing => "the stress angle is not finite".to_owned(),
            Closure::PlasticPotential => {
                format!("Q_D = {rate:.6e} 1/s is below {:.6e}: nearly rigid", self.least)
            }
        }
    }

    /// The pressure, in modes and at the points.
    fn press(&mut self, waves: &Waves, time: f64) -> Result<(), Left> {
        let Points { direction: [cosines, sines], product, pressure, .. } = &mut self.points;
        let series = &mut self.series;
        let [cos, sin, source] = &mut self.modes;
        series.forward(cosines, cos);
        series.forward(sines, sin);
        series.forward(&product[0], source);
        let stress = self.problem.pressure * self.sin_phi + self.cohesion;
        right_hand_side(series, waves, source, [cos, sin], stress, &mut self.right);
        let equation = Equation {
            waves: *waves,
            sin_phi: self.sin_phi,
            direction: [cosines, sines],
            mean: [cos[0].re, sin[0].re],
        };
        let tolerance = self.problem.pressure_tolerance;
        let solved =
            self.solver.solve(series, &equation, &self.right, tolerance, &mut self.pressure);
        let solved = solved.map_err(|solved| {
            // The next one is not to start from what may be no number.
            self.pressure.fill(Complex64::ZERO);
            let (residual, count) = (solved.residual, solved.iterations);
            let what = format!("no pressure: residual {residual:.1e} after {count} iterations");
            Left { what, at: [0.0; 2], time }
        })?;
        self.effort = [self.effort[0] + 1, self.effort[1] + solved.iterations];
        self.residual = solved.residual;
        self.series.inverse(&self.pressure, waves, |_| Complex64::ONE, pressure);
        Ok(())
    }

    /// T₁₂ and T₁₁ − T₂₂ at the points, and the powers.
    fn fluxes(&mut self) -> Result<(), (usize, String)> {
        let mut product = std::mem::take(&mut self.points.product);
        let [shear, difference] = &mut product;
        let own = &*self;
        let density = self.problem.density;
        let [[g11, g12], [g21, g22]] = self.problem.velocity_gradient;
        let parts: Vec<(Option<usize>, [f64; 3])> = shear
            .par_chunks_mut(PART)
            .zip(difference.par_chunks_mut(PART))
            .enumerate()
            .map(|(part, (shear, difference))| {
                let (mut first, mut sums) = (None, [0.0; 3]);
                let outputs = shear.iter_mut().zip(difference);
                for (point, (shear, difference)) in (PART * part..).zip(outputs) {
                    let [cos, sin] = own.points.direction.each_ref().map(|own| own[point]);
                    let [v1, v2] = own.points.velocity.each_ref().map(|own| own[point]);
                    let [a, b, c] = own.points.gradient.each_ref().map(|own| own[point]);
                    let q = own.deviator(point);
                    // Not a number is no deviator, either.
                    if !matches!(q.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater)) {
                        first = first.or(Some(point));
                    }
                    *shear = q * sin / density - v1 * v2;
                    *difference = 2.0 * q * cos / density - (v1 * v1 - v2 * v2);
                    let [one, other] = own.deformation(point).deviator;
                    sums[0] -= density * (g11 * v1 * v1 + (g12 + g21) * v1 * v2 + g22 * v2 * v2);
                    sums[1] -= q * (2.0 * cos * a + sin * (b + c));
                    sums[2] += q * (cos * one + sin * other);
                }
                (first, sums)
            })
            .collect();
        self.points.product = product;
        let count = self.points.pressure.len() as f64;
        let [background, stress, internal] = parts
            .iter()
            .fold([0.0; 3], |all, (_, own)| std::array::from_fn(|i| all[i] + own[i] / count));
        self.powers = Powers { background, stress, internal };
        match parts.iter().find_map(|part| part.0) {
            None => Ok(()),
            Some(point) => {
                let (p, q) =
                    (self.problem.pressure + self.points.pressure[point], self.deviator(point));
                Err((point, format!("p = {p:.6e} Pa, so that q = {q:.6e} Pa is not positive")))
            }
        }
    }

    /// q = p sin φ + c cos φ, Pa.
    #[inline(always)]
    fn deviator(&self, point: usize) -> f64 {
        (self.problem.pressure + self.points.pressure[point]) * self.sin_phi + self.cohesion
    }

    /// The rate of ω or ψ, of which `mean` is the mean.
    fn advect(&mut self, waves: &Waves, mean: f64, rates: &mut [Complex64]) {
        let mut product = std::mem::take(&mut self.points.product[0]);
        for axis in 0..2 {
            let points = &self.points;
            let values = points.velocity[axis].par_chunks(PART).zip(points.inner.par_chunks(PART));
            product.par_chunks_mut(PART).zip(values).for_each(|(flux, (velocity, inner))| {
                for (flux, (velocity, inner)) in flux.iter_mut().zip(velocity.iter().zip(inner)) {
                    *flux = velocity * (inner - mean);
                }
            });
            self.series.forward(&product, &mut self.modes[axis]);
        }
        if self.problem.closure == Closure::DoubleShearing {
            let own = &*self;
            product.par_chunks_mut(PART).enumerate().for_each(|(part, source)| {
                for (point, source) in (PART * part..).zip(source) {
                    let direction = own.points.direction.each_ref().map(|own| own[point]);
                    *source = double_shearing(&own.deformation(point), own.sin_phi, direction);
                }
            });
            self.series.forward(&product, &mut self.modes[2]);
        } else {
            self.modes[2].fill(Complex64::ZERO);
            self.modes[2][0].re = self.problem.spin_acceleration;
        }
        self.points.product[0] = product;
        let i = Complex64::I;
        let [one, other, sources] = &self.modes;
        self.series.fill(rates, waves, |[k1, k2], index| {
            sources[index] - i * (k1 * one[index] + k2 * other[index])
        });
    }
}

/// cos 2ψ and sin 2ψ.
#[inline(always)]
pub(super) fn cos_sin(angle: f64) -> [f64; 2] {
    let (sin, cos) = (2.0 * angle).sin_cos();
    [cos, sin]
}
