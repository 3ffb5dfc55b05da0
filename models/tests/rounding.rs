//! `Rounded` against arithmetic of 31 digits: the bounds cover the errors, and bounds of simple expressions are not far
//! too large.

use crate::support::{DifferentiableReal, DoubleDouble, RandomNumbers, dd};
use wellposed_models::Rounded;
use wellposed_models::common::rounding::UNIT_ROUNDOFF;

/// A rounded number, its exact value with 31 digits, and the largest magnitude of an intermediate result, which scales
/// the error of the 31-digit arithmetic.
#[derive(Clone, Copy)]
struct TrackedNumber {
    rounded: Rounded,
    exact_value: DoubleDouble,
    magnitude: f64,
}

impl TrackedNumber {
    /// Creates a random number whose value is exact, or whose exact value is inside or at an end of the interval of one
    /// rounding error u·|value| about the value, with the unit roundoff u.
    fn new_random(random: &mut RandomNumbers) -> Self {
        let value =
            random.signed_uniform(1.0, 10.0) * 10f64.powi(random.uniform_index(7) as i32 - 3);
        Self::new_rounded(random, value)
    }

    fn new_rounded(random: &mut RandomNumbers, value: f64) -> Self {
        let (rounded, shift) = match random.uniform_index(4) {
            0 => (Rounded::from_exact(value), 0.0),
            1 => (Rounded::from_rounded(value), random.uniform(-1.0, 1.0)),
            2 => (Rounded::from(value), 1.0),
            _ => (Rounded::from_rounded(value), -1.0),
        };
        let exact = dd(value) + dd(value) * dd(shift * UNIT_ROUNDOFF);
        Self { rounded, exact_value: exact, magnitude: value.abs() }
    }

    fn error(&self) -> f64 {
        (dd(self.rounded.value) - self.exact_value).to_f64().abs()
    }

    fn from_result(rounded: Rounded, exact: DoubleDouble, sizes: f64) -> Self {
        Self { rounded, exact_value: exact, magnitude: sizes.max(exact.to_f64().abs()) }
    }

    fn add(self, other: Self) -> Self {
        let size = self.magnitude.max(other.magnitude);
        Self::from_result(self.rounded + other.rounded, self.exact_value + other.exact_value, size)
    }
    fn subtract(self, other: Self) -> Self {
        let size = self.magnitude.max(other.magnitude);
        Self::from_result(self.rounded - other.rounded, self.exact_value - other.exact_value, size)
    }
    fn multiply(self, other: Self) -> Self {
        let size = self.magnitude * other.magnitude;
        Self::from_result(self.rounded * other.rounded, self.exact_value * other.exact_value, size)
    }
    fn divide(self, other: Self) -> Self {
        let below = other.exact_value.to_f64().abs();
        let size = self.magnitude / below * (other.magnitude / below);
        Self::from_result(self.rounded / other.rounded, self.exact_value / other.exact_value, size)
    }
    fn sine(self) -> Self {
        Self::from_result(self.rounded.sin(), self.exact_value.sin(), self.magnitude.max(1.0))
    }
    fn cosine(self) -> Self {
        Self::from_result(self.rounded.cos(), self.exact_value.cos(), self.magnitude.max(1.0))
    }
}

/// Random sequences of fifteen operations on a shared pool of numbers, so that terms recur with opposite sign and
/// cancel. After every operation the error is within the bound, and a certain sign is the sign of the exact number.
///
/// Tolerance: 1e-12 of the bound, for the rounding of the bound itself, and 1e-28 of the largest intermediate result,
/// for the 31 digits of the reference.
#[test]
fn rounding_bounds_hold_for_random_operation_sequences() {
    let mut random = RandomNumbers::new(800);
    let (mut steps, mut uncertain, mut cancelled, mut max_ratio) = (0, 0, 0, 0.0f64);
    for _ in 0..20_000 {
        let mut pool: Vec<TrackedNumber> =
            (0..5).map(|_| TrackedNumber::new_random(&mut random)).collect();
        for _ in 0..15 {
            let [a, b] = [0; 2].map(|_| pool[random.uniform_index(pool.len())]);
            let next = match random.uniform_index(9) {
                0 => a.add(b),
                1 | 2 => a.subtract(b),
                3 | 4 => a.multiply(b),
                5 => a.divide(b),
                // Larger arguments are excluded, since argument reduction would lose digits of the reference.
                6 if a.rounded.value.abs() < 1e3 => a.sine(),
                7 if a.rounded.value.abs() < 1e3 => a.cosine(),
                _ => {
                    let mut sum = a.rounded;
                    sum += -(2.0 * b.rounded);
                    let exact = a.exact_value - b.exact_value * dd(2.0);
                    TrackedNumber::from_result(sum, exact, a.magnitude.max(2.0 * b.magnitude))
                }
            };
            let Rounded { value, bound } = next.rounded;
            if !bound.is_finite() {
                continue;
            }
            // Underflow and overflow are excluded: the rounding model does not cover them.
            let in_range = |x: f64| x == 0.0 || (1e-60..1e60).contains(&x.abs());
            if !in_range(value) || !in_range(next.magnitude) || bound > 1e60 {
                continue;
            }
            let noise = 1e-28 * next.magnitude;
            assert!(
                next.error() <= bound * (1.0 + 1e-12) + noise,
                "error {:e} beyond the bound {bound:e} of {value:e}",
                next.error()
            );
            match next.rounded.sign() {
                Some(sign) if next.exact_value.to_f64().abs() > noise => {
                    assert_eq!(f64::from(sign), next.exact_value.to_f64().signum());
                }
                Some(_) => {}
                None => uncertain += 1,
            }
            cancelled += usize::from(value.abs() < 1e-10 * next.magnitude);
            if bound > 0.0 && noise < 1e-3 * bound {
                max_ratio = max_ratio.max(next.error() / bound);
            }
            steps += 1;
            pool.push(next);
        }
    }
    println!(
        "{steps} steps, {cancelled} cancellations, {uncertain} uncertain; largest ratio {max_ratio:.3}"
    );
    assert!(steps > 100_000 && cancelled > 1_000 && uncertain > 1_000);
}

