//! Exact summation: results do not depend on the order of the terms.
//!
//! An accumulator holds a sum exactly, as a fixed-point number that spans the range of double precision (Kulisch 1971;
//! the "small superaccumulator" of Neal 2015, *Fast exact summation using small and large superaccumulators*).
//! Subdomains, threads and tiles may add terms and merge accumulators in any order; the sum is rounded once.

/// Number of bits of a digit.
const DIGIT_BITS: usize = 32;

/// Number of digits: from the smallest subnormal number 2⁻¹⁰⁷⁴ to 2¹⁰²⁴, plus two digits for carries.
const DIGIT_COUNT: usize = (1074_usize + 1024).div_ceil(DIGIT_BITS) + 2;

/// Maximum number of terms between two carry propagations: a term adds less than 2³² to a digit, which holds up to 2⁶³.
const MAX_PENDING_TERMS: u32 = 1 << 30;

/// Number of terms per vector in [`ExactSum::add_terms`].
const GROUP_SIZE: usize = 8;
/// Maximum number of splitting levels of [`ExactSum::add_terms`].
const MAX_SPLIT_LEVELS: usize = 3;

/// Exact sum of `f64` terms.
#[derive(Clone, Debug)]
pub(crate) struct ExactSum {
    /// Digit i is the coefficient of 2^(32 i − 1074), of either sign.
    digits: [i64; DIGIT_COUNT],
    /// Number of terms that may be added before carries must be propagated.
    remaining_terms: u32,
    /// Sum of the non-finite terms; zero if there are none.
    non_finite_sum: f64,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self { digits: [0; DIGIT_COUNT], remaining_terms: MAX_PENDING_TERMS, non_finite_sum: 0.0 }
    }
}

impl ExactSum {
    /// Adds a term to the sum, exactly.
    #[inline]
    pub(crate) fn add(&mut self, term: f64) {
        // Fast path: many cells are at rest in typical states.
        if term == 0.0 {
            return;
        }
        let bits = term.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as usize;
        let fraction = bits & ((1 << 52) - 1);
        if exponent == 0x7ff {
            self.non_finite_sum += term;
            return;
        }
        // Subnormal numbers have the exponent of the smallest normal ones and no implicit leading bit.
        let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        let bit_position = exponent.saturating_sub(1);
        let (digit, shift) = (bit_position / DIGIT_BITS, bit_position % DIGIT_BITS);
        let shifted = u128::from(mantissa) << shift;
        let sign = 1 - 2 * (bits >> 63) as i64;
        for (digit_sum, position) in self.digits[digit..digit + 3].iter_mut().zip([0, 1, 2]) {
            *digit_sum += sign * i64::from((shifted >> (position * DIGIT_BITS)) as u32);
        }
        self.remaining_terms -= 1;
        if self.remaining_terms == 0 {
            self.propagate_carries();
        }
    }

