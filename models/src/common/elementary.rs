//! Elementary functions whose results have the same bits on every platform.
//!
//! The standard library calls the platform's sin, cos, exp, …: glibc, musl and macOS differ in the last bit, and the
//! code that glibc selects depends on whether the processor has fused multiply-add. A correctly rounded result is
//! unique. The functions here call the crate `pxfm`, which evaluates with a few bits more than a double has and repeats
//! in higher precision if the first pass does not decide the rounding (Ziv 1991). `pxfm` uses fused multiply-add where
//! the processor has it, and returns the same bits without it (`tests/elementary.rs`). Names follow C23, which reserves
//! the prefix `cr_` for correctly rounded functions (ISO/IEC TS 18661-4).
//!
//! The operations `+ − × ÷ √` are correctly rounded on every platform by IEEE 754, so expressions of these operations
//! alone are platform-independent without this module.

use nalgebra::Complex;

/// Elementary functions of a double with platform-independent bits. Functions whose names start with `cr_` are
/// correctly rounded. Angles are in rad; x is `self`, except in [`cr_atan2`](Self::cr_atan2).
pub trait Elementary: Sized {
    /// sin x.
    fn cr_sin(self) -> Self;
    /// cos x.
    fn cr_cos(self) -> Self;
    /// (sin x, cos x).
    fn cr_sin_cos(self) -> (Self, Self);
    /// tan x.
    fn cr_tan(self) -> Self;
    /// arcsin x in [−π/2, π/2].
    fn cr_asin(self) -> Self;
    /// arccos x in [0, π].
    fn cr_acos(self) -> Self;
    /// arctan x in (−π/2, π/2).
    fn cr_atan(self) -> Self;
    /// The polar angle in [−π, π] of the point (x, y), where y is `self`.
    fn cr_atan2(self, x: Self) -> Self;
    /// sinh x.
    fn cr_sinh(self) -> Self;
    /// cosh x.
    fn cr_cosh(self) -> Self;
    /// tanh x.
    fn cr_tanh(self) -> Self;
    /// eˣ.
    fn cr_exp(self) -> Self;
    /// 2ˣ.
    fn cr_exp2(self) -> Self;
    /// Natural logarithm ln x.
    fn cr_ln(self) -> Self;
    /// Logarithm to the base 2, log₂ x.
    fn cr_log2(self) -> Self;
    /// Logarithm to the base 10, log₁₀ x.
    fn cr_log10(self) -> Self;
    /// Power xᵖ with the exponent p = `power`.
    fn cr_powf(self, power: Self) -> Self;
    /// Euclidean norm √(self² + other²) (`hypot`), within one unit in the last place, without harmful intermediate
    /// overflow or underflow; ∞ if an argument is infinite, even if the other is NaN.
    fn root_sum_square(self, other: Self) -> Self;
}

/// Implements methods of one or two doubles by functions of `pxfm`.
macro_rules! call_pxfm {
    ($($method:ident($($argument:ident),*) = $function:ident;)*) => {
        $(fn $method(self $(, $argument: Self)*) -> Self {
            pxfm::$function(self $(, $argument)*)
        })*
    };
}

impl Elementary for f64 {
    call_pxfm! {
        cr_sin() = f_sin;
        cr_cos() = f_cos;
        cr_tan() = f_tan;
        cr_asin() = f_asin;
        cr_acos() = f_acos;
        cr_atan() = f_atan;
        cr_atan2(x) = f_atan2;
        cr_sinh() = f_sinh;
        cr_cosh() = f_cosh;
        cr_tanh() = f_tanh;
        cr_exp() = f_exp;
        cr_exp2() = f_exp2;
        cr_ln() = f_log;
        cr_log2() = f_log2;
        cr_log10() = f_log10;
        cr_powf(power) = f_pow;
    }

    fn cr_sin_cos(self) -> (Self, Self) {
        pxfm::f_sincos(self)
    }

    // Computed from products and a square root, since `pxfm::f_hypot` (0.1.30) is not correctly rounded.
    #[inline]
    fn root_sum_square(self, other: Self) -> Self {
        /// Magnitudes of the larger argument for which the sum of both squares neither overflows nor underflows.
        const SAFE_MAGNITUDES: std::ops::Range<f64> = 1e-140..1e140;
        /// Scale factor 2⁶⁰⁰, exact, by which arguments outside [`SAFE_MAGNITUDES`] are multiplied or divided before
        /// they are squared.
        const SCALE_FACTOR: f64 = f64::from_bits((1023 + 600) << 52);
        let largest = self.abs().max(other.abs());
        let norm = |x: f64, y: f64| (x * x + y * y).sqrt();
        if SAFE_MAGNITUDES.contains(&largest) || largest == 0.0 {
            norm(self, other)
        } else if self.is_infinite() || other.is_infinite() {
            f64::INFINITY
        } else if largest < 1.0 {
            norm(self * SCALE_FACTOR, other * SCALE_FACTOR) / SCALE_FACTOR
        } else {
            norm(self / SCALE_FACTOR, other / SCALE_FACTOR) * SCALE_FACTOR
        }
    }
}

/// Modulus of a complex number with platform-independent bits.
pub trait Modulus {
    /// |z| = √(re² + im²) by [`Elementary::root_sum_square`].
    fn modulus(self) -> f64;
}

impl Modulus for Complex<f64> {
    #[inline]
    fn modulus(self) -> f64 {
        self.re.root_sum_square(self.im)
    }
}

/// The unit complex number e^(iθ) of the angle θ (rad).
pub fn cr_cis(angle: f64) -> Complex<f64> {
    let (sin, cos) = angle.cr_sin_cos();
    Complex::new(cos, sin)
}

/// Argument (phase) of a complex number, rad, in [−π, π].
pub fn cr_arg(z: Complex<f64>) -> f64 {
    z.im.cr_atan2(z.re)
}

/// The complex number `modulus` · e^(i `angle`) from polar coordinates; `angle` in rad.
pub fn cr_from_polar(modulus: f64, angle: f64) -> Complex<f64> {
    cr_cis(angle) * modulus
}
