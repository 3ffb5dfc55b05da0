//! Elastic solids: Cosserat, reduced Cosserat and classical, in space and in plane strain.

pub mod parameters;
pub mod stress;
pub mod symbol;
pub mod waves;
