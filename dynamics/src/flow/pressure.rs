//! Pressure of an incompressible flow, from the divergence of the momentum balance,
//!
//! ```text
//! ∂ᵢ∂ⱼ[(δᵢⱼ − sin φ Nᵢⱼ) p] = s + c cos φ ∂ᵢ∂ⱼNᵢⱼ,   N = [[cos 2ψ, sin 2ψ], [sin 2ψ, −cos 2ψ]],
//! ```
//!
//! with the source s = −ρ ∂ᵢvⱼ∂ⱼvᵢ without the part of the background flow, Pa/m². Its Fourier transform divided by
//! −k², with k = k(cos θ, sin θ), p = P₀ + p̃ and prescribed mean P₀, is
//!
//! ```text
//! (1 − sin φ R) p̃ = −ŝ/k² + (P₀ sin φ + c cos φ) R 1,   R p = cos 2θ (cos 2ψ p)^ + sin 2θ (sin 2ψ p)^
//! ```
//!
//! where ^ denotes the Fourier transform and R 1 is R applied to the constant 1. ‖R‖ ≤ 1, so that p̃ is unique for any
//! ψ. The differential operator is not self-adjoint; for variable ψ its kernel is spanned not by a constant but by
//! another function of mean 1. Therefore p̃ has no mode 0, for which the equation reads 0 = 0, and the given P₀
//! replaces that mode, as in a bordered system.

use super::spectral::{FourierSeries, ModeWaveVector, ModeWaveVectors};
use models::common::elementary::Elementary;
use num_complex::Complex64;
use rayon::prelude::*;

/// Number of GMRES iterations before a restart.
const RESTART_LENGTH: usize = 30;
/// Number of GMRES iterations from which on there is no further restart.
const MAX_ITERATIONS: usize = 300;

/// Mean square variation of (cos 2ψ, sin 2ψ) below which a flow is nearly uniform: an iteration divides the residual by at
/// least about 100.
const NEARLY_UNIFORM: f64 = 1e-4;
/// Relative residual below which the estimate of the iteration may differ from the residual by rounding.
const LEAST_ESTIMATED_RESIDUAL: f64 = 1e-11;

/// Pressure equation for a given field of the stress angle ψ.
pub(super) struct PressureEquation<'a> {
    pub(super) waves: &'a ModeWaveVectors,
    pub(super) sin_phi: f64,
    /// cos 2ψ and sin 2ψ of the stress angle ψ at the points.
    pub(super) stress_double_angle: [&'a [f64]; 2],
    /// Means of cos 2ψ and sin 2ψ over the box.
    pub(super) mean_double_angle: [f64; 2],
}

impl PressureEquation<'_> {
    /// Returns the preconditioner of a mode: the inverse of the operator 1 − sin φ R with N replaced by its mean over
    /// the box.
    #[inline(always)]
    fn preconditioner(&self, wave: &ModeWaveVector) -> f64 {
        let ([cos, sin], [mean_cos, mean_sin]) = (wave.double_angle, self.mean_double_angle);
        1.0 / (1.0 - self.sin_phi * (mean_cos * cos + mean_sin * sin))
    }
}

/// Number of iterations and accuracy of a solution of the pressure equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Convergence {
    pub(super) iterations: usize,
    /// Norm of the residual divided by that of the right-hand side.
    pub(super) residual: f64,
}

/// Pressure solver: buffers of the GMRES iteration.
pub(super) struct PressureSolver {
    /// Orthonormal basis of the Krylov space.
    basis: Vec<Vec<Complex64>>,
    /// Function to which the operator is applied, at the points.
    point_values: Vec<f64>,
    /// Modes of the products of this function with cos 2ψ and sin 2ψ.
    products: [Vec<Complex64>; 2],
    operator_result: Vec<Complex64>,
    correction: Vec<Complex64>,
}

impl PressureSolver {
    pub(super) fn new(series: &FourierSeries) -> Self {
        let modes = || vec![Complex64::ZERO; series.mode_count()];
        Self {
            basis: Vec::new(),
            point_values: vec![0.0; series.points().iter().product()],
            products: [modes(), modes()],
            operator_result: modes(),
            correction: modes(),
        }
    }

    /// Computes `operator_result` = (1 − sin φ R) f p, with the modes of p multiplied by f = `factor` of their wave
    /// vectors.
    fn apply_operator(
        &mut self,
        series: &mut FourierSeries,
        equation: &PressureEquation,
        factor: impl Fn(&ModeWaveVector) -> f64 + Sync,
        p: &[Complex64],
    ) {
        series.transform_inverse(
            p,
            equation.waves,
            |wave| factor(wave).into(),
            &mut self.point_values,
        );
        let values = &self.point_values;
        for (direction, product) in equation.stress_double_angle.iter().zip(&mut self.products) {
            series.transform_forward(|point| values[point] * direction[point], product);
        }
        let [cosine_product, sine_product] = &self.products;
        series.fill_modes(&mut self.operator_result, equation.waves, |wave, i| {
            let [cos, sin] = wave.double_angle;
            factor(wave) * p[i]
                - equation.sin_phi * (cos * cosine_product[i] + sin * sine_product[i])
        });
    }

    /// Computes `operator_result` = `right` − (1 − sin φ R) p, the residual; returns its norm.
    fn compute_residual(
        &mut self,
        series: &mut FourierSeries,
        equation: &PressureEquation,
        right: &[Complex64],
        p: &[Complex64],
    ) -> f64 {
        self.apply_operator(series, equation, |_| 1.0, p);
        axpby(&mut self.operator_result, -1.0, right, 1.0);
        series.mean_product(&self.operator_result, &self.operator_result).sqrt()
    }

