//! Tools shared by all models: number types, rounding bounds, linearised systems, symmetric rate equations, parameter
//! metadata and ranges, and elementary functions and matrix products with platform-independent bits.

pub mod decimal;
mod dyn_eq;
pub mod elementary;
pub mod fourier;
pub(crate) mod input;
pub(crate) mod kind;
pub mod number;
pub mod parameter;
pub mod product;
pub mod range;
pub mod rates;
pub mod rounding;
pub mod scalar;
pub mod system;
pub mod taylor_model;

pub use dyn_eq::DynEq;
