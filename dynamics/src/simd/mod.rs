//! Numbers in SIMD lanes: `f32` and `f64`, groups of numbers that fill a cache line, registers of each instruction set,
//! dispatch at run time. Results do not depend on the instruction set: operations are neither contracted nor
//! reassociated.

mod instructions;
mod real;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use instructions::InstructionSet;
pub(crate) use real::MAX_LANES;
pub use real::{LaneGroup, Lanes, Number, Real, SimdKernel, Vector};
