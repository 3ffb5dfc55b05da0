//! Newton polygons: orders and leading coefficients of roots as k → ∞ in one direction.

use crate::roots;
use models::Rounded;
use num_complex::Complex64;

/// A rational order of growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Numerator.
    pub numerator: i64,
    /// Denominator, positive, in lowest terms.
    pub denominator: i64,
}

impl Order {
    pub(crate) fn new(numerator: i64, denominator: i64) -> Self {
        fn gcd(a: i64, b: i64) -> i64 {
            if b == 0 { a.abs() } else { gcd(b, a % b) }
        }
        let divisor = gcd(numerator, denominator).max(1) * denominator.signum();
        Self { numerator: numerator / divisor, denominator: denominator / divisor }
    }

    /// As a double.
    pub fn value(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

/// What the leading coefficients c of some roots do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trend {
    /// Some Re c > 0, the greatest of them.
    Grows(f64),
    /// Greatest Re c is zero to rounding (a wave): the next order decides.
    Neutral,
    /// All Re c < 0.
    Decays,
    /// A sign is lost in rounding.
    Doubtful(Rounded),
}

/// By how much a layer's coefficient must exceed that of the sectors beside it to be news.
pub(crate) const LAYER_EXCESS: f64 = 1.01;

/// |Re c| below this fraction of |c| counts as zero where c is a root of a polynomial with more
/// than two terms; two terms are judged by exact signs.
pub(crate) const NEUTRAL: f64 = 1e-7;

/// Roots nearer to each other than this fraction of their modulus may be one repeated root.
pub(crate) const CLUSTER: f64 = 1e-3;

/// The greatest growth met so far, and what could not be judged.
#[derive(Default)]
pub(crate) struct Worst {
    /// (order, scaled coefficient, direction)
    pub(crate) growth: Option<(Order, f64, f64)>,
    /// (order, scaled coefficient) of the sectors alone.
    pub(crate) sectors: Option<(Order, f64)>,
    pub(crate) doubt: Option<(String, f64, f64)>,
}

impl Worst {
    pub(crate) fn grows(&mut self, order: Order, coefficient: f64, direction: f64) {
        let better = self.growth.is_none_or(|(o, c, _)| {
            let (new, old) = (order.value(), o.value());
            new > old || (new == old && coefficient > c)
        });
        if better {
            self.growth = Some((order, coefficient, direction));
        }
    }

    /// Growth in a layer. Of equal order it is mostly that of the sectors beside it again, which
    /// know it more accurately.
    pub(crate) fn grows_in_layer(&mut self, order: Order, coefficient: f64, direction: f64) {
        let again = self.sectors.is_some_and(|(o, c)| o == order && coefficient < LAYER_EXCESS * c);
        if !again {
            self.grows(order, coefficient, direction);
        }
    }

