//! Growth in thin layers of directions around degenerate directions, by the Newton polytope of the dispersion
//! polynomial in root, direction and wave number.
//!
//! A chart is the dispersion polynomial Σ value xⁱ yˡ k^j in local coordinates: x = ς − ς₀, and y is the offset of the
//! wave vector from a direction. For x = c k^m and y = d k^τ, the leading terms belong to a facet of the Newton
//! polytope of the points (i, l, j) and form a polynomial in c and d. Each root c(d) is growing, decaying or neutral;
//! neutral roots are continued by Puiseux series. Where roots vanish, become infinite or collide, a further chart is
//! opened.

use crate::face_polynomial::{CoefficientZero, FacePolynomial};
use crate::form::{BinaryForm, FormZero};
use crate::growth_accumulator::GrowthAccumulator;
use crate::list::{StackList, list};
use crate::newton_polygon::GrowthOrder;
use crate::polynomial::DispersionTerm;
use crate::puiseux::{self, BoundedRoot, Monomial, UNDECIDED_RELATIVE_BOUND, binomial, lcm};
use crate::root_collisions::{RootCollision, find_collisions};
use crate::rounded_complex::RoundedComplex;
use models::Rounded;
use models::common::elementary::{Elementary, Modulus};
use num_complex::Complex64;
use std::cell::RefCell;
use std::f64::consts::{FRAC_PI_2, PI};

/// Maximum depth of nested charts.
const MAX_CHART_DEPTH: usize = 4;

/// A monomial `value` xⁱ yˡ k^j of a chart.
#[derive(Clone, Copy, Debug)]
struct ChartTerm {
    x_power: usize,
    y_power: usize,
    /// Power of k, in units of 1/`Chart::power_denominator`.
    k_power: i64,
    value: RoundedComplex,
}

/// Degenerate direction of a chart, and remaining depth of nested charts.
#[derive(Clone, Copy)]
pub(crate) struct ChartLocation {
    /// The degenerate direction, rad.
    pub(crate) angle: f64,
    /// Remaining depth of nested charts.
    remaining_depth: usize,
}

/// Dispersion polynomial in coordinates (x, y) relative to a root and a direction, and in the wave number k; see the
/// module comment.
struct Chart {
    terms: StackList<ChartTerm, 64>,
    /// Common denominator of the powers of k.
    power_denominator: i64,
    /// Exclusive upper bound on the order m of x; `None` if m is not bounded.
    order_bound: Option<GrowthOrder>,
    /// Exclusive upper bound on the order τ of y.
    offset_order_bound: GrowthOrder,
}

/// Coefficients of κ^(d−l) κ⊥^l in axes along a degenerate direction with this cosine and sine, with bounds widened by
/// the uncertainty `angle_bound` (rad) of the direction.
pub(crate) fn expand_along_direction(
    form: &BinaryForm,
    [cos, sin]: [Rounded; 2],
    angle_bound: f64,
) -> StackList<Rounded> {
    let mut turned = form.to_rotated_axes(cos, sin).coefficients;
    // Coefficients of the derivative by the angle, as in `BinaryForm::derivative`.
    let derivative = |values: &[f64]| -> StackList<f64> {
        let at = |l: usize| values.get(l).copied().unwrap_or_default();
        let from_below = |l: usize| (values.len() - l) as f64 * at(l.wrapping_sub(1));
        (0..values.len()).map(|l| (l + 1) as f64 * at(l + 1) - from_below(l)).collect()
    };
    let values: StackList<f64> = turned.iter().map(|c| c.value).collect();
    let slope = derivative(&values);
    let curvature = derivative(&slope);
    for (c, (slope, curvature)) in turned.iter_mut().zip(slope.iter().zip(&curvature)) {
        c.bound += angle_bound * slope.abs() + angle_bound * angle_bound * curvature.abs();
    }
    turned
}

