//! `Rounded` against arithmetic of 31 digits: the bounds cover the errors and are not far too large.

mod support;

use support::{Random, Real, Wide, wide};
use wellposed_models::Rounded;
use wellposed_models::common::rounding::UNIT_ROUNDOFF;

/// A rounded number, its exact value in 31 digits, and the largest magnitude of an intermediate result, which scales
/// the error of the 31 digits.
#[derive(Clone, Copy)]
struct Tracked {
    rounded: Rounded,
    exact: Wide,
    size: f64,
}

impl Tracked {
    /// Random number: exact, or with an exact value inside or at an end of the interval of half a unit in the last
    /// place.
    fn leaf(random: &mut Random) -> Self {
        let value = random.generic(1.0, 10.0) * 10f64.powi(random.below(7) as i32 - 3);
        Self::given(random, value)
    }

    fn given(random: &mut Random, value: f64) -> Self {
        let (rounded, shift) = match random.below(4) {
            0 => (Rounded::exact(value), 0.0),
            1 => (Rounded::given(value), random.within(-1.0, 1.0)),
            2 => (Rounded::from(value), 1.0),
            _ => (Rounded::given(value), -1.0),
        };
        let exact = wide(value) + wide(value) * wide(shift * UNIT_ROUNDOFF);
        Self { rounded, exact, size: value.abs() }
    }

    fn error(&self) -> f64 {
        (wide(self.rounded.value) - self.exact).value().abs()
    }

    fn of(rounded: Rounded, exact: Wide, sizes: f64) -> Self {
        Self { rounded, exact, size: sizes.max(exact.value().abs()) }
    }

    fn sum(self, other: Self) -> Self {
        let size = self.size.max(other.size);
        Self::of(self.rounded + other.rounded, self.exact + other.exact, size)
    }
    fn difference(self, other: Self) -> Self {
        let size = self.size.max(other.size);
        Self::of(self.rounded - other.rounded, self.exact - other.exact, size)
    }
    fn product(self, other: Self) -> Self {
        let size = self.size * other.size;
        Self::of(self.rounded * other.rounded, self.exact * other.exact, size)
    }
    fn quotient(self, other: Self) -> Self {
        let below = other.exact.value().abs();
        let size = self.size / below * (other.size / below);
        Self::of(self.rounded / other.rounded, self.exact / other.exact, size)
    }
    fn sine(self) -> Self {
        Self::of(self.rounded.sin(), self.exact.sin(), self.size.max(1.0))
    }
    fn cosine(self) -> Self {
        Self::of(self.rounded.cos(), self.exact.cos(), self.size.max(1.0))
    }
}

/// Random sequences of fifteen operations on a shared pool of numbers, so that terms recur with opposite sign and
/// cancel. After every operation the error is within the bound, and a certain sign is the sign of the exact number.
///
/// Tolerance: 1e-12 of the bound, for the rounding of the bound itself, and 1e-28 of the largest intermediate result,
/// for the 31 digits of the reference.
#[test]
fn bounds_hold_in_random_programs() {
    let mut random = Random::new(800);
    let (mut steps, mut unsure, mut cancelled, mut closest) = (0, 0, 0, 0.0f64);
    for _ in 0..20_000 {
        let mut pool: Vec<Tracked> = (0..5).map(|_| Tracked::leaf(&mut random)).collect();
        for _ in 0..15 {
            let [a, b] = [0; 2].map(|_| pool[random.below(pool.len())]);
            let next = match random.below(9) {
                0 => a.sum(b),
                1 | 2 => a.difference(b),
                3 | 4 => a.product(b),
                5 => a.quotient(b),
                // Larger arguments are excluded: their reduction loses digits of the reference.
                6 if a.rounded.value.abs() < 1e3 => a.sine(),
                7 if a.rounded.value.abs() < 1e3 => a.cosine(),
                _ => {
                    let mut sum = a.rounded;
                    sum += -(2.0 * b.rounded);
                    let exact = a.exact - b.exact * wide(2.0);
                    Tracked::of(sum, exact, a.size.max(2.0 * b.size))
                }
            };
            let Rounded { value, bound } = next.rounded;
            if !bound.is_finite() {
                continue;
            }
            // Underflow and overflow are excluded: the rounding model does not cover them.
            let in_range = |x: f64| x == 0.0 || (1e-60..1e60).contains(&x.abs());
            if !in_range(value) || !in_range(next.size) || bound > 1e60 {
                continue;
            }
            let noise = 1e-28 * next.size;
            assert!(
                next.error() <= bound * (1.0 + 1e-12) + noise,
                "error {:e} beyond the bound {bound:e} of {value:e}",
                next.error()
            );
            match next.rounded.sign() {
                Some(sign) if next.exact.value().abs() > noise => {
                    assert_eq!(f64::from(sign), next.exact.value().signum());
                }
                Some(_) => {}
                None => unsure += 1,
            }
            cancelled += usize::from(value.abs() < 1e-10 * next.size);
            if bound > 0.0 && noise < 1e-3 * bound {
                closest = closest.max(next.error() / bound);
            }
            steps += 1;
            pool.push(next);
        }
    }
    println!("{steps} steps, {cancelled} cancellations, {unsure} unsure; closest {closest:.3}");
    assert!(steps > 100_000 && cancelled > 1_000 && unsure > 1_000);
}

