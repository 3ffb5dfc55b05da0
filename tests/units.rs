//! Verifies that results do not depend on the units of mass, length and time: for cases in units that differ by powers
//! of two, verdicts are equal, and the values of runs are bit-identical after scaling.

use crate::program::{create_case_folder, run_with_exit_code};
use std::fs;
use std::path::Path;
use toml::{Table, Value};
use wellposed::CASES;

const TEST_FOLDER: &str = "units";

/// Exponents of mass, length and time in the unit of a key.
type DimensionExponents = [i32; 3];

const DIMENSIONLESS: DimensionExponents = [0, 0, 0];
const LENGTH: DimensionExponents = [0, 1, 0];
const TIME: DimensionExponents = [0, 0, 1];
const RATE: DimensionExponents = [0, 0, -1];
const VELOCITY: DimensionExponents = [0, 1, -1];
const STRESS: DimensionExponents = [1, -1, -2];
/// Dimension of couple stress, and of force per length.
const COUPLE_STRESS: DimensionExponents = [1, 0, -2];
/// Dimension of force, and of couple per length.
const FORCE: DimensionExponents = [1, 1, -2];

/// Returns the dimension of a key; for a load or an initial value, that of its field.
fn find_dimension(section: &str, key: &str, table: &Table) -> DimensionExponents {
    if key.ends_with("_deg") {
        return DIMENSIONLESS;
    }
    match (section, key) {
        ("model", "lambda" | "mu" | "alpha" | "cohesion" | "rotational_strength") => STRESS,
        ("model", "beta" | "gamma" | "eta") => FORCE,
        ("model" | "background", "density") => [1, -3, 0],
        ("model", "inertia") => [1, -1, 0],
        ("model", "moment_of_inertia") => [0, 2, 0],
        ("background", "pressure") => STRESS,
        ("background", "shear_rate" | "half_vorticity" | "spin") => RATE,
        ("background", "pressure_gradient") => [1, -2, -2],
        ("yield", "shear_strength" | "strength" | "hardening") => STRESS,
        ("yield", "couple_strength") => COUPLE_STRESS,
        (
            "yield",
            "couple_friction" | "couple_dilatancy" | "symmetric_length" | "antisymmetric_length",
        ) => LENGTH,
        ("yield", "plastic_rate") => RATE,
        ("stress", "couple_stress") => COUPLE_STRESS,
        (
            "stress",
            "pressure" | "deviatoric_stress" | "out_of_plane_stress" | "rotational_stress",
        ) => STRESS,
        ("wave" | "check", "number" | "numbers" | "greatest_number") => [0, -1, 0],
        ("grid", "spacing" | "origin" | "length") => LENGTH,
        ("time", "duration" | "start" | "delay") | ("output", "snapshot_interval") => TIME,
        ("time", "frequency") => RATE,
        ("gravity", "acceleration") => [0, 1, -2],
        ("source", "amplitude") => FORCE,
        ("initial", "from" | "to")
            if table.get("kind").and_then(Value::as_str) == Some("noise") =>
        {
            DIMENSIONLESS
        }
        (
            "region" | "load" | "receiver" | "source" | "initial",
            "from" | "to" | "at" | "radius" | "center",
        ) => LENGTH,
        ("load" | "initial", "amplitude") => match table["field"].as_str().unwrap() {
            // A point load in the plane is a force per out-of-plane length.
            field if field.starts_with("sigma") && table.contains_key("at") => COUPLE_STRESS,
            field if field.starts_with("sigma") => STRESS,
            field if field.starts_with('m') => COUPLE_STRESS,
            field if field.starts_with('w') => RATE,
            _ => VELOCITY,
        },
        _ => DIMENSIONLESS,
    }
}

/// Converts all numbers of a case that have a unit to units that are smaller by the factors 2^`exponents`.
fn scale_case(table: &mut Table, section: &str, exponents: DimensionExponents) {
    let units = table.clone();
    for (key, value) in table.iter_mut() {
        match value {
            Value::Table(inner) if ["x", "y"].contains(&key.as_str()) => {
                let parameter = inner["parameter"].as_str().unwrap().to_owned();
                let (section, key) = parameter.split_once('.').unwrap();
                let unit = find_dimension(section, key, &units);
                for end in ["from", "to"] {
                    multiply_numbers(
                        inner.get_mut(end).unwrap(),
                        unit_conversion_factor(unit, exponents),
                    );
                }
            }
            Value::Table(inner) => scale_case(inner, key, exponents),
            Value::Array(list) if list.first().is_some_and(Value::is_table) => {
                for inner in list {
                    scale_case(inner.as_table_mut().unwrap(), key, exponents);
                }
            }
            _ => {
                let unit = find_dimension(section, key, &units);
                if unit != DIMENSIONLESS {
                    multiply_numbers(value, unit_conversion_factor(unit, exponents));
                }
            }
        }
    }
}

