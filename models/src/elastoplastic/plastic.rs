//! The yield set of a solid, and the state of stress at which it yields.

use crate::common::decimal::format_exact;
use crate::common::input::InputError;
use crate::common::range::AllowedRange;
use crate::solid::stress::Stress;
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::{RayStartError, YieldSet};

/// Relative tolerance within which a yield condition counts as active at the scaled stress.
const YIELD_TOLERANCE: f64 = 1e-9;

/// A yield set with its active conditions at a stress on yield.
#[derive(Clone, Debug, PartialEq)]
pub struct PlasticState {
    /// Yield set of the solid.
    pub set: YieldSet,
    /// Stress scaled onto yield; `None` if the active conditions are given instead.
    pub stress: Option<Stress>,
    /// Active conditions (f = 0); at least one if `stress` is given.
    pub active_conditions: Vec<ActiveCondition>,
    /// Plastic multiplier rate Λ of the background flow, 1/s; ≥ 0; 0 if the active conditions are given. It has no
    /// effect for interlayer sets, whose conditions are linear.
    pub multiplier_rate: f64,
}

impl PlasticState {
    /// Allowed range of [`PlasticState::multiplier_rate`].
    pub const RATE_RANGE: AllowedRange = AllowedRange::NotNegative;

    /// Creates the plastic state at the stress −p δ + s·`direction` with the largest admissible s, where p is
    /// `pressure` (Pa) and δ the unit tensor, for a background that flows plastically at the multiplier rate Λ = `rate`
    /// (1/s).
    ///
    /// # Errors
    /// The stress cannot be scaled onto yield (see [`scale_onto_yield`]), no condition is active there (a cone on its
    /// axis has no unique normal), or the rate is negative or not finite.
    pub fn from_stress(
        set: YieldSet,
        pressure: f64,
        direction: &Stress,
        rate: f64,
    ) -> Result<Self, InputError> {
        let stress = scale_onto_yield(&set, pressure, direction)?;
        let active = set.active_conditions(&stress, YIELD_TOLERANCE);
        if active.is_empty() {
            return Err(no_yield_error("a stress on the axis of the cone"));
        }
        if !Self::RATE_RANGE.contains(rate) {
            return Err(InputError {
                input: "plastic_rate",
                rejected_value: format_exact(rate),
                allowed_values: "the plastic rate must be Λ ≥ 0, in 1/s".into(),
            });
        }
        Ok(Self { set, stress: Some(stress), active_conditions: active, multiplier_rate: rate })
    }

    /// Creates the plastic state of a polyhedral set with given active conditions, independent of the stress; `active`
    /// holds indices into [`half_spaces`](crate::yield_set::YieldConditions::half_spaces).
    ///
    /// # Errors
    /// An index is out of range; for a set that is not polyhedral, every index.
    pub fn with_active(set: YieldSet, active: &[usize]) -> Result<Self, InputError> {
        let all: Vec<ActiveCondition> =
            set.half_spaces().into_iter().flatten().map(|(condition, _)| condition).collect();
        let condition = |&index: &usize| {
            all.get(index).copied().ok_or_else(|| InputError {
                input: "active",
                rejected_value: format!("condition {index}"),
                allowed_values: format!("expected one of {} conditions, counted from 0", all.len()),
            })
        };
        let active = active.iter().map(condition).collect::<Result<_, _>>()?;
        Ok(Self { set, stress: None, active_conditions: active, multiplier_rate: 0.0 })
    }
}

/// Computes the stress −p δ + s·`direction` on yield, with the largest s ≥ 0 for which this stress is in the yield set;
/// p is `pressure` (Pa) and δ the unit tensor.
///
/// # Errors
/// The hydrostatic stress −p δ is outside the set or a condition has no strength there, or no positive multiple of the
/// direction yields.
pub fn scale_onto_yield(
    set: &YieldSet,
    pressure: f64,
    direction: &Stress,
) -> Result<Stress, InputError> {
    let mut stress = Stress::default();
    for i in 0..3 {
        stress.force[i][i] = -pressure;
    }
    let scale = set.ray_exit(&stress, direction).map_err(|unusable| match unusable {
        RayStartError::NoStrength => InputError {
            input: "yield",
            rejected_value: "no strength under this pressure".into(),
            allowed_values:
                "expected a strength or a friction above 0; or name the active conditions in yield.active"
                    .into(),
        },
        RayStartError::Outside => InputError {
            input: "pressure",
            rejected_value: format_exact(pressure),
            allowed_values: "expected a pressure within the yield set: greater than −strength/friction"
                .into(),
        },
    })?;
    if !scale.is_finite() {
        return Err(no_yield_error("stresses that never yield, however large"));
    }
    let add = |sum: &mut [[f64; 3]; 3], part: &[[f64; 3]; 3]| {
        for (sum, part) in sum.iter_mut().flatten().zip(part.iter().flatten()) {
            *sum += scale * part;
        }
    };
    add(&mut stress.force, &direction.force);
    add(&mut stress.couple, &direction.couple);
    Ok(stress)
}

fn no_yield_error(found: &str) -> InputError {
    InputError {
        input: "stress",
        rejected_value: found.into(),
        allowed_values:
            "expected a deviatoric, rotational or couple stress that reaches the yield set; or, where \
                  the set has named conditions, yield.active"
                .into(),
    }
}
