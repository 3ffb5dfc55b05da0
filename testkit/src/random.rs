//! Random numbers that are the same in every run.

/// A small generator with a fixed seed (SplitMix64).
pub struct Random(u64);

impl Random {
    /// With a seed.
    pub fn new(seed: u64) -> Self {
        Self::with_salt(seed, 0)
    }

    /// Another sequence for each salt.
    pub fn with_salt(seed: u64, salt: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ salt)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [least, most).
    pub fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// Log-uniform in [least, most).
    pub fn decades(&mut self, least: f64, most: f64) -> f64 {
        self.within(least.ln(), most.ln()).exp()
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Of either sign, log-uniform magnitude.
    pub fn signed(&mut self, least: f64, most: f64) -> f64 {
        let size = self.decades(least, most);
        if self.chance(0.5) { -size } else { size }
    }

    /// Of either sign, uniform magnitude in [least, most): never near zero, so that no term hides.
    pub fn generic(&mut self, least: f64, most: f64) -> f64 {
        let magnitude = self.within(least, most);
        if self.bits() & (1 << 40) == 0 { magnitude } else { -magnitude }
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 20) as usize % count
    }
}