fn multiply_numbers(value: &mut Value, factor: f64) {
    match value {
        Value::Integer(number) => *value = Value::Float(*number as f64 * factor),
        Value::Float(number) => *number *= factor,
        Value::Array(list) => list.iter_mut().for_each(|entry| multiply_numbers(entry, factor)),
        _ => panic!("{value} has no unit"),
    }
}

/// Returns the factor on a number of dimension `unit` if the base units become smaller by powers of two with these
/// exponents.
fn unit_conversion_factor(unit: DimensionExponents, exponents: DimensionExponents) -> f64 {
    2f64.powi(unit.iter().zip(exponents).map(|(a, b)| a * b).sum())
}

/// Systems of units, as exponents of 2 for mass, length and time, in sets that change all three.
const UNIT_SYSTEMS: [[DimensionExponents; 3]; 3] = [
    [[60, 60, 60], [-60, -60, -60], [7, -5, 3]],
    [[60, 0, 0], [0, 60, 0], [0, 0, 60]],
    [[-60, 0, 0], [0, -60, 0], [0, 0, -60]],
];

/// Extent of a test: each case in one of the sets of [`UNIT_SYSTEMS`] in turn, or in all systems of units.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    OneSetInTurn,
    AllSystems,
}

impl Extent {
    /// Returns the systems of units in which the case of an index is computed.
    fn unit_systems(self, index: usize) -> Vec<DimensionExponents> {
        match self {
            Self::OneSetInTurn => UNIT_SYSTEMS[index % UNIT_SYSTEMS.len()].to_vec(),
            Self::AllSystems => UNIT_SYSTEMS.concat(),
        }
    }
}

/// Writes a case in other units and returns the folder.
fn write_case(name: &str, case: &Table, exponents: DimensionExponents) -> std::path::PathBuf {
    let [mass, length, time] = exponents;
    let mut case = case.clone();
    scale_case(&mut case, "", exponents);
    create_case_folder(
        TEST_FOLDER,
        &format!("{name}{mass}_{length}_{time}"),
        &toml::to_string(&case).unwrap(),
    )
}

fn parse_bundled_case(name: &str) -> Table {
    let (_, text) = CASES.iter().find(|(path, _)| path.ends_with(name)).unwrap();
    text.parse().unwrap()
}

/// Sets the wave number explicitly if the case does not, since it has a unit and its default is not zero.
fn with_explicit_wave_number(mut case: Table) -> Table {
    let wave = case.entry("wave").or_insert(Table::new().into()).as_table_mut().unwrap();
    wave.entry("number").or_insert(Value::Float(1000.0));
    case
}

fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// Verifies that verdicts of states are equal in all units; a third of the systems of units for each case.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn verdicts_do_not_depend_on_units() {
    check_verdicts("", Extent::OneSetInTurn);
}

/// Computes verdicts in folders whose names begin with `prefix`.
fn check_verdicts(prefix: &str, extent: Extent) {
    let names = [
        "granular-flow/noncoaxiality-bound.toml",
        "granular-flow/dilatant-domain.toml",
        "granular-flow/plastic-potential.toml",
        "granular-flow/double-shearing-against-harris-grekova.toml",
        "flow/decay.toml",
        "cosserat/flutter.toml",
        "cosserat/forbidden-band.toml",
        "cosserat/microrotation.toml",
        "cosserat/rotation-waves.toml",
        "cosserat/shear-band.toml",
        "check/slipping-layers.toml",
        "check/yielding-cone.toml",
        "check/cubic-plane.toml",
    ];
    for (index, name) in names.into_iter().enumerate() {
        let case = with_explicit_wave_number(parse_bundled_case(name));
        let verdict = |exponents| {
            let here =
                write_case(&format!("{prefix}{}", name.replace(['/', '.'], "-")), &case, exponents);
            run_with_exit_code(0, &here, "point case.toml --out out");
            let all = read_json(&here.join("out/point.json"));
            ["verdict", "order", "hyperbolicity", "associated", "active"]
                .map(|key| all.get(key).cloned().unwrap_or_default())
        };
        let own = verdict(DIMENSIONLESS);
        for exponents in extent.unit_systems(index) {
            assert_eq!(verdict(exponents), own, "{name} in units of 2^{exponents:?}");
        }
    }
}

