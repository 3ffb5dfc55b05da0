//! Growth in the layers around degenerate directions, by the Newton polytope in root, direction and wave number.
//!
//! A chart is the dispersion polynomial in local coordinates: x = ς − ς₀, and the offset y of the wave vector from a
//! direction, Σ value xⁱ yˡ k^j. With x = O(k^m) and y = O(k^τ) the leading part is a facet of the Newton polytope of
//! the points (i, l, j), a polynomial in c and d with x = c k^m and y = d k^τ. Its roots c grow, decay, or are neutral
//! and continued by Puiseux series; a further chart is opened where they vanish, become infinite or collide.

use crate::face::FacePolynomial;
use crate::form::{Form, Zero};
use crate::list::{List, list};
use crate::newton::Order;
use crate::polynomial::Term;
use crate::puiseux::{self, DOUBTFUL, Monomial, Root, binomial, lcm};
use crate::value::Value;
use crate::worst::Worst;
use models::Rounded;
use models::common::elementary::Elementary;
use num_complex::Complex64;
use std::cell::RefCell;
use std::f64::consts::{FRAC_PI_2, PI};

/// Maximum depth of nested charts.
const DEPTH: usize = 4;

/// A monomial `value` xⁱ yˡ k^j of a chart.
#[derive(Clone, Copy, Debug)]
struct Point {
    x: usize,
    y: usize,
    /// Power of k, in units of 1/`Chart::unit`.
    power: i64,
    value: Value,
}

/// Location of a chart, for reports.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    /// The degenerate direction, rad.
    pub(crate) angle: f64,
    /// Remaining depth of nested charts.
    depth: usize,
}

/// A polynomial in local coordinates (x, y) and k; see the module comment.
struct Chart {
    points: List<Point, 64>,
    /// Common denominator of the powers of k.
    unit: i64,
    /// Upper bounds on the orders m of x and τ of y.
    below: Option<Order>,
    offset_below: Order,
}

/// Coefficients of κ^(d−l) κ⊥^l in axes along a degenerate direction, with bounds widened by the uncertainty of the
/// direction.
pub(crate) fn along(form: &Form, zero: &Zero) -> List<Rounded> {
    let axis = Rounded::exact(zero.angle);
    let turned = form.rotated(axis.cos(), axis.sin());
    let slope = turned.derivative();
    let curvature = slope.derivative();
    let widened = |l: usize| {
        zero.bound * slope.coefficients[l].value.abs()
            + zero.bound * zero.bound * curvature.coefficients[l].value.abs()
    };
    turned
        .coefficients
        .iter()
        .enumerate()
        .map(|(l, c)| Rounded { value: c.value, bound: c.bound + widened(l) })
        .collect()
}

/// Chart around a degenerate direction and ς = 0.
fn chart(terms: &[Term], zero: &Zero) -> Chart {
    let mut points = List::new();
    for term in terms {
        let degree = term.form.degree();
        for (l, value) in along(&term.form, zero).into_iter().enumerate() {
            let value = Value::times_imaginary_power(value, degree as i64);
            if !value.is_zero() {
                points.push(Point { x: term.time, y: l, power: (degree - l) as i64, value });
            }
        }
    }
    Chart { points, unit: 1, below: None, offset_below: Order::new(1, 1) }
}

/// Searches growth in the layers around a direction in which some coefficient vanishes.
pub(crate) fn search_layer(terms: &[Term], zero: &Zero, worst: &mut Worst) {
    explore(&chart(terms, zero), Place { angle: zero.angle, depth: DEPTH }, worst);
}

/// Searches growth around a direction in which neutral roots ς ≈ c k^m collide.
pub(crate) fn search_collision(
    terms: &[Term],
    zero: &Zero,
    order: Order,
    root: &Root,
    worst: &mut Worst,
) {
    let whole = chart(terms, zero);
    let top = (order.numerator, order.denominator);
    let inner = whole.moved_root(top, Order::new(1, 1), root);
    explore(&inner, Place { angle: zero.angle, depth: DEPTH }, worst);
}

