//! Operators of number types of tests: complex numbers with parts of any number type, and subtraction by negation.

/// Implements `+`, binary and unary `-`, and `*` for a complex type with the fields `re` and `im`.
#[macro_export]
macro_rules! impl_complex_arithmetic {
    ($complex:ty) => {
        impl std::ops::Add for $complex {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self { re: self.re + other.re, im: self.im + other.im }
            }
        }

        impl std::ops::Sub for $complex {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self { re: self.re - other.re, im: self.im - other.im }
            }
        }

        impl std::ops::Neg for $complex {
            type Output = Self;
            fn neg(self) -> Self {
                Self { re: -self.re, im: -self.im }
            }
        }

        impl std::ops::Mul for $complex {
            type Output = Self;
            fn mul(self, other: Self) -> Self {
                Self {
                    re: self.re * other.re - self.im * other.im,
                    im: self.re * other.im + self.im * other.re,
                }
            }
        }
    };
}

/// Implements `-` for a number type as the sum with the negated number.
#[macro_export]
macro_rules! impl_subtraction {
    ($number:ty) => {
        impl std::ops::Sub for $number {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                self + -other
            }
        }
    };
}
