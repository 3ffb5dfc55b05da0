//! Test values at the ends of ranges.

use models::common::range::Range;

/// A positive number close to 0.
const TINY: f64 = 1e-300;

/// Returns test values just outside a range.
pub fn outside(range: Range) -> Vec<f64> {
    match range {
        Range::Finite => vec![],
        Range::Positive => vec![-TINY, 0.0],
        Range::NotNegative => vec![-TINY],
        Range::UpTo(most) => vec![-TINY, 0.0, most.next_up()],
        Range::Below(limit) => vec![-TINY, 0.0, limit],
        Range::NotNegativeBelow(limit) => vec![-TINY, limit],
    }
}

/// Returns the closed ends of a range.
pub fn closed_ends(range: Range) -> Vec<f64> {
    match range {
        Range::Finite | Range::Positive | Range::Below(_) => vec![],
        Range::NotNegative | Range::NotNegativeBelow(_) => vec![0.0],
        Range::UpTo(most) => vec![most],
    }
}

/// Returns test values just inside the open ends of a range.
pub fn just_inside(range: Range) -> Vec<f64> {
    match range {
        Range::Finite | Range::NotNegative => vec![f64::MAX],
        Range::Positive => vec![TINY, f64::MAX],
        Range::UpTo(_) => vec![TINY],
        Range::Below(limit) => vec![TINY, limit.next_down()],
        Range::NotNegativeBelow(limit) => vec![limit.next_down()],
    }
}
