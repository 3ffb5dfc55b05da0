//! The exact dispersion polynomial P(ς, κ₁, κ₂) = det L, κ = ik, of the symbol L = ςA + κ₁B¹ + κ₂B² + C plus terms of
//! higher order in ς and κ.
//!
//! Its coefficients are real. The determinant is expanded row by row over subsets of columns (Laplace expansion by
//! dynamic programming) in double-double arithmetic, with a bound on the effect of the rounding of the entries of
//! A, Bⁱ, C on each coefficient.

use crate::AnalysisError;
use crate::direction_polynomial::DirectionPolynomial;
use crate::extended_precision::{ExtendedComplex, ExtendedReal};
use crate::form::BinaryForm;
use crate::list::StackList;
use crate::scaling::ScaledSystem;
use models::common::elementary::Elementary;
use models::common::system::{HigherTerm, Unknown};
use models::{LinearisedSystem, Rounded};
use num_complex::Complex64;
use smallvec::smallvec;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Maximum number n of equations: the expansion takes up to 2ⁿ partial determinants.
pub const MAX_EQUATIONS: usize = 16;

/// Maximum number of coefficients of all partial determinants together (64 MiB); larger systems keep those of two levels
/// at a time.
const MAX_STORED_COEFFICIENTS: usize = 1 << 21;

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
    const ONE: Self = Self {
        value: ExtendedReal { high: 1.0, low: 0.0 },
        entry_error_bound: 0.0,
        expansion_error_bound: 0.0,
    };

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
            let total: u8 = wanted.iter().sum();
            if usize::from(total) > degree { u16::MAX } else { Self::index(wanted) as u16 }
        };
        monomials.product_indices = monomials
            .exponents
            .iter()
            .map(|&[a, b, c]| [find([a + 1, b, c]), find([a, b + 1, c]), find([a, b, c + 1])])
            .collect();
        monomials
    }

    /// Index of a monomial: after those of lower total degree t, by ascending exponent of ς, then of κ₁.
    fn index([a, b, c]: [u8; 3]) -> usize {
        let [a, b, c] = [a, b, c].map(usize::from);
        let total = a + b + c;
        let lower = total * (total + 1) * (total + 2) / 6;
        // Σ (t − a′ + 1) over the exponents a′ < a of ς.
        lower + a * (total + 1) - a * a.saturating_sub(1) / 2 + b
    }

    /// Index of the product of the monomial `index` with another one.
    fn multiply(&self, index: usize, other: [u8; 3]) -> usize {
        let own = self.exponents[index];
        Self::index(std::array::from_fn(|i| own[i] + other[i]))
    }
}

/// Entry of the symbol in one row and column: coefficients of ς, κ₁, κ₂ and 1, and the terms of higher order in
/// [`LinearisedSystem::higher_terms`], which are sorted by row and column.
struct SymbolEntry<'a> {
    linear_form: [Rounded; 4],
    higher_terms: &'a [HigherTerm<2>],
}

impl SymbolEntry<'_> {
    fn is_zero(&self) -> bool {
        self.higher_terms.is_empty() && self.linear_form.iter().all(|x| x.is_structural_zero())
    }

    /// Adds ± `source` × this entry to `target`.
    fn add_product(
        &self,
        monomials: &Monomials,
        source: &[BoundedCoefficient],
        target: &mut [BoundedCoefficient],
        negative: bool,
    ) {
        for (index, coefficient) in source.iter().enumerate() {
            if coefficient.is_structural_zero() {
                continue;
            }
            for (variable, &entry) in self.linear_form.iter().enumerate() {
                if !entry.is_structural_zero() {
                    let to = if variable == 3 {
                        index
                    } else {
                        usize::from(monomials.product_indices[index][variable])
                    };
                    target[to].add_product(coefficient, entry, negative);
                }
            }
            for term in self.higher_terms {
                let [first, second] = term.space_powers;
                let to = monomials.multiply(index, [term.time_power, first, second]);
                target[to].add_product(coefficient, term.coefficient, negative);
            }
        }
    }
}

/// The symbol, read entry by entry.
struct Symbol<'a> {
    system: &'a LinearisedSystem<2>,
    /// Terms of higher order, sorted by row and column.
    higher_terms: StackList<HigherTerm<2>, 16>,
}

impl<'a> Symbol<'a> {
    fn new(system: &'a LinearisedSystem<2>) -> Self {
        let mut higher_terms: StackList<HigherTerm<2>, 16> = StackList::new();
        let is_present = |term: &&HigherTerm<2>| !term.coefficient.is_structural_zero();
        higher_terms.extend(system.higher_terms.iter().filter(is_present).copied());
        higher_terms.sort_by_key(|term| (term.row, term.column));
        Self { system, higher_terms }
    }

