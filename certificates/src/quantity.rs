//! Deciding quantities as quotients of polynomials.

use crate::interval::Interval;
use crate::polynomial::Polynomial;

/// A quantity over a part of a box: `numerator`/`divisor`, with a positive divisor.
#[derive(Clone, Debug)]
pub(crate) struct Quantity {
    pub(crate) numerator: Polynomial,
    pub(crate) divisor: Polynomial,
}

impl Quantity {
    pub(crate) fn new(numerator: Polynomial, divisor: Polynomial) -> Self {
        Self { numerator, divisor }
    }

    /// The same with intervals as coefficients.
    pub(crate) fn spread(self) -> Self {
        Self { numerator: self.numerator.spread(), divisor: self.divisor.spread() }
    }

    /// The same for a range of the direction.
    pub(crate) fn restrict(&self, variable: usize, low: &Interval, high: &Interval) -> Self {
        Self {
            numerator: self.numerator.restrict(variable, low, high),
            divisor: self.divisor.restrict(variable, low, high),
        }
    }

    pub(crate) fn is_positive(&self) -> bool {
        self.divisor.is_positive() && self.numerator.is_positive()
    }

    pub(crate) fn is_negative(&self) -> bool {
        let zero = Polynomial::whole(0);
        self.divisor.is_positive() && (&zero - &self.numerator).is_positive()
    }

    /// Enclosure of the value at u = v = s = 0; `None` where the divisor may vanish.
    pub(crate) fn at_origin(&self) -> Option<Interval> {
        let divisor = self.divisor.at_origin();
        divisor.is_positive().then(|| self.numerator.at_origin() / divisor)
    }
}
