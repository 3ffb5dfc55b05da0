//! Porous medium such as a metal foam (Sadovskii & Sadovskaya 2019): an elastic-plastic skeleton in parallel with an
//! elastic spring that acts when the pores have collapsed.
//!
//! ```text
//! σ = s + π_K(q + q⁰),  q⁰ = k_bθ₀δ,  (s̃ − s):(a:ṡ − ∇v) ≥ 0 for τ(s̃) ≤ τ_s,  b:q̇ = sym ∇v
//! ```
//!
//! with the skeleton (k_a, μ_a, τ_s), the spring (k_b, μ_b), the porosity θ₀ and the cone K of the contact of pore
//! walls: with the spherical contact only the mean stress of the spring acts, for tr ε < −θ₀; a contact with friction
//! acts earlier.

mod cone_law;
mod parameters;
mod plastic_cone_law;
mod pore_law;
mod uniaxial;

pub use cone_law::{PoreConeLaw, PoreConeStep};
pub use parameters::{PoreContact, PorousMedium, PorousParameters};
pub use plastic_cone_law::{PlasticPoreConeLaw, PlasticPoreConeStep};
pub use pore_law::{PoreLaw, PoreState, PoreStep};
