//! The pressure that keeps a flow free of divergence.
//!
//! ```text
//! ∂ᵢ∂ⱼ[(δᵢⱼ − sin φ Nᵢⱼ) p] = s + c cos φ ∂ᵢ∂ⱼNᵢⱼ,   N = [[cos 2ψ, sin 2ψ], [sin 2ψ, −cos 2ψ]]
//! ```
//!
//! Over −k², with k = k(cos θ, sin θ), and with the mean P₀ of p prescribed, p = P₀ + p̃:
//!
//! ```text
//! (1 − sin φ R) p̃ = −ŝ/k² + (P₀ sin φ + c cos φ) R 1,   R p = cos 2θ (cos 2ψ p)^ + sin 2θ (sin 2ψ p)^
//! ```
//!
//! R has norm 1 at most, so that there is just one p̃ for any ψ. The operator is not self-adjoint, and where
//! ψ varies its kernel is not the constants but one function of mean 1: p̃ leaves the mode 0 out, where the
//! equation says 0 = 0, and P₀ takes its place, as a bordered system would have it.

use super::spectral::{Series, Waves};
use num_complex::Complex64;
use rayon::prelude::*;

/// Iterations after which the basis is thrown away.
const RESTART: usize = 30;
/// Iterations after which there is no pressure.
const MOST: usize = 300;

/// cos 2θ and sin 2θ of a wave vector; of none (0, 0).
#[inline(always)]
fn doubled([k1, k2]: [f64; 2]) -> [f64; 2] {
    let square = k1 * k1 + k2 * k2;
    if square == 0.0 { [0.0; 2] } else { [(k1 * k1 - k2 * k2) / square, 2.0 * k1 * k2 / square] }
}

/// The equation for one field of ψ.
pub(super) struct Equation<'a> {
    pub(super) waves: Waves,
    pub(super) sin_phi: f64,
    /// cos 2ψ and sin 2ψ at the points.
    pub(super) direction: [&'a [f64]; 2],
    /// Means of both.
    pub(super) mean: [f64; 2],
}

/// What a solution took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Solved {
    pub(super) iterations: usize,
    /// Norm of the residual over that of the right-hand side.
    pub(super) residual: f64,
}

/// Memory of the solver.
#[derive(Default)]
pub(super) struct Solver {
    /// Orthonormal basis of the Krylov space.
    basis: Vec<Vec<Complex64>>,
    /// One factor of products at the points, and the other.
    pressure: Vec<f64>,
    product: Vec<f64>,
    modes: [Vec<Complex64>; 2],
}

impl Solver {
    pub(super) fn new(series: &Series) -> Self {
        let [columns, rows] = series.points();
        Self {
            basis: Vec::new(),
            pressure: vec![0.0; columns * rows],
            product: vec![0.0; columns * rows],
            modes: [vec![Complex64::ZERO; series.count()], vec![Complex64::ZERO; series.count()]],
        }
    }

    /// `out` = (1 − sin φ R) p of a p of mean 0.
    fn apply(
        &mut self,
        series: &mut Series,
        equation: &Equation,
        p: &[Complex64],
        out: &mut [Complex64],
    ) {
        series.inverse(p, &equation.waves, |_| Complex64::ONE, &mut self.pressure);
        for (direction, modes) in equation.direction.iter().zip(&mut self.modes) {
            multiply(&self.pressure, direction, &mut self.product);
            series.forward(&self.product, modes);
        }
        let [one, other] = &self.modes;
        series.fill(out, &equation.waves, |k, i| {
            let [cos, sin] = doubled(k);
            p[i] - equation.sin_phi * (cos * one[i] + sin * other[i])
        });
    }

