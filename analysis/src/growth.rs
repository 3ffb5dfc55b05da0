//! How fast short waves grow, in every direction: the verdict on a frozen state.
//!
//! With P = Σ ςⁱ F_ij(κ₁, κ₂) the roots at wave number k → ∞ in a fixed direction are
//! ς ≈ c k^m, where m runs through the slopes of the Newton polygon of the points (i, j) with
//! F_ij ≠ 0 and c through the roots of the edge polynomials ([`newton`](crate::newton)). Signs of
//! the F_ij at the corners of the polygon change only at their zeros, which are found exactly
//! ([`Form::zeros`]); between them the worst direction is searched. Around each zero ("degenerate
//! direction") lies a layer in which other terms decide (module `layers`).

use crate::form::{self, Form, Zero};
use crate::layers::search_layer;
use crate::leading;
use crate::newton::{
    NextOrder, Order, Trend, Worst, corners_of, golden_section, is_on, next_order, trend,
};
use crate::pencil::Pencil;
use crate::polynomial::Term;
use std::f64::consts::PI;

/// Growth of the worst short waves, Re ς ≈ `coefficient` k^`order`.
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
    /// The growth rate is bounded uniformly over short waves of all directions.
    WellPosed,
    /// It is not.
    IllPosed {
        /// Order and coefficient; `None` where the growth rate is unbounded at finite wave
        /// numbers already.
        growth: Option<Growth>,
        /// Angle of the wave vector, rad, in [0, π), at which it is approached.
        direction: f64,
    },
    /// The quantity that decides is zero within its own rounding bound.
    Marginal {
        /// What it is.
        quantity: String,
        /// Its value (in scaled units).
        value: f64,
        /// Its rounding bound.
        rounding: f64,
    },
    /// det ≡ 0, or fewer equations than unknowns.
    Indeterminate {
        /// Generic rank of the pencil.
        rank: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

impl Verdict {
    /// Name in results.
    pub fn name(&self) -> &'static str {
        match self {
            Self::WellPosed => "well-posed",
            Self::IllPosed { .. } => "ill-posed",
            Self::Marginal { .. } => "marginal",
            Self::Indeterminate { .. } => "indeterminate",
        }
    }
}

/// A direction in which a leading coefficient vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DegenerateDirection {
    /// Angle of the wave vector, rad, in [0, π).
    pub angle: f64,
    /// Bound on its error, rad.
    pub bound: f64,
}

/// A verdict with what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// The verdict.
    pub verdict: Verdict,
    /// The Newton polygon in a general direction: (order, number of roots) of the growing or
    /// decaying roots, largest order first; orders ≤ 0 are bounded and left out.
    pub orders: Vec<(Order, usize)>,
    /// Directions in which a leading coefficient vanishes, ascending.
    pub degenerate: Vec<DegenerateDirection>,
}

/// An edge of the Newton polygon in a general direction.
struct Edge<'a> {
    order: Order,
    /// Terms on the edge, by descending power of ς.
    terms: Vec<&'a Term>,
}

/// Directions tried between two degenerate ones.
const SAMPLES: usize = 12;

