//! Verifies the result files of the joints of blocky media: table, archive, lines for ParaView, snapshots, pictures and
//! report.

use crate::support;

use files::npz::{ArrayValues, read_arrays};
use files::vti::{POINTS_ARRAY, parse_collection, read_plain_time, read_plain_values};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use support::{create_run_options, parse_case, run_case};
use wellposed::cli::folder::verify_folder;
use wellposed::report::PictureOptions;
use wellposed::study::ignore_progress;
use wellposed::study::simulate::{JOINT_QUANTITIES, SimulationSettings};

const BREAKING_CASE: &str = include_str!("data/breaking-joints.toml");

/// Case of a central block that is rotated at once between saturated joints.
const SATURATED_CASE: &str = include_str!("data/saturated-joints.toml");

/// Names of the columns of tables of joints.
const JOINT_COLUMN_NAMES: [&str; 13] = [
    "x1",
    "x2",
    "axis",
    "joint",
    "normal_stress",
    "shear_stress",
    "slip",
    "opening",
    "slip_time",
    "fracture_time",
    "porosity",
    "pressure",
    "fluid_velocity",
];

fn create_scratch_folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

fn read_file(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join("out").join(name)).expect(name)
}

/// Reads the columns of `joints.csv`; empty cells are not-a-number.
fn read_table(folder: &Path) -> BTreeMap<String, Vec<f64>> {
    let text = String::from_utf8(read_file(folder, "joints.csv")).expect("text");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    assert_eq!(names, JOINT_COLUMN_NAMES);
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for line in lines {
        for (name, cell) in names.iter().zip(line.split(',')) {
            let value = if cell.is_empty() { f64::NAN } else { cell.parse().expect("a number") };
            columns.entry((*name).to_owned()).or_default().push(value);
        }
    }
    columns
}

/// Reads the columns of `joints.npz`, with integers as `f64`; checks names and units.
fn read_archive(folder: &Path) -> BTreeMap<String, Vec<f64>> {
    let mut columns = BTreeMap::new();
    for array in read_arrays(&read_file(folder, "joints.npz")).expect("an archive") {
        let values = match array.values {
            ArrayValues::F64(values) => values,
            ArrayValues::I32(values) => values.into_iter().map(f64::from).collect(),
            ArrayValues::Text(texts) => {
                assert_eq!(texts.len(), JOINT_COLUMN_NAMES.len());
                match array.name.as_str() {
                    "names" => assert_eq!(texts, JOINT_COLUMN_NAMES),
                    _ => assert_eq!(texts[2..6], ["1", "1", "Pa", "Pa"]),
                }
                continue;
            }
            ArrayValues::I8(_) => panic!("{}", array.name),
        };
        columns.insert(array.name, values);
    }
    columns
}

/// Reads quantities, positions and axes of faces from the bytes of a ParaView file of lines.
fn read_lines(bytes: &[u8]) -> BTreeMap<String, Vec<f64>> {
    let mut columns = BTreeMap::new();
    for (name, unit, _) in JOINT_QUANTITIES {
        let array = if unit == "1" { name.to_owned() } else { format!("{name} [{unit}]") };
        columns.insert(name.to_owned(), read_plain_values(bytes, &array).expect(name));
    }
    let points = read_plain_values(bytes, POINTS_ARRAY).expect("points");
    for [a1, a2, a3, b1, b2, b3] in points.as_chunks::<6>().0 {
        assert!(*a3 == 0.0 && *b3 == 0.0);
        let axis = if a1 == b1 { 1.0 } else { 2.0 };
        for (name, value) in [("x1", 0.5 * (a1 + b1)), ("x2", 0.5 * (a2 + b2)), ("axis", axis)] {
            columns.entry(name.to_owned()).or_default().push(value);
        }
    }
    columns
}

/// Asserts that values agree within an absolute tolerance; any not-a-number equals any other.
fn assert_same(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name}");
    for (found, expected) in found.iter().zip(expected) {
        let agree = (found.is_nan() && expected.is_nan()) || (found - expected).abs() <= tolerance;
        assert!(agree, "{name}: {found} {expected}");
    }
}

