//! `point` and `map` of models given as equations in space and in one dimension: matrices in the report and in the archive,
//! verdicts, directions, and boundaries of maps.

use crate::support::bundled_case;
use files::npz::{self, ArrayValues};
use wellposed::case::Case;
use wellposed::report::{Report, to_json};
use wellposed::study::map::PointStatus;
use wellposed::study::{MapOptions, analyse_point, compute_map, ignore_progress};

/// Isentropic gas of the bundled case at rest.
const DENSITY: f64 = 1.2;
const PRESSURE: f64 = 1e5;
const EXPONENT: f64 = 1.4;
const VISCOSITY: f64 = 1.8e-5;
const SECOND_VISCOSITY: f64 = -1.2e-5;

/// A matrix of the report by rows.
fn rows(value: &serde_json::Value) -> Vec<f64> {
    let row = |row: &serde_json::Value| row.as_array().expect("a row").clone();
    let entries = value.as_array().expect("rows").iter().flat_map(row);
    entries.map(|entry| entry.as_f64().expect("a number")).collect()
}

fn assert_near(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= 1e-13 * b.abs(), "{what}, entry {index}: {a}, not {b}");
    }
}

/// The matrices of a viscous gas at rest, derived by hand: mass ρ̇ + ρ ∇·v = 0, momentum ρ v̇ + c² ∇ρ = (λ + μ) ∇∇·v +
/// μ ∇²v with c² = γp/ρ.
#[test]
fn report_and_archive_hold_the_matrices() {
    let path = bundled_case("equations/compressible-navier-stokes.toml");
    let case = Case::load(&path, &[]).expect("a case");
    let found = analyse_point(&case, &ignore_progress).expect("a state");
    let json = to_json(&found).expect("a report");
    let linearised = &json["linearised"];
    let at = |row: usize, column: usize, value: f64| {
        let mut matrix = vec![0.0; 16];
        matrix[4 * row + column] = value;
        matrix
    };
    let sum = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(x, y)| x + y).collect::<Vec<f64>>();
    let a: Vec<f64> = (0..16)
        .map(|index| {
            if index % 5 > 0 {
                0.0
            } else if index == 0 {
                1.0
            } else {
                DENSITY
            }
        })
        .collect();
    let squared_speed = EXPONENT * PRESSURE / DENSITY;
    let b: Vec<f64> =
        (1..4).flat_map(|axis| sum(at(0, axis, DENSITY), at(axis, 0, squared_speed))).collect();
    let tables = found.create_tables(&case).expect("tables");
    let archive = tables.into_iter().find(|(name, _)| *name == "linearised.npz");
    let (_, archive) = archive.expect("an archive");
    let bytes = archive.encode().expect("an archive");
    let arrays = npz::read_arrays(&bytes).expect("arrays");
    let array = |name: &str| {
        let own = arrays.iter().find(|own| own.name == name).expect("an array");
        match &own.values {
            ArrayValues::F64(values) => values.clone(),
            _ => panic!("{name}: no doubles"),
        }
    };
    assert_near("A", &rows(&linearised["a"]), &a);
    assert_near("A of the archive", &array("A"), &a);
    let listed: Vec<f64> =
        linearised["b"].as_array().expect("matrices").iter().flat_map(rows).collect();
    assert_near("B", &listed, &b);
    assert_near("B of the archive", &array("B"), &b);
    assert_near("C of the archive", &array("C"), &[0.0; 16]);
    // Row, column, power of ς, powers of κ₁, κ₂, κ₃, value, bound.
    let terms = array("terms");
    for row in 1..4 {
        for column in 1..4 {
            for first in 0..3 {
                for second in first..3 {
                    let mut powers = [0.0; 3];
                    powers[first] += 1.0;
                    powers[second] += 1.0;
                    let is_place = |own: &&[f64]| {
                        own[..3] == [row as f64, column as f64, 0.0] && own[3..6] == powers
                    };
                    let value = terms.chunks_exact(8).find(is_place).map_or(0.0, |own| own[6]);
                    let [along, mixed] = [
                        first == second && row == column,
                        [first + 1, second + 1] == [row.min(column), row.max(column)],
                    ];
                    let expected = -VISCOSITY * f64::from(along)
                        - (SECOND_VISCOSITY + VISCOSITY) * f64::from(mixed);
                    let error = (value - expected).abs();
                    assert!(error < 1e-18, "{row} {column} {powers:?}: {value}, not {expected}");
                }
            }
        }
    }
}

