//! Yield sets bounded by half-spaces n·σ ≤ k, each given as a condition with its normal n and its strength k.

use models::solid::stress::Stress;
use models::yield_set::parameters::{ActiveCondition, contract};
use models::yield_set::{RayStartError, linear_ray_exit};

/// Returns the active conditions, i.e. those with n·σ ≥ k (1 − `tolerance`).
pub fn active_conditions(
    half_spaces: &[(ActiveCondition, f64)],
    stress: &Stress,
    tolerance: f64,
) -> Vec<ActiveCondition> {
    let is_active = |(condition, strength): &&(ActiveCondition, f64)| {
        contract(&condition.normal, stress) >= strength * (1.0 - tolerance)
    };
    half_spaces.iter().filter(is_active).map(|(condition, _)| *condition).collect()
}

/// Returns the smallest parameter t at which `start` + t `direction` leaves a half-space; infinity if it leaves none.
///
/// # Errors
/// `start` is not in the interior of the set.
pub fn ray_exit(
    half_spaces: &[(ActiveCondition, f64)],
    start: &Stress,
    direction: &Stress,
) -> Result<f64, RayStartError> {
    let mut exit = f64::INFINITY;
    for (condition, strength) in half_spaces {
        let [at_start, rate] = [start, direction].map(|stress| contract(&condition.normal, stress));
        exit = exit.min(linear_ray_exit(at_start, *strength, rate)?);
    }
    Ok(exit)
}
