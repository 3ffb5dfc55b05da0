//! Registers of x86-64: AVX2 and AVX-512.
//!
//! SAFETY of all unsafe blocks below: the register types are used only in `Real::run_avx2` and `Real::run_avx512`,
//! whose callers guarantee the instruction set; addresses come from references to as many numbers as are read or
//! written.

use crate::simd::{Lanes, Number, Vector};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! register_vector {
    (
        $(#[$about:meta])*
        $name:ident, $scalar:ty, $register:ty, $count:literal of $width:literal,
        $add:ident $sub:ident $mul:ident $div:ident $max:ident $min:ident $sqrt:ident
        $load:ident $store:ident $gt:ident $minmod3:ident $flush:ident $shift:ident $blend:ident
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name([$register; $count]);

        register_vector!(@binary $name, $count, Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);

        impl $name {
            const fn splat(value: $scalar) -> Self {
                // SAFETY: a register has the memory layout of an array of its numbers.
                Self(unsafe {
                    std::mem::transmute::<[$scalar; $count * $width], [$register; $count]>(
                        [value; $count * $width],
                    )
                })
            }
        }

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                // Not 0 − x, which is +0 instead of −0 for x = +0.
                Self::splat(-1.0) * self
            }
        }

        impl Number for $name {
            const ZERO: Self = Self::splat(0.0);
            const ONE: Self = Self::splat(1.0);
            const HALF: Self = Self::splat(0.5);
            const THIRD: Self = Self::splat(1.0 / 3.0);
            const QUARTER: Self = Self::splat(0.25);
            const MIN_POSITIVE: Self = Self::splat(<$scalar>::MIN_POSITIVE);
            const EPSILON: Self = Self::splat(<$scalar>::EPSILON);

            #[inline(always)]
            #[allow(clippy::unnecessary_cast, reason = "it is one for f32")]
            fn from_f64(value: f64) -> Self {
                Self::splat(value as $scalar)
            }

            #[inline(always)]
            fn max(mut self, other: Self) -> Self {
                for i in 0..$count {
                    self.0[i] = unsafe { $max(self.0[i], other.0[i]) };
                }
                self
            }

            #[inline(always)]
            fn min(mut self, other: Self) -> Self {
                for i in 0..$count {
                    self.0[i] = unsafe { $min(self.0[i], other.0[i]) };
                }
                self
            }

            #[inline(always)]
            fn sqrt(mut self) -> Self {
                for i in 0..$count {
                    self.0[i] = unsafe { $sqrt(self.0[i]) };
                }
                self
            }

            #[inline(always)]
            fn minmod3(mut self, one: Self, other: Self) -> Self {
                for i in 0..$count {
                    self.0[i] = unsafe { $minmod3(self.0[i], one.0[i], other.0[i]) };
                }
                self
            }

            #[inline(always)]
            fn flush_below(mut self, limit: Self) -> Self {
                for i in 0..$count {
                    self.0[i] = unsafe { $flush(self.0[i], limit.0[i]) };
                }
                self
            }

            #[inline(always)]
            fn any_gt(self, other: Self) -> bool {
                self.greater_lanes(other) != 0
            }

            #[inline(always)]
            fn select_gt(self, other: Self, if_greater: Self, otherwise: Self) -> Self {
                otherwise.blend_lanes(self.greater_lanes(other), if_greater)
            }
        }

        impl Vector<$scalar> for $name {
            #[inline(always)]
            fn load(from: &Lanes<$scalar, { $count * $width }>) -> Self {
                let mut group = Self::ZERO;
                for i in 0..$count {
                    group.0[i] = unsafe { $load(from.0.as_ptr().add(i * $width)) };
                }
                group
            }

            #[inline(always)]
            fn store(self, to: &mut Lanes<$scalar, { $count * $width }>) {
                for i in 0..$count {
                    unsafe { $store(to.0.as_mut_ptr().add(i * $width), self.0[i]) };
                }
            }

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                Self::splat(value)
            }

            #[inline(always)]
            fn shift_in_low(mut self, previous: Self) -> Self {
                let mut last = previous.0[$count - 1];
                for i in 0..$count {
                    let operand = self.0[i];
                    self.0[i] = unsafe { $shift::<{ $width - 1 }>(operand, last) };
                    last = operand;
                }
                self
            }

            #[inline(always)]
            fn shift_in_high(mut self, next: Self) -> Self {
                let mut first = next.0[0];
                for i in (0..$count).rev() {
                    let operand = self.0[i];
                    self.0[i] = unsafe { $shift::<1>(first, operand) };
                    first = operand;
                }
                self
            }

            #[inline(always)]
            fn blend_lanes(mut self, lanes: u16, other: Self) -> Self {
                for i in 0..$count {
                    let lanes = lanes >> (i * $width);
                    self.0[i] = unsafe { $blend(self.0[i], lanes, other.0[i]) };
                }
                self
            }

            #[inline(always)]
            fn greater_lanes(self, other: Self) -> u16 {
                let mut lanes = 0;
                for i in 0..$count {
                    lanes |= unsafe { $gt(self.0[i], other.0[i]) } << (i * $width);
                }
                lanes
            }
        }
    };
    (@binary $name:ident, $count:literal, $($operation:ident $function:ident $instruction:ident),*) => {
        $(impl $operation for $name {
            type Output = Self;

            #[inline(always)]
            fn $function(mut self, other: Self) -> Self {
                for i in 0..$count {
                    self.0[i] = unsafe { $instruction(self.0[i], other.0[i]) };
                }
                self
            }
        })*
    };
}

