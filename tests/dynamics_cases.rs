//! What case files say of runs in time: what is read, what is refused and in which words.

use models::cosserat::parameters::{Isotropic, Theory};
use models::registry;
use std::panic::{AssertUnwindSafe, catch_unwind};
use wellposed::case::dynamics::{
    Action, Centre, Component, Condition, Dynamics, Initial, Kernel, Picture, Recorded, Shape,
    Side, SourceKind, TimeFunction,
};
use wellposed::case::{Case, Kind, Medium, Yield};
use wellposed::new::{self, Purpose};
use wellposed::setup;
use wellposed::{Options, cli};

/// Plane strain with everything that it can have; tests refer to its lines.
const PLANE: &str = "\
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

[[side]]
side = 'x2-'
kind = 'fixed'
[[side]]
side = 'x2-'
kind = 'mixed'
from = [-1]
to = [1]
held = ['v2', 'w3']
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

/// Space.
const SPACE: &str = "\
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
[[side]]
side = 'x1-'
kind = 'periodic'
[[side]]
side = 'x1+'
kind = 'periodic'
[[side]]
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

fn parse(text: &str) -> Result<Case, String> {
    Case::parse(text, "folder/x.toml", &[]).map_err(|error| error.to_string())
}

fn parse_with(text: &str, sets: &[&str]) -> Result<Case, String> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Case::parse(text, "folder/x.toml", &sets).map_err(|error| error.to_string())
}

fn dynamics(text: &str) -> Dynamics {
    parse(text).unwrap().dynamics.unwrap()
}

/// The text with a part replaced that must be there.
fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

#[test]
fn a_case_is_read_as_written() {
    let dynamics = dynamics(PLANE);
    assert_eq!(dynamics.grid.extent(0), [-5.0, 5.0]);
    assert_eq!((dynamics.grid.count(), dynamics.time.courant), (200, 0.9));
    assert_eq!(dynamics.scheme.order.name(), "godunov");
    assert_eq!(dynamics.scheme.correction.name(), "first-order");
    let names = |list: &[Component]| list.iter().map(Component::to_string).collect::<Vec<_>>();
    let Condition::Mixed { held } = &dynamics.sides[1].condition else { panic!() };
    assert_eq!(names(held), ["v2", "w3"]);
    assert_eq!(
        dynamics.loads[1].action,
        Action::Point { at: vec![0.5], kernel: Kernel::Bell { radius: 0.25 } }
    );
    assert_eq!(dynamics.loads[1].time, TimeFunction::Ricker { frequency: 30.0, delay: 1.5 / 30.0 });
    assert_eq!(dynamics.loads[2].side, Side { axis: 0, is_upper: false });
    assert_eq!(dynamics.sources[1].action, SourceKind::Couple(vec![7.0]));
    assert!(matches!(
        dynamics.initial[1],
        Initial::Pulse { centre: Centre::Plane { axis: 1, at: 3.0 }, .. }
    ));
    assert!(matches!(dynamics.initial[3], Initial::Rotation { axis: 2, .. }));
    let stresses: Vec<(String, f64)> =
        dynamics.initial_stress.iter().map(|(c, value)| (c.to_string(), *value)).collect();
    let expected = [
        ("sigma11", -1e5),
        ("sigma12", 0.0),
        ("sigma21", 0.0),
        ("sigma22", 0.0),
        ("sigma33", -2e5),
        ("m31", 4.0),
        ("m32", 0.0),
        ("m13", 0.0),
        ("m23", 0.0),
    ];
    assert_eq!(stresses, expected.map(|(name, value)| (name.to_owned(), value)));
    let gravity = dynamics.gravity.unwrap();
    assert!(gravity.is_balanced && gravity.lateral_ratio == 0.5);
    assert_eq!(dynamics.receivers[0].name, "r1");
    assert_eq!(dynamics.receivers[0].fields.len(), 12);
    let recorded = |list: &[Recorded]| list.iter().map(Recorded::to_string).collect::<Vec<_>>();
    assert_eq!(recorded(&dynamics.receivers[1].fields), ["v1", "sigma21"]);
    assert!(matches!(dynamics.output.picture, Picture::Component(_)));
    assert_eq!(dynamics.output.contours, Some(vec![-1.0, 0.5]));

    // Integrals that are kept are recorded where they are asked for, or nothing in particular is.
    let sets = ["output.integrals=['u2']", "receiver[1].fields=['u2', 'v1']"];
    let dynamics = parse_with(PLANE, &sets).unwrap().dynamics.unwrap();
    assert_eq!(recorded(&dynamics.receivers[0].fields).last().unwrap(), "u2");
    assert_eq!(recorded(&dynamics.receivers[1].fields), ["u2", "v1"]);
    let error = parse_with(PLANE, &sets[1..]).unwrap_err();
    assert!(error.contains("receiver[1].fields: found 'u2'; did you mean 'v2'?"), "{error}");

    // The grid says in how many dimensions the solid is.
    let case = parse(PLANE).unwrap();
    assert_eq!(case.numbers.dimensions, 2);
    // Without sections for it a case is not run in time.
    assert_eq!(parse(&wellposed::new::text(case.medium())).unwrap().dynamics, None);
}

