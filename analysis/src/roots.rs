//! All roots of a complex polynomial by simultaneous iteration (Aberth–Ehrlich method: Ehrlich 1967, Aberth 1973).

use crate::extended_precision::ExtendedComplex;
use crate::list::{StackList, list};
use models::common::elementary::{Elementary, Modulus, cr_cis, cr_from_polar};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Relative error of a complex product and sum of double-double numbers.
const EXTENDED_EVALUATION_ERROR: f64 = 1e-30;

/// Rounding error of a polynomial evaluated in working precision, relative to the sum of the moduli of its terms: an
/// iterate with a smaller value is the exact root of a polynomial whose coefficients differ by this part (backward error).
const EVALUATION_ERROR: f64 = 2.0 * f64::EPSILON;

/// Last step of the iteration, relative to the root: the spacing of doubles.
const LAST_STEP: f64 = f64::EPSILON;

/// Newton correction, relative to the root, below which an iterate is near a root.
const NEWTON_RANGE: f64 = 1e-3;

/// Maximum number of Aberth–Ehrlich iterations.
const MAX_ITERATIONS: usize = 200;

/// All roots of Σ `coefficients[i]` xⁱ; the last coefficient must not vanish.
pub fn solve(coefficients: &[Complex64]) -> StackList<Complex64> {
    match coefficients {
        [] | [_] => StackList::new(),
        [c0, c1] => list![-c0 / c1],
        [c0, c1, c2] => {
            // The larger root first, the other from their product, to avoid cancellation.
            let root = (c1 * c1 - 4.0 * c2 * c0).sqrt();
            let sign = if (c1.conj() * root).re < 0.0 { -1.0 } else { 1.0 };
            let sum = -(c1 + sign * root) / 2.0;
            if sum == Complex64::ZERO {
                list![Complex64::ZERO; 2]
            } else {
                list![sum / c2, c0 / sum]
            }
        }
        _ => {
            if let Some(roots) = solve_even(coefficients) {
                return roots;
            }
            let mut start = initial_guesses(coefficients, &[]);
            let moduli: StackList<f64> = coefficients.iter().map(|c| c.modulus()).collect();
            iterate_aberth(&mut start, &moduli, EVALUATION_ERROR, |x| {
                evaluate_with_derivative(coefficients, x)
            })
        }
    }
}

/// The roots of a polynomial in x² as pairs ±√z of its roots z; `None` for other polynomials, and if two of the z are
/// close, hence ill-conditioned.
fn solve_even(coefficients: &[Complex64]) -> Option<StackList<Complex64>> {
    /// Distance of two roots z, relative to the larger one, below which they are close.
    const CLOSE_DISTANCE: f64 = 1e-2;
    let is_even = coefficients.len() % 2 == 1
        && coefficients.iter().skip(1).step_by(2).all(|c| *c == Complex64::ZERO);
    if !is_even {
        return None;
    }
    let squares: StackList<Complex64> = coefficients.iter().step_by(2).copied().collect();
    let squares = solve(&squares);
    let is_apart = |a: Complex64, b: Complex64| {
        (a - b).norm_sqr() > CLOSE_DISTANCE * CLOSE_DISTANCE * a.norm_sqr().max(b.norm_sqr())
    };
    let are_apart = (1..squares.len())
        .all(|last| squares[..last].iter().all(|square| is_apart(*square, squares[last])));
    let pair = |square: &Complex64| {
        let root = square.sqrt();
        [root, -root]
    };
    are_apart.then(|| squares.iter().flat_map(pair).collect())
}

