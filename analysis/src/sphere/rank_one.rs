//! The change of rank one that an active yield condition makes to the stiffness.

use super::error::SphereError;
use models::common::rates::RateEquations;

/// The change −a bᵀ of the stiffness while one yield condition is active.
#[derive(Clone, Debug, PartialEq)]
pub struct RankOne {
    /// a = D m/(H + n·Dm), dimensionless where the gradients of the condition are.
    pub image: Vec<f64>,
    /// b = D n, in the units of the stiffness.
    pub covector: Vec<f64>,
}

impl RankOne {
    /// The change that a condition makes with its gradient n, the direction m of plastic flow, both by
    /// the stresses of `elastic`, and the plastic modulus H, Pa.
    ///
    /// # Errors
    /// Vectors of another length; H + n·Dm that is not positive.
    pub fn new(
        elastic: &RateEquations<3>,
        normal: &[f64],
        flow: &[f64],
        hardening: f64,
    ) -> Result<Self, SphereError> {
        let needed = elastic.stresses();
        for vector in [normal, flow] {
            if vector.len() != needed {
                return Err(SphereError::Mismatch { given: vector.len(), needed });
            }
        }
        let product = |vector: &[f64]| -> Vec<f64> {
            let row = |i| (0..needed).map(|j| elastic.stiffness[(i, j)].value * vector[j]).sum();
            (0..needed).map(row).collect()
        };
        let (mut image, covector) = (product(flow), product(normal));
        let response = hardening + normal.iter().zip(&image).map(|(n, d)| n * d).sum::<f64>();
        if response.is_nan() {
            return Err(SphereError::NotFinite);
        }
        if response <= 0.0 {
            return Err(SphereError::NoResponse(response));
        }
        for component in &mut image {
            *component /= response;
        }
        Ok(Self { image, covector })
    }
}