#[test]
fn regions_inherit_what_they_do_not_have() {
    let case = parse(PLANE).unwrap();
    let regions = &case.dynamics.as_ref().unwrap().regions;
    let modulus = |case: &Case| {
        let law = setup::solid::solid(case).unwrap().elastic;
        let solid = law.downcast::<Isotropic>().unwrap();
        [solid.lambda, solid.mu]
    };
    assert_eq!(modulus(&regions[0].case), [2e9, 3e9]);
    assert_eq!(modulus(&regions[1].case), [2e9, 1e9]);
    let sets: Vec<Option<Yield>> = regions.iter().map(|region| region.case.yields).collect();
    assert_eq!(sets, [Some(registry::COSSERAT_MISES), None, Some(registry::VON_MISES)]);
    assert_eq!(regions[0].case.numbers.yields, case.numbers.yields);
    let other = &regions[2].case.numbers.yields;
    assert_eq!((other.get("strength"), other.get("friction")), (Some(5.0), None));

    // Another kind has nothing of the case's own, and its own yield set where that is possible.
    let text = with(
        PLANE,
        "yield = { kind = 'none' }",
        "model = { kind = 'reduced-cosserat', lambda = 1, mu = 1, alpha = 1, density = 1, \
         inertia = 1 }",
    );
    let other = &dynamics(&text).regions[1].case;
    assert_eq!(other.kind, Kind::Solid(registry::REDUCED_COSSERAT));
    assert_eq!(other.yields, Some(registry::COSSERAT_MISES));
    assert_eq!((other.numbers.dimensions, other.numbers.model.get("beta")), (2, None));
}

#[test]
fn an_error_of_a_model_names_the_line_of_the_region() {
    let located = |text: &str, sets: &[&str]| {
        let case = parse_with(text, sets).unwrap();
        let region = &case.dynamics.as_ref().unwrap().regions[0].case;
        region.locate(setup::solid::solid(region).unwrap_err()).to_string()
    };
    let text = with(PLANE, "mu = 3e9", "mu = -3e9");
    let start = "folder/x.toml:34: region[0].model.mu: found -3000000000";
    let error = located(&text, &[]);
    assert!(error.starts_with(start), "{error}");
    // What is inherited stands where it stands.
    let error = located(&with(PLANE, "alpha = 5e8", "alpha = -5"), &[]);
    assert!(error.starts_with("folder/x.toml:6: model.alpha: found -5"), "{error}");
    let error = located(PLANE, &["region[0].model.mu=-1"]);
    let start = "--set region[0].model.mu=-1: region[0].model.mu: found -1";
    assert!(error.starts_with(start), "{error}");
    let case = parse(PLANE).unwrap();
    let error = case.dynamics.unwrap().locate("load[1].at", "too near", "move it").to_string();
    assert_eq!(error, "folder/x.toml:62: load[1].at: too near; move it");
}

#[test]
fn the_resolved_case_reads_back_to_itself() {
    let spinning = SPACE
        .replacen("'classical'", "'cosserat'", 1)
        .replace("sigma31", "sigma13")
        .replace("sigma32", "sigma23")
        .replacen("mu =", "alpha = 1\nbeta = 1\ngamma = 1\neta = 1\ninertia = 1\nmu =", 1)
        + "[[initial]]
kind = 'rotation'
shape = 'layer'
axis = 1
from = 0
to = 1
about = 2
angle_deg = 3
[[source]]
kind = 'couple'
amplitude = [1, 2, 3]
at = [1, 1, 1]
time = { kind = 'step' }
";
    let spinning = spinning.replace("lambda = 0, mu = 5e8", "lambda = 0, mu = 5e8, density = 1");
    for text in [PLANE, SPACE, &spinning] {
        let case = parse(text).unwrap();
        let resolved = case.to_toml();
        let again = parse(&resolved).unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(again, case, "{resolved}");
        assert_eq!(again.to_toml(), resolved);
        for default in ["correction = \"first-order\"", "start = 0.0", "fields = [\"v1\", \"v2\""] {
            assert!(resolved.contains(default), "{default} is missing in\n{resolved}");
        }
        // A difference in a run is a difference between cases.
        let other = parse_with(text, &["time.duration=7"]).unwrap();
        assert_ne!(other, case);
    }
}

