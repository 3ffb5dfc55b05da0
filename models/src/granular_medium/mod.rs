//! Granular medium: elastic or elastic-plastic particles in contact (Sadovskii & Sadovskaya, "Mathematical modeling in
//! mechanics of granular materials", 2012).
//!
//! An elastic spring (the particles), a contact and a plastic hinge act in series: the stress is the projection of the
//! conditional stress s = C:(ε − εᵖ) onto the cone τ ≤ æp, in the norm of the elastic energy, and τ ≤ τ_s. Here
//! p = −⅓ tr σ and τ² = c² dev σ : dev σ.
//!
//! In extension the cone transmits no stress if æ ≤ r = √(3c²/2). The medium is then open: its tangent modulus and its
//! speed of sound are zero.

mod contact_law;
mod kelvin_voigt;
mod maxwell;
mod parameters;
mod uniaxial;

pub use contact_law::{GranularContact, GranularStep};
pub use kelvin_voigt::{DampedState, KelvinVoigtParticles, KelvinVoigtStep};
pub use maxwell::{MaxwellParticles, MaxwellStep, RelaxedState};
pub use parameters::{GranularMedium, GranularParameters};
