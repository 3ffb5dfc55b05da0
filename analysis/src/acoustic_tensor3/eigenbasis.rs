//! Eigenvectors of the elastic acoustic tensor Γₑ by Jacobi's method, and groups of equal eigenvalues.

/// Maximum number of velocities of a solid: three translations and three spins.
pub(super) const MAX_VELOCITIES: usize = 6;

/// Successive eigenvalues of Γₑ closer than this, relative to the larger, count as equal.
const EQUALITY_TOLERANCE: f64 = 1e-10;

/// Distinct eigenvalues of the elastic acoustic tensor Γₑ for one wave normal, ascending.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EigenvalueGroups {
    /// Number of distinct eigenvalues.
    pub(super) group_count: usize,
    pub(super) values: [f64; MAX_VELOCITIES],
    pub(super) multiplicities: [u8; MAX_VELOCITIES],
    /// Index of the group that contains each eigenvalue.
    pub(super) group_index: [u8; MAX_VELOCITIES],
}

/// Eigenvectors of the elastic acoustic tensor Γₑ for one wave normal, in columns.
pub(super) type Eigenbasis = [[f64; MAX_VELOCITIES]; MAX_VELOCITIES];

impl EigenvalueGroups {
    /// Groups eigenvalues that are equal within [`EQUALITY_TOLERANCE`].
    pub(super) fn new(eigenvalues: &[f64]) -> Self {
        let mut order: [usize; MAX_VELOCITIES] = std::array::from_fn(|i| i);
        let order = &mut order[..eigenvalues.len()];
        order.sort_by(|&i, &j| eigenvalues[i].total_cmp(&eigenvalues[j]));
        let mut groups = Self::default();
        let mut previous = f64::NEG_INFINITY;
        for &index in order.iter() {
            let value = eigenvalues[index];
            if value - previous > EQUALITY_TOLERANCE * value.abs() {
                groups.values[groups.group_count] = value;
                groups.group_count += 1;
            }
            previous = value;
            groups.group_index[index] = groups.group_count.saturating_sub(1) as u8;
            groups.multiplicities[groups.group_count.saturating_sub(1)] += 1;
        }
        groups
    }
}

/// Diagonalises a block of a symmetric matrix by Jacobi's method: eigenvalues on the diagonal, ascending. The columns
/// of `basis`, in which the matrix is given, are rotated into the eigenvectors.
pub(super) fn diagonalise(
    matrix: &mut Eigenbasis,
    basis: &mut Eigenbasis,
    (first, size): (usize, usize),
) {
    let range = first..first + size;
    let trace = range.clone().fold(0.0, |sum, i| sum + matrix[i][i].abs());
    for _ in 0..40 {
        let mut is_done = true;
        for p in range.clone() {
            for q in p + 1..first + size {
                let entry = matrix[p][q];
                if entry.abs() <= 1e-18 * trace {
                    continue;
                }
                is_done = false;
                let ratio = (matrix[q][q] - matrix[p][p]) / (2.0 * entry);
                let tangent = ratio.signum() / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
                let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                let sine = tangent * cosine;
                matrix[p][p] -= tangent * entry;
                matrix[q][q] += tangent * entry;
                matrix[p][q] = 0.0;
                matrix[q][p] = 0.0;
                for i in range.clone() {
                    if i != p && i != q {
                        let (x, y) = (matrix[i][p], matrix[i][q]);
                        matrix[i][p] = cosine * x - sine * y;
                        matrix[i][q] = sine * x + cosine * y;
                        matrix[p][i] = matrix[i][p];
                        matrix[q][i] = matrix[i][q];
                    }
                    let (x, y) = (basis[i][p], basis[i][q]);
                    basis[i][p] = cosine * x - sine * y;
                    basis[i][q] = sine * x + cosine * y;
                }
            }
        }
        if is_done {
            break;
        }
    }
    for end in (first + 1..first + size).rev() {
        for p in first..end {
            if matrix[p][p] > matrix[p + 1][p + 1] {
                let lower = matrix[p][p];
                matrix[p][p] = matrix[p + 1][p + 1];
                matrix[p + 1][p + 1] = lower;
                for row in &mut basis[range.clone()] {
                    row.swap(p, p + 1);
                }
            }
        }
    }
}

pub(super) fn new_identity() -> Eigenbasis {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
}
