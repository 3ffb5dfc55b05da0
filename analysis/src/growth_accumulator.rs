//! Accumulator of the largest growth and of undecided quantities during an assessment.

use crate::newton_polygon::GrowthOrder;
use crate::puiseux::RootGrowth;
use std::f64::consts::PI;

/// Factor by which the growth coefficient in a layer around a degenerate direction must exceed the largest coefficient
/// so far of the same order: a layer usually repeats the coefficient of the neighbouring sectors.
const LAYER_EXCESS: f64 = 1.0 + 1e-6;

/// Largest growth so far, and the first undecided quantity.
#[derive(Default)]
pub(crate) struct GrowthAccumulator {
    /// Largest order of growth, its scaled coefficient, and the direction, rad.
    pub(crate) growth: Option<(GrowthOrder, f64, f64)>,
    /// First undecided quantity, its value and its rounding bound.
    pub(crate) undecided_quantity: Option<(String, f64, f64)>,
    /// Order that growth still to be found must exceed.
    expected_order: Option<GrowthOrder>,
}

impl GrowthAccumulator {
    /// Records growth if its order, or its coefficient at equal order, is the largest so far.
    pub(crate) fn record_growth(&mut self, order: GrowthOrder, coefficient: f64, direction: f64) {
        let better = self.growth.is_none_or(|(o, c, _)| (order, coefficient) > (o, c));
        if better {
            self.growth = Some((order, coefficient, direction));
        }
    }

    /// Records growth in a layer, unless it repeats the largest known coefficient of the same order (`LAYER_EXCESS`).
    pub(crate) fn record_layer_growth(
        &mut self,
        order: GrowthOrder,
        coefficient: f64,
        direction: f64,
    ) {
        let again =
            self.growth.is_some_and(|(o, c, _)| o == order && coefficient < LAYER_EXCESS * c);
        if !again {
            self.record_growth(order, coefficient, direction);
        }
    }

    /// Records the growth of roots in one direction.
    pub(crate) fn record_root_growth(&mut self, found: RootGrowth, direction: f64) {
        if let Some((order, coefficient)) = found.growth {
            self.record_layer_growth(order, coefficient, direction);
        }
        if let Some((order, value, bound)) = found.undecided_term {
            self.record_undecided(
                format!("real part of the coefficient of order {}", order.to_f64()),
                value,
                bound,
            );
        }
    }

    /// Records that growth increases towards a neighbouring layer and so must exceed `order` there.
    pub(crate) fn expect_growth_above(&mut self, order: GrowthOrder) {
        self.expected_order = self.expected_order.max(Some(order));
    }

    /// Whether growth of order `order` could exceed the largest growth recorded so far.
    pub(crate) fn can_improve(&self, order: GrowthOrder) -> bool {
        self.growth.is_none_or(|(known, _, _)| order >= known)
    }

    /// Whether growth of some order below `order` could exceed the largest growth recorded so far.
    pub(crate) fn can_improve_below(&self, order: GrowthOrder) -> bool {
        self.growth.is_none_or(|(known, _, _)| order > known)
    }

    /// Returns the order passed to [`Self::expect_growth_above`] if no growth of a higher order was recorded: then the
    /// search is incomplete.
    pub(crate) fn missing_order(&self) -> Option<GrowthOrder> {
        self.expected_order.filter(|&order| self.can_improve(order))
    }

    /// Whether no growth has been recorded.
    pub(crate) fn is_bounded(&self) -> bool {
        self.growth.is_none()
    }

    /// Records that branches of neutral roots of order `order` touch near `angle` (rad): growth of lower order depends
    /// on whether they touch exactly.
    pub(crate) fn record_undecided_contact(&mut self, order: GrowthOrder, angle: f64) {
        self.record_undecided(
            format!(
                "distance between roots of order {} that touch near {:.6}°",
                order.to_f64(),
                angle.rem_euclid(PI).to_degrees()
            ),
            0.0,
            f64::EPSILON,
        );
    }

    /// Records an undecided quantity; only the first is stored.
    pub(crate) fn record_undecided(&mut self, quantity: String, value: f64, rounding: f64) {
        self.undecided_quantity.get_or_insert((quantity, value, rounding));
    }
}
