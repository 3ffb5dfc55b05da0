//! Reproducible random number generators.

use super::noise;

/// Generator whose n-th number is [`noise`] of the seed plus n.
pub struct NoiseSequence {
    seed: u64,
    /// Number of values drawn.
    drawn_count: u64,
}

impl NoiseSequence {
    /// Creates a generator from a seed. Seeds should differ by more than the number of values drawn.
    pub fn new(seed: u64) -> Self {
        Self { seed, drawn_count: 0 }
    }

    /// Returns the seed of the generator.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the number of values drawn.
    pub fn drawn_count(&self) -> u64 {
        self.drawn_count
    }

    /// Returns a random number in [−1, 1).
    pub fn uniform_symmetric(&mut self) -> f64 {
        self.drawn_count += 1;
        noise(self.seed + self.drawn_count)
    }

    /// Returns a random integer in [0, count).
    pub fn uniform_index(&mut self, count: usize) -> usize {
        // The product may be rounded up to `count`.
        ((0.5 * self.uniform_symmetric() + 0.5) * count as f64) as usize % count
    }

    /// Returns true with the probability 1/`count`.
    pub fn is_one_in(&mut self, count: usize) -> bool {
        self.uniform_index(count) == 0
    }

    /// Returns a random element of a list.
    pub fn choose<V: Copy>(&mut self, list: &[V]) -> V {
        list[self.uniform_index(list.len())]
    }
}

/// Linear congruential generator modulo 2⁶⁴ with Knuth's multiplier.
pub struct CongruentialGenerator(u64);

impl CongruentialGenerator {
    /// Creates a generator from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns a uniform random number in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Returns a number whose decadic logarithm is uniform in [low, high).
    pub fn log10_uniform(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.uniform(low, high))
    }
}
