//! Tests of time-domain sections of case files: parsing, refusals and messages.

mod interpretation;
mod parsing;
mod refusals;

use crate::support::parse_case;
use wellposed::case::dynamics::SolidRun;

/// Plane-strain case with every section of a run except `[[block]]`, `[[joint]]` and `[check]`; tests refer to its line
/// numbers.
const PLANE_CASE: &str = include_str!("../data/plane.toml");

/// Three-dimensional case of a time-domain simulation.
const SPATIAL_CASE: &str = include_str!("../data/spatial.toml");

fn parse_solid_run(text: &str) -> SolidRun {
    parse_case(text).unwrap().solid_run.unwrap()
}
