//! The exact dispersion polynomial P(ς, κ₁, κ₂) = det(ςA + κ₁B¹ + κ₂B² + C), κ = ik.
//!
//! Its coefficients are real. The determinant is expanded row by row over subsets of columns (Laplace expansion by
//! dynamic programming) in double-double arithmetic, with a bound on the effect of the rounding of the entries of
//! A, Bⁱ, C on each coefficient.

use crate::extended_precision::{ExtendedComplex, ExtendedReal};
use crate::form::BinaryForm;
use crate::list::StackList;
use crate::scaling::ScaledSystem;
use crate::{AnalysisError, roots};
use models::common::elementary::Elementary;
use models::common::system::Unknown;
use models::{LinearisedSystem, Rounded};
use num_complex::Complex64;
use std::cell::RefCell;

/// Maximum number n of equations: the expansion takes 2ⁿ partial determinants.
pub const MAX_EQUATIONS: usize = 10;

/// A coefficient of the polynomial with bounds on its error.
#[derive(Clone, Copy, Debug, Default)]
struct BoundedCoefficient {
    /// Coefficient of the determinant of the stored entries, in double-double precision.
    value: ExtendedReal,
    /// Error bound due to the rounding bounds of the entries.
    entry_error_bound: f64,
    /// Error bound due to rounding in the expansion itself.
    expansion_error_bound: f64,
}

/// Upper bound on the relative error of a double-double product and sum.
const EXTENDED_ROUNDOFF: f64 = 1e-30;

impl BoundedCoefficient {
    /// Error bound from the entries and from the expansion.
    fn total_error_bound(&self) -> f64 {
        self.entry_error_bound * 1.000_001 + self.expansion_error_bound
    }

    /// Whether the coefficient is exactly zero, also by exact cancellation of exact entries.
    fn is_structural_zero(&self) -> bool {
        self.value.high == 0.0 && self.entry_error_bound == 0.0
    }

    /// Adds ± `other` × `entry`, with error bounds.
    fn add_product(&mut self, other: &Self, entry: Rounded, negative: bool) {
        let factor = ExtendedReal::from(if negative { -entry.value } else { entry.value });
        self.value = self.value + other.value * factor;
        self.entry_error_bound += other.value.high.abs() * entry.bound
            + entry.value.abs() * other.entry_error_bound
            + entry.bound * other.entry_error_bound;
        self.expansion_error_bound += entry.value.abs()
            * (other.expansion_error_bound + EXTENDED_ROUNDOFF * other.value.high.abs());
    }
}

/// Monomials ς^a κ₁^b κ₂^c up to a total degree, by ascending total degree.
#[derive(Clone, Debug, Default)]
struct Monomials {
    exponents: Vec<[u8; 3]>,
    /// Index of the product of each monomial with ς, κ₁, κ₂; `u16::MAX` if its total degree is too high.
    product_indices: Vec<[u16; 3]>,
    /// Entry d is the number of monomials of total degree ≤ d.
    count_up_to_degree: Vec<usize>,
}

impl Monomials {
    fn new(degree: usize) -> Self {
        let mut monomials = Self::default();
        for total in 0..=degree {
            for a in 0..=total {
                for b in 0..=total - a {
                    monomials.exponents.push([a as u8, b as u8, (total - a - b) as u8]);
                }
            }
            monomials.count_up_to_degree.push(monomials.exponents.len());
        }
        let find = |wanted: [u8; 3]| {
            let index = monomials.exponents.iter().position(|&e| e == wanted);
            index.map_or(u16::MAX, |i| i as u16)
        };
        monomials.product_indices = monomials
            .exponents
            .iter()
            .map(|&[a, b, c]| [find([a + 1, b, c]), find([a, b + 1, c]), find([a, b, c + 1])])
            .collect();
        monomials
    }
}

/// The exact dispersion polynomial of a square system, in the units of its [`ScaledSystem`].
#[derive(Clone, Debug, Default)]
pub struct DispersionPolynomial {
    size: usize,
    monomials: Monomials,
    /// Partial determinants, one block of coefficients per set of columns; the last block is the full determinant.
    partial_determinants: Vec<BoundedCoefficient>,
    /// Whether a subset of columns has a transversal in the rows used so far.
    is_subset_reached: Vec<bool>,
    /// Rows in the order of expansion.
    row_order: Vec<usize>,
    /// Unit of ς, 1/s.
    pub rate_unit: f64,
    /// Unit of k, 1/m.
    pub wave_number_unit: f64,
    velocity: [f64; 2],
}

