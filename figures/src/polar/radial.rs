//! Symmetric logarithmic radial scale of a polar diagram.

use crate::growth::Line;
use crate::scale::SymmetricLog;

/// Share of the radius that is left empty in the centre, where circles would be too small to be legible.
pub(super) const HOLE: f64 = 0.12;

/// Magnitude above which growth rates are treated as infinite.
const FINITE: f64 = 1e300;

/// Radial scale: maps positions of the symmetric logarithm between `low` and `high` to radii, pixels.
pub(super) struct Radial {
    pub(super) scale: SymmetricLog,
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) radius: f64,
}

impl Radial {
    pub(super) fn of(curves: &[Line], radius: f64) -> Self {
        let growth = || curves.iter().flat_map(|line| &line.points).map(|point| point[1]);
        let finite = || growth().filter(|growth| growth.abs() < FINITE);
        let scale = SymmetricLog::for_values(finite());
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for place in finite().map(|growth| scale.forward(growth)) {
            (low, high) = (low.min(place), high.max(place));
        }
        // The range extends to both sides of zero; infinite values are drawn in the margins.
        let room = 0.06 * (high - low).max(2.0);
        Self { scale, low: low.min(-1.0) - room, high: high.max(1.0) + room, radius }
    }

    /// Returns the radius of a position of the symmetric logarithm, pixels.
    pub(super) fn at_place(&self, place: f64) -> f64 {
        let share = (place.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        self.radius * (HOLE + (1.0 - HOLE) * share)
    }

    /// Returns the radius of a growth rate, pixels; infinite growth rates are drawn just inside the rim or the hole.
    pub(super) fn at(&self, growth: f64) -> f64 {
        let inset = 0.015 * (self.high - self.low);
        self.at_place(self.scale.forward(growth).clamp(self.low + inset, self.high - inset))
    }
}
