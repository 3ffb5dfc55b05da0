//! Registers of x86-64: SSE2, which every such processor has, AVX2 and AVX-512.
//!
//! SAFETY of all unsafe blocks below: the wider register types are used only in `Real::run_avx2` and
//! `Real::run_avx512`, whose callers guarantee the instruction set; addresses come from references to as many numbers
//! as are read or written.

use crate::simd::{Lanes, Number, Vector};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

// Operations are written out for each register: loops, even of one turn, multiply the time to compile the kernels.
macro_rules! register_vector {
    (
        $(#[$about:meta])*
        $name:ident, $scalar:ty, $register:ty, [$($i:literal)*] of $width:literal,
        $add:ident $sub:ident $mul:ident $div:ident $max:ident $min:ident $sqrt:ident
        $load:ident $store:ident $gt:ident $minmod3:ident $flush:ident $shift:ident $blend:ident $select:ident
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name([$register; Self::COUNT]);

        register_vector!(@binary $name, [$($i)*], Add add $add);
        register_vector!(@binary $name, [$($i)*], Sub sub $sub);
        register_vector!(@binary $name, [$($i)*], Mul mul $mul);
        register_vector!(@binary $name, [$($i)*], Div div $div);

        impl $name {
            /// Number of registers.
            const COUNT: usize = [$($i),*].len();

            const fn splat(value: $scalar) -> Self {
                // SAFETY: a register has the memory layout of an array of its numbers.
                Self(unsafe {
                    std::mem::transmute::<[$scalar; Self::COUNT * $width], [$register; Self::COUNT]>(
                        [value; Self::COUNT * $width],
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
            fn max(self, other: Self) -> Self {
                Self([$(unsafe { $max(self.0[$i], other.0[$i]) }),*])
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self([$(unsafe { $min(self.0[$i], other.0[$i]) }),*])
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self([$(unsafe { $sqrt(self.0[$i]) }),*])
            }

            #[inline(always)]
            fn minmod3(self, one: Self, other: Self) -> Self {
                Self([$(unsafe { $minmod3(self.0[$i], one.0[$i], other.0[$i]) }),*])
            }

            #[inline(always)]
            fn flush_below(self, limit: Self) -> Self {
                Self([$(unsafe { $flush(self.0[$i], limit.0[$i]) }),*])
            }

            #[inline(always)]
            fn any_gt(self, other: Self) -> bool {
                self.greater_lanes(other) != 0
            }

            #[inline(always)]
            fn select_gt(self, other: Self, if_greater: Self, otherwise: Self) -> Self {
                Self([$(unsafe {
                    $select(self.0[$i], other.0[$i], if_greater.0[$i], otherwise.0[$i])
                }),*])
            }
        }

        impl Vector<$scalar> for $name {
            #[inline(always)]
            fn load(from: &Lanes<$scalar, { Self::COUNT * $width }>) -> Self {
                Self([$(unsafe { $load(from.0.as_ptr().add($i * $width)) }),*])
            }

            #[inline(always)]
            fn store(self, to: &mut Lanes<$scalar, { Self::COUNT * $width }>) {
                $(unsafe { $store(to.0.as_mut_ptr().add($i * $width), self.0[$i]) };)*
            }

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                Self::splat(value)
            }

            #[inline(always)]
            fn shift_in_low(self, previous: Self) -> Self {
                let registers = [previous.0[Self::COUNT - 1], $(self.0[$i]),*];
                Self([$(unsafe { $shift::<{ $width - 1 }>(registers[$i + 1], registers[$i]) }),*])
            }

            #[inline(always)]
            fn shift_in_high(self, next: Self) -> Self {
                let registers = [$(self.0[$i],)* next.0[0]];
                Self([$(unsafe { $shift::<1>(registers[$i + 1], registers[$i]) }),*])
            }

            #[inline(always)]
            fn blend_lanes(self, lanes: u16, other: Self) -> Self {
                Self([$(unsafe { $blend(self.0[$i], lanes >> ($i * $width), other.0[$i]) }),*])
            }

            #[inline(always)]
            fn greater_lanes(self, other: Self) -> u16 {
                0 $(| unsafe { $gt(self.0[$i], other.0[$i]) } << ($i * $width))*
            }
        }
    };
    (@binary $name:ident, [$($i:literal)*], $operation:ident $function:ident $instruction:ident) => {
        impl $operation for $name {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self([$(unsafe { $instruction(self.0[$i], other.0[$i]) }),*])
            }
        }
    };
}

// Greater-than masks: bit i is set if number i of `one` is greater than number i of `other`.

#[inline(always)]
unsafe fn gt_double128(one: __m128d, other: __m128d) -> u16 {
    unsafe { _mm_movemask_pd(_mm_cmpgt_pd(one, other)) as u16 }
}

#[inline(always)]
unsafe fn gt_single128(one: __m128, other: __m128) -> u16 {
    unsafe { _mm_movemask_ps(_mm_cmpgt_ps(one, other)) as u16 }
}

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

// Choices: numbers of `greater` where `one` is greater than `other`, numbers of `otherwise` elsewhere.

#[inline(always)]
unsafe fn select_double128(
    one: __m128d,
    other: __m128d,
    greater: __m128d,
    otherwise: __m128d,
) -> __m128d {
    unsafe { choose_double128(_mm_cmpgt_pd(one, other), greater, otherwise) }
}

#[inline(always)]
unsafe fn select_single128(
    one: __m128,
    other: __m128,
    greater: __m128,
    otherwise: __m128,
) -> __m128 {
    unsafe { choose_single128(_mm_cmpgt_ps(one, other), greater, otherwise) }
}

#[inline(always)]
unsafe fn select_double256(
    one: __m256d,
    other: __m256d,
    greater: __m256d,
    otherwise: __m256d,
) -> __m256d {
    unsafe { _mm256_blendv_pd(otherwise, greater, _mm256_cmp_pd::<_CMP_GT_OQ>(one, other)) }
}

#[inline(always)]
unsafe fn select_single256(
    one: __m256,
    other: __m256,
    greater: __m256,
    otherwise: __m256,
) -> __m256 {
    unsafe { _mm256_blendv_ps(otherwise, greater, _mm256_cmp_ps::<_CMP_GT_OQ>(one, other)) }
}

#[inline(always)]
unsafe fn select_double512(
    one: __m512d,
    other: __m512d,
    greater: __m512d,
    otherwise: __m512d,
) -> __m512d {
    unsafe { _mm512_mask_mov_pd(otherwise, _mm512_cmp_pd_mask::<_CMP_GT_OQ>(one, other), greater) }
}

#[inline(always)]
unsafe fn select_single512(
    one: __m512,
    other: __m512,
    greater: __m512,
    otherwise: __m512,
) -> __m512 {
    unsafe { _mm512_mask_mov_ps(otherwise, _mm512_cmp_ps_mask::<_CMP_GT_OQ>(one, other), greater) }
}

// Choices by masks, all bits of a number 0 or 1: numbers of `chosen` where they are 1, of `otherwise` elsewhere.

#[inline(always)]
unsafe fn choose_double128(mask: __m128d, chosen: __m128d, otherwise: __m128d) -> __m128d {
    unsafe { _mm_or_pd(_mm_and_pd(mask, chosen), _mm_andnot_pd(mask, otherwise)) }
}

#[inline(always)]
unsafe fn choose_single128(mask: __m128, chosen: __m128, otherwise: __m128) -> __m128 {
    unsafe { _mm_or_ps(_mm_and_ps(mask, chosen), _mm_andnot_ps(mask, otherwise)) }
}

// Shifts across two registers: numbers `BY`, `BY` + 1, … of the concatenation of `low` and `high`.

#[inline(always)]
unsafe fn shift_double128<const BY: i32>(high: __m128d, low: __m128d) -> __m128d {
    // Two numbers in a register: `BY` is 1 in both directions.
    unsafe { _mm_shuffle_pd::<0b01>(low, high) }
}

#[inline(always)]
unsafe fn shift_single128<const BY: i32>(high: __m128, low: __m128) -> __m128 {
    unsafe {
        let (high, low) = (_mm_castps_si128(high), _mm_castps_si128(low));
        _mm_castsi128_ps(match BY {
            1 => _mm_or_si128(_mm_srli_si128::<4>(low), _mm_slli_si128::<12>(high)),
            _ => _mm_or_si128(_mm_srli_si128::<12>(low), _mm_slli_si128::<4>(high)),
        })
    }
}

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
unsafe fn blend_double128(operand: __m128d, lanes: u16, other: __m128d) -> __m128d {
    unsafe {
        let bits = _mm_set_epi32(2, 2, 1, 1);
        let chosen = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(lanes.into()), bits), bits);
        choose_double128(_mm_castsi128_pd(chosen), other, operand)
    }
}

#[inline(always)]
unsafe fn blend_single128(operand: __m128, lanes: u16, other: __m128) -> __m128 {
    unsafe {
        let bits = _mm_set_epi32(8, 4, 2, 1);
        let chosen = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(lanes.into()), bits), bits);
        choose_single128(_mm_castsi128_ps(chosen), other, operand)
    }
}

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
// leave the floating-point units free. AVX2 has a comparison of 64-bit integers, but no minimum. SSE2 has neither: there,
// minima are those of floating-point magnitudes.

