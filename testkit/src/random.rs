//! Reproducible random numbers.

/// SplitMix64 random number generator with a fixed seed (Steele, Lea & Flood 2014).
pub struct Random(u64);

impl Random {
    /// Creates a generator from a seed.
    pub fn new(seed: u64) -> Self {
        Self::with_salt(seed, 0)
    }

    /// Creates a generator from a seed, with an independent sequence for each `salt`.
    pub fn with_salt(seed: u64, salt: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ salt)
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a uniform random number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a uniform random number in [least, most).
    pub fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// Returns a log-uniform random number in [least, most).
    pub fn decades(&mut self, least: f64, most: f64) -> f64 {
        self.within(least.ln(), most.ln()).exp()
    }

    /// Returns true with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Returns a number of random sign whose magnitude is log-uniform in [least, most).
    pub fn signed(&mut self, least: f64, most: f64) -> f64 {
        let size = self.decades(least, most);
        if self.chance(0.5) { -size } else { size }
    }

    /// Returns a number of random sign whose magnitude is uniform in [least, most): non-zero, so that every term
    /// counts.
    pub fn generic(&mut self, least: f64, most: f64) -> f64 {
        let magnitude = self.within(least, most);
        if self.bits() & (1 << 40) == 0 { magnitude } else { -magnitude }
    }

    /// Returns a uniform random integer in [0, count).
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 20) as usize % count
    }
}
