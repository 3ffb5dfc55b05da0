//! Directions on the half-sphere: a Fibonacci spiral, and local maximisation by pattern search.

use nalgebra::Vector3;

/// Directions spread evenly over the half-sphere on a Fibonacci spiral.
pub fn fibonacci_directions(count: usize) -> impl Iterator<Item = [f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    })
}

/// Local maximum of a function of the direction near `start`, by pattern search with decreasing steps.
pub fn maximise_by_pattern_search(
    start: [f64; 3],
    mut step: f64,
    function: impl Fn([f64; 3]) -> f64,
) -> ([f64; 3], f64) {
    let mut best = (start, function(start));
    while step > 1e-9 {
        let centre = Vector3::from(best.0);
        let first = centre.cross(&if centre.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() });
        let first = first.normalize();
        let second = centre.cross(&first);
        let before = best.1;
        for i in 0..8 {
            let (sin, cos) = (std::f64::consts::FRAC_PI_4 * f64::from(i)).sin_cos();
            let point = (centre + (first * cos + second * sin) * step).normalize();
            let value = function(point.into());
            if value > best.1 {
                best = (point.into(), value);
            }
        }
        if best.1 <= before {
            step *= 0.5;
        }
    }
    best
}
