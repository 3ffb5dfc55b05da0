//! Tests of the solid solvers, in one program, so that their kernels are compiled once.
//!
//! `cargo test --release -p wellposed-dynamics --test solid energy::` runs the tests of one file.

mod block_rotation;
mod blocks;
mod blocky_ledger;
mod blocky_media;
mod configurations;
mod contact_waves;
mod contacts;
mod damped_waves;
mod decomposition;
mod domain;
mod energy;
mod guided_wave;
mod idle_axes;
mod interlayers;
mod ledger;
mod line;
mod metric;
mod passes;
mod plane_waves;
mod plastic;
mod plastic_fronts;
mod rank_plan;
mod ranks;
mod rayleigh;
mod relaxation;
mod return_mapping;
mod rockhole;
mod saturated_cuts;
mod shear_steps;
mod simple_waves;
mod simulation;
mod subdomain_regions;
mod support;
mod sweep_order;
mod thread_start;
mod uniaxial;
mod verification;
mod wide_stencil;
