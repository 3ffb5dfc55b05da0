//! Random lines of cells, for tests of energy stability.

use crate::solid::cell::CellConstants;

/// Linear congruential generator (Knuth, MMIX), the same on every machine.
pub(crate) struct LinearCongruentialGenerator(u64);

impl LinearCongruentialGenerator {
    /// Creates a generator from a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns a uniform random number in \[low, high).
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Returns the constants of a line of random length, at least `lengths[0]` and below `lengths[1]` cells: blocks of
    /// one medium each, of random impedances and Courant numbers. Blocks have at most 1, 2, 3 or 8 cells, in turn with
    /// `attempt`.
    pub(crate) fn cells(&mut self, lengths: [f64; 2], attempt: usize) -> Vec<CellConstants<f64>> {
        let count = self.uniform(lengths[0], lengths[1]) as usize;
        let longest = [1.0, 2.0, 3.0, 8.0][attempt % 4];
        let decades = self.uniform(0.0, 3.0);
        let mut cells = Vec::new();
        while cells.len() < count {
            let block = CellConstants::<f64>::with_interfaces(
                10f64.powf(self.uniform(-decades, decades)),
                10f64.powf(self.uniform(-3.0, 0.0)),
            );
            let length = self.uniform(1.0, longest + 1.0) as usize;
            cells.extend(vec![block; length.min(count - cells.len())]);
        }
        cells
    }
}