// Greater-than masks: bit i is set if number i of `one` is greater than number i of `other`.

#[inline(always)]
unsafe fn gt_double256(one: __m256d, other: __m256d) -> u16 {
    unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(one, other)) as u16 }
}

#[inline(always)]
unsafe fn gt_single256(one: __m256, other: __m256) -> u16 {
    unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(one, other)) as u16 }
}

#[inline(always)]
unsafe fn gt_double512(one: __m512d, other: __m512d) -> u16 {
    unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(one, other).into() }
}

#[inline(always)]
unsafe fn gt_single512(one: __m512, other: __m512) -> u16 {
    unsafe { _mm512_cmp_ps_mask::<_CMP_GT_OQ>(one, other) }
}

// Shifts across two registers: numbers `BY`, `BY` + 1, … of the concatenation of `low` and `high`.

#[inline(always)]
unsafe fn shift_double256<const BY: i32>(high: __m256d, low: __m256d) -> __m256d {
    unsafe {
        let (high, low) = (_mm256_castpd_si256(high), _mm256_castpd_si256(low));
        let middle = _mm256_permute2x128_si256::<0x21>(low, high);
        _mm256_castsi256_pd(match BY {
            1 => _mm256_alignr_epi8::<8>(middle, low),
            _ => _mm256_alignr_epi8::<8>(high, middle),
        })
    }
}

#[inline(always)]
unsafe fn shift_single256<const BY: i32>(high: __m256, low: __m256) -> __m256 {
    unsafe {
        let (high, low) = (_mm256_castps_si256(high), _mm256_castps_si256(low));
        let middle = _mm256_permute2x128_si256::<0x21>(low, high);
        _mm256_castsi256_ps(match BY {
            1 => _mm256_alignr_epi8::<4>(middle, low),
            _ => _mm256_alignr_epi8::<12>(high, middle),
        })
    }
}

#[inline(always)]
unsafe fn shift_double512<const BY: i32>(high: __m512d, low: __m512d) -> __m512d {
    unsafe {
        let (high, low) = (_mm512_castpd_si512(high), _mm512_castpd_si512(low));
        _mm512_castsi512_pd(_mm512_alignr_epi64::<BY>(high, low))
    }
}

#[inline(always)]
unsafe fn shift_single512<const BY: i32>(high: __m512, low: __m512) -> __m512 {
    unsafe {
        let (high, low) = (_mm512_castps_si512(high), _mm512_castps_si512(low));
        _mm512_castsi512_ps(_mm512_alignr_epi32::<BY>(high, low))
    }
}

// Blends: numbers of `other` where the bit of `lanes` is set, numbers of `operand` elsewhere.

#[inline(always)]
unsafe fn blend_double256(operand: __m256d, lanes: u16, other: __m256d) -> __m256d {
    unsafe {
        let bits = _mm256_set_epi64x(8, 4, 2, 1);
        let chosen = _mm256_and_si256(_mm256_set1_epi64x(lanes.into()), bits);
        let chosen = _mm256_castsi256_pd(_mm256_cmpeq_epi64(chosen, bits));
        _mm256_blendv_pd(operand, other, chosen)
    }
}

#[inline(always)]
unsafe fn blend_single256(operand: __m256, lanes: u16, other: __m256) -> __m256 {
    unsafe {
        let bits = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
        let chosen = _mm256_and_si256(_mm256_set1_epi32(lanes.into()), bits);
        let chosen = _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, bits));
        _mm256_blendv_ps(operand, other, chosen)
    }
}

#[inline(always)]
unsafe fn blend_double512(operand: __m512d, lanes: u16, other: __m512d) -> __m512d {
    unsafe { _mm512_mask_mov_pd(operand, lanes as u8, other) }
}

#[inline(always)]
unsafe fn blend_single512(operand: __m512, lanes: u16, other: __m512) -> __m512 {
    unsafe { _mm512_mask_mov_ps(operand, lanes, other) }
}

// Three-argument minmod: bit patterns of numbers of equal sign are ordered as their magnitudes, and integer minima
// leave the floating-point units free. AVX2 has no minimum of 64-bit integers: doubles use that of floating-point
// magnitudes.

