//! Allowed ranges of single numbers.

/// Allowed range of a number, independent of other numbers; bounds are in the unit of the number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// Above 0.
    Positive,
    /// At least 0.
    NotNegative,
    /// Above 0 and at most this bound.
    UpTo(f64),
    /// Above 0 and below this bound.
    Below(f64),
    /// At least 0 and below this bound.
    NotNegativeBelow(f64),
}

impl Range {
    /// Whether the range contains `x`; NaN and infinities are in no range.
    pub fn contains(self, x: f64) -> bool {
        x.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => x > 0.0,
                Self::NotNegative => x >= 0.0,
                Self::UpTo(most) => x > 0.0 && x <= most,
                Self::Below(limit) => x > 0.0 && x < limit,
                Self::NotNegativeBelow(limit) => x >= 0.0 && x < limit,
            }
    }

    /// Converts a range in degrees to radians.
    pub fn to_radians(self) -> Self {
        match self {
            Self::UpTo(most) => Self::UpTo(most.to_radians()),
            Self::Below(limit) => Self::Below(limit.to_radians()),
            Self::NotNegativeBelow(limit) => Self::NotNegativeBelow(limit.to_radians()),
            Self::Finite | Self::Positive | Self::NotNegative => self,
        }
    }
}
