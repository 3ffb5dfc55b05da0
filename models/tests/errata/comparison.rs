//! Printed and corrected formulas compared with the truth.

use crate::support::Complex;

/// 31 digits, minus those that sums of a few hundred products lose.
pub const EXACT: f64 = 1e-22;
/// A printed form counts as wrong beyond this fraction of the truth's own size; the states are
/// generic, so a wrong form is off by a number of order one in nearly all of them.
const WRONG: f64 = 1e-4;

/// Counts where a printed form misses the truth and insists on the corrected one.
#[derive(Default)]
pub struct Comparison {
    pub compared: usize,
    pub printed_wrong: usize,
}

impl Comparison {
    /// `size`: of the terms that make up the truth.
    pub fn add(&mut self, truth: Complex, printed: Complex, corrected: Complex, size: f64) {
        let size = size.max(truth.abs());
        let corrected = (corrected - truth).abs();
        assert!(
            corrected <= EXACT * size,
            "the corrected form is off by {corrected:e} of {size:e}"
        );
        self.compared += 1;
        self.printed_wrong += usize::from((printed - truth).abs() > WRONG * size);
    }

    /// The printed form is wrong in practically every generic state.
    pub fn finish(self) {
        assert!(self.compared >= 200);
        assert!(
            self.printed_wrong * 100 >= self.compared * 95,
            "the printed form holds in {} of {}",
            self.compared - self.printed_wrong,
            self.compared
        );
    }
}
