//! Instruction sets: each kernel is compiled for all of them, and one is selected at run time.

use super::real::{Real, SimdKernel};

/// Instruction set of a processor; results do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// Instructions of every processor of the architecture.
    Baseline,
    /// AVX2: registers of 256 bits.
    Avx2,
    /// AVX-512 (F, DQ and VL): registers of 512 bits.
    Avx512,
}

impl InstructionSet {
    /// Whether this processor has the instruction set.
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

    /// Returns the instruction sets of this processor, the widest last.
    pub fn available_sets() -> impl Iterator<Item = Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|set| set.is_available())
    }

    /// Returns the widest instruction set of this processor.
    pub fn widest() -> Self {
        Self::available_sets().last().unwrap_or(Self::Baseline)
    }

    /// Runs a kernel with this instruction set, or with the baseline if the processor does not have it.
    pub(crate) fn run_kernel<T: Real>(self, kernel: impl SimdKernel<T>) {
        match self {
            // SAFETY: the processor has AVX2, as `is_available` has checked.
            Self::Avx2 if self.is_available() => unsafe { T::run_avx2(kernel) },
            // SAFETY: the processor has AVX-512F, DQ and VL, as `is_available` has checked.
            Self::Avx512 if self.is_available() => unsafe { T::run_avx512(kernel) },
            _ => kernel.run::<T::Baseline>(),
        }
    }

    /// Runs a kernel with this instruction set, or a slower form with the same results, `compact`, if the set is the
    /// baseline of x86-64 or the processor does not have it. Nearly all x86-64 processors have AVX2; the baseline is not
    /// worth the time to compile the fast forms.
    pub(crate) fn run_kernel_or<T: Real, K: SimdKernel<T>>(
        self,
        kernel: K,
        compact: impl FnOnce(K),
    ) {
        match self {
            // SAFETY: the processor has AVX2, as `is_available` has checked.
            Self::Avx2 if self.is_available() => unsafe { T::run_avx2(kernel) },
            // SAFETY: the processor has AVX-512F, DQ and VL, as `is_available` has checked.
            Self::Avx512 if self.is_available() => unsafe { T::run_avx512(kernel) },
            _ if cfg!(target_arch = "x86_64") => compact(kernel),
            _ => kernel.run::<T::Baseline>(),
        }
    }
}