#[inline(always)]
unsafe fn minmod3_double256(mean: __m256d, one: __m256d, other: __m256d) -> __m256d {
    unsafe {
        let sign = _mm256_set1_pd(-0.0);
        let (mean, smallest) = (_mm256_andnot_pd(sign, mean), _mm256_andnot_pd(sign, one));
        let last = _mm256_andnot_pd(sign, other);
        let smallest = _mm256_min_pd(_mm256_min_pd(mean, smallest), last);
        let smallest = _mm256_or_pd(smallest, _mm256_and_pd(sign, one));
        _mm256_blendv_pd(smallest, _mm256_setzero_pd(), _mm256_xor_pd(one, other))
    }
}

#[inline(always)]
unsafe fn minmod3_single256(mean: __m256, one: __m256, other: __m256) -> __m256 {
    unsafe {
        let (mean, smallest, last) =
            (_mm256_castps_si256(mean), _mm256_castps_si256(one), _mm256_castps_si256(other));
        let smallest = _mm256_min_epu32(_mm256_min_epu32(mean, smallest), last);
        let differ = _mm256_xor_ps(one, other);
        _mm256_blendv_ps(_mm256_castsi256_ps(smallest), _mm256_setzero_ps(), differ)
    }
}

#[inline(always)]
unsafe fn minmod3_double512(mean: __m512d, one: __m512d, other: __m512d) -> __m512d {
    unsafe {
        let (mean, one, other) =
            (_mm512_castpd_si512(mean), _mm512_castpd_si512(one), _mm512_castpd_si512(other));
        let same = _mm512_movepi64_mask(_mm512_ternarylogic_epi64::<XNOR_TABLE>(one, one, other));
        let smallest = _mm512_min_epu64(one, other);
        _mm512_castsi512_pd(_mm512_maskz_min_epu64(same, smallest, mean))
    }
}

#[inline(always)]
unsafe fn minmod3_single512(mean: __m512, one: __m512, other: __m512) -> __m512 {
    unsafe {
        let (mean, one, other) =
            (_mm512_castps_si512(mean), _mm512_castps_si512(one), _mm512_castps_si512(other));
        let same = _mm512_movepi32_mask(_mm512_ternarylogic_epi32::<XNOR_TABLE>(one, one, other));
        let smallest = _mm512_min_epu32(one, other);
        _mm512_castsi512_ps(_mm512_maskz_min_epu32(same, smallest, mean))
    }
}

/// Truth table for `_mm512_ternarylogic_epi64` and `_mm512_ternarylogic_epi32`: XNOR of the second and the third
/// operand.
const XNOR_TABLE: i32 = 0b1001_1001;

// Flushes magnitudes below a limit to zero; NaN is unchanged.

#[inline(always)]
unsafe fn flush_double256(operand: __m256d, limit: __m256d) -> __m256d {
    unsafe {
        let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), operand);
        _mm256_and_pd(operand, _mm256_cmp_pd::<_CMP_NLT_UQ>(size, limit))
    }
}

#[inline(always)]
unsafe fn flush_single256(operand: __m256, limit: __m256) -> __m256 {
    unsafe {
        let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), operand);
        _mm256_and_ps(operand, _mm256_cmp_ps::<_CMP_NLT_UQ>(size, limit))
    }
}

#[inline(always)]
unsafe fn flush_double512(operand: __m512d, limit: __m512d) -> __m512d {
    unsafe {
        let is_kept = _mm512_cmp_pd_mask::<_CMP_NLT_UQ>(_mm512_abs_pd(operand), limit);
        _mm512_maskz_mov_pd(is_kept, operand)
    }
}

#[inline(always)]
unsafe fn flush_single512(operand: __m512, limit: __m512) -> __m512 {
    unsafe {
        let is_kept = _mm512_cmp_ps_mask::<_CMP_NLT_UQ>(_mm512_abs_ps(operand), limit);
        _mm512_maskz_mov_ps(is_kept, operand)
    }
}

register_vector!(
    /// Eight `f64` in two AVX2 registers of four.
    Avx2Double, f64, __m256d, 2 of 4,
    _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_max_pd _mm256_min_pd
    _mm256_sqrt_pd _mm256_load_pd _mm256_store_pd gt_double256 minmod3_double256 flush_double256
    shift_double256 blend_double256
);
register_vector!(
    /// Sixteen `f32` in two AVX2 registers of eight.
    Avx2Single, f32, __m256, 2 of 8,
    _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_max_ps _mm256_min_ps
    _mm256_sqrt_ps _mm256_load_ps _mm256_store_ps gt_single256 minmod3_single256 flush_single256
    shift_single256 blend_single256
);
register_vector!(
    /// Eight `f64` in an AVX-512 register.
    Avx512Double, f64, __m512d, 1 of 8,
    _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_max_pd _mm512_min_pd
    _mm512_sqrt_pd _mm512_load_pd _mm512_store_pd gt_double512 minmod3_double512 flush_double512
    shift_double512 blend_double512
);
register_vector!(
    /// Sixteen `f32` in an AVX-512 register.
    Avx512Single, f32, __m512, 1 of 16,
    _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_max_ps _mm512_min_ps
    _mm512_sqrt_ps _mm512_load_ps _mm512_store_ps gt_single512 minmod3_single512 flush_single512
    shift_single512 blend_single512
);
