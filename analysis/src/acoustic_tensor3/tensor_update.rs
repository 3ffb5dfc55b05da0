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
    /// Value of the linear function `rows` (velocities × axes) at a wave normal.
    pub(super) fn apply(
        &self,
        rows: &[[f64; 3]; MAX_VELOCITIES],
        normal: &[f64; 3],
    ) -> [f64; MAX_VELOCITIES] {
        rows.map(|row| row[0] * normal[0] + row[1] * normal[1] + row[2] * normal[2])
    }

    /// Secular equation in the direction `normal`, from the eigenvectors and the grouped eigenvalues of Γₑ there.
    pub(super) fn secular_equation_at(
        &self,
        normal: &[f64; 3],
        basis: &Eigenbasis,
        groups: &EigenvalueGroups,
    ) -> SecularEquation {
        let (mut alpha, mut beta) = ([0.0; MAX_VELOCITIES], [0.0; MAX_VELOCITIES]);
        let (own_alpha, own_beta) =
            (self.apply(&self.alpha, normal), self.apply(&self.beta, normal));
        let rows = own_alpha.iter().zip(&own_beta).zip(basis).take(self.velocity_count);
        for ((&a, &b), row) in rows {
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
    /// Secular equation in the direction `normal`; fast if `nearby_basis` is close to the eigenvectors of Γₑ there.
    pub(super) fn secular_equation_near(
        &self,
        update: &TensorUpdate,
        nearby_basis: &Eigenbasis,
        normal: &[f64; 3],
    ) -> SecularEquation {
        if let Some(waves) = &self.isotropic {
            return waves.secular_equation_at(update, normal);
        }
        let (values, basis) = self.elastic_eigenbasis(normal, nearby_basis);
        let groups = EigenvalueGroups::new(&values[..self.velocity_count]);
        update.secular_equation_at(normal, &basis, &groups)
    }

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
