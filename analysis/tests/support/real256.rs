//! Real and complex numbers of 256 bits (77 digits), for references that share no code with the
//! crate. Sums and products are truncated: one operation is wrong by at most 2⁻²⁵⁴ relative.

use num_complex::Complex64;
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Mul, Neg};
use std::sync::OnceLock;

/// Number of 64-bit limbs of the mantissa.
const LIMBS: usize = 4;

/// ± 0.limbs · 2^exponent; the last limb is the leading one and has its top bit set, except in zero.
#[derive(Clone, Copy, Debug)]
pub struct Real256 {
    has_minus_sign: bool,
    exponent: i64,
    limbs: [u64; LIMBS],
}

impl Real256 {
    pub const ZERO: Self = Self { has_minus_sign: false, exponent: 0, limbs: [0; LIMBS] };

    pub fn is_zero(self) -> bool {
        self.limbs[LIMBS - 1] == 0
    }

    pub fn abs(self) -> Self {
        Self { has_minus_sign: false, ..self }
    }

    pub fn is_negative(self) -> bool {
        self.has_minus_sign && !self.is_zero()
    }

    /// Product with 2^n, exact.
    pub fn multiply_by_power_of_two(self, n: i64) -> Self {
        Self { exponent: self.exponent + n, ..self }
    }

    /// Binary exponent e with 2^(e−1) ≤ |x| < 2^e; very negative for zero.
    pub fn exponent(self) -> i64 {
        if self.is_zero() { i64::MIN / 4 } else { self.exponent }
    }

    pub fn to_f64(self) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        let mantissa = self.limbs[LIMBS - 1] as f64 * (-64f64).exp2();
        let exponent = self.exponent.clamp(-2000, 2000) as i32;
        let half = exponent / 2;
        let value = mantissa * f64::from(half).exp2() * f64::from(exponent - half).exp2();
        if self.has_minus_sign { -value } else { value }
    }

    /// Base-two logarithm of |x|.
    pub fn log2(self) -> f64 {
        if self.is_zero() {
            return f64::NEG_INFINITY;
        }
        self.exponent as f64 + (self.limbs[LIMBS - 1] as f64).log2() - 64.0
    }

    /// 1/x by Newton's iteration.
    pub fn reciprocal(self) -> Self {
        assert!(!self.is_zero(), "division by zero");
        let mantissa = Self { has_minus_sign: false, exponent: 0, ..self };
        let mut y = Self::from(1.0 / mantissa.to_f64());
        for _ in 0..3 {
            y += y * (Self::from(1.0) - mantissa * y);
        }
        Self { has_minus_sign: self.has_minus_sign, exponent: y.exponent - self.exponent, ..y }
    }

    pub fn sin_cos(self) -> (Self, Self) {
        // Halve the angle until it is small, sum the series of sin and of 1 − cos, then double the angle again: 1 − cos
        // is doubled without cancellation.
        let halvings = (self.exponent() + 10).max(0);
        let x = self.multiply_by_power_of_two(-halvings);
        let square = x * x;
        let (mut sine, mut versine) = (Self::ZERO, Self::ZERO);
        let mut term = x;
        let mut n = 1.0;
        while term.exponent() > x.exponent() - 270 && !term.is_zero() {
            sine += term;
            // Term x^(n+1)/(n+1)!, with the sign opposite to the cosine series.
            let next = term * x * Self::from(n + 1.0).reciprocal();
            versine += next;
            term = -(term * square * Self::from((n + 1.0) * (n + 2.0)).reciprocal());
            n += 2.0;
        }
        for _ in 0..halvings {
            let cosine = Self::from(1.0) - versine;
            (sine, versine) = (
                (sine * cosine).multiply_by_power_of_two(1),
                (sine * sine).multiply_by_power_of_two(1),
            );
        }
        (sine, Self::from(1.0) - versine)
    }

    /// π by Machin's formula.
    pub fn pi() -> Self {
        static PI: OnceLock<Real256> = OnceLock::new();
        *PI.get_or_init(|| {
            let arctangent = |n: f64| {
                let x = Self::from(n).reciprocal();
                let square = x * x;
                let (mut sum, mut power, mut m) = (Self::ZERO, x, 1.0);
                while power.exponent() > -270 {
                    sum += power * Self::from(m).reciprocal();
                    power = -(power * square);
                    m += 2.0;
                }
                sum
            };
            (arctangent(5.0).multiply_by_power_of_two(2) - arctangent(239.0))
                .multiply_by_power_of_two(2)
        })
    }

    fn compare_moduli(a: &Self, b: &Self) -> Ordering {
        a.exponent().cmp(&b.exponent()).then_with(|| a.limbs.iter().rev().cmp(b.limbs.iter().rev()))
    }
}

