//! Uniform sampling of an interval.

/// Returns `points` equidistant numbers from `from` to `to`, both included.
pub fn sample_interval(from: f64, to: f64, points: usize) -> Vec<f64> {
    (0..points).map(|i| from + (to - from) * i as f64 / (points - 1) as f64).collect()
}