impl Chart {
    /// Chart in the shifted root x − c k^m, m = `top`\[0\]/`top`\[1\], for offsets below k^τ.
    fn moved_root(&self, top: (i64, i64), tau: Order, root: &Root) -> Chart {
        let order = Order::new(top.0, top.1);
        let unit = lcm(lcm(self.unit, order.denominator), tau.denominator);
        let slope = order.numerator * (unit / order.denominator);
        let across = tau.numerator * (unit / tau.denominator);
        let weight = |x: usize, y: usize, power: i64| power + slope * x as i64 + across * y as i64;
        let scaled = |p: &Point| p.power * (unit / self.unit);
        let greatest =
            self.points.iter().map(|p| weight(p.x, p.y, scaled(p))).max().unwrap_or_default();
        let powers = powers_of(root.value, root.bound, self.points.iter().map(|p| p.x).max());
        let mut points = List::new();
        for p in &self.points {
            for x in 0..=p.x {
                let power = scaled(p) + slope * (p.x - x) as i64;
                // Around a root of multiplicity n that stays neutral on both sides, branches cross and do not fold: x =
                // O(y), since any other power would move x off the imaginary axis on one side. Leading terms xⁱ yˡ with
                // i + l < n contradict this and are rounding.
                if x + p.y < root.multiplicity && weight(x, p.y, power) == greatest {
                    continue;
                }
                let factor = Value::new(binomial(p.x, x).into(), 0.0);
                points.push(Point { x, y: p.y, power, value: p.value * powers[p.x - x] * factor });
            }
        }
        collect(&mut points);
        Chart { points, unit, below: Some(order), offset_below: tau }
    }

    /// Chart in the shifted offset y − d k^τ.
    fn moved_offset(&self, tau: Order, d: f64, bound: f64) -> Chart {
        let unit = lcm(self.unit, tau.denominator);
        let across = tau.numerator * (unit / tau.denominator);
        let powers = powers_of(d.into(), bound, self.points.iter().map(|p| p.y).max());
        let mut points = List::new();
        for p in &self.points {
            for y in 0..=p.y {
                let power = p.power * (unit / self.unit) + across * (p.y - y) as i64;
                let factor = Value::new(binomial(p.y, y).into(), 0.0);
                points.push(Point { x: p.x, y, power, value: p.value * powers[p.y - y] * factor });
            }
        }
        collect(&mut points);
        Chart { points, unit, below: self.below, offset_below: tau }
    }
}

/// Powers 0 to `greatest` of a number known to within `bound`.
fn powers_of(base: Complex64, bound: f64, greatest: Option<usize>) -> List<Value> {
    let mut powers = list![Value::new(Complex64::ONE, 0.0)];
    for i in 0..greatest.unwrap_or(0) {
        powers.push(powers[i] * Value::new(base, bound));
    }
    powers
}

/// Sums points of equal powers and drops those that may be zero.
fn collect(points: &mut List<Point, 64>) {
    points.sort_by_key(|p| (p.x, p.y, p.power));
    points.dedup_by(|later, first| {
        let same = (later.x, later.y, later.power) == (first.x, first.y, first.power);
        if same {
            first.value += later.value;
        }
        same
    });
    points.retain(|p| !p.value.is_zero());
}

/// A facet: x = O(k^order), y = O(k^offset).
struct Facet {
    order: Order,
    offset: Order,
    points: List<Point>,
}

/// Searches growth in a chart: in the degenerate direction itself, and in every facet of the Newton polytope.
fn explore(chart: &Chart, place: Place, worst: &mut Worst) {
    // The degenerate direction itself, y = 0.
    let line: List<Monomial, 32> = chart
        .points
        .iter()
        .filter(|p| p.y == 0)
        .map(|p| Monomial { x: p.x, power: p.power, value: p.value })
        .collect();
    worst.takes(puiseux::growth(&line, chart.unit, chart.below), place.angle);
    for facet in facets(chart) {
        explore_facet(chart, &facet, place, worst);
    }
}

