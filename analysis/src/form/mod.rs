//! Binary forms F(κ₁, κ₂) = Σ f_l κ₁^(d−l) κ₂^l with rounding bounds, and their zeros.

mod binary_form;
mod ratio;
#[cfg(test)]
mod tests;
mod zeros;

pub use binary_form::BinaryForm;
pub use ratio::{locate_ratio_maximum, ratio_extrema};
pub use zeros::{FormZero, merge_zeros};
