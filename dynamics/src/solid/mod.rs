//! Solids in time.

pub mod boundary;
mod cell;
#[cfg(test)]
mod contraction;
pub mod domain;
mod ghosts;
pub mod initial;
pub mod ledger;
pub mod line;
pub mod medium;
pub mod point_kernel;
pub mod probe;
pub mod problem;
mod reconstruction;
mod riemann;