/// A gas of negative viscosity is ill-posed of order 2 with the coefficient 2|μ|/ρ of the longitudinal waves; one
/// without viscosity, or of positive viscosity, is well-posed.
#[test]
fn map_in_space_has_the_known_verdicts() {
    let path = bundled_case("equations/compressible-navier-stokes.toml");
    let map = "
        [map]
        x = { parameter = 'model.parameters.mu', from = -1e-5, to = 1e-5, points = 3 }
        y = { parameter = 'background.rho', from = 0.6, to = 1.2, points = 2 }
    ";
    let text = std::fs::read_to_string(&path).expect("a file") + map;
    let sets = ["model.parameters.lambda=0".to_owned()];
    let case = Case::parse(&text, "map.toml", &sets).expect("a case");
    let found = compute_map(&case, MapOptions::default(), &ignore_progress).expect("a map");
    assert_eq!(found.points.len(), 6);
    for (index, point) in found.points.iter().enumerate() {
        let density = [0.6, 1.2][index / 3];
        if index % 3 > 0 {
            assert_eq!(point.status, PointStatus::WellPosed, "{point:?}");
            continue;
        }
        assert_eq!((point.status, point.growth_order), (PointStatus::IllPosed, 2.0));
        assert_near("coefficient", &[point.growth_coefficient], &[2e-5 / density]);
        assert!(point.direction_deg.is_finite() && point.elevation_deg.is_finite(), "{point:?}");
    }
}

/// Nonlinear conduction of heat, ∂ₜT = ∂₁(k₀(T/T₀)²∂₁T), in one dimension: growth −k₀(T/T₀)²k² for k₀ < 0.
const HEAT: &str = r#"
title = "nonlinear heat"
[model]
kind = "equations"
dimensions = 1
unknowns = { T = "K" }
[model.parameters]
k0 = { value = 2, unit = "m^2/s" }
T0 = { value = 300, unit = "K" }
[model.equations]
heat = "dt(T) = d1(k0*(T/T0)^2*d1(T))"
[background]
T = { value = 600 }
[map]
x = { parameter = "model.parameters.k0", from = -1, to = 1, points = 3 }
y = { parameter = "background.T", from = 300, to = 600, points = 3 }
"#;

/// The verdict changes at k₀ = 0, which is 3/7 of the step from −0.3 to 0.4; four bisections leave 1/32 of the step.
#[test]
fn boundaries_of_maps_are_located_by_bisection() {
    let text = HEAT.replace("from = -1, to = 1", "from = -1, to = 0.4");
    let case = Case::parse(&text, "heat.toml", &[]).expect("a case");
    let bound = MapOptions { computes_bound: true, ..MapOptions::default() };
    for options in [MapOptions::default(), bound] {
        let found = compute_map(&case, options, &ignore_progress).expect("a map");
        let [along_x, along_y] = [0, 1].map(|axis| {
            let places = 0..found.points.len();
            places.map(|point| found.boundaries.step_fraction(axis, point)).collect::<Vec<_>>()
        });
        for (index, fraction) in along_x.iter().enumerate() {
            match index % 3 {
                1 => assert!((fraction - 3.0 / 7.0).abs() <= 1.0 / 32.0, "{along_x:?}"),
                _ => assert!(fraction.is_nan(), "{along_x:?}"),
            }
        }
        assert!(along_y.iter().all(|fraction| fraction.is_nan()), "{along_y:?}");
        assert!(!found.boundaries.is_on_line.contains(&true));
    }
}

/// All waves have one direction, which the report does not state.
#[test]
fn maps_in_one_dimension_name_no_direction() {
    let case = Case::parse(HEAT, "heat.toml", &[]).expect("a case");
    let found = compute_map(&case, MapOptions::default(), &ignore_progress).expect("a map");
    let fastest = found.points.iter().map(|own| own.growth_coefficient).fold(0.0, f64::max);
    assert!((fastest - 4.0).abs() < 1e-12, "{fastest}");
    let report = found.to_text(&case);
    assert!(report.contains("Re ς ≈ 4 k²") && !report.contains("NaN"), "{report}");
}
