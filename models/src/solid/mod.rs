//! Elastic solids: the interface of an elastic law, rate equations, one-dimensional waves, and registry entries.

pub mod cubic_plane;
mod elastic_law;
pub mod isotropic;
mod model;
pub mod parameters;
pub mod stress;
pub mod symbol;
pub mod waves;

pub use elastic_law::{ElasticLaw, Elasticity};
pub use model::{SolidKind, SolidModel};
