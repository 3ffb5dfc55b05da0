//! Rank-one update −αβᵀ of the acoustic tensor in a direction.

use super::eigenbasis::{Eigenbasis, EigenvalueGroups, MAX_VELOCITIES};
use super::elastic_waves::AcousticTensor3;
use super::error::NormalSearchError;
use super::rank_one::RankOneUpdate;
use super::secular_equation::{SecularEquation, assemble_secular_equation};

/// Threshold of zero for the weights w_g, relative to |α||β|.
pub(super) const WEIGHT_TOLERANCE: f64 = 1e-15;

/// The vectors α and β of the update −αβᵀ as linear functions of the wave normal: velocities × axes.
pub(super) struct TensorUpdate {
    pub(super) velocity_count: usize,
    pub(super) alpha: [[f64; 3]; MAX_VELOCITIES],
    pub(super) beta: [[f64; 3]; MAX_VELOCITIES],
    /// A bound on |α||β| over all normals.
    pub(super) max_norm_product: f64,
}

impl TensorUpdate {
    /// Secular equation in the direction `normal`, from the eigenvectors and the grouped eigenvalues of Γₑ there.
    pub(super) fn secular_equation_at(
        &self,
        normal: &[f64; 3],
        basis: &Eigenbasis,
        groups: &EigenvalueGroups,
    ) -> SecularEquation {
        let product = |row: &[f64; 3]| row[0] * normal[0] + row[1] * normal[1] + row[2] * normal[2];
        let (mut alpha, mut beta) = ([0.0; MAX_VELOCITIES], [0.0; MAX_VELOCITIES]);
        let rows = self.alpha.iter().zip(&self.beta).zip(basis).take(self.velocity_count);
        for ((own_alpha, own_beta), row) in rows {
            let (a, b) = (product(own_alpha), product(own_beta));
            for k in 0..self.velocity_count {
                alpha[k] += row[k] * a;
                beta[k] += row[k] * b;
            }
        }
        let mut products = [0.0; MAX_VELOCITIES];
        for k in 0..self.velocity_count {
            products[k] = alpha[k] * beta[k];
        }
        let square = |x: &[f64; MAX_VELOCITIES]| x.iter().fold(0.0, |sum, x| sum + x * x);
        assemble_secular_equation(
            groups,
            &products[..self.velocity_count],
            WEIGHT_TOLERANCE * (square(&alpha) * square(&beta)).sqrt(),
        )
    }
}

impl AcousticTensor3 {
    /// Projects the update −a bᵀ of the stiffness to the vectors α and β as functions of the wave normal.
    pub(super) fn project_update(
        &self,
        update: &RankOneUpdate,
    ) -> Result<TensorUpdate, NormalSearchError> {
        for vector in [&update.flow_image, &update.normal_image] {
            if vector.len() != self.stress_count {
                let given = vector.len();
                return Err(NormalSearchError::LengthMismatch { given, needed: self.stress_count });
            }
        }
        let project = |vector: &[f64]| -> [[f64; 3]; MAX_VELOCITIES] {
            std::array::from_fn(|v| {
                std::array::from_fn(|axis| {
                    if v >= self.velocity_count {
                        return 0.0;
                    }
                    (0..self.stress_count)
                        .fold(0.0, |sum, s| sum + self.scaled_divergence[axis][(v, s)] * vector[s])
                })
            })
        };
        let (mut alpha, mut beta) = (project(&update.flow_image), project(&update.normal_image));
        let norm = |rows: &[[f64; 3]; MAX_VELOCITIES]| {
            rows.iter().flatten().fold(0.0, |sum: f64, x| sum + x * x).sqrt()
        };
        let (first, second) = (norm(&alpha), norm(&beta));
        let max_norm_product = first * second;
        if !max_norm_product.is_finite() {
            return Err(NormalSearchError::NotFinite);
        }
        // Balance |α| and |β|: only the product αβᵀ matters.
        if max_norm_product > 0.0 {
            let balanced = (second / first).sqrt();
            alpha.iter_mut().flatten().for_each(|x| *x *= balanced);
            beta.iter_mut().flatten().for_each(|x| *x /= balanced);
        }
        Ok(TensorUpdate { velocity_count: self.velocity_count, alpha, beta, max_norm_product })
    }
}