/// Searches growth in the layer of a facet, then in charts around its special offsets and collisions.
fn explore_facet(chart: &Chart, facet: &Facet, place: Place, worst: &mut Worst) {
    let lowest = facet.points.iter().map(|p| p.x).min().unwrap_or(0);
    let highest = facet.points.iter().map(|p| p.x).max().unwrap_or(0);
    if highest == lowest {
        return;
    }
    let first = facet.points.iter().map(|p| p.y).min().unwrap_or(0);
    let width = facet.points.iter().map(|p| p.y).max().unwrap_or(0) - first;
    let mut face =
        FacePolynomial::new(list![list![Value::default(); width + 1]; highest - lowest + 1]);
    for p in &facet.points {
        face.coefficients[p.x - lowest][p.y - first] += p.value;
    }

    // Offsets at which roots c vanish or become infinite; 0 and ∞ belong to neighbouring facets.
    let inner = |angle: &f64| angle.cr_sin().abs() > 1e-9 && (angle - FRAC_PI_2).abs() > 1e-9;
    let infinite = face.zeros_of_power(face.degree());
    let vanishing = face.zeros_of_power(0);
    let mut special: List<f64> =
        infinite.iter().chain(&vanishing).copied().filter(|a| inner(a)).collect();
    special.extend([0.0, FRAC_PI_2]);
    special.sort_by(f64::total_cmp);
    special.dedup_by(|a, b| (*a - *b).abs() < 1e-9);

    if worst.may_improve(facet.order) {
        let top = &face.coefficients[face.degree()];
        let mut avoided = infinite;
        avoided.retain(|angle| inner(angle));
        avoided.extend(
            [(0.0, 0), (FRAC_PI_2, width)].iter().filter(|e| top[e.1].is_zero()).map(|e| e.0),
        );
        let supremum = match triangle(facet) {
            Some((normal, scale)) => normal.supremum().map(|rate| scale * rate),
            None => face.supremum(&avoided).map(|(rate, _)| rate),
        };
        if let Some(rate) = supremum {
            worst.grows_in_layer(facet.order, rate, place.angle);
        } else if special
            .iter()
            .any(|z| [1e-3, -1e-3, 0.3, -0.3].iter().any(|offset| face.rate(z + offset) > 0.0))
        {
            // Growth that is unbounded in this layer is found in a neighbouring or an inner layer.
            worst.expects(facet.order);
        }
    }
    if place.depth == 0 {
        let hidden = special.iter().any(inner) && worst.is_bounded();
        if hidden {
            worst.doubts(format!("layer within layers, order {}", facet.order.value()), 0.0, 0.0);
        }
        return;
    }
    let deeper = Place { depth: place.depth - 1, ..place };
    for angle in special.iter().copied().filter(inner) {
        let moved = chart.moved_offset(facet.offset, angle.cr_tan(), offset_bound(angle));
        explore(&Chart { below: None, ..moved }, deeper, worst);
    }
    if !worst.may_improve_below(facet.order) {
        return;
    }
    // Continue neutral roots from general offsets, and from the offsets at which they collide.
    let mut sides: List<f64> = special
        .iter()
        .enumerate()
        .map(|(i, left)| 0.5 * (left + special.get(i + 1).copied().unwrap_or(special[0] + PI)))
        .collect();
    sides.extend([0.13, 0.5, 1.1, 1.4].iter().flat_map(|a| [*a, PI - a]));
    for angle in sides {
        let d = angle.cr_tan();
        let terms = at_offset(chart, facet.offset, d);
        let mut growth = puiseux::growth(&terms.0, terms.1, chart.below);
        // Growth of the order of this facet has been computed more accurately above.
        growth.growth = growth.growth.filter(|(order, _)| *order < facet.order);
        if let Some((order, coefficient)) = growth.growth {
            worst.grows_in_layer(order, coefficient, place.angle);
        }
    }
    for &angle in face.collisions().iter().filter(|angle| inner(angle)) {
        for Collision { angle, root, is_sharp } in collisions_at(&face, angle) {
            if !inner(&angle) || !root.is_neutral() || root.bound > DOUBTFUL * root.value.norm() {
                continue;
            }
            if !is_sharp {
                worst.doubts_contact(facet.order, place.angle);
                continue;
            }
            let moved = chart.moved_offset(facet.offset, angle.cr_tan(), offset_bound(angle));
            let order = (facet.order.numerator, facet.order.denominator);
            explore(&moved.moved_root(order, facet.offset, &root), deeper, worst);
        }
    }
}

