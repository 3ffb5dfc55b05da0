//! Results of the search over all wave normals: strongest flutter and slowest wave.

use num_complex::Complex64;

/// Strongest flutter over all wave normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flutter {
    /// Supremum of |Im c| over the directions with complex c², m/s: short waves grow at the rate |Im c| k.
    pub max_imaginary_speed: f64,
    /// Squared speed c² of the strongest flutter, m²/s²; the other root of the pair is its conjugate.
    pub squared_speed: Complex64,
    /// The wave normal.
    pub normal: [f64; 3],
}

/// Slowest wave over all wave normals, among those with real c².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlowestSpeed {
    /// Smallest real c², m²/s². Zero is a stationary discontinuity, the onset of a shear band; if it is negative, waves
    /// grow at the rate √(−c²) k. Infinite if no direction has a real c².
    pub squared_speed: f64,
    /// The wave normal, which is the normal of the band.
    pub normal: [f64; 3],
    /// Rounding bound of `squared_speed`, m²/s².
    pub rounding: f64,
}

/// Strongest flutter and slowest wave over all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveExtremes {
    /// Strongest flutter; `None` if no speed is complex.
    pub flutter: Option<Flutter>,
    /// Wave of the smallest real c².
    pub slowest: SlowestSpeed,
}

impl WaveExtremes {
    /// Largest |Im c| of flutter and of negative c², m/s; 0 if there is neither.
    pub fn max_imaginary_speed(&self) -> f64 {
        let divergence = (-self.slowest.squared_speed).max(0.0).sqrt();
        self.flutter.map_or(divergence, |flutter| flutter.max_imaginary_speed.max(divergence))
    }
}