/// The bound of a simple expression is at most 50 times the largest error in 2,000 random samples with inputs at the
/// ends of their intervals.
#[test]
fn bounds_of_simple_expressions_are_near_the_worst_case() {
    type Expression = fn([Tracked; 6]) -> Tracked;
    let expressions: [(&str, Expression); 9] = [
        ("sum", |x| x[0].sum(x[1])),
        ("difference", |x| x[0].difference(x[1])),
        ("product", |x| x[0].product(x[1])),
        ("quotient", |x| x[0].quotient(x[1])),
        ("sine", |x| x[0].sine()),
        ("cosine", |x| x[0].cosine()),
        ("product of three", |x| x[0].product(x[1]).product(x[2])),
        ("scalar product", |x| x[0].product(x[1]).sum(x[2].product(x[3])).sum(x[4].product(x[5]))),
        ("two by two determinant", |x| x[0].product(x[1]).difference(x[2].product(x[3]))),
    ];
    for (name, expression) in expressions {
        let mut random = Random::new(810);
        let mut closest = 0.0f64;
        for _ in 0..2_000 {
            let inputs = [0; 6].map(|_| {
                let value = random.generic(0.5, 3.0);
                Tracked::given(&mut random, value)
            });
            let result = expression(inputs);
            assert!(result.error() <= result.rounded.bound * (1.0 + 1e-12) + 1e-29);
            closest = closest.max(result.error() / result.rounded.bound);
        }
        println!("{name}: the error reaches {closest:.2} of the bound");
        assert!(closest > 0.02, "{name}: the bound is {:.0} times too large", 1.0 / closest);
    }
}

/// Near zeros of sin x and 1 − cos x a certain sign is correct, and both certain and uncertain signs occur.
#[test]
fn signs_near_zero() {
    let mut random = Random::new(820);
    let (mut sure, mut unsure) = (0, 0);
    for _ in 0..5_000 {
        let turns = random.below(8) as f64;
        // At a distance of 1 to 1e4 units in the last place from a zero of the sine.
        let offset = 10f64.powf(random.within(-16.5, -12.0));
        let value =
            turns * std::f64::consts::PI + random.generic(0.5, 1.0) * offset * (1.0 + turns);
        let angle = Tracked::given(&mut random, value);
        for x in [angle.sine(), Tracked::given(&mut random, 1.0).difference(angle.cosine())] {
            assert!(x.error() <= x.rounded.bound * (1.0 + 1e-12) + 1e-30);
            match x.rounded.sign() {
                Some(sign) => {
                    sure += 1;
                    assert_eq!(f64::from(sign), x.exact.value().signum());
                }
                None => unsure += 1,
            }
        }
    }
    assert!(sure > 500 && unsure > 500, "{sure} {unsure}");
}

/// Division by a number whose interval contains zero gives an infinite bound and no sign; otherwise the bound is
/// finite.
#[test]
fn division_by_what_may_be_zero_has_no_bound() {
    let mut random = Random::new(830);
    for _ in 0..1_000 {
        let x = Tracked::leaf(&mut random).rounded;
        let y = Rounded::given(random.generic(0.5, 2.0));
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
fn structural_zeros() {
    let mut random = Random::new(840);
    for _ in 0..1_000 {
        let x = Tracked::leaf(&mut random).rounded;
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
