//! Flow case with every section of a study of states except `check`, and helpers that parse it.

use crate::support::parse_case_with;
use wellposed::case::Case;

/// Flow case with model, background, wave, map and comparison; tests refer to its line numbers.
pub const FULL_CASE: &str = "\
title = 'All sections'
[model]
kind = 'harris-grekova'
friction_angle_deg = 30
dilatancy_angle_deg = 10.5
moment_of_inertia = 1.25e-7
rotational_strength = 5

[background]
density = 1600
pressure = 1000.25
stress_angle_deg = 45
shear_rate = 2
velocity = [0.5, 0.25]
spin = -0.125
pressure_gradient = [1, -2]

[wave]
number = 500
direction_deg = 30

[map]
x = { parameter = 'background.pressure', from = 1, to = 9, points = 5 }
y = { parameter = 'background.velocity[1]', from = -1, to = 1, points = 3 }

[compare]
kinds = ['harris-grekova', 'double-shearing']
";

/// Parses [`FULL_CASE`] with settings in the notation of the option `--set`.
pub fn parse_full_case_with(settings: &[&str]) -> Result<Case, String> {
    parse_case_with(FULL_CASE, settings)
}

/// Derives model and background of a case, i.e. all that precedes the analysis.
pub fn derive_background(case: &Case) -> Result<(), String> {
    let background = case
        .build_located_model()
        .map_err(|error| error.to_string())?
        .background(&case.to_flow_state());
    background.map(|_| ()).map_err(|error| case.locate_error(error).to_string())
}
