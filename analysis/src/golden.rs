//! Golden section.

const RATIO: f64 = 0.618_033_988_749_894_9;
/// The interval shrinks to the rounding of its ends.
const STEPS: usize = 60;

/// The place of the greatest value of a function with one maximum in [a, b].
pub(crate) fn golden_section(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let (mut x, mut y) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..STEPS {
        if b - a <= 1e-12 * (a.abs() + b.abs()) {
            break;
        }
        if fx >= fy {
            (b, y, fy) = (y, x, fx);
            x = b - RATIO * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + RATIO * (b - a);
            fy = f(y);
        }
    }
    0.5 * (a + b)
}
