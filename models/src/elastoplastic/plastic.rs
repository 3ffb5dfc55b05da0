//! The yield set of a solid, and the state of stress at which it yields.

use crate::common::input::InputError;
use crate::common::range::Range;
use crate::solid::stress::Stress;
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::{Unusable, YieldSet};

/// Conditions that the scaled stress meets to within this, relative to the terms that they compare,
/// hold with equality.
const ON_YIELD: f64 = 1e-9;

/// A yield set and what is active of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plastic {
    /// The yield set.
    pub set: YieldSet,
    /// The stress, scaled onto yield; `None` where the active conditions are given instead.
    pub stress: Option<Stress>,
    /// The conditions that hold with equality; at least one.
    pub active: Vec<ActiveCondition>,
    /// Rate Λ at which the background flows, 1/s; 0 of layers, whose conditions are not curved.
    pub rate: f64,
}

impl Plastic {
    /// Range of the rate.
    pub const RATE: Range = Range::NotNegative;

    /// A set that yields at the stress −p δ + s·`direction` of the greatest s, while the background flows at
    /// the rate Λ (1/s).
    ///
    /// # Errors
    /// No such stress yields (see [`scale_onto_yield`]); the rate is negative.
    pub fn at_stress(
        set: YieldSet,
        pressure: f64,
        direction: &Stress,
        rate: f64,
    ) -> Result<Self, InputError> {
        let stress = scale_onto_yield(&set, pressure, direction)?;
        let active = set.active(&stress, ON_YIELD);
        if active.is_empty() {
            return Err(never_yields("a stress on the axis of the cone"));
        }
        if !Self::RATE.contains(rate) {
            return Err(InputError {
                input: "plastic_rate",
                found: format!("{rate:?}"),
                allowed: "the plastic rate must be Λ ≥ 0, in 1/s".into(),
            });
        }
        Ok(Self { set, stress: Some(stress), active, rate })
    }

    /// A polyhedral set whose conditions of these indices, in the order of its
    /// [`half_spaces`](crate::yield_set::YieldConditions::half_spaces), are active, at whatever stress.
    ///
    /// # Errors
    /// There is no condition of that index.
    pub fn with_active(set: YieldSet, active: &[usize]) -> Result<Self, InputError> {
        let all: Vec<ActiveCondition> =
            set.half_spaces().into_iter().flatten().map(|(condition, _)| condition).collect();
        let condition = |&index: &usize| {
            all.get(index).copied().ok_or_else(|| InputError {
                input: "active",
                found: format!("condition {index}"),
                allowed: format!("one of {} conditions, counted from 0", all.len()),
            })
        };
        let active = active.iter().map(condition).collect::<Result<_, _>>()?;
        Ok(Self { set, stress: None, active, rate: 0.0 })
    }
}

/// The stress −p δ + s·`direction` with the greatest s ≥ 0 inside the yield set.
///
/// # Errors
/// The set has no strength under this pressure (Pa), or does not hold it; no multiple of the direction
/// yields.
pub fn scale_onto_yield(
    set: &YieldSet,
    pressure: f64,
    direction: &Stress,
) -> Result<Stress, InputError> {
    let mut stress = Stress::default();
    for i in 0..3 {
        stress.force[i][i] = -pressure;
    }
    let scale = set.reach(&stress, direction).map_err(|unusable| match unusable {
        Unusable::NoStrength => InputError {
            input: "yield",
            found: "no strength under this pressure".into(),
            allowed: "strength or friction that a stress can grow to; yield.active may name the \
                      conditions instead"
                .into(),
        },
        Unusable::Outside => InputError {
            input: "pressure",
            found: format!("{pressure:?}"),
            allowed: "a pressure within the yield set: greater than −strength/friction".into(),
        },
    })?;
    if !scale.is_finite() {
        return Err(never_yields("stresses that never yield, however large"));
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

fn never_yields(found: &str) -> InputError {
    InputError {
        input: "stress",
        found: found.into(),
        allowed:
            "a deviatoric, rotational or couple stress that reaches the yield set; where the set \
                  names its conditions, yield.active may say which hold instead"
                .into(),
    }
}
