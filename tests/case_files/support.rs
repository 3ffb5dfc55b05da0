//! Case with every section, and helpers that parse it.

use wellposed::case::Case;

/// Case with every section; tests refer to its line numbers.
pub const CASE: &str = "\
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

pub fn parse(text: &str) -> Result<Case, String> {
    Case::parse(text, "folder/x.toml", &[]).map_err(|error| error.to_string())
}

pub fn parse_with(sets: &[&str]) -> Result<Case, String> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Case::parse(CASE, "folder/x.toml", &sets).map_err(|error| error.to_string())
}

/// Derives model and background of a case, i.e. everything before the analysis.
pub fn check(case: &Case) -> Result<(), String> {
    let background = case.model().map_err(|error| error.to_string())?.background(&case.state());
    background.map(|_| ()).map_err(|error| case.locate(error).to_string())
}
