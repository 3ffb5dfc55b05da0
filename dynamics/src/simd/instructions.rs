//! Instruction sets, chosen at run time: each kernel is compiled for all of them.

use super::real::{Real, SimdKernel};

/// Sets of instructions that a processor may have. Results do not depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// What every processor of the kind has.
    Baseline,
    /// 256 bits at once.
    Avx2,
    /// 512 bits at once.
    Avx512,
}

impl Instructions {
    /// Whether this processor has the set.
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Self::Baseline => true,
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        };
        #[cfg(not(target_arch = "x86_64"))]
        return self == Self::Baseline;
    }

    /// The sets that this processor has, the widest last.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|set| set.is_available())
    }

    /// The widest set that this processor has.
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::Baseline)
    }

    /// Does the work in these instructions, or in the baseline's where the processor has not got them.
    pub(crate) fn run<T: Real>(self, work: impl SimdKernel<T>) {
        match self {
            // SAFETY: the processor has AVX2.
            Self::Avx2 if self.is_available() => unsafe { T::avx2(work) },
            // SAFETY: the processor has all three.
            Self::Avx512 if self.is_available() => unsafe { T::avx512(work) },
            _ => work.run::<T::Lanes>(),
        }
    }
}
