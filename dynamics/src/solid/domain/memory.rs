//! Buffers of a domain and allocation in huge pages.

use super::kernel::Carried;
use super::layout::{GroupIndex, Layout};
use super::schedule::CHUNK;
use super::total_stress::{Wide, blocks_per_group};
use crate::simd::{Number, Real};
use crate::solid::reconstruction::GHOSTS;

/// Buffers of sweeps and return mapping, allocated once.
#[derive(Clone)]
pub(super) struct Buffer<T: Real> {
    /// State that sweeps carry from tile to tile, by axis and half step of the pass, then by line and pair of waves.
    /// Rows are swept whole: along the first axis the length only sets the number of lines.
    pub(super) carried: [Vec<Vec<Carried<T::Lanes>>>; 3],
    /// Groups on the path of a sweep along a line.
    pub(super) path: Vec<GroupIndex>,
    /// Groups with cells for the scalar return mapping, and masks of their lanes.
    pub(super) left: Vec<(usize, u16)>,
    /// Fields of a row in double precision, for the return mapping of a domain in single precision.
    pub(super) wide: Vec<Wide>,
}

impl<T: Real> Buffer<T> {
    /// Allocates buffers for `pairs` pairs of waves by axis, `halves` half steps of a pass, and rows in double
    /// precision if `needs_wide`.
    pub(super) fn new<const D: usize>(
        layout: &Layout<D>,
        pairs: [usize; D],
        halves: usize,
        needs_wide: bool,
    ) -> Self {
        let layers = layout.layers();
        let longest = layout.cells.iter().copied().max().unwrap_or(0).max(layers) + 2 * GHOSTS;
        let carried = std::array::from_fn(|axis| {
            let lines = match axis {
                0 => CHUNK,
                _ if axis + 1 == D => layout.layer_groups(),
                _ => layers * layout.groups,
            };
            let waves = pairs.get(axis).copied().unwrap_or(0);
            vec![vec![Carried::empty(); lines * waves]; halves]
        });
        let blocks = layout.fields * layout.groups * blocks_per_group::<T>();
        Self {
            carried,
            path: Vec::with_capacity(longest),
            left: Vec::with_capacity(layout.layer_groups()),
            wide: vec![Wide::ZERO; if needs_wide { blocks } else { 0 }],
        }
    }
}

/// Allocates `count` zeros, in huge pages if the system has them: a sweep across rows touches another small page with
/// every cell, more than the translation lookaside buffer holds.
pub(super) fn zeros<N: Number>(count: usize) -> Vec<N> {
    let mut room: Vec<N> = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    {
        const PAGE: usize = 1 << 12;
        let free = room.spare_capacity_mut();
        let before = free.as_ptr().cast::<u8>().align_offset(PAGE);
        let length = size_of_val(free).saturating_sub(before) / PAGE * PAGE;
        if length > 0 {
            // SAFETY: whole pages of memory owned by the vector; the advice does not change their content. Failure is
            // ignored: small pages work as well.
            unsafe {
                libc::madvise(
                    free.as_mut_ptr().cast::<u8>().add(before).cast(),
                    length,
                    libc::MADV_HUGEPAGE,
                );
            }
        }
    }
    room.resize(count, N::ZERO);
    room
}
