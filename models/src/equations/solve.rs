//! Background derivatives from the equations, by Gauss–Newton iterations of least squares.

use super::error::EvaluationError;
use super::graph::JetVariable;
use super::model::TextModel;
use super::state::{TextState, TextWorkspace};
use crate::common::rounding::Rounded;
use crate::common::scalar::{Dual, Scalar};
use nalgebra::{DMatrix, DVector};

/// Largest number of iterations; equations that are linear in the derivatives need one.
const MAX_ITERATIONS: usize = 30;

/// Singular values below this fraction of the largest one count as zero.
const RANK_TOLERANCE: f64 = 1e-10;

impl TextModel {
    /// Determines the background derivatives that `state` asks for from the equations that are not driven, and stores
    /// them in `state` with bounds on their errors.
    ///
    /// # Errors
    /// The equations do not determine the derivatives, an expression is not defined, or the iteration does not converge.
    pub fn solve_background(
        &self,
        state: &mut TextState,
        workspace: &mut TextWorkspace,
    ) -> Result<(), EvaluationError> {
        let sought = state.solved.clone();
        if sought.is_empty() {
            return Ok(());
        }
        for &variable in &sought {
            if !state.background.iter().any(|(own, _)| *own == variable) {
                state.set_background(variable, Rounded::ZERO);
            }
        }
        let rows: Vec<usize> =
            (0..self.equations.len()).filter(|row| !self.is_driven[*row]).collect();
        for _ in 0..MAX_ITERATIONS {
            let residuals = self.residuals(state, workspace)?;
            let mut jacobian = DMatrix::zeros(rows.len(), sought.len());
            for (column, &variable) in sought.iter().enumerate() {
                let slopes = self.residual_slopes(state, variable)?;
                for (index, &row) in rows.iter().enumerate() {
                    jacobian[(index, column)] = slopes[row];
                }
            }
            // Rows in units of their largest entry, so that equations in other units weigh equally.
            let scales: Vec<f64> = (0..rows.len())
                .map(|index| {
                    let largest = jacobian.row(index).amax();
                    if largest > 0.0 { 1.0 / largest } else { 0.0 }
                })
                .collect();
            for (index, scale) in scales.iter().enumerate() {
                jacobian.row_mut(index).scale_mut(*scale);
            }
            let part = |of: fn(Rounded) -> f64| {
                let own = rows.iter().zip(&scales);
                DVector::from_iterator(
                    rows.len(),
                    own.map(|(&row, scale)| of(residuals[row].residual) * scale),
                )
            };
            let svd = jacobian.svd(true, true);
            let tolerance = RANK_TOLERANCE * svd.singular_values.max();
            let rank = svd.rank(tolerance.max(f64::MIN_POSITIVE));
            if rank < sought.len() {
                return Err(EvaluationError::NotDetermined { count: sought.len(), found: rank });
            }
            let Ok(inverse) = svd.pseudo_inverse(tolerance) else {
                return Err(EvaluationError::NoConvergence);
            };
            let step = &inverse * part(|own| own.value);
            // Errors of the residuals move the solution by at most these errors.
            let error = inverse.abs() * part(|own| own.bound);
            let mut is_converged = true;
            for (index, &variable) in sought.iter().enumerate() {
                let change = step[index].abs();
                let value = state.at_rest(variable).value - step[index];
                is_converged &= change <= error[index].max(1e-14 * value.abs());
                state.set_background(variable, Rounded::from_exact(value));
            }
            if is_converged {
                for (index, &variable) in sought.iter().enumerate() {
                    let value = state.at_rest(variable).value;
                    let bound = error[index] + step[index].abs() + f64::EPSILON * value.abs();
                    state.set_background(variable, Rounded { value, bound });
                }
                return Ok(());
            }
        }
        Err(EvaluationError::NoConvergence)
    }

    /// Derivatives of all residuals by a jet variable of the background in the frame at rest, by dual numbers.
    fn residual_slopes(
        &self,
        state: &TextState,
        variable: JetVariable,
    ) -> Result<Vec<f64>, EvaluationError> {
        // A jet variable of the moving frame is linear in the derivatives at rest; the velocity itself, which sets the
        // frame, is no derivative.
        let [mut without, mut with] = [state.clone(), state.clone()];
        without.set_background(variable, Rounded::ZERO);
        with.set_background(variable, Rounded::ONE);
        let jet = |own: JetVariable| {
            let [low, high] = [&without, &with].map(|state| self.background_jet(state, own).value);
            Dual { value: self.background_jet(state, own).value, slope: high - low }
        };
        let mut registers = Vec::new();
        let zero = |_| Dual::<f64>::from_exact(0.0);
        let found = self.evaluate_residuals(state, &mut registers, jet, zero)?;
        Ok(found.into_iter().map(|own| own.slope).collect())
    }
}
