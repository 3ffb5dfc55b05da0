//! Pressure of an incompressible flow: the divergence of the momentum balance,
//!
//! ```text
//! ∂ᵢ∂ⱼ[(δᵢⱼ − sin φ Nᵢⱼ) p] = s + c cos φ ∂ᵢ∂ⱼNᵢⱼ,   N = [[cos 2ψ, sin 2ψ], [sin 2ψ, −cos 2ψ]]
//! ```
//!
//! divided by −k², with k = k(cos θ, sin θ), p = P₀ + p̃ and prescribed mean P₀:
//!
//! ```text
//! (1 − sin φ R) p̃ = −ŝ/k² + (P₀ sin φ + c cos φ) R 1,   R p = cos 2θ (cos 2ψ p)^ + sin 2θ (sin 2ψ p)^
//! ```
//!
//! ‖R‖ ≤ 1, so that p̃ is unique for any ψ. The operator is not self-adjoint, and for variable ψ its kernel is not the
//! constants but one function of mean 1. Therefore p̃ omits mode 0, where the equation reads 0 = 0, and P₀ replaces it,
//! as in a bordered system.

use super::spectral::{Series, Wave, Waves};
use models::common::elementary::Elementary;
use num_complex::Complex64;
use rayon::prelude::*;

/// Number of GMRES iterations before a restart.
const RESTART: usize = 30;
/// Maximum number of iterations.
const MOST: usize = 300;

/// Pressure equation for a given field ψ.
pub(super) struct Equation<'a> {
    pub(super) waves: &'a Waves,
    pub(super) sin_phi: f64,
    /// cos 2ψ and sin 2ψ at the points.
    pub(super) direction: [&'a [f64]; 2],
    /// Means of cos 2ψ and sin 2ψ.
    pub(super) mean: [f64; 2],
}

impl Equation<'_> {
    /// Preconditioner: inverse of the operator with N replaced by its mean.
    #[inline(always)]
    fn preconditioner(&self, wave: &Wave) -> f64 {
        let ([cos, sin], [mean_cos, mean_sin]) = (wave.doubled, self.mean);
        1.0 / (1.0 - self.sin_phi * (mean_cos * cos + mean_sin * sin))
    }
}

/// Effort and accuracy of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Solved {
    pub(super) iterations: usize,
    /// Norm of the residual divided by that of the right-hand side.
    pub(super) residual: f64,
}

/// Buffers of the solver.
pub(super) struct Solver {
    /// Orthonormal basis of the Krylov space.
    basis: Vec<Vec<Complex64>>,
    /// Argument of the operator at the points.
    values: Vec<f64>,
    /// Modes of its products with cos 2ψ and sin 2ψ.
    products: [Vec<Complex64>; 2],
    next: Vec<Complex64>,
    sum: Vec<Complex64>,
}

impl Solver {
    pub(super) fn new(series: &Series) -> Self {
        let modes = || vec![Complex64::ZERO; series.count()];
        Self {
            basis: Vec::new(),
            values: vec![0.0; series.points().iter().product()],
            products: [modes(), modes()],
            next: modes(),
            sum: modes(),
        }
    }

    /// Computes `next` = (1 − sin φ R) f p, where `factor` f multiplies each mode.
    fn apply(
        &mut self,
        series: &mut Series,
        equation: &Equation,
        factor: impl Fn(&Wave) -> f64 + Sync,
        p: &[Complex64],
    ) {
        series.inverse(p, equation.waves, |wave| factor(wave).into(), &mut self.values);
        let values = &self.values;
        for (direction, product) in equation.direction.iter().zip(&mut self.products) {
            series.forward(|point| values[point] * direction[point], product);
        }
        let [one, other] = &self.products;
        series.fill(&mut self.next, equation.waves, |wave, i| {
            let [cos, sin] = wave.doubled;
            factor(wave) * p[i] - equation.sin_phi * (cos * one[i] + sin * other[i])
        });
    }