    fn entry(&self, row: usize, column: usize) -> SymbolEntry<'_> {
        let (system, at) = (self.system, (row, column));
        let linear_form = [system.a[at], system.b[0][at], system.b[1][at], system.c[at]];
        if self.higher_terms.is_empty() {
            return SymbolEntry { linear_form, higher_terms: &[] };
        }
        let start = self.higher_terms.partition_point(|term| (term.row, term.column) < at);
        let count =
            self.higher_terms[start..].partition_point(|term| (term.row, term.column) == at);
        SymbolEntry { linear_form, higher_terms: &self.higher_terms[start..start + count] }
    }

    /// Largest total degree of the entries in `row`, at least 1.
    fn degree(&self, row: usize) -> usize {
        let own = self.higher_terms.iter().filter(|term| term.row == row);
        own.map(|term| usize::from(term.time_power + term.wave_number_power())).max().unwrap_or(1)
    }
}

/// The exact dispersion polynomial of a square system, in the units of its [`ScaledSystem`].
#[derive(Clone, Debug, Default)]
pub struct DispersionPolynomial {
    /// Number of equations.
    size: usize,
    /// Bound on the total degree in ς and κ.
    degree: usize,
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
    forms: Vec<DispersionTerm>,
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
        let symbol = Symbol::new(system);

        // Rows with the fewest entries first keep the partial determinants sparse.
        let entries = |row: usize| (0..n).filter(|&c| !symbol.entry(row, c).is_zero()).count();
        self.row_order.clear();
        self.row_order.extend(0..n);
        self.row_order.sort_by_key(|&row| entries(row));