/// Verifies that every verdict of a map is equal in all units; a third of the systems of units for each case.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn maps_do_not_depend_on_units() {
    check_maps("map-", Extent::OneSetInTurn);
}

/// Computes maps in folders whose names begin with `prefix`.
fn check_maps(prefix: &str, extent: Extent) {
    let names = [
        "granular-flow/noncoaxiality-bound.toml",
        "granular-flow/dilatant-domain.toml",
        "cosserat/shear-band.toml",
        "cosserat/microrotation.toml",
        "cosserat/rotation-waves.toml",
    ];
    for (index, name) in names.into_iter().enumerate() {
        let mut case = with_explicit_wave_number(parse_bundled_case(name));
        for axis in ["x", "y"] {
            case["map"][axis]["points"] = Value::Integer(7);
        }
        let verdicts = |exponents| {
            let here =
                write_case(&format!("{prefix}{}", name.replace(['/', '.'], "-")), &case, exponents);
            run_with_exit_code(0, &here, "map case.toml --out out");
            let text = fs::read_to_string(here.join("out/map.csv")).unwrap();
            let mut rows = text
                .lines()
                .filter(|line| !line.starts_with('#'))
                .map(|line| line.split(',').collect::<Vec<_>>());
            let column = rows.next().unwrap().iter().position(|name| *name == "verdict").unwrap();
            rows.map(|row| row[column].to_owned()).collect::<Vec<_>>()
        };
        let own = verdicts(DIMENSIONLESS);
        assert_eq!(own.len(), 49);
        for exponents in extent.unit_systems(index) {
            assert_eq!(verdicts(exponents), own, "{name} in units of 2^{exponents:?}");
        }
    }
}

/// Returns the dimension of a column of `receivers.csv` or `ledger.csv`.
fn column_dimension(name: &str, is_ledger: bool) -> DimensionExponents {
    if name == "time" {
        return TIME;
    }
    if is_ledger {
        // An energy per length has the dimension of a force.
        return FORCE;
    }
    let field = name.rsplit('.').next().unwrap_or(name);
    match field {
        _ if field.starts_with("sigma") => STRESS,
        _ if field.starts_with("psi") || field.starts_with("phi") => DIMENSIONLESS,
        "p" => STRESS,
        _ if field.starts_with('v') => VELOCITY,
        _ if field.starts_with('u') => LENGTH,
        _ if field.starts_with('w') || field.starts_with("omega") || field.starts_with("spin") => {
            RATE
        }
        _ if field.starts_with('m') => COUPLE_STRESS,
        _ => panic!("unit of {name}?"),
    }
}

const COSSERAT_MODEL: &str = "
[model]
kind = 'cosserat'
dimensions = 2
lambda = 8e7
mu = 8e7
alpha = 4e7
beta = 2e7
gamma = 2e7
eta = 2e7
density = 2000
inertia = 800
";

/// Name, model and further sections of the solids; all yield under [`LOADING_SECTIONS`].
const SOLIDS: [(&str, &str, &str); 3] = [
    (
        "cone",
        COSSERAT_MODEL,
        "[yield]
kind = 'cosserat-mises'
strength = 1e4
friction = 0.3
dilatancy = 0.3
antisymmetric_weight = 1
symmetric_length = 0.5
antisymmetric_length = 0.5
",
    ),
    (
        "interlayer",
        COSSERAT_MODEL,
        "[yield]
kind = 'interlayer'
shear_strength = 1e4
shear_friction = 0.6
shear_dilatancy = 0.6
couple_strength = 1e3
couple_friction = 0.3
couple_dilatancy = 0.3
",
    ),
    (
        "weight",
        "",
        "
[model]
kind = 'classical'
dimensions = 2
lambda = 1.2e8
mu = 8e7
density = 1900
[yield]
kind = 'drucker-prager'
strength = 2e4
friction = 0.5
dilatancy = 0.5
[gravity]
acceleration = [0, -9.81]
lateral_ratio = 0.5
",
    ),
];

