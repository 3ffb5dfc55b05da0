//! Helpers of the tests, independent of the models: random numbers, double-double numbers, dual numbers, complex
//! numbers, determinants.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod equations;
pub mod states;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use testkit::random::Random;

/// Random number 10ˣ with x uniform between `from` and `to`.
pub fn decades(random: &mut Random, from: f64, to: f64) -> f64 {
    10f64.powf(random.within(from, to))
}

/// Real numbers that support automatic differentiation.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn constant(value: f64) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Square root √½.
    fn root_of_half() -> Self;
}

/// Double-double number: the sum of two doubles that do not overlap, about 31 decimal digits (Dekker 1971).
#[derive(Clone, Copy, Debug, Default)]
pub struct Wide {
    pub high: f64,
    pub low: f64,
}

pub const fn wide(value: f64) -> Wide {
    Wide { high: value, low: 0.0 }
}

/// π/2 to 33 digits.
pub const RIGHT_ANGLE: Wide =
    Wide { high: std::f64::consts::FRAC_PI_2, low: 6.123_233_995_736_766e-17 };

fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let part = high - a;
    Wide { high, low: (a - (high - part)) + (b - part) }
}

fn two_product(a: f64, b: f64) -> Wide {
    let high = a * b;
    Wide { high, low: a.mul_add(b, -high) }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let first = two_sum(high.high, high.low + low.high);
        two_sum(first.high, first.low + low.low)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * wide(first);
        let second = rest.high / other.high;
        let third = (rest - other * wide(second)).high / other.high;
        two_sum(first, second) + wide(third)
    }
}

impl Wide {
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    pub fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return self;
        }
        let mut root = wide(self.high.sqrt());
        for _ in 0..2 {
            root = (root + self / root) * wide(0.5);
        }
        root
    }
}

