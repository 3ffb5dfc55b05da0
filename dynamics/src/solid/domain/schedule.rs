//! The order in which layers and rows go through the stages of a step.
//!
//! A pass is one wavefront-tiled traversal of memory, of one step in space and of up to two in the plane. Tiles of a few
//! layers and rows enter; each later stage trails the previous one by the half-width of its stencil, so that a row is read and written once per pass while it is in the
//! cache. In space a block of rows goes through the step in all layers before the next block does, so that layers that
//! wait for others stay in the cache. In the plane, where layers are rows and many of them fit in the cache, the
//! next step follows in the same pass.

use crate::solid::reconstruction::{GHOSTS, HALO};
use std::ops::Range;

/// Rows or layers that are loaded at a time: few enough to stay in the cache, enough to amortise loading and
/// storing the interface states that sweeps carry from chunk to chunk.
pub(super) const CHUNK: usize = 8;

/// Steps of a pass at most, in the plane: in space few layers fit in the cache.
pub(super) const STEPS: usize = 2;

/// Ghosts at the lower end of lines are filled for the first chunk of a sweep, and the next sweep overwrites them: each of
/// the 2·[`STEPS`] sweeps of a pass must have [`GHOSTS`] rows of the first chunk or more, though each trails the one before
/// it by as many. (In space [`TileSizes`] keeps to it.)
const _: () = assert!(CHUNK >= 2 * STEPS * GHOSTS);

/// Progress of rows or layers, of which `loaded` have entered: entered, past the first sweep across them, past the second.
/// Each sweep trails the previous stage by [`GHOSTS`], the half-width of its stencil, until all have entered.
pub(super) fn stage_progress(loaded: usize, all: usize) -> [usize; 3] {
    let written = |ready: usize| if ready == all { all } else { ready.saturating_sub(GHOSTS) };
    [loaded, written(loaded), written(written(loaded))]
}

/// The rows or layers that pass each of three stages between two states of progress.
pub(super) fn passing(before: [usize; 3], ready: [usize; 3]) -> [Range<usize>; 3] {
    std::array::from_fn(|stage| before[stage]..ready[stage])
}

/// Steps of a pass at most, where the smallest part of a domain has `layers` layers: it must own all layers of its
/// neighbours' halos.
pub(crate) fn most_steps<const D: usize>(layers: usize) -> usize {
    if D == 2 { (layers / HALO).clamp(1, STEPS) } else { 1 }
}

/// Bytes of rows of layers that are loaded together, so that they stay in a core's own cache while they go through the
/// step.
const OWN_CACHE: usize = 1 << 20;

/// Bytes of a block of rows in the layers that are within the step, so that they stay in the cache that cores share.
const SHARED_CACHE: usize = 7 << 20;

/// How many layers and rows are loaded at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileSizes {
    pub(super) layers: usize,
    /// Rows of these layers.
    pub(super) rows: usize,
    /// Rows of a block: all layers go through the step in these before the next block does.
    pub(super) block: usize,
}

impl TileSizes {
    /// Tiles in the plane, where layers are rows.
    pub(super) const ROWS: Self = Self { layers: CHUNK, rows: 1, block: 1 };

    /// Tiles in space, where a row takes `row` bytes. Periodic rows are each other's ghosts, and must all be loaded.
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

/// Steps done, and the tiling of a pass.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    /// Steps done.
    pub(super) steps: usize,
    /// Steps of the pass under way.
    pub(super) pass_steps: usize,
    /// Steps of a pass at most.
    pub(super) most_steps: usize,
    pub(super) tiles: TileSizes,
    /// Rows from those that were loaded last to those that are loaded next: for prefetching.
    pub(super) ahead: usize,
}

impl Schedule {
    pub(super) fn new(most_steps: usize, tiles: TileSizes) -> Self {
        Self { steps: 0, pass_steps: 0, most_steps, tiles, ahead: 0 }
    }

    /// Whether a half step of the pass is the first of all.
    pub(super) fn is_first(&self, half: usize) -> bool {
        half == 0 && self.steps == self.pass_steps
    }

    /// The rows of a block that are loaded next, in so many layers together, of which each has so many rows; records for
    /// prefetching where those after them stand.
    pub(super) fn next_rows(
        &mut self,
        loaded: usize,
        block: &Range<usize>,
        (layers, rows): (usize, usize),
    ) -> Range<usize> {
        let end = block.end.min(loaded.saturating_add(self.tiles.rows));
        // Behind the last ones of the block come its first ones in the layers that follow.
        self.ahead = match end < block.end {
            true => end - loaded,
            false => layers.saturating_mul(rows) - (loaded - block.start),
        };
        loaded..end
    }
}
