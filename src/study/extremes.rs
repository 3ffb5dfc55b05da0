//! Extremes of the characteristic speeds of a solid over all directions, as they stand in values.

use analysis::solids::angles_deg;
use analysis::sphere;
use serde::Serialize;

/// The normal of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Normal {
    /// Unit vector.
    pub vector: [f64; 3],
    /// Direction in the plane of x₁ and x₂ from x₁, degrees.
    pub direction_deg: f64,
    /// Angle above that plane, degrees.
    pub elevation_deg: f64,
}

impl From<[f64; 3]> for Normal {
    fn from(vector: [f64; 3]) -> Self {
        let [direction_deg, elevation_deg] = angles_deg(vector);
        Self { vector, direction_deg, elevation_deg }
    }
}

/// The strongest flutter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flutter {
    /// Greatest |Im c|, m/s: short waves grow as this times k.
    pub growth: f64,
    /// Re c² and Im c², m²/s²; the conjugate is a c² too.
    pub squared_speed: [f64; 2],
    /// Normal of the wave.
    pub normal: Normal,
}

impl From<sphere::Flutter> for Flutter {
    fn from(flutter: sphere::Flutter) -> Self {
        Self {
            growth: flutter.growth,
            squared_speed: [flutter.speed_squared.re, flutter.speed_squared.im],
            normal: flutter.normal.into(),
        }
    }
}

/// The slowest wave among those with real c².
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slowest {
    /// Least real c², m²/s²; infinite if no direction has a real one (null in JSON).
    pub squared_speed: f64,
    /// How far rounding may have moved it, m²/s².
    pub rounding: f64,
    /// Normal of the wave.
    pub normal: Normal,
}

impl From<sphere::Slowest> for Slowest {
    fn from(slowest: sphere::Slowest) -> Self {
        Self {
            squared_speed: slowest.speed_squared,
            rounding: slowest.rounding,
            normal: slowest.normal.into(),
        }
    }
}
