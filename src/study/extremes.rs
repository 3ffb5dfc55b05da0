//! Strongest flutter (complex characteristic speeds) and slowest wave of a solid over all directions.

use analysis::acoustic_tensor3::{Flutter, SlowestSpeed};
use analysis::solids::angles_deg;
use serde::Serialize;

/// Wave normal, as a vector and as angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaveNormal {
    /// Unit vector normal to the wave front.
    pub vector: [f64; 3],
    /// Direction in the plane of x₁ and x₂ from x₁, degrees.
    pub direction_deg: f64,
    /// Elevation above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
}

impl From<[f64; 3]> for WaveNormal {
    fn from(vector: [f64; 3]) -> Self {
        let [direction_deg, elevation_deg] = angles_deg(vector);
        Self { vector, direction_deg, elevation_deg }
    }
}

/// Wave of the strongest flutter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlutterWave {
    /// Supremum of |Im c| over the directions with complex c², m/s; short waves grow at the rate of this speed times
    /// the wave number k.
    #[serde(rename = "growth")]
    pub max_imaginary_speed: f64,
    /// Real and imaginary part of c² at the supremum, m²/s²; the conjugate is also an eigenvalue.
    pub squared_speed: [f64; 2],
    /// Normal of this wave.
    pub normal: WaveNormal,
}

impl From<Flutter> for FlutterWave {
    fn from(Flutter { growth, speed_squared, normal }: Flutter) -> Self {
        let squared_speed = [speed_squared.re, speed_squared.im];
        Self { max_imaginary_speed: growth, squared_speed, normal: normal.into() }
    }
}

/// Slowest wave among those with real c².
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlowestWave {
    /// Smallest real c², m²/s²; infinite if no direction has real c² (null in JSON).
    pub squared_speed: f64,
    /// Bound on the rounding error of `squared_speed`, m²/s².
    pub rounding: f64,
    /// Normal of this wave.
    pub normal: WaveNormal,
}

impl From<SlowestSpeed> for SlowestWave {
    fn from(SlowestSpeed { speed_squared, normal, rounding }: SlowestSpeed) -> Self {
        Self { squared_speed: speed_squared, rounding, normal: normal.into() }
    }
}
