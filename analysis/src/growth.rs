//! Verdict on a frozen state: the asymptotic growth of short waves over all directions, by the Newton polygon of the
//! dispersion polynomial.
//!
//! With P = Σ ςⁱ F_ij(κ₁, κ₂) the roots at wave number k → ∞ in a fixed direction are
//! ς ≈ c k^m, where m runs through the slopes of the Newton polygon of the points (i, j) with
//! F_ij ≠ 0 and c through the roots of the edge polynomials ([`newton_polygon`](crate::newton_polygon)). Signs of
//! the F_ij at the corners of the polygon change only at their zeros, which are found with error bounds
//! ([`BinaryForm::zeros`](crate::form::BinaryForm::zeros)); between them the worst direction is searched. In a layer around each zero ("degenerate
//! direction") other terms dominate (module `layers`).

use crate::corner_factors;
use crate::face_polynomial::FacePolynomial;
use crate::finite_wave_number::{
    SAMPLED_DIRECTIONS, angular_distance, find_pole, find_unbounded_direction,
};
use crate::form::{self, FormZero};
use crate::growth_accumulator::GrowthAccumulator;
use crate::layers::{search_collision, search_layer};
use crate::line_search::argmax_unimodal;
use crate::list::{StackList, list};
use crate::newton_polygon::{GrowthOrder, is_on_edge, newton_polygon_corners};
use crate::pencil::Pencil;
use crate::polynomial::DispersionTerm;
use crate::puiseux::{self, Monomial, UNDECIDED_RELATIVE_BOUND};
use crate::root_collisions::{RootCollision, find_collisions};
use crate::rounded_complex::{RoundedComplex, imaginary_power};
use models::Rounded;
use models::common::elementary::{Elementary, Modulus, cr_arg};
use std::cell::OnceCell;
use std::f64::consts::PI;

/// Asymptotic growth of the fastest growing short waves, Re ς ≈ `coefficient` k^`order`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Order in k.
    pub order: GrowthOrder,
    /// Limit of Re ς / k^order, in m^order/s.
    pub coefficient: f64,
}

/// The verdict on a frozen state.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The growth rate is bounded uniformly over all wave vectors.
    WellPosed,
    /// The growth rate is unbounded.
    IllPosed {
        /// Order and coefficient; `None` if the growth rate is unbounded at finite wave numbers.
        growth: Option<Growth>,
        /// Angle of the wave vector, rad, in [0, π), of the fastest or unbounded growth.
        direction: f64,
    },
    /// Undecided: the deciding quantity is zero within its rounding bound.
    Marginal {
        /// Name of the deciding quantity.
        quantity: String,
        /// Value of the quantity, in scaled units.
        value: f64,
        /// Rounding bound of the value.
        rounding: f64,
    },
    /// Singular pencil: det ≡ 0, or the numbers of equations and unknowns differ.
    Indeterminate {
        /// Generic rank of the pencil.
        rank: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

impl Verdict {
    /// Name of the verdict in output.
    pub fn name(&self) -> &'static str {
        match self {
            Self::WellPosed => "well-posed",
            Self::IllPosed { .. } => "ill-posed",
            Self::Marginal { .. } => "marginal",
            Self::Indeterminate { .. } => "indeterminate",
        }
    }
}

/// A degenerate direction: a leading coefficient vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DegenerateDirection {
    /// Angle of the wave vector, rad, in [0, π).
    pub angle: f64,
    /// Bound on the error of the angle, rad.
    pub bound: f64,
}

/// A verdict with its evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// The verdict.
    pub verdict: Verdict,
    /// The Newton polygon in a general direction: (order, number of roots) of its edges of positive order, largest
    /// order first; roots of orders ≤ 0, which are bounded, are omitted.
    pub orders: StackList<(GrowthOrder, usize)>,
    /// Degenerate directions, ascending.
    pub degenerate_directions: StackList<DegenerateDirection>,
}

/// Edge of the Newton polygon in a general direction: the roots of one order of growth.
struct PolygonEdge<'a> {
    order: GrowthOrder,
    /// Terms on the edge, by descending power of ς.
    terms: StackList<&'a DispersionTerm>,
    face_polynomial: OnceCell<FacePolynomial>,
}

