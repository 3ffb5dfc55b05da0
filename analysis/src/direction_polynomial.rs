//! The exact dispersion polynomial along a direction of the wave vector: a polynomial in the frequency and the wave number.

use crate::extended_precision::{ExtendedComplex, ExtendedReal};
use crate::list::{StackList, list};
use crate::roots;
use models::common::elementary::Modulus;
use num_complex::Complex64;

/// Factor by which the polynomial must exceed its rounding bound for growth to be certain: the direction is rounded too.
const ROUNDING_MARGIN: f64 = 16.0;

/// The dispersion polynomial Σ ςⁱ (ik)^j f_ij along a direction, in scaled units.
#[derive(Clone, Debug)]
pub struct DirectionPolynomial {
    /// The coefficients f_ij that are not structurally zero: i and j, value, and bound on its error.
    terms: StackList<([u8; 2], ExtendedReal, f64), 12>,
    /// Degree in ς.
    time_degree: usize,
    /// Degree in k.
    space_degree: usize,
    /// Component of the velocity of the material along the direction, m/s.
    velocity: f64,
    /// Unit of ς, 1/s.
    rate_unit: f64,
    /// Unit of k, 1/m.
    wave_number_unit: f64,
}

impl DirectionPolynomial {
    /// Sums the `terms` (i and j, value, and bound on its error); `velocity`: that of the material along the direction, m/s;
    /// units: of ς, 1/s, and of k, 1/m.
    pub(crate) fn new(
        terms: impl Iterator<Item = ([u8; 2], ExtendedReal, f64)>,
        velocity: f64,
        [rate_unit, wave_number_unit]: [f64; 2],
    ) -> Self {
        let mut own = Self {
            terms: StackList::new(),
            time_degree: 0,
            space_degree: 0,
            velocity,
            rate_unit,
            wave_number_unit,
        };
        for (powers, value, bound) in terms {
            own.time_degree = own.time_degree.max(usize::from(powers[0]));
            own.space_degree = own.space_degree.max(usize::from(powers[1]));
            match own.terms.iter_mut().find(|term| term.0 == powers) {
                Some(sum) => (sum.1, sum.2) = (sum.1 + value, sum.2 + bound),
                None => own.terms.push((powers, value, bound)),
            }
        }
        own
    }

    /// Coefficients, in scaled units, of the powers of ς + ik·V (the root in the frame of the material) at the wave number
    /// `k` (1/m), by ascending power. Leading coefficients that are zero within their rounding bound are omitted (but for
    /// the last one left), so the degree is the number of finite roots.
    pub fn coefficients_at(&self, k: f64) -> StackList<ExtendedComplex> {
        self.bounded_coefficients_at(k).0
    }

    /// The [`coefficients_at`](Self::coefficients_at) a wave number, and bounds on their errors.
    fn bounded_coefficients_at(&self, k: f64) -> (StackList<ExtendedComplex>, StackList<f64>) {
        let scaled = k / self.wave_number_unit;
        let mut powers: StackList<ExtendedReal> = list![ExtendedReal::from(1.0)];
        for power in 0..self.space_degree {
            powers.push(powers[power] * scaled);
        }
        let mut values = list![ExtendedComplex::default(); self.time_degree + 1];
        let mut bounds = list![0.0f64; self.time_degree + 1];
        for &(powers_of_term, coefficient, bound) in &self.terms {
            let [time_power, space_power] = powers_of_term.map(usize::from);
            let term = coefficient * powers[space_power];
            bounds[time_power] += bound * powers[space_power].high;
            let sum = &mut values[time_power];
            // Factor i^j.
            match space_power % 4 {
                0 => sum.re = sum.re + term,
                1 => sum.im = sum.im + term,
                2 => sum.re = sum.re + -term,
                _ => sum.im = sum.im + -term,
            }
        }
        while let (Some(top), Some(bound)) = (values.last(), bounds.last()) {
            if top.re.high.abs().max(top.im.high.abs()) > *bound || values.len() == 1 {
                break;
            }
            values.pop();
            bounds.pop();
        }
        (values, bounds)
    }

