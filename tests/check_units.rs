//! Verifies that the results of `wellposed check` do not depend on the system of units.

use crate::support::bundled_case;
use rayon::prelude::*;
use serde_json::Value;
use std::fs;
use wellposed::Error;
use wellposed::case::{Case, Material, ModelKind, SweepParameter};
use wellposed::report;
use wellposed::study::check::CheckExtent;
use wellposed::study::ignore_progress;

/// Computes the report on a case, as written to `check.json`.
fn compute_report(case: &Case, extent: CheckExtent) -> Result<Value, Error> {
    report::to_json(&wellposed::check_agreement(case, extent, &ignore_progress)?)
}

/// Returns the exponents of mass, length and time of a unit that is a product of powers; `None` for other units.
fn parse_unit_exponents(unit: &str) -> Option<[i32; 3]> {
    let mut sum = [0; 3];
    let mut sign = 1;
    let mut rest = unit.trim_matches(|c| c == '(' || c == ')').replace(['(', ')'], "");
    for (from, to) in [("·", " "), ("/", " / ")] {
        rest = rest.replace(from, to);
    }
    for factor in rest.split_whitespace() {
        if factor == "/" {
            sign = -1;
            continue;
        }
        let name = factor.trim_end_matches(['²', '³', '⁴']);
        let power = match factor.chars().last() {
            Some('²') => 2,
            Some('³') => 3,
            Some('⁴') => 4,
            _ => 1,
        };
        let base = match name {
            "kg" => [1, 0, 0],
            "m" => [0, 1, 0],
            "s" => [0, 0, 1],
            "Pa" => [1, -1, -2],
            "N" => [1, 1, -2],
            "1" | "rad" | "°" | "deg" | "–" | "-" => [0; 3],
            _ => return None,
        };
        (0..3).for_each(|i| sum[i] += sign * power * base[i]);
    }
    Some(sum)
}

/// Returns a material with values in units that are 2^−powers times the units of mass, length and time.
fn scale_material(material: &Material, powers: [i32; 3]) -> Material {
    let mut scaled = material.clone();
    for parameter in SweepParameter::all_parameters() {
        let Some(value) = parameter.value(&material.numbers).filter(|value| *value != 0.0) else {
            continue;
        };
        let unit = parse_unit_exponents(parameter.unit())
            .unwrap_or_else(|| panic!("{}: {}", parameter.name(), parameter.unit()));
        let power: i32 = unit.iter().zip(powers).map(|(a, b)| a * b).sum();
        scaled.set_number(parameter, value * 2f64.powi(power));
    }
    scaled
}

/// Returns a case with values in units that are 2^−powers times the units of mass, length and time.
fn scale_case(case: &Case, powers: [i32; 3]) -> Case {
    let mut scaled = case.clone();
    scaled.material = scale_material(&case.material, powers);
    if let Some(numbers) =
        scaled.check_options.as_mut().and_then(|options| options.wave_numbers.as_mut())
    {
        numbers.iter_mut().for_each(|number| *number *= 2f64.powi(-powers[1]));
    }
    if let Some(dynamics) = &mut scaled.solid_run {
        for region in &mut dynamics.regions {
            region.material = scale_material(&region.material, powers);
        }
    }
    scaled
}

/// Returns all branches or modes of a report, of all media.
fn report_rows(report: &Value) -> Vec<&Value> {
    let media = report["media"].as_array().into_iter().flatten();
    let rows = media.chain([report]).filter_map(|medium| medium["rows"].as_array());
    rows.flatten().collect()
}

