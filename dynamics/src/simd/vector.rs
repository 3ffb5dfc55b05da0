//! Implementations of [`Vector`] for groups in memory (baseline instruction set) and of [`Real`] for `f32` and `f64`.

use crate::simd::{Lanes, Real, SimdKernel, Vector};

#[cfg(target_arch = "x86_64")]
use super::x86::{Avx2Double, Avx2Single, Avx512Double, Avx512Single, Sse2Double, Sse2Single};

macro_rules! impl_real {
    ($kind:ty, $lanes:literal, $sse2:ident, $avx2:ident in $avx2_module:ident, $avx512:ident in $avx512_module:ident) => {
        // Modules of their own, since the compiler makes a codegen unit of each and compiles several at the same time. Not
        // inlined, so that kernels that other kernels run are compiled once.
        #[cfg(target_arch = "x86_64")]
        mod $avx2_module {
            #[inline(never)]
            #[target_feature(enable = "avx2")]
            pub(super) fn run(kernel: impl super::SimdKernel<$kind>) {
                kernel.run::<super::$avx2>();
            }
        }

        #[cfg(target_arch = "x86_64")]
        mod $avx512_module {
            #[inline(never)]
            #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
            pub(super) fn run(kernel: impl super::SimdKernel<$kind>) {
                kernel.run::<super::$avx512>();
            }
        }

        impl Vector<$kind> for Lanes<$kind, $lanes> {
            #[inline(always)]
            fn load(from: &Self) -> Self {
                *from
            }

            #[inline(always)]
            fn store(self, to: &mut Self) {
                *to = self;
            }

            #[inline(always)]
            fn splat(value: $kind) -> Self {
                Self([value; $lanes])
            }

            #[inline(always)]
            fn shift_in_low(mut self, previous: Self) -> Self {
                self.0.copy_within(..$lanes - 1, 1);
                self.0[0] = previous.0[$lanes - 1];
                self
            }

            #[inline(always)]
            fn shift_in_high(mut self, next: Self) -> Self {
                self.0.copy_within(1.., 0);
                self.0[$lanes - 1] = next.0[0];
                self
            }

            #[inline(always)]
            fn blend_lanes(mut self, lanes: u16, other: Self) -> Self {
                for lane in 0..$lanes {
                    if lanes >> lane & 1 == 1 {
                        self.0[lane] = other.0[lane];
                    }
                }
                self
            }

            #[inline(always)]
            fn greater_lanes(self, other: Self) -> u16 {
                let mut lanes = 0;
                for lane in 0..$lanes {
                    lanes |= u16::from(self.0[lane] > other.0[lane]) << lane;
                }
                lanes
            }
        }

        impl Real for $kind {
            type Lanes = Lanes<Self, $lanes>;
            #[cfg(target_arch = "x86_64")]
            type Baseline = $sse2;
            #[cfg(not(target_arch = "x86_64"))]
            type Baseline = Self::Lanes;

            #[cfg(target_arch = "x86_64")]
            unsafe fn run_avx2(kernel: impl SimdKernel<Self>) {
                // SAFETY: the caller guarantees AVX2.
                unsafe { $avx2_module::run(kernel) }
            }

            #[cfg(target_arch = "x86_64")]
            unsafe fn run_avx512(kernel: impl SimdKernel<Self>) {
                // SAFETY: the caller guarantees AVX-512F, DQ and VL.
                unsafe { $avx512_module::run(kernel) }
            }

            #[cfg(not(target_arch = "x86_64"))]
            unsafe fn run_avx2(kernel: impl SimdKernel<Self>) {
                kernel.run::<Self::Lanes>();
            }

            #[cfg(not(target_arch = "x86_64"))]
            unsafe fn run_avx512(kernel: impl SimdKernel<Self>) {
                kernel.run::<Self::Lanes>();
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }

            fn write_bytes(numbers: &[Self], bytes: &mut [u8]) {
                let (bytes, _) = bytes.as_chunks_mut();
                for (bytes, number) in bytes.iter_mut().zip(numbers) {
                    *bytes = number.to_le_bytes();
                }
            }

            fn read_bytes(bytes: &[u8], numbers: &mut [Self]) {
                let (bytes, _) = bytes.as_chunks();
                for (number, bytes) in numbers.iter_mut().zip(bytes) {
                    *number = Self::from_le_bytes(*bytes);
                }
            }
        }
    };
}