/// Assesses the linearised system in `pencil`.
pub fn assess(pencil: &Pencil) -> Assessment {
    let mut assessment = Assessment {
        verdict: Verdict::WellPosed,
        orders: StackList::new(),
        degenerate_directions: StackList::new(),
    };
    if pencil.is_singular() {
        let unknowns = pencil.scaled.system.unknowns.len();
        assessment.verdict = Verdict::Indeterminate { rank: pencil.generic_rank(), unknowns };
        return assessment;
    }
    let mut certain: StackList<DispersionTerm, 24> = StackList::new();
    let mut doubtful: StackList<&DispersionTerm, 2> = StackList::new();
    for term in pencil.polynomial.forms() {
        if term.form.is_nonzero() {
            certain.push(term.clone());
        } else {
            doubtful.push(term);
        }
    }
    let corners = newton_polygon_corners(certain.iter().map(exponents));
    let mut zeros = find_corner_zeros(pencil, &mut certain, &corners);
    let edges = find_growing_edges(&certain, &corners);
    assessment.orders = edges
        .iter()
        .map(|e| (e.order, e.terms[0].time_power - e.terms[e.terms.len() - 1].time_power))
        .collect();

    // A form that is zero within rounding but would lie above the polygon makes the verdict marginal.
    if let Some(term) = doubtful.iter().find(|term| is_above_polygon(term, &corners)) {
        assessment.verdict = describe_doubtful_term(term);
        return assessment;
    }

    // Zeros of different corners in one direction are one degenerate direction.
    form::merge_zeros(&mut zeros);
    assessment.degenerate_directions =
        zeros.iter().map(|z| DegenerateDirection { angle: z.angle, bound: z.bound }).collect();

    let mut accumulator = GrowthAccumulator::default();
    if !pencil.scaled.system.higher_terms.is_empty()
        && let Some(direction) = find_pole(&certain, &SAMPLED_DIRECTIONS)
    {
        assessment.verdict = Verdict::IllPosed { growth: None, direction };
        return assessment;
    }
    if let Some((direction, is_certain)) = find_unbounded_direction(&certain, &doubtful) {
        if is_certain {
            assessment.verdict = Verdict::IllPosed { growth: None, direction };
            return assessment;
        }
        accumulator.record_undecided(
            format!(
                "coefficient of the highest power of ς for wave vectors at {:.6}°",
                direction.to_degrees()
            ),
            0.0,
            f64::EPSILON,
        );
    }
    for edge in &edges {
        search_directions(edge, &zeros, &mut accumulator);
    }
    if edges.iter().any(|edge| edge.can_be_neutral() && accumulator.can_improve_below(edge.order)) {
        continue_neutral_roots(&certain, &zeros, &mut accumulator);
    }
    for zero in &zeros {
        search_layer(&certain, zero, &mut accumulator);
    }
    for edge in edges.iter().filter(|edge| edge.terms.len() > 2) {
        if accumulator.can_improve_below(edge.order) {
            search_collisions(&certain, edge, &zeros, &mut accumulator);
        }
    }
    assessment.verdict = decide_verdict(accumulator, pencil);
    assessment
}

/// The verdict if the sign of a term decides that is zero within rounding.
pub(crate) fn describe_doubtful_term(term: &DispersionTerm) -> Verdict {
    let coefficients = term.form.coefficients.iter().copied();
    let least_certain = coefficients.max_by(|a, b| a.bound.total_cmp(&b.bound));
    let at = least_certain.unwrap_or_default();
    let (time, space) = (term.time_power, term.form.degree());
    Verdict::Marginal {
        quantity: format!("coefficient of ς^{time} k^{space} in the dispersion polynomial"),
        value: at.value,
        rounding: at.bound,
    }
}

/// Power of ς and degree of the form of a term.
pub(crate) fn exponents(term: &DispersionTerm) -> (i64, i64) {
    (term.time_power as i64, term.form.degree() as i64)
}

/// Distance (rad) between two zeros of a coefficient below which the coefficient is factored.
const CLOSE_ZERO_DISTANCE: f64 = 1e-2;