#[test]
fn options_reach_all_sections() {
    let case = parse_with(
        PLANE,
        &[
            "grid.cells=[40, 20]",
            "grid.spacing=[0.25, 0.5]",
            "time.duration=0.1",
            "load[0].amplitude=2e6",
            "load[2].time={ kind = 'step', start = 3 }",
            "load[2].time.start=4",
            "region[0].model.mu=1e9",
            "region[1].yield.kind=von-mises",
            "region[1].yield.strength=8",
            "output.picture=speed",
            "scheme.ledger=full",
            "side[0].kind=free",
            "receiver[0].name=here",
        ],
    )
    .unwrap();
    let dynamics = case.dynamics.unwrap();
    assert_eq!((dynamics.grid.cells, dynamics.time.duration), (vec![40, 20], 0.1));
    assert_eq!(dynamics.loads[0].amplitude, 2e6);
    assert_eq!(dynamics.loads[2].time, TimeFunction::Step { start: 4.0, duration: None });
    assert_eq!(dynamics.regions[0].case.numbers.model.get("mu"), Some(1e9));
    assert_eq!(dynamics.regions[1].case.numbers.yields.get("strength"), Some(8.0));
    assert_eq!(dynamics.output.picture, Picture::Speed);
    assert_eq!(dynamics.scheme.ledger.name(), "full");
    assert_eq!(dynamics.sides[0].condition, Condition::Free);
    assert_eq!(dynamics.receivers[0].name, "here");
    // A case without sections gets them.
    let (model, _) = PLANE.split_once("[grid]").unwrap();
    let sets = ["grid.cells=[2,2]", "grid.spacing=1", "time.duration=1"];
    assert_eq!(parse_with(model, &sets).unwrap().dynamics.unwrap().grid.origin, [0.0, 0.0]);

    for (set, message) in [
        ("load[3].amplitude=1", "load: the index 3 of 3; expected an index from 0 to 2"),
        ("load.amplitude=1", "load: a list of 3; write load[0] with an index from 0 to 2"),
        ("grid[0].cells=1", "grid: the index 0; grid is no list"),
        ("grid.cells[0]=1", "grid.cells: the index 0; set the value as a whole"),
        ("grid.cells.x=1", "grid.cells: no section; a key inside it cannot be set"),
        (
            "load[x].at=1",
            "load[x].at: no key; write section.key or section[0].key, the index counted from 0",
        ),
        (
            "load[0]=1",
            "load[0]: found the integer 1; name a key inside it, or give a table in braces",
        ),
        ("grid=1", "grid: found the integer 1; expected a section [grid]"),
        ("load=1", "load: found the integer 1; expected sections [[load]]"),
        (
            "time.courant=1.5",
            "time.courant: found the number 1.5; expected a number above 0 and at most 1 (Courant \
             number): a sweep is unstable above 1",
        ),
        (
            "load[2].time={ kind = 'step', stat = 3 }",
            "load[2].time.stat: unknown key; did you mean 'start'? allowed here: kind, start, \
             duration",
        ),
        (
            "region[1].model.mv=1",
            "region[1].model.mv: unknown key; did you mean 'mu'? allowed here: kind, dimensions, \
             lambda, mu, alpha, beta, gamma, eta, density, inertia",
        ),
        (
            "grid.cells=[3]",
            "grid.cells: found [3]; expected a list of 2 or 3 whole numbers of at least 1 (cells along each axis)",
        ),
    ] {
        let error = parse_with(PLANE, &[set]).expect_err(set);
        assert_eq!(error, format!("--set {set}: {message}"));
    }
    let flow = wellposed::new::text(Kind::flows()[0]);
    let error = parse_with(&flow, &["grid.spacing=1"]).unwrap_err();
    let start = "--set grid.spacing=1: grid.spacing: found for a flow; give length, the edges of";
    assert!(error.starts_with(start), "{error}");
    let error = parse_with(SPACE, &["receiver[1].at=[0,0,0]"]).unwrap_err();
    assert!(
        error.ends_with("receiver: the index 1 of 1; expected an index from 0 to 0"),
        "{error}"
    );
    let error = parse_with(model, &["load[0].at=1"]).unwrap_err();
    let end = "load: the index 0 of no entry; add [[load]] to the file first";
    assert_eq!(error, format!("--set load[0].at=1: {end}"));
}