impl Real for Wide {
    fn constant(value: f64) -> Self {
        wide(value)
    }
    /// Taylor series after argument reduction to |x| ≤ π/4.
    fn sin_cos(self) -> (Self, Self) {
        let turns = (self.high / RIGHT_ANGLE.high).round();
        let x = self - RIGHT_ANGLE * wide(turns);
        let (mut sine, mut cosine, mut term) = (wide(0.0), wide(0.0), wide(1.0));
        for n in 0..30 {
            match n % 4 {
                0 => cosine = cosine + term,
                1 => sine = sine + term,
                2 => cosine = cosine - term,
                _ => sine = sine - term,
            }
            term = term * x / wide(f64::from(n + 1));
        }
        match (turns as i64).rem_euclid(4) {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
    fn root_of_half() -> Self {
        wide(0.5).sqrt()
    }
}

/// Dual number: a value and its derivative with respect to one variable. A nested dual number has a mixed second
/// derivative.
#[derive(Clone, Copy, Debug)]
pub struct Dual<T> {
    pub value: T,
    pub slope: T,
}

impl<T: Real> Dual<T> {
    pub fn of(value: T) -> Self {
        Self { value, slope: T::constant(0.0) }
    }
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Real> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Real> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Real> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl<T: Real> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<T: Real> Real for Dual<T> {
    fn constant(value: f64) -> Self {
        Self::of(T::constant(value))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        let slopes = (self.slope * cosine, -(self.slope * sine));
        (Self { value: sine, slope: slopes.0 }, Self { value: cosine, slope: slopes.1 })
    }
    fn root_of_half() -> Self {
        Self::of(T::root_of_half())
    }
}

/// A complex double-double number.
#[derive(Clone, Copy, Debug, Default)]
pub struct Complex {
    pub re: Wide,
    pub im: Wide,
}

pub fn complex(re: f64, im: f64) -> Complex {
    Complex { re: wide(re), im: wide(im) }
}

impl From<Wide> for Complex {
    fn from(re: Wide) -> Self {
        Self { re, im: wide(0.0) }
    }
}

impl From<f64> for Complex {
    fn from(re: f64) -> Self {
        wide(re).into()
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let square = other.re * other.re + other.im * other.im;
        let top = self * Self { re: other.re, im: -other.im };
        Self { re: top.re / square, im: top.im / square }
    }
}

impl Complex {
    pub fn abs(self) -> f64 {
        self.re.value().hypot(self.im.value())
    }

    pub fn sqrt(self) -> Self {
        let size = (self.re * self.re + self.im * self.im).sqrt();
        if size.high == 0.0 {
            return self;
        }
        // The larger part is computed first, without cancellation.
        let large = ((size + self.re.abs()) * wide(0.5)).sqrt();
        let small = self.im / (large + large);
        if self.re.high >= 0.0 {
            Self { re: large, im: small }
        } else if self.im.high >= 0.0 {
            Self { re: small, im: large }
        } else {
            Self { re: -small, im: -large }
        }
    }
}

/// A polynomial by its coefficients in ascending order, without trailing exact zeros.
pub type Polynomial = Vec<Complex>;

fn trimmed(mut polynomial: Polynomial) -> Polynomial {
    while polynomial.last().is_some_and(|c| c.re.high == 0.0 && c.im.high == 0.0) {
        polynomial.pop();
    }
    polynomial
}

pub fn product(a: &[Complex], b: &[Complex]) -> Polynomial {
    if a.is_empty() || b.is_empty() {
        return vec![];
    }
    let mut result = vec![Complex::default(); a.len() + b.len() - 1];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            result[i + j] = result[i + j] + x * y;
        }
    }
    trimmed(result)
}

pub fn evaluate(polynomial: &[Complex], x: Complex) -> Complex {
    polynomial.iter().rev().fold(Complex::default(), |sum, &c| sum * x + c)
}

/// Both roots of a quadratic, the larger first.
pub fn quadratic_roots(polynomial: &[Complex]) -> [Complex; 2] {
    let [c, b, a] = polynomial else { panic!("degree {}", polynomial.len() as i64 - 1) };
    let discriminant = (*b * *b - complex(4.0, 0.0) * *a * *c).sqrt();
    let (plus, minus) = (*b + discriminant, *b - discriminant);
    let sum = if plus.abs() > minus.abs() { plus } else { minus };
    let half = -(sum * complex(0.5, 0.0));
    [half / *a, *c / half]
}

/// Determinant of a matrix of polynomials by Laplace expansion with shared minors. Without pivoting, a coefficient to
/// which no permutation contributes is exactly zero and absent.
pub fn determinant(matrix: &[Vec<Polynomial>]) -> Polynomial {
    let n = matrix.len();
    let mut minors: Vec<Polynomial> = vec![vec![]; 1 << n];
    minors[0] = vec![complex(1.0, 0.0)];
    for set in 1usize..1 << n {
        let row = set.count_ones() as usize - 1;
        let mut sum: Polynomial = vec![];
        for column in (0..n).filter(|column| set & (1 << column) != 0) {
            // The sign depends on the number of columns of the set with a higher index.
            let odd = (set >> (column + 1)).count_ones() % 2 == 1;
            let term = product(&matrix[row][column], &minors[set & !(1 << column)]);
            sum.resize(sum.len().max(term.len()), Complex::default());
            for (s, t) in sum.iter_mut().zip(term) {
                *s = if odd { *s - t } else { *s + t };
            }
        }
        minors[set] = trimmed(sum);
    }
    minors.pop().unwrap_or_default()
}

/// Permanent of the absolute values: the scale of the rounding error of a determinant.
pub fn permanent(matrix: &[Vec<f64>]) -> f64 {
    let n = matrix.len();
    let mut minors = vec![0.0; 1 << n];
    minors[0] = 1.0;
    for set in 1usize..1 << n {
        let row = set.count_ones() as usize - 1;
        minors[set] = (0..n)
            .filter(|column| set & (1 << column) != 0)
            .map(|column| matrix[row][column].abs() * minors[set & !(1 << column)])
            .sum();
    }
    minors[(1 << n) - 1]
}

/// Determinant of a matrix of numbers.
pub fn number_determinant(matrix: &[Vec<Complex>]) -> Complex {
    let polynomials: Vec<Vec<Polynomial>> =
        matrix.iter().map(|row| row.iter().map(|&x| trimmed(vec![x])).collect()).collect();
    determinant(&polynomials).first().copied().unwrap_or_default()
}
