//! What sweeps compute with: floating-point numbers, and groups of them side by side.

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use models::common::number::Number;

/// `f32` or `f64`.
pub trait Real: Number + PartialOrd {
    /// As many numbers as fill a line of the cache.
    type Lanes: Group<Self> + Vector<Self>;

    /// The nearest number of this kind.
    fn of(value: f64) -> Self;

    /// The same number.
    fn wide(self) -> f64;

    /// Its bytes, the least first.
    fn bytes(self) -> impl Iterator<Item = u8>;

    /// Numbers from such bytes; `None` where one is not whole.
    fn from_bytes(bytes: &[u8]) -> Option<Vec<Self>>;

    /// Does the work in registers of 256 bits.
    ///
    /// # Safety
    /// The processor has AVX2.
    #[doc(hidden)]
    unsafe fn avx2(work: impl SimdKernel<Self>);

    /// Does the work in registers of 512 bits.
    ///
    /// # Safety
    /// The processor has AVX-512F, DQ and VL.
    #[doc(hidden)]
    unsafe fn avx512(work: impl SimdKernel<Self>);
}

/// Lanes of the narrowest numbers.
pub(crate) const MOST_LANES: usize = 16;

/// Numbers in lanes.
pub trait Group<T>: Number {
    /// How many.
    const COUNT: usize;

    /// The same number in all lanes.
    fn all(value: T) -> Self;

    /// A number for each lane.
    fn by_lane(value: impl FnMut(usize) -> T) -> Self;

    /// The numbers.
    fn lanes(&self) -> &[T];

    /// The numbers, to be set.
    fn lanes_mut(&mut self) -> &mut [T];
}

/// `COUNT` numbers on a line of the cache.
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
}

impl<T: Number, const COUNT: usize> Group<T> for Lanes<T, COUNT> {
    const COUNT: usize = COUNT;

    #[inline(always)]
    fn all(value: T) -> Self {
        Self([value; COUNT])
    }

    fn by_lane(value: impl FnMut(usize) -> T) -> Self {
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

/// The numbers of a group on their way through a processor.
pub trait Vector<T: Real>: Number {
    /// The numbers of a group.
    fn load(from: &T::Lanes) -> Self;

    /// The numbers as a group.
    fn store(self, to: &mut T::Lanes);

    /// The same number in all lanes.
    fn all(value: T) -> Self;

    /// The lanes moved on by one: in the place of each the one before it, in the first the last of `previous`.
    fn after(self, previous: Self) -> Self;

    /// The lanes moved back by one: in the place of each the one behind it, in the last the first of `next`.
    fn before(self, next: Self) -> Self;

    /// The numbers of another group in some lanes, by bits, and the own ones in the rest.
    fn with_lanes(self, lanes: u16, other: Self) -> Self;

    /// The lanes in which a number is greater than its counterpart, by bits.
    fn greater_lanes(self, other: Self) -> u16;
}

/// Something to be done in any set of instructions: `run` and all that it calls must be inlined, which
/// closures are not.
pub trait SimdKernel<T: Real> {
    /// Does it.
    fn run<V: Vector<T>>(self);
}
