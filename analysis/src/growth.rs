//! Verdict on a frozen state: the asymptotic growth of short waves over all directions, by the Newton polygon of the
//! dispersion polynomial.
//!
//! With P = Σ ςⁱ F_ij(κ₁, κ₂) the roots at wave number k → ∞ in a fixed direction are
//! ς ≈ c k^m, where m runs through the slopes of the Newton polygon of the points (i, j) with
//! F_ij ≠ 0 and c through the roots of the edge polynomials ([`newton`](crate::newton)). Signs of
//! the F_ij at the corners of the polygon change only at their zeros, which are found exactly
//! ([`Form::zeros`]); between them the worst direction is searched. In a layer around each zero ("degenerate
//! direction") other terms dominate (module `layers`).

use crate::face::FacePolynomial;
use crate::form::{self, Form, Zero};
use crate::layers::{Collision, along, collisions_at, search_collision, search_layer};
use crate::leading;
use crate::list::{List, list};
use crate::newton::{Order, corners_of, is_on};
use crate::pencil::Pencil;
use crate::polynomial::Term;
use crate::puiseux::{self, Monomial};
use crate::search::argmax_unimodal;
use crate::value::{Value, imaginary_power};
use crate::worst::Worst;
use models::Rounded;
use models::common::elementary::{Elementary, cr_arg};
use std::cell::OnceCell;
use std::f64::consts::PI;

/// Asymptotic growth of the fastest growing short waves, Re ς ≈ `coefficient` k^`order`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Order in k.
    pub order: Order,
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
        /// Angle of the wave vector, rad, in [0, π), at which it is approached.
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
    /// Singular pencil: det ≡ 0, or fewer equations than unknowns.
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
    /// The Newton polygon in a general direction: (order, number of roots) of the growing or decaying roots, largest
    /// order first; orders ≤ 0, which are bounded, are omitted.
    pub orders: List<(Order, usize)>,
    /// Degenerate directions, ascending.
    pub degenerate: List<DegenerateDirection>,
}

/// An edge of the Newton polygon in a general direction.
struct Edge<'a> {
    order: Order,
    /// Terms on the edge, by descending power of ς.
    terms: List<&'a Term>,
    face: OnceCell<FacePolynomial>,
}

/// Assesses the linearised system in `pencil`.
pub fn assess(pencil: &Pencil) -> Assessment {
    let mut assessment =
        Assessment { verdict: Verdict::WellPosed, orders: List::new(), degenerate: List::new() };
    if pencil.is_singular() {
        let unknowns = pencil.scaled.system.unknowns.len();
        assessment.verdict = Verdict::Indeterminate { rank: pencil.generic_rank(), unknowns };
        return assessment;
    }
    let terms = pencil.polynomial.forms();
    let (mut certain, doubtful): (List<Term, 24>, List<Term, 24>) =
        terms.into_iter().partition(|term| term.form.is_certain());
    let corners = corners_of(certain.iter().map(powers));
    let mut zeros = zeros_of_corners(pencil, &mut certain, &corners);
    let edges = edges(&certain, &corners);
    assessment.orders = edges
        .iter()
        .map(|e| (e.order, e.terms[0].time - e.terms[e.terms.len() - 1].time))
        .collect();

    // A form that is zero within rounding but would lie above the polygon makes the verdict marginal.
    if let Some(term) = doubtful.iter().find(|term| lies_above_polygon(term, &corners)) {
        let worst =
            |f: &Form| f.coefficients.iter().copied().max_by(|a, b| a.bound.total_cmp(&b.bound));
        let at = worst(&term.form).unwrap_or_default();
        assessment.verdict = Verdict::Marginal {
            quantity: format!(
                "coefficient of ς^{} k^{} in the dispersion polynomial",
                term.time,
                term.form.degree()
            ),
            value: at.value,
            rounding: at.bound,
        };
        return assessment;
    }

    // Zeros of different corners in one direction are one degenerate direction.
    form::merge(&mut zeros);
    assessment.degenerate =
        zeros.iter().map(|z| DegenerateDirection { angle: z.angle, bound: z.bound }).collect();

    let mut worst = Worst::default();
    if let Some((direction, is_certain)) = unbounded_at_finite_k(&certain, &doubtful) {
        if is_certain {
            assessment.verdict = Verdict::IllPosed { growth: None, direction };
            return assessment;
        }
        worst.doubts(
            format!(
                "coefficient of the highest power of ς for wave vectors at {:.6}°",
                direction.to_degrees()
            ),
            0.0,
            f64::EPSILON,
        );
    }
    for edge in &edges {
        search_directions(edge, &zeros, &mut worst);
    }
    if edges.iter().any(|edge| edge.may_be_neutral() && worst.may_improve_below(edge.order)) {
        follow_neutral_roots(&certain, &zeros, &mut worst);
    }
    for zero in &zeros {
        search_layer(&certain, zero, &mut worst);
    }
    for edge in edges.iter().filter(|edge| edge.terms.len() > 2) {
        if worst.may_improve_below(edge.order) {
            search_collisions(&certain, edge, &zeros, &mut worst);
        }
    }
    assessment.verdict = verdict(worst, pencil);
    assessment
}

