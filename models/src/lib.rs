//! Physical models of granular media.
//!
//! The base crate of `wellposed`: constitutive models without discretisation, threads, files or case keys. Models take
//! plain numbers in SI units (angles in rad) and check them.
//!
//! | module | holds |
//! |---|---|
//! | [`common`] | numbers with rounding bounds, linearised systems, symmetric rate equations, constants with units |
//! | [`flow`] | granular flows: shared equations, and one folder per model |
//! | [`solid`] | elastic laws, their linearised equations, and their waves in closed form |
//! | [`yield_set`] | yield sets: conditions, return mapping, tangent of the flow rule |
//! | [`granular_medium`], [`porous`] | media whose contacts open and whose pores collapse |
//! | [`uniaxial`] | uniaxial strain of such media: piecewise-linear diagrams |
//! | [`rheology`] | stress that depends on history: rheological schemes of springs, dampers, hinges and contacts; relaxation of the deviator |
//! | [`interface`] | face laws: fluxes from the Riemann invariants incoming at a face, with history variables |
//! | [`elastoplastic`] | a solid with an elastic law and a yield set |
//! | [`registry`] | flows, elastic solids, yield sets and layers by name; a program adds one of the first three with one call |
//!
//! The folder of a flow holds independent statements of the same physics, compared by tests:
//!
//! - `parameters`: constants with units, their checks, and growth rates where a closed form exists;
//! - `symbol`: the linearised equations with frozen coefficients, written from the equations;
//! - `closed_form`: the verdict where a formula decides it.
//!
//! Conventions: SI units, radians, tension-positive stress whose second index is the face normal,
//! compression-positive pressure, angles and spins positive anticlockwise, `(∇v)ᵢⱼ = ∂ⱼvᵢ`.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod common;
pub mod elastoplastic;
pub mod equations;
pub mod flow;
pub mod granular_medium;
pub mod interface;
pub mod porous;
pub mod registry;
pub mod rheology;
pub mod solid;
pub mod uniaxial;
pub mod yield_set;

pub use common::input::InputError;
pub use common::rounding::Rounded;
pub use common::system::LinearisedSystem;
pub use flow::closed_form::ClosedFormVerdict;
