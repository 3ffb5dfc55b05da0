//! Determinants, polynomials and their roots in 256 bits, by Leibniz's sum over permutations, independent of the
//! methods of the crate.

use super::real256::{Complex256, Real256};
use models::LinearisedSystem;
use num_complex::Complex64;

/// The matrices of A ∂ₜz + Σ Bⁱ ∂ᵢz + C z = 0 in 256 bits, row by row.
#[derive(Clone, Debug)]
pub struct System256 {
    pub size: usize,
    /// Entry (i, j) → coefficients of ς, κ₁, κ₂ and 1.
    pub entries: Vec<Vec<[Real256; 4]>>,
}

impl System256 {
    /// Converts the doubles of a square system exactly; `velocity` is omitted.
    pub fn from_linearised(system: &LinearisedSystem<2>) -> Self {
        let size = system.equations.len();
        assert_eq!(size, system.unknowns.len());
        let entry = |i: usize, j: usize| {
            let at = (i, j);
            [system.a[at], system.b[0][at], system.b[1][at], system.c[at]]
                .map(|x| Real256::from(x.value))
        };
        let entries = (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect();
        Self { size, entries }
    }

    /// det(ςA + κ₁B¹ + κ₂B² + C), one coefficient for each power of ς, κ₁, κ₂.
    pub fn polynomial(&self) -> DispersionReference {
        let powers = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]];
        let terms = |i: usize, j: usize| powers.into_iter().zip(self.entries[i][j]).collect();
        DispersionReference::from_symbol(self.size, &terms)
    }

    /// Coefficients of det(ςA + i(k₁B¹ + k₂B²) + C) by ascending powers of ς; leading exact zeros are omitted.
    pub fn coefficients_at_wave(&self, wave: [f64; 2]) -> Vec<Complex256> {
        let wave = wave.map(Real256::from);
        let constant = |i: usize, j: usize| {
            let e = &self.entries[i][j];
            Complex256 { re: e[3], im: wave[0] * e[1] + wave[1] * e[2] }
        };
        let mut result = vec![Complex256::ZERO; self.size + 1];
        expand_leibniz(
            self.size,
            vec![Complex256::from_real(Real256::from(1.0))],
            &|i, j| !(constant(i, j).is_zero() && self.entries[i][j][0].is_zero()),
            &|product: &Vec<Complex256>, i, j| {
                let (a, c) = (self.entries[i][j][0], constant(i, j));
                let mut next = vec![Complex256::ZERO; product.len() + usize::from(!a.is_zero())];
                for (n, &p) in product.iter().enumerate() {
                    if !c.is_zero() {
                        next[n] += p * c;
                    }
                    if !a.is_zero() {
                        next[n + 1] += p.scale(a);
                    }
                }
                next
            },
            &mut |product, negative| {
                for (r, &p) in result.iter_mut().zip(product) {
                    *r += if negative { -p } else { p };
                }
            },
        );
        trim_leading_zeros(&mut result);
        result
    }

    /// Cofactors of ςA + i(k₁B¹ + k₂B²) + C at the value `root` of ς.
    pub fn cofactors(&self, wave: [f64; 2], root: Complex256) -> Vec<Vec<Complex256>> {
        let wave = wave.map(Real256::from);
        let matrix: Vec<Vec<Complex256>> = self
            .entries
            .iter()
            .map(|row| {
                row.iter()
                    .map(|e| {
                        root.scale(e[0])
                            + Complex256 { re: e[3], im: wave[0] * e[1] + wave[1] * e[2] }
                    })
                    .collect()
            })
            .collect();
        let n = self.size;
        (0..n)
            .map(|row| {
                (0..n)
                    .map(|column| {
                        let at = |i: usize, j: usize| {
                            matrix[i + usize::from(i >= row)][j + usize::from(j >= column)]
                        };
                        let mut sum = Complex256::ZERO;
                        expand_leibniz(
                            n - 1,
                            Complex256::from_real(Real256::from(1.0)),
                            &|i, j| !at(i, j).is_zero(),
                            &|&product: &Complex256, i, j| product * at(i, j),
                            &mut |&product, negative| {
                                sum += if negative { -product } else { product };
                            },
                        );
                        if (row + column) % 2 == 1 { -sum } else { sum }
                    })
                    .collect()
            })
            .collect()
    }
}

