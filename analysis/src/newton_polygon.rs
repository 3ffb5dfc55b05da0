//! Newton polygon of a polynomial P(ς, k): its upper hull over the exponents of ς and k has a slope −m for each group
//! of roots that grow as ς ≈ c kᵐ for k → ∞; `puiseux` computes the coefficients c.

use crate::list::StackList;
use std::cmp::Ordering;

/// A rational order of growth: the exponent m of ς ≈ c k^m.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrowthOrder {
    /// Numerator.
    pub numerator: i64,
    /// Denominator, positive, in lowest terms.
    pub denominator: i64,
}

/// Greatest common divisor.
pub(crate) fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

impl GrowthOrder {
    pub(crate) fn new(numerator: i64, denominator: i64) -> Self {
        let divisor = gcd(numerator, denominator).max(1) * denominator.signum();
        Self { numerator: numerator / divisor, denominator: denominator / divisor }
    }

    /// The order as a double.
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl Ord for GrowthOrder {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.numerator * other.denominator).cmp(&(other.numerator * self.denominator))
    }
}

impl PartialOrd for GrowthOrder {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Newton polygon: corners of the upper hull of points (i, j), by descending i.
pub(crate) fn newton_polygon_corners(
    points: impl Iterator<Item = (i64, i64)>,
) -> StackList<(i64, i64)> {
    let mut sorted: StackList<_, 64> = points.collect();
    // Among points with equal i only the largest j matters.
    sorted.sort_by_key(|&(i, j)| (std::cmp::Reverse(i), std::cmp::Reverse(j)));
    sorted.dedup_by_key(|point| point.0);
    let mut corners: StackList<(i64, i64)> = StackList::new();
    for (i, j) in sorted {
        while let [.., a, b] = corners[..] {
            // Remove b if it lies below or on the chord from a to the new point.
            if (b.1 - a.1) * (a.0 - i) > (j - a.1) * (a.0 - b.0) {
                break;
            }
            corners.pop();
        }
        corners.push((i, j));
    }
    corners
}

/// Whether (i, j) lies on the edge between two corners.
pub(crate) fn is_on_edge(
    (i, j): (i64, i64),
    ((i1, j1), (i0, j0)): ((i64, i64), (i64, i64)),
) -> bool {
    i0 <= i && i <= i1 && (j - j1) * (i1 - i0) == (j0 - j1) * (i1 - i)
}