impl From<f64> for Real256 {
    fn from(x: f64) -> Self {
        assert!(x.is_finite(), "{x} is no number");
        if x == 0.0 {
            return Self::ZERO;
        }
        let bits = x.to_bits();
        let (biased, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
        let (mantissa, exponent) = if biased == 0 {
            (fraction, -1074)
        } else {
            (fraction | 1 << 52, biased as i64 - 1075)
        };
        let shift = mantissa.leading_zeros();
        let mut limbs = [0; LIMBS];
        limbs[LIMBS - 1] = mantissa << shift;
        Self { has_minus_sign: x < 0.0, exponent: exponent + 64 - i64::from(shift), limbs }
    }
}

impl PartialEq for Real256 {
    fn eq(&self, other: &Self) -> bool {
        (*self - *other).is_zero()
    }
}

impl PartialOrd for Real256 {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let difference = *self - *other;
        Some(if difference.is_zero() {
            Ordering::Equal
        } else if difference.has_minus_sign {
            Ordering::Less
        } else {
            Ordering::Greater
        })
    }
}

impl Neg for Real256 {
    type Output = Self;
    fn neg(self) -> Self {
        Self { has_minus_sign: !self.has_minus_sign, ..self }
    }
}

impl Add for Real256 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is_zero() {
            return other;
        }
        if other.is_zero() {
            return self;
        }
        let (a, b) = match Self::compare_moduli(&self, &other) {
            Ordering::Less => (other, self),
            _ => (self, other),
        };
        let distance = (a.exponent - b.exponent) as u64;
        if distance >= 64 * (LIMBS as u64 + 1) {
            return a;
        }
        // A guard limb holds the bits that the shift would lose.
        let mut x = [0u64; LIMBS + 1];
        x[1..].copy_from_slice(&a.limbs);
        let mut y = [0u64; LIMBS + 1];
        let (words, bits) = ((distance / 64) as usize, distance % 64);
        let source = |i: usize| if i == 0 { 0 } else { b.limbs.get(i - 1).copied().unwrap_or(0) };
        for (i, limb) in y.iter_mut().enumerate() {
            let low = source(i + words);
            *limb =
                if bits == 0 { low } else { low >> bits | source(i + words + 1) << (64 - bits) };
        }
        let mut exponent = a.exponent;
        if a.has_minus_sign == b.has_minus_sign {
            let mut carry = false;
            for (p, q) in x.iter_mut().zip(y) {
                let (sum, first) = p.overflowing_add(q);
                let (sum, second) = sum.overflowing_add(u64::from(carry));
                (*p, carry) = (sum, first || second);
            }
            if carry {
                for i in 0..LIMBS {
                    x[i] = x[i] >> 1 | x[i + 1] << 63;
                }
                x[LIMBS] = x[LIMBS] >> 1 | 1 << 63;
                exponent += 1;
            }
        } else {
            let mut borrow = false;
            for (p, q) in x.iter_mut().zip(y) {
                let (rest, first) = p.overflowing_sub(q);
                let (rest, second) = rest.overflowing_sub(u64::from(borrow));
                (*p, borrow) = (rest, first || second);
            }
            let Some(top) = x.iter().rposition(|&limb| limb != 0) else { return Self::ZERO };
            let bits = x[top].leading_zeros();
            let words = LIMBS - top;
            for i in (0..=LIMBS).rev() {
                let at = |n: usize| if n >= words { x[n - words] } else { 0 };
                let low = if i > 0 { at(i - 1) } else { 0 };
                x[i] = if bits == 0 { at(i) } else { at(i) << bits | low >> (64 - bits) };
            }
            exponent -= 64 * words as i64 + i64::from(bits);
        }
        let mut limbs = [0; LIMBS];
        limbs.copy_from_slice(&x[1..]);
        Self { has_minus_sign: a.has_minus_sign, exponent, limbs }
    }
}

