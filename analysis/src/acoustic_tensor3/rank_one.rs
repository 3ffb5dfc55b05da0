//! Rank-one update of the stiffness by an active yield condition.

use super::error::NormalSearchError;
use models::common::rates::RateEquations;

/// Rank-one update −a bᵀ of the stiffness while one yield condition is active.
#[derive(Clone, Debug, PartialEq)]
pub struct RankOneUpdate {
    /// Vector a = D m/(H + n·Dm), dimensionless if the gradients of the yield condition are.
    pub flow_image: Vec<f64>,
    /// Vector b = D n, in the units of the stiffness.
    pub normal_image: Vec<f64>,
}

impl RankOneUpdate {
    /// Computes the update for a condition with normal n and flow direction m, both in the stress components of
    /// `elastic`, and plastic modulus H, Pa.
    ///
    /// # Errors
    /// A vector has the wrong length, or H + n·Dm is NaN or not positive.
    pub fn new(
        elastic: &RateEquations<3>,
        normal: &[f64],
        flow: &[f64],
        hardening: f64,
    ) -> Result<Self, NormalSearchError> {
        let needed = elastic.stress_count();
        for vector in [normal, flow] {
            if vector.len() != needed {
                return Err(NormalSearchError::LengthMismatch { given: vector.len(), needed });
            }
        }
        let product = |vector: &[f64]| -> Vec<f64> {
            let row = |i| (0..needed).map(|j| elastic.stiffness[(i, j)].value * vector[j]).sum();
            (0..needed).map(row).collect()
        };
        let (mut flow_image, normal_image) = (product(flow), product(normal));
        let response = hardening + normal.iter().zip(&flow_image).map(|(n, d)| n * d).sum::<f64>();
        if response.is_nan() {
            return Err(NormalSearchError::NotFinite);
        }
        if response <= 0.0 {
            return Err(NormalSearchError::NoResponse(response));
        }
        for component in &mut flow_image {
            *component /= response;
        }
        Ok(Self { flow_image, normal_image })
    }
}
