//! Orders of growth, Newton polygons, and the worst growth met so far.

use crate::list::List;
use crate::puiseux::Growth;
use std::cmp::Ordering;

/// A rational order of growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Numerator.
    pub numerator: i64,
    /// Denominator, positive, in lowest terms.
    pub denominator: i64,
}

/// Greatest common divisor.
pub(crate) fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

impl Order {
    pub(crate) fn new(numerator: i64, denominator: i64) -> Self {
        let divisor = gcd(numerator, denominator).max(1) * denominator.signum();
        Self { numerator: numerator / divisor, denominator: denominator / divisor }
    }

    /// As a double.
    pub fn value(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl Ord for Order {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.numerator * other.denominator).cmp(&(other.numerator * self.denominator))
    }
}

impl PartialOrd for Order {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// By how much a layer's coefficient must exceed that of the sectors beside it to be news: of equal
/// order it is mostly theirs again.
const LAYER_EXCESS: f64 = 1.0 + 1e-6;

/// The greatest growth met so far, and what could not be judged.
#[derive(Default)]
pub(crate) struct Worst {
    /// (order, scaled coefficient, direction)
    pub(crate) growth: Option<(Order, f64, f64)>,
    pub(crate) doubt: Option<(String, f64, f64)>,
    /// Growth of more than this order must turn up.
    expected: Option<Order>,
}

impl Worst {
    pub(crate) fn grows(&mut self, order: Order, coefficient: f64, direction: f64) {
        let better = self.growth.is_none_or(|(o, c, _)| (order, coefficient) > (o, c));
        if better {
            self.growth = Some((order, coefficient, direction));
        }
    }

    /// Growth in a layer.
    pub(crate) fn grows_in_layer(&mut self, order: Order, coefficient: f64, direction: f64) {
        let again =
            self.growth.is_some_and(|(o, c, _)| o == order && coefficient < LAYER_EXCESS * c);
        if !again {
            self.grows(order, coefficient, direction);
        }
    }

    /// Growth of roots in one direction.
    pub(crate) fn takes(&mut self, found: Growth, direction: f64) {
        if let Some((order, coefficient)) = found.growth {
            self.grows_in_layer(order, coefficient, direction);
        }
        if let Some((order, value, bound)) = found.doubt {
            self.doubts(
                format!("real part of the coefficient of order {}", order.value()),
                value,
                bound,
            );
        }
    }

    /// Growth that increases towards a neighbouring layer.
    pub(crate) fn expects(&mut self, order: Order) {
        self.expected = self.expected.max(Some(order));
    }

    /// Whether growth of that order would count.
    pub(crate) fn may_improve(&self, order: Order) -> bool {
        self.growth.is_none_or(|(known, _, _)| order >= known)
    }

    /// Whether growth of some order below that one would count.
    pub(crate) fn may_improve_below(&self, order: Order) -> bool {
        self.growth.is_none_or(|(known, _, _)| order > known)
    }

    /// The order of growth that was expected and not found.
    pub(crate) fn missing(&self) -> Option<Order> {
        self.expected.filter(|&order| self.may_improve(order))
    }

    pub(crate) fn is_bounded(&self) -> bool {
        self.growth.is_none()
    }

    pub(crate) fn doubts(&mut self, quantity: String, value: f64, rounding: f64) {
        self.doubt.get_or_insert((quantity, value, rounding));
    }
}

/// Corners of the upper boundary of the Newton polygon of points (i, j), by descending i.
pub(crate) fn corners_of(points: impl Iterator<Item = (i64, i64)>) -> List<(i64, i64)> {
    let mut sorted: List<_, 64> = points.collect();
    // Of equal i only the greatest j counts.
    sorted.sort_by_key(|&(i, j)| (std::cmp::Reverse(i), std::cmp::Reverse(j)));
    sorted.dedup_by_key(|point| point.0);
    let mut corners: List<(i64, i64)> = List::new();
    for (i, j) in sorted {
        while let [.., a, b] = corners[..] {
            // b below or on the chord from a to the new point goes.
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
pub(crate) fn is_on((i, j): (i64, i64), ((i1, j1), (i0, j0)): ((i64, i64), (i64, i64))) -> bool {
    i0 <= i && i <= i1 && (j - j1) * (i1 - i0) == (j0 - j1) * (i1 - i)
}
