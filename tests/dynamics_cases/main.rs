//! Tests of time-domain sections of case files: parsing, refusals and messages.

mod interpretation;
mod parsing;
mod refusals;
#[path = "../support/mod.rs"]
mod support;

use support::parse_case;
use wellposed::case::dynamics::SolidRun;

/// Plane-strain case with every section; tests refer to its line numbers.
const PLANE_CASE: &str = "\
title = 'Plane'
[model]
kind = 'cosserat'
lambda = 2e9
mu = 1e9
alpha = 5e8
beta = 1e3
gamma = 1e3
eta = 1e3
density = 2000
inertia = 0.5
[yield]
kind = 'cosserat-mises'
strength = 1e6
friction = 0.5
dilatancy = 0.5
antisymmetric_weight = 1

[grid]
cells = [20, 10]
spacing = [0.5, 1]
origin = [-5, 0]
[time]
duration = 0.25
courant = 0.9
[scheme]
order = 'godunov'
precision = 'f32'

[[region]]
shape = 'box'
from = [-5, 0]
to = [0, 10]
model = { mu = 3e9 }
[[region]]
shape = 'circle'
center = [2.5, 5]
radius = 1.5
yield = { kind = 'none' }
[[region]]
shape = 'rest'
yield = { kind = 'von-mises', strength = 5 }

[[boundary]]
side = 'x2-'
kind = 'fixed'
[[boundary]]
side = 'x2-'
kind = 'mixed'
from = [-1]
to = [1]
fixed_components = ['v2', 'w3']
[[load]]
side = 'x2+'
field = 'sigma22'
amplitude = -1e6
time = { kind = 'triangle', duration = 0.01 }
[[load]]
side = 'x2+'
field = 'm32'
amplitude = 3
at = [0.5]
radius = 0.25
time = { kind = 'ricker', frequency = 30 }
[[load]]
side = 'x1-'
field = 'v1'
amplitude = 0.1
from = [2]
to = [4]
time = { kind = 'step', start = 0.1, duration = 0.1 }

[[source]]
kind = 'force'
amplitude = [1, 2]
at = [0, 5]
radius = 1
time = { kind = 'sine', frequency = 100 }
[[source]]
kind = 'couple'
amplitude = 7
at = [0, 5]
time = { kind = 'pulse', start = 0.1, duration = 0.2 }
[[source]]
kind = 'moment'
amplitude = [[1, 0], [0, -1]]
at = [0, 5]
time = { kind = 'step' }
[[source]]
kind = 'explosion'
amplitude = 9
at = [0, 5]
time = { kind = 'step', start = 1 }

[[initial]]
kind = 'pulse'
field = 'v1'
amplitude = 0.5
at = [1, 2]
radius = 0.5
[[initial]]
kind = 'pulse'
field = 'w3'
amplitude = 0.5
axis = 2
at = 3
radius = 0.5
[[initial]]
kind = 'plane-wave'
branch = 2
direction_deg = 30
wavelength = 2
amplitude = 0.1
[[initial]]
kind = 'rotation'
shape = 'half-plane'
point = [0, 0]
normal = [0, 1]
angle_deg = 5
[[initial]]
kind = 'uniform'
shape = 'everywhere'
field = 'sigma33'
amplitude = 2

[initial_stress]
sigma11 = -1e5
sigma33 = -2e5
m31 = 4
[gravity]
acceleration = [0, -9.81]
lateral_ratio = 0.5

[[receiver]]
at = [0, 5]
[[receiver]]
name = 'surface.1'
at = [5, 10]
fields = ['v1', 'sigma21']
[output]
ledger_interval = 0.001
picture = 'w3'
contours = [-1, 0.5]
";

/// Three-dimensional case.
const SPATIAL_CASE: &str = "\
[model]
kind = 'classical'
dimensions = 3
lambda = 2e9
mu = 1e9
density = 2000
[grid]
cells = [4, 6, 8]
spacing = 0.5
[time]
duration = 1
[[region]]
shape = 'layer'
axis = 3
from = 0
to = 2
[[region]]
shape = 'half-space'
point = [0, 0, 2]
normal = [0, 0, 1]
model = { kind = 'classical', lambda = 0, mu = 5e8 }
yield = { kind = 'drucker-prager', strength = 1e6, friction = 0.5, dilatancy = 0.5 }
[[boundary]]
side = 'x1-'
kind = 'periodic'
[[boundary]]
side = 'x1+'
kind = 'periodic'
[[boundary]]
side = 'x2+'
kind = 'non-reflecting'
from = [0, 0]
to = [1, 1]
[[load]]
side = 'x3+'
field = 'sigma31'
amplitude = 1
at = [1, 1]
time = { kind = 'step' }
[[source]]
kind = 'moment'
amplitude = [[0, 0, 1], [0, 0, 0], [1, 0, 0]]
at = [1, 1, 1]
time = { kind = 'step' }
[[initial]]
kind = 'plane-wave'
branch = 1
direction_deg = 30
elevation_deg = 10
wavelength = 2
amplitude = 0.1
[[initial]]
kind = 'uniform'
shape = 'sphere'
center = [1, 1, 1]
radius = 0.5
field = 'sigma32'
amplitude = 2
[gravity]
acceleration = [1, 0, -9]
balanced = false
[[receiver]]
at = [1, 1, 4]
";

fn parse_dynamics(text: &str) -> SolidRun {
    parse_case(text).unwrap().solid_run.unwrap()
}
