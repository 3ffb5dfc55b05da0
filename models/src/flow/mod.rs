//! Planar flow of Mohr–Coulomb granular materials: shared equations, and one folder per model.
//!
//! The Harris–Grekova model (2005), double shearing (Spencer 1964; Mehrabadi & Cowin 1978), the plastic potential and
//! the double-sliding free-rotating model (de Josselin de Jong 1977) share the balances of momentum and mass, the yield
//! condition and the form of the flow rule; they differ in the coefficients of the flow rule and in the definition of
//! the material rotation. This module holds the shared equations ([`state`], [`balance`]), the registry entry of a
//! model ([`FlowModel`]) and the model with checked constants ([`Model`]).

mod background;
pub mod balance;
pub mod closed_form;
pub mod double_shearing;
pub mod free_rotating;
pub mod harris_grekova;
pub mod hopper;
mod model;
mod parameters;
pub mod plastic_potential;
pub mod state;

pub use model::{FlowKind, FlowLaw, FlowModel, Model, RotationKind, Slip};
pub use parameters::{COHESION, DILATANCY_ANGLE, FRICTION_ANGLE, SHARED_PARAMETERS};