/// Chart around a degenerate direction and ς = 0.
fn build_chart(terms: &[DispersionTerm], zero: &FormZero) -> Chart {
    let mut chart_terms = StackList::new();
    let axis = zero.axis();
    for term in terms {
        let degree = term.form.degree();
        let turned = expand_along_direction(&term.form, axis, zero.bound);
        for (l, value) in turned.into_iter().enumerate() {
            let value = RoundedComplex::from_i_power(value, degree as i64);
            if !value.is_zero() {
                chart_terms.push(ChartTerm {
                    x_power: term.time_power,
                    y_power: l,
                    k_power: (degree - l) as i64,
                    value,
                });
            }
        }
    }
    Chart {
        terms: chart_terms,
        power_denominator: 1,
        order_bound: None,
        offset_order_bound: GrowthOrder::new(1, 1),
    }
}

/// Searches growth in the layers around a degenerate direction, in which a coefficient of the polynomial vanishes.
pub(crate) fn search_layer(
    terms: &[DispersionTerm],
    zero: &FormZero,
    accumulator: &mut GrowthAccumulator,
) {
    search_chart(
        &build_chart(terms, zero),
        ChartLocation { angle: zero.angle, remaining_depth: MAX_CHART_DEPTH },
        accumulator,
    );
}

/// Searches growth around a direction in which neutral roots ς ≈ c k^m collide.
pub(crate) fn search_collision(
    terms: &[DispersionTerm],
    zero: &FormZero,
    order: GrowthOrder,
    root: &BoundedRoot,
    accumulator: &mut GrowthAccumulator,
) {
    let whole = build_chart(terms, zero);
    let top = (order.numerator, order.denominator);
    let inner = whole.shift_root(top, GrowthOrder::new(1, 1), root);
    search_chart(
        &inner,
        ChartLocation { angle: zero.angle, remaining_depth: MAX_CHART_DEPTH },
        accumulator,
    );
}

impl Chart {
    /// Chart in the shifted root x − c k^m, m = `top`\[0\]/`top`\[1\], valid for offsets y of an order below τ in k.
    fn shift_root(&self, top: (i64, i64), tau: GrowthOrder, root: &BoundedRoot) -> Chart {
        let order = GrowthOrder::new(top.0, top.1);
        let unit = lcm(lcm(self.power_denominator, order.denominator), tau.denominator);
        let slope = order.numerator * (unit / order.denominator);
        let across = tau.numerator * (unit / tau.denominator);
        let weight = |x: usize, y: usize, power: i64| power + slope * x as i64 + across * y as i64;
        let scaled = |p: &ChartTerm| p.k_power * (unit / self.power_denominator);
        let greatest = self
            .terms
            .iter()
            .map(|p| weight(p.x_power, p.y_power, scaled(p)))
            .max()
            .unwrap_or_default();
        let powers =
            compute_powers(root.value, root.bound, self.terms.iter().map(|p| p.x_power).max());
        let mut terms = StackList::new();
        for p in &self.terms {
            for x in 0..=p.x_power {
                let power = scaled(p) + slope * (p.x_power - x) as i64;
                // Around a root of multiplicity n that stays neutral on both sides, branches cross and do not fold: x =
                // O(y), since any other power would move x off the imaginary axis on one side. Leading terms xⁱ yˡ with
                // i + l < n contradict this and are rounding.
                if x + p.y_power < root.multiplicity && weight(x, p.y_power, power) == greatest {
                    continue;
                }
                let factor = RoundedComplex::new(binomial(p.x_power, x).into(), 0.0);
                terms.push(ChartTerm {
                    x_power: x,
                    y_power: p.y_power,
                    k_power: power,
                    value: p.value * powers[p.x_power - x] * factor,
                });
            }
        }
        combine_like_terms(&mut terms);
        Chart { terms, power_denominator: unit, order_bound: Some(order), offset_order_bound: tau }
    }