#[inline(always)]
unsafe fn minmod3_double128(mean: __m128d, one: __m128d, other: __m128d) -> __m128d {
    unsafe {
        let sign = _mm_set1_pd(-0.0);
        let (mean, smallest) = (_mm_andnot_pd(sign, mean), _mm_andnot_pd(sign, one));
        let smallest = _mm_min_pd(_mm_min_pd(mean, smallest), _mm_andnot_pd(sign, other));
        let smallest = _mm_or_pd(smallest, _mm_and_pd(sign, one));
        // The sign bit of each number, copied to all its bits.
        let differ = _mm_srai_epi32::<31>(_mm_castpd_si128(_mm_xor_pd(one, other)));
        _mm_andnot_pd(_mm_castsi128_pd(_mm_shuffle_epi32::<0b11_11_01_01>(differ)), smallest)
    }
}

#[inline(always)]
unsafe fn minmod3_single128(mean: __m128, one: __m128, other: __m128) -> __m128 {
    unsafe {
        let sign = _mm_set1_ps(-0.0);
        let (mean, smallest) = (_mm_andnot_ps(sign, mean), _mm_andnot_ps(sign, one));
        let smallest = _mm_min_ps(_mm_min_ps(mean, smallest), _mm_andnot_ps(sign, other));
        let smallest = _mm_or_ps(smallest, _mm_and_ps(sign, one));
        let differ = _mm_srai_epi32::<31>(_mm_castps_si128(_mm_xor_ps(one, other)));
        _mm_andnot_ps(_mm_castsi128_ps(differ), smallest)
    }
}

