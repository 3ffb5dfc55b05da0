//! Solids in time by sweeps along coordinate lines, granular flow in time by Fourier series, and their energy ledgers.
//!
//! It knows no case and no file, and nothing of the analysis: records, snapshots and checkpoints go to an observer.
//!
//! - [`medium`]: what a solid is to the sweeps;
//! - [`problem`]: what is to be solved;
//! - [`domain`]: fields on a rectangular grid, and a step of theirs;
//! - [`boundary`]: what lies beyond its sides, and what acts there and inside;
//! - [`point_kernel`]: the shares of cells in what acts at a point;
//! - [`initial`]: weight in equilibrium, and waves that a solid begins with;
//! - [`ledger`]: the energy there is, and what steps did to it;
//! - [`split`]: the same in parts, each in a thread of its own, and the halo between them;
//! - [`mod@line`]: one pair of fields along a line of cells and joints, with its energy account;
//! - [`kernel`]: the same on many lines at once, in the instructions that the processor has;
//! - [`simulation`]: the loop in time, for solids and flows;
//! - [`probe`]: points at which fields are recorded;
//! - [`real`]: floating-point numbers, and groups of them;
//! - [`flow`]: granular flow in a box that moves with it, by Fourier series.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod axis_permutation;
pub mod boundary;
mod cell;
#[cfg(test)]
mod contraction;
pub mod domain;
pub mod flow;
pub mod initial;
pub mod kernel;
pub mod ledger;
pub mod line;
pub mod medium;
pub mod point_kernel;
pub mod probe;
pub mod problem;
pub mod real;
mod row;
mod side;
pub mod simulation;
pub mod split;
mod vector;