    pub(crate) fn doubts(&mut self, quantity: String, value: f64, rounding: f64) {
        self.doubt.get_or_insert((quantity, value, rounding));
    }
}

/// Corners of the upper boundary of the Newton polygon of points (i, j), by descending i.
pub(crate) fn corners_of(points: impl Iterator<Item = (i64, i64)>) -> Vec<(i64, i64)> {
    let mut sorted: Vec<_> = points.collect();
    // Of equal i only the greatest j counts.
    sorted.sort_by_key(|&(i, j)| (std::cmp::Reverse(i), std::cmp::Reverse(j)));
    sorted.dedup_by_key(|point| point.0);
    let mut corners: Vec<(i64, i64)> = Vec::new();
    for (i, j) in sorted {
        while let [.., a, b] = corners[..] {
            // b below or on the chord from a to the new point goes.
            if (b.1 - a.1) * (a.0 - i) > (j - a.1) * (a.0 - b.0) {
                break;
            }
            corners.pop();
        }
        corners.push((i, j));
    }
    corners
}

/// Whether (i, j) lies on the edge between two corners.
pub(crate) fn is_on((i, j): (i64, i64), ((i1, j1), (i0, j0)): ((i64, i64), (i64, i64))) -> bool {
    i0 <= i && i <= i1 && (j - j1) * (i1 - i0) == (j0 - j1) * (i1 - i)
}

/// iⁿ
pub(crate) fn imaginary_power(n: i64) -> Complex64 {
    match n.rem_euclid(4) {
        0 => Complex64::ONE,
        1 => Complex64::I,
        2 => -Complex64::ONE,
        _ => -Complex64::I,
    }
}

/// What the non-zero roots c of Σ `coefficient` i^`power of κ` c^`power of ς` do; the coefficients
/// by descending power of ς.
pub(crate) fn trend(points: &[(usize, i64, Rounded)]) -> Trend {
    let (Some(&(i1, j1, first)), Some(&(i0, j0, last))) = (points.first(), points.last()) else {
        return Trend::Decays;
    };
    for corner in [first, last] {
        if corner.sign().is_none_or(|s| s == 0) {
            return Trend::Doubtful(corner);
        }
    }
    if let [_, _] = points {
        // c^p = w with |w| positive and w/|w| = −(±1) i^(j0 − j1), exactly.
        let p = i1 - i0;
        let modulus = (last.value / first.value).abs().powf(1.0 / p as f64);
        let w = -imaginary_power(j0 - j1) * (last.value / first.value).signum();
        let turn = w.arg() / p as f64;
        let greatest = (0..p)
            .map(|n| {
                let angle = turn + std::f64::consts::TAU * n as f64 / p as f64;
                let cos = angle.cos();
                // Multiples of a right angle are exact here.
                if cos.abs() < 1e-12 { 0.0 } else { cos }
            })
            .fold(-1.0, f64::max);
        return match greatest {
            g if g > 0.0 => Trend::Grows(g * modulus),
            0.0 => Trend::Neutral,
            _ => Trend::Decays,
        };
    }
    let mut polynomial = vec![Complex64::ZERO; i1 - i0 + 1];
    for &(i, j, value) in points {
        polynomial[i - i0] += imaginary_power(j) * value.value;
    }
    let roots = roots::of(&polynomial);
    // A repeated root comes back as a cluster: its real part is known to the cluster's size only.
    let tolerance = |c: &Complex64| {
        let nearest = roots
            .iter()
            .filter(|other| *other != c)
            .map(|other| (other - c).norm() / c.norm())
            .fold(f64::INFINITY, f64::min);
        if nearest < CLUSTER { 10.0 * nearest.max(NEUTRAL) } else { NEUTRAL }
    };
    let grows = |c: &&Complex64| c.re > tolerance(c) * c.norm();
    let decays = |c: &Complex64| c.re < -tolerance(c) * c.norm();
    match roots.iter().filter(grows).map(|c| c.re).reduce(f64::max) {
        Some(worst) => Trend::Grows(worst),
        None if roots.iter().all(decays) => Trend::Decays,
        None => Trend::Neutral,
    }
}

/// What the next order of neutral roots says.
pub(crate) enum NextOrder {
    Bounded,
    Grows(Order, f64),
    Doubtful(String, f64, f64),
}

/// Follows roots ς ≈ c k^m with Re c = 0 (waves) to their next order. `points` holds all coefficients
/// in one direction as (power of ς, power of κ, value). With those that lie γ below the edge of order
/// m, ς ≈ c k^m + e k^(m−γ), e = −R(c)/E′(c), where E is the edge polynomial and R collects those
/// points. While m − γ ≤ 0 simple roots stay bounded.
pub(crate) fn next_order(points: &[(usize, i64, Rounded)], order: Order) -> NextOrder {
    let Order { numerator, denominator } = order;
    let weight = |&(i, j, _): &(usize, i64, Rounded)| numerator * i as i64 + denominator * j;
    let Some(top) = points.iter().map(weight).max() else { return NextOrder::Bounded };
    let edge: Vec<_> = points.iter().filter(|p| weight(p) == top).collect();
    let lowest = edge.iter().map(|p| p.0).min().unwrap_or(0);
    let highest = edge.iter().map(|p| p.0).max().unwrap_or(0);
    let gap = points.iter().map(|p| top - weight(p)).filter(|&gap| gap > 0).min();
    let mut polynomial = vec![Complex64::ZERO; highest - lowest + 1];
    for &&(i, j, value) in &edge {
        polynomial[i - lowest] += imaginary_power(j) * value.value;
    }
    let mut result = NextOrder::Bounded;
    for c in roots::of(&polynomial) {
        // Not neutral, and not part of a cluster around a neutral root.
        if c.re.abs() > 10.0 * CLUSTER * c.norm() {
            continue;
        }
        let (mut slope, mut size) = (Complex64::ZERO, 0.0);
        for (i, a) in polynomial.iter().enumerate().skip(1) {
            let term = a * c.powi(i as i32 - 1) * i as f64;
            slope += term;
            size += term.norm();
        }
        if slope.norm() <= NEUTRAL * size {
            let quantity = format!("splitting of a repeated root of order {}", order.value());
            return NextOrder::Doubtful(quantity, slope.norm(), NEUTRAL * size);
        }
        let Some(gap) = gap.filter(|&gap| gap < numerator) else { continue };
        let rest: Complex64 = points
            .iter()
            .filter(|p| top - weight(p) == gap)
            .map(|&(i, j, value)| {
                imaginary_power(j) * value.value * c.powi(i as i32 - lowest as i32)
            })
            .sum();
        let e = -rest / slope;
        let order = Order::new(numerator - gap, denominator);
        if e.re > NEUTRAL * e.norm() {
            if !matches!(result, NextOrder::Grows(_, greatest) if greatest >= e.re) {
                result = NextOrder::Grows(order, e.re);
            }
        } else if e.re >= -NEUTRAL * e.norm() && matches!(result, NextOrder::Bounded) {
            let quantity = format!("real part of the coefficient of order {}", order.value());
            result = NextOrder::Doubtful(quantity, e.re, NEUTRAL * e.norm());
        }
    }
    result
}

/// The place of the greatest value of a function with one maximum in [a, b].
pub(crate) fn golden_section(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut x, mut y) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..60 {
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
