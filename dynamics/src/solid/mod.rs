//! Time-domain solvers of elastoplastic solids.
//!
//! | module | contents |
//! |---|---|
//! | [`problem`] | problem definition: grid, media, boundary conditions, sources, scheme |
//! | [`medium`] | a solid as wave pairs along the axes, rotation, relaxation and yield set |
//! | [`contact_law`], `contact_faces` | contact of particles and of walls of pores: law of a cell, faces |
//! | [`boundary`] | boundary conditions, loads and sources |
//! | `cell`, `riemann`, `reconstruction`, [`mod@line`] | sweep: cell constants, Riemann solver, limiter, update |
//! | `wide_stencil` | sweeps of sixth and eighth order |
//! | [`interlayers`], [`interface`] | thin layers with mass between blocks of cells; faces with history along a line |
//! | `fluid_network` | flow of the fluid along saturated interlayers and through their junctions |
//! | `ghosts` | boundary conditions as ghost cells |
//! | [`metric`] | cell lengths that vary by layer, and polar blocks |
//! | [`domain`] | fused solver; its `step` defines the sequence of operations of a time step |
//! | [`mod@reference`] | reference solver with full energy ledger; `cell_laws`: formulas of both solvers |
//! | [`region`], `restriction` | subdomain with its halo; problem restricted to it |
//! | [`snapshot`] | state for checkpoints |
//! | [`ledger`] | energy, work and dissipation |
//! | [`initial`], [`point_kernel`], [`probe`] | initial states, point sources distributed over cells, receivers |

pub(crate) mod axis_permutation;
pub mod boundary;
mod cell;
mod cell_laws;
mod contact_faces;
pub mod contact_law;
#[cfg(test)]
mod contraction;
pub mod domain;
mod fluid_network;
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
#[cfg(test)]
mod random_lines;
mod reconstruction;
pub mod reference;
pub mod region;
mod restriction;
mod riemann;
mod shear_steps;
pub mod snapshot;
mod wide_stencil;