impl_real!(f32, 16, Sse2Single, Avx2Single in avx2_single, Avx512Single in avx512_single);
impl_real!(f64, 8, Sse2Double, Avx2Double in avx2_double, Avx512Double in avx512_double);

#[cfg(test)]
mod tests {
    use crate::simd::InstructionSet;
    use crate::simd::{LaneGroup, Number, Real, SimdKernel, Vector};

    struct Minmod3Kernel<'a, T: Real>(&'a [[T::Lanes; 3]], &'a mut Vec<T::Lanes>);

    impl<T: Real> SimdKernel<T> for Minmod3Kernel<'_, T> {
        #[inline(always)]
        fn run<V: Vector<T>>(self) {
            for [mean, one, other] in self.0 {
                let mut found = T::Lanes::ZERO;
                V::load(mean).minmod3(V::load(one), V::load(other)).store(&mut found);
                self.1.push(found);
            }
        }
    }

    /// Verifies `minmod3` against its definition (the argument of smallest magnitude, or zero if the bounds differ in
    /// sign), bit by bit, in every instruction set.
    fn check_minmod3<T: Real>() {
        let tiny = T::MIN_POSITIVE.to_f64();
        let sizes = [0.0, 1e-3 * tiny, tiny, 1e-3, 0.7, 1.0, 1.5, 1e30, f64::INFINITY];
        let bounds: Vec<f64> = sizes.iter().flat_map(|size| [*size, -size]).collect();
        let mut cases = Vec::new();
        for &one in &bounds {
            for &other in &bounds {
                for mean in sizes.map(|size| size.copysign(one)) {
                    cases.push([mean, one, other]);
                }
            }
        }
        let lanes = T::Lanes::COUNT;
        let groups: Vec<[T::Lanes; 3]> = cases
            .chunks(lanes)
            .map(|chunk| {
                let lane = |which: usize| {
                    T::Lanes::from_lanes(|i| T::from_f64(chunk[i % chunk.len()][which]))
                };
                [lane(0), lane(1), lane(2)]
            })
            .collect();
        for set in InstructionSet::available_sets() {
            let mut found = Vec::new();
            set.run_kernel::<T>(Minmod3Kernel(&groups, &mut found));
            for (place, case) in cases.iter().enumerate() {
                let [mean, one, other] = case.map(|value| T::from_f64(value).to_f64());
                let differ = one.is_sign_negative() != other.is_sign_negative();
                let smallest = mean.abs().min(one.abs()).min(other.abs()).copysign(one);
                let expected = if differ { 0.0 } else { smallest };
                let found = found[place / lanes].lanes()[place % lanes].to_f64();
                assert_eq!(found.to_bits(), expected.to_bits(), "{set:?} {case:?}");
            }
        }
    }

    struct FlushKernel<'a, T: Real>(T::Lanes, T, &'a mut T::Lanes);

    impl<T: Real> SimdKernel<T> for FlushKernel<'_, T> {
        #[inline(always)]
        fn run<V: Vector<T>>(self) {
            V::load(&self.0).flush_below(<V as Vector<T>>::splat(self.1)).store(self.2);
        }
    }

    /// Verifies that `flush_below` turns magnitudes below a limit into +0 and leaves all others, NaN included,
    /// unchanged, bit by bit, in every instruction set.
    fn check_flush<T: Real>() {
        let limit = 1e-3;
        let magnitudes = [0.0, 1e-40, 0.9e-3, 1e-3, 1.1e-3, 7.0, f64::INFINITY, f64::NAN];
        for sign in [1.0, -1.0] {
            let group = T::Lanes::from_lanes(|lane| {
                T::from_f64(sign * magnitudes[lane % magnitudes.len()])
            });
            for set in InstructionSet::available_sets() {
                let mut found = T::Lanes::ZERO;
                set.run_kernel::<T>(FlushKernel(group, T::from_f64(limit), &mut found));
                for (group, found) in group.lanes().iter().zip(found.lanes()) {
                    let is_below = group.to_f64().abs() < T::from_f64(limit).to_f64();
                    let expected = if is_below { 0.0 } else { group.to_f64() };
                    assert_eq!(found.to_f64().to_bits(), expected.to_bits(), "{set:?} {group:?}");
                }
            }
        }
    }

    #[test]
    fn flush_zeroes_small_values_in_every_instruction_set() {
        check_flush::<f64>();
        check_flush::<f32>();
    }

    #[test]
    fn minmod3_matches_its_definition_in_every_instruction_set() {
        check_minmod3::<f64>();
        check_minmod3::<f32>();
    }

    struct LaneShiftKernel<'a, T: Real>(u16, &'a mut [T::Lanes; 3]);

    impl<T: Real> SimdKernel<T> for LaneShiftKernel<'_, T> {
        #[inline(always)]
        fn run<V: Vector<T>>(self) {
            let Self(lanes, moved) = self;
            let [first, second] = [0.0, 100.0]
                .map(|from| T::Lanes::from_lanes(|lane| T::from_f64(from + lane as f64)));
            let (first, second) = (V::load(&first), V::load(&second));
            first.shift_in_low(second).store(&mut moved[0]);
            first.shift_in_high(second).store(&mut moved[1]);
            first.blend_lanes(lanes, second).store(&mut moved[2]);
        }
    }

    /// Verifies `shift_in_low`, `shift_in_high` and `blend_lanes` on a group with the numbers 0, 1, … and another one
    /// with 100, 101, …, for each single lane, for no lane and for a mixed selection, in every instruction set.
    fn check_lane_shifts<T: Real>() {
        let count = T::Lanes::COUNT;
        let choices = (0..count).map(|lane| 1 << lane).chain([0, 0b1010_0110_0101_1001]);
        for lanes in choices {
            let expected: [Vec<f64>; 3] = [
                (0..count)
                    .map(|i| if i == 0 { 99.0 + count as f64 } else { i as f64 - 1.0 })
                    .collect(),
                (1..=count).map(|i| if i == count { 100.0 } else { i as f64 }).collect(),
                (0..count).map(|i| i as f64 + f64::from(lanes >> i & 1) * 100.0).collect(),
            ];
            for set in InstructionSet::available_sets() {
                let mut shifted = [T::Lanes::ZERO; 3];
                set.run_kernel::<T>(LaneShiftKernel(lanes, &mut shifted));
                for (shifted, expected) in shifted.iter().zip(&expected) {
                    let found: Vec<f64> =
                        shifted.lanes().iter().map(|lane| lane.to_f64()).collect();
                    assert_eq!(&found, expected, "{set:?} {lanes:b}");
                }
            }
        }
    }

    struct ComparisonKernel<'a, T: Real>([T::Lanes; 2], &'a mut T::Lanes, &'a mut u16);

    impl<T: Real> SimdKernel<T> for ComparisonKernel<'_, T> {
        #[inline(always)]
        fn run<V: Vector<T>>(self) {
            let [one, other] = [V::load(&self.0[0]), V::load(&self.0[1])];
            one.select_gt(other, V::ONE, V::HALF).store(self.1);
            *self.2 = one.greater_lanes(other);
        }
    }

    /// Verifies `select_gt` and `greater_lanes` lane by lane, zeros of both signs, infinite numbers and NaN included, in
    /// every instruction set.
    fn check_comparisons<T: Real>() {
        let values = [0.0, -0.0, 1.0, -1.0, 2.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        for shift in 0..values.len() {
            let one = |lane: usize| T::from_f64(values[lane % values.len()]);
            // Sixteen lanes compare each number with two others.
            let other = |lane: usize| {
                T::from_f64(values[(lane + lane / values.len() + shift) % values.len()])
            };
            let groups = [T::Lanes::from_lanes(one), T::Lanes::from_lanes(other)];
            for set in InstructionSet::available_sets() {
                let (mut chosen, mut lanes) = (T::Lanes::ZERO, 0);
                set.run_kernel::<T>(ComparisonKernel(groups, &mut chosen, &mut lanes));
                for (lane, chosen) in chosen.lanes().iter().enumerate() {
                    let is_greater = one(lane) > other(lane);
                    let expected = if is_greater { T::ONE } else { T::HALF };
                    assert_eq!(chosen.to_f64(), expected.to_f64(), "{set:?} {lane} {shift}");
                    assert_eq!(lanes >> lane & 1 == 1, is_greater, "{set:?} {lane} {shift}");
                }
            }
        }
    }

    #[test]
    fn comparisons_agree_in_every_instruction_set() {
        check_comparisons::<f64>();
        check_comparisons::<f32>();
    }

    #[test]
    fn lanes_shift_and_blend_in_every_instruction_set() {
        check_lane_shifts::<f64>();
        check_lane_shifts::<f32>();
    }
}