/// All roots of a polynomial with double-double coefficients, so that even ill-conditioned roots are accurate to nearly
/// working precision. The `guesses` are used if there is one per root, all are finite, and no root is exactly zero.
pub fn solve_extended(
    coefficients: &[ExtendedComplex],
    guesses: &[Complex64],
) -> StackList<Complex64> {
    let rounded: StackList<_> =
        coefficients.iter().map(|c| Complex64::new(c.re.high, c.im.high)).collect();
    // Split off roots that are exactly zero.
    let zeros = rounded.iter().take_while(|c| **c == Complex64::ZERO).count();
    if zeros + 1 >= rounded.len() {
        return list![Complex64::ZERO; zeros.min(rounded.len().saturating_sub(1))];
    }
    let (coefficients, rounded) = (&coefficients[zeros..], &rounded[zeros..]);
    let guesses = if zeros == 0 { guesses } else { &[] };
    let mut start = initial_guesses(rounded, guesses);
    let rounding = EXTENDED_EVALUATION_ERROR * rounded.len() as f64;
    let moduli: StackList<f64> = rounded.iter().map(|c| c.modulus()).collect();
    let mut roots =
        iterate_aberth(&mut start, &moduli, rounding, |x| evaluate_extended(coefficients, x));
    roots.extend(std::iter::repeat_n(Complex64::ZERO, zeros));
    roots
}

/// Value and derivative at x of a polynomial with double-double coefficients, by Horner's scheme; the value in
/// double-double precision.
pub(crate) fn evaluate_extended(
    coefficients: &[ExtendedComplex],
    x: Complex64,
) -> (Complex64, Complex64) {
    let (mut value, mut slope) = (ExtendedComplex::default(), Complex64::ZERO);
    for c in coefficients.iter().rev() {
        slope = slope * x + Complex64::new(value.re.high, value.im.high);
        value = value * x + *c;
    }
    (Complex64::new(value.re.high, value.im.high), slope)
}

/// Value and derivative of the polynomial at x, by Horner's scheme.
fn evaluate_with_derivative(coefficients: &[Complex64], x: Complex64) -> (Complex64, Complex64) {
    let (mut value, mut slope) = (Complex64::ZERO, Complex64::ZERO);
    for c in coefficients.iter().rev() {
        slope = slope * x + value;
        value = value * x + c;
    }
    (value, slope)
}

/// Starting points: the `guesses`, slightly perturbed, if there is one per root and all are finite; else, up to degree two,
/// the roots in working precision, unless products of the coefficients underflow or overflow; else points on
/// circles whose logarithmic radii are the negative slopes of the Newton polygon of the logarithms of the moduli.
fn initial_guesses(coefficients: &[Complex64], guesses: &[Complex64]) -> StackList<Complex64> {
    let degree = coefficients.len() - 1;
    let usable = guesses.len() == degree && guesses.iter().all(|g| g.is_finite());
    if usable {
        // Perturb the guesses: equal ones would divide by zero.
        return guesses
            .iter()
            .enumerate()
            .map(|(i, g)| g * cr_from_polar(1.0 + 1e-9 * i as f64, 1e-9 * i as f64))
            .collect();
    }
    if degree <= 2 {
        let mut roots = solve(coefficients);
        if let [first, second] = &mut roots[..]
            && first == second
        {
            // Equal starting points do not separate.
            *second *= 1.0 + 1e-9;
        }
        if roots.iter().all(|root| root.is_finite() && *root != Complex64::ZERO) {
            return roots;
        }
    }
    let logarithms: StackList<f64> =
        coefficients.iter().map(|c| c.modulus().max(f64::MIN_POSITIVE).cr_log2()).collect();
    let log = |i: usize| logarithms[i];
    let mut hull: StackList<usize> = StackList::new();
    for i in (0..=degree).filter(|&i| coefficients[i] != Complex64::ZERO) {
        while let [.., a, b] = hull[..] {
            let above = (log(b) - log(a)) * (i - a) as f64 <= (log(i) - log(a)) * (b - a) as f64;
            if !above {
                break;
            }
            hull.pop();
        }
        hull.push(i);
    }
    let mut start = StackList::new();
    start.resize(hull.first().copied().unwrap_or(0), Complex64::ZERO);
    for pair in hull.windows(2) {
        let count = pair[1] - pair[0];
        let radius = ((log(pair[0]) - log(pair[1])) / count as f64).cr_exp2();
        // Different phases keep points on circles of almost equal radii apart.
        let mut point = cr_from_polar(radius, 0.7 + pair[0] as f64);
        start.push(point);
        if count > 1 {
            let turn = cr_cis(TAU / count as f64);
            for _ in 1..count {
                point *= turn;
                start.push(point);
            }
        }
    }
    start
}

