//! Conversion of cases of blocky media to cases of the equivalent Cosserat continuum.

use models::interface::continuum::OpeningLimit;
use wellposed_cases::dynamics::{InitialStateTerm, StateComponent};
use wellposed_cases::{Case, CaseError, ContinuumOptions, EquivalentContinuum};

const CASE_SECTIONS: &str = "
[model]
kind = 'classical'
lambda = 1.89e10
mu = 2.43e10
density = 2700
[[block]]
name = 'rock'
cells = [5, 5]
size = [0.05, 0.05]
repeat = [8, 4]
origin = [-0.2, -0.2]
[time]
duration = 1e-4
";
const ELASTIC_LAYER_KEYS: &str = "thickness = 1e-3
density = 1500
longitudinal_speed = 1000
shear_speed = 500
";
const ELASTIC_JOINTS: &str = "[[joint]]\nevery = 'all'\nkind = 'elastic'\n";

fn elastic_case() -> String {
    format!("{CASE_SECTIONS}{ELASTIC_JOINTS}{ELASTIC_LAYER_KEYS}")
}

fn convert_to_continuum(text: &str, sets: &[&str]) -> Result<EquivalentContinuum, CaseError> {
    convert_with_options(text, sets, &ContinuumOptions::default())
}

fn convert_with_options(
    text: &str,
    sets: &[&str],
    options: &ContinuumOptions,
) -> Result<EquivalentContinuum, CaseError> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Case::parse(text, "blocks.toml", &sets)?.to_equivalent_continuum(options)
}

/// Constants for three thicknesses δ of the layers, m: a₁, b₁, a₂, b₂ in 10⁻¹² 1/Pa; α₂, N; ρ₀, kg/m³, and J₀, kg/m;
/// K_t h/μ.
#[allow(clippy::type_complexity, reason = "a row of the table")]
const REFERENCE_CONSTANTS: [(f64, [f64; 4], f64, [f64; 2], f64); 3] = [
    (1e-4, [17.40844, 4.501029, 15.6214, -10.28807], 1.197e7, [2706.0, 1.12625], 7.7),
    (1e-3, [29.40844, 4.501029, 63.6214, -10.28807], 7.084e6, [2760.0, 1.1375], 0.77),
    (5e-3, [82.74177, 4.501029, 276.9547, -10.28807], 2.518e6, [3000.0, 1.1875], 0.154),
];

#[test]
fn written_constants_are_those_of_the_table() {
    for (thickness, compliances, alpha2, inertias, ratio) in REFERENCE_CONSTANTS {
        let found =
            convert_to_continuum(&elastic_case(), &[&format!("joint[0].thickness={thickness:e}")])
                .expect("a medium");
        let value = |name: &str| found.case.number(&format!("model.{name}")).expect("a number");
        let is_close = |found: f64, expected: f64, tolerance: f64| {
            assert!((found / expected - 1.0).abs() < tolerance, "{found} for {expected}");
        };
        for (name, expected) in ["a1", "b1", "a2", "b2"].into_iter().zip(compliances) {
            is_close(value(name), expected * 1e-12, 1e-6);
        }
        is_close(value("alpha2"), alpha2, 5e-4);
        is_close(value("density"), inertias[0], 1e-12);
        is_close(value("inertia"), inertias[1], 1e-12);
        is_close(found.constants.stiffness_ratio, ratio, 5e-3);
        assert_eq!(found.constants.has_rigid_blocks(), ratio < 0.2);
    }
}

#[test]
fn grid_has_the_extent_of_the_blocks() {
    for cells_per_block in [1, 3] {
        let options = ContinuumOptions { cells_per_block, ..ContinuumOptions::default() };
        let found = convert_with_options(&elastic_case(), &[], &options).expect("a medium");
        let grid = &found.case.solid_run.as_ref().expect("a simulation").grid;
        assert_eq!(grid.cells, [8 * cells_per_block, 4 * cells_per_block]);
        for (axis, expected) in [[-0.2, 0.2], [-0.2, 0.0]].into_iter().enumerate() {
            let bounds = grid.axis_bounds(axis);
            assert!((0..2).all(|end| (bounds[end] - expected[end]).abs() < 1e-12), "{bounds:?}");
        }
        assert!(found.case.solid_run.as_ref().is_some_and(|run| run.blocks.is_none()));
        assert_eq!(found.case.name, "blocks-continuum");
    }
    let none = ContinuumOptions { cells_per_block: 0, ..ContinuumOptions::default() };
    assert!(convert_with_options(&elastic_case(), &[], &none).is_err());
}

