//! Rank-one update −αβᵀ of the acoustic tensor in a direction.

use super::eigenbasis::{Basis, Groups, SIZE};
use super::elastic_waves::AcousticTensor3;
use super::error::SphereError;
use super::rank_one::RankOne;
use super::secular_equation::{Secular, secular};

/// Threshold of zero for the weights w_g, relative to |α||β|.
pub(super) const NO_WEIGHT: f64 = 1e-15;

/// α and β as linear functions of the wave normal.
pub(super) struct Change {
    pub(super) size: usize,
    pub(super) alpha: [[f64; 3]; SIZE],
    pub(super) beta: [[f64; 3]; SIZE],
    /// A bound on |α||β| over all normals.
    pub(super) largest: f64,
}

impl Change {
    /// Secular equation in the direction `normal`, from the eigenvectors and the grouped eigenvalues of Γₑ there.
    pub(super) fn at(&self, normal: &[f64; 3], basis: &Basis, groups: &Groups) -> Secular {
        let product = |row: &[f64; 3]| row[0] * normal[0] + row[1] * normal[1] + row[2] * normal[2];
        let (mut alpha, mut beta) = ([0.0; SIZE], [0.0; SIZE]);
        let rows = self.alpha.iter().zip(&self.beta).zip(basis).take(self.size);
        for ((own_alpha, own_beta), row) in rows {
            let (a, b) = (product(own_alpha), product(own_beta));
            for k in 0..self.size {
                alpha[k] += row[k] * a;
                beta[k] += row[k] * b;
            }
        }
        let mut products = [0.0; SIZE];
        for k in 0..self.size {
            products[k] = alpha[k] * beta[k];
        }
        let square = |x: &[f64; SIZE]| x.iter().fold(0.0, |sum, x| sum + x * x);
        secular(groups, &products[..self.size], NO_WEIGHT * (square(&alpha) * square(&beta)).sqrt())
    }
}

impl AcousticTensor3 {
    /// Projects the update to α and β as functions of the wave normal.
    pub(super) fn change(&self, update: &RankOne) -> Result<Change, SphereError> {
        for vector in [&update.image, &update.covector] {
            if vector.len() != self.stresses {
                let given = vector.len();
                return Err(SphereError::Mismatch { given, needed: self.stresses });
            }
        }
        let project = |vector: &[f64]| -> [[f64; 3]; SIZE] {
            std::array::from_fn(|v| {
                std::array::from_fn(|axis| {
                    if v >= self.size {
                        return 0.0;
                    }
                    (0..self.stresses)
                        .fold(0.0, |sum, s| sum + self.balance[axis][(v, s)] * vector[s])
                })
            })
        };
        let (mut alpha, mut beta) = (project(&update.image), project(&update.covector));
        let norm = |rows: &[[f64; 3]; SIZE]| {
            rows.iter().flatten().fold(0.0, |sum: f64, x| sum + x * x).sqrt()
        };
        let (first, second) = (norm(&alpha), norm(&beta));
        let largest = first * second;
        if !largest.is_finite() {
            return Err(SphereError::NotFinite);
        }
        // Balance |α| and |β|: only the product αβᵀ matters.
        if largest > 0.0 {
            let balanced = (second / first).sqrt();
            alpha.iter_mut().flatten().for_each(|x| *x *= balanced);
            beta.iter_mut().flatten().for_each(|x| *x /= balanced);
        }
        Ok(Change { size: self.size, alpha, beta, largest })
    }
}
