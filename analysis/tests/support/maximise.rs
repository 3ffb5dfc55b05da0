//! Maximisation over directions.

use std::f64::consts::FRAC_PI_2;

/// Maximum of a function of an angle of period π, and its angle, by a scan of 2 × `scan_steps` intervals and shrinking
/// grids around the maximum.
pub fn maximise_over_half_turn(scan_steps: i32, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut best = (f64::NEG_INFINITY, 0.0);
    let (mut centre, mut width) = (FRAC_PI_2, FRAC_PI_2);
    for round in 0..14 {
        let steps = if round == 0 { scan_steps } else { 40 };
        for n in -steps..=steps {
            let angle = centre + width * f64::from(n) / f64::from(steps);
            let value = f(angle);
            if value > best.0 {
                best = (value, angle);
            }
        }
        (centre, width) = (best.1, 4.0 * width / f64::from(steps));
    }
    best
}