    /// Adds many terms and overwrites them; vectorised in groups of [`GROUP_SIZE`] as long as the terms have similar
    /// magnitudes.
    ///
    /// For the anchor A = 3/2 · 2ᵉ, with e so large that no partial sum of the terms t reaches 2ᵉ, h = (t + A) − A is t
    /// rounded to a multiple of ulp(A), t − h is exact, and so are sums of all h (Demmel & Nguyen 2015, *Parallel
    /// reproducible summation*). The remainders t − h are split in the same way. They are added one by one after
    /// [`MAX_SPLIT_LEVELS`] levels, or if e is outside −900 … 899.
    #[inline(always)]
    pub(crate) fn add_terms(&mut self, terms: &mut [f64]) {
        let (groups, ungrouped) = terms.as_chunks_mut::<GROUP_SIZE>();
        let mut levels = 0;
        loop {
            // Bit patterns of absolute values are ordered like the values; non-finite ones are largest.
            let mut largest_bits = [0_u64; GROUP_SIZE];
            for group in groups.iter() {
                for (largest_bits, term) in largest_bits.iter_mut().zip(group) {
                    *largest_bits = (*largest_bits).max(term.abs().to_bits());
                }
            }
            let largest_bits = largest_bits.into_iter().fold(0, u64::max);
            if largest_bits == 0 {
                break ungrouped.iter().for_each(|term| self.add(*term));
            }
            // Exponent e of the anchor A: that of the largest term, plus log₂ of the number of terms in groups (rounded
            // up to a power of two), plus two.
            let bits = (GROUP_SIZE * groups.len()).next_power_of_two().trailing_zeros() as i32 + 2;
            let exponent = (largest_bits >> 52) as i32 - 1023 + bits;
            if levels == MAX_SPLIT_LEVELS || !(-900..900).contains(&exponent) {
                break groups
                    .as_flattened()
                    .iter()
                    .chain(ungrouped.iter())
                    .for_each(|term| self.add(*term));
            }
            levels += 1;
            let anchor = 1.5 * power_of_two(exponent);
            let mut sums = [0.0; GROUP_SIZE];
            for group in groups.iter_mut() {
                for (sum, term) in sums.iter_mut().zip(group) {
                    let high = (*term + anchor) - anchor;
                    *sum += high;
                    *term -= high;
                }
            }
            sums.into_iter().for_each(|sum| self.add(sum));
        }
    }

    /// Adds all terms of another accumulator.
    pub(crate) fn merge(&mut self, addend: &Self) {
        let mut addend = addend.clone();
        addend.propagate_carries();
        self.propagate_carries();
        for (own, digit) in self.digits.iter_mut().zip(addend.digits) {
            *own += digit;
        }
        self.remaining_terms -= 1;
        self.non_finite_sum += addend.non_finite_sum;
    }

    /// Propagates carries: all digits but the highest are then in 0 … 2³² − 1.
    fn propagate_carries(&mut self) {
        let mut carry = 0;
        let (highest_digit, lower_digits) = self.digits.split_last_mut().expect("there are digits");
        for digit in lower_digits {
            let sum = *digit + carry;
            carry = sum >> DIGIT_BITS;
            *digit = sum & ((1 << DIGIT_BITS) - 1);
        }
        *highest_digit += carry;
        self.remaining_terms = MAX_PENDING_TERMS;
    }

    /// Returns the sign of the sum and the digits of its absolute value, all in 0 … 2³² − 1.
    fn sign_and_magnitude(&self) -> (f64, [i64; DIGIT_COUNT]) {
        let mut normalised = self.clone();
        normalised.propagate_carries();
        if normalised.digits[DIGIT_COUNT - 1] >= 0 {
            return (1.0, normalised.digits);
        }
        normalised.digits.iter_mut().for_each(|digit| *digit = -*digit);
        normalised.propagate_carries();
        (-1.0, normalised.digits)
    }

    /// Returns the sum, rounded to nearest; +0 if it is zero, the sum of the non-finite terms if there are any.
    pub(crate) fn to_f64(&self) -> f64 {
        if self.non_finite_sum != 0.0 {
            return self.non_finite_sum;
        }
        let (sign, digits) = self.sign_and_magnitude();
        let Some(first) = digits.iter().rposition(|digit| *digit != 0) else { return 0.0 };
        let low = first.saturating_sub(2);
        let upper = digits[low..=first]
            .iter()
            .rev()
            .fold(0, |sum: u128, digit| sum << DIGIT_BITS | *digit as u128);
        // Sticky bit: digits below the three highest ones decide ties.
        let sticky = u128::from(digits[..low].iter().any(|digit| *digit != 0));
        sign * scale_by_power_of_two((upper << 1 | sticky) as f64, (low * DIGIT_BITS) as i32 - 1075)
    }