/// Zeros of all corner coefficients of the Newton polygon, including corners off the growing edges: at their zeros
/// other edges may grow. Coefficients with close zeros are split into factors, whose zeros are well-conditioned.
fn find_corner_zeros(
    pencil: &Pencil,
    terms: &mut [DispersionTerm],
    corners: &[(i64, i64)],
) -> StackList<FormZero> {
    let slope = |a: (i64, i64), b: (i64, i64)| [b.1 - a.1, a.0 - b.0];
    let mut all = StackList::new();
    for (index, &corner) in corners.iter().enumerate() {
        let Some(term) = terms.iter_mut().find(|t| exponents(t) == corner) else { continue };
        let steeper = (index > 0).then(|| slope(corners[index - 1], corner));
        let flatter = corners.get(index + 1).map(|&next| slope(corner, next));
        let is_growing = |s: &Option<[i64; 2]>| s.is_some_and(|s| s[0] > 0);
        if !is_growing(&steeper) && !is_growing(&flatter) {
            all.extend(term.form.zeros());
            continue;
        }
        let zeros = term.form.zeros_unless_touching();
        let is_close = zeros.as_ref().is_none_or(|zeros| {
            sectors_between(zeros).iter().any(|(left, right)| right - left < CLOSE_ZERO_DISTANCE)
        });
        if is_close {
            // A slope m strictly between the slopes of the two edges, at which the corner alone is of leading order.
            let low = flatter.unwrap_or([0, 1]);
            let high = steeper.unwrap_or([low[0] + low[1], low[1]]);
            let between = [6 * low[0] * high[1] + 5 * high[0] * low[1], 11 * low[1] * high[1]];
            let factors = corner_factors::factor_corner_coefficient(&pencil.scaled, between);
            if !factors.is_empty() {
                term.form.set_factors(&factors);
                all.extend(term.form.zeros());
                continue;
            }
        }
        all.extend(zeros.unwrap_or_else(|| term.form.zeros()));
    }
    all
}

/// Finds the edges of the Newton polygon with a positive order of growth, largest order first.
fn find_growing_edges<'a>(
    terms: &'a [DispersionTerm],
    corners: &[(i64, i64)],
) -> StackList<PolygonEdge<'a>, 2> {
    corners
        .windows(2)
        .filter(|pair| pair[1].1 > pair[0].1)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let mut terms: StackList<&DispersionTerm> =
                terms.iter().filter(|t| is_on_edge(exponents(t), (a, b))).collect();
            terms.sort_by_key(|t| std::cmp::Reverse(t.time_power));
            let order = GrowthOrder::new(b.1 - a.1, a.0 - b.0);
            PolygonEdge { order, terms, face_polynomial: OnceCell::new() }
        })
        .collect()
}

/// Whether a term, if nonzero, would lie above the part of the polygon with positive orders.
pub(crate) fn is_above_polygon(term: &DispersionTerm, corners: &[(i64, i64)]) -> bool {
    let (i, j) = (term.time_power as i64, term.form.degree() as i64);
    let Some(&(first, top)) = corners.first() else { return false };
    if i > first {
        // A new highest power of ς: harmless only if the roots that it adds stay bounded.
        return j < corners.iter().map(|c| c.1).max().unwrap_or(top);
    }
    corners.windows(2).any(|pair| {
        let ((i1, j1), (i0, j0)) = (pair[0], pair[1]);
        i0 <= i && i <= i1 && j0 > j1 && (j - j1) * (i1 - i0) > (j0 - j1) * (i1 - i)
    })
}

impl PolygonEdge<'_> {
    /// Whether roots of this edge may be neutral in a whole sector to leading order, but grow at a lower order.
    fn can_be_neutral(&self) -> bool {
        if self.terms.len() > 2 {
            return true;
        }
        // A simple neutral root of order 1 continues with a term of order 0, which is bounded.
        let both = [1.0, -1.0].map(|sign| self.max_cosine(sign));
        self.order.to_f64() > 1.0 && both.contains(&0.0)
    }

    /// Powers of ς and κ of the first and of the last term.
    fn end_exponents(&self) -> [(usize, usize); 2] {
        let end = |t: &DispersionTerm| (t.time_power, t.form.degree());
        [end(self.terms[0]), end(self.terms[self.terms.len() - 1])]
    }

    /// Largest Re c/|c| over the roots of an edge of two terms, c^r = −i^(j₀−j₁) F₀/F₁ with r = i₁ − i₀, for a ratio
    /// F₀/F₁ of sign `sign`. The first term is ς^i₁ F₁ of degree j₁, the last ς^i₀ F₀ of degree j₀.
    fn max_cosine(&self, sign: f64) -> f64 {
        let [(i1, j1), (i0, j0)] = self.end_exponents();
        let r = i1 - i0;
        let turn = cr_arg(-imaginary_power(j0 as i64 - j1 as i64) * sign) / r as f64;
        (0..r)
            .map(|n| {
                let cosine = (turn + 2.0 * PI * n as f64 / r as f64).cr_cos();
                // Cosines of odd multiples of π/2 are exactly zero.
                if cosine.abs() < 1e-12 { 0.0 } else { cosine }
            })
            .fold(-1.0, f64::max)
    }

    /// Face polynomial of the edge, computed at the first use.
    fn face_polynomial(&self) -> &FacePolynomial {
        self.face_polynomial.get_or_init(|| {
            let [(highest, _), (lowest, _)] = self.end_exponents();
            let mut coefficients = list![StackList::new(); highest - lowest + 1];
            for t in &self.terms {
                let turned = |&f: &Rounded| RoundedComplex::from_i_power(f, t.form.degree() as i64);
                coefficients[t.time_power - lowest] =
                    t.form.coefficients.iter().map(turned).collect();
            }
            FacePolynomial::new(coefficients)
        })
    }
}