/// The bound of a simple expression is at most 50 times the largest error in 2,000 random samples with inputs at the
/// ends of their intervals.
#[test]
fn rounding_bounds_of_simple_expressions_are_at_most_50_times_the_error() {
    type Expression = fn([TrackedNumber; 6]) -> TrackedNumber;
    let expressions: [(&str, Expression); 9] = [
        ("sum", |x| x[0].add(x[1])),
        ("difference", |x| x[0].subtract(x[1])),
        ("product", |x| x[0].multiply(x[1])),
        ("quotient", |x| x[0].divide(x[1])),
        ("sine", |x| x[0].sine()),
        ("cosine", |x| x[0].cosine()),
        ("product of three", |x| x[0].multiply(x[1]).multiply(x[2])),
        ("scalar product", |x| {
            x[0].multiply(x[1]).add(x[2].multiply(x[3])).add(x[4].multiply(x[5]))
        }),
        ("two by two determinant", |x| x[0].multiply(x[1]).subtract(x[2].multiply(x[3]))),
    ];
    for (name, expression) in expressions {
        let mut random = RandomNumbers::new(810);
        let mut max_ratio = 0.0f64;
        for _ in 0..2_000 {
            let inputs = [0; 6].map(|_| {
                let value = random.signed_uniform(0.5, 3.0);
                TrackedNumber::new_rounded(&mut random, value)
            });
            let result = expression(inputs);
            assert!(result.error() <= result.rounded.bound * (1.0 + 1e-12) + 1e-29);
            max_ratio = max_ratio.max(result.error() / result.rounded.bound);
        }
        println!("{name}: the error reaches {max_ratio:.2} of the bound");
        assert!(max_ratio > 0.02, "{name}: the bound is {:.0} times too large", 1.0 / max_ratio);
    }
}

/// For sin x and 1 − cos x near multiples of π a certain sign is correct, and both certain and uncertain signs occur.
#[test]
fn certain_signs_are_correct_near_zeros() {
    let mut random = RandomNumbers::new(820);
    let (mut certain, mut uncertain) = (0, 0);
    for _ in 0..5_000 {
        let turns = random.uniform_index(8) as f64;
        // The distance from the zero n π of the sine is up to (1 + n) × 1e-12, where n is `turns`.
        let offset = 10f64.powf(random.uniform(-16.5, -12.0));
        let value =
            turns * std::f64::consts::PI + random.signed_uniform(0.5, 1.0) * offset * (1.0 + turns);
        let angle = TrackedNumber::new_rounded(&mut random, value);
        for x in
            [angle.sine(), TrackedNumber::new_rounded(&mut random, 1.0).subtract(angle.cosine())]
        {
            assert!(x.error() <= x.rounded.bound * (1.0 + 1e-12) + 1e-30);
            match x.rounded.sign() {
                Some(sign) => {
                    certain += 1;
                    assert_eq!(f64::from(sign), x.exact_value.to_f64().signum());
                }
                None => uncertain += 1,
            }
        }
    }
    assert!(certain > 500 && uncertain > 500, "{certain} {uncertain}");
}

/// Division by a number whose interval contains zero gives an infinite bound and no sign; otherwise the bound is
/// finite.
#[test]
fn division_by_a_possible_zero_has_infinite_bound() {
    let mut random = RandomNumbers::new(830);
    for _ in 0..1_000 {
        let x = TrackedNumber::new_random(&mut random).rounded;
        let y = Rounded::from_rounded(random.signed_uniform(0.5, 2.0));
        let zero = y - y;
        assert_eq!((x / zero).bound, f64::INFINITY);
        assert_eq!((x / zero).sign(), None);
        assert_eq!((x / Rounded::ZERO).sign(), None);
        // Division by an exact zero, including zero by zero.
        assert_eq!((x / Rounded::ZERO).bound, f64::INFINITY);
        assert_eq!((Rounded::ZERO / Rounded::ZERO).bound, f64::INFINITY);
        let near = Rounded { value: y.value, bound: 0.999 * y.value.abs() };
        assert!((x / near).bound.is_finite());
        let over = Rounded { value: y.value, bound: y.value.abs() };
        assert_eq!((x / over).bound, f64::INFINITY);
    }
}

/// Adding a structural zero changes nothing; a product with a structural zero is a structural zero.
#[test]
fn structural_zeros_are_exact_in_sums_and_products() {
    let mut random = RandomNumbers::new(840);
    for _ in 0..1_000 {
        let x = TrackedNumber::new_random(&mut random).rounded;
        assert_eq!(x + Rounded::ZERO, x);
        assert_eq!(Rounded::ZERO + x, x);
        assert_eq!(x - Rounded::ZERO, x);
        assert_eq!(Rounded::ZERO - x, -x);
        assert!((x * Rounded::ZERO).is_structural_zero());
        assert_eq!((x * Rounded::ZERO).sign(), Some(0));
        assert_eq!((-x).bound, x.bound);
    }
    assert!(Rounded::ZERO.sin().is_structural_zero());
    assert!((Rounded::ZERO / Rounded::ONE).is_structural_zero());
}
