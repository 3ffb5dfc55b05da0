//! Traits of the number types of sweeps: floating-point scalars, groups of them in a cache line, and groups in
//! registers.

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use models::common::number::Number;

/// Floating-point scalar: `f32` or `f64`.
pub trait Real: Number + PartialOrd {
    /// Group of numbers that fills a cache line of 64 bytes.
    type Lanes: LaneGroup<Self> + Vector<Self>;

    /// Such a group in registers that every processor of the architecture has.
    type Baseline: Vector<Self>;

    /// Converts to double precision, exactly.
    fn to_f64(self) -> f64;

    /// Writes numbers as little-endian bytes, as many as there is room for.
    fn write_bytes(numbers: &[Self], bytes: &mut [u8]);

    /// Reads numbers from little-endian bytes, as many as there are.
    fn read_bytes(bytes: &[u8], numbers: &mut [Self]);

    /// Converts little-endian bytes to numbers; `None` if their count is not a multiple of the size of a number.
    fn from_bytes(bytes: &[u8]) -> Option<Vec<Self>> {
        let count = bytes.len() / size_of::<Self>();
        if count * size_of::<Self>() != bytes.len() {
            return None;
        }
        let mut numbers = vec![Self::ZERO; count];
        Self::read_bytes(bytes, &mut numbers);
        Some(numbers)
    }

    /// Runs a kernel in registers of 256 bits.
    ///
    /// # Safety
    /// The processor has AVX2.
    #[doc(hidden)]
    unsafe fn run_avx2(kernel: impl SimdKernel<Self>);

    /// Runs a kernel in registers of 512 bits.
    ///
    /// # Safety
    /// The processor has AVX-512F, DQ and VL.
    #[doc(hidden)]
    unsafe fn run_avx512(kernel: impl SimdKernel<Self>);
}

/// Largest number of lanes of a group, that of `f32`.
pub(crate) const MAX_LANES: usize = 16;

/// Group of numbers, one per lane, in memory.
pub trait LaneGroup<T>: Number {
    /// Number of lanes of the group.
    const COUNT: usize;

    /// Returns a group with `value` in all lanes.
    fn splat(value: T) -> Self;

    /// Returns a group with the number `value(lane)` in each lane.
    fn from_lanes(value: impl FnMut(usize) -> T) -> Self;

    /// Returns the numbers in the lanes.
    fn lanes(&self) -> &[T];

    /// Returns the numbers of the lanes, to be modified.
    fn lanes_mut(&mut self) -> &mut [T];
}

/// `COUNT` numbers in lanes, aligned to a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<T, const COUNT: usize>(pub(crate) [T; COUNT]);

macro_rules! lanewise {
    ($($operation:ident $function:ident $sign:tt),*) => {
        $(impl<T: Number, const COUNT: usize> $operation for Lanes<T, COUNT> {
            type Output = Self;

            #[inline(always)]
            fn $function(mut self, other: Self) -> Self {
                for lane in 0..COUNT {
                    self.0[lane] = self.0[lane] $sign other.0[lane];
                }
                self
            }
        })*
    };
}

lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<T: Number, const COUNT: usize> Neg for Lanes<T, COUNT> {
    type Output = Self;

    #[inline(always)]
    fn neg(mut self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = -self.0[lane];
        }
        self
    }
}

impl<T: Number, const COUNT: usize> Number for Lanes<T, COUNT> {
    const ZERO: Self = Self([T::ZERO; COUNT]);
    const ONE: Self = Self([T::ONE; COUNT]);
    const HALF: Self = Self([T::HALF; COUNT]);
    const THIRD: Self = Self([T::THIRD; COUNT]);
    const QUARTER: Self = Self([T::QUARTER; COUNT]);
    const MIN_POSITIVE: Self = Self([T::MIN_POSITIVE; COUNT]);
    const EPSILON: Self = Self([T::EPSILON; COUNT]);

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self([T::from_f64(value); COUNT])
    }

    #[inline(always)]
    fn max(mut self, other: Self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = self.0[lane].max(other.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn min(mut self, other: Self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = self.0[lane].min(other.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn sqrt(mut self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = self.0[lane].sqrt();
        }
        self
    }

    #[inline(always)]
    fn minmod3(mut self, one: Self, other: Self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = self.0[lane].minmod3(one.0[lane], other.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn flush_below(mut self, limit: Self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = self.0[lane].flush_below(limit.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn any_gt(self, other: Self) -> bool {
        let mut any = false;
        for lane in 0..COUNT {
            any |= self.0[lane].any_gt(other.0[lane]);
        }
        any
    }

    #[inline(always)]
    fn select_gt(self, other: Self, if_greater: Self, mut otherwise: Self) -> Self {
        for lane in 0..COUNT {
            let both = (if_greater.0[lane], otherwise.0[lane]);
            otherwise.0[lane] = self.0[lane].select_gt(other.0[lane], both.0, both.1);
        }
        otherwise
    }
}

impl<T: Number, const COUNT: usize> LaneGroup<T> for Lanes<T, COUNT> {
    const COUNT: usize = COUNT;

    #[inline(always)]
    fn splat(value: T) -> Self {
        Self([value; COUNT])
    }

    fn from_lanes(value: impl FnMut(usize) -> T) -> Self {
        Self(std::array::from_fn(value))
    }

    #[inline(always)]
    fn lanes(&self) -> &[T] {
        &self.0
    }

    #[inline(always)]
    fn lanes_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

/// Group of numbers in registers: operations act lane by lane.
pub trait Vector<T: Real>: Number {
    /// Loads the numbers of a group from memory.
    fn load(from: &T::Lanes) -> Self;

    /// Stores the numbers as a group in memory.
    fn store(self, to: &mut T::Lanes);

    /// Returns a group with `value` in all lanes.
    fn splat(value: T) -> Self;

    /// Shifts lanes up by one: lane i of the result is lane i − 1 of `self`, lane 0 the last lane of `previous`.
    fn shift_in_low(self, previous: Self) -> Self;

    /// Shifts lanes down by one: lane i of the result is lane i + 1 of `self`, the last lane is lane 0 of `next`.
    fn shift_in_high(self, next: Self) -> Self;

    /// Blends two groups: lanes whose bit is set in `lanes` from `other`, all others from `self`.
    fn blend_lanes(self, lanes: u16, other: Self) -> Self;

    /// Compares lane by lane: bit i is set if lane i is greater than lane i of `other`.
    fn greater_lanes(self, other: Self) -> u16;
}

/// Kernel that is compiled for each instruction set. `run` and all functions that it calls must be inlined, to be
/// compiled with the instructions of the set. Closures are not inlined.
pub trait SimdKernel<T: Real> {
    /// Runs the kernel in registers of type `V`.
    fn run<V: Vector<T>>(self);
}
