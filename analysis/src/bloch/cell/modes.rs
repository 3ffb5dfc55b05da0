//! Lowest modes of a cell at a wave vector, and choice of the polynomial degree.

use super::{Cell, CellModel};
use crate::bloch::{BlochError, ensure};
use crate::dense::hermitian_eigenvalues;
use nalgebra::{Cholesky, DMatrix, DVector};
use num_complex::Complex64;

/// Bound on the rounding error of ω² per unknown, relative to the largest ω² of the discretisation.
const ROUNDING: f64 = f64::EPSILON;
/// Increment of the polynomial degree.
const DEGREE_STEP: usize = 2;
/// Multiple of the rounding bound below which an ω² is left out of relative changes.
const ZERO_SQUARE_ROUNDINGS: f64 = 4.0;

/// Lowest modes at a wave vector, ascending in ω².
#[derive(Clone, Debug, PartialEq)]
pub struct BlochModes {
    /// Squared angular frequencies ω², rad²/s²; negative for growing modes e^{±|ω|t}.
    pub squared_frequencies: Vec<f64>,
    /// Bound on the rounding error of ω², rad²/s².
    pub rounding: f64,
    /// Eigenvectors u of the unknowns by columns, u* M u = 1; empty unless requested.
    pub eigenvectors: DMatrix<Complex64>,
}

/// Lowest frequencies for a polynomial degree that meets the requested tolerance.
///
/// At the corners of blocks, where two joints may impose different shear stresses, the displacement has a singularity r
/// log r, and the error of ω² decreases as (p + ½)^(−q) with q of [`CellModel::convergence_order`]. Extrapolation from
/// two degrees removes most of this error; for smooth solutions the correction is negligible.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergedModes {
    /// Squared angular frequencies extrapolated from the last two degrees, rad²/s², ascending.
    pub squared_frequencies: Vec<f64>,
    /// Modes for the last degree, without extrapolation; their ω² are upper bounds of the exact ones.
    pub modes: BlochModes,
    /// Last degree p of the Legendre polynomials.
    pub degree: usize,
    /// Estimate of the largest relative error of a frequency: the change of the extrapolated frequencies when the
    /// degree was raised the last time. Above the tolerance if the largest degree was reached.
    pub frequency_error: f64,
}

impl ConvergedModes {
    /// Extrapolated angular frequencies, rad/s; zero for squared frequencies that are not positive.
    pub fn frequencies(&self) -> Vec<f64> {
        self.squared_frequencies.iter().map(|square| square.max(0.0).sqrt()).collect()
    }
}

/// Accuracy and range that control the degree of the Legendre polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DegreeControl {
    /// Requested relative accuracy of frequencies.
    pub tolerance: f64,
    /// Degree that is tried first.
    pub first_degree: usize,
    /// Largest degree that is tried.
    pub largest_degree: usize,
}

impl Default for DegreeControl {
    /// Relative accuracy 1e-6, degrees 4 to 16.
    fn default() -> Self {
        Self { tolerance: 1e-6, first_degree: 4, largest_degree: 16 }
    }
}

impl BlochModes {
    /// Angular frequencies, rad/s; zero for squared frequencies that are not positive.
    pub fn frequencies(&self) -> Vec<f64> {
        self.squared_frequencies.iter().map(|square| square.max(0.0).sqrt()).collect()
    }

    /// Whether all frequencies are real within rounding, so that no mode grows.
    pub fn is_stable(&self) -> bool {
        self.squared_frequencies.iter().all(|&square| square >= -self.rounding)
    }
}

/// Largest relative difference of two lists of frequencies, given by their squares; squares up to `floor` are left out.
fn relative_change(squares: &[f64], others: &[f64], floor: f64) -> f64 {
    let size = |x: f64, y: f64| x.abs().max(y.abs());
    let pairs = squares.iter().zip(others).filter(|(x, y)| size(**x, **y) > floor);
    pairs.map(|(x, y)| 0.5 * (x - y).abs() / size(*x, *y)).fold(0.0, f64::max)
}

/// Extrapolates values from the degrees p − [`DEGREE_STEP`] and p to infinite degree, for errors ∝ (p + ½)^(−`order`).
fn extrapolate_to_infinite_degree(
    coarse: &[f64],
    fine: &[f64],
    degree: usize,
    order: i32,
) -> Vec<f64> {
    let shifted = degree as f64 + 0.5;
    let ratio = (shifted / (shifted - DEGREE_STEP as f64)).powi(order);
    coarse.iter().zip(fine).map(|(coarse, fine)| fine + (fine - coarse) / (ratio - 1.0)).collect()
}

