//! Functions and types shared by several tests.

pub mod blocky;
pub mod chain;
pub mod interlayers;
pub mod media;
mod noise;
pub mod random;
pub mod shear_flow;

pub use noise::noise;
