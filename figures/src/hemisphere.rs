//! Lambert's azimuthal equal-area projection of a hemisphere to a disc.

use std::f64::consts::SQRT_2;

use crate::picture::Point;
use crate::polar::polar_to_point;

/// Projection of the hemisphere to a disc.
#[derive(Clone, Copy)]
pub(crate) struct HemisphereProjection {
    /// Centre of the disc.
    pub(crate) centre: Point,
    /// Radius of the disc, pixels.
    pub(crate) radius: f64,
}

impl HemisphereProjection {
    /// Projects a direction, given by its angles from x₃ and from x₁ in degrees, to a point.
    pub(crate) fn project(self, polar_deg: f64, azimuth_deg: f64) -> Point {
        let radius = self.radius * SQRT_2 * (0.5 * polar_deg.to_radians()).sin();
        polar_to_point(self.centre, azimuth_deg, radius)
    }

    /// Computes the angles (degrees, from x₃ and from x₁) of the direction projected to a point; for a point outside
    /// the rim the angles of the opposite direction, which is in the hemisphere.
    pub(crate) fn unproject(self, [x, y]: Point) -> [f64; 2] {
        let (dx, dy) = (x - self.centre[0], self.centre[1] - y);
        let half_sine = (dx.hypot(dy) / (SQRT_2 * self.radius)).min(1.0);
        let polar = 2.0 * half_sine.asin().to_degrees();
        let azimuth = dy.atan2(dx).to_degrees();
        if polar > 90.0 { [180.0 - polar, azimuth + 180.0] } else { [polar, azimuth] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_preserves_areas_and_directions() {
        let disc = HemisphereProjection { centre: [500.0, 500.0], radius: 400.0 };
        for [polar, azimuth] in [[0.0, 0.0], [30.0, 40.0], [60.0, -120.0], [90.0, 90.0]] {
            let [x, y] = disc.project(polar, azimuth);
            let back = disc.unproject([x, y]);
            assert!((back[0] - polar).abs() < 1e-6, "{back:?}");
            assert!(polar == 0.0 || (back[1] - azimuth).abs() < 1e-6, "{back:?}");
        }
        // Equal areas: half of the area of the hemisphere is within 60° of the pole.
        let [x, _] = disc.project(60.0, 0.0);
        assert!((((x - 500.0) / 400.0).powi(2) - 0.5).abs() < 1e-12);
        // Outside the rim are the opposite directions.
        let [polar, azimuth] = disc.unproject([905.0, 500.0]);
        assert!(polar < 90.0 && (azimuth - 180.0).abs() < 1e-9);
    }
}