/// Compares a case in other units with its report in SI units: equal rows, verdicts and texts, and rates to all
/// printed digits. Solids are bit-identical if the powers are even, since square roots of their products are then
/// powers of two.
fn check_scaled_case(
    name: &str,
    case: &Case,
    first: &Value,
    extent: CheckExtent,
    powers: [i32; 3],
) {
    let label = format!("{name} {powers:?}");
    let scaled = scale_case(case, powers);
    let found = compute_report(&scaled, extent).unwrap_or_else(|error| panic!("{label}: {error}"));
    assert_eq!(found["agrees"], first["agrees"], "{label}: {found:#}");
    assert_eq!(found["not_measurable"].is_string(), first["not_measurable"].is_string(), "{label}");
    let (found_rows, first_rows) = (report_rows(&found), report_rows(first));
    assert_eq!(found_rows.len(), first_rows.len(), "{label}");
    let is_solid = matches!(case.material.kind, ModelKind::Solid(_));
    let is_exact = is_solid && powers.iter().all(|power| power % 2 == 0);
    let to_rate = 2f64.powi(powers[2]);
    let shear_rate = case.number("background.shear_rate").unwrap_or(0.0);
    for (found, first) in found_rows.into_iter().zip(first_rows) {
        for key in ["branch", "response", "mode", "agrees"] {
            assert_eq!(found[key], first[key], "{label} {key}: {found:#} for {first:#}");
        }
        assert_eq!(found["not_measurable"].is_string(), first["not_measurable"].is_string());
        let pair = |key: &str, component: &str| {
            let number = |row: &Value| row[key][component].as_f64();
            (number(found).map(|number| number * to_rate), number(first))
        };
        let components = ["frequency", "growth_rate"];
        let scale = components
            .iter()
            .filter_map(|component| pair("predicted", component).1)
            .fold(shear_rate, |max, number| max.max(number.abs()));
        for (key, component) in ["predicted", "limit", "frozen"]
            .iter()
            .flat_map(|key| components.map(|component| (key, component)))
        {
            let (found, first) = pair(key, component);
            if is_exact {
                assert_eq!(found, first, "{label} {key} {component}");
            } else if let (Some(found), Some(first)) = (found, first) {
                let difference = (found - first).abs();
                assert!(
                    difference <= 1e-8 * scale,
                    "{label} {key} {component}: {found} for {first}"
                );
            }
        }
        let (found, first) = pair("limit", "tolerance");
        if is_solid {
            let (found, first) = (found.expect("a number"), first.expect("a number"));
            assert!((found / first - 1.0).abs() <= if is_exact { 0.0 } else { 1e-6 }, "{label}");
        }
    }
}

/// Verifies that other units of mass, length and time change no row and no verdict of any bundled case. The checks run
/// on threads of a rayon pool: from any other thread each of their many small parallel loops would wake and await one.
fn check_unit_invariance(extent: CheckExtent, powers: &[[i32; 3]]) {
    let mut files = Vec::new();
    for folder in ["check", "cosserat", "dynamics", "flow", "granular-flow"] {
        let entries = fs::read_dir(bundled_case(folder)).expect("a folder");
        files.extend(entries.map(|entry| entry.expect("an entry").path()));
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    assert!(files.len() >= 29);
    files.par_iter().enumerate().for_each(|(index, file)| {
        let name = file.file_name().expect("a name").to_string_lossy();
        let mut case = Case::load(file, &[]).expect("a case");
        let is_flow = matches!(case.material.kind, ModelKind::Flow(_));
        let mut asked = case.check_options.clone().unwrap_or_default();
        if is_flow {
            // The boxes of perturbations are not parameters of a case and are not scaled.
            asked.grid_sizes = None;
        }
        if extent == CheckExtent::Short {
            // Coarser grids and fewer waves are sufficient, since units enter all of them alike.
            let is_plane =
                case.number("model.dimensions").is_none_or(|dimensions| dimensions == 2.0);
            let cells = if is_plane { vec![12, 16] } else { vec![8, 10] };
            asked.grid_sizes = (!is_flow).then_some(cells);
            asked.directions_deg = Some(vec![30.0]);
        }
        case.check_options = Some(asked);
        let first = compute_report(&case, extent).unwrap_or_else(|error| panic!("{name}: {error}"));
        // The short test uses one set of powers for each case, in turn.
        let count = if extent == CheckExtent::Short { 1 } else { powers.len() };
        for powers in powers.iter().cycle().skip(index).take(count) {
            check_scaled_case(&name, &case, &first, extent, *powers);
        }
    });
}

/// Exponents of 2 for the units of mass, length and time: even and odd.
const UNIT_EXPONENTS: [[i32; 3]; 10] = [
    [0, 40, 0],
    [1, 0, 0],
    [0, -40, 0],
    [0, -3, 0],
    [40, 40, -40],
    [0, 0, 39],
    [-40, -20, 40],
    [-39, 37, -35],
    [40, -40, -40],
    [-33, -1, 40],
];

#[test]
fn short_reports_are_invariant_under_change_of_units() {
    check_unit_invariance(CheckExtent::Short, &UNIT_EXPONENTS);
}

/// The same verification with complete checks of all cases in all systems of units; run by hand.
#[test]
#[ignore = "takes long"]
fn full_reports_are_invariant_under_change_of_units() {
    check_unit_invariance(CheckExtent::Full, &UNIT_EXPONENTS);
}
