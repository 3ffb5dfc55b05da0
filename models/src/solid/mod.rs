//! Elastic solids: what an elastic law states, and the entry of a solid in the registry.

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
