//! `Rounded` against arithmetic of 31 digits: its bounds hold, and they are not silly.

mod support;

use support::{Random, Real, Wide, wide};
use wellposed_models::Rounded;
use wellposed_models::common::rounding::UNIT_ROUNDOFF;

/// A rounded number, the number that it stands for, and the largest magnitude on the way to it,
/// against which 31 digits count.
#[derive(Clone, Copy)]
struct Tracked {
    rounded: Rounded,
    exact: Wide,
    size: f64,
}

impl Tracked {
    /// A literal, or a given double whose exact value lies within half a unit in the last place:
    /// anywhere, or at the very end.
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

/// Random programs of fifteen steps on a shared pool, so that terms come back with the opposite
/// sign and cancel: after every step the error is within the bound, and a sign that is asserted is
/// the sign of the exact number.
///
/// Slack: the bounds are themselves sums of a few doubles rounded to nearest (1e-12 relative is
/// far more than that), and the reference has 31 digits of the largest intermediate (1e-28).
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
                // Larger arguments lose digits that no bound on the angle is at fault for.
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
            // No under- or overflow: neither is covered by the model of rounding.
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

/// The bound of a simple expression is within a factor of 50 of the worst error seen in 2,000
/// draws with inputs at the ends of their intervals; a bound that is a guess would not be.
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

/// Around the zeros of sine and cosine and in the difference of neighbours the sign is asserted
/// exactly as far as the interval allows.
#[test]
fn signs_near_zero() {
    let mut random = Random::new(820);
    let (mut sure, mut unsure) = (0, 0);
    for _ in 0..5_000 {
        let turns = random.below(8) as f64;
        // From 1 to 1e4 units in the last place off the zero of the sine.
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

/// A divisor whose interval contains zero gives no bound and no sign; one that does not gives both.
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
        // Exact zeros too, zero over zero included.
        assert_eq!((x / Rounded::ZERO).bound, f64::INFINITY);
        assert_eq!((Rounded::ZERO / Rounded::ZERO).bound, f64::INFINITY);
        let near = Rounded { value: y.value, bound: 0.999 * y.value.abs() };
        assert!((x / near).bound.is_finite());
        let over = Rounded { value: y.value, bound: y.value.abs() };
        assert_eq!((x / over).bound, f64::INFINITY);
    }
}

/// Structural zeros: sums with them change nothing, products with them are exact.
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