/// Runs a case and checks that table, archive, lines and the last snapshot agree, that the list of snapshots is
/// complete, that checksums are sound, and that `plot` draws the same pictures. Returns the columns and the text.
fn run_and_check_joint_files(folder: &Path, case: &str) -> (BTreeMap<String, Vec<f64>>, String) {
    let text = run_case(&create_run_options(folder, case)).expect("a sound case");
    let table = read_table(folder);
    let archive = read_archive(folder);
    assert_eq!(archive.len(), JOINT_COLUMN_NAMES.len());
    let bytes = read_file(folder, "joints.vtp");
    let lines = read_lines(&bytes);
    for name in JOINT_COLUMN_NAMES {
        assert_same(name, &archive[name], &table[name], 0.0);
        if name != "joint" {
            let tolerance = if name.starts_with('x') { 1e-12 } else { 0.0 };
            assert_same(name, &lines[name], &table[name], tolerance);
        }
    }
    // The last snapshot is the final state.
    let list = String::from_utf8(read_file(folder, "joints.pvd")).expect("text");
    let names = parse_collection(&list);
    let fields =
        parse_collection(&String::from_utf8(read_file(folder, "snapshots.pvd")).expect("text"));
    assert!(names.len() > 2 && names.len() == fields.len());
    for (name, fields) in names.iter().zip(&fields) {
        let times = [name, fields].map(|name| read_plain_time(&read_file(folder, name)));
        assert!(times[0].is_some() && times[0] == times[1], "{name}");
    }
    assert_eq!(read_file(folder, names.last().expect("a snapshot")), bytes);
    let at_rest = read_lines(&read_file(folder, &names[0]));
    assert!(["slip", "opening"].iter().all(|name| at_rest[*name].iter().all(|own| *own == 0.0)));
    // No file differs from its checksum.
    let found = verify_folder(&folder.join("out")).expect("results");
    assert!(found.damaged_files.is_empty() && !found.is_unfinished, "{found:?}");
    // `plot` draws the same pictures from the result files.
    let names = ["run.svg", "run.png", "animation.gif"];
    let drawn = names.map(|name| read_file(folder, name));
    wellposed::cli::plot(&folder.join("out"), &PictureOptions::default(), &mut Vec::new())
        .expect("a finished run");
    assert!(names.map(|name| read_file(folder, name)) == drawn);
    // The library computes the same final state.
    let case = parse_case(case).expect("a sound case");
    let result = wellposed::simulate(&case, SimulationSettings::default(), &ignore_progress)
        .expect("a sound case");
    for (name, _, value) in JOINT_QUANTITIES {
        let values: Vec<f64> =
            result.fields.joint_faces.iter().map(|face| value(&face.record)).collect();
        assert_same(name, &values, &table[name], 0.0);
    }
    let snapshots = &result.records.snapshots;
    assert!(snapshots.last().is_some_and(|last| last.joint_faces == result.fields.joint_faces));
    (table, text)
}

#[test]
fn slipped_broken_and_open_joints_are_reported() {
    let here = create_scratch_folder();
    let (table, text) = run_and_check_joint_files(here.path(), BREAKING_CASE);
    // There are 11 planes of 36 faces and 5 planes of 72 faces.
    assert_eq!(table["axis"].iter().filter(|axis| **axis == 1.0).count(), 11 * 36);
    assert_eq!(table["axis"].iter().filter(|axis| **axis == 2.0).count(), 5 * 72);
    #[allow(clippy::needless_range_loop, reason = "index of several columns")]
    for face in 0..table["x1"].len() {
        let value = |name: &str| table[name][face];
        // The joint of index 0 has faces normal to x₁ only, and does not break.
        assert_eq!(value("joint"), value("axis") - 1.0);
        assert_eq!(value("slip") > 0.0, value("slip_time") > 0.0);
        assert!(value("opening") == 0.0 || value("fracture_time") > 0.0);
        assert!(value("axis") == 2.0 || value("fracture_time").is_nan());
        let steps = |along: usize| (value(["x1", "x2"][along]) + 0.3) / (0.05 / 6.0);
        let across = value("axis") as usize - 1;
        // Centres of faces are on planes between blocks, in the middle of a cell.
        assert!((steps(across) / 6.0 - (steps(across) / 6.0).round()).abs() < 1e-9);
        let middle = steps(1 - across) - 0.5;
        assert!((middle - middle.round()).abs() < 1e-9);
    }
    let count = |is_selected: &dyn Fn(usize) -> bool| {
        (0..table["x1"].len()).filter(|face| is_selected(*face)).count()
    };
    let slipped = count(&|face| table["slip"][face] > 0.0);
    let open = count(&|face| table["opening"][face] > 0.0);
    let broken = count(&|face| table["fracture_time"][face] > 0.0);
    assert!(slipped > 20 && open > 10 && broken >= open, "{slipped} {open} {broken}");
    let expected = format!("faces of joints: 756; {slipped} slipped, {open} open, {broken} broken");
    assert!(text.contains(&expected), "{text}");
    for line in ["largest slip", "largest opening", "first slip", "first fracture"] {
        assert!(text.contains(line), "{line} {text}");
    }
    let report: serde_json::Value =
        serde_json::from_slice(&read_file(here.path(), "run.json")).expect("JSON");
    let joints = &report["joints"];
    assert_eq!(joints["slipped"], slipped);
    assert_eq!(joints["broken"], broken);
    let largest = table["slip"].iter().copied().fold(0.0, f64::max);
    assert_eq!(joints["largest_slip"].as_f64(), Some(largest));
    let first = table["fracture_time"].iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(joints["first_fracture_time"].as_f64(), Some(first));
    // The picture contains the lines of joints and their legend; an SVG contains each text as a whole.
    let picture = String::from_utf8(read_file(here.path(), "run.svg")).expect("text");
    for text in ["slip up to", "open, gap up to", "joints"] {
        assert!(picture.contains(text), "{text}");
    }
    assert!(!here.path().join("out/fluid.png").exists());
}