impl DispersionPolynomial {
    /// Expands the determinant of a square scaled system into `self`, reusing its memory.
    ///
    /// # Errors
    /// [`AnalysisError::TooLarge`] beyond [`MAX_EQUATIONS`] equations.
    pub fn update(&mut self, scaled: &ScaledSystem) -> Result<(), AnalysisError> {
        let system = &scaled.system;
        let n = system.equations.len();
        if n > MAX_EQUATIONS {
            return Err(AnalysisError::TooLarge(n));
        }
        (self.rate_unit, self.wave_number_unit, self.velocity) =
            (scaled.rate_unit, scaled.wave_number_unit, system.velocity);
        if self.size != n || self.monomials.exponents.is_empty() {
            self.size = n;
            self.monomials = Monomials::new(n);
        }
        let block = self.monomials.exponents.len();
        self.partial_determinants.resize(block << n, BoundedCoefficient::default());
        self.is_subset_reached.clear();
        self.is_subset_reached.resize(1 << n, false);

        // Rows with the fewest entries first keep the partial determinants sparse.
        let linear_form = |row: usize, column: usize| {
            let at = (row, column);
            [system.a[at], system.b[0][at], system.b[1][at], system.c[at]]
        };
        let entries = |row: usize| {
            (0..n).filter(|&c| linear_form(row, c).iter().any(|x| !x.is_structural_zero())).count()
        };
        self.row_order.clear();
        self.row_order.extend(0..n);
        self.row_order.sort_by_key(|&row| entries(row));

        self.partial_determinants[..block].fill(BoundedCoefficient::default());
        self.is_subset_reached[0] = true;
        // Clear the block of the full determinant here, since the expansion may not reach it.
        self.partial_determinants[((1 << n) - 1) * block..].fill(BoundedCoefficient::default());
        self.partial_determinants[0] =
            BoundedCoefficient { value: ExtendedReal::from(1.0), ..BoundedCoefficient::default() };
        for set in 0usize..(1 << n) - 1 {
            if !self.is_subset_reached[set] {
                continue;
            }
            let used = set.count_ones() as usize;
            let row = self.row_order[used];
            let (before, after) = self.partial_determinants.split_at_mut((set + 1) * block);
            let source = &before[set * block..][..self.monomials.count_up_to_degree[used]];
            if source.iter().all(BoundedCoefficient::is_structural_zero) {
                continue;
            }
            for column in (0..n).filter(|c| set >> c & 1 == 0) {
                let form = linear_form(row, column);
                if form.iter().all(|x| x.is_structural_zero()) {
                    continue;
                }
                // Laplace sign: parity of the number of columns of the set to the right of `column`.
                let negative = (set >> column).count_ones() % 2 == 1;
                let with = set | 1 << column;
                let target = &mut after[(with - set - 1) * block..][..block];
                if !self.is_subset_reached[with] {
                    self.is_subset_reached[with] = true;
                    target[..self.monomials.count_up_to_degree[used + 1]]
                        .fill(BoundedCoefficient::default());
                }
                for (index, coefficient) in source.iter().enumerate() {
                    if coefficient.is_structural_zero() {
                        continue;
                    }
                    for (variable, &entry) in form.iter().enumerate() {
                        if !entry.is_structural_zero() {
                            let to = if variable == 3 {
                                index
                            } else {
                                usize::from(self.monomials.product_indices[index][variable])
                            };
                            target[to].add_product(coefficient, entry, negative);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Monomials and coefficients of the full determinant.
    fn coefficients(&self) -> impl Iterator<Item = ([u8; 3], &BoundedCoefficient)> {
        let block = self.monomials.exponents.len();
        let whole = &self.partial_determinants[self.partial_determinants.len() - block..];
        self.monomials.exponents.iter().copied().zip(whole)
    }

    /// The binary forms F_ij(κ₁, κ₂) of P = Σ ςⁱ F_ij, of degree j, in scaled units; only those
    /// with a coefficient that is not a structural zero.
    pub fn forms(&self) -> StackList<DispersionTerm, 24> {
        let mut terms: StackList<DispersionTerm, 24> = StackList::new();
        for ([a, b, c], coefficient) in self.coefficients() {
            if coefficient.is_structural_zero() {
                continue;
            }
            let (time, space) = (usize::from(a), usize::from(b + c));
            let index = terms
                .iter()
                .position(|t| t.time_power == time && t.form.degree() == space)
                .unwrap_or_else(|| {
                    terms.push(DispersionTerm {
                        time_power: time,
                        form: BinaryForm::new_zero(space),
                    });
                    terms.len() - 1
                });
            let value = coefficient.value.high;
            terms[index].form.coefficients[usize::from(c)] = Rounded {
                value,
                bound: coefficient.total_error_bound() + coefficient.value.low.abs() * 1.000_001,
            };
        }
        terms
    }

    /// Coefficients, in scaled units, of the powers of ς + ik·V (the root in the frame of the material) at the wave
    /// vector k = `k` (cos θ, sin θ), by ascending power. Leading coefficients that are zero within their rounding
    /// bound are omitted (but for the last one left), so the degree is the number of finite roots.
    pub fn coefficients_at(&self, k: f64, direction: f64) -> Vec<ExtendedComplex> {
        let (sin, cos) = direction.cr_sin_cos();
        let k_scaled = k / self.wave_number_unit;
        let powers = |x: f64| {
            let mut list = vec![ExtendedReal::from(1.0)];
            for i in 0..self.size {
                list.push(list[i] * ExtendedReal::from(x));
            }
            list
        };
        // Powers of the doubles k̂ cos θ, k̂ sin θ in twice the working precision.
        let (first, second) = (powers(k_scaled * cos), powers(k_scaled * sin));
        let mut result = vec![ExtendedComplex::default(); self.size + 1];
        let mut bounds = vec![0.0f64; self.size + 1];
        for ([a, b, c], coefficient) in self.coefficients() {
            if coefficient.is_structural_zero() {
                continue;
            }
            let (a, b, c) = (usize::from(a), usize::from(b), usize::from(c));
            let factor = first[b] * second[c];
            let term = coefficient.value * factor;
            bounds[a] += coefficient.total_error_bound() * factor.high.abs();
            let slot = &mut result[a];
            // Factor i^(b+c) of κ₁^b κ₂^c, since κ = ik.
            match (b + c) % 4 {
                0 => slot.re = slot.re + term,
                1 => slot.im = slot.im + term,
                2 => slot.re = slot.re + -term,
                _ => slot.im = slot.im + -term,
            }
        }
        while let (Some(top), Some(bound)) = (result.last(), bounds.last()) {
            if top.re.high.abs().max(top.im.high.abs()) > *bound || result.len() == 1 {
                break;
            }
            result.pop();
            bounds.pop();
        }
        result
    }

    /// All finite roots ς, 1/s, at the wave vector of magnitude `k` (1/m) and `direction` (rad), by the Aberth–Ehrlich
    /// method on the exact polynomial. The `guesses` (1/s) are used as starting points if there is one per root.
    pub fn roots(&self, k: f64, direction: f64, guesses: &[Complex64]) -> Vec<Complex64> {
        let coefficients = self.coefficients_at(k, direction);
        let (sin, cos) = direction.cr_sin_cos();
        let convection =
            Complex64::new(0.0, -k * (self.velocity[0] * cos + self.velocity[1] * sin));
        let guesses: Vec<_> = guesses.iter().map(|g| (g - convection) / self.rate_unit).collect();
        roots::solve_extended(&coefficients, &guesses)
            .into_iter()
            .map(|root| root * self.rate_unit + convection)
            .collect()
    }
}

/// Reusable memory of [`block_determinant`] for blocks of one size.
#[derive(Default)]
struct BlockWorkspace {
    system: LinearisedSystem<2>,
    scaled: ScaledSystem,
    polynomial: DispersionPolynomial,
}

/// Dispersion polynomial of a square block, in scaled units, so that each term is multiplied by some positive factor;
/// `entry` (i, j) returns the coefficients of A, B¹, B², C. `None` if a coefficient is not finite or the block is too
/// large.
pub(crate) fn block_determinant(
    size: usize,
    entry: impl Fn(usize, usize) -> [Rounded; 4],
) -> Option<StackList<DispersionTerm, 24>> {
    const UNKNOWNS: [Unknown; MAX_EQUATIONS] = [Unknown { name: "", family: "" }; MAX_EQUATIONS];
    const EQUATIONS: [&str; MAX_EQUATIONS] = [""; MAX_EQUATIONS];
    thread_local! {
        static BLOCK_WORKSPACES: RefCell<[BlockWorkspace; MAX_EQUATIONS + 1]> = RefCell::default();
    }
    BLOCK_WORKSPACES.with_borrow_mut(|blocks| {
        let BlockWorkspace { system, scaled, polynomial } = blocks.get_mut(size)?;
        system.reset(UNKNOWNS.get(..size)?, EQUATIONS.get(..size)?, [0.0; 2]);
        for i in 0..size {
            for j in 0..size {
                let at = (i, j);
                let [first, second] = &mut system.b;
                [system.a[at], first[at], second[at], system.c[at]] = entry(i, j);
            }
        }
        scaled.update(system).ok()?;
        polynomial.update(scaled).ok()?;
        Some(polynomial.forms())
    })
}

/// A term ςⁱ F(κ₁, κ₂) of the dispersion polynomial.
#[derive(Clone, Debug)]
pub struct DispersionTerm {
    /// Exponent i of ς.
    pub time_power: usize,
    /// Binary form F of degree j.
    pub form: BinaryForm,
}