/// A facet of three points whose coefficients are powers of i: (power of c, power of d, n).
#[derive(Clone, Copy, PartialEq)]
struct Triangle([(usize, usize, u8); 3]);

/// Normalises a facet of three points by scaling c and d; returns the triangle and the scale of c.
fn triangle(facet: &Facet) -> Option<(Triangle, f64)> {
    let [p, q, r] = facet.points[..] else { return None };
    let lowest = |f: fn(&Point) -> usize| facet.points.iter().map(f).min().unwrap_or(0);
    let (x, y) = (lowest(|p| p.x), lowest(|p| p.y));
    let quarter = |p: Point| {
        let n = match p.value.value {
            Complex64 { re, im: 0.0 } if re > 0.0 => 0,
            Complex64 { re: 0.0, im } if im > 0.0 => 1,
            Complex64 { im: 0.0, .. } => 2,
            Complex64 { re: 0.0, .. } => 3,
            _ => return None,
        };
        Some((p.x - x, p.y - y, n))
    };
    let normal = Triangle([quarter(p)?, quarter(q)?, quarter(r)?]);
    // x log c + y log d + log |value| must be equal at all three points.
    let log = |p: Point| p.value.value.norm().cr_ln();
    let row = |s: Point| [s.x as f64 - p.x as f64, s.y as f64 - p.y as f64, log(p) - log(s)];
    let ([a, b, e], [c, d, f]) = (row(q), row(r));
    Some((normal, ((e * d - b * f) / (a * d - b * c)).cr_exp()))
}

impl Triangle {
    /// Supremum of Re c of the face polynomial, cached per thread.
    fn supremum(self) -> Option<f64> {
        thread_local! {
            static KNOWN: RefCell<Vec<(Triangle, Option<f64>)>> = const { RefCell::new(Vec::new()) };
        }
        let known = KNOWN.with_borrow(|k| k.iter().find(|(own, _)| *own == self).map(|k| k.1));
        known.unwrap_or_else(|| {
            let greatest = |f: fn(&(usize, usize, u8)) -> usize| self.0.iter().map(f).max();
            let degree = greatest(|p| p.0).unwrap_or(0);
            let width = greatest(|p| p.1).unwrap_or(0);
            let mut face =
                FacePolynomial::new(list![list![Value::default(); width + 1]; degree + 1]);
            for (x, y, n) in self.0 {
                face.coefficients[x][y] += Value::times_imaginary_power(Rounded::ONE, n.into());
            }
            let top = &face.coefficients[degree];
            let ends = [(0.0, 0), (FRAC_PI_2, width)].into_iter().filter(|e| top[e.1].is_zero());
            let mut avoided = face.zeros_of_power(degree);
            avoided.extend(ends.map(|e| e.0));
            let found = face.supremum(&avoided).map(|(rate, _)| rate);
            KNOWN.with_borrow_mut(|known| known.push((self, found)));
            found
        })
    }
}

/// Error bound of an offset tan `angle`, for an angle accurate to rounding.
fn offset_bound(angle: f64) -> f64 {
    1e-14 * (1.0 + angle.cr_tan().powi(2))
}

/// Terms of a chart at a fixed offset y = d k^τ.
fn at_offset(chart: &Chart, tau: Order, d: f64) -> (List<Monomial, 32>, i64) {
    let unit = lcm(chart.unit, tau.denominator);
    let across = tau.numerator * (unit / tau.denominator);
    let mut terms: List<Monomial, 32> = chart
        .points
        .iter()
        .map(|p| Monomial {
            x: p.x,
            power: p.power * (unit / chart.unit) + across * p.y as i64,
            value: p.value * Value::new(d.powi(p.y as i32).into(), 0.0),
        })
        .collect();
    puiseux::collect(&mut terms);
    (terms, unit)
}

