//! Helpers of the tests, independent of the models: random numbers, double-double numbers, dual numbers, complex
//! numbers, determinants.
#![allow(dead_code, unused_imports, reason = "each test file uses some of the helpers")]

pub mod equations;
pub mod solids;
pub mod states;
pub mod yield_sets;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use testkit::random::RandomNumbers;

/// Random number 10ˣ with x uniform between `from` and `to`.
pub fn draw_log_uniform(random: &mut RandomNumbers, from: f64, to: f64) -> f64 {
    10f64.powf(random.uniform(from, to))
}

/// Real numbers that support automatic differentiation.
pub trait DifferentiableReal:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn from_f64(value: f64) -> Self;
    /// Sine and cosine of `self` (rad).
    fn sin_cos(self) -> (Self, Self);
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Square root √½.
    fn sqrt_half() -> Self;
}

/// Double-double number: the sum of two doubles that do not overlap, about 31 decimal digits (Dekker 1971).
#[derive(Clone, Copy, Debug, Default)]
pub struct DoubleDouble {
    pub high: f64,
    pub low: f64,
}

pub const fn dd(value: f64) -> DoubleDouble {
    DoubleDouble { high: value, low: 0.0 }
}

/// π/2 to 33 digits.
pub const RIGHT_ANGLE: DoubleDouble =
    DoubleDouble { high: std::f64::consts::FRAC_PI_2, low: 6.123_233_995_736_766e-17 };

fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble { high, low: (a - (high - part)) + (b - part) }
}

fn two_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    DoubleDouble { high, low: a.mul_add(b, -high) }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let first = two_sum(high.high, high.low + low.high);
        two_sum(first.high, first.low + low.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

testkit::impl_subtraction!(DoubleDouble);

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * dd(first);
        let second = rest.high / other.high;
        let third = (rest - other * dd(second)).high / other.high;
        two_sum(first, second) + dd(third)
    }
}

impl DoubleDouble {
    pub fn to_f64(self) -> f64 {
        self.high + self.low
    }

    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    pub fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return self;
        }
        let mut root = dd(self.high.sqrt());
        for _ in 0..2 {
            root = (root + self / root) * dd(0.5);
        }
        root
    }
}

impl DifferentiableReal for DoubleDouble {
    fn from_f64(value: f64) -> Self {
        dd(value)
    }
    /// Taylor series after argument reduction to |x| ≤ π/4.
    fn sin_cos(self) -> (Self, Self) {
        let quarter_turns = (self.high / RIGHT_ANGLE.high).round();
        let x = self - RIGHT_ANGLE * dd(quarter_turns);
        let (mut sine, mut cosine, mut term) = (dd(0.0), dd(0.0), dd(1.0));
        for n in 0..30 {
            match n % 4 {
                0 => cosine = cosine + term,
                1 => sine = sine + term,
                2 => cosine = cosine - term,
                _ => sine = sine - term,
            }
            term = term * x / dd(f64::from(n + 1));
        }
        match (quarter_turns as i64).rem_euclid(4) {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
    fn sqrt_half() -> Self {
        dd(0.5).sqrt()
    }
}

/// Dual number: a value and its derivative with respect to one variable. A dual number of dual numbers also contains a
/// mixed second derivative.
#[derive(Clone, Copy, Debug)]
pub struct Dual<T> {
    pub value: T,
    pub derivative: T,
}

impl<T: DifferentiableReal> Dual<T> {
    pub fn from_value(value: T) -> Self {
        Self { value, derivative: T::from_f64(0.0) }
    }
}

impl<T: DifferentiableReal> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl<T: DifferentiableReal> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl<T: DifferentiableReal> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl<T: DifferentiableReal> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            derivative: self.derivative * other.value + self.value * other.derivative,
        }
    }
}

impl<T: DifferentiableReal> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - value * other.derivative) / other.value }
    }
}

impl<T: DifferentiableReal> DifferentiableReal for Dual<T> {
    fn from_f64(value: f64) -> Self {
        Self::from_value(T::from_f64(value))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        let derivatives = (self.derivative * cosine, -(self.derivative * sine));
        (
            Self { value: sine, derivative: derivatives.0 },
            Self { value: cosine, derivative: derivatives.1 },
        )
    }
    fn sqrt_half() -> Self {
        Self::from_value(T::sqrt_half())
    }
}