/// Power of ς and degree of the form of a term.
fn powers(term: &Term) -> (i64, i64) {
    (term.time as i64, term.form.degree() as i64)
}

/// Distance (rad) below which zeros are computed factor by factor.
const CLOSE: f64 = 1e-2;

/// Zeros of all corner coefficients of the Newton polygon, including corners off the growing edges: at their zeros
/// other edges may grow. Coefficients with close zeros are split into factors, whose zeros are well-conditioned.
fn zeros_of_corners(pencil: &Pencil, terms: &mut [Term], corners: &[(i64, i64)]) -> List<Zero> {
    let slope = |a: (i64, i64), b: (i64, i64)| [b.1 - a.1, a.0 - b.0];
    let mut all = List::new();
    for (index, &corner) in corners.iter().enumerate() {
        let Some(term) = terms.iter_mut().find(|t| powers(t) == corner) else { continue };
        let zeros = term.form.zeros();
        let steeper = (index > 0).then(|| slope(corners[index - 1], corner));
        let flatter = corners.get(index + 1).map(|&next| slope(corner, next));
        let is_growing = |s: &Option<[i64; 2]>| s.is_some_and(|s| s[0] > 0);
        let is_close = zeros.iter().any(|z| !z.crosses)
            || sectors(&zeros).iter().any(|(left, right)| right - left < CLOSE);
        if is_close && (is_growing(&steeper) || is_growing(&flatter)) {
            // A slope m strictly between the slopes of the two edges, at which the corner alone is of leading order.
            let low = flatter.unwrap_or([0, 1]);
            let high = steeper.unwrap_or([low[0] + low[1], low[1]]);
            let between = [6 * low[0] * high[1] + 5 * high[0] * low[1], 11 * low[1] * high[1]];
            let factors = leading::factors(&pencil.scaled, between);
            if !factors.is_empty() {
                term.form.factorise(&factors);
                all.extend(term.form.zeros());
                continue;
            }
        }
        all.extend(zeros);
    }
    all
}

/// Edges of positive slope, steepest first.
fn edges<'a>(terms: &'a [Term], corners: &[(i64, i64)]) -> List<Edge<'a>> {
    corners
        .windows(2)
        .filter(|pair| pair[1].1 > pair[0].1)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let mut terms: List<&Term> =
                terms.iter().filter(|t| is_on(powers(t), (a, b))).collect();
            terms.sort_by_key(|t| std::cmp::Reverse(t.time));
            let order = Order::new(b.1 - a.1, a.0 - b.0);
            Edge { order, terms, face: OnceCell::new() }
        })
        .collect()
}

