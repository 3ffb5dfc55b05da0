//! Wavefront tiling: the order in which tiles of rows and layers pass the stages of a step.
//!
//! A pass is one wavefront-tiled traversal of memory, of one step in space and of up to two in the plane. Tiles of a
//! few layers and rows are loaded; each later stage trails the previous one by the half-width of its stencil, so that a
//! row is read and written once per pass while it is in the cache. In space a block of rows passes the step in all
//! layers before the next block does, so that layers in progress stay in the cache. In the plane, where layers are rows
//! and many of them fit in the cache, the next step follows in the same pass.

use crate::solid::reconstruction::{GHOSTS, HALO};
use std::ops::Range;

/// Number of rows or layers loaded at a time: few enough to stay in the cache, enough to amortise loading and storing
/// the interface states that sweeps carry from chunk to chunk.
pub(super) const CHUNK: usize = 8;

/// Largest number of steps of a pass, in the plane: in space few layers fit in the cache.
pub(super) const STEPS: usize = 2;

/// Ghosts at the lower end of lines are filled for the first chunk of a sweep, and the next sweep overwrites them. Each
/// of the 2·[`STEPS`] sweeps of a pass must therefore advance by at least [`GHOSTS`] rows in the first chunk, although
/// each trails the previous one by as many. (In space [`TileSizes`] satisfies this.)
const _: () = assert!(CHUNK >= 2 * STEPS * GHOSTS);

/// Returns the progress of rows or layers of which `loaded` have been loaded: loaded, past the first sweep across them,
/// past the second. Each sweep trails the previous stage by [`GHOSTS`], the half-width of its stencil, until all are
/// loaded.
pub(super) fn stage_progress(loaded: usize, all: usize) -> [usize; 3] {
    let written = |ready: usize| if ready == all { all } else { ready.saturating_sub(GHOSTS) };
    [loaded, written(loaded), written(written(loaded))]
}

/// Returns the rows or layers that pass each of three stages between two states of progress.
pub(super) fn passing(before: [usize; 3], ready: [usize; 3]) -> [Range<usize>; 3] {
    std::array::from_fn(|stage| before[stage]..ready[stage])
}

/// Returns the largest number of steps of a pass if the smallest subdomain has `layers` layers: a subdomain must own
/// all layers of the halos of its neighbours.
pub(crate) fn most_steps<const D: usize>(layers: usize) -> usize {
    if D == 2 { (layers / HALO).clamp(1, STEPS) } else { 1 }
}

/// Size of the rows of layers that are loaded together, bytes, so that they stay in the private cache of a core during
/// the step.
const OWN_CACHE: usize = 1 << 20;

/// Size of a block of rows in the layers in progress, bytes, so that they stay in the shared cache.
const SHARED_CACHE: usize = 7 << 20;

/// Tile sizes: layers and rows loaded at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileSizes {
    pub(super) layers: usize,
    /// Rows of these layers.
    pub(super) rows: usize,
    /// Rows of a block: all layers pass the step in one block before the next block does.
    pub(super) block: usize,
}

impl TileSizes {
    /// Tiles in the plane, where layers are rows.
    pub(super) const ROWS: Self = Self { layers: CHUNK, rows: 1, block: 1 };

    /// Returns the tiles in space, for rows of `row` bytes. Periodic rows are the ghosts of each other and must all be
    /// loaded.
    pub(super) fn in_space(row: usize, periodic: bool) -> Self {
        let fits = |layers: &usize| layers * CHUNK * row <= OWN_CACHE;
        let layers = (2 * GHOSTS..=CHUNK).rev().step_by(2).find(fits).unwrap_or(2 * GHOSTS);
        let block = SHARED_CACHE / ((layers + 2 * GHOSTS) * row) / CHUNK;
        match periodic {
            true => Self { layers, rows: usize::MAX, block: usize::MAX },
            false => Self { layers, rows: CHUNK, block: block.max(1) * CHUNK },
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
    pub(super) most_steps: usize,
    pub(super) tiles: TileSizes,
    /// Prefetch distance in rows, from the rows loaded last to those loaded next.
    pub(super) ahead: usize,
}

impl Schedule {
    pub(super) fn new(most_steps: usize, tiles: TileSizes) -> Self {
        Self { steps: 0, pass_steps: 0, most_steps, tiles, ahead: 0 }
    }

    /// Whether a half step of the pass is the first one of the whole simulation.
    pub(super) fn is_first(&self, half: usize) -> bool {
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
        let end = block.end.min(loaded.saturating_add(self.tiles.rows));
        // After the last rows of the block come its first rows in the next layers.
        self.ahead = match end < block.end {
            true => end - loaded,
            false => layers.saturating_mul(rows) - (loaded - block.start),
        };
        loaded..end
    }
}