#[test]
fn joints_that_slip_give_the_interlayer_yield_set() {
    let slipping = format!(
        "{CASE_SECTIONS}[[joint]]\nevery = 'all'\nkind = 'breaking'\n{ELASTIC_LAYER_KEYS}shear_strength = 1e6\nshear_friction = 0.5\ntensile_strength = 5e5\n"
    );
    for (opening_limit, arm) in
        [(OpeningLimit::FirstOpening, 0.05 / 6.0), (OpeningLimit::Overturning, 0.025)]
    {
        let options = ContinuumOptions { opening_limit, ..ContinuumOptions::default() };
        // Without fracture the tensile strength is that of the apex, τ_s/k_s.
        for (set, tension) in [("joint[0].fracture=true", 5e5), ("joint[0].fracture=false", 2e6)] {
            let found = convert_with_options(&slipping, &[set], &options).expect("a medium");
            let value = |name: &str| found.case.number(&format!("yield.{name}")).expect("a number");
            assert_eq!(found.case.material.yield_set.map(|set| set.name), Some("interlayer"));
            assert_eq!([value("shear_strength"), value("shear_friction")], [1e6, 0.5]);
            assert!((value("couple_friction") / arm - 1.0).abs() < 1e-12);
            assert!((value("couple_strength") / (arm * tension) - 1.0).abs() < 1e-12);
        }
    }
    assert!(convert_to_continuum(&elastic_case(), &[]).expect("a medium").yield_set.is_none());
    let fixed =
        convert_to_continuum(&slipping, &["joint[0].slip_hardening=1e9"]).expect_err("hardening");
    assert!(fixed.to_string().contains("joint[0].slip_hardening"), "{fixed}");
    let smooth =
        convert_to_continuum(&slipping, &["joint[0].shear_friction=0", "joint[0].fracture=false"]);
    assert!(smooth.expect_err("unlimited couples").to_string().contains("shear_friction"));
}

/// Boundary conditions, loads, initial state, receivers and output are converted to the components of a Cosserat solid.
#[test]
fn other_sections_are_converted_to_a_cosserat_solid() {
    let text = format!(
        "title = 'Blocks'\n{}
[[boundary]]
side = 'x1-'
kind = 'non-reflecting'
[[boundary]]
side = 'x1+'
kind = 'mixed'
fixed_components = ['v2']
[[load]]
side = 'x1-'
field = 'sigma12'
amplitude = 3.0
time = {{ kind = 'step', start = 0.0, duration = 4e-5 }}
[[load]]
side = 'x2+'
field = 'sigma12'
amplitude = 2.0
from = -0.1
to = 0.1
time = {{ kind = 'step', start = 0.0 }}
[[initial]]
kind = 'rigid-rotation'
shape = 'box'
from = [0.0, -0.1]
to = [0.05, -0.05]
at = [0.025, -0.075]
rate = 1.0
[[initial]]
kind = 'uniform'
shape = 'everywhere'
field = 'sigma12'
amplitude = 1.0
[initial_stress]
sigma12 = 5.0
sigma22 = -7.0
[[source]]
kind = 'force'
at = [0.0, -0.1]
amplitude = [1.0, 2.0]
time = {{ kind = 'ricker', frequency = 1e4, delay = 1e-4 }}
[[receiver]]
name = 'middle'
at = [0.0, -0.1]
interpolation = 'none'
[output]
snapshot_interval = 1e-5
integrals = ['u1']
picture = 'sigma12'
",
        elastic_case()
    );
    let before = Case::parse(&text, "blocks.toml", &[]).expect("a case");
    let found = before.to_equivalent_continuum(&ContinuumOptions::default()).expect("a medium");
    let (old, new) =
        (before.solid_run.expect("blocks"), found.case.solid_run.clone().expect("a grid"));
    assert_eq!(found.case.title, "Blocks, equivalent continuum");
    assert_eq!([&old.boundary_conditions], [&new.boundary_conditions]);
    assert_eq!((&old.sources, &old.time), (&new.sources, &new.time));
    let components: Vec<String> = new.loads.iter().map(|load| load.component.to_string()).collect();
    // The second index is the normal of the face.
    assert_eq!(components, ["sigma21", "sigma12"]);
    assert_eq!(old.loads[1].loaded_area, new.loads[1].loaded_area);
    assert!(matches!(new.initial_terms[0], InitialStateTerm::RigidRotation { rate: 1.0, .. }));
    assert_eq!(new.initial_terms.len(), 3);
    let stress: Vec<(String, f64)> = new
        .initial_stress
        .iter()
        .map(|(component, value): &(StateComponent, f64)| (component.to_string(), *value))
        .collect();
    for expected in [("sigma12", 5.0), ("sigma21", 5.0), ("sigma22", -7.0)] {
        assert!(
            stress.iter().any(|(name, value)| (name.as_str(), *value) == expected),
            "{stress:?}"
        );
    }
    let fields: Vec<String> = new.receivers[0].fields.iter().map(ToString::to_string).collect();
    for name in ["v1", "sigma12", "sigma21", "w3", "u1"] {
        assert_eq!(fields.iter().filter(|own| *own == name).count(), 1, "{fields:?}");
    }
    // The written text is parsed to the same case.
    let again = Case::parse(&found.case.to_toml(), "blocks-continuum.toml", &[]).expect("a case");
    assert_eq!(again.to_toml(), found.case.to_toml());
}