    /// Solves for p̃, from what stands there, by GMRES (Saad & Schultz 1986), preconditioned from the right
    /// by the operator of the mean of N.
    ///
    /// # Errors
    /// What was reached where the tolerance was not.
    pub(super) fn solve(
        &mut self,
        series: &mut Series,
        equation: &Equation,
        right: &[Complex64],
        tolerance: f64,
        p: &mut [Complex64],
    ) -> Result<Solved, Solved> {
        let goal = tolerance * series.product(right, right).sqrt();
        let norm_of = |residual: f64| if goal > 0.0 { residual * tolerance / goal } else { 0.0 };
        let precondition = |series: &Series, from: &[Complex64], to: &mut [Complex64]| {
            series.fill(to, &equation.waves, |k, i| {
                let ([cos, sin], [mean_cos, mean_sin]) = (doubled(k), equation.mean);
                from[i] / (1.0 - equation.sin_phi * (mean_cos * cos + mean_sin * sin))
            });
        };
        let mut iterations = 0;
        let mut work = vec![Complex64::ZERO; p.len()];
        loop {
            self.apply(series, equation, p, &mut work);
            combine(&mut work, -1.0, right, 1.0);
            let mut residual = series.product(&work, &work).sqrt();
            // No residual can be told from rounding below its part of the right-hand side.
            if residual <= goal || goal == 0.0 {
                return Ok(Solved { iterations, residual: norm_of(residual) });
            }
            if iterations >= MOST || !residual.is_finite() {
                return Err(Solved { iterations, residual: norm_of(residual) });
            }
            // Arnoldi's process; rotations make the matrix triangular.
            let mut triangle: Vec<Vec<f64>> = Vec::new();
            let mut rotations: Vec<[f64; 2]> = Vec::new();
            let mut rest = vec![residual];
            self.keep(0, &work, 1.0 / residual);
            while triangle.len() < RESTART && residual > goal {
                let last = triangle.len();
                precondition(series, &self.basis[last], &mut work);
                let mut next = vec![Complex64::ZERO; p.len()];
                self.apply(series, equation, &work, &mut next);
                let mut column = Vec::with_capacity(last + 2);
                for own in &self.basis[..=last] {
                    let part = series.product(own, &next);
                    combine(&mut next, 1.0, own, -part);
                    column.push(part);
                }
                let norm = series.product(&next, &next).sqrt();
                if norm > 0.0 {
                    self.keep(last + 1, &next, 1.0 / norm);
                }
                for (i, [cos, sin]) in rotations.iter().enumerate() {
                    let (upper, lower) = (column[i], column[i + 1]);
                    (column[i], column[i + 1]) =
                        (cos * upper + sin * lower, cos * lower - sin * upper);
                }
                let length = column[last].hypot(norm);
                let [cos, sin] = [column[last] / length, norm / length];
                column[last] = length;
                rotations.push([cos, sin]);
                rest.push(-sin * rest[last]);
                rest[last] *= cos;
                residual = rest[last + 1].abs();
                triangle.push(column);
                iterations += 1;
            }
            // Back substitution, and the combination of the basis.
            let mut sum = vec![Complex64::ZERO; p.len()];
            for i in (0..triangle.len()).rev() {
                let factor = rest[i] / triangle[i][i];
                for (rest, entry) in rest[..i].iter_mut().zip(&triangle[i]) {
                    *rest -= factor * entry;
                }
                combine(&mut sum, 1.0, &self.basis[i], factor);
            }
            precondition(series, &sum, &mut work);
            combine(p, 1.0, &work, 1.0);
        }
    }

    /// Makes `factor` times `vector` an entry of the basis.
    fn keep(&mut self, index: usize, vector: &[Complex64], factor: f64) {
        if self.basis.len() == index {
            self.basis.push(vec![Complex64::ZERO; vector.len()]);
        }
        combine(&mut self.basis[index], 0.0, vector, factor);
    }
}

/// The right-hand side, from the modes of s, and of cos 2ψ and sin 2ψ.
pub(super) fn right_hand_side(
    series: &Series,
    waves: &Waves,
    source: &[Complex64],
    [cos, sin]: [&[Complex64]; 2],
    stress: f64,
    out: &mut [Complex64],
) {
    series.fill(out, waves, |k, i| {
        let square = k[0] * k[0] + k[1] * k[1];
        if square == 0.0 {
            return Complex64::ZERO;
        }
        let [cos_wave, sin_wave] = doubled(k);
        stress * (cos_wave * cos[i] + sin_wave * sin[i]) - source[i] / square
    });
}

/// `out` = a·b, point by point.
fn multiply(a: &[f64], b: &[f64], out: &mut [f64]) {
    const PART: usize = 4096;
    out.par_chunks_mut(PART).zip(a.par_chunks(PART).zip(b.par_chunks(PART))).for_each(
        |(out, (a, b))| {
            for (out, (a, b)) in out.iter_mut().zip(a.iter().zip(b)) {
                *out = a * b;
            }
        },
    );
}

/// `out` = own·out + other·b.
pub(super) fn combine(out: &mut [Complex64], own: f64, b: &[Complex64], other: f64) {
    const PART: usize = 2048;
    out.par_chunks_mut(PART).zip(b.par_chunks(PART)).for_each(|(out, b)| {
        for (out, b) in out.iter_mut().zip(b) {
            *out = own * *out + other * b;
        }
    });
}
