//! Allowed ranges of single numbers.

/// Allowed range of a number, independent of other numbers; bounds are in the unit of the number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AllowedRange {
    /// Any finite number.
    Finite,
    /// Above 0.
    Positive,
    /// At least 0.
    NotNegative,
    /// Above 0 and at most this bound.
    PositiveUpTo(f64),
    /// Above 0 and below this bound.
    PositiveBelow(f64),
    /// At least 0 and below this bound.
    NotNegativeBelow(f64),
}

impl AllowedRange {
    /// Whether the range contains `x`; NaN and infinities are in no range.
    pub fn contains(self, x: f64) -> bool {
        x.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => x > 0.0,
                Self::NotNegative => x >= 0.0,
                Self::PositiveUpTo(most) => x > 0.0 && x <= most,
                Self::PositiveBelow(limit) => x > 0.0 && x < limit,
                Self::NotNegativeBelow(limit) => x >= 0.0 && x < limit,
            }
    }

    /// Converts the bounds of a range from degrees to radians.
    pub fn to_radians(self) -> Self {
        match self {
            Self::PositiveUpTo(most) => Self::PositiveUpTo(most.to_radians()),
            Self::PositiveBelow(limit) => Self::PositiveBelow(limit.to_radians()),
            Self::NotNegativeBelow(limit) => Self::NotNegativeBelow(limit.to_radians()),
            Self::Finite | Self::Positive | Self::NotNegative => self,
        }
    }
}