    /// Chart in the shifted offset y − d k^τ.
    fn shift_offset(&self, tau: GrowthOrder, d: f64, bound: f64) -> Chart {
        let unit = lcm(self.power_denominator, tau.denominator);
        let across = tau.numerator * (unit / tau.denominator);
        let powers = compute_powers(d.into(), bound, self.terms.iter().map(|p| p.y_power).max());
        let mut terms = StackList::new();
        for p in &self.terms {
            for y in 0..=p.y_power {
                let power =
                    p.k_power * (unit / self.power_denominator) + across * (p.y_power - y) as i64;
                let factor = RoundedComplex::new(binomial(p.y_power, y).into(), 0.0);
                terms.push(ChartTerm {
                    x_power: p.x_power,
                    y_power: y,
                    k_power: power,
                    value: p.value * powers[p.y_power - y] * factor,
                });
            }
        }
        combine_like_terms(&mut terms);
        Chart {
            terms,
            power_denominator: unit,
            order_bound: self.order_bound,
            offset_order_bound: tau,
        }
    }
}

/// Powers 0 to `max_exponent` of a number known to within `bound`.
fn compute_powers(
    base: Complex64,
    bound: f64,
    max_exponent: Option<usize>,
) -> StackList<RoundedComplex> {
    let mut powers = list![RoundedComplex::new(Complex64::ONE, 0.0)];
    for i in 0..max_exponent.unwrap_or(0) {
        powers.push(powers[i] * RoundedComplex::new(base, bound));
    }
    powers
}

/// Sums terms of equal powers and drops those that may be zero.
fn combine_like_terms(terms: &mut StackList<ChartTerm, 64>) {
    terms.sort_by_key(|p| (p.x_power, p.y_power, p.k_power));
    terms.dedup_by(|later, first| {
        let same = (later.x_power, later.y_power, later.k_power)
            == (first.x_power, first.y_power, first.k_power);
        if same {
            first.value += later.value;
        }
        same
    });
    terms.retain(|p| !p.value.is_zero());
}

/// Terms on a facet of the Newton polytope, which dominate where x = O(k^`order`) and y = O(k^`offset_order`).
struct Facet {
    order: GrowthOrder,
    offset_order: GrowthOrder,
    terms: StackList<ChartTerm>,
}

/// Searches growth in a chart: in the degenerate direction itself, and in every facet of the Newton polytope.
fn search_chart(chart: &Chart, location: ChartLocation, accumulator: &mut GrowthAccumulator) {
    // The degenerate direction itself, y = 0.
    let line: StackList<Monomial, 32> = chart
        .terms
        .iter()
        .filter(|p| p.y_power == 0)
        .map(|p| Monomial { x_power: p.x_power, k_power: p.k_power, value: p.value })
        .collect();
    accumulator.record_root_growth(
        puiseux::asymptotic_growth(&line, chart.power_denominator, chart.order_bound),
        location.angle,
    );
    for facet in find_facets(chart) {
        search_facet(chart, &facet, location, accumulator);
    }
}

/// Whether the offset tan `angle` is neither zero nor infinite: `angle` is more than 1e-9 rad from 0, π/2 and π.
fn is_off_axes(angle: &f64) -> bool {
    angle.cr_sin().abs() > 1e-9 && (angle - FRAC_PI_2).abs() > 1e-9
}