        let degree = (0..n).map(|row| symbol.degree(row)).sum();
        if self.degree != degree || self.monomials.exponents.is_empty() {
            self.monomials = Monomials::new(degree);
        }
        (self.size, self.degree) = (n, degree);
        if self.monomials.exponents.len() << n > MAX_STORED_COEFFICIENTS {
            self.expand_by_levels(&symbol);
        } else {
            self.expand(&symbol);
        }
        self.collect_forms();
        Ok(())
    }

    /// Expands the determinant with the partial determinants of all sets of columns in memory.
    fn expand(&mut self, symbol: &Symbol) {
        let n = self.size;
        let block = self.monomials.exponents.len();
        self.partial_determinants.resize(block << n, BoundedCoefficient::default());
        self.is_subset_reached.clear();
        self.is_subset_reached.resize(1 << n, false);
        self.partial_determinants[..block].fill(BoundedCoefficient::default());
        self.is_subset_reached[0] = true;
        // Clear the block of the full determinant here, since the expansion may not reach it.
        self.partial_determinants[((1 << n) - 1) * block..].fill(BoundedCoefficient::default());
        self.partial_determinants[0] = BoundedCoefficient::ONE;
        let degrees = self.partial_degrees(symbol);
        for set in 0usize..(1 << n) - 1 {
            if !self.is_subset_reached[set] {
                continue;
            }
            let used = set.count_ones() as usize;
            let row = self.row_order[used];
            let (before, after) = self.partial_determinants.split_at_mut((set + 1) * block);
            let source = &before[set * block..][..self.monomials.count_up_to_degree[degrees[used]]];
            if source.iter().all(BoundedCoefficient::is_structural_zero) {
                continue;
            }
            for column in (0..n).filter(|c| set >> c & 1 == 0) {
                let entry = symbol.entry(row, column);
                if entry.is_zero() {
                    continue;
                }
                let with = set | 1 << column;
                let target = &mut after[(with - set - 1) * block..][..block];
                if !self.is_subset_reached[with] {
                    self.is_subset_reached[with] = true;
                    target[..self.monomials.count_up_to_degree[degrees[used + 1]]]
                        .fill(BoundedCoefficient::default());
                }
                entry.add_product(&self.monomials, source, target, has_odd_parity(set, column));
            }
        }
    }

    /// Expands the determinant with the partial determinants of the sets of columns of one size in memory at a time,
    /// those of the next size being computed; only sets with a transversal are stored.
    fn expand_by_levels(&mut self, symbol: &Symbol) {
        let n = self.size;
        let degrees = self.partial_degrees(symbol);
        let mut level = BTreeMap::from([(0usize, vec![BoundedCoefficient::ONE])]);
        for used in 0..n {
            let row = self.row_order[used];
            let count = self.monomials.count_up_to_degree[degrees[used + 1]];
            let mut next: BTreeMap<usize, Vec<BoundedCoefficient>> = BTreeMap::new();
            for (set, source) in level {
                for column in (0..n).filter(|c| set >> c & 1 == 0) {
                    let entry = symbol.entry(row, column);
                    if entry.is_zero() {
                        continue;
                    }
                    let target = next
                        .entry(set | 1 << column)
                        .or_insert_with(|| vec![BoundedCoefficient::default(); count]);
                    let negative = has_odd_parity(set, column);
                    entry.add_product(&self.monomials, &source, target, negative);
                }
            }
            level = next;
        }
        let whole = level.into_values().next();
        let count = self.monomials.exponents.len();
        self.partial_determinants =
            whole.unwrap_or_else(|| vec![BoundedCoefficient::default(); count]);
    }

    /// Bounds on the total degrees of the partial determinants of the first 0, 1, … rows in the order of expansion.
    fn partial_degrees(&self, symbol: &Symbol) -> StackList<usize, 17> {
        let mut degrees: StackList<usize, 17> = smallvec![0];
        for &row in &self.row_order {
            degrees.push(degrees[degrees.len() - 1] + symbol.degree(row));
        }
        degrees
    }

    /// Monomials and coefficients of the full determinant.
    fn coefficients(&self) -> impl Iterator<Item = ([u8; 3], &BoundedCoefficient)> {
        let block = self.monomials.exponents.len();
        let whole = &self.partial_determinants[self.partial_determinants.len() - block..];
        self.monomials.exponents.iter().copied().zip(whole)
    }

    /// The binary forms F_ij(κ₁, κ₂) of P = Σ ςⁱ F_ij, of degree j, in scaled units; only those
    /// with a coefficient that is not a structural zero.
    pub fn forms(&self) -> &[DispersionTerm] {
        &self.forms
    }

    fn collect_forms(&mut self) {
        let mut terms = std::mem::take(&mut self.forms);
        terms.clear();
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
        self.forms = terms;
    }

    /// Restricts the polynomial to the wave vectors along `direction` (rad).
    pub fn along(&self, direction: f64) -> DirectionPolynomial {
        let (sin, cos) = direction.cr_sin_cos();
        let powers = |x: f64| {
            let mut list: StackList<ExtendedReal> = smallvec![ExtendedReal::from(1.0)];
            for i in 0..self.degree {
                list.push(list[i] * ExtendedReal::from(x));
            }
            list
        };
        let (first, second) = (powers(cos), powers(sin));
        let coefficients = self.coefficients().filter(|(_, own)| !own.is_structural_zero());
        let terms = coefficients.map(|([a, b, c], own)| {
            let factor = first[usize::from(b)] * second[usize::from(c)];
            let bound = own.total_error_bound() * factor.high.abs();
            ([a, b + c], own.value * factor, bound)
        });
        let velocity = self.velocity[0] * cos + self.velocity[1] * sin;
        DirectionPolynomial::new(terms, velocity, [self.rate_unit, self.wave_number_unit])
    }

    /// [`DirectionPolynomial::coefficients_at`] the wave number `k` (1/m) along `direction` (rad).
    pub fn coefficients_at(&self, k: f64, direction: f64) -> StackList<ExtendedComplex> {
        self.along(direction).coefficients_at(k)
    }

    /// [`DirectionPolynomial::roots`] at the wave number `k` (1/m) along `direction` (rad).
    pub fn roots(&self, k: f64, direction: f64, guesses: &[Complex64]) -> StackList<Complex64> {
        self.along(direction).roots(k, guesses)
    }
}

/// Laplace sign of adding `column` to the columns of `set`: whether the number of those to its right is odd.
fn has_odd_parity(set: usize, column: usize) -> bool {
    (set >> column).count_ones() % 2 == 1
}

/// Reusable memory of [`block_determinant`] for blocks of one size.
#[derive(Default)]
struct BlockWorkspace {
    system: LinearisedSystem<2>,
    scaled: ScaledSystem,
    polynomial: DispersionPolynomial,
}