fn add_term(terms: &mut Vec<Term>, power: [u8; 3], value: Real256) {
    match terms.iter_mut().find(|(own, _)| *own == power) {
        Some((_, own)) => *own += value,
        None => terms.push((power, value)),
    }
}

/// Visits all permutations of the columns without zero entries, with their products and parities (Leibniz's formula).
fn expand_leibniz<P>(
    size: usize,
    initial: P,
    is_nonzero: &dyn Fn(usize, usize) -> bool,
    multiply: &dyn Fn(&P, usize, usize) -> P,
    visit: &mut dyn FnMut(&P, bool),
) {
    fn visit_permutations<P>(
        size: usize,
        chosen: &mut Vec<usize>,
        product: &P,
        is_nonzero: &dyn Fn(usize, usize) -> bool,
        multiply: &dyn Fn(&P, usize, usize) -> P,
        visit: &mut dyn FnMut(&P, bool),
    ) {
        let row = chosen.len();
        if row == size {
            let inversions: usize =
                (0..size).map(|i| (i + 1..size).filter(|&j| chosen[j] < chosen[i]).count()).sum();
            visit(product, inversions % 2 == 1);
            return;
        }
        for column in 0..size {
            if !chosen.contains(&column) && is_nonzero(row, column) {
                let next = multiply(product, row, column);
                chosen.push(column);
                visit_permutations(size, chosen, &next, is_nonzero, multiply, visit);
                chosen.pop();
            }
        }
    }
    visit_permutations(size, &mut Vec::new(), &initial, is_nonzero, multiply, visit);
}

/// Removes leading coefficients that are exactly zero.
pub fn trim_leading_zeros(polynomial: &mut Vec<Complex256>) {
    while polynomial.len() > 1 && polynomial.last().is_some_and(|c| c.is_zero()) {
        polynomial.pop();
    }
}

/// Value and slope of Σ pᵢ xⁱ.
pub fn evaluate_with_derivative(
    polynomial: &[Complex256],
    x: Complex256,
) -> (Complex256, Complex256) {
    let (mut value, mut slope) = (Complex256::ZERO, Complex256::ZERO);
    for &c in polynomial.iter().rev() {
        slope = slope * x + value;
        value = value * x + c;
    }
    (value, slope)
}