/// Searches growth in the layer of a facet, then in charts around its special offsets and collisions.
fn search_facet(
    chart: &Chart,
    facet: &Facet,
    location: ChartLocation,
    accumulator: &mut GrowthAccumulator,
) {
    let lowest = facet.terms.iter().map(|p| p.x_power).min().unwrap_or(0);
    let highest = facet.terms.iter().map(|p| p.x_power).max().unwrap_or(0);
    if highest == lowest {
        return;
    }
    let first = facet.terms.iter().map(|p| p.y_power).min().unwrap_or(0);
    let width = facet.terms.iter().map(|p| p.y_power).max().unwrap_or(0) - first;
    let mut face = FacePolynomial::new(
        list![list![RoundedComplex::default(); width + 1]; highest - lowest + 1],
    );
    for p in &facet.terms {
        face.coefficients[p.x_power - lowest][p.y_power - first] += p.value;
    }

    // Offsets at which roots c vanish or become infinite; 0 and ∞ belong to neighbouring facets.
    let infinite = face.zeros_of_coefficient(face.degree());
    let vanishing = face.zeros_of_coefficient(0);
    let mut special: StackList<CoefficientZero> =
        infinite.iter().chain(&vanishing).copied().filter(|own| is_off_axes(&own.angle)).collect();
    special.extend([0.0, FRAC_PI_2].map(|angle| CoefficientZero { angle, bound: 0.0 }));
    special.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    special.dedup_by(|later, first| {
        let reach = later.bound + first.bound;
        let is_same = (later.angle - first.angle).abs() < reach.max(1e-9);
        if is_same {
            first.bound = first.bound.max(later.bound);
        }
        is_same
    });

    if accumulator.can_improve(facet.order) {
        let top = &face.coefficients[face.degree()];
        let mut avoided: StackList<f64> =
            infinite.iter().map(|own| own.angle).filter(is_off_axes).collect();
        avoided.extend(
            [(0.0, 0), (FRAC_PI_2, width)].iter().filter(|e| top[e.1].is_zero()).map(|e| e.0),
        );
        let supremum = match normalise_triangle(facet) {
            Some((normal, scale)) => normal.supremum().map(|rate| scale * rate),
            None => face.supremum(&avoided).map(|(rate, _)| rate),
        };
        if let Some(rate) = supremum {
            accumulator.record_layer_growth(facet.order, rate, location.angle);
        } else if special.iter().any(|z| {
            [1e-3, -1e-3, 0.3, -0.3].iter().any(|offset| face.max_growth(z.angle + offset) > 0.0)
        }) {
            // Growth that is unbounded in this layer is found in a neighbouring or an inner layer.
            accumulator.expect_growth_above(facet.order);
        }
    }
    if location.remaining_depth == 0 {
        let hidden = special.iter().any(|own| is_off_axes(&own.angle)) && accumulator.is_bounded();
        if hidden {
            accumulator.record_undecided(
                format!("layer within layers, order {}", facet.order.to_f64()),
                0.0,
                0.0,
            );
        }
        return;
    }
    let deeper = ChartLocation { remaining_depth: location.remaining_depth - 1, ..location };
    for &CoefficientZero { angle, bound } in special.iter().filter(|own| is_off_axes(&own.angle)) {
        let bound = offset_error_bound(angle, bound.max(LEAST_ANGLE_BOUND));
        let moved = chart.shift_offset(facet.offset_order, angle.cr_tan(), bound);
        search_chart(&Chart { order_bound: None, ..moved }, deeper, accumulator);
    }
    if !accumulator.can_improve_below(facet.order) {
        return;
    }
    continue_facet_roots(chart, facet, &face, &special, deeper, accumulator);
}

/// Continues neutral roots of a facet by Puiseux series from general offsets, and by charts around the offsets at which
/// they collide; `special` are the offsets at which roots vanish or become infinite.
fn continue_facet_roots(
    chart: &Chart,
    facet: &Facet,
    face: &FacePolynomial,
    special: &[CoefficientZero],
    deeper: ChartLocation,
    accumulator: &mut GrowthAccumulator,
) {
    // Offsets between the special ones, and a few fixed ones.
    let mut sides: StackList<f64> = special
        .iter()
        .enumerate()
        .map(|(i, left)| {
            let right = special.get(i + 1).map_or(special[0].angle + PI, |next| next.angle);
            0.5 * (left.angle + right)
        })
        .collect();
    sides.extend([0.13, 0.5, 1.1, 1.4].iter().flat_map(|a| [*a, PI - a]));
    for angle in sides {
        let d = angle.cr_tan();
        let terms = terms_at_offset(chart, facet.offset_order, d);
        let mut growth = puiseux::asymptotic_growth(&terms.0, terms.1, chart.order_bound);
        // Growth of the order of this facet has been computed more accurately in `search_facet`.
        growth.growth = growth.growth.filter(|(order, _)| *order < facet.order);
        if let Some((order, coefficient)) = growth.growth {
            accumulator.record_layer_growth(order, coefficient, deeper.angle);
        }
    }
    for &angle in face.collision_angles().iter().filter(|angle| is_off_axes(angle)) {
        for collision in find_collisions(face, angle) {
            let RootCollision { angle, angle_bound, root, is_accurate } = collision;
            if !is_off_axes(&angle) || !root.is_neutral() {
                continue;
            }
            let is_resolved = root.bound <= UNDECIDED_RELATIVE_BOUND * root.value.modulus();
            if !is_accurate || !is_resolved {
                accumulator.record_undecided_contact(facet.order, deeper.angle);
                continue;
            }
            let bound = offset_error_bound(angle, angle_bound.max(LEAST_ANGLE_BOUND));
            let moved = chart.shift_offset(facet.offset_order, angle.cr_tan(), bound);
            let order = (facet.order.numerator, facet.order.denominator);
            search_chart(&moved.shift_root(order, facet.offset_order, &root), deeper, accumulator);
        }
    }
}

