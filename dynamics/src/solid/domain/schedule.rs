//! Wavefront tiling: the order in which tiles of rows and layers pass the stages of a step.
//!
//! A pass is one wavefront-tiled traversal of memory, of one step in space and of up to two in the plane. Tiles of a
//! few layers and rows are loaded; each later stage trails the previous one by the half-width of its stencil, so that a
//! row is read and written once per pass while it is in the cache. In space a block of rows passes the step in all
//! layers before the next block does, so that layers in progress stay in the cache. In the plane, where layers are rows
//! and many of them fit in the cache, the next step follows in the same pass.

use crate::solid::reconstruction::{GHOSTS, MAX_GHOSTS};
use std::ops::Range;

/// Number of rows or layers loaded at a time: few enough to stay in the cache, enough to amortise loading and storing
/// the interface states that sweeps carry from chunk to chunk.
pub(super) const CHUNK_SIZE: usize = 8;

/// Largest number of steps of a pass, in the plane: in space few layers fit in the cache.
pub(super) const MAX_PASS_STEPS: usize = 2;

/// Ghosts at the lower end of lines are filled for the first chunk of a sweep, and the next sweep overwrites them. Each
/// of the sweeps of a pass, two for each step, must therefore advance by at least as many rows as there are ghosts in the
/// first chunk, although each sweep trails the previous one by as many rows. [`max_pass_steps`] and, in space,
/// [`TileSizes`] satisfy this.
const _: () = assert!(CHUNK_SIZE >= 2 * MAX_PASS_STEPS * GHOSTS && CHUNK_SIZE >= 2 * MAX_GHOSTS);

/// Returns the progress of rows or layers of which `loaded` have been loaded: the numbers of those loaded, of those
/// past the first sweep across them, and of those past the second. Each sweep trails the previous stage by `ghosts`, the
/// half-width of its stencil, until all are loaded.
pub(super) fn stage_progress(loaded: usize, all: usize, ghosts: usize) -> [usize; 3] {
    let completed = |ready: usize| if ready == all { all } else { ready.saturating_sub(ghosts) };
    [loaded, completed(loaded), completed(completed(loaded))]
}

/// Returns the rows or layers that pass each of the three stages between two states of progress (see
/// [`stage_progress`]).
pub(super) fn stage_ranges(before: [usize; 3], ready: [usize; 3]) -> [Range<usize>; 3] {
    std::array::from_fn(|stage| before[stage]..ready[stage])
}

/// Returns the largest number of steps of a pass with a halo of `halo` layers per step if the smallest subdomain has
/// `layers` layers: a subdomain must own all layers of the halos of its neighbours.
pub(crate) fn max_pass_steps<const D: usize>(layers: usize, halo: usize) -> usize {
    match D {
        2 => (layers / halo).clamp(1, MAX_PASS_STEPS.min(CHUNK_SIZE / halo)),
        _ => 1,
    }
}

/// Size of the rows of layers that are loaded together, bytes, so that they stay in the private cache of a core during
/// the step.
const PRIVATE_CACHE_BYTES: usize = 1 << 20;

/// Size of a block of rows in the layers in progress, bytes, so that they stay in the shared cache.
const SHARED_CACHE_BYTES: usize = 7 << 20;

/// Tile sizes: layers and rows loaded at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileSizes {
    pub(super) layers: usize,
    /// Number of rows of these layers that are loaded at a time.
    pub(super) rows: usize,
    /// Number of rows of a block: all layers pass the step in one block before the next block does.
    pub(super) block_rows: usize,
}

impl TileSizes {
    /// Tiles in the plane, where layers are rows.
    pub(super) const PLANE_TILES: Self = Self { layers: CHUNK_SIZE, rows: 1, block_rows: 1 };

    /// Returns the tile sizes in space, for rows of `row` bytes and stencils with `ghosts` ghosts. Periodic rows are the
    /// ghosts of each other and must all be loaded.
    pub(super) fn new_in_space(row: usize, is_periodic: bool, ghosts: usize) -> Self {
        let fits_private_cache = |layers: &usize| layers * CHUNK_SIZE * row <= PRIVATE_CACHE_BYTES;
        let layers = (2 * ghosts..=CHUNK_SIZE)
            .rev()
            .step_by(2)
            .find(fits_private_cache)
            .unwrap_or(2 * ghosts);
        let block_chunks = SHARED_CACHE_BYTES / ((layers + 2 * ghosts) * row) / CHUNK_SIZE;
        match is_periodic {
            true => Self { layers, rows: usize::MAX, block_rows: usize::MAX },
            false => {
                Self { layers, rows: CHUNK_SIZE, block_rows: block_chunks.max(1) * CHUNK_SIZE }
            }
        }
    }
}

/// Number of completed steps, and the tiling of a pass.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    /// Number of completed steps, those of the current pass included.
    pub(super) steps: usize,
    /// Number of steps of the current pass.
    pub(super) pass_steps: usize,
    /// Largest number of steps of a pass.
    pub(super) max_pass_steps: usize,
    pub(super) tile_sizes: TileSizes,
    /// Prefetch distance in rows, from the rows loaded last to those loaded next.
    pub(super) prefetch_rows: usize,
}

impl Schedule {
    pub(super) fn new(max_pass_steps: usize, tile_sizes: TileSizes) -> Self {
        Self { steps: 0, pass_steps: 0, max_pass_steps, tile_sizes, prefetch_rows: 0 }
    }

    /// Whether a half step of the pass is the first one of the whole simulation.
    pub(super) fn is_first_half_step(&self, half: usize) -> bool {
        half == 0 && self.steps == self.pass_steps
    }

    /// Returns the next rows of a block to be loaded, in `layers` layers of `rows` rows, and sets the prefetch distance
    /// to the rows after them.
    pub(super) fn next_rows(
        &mut self,
        loaded: usize,
        block: &Range<usize>,
        (layers, rows): (usize, usize),
    ) -> Range<usize> {
        let end = block.end.min(loaded.saturating_add(self.tile_sizes.rows));
        // After the last rows of the block come its first rows in the next layers.
        self.prefetch_rows = match end < block.end {
            true => end - loaded,
            false => layers.saturating_mul(rows) - (loaded - block.start),
        };
        loaded..end
    }
}
