//! Tests of the whole program and of the public library in one program, so that it is compiled and linked once.
//!
//! `cargo test --release --test suite run::` runs the tests of one file. Tests with an allocator, process settings or
//! registered models of their own, and long ones, are programs of their own.

mod polyhedral_set;
mod program;
mod reference;
mod states;
mod support;

#[path = "accuracy.rs"]
mod accuracy;
#[path = "bloch.rs"]
mod bloch;
#[path = "check.rs"]
mod check;
#[path = "check_blocks.rs"]
mod check_blocks;
#[path = "check_equations.rs"]
mod check_equations;
#[path = "check_reports.rs"]
mod check_reports;
#[path = "diagram.rs"]
mod diagram;
#[path = "dispersion.rs"]
mod dispersion;
#[path = "documents.rs"]
mod documents;
#[path = "dry_run.rs"]
mod dry_run;
#[path = "equations_in_space.rs"]
mod equations_in_space;
#[path = "extreme_numbers.rs"]
mod extreme_numbers;
#[path = "first_use.rs"]
mod first_use;
#[path = "flow.rs"]
mod flow;
#[path = "flow_cases.rs"]
mod flow_cases;
#[path = "flow_run.rs"]
mod flow_run;
#[path = "half_spaces.rs"]
mod half_spaces;
#[path = "homogenise.rs"]
mod homogenise;
#[path = "joint_outputs.rs"]
mod joint_outputs;
#[path = "layer_ends.rs"]
mod layer_ends;
#[path = "library.rs"]
mod library;
#[path = "messages.rs"]
mod messages;
#[path = "normal_limits.rs"]
mod normal_limits;
#[path = "pictures.rs"]
mod pictures;
#[path = "point_loads.rs"]
mod point_loads;
#[path = "polar_grids.rs"]
mod polar_grids;
#[path = "profiles.rs"]
mod profiles;
#[path = "ranges.rs"]
mod ranges;
#[path = "receivers.rs"]
mod receivers;
#[path = "references.rs"]
mod references;
#[path = "routes.rs"]
mod routes;
#[path = "run.rs"]
mod run;
#[path = "shocks.rs"]
mod shocks;
#[path = "simulate.rs"]
mod simulate;
#[path = "snapshots.rs"]
mod snapshots;
#[path = "solids.rs"]
mod solids;
#[path = "verbs.rs"]
mod verbs;
#[path = "waves_in_time.rs"]
mod waves_in_time;
#[path = "wrong_inputs.rs"]
mod wrong_inputs;