/// Dispersion polynomial of a square block if it is one term ςⁱ F(κ₁, κ₂): the form F, in scaled units, so that it is
/// multiplied by some positive factor; `entry` (i, j) returns the coefficients of A, B¹, B², C; `is_scaled`: these are
/// finite and of comparable size, else they are scaled. `None` if a coefficient is not finite, if the block is too large, or if the
/// polynomial has no or several terms.
pub(crate) fn block_determinant(
    size: usize,
    is_scaled: bool,
    entry: impl Fn(usize, usize) -> [Rounded; 4],
) -> Option<BinaryForm> {
    const UNKNOWNS: [Unknown; MAX_EQUATIONS] = [Unknown { name: "", family: "" }; MAX_EQUATIONS];
    const EQUATIONS: [&str; MAX_EQUATIONS] = [""; MAX_EQUATIONS];
    thread_local! {
        static BLOCK_WORKSPACES: RefCell<[BlockWorkspace; MAX_EQUATIONS + 1]> = RefCell::default();
    }
    BLOCK_WORKSPACES.with_borrow_mut(|blocks| {
        let BlockWorkspace { system, scaled, polynomial } = blocks.get_mut(size)?;
        let target = if is_scaled { &mut scaled.system } else { &mut *system };
        target.reset(UNKNOWNS.get(..size)?, EQUATIONS.get(..size)?, [0.0; 2]);
        for i in 0..size {
            for j in 0..size {
                let at = (i, j);
                let [first, second] = &mut target.b;
                [target.a[at], first[at], second[at], target.c[at]] = entry(i, j);
            }
        }
        if !is_scaled {
            scaled.update(system).ok()?;
        }
        polynomial.update(scaled).ok()?;
        match polynomial.forms() {
            [only] => Some(only.form.clone()),
            _ => None,
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The expansion that keeps two levels of partial determinants equals that which keeps all, for a full system with
    /// terms of higher order.
    #[test]
    fn expansion_by_levels_equals_the_full_expansion() {
        const SIZE: usize = 5;
        const UNKNOWNS: [Unknown; SIZE] = [Unknown { name: "", family: "" }; SIZE];
        let mut scaled = ScaledSystem::default();
        (scaled.rate_unit, scaled.wave_number_unit) = (1.0, 1.0);
        scaled.system.reset(&UNKNOWNS, &[""; SIZE], [0.0; 2]);
        let mut state = 1u32;
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            Rounded::from_rounded(f64::from(state >> 8) / f64::from(1 << 23) - 1.0)
        };
        for row in 0..SIZE {
            for column in 0..SIZE {
                let at = (row, column);
                let [first, second] = &mut scaled.system.b;
                for own in [&mut scaled.system.a, first, second, &mut scaled.system.c] {
                    own[at] = draw();
                }
                if (row + column) % 3 == 0 {
                    let powers = [[2, 0, 0], [0, 1, 1], [1, 0, 3]];
                    for [time_power, first, second] in powers {
                        let (space_powers, coefficient) = ([first, second], draw());
                        scaled.system.higher_terms.push(HigherTerm {
                            row,
                            column,
                            time_power,
                            space_powers,
                            coefficient,
                        });
                    }
                }
            }
        }
        let mut full = DispersionPolynomial::default();
        full.update(&scaled).expect("small");
        let mut levels = full.clone();
        levels.expand_by_levels(&Symbol::new(&scaled.system));
        let mut count = 0;
        for ((own, a), (other, b)) in full.coefficients().zip(levels.coefficients()) {
            assert_eq!(own, other);
            assert_eq!((a.value, a.entry_error_bound), (b.value, b.entry_error_bound), "{own:?}");
            count += usize::from(a.value.high != 0.0);
        }
        assert!(count > 200, "{count} coefficients");
    }

    /// The determinant of a block of two rows against (a₁κ₁ + a₂κ₂)(d₁κ₁ + d₂κ₂) − (b₁κ₁ + b₂κ₂)(c₁κ₁ + c₂κ₂), without
    /// and with scaling, which multiplies it by a positive factor.
    #[test]
    fn determinant_of_a_block_is_that_of_its_entries() {
        let entries = [[[3.0, 1.0], [-2.0, 5.0]], [[0.5, 4.0], [7.0, -1.0]]];
        let [[a, b], [c, d]] = entries;
        let wanted = [
            a[0] * d[0] - b[0] * c[0],
            a[0] * d[1] + a[1] * d[0] - b[0] * c[1] - b[1] * c[0],
            a[1] * d[1] - b[1] * c[1],
        ];
        for is_scaled in [true, false] {
            let entry = |i: usize, j: usize| {
                let [first, second] = entries[i][j].map(Rounded::from_exact);
                [Rounded::ZERO, first, second, Rounded::ZERO]
            };
            let form = block_determinant(2, is_scaled, entry).expect("one term");
            let factor = form.coefficients[0].value / wanted[0];
            assert!(factor > 0.0 && (factor == 1.0 || !is_scaled), "{factor}");
            for (own, wanted) in form.coefficients.iter().zip(wanted) {
                assert!((own.value - factor * wanted).abs() <= own.bound + 1e-15 * factor);
            }
        }
    }

    #[test]
    fn indices_of_monomials_are_their_places() {
        let monomials = Monomials::new(7);
        for (index, &exponents) in monomials.exponents.iter().enumerate() {
            assert_eq!(Monomials::index(exponents), index, "{exponents:?}");
        }
    }
}