#[test]
fn circulation_of_fluid_is_drawn() {
    let here = create_scratch_folder();
    let (table, _) = run_and_check_joint_files(here.path(), SATURATED_CASE);
    // The fluid moves, and the state is antisymmetric under a half turn about the rotated block.
    let largest = |name: &str| table[name].iter().fold(0.0, |sum: f64, own| sum.max(own.abs()));
    assert!(largest("fluid_velocity") > 0.0 && largest("pressure") > 0.0);
    assert!(table["porosity"].iter().all(|own| (0.0..0.2).contains(own)));
    let faces: BTreeMap<[i64; 3], usize> = (0..table["x1"].len())
        .map(|face| {
            let place = ["x1", "x2"].map(|name| (table[name][face] * 1e5).round() as i64);
            ([place[0], place[1], table["axis"][face] as i64], face)
        })
        .collect();
    let tolerance = 1e-9 * largest("fluid_velocity");
    for ([x1, x2, axis], face) in &faces {
        let other = faces[&[-x1, -x2, *axis]];
        let sum = table["fluid_velocity"][*face] + table["fluid_velocity"][other];
        assert!(sum.abs() <= tolerance, "{x1} {x2} {axis}: {sum}");
    }
    for name in ["fluid.png", "fluid.svg"] {
        assert!(here.path().join("out").join(name).exists(), "{name}");
    }
    let picture = String::from_utf8(read_file(here.path(), "fluid.svg")).expect("text");
    for text in ["flux of fluid θw", "level curves of |θw|", "pressure of fluid p ("] {
        assert!(picture.contains(text), "{text}");
    }
    // Rows shifted as in masonry have level curves, too.
    let masonry = SATURATED_CASE.replace("repeat = [7, 7]", "repeat = [7, 7]\nrow_shift = 0.025");
    run_case(&create_run_options(here.path(), &masonry)).expect("a sound case");
    let picture = String::from_utf8(read_file(here.path(), "fluid.svg")).expect("text");
    assert!(picture.contains("level curves of |θw|"));
}