/// Whether a term, if nonzero, would lie above the part of the polygon with positive orders.
fn lies_above_polygon(term: &Term, corners: &[(i64, i64)]) -> bool {
    let (i, j) = (term.time as i64, term.form.degree() as i64);
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

/// A generic large wave number, in scaled units.
const GENERAL: f64 = 1.37e3;

/// Finds a direction in which the coefficient of the highest power of ς vanishes at a finite wave number while a root
/// with positive real part passes through infinity; returns the direction and whether this is certain.
fn unbounded_at_finite_k(certain: &[Term], doubtful: &[Term]) -> Option<(f64, bool)> {
    let highest = certain.iter().map(|t| t.time).max()?;
    if doubtful.iter().any(|t| t.time == highest) {
        return None;
    }
    let tops: List<&Term> = certain.iter().filter(|t| t.time == highest).collect();
    let zeros = match tops[..] {
        [only] => only.form.zeros(),
        _ => {
            // Real and imaginary part of the coefficient at the wave number GENERAL, each as a form of a single degree.
            let part = |parity: usize| {
                let own = || tops.iter().filter(move |t| t.form.degree() % 2 == parity);
                let degree = own().map(|t| t.form.degree()).max()?;
                let mut sum = Form::zero(degree);
                for term in own() {
                    let j = term.form.degree();
                    let sign = if (j / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
                    sum.add(&term.form, Rounded::exact(sign * GENERAL.powi(j as i32)));
                }
                Some(sum)
            };
            match (part(0), part(1)) {
                (Some(one), None) | (None, Some(one)) => one.zeros(),
                (Some(even), Some(odd)) => {
                    let others = odd.zeros();
                    let shared = |z: &Zero| {
                        others.iter().any(|o| apart(o.angle, z.angle) <= 2.0 * (o.bound + z.bound))
                    };
                    even.zeros().into_iter().filter(shared).collect()
                }
                (None, None) => List::new(),
            }
        }
    };
    let mut doubt = None;
    for zero in zeros {
        if !leads_to_infinity(certain, highest, &zero) {
            continue;
        }
        // Limit of the direction as k → ∞.
        let direction = tops
            .iter()
            .max_by_key(|t| t.form.degree())
            .into_iter()
            .flat_map(|t| t.form.zeros())
            .map(|z| z.angle)
            .min_by(|a, b| apart(*a, zero.angle).total_cmp(&apart(*b, zero.angle)))
            .unwrap_or(zero.angle);
        let exact = tops.iter().all(|t| t.form.vanishes_on_axis(zero.angle));
        if zero.crosses || exact {
            return Some((direction, true));
        }
        doubt = Some((direction, false));
    }
    doubt
}

/// Whether, at a generic wave number, roots ς with positive real part tend to infinity as the wave vector approaches
/// the direction `zero`.
fn leads_to_infinity(certain: &[Term], highest: usize, zero: &Zero) -> bool {
    [1.0, -1.0].into_iter().any(|side: f64| {
        let mut terms = List::new();
        for term in certain {
            let degree = term.form.degree();
            for (l, f) in along(&term.form, zero).into_iter().enumerate() {
                if l == 0 && term.time == highest {
                    continue;
                }
                let size = GENERAL.powi((degree - l) as i32) * side.powi(l as i32);
                let value = Value::times_imaginary_power(f * Rounded::exact(size), degree as i64);
                terms.push(Monomial { x: term.time, power: -(l as i64), value });
            }
        }
        puiseux::collect(&mut terms);
        puiseux::growth(&terms, 1, None).growth.is_some()
    })
}

/// Angle between two directions modulo π, rad.
fn apart(a: f64, b: f64) -> f64 {
    let gap = (a - b).rem_euclid(PI);
    gap.min(PI - gap)
}

impl Edge<'_> {
    /// Whether roots of this edge may be neutral in a whole sector to leading order, but grow at a lower order.
    fn may_be_neutral(&self) -> bool {
        if self.terms.len() > 2 {
            return true;
        }
        // A simple neutral root of order 1 continues with a term of order 0, which is bounded.
        let both = [1.0, -1.0].map(|sign| self.greatest_cosine(sign));
        self.order.value() > 1.0 && both.contains(&0.0)
    }

    /// Powers of ς and κ of the first and of the last term.
    fn ends(&self) -> [(usize, usize); 2] {
        let end = |t: &Term| (t.time, t.form.degree());
        [end(self.terms[0]), end(self.terms[self.terms.len() - 1])]
    }

    /// For an edge of two terms, c^r = w: largest Re c/|c| over the roots, for F₀/F₁ of sign `sign`.
    fn greatest_cosine(&self, sign: f64) -> f64 {
        let [(i1, j1), (i0, j0)] = self.ends();
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
    fn face(&self) -> &FacePolynomial {
        self.face.get_or_init(|| {
            let [(highest, _), (lowest, _)] = self.ends();
            let mut coefficients = list![List::new(); highest - lowest + 1];
            for t in &self.terms {
                let turned = |&f: &Rounded| Value::times_imaginary_power(f, t.form.degree() as i64);
                coefficients[t.time - lowest] = t.form.coefficients.iter().map(turned).collect();
            }
            FacePolynomial::new(coefficients)
        })
    }
}

/// Sectors between degenerate directions: (left, right), rad.
fn sectors(zeros: &[Zero]) -> List<(f64, f64)> {
    // Without zeros: one sector of length π whose ends are at no special angle, so that no extremum lies there.
    let Some(first) = zeros.first() else { return list![(-0.123_4, PI - 0.123_4)] };
    zeros
        .iter()
        .enumerate()
        .map(|(i, z)| (z.angle, zeros.get(i + 1).map_or(first.angle + PI, |next| next.angle)))
        .collect()
}

/// Searches the direction of largest growth of an edge.
fn search_directions(edge: &Edge, zeros: &[Zero], worst: &mut Worst) {
    if !worst.may_improve(edge.order) {
        return;
    }
    let (&[first, last], angles) = (&edge.terms[..], zeros) else {
        let face = edge.face();
        let avoided: List<f64> = zeros.iter().map(|z| z.angle).collect();
        match face.supremum(&avoided) {
            Some((rate, direction)) => worst.grows(edge.order, rate, direction),
            None => {
                let beside = zeros
                    .iter()
                    .any(|z| [1e-3, -1e-3].iter().any(|offset| face.rate(z.angle + offset) > 0.0));
                if beside {
                    worst.expects(edge.order);
                }
            }
        }
        return;
    };
    // c^r = −F₀/F₁ up to a power of i: |c| is extremal where |F₀/F₁| is.
    let mut extrema = None;
    let power = 1.0 / (first.time - last.time) as f64;
    for (left, right) in sectors(angles) {
        let ratio = |angle: f64| {
            let [upper, lower] = [&last.form, &first.form].map(|f| f.at_angle(angle));
            // At a common zero the ratio is lost to rounding.
            let edge = (angle - left).min(right - angle) < 1e-9f64.min(1e-3 * (right - left));
            let lost = edge || lower.bound > 1e-2 * lower.value.abs();
            if lost { 0.0 } else { (upper.value / lower.value).abs().cr_powf(power) }
        };
        let middle = 0.5 * (left + right);
        let signs = [&last.form, &first.form].map(|f| f.at_angle(middle));
        let [Some(a), Some(b)] = signs.map(Rounded::sign) else {
            let lost = if signs[0].sign().is_none() { signs[0] } else { signs[1] };
            worst.doubts(
                format!(
                    "leading coefficient near the wave vector's direction {:.6}°",
                    middle.rem_euclid(PI).to_degrees()
                ),
                lost.value,
                lost.bound,
            );
            continue;
        };
        let cosine = edge.greatest_cosine(f64::from(a * b));
        if cosine <= 0.0 {
            continue;
        }
        let mut best = (ratio(middle), middle);
        let mut is_thin = true;
        let extrema =
            extrema.get_or_insert_with(|| form::extrema_of_ratio(&last.form, &first.form));
        for angle in extrema.iter().flat_map(|e| [*e, e + PI]) {
            if left < angle && angle < right {
                is_thin = false;
                let value = ratio(angle);
                if value > best.0 {
                    best = (value, angle);
                }
            }
        }
        if is_thin {
            // The sector is too thin to be resolved by the roots of the polynomial.
            let angle = form::maximum_of_ratio(&last.form, &first.form, left, right);
            if ratio(angle) > best.0 {
                best = (ratio(angle), angle);
            }
        }
        worst.grows(edge.order, cosine * best.0, best.1);
    }
}

/// Number of sample directions in each sector between degenerate directions for roots that are neutral to leading
/// order.
const SAMPLES: usize = 12;

/// Minimum width (rad) of a sector of growth; in narrower ones growth may be an effect of branches that nearly touch.
const WIDTH: f64 = 0.1;

/// Searches lower-order growth of roots that are neutral to leading order in whole sectors, by Puiseux series.
fn follow_neutral_roots(terms: &[Term], zeros: &[Zero], worst: &mut Worst) {
    let at = |angle: f64| {
        let mut list: List<Monomial, 32> = terms
            .iter()
            .map(|t| {
                let degree = t.form.degree() as i64;
                let value = Value::times_imaginary_power(t.form.at_angle(angle), degree);
                Monomial { x: t.time, power: degree, value }
            })
            .collect();
        puiseux::collect(&mut list);
        puiseux::growth(&list, 1, None)
    };
    for (left, right) in sectors(zeros) {
        let step = (right - left) / SAMPLES as f64;
        let mut best: Option<(Order, f64, f64)> = None;
        for sample in 0..SAMPLES {
            let angle = left + (sample as f64 + 0.5) * step;
            let found = at(angle);
            let Some((order, c)) = found.growth else {
                worst.takes(found, angle);
                continue;
            };
            // Next to a collision distinct roots may appear multiple; growth of a whole sector also appears at
            // neighbouring angles.
            let goes_on = [0.4, -0.4].into_iter().any(|offset| {
                let beside = at(angle + offset * step.max(WIDTH));
                beside.growth.is_some_and(|(beside, _)| beside == order)
            });
            if !goes_on {
                worst.doubts_contact(order, angle);
            } else if best.is_none_or(|(o, b, _)| (order, c) > (o, b)) {
                best = Some((order, c, angle));
            }
        }
        let Some((order, mut value, mut place)) = best else { continue };
        let known = worst.growth.is_some_and(|(o, _, _)| o >= order);
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
        worst.grows(order, value, place);
    }
}

/// Searches growth around the directions in which neutral roots of an edge collide.
fn search_collisions(terms: &[Term], edge: &Edge, zeros: &[Zero], worst: &mut Worst) {
    let face = edge.face();
    for &angle in face.collisions() {
        for Collision { angle, root, is_sharp } in collisions_at(face, angle) {
            // Degenerate directions are searched by `search_layer`.
            if !root.is_neutral() || zeros.iter().any(|z| apart(z.angle, angle) < 1e-9) {
                continue;
            }
            if !is_sharp {
                worst.doubts_contact(edge.order, angle);
                continue;
            }
            // The angle is not reduced to [0, π): the roots c at α + π differ from those at α.
            let zero = Zero { angle, bound: 4e-15, crosses: true };
            search_collision(terms, &zero, edge.order, &root, worst);
        }
    }
}

/// Verdict from the accumulated worst growth and doubts.
fn verdict(mut worst: Worst, pencil: &Pencil) -> Verdict {
    if let Some(order) = worst.missing() {
        worst.growth = None;
        worst.doubts(format!("growth of an order above {}", order.value()), 0.0, f64::EPSILON);
    }
    let (rate, wave_number) = (pencil.polynomial.rate, pencil.polynomial.wave_number);
    match (worst.growth, worst.doubt) {
        (Some((order, scaled, direction)), _) => Verdict::IllPosed {
            growth: Some(Growth {
                order,
                coefficient: scaled * rate / wave_number.cr_powf(order.value()),
            }),
            direction: direction.rem_euclid(PI),
        },
        (None, Some((quantity, value, rounding))) => {
            Verdict::Marginal { quantity, value, rounding }
        }
        (None, None) => Verdict::WellPosed,
    }
}
