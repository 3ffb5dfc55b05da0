//! Solids: an elastic law, and the yield set that may limit the stress.

mod elastic_law;

pub use elastic_law::ElasticLaw;
