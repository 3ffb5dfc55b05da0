//! Elastoplastic solids in time.
//!
//! | module | holds |
//! |---|---|
//! | [`problem`] | what is to be solved: grid, media, boundary conditions, sources, scheme |
//! | [`medium`] | a solid as pairs of waves along the axes, a rotation, and a yield set |
//! | [`boundary`] | boundary conditions, loads and sources |
//! | `cell`, `riemann`, `reconstruction`, [`mod@line`] | a one-dimensional sweep: constants of a cell, interface states, limiter, update |
//! | [`interlayers`], [`interface`] | thin layers with mass between blocks of cells; faces with memory along a line |
//! | `ghosts` | boundary conditions as ghost cells |
//! | [`metric`] | layers with spacings of their own, and polar blocks |
//! | [`domain`] | the fused solver; its `step` is the recipe of a time step |
//! | [`mod@reference`] | the same scheme written plainly, with the energy account of every cell; `cell_laws`: formulas of both |
//! | [`region`], `restriction` | a part of a grid with its halo; the problem of such a part |
//! | [`snapshot`] | the state, as solvers save and restore it |
//! | [`ledger`] | the energy, and what steps do to it |
//! | [`initial`], [`point_kernel`], [`probe`] | initial states, point sources spread over cells, receivers |

pub(crate) mod axis_permutation;
pub mod boundary;
mod cell;
mod cell_laws;
#[cfg(test)]
mod contraction;
pub mod domain;
mod ghosts;
pub mod initial;
pub mod interface;
pub mod interlayers;
pub mod ledger;
pub mod line;
pub mod medium;
pub mod metric;
pub mod point_kernel;
pub mod probe;
pub mod problem;
mod reconstruction;
pub mod reference;
pub mod region;
mod restriction;
mod riemann;
pub mod snapshot;