/// All roots of Σ pᵢ xⁱ, simple ones to about 60 digits, by the Aberth–Ehrlich method from starting points on circles
/// whose binary logarithms of the radii are the negative slopes of the Newton polygon of log₂ |pᵢ|.
pub fn solve_roots(polynomial: &[Complex256]) -> Vec<Complex256> {
    let zeros = polynomial.iter().take_while(|c| c.is_zero()).count();
    let p = &polynomial[zeros.min(polynomial.len() - 1)..];
    let degree = p.len() - 1;
    let mut computed = vec![Complex256::ZERO; polynomial.len() - p.len()];
    if degree == 0 {
        return computed;
    }
    let logs: Vec<f64> = p.iter().map(|c| c.modulus().log2()).collect();
    let mut x = Vec::with_capacity(degree);
    let mut from = 0;
    while from < degree {
        // The largest slope of log |p| from here is an edge of the Newton polygon.
        let slope = |to: usize| (logs[to] - logs[from]) / (to - from) as f64;
        let to = (from + 1..=degree)
            .fold(from + 1, |best, to| if slope(to) >= slope(best) { to } else { best });
        let radius = -slope(to);
        let whole = radius.floor();
        for n in 0..to - from {
            let turn = std::f64::consts::TAU * n as f64 / (to - from) as f64 + 0.61;
            let start = Complex64::from_polar((radius - whole).exp2(), turn);
            x.push(Complex256::from(start).multiply_by_power_of_two(whole as i64));
        }
        from = to;
    }
    let mut settled = vec![false; degree];
    for _ in 0..400 {
        for i in 0..degree {
            if settled[i] {
                continue;
            }
            let (value, slope) = evaluate_with_derivative(p, x[i]);
            // At a multiple root the value is rounding long before the iterates agree in all bits.
            let size = |(n, c): (usize, &Complex256)| {
                c.exponent().saturating_add(x[i].exponent().saturating_mul(n as i64))
            };
            let largest = p.iter().enumerate().filter(|(_, c)| !c.is_zero()).map(size).max();
            if largest.is_some_and(|own| value.exponent() < own - 240) {
                settled[i] = true;
                continue;
            }
            if value.is_zero() || slope.is_zero() {
                settled[i] = value.is_zero();
                continue;
            }
            let newton = value.ratio(slope);
            let one = Complex256::from_real(Real256::from(1.0));
            let mut denominator = one;
            for j in 0..degree {
                let gap = x[i] - x[j];
                if j != i && !gap.is_zero() {
                    denominator = denominator - newton.ratio(gap);
                }
            }
            let step = if denominator.is_zero() { newton } else { newton.ratio(denominator) };
            x[i] = x[i] - step;
            settled[i] = step.exponent() < x[i].exponent() - 200;
        }
        if settled.iter().all(|s| *s) {
            break;
        }
    }
    computed.extend(x);
    computed
}

/// Pairs the numbers of two lists of equal length, nearest pairs first.
pub fn match_roots<'a>(
    computed: &'a [Complex64],
    exact: &'a [Complex256],
) -> Vec<(&'a Complex64, &'a Complex256)> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, &f) in computed.iter().enumerate() {
        for (j, &w) in exact.iter().enumerate() {
            let size = w.modulus() + Real256::from(f64::MIN_POSITIVE);
            let gap = (Complex256::from(f) - w).modulus() * size.reciprocal();
            pairs.push((gap.to_f64(), i, j));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut left, mut right) = (vec![true; computed.len()], vec![true; exact.len()]);
    let mut result = Vec::new();
    for (_, i, j) in pairs {
        if left[i] && right[j] {
            (left[i], right[j]) = (false, false);
            result.push((&computed[i], &exact[j]));
        }
    }
    result
}

/// Powers of ς, κ₁, κ₂, and their coefficient.
pub type Term = ([u8; 3], Real256);

/// The dispersion polynomial in 256 bits.
#[derive(Clone, Debug)]
pub struct DispersionReference {
    pub terms: Vec<Term>,
}

impl DispersionReference {
    /// Determinant of a square symbol, whose `entry` (i, j) lists powers of ς, κ₁, κ₂ and their coefficients.
    fn from_symbol(size: usize, entry: &dyn Fn(usize, usize) -> Vec<Term>) -> Self {
        let entries: Vec<Vec<Vec<Term>>> = (0..size)
            .map(|i| {
                let present =
                    |j| entry(i, j).into_iter().filter(|term| !term.1.is_zero()).collect();
                (0..size).map(present).collect()
            })
            .collect();
        let mut result = Self { terms: Vec::new() };
        expand_leibniz(
            size,
            vec![([0u8; 3], Real256::from(1.0))],
            &|i, j| !entries[i][j].is_empty(),
            &|product, i, j| {
                let mut next = Vec::with_capacity(2 * product.len());
                for (power, value) in product {
                    for (other, x) in &entries[i][j] {
                        let sum = std::array::from_fn(|n| power[n] + other[n]);
                        add_term(&mut next, sum, *value * *x);
                    }
                }
                next
            },
            &mut |product, negative| {
                for &(power, value) in product {
                    add_term(&mut result.terms, power, if negative { -value } else { value });
                }
            },
        );
        result.terms.retain(|(_, value)| !value.is_zero());
        result
    }