/// Replaces a part of [`PLANE`] and expects the whole message.
#[test]
fn bad_input_is_answered_with_line_key_and_remedy() {
    const FIELDS: &str =
        "v1, v2, w3, sigma11, sigma12, sigma21, sigma22, sigma33, m31, m32, m13, m23";
    #[rustfmt::skip]
    let table: &[(&str, &str, &str)] = &[
        // sections and keys
        ("[grid]", "[grdi]", "19: grdi: unknown key; did you mean 'grid'? allowed here: title, name, [model], [yield], [stress], [wave], [map], [check], [grid], [time], [scheme], [[region]], [[side]], [[load]], [[source]], [[initial]], [initial_stress], [gravity], [[receiver]], [output]"),
        ("[[receiver]]", "[[reciever]]", "134: reciever: unknown key; did you mean 'receiver'? allowed here: "),
        ("spacing = [0.5, 1]", "spacin = 1", "19: grid.spacing: missing; add spacing to [grid]: expected a positive number or a list of 2 positive numbers in m (edges of a cell)"),
        ("origin = [-5, 0]", "orign = [-5, 0]", "22: grid.orign: unknown key; did you mean 'origin'? allowed here: cells, spacing, origin"),
        ("courant = 0.9", "courant = 1.5", "25: time.courant: found the number 1.5; expected a number above 0 and at most 1 (Courant number): a sweep is unstable above 1"),
        ("courant = 0.9", "courat = 0.9", "25: time.courat: unknown key; did you mean 'courant'? allowed here: duration, courant, rotation_deg"),
        ("duration = 0.25", "duration = 0", "24: time.duration: found the integer 0; expected a positive number in s"),
        ("duration = 0.25\n", "", "23: time.duration: missing; add duration to [time]: expected a positive number in s"),
        ("[time]\nduration = 0.25\ncourant = 0.9\n", "", ": time: missing; add a section [time] with duration in s"),
        ("'godunov'", "'godunow'", "27: scheme.order: found 'godunow'; did you mean 'godunov'? allowed: fourth-order, eno2, godunov"),
        ("'godunov'", "2", "27: scheme.order: found the integer 2; expected one of fourth-order, eno2, godunov"),
        // grid
        ("cells = [20, 10]", "cells = [20, 10, 5, 3]", "20: grid.cells: found [20, 10, 5, 3]; expected a list of 2 or 3 whole numbers of at least 1 (cells along each axis)"),
        ("cells = [20, 10]", "cells = [20, 0]", "20: grid.cells: found [20, 0]; expected a list of 2 or 3 whole numbers of at least 1 (cells along each axis)"),
        ("cells = [20, 10]", "cells = [2000000, 1000000]", "20: grid.cells: a grid of 2000000 × 1000000; expected at most 4000000000 cells in all"),
        ("spacing = [0.5, 1]", "spacing = 1e-300", "21: grid.spacing: cells of 1e-300 m from -5.0 to -5.0; expected coordinates that tell cells apart along x1"),
        ("lambda = 2e9", "dimensions = 3\nlambda = 2e9", "4: model.dimensions: found 3 in a grid of 2 dimensions; give as many as entries of grid.cells, 2, or leave it out"),
        // regions
        ("model = { mu = 3e9 }", "model = { mu = 3e9, a1 = 4 }", "34: region[0].model.a1: not used by the model cosserat; leave it out (it belongs to cosserat-compliances)"),
        ("model = { mu = 3e9 }", "model = { mu = '3e9' }", "34: region[0].model.mu: found the text '3e9'; expected a finite number in Pa (shear modulus μ; > 0)"),
        ("model = { mu = 3e9 }", "model = { kind = 'classical' }", "34: region[0].model.kind: found classical, which cannot yield by cosserat-mises; add yield = { kind = ... } with one of none, interlayer, von-mises, drucker-prager"),
        ("model = { mu = 3e9 }", "model = { kind = 'reduced-cosserat', mu = 1, lambda = 1, density = 1, inertia = 1 }", "34: region[0].model.alpha: missing; add alpha to region[0].model: expected a finite number in Pa (modulus α of the antisymmetric strain; > 0)"),
        ("model = { mu = 3e9 }", "model = { dimensions = 3 }", "34: region[0].model.dimensions: found 3 in a grid of 2 dimensions; give as many as entries of grid.cells, 2, or leave it out"),
        ("model = { mu = 3e9 }", "model = { kind = 'double-shearing' }", "34: region[0].model.kind: found double-shearing, a flow; solids alone: classical, reduced-cosserat, cosserat, cosserat-compliances"),
        ("model = { mu = 3e9 }", "model = 3", "34: region[0].model: found the integer 3; expected a table in braces { key = value, ... }"),
        ("model = { mu = 3e9 }", "modl = { mu = 3e9 }", "34: region[0].modl: unknown key; did you mean 'model'? allowed here: shape, from, to, model, yield"),
        ("yield = { kind = 'none' }", "yield = { kind = 'non' }", "39: region[1].yield.kind: found 'non'; did you mean 'none'? allowed for cosserat: interlayer, von-mises, drucker-prager, cosserat-mises, none"),
        ("yield = { kind = 'none' }", "yield = { kind = 'none', strength = 1 }", "39: region[1].yield.strength: not used by an elastic solid; leave it out (it belongs to von-mises, drucker-prager, cosserat-mises)"),
        ("yield = { kind = 'von-mises', strength = 5 }", "yield = { kind = 'von-mises' }", "42: region[2].yield.strength: missing; add strength to region[2].yield: expected a finite number in Pa (strength k in shear; > 0)"),
        ("shape = 'circle'", "shape = 'rest'", "37: region[1].center: unknown key; allowed here: shape, model, yield"),
        ("shape = 'circle'\ncenter = [2.5, 5]\nradius = 1.5", "shape = 'rest'", "39: region[2].shape: a second rest besides region[1] (folder/x.toml:35); give one region the rest"),
        ("shape = 'circle'", "shape = 'sphere'", "36: region[1].shape: found 'sphere' in a grid of 2 dimensions; write circle"),
        ("to = [0, 10]", "to = [0, 0]", "33: region[0].to: found [0.0, 0.0] with from = [-5.0, 0.0]; to must be greater than from along each axis"),
        ("radius = 1.5", "radius = 0", "38: region[1].radius: found the integer 0; expected a positive number in m"),
        // sides and loads
        ("side = 'x2-'\nkind = 'fixed'", "side = 'x3-'\nkind = 'fixed'", "45: side[0].side: found 'x3-'; did you mean 'x1-'? allowed: x1-, x1+, x2-, x2+"),
        ("kind = 'fixed'", "kind = 'periodic'", "46: side[0].kind: found periodic on x2- alone; add [[side]] with side = \"x2+\", kind = \"periodic\""),
        ("kind = 'fixed'", "kind = 'fixd'", "46: side[0].kind: found 'fixd'; did you mean 'fixed'? allowed: free, fixed, symmetry, antisymmetry, periodic, non-reflecting, mixed"),
        ("from = [-1]\n", "", "47: side[1].from: missing; give both ends of a part, from and to"),
        ("held = ['v2', 'w3']", "held = ['v2', 'w1']", "52: side[1].held: found 'w1'; did you mean 'v1'? allowed: v1, v2, w3"),
        ("held = ['v2', 'w3']\n", "", "47: side[1].held: missing; add held, a list with any of v1, v2, w3"),
        ("side = 'x2+'\nfield = 'sigma22'", "side = 'x3+'\nfield = 'sigma22'", "54: load[0].side: found 'x3+'; did you mean 'x1+'? allowed: x1-, x1+, x2-, x2+"),
        ("field = 'sigma22'", "field = 'sigma21'", "55: load[0].field: found 'sigma21'; did you mean 'sigma12'? allowed: v1, v2, w3, sigma12, sigma22, m32"),
        ("at = [0.5]", "at = [50]", "62: load[1].at: found [50.0], outside the grid; the grid has x1 from -5.0 to 5.0 m"),
        ("at = [0.5]\n", "", "62: load[1].radius: found without at; add at, the point that it is about, or leave it out"),
        ("from = [2]\nto = [4]", "at = [4]", "69: load[2].at: found for the velocity v1; a stress or couple stress, or from and to in place of at"),
        ("time = { kind = 'triangle', duration = 0.01 }", "time = { kind = 'triangel' }", "57: load[0].time.kind: found 'triangel'; did you mean 'triangle'? allowed: step, triangle, pulse, ricker, sine, table"),
        ("time = { kind = 'triangle', duration = 0.01 }", "time = { kind = 'triangle' }", "57: load[0].time.duration: missing; add duration to load[0].time: expected a positive number in s (how long it lasts)"),
        ("time = { kind = 'triangle', duration = 0.01 }", "time = { kind = 'table', file = 'none.csv' }", "57: load[0].time.file: 'none.csv': No such file or directory (os error 2); name a CSV file of two columns, time in s and value, in a folder as seen from that of the case"),
        ("time = { kind = 'triangle', duration = 0.01 }\n", "", "53: load[0].time: missing; add time to load[0]: expected a table { kind = ..., ... } (kind: step, triangle, pulse, ricker, sine, table)"),
        // sources and the initial state
        ("at = [0, 5]\nradius = 1", "at = [0, 50]\nradius = 1", "76: source[0].at: found [0.0, 50.0], outside the grid; the grid has x1 from -5.0 to 5.0 m, x2 from 0.0 to 10.0 m"),
        ("amplitude = [1, 2]", "amplitude = 1", "75: source[0].amplitude: found the integer 1; expected a list of 2 finite numbers in N/m (force by components)"),
        ("branch = 2", "branch = 4", "110: initial[2].branch: found the integer 4; expected a whole number from 1 to 3 (1 is the greatest frequency)"),
        ("field = 'sigma33'", "field = 'sigma34'", &format!("123: initial[4].field: found 'sigma34'; did you mean 'sigma33'? allowed: {FIELDS}")),
        ("normal = [0, 1]", "normal = [0, 0]", "118: initial[3].normal: found [0, 0]; expected a list of 2 numbers, not all 0 (points into the shape)"),
        ("m31 = 4", "m33 = 4", "129: initial_stress.m33: unknown key; did you mean 'm31'? allowed here: sigma11, sigma12, sigma21, sigma22, sigma33, m31, m32, m13, m23"),
        ("acceleration = [0, -9.81]", "acceleration = [1, -9.81]", "130: gravity.balanced: found true, the default, with the acceleration [1.0, -9.81]; give an acceleration along one axis, or set balanced = false"),
        // what is recorded
        ("at = [5, 10]", "at = [5.5, 10]", "138: receiver[1].at: found [5.5, 10.0], outside the grid; the grid has x1 from -5.0 to 5.0 m, x2 from 0.0 to 10.0 m"),
        ("'surface.1'", "'r1'", "137: receiver[1].name: found 'r1', the name of receiver[0] (folder/x.toml:134); give each receiver its own name"),
        ("'surface.1'", "'a b'", "137: receiver[1].name: found the text 'a b'; expected text in quotes (letters, digits, '-', '_' and '.')"),
        ("['v1', 'sigma21']", "['v1', 'v1']", "139: receiver[1].fields: found 'v1' twice; name each once"),
        ("picture = 'w3'", "picture = 'sped'", &format!("142: output.picture: found 'sped'; did you mean 'speed'? allowed: speed, {FIELDS}, dissipation")),
        ("contours = [-1, 0.5]", "contours = [1, 'a']", "143: output.contours: found a list that holds the text 'a'; expected a list of finite numbers in the unit of the picture (lines of equal value)"),
    ];
    for (old, new, message) in table {
        let error = parse(&with(PLANE, old, new)).expect_err(new);
        let file = if message.starts_with(':') { "folder/x.toml" } else { "folder/x.toml:" };
        let message = format!("{file}{message}");
        match message.ends_with(": ") {
            true => assert!(error.starts_with(&message), "{new}:\n{message}\n{error}"),
            false => assert_eq!(error, message, "{new}"),
        }
    }
}

