//! Growth in the layers around degenerate directions.
//!
//! Across a direction in which a leading coefficient vanishes let κ⊥ = O(k^τ), τ < 1. The orders m
//! and offsets τ that compete are the facets of the Newton polytope of the points (i, j, l) of
//! ςⁱ κʲ κ⊥ˡ in the axes of that direction.

use crate::form::{Form, Zero};
use crate::newton::{
    NextOrder, Order, Trend, Worst, corners_of, golden_section, is_on, next_order, trend,
};
use crate::polynomial::Term;
use models::Rounded;

/// Layers are scanned over widths of 2^−SCAN to 2^SCAN in the system's own units.
const SCAN: i32 = 30;

/// A point ςⁱ κʲ κ⊥ˡ of the polynomial in the axes of a degenerate direction.
#[derive(Clone, Copy)]
struct Point {
    i: i64,
    j: i64,
    l: i64,
    value: Rounded,
}

/// Coefficients in the axes of a direction that is known to within `bound`: those in the axes as they
/// stand, their bounds widened by what a turn by `bound` does to them.
fn rotated(form: &Form, cos: Rounded, sin: Rounded, bound: f64) -> Vec<Rounded> {
    let turned = form.rotated(cos, sin);
    let slope = turned.derivative();
    let curvature = slope.derivative();
    let widened = |l: usize| {
        bound * slope.coefficients[l].value.abs()
            + bound * bound * curvature.coefficients[l].value.abs()
    };
    turned
        .coefficients
        .iter()
        .enumerate()
        .map(|(l, c)| Rounded { value: c.value, bound: c.bound + widened(l) })
        .collect()
}

/// Growth in the layers around a degenerate direction, and in that direction itself.
pub(crate) fn search_layer(terms: &[Term], zero: &Zero, worst: &mut Worst) {
    let axis = Rounded::exact(zero.angle);
    let (cos, sin) = (axis.cos(), axis.sin());
    // Of all points with equal i and l the one with the greatest j dominates.
    let mut points: Vec<Point> = Vec::new();
    for term in terms {
        let d = term.form.degree();
        for (l, &value) in rotated(&term.form, cos, sin, zero.bound).iter().enumerate() {
            if !matches!(value.sign(), Some(1 | -1)) {
                continue;
            }
            let point = Point { i: term.time as i64, j: (d - l) as i64, l: l as i64, value };
            match points.iter_mut().find(|p| (p.i, p.l) == (point.i, point.l)) {
                Some(p) if p.j < point.j => *p = point,
                Some(_) => {}
                None => points.push(point),
            }
        }
    }

    // In the direction itself only l = 0 counts.
    let line: Vec<Point> = points.iter().copied().filter(|p| p.l == 0).collect();
    for (order, on) in polygon_of(&line) {
        match trend(&scaled_points(&on, 1.0)) {
            Trend::Grows(c) => worst.grows_in_layer(order, c, zero.angle),
            Trend::Decays => {}
            Trend::Neutral => match next_order(&scaled_points(&line, 1.0), order) {
                NextOrder::Bounded => {}
                NextOrder::Grows(order, c) => worst.grows_in_layer(order, c, zero.angle),
                NextOrder::Doubtful(quantity, value, bound) => {
                    worst.doubts(quantity, value, bound);
                }
            },
            Trend::Doubtful(value) => worst.doubts(
                "leading coefficient in a degenerate direction".into(),
                value.value,
                value.bound,
            ),
        }
    }

    for (order, on) in facets(&points) {
        // κ⊥ = d k^τ: scan the size of d over the range in which the terms exchange dominance.
        let at = |log: f64, sign: f64| trend(&scaled_points(&on, sign * log.exp2()));
        let rate = |log: f64, sign: f64| match at(log, sign) {
            Trend::Grows(c) => c,
            _ => 0.0,
        };
        for sign in [1.0, -1.0] {
            let mut best = (0.0, 0.0);
            let mut neutral = 0;
            for log in (-SCAN..=SCAN).step_by(2).map(f64::from) {
                match at(log, sign) {
                    Trend::Grows(c) if c > best.0 => best = (c, log),
                    Trend::Neutral => neutral += 1,
                    _ => {}
                }
            }
            if best.0 > 0.0 && best.1.abs() == f64::from(SCAN) {
                // Still rising where the scan ends: not the growth of this layer.
                worst.doubts(
                    format!("growth of order {} in a layer", order.value()),
                    best.0,
                    f64::INFINITY,
                );
            } else if best.0 > 0.0 {
                let x = golden_section(|s| rate(s, sign), best.1 - 2.0, best.1 + 2.0);
                worst.grows_in_layer(order, rate(x, sign).max(best.0), zero.angle);
            } else if neutral > SCAN / 2 {
                worst.doubts(
                    format!("real part of the coefficient of order {} in a layer", order.value()),
                    0.0,
                    f64::EPSILON,
                );
            }
        }
    }
}

