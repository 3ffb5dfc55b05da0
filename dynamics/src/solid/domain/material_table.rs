//! Look-up tables of the kernels: constants of the materials by lane pattern and wave.

use crate::simd::{Real, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::GhostCoefficients;

/// Pair of waves (one in each direction) along an axis: offsets of its fields in a row, and indices of its constants in
/// the table.
#[derive(Clone, Debug)]
pub(crate) struct WavePair {
    pub(crate) velocity: usize,
    pub(crate) stress: usize,
    pub(crate) passive_stresses: Vec<usize>,
    /// Index of the wave constants within those of a pattern.
    pub(crate) constants_index: usize,
    /// Indices of the coupling ratios of the passive stresses within those of a pattern.
    pub(crate) ratio_indices: Vec<usize>,
}

/// Constants of the media by lane pattern, which states the medium of each lane of a group.
#[derive(Clone, Debug)]
pub(crate) struct MaterialTable<T: Real> {
    pub(crate) cell_constants: Vec<CellConstants<T::Lanes>>,
    /// Number of wave constants of a pattern: pairs with equal constants share them.
    pub(crate) cells_per_pattern: usize,
    pub(crate) coupling_ratios: Vec<T::Lanes>,
    /// Number of coupling ratios of a pattern.
    pub(crate) ratios_per_pattern: usize,
    /// Ghost coefficients by index of the wave constants if there is one lane pattern; empty for several patterns, for
    /// which computing the coefficients takes less time than loading them.
    pub(crate) ghost_coefficients: Vec<GhostCoefficients<T::Lanes>>,
}

impl<T: Real> MaterialTable<T> {
    /// Whether all groups have the same lane pattern, as in a domain of one medium.
    #[inline(always)]
    pub(crate) fn has_single_pattern(&self) -> bool {
        self.cell_constants.len() == self.cells_per_pattern
    }

    #[inline(always)]
    pub(crate) fn constants(&self, pattern: u32, wave: &WavePair) -> &CellConstants<T::Lanes> {
        &self.cell_constants[pattern as usize * self.cells_per_pattern + wave.constants_index]
    }

    /// Returns the ghost coefficients of a pair of waves at the end of a line: stored ones or, if there are none,
    /// computed from the constants of the outermost cell.
    #[inline(always)]
    pub(crate) fn ghost_coefficients<V: Vector<T>>(
        &self,
        wave: &WavePair,
        outermost: &CellConstants<V>,
    ) -> GhostCoefficients<V> {
        // Both branches pass through memory: otherwise the compiler would evaluate both branches and select the result.
        let computed;
        let group = match self.ghost_coefficients.get(wave.constants_index) {
            Some(stored) => stored,
            None => {
                computed = GhostCoefficients::new(outermost).to_lanes();
                &computed
            }
        };
        GhostCoefficients::load(group)
    }

    #[inline(always)]
    pub(crate) fn coupling_ratio(
        &self,
        pattern: u32,
        wave: &WavePair,
        passive: usize,
    ) -> &T::Lanes {
        &self.coupling_ratios
            [pattern as usize * self.ratios_per_pattern + wave.ratio_indices[passive]]
    }
}
