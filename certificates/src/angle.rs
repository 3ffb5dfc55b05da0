//! Cosine and sine of angles as rational functions of the tangent of the half angle.

use crate::interval::Interval;
use crate::polynomial::Polynomial;

/// An angle by polynomials: cos = `cosine`/`norm` and sin = `sine`/`norm` with `norm` > 0.
#[derive(Clone, Debug)]
pub(crate) struct Angle {
    pub(crate) cosine: Polynomial,
    pub(crate) sine: Polynomial,
    pub(crate) norm: Polynomial,
}

impl Angle {
    /// The angle 2 arctan t.
    pub(crate) fn from_half_tangent(t: &Polynomial) -> Self {
        let (one, square) = (Polynomial::whole(1), t * t);
        Self { cosine: &one - &square, sine: t + t, norm: &one + &square }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            cosine: &(&self.cosine * &other.cosine) - &(&self.sine * &other.sine),
            sine: &(&self.sine * &other.cosine) + &(&self.cosine * &other.sine),
            norm: &self.norm * &other.norm,
        }
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        let sine = &Polynomial::constant(Interval::zero()) - &other.sine;
        self.plus(&Self { sine, ..other.clone() })
    }
}
