//! Binary forms F(κ₁, κ₂) = Σ f_l κ₁^(d−l) κ₂^l with rounding bounds, and their zeros.

mod binary_form;
mod ratio;
#[cfg(test)]
mod tests;
mod zeros;

pub use binary_form::Form;
pub use ratio::{extrema_of_ratio, maximum_of_ratio};
pub use zeros::{Zero, merge};