const LOADING_SECTIONS: &str = "
[grid]
cells = [60, 40]
spacing = 0.1
origin = [-3, -4]
[time]
duration = 0.03
[scheme]
ledger = 'full'
[[region]]
shape = 'circle'
center = [0.05, -3]
radius = 0.62
model = { lambda = 4e9, mu = 4e9 }
[[region]]
shape = 'rest'
[[boundary]]
side = 'x1-'
kind = 'non-reflecting'
[[boundary]]
side = 'x2-'
kind = 'fixed'
[[load]]
side = 'x2+'
field = 'sigma22'
from = -1
to = 1
amplitude = -4e5
time = { kind = 'pulse', duration = 0.02 }
[[load]]
side = 'x2+'
field = 'sigma12'
at = -1
amplitude = 3e4
time = { kind = 'ricker', frequency = 80 }
[[source]]
kind = 'explosion'
amplitude = 1e5
at = [1, -2]
radius = 0.3
time = { kind = 'pulse', duration = 0.01 }
[[initial]]
kind = 'pulse'
field = 'v1'
amplitude = 0.01
at = [-1, -1]
radius = 0.5
[[receiver]]
name = 'edge'
at = [1.5, -0.07]
[[receiver]]
name = 'inside'
at = [0.3, -2.71]
[output]
integrals = ['u2']
";

/// Compares the tables of a run in other units bit by bit.
fn compare_tables(name: &str, case: &Table, units: &[DimensionExponents], tables: &[&str]) {
    let run = |exponents| {
        let here = write_case(name, case, exponents);
        run_with_exit_code(0, &here, "run case.toml --out out --threads 1");
        tables
            .iter()
            .map(|table| fs::read_to_string(here.join("out").join(table)).unwrap())
            .collect::<Vec<_>>()
    };
    let own = run(DIMENSIONLESS);
    for &exponents in units {
        for ((table, own), other) in tables.iter().zip(&own).zip(run(exponents)) {
            assert_eq!(own.lines().count(), other.lines().count(), "{name} {table}");
            let names: Vec<&str> = own.lines().next().unwrap().split(',').collect();
            for (row, (a, b)) in own.lines().zip(other.lines()).enumerate().skip(1) {
                for ((column, a), b) in names.iter().zip(a.split(',')).zip(b.split(',')) {
                    let unit = column_dimension(column, *table == "ledger.csv");
                    let [a, b] = [a, b].map(|text| text.parse::<f64>().unwrap());
                    let scaled = a * unit_conversion_factor(unit, exponents);
                    assert_eq!(
                        scaled, b,
                        "{name} {table} row {row} {column} in units of 2^{exponents:?}"
                    );
                }
            }
        }
    }
}

/// Verifies that records and energies of yielding solids are bit-identical in all units, after scaling; a third of the
/// systems of units for each solid.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn runs_of_solids_do_not_depend_on_units() {
    check_runs_of_solids("", Extent::OneSetInTurn);
}

/// Runs solids in folders whose names begin with `prefix`.
fn check_runs_of_solids(prefix: &str, extent: Extent) {
    for (index, (name, model, sections)) in SOLIDS.into_iter().enumerate() {
        let name = format!("{prefix}{name}");
        let case: Table = format!("{model}{sections}{LOADING_SECTIONS}").parse().unwrap();
        compare_tables(&name, &case, &extent.unit_systems(index), &["receivers.csv", "ledger.csv"]);
        let text = fs::read_to_string(
            Path::new(env!("CARGO_TARGET_TMPDIR"))
                .join(format!("units/{name}0_0_0/out/ledger.csv")),
        )
        .unwrap();
        let mut rows = text.lines().map(|row| row.split(',').collect::<Vec<_>>());
        let place = rows.next().unwrap().iter().position(|own| *own == "plastic_dissipation");
        let dissipation: f64 = rows.next_back().unwrap()[place.unwrap()].parse().unwrap();
        assert!(dissipation > 100.0, "{name} hardly yields: {dissipation} J/m");
    }
}

/// Verifies that records of a flow are bit-identical in all units, after scaling.
#[test]
fn runs_of_flows_do_not_depend_on_units() {
    let mut case = parse_bundled_case("flow/decay.toml");
    case["grid"]["cells"] = Value::Array(vec![Value::Integer(16), Value::Integer(16)]);
    case["initial"][0]["to"] = Value::Integer(5);
    case["time"]["duration"] = Value::Float(1e-3);
    compare_tables("flow", &case, &UNIT_SYSTEMS.concat(), &["receivers.csv"]);
}

#[test]
#[ignore = "takes minutes"]
fn verdicts_maps_and_runs_do_not_depend_on_any_units() {
    check_verdicts("all-", Extent::AllSystems);
    check_maps("all-map-", Extent::AllSystems);
    check_runs_of_solids("all-", Extent::AllSystems);
}
