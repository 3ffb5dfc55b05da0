//! Comparison of printed and corrected formulas with reference values.

use crate::support::Complex;

/// Relative tolerance of calculations with 31 digits and sums of a few hundred products.
pub const EXACT_TOLERANCE: f64 = 1e-22;
/// Relative error beyond which a printed formula counts as wrong. The states are random, so the relative error of a
/// wrong formula is of order one in nearly all of them.
const MISPRINT_THRESHOLD: f64 = 1e-4;

/// Counts comparisons and those in which a printed formula is wrong, and asserts that the corrected formula is right.
#[derive(Default)]
pub struct Comparison {
    pub comparisons: usize,
    pub misprints: usize,
}

impl Comparison {
    /// Adds one comparison; `truth` is the reference value and `size` the magnitude of its terms.
    pub fn add_case(&mut self, truth: Complex, printed: Complex, corrected: Complex, size: f64) {
        let size = size.max(truth.abs());
        let corrected = (corrected - truth).abs();
        assert!(
            corrected <= EXACT_TOLERANCE * size,
            "the corrected form is off by {corrected:e} of {size:e}"
        );
        self.comparisons += 1;
        self.misprints += usize::from((printed - truth).abs() > MISPRINT_THRESHOLD * size);
    }

    /// Asserts that there are at least 200 comparisons and that the printed formula is wrong in at least 95 % of them.
    pub fn assert_mostly_misprinted(self) {
        assert!(self.comparisons >= 200);
        assert!(
            self.misprints * 100 >= self.comparisons * 95,
            "the printed form holds in {} of {}",
            self.comparisons - self.misprints,
            self.comparisons
        );
    }
}
