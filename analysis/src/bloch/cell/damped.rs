//! Damped modes of a cell with viscous joints, by a first-order system with internal variables.
//!
//! With the openings d = Bu at the quadrature points, delayed openings e and the instantaneous stiffness K of the
//! joints,
//!
//! ```text
//! u̇ = v,    M v̇ = −K(κ)u + B* WK e,    τė = C₁K(Bu − e) − e,
//! ```
//!
//! with the quadrature weights W. The eigenvalues iω are those of a matrix in the unknowns Λ^½Q*L*u, Q*L*v, √(WK)e with
//! M = LL* and L⁻¹KL⁻* = QΛQ*: all its entries are rates, and without viscosity it is antisymmetric.

use super::CellModel;
use super::modes::EIGENVALUES_NOT_CONVERGED;
use crate::bloch::BlochError;
use crate::dense::{eigenvalues, hermitian_eigenvalues};
use models::common::elementary::cr_cis;
use nalgebra::DMatrix;
use num_complex::Complex64;

/// Bound on the rounding error of eigenvalues per unknown, relative to the norm of the matrix.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Frequencies below this fraction of the largest count as zero: the square root of the rounding error.
const ZERO_FREQUENCY: f64 = 1e-7;

/// Modes of a cell with viscous joints at a wave vector, in e^{iωt}.
#[derive(Clone, Debug, PartialEq)]
pub struct DampedModes {
    /// Complex angular frequencies ω of waves that travel or oscillate, Re ω > 0, rad/s, ascending in Re ω; Im ω > 0
    /// for waves that decay.
    pub frequencies: Vec<Complex64>,
    /// Decay rates Im ω of modes without oscillation, 1/s, ascending; negative for modes that grow.
    pub decay_rates: Vec<f64>,
    /// Bound on the rounding error of simple eigenvalues, rad/s; the error of double ones is larger.
    pub rounding: f64,
}

impl DampedModes {
    /// Whether no mode grows by more than rounding.
    pub fn is_stable(&self) -> bool {
        let mut rates =
            self.frequencies.iter().map(|omega| omega.im).chain(self.decay_rates.iter().copied());
        rates.all(|rate| rate >= -self.rounding)
    }
}

impl CellModel {
    /// All modes of a cell with or without viscous joints at the wave vector κ, 1/m.
    ///
    /// # Errors
    /// κ is not finite, or the iteration for eigenvalues does not converge.
    pub fn damped_modes(&self, wave_vector: [f64; 2]) -> Result<DampedModes, BlochError> {
        let (reduced_stiffness, factor) = self.reduced_stiffness(wave_vector)?;
        let (size, count) = (self.size(), self.delayed_openings.len());
        // G* = L⁻¹ B* √(WK).
        let mut openings = DMatrix::<Complex64>::zeros(size, count);
        for (column, opening) in self.delayed_openings.iter().enumerate() {
            let scale = (opening.quadrature_weight * opening.stiffness).sqrt();
            let phases = [0, 1].map(|axis| wave_vector[axis] * self.periods[axis]);
            let angle =
                f64::from(opening.shift[0]) * phases[0] + f64::from(opening.shift[1]) * phases[1];
            // Conjugate of e^{−iκ·a}: the adjoint of B.
            let factors = [Complex64::from(-scale), cr_cis(angle) * scale];
            for side in 0..2 {
                for (i, value) in opening.polynomial_values[side].iter().enumerate() {
                    openings[(opening.first_unknowns[side] + i, column)] += factors[side] * value;
                }
            }
        }
        let openings = factor.solve_lower_triangular(&openings).ok_or(EIGENVALUES_NOT_CONVERGED)?;
        // Modes of the instantaneous stiffness: L⁻¹KL⁻* = QΛQ*, G ← GQ.
        let (squares, vectors) =
            hermitian_eigenvalues(reduced_stiffness, true).ok_or(EIGENVALUES_NOT_CONVERGED)?;
        let openings = vectors.ok_or(EIGENVALUES_NOT_CONVERGED)?.adjoint() * openings;
        let largest = squares.iter().fold(0.0, |a: f64, b| a.max(b.abs())).sqrt();
        let mut matrix = DMatrix::<Complex64>::zeros(2 * size + count, 2 * size + count);
        for (i, square) in squares.iter().enumerate() {
            let frequency = square.abs().sqrt();
            matrix[(i, size + i)] = Complex64::from(frequency);
            matrix[(size + i, i)] = Complex64::from(-frequency.copysign(*square));
        }
        matrix.view_mut((size, 2 * size), (size, count)).copy_from(&openings);
        for (row, opening) in self.delayed_openings.iter().enumerate() {
            let rate = 1.0 / opening.delay.retardation_time;
            let coupling = opening.delay.compliance * opening.stiffness * rate;
            for (i, square) in squares.iter().enumerate() {
                // Modes of zero frequency do not open joints.
                let frequency = square.abs().sqrt();
                if frequency > ZERO_FREQUENCY * largest {
                    matrix[(2 * size + row, i)] =
                        openings[(i, row)].conj() * (coupling / frequency);
                }
            }
            matrix[(2 * size + row, 2 * size + row)] = Complex64::from(-coupling - rate);
        }
        let rounding = ROUNDING * matrix.nrows() as f64 * matrix.norm();
        let values = eigenvalues(matrix).ok_or(EIGENVALUES_NOT_CONVERGED)?;
        let omegas = values.iter().map(|value| -Complex64::i() * value);
        let (mut frequencies, mut others): (Vec<Complex64>, Vec<Complex64>) =
            omegas.partition(|omega| omega.re > rounding);
        others.retain(|omega| omega.re >= -rounding);
        frequencies.sort_by(|a, b| a.re.total_cmp(&b.re));
        let mut decay_rates: Vec<f64> = others.iter().map(|omega| omega.im).collect();
        decay_rates.sort_by(f64::total_cmp);
        Ok(DampedModes { frequencies, decay_rates, rounding })
    }
}