/// Error: the iteration for the eigenvalues of a Bloch wave did not converge.
pub(super) const EIGENVALUES_NOT_CONVERGED: BlochError =
    BlochError::NotConverged { iteration: "the iteration for eigenvalues" };

impl CellModel {
    /// Reduces K u = ω²M u to a standard eigenproblem: the Hermitian matrix L⁻¹KL⁻*, 1/s², at the wave vector κ, 1/m,
    /// and the Cholesky factor L of M = LL*.
    pub(super) fn reduced_stiffness(
        &self,
        wave_vector: [f64; 2],
    ) -> Result<(DMatrix<Complex64>, DMatrix<Complex64>), BlochError> {
        for component in wave_vector {
            ensure(component.is_finite(), "wave_vector", component, "finite numbers")?;
        }
        let [stiffness, mass] = self.matrices(wave_vector);
        let factor = Cholesky::new(mass).ok_or(EIGENVALUES_NOT_CONVERGED)?.unpack();
        let half = factor.solve_lower_triangular(&stiffness).ok_or(EIGENVALUES_NOT_CONVERGED)?;
        let reduced_stiffness =
            factor.solve_lower_triangular(&half.adjoint()).ok_or(EIGENVALUES_NOT_CONVERGED)?;
        Ok(((&reduced_stiffness + reduced_stiffness.adjoint()) * Complex64::from(0.5), factor))
    }

    /// The lowest `count` modes at the wave vector κ, 1/m; fewer if the discretisation has fewer.
    ///
    /// # Errors
    /// κ is not finite, a joint is viscous (see [`damped_modes`](Self::damped_modes)), or the iteration for eigenvalues
    /// does not converge.
    pub fn modes(
        &self,
        wave_vector: [f64; 2],
        count: usize,
        with_vectors: bool,
    ) -> Result<BlochModes, BlochError> {
        if !self.delayed_openings.is_empty() {
            return Err(BlochError::ViscousJoint);
        }
        let (reduced_stiffness, factor) = self.reduced_stiffness(wave_vector)?;
        let (values, vectors) = hermitian_eigenvalues(reduced_stiffness, with_vectors)
            .ok_or(EIGENVALUES_NOT_CONVERGED)?;
        let size = self.size();
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
        let largest = values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        order.truncate(count);
        let vectors = match vectors {
            None => DMatrix::zeros(0, 0),
            Some(vectors) => {
                let columns: Vec<DVector<Complex64>> =
                    order.iter().map(|&i| vectors.column(i).into_owned()).collect();
                match columns.is_empty() {
                    true => DMatrix::zeros(size, 0),
                    false => factor
                        .adjoint()
                        .solve_upper_triangular(&DMatrix::from_columns(&columns))
                        .ok_or(EIGENVALUES_NOT_CONVERGED)?,
                }
            }
        };
        Ok(BlochModes {
            squared_frequencies: order.iter().map(|&i| values[i]).collect(),
            rounding: ROUNDING * size as f64 * largest,
            eigenvectors: vectors,
        })
    }
}

impl Cell {
    /// Solves for the lowest `count` frequencies at the wave vector κ, 1/m. The degree is raised by 2 until no
    /// extrapolated frequency changes by more than the tolerance, at most to the largest degree.
    ///
    /// # Errors
    /// κ is not finite, or the iteration for eigenvalues does not converge.
    pub fn solve(
        &self,
        wave_vector: [f64; 2],
        count: usize,
        control: &DegreeControl,
    ) -> Result<ConvergedModes, BlochError> {
        let mut degree = control.first_degree.max(1);
        let mut modes = CellModel::new(self, degree).modes(wave_vector, count, false)?;
        let mut squares = modes.squared_frequencies.clone();
        let (mut frequency_error, mut has_extrapolated) = (f64::INFINITY, false);
        while degree + DEGREE_STEP <= control.largest_degree && frequency_error > control.tolerance
        {
            degree += DEGREE_STEP;
            let model = CellModel::new(self, degree);
            let finer = model.modes(wave_vector, count, false)?;
            let [coarse, fine] = [&modes, &finer].map(|modes| &modes.squared_frequencies);
            let next =
                extrapolate_to_infinite_degree(coarse, fine, degree, model.convergence_order());
            if has_extrapolated && squares.len() == finer.squared_frequencies.len() {
                let floor = ZERO_SQUARE_ROUNDINGS * finer.rounding.max(modes.rounding);
                frequency_error = relative_change(&squares, &next, floor);
            }
            has_extrapolated = next.len() == finer.squared_frequencies.len();
            (squares, modes) = (next, finer);
        }
        squares.sort_by(f64::total_cmp);
        Ok(ConvergedModes { squared_frequencies: squares, modes, degree, frequency_error })
    }
}
