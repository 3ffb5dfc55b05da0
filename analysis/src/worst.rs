//! Accumulator of the largest growth and of undecided quantities during an assessment.

use crate::newton::Order;
use crate::puiseux::RootGrowth;
use std::f64::consts::PI;

/// Factor by which the coefficient of a layer must exceed the largest known coefficient of the same order: a layer
/// usually repeats the coefficient of the neighbouring sectors.
const LAYER_EXCESS: f64 = 1.0 + 1e-6;

/// Largest growth so far, and the first undecided quantity.
#[derive(Default)]
pub(crate) struct Worst {
    /// Largest order of growth, its scaled coefficient, and the direction, rad.
    pub(crate) growth: Option<(Order, f64, f64)>,
    /// First undecided quantity, its value and its rounding bound.
    pub(crate) doubt: Option<(String, f64, f64)>,
    /// Order that growth still to be found must exceed.
    expected: Option<Order>,
}

impl Worst {
    /// Records growth if its order, or its coefficient at equal order, is the largest so far.
    pub(crate) fn grows(&mut self, order: Order, coefficient: f64, direction: f64) {
        let better = self.growth.is_none_or(|(o, c, _)| (order, coefficient) > (o, c));
        if better {
            self.growth = Some((order, coefficient, direction));
        }
    }

    /// Records growth in a layer.
    pub(crate) fn grows_in_layer(&mut self, order: Order, coefficient: f64, direction: f64) {
        let again =
            self.growth.is_some_and(|(o, c, _)| o == order && coefficient < LAYER_EXCESS * c);
        if !again {
            self.grows(order, coefficient, direction);
        }
    }

    /// Records the growth of roots in one direction.
    pub(crate) fn takes(&mut self, found: RootGrowth, direction: f64) {
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

    /// Records that growth increases towards a neighbouring layer and so must exceed `order` there.
    pub(crate) fn expects(&mut self, order: Order) {
        self.expected = self.expected.max(Some(order));
    }

    /// Whether growth of order `order` could exceed the largest so far.
    pub(crate) fn may_improve(&self, order: Order) -> bool {
        self.growth.is_none_or(|(known, _, _)| order >= known)
    }

    /// Whether growth of some order below `order` could exceed the largest so far.
    pub(crate) fn may_improve_below(&self, order: Order) -> bool {
        self.growth.is_none_or(|(known, _, _)| order > known)
    }

    /// The order of growth that was expected and not found.
    pub(crate) fn missing(&self) -> Option<Order> {
        self.expected.filter(|&order| self.may_improve(order))
    }

    /// Whether no growth has been recorded.
    pub(crate) fn is_bounded(&self) -> bool {
        self.growth.is_none()
    }

    /// Records that branches of neutral roots of order `order` touch near `angle` (rad): growth of lower order depends
    /// on whether they touch exactly.
    pub(crate) fn doubts_contact(&mut self, order: Order, angle: f64) {
        self.doubts(
            format!(
                "distance between roots of order {} that touch near {:.6}°",
                order.value(),
                angle.rem_euclid(PI).to_degrees()
            ),
            0.0,
            f64::EPSILON,
        );
    }

    /// Records an undecided quantity; only the first is stored.
    pub(crate) fn doubts(&mut self, quantity: String, value: f64, rounding: f64) {
        self.doubt.get_or_insert((quantity, value, rounding));
    }
}
