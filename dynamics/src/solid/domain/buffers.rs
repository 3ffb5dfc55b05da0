//! Buffers of a domain and allocation in huge pages.

use super::kernel::CarriedState;
use super::kernel::interlayers::InterlayerStates;
use super::layout::{GroupIndex, Layout};
use super::schedule::CHUNK_SIZE;
use super::total_stress::{DoubleLanes, blocks_per_group};
use crate::simd::{Number, Real};
use crate::solid::problem::DomainError;

/// Buffers of sweeps and return mapping, allocated once.
#[derive(Clone)]
pub(super) struct Buffers<T: Real> {
    /// State that sweeps carry from tile to tile, by axis and half step of the pass, then by line and pair of waves, several
    /// for each with wide stencils.
    /// Sweeps along rows carry no state between tiles: along the first axis only the length of the list is used, for
    /// the number of lines.
    pub(super) carried_states: [Vec<Vec<CarriedState<T::Lanes>>>; 3],
    /// Groups on the path of a sweep along a line.
    pub(super) path: Vec<GroupIndex>,
    /// Interface states of the interlayers on the path.
    pub(super) interlayer_states: InterlayerStates<T>,
    /// Groups (index within the segment of a row) that contain cells for the scalar return mapping, and masks of the
    /// lanes of these cells.
    pub(super) scalar_lanes: Vec<(usize, u16)>,
    /// Fields of a row in double precision, for the return mapping of a domain in single precision.
    pub(super) double_row: Vec<DoubleLanes>,
}

impl<T: Real> Buffers<T> {
    /// Allocates the buffers. `pairs`: number of pairs of waves by axis; `halves`: number of half steps of a pass;
    /// `needs_double`: whether rows are also stored in double precision.
    pub(super) fn new<const D: usize>(
        layout: &Layout<D>,
        pairs: [usize; D],
        halves: usize,
        needs_double: bool,
    ) -> Self {
        let layers = layout.layers();
        let longest =
            layout.cells.iter().copied().max().unwrap_or(0).max(layers) + 2 * layout.ghosts;
        let carried_states = std::array::from_fn(|axis| {
            let lines = match axis {
                0 => CHUNK_SIZE,
                _ if axis + 1 == D => layout.layer_groups(),
                _ => layers * layout.groups,
            };
            let waves = pairs.get(axis).copied().unwrap_or(0);
            let slots = lines * waves * CarriedState::<T::Lanes>::slots(layout.ghosts);
            vec![vec![CarriedState::new(); slots]; halves]
        });
        let blocks = layout.field_count * layout.groups * blocks_per_group::<T>();
        Self {
            carried_states,
            path: Vec::with_capacity(longest),
            interlayer_states: InterlayerStates::default(),
            scalar_lanes: Vec::with_capacity(layout.layer_groups()),
            double_row: vec![DoubleLanes::ZERO; if needs_double { blocks } else { 0 }],
        }
    }
}

/// Allocates `count` zeros, in huge pages if the system has them: a sweep across rows touches another small page with
/// every cell, more than the translation lookaside buffer holds.
///
/// # Errors
/// There is not enough memory.
pub(super) fn allocate_zeros<N: Number>(count: usize) -> Result<Vec<N>, DomainError> {
    let mut buffer: Vec<N> = Vec::new();
    buffer
        .try_reserve_exact(count)
        .map_err(|_| DomainError::OutOfMemory { bytes: count.saturating_mul(size_of::<N>()) })?;
    #[cfg(target_os = "linux")]
    {
        const PAGE_SIZE: usize = 1 << 12;
        let spare = buffer.spare_capacity_mut();
        let alignment_offset = spare.as_ptr().cast::<u8>().align_offset(PAGE_SIZE);
        let length = size_of_val(spare).saturating_sub(alignment_offset) / PAGE_SIZE * PAGE_SIZE;
        if length > 0 {
            // SAFETY: whole pages of memory owned by the vector; the advice does not change their content. Failure is
            // ignored: small pages work as well.
            unsafe {
                libc::madvise(
                    spare.as_mut_ptr().cast::<u8>().add(alignment_offset).cast(),
                    length,
                    libc::MADV_HUGEPAGE,
                );
            }
        }
    }
    buffer.resize(count, N::ZERO);
    Ok(buffer)
}