    /// Solves for p̃ by restarted GMRES (Saad & Schultz 1986) with right preconditioning; `p` holds the initial guess.
    ///
    /// # Errors
    /// Iterations and residual, if the tolerance is not reached.
    pub(super) fn solve(
        &mut self,
        series: &mut Series,
        equation: &Equation,
        right: &[Complex64],
        tolerance: f64,
        p: &mut [Complex64],
    ) -> Result<Solved, Solved> {
        let size = series.product(right, right).sqrt();
        let goal = tolerance * size;
        let mut iterations = 0;
        loop {
            self.apply(series, equation, |_| 1.0, p);
            combine(&mut self.next, -1.0, right, 1.0);
            let mut residual = series.product(&self.next, &self.next).sqrt();
            let relative = if size > 0.0 { residual / size } else { 0.0 };
            let solved = Solved { iterations, residual: relative };
            if residual <= goal || size == 0.0 {
                return Ok(solved);
            }
            if iterations >= MOST || !residual.is_finite() {
                return Err(solved);
            }
            // Arnoldi process; Givens rotations make the Hessenberg matrix triangular.
            let mut triangle: Vec<Vec<f64>> = Vec::new();
            let mut rotations: Vec<[f64; 2]> = Vec::new();
            let mut rest = vec![residual];
            self.keep(0, 1.0 / residual);
            while triangle.len() < RESTART && residual > goal {
                let last = triangle.len();
                let own = std::mem::take(&mut self.basis[last]);
                self.apply(series, equation, |wave| equation.preconditioner(wave), &own);
                self.basis[last] = own;
                let mut column = Vec::with_capacity(last + 2);
                for own in &self.basis[..=last] {
                    let part = series.product(own, &self.next);
                    combine(&mut self.next, 1.0, own, -part);
                    column.push(part);
                }
                let norm = series.product(&self.next, &self.next).sqrt();
                if norm > 0.0 {
                    self.keep(last + 1, 1.0 / norm);
                }
                for (i, [cos, sin]) in rotations.iter().enumerate() {
                    let (upper, lower) = (column[i], column[i + 1]);
                    (column[i], column[i + 1]) =
                        (cos * upper + sin * lower, cos * lower - sin * upper);
                }
                let length = column[last].root_sum_square(norm);
                let [cos, sin] = [column[last] / length, norm / length];
                column[last] = length;
                rotations.push([cos, sin]);
                rest.push(-sin * rest[last]);
                rest[last] *= cos;
                residual = rest[last + 1].abs();
                triangle.push(column);
                iterations += 1;
            }
            // Back substitution and linear combination of the basis.
            self.sum.fill(Complex64::ZERO);
            for i in (0..triangle.len()).rev() {
                let factor = rest[i] / triangle[i][i];
                for (rest, entry) in rest[..i].iter_mut().zip(&triangle[i]) {
                    *rest -= factor * entry;
                }
                combine(&mut self.sum, 1.0, &self.basis[i], factor);
            }
            let sum = &self.sum;
            series.fill(&mut self.next, equation.waves, |wave, i| {
                equation.preconditioner(wave) * sum[i]
            });
            combine(p, 1.0, &self.next, 1.0);
        }
    }

    /// Sets basis vector `index` to `factor`·`next`.
    fn keep(&mut self, index: usize, factor: f64) {
        if self.basis.len() == index {
            self.basis.push(vec![Complex64::ZERO; self.next.len()]);
        }
        combine(&mut self.basis[index], 0.0, &self.next, factor);
    }
}

/// Computes the right-hand side from the modes of s, cos 2ψ and sin 2ψ; `stress` = P₀ sin φ + c cos φ.
pub(super) fn right_hand_side(
    series: &Series,
    waves: &Waves,
    source: &[Complex64],
    [cos, sin]: [&[Complex64]; 2],
    stress: f64,
    out: &mut [Complex64],
) {
    series.fill(out, waves, |wave, i| {
        let [cos_wave, sin_wave] = wave.doubled;
        stress * (cos_wave * cos[i] + sin_wave * sin[i]) - wave.inverse_square * source[i]
    });
}

/// Computes `out` = `own`·`out` + `other`·`b`.
pub(super) fn combine(out: &mut [Complex64], own: f64, b: &[Complex64], other: f64) {
    const PART: usize = 2048;
    out.par_chunks_mut(PART).zip(b.par_chunks(PART)).for_each(|(out, b)| {
        for (out, b) in out.iter_mut().zip(b) {
            *out = own * *out + other * b;
        }
    });
}