/// Judges the system that `pencil` holds.
pub fn assess(pencil: &Pencil) -> Assessment {
    let mut assessment =
        Assessment { verdict: Verdict::WellPosed, orders: Vec::new(), degenerate: Vec::new() };
    if pencil.is_singular() {
        let unknowns = pencil.scaled.system.unknowns.len();
        assessment.verdict = Verdict::Indeterminate { rank: pencil.generic_rank(), unknowns };
        return assessment;
    }
    let terms = pencil.polynomial.forms();
    let (mut certain, doubtful): (Vec<Term>, Vec<Term>) =
        terms.into_iter().partition(|term| term.form.is_certain());
    let corners = corners_of(certain.iter().map(powers));
    factorise_corners(pencil, &mut certain, &corners);
    let edges = edges(&certain, &corners);
    assessment.orders = edges
        .iter()
        .map(|e| (e.order, e.terms[0].time - e.terms[e.terms.len() - 1].time))
        .collect();

    // A form that is all rounding, but would stand above the polygon, decides and cannot be judged.
    if let Some(term) = doubtful.iter().find(|term| stands_above(term, &corners)) {
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

    // Corners off the growing edges count too: where they vanish, other edges may come to grow.
    let is_corner = |t: &&Term| corners.contains(&powers(t));
    let mut zeros: Vec<Zero> =
        certain.iter().filter(is_corner).flat_map(|corner| corner.form.zeros()).collect();
    // Zeros of different corners in one direction are one degenerate direction.
    form::merge(&mut zeros);
    assessment.degenerate =
        zeros.iter().map(|z| DegenerateDirection { angle: z.angle, bound: z.bound }).collect();

    let mut worst = Worst::default();
    match unbounded_at_finite_k(&certain, &doubtful) {
        Some(Zero { angle: direction, crosses: true, .. }) => {
            assessment.verdict = Verdict::IllPosed { growth: None, direction };
            return assessment;
        }
        Some(Zero { angle, .. }) => worst.doubts(
            format!(
                "coefficient of the highest power of ς for wave vectors at {:.6}°",
                angle.to_degrees()
            ),
            0.0,
            f64::EPSILON,
        ),
        None => {}
    }

    for edge in &edges {
        search_directions(&certain, edge, &zeros, &mut worst);
    }
    worst.sectors = worst.growth.map(|(order, coefficient, _)| (order, coefficient));
    for zero in &zeros {
        search_layer(&certain, zero, &mut worst);
    }
    assessment.verdict = verdict(worst, pencil);
    assessment
}

/// Power of ς and degree of the form.
fn powers(term: &Term) -> (i64, i64) {
    (term.time as i64, term.form.degree() as i64)
}

/// Splits the corner coefficients that vanish in more than one direction into factors: zeros of one
/// factor are well-conditioned however near those of another lie.
fn factorise_corners(pencil: &Pencil, terms: &mut [Term], corners: &[(i64, i64)]) {
    let slope = |a: (i64, i64), b: (i64, i64)| [b.1 - a.1, a.0 - b.0];
    for (index, &(i, j)) in corners.iter().enumerate() {
        let steeper = (index > 0).then(|| slope(corners[index - 1], corners[index]));
        let flatter = corners.get(index + 1).map(|&next| slope(corners[index], next));
        let is_on_growing_edge = |s: &Option<[i64; 2]>| s.is_some_and(|s| s[0] > 0);
        if !is_on_growing_edge(&steeper) && !is_on_growing_edge(&flatter) {
            continue;
        }
        let Some(term) =
            terms.iter_mut().find(|t| (t.time as i64, t.form.degree() as i64) == (i, j))
        else {
            continue;
        };
        if term.form.degree() < 2 || term.form.zeros().is_empty() {
            continue;
        }
        // An m strictly between the two slopes at which no other powers compete.
        let low = flatter.unwrap_or([0, 1]);
        let high = steeper.unwrap_or([low[0] + low[1], low[1]]);
        let between = [6 * low[0] * high[1] + 5 * high[0] * low[1], 11 * low[1] * high[1]];
        let factors = leading::factors(&pencil.scaled, between);
        if !factors.is_empty() {
            term.form.factorise(factors);
        }
    }
}

/// Edges of positive slope, steepest first.
fn edges<'a>(terms: &'a [Term], corners: &[(i64, i64)]) -> Vec<Edge<'a>> {
    corners
        .windows(2)
        .filter(|pair| pair[1].1 > pair[0].1)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let mut terms: Vec<&Term> = terms.iter().filter(|t| is_on(powers(t), (a, b))).collect();
            terms.sort_by_key(|t| std::cmp::Reverse(t.time));
            Edge { order: Order::new(b.1 - a.1, a.0 - b.0), terms }
        })
        .collect()
}