/// Sums the points of equal power of ς with κ⊥ = d; by descending power.
fn scaled_points(on: &[Point], d: f64) -> Vec<(usize, i64, Rounded)> {
    let mut list: Vec<(usize, i64, Rounded)> = Vec::new();
    let mut sorted = on.to_vec();
    sorted.sort_by_key(|p| (std::cmp::Reverse(p.i), p.j + p.l));
    for p in sorted {
        let value = Rounded::exact(d.powi(p.l as i32)) * p.value;
        match list.last_mut() {
            Some(last) if last.0 == p.i as usize && last.1 == p.j + p.l => last.2 += value,
            _ => list.push((p.i as usize, p.j + p.l, value)),
        }
    }
    list
}

/// Edges of positive order of the polygon of points with one l each.
fn polygon_of(points: &[Point]) -> Vec<(Order, Vec<Point>)> {
    corners_of(points.iter().map(|p| (p.i, p.j)))
        .windows(2)
        .filter(|pair| pair[1].1 > pair[0].1)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let on = points.iter().filter(|p| is_on((p.i, p.j), (a, b))).copied().collect();
            (Order::new(b.1 - a.1, a.0 - b.0), on)
        })
        .collect()
}

/// Facets of the polytope whose normal is (m, 1, τ) with m > 0 and τ < 1.
fn facets(points: &[Point]) -> Vec<(Order, Vec<Point>)> {
    let mut found: Vec<([i64; 3], Vec<Point>)> = Vec::new();
    for (a, p) in points.iter().enumerate() {
        for (b, q) in points.iter().enumerate().skip(a + 1) {
            for r in &points[b + 1..] {
                // m Δi + τ Δl = −Δj for both differences, times the determinant.
                let (i1, l1, j1) = (p.i - q.i, p.l - q.l, p.j - q.j);
                let (i2, l2, j2) = (p.i - r.i, p.l - r.l, p.j - r.j);
                let mut normal = [j2 * l1 - j1 * l2, i1 * l2 - i2 * l1, i2 * j1 - i1 * j2];
                if normal[1] == 0 {
                    continue;
                }
                if normal[1] < 0 {
                    normal = normal.map(|x| -x);
                }
                let [m, one, tau] = normal;
                if m <= 0 || tau >= one {
                    continue;
                }
                let weight = |x: &Point| m * x.i + one * x.j + tau * x.l;
                let height = weight(p);
                if points.iter().any(|x| weight(x) > height) {
                    continue;
                }
                let same = |n: &[i64; 3]| n[0] * one == m * n[1] && n[2] * one == tau * n[1];
                if !found.iter().any(|(n, _)| same(n)) {
                    let on = points.iter().filter(|x| weight(x) == height).copied().collect();
                    found.push((normal, on));
                }
            }
        }
    }
    found.into_iter().map(|([m, one, _], on)| (Order::new(m, one), on)).collect()
}