    /// Determinant of the symbol of a square system, terms of higher order included; `velocity` is omitted.
    pub fn from_linearised(system: &LinearisedSystem<2>) -> Self {
        let size = system.equations.len();
        assert_eq!(size, system.unknowns.len());
        Self::from_symbol(size, &|i, j| {
            let at = (i, j);
            let mut terms = vec![
                ([1, 0, 0], system.a[at]),
                ([0, 1, 0], system.b[0][at]),
                ([0, 0, 1], system.b[1][at]),
                ([0, 0, 0], system.c[at]),
            ];
            let higher = system.higher_terms.iter().filter(|term| (term.row, term.column) == at);
            terms.extend(higher.map(|term| {
                let [b, c] = term.space_powers;
                ([term.time_power, b, c], term.coefficient)
            }));
            terms.into_iter().map(|(power, x)| (power, Real256::from(x.value))).collect()
        })
    }

    /// Coefficients by ascending powers of ς at the wave vector k (cos, sin).
    pub fn coefficients_at(&self, k: Real256, cos: Real256, sin: Real256) -> Vec<Complex256> {
        let degree = self.terms.iter().map(|t| t.0[1] + t.0[2]).max().unwrap_or(0);
        let powers = |x: Real256| {
            let mut list = vec![Real256::from(1.0)];
            for n in 0..usize::from(degree) {
                list.push(list[n] * x);
            }
            list
        };
        let (first, second) = (powers(k * cos), powers(k * sin));
        let highest = self.terms.iter().map(|t| t.0[0]).max().unwrap_or(0);
        let mut result = vec![Complex256::ZERO; usize::from(highest) + 1];
        let mut greatest = vec![Real256::ZERO.exponent(); result.len()];
        for &([a, b, c], value) in &self.terms {
            let term = value * first[usize::from(b)] * second[usize::from(c)];
            result[usize::from(a)] +=
                Complex256::from_real(term).multiply_by_i_power(usize::from(b + c));
            let size = value.exponent() + i64::from(b + c) * k.exponent();
            greatest[usize::from(a)] = greatest[usize::from(a)].max(size);
        }
        // Sums below 2⁻²³⁵ of their largest term are rounding errors of the direction in 256 bits.
        for (sum, greatest) in result.iter_mut().zip(greatest) {
            if sum.exponent() < greatest - 235 {
                *sum = Complex256::ZERO;
            }
        }
        trim_leading_zeros(&mut result);
        result
    }

    /// Largest real part of the roots at the wave number `k` and `direction` (rad); −2⁴⁰⁰⁰ without roots.
    pub fn max_growth_rate(&self, k: Real256, direction: Real256) -> Real256 {
        let (sin, cos) = direction.sin_cos();
        solve_roots(&self.coefficients_at(k, cos, sin))
            .into_iter()
            // Real parts below 2⁻¹³⁰ of the imaginary part are rounding errors.
            .map(|z| if z.re.exponent() < z.im.exponent() - 130 { Real256::ZERO } else { z.re })
            .reduce(|a, b| if b > a { b } else { a })
            .unwrap_or(-Real256::from(1.0).multiply_by_power_of_two(4000))
    }

    /// Degree in ς.
    pub fn degree(&self) -> u8 {
        self.terms.iter().map(|t| t.0[0]).max().unwrap_or(0)
    }

    /// Value F_ij(cos θ, sin θ).
    pub fn evaluate_form(&self, i: u8, j: u8, angle: Real256) -> Real256 {
        let (sin, cos) = angle.sin_cos();
        let mut sum = Real256::ZERO;
        for &([a, b, c], value) in &self.terms {
            if a == i && b + c == j {
                let power = |x: Real256, n: u8| (0..n).fold(Real256::from(1.0), |p, _| p * x);
                sum += value * power(cos, b) * power(sin, c);
            }
        }
        sum
    }
}