    /// Largest Re ς, 1/s, at the wave number `k` (1/m) among the roots whose growth is certain: the polynomial differs from
    /// zero by more than its rounding bound at the point of the imaginary axis beside the root. 0 without such a root.
    pub(crate) fn certain_growth_rate(&self, k: f64) -> f64 {
        self.largest_growth_rate(k, |coefficients, bounds, root| {
            let beside = Complex64::new(0.0, root.im);
            let (value, _) = roots::evaluate_extended(coefficients, beside);
            let bound = bounds.iter().rev().fold(0.0, |sum, own| sum * root.im.abs() + own);
            value.modulus() > ROUNDING_MARGIN * bound
        })
    }

    /// Largest Re ς, 1/s, at the wave number `k` (1/m) among the roots whose real part exceeds the effect of rounding, by
    /// the derivative of the polynomial at the root; 0 without such a root.
    pub(crate) fn growth_rate_beyond_rounding(&self, k: f64) -> f64 {
        self.largest_growth_rate(k, |coefficients, bounds, root| {
            let (_, slope) = roots::evaluate_extended(coefficients, root);
            let bound = bounds.iter().rev().fold(0.0, |sum, own| sum * root.modulus() + own);
            let error = bound + f64::EPSILON * root.modulus() * slope.modulus();
            root.re * slope.modulus() > ROUNDING_MARGIN * error
        })
    }

    /// Largest positive Re ς, 1/s, at the wave number `k` (1/m) among the roots that are certain by the coefficients, the
    /// bounds on their errors, and the root in scaled units; 0 without such a root.
    fn largest_growth_rate(
        &self,
        k: f64,
        is_certain: impl Fn(&[ExtendedComplex], &[f64], Complex64) -> bool,
    ) -> f64 {
        let (coefficients, bounds) = self.bounded_coefficients_at(k);
        let roots = roots::solve_extended(&coefficients, &[]);
        let growing = roots
            .into_iter()
            .filter(|root| root.re > 0.0 && is_certain(&coefficients, &bounds, *root));
        growing.fold(0.0, |largest: f64, root| largest.max(root.re)) * self.rate_unit
    }

    /// All finite roots ς + ik·V (in the frame of the material), in scaled units, at the wave number `k` (1/m), by the
    /// Aberth–Ehrlich method on the exact polynomial. The `guesses` are used as starting points if there is one per root.
    pub(crate) fn scaled_roots(&self, k: f64, guesses: &[Complex64]) -> StackList<Complex64> {
        roots::solve_extended(&self.coefficients_at(k), guesses)
    }

    /// Largest Re ς, 1/s, among [`scaled_roots`](Self::scaled_roots); −∞ without roots.
    pub(crate) fn largest_real_part(&self, scaled_roots: &[Complex64]) -> f64 {
        let largest = scaled_roots.iter().map(|root| root.re).fold(f64::NEG_INFINITY, f64::max);
        largest * self.rate_unit
    }

    /// Largest Re ς, 1/s, at the wave number `k` (1/m); −∞ without roots.
    pub(crate) fn growth_rate(&self, k: f64) -> f64 {
        self.largest_real_part(&self.scaled_roots(k, &[]))
    }

    /// All finite roots ς, 1/s, at the wave number `k` (1/m), by the Aberth–Ehrlich method on the exact polynomial. The
    /// `guesses` (1/s) are used as starting points if there is one per root.
    pub fn roots(&self, k: f64, guesses: &[Complex64]) -> StackList<Complex64> {
        let convection = Complex64::new(0.0, -k * self.velocity);
        let guesses: StackList<Complex64> =
            guesses.iter().map(|guess| (guess - convection) / self.rate_unit).collect();
        let mut roots = self.scaled_roots(k, &guesses);
        for root in &mut roots {
            *root = *root * self.rate_unit + convection;
        }
        roots
    }
}
