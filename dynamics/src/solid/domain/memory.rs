//! Memory of the fields, and room for the sweeps.

use super::kernel::Carried;
use super::layout::{GroupIndex, Layout};
use super::schedule::CHUNK;
use super::whole_stress::{Wide, blocks_of_group};
use crate::simd::{Number, Real};
use crate::solid::reconstruction::GHOSTS;

/// Buffers of the sweeps.
#[derive(Clone)]
pub(super) struct Buffer<T: Real> {
    /// State that sweeps carry from tile to tile, by axis and half step of the pass, then by line and pair of waves. Rows are
    /// swept whole: along them its length only sets the number of lines.
    pub(super) carried: [Vec<Vec<Carried<T::Lanes>>>; 3],
    /// Groups on the path along a line.
    pub(super) path: Vec<GroupIndex>,
    /// Groups with cells that are yet to be projected one at a time, and the lanes of these.
    pub(super) left: Vec<(usize, u16)>,
    /// The fields of a row in double precision, where the return mapping needs them.
    pub(super) wide: Vec<Wide>,
}

impl<T: Real> Buffer<T> {
    /// For so many pairs of waves by axis and half steps of a pass, and rows in double precision or none.
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
        let blocks = layout.fields * layout.groups * blocks_of_group::<T>();
        Self {
            carried,
            path: Vec::with_capacity(longest),
            left: Vec::with_capacity(layout.layer_groups()),
            wide: vec![Wide::ZERO; if needs_wide { blocks } else { 0 }],
        }
    }
}

/// So many zeros, in huge pages where the system has such: a sweep across rows is on another small page with
/// every cell, and the translation lookaside buffer of a processor holds few.
pub(super) fn zeros<N: Number>(count: usize) -> Vec<N> {
    let mut room: Vec<N> = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    {
        const PAGE: usize = 1 << 12;
        let free = room.spare_capacity_mut();
        let before = free.as_ptr().cast::<u8>().align_offset(PAGE);
        let length = size_of_val(free).saturating_sub(before) / PAGE * PAGE;
        if length > 0 {
            // SAFETY: whole pages of memory that is ours; how the system keeps them does not change what they hold.
            // Where it cannot do it, it goes on as ever.
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
