//! The kernels, compiled in this crate once for each kind of number and instruction set, and not anew in every crate
//! that uses a domain.

use super::fill::{Fill, FillEnd, FillOneSided};
use super::kernel::Lines;
use super::kernel::interlayers::InterlayerLines;
use crate::simd::{Instructions, Real};

/// `f32` or `f64`: the numbers of a [`Domain`](super::Domain).
#[allow(private_interfaces, reason = "nobody else implements or calls it")]
pub trait SolverReal: Real {
    /// Sweeps lines.
    #[doc(hidden)]
    fn sweep_lines(lines: Lines<'_, Self>, instructions: Instructions);

    /// Sweeps lines with interlayers.
    #[doc(hidden)]
    fn sweep_interlayers(lines: InterlayerLines<'_, Self>, instructions: Instructions);

    /// Fills ghosts of rows.
    #[doc(hidden)]
    fn fill(work: Fill<'_, Self>, instructions: Instructions);

    /// Fills ghosts at an end of lines across the rows, as images.
    #[doc(hidden)]
    fn fill_end(work: FillEnd<'_, Self>, instructions: Instructions);

    /// Fills such ghosts by one-sided reconstruction.
    #[doc(hidden)]
    fn fill_one_sided(work: FillOneSided<'_, Self>, instructions: Instructions);
}

macro_rules! compiled {
    ($kind:ident $(, $parameter:ident)?) => {
        #[allow(private_interfaces, reason = "nobody else implements or calls it")]
        impl$(<$parameter: Real>)? SolverReal for $kind {
            fn sweep_lines(lines: Lines<'_, Self>, instructions: Instructions) {
                lines.walk(instructions);
            }

            fn sweep_interlayers(
                lines: InterlayerLines<'_, Self>,
                instructions: Instructions,
            ) {
                instructions.run::<Self>(lines);
            }

            fn fill(work: Fill<'_, Self>, instructions: Instructions) {
                instructions.run::<Self>(work);
            }

            fn fill_end(work: FillEnd<'_, Self>, instructions: Instructions) {
                instructions.run::<Self>(work);
            }

            fn fill_one_sided(work: FillOneSided<'_, Self>, instructions: Instructions) {
                instructions.run::<Self>(work);
            }
        }
    };
}

#[cfg(not(test))]
compiled!(f32);
#[cfg(not(test))]
compiled!(f64);
// Tests of this crate use little of it.
#[cfg(test)]
compiled!(T, T);