    /// Returns numbers whose exact sum is this sum if it is in the range of `f64`, for checkpoints: one for each digit
    /// that is not zero, and the sum of the non-finite terms if there are any.
    pub(crate) fn to_terms(&self) -> Vec<f64> {
        let (sign, digits) = self.sign_and_magnitude();
        let part = |(index, digit): (usize, &i64)| {
            sign * scale_by_power_of_two(*digit as f64, (index * DIGIT_BITS) as i32 - 1074)
        };
        let finite = digits.iter().enumerate().filter(|(_, digit)| **digit != 0).map(part);
        finite.chain(Some(self.non_finite_sum).filter(|rest| *rest != 0.0)).collect()
    }
}

/// Computes `number`·2^`exponent`, rounded once if the result is subnormal.
fn scale_by_power_of_two(mut number: f64, mut exponent: i32) -> f64 {
    while exponent > 1023 {
        number *= power_of_two(1023);
        exponent -= 1023;
    }
    if exponent < -1022 {
        // The first factor keeps the number far above the subnormal range.
        number *= power_of_two(exponent + 1022 / 2);
        exponent = -1022 / 2;
    }
    number * power_of_two(exponent)
}

/// Computes 2^`exponent` for exponents from −1022 to 1023.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

impl FromIterator<f64> for ExactSum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Self::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::ExactSum;
    use testkit::random::RandomNumbers;

    /// Random numbers of either sign: uniform in [−1, 1] times a factor log-uniform in [1/`exponents`, `exponents`].
    fn random_terms(seed: u64, count: usize, exponents: f64) -> Vec<f64> {
        let mut random = RandomNumbers::new(seed);
        let mut term =
            || random.uniform(-1.0, 1.0) * random.log_uniform(exponents.recip(), exponents);
        (0..count).map(|_| term()).collect()
    }

    fn sum_exactly(terms: &[f64]) -> ExactSum {
        terms.iter().copied().collect()
    }

    /// Verifies sums against 128-bit integers, which are exact for these magnitudes.
    #[test]
    fn sums_are_rounded_once() {
        for seed in 0..200 {
            let integers =
                random_terms(seed, 50, 1e6).into_iter().map(|term| (term * 2e14).trunc());
            let integers: Vec<f64> = integers.collect();
            let exact: i128 = integers.iter().map(|term| *term as i128).sum();
            assert_eq!(sum_exactly(&integers).to_f64(), exact as f64, "{seed}");
            // At the lower end of the range: exact multiples of the smallest subnormal number.
            let smallest: Vec<f64> =
                random_terms(seed, 50, 1e3).iter().map(|term| (term * 1e3).trunc()).collect();
            let exact: f64 = smallest.iter().sum();
            let subnormal: Vec<f64> = smallest.iter().map(|term| term * 5e-324).collect();
            assert_eq!(sum_exactly(&subnormal).to_f64(), exact * 5e-324, "{seed}");
        }
    }

    #[test]
    fn ties_are_rounded_to_even() {
        let one = 1.0;
        let half = f64::EPSILON / 2.0;
        assert_eq!(sum_exactly(&[one, half]).to_f64(), 1.0);
        assert_eq!(sum_exactly(&[one, half, 1e-300]).to_f64(), 1.0 + f64::EPSILON);
        assert_eq!(sum_exactly(&[one, half, -1e-300]).to_f64(), 1.0);
        assert_eq!(sum_exactly(&[1.0 + f64::EPSILON, half]).to_f64(), 1.0 + 2.0 * f64::EPSILON);
        assert_eq!(sum_exactly(&[-one, -half, -1e-300]).to_f64(), -1.0 - f64::EPSILON);
    }

    #[test]
    fn order_and_merging_do_not_matter() {
        for seed in 0..50 {
            let mut terms = random_terms(seed, 300, 1e90);
            // Sums with almost complete cancellation.
            terms.extend(
                random_terms(seed, 300, 1e90).iter().map(|term| -term * (1.0 + f64::EPSILON)),
            );
            let expected = sum_exactly(&terms).to_f64().to_bits();
            let mut random = RandomNumbers::new(seed + 1000);
            for _ in 0..5 {
                for last in (1..terms.len()).rev() {
                    terms.swap(last, random.uniform_index(last + 1));
                }
                let cut = random.uniform_index(terms.len());
                let (mut upper_part, lower_part) =
                    (sum_exactly(&terms[cut..]), sum_exactly(&terms[..cut]));
                upper_part.merge(&lower_part);
                assert_eq!(upper_part.to_f64().to_bits(), expected, "{seed}");
                let stored = upper_part.to_terms();
                assert!(stored.len() < 30);
                assert_eq!(sum_exactly(&stored).to_f64().to_bits(), expected, "{seed}");
            }
        }
    }

    /// Verifies `add_terms` against `add` for similar and very different magnitudes, zeros, non-finite terms, and
    /// numbers of terms that are no multiples of the group size.
    #[test]
    fn adding_many_terms_equals_adding_each() {
        for seed in 0..300 {
            let (count, range) =
                ([0, 1, 7, 8, 64, 333, 5000][seed % 7], [2.0, 1e9, 1e90, 1e250][seed % 4]);
            let mut terms = random_terms(seed as u64, count, range);
            if seed % 3 == 0 {
                terms.iter_mut().step_by(2).for_each(|term| *term = 0.0);
            }
            if seed % 11 == 0 && count > 9 {
                terms[9] = [f64::NAN, f64::INFINITY, f64::MAX, 5e-324][seed % 4];
            }
            let expected = sum_exactly(&terms);
            let mut found = ExactSum::default();
            found.add(0.1);
            found.add_terms(&mut terms);
            found.add(-0.1);
            let [found, expected] =
                [found, expected].map(|sum| (sum.to_f64().to_bits(), sum.to_terms().len()));
            assert_eq!(found, expected, "{seed}");
        }
    }

    /// Verifies `add_terms` for terms of one sign: the largest partial sums for a given magnitude.
    #[test]
    fn terms_of_one_sign_are_summed_exactly() {
        for seed in 0..20 {
            let mut random = RandomNumbers::new(seed);
            let mut terms: Vec<f64> = (0..8192).map(|_| random.uniform(1.9, 2.0)).collect();
            let expected = sum_exactly(&terms).to_f64();
            let mut found = ExactSum::default();
            found.add_terms(&mut terms);
            assert_eq!(found.to_f64(), expected, "{seed}");
        }
    }

    #[test]
    fn extreme_and_non_finite_terms_are_summed_exactly() {
        assert_eq!(ExactSum::default().to_f64().to_bits(), 0.0_f64.to_bits());
        assert_eq!(sum_exactly(&[1e300, 1.0, -1e300]).to_f64(), 1.0);
        assert_eq!(sum_exactly(&[f64::MAX, f64::MAX]).to_f64(), f64::INFINITY);
        assert_eq!(sum_exactly(&[f64::MAX, f64::MAX, -f64::MAX]).to_f64(), f64::MAX);
        assert_eq!(sum_exactly(&[5e-324, -1e-323]).to_f64(), -5e-324);
        assert_eq!(sum_exactly(&[f64::MIN_POSITIVE, -5e-324]).to_f64(), f64::MIN_POSITIVE - 5e-324);
        assert!(sum_exactly(&[1.0, f64::NAN]).to_f64().is_nan());
        assert_eq!(sum_exactly(&[1.0, f64::NEG_INFINITY]).to_f64(), f64::NEG_INFINITY);
        // Digits that exceed 32 bits many times over, with a single carry propagation in `to_f64`.
        let term_count = 5_000_000;
        let ones: ExactSum = (0..term_count).map(|_| 0.1).collect();
        // The double nearest to 0.1 is 3602879701896397 / 2^55.
        let exact = 3_602_879_701_896_397_i128 * term_count;
        assert_eq!(ones.to_f64(), exact as f64 / 55_f64.exp2());
    }
}
