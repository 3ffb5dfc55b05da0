//! Elastoplastic tangent stiffness D_t: with the elastic stiffness D, and the normals n, flow directions m, plastic
//! moduli H and plastic multiplier rates λ̇ of the active conditions,
//!
//! ```text
//! σ̇ = D (ε̇ − Σ λ̇ₐ mₐ),  nₐ·σ̇ = Hₐ λ̇ₐ   ⇒   D_t = D − Σ over conditions (D m)(nᵀD)/(H + nᵀD m),
//! ```
//!
//! The conditions are applied one after another: each updates the stiffness that results from the previous conditions,
//! and in its term of the sum D stands for this stiffness.

use super::parameters::ActiveCondition;
use crate::common::rounding::{Rounded, UNIT_ROUNDOFF};
use crate::common::system::RoundedMatrix;
use crate::solid::stress::StressComponent;

/// Error of the tangent stiffness: the rate response of the solid is undefined, since the plastic denominator H + nᵀD m
/// (plastic modulus H, yield normal n, stiffness D, flow direction m) does not exceed its rounding bound for an active
/// condition: it is not certainly positive.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "no response while yielding ({condition}): H + n·Dm = {value:e} Pa must be positive; less \
     difference between friction and dilatancy, or more hardening"
)]
pub struct NoResponse {
    /// Name of the condition whose plastic denominator is not certainly positive.
    pub condition: &'static str,
    /// Value of the plastic denominator H + nᵀD m, Pa.
    pub value: f64,
}

/// Computes the tangent stiffness between the components `stresses` for plastic loading of all `active_conditions`.
///
/// A condition without hardening whose normal depends linearly on the normals of the previous conditions is skipped.
///
/// # Errors
/// The plastic denominator H + nᵀD m of a condition is not certainly positive; see [`NoResponse`].
pub fn tangent_stiffness(
    elastic_stiffness: &RoundedMatrix,
    stresses: &[StressComponent],
    active_conditions: &[ActiveCondition],
) -> Result<RoundedMatrix, NoResponse> {
    let mut tangent = elastic_stiffness.clone();
    let size = stresses.len();
    for (index, condition) in active_conditions.iter().enumerate() {
        // Rounding bound of the nonzero components of a normal or flow direction: 8 u times the largest component of
        // the same unit, with the unit roundoff u.
        let component_derivatives = |gradient: &crate::solid::stress::Stress| -> Vec<Rounded> {
            let largest = [false, true].map(|is_couple| {
                let same_unit = stresses.iter().filter(|c| c.is_couple() == is_couple);
                same_unit.fold(0.0f64, |largest, c| largest.max(c.derivative(gradient).abs()))
            });
            let to_rounded = |c: &StressComponent| match c.derivative(gradient) {
                0.0 => Rounded::ZERO,
                value => Rounded {
                    value,
                    bound: 8.0 * UNIT_ROUNDOFF * largest[usize::from(c.is_couple())],
                },
            };
            stresses.iter().map(to_rounded).collect()
        };
        let (normal, flow) = (
            component_derivatives(&condition.normal),
            component_derivatives(&condition.flow_direction),
        );
        let sum_rounded = |terms: &mut dyn Iterator<Item = Rounded>| {
            terms.fold(Rounded::ZERO, std::ops::Add::add)
        };
        let image = |matrix: &RoundedMatrix, i: usize| {
            sum_rounded(&mut (0..size).map(|j| matrix[(i, j)] * flow[j]))
        };
        let covector = |matrix: &RoundedMatrix, j: usize| {
            sum_rounded(&mut (0..size).map(|i| normal[i] * matrix[(i, j)]))
        };
        let normal_stiffness = sum_rounded(&mut (0..size).map(|i| normal[i] * image(&tangent, i)));
        // If n depends linearly on the normals of the previous conditions, these have reduced n·Dm to rounding errors.
        let initial_normal_stiffness =
            sum_rounded(&mut (0..size).map(|i| normal[i] * image(elastic_stiffness, i)));
        let is_dependent =
            normal_stiffness.value.abs() <= 1e-12 * initial_normal_stiffness.value.abs();
        if index > 0 && condition.hardening == 0.0 && is_dependent {
            continue;
        }
        let plastic_denominator = Rounded::from_rounded(condition.hardening) + normal_stiffness;
        if plastic_denominator.value <= plastic_denominator.bound {
            return Err(NoResponse { condition: condition.name, value: plastic_denominator.value });
        }
        let images: Vec<Rounded> = (0..size).map(|i| image(&tangent, i)).collect();
        let covectors: Vec<Rounded> = (0..size).map(|j| covector(&tangent, j)).collect();
        for i in 0..size {
            for j in 0..size {
                tangent[(i, j)] = tangent[(i, j)] - images[i] * covectors[j] / plastic_denominator;
            }
        }
    }
    Ok(tangent)
}
