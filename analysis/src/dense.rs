//! Eigenvalues of dense matrices of any size.

use nalgebra::linalg::Schur;
use nalgebra::{DMatrix, SymmetricEigen};
use num_complex::Complex64;

/// Eigenvalues of a dense complex matrix by the Schur form (QR algorithm), each accurate to the rounding of the largest
/// one; `None` if the norm is not finite or the iteration does not converge.
///
/// Deflation compares with the diagonal, which vanishes for zero eigenvalues, so the matrix is shifted by its norm.
pub(crate) fn eigenvalues(mut matrix: DMatrix<Complex64>) -> Option<Vec<Complex64>> {
    let shift = Complex64::from(matrix.norm());
    if !shift.is_finite() {
        return None;
    }
    for i in 0..matrix.nrows() {
        matrix[(i, i)] += shift;
    }
    // Tolerance above the rounding of the rotations.
    let roots = Schur::try_new(matrix, 8.0 * f64::EPSILON, 10_000)?.eigenvalues()?;
    Some(roots.iter().map(|root| root - shift).collect())
}

/// Eigenvalues, not sorted, and optionally eigenvectors of a Hermitian matrix; `None` if an entry is not finite or the
/// iteration does not converge.
pub(crate) fn hermitian_eigenvalues(
    matrix: DMatrix<Complex64>,
    with_vectors: bool,
) -> Option<(Vec<f64>, Option<DMatrix<Complex64>>)> {
    if !matrix.norm().is_finite() {
        return None;
    }
    if !with_vectors {
        return Some((matrix.symmetric_eigenvalues().iter().copied().collect(), None));
    }
    let decomposition = SymmetricEigen::try_new(matrix, f64::EPSILON, 100_000)?;
    let values = decomposition.eigenvalues.iter().copied().collect();
    Some((values, Some(decomposition.eigenvectors)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verifies that an overflowing norm returns `None` at once; the QR iteration on NaN would run to its step limit.
    #[test]
    fn eigenvalues_are_none_if_the_norm_overflows() {
        let matrix = |entry: f64| DMatrix::from_element(15, 15, Complex64::from(entry));
        assert_eq!(eigenvalues(matrix(1e308)), None);
        assert!(eigenvalues(matrix(1e100)).is_some());
    }
}