testkit::impl_subtraction!(Real256);

impl Mul for Real256 {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        let mut product = [0u64; 2 * LIMBS];
        for (i, &a) in self.limbs.iter().enumerate() {
            let mut carry = 0u128;
            for (j, &b) in other.limbs.iter().enumerate() {
                let sum = u128::from(a) * u128::from(b) + u128::from(product[i + j]) + carry;
                product[i + j] = sum as u64;
                carry = sum >> 64;
            }
            product[i + LIMBS] = carry as u64;
        }
        let mut exponent = self.exponent + other.exponent;
        if product[2 * LIMBS - 1] >> 63 == 0 {
            for i in (1..2 * LIMBS).rev() {
                product[i] = product[i] << 1 | product[i - 1] >> 63;
            }
            exponent -= 1;
        }
        let mut limbs = [0; LIMBS];
        limbs.copy_from_slice(&product[LIMBS..]);
        Self { has_minus_sign: self.has_minus_sign != other.has_minus_sign, exponent, limbs }
    }
}

impl AddAssign for Real256 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// A complex number with real and imaginary parts of 256 bits each.
#[derive(Clone, Copy, Debug)]
pub struct Complex256 {
    pub re: Real256,
    pub im: Real256,
}

impl Complex256 {
    pub const ZERO: Self = Self { re: Real256::ZERO, im: Real256::ZERO };

    pub fn from_real(re: Real256) -> Self {
        Self { re, im: Real256::ZERO }
    }

    pub fn is_zero(self) -> bool {
        self.re.is_zero() && self.im.is_zero()
    }

    pub fn exponent(self) -> i64 {
        self.re.exponent().max(self.im.exponent())
    }

    /// Product with iⁿ.
    pub fn multiply_by_i_power(self, n: usize) -> Self {
        match n % 4 {
            0 => self,
            1 => Self { re: -self.im, im: self.re },
            2 => -self,
            _ => Self { re: self.im, im: -self.re },
        }
    }

    pub fn scale(self, factor: Real256) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    pub fn multiply_by_power_of_two(self, n: i64) -> Self {
        Self { re: self.re.multiply_by_power_of_two(n), im: self.im.multiply_by_power_of_two(n) }
    }

    pub fn to_complex64(self) -> Complex64 {
        Complex64::new(self.re.to_f64(), self.im.to_f64())
    }

    /// |z| to double precision, as a number that cannot overflow.
    pub fn modulus(self) -> Real256 {
        if self.is_zero() {
            return Real256::ZERO;
        }
        let e = self.exponent();
        Real256::from(self.multiply_by_power_of_two(-e).to_complex64().norm())
            .multiply_by_power_of_two(e)
    }

    /// self / other to double precision.
    pub fn ratio(self, other: Self) -> Self {
        let (p, q) = (self.exponent(), other.exponent());
        let ratio = self.multiply_by_power_of_two(-p).to_complex64()
            / other.multiply_by_power_of_two(-q).to_complex64();
        Self::from(ratio).multiply_by_power_of_two(p - q)
    }
}

impl From<Complex64> for Complex256 {
    fn from(z: Complex64) -> Self {
        Self { re: z.re.into(), im: z.im.into() }
    }
}

testkit::impl_complex_arithmetic!(Complex256);

impl AddAssign for Complex256 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