/// Verifies pictures of quantities of joints: single and animated, redrawn with the same bits, and refused for joints that
/// do not have the quantity.
#[test]
fn quantities_of_joints_are_drawn() {
    let here = create_scratch_folder();
    let draw = |case: &str, old: &str, name: &str| {
        let case = case.replace(&format!("picture = \"{old}\""), &format!("picture = \"{name}\""));
        run_and_check_joint_files(here.path(), &case);
        let picture = String::from_utf8(read_file(here.path(), "run.svg")).expect("text");
        // The plotted quantity is in the colours of the faces: no other style of line is drawn.
        assert!(picture.contains(&format!("{name}, above ")), "{name}");
        assert!(!picture.contains("up to"), "{name}");
        let animation = read_file(here.path(), "animation.gif");
        (picture, animation)
    };
    let slip = draw(BREAKING_CASE, "sigma12", "slip");
    let opening = draw(BREAKING_CASE, "sigma12", "opening");
    let pressure = draw(SATURATED_CASE, "speed", "pressure");
    // The name of the colour bar ends with the unit, after a common factor if there is one.
    let unit = |picture: &str, name: &str| {
        let text = picture.split(&format!("{name} (")).nth(1).expect("the name of a colour bar");
        let parts = text.split(')').next().unwrap_or_default().split_whitespace();
        parts.last().unwrap_or_default().to_owned()
    };
    assert_eq!(unit(&slip.0, "slip of joints"), "m");
    assert_eq!(unit(&opening.0, "opening of joints"), "m");
    assert_eq!(unit(&pressure.0, "pressure of fluid p"), "Pa");
    assert!(slip.0 != opening.0 && slip.1 != opening.1);
    let refuse = |case: &str, old: &str, set: &str| {
        let case = case.replace(&format!("picture = \"{old}\""), set);
        parse_case(&case).expect_err("a refusal")
    };
    let expected = [
        (
            "picture = 'pressure'",
            "43: output.picture: found 'pressure' with joints of kind breaking, elastic-plastic; use another quantity, or a joint of kind saturated",
        ),
        (
            "picture = 'slip'\ncontours = [1e-6]",
            "44: output.contours: found with picture = 'slip'; leave it out",
        ),
    ];
    for (set, message) in expected {
        let error = refuse(BREAKING_CASE, "sigma12", set);
        assert!(error.starts_with(&format!("folder/x.toml:{message}")), "{error}");
    }
    let error = refuse(SATURATED_CASE, "speed", "picture = 'slip'");
    assert!(error.contains("found 'slip' with joints of kind saturated"), "{error}");
    let (welded, _) = BREAKING_CASE.split_once("[[joint]]").expect("joints");
    let (_, rest) = BREAKING_CASE.split_once("[time]").expect("a time");
    let error = refuse(&format!("{welded}[time]{rest}"), "sigma12", "picture = 'slip'");
    assert!(
        error.contains("found 'slip', a quantity of joints, in a case without joints"),
        "{error}"
    );
}

/// Verifies that the printed report has the terms of the ledger that are not zero, and no others of joints.
#[test]
fn report_lists_terms_of_the_joints_in_the_case() {
    let here = create_scratch_folder();
    let all = [
        ("plastic dissipation of joints", "joint_plastic_dissipation"),
        ("viscous dissipation of joints", "joint_viscous_dissipation"),
        ("energy released by open cracks", "joint_released_energy"),
        ("energy lost at fracture", "joint_fracture_energy"),
        ("kinetic energy of joints", "joint_kinetic"),
        ("kinetic energy of the fluid", "fluid_kinetic"),
    ];
    for (case, expected) in [(BREAKING_CASE, 4), (SATURATED_CASE, 3)] {
        let text = run_case(&create_run_options(here.path(), case)).expect("a sound case");
        let table = String::from_utf8(read_file(here.path(), "ledger.csv")).expect("text");
        let header: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
        let last: Vec<&str> = table.lines().last().expect("a row").split(',').collect();
        let mut count = 0;
        for (words, name) in all {
            let column = header.iter().position(|own| *own == name).expect(name);
            let is_zero = last[column].parse::<f64>().expect("a number") == 0.0;
            assert_eq!(text.contains(words), !is_zero, "{words}");
            count += usize::from(!is_zero);
        }
        assert_eq!(count, expected);
    }
}

/// Verifies that cases without joints have no such files and no such entry in the report.
#[test]
fn runs_without_joints_write_no_joint_files() {
    let here = create_scratch_folder();
    let (welded, _) = BREAKING_CASE.split_once("[[joint]]").expect("joints");
    let (_, rest) = BREAKING_CASE.split_once("[time]").expect("a time");
    let case = format!("{welded}[time]{rest}");
    let text = run_case(&create_run_options(here.path(), &case)).expect("a sound case");
    assert!(!text.contains("joints:"), "{text}");
    let names = fs::read_dir(here.path().join("out")).expect("a folder");
    for name in names {
        let name = name.expect("a name").file_name().to_string_lossy().into_owned();
        assert!(!name.starts_with("joints"), "{name}");
    }
    let report: serde_json::Value =
        serde_json::from_slice(&read_file(here.path(), "run.json")).expect("JSON");
    assert!(report.get("joints").is_none());
}