#[test]
fn a_run_in_time_needs_a_solid_and_a_grid() {
    let (model, rest) = PLANE.split_once("[grid]\n").unwrap();
    let (_, rest) = rest.split_once("[time]").unwrap();
    let error = parse(&format!("{model}[time]{rest}")).unwrap_err();
    let end = "time: found without a grid; add a section [grid] with cells and spacing, or leave \
               this one out";
    assert_eq!(error, format!("folder/x.toml:19: {end}"));

    let plane =
        wellposed::new::text(Kind::solids()[3]) + "[grid]\ncells = [2, 2, 2]\nspacing = 1\n";
    let error = parse(&plane).unwrap_err();
    let end = "model.kind: found cosserat-compliances in a grid of 3 dimensions; it is a solid in \
               plane strain: grid.cells must have 2 entries";
    assert!(error.ends_with(end), "{error}");

    let classical = wellposed::new::text(Kind::solids()[0])
        + "[grid]\ncells = [2, 2, 2]\nspacing = 1\n[time]\nduration = 1\n";
    for (entry, end) in [
        (
            "[[initial]]\nkind = 'rotation'\n",
            "initial[0].kind: found a microrotation in a solid without spin; a Cosserat solid in \
             model.kind, or another kind here",
        ),
        (
            "[[source]]\nkind = 'couple'\n",
            "source[0].kind: found a couple in a solid without spin; a Cosserat solid in \
             model.kind, or another kind here",
        ),
        (
            "[initial_stress]\nsigma12 = 1\nsigma21 = 1\n",
            "initial_stress.sigma21: a second value of sigma12; give one: shear stresses of a \
             classical solid are equal",
        ),
        (
            "[[side]]\nside = 'x1-'\nkind = 'periodic'\n[[side]]\nside = 'x1+'\nkind = 'periodic'\n\
             [[load]]\nside = 'x1+'\n",
            "load[0].side: found x1+, which is periodic; a periodic side has no load; give \
             [[source]], or another side",
        ),
        (
            "[[side]]\nside = 'x1-'\nkind = 'periodic'\n[[side]]\nside = 'x1+'\nkind = 'periodic'\n\
             [[side]]\nside = 'x1+'\nkind = 'free'\nfrom = [0, 0]\nto = [1, 1]\n",
            "side[2].side: found a part of x1+, which is periodic; leave the part out: a side is \
             periodic as a whole",
        ),
        ("side = 3\n", "time.side: unknown key; allowed here: duration, courant, rotation_deg"),
    ] {
        let error = parse(&format!("{classical}{entry}")).unwrap_err();
        assert!(error.ends_with(end), "{error}");
    }
}

