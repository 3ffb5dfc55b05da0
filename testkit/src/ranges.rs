//! Test values at the ends of ranges.

use models::common::range::AllowedRange;

/// A positive number close to 0.
const SMALL_POSITIVE: f64 = 1e-300;

/// Returns test values just outside a range, at its finite ends.
pub fn values_outside(range: AllowedRange) -> Vec<f64> {
    match range {
        AllowedRange::Finite => vec![],
        AllowedRange::Positive => vec![-SMALL_POSITIVE, 0.0],
        AllowedRange::NotNegative => vec![-SMALL_POSITIVE],
        AllowedRange::PositiveUpTo(most) => vec![-SMALL_POSITIVE, 0.0, most.next_up()],
        AllowedRange::PositiveBelow(limit) => vec![-SMALL_POSITIVE, 0.0, limit],
        AllowedRange::NotNegativeBelow(limit) => vec![-SMALL_POSITIVE, limit],
    }
}

/// Returns the end points that belong to a range.
pub fn closed_ends(range: AllowedRange) -> Vec<f64> {
    match range {
        AllowedRange::Finite | AllowedRange::Positive | AllowedRange::PositiveBelow(_) => vec![],
        AllowedRange::NotNegative | AllowedRange::NotNegativeBelow(_) => vec![0.0],
        AllowedRange::PositiveUpTo(most) => vec![most],
    }
}

/// Returns test values just inside the open ends of a range; [`f64::MAX`] for a range without upper bound.
pub fn values_just_inside(range: AllowedRange) -> Vec<f64> {
    match range {
        AllowedRange::Finite | AllowedRange::NotNegative => vec![f64::MAX],
        AllowedRange::Positive => vec![SMALL_POSITIVE, f64::MAX],
        AllowedRange::PositiveUpTo(_) => vec![SMALL_POSITIVE],
        AllowedRange::PositiveBelow(limit) => vec![SMALL_POSITIVE, limit.next_down()],
        AllowedRange::NotNegativeBelow(limit) => vec![limit.next_down()],
    }
}