/// Aberth–Ehrlich iteration from the starting points `roots` until each step is at most [`LAST_STEP`] times the root, or
/// the value before the step at most the part `evaluation_error` of the sum of the moduli of the terms: iterates at a
/// multiple root never agree in all digits, and are as good as the coefficients determine them where the value is rounding.
/// `evaluate` returns value and derivative; `moduli` are those of the coefficients.
fn iterate_aberth(
    roots: &mut [Complex64],
    moduli: &[f64],
    evaluation_error: f64,
    evaluate: impl Fn(Complex64) -> (Complex64, Complex64),
) -> StackList<Complex64> {
    let mut settled = list![false; roots.len()];
    for _ in 0..MAX_ITERATIONS {
        for i in 0..roots.len() {
            if settled[i] {
                continue;
            }
            let (value, slope) = evaluate(roots[i]);
            let size = roots[i].modulus();
            let terms = moduli.iter().rev().fold(0.0, |sum, modulus| sum * size + modulus);
            let is_rounding = value.modulus() <= evaluation_error * terms;
            let others: Complex64 = (0..roots.len())
                .filter(|&j| j != i && roots[j] != roots[i])
                .map(|j| {
                    let distance = roots[i] - roots[j];
                    distance.conj() * (1.0 / distance.norm_sqr())
                })
                .sum();
            let step = value / (slope - value * others);
            // A step may also be small because another iterate is close: test the Newton correction too.
            let is_near = value.modulus() <= NEWTON_RANGE * size * slope.modulus();
            if is_rounding && !(is_near && step.is_finite()) {
                // At a multiple root the step is noise.
                settled[i] = true;
                continue;
            }
            if !step.is_finite() {
                // The sum over the other roots cancels the derivative: continue from a nearby point.
                roots[i] *= cr_from_polar(1.001, 0.01);
                continue;
            }
            roots[i] -= step;
            settled[i] = is_rounding || is_near && step.modulus() <= LAST_STEP * size;
        }
        if settled.iter().all(|s| *s) {
            break;
        }
    }
    StackList::from_slice(roots)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand_product(roots: &[Complex64]) -> Vec<Complex64> {
        let mut p = vec![Complex64::ONE];
        for r in roots {
            let mut next = vec![Complex64::ZERO; p.len() + 1];
            for (i, c) in p.iter().enumerate() {
                next[i + 1] += c;
                next[i] -= r * c;
            }
            p = next;
        }
        p
    }

    #[test]
    fn roots_spread_over_many_decades_are_recovered() {
        let c = Complex64::new;
        for wanted in [
            vec![c(-3e8, 1.0), c(2.0, -1e-3)],
            vec![c(1e-6, 2e-6), c(-4.0, 1.0), c(5e5, -7e5)],
            vec![c(1.0, 0.0), c(-1.0, 0.0), c(0.0, 1.0), c(0.0, -1.0), c(1e4, 3.0)],
        ] {
            let found = solve(&expand_product(&wanted));
            assert_eq!(found.len(), wanted.len());
            for w in &wanted {
                let best = found.iter().map(|f| (f - w).modulus()).fold(f64::MAX, f64::min);
                assert!(best <= 1e-12 * w.modulus(), "{w}: off by {best:e}");
            }
        }
    }

    /// The roots of Π (x² − sᵢ) are compared with ±√sᵢ, and each with the iteration for general polynomials.
    #[test]
    fn roots_of_even_polynomials_are_pairs() {
        let c = Complex64::new;
        for squares in [
            vec![c(2.0, 0.0), c(-3.0, 0.0)],
            vec![c(-1e-6, 0.0), c(-4.0, 0.0)],
            vec![c(0.3, 0.8), c(0.3, -0.8), c(-5e5, 7e2)],
            vec![c(-1.0, 0.0), c(-1.5, 0.0), c(2.0, -1.0), c(1e3, 0.0)],
        ] {
            let wanted: Vec<Complex64> =
                squares.iter().flat_map(|s| [s.sqrt(), -s.sqrt()]).collect();
            let even = expand_product(&squares).into_iter().flat_map(|c| [c, Complex64::ZERO]);
            let mut even: Vec<Complex64> = even.collect();
            even.pop();
            let general = {
                let moduli: StackList<f64> = even.iter().map(|c| c.modulus()).collect();
                iterate_aberth(&mut initial_guesses(&even, &[]), &moduli, EVALUATION_ERROR, |x| {
                    evaluate_with_derivative(&even, x)
                })
            };
            for found in [solve(&even), general] {
                assert_eq!(found.len(), wanted.len());
                for w in &wanted {
                    let best = found.iter().map(|f| (f - w).modulus()).fold(f64::MAX, f64::min);
                    assert!(best <= 1e-12 * w.modulus(), "{w}: off by {best:e}");
                }
            }
        }
        // Close squares are left to the iteration.
        let close = [c(1.002, 0.0), c(0.0, 0.0), c(-2.002, 0.0), c(0.0, 0.0), c(1.0, 0.0)];
        assert!(solve_even(&close).is_none());
        // Imaginary roots have no spurious real part.
        let found = solve(&[c(4.0, 0.0), c(0.0, 0.0), c(5.0, 0.0), c(0.0, 0.0), c(1.0, 0.0)]);
        assert!(found.iter().all(|root| root.re == 0.0), "{found:?}");
    }

    /// Coefficients rounded by a part δ move a root of multiplicity m by about (δ |p| / |p⁽ᵐ⁾ / m!|)^(1/m).
    #[test]
    fn multiple_and_close_roots_are_as_good_as_their_coefficients() {
        let c = |re| Complex64::new(re, 0.0);
        for (wanted, tolerance) in [
            (vec![c(1.0); 2], 1e-7),
            (vec![c(1.0), c(1.0), c(1.0), c(-2.0)], 3e-5),
            (vec![c(1.0), c(1.0 + 1e-6), c(-2.0)], 1e-8),
        ] {
            let found = solve(&expand_product(&wanted));
            for near in found
                .iter()
                .map(|f| wanted.iter().map(|w| (f - w).modulus()).fold(f64::MAX, f64::min))
            {
                assert!(near < tolerance, "{wanted:?}: {found:?}");
            }
            for w in &wanted {
                assert!(found.iter().any(|f| (f - w).modulus() < tolerance), "{w}: {found:?}");
            }
        }
    }

    #[test]
    fn extended_coefficients_resolve_close_roots() {
        // (x − 1)(x − 1 − 2⁻⁴⁰): the coefficients need more than 53 bits.
        let gap = (-40f64).exp2();
        let e = |x: f64| crate::extended_precision::ExtendedReal::from(x);
        let real = |re| ExtendedComplex { re, im: e(0.0) };
        let p = [real(e(1.0) + e(gap)), real(-(e(2.0) + e(gap))), real(e(1.0))];
        let mut found: Vec<_> = solve_extended(&p, &[]).iter().map(|r| r.re).collect();
        found.sort_by(f64::total_cmp);
        assert!((found[0] - 1.0).abs() < 1e-15 && (found[1] - 1.0 - gap).abs() < 1e-15);
    }

    #[test]
    fn exact_zero_roots_are_exact() {
        let e = |x: f64| ExtendedComplex { re: x.into(), im: 0.0.into() };
        let mut found = solve_extended(&[e(0.0), e(0.0), e(-6.0), e(2.0)], &[]);
        found.sort_by(|a, b| a.re.total_cmp(&b.re));
        assert_eq!(found[..2], [Complex64::ZERO; 2]);
        assert!((found[2].re - 3.0).abs() < 1e-15);
    }
}
