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
pub mod elementary;
pub mod fourier;
pub mod granular_flow;
mod input;
pub mod parameter;
pub mod plasticity;
pub mod product;
pub mod rates;
pub mod registry;
pub mod rounding;
pub mod system;

/// Harris & Grekova (2005): double shearing of a reduced Cosserat continuum with intrinsic spin.
pub mod harris_grekova {
    pub mod closed_form;
    pub mod parameters;
    pub mod symbol;
}
/// Spencer (1964), for ν > 0 Mehrabadi & Cowin (1978): double shearing about the stress axes.
pub mod double_shearing {
    pub mod closed_form;
    pub mod parameters;
    pub mod symbol;
}
/// Coaxial Mohr–Coulomb plasticity with a plastic potential, associated or not.
pub mod plastic_potential {
    pub mod closed_form;
    pub mod parameters;
    pub mod symbol;
}
/// de Josselin de Jong (1959, 1977): double sliding with free rotation.
pub mod free_rotating {
    pub mod closed_form;
    pub mod parameters;
    pub mod symbol;
}

pub use closed_form::ClosedForm;
pub use rounding::Rounded;
pub use system::LinearisedSystem;
