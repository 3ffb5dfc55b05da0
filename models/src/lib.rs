//! Physical models of granular media.
//!
//! The ground floor of `wellposed`: no discretisation, no files, no threads. A model is one folder
//! of independent statements of the same physics:
//!
//! - `parameters`: constants with units, their checks, and growth rates in closed form;
//! - `symbol`: the linearised equations with frozen coefficients, written from the equations;
//! - `closed_form`: the verdict where a formula decides it.
//!
//! Conventions: SI units, radians, tension-positive stress whose second index is the face normal,
//! compression-positive pressure, angles and spins anticlockwise, `(∇v)ᵢⱼ = ∂ⱼvᵢ`.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod closed_form;
pub mod cosserat;
pub mod double_shearing;
mod dyn_eq;
pub mod elastoplastic;
pub mod elementary;
pub mod fourier;
pub mod free_rotating;
pub mod granular_flow;
pub mod harris_grekova;
mod input;
pub mod parameter;
pub mod plastic_potential;
pub mod plasticity;
pub mod product;
pub mod rates;
pub mod registry;
pub mod rounding;
pub mod solid;
pub mod system;
pub mod yield_set;

pub use closed_form::ClosedForm;
pub use rounding::Rounded;
pub use system::LinearisedSystem;