/// A line of a template: the key with its value, and whether it is taken in as it stands.
fn template_line(line: &str) -> Option<(&str, &str, bool)> {
    let inner = line.strip_prefix("# ");
    let (line, is_active) = (inner.unwrap_or(line), inner.is_none());
    let is_key = |key: &str| key.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    let (key, _) = line.split_once(" = ").filter(|(key, _)| is_key(key))?;
    Some((key, line, is_active))
}

/// The template of a run has every key that a run takes, and every entry of it is a sound one.
#[test]
fn new_runs_show_every_key() {
    for medium in Medium::all().filter(|medium| matches!(medium.kind, Kind::Solid(_))) {
        let text = new::text_for(medium, Purpose::Run);
        parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
    let cosserat = Medium::from(Kind::Solid(registry::COSSERAT));
    let text = new::text_for(cosserat, Purpose::Run);
    let (model, template) = text.split_at(text.find("\n[grid]\n").unwrap());
    // By header, all entries: the lines to take in, and all keys.
    let blocks = template.split("\n\n").map(str::trim).filter_map(|block| {
        let (header, lines) = block.split_once('\n')?;
        let (header, is_active) = match header.strip_prefix("# ") {
            Some(header) => (header, false),
            None => (header, true),
        };
        let header = header.split('#').next().unwrap().trim();
        let lines: Vec<_> = lines.lines().filter_map(template_line).collect();
        let is_taken = |line: &(&str, &str, bool)| {
            (line.2 || !is_active) && !line.1.contains("in space alone")
        };
        let taken = lines.iter().filter(|line| is_taken(line)).map(|line| format!("{}\n", line.1));
        let text = format!("{header}\n{}", taken.collect::<String>());
        header.starts_with('[').then_some((header, text, lines))
    });
    let blocks: Vec<_> = blocks.collect();
    let document = |header: &str, text: &str| {
        let others = blocks.iter().filter(|own| ["[grid]", "[time]"].contains(&own.0));
        let others: String =
            others.filter(|own| own.0 != header).map(|own| own.1.clone()).collect();
        format!("{model}\n{others}{text}")
    };
    let is_shown = |header: &str, key: &str| {
        blocks.iter().any(|own| own.0 == header && own.2.iter().any(|line| line.0 == key))
    };
    // What is allowed in place of what is not.
    let allowed = |header: &str, text: &str, before: &str| -> Vec<String> {
        let error = parse(&document(header, text)).expect_err(text);
        let (_, list) = error.split_once(before).unwrap_or_else(|| panic!("{error}"));
        list.split(", ").map(str::to_owned).collect()
    };
    for (header, text, lines) in &blocks {
        parse(&document(header, text)).unwrap_or_else(|error| panic!("{error}\n{text}"));
        if *header != "[initial_stress]" {
            for key in allowed(header, &format!("{text}odd = 0\n"), "allowed here: ") {
                assert!(is_shown(header, &key), "{key} is missing in {header}");
            }
        }
        // Words that stand for a choice.
        for (key, line, _) in lines {
            let choices = ["kind", "shape", "order", "correction", "precision", "ledger"];
            if choices.contains(key) {
                let own = format!("{text}\n");
                let own = own.replace(&format!("{line}\n"), "") + &format!("{key} = 'odd'\n");
                for word in allowed(header, &own, "allowed: ") {
                    assert!(template.contains(&word), "{word} is missing for {key} in {header}");
                }
            }
        }
        for (_, line, _) in lines.iter().filter(|line| line.0 == "time" && !line.1.contains("file"))
        {
            let (start, _) = line.split_once(" }").unwrap();
            let source = "[[source]]\nkind = 'explosion'\namplitude = 1\nat = [0, -1]\n";
            parse(&document("", &format!("{source}{line}\n"))).unwrap();
            let odd = format!("{source}{start}, odd = 0 }}\n");
            for key in allowed("", &odd, "allowed here: ").iter().filter(|_| *header == "[[load]]")
            {
                assert!(start.contains(&format!("{key} = ")), "{key} is missing in {line}");
            }
        }
    }
    for key in ["elevation_deg", "about"] {
        assert!(is_shown("[[initial]]", key), "{key}");
    }
    for name in TimeFunction::NAMES {
        assert!(template.contains(&format!("time = {{ kind = \"{name}\", ")), "{name}");
    }
    assert!(template.contains("kind = \"table\", file ="));
}

#[test]
fn other_verbs_take_such_cases() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.toml");
    std::fs::write(&file, PLANE).unwrap();
    let options = Options { case: file, dry_run: true, ..Options::default() };
    cli::dispersion(&options, &mut std::io::sink()).unwrap();
    cli::point(&options, &mut std::io::sink()).unwrap();
}