/// A complex double-double number.
#[derive(Clone, Copy, Debug, Default)]
pub struct Complex {
    pub re: DoubleDouble,
    pub im: DoubleDouble,
}

pub fn complex(re: f64, im: f64) -> Complex {
    Complex { re: dd(re), im: dd(im) }
}

impl From<DoubleDouble> for Complex {
    fn from(re: DoubleDouble) -> Self {
        Self { re, im: dd(0.0) }
    }
}

impl From<f64> for Complex {
    fn from(re: f64) -> Self {
        dd(re).into()
    }
}

testkit::impl_complex_arithmetic!(Complex);

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
        self.re.to_f64().hypot(self.im.to_f64())
    }

    pub fn sqrt(self) -> Self {
        let size = (self.re * self.re + self.im * self.im).sqrt();
        if size.high == 0.0 {
            return self;
        }
        // The larger in magnitude of the real and imaginary parts is computed first, without cancellation.
        let large = ((size + self.re.abs()) * dd(0.5)).sqrt();
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

fn trim_trailing_zeros(mut polynomial: Polynomial) -> Polynomial {
    while polynomial.last().is_some_and(|c| c.re.high == 0.0 && c.im.high == 0.0) {
        polynomial.pop();
    }
    polynomial
}

pub fn multiply_polynomials(a: &[Complex], b: &[Complex]) -> Polynomial {
    if a.is_empty() || b.is_empty() {
        return vec![];
    }
    let mut result = vec![Complex::default(); a.len() + b.len() - 1];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            result[i + j] = result[i + j] + x * y;
        }
    }
    trim_trailing_zeros(result)
}

pub fn evaluate_polynomial(polynomial: &[Complex], x: Complex) -> Complex {
    polynomial.iter().rev().fold(Complex::default(), |sum, &c| sum * x + c)
}

/// Both roots of a quadratic polynomial, the root of larger magnitude first.
pub fn quadratic_roots(polynomial: &[Complex]) -> [Complex; 2] {
    let [c, b, a] = polynomial else { panic!("degree {}", polynomial.len() as i64 - 1) };
    let discriminant = (*b * *b - complex(4.0, 0.0) * *a * *c).sqrt();
    let (plus, minus) = (*b + discriminant, *b - discriminant);
    let sum = if plus.abs() > minus.abs() { plus } else { minus };
    let half = -(sum * complex(0.5, 0.0));
    [half / *a, *c / half]
}

/// Determinant of a matrix of polynomials by Laplace expansion with shared minors. Since there is no pivoting, a
/// coefficient to which no permutation contributes is exactly zero; it is absent if it is the highest.
pub fn polynomial_determinant(matrix: &[Vec<Polynomial>]) -> Polynomial {
    let n = matrix.len();
    let mut minors: Vec<Polynomial> = vec![vec![]; 1 << n];
    minors[0] = vec![complex(1.0, 0.0)];
    for set in 1usize..1 << n {
        let row = set.count_ones() as usize - 1;
        let mut sum: Polynomial = vec![];
        for column in (0..n).filter(|column| set & (1 << column) != 0) {
            // The sign of the term is −1 if the number of columns of the set with a higher index is odd.
            let odd = (set >> (column + 1)).count_ones() % 2 == 1;
            let term = multiply_polynomials(&matrix[row][column], &minors[set & !(1 << column)]);
            sum.resize(sum.len().max(term.len()), Complex::default());
            for (s, t) in sum.iter_mut().zip(term) {
                *s = if odd { *s - t } else { *s + t };
            }
        }
        minors[set] = trim_trailing_zeros(sum);
    }
    minors.pop().unwrap_or_default()
}

/// Permanent of the absolute values of a matrix: the scale of the rounding error of its determinant.
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

/// Determinant of a matrix of complex numbers.
pub fn complex_determinant(matrix: &[Vec<Complex>]) -> Complex {
    let polynomials: Vec<Vec<Polynomial>> = matrix
        .iter()
        .map(|row| row.iter().map(|&x| trim_trailing_zeros(vec![x])).collect())
        .collect();
    polynomial_determinant(&polynomials).first().copied().unwrap_or_default()
}
