//! How fast short waves grow, in every direction: the verdict on a frozen state.
//!
//! With P = Σ ςⁱ F_ij(κ₁, κ₂) the roots at wave number k → ∞ in a fixed direction are
//! ς ≈ c k^m, where m runs through the slopes of the Newton polygon of the points (i, j) with
//! F_ij ≠ 0 and c through the roots of the edge polynomials. Signs of the F_ij at the corners of
//! the polygon change only at their zeros, which are found exactly ([`Form::zeros`]); between them
//! the worst direction is searched. Around each zero ("degenerate direction") lies a layer in which
//! other terms decide: with κ⊥ = O(k^τ), τ < 1, across that direction, the orders m and offsets τ
//! that compete are the facets of the Newton polytope of the points (i, j, l) of ςⁱ κʲ κ⊥ˡ.

use crate::AnalysisError;
use crate::form::{self, Form, Zero};
use crate::leading;
use crate::pencil::Pencil;
use crate::polynomial::Term;
use crate::roots;
use models::Rounded;
use num_complex::Complex64;
use std::f64::consts::PI;

/// A rational order of growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Numerator.
    pub numerator: i64,
    /// Denominator, positive, in lowest terms.
    pub denominator: i64,
}

impl Order {
    fn new(numerator: i64, denominator: i64) -> Self {
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

/// What the leading coefficients c of some roots do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trend {
    /// Some Re c > 0, the greatest of them.
    Grows(f64),
    /// Greatest Re c is zero to rounding (a wave): the next order decides.
    Neutral,
    /// All Re c < 0.
    Decays,
    /// A sign is lost in rounding.
    Doubtful(Rounded),
}

/// Directions tried between two degenerate ones.
const SAMPLES: usize = 12;

/// By how much a layer's coefficient must exceed that of the sectors beside it to be news.
const LAYER_EXCESS: f64 = 1.01;

/// Layers are scanned over widths of 2^−SCAN to 2^SCAN in the system's own units.
const SCAN: i32 = 30;

/// |Re c| below this fraction of |c| counts as zero where c is a root of a polynomial with more
/// than two terms; two terms are judged by exact signs.
const NEUTRAL: f64 = 1e-7;

/// Roots nearer to each other than this fraction of their modulus may be one repeated root.
const CLUSTER: f64 = 1e-3;

/// Judges the system that `pencil` holds.
///
/// # Errors
/// See [`AnalysisError`].
pub fn assess(pencil: &Pencil) -> Result<Assessment, AnalysisError> {
    let mut assessment =
        Assessment { verdict: Verdict::WellPosed, orders: Vec::new(), degenerate: Vec::new() };
    if pencil.is_singular() {
        let unknowns = pencil.scaled.system.unknowns.len();
        assessment.verdict = Verdict::Indeterminate { rank: pencil.generic_rank(), unknowns };
        return Ok(assessment);
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
        return Ok(assessment);
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
            return Ok(assessment);
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
    assessment.verdict = worst.verdict(pencil);
    Ok(assessment)
}

/// The greatest growth met so far, and what could not be judged.
#[derive(Default)]
struct Worst {
    /// (order, scaled coefficient, direction)
    growth: Option<(Order, f64, f64)>,
    /// (order, scaled coefficient) of the sectors alone.
    sectors: Option<(Order, f64)>,
    doubt: Option<(String, f64, f64)>,
}

impl Worst {
    fn grows(&mut self, order: Order, coefficient: f64, direction: f64) {
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
    fn grows_in_layer(&mut self, order: Order, coefficient: f64, direction: f64) {
        let again = self.sectors.is_some_and(|(o, c)| o == order && coefficient < LAYER_EXCESS * c);
        if !again {
            self.grows(order, coefficient, direction);
        }
    }

    fn doubts(&mut self, quantity: String, value: f64, rounding: f64) {
        self.doubt.get_or_insert((quantity, value, rounding));
    }

    fn verdict(self, pencil: &Pencil) -> Verdict {
        let (rate, wave_number) = (pencil.polynomial.rate, pencil.polynomial.wave_number);
        match (self.growth, self.doubt) {
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
}

/// Corners of the upper boundary of the Newton polygon of points (i, j), by descending i.
fn corners_of(points: impl Iterator<Item = (i64, i64)>) -> Vec<(i64, i64)> {
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
fn is_on((i, j): (i64, i64), ((i1, j1), (i0, j0)): ((i64, i64), (i64, i64))) -> bool {
    i0 <= i && i <= i1 && (j - j1) * (i1 - i0) == (j0 - j1) * (i1 - i)
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

/// iⁿ
fn imaginary_power(n: i64) -> Complex64 {
    match n.rem_euclid(4) {
        0 => Complex64::ONE,
        1 => Complex64::I,
        2 => -Complex64::ONE,
        _ => -Complex64::I,
    }
}

/// What the non-zero roots c of Σ `coefficient` i^`power of κ` c^`power of ς` do; the coefficients
/// by descending power of ς.
fn trend(points: &[(usize, i64, Rounded)]) -> Trend {
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

/// What the next order of neutral roots says.
enum NextOrder {
    Bounded,
    Grows(Order, f64),
    Doubtful(String, f64, f64),
}

/// Follows roots ς ≈ c k^m with Re c = 0 (waves) to their next order. `points` holds all coefficients
/// in one direction as (power of ς, power of κ, value). With those that lie γ below the edge of order
/// m, ς ≈ c k^m + e k^(m−γ), e = −R(c)/E′(c), where E is the edge polynomial and R collects those
/// points. While m − γ ≤ 0 simple roots stay bounded.
fn next_order(points: &[(usize, i64, Rounded)], order: Order) -> NextOrder {
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
fn search_layer(terms: &[Term], zero: &Zero, worst: &mut Worst) {
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