/// Sectors between neighbouring degenerate directions: (left, right), rad.
fn sectors_between(zeros: &[FormZero]) -> StackList<(f64, f64)> {
    // Without zeros: one sector of length π whose ends are at no special angle, so that no extremum lies there.
    let Some(first) = zeros.first() else { return list![(-0.123_4, PI - 0.123_4)] };
    zeros
        .iter()
        .enumerate()
        .map(|(i, z)| (z.angle, zeros.get(i + 1).map_or(first.angle + PI, |next| next.angle)))
        .collect()
}

/// Relative difference of two ratios of forms that rounding may cause.
const RATIO_ROUNDING: f64 = 1e-12;

/// Searches the direction of largest growth of an edge.
fn search_directions(edge: &PolygonEdge, zeros: &[FormZero], accumulator: &mut GrowthAccumulator) {
    if !accumulator.can_improve(edge.order) {
        return;
    }
    let (&[first, last], angles) = (&edge.terms[..], zeros) else {
        let face = edge.face_polynomial();
        let avoided: StackList<f64> = zeros.iter().map(|z| z.angle).collect();
        match face.supremum(&avoided) {
            Some((rate, direction)) => accumulator.record_growth(edge.order, rate, direction),
            None => {
                let beside = zeros.iter().any(|z| {
                    [1e-3, -1e-3].iter().any(|offset| face.max_growth(z.angle + offset) > 0.0)
                });
                if beside {
                    accumulator.expect_growth_above(edge.order);
                }
            }
        }
        return;
    };
    // c^r = −F₀/F₁ up to a power of i: |c| is extremal where |F₀/F₁| is.
    let mut extrema = None;
    let power = 1.0 / (first.time_power - last.time_power) as f64;
    for (left, right) in sectors_between(angles) {
        let ratio = |angle: f64| {
            let [upper, lower] = [&last.form, &first.form].map(|f| f.evaluate_at_angle(angle));
            // Next to the ends of the sector, or where F₁ is lost to rounding, the ratio is taken as 0.
            let edge = (angle - left).min(right - angle) < 1e-9f64.min(1e-3 * (right - left));
            let lost = edge || lower.bound > 1e-2 * lower.value.abs();
            if lost { 0.0 } else { (upper.value / lower.value).abs().cr_powf(power) }
        };
        let middle = 0.5 * (left + right);
        let signs = [&last.form, &first.form].map(|f| f.evaluate_at_angle(middle));
        let [Some(a), Some(b)] = signs.map(Rounded::sign) else {
            let lost = if signs[0].sign().is_none() { signs[0] } else { signs[1] };
            accumulator.record_undecided(
                format!(
                    "leading coefficient near the wave vector's direction {:.6}°",
                    middle.rem_euclid(PI).to_degrees()
                ),
                lost.value,
                lost.bound,
            );
            continue;
        };
        let cosine = edge.max_cosine(f64::from(a * b));
        if cosine <= 0.0 {
            continue;
        }
        let mut best = (ratio(middle), middle);
        let mut consider = |angle: f64| {
            let value = ratio(angle);
            // A ratio that is constant within rounding keeps the middle.
            if value > best.0 * (1.0 + RATIO_ROUNDING) {
                best = (value, angle);
            }
        };
        let mut is_thin = true;
        let extrema = extrema.get_or_insert_with(|| form::ratio_extrema(&last.form, &first.form));
        for angle in extrema.iter().flat_map(|e| [*e, e + PI]) {
            if left < angle && angle < right {
                is_thin = false;
                consider(angle);
            }
        }
        if is_thin {
            // The sector is too thin to be resolved by the roots of the polynomial.
            consider(form::locate_ratio_maximum(&last.form, &first.form, left, right));
        }
        accumulator.record_growth(edge.order, cosine * best.0, best.1);
    }
}

/// Number of sample directions in each sector between degenerate directions for roots that are neutral to leading
/// order.
const SECTOR_SAMPLES: usize = 12;

/// Minimum width (rad) of a sector of growth; apparent growth in a narrower one may come from roots that nearly
/// collide.
const MIN_SECTOR_WIDTH: f64 = 0.1;

