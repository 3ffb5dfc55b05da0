//! Tests of the whole program and of the public library in one program, so that it is compiled and linked once.
//!
//! `cargo test --release --test suite run::` runs the tests of one file. Tests with an
//! allocator or registered models of their own are programs of their own.

mod mutation;
mod polyhedral_set;
mod program;
mod reference;
mod states;
mod support;

#[path = "accuracy.rs"]
mod accuracy;
#[path = "bloch.rs"]
mod bloch;
#[path = "case_files/main.rs"]
mod case_files;
#[path = "certificates.rs"]
mod certificates;
#[path = "certified.rs"]
mod certified;
#[path = "check.rs"]
mod check;
#[path = "check_blocks.rs"]
mod check_blocks;
#[path = "check_equations.rs"]
mod check_equations;
#[path = "check_reports.rs"]
mod check_reports;
#[path = "check_units.rs"]
mod check_units;
#[path = "code_blocks.rs"]
mod code_blocks;
#[path = "command_line.rs"]
mod command_line;
#[path = "comparison.rs"]
mod comparison;
#[path = "diagram.rs"]
mod diagram;
#[path = "dispersion.rs"]
mod dispersion;
#[path = "documents.rs"]
mod documents;
#[path = "dry_run.rs"]
mod dry_run;
#[path = "dynamics_cases/main.rs"]
mod dynamics_cases;
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
#[path = "fuzz.rs"]
mod fuzz;
#[path = "half_spaces.rs"]
mod half_spaces;
#[path = "homogenise.rs"]
mod homogenise;
#[path = "hopper.rs"]
mod hopper;
#[path = "hostile.rs"]
mod hostile;
#[path = "joint_outputs.rs"]
mod joint_outputs;
#[path = "kills.rs"]
mod kills;
#[path = "layer_ends.rs"]
mod layer_ends;
#[path = "library.rs"]
mod library;
#[path = "limits.rs"]
mod limits;
#[path = "log_maps.rs"]
mod log_maps;
#[path = "messages.rs"]
mod messages;
#[path = "normal_limits.rs"]
mod normal_limits;
#[path = "picture_layout.rs"]
mod picture_layout;
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
#[path = "rank_matrix.rs"]
mod rank_matrix;
#[path = "ranks.rs"]
mod ranks;
#[path = "receivers.rs"]
mod receivers;
#[path = "references.rs"]
mod references;
#[path = "report_page.rs"]
mod report_page;
#[path = "result_folders.rs"]
mod result_folders;
#[path = "resume.rs"]
mod resume;
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
#[path = "split.rs"]
mod split;
#[path = "thin_grids.rs"]
mod thin_grids;
#[path = "units.rs"]
mod units;
#[path = "verbs.rs"]
mod verbs;
#[path = "waves_in_time.rs"]
mod waves_in_time;
#[path = "wrong_inputs.rs"]
mod wrong_inputs;