    /// Solves for p̃ by restarted GMRES (Saad & Schultz 1986) with right preconditioning; `p` holds the initial guess. In a
    /// nearly uniform flow the preconditioner is nearly the inverse, and the iteration starts from zero, which saves the
    /// residual of the guess.
    ///
    /// # Errors
    /// Iterations and residual if the tolerance is not reached or the residual is not finite.
    pub(super) fn solve(
        &mut self,
        series: &mut FourierSeries,
        equation: &PressureEquation,
        right: &[Complex64],
        tolerance: f64,
        p: &mut [Complex64],
    ) -> Result<Convergence, Convergence> {
        let size = series.mean_product(right, right).sqrt();
        let residual_limit = tolerance * size;
        let [mean_cos, mean_sin] = equation.mean_double_angle;
        // The mean square of the deviation of (cos 2ψ, sin 2ψ) from its mean.
        let variation = 1.0 - (mean_cos * mean_cos + mean_sin * mean_sin);
        let (mut iterations, mut residual) = if variation < NEARLY_UNIFORM {
            p.fill(Complex64::ZERO);
            self.operator_result.copy_from_slice(right);
            (0, size)
        } else {
            (0, self.compute_residual(series, equation, right, p))
        };
        loop {
            let relative = if size > 0.0 { residual / size } else { 0.0 };
            let solved = Convergence { iterations, residual: relative };
            if residual <= residual_limit || size == 0.0 {
                return Ok(solved);
            }
            if iterations >= MAX_ITERATIONS || !residual.is_finite() {
                return Err(solved);
            }
            // Arnoldi process; Givens rotations make the Hessenberg matrix triangular.
            let mut triangle: Vec<Vec<f64>> = Vec::new();
            let mut rotations: Vec<[f64; 2]> = Vec::new();
            let mut rotated_residual = vec![residual];
            self.store_basis_vector(0, 1.0 / residual);
            while triangle.len() < RESTART_LENGTH && residual > residual_limit {
                let last = triangle.len();
                let basis_vector = std::mem::take(&mut self.basis[last]);
                self.apply_operator(
                    series,
                    equation,
                    |wave| equation.preconditioner(wave),
                    &basis_vector,
                );
                self.basis[last] = basis_vector;
                let mut column = Vec::with_capacity(last + 2);
                for basis_vector in &self.basis[..=last] {
                    let projection = series.mean_product(basis_vector, &self.operator_result);
                    axpby(&mut self.operator_result, 1.0, basis_vector, -projection);
                    column.push(projection);
                }
                let norm = series.mean_product(&self.operator_result, &self.operator_result).sqrt();
                if norm > 0.0 {
                    self.store_basis_vector(last + 1, 1.0 / norm);
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
                rotated_residual.push(-sin * rotated_residual[last]);
                rotated_residual[last] *= cos;
                residual = rotated_residual[last + 1].abs();
                triangle.push(column);
                iterations += 1;
            }
            // Back substitution and linear combination of the basis.
            self.correction.fill(Complex64::ZERO);
            for i in (0..triangle.len()).rev() {
                let factor = rotated_residual[i] / triangle[i][i];
                for (rotated_residual, entry) in rotated_residual[..i].iter_mut().zip(&triangle[i])
                {
                    *rotated_residual -= factor * entry;
                }
                axpby(&mut self.correction, 1.0, &self.basis[i], factor);
            }
            let sum = &self.correction;
            series.fill_modes(&mut self.operator_result, equation.waves, |wave, i| {
                equation.preconditioner(wave) * sum[i]
            });
            axpby(p, 1.0, &self.operator_result, 1.0);
            if residual > residual_limit || tolerance < LEAST_ESTIMATED_RESIDUAL {
                residual = self.compute_residual(series, equation, right, p);
            }
        }
    }

    /// Sets basis vector `index` to `factor`·`operator_result`.
    fn store_basis_vector(&mut self, index: usize, factor: f64) {
        if self.basis.len() == index {
            self.basis.push(vec![Complex64::ZERO; self.operator_result.len()]);
        }
        axpby(&mut self.basis[index], 0.0, &self.operator_result, factor);
    }
}

/// Assembles the right-hand side of the pressure equation from the modes of s, cos 2ψ and sin 2ψ; `stress` = P₀ sin φ +
/// c cos φ, Pa.
pub(super) fn assemble_right_hand_side(
    series: &FourierSeries,
    waves: &ModeWaveVectors,
    source: &[Complex64],
    [cos, sin]: [&[Complex64]; 2],
    stress: f64,
    right_hand_side: &mut [Complex64],
) {
    series.fill_modes(right_hand_side, waves, |wave, i| {
        let [cos_wave, sin_wave] = wave.double_angle;
        stress * (cos_wave * cos[i] + sin_wave * sin[i]) - wave.inverse_square * source[i]
    });
}

/// Computes y ← βy + αx.
pub(super) fn axpby(y: &mut [Complex64], beta: f64, x: &[Complex64], alpha: f64) {
    const CHUNK_LENGTH: usize = 2048;
    y.par_chunks_mut(CHUNK_LENGTH).zip(x.par_chunks(CHUNK_LENGTH)).for_each(|(y, x)| {
        for (y, x) in y.iter_mut().zip(x) {
            *y = beta * *y + alpha * x;
        }
    });
}