/// An angle at which roots collide.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collision {
    pub(crate) angle: f64,
    pub(crate) root: Root,
    /// Whether the angle is accurate to rounding; false where branches touch.
    pub(crate) is_sharp: bool,
}

/// Collisions of roots next to `angle`: all multiple roots, with refined angles.
///
/// Roots that are neutral on both sides cross; they do not fold. At a crossing of n branches ∂E/∂α and ∂E/∂c vanish
/// together with their first n − 2 derivatives in c. This zero is simple unless two branches touch, so Newton's
/// iteration locates it to full accuracy. On the axes the angle is exact.
pub(crate) fn collisions_at(face: &FacePolynomial, angle: f64) -> List<Collision> {
    let mut found: List<Collision> = List::new();
    let mut include = |angle: f64, near: Option<Complex64>, is_sharp: bool| {
        for root in face.roots(angle).into_iter().filter(|r| r.multiplicity > 1) {
            let is_meant = near.is_none_or(|c| (c - root.value).norm() <= 1e-3 * root.value.norm());
            if !is_meant || !splits_nearby(face, angle, &root) {
                continue;
            }
            let is_same = |c: &&Collision| {
                (c.root.value - root.value).norm() <= 1e-2 * root.value.norm()
                    && (!is_sharp || (c.angle - angle).abs() < 1e-9)
            };
            if !found.iter().any(|c| is_same(&c)) {
                let bound = root.bound.max(1e-14 * root.value.norm());
                found.push(Collision { angle, root: Root { bound, ..root }, is_sharp });
            }
        }
    };
    for axis in [0.0, FRAC_PI_2, PI] {
        if (angle - axis).abs() < 1e-2 {
            include(axis, None, true);
        }
    }
    let roots = face.roots(angle);
    let mut is_settled: List<bool> = list![false; roots.len()];
    for first in &roots {
        // Groups of one root and its neighbours, the largest group first.
        let mut near: List<(f64, usize)> =
            roots.iter().enumerate().map(|(i, r)| ((r.value - first.value).norm(), i)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.retain(|(gap, _)| *gap <= 0.2 * first.value.norm());
        for end in (0..near.len()).rev() {
            let members = &near[..=end];
            let count = members.iter().map(|(_, i)| roots[*i].multiplicity).sum::<usize>();
            // Skip single roots and groups with a root of a crossing already found.
            if count < 2 || members.iter().any(|(_, i)| is_settled[*i]) {
                continue;
            }
            let weighted = |(_, i): &(f64, usize)| roots[*i].value * roots[*i].multiplicity as f64;
            let start = members.iter().map(weighted).sum::<Complex64>() / count as f64;
            if let Some((place, root, is_sharp)) = crossing(face, angle, start, count) {
                include(place, Some(root), is_sharp);
                members.iter().for_each(|(_, i)| is_settled[*i] = true);
                break;
            }
        }
    }
    found
}

/// Number of Newton steps from a zero of the discriminant to rounding accuracy, with two in reserve.
const NEWTON_STEPS: usize = 12;

/// Locates the crossing of `count` branches near `angle` and the root c by Newton's iteration: angle, root, and whether
/// convergence was quadratic (branches cross) and not linear (branches touch).
fn crossing(
    face: &FacePolynomial,
    angle: f64,
    c: Complex64,
    count: usize,
) -> Option<(f64, Complex64, bool)> {
    let (mut place, mut root) = (Complex64::from(angle), c);
    let mut steps = [f64::INFINITY; NEWTON_STEPS];
    let n = count as f64;
    for last in &mut steps {
        // f = ∂c^(n−1) E and g = ∂α ∂c^(n−2) E over factorials, with their derivatives by c and α.
        let [value, by_angle, twice] = face.by_powers(place, root, count);
        let (f, fc, fa) = (value[count - 1], n * value[count], by_angle[count - 1]);
        let (g, gc, ga) = (by_angle[count - 2], (n - 1.0) * by_angle[count - 1], twice[count - 2]);
        let determinant = fc * ga - fa * gc;
        let step = [(fc * g - f * gc) / determinant, (f * ga - fa * g) / determinant];
        if !step[0].is_finite() || !step[1].is_finite() {
            return None;
        }
        place -= step[0];
        root -= step[1];
        *last = step[0].norm() + step[1].norm() / root.norm();
    }
    // Require several small steps: a single one may be accidental.
    let is_sharp = steps[NEWTON_STEPS - 3..].iter().all(|&step| step < 1e-12);
    let last = steps[NEWTON_STEPS - 1];
    let is_close = (place - angle).norm() < 1e-2 && (root - c).norm() < 0.2 * c.norm();
    if last > 1e-3 || !is_close || place.im.abs() > 1e-3 * last + 1e-9 {
        return None;
    }
    // f = g = 0 also where branches only approach each other: E itself must vanish.
    let [value, ..] = face.by_powers(place.re.into(), root, 2);
    let tolerance = if is_sharp { 1e-13 } else { 1e-10 };
    let holds = value[0].norm() <= tolerance * face.size(root.norm());
    holds.then_some((place.re, root, is_sharp))
}

/// Whether a multiple root splits at neighbouring angles.
fn splits_nearby(face: &FacePolynomial, angle: f64, root: &Root) -> bool {
    [1e-3, -1e-3].into_iter().any(|offset| {
        let distance = |r: &Root| (r.value - root.value).norm();
        let beside = face.roots(angle + offset);
        let nearest = beside.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.is_some_and(|nearest| nearest.multiplicity < root.multiplicity)
    })
}

/// Facets of the Newton polytope with normal (m, τ, 1), m > 0 and τ within the limits of the chart.
fn facets(chart: &Chart) -> List<Facet> {
    // Among points with equal x and y the one with the largest power dominates.
    let mut points: List<&Point, 64> = List::new();
    for p in &chart.points {
        match points.iter_mut().find(|own| (own.x, own.y) == (p.x, p.y)) {
            Some(own) if own.power < p.power => *own = p,
            Some(_) => {}
            None => points.push(p),
        }
    }
    let mut found: List<([i64; 3], Facet)> = List::new();
    for (a, p) in points.iter().enumerate() {
        for (b, q) in points.iter().enumerate().skip(a + 1) {
            for r in &points[b + 1..] {
                // Solve m Δx + τ Δy = −Δpower for both differences; all components are multiplied by the determinant.
                let difference = |s: &Point| {
                    [p.x as i64 - s.x as i64, p.y as i64 - s.y as i64, p.power - s.power]
                };
                let ([x1, y1, k1], [x2, y2, k2]) = (difference(q), difference(r));
                let mut normal = [k2 * y1 - k1 * y2, x2 * k1 - x1 * k2, x1 * y2 - x2 * y1];
                if normal[2] == 0 {
                    continue;
                }
                if normal[2] < 0 {
                    normal = normal.map(|n| -n);
                }
                let [m, tau, one] = normal;
                if m <= 0 {
                    continue;
                }
                let order = Order::new(m, one * chart.unit);
                let offset = Order::new(tau, one * chart.unit);
                if offset >= chart.offset_below || chart.below.is_some_and(|b| order >= b) {
                    continue;
                }
                let weight = |s: &Point| m * s.x as i64 + tau * s.y as i64 + one * s.power;
                let height = weight(p);
                if points.iter().any(|s| weight(s) > height) {
                    continue;
                }
                if found.iter().any(|(_, f)| f.order == order && f.offset == offset) {
                    continue;
                }
                let on = points.iter().filter(|s| weight(s) == height).map(|s| **s).collect();
                found.push((normal, Facet { order, offset, points: on }));
            }
        }
    }
    found.into_iter().map(|(_, facet)| facet).collect()
}
