//! Strongest flutter (complex characteristic speeds) and slowest wave of a solid over all directions.

use analysis::acoustic_tensor3::{Flutter, SlowestSpeed};
use analysis::solids::angles_deg;
use serde::Serialize;

/// Unit normal of a plane wave front, as a vector and as two angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaveNormal {
    /// Unit vector n normal to the wave front.
    pub vector: [f64; 3],
    /// Direction of the normal in the plane of x₁ and x₂, measured from x₁, degrees.
    pub direction_deg: f64,
    /// Elevation of the normal above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
}

impl From<[f64; 3]> for WaveNormal {
    fn from(vector: [f64; 3]) -> Self {
        let [direction_deg, elevation_deg] = angles_deg(vector);
        Self { vector, direction_deg, elevation_deg }
    }
}

/// Wave of the strongest flutter, i.e. of the largest imaginary part of a complex characteristic speed c.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlutterWave {
    /// Supremum of |Im c| over the directions with complex c², m/s; short waves grow at the rate of this speed times
    /// the wave number k.
    #[serde(rename = "growth")]
    pub max_imaginary_speed: f64,
    /// Real and imaginary part of c² of this wave, m²/s²; the complex conjugate is also an eigenvalue.
    pub squared_speed: [f64; 2],
    /// Wave normal of the strongest flutter.
    #[serde(rename = "normal")]
    pub wave_normal: WaveNormal,
}

impl From<Flutter> for FlutterWave {
    fn from(flutter: Flutter) -> Self {
        let Flutter { max_imaginary_speed, squared_speed, normal } = flutter;
        let squared_speed = [squared_speed.re, squared_speed.im];
        Self { max_imaginary_speed, squared_speed, wave_normal: normal.into() }
    }
}

/// Slowest wave over all directions among those with real squared characteristic speed c².
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlowestWave {
    /// Smallest real c², m²/s²; infinite if no direction has real c² (null in JSON).
    pub squared_speed: f64,
    /// Bound on the rounding error of `squared_speed`, m²/s².
    #[serde(rename = "rounding")]
    pub rounding_bound: f64,
    /// Wave normal of the slowest wave.
    #[serde(rename = "normal")]
    pub wave_normal: WaveNormal,
}

impl From<SlowestSpeed> for SlowestWave {
    fn from(SlowestSpeed { squared_speed, normal, rounding }: SlowestSpeed) -> Self {
        Self { squared_speed, rounding_bound: rounding, wave_normal: normal.into() }
    }
}
