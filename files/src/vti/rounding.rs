//! Rounding to significant decimal digits, so that values compress better.

/// Number of explicit bits of the mantissa of a double.
const MANTISSA_BITS: u32 = 52;

/// Returns the number of bits of the mantissa that `digits` significant decimal digits need.
fn needed_bits(digits: usize) -> u32 {
    // ⌈digits·log₂10⌉ bits after the leading one: the spacing is at most 10^−digits of the value.
    ((digits as f64 * std::f64::consts::LOG2_10).ceil() as u32).min(MANTISSA_BITS)
}

/// Returns the largest relative error of [`round_to_digits`] of normal numbers: at most half a unit of the last digit.
pub fn rounding_error(digits: usize) -> f64 {
    match needed_bits(digits) {
        MANTISSA_BITS => 0.0,
        bits => 0.5f64.powi(bits as i32 + 1),
    }
}

/// Rounds the mantissa of a number to the bits that `digits` significant decimal digits need, to nearest and even.
pub fn round_to_digits(value: f64, digits: usize) -> f64 {
    let dropped = MANTISSA_BITS - needed_bits(digits);
    if dropped == 0 || !value.is_finite() {
        return value;
    }
    let (bits, unit) = (value.to_bits(), 1u64 << dropped);
    let is_odd = (bits >> dropped) & 1;
    let rounded = f64::from_bits((bits + (unit / 2 - 1) + is_odd) & !(unit - 1));
    // The largest numbers would be rounded to infinity.
    if rounded.is_finite() { rounded } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits() {
        assert_eq!(rounding_error(4), 0.5f64.powi(15));
        let mut largest = 0.0f64;
        for index in 0..2000 {
            let value = (1.0 + f64::from(index) * 7.3e-4) * 10f64.powi(index % 40 - 20);
            for digits in 1..=15 {
                for value in [value, -value] {
                    let error = ((round_to_digits(value, digits) - value) / value).abs();
                    assert!(error <= rounding_error(digits));
                    assert!(rounding_error(digits) <= 0.5 * 0.1f64.powi(digits as i32));
                    if digits == 4 {
                        largest = largest.max(error);
                    }
                }
            }
        }
        assert!(largest > 0.9 * rounding_error(4));
        // 1 + 3·2⁻¹⁵ lies midway between 1 + 2⁻¹⁴ and 1 + 2·2⁻¹⁴, of which the second is even.
        assert_eq!(round_to_digits(1.0 + 3.0 * 0.5f64.powi(15), 4), 1.0 + 0.5f64.powi(13));
        assert_eq!(round_to_digits(1.0 + 0.5f64.powi(15), 4), 1.0);
        for value in [0.0, f64::MAX, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(round_to_digits(value, 2), value);
        }
        assert!(
            round_to_digits(-0.0, 2).is_sign_negative() && round_to_digits(f64::NAN, 2).is_nan()
        );
        assert_eq!(round_to_digits(2.0 - f64::EPSILON, 3), 2.0);
    }
}
