//! Eigenvalues of dense matrices of any size.

use nalgebra::DMatrix;
use nalgebra::linalg::Schur;
use num_complex::Complex64;

/// The eigenvalues, each to rounding of the largest; `None` if the norm of the matrix is not finite, or the iteration
/// does not converge.
///
/// The iteration deflates by comparison with its diagonal, which eigenvalues of zero make vanish: it runs
/// on the matrix plus its norm.
pub(crate) fn eigenvalues(mut matrix: DMatrix<Complex64>) -> Option<Vec<Complex64>> {
    let shift = Complex64::from(matrix.norm());
    if !shift.is_finite() {
        return None;
    }
    for i in 0..matrix.nrows() {
        matrix[(i, i)] += shift;
    }
    // A unit in the last place is less than what rotations leave.
    let roots = Schur::try_new(matrix, 8.0 * f64::EPSILON, 10_000)?.eigenvalues()?;
    Some(roots.iter().map(|root| root - shift).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Else the iteration would take all of its steps on numbers that are none.
    #[test]
    fn a_norm_that_overflows_has_no_eigenvalues() {
        let matrix = |entry: f64| DMatrix::from_element(15, 15, Complex64::from(entry));
        assert_eq!(eigenvalues(matrix(1e308)), None);
        assert!(eigenvalues(matrix(1e100)).is_some());
    }
}