#[inline(always)]
unsafe fn minmod3_double256(mean: __m256d, one: __m256d, other: __m256d) -> __m256d {
    unsafe {
        let smallest = smaller_double256(smaller_double256(one, other), mean);
        _mm256_blendv_pd(smallest, _mm256_setzero_pd(), _mm256_xor_pd(one, other))
    }
}

/// Returns the number of smaller magnitude of two numbers of equal sign.
#[inline(always)]
unsafe fn smaller_double256(one: __m256d, other: __m256d) -> __m256d {
    unsafe {
        let is_greater = _mm256_cmpgt_epi64(_mm256_castpd_si256(one), _mm256_castpd_si256(other));
        _mm256_blendv_pd(one, other, _mm256_castsi256_pd(is_greater))
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
unsafe fn flush_double128(operand: __m128d, limit: __m128d) -> __m128d {
    unsafe {
        let size = _mm_andnot_pd(_mm_set1_pd(-0.0), operand);
        _mm_and_pd(operand, _mm_cmpnlt_pd(size, limit))
    }
}

#[inline(always)]
unsafe fn flush_single128(operand: __m128, limit: __m128) -> __m128 {
    unsafe {
        let size = _mm_andnot_ps(_mm_set1_ps(-0.0), operand);
        _mm_and_ps(operand, _mm_cmpnlt_ps(size, limit))
    }
}

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
    /// Eight `f64` in four SSE2 registers of two.
    Sse2Double, f64, __m128d, [0 1 2 3] of 2,
    _mm_add_pd _mm_sub_pd _mm_mul_pd _mm_div_pd _mm_max_pd _mm_min_pd
    _mm_sqrt_pd _mm_load_pd _mm_store_pd gt_double128 minmod3_double128 flush_double128
    shift_double128 blend_double128 select_double128
);
register_vector!(
    /// Sixteen `f32` in four SSE2 registers of four.
    Sse2Single, f32, __m128, [0 1 2 3] of 4,
    _mm_add_ps _mm_sub_ps _mm_mul_ps _mm_div_ps _mm_max_ps _mm_min_ps
    _mm_sqrt_ps _mm_load_ps _mm_store_ps gt_single128 minmod3_single128 flush_single128
    shift_single128 blend_single128 select_single128
);
register_vector!(
    /// Eight `f64` in two AVX2 registers of four.
    Avx2Double, f64, __m256d, [0 1] of 4,
    _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_max_pd _mm256_min_pd
    _mm256_sqrt_pd _mm256_load_pd _mm256_store_pd gt_double256 minmod3_double256 flush_double256
    shift_double256 blend_double256 select_double256
);
register_vector!(
    /// Sixteen `f32` in two AVX2 registers of eight.
    Avx2Single, f32, __m256, [0 1] of 8,
    _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_max_ps _mm256_min_ps
    _mm256_sqrt_ps _mm256_load_ps _mm256_store_ps gt_single256 minmod3_single256 flush_single256
    shift_single256 blend_single256 select_single256
);
register_vector!(
    /// Eight `f64` in an AVX-512 register.
    Avx512Double, f64, __m512d, [0] of 8,
    _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_max_pd _mm512_min_pd
    _mm512_sqrt_pd _mm512_load_pd _mm512_store_pd gt_double512 minmod3_double512 flush_double512
    shift_double512 blend_double512 select_double512
);
register_vector!(
    /// Sixteen `f32` in an AVX-512 register.
    Avx512Single, f32, __m512, [0] of 16,
    _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_max_ps _mm512_min_ps
    _mm512_sqrt_ps _mm512_load_ps _mm512_store_ps gt_single512 minmod3_single512 flush_single512
    shift_single512 blend_single512 select_single512
);