/// A facet of three terms iⁿ c^p d^q, each given as (p, q, n).
#[derive(Clone, Copy, PartialEq)]
struct TriangularFacet([(usize, usize, u8); 3]);

/// Scales c and d so that the coefficients of a facet of three terms become powers of i; returns the scaled facet and
/// the scale of c. `None` unless the facet has three terms, each with a real or an imaginary coefficient.
fn normalise_triangle(facet: &Facet) -> Option<(TriangularFacet, f64)> {
    let [p, q, r] = facet.terms[..] else { return None };
    let lowest = |f: fn(&ChartTerm) -> usize| facet.terms.iter().map(f).min().unwrap_or(0);
    let (x, y) = (lowest(|p| p.x_power), lowest(|p| p.y_power));
    let quarter = |p: ChartTerm| {
        let n = match p.value.value {
            Complex64 { re, im: 0.0 } if re > 0.0 => 0,
            Complex64 { re: 0.0, im } if im > 0.0 => 1,
            Complex64 { im: 0.0, .. } => 2,
            Complex64 { re: 0.0, .. } => 3,
            _ => return None,
        };
        Some((p.x_power - x, p.y_power - y, n))
    };
    let normal = TriangularFacet([quarter(p)?, quarter(q)?, quarter(r)?]);
    // x log c + y log d + log |value| must be equal at all three terms.
    let log = |p: ChartTerm| p.value.value.modulus().cr_ln();
    let row = |s: ChartTerm| {
        [s.x_power as f64 - p.x_power as f64, s.y_power as f64 - p.y_power as f64, log(p) - log(s)]
    };
    let ([a, b, e], [c, d, f]) = (row(q), row(r));
    Some((normal, ((e * d - b * f) / (a * d - b * c)).cr_exp()))
}

impl TriangularFacet {
    /// Supremum of Re c of the face polynomial, cached per thread; `None` if it is not positive or not bounded.
    fn supremum(self) -> Option<f64> {
        thread_local! {
            static SUPREMA: RefCell<Vec<(TriangularFacet, Option<f64>)>> = const { RefCell::new(Vec::new()) };
        }
        let known = SUPREMA.with_borrow(|k| k.iter().find(|(own, _)| *own == self).map(|k| k.1));
        known.unwrap_or_else(|| {
            let greatest = |f: fn(&(usize, usize, u8)) -> usize| self.0.iter().map(f).max();
            let degree = greatest(|p| p.0).unwrap_or(0);
            let width = greatest(|p| p.1).unwrap_or(0);
            let mut face =
                FacePolynomial::new(list![list![RoundedComplex::default(); width + 1]; degree + 1]);
            for (x, y, n) in self.0 {
                face.coefficients[x][y] += RoundedComplex::from_i_power(Rounded::ONE, n.into());
            }
            let top = &face.coefficients[degree];
            let ends = [(0.0, 0), (FRAC_PI_2, width)].into_iter().filter(|e| top[e.1].is_zero());
            let mut avoided: StackList<f64> =
                face.zeros_of_coefficient(degree).iter().map(|own| own.angle).collect();
            avoided.extend(ends.map(|e| e.0));
            let found = face.supremum(&avoided).map(|(rate, _)| rate);
            SUPREMA.with_borrow_mut(|known| known.push((self, found)));
            found
        })
    }
}

/// Least error bound of the angle of an offset, rad.
const LEAST_ANGLE_BOUND: f64 = 1e-14;

