//! Reproducible random numbers.

/// SplitMix64 random number generator (Steele, Lea & Flood 2014); the same seed gives the same sequence.
pub struct RandomNumbers(u64);

impl RandomNumbers {
    /// Creates a generator from a seed.
    pub fn new(seed: u64) -> Self {
        Self::with_salt(seed, 0)
    }

    /// Creates a generator from a seed, with another sequence for each `salt`.
    pub fn with_salt(seed: u64, salt: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ salt)
    }

    /// Returns 64 random bits.
    pub fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a uniform random number in [0, 1).
    pub fn unit_interval(&mut self) -> f64 {
        (self.next_bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a uniform random number in [min, max).
    pub fn uniform(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.unit_interval()
    }

    /// Returns a log-uniform random number in [min, max), to within rounding of the bounds; min > 0.
    pub fn log_uniform(&mut self, min: f64, max: f64) -> f64 {
        self.uniform(min.ln(), max.ln()).exp()
    }

    /// Returns true with the given probability.
    pub fn bernoulli(&mut self, probability: f64) -> bool {
        self.unit_interval() < probability
    }

    /// Returns a number of random sign whose magnitude is log-uniform in [min, max), to within rounding of the bounds;
    /// min > 0.
    pub fn signed_log_uniform(&mut self, min: f64, max: f64) -> f64 {
        let size = self.log_uniform(min, max);
        if self.bernoulli(0.5) { -size } else { size }
    }

    /// Returns a number of random sign whose magnitude is uniform in [min, max). For min > 0 it is not zero, so that no
    /// term of a formula under test vanishes.
    pub fn signed_uniform(&mut self, min: f64, max: f64) -> f64 {
        let magnitude = self.uniform(min, max);
        if self.next_bits() & (1 << 40) == 0 { magnitude } else { -magnitude }
    }

    /// Returns a uniform random integer in [0, count); `count` > 0.
    pub fn uniform_index(&mut self, count: usize) -> usize {
        (self.next_bits() >> 20) as usize % count
    }
}