#[test]
fn media_without_equivalent_are_refused_with_a_remedy() {
    let without_blocks = "
[model]
kind = 'classical'
dimensions = 2
lambda = 1e9
mu = 1e9
density = 2000
";
    let plain = format!("{CASE_SECTIONS}{ELASTIC_JOINTS}{ELASTIC_LAYER_KEYS}");
    let second = "[[joint]]\nevery = 'x2'\nkind = 'elastic'\nthickness = 2e-3\ndensity = 1500\nlongitudinal_speed = 1000\nshear_speed = 500\n";
    let cracked =
        format!("{CASE_SECTIONS}[[joint]]\nevery = 'all'\nkind = 'cracked'\n{ELASTIC_LAYER_KEYS}");
    let viscous = format!(
        "{CASE_SECTIONS}[[joint]]\nevery = 'all'\nkind = 'viscous'\n{ELASTIC_LAYER_KEYS}delayed_compliance = 1e-9\nviscosity = 7500\n"
    );
    let one_axis =
        format!("{CASE_SECTIONS}[[joint]]\nevery = 'x1'\nkind = 'elastic'\n{ELASTIC_LAYER_KEYS}");
    let wave = "[[initial]]\nkind = 'plane-wave'\nbranch = 1\nwavelength = 0.1\namplitude = 1.0\n";
    let cases: [(String, &[&str], &str, &str); 9] = [
        (without_blocks.to_owned(), &[], "block", "with [[block]] and [[joint]]"),
        (
            plain.clone(),
            &["block[0].cells=[5, 10]", "block[0].size=[0.05, 0.1]"],
            "block[0].cells",
            "square",
        ),
        (
            plain.clone(),
            &["block[0].cells=[6, 6]", "block[0].row_shift=0.025"],
            "block[0].row_shift",
            "aligned",
        ),
        (plain.clone() + second, &[], "joint[1]", "same joints"),
        (cracked, &[], "joint[0].kind", "elastic-plastic"),
        (viscous, &[], "joint[0]", "no viscosity"),
        (one_axis, &[], "joint", "every"),
        (plain.clone() + wave, &[], "initial[0].kind", "pulse"),
        (plain, &["block[0].repeat=[8, 1]"], "joint", "repeat"),
    ];
    for (text, sets, key, remedy) in cases {
        let error = convert_to_continuum(&text, sets).expect_err(key);
        let CaseError::Key { key: found, allowed, .. } = &error else { panic!("{error}") };
        assert!(found == key && allowed.contains(remedy), "{key}: {error}");
        println!("{error}");
    }
}
