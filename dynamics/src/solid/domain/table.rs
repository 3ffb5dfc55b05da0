//! Constants of the materials as the kernels look them up: by lane pattern and wave.

use crate::simd::{Real, Vector};
use crate::solid::cell::Cell;
use crate::solid::ghosts::GhostCoefficients;

/// Places of the fields of a pair of waves in a row, and of its constants in the table.
#[derive(Clone, Debug)]
pub(crate) struct Wave {
    pub(crate) velocity: usize,
    pub(crate) stress: usize,
    pub(crate) followers: Vec<usize>,
    /// Place of the constants among those of a pattern.
    pub(crate) constants: usize,
    /// Places of the followers' ratios among those of a pattern.
    pub(crate) ratios: Vec<usize>,
}

/// Constants of the media by pattern: which medium each lane of a group has.
#[derive(Clone, Debug)]
pub(crate) struct Table<T: Real> {
    pub(crate) cells: Vec<Cell<T::Lanes>>,
    /// Constants of a pattern: waves that have the same share them.
    pub(crate) waves: usize,
    pub(crate) ratios: Vec<T::Lanes>,
    /// Ratios of a pattern, shared likewise.
    pub(crate) followers: usize,
    /// Ghost coefficients by wave if there is one pattern; empty for more, where computing them again takes less time
    /// than loading them.
    pub(crate) ghost_coefficients: Vec<GhostCoefficients<T::Lanes>>,
}

impl<T: Real> Table<T> {
    /// Whether all groups have the same media, as where there is one.
    #[inline(always)]
    pub(crate) fn is_of_one_pattern(&self) -> bool {
        self.cells.len() == self.waves
    }

    #[inline(always)]
    pub(crate) fn cell(&self, pattern: u32, wave: &Wave) -> &Cell<T::Lanes> {
        &self.cells[pattern as usize * self.waves + wave.constants]
    }

    /// Ghost coefficients of a wave beside this outermost cell.
    #[inline(always)]
    pub(crate) fn ghost_coefficients<V: Vector<T>>(
        &self,
        wave: &Wave,
        outermost: &Cell<V>,
    ) -> GhostCoefficients<V> {
        // Both branches through memory: a branch between registers makes the compiler compute both.
        let computed;
        let group = match self.ghost_coefficients.get(wave.constants) {
            Some(stored) => stored,
            None => {
                computed = GhostCoefficients::new(outermost).group();
                &computed
            }
        };
        GhostCoefficients::load(group)
    }

    #[inline(always)]
    pub(crate) fn ratio(&self, pattern: u32, wave: &Wave, follower: usize) -> &T::Lanes {
        &self.ratios[pattern as usize * self.followers + wave.ratios[follower]]
    }
}