/// Error bound of an offset tan `angle`, for an angle accurate to `angle_bound` (rad).
fn offset_error_bound(angle: f64, angle_bound: f64) -> f64 {
    angle_bound * (1.0 + angle.cr_tan().powi(2))
}

/// Terms of a chart at the offset y = d k^τ, and the common denominator of their powers of k.
fn terms_at_offset(chart: &Chart, tau: GrowthOrder, d: f64) -> (StackList<Monomial, 32>, i64) {
    let unit = lcm(chart.power_denominator, tau.denominator);
    let across = tau.numerator * (unit / tau.denominator);
    let mut terms: StackList<Monomial, 32> = chart
        .terms
        .iter()
        .map(|p| Monomial {
            x_power: p.x_power,
            k_power: p.k_power * (unit / chart.power_denominator) + across * p.y_power as i64,
            value: p.value * RoundedComplex::new(d.powi(p.y_power as i32).into(), 0.0),
        })
        .collect();
    puiseux::combine_like_terms(&mut terms);
    (terms, unit)
}

/// Finds the facets of the Newton polytope with normal (m, τ, 1), m > 0, where m and τ are below the order bounds of
/// the chart.
fn find_facets(chart: &Chart) -> StackList<Facet> {
    // Among terms with equal powers of x and of y the one with the largest power of k dominates.
    let mut terms: StackList<&ChartTerm, 64> = StackList::new();
    for p in &chart.terms {
        match terms.iter_mut().find(|own| (own.x_power, own.y_power) == (p.x_power, p.y_power)) {
            Some(own) if own.k_power < p.k_power => *own = p,
            Some(_) => {}
            None => terms.push(p),
        }
    }
    let mut found: StackList<Facet> = StackList::new();
    for (a, p) in terms.iter().enumerate() {
        for (b, q) in terms.iter().enumerate().skip(a + 1) {
            for r in &terms[b + 1..] {
                // Solve m Δi + τ Δl = −Δj for the differences of both pairs of points (i, l, j); (m, τ, 1) is
                // multiplied by the determinant.
                let difference = |s: &ChartTerm| {
                    [
                        p.x_power as i64 - s.x_power as i64,
                        p.y_power as i64 - s.y_power as i64,
                        p.k_power - s.k_power,
                    ]
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
                let order = GrowthOrder::new(m, one * chart.power_denominator);
                let offset = GrowthOrder::new(tau, one * chart.power_denominator);
                if offset >= chart.offset_order_bound
                    || chart.order_bound.is_some_and(|b| order >= b)
                {
                    continue;
                }
                let weight =
                    |s: &ChartTerm| m * s.x_power as i64 + tau * s.y_power as i64 + one * s.k_power;
                let height = weight(p);
                if terms.iter().any(|s| weight(s) > height) {
                    continue;
                }
                if found.iter().any(|f| f.order == order && f.offset_order == offset) {
                    continue;
                }
                let on = terms.iter().filter(|s| weight(s) == height).map(|s| **s).collect();
                found.push(Facet { order, offset_order: offset, terms: on });
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bounds of turned coefficients against the derivatives of the turned form.
    #[test]
    fn uncertain_directions_widen_the_bounds_by_the_derivatives() {
        let mut form = BinaryForm::new_zero(4);
        for (own, value) in form.coefficients.iter_mut().zip([0.7, -1.3, 2.9, 0.11, 1.0]) {
            *own = Rounded::from_exact(value);
        }
        let zero = FormZero { angle: 0.6, bound: 1e-3, has_sign_change: true };
        let [cos, sin] = zero.axis();
        let turned = form.to_rotated_axes(cos, sin);
        let slope = turned.derivative();
        let curvature = slope.derivative();
        let found = expand_along_direction(&form, [cos, sin], zero.bound);
        for (l, own) in found.iter().enumerate() {
            assert_eq!(own.value, turned.coefficients[l].value);
            let wanted = 1e-3 * slope.coefficients[l].value.abs()
                + 1e-6 * curvature.coefficients[l].value.abs();
            assert!((own.bound - wanted).abs() < 1e-12, "{l}: {own:?}, not {wanted}");
        }
    }
}