#[test]
fn every_cell_has_one_medium() {
    let media = |text: &str| dynamics(text).media_of_cells().map_err(|error| error.to_string());
    let plane = media(PLANE).unwrap();
    let count = |medium: u16| plane.iter().filter(|own| **own == medium).count();
    // Half of the grid, the centres within 1.5 m of (2.5, 5), and the rest.
    assert_eq!((plane.len(), count(0), count(1), count(2)), (200, 100, 12, 88));
    assert_eq!(plane[..11], [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2]);
    // Layers and half-spaces adjoin without gaps, though centres may lie on the plane.
    assert_eq!(media(SPACE).unwrap().iter().filter(|own| **own == 0).count(), 4 * 6 * 4);
    let (model, _) = SPACE.split_once("[[region]]").unwrap();
    let halves = format!(
        "{model}[[region]]\nshape = 'half-space'\npoint = [1.25, 0, 0]\nnormal = [-1, 0, 0]\n\
         [[region]]\nshape = 'half-space'\npoint = [1.25, 0, 0]\nnormal = [1, 0, 0]\n"
    );
    assert_eq!(media(&halves).unwrap()[..4], [0, 0, 1, 1]);
    assert_eq!(media(model).unwrap(), [0; 4 * 6 * 8]);

    let error = media(&with(PLANE, "to = [0, 10]", "to = [1.5, 10]")).unwrap_err();
    let end = "region[1]: overlaps region[0] (folder/x.toml:30) in the cell at [1.25, 4.5]; give \
               every cell to one region: move or shrink one of the two";
    assert_eq!(error, format!("folder/x.toml:35: {end}"));
    let text = with(PLANE, "shape = 'rest'", "shape = 'box'\nfrom = [0, 0]\nto = [5, 4]");
    let error = media(&text).unwrap_err();
    let end = "region: no region holds the cell at [0.25, 4.5]; add [[region]] with shape = \
               \"rest\", or make the regions larger";
    assert_eq!(error, format!("folder/x.toml:30: {end}"));
    let error = media(&with(PLANE, "center = [2.5, 5]", "center = [25, 5]")).unwrap_err();
    let end = "region[1]: no cell has its centre in it; make it larger than a cell, move it into \
               the grid, or leave it out";
    assert_eq!(error, format!("folder/x.toml:35: {end}"));
}

#[test]
fn shapes_hold_what_they_should() {
    let ball = Shape::Ball { center: vec![0.0, 0.0], radius: 5.0 };
    assert!(ball.contains(&[3.0, 3.9]) && !ball.contains(&[3.0, 4.0]));
    let boxed = Shape::Box { from: vec![0.0, 0.0], to: vec![1.0, 2.0] };
    assert!(boxed.contains(&[0.0, 1.9]) && !boxed.contains(&[1.0, 1.0]));
    let layer = Shape::Layer { axis: 1, from: 0.0, to: 1.0 };
    assert!(layer.contains(&[9.0, 0.0]) && !layer.contains(&[9.0, 1.0]));
    let half = |normal: [f64; 2]| Shape::HalfSpace { point: vec![1.0, 1.0], normal: normal.into() };
    for normal in [[1.0, 1.0], [0.0, 2.0], [-1.0, 3.0]] {
        let [one, other] = [half(normal), half(normal.map(|n| -n))];
        for x in [[1.0, 1.0], [0.0, 2.0], [2.0, 1.0], [-3.0, 1.0]] {
            assert_ne!(one.contains(&x), other.contains(&x), "{normal:?} {x:?}");
        }
    }
    assert!(half([0.0, 1.0]).contains(&[0.0, 5.0]) && !half([0.0, 1.0]).contains(&[0.0, 0.0]));
    assert!(Shape::Everywhere.contains(&[0.0, 0.0]));
}

#[test]
fn functions_of_time_have_their_values() {
    let step = TimeFunction::Step { start: 1.0, duration: Some(2.0) };
    assert_eq!([0.9, 1.0, 2.9, 3.0].map(|t| step.value(t)), [0.0, 1.0, 1.0, 0.0]);
    let step = TimeFunction::Step { start: 1.0, duration: None };
    assert_eq!([0.9, 1.0, 1e9].map(|t| step.value(t)), [0.0, 1.0, 1.0]);
    let triangle = TimeFunction::Triangle { start: 1.0, duration: 4.0 };
    assert_eq!(
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|t| triangle.value(t)),
        [0.0, 0.0, 0.5, 1.0, 0.5, 0.0]
    );
    let pulse = TimeFunction::Pulse { start: 1.0, duration: 4.0 };
    assert_eq!((pulse.value(1.0), pulse.value(3.0), pulse.value(5.0)), (0.0, 1.0, 0.0));
    assert!((pulse.value(2.0) - 0.5).abs() < 1e-15);
    let ricker = TimeFunction::Ricker { frequency: 10.0, delay: 0.15 };
    assert_eq!((ricker.value(0.15), ricker.value(1e300)), (1.0, 0.0));
    // It is 0 where a = ½.
    let zero = 0.15 + 0.5f64.sqrt() / (10.0 * std::f64::consts::PI);
    assert!(ricker.value(zero).abs() < 1e-14);
    let sine = TimeFunction::Sine { frequency: 2.0, start: 1.0 };
    assert_eq!((sine.value(0.9), sine.value(1.125)), (0.0, 1.0));
    let table = TimeFunction::from_samples(vec![[1.0, 2.0], [2.0, 4.0], [4.0, -1.0]]).unwrap();
    let times = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 4.5];
    assert_eq!(times.map(|t| table.value(t)), [0.0, 2.0, 3.0, 4.0, 1.5, -1.0, 0.0]);
    assert_eq!(TimeFunction::from_samples(vec![[1.0, 2.0], [1.0, 4.0]]), None);
    assert_eq!(TimeFunction::from_samples(vec![[1.0, 2.0]]), None);
}

