//! Minimisation over directions by Newton's method in the tangent plane.

use super::unit_vectors::{normalise, tangent_vectors};

/// Final step of the finite differences, rad: the rounding error divided by the step and the square of the step are
/// both below 1e-9.
const MIN_DIFFERENCE_STEP: f64 = 2e-5;

/// Local minimum near a direction, by Newton's method with finite differences in the tangent plane, and by pattern
/// search with decreasing steps if the function is not smooth; Newton steps are at first at most `radius` (rad) long.
/// The iteration ends at a Newton step below 1e-9 rad or a pattern step below 1e-10 rad, after 100 rounds, or if the
/// values around the direction show that the minimum stays above `target`. Returns the direction and the value there.
pub(super) fn minimise(
    start: [f64; 3],
    radius: f64,
    target: f64,
    mut function: impl FnMut(&[f64; 3]) -> f64,
) -> ([f64; 3], f64) {
    let mut best = (start, function(&start));
    let (mut trust, mut h) = (radius, 0.25 * radius);
    for _ in 0..100 {
        let (centre, middle) = best;
        let [first, second] = tangent_vectors(&centre);
        let mut at = |x: f64, y: f64| {
            let point =
                normalise(std::array::from_fn(|i| centre[i] + x * first[i] + y * second[i]));
            let value = function(&point);
            if value < best.1 {
                best = (point, value);
            }
            (point, value)
        };
        let [east, west, north, south, both, neither] =
            [(h, 0.0), (-h, 0.0), (0.0, h), (0.0, -h), (h, h), (-h, -h)].map(|(x, y)| at(x, y).1);
        let gradient = [(east - west) / (2.0 * h), (north - south) / (2.0 * h)];
        let square = h * h;
        let xx = (east - 2.0 * middle + west) / square;
        let yy = (north - 2.0 * middle + south) / square;
        let xy = (both - east - north + 2.0 * middle - west - south + neither) / (2.0 * square);
        let determinant = xx * yy - xy * xy;
        let is_bowl = xx > 0.0 && determinant > 1e-12 * xx * xx && determinant.is_finite();
        let mut is_lower = false;
        if is_bowl {
            let mut step = [
                (xy * gradient[1] - yy * gradient[0]) / determinant,
                (xy * gradient[0] - xx * gradient[1]) / determinant,
            ];
            let gain = -0.5 * (gradient[0] * step[0] + gradient[1] * step[1]);
            let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
            if length <= trust && middle - 4.0 * gain > target {
                return best;
            }
            let shortened = (trust / length).min(1.0);
            step = step.map(|x| shortened * x);
            let (point, value) = at(step[0], step[1]);
            if value <= middle + 4.0 * f64::EPSILON * middle.abs() {
                // Rounding may make a stencil point slightly lower than the Newton point; prefer the Newton point.
                if best.1 >= value - 4.0 * f64::EPSILON * middle.abs() || length < h {
                    best = (point, value);
                }
                is_lower = true;
                if length < 1e-9 && h <= MIN_DIFFERENCE_STEP {
                    return best;
                }
                h = length.clamp(MIN_DIFFERENCE_STEP.min(h), h);
            }
        }
        if !is_lower && best.1 >= middle {
            // No stencil point is lower: points closer to the centre cannot be lower by more than about the rise over
            // the stencil.
            let stencil_values = [east, west, north, south, both, neither];
            let rise = stencil_values.iter().filter(|value| value.is_finite());
            let rise = rise.fold(0.0, |rise: f64, value| rise.max(value - middle));
            if rise > 0.0 && middle - 2.0 * rise > target {
                return best;
            }
            h *= 0.25;
            trust *= 0.25;
            if h < 1e-10 {
                return best;
            }
        }
    }
    best
}