/// Whether a term, were it not zero, would enter the part of the polygon with positive orders.
fn stands_above(term: &Term, corners: &[(i64, i64)]) -> bool {
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

/// A direction in which the coefficient of the highest power of ς vanishes at every wave number, so
/// that ς passes through infinity as the wave vector turns: the zero, which crosses or touches.
fn unbounded_at_finite_k(certain: &[Term], doubtful: &[Term]) -> Option<Zero> {
    let highest = certain.iter().map(|t| t.time).max()?;
    if doubtful.iter().any(|t| t.time == highest) {
        return None;
    }
    let of_power = |power: usize| certain.iter().filter(move |t| t.time == power);
    let tops: Vec<&Term> = of_power(highest).collect();
    let (top, others) = tops.split_first()?;
    let vanishes =
        |t: &Term, angle: f64| t.form.at_angle(angle).value.abs() <= 1e-9 * size(&t.form);
    top.form.zeros().into_iter().find(|zero| {
        if !others.iter().all(|t| vanishes(t, zero.angle)) {
            return false;
        }
        // Next to the zero ς ≈ −(next coefficient)/(top coefficient). One that is imaginary against a
        // single top form leads along the imaginary axis.
        let mut next = of_power(highest.wrapping_sub(1)).filter(|t| !vanishes(t, zero.angle));
        let is_real = |t: &Term| (t.form.degree() + top.form.degree()).is_multiple_of(2);
        match next.next() {
            Some(first) => !others.is_empty() || is_real(first) || next.any(is_real),
            // Without it, roots of the ratio to a lower power, some with a positive real part.
            None => certain.iter().any(|t| t.time + 1 < highest && !vanishes(t, zero.angle)),
        }
    })
}

fn size(form: &Form) -> f64 {
    form.coefficients.iter().map(|c| c.value.abs()).fold(0.0, f64::max)
}

fn trend_in_direction(edge: &Edge, angle: f64) -> Trend {
    let points: Vec<_> = edge
        .terms
        .iter()
        .map(|t| (t.time, t.form.degree() as i64, t.form.at_angle(angle)))
        .collect();
    trend(&points)
}

/// The worst direction of an edge, sector by sector.
fn search_directions(terms: &[Term], edge: &Edge, zeros: &[Zero], worst: &mut Worst) {
    let mut bounds: Vec<f64> = zeros.iter().map(|z| z.angle).collect();
    if bounds.is_empty() {
        bounds.push(0.0);
    }
    for (index, &left) in bounds.iter().enumerate() {
        let right = bounds.get(index + 1).copied().unwrap_or(bounds[0] + PI);
        let width = right - left;
        let at = |x: f64| left + x * width;
        let rate = |x: f64| match trend_in_direction(edge, at(x)) {
            Trend::Grows(c) => c,
            _ => 0.0,
        };
        let next = |x: f64| {
            let points: Vec<_> = terms
                .iter()
                .map(|t| (t.time, t.form.degree() as i64, t.form.at_angle(at(x))))
                .collect();
            next_order(&points, edge.order)
        };
        let mut best = (0.0, 0.5);
        let mut second = (None, 0.0, 0.5);
        for sample in 0..SAMPLES {
            let x = (sample as f64 + 0.5) / SAMPLES as f64;
            match trend_in_direction(edge, at(x)) {
                Trend::Grows(c) if c > best.0 => best = (c, x),
                Trend::Grows(_) | Trend::Decays => {}
                Trend::Neutral => match next(x) {
                    NextOrder::Bounded => {}
                    NextOrder::Grows(order, c) if c > second.1 => second = (Some(order), c, x),
                    NextOrder::Grows(..) => {}
                    NextOrder::Doubtful(quantity, value, bound) => {
                        worst.doubts(quantity, value, bound);
                    }
                },
                Trend::Doubtful(value) => worst.doubts(
                    format!(
                        "leading coefficient near the wave vector's direction {:.6}°",
                        at(x).rem_euclid(PI).to_degrees()
                    ),
                    value.value,
                    value.bound,
                ),
            }
        }
        let step = 1.0 / SAMPLES as f64;
        let refine = |rate: &dyn Fn(f64) -> f64, (value, x): (f64, f64)| {
            let refined = golden_section(rate, (x - step).max(0.0), (x + step).min(1.0));
            if rate(refined) >= value { (rate(refined), refined) } else { (value, x) }
        };
        if best.0 > 0.0 {
            let (value, x) = refine(&rate, best);
            worst.grows(edge.order, value, at(x));
        }
        if let (Some(order), value, x) = second {
            let rate = |x: f64| match next(x) {
                NextOrder::Grows(_, c) => c,
                _ => 0.0,
            };
            let (value, x) = refine(&rate, (value, x));
            worst.grows(order, value, at(x));
        }
    }
}

/// The verdict that follows from all that was found.
fn verdict(worst: Worst, pencil: &Pencil) -> Verdict {
    let (rate, wave_number) = (pencil.polynomial.rate, pencil.polynomial.wave_number);
    match (worst.growth, worst.doubt) {
        (Some((order, scaled, direction)), _) => Verdict::IllPosed {
            growth: Some(Growth {
                order,
                coefficient: scaled * rate / wave_number.powf(order.value()),
            }),
            direction: direction.rem_euclid(PI),
        },
        (None, Some((quantity, value, rounding))) => {
            Verdict::Marginal { quantity, value, rounding }
        }
        (None, None) => Verdict::WellPosed,
    }
}