/// Searches lower-order growth of roots that are neutral to leading order in whole sectors, by Puiseux series.
fn continue_neutral_roots(
    terms: &[DispersionTerm],
    zeros: &[FormZero],
    accumulator: &mut GrowthAccumulator,
) {
    let at = |angle: f64| {
        let mut list: StackList<Monomial, 32> = terms
            .iter()
            .map(|t| {
                let degree = t.form.degree() as i64;
                let value = RoundedComplex::from_i_power(t.form.evaluate_at_angle(angle), degree);
                Monomial { x_power: t.time_power, k_power: degree, value }
            })
            .collect();
        puiseux::combine_like_terms(&mut list);
        puiseux::asymptotic_growth(&list, 1, None)
    };
    for (left, right) in sectors_between(zeros) {
        let step = (right - left) / SECTOR_SAMPLES as f64;
        let mut best: Option<(GrowthOrder, f64, f64)> = None;
        for sample in 0..SECTOR_SAMPLES {
            let angle = left + (sample as f64 + 0.5) * step;
            let found = at(angle);
            let Some((order, c)) = found.growth else {
                accumulator.record_root_growth(found, angle);
                continue;
            };
            // Next to a collision distinct roots may appear multiple; growth of a whole sector also appears at
            // neighbouring angles.
            let continues_at_neighbours = [0.4, -0.4].into_iter().any(|offset| {
                let beside = at(angle + offset * step.max(MIN_SECTOR_WIDTH));
                beside.growth.is_some_and(|(beside, _)| beside == order)
            });
            if !continues_at_neighbours {
                accumulator.record_undecided_contact(order, angle);
            } else if best.is_none_or(|(o, b, _)| (order, c) > (o, b)) {
                best = Some((order, c, angle));
            }
        }
        let Some((order, mut value, mut place)) = best else { continue };
        let known = accumulator.growth.is_some_and(|(o, _, _)| o >= order);
        if known {
            continue;
        }
        let rate = |angle: f64| match at(angle).growth {
            Some((o, c)) if o == order => c,
            _ => 0.0,
        };
        let (a, b) = ((place - step).max(left), (place + step).min(right));
        let refined = argmax_unimodal(rate, a, b);
        if rate(refined) > value {
            (value, place) = (rate(refined), refined);
        }
        accumulator.record_growth(order, value, place);
    }
}

/// Searches growth around the directions in which neutral roots of an edge collide.
fn search_collisions(
    terms: &[DispersionTerm],
    edge: &PolygonEdge,
    zeros: &[FormZero],
    accumulator: &mut GrowthAccumulator,
) {
    let face = edge.face_polynomial();
    for &angle in face.collision_angles() {
        for collision in find_collisions(face, angle) {
            let RootCollision { angle, angle_bound, root, is_accurate } = collision;
            // Degenerate directions are searched by `search_layer`.
            if !root.is_neutral() || zeros.iter().any(|z| angular_distance(z.angle, angle) < 1e-9) {
                continue;
            }
            let is_resolved = root.bound <= UNDECIDED_RELATIVE_BOUND * root.value.modulus();
            if !is_accurate || !is_resolved {
                accumulator.record_undecided_contact(edge.order, angle);
                continue;
            }
            // The angle is not reduced to [0, π): the roots c at α + π differ from those at α.
            let zero = FormZero { angle, bound: angle_bound, has_sign_change: true };
            search_collision(terms, &zero, edge.order, &root, accumulator);
        }
    }
}

/// Decides the verdict from the largest growth and the undecided quantities of the search.
pub(crate) fn decide_verdict(mut accumulator: GrowthAccumulator, pencil: &Pencil) -> Verdict {
    if let Some(order) = accumulator.missing_order() {
        accumulator.growth = None;
        accumulator.record_undecided(
            format!("growth of an order above {}", order.to_f64()),
            0.0,
            f64::EPSILON,
        );
    }
    let (rate, wave_number) = (pencil.polynomial.rate_unit, pencil.polynomial.wave_number_unit);
    match (accumulator.growth, accumulator.undecided_quantity) {
        (Some((order, scaled, direction)), _) => Verdict::IllPosed {
            growth: Some(Growth {
                order,
                coefficient: scaled * rate / wave_number.cr_powf(order.to_f64()),
            }),
            direction: direction.rem_euclid(PI),
        },
        (None, Some((quantity, value, rounding))) => {
            Verdict::Marginal { quantity, value, rounding }
        }
        (None, None) => Verdict::WellPosed,
    }
}
