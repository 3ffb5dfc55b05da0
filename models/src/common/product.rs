//! Real matrix products whose bits do not depend on the processor.
//!
//! `nalgebra` delegates products of real, dynamically sized matrices to the crate `matrixmultiply` if both factors have
//! more than five rows and columns; `matrixmultiply` uses fused multiply-add where the processor has it. Products of
//! complex matrices, matrix–vector products and decompositions do not call `matrixmultiply`.

use nalgebra::{DMatrix, Dim, Matrix, Storage};

/// Computes the matrix product AB column by column. The terms of an entry are added in the order of the summation
/// index, without fused multiply-add.
///
/// # Panics
/// The number of columns of A differs from the number of rows of B.
pub fn product<R1, C1, S1, R2, C2, S2>(
    a: &Matrix<f64, R1, C1, S1>,
    b: &Matrix<f64, R2, C2, S2>,
) -> DMatrix<f64>
where
    R1: Dim,
    C1: Dim,
    S1: Storage<f64, R1, C1>,
    R2: Dim,
    C2: Dim,
    S2: Storage<f64, R2, C2>,
{
    assert_eq!(a.ncols(), b.nrows(), "sizes that do not match");
    let mut result = DMatrix::zeros(a.nrows(), b.ncols());
    for (j, mut column) in result.column_iter_mut().enumerate() {
        for k in 0..a.ncols() {
            let factor = b[(k, j)];
            column
                .iter_mut()
                .zip(a.column(k).iter())
                .for_each(|(sum, entry)| *sum += entry * factor);
        }
    }
    result
}

/// Triple matrix product (AB)C.
pub fn triple_product(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>) -> DMatrix<f64> {
    product(&product(a, b), c)
}
