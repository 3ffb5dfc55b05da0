//! Symmetric logarithmic radial scale of a polar diagram.

use crate::growth::LabelledCurve;
use crate::scale::{FINITE_LIMIT, SymmetricLog};

/// Fraction of the radius that is left empty in the centre, where circles would be too small to be legible.
pub(super) const HOLE_FRACTION: f64 = 0.12;

/// Radial scale: maps positions of the symmetric logarithm between `low` and `high` to radii, pixels.
pub(super) struct RadialScale {
    pub(super) scale: SymmetricLog,
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) rim_radius: f64,
}

impl RadialScale {
    pub(super) fn from_curves(curves: &[LabelledCurve], rim_radius: f64) -> Self {
        let growth = || curves.iter().flat_map(|line| &line.points).map(|point| point[1]);
        let finite = || growth().filter(|growth| growth.abs() < FINITE_LIMIT);
        let scale = SymmetricLog::from_values(finite());
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for place in finite().map(|growth| scale.to_position(growth)) {
            (low, high) = (low.min(place), high.max(place));
        }
        // The range extends to both sides of zero; infinite values are drawn in the margins.
        let margin = 0.06 * (high - low).max(2.0);
        Self { scale, low: low.min(-1.0) - margin, high: high.max(1.0) + margin, rim_radius }
    }

    /// Returns the radius of a position of the symmetric logarithm, pixels.
    pub(super) fn position_radius(&self, position: f64) -> f64 {
        let share = (position.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        self.rim_radius * (HOLE_FRACTION + (1.0 - HOLE_FRACTION) * share)
    }

    /// Returns the radius of a growth rate, pixels; infinite growth rates are drawn just inside the rim (+∞) or just
    /// outside the hole (−∞).
    pub(super) fn growth_radius(&self, growth: f64) -> f64 {
        let inset = 0.015 * (self.high - self.low);
        self.position_radius(
            self.scale.to_position(growth).clamp(self.low + inset, self.high - inset),
        )
    }
}