#[test]
fn tables_are_read_next_to_the_case() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let table = folder.path().join("data/load.csv");
    let old = "time = { kind = 'triangle', duration = 0.01 }";
    let text = with(PLANE, old, "time = { kind = 'table', file = 'data/load.csv' }");
    let file = folder.path().join("x.toml");
    std::fs::write(&file, text).unwrap();
    let load = || Case::load(&file, &[]).map_err(|error| error.to_string());

    std::fs::write(&table, "# measured\n\ntime, value\n0, 1\n0.5,-2e3\n# more\n 1 , 0\n").unwrap();
    let case = load().unwrap();
    let TimeFunction::Table(samples) = &case.dynamics.as_ref().unwrap().loads[0].time else {
        panic!()
    };
    assert_eq!(samples.samples(), [[0.0, 1.0], [0.5, -2e3], [1.0, 0.0]]);
    let resolved = case.to_toml();
    // Whole in itself: it reads the same wherever it is taken.
    let samples = "samples = [[0.0, 1.0], [0.5, -2000.0], [1.0, 0.0]]";
    assert!(resolved.contains(&format!("time = {{ kind = \"table\", {samples} }}")));
    let named = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, &resolved).unwrap();
    assert_eq!(load().unwrap(), case);
    std::fs::write(&file, named).unwrap();

    let table_name = table.display().to_string();
    for (content, line, end) in [
        ("0,1\n0,2\n", 2, "found the time 0.0 after 0.0; times must increase"),
        (
            "0,1\n1,x\n",
            2,
            "found '1,x'; expected two finite numbers with a comma between them, time in s and value",
        ),
        (
            "t,v\nt,v\n",
            2,
            "found 't,v'; expected two finite numbers with a comma between them, time in s and value",
        ),
        (
            "# a\n0,inf\n",
            2,
            "found '0,inf'; expected two finite numbers with a comma between them, time in s and value",
        ),
    ] {
        std::fs::write(&table, content).unwrap();
        assert_eq!(load().unwrap_err(), format!("{table_name}:{line}: load[0].time.file: {end}"));
    }
    for (content, end) in [
        (
            "0,1\n",
            "'data/load.csv' has 1 sample; expected at least two lines of a time in s and a value",
        ),
        (
            "",
            "'data/load.csv' has 0 samples; expected at least two lines of a time in s and a value",
        ),
    ] {
        std::fs::write(&table, content).unwrap();
        let error = load().unwrap_err();
        assert!(error.ends_with(&format!(": load[0].time.file: {end}")), "{error}");
    }
    std::fs::write(&table, b"0,\xff\n").unwrap();
    assert!(load().unwrap_err().contains(": load[0].time.file: 'data/load.csv': not UTF-8 text; "));

    // What is no file is not opened: a pipe without a writer would never answer.
    let is_refused = || load().unwrap_err().contains("'data/load.csv': not a regular file; name a");
    std::fs::remove_file(&table).unwrap();
    std::fs::create_dir(&table).unwrap();
    assert!(is_refused());
    std::fs::remove_dir(&table).unwrap();
    if std::process::Command::new("mkfifo").arg(&table).status().is_ok_and(|made| made.success()) {
        assert!(is_refused());
    }
}

#[test]
fn components_have_names_and_sides() {
    for theory in [Theory::Classical, Theory::Reduced, Theory::Cosserat] {
        for dimensions in [2, 3] {
            let all = Component::all(theory, dimensions);
            for component in &all {
                let name = component.to_string();
                assert_eq!(Component::find(&name, theory, &all), Some(*component), "{name}");
            }
        }
    }
    let on = |theory, dimensions, axis| {
        let all = Component::on_side(theory, dimensions, axis);
        all.iter().map(Component::to_string).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(on(Theory::Classical, 2, 0), "v1 v2 sigma11 sigma12");
    assert_eq!(on(Theory::Classical, 3, 1), "v1 v2 v3 sigma12 sigma22 sigma23");
    assert_eq!(on(Theory::Reduced, 2, 1), "v1 v2 sigma12 sigma22");
    assert_eq!(on(Theory::Cosserat, 2, 0), "v1 v2 w3 sigma11 sigma21 m31");
    assert_eq!(on(Theory::Cosserat, 3, 2), "v1 v2 v3 w1 w2 w3 sigma13 sigma23 sigma33 m13 m23 m33");
}

/// Lines taken out, doubled, swapped, and given other values: nothing panics, and what is taken
/// reads back.
#[test]
fn spoiled_cases_are_taken_or_refused() {
    const VALUES: [&str; 14] = [
        "0",
        "-1",
        "1e308",
        "5e-324",
        "nan",
        "true",
        "'x'",
        "[]",
        "[1]",
        "[1, 2]",
        "[[1, 2], [3, 4]]",
        "{}",
        "[{}]",
        "{ kind = 'step', start = 1e308 }",
    ];
    let (mut taken, mut count) = (0, 0);
    for original in [PLANE, SPACE] {
        let lines: Vec<&str> = original.lines().collect();
        let mut mutants = Vec::new();
        for at in 0..lines.len() {
            let replaced = |with: &[&str]| {
                let parts = [&lines[..at], with, &lines[at + 1..]];
                parts.concat().join("\n")
            };
            mutants.push(replaced(&[]));
            mutants.push(replaced(&[lines[at], lines[at]]));
            mutants.push(replaced(&[lines[(at * 7 + 3) % lines.len()]]));
            if let Some((key, _)) = lines[at].split_once(" = ") {
                let value = |value: &&str| replaced(&[&format!("{key} = {value}")]);
                mutants.extend(VALUES.iter().map(value));
            }
        }
        for text in mutants {
            count += 1;
            let run = || {
                let case = parse(&text).ok()?;
                let resolved = case.to_toml();
                assert!(parse(&resolved) == Ok(case.clone()), "{resolved}");
                if let Some(dynamics) = case.dynamics.filter(|own| own.grid.count() < 10_000) {
                    let _ = dynamics.media_of_cells();
                }
                Some(())
            };
            match catch_unwind(AssertUnwindSafe(run)) {
                Ok(case) => taken += usize::from(case.is_some()),
                Err(_) => panic!("{text}"),
            }
        }
    }
    assert!(taken > count / 20 && taken < count * 3 / 4, "{taken} of {count} were taken");
}
