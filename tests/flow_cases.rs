//! Tests of time-domain flow sections of case files: parsing, refusals and messages.

use crate::support;

use models::flow::RotationKind;
use std::fs;
use std::path::Path;
use support::{NO_CHECKPOINTS, parse_case, replace_first};
use wellposed::case::flow::{FlowPerturbation, FlowQuantity, FlowRun, PerturbedField};
use wellposed::case::{Case, ModelKind};
use wellposed::cli::new::{self, TemplateKind};
use wellposed::cli::{self, CommandError, Options};

/// Flow case with every section; tests refer to its line numbers.
const FLOW_CASE: &str = include_str!("data/flow.toml");

fn parse_flow_run(text: &str) -> FlowRun {
    parse_case(text).unwrap().flow_run.unwrap()
}

/// Formats the case of a model without spin.
fn format_case_without_spin(kind: &str, inner: &str) -> String {
    let text =
        replace_first(FLOW_CASE, "moment_of_inertia = 1.25e-7\nrotational_strength = 0\n", "");
    let text = replace_first(&text, "harris-grekova", kind).replace("field = 'w'", inner);
    replace_first(&text, "noncoaxiality_deg = 20\n", "")
}

fn format_plastic_potential_case() -> String {
    let text = format_case_without_spin("plastic-potential", "field = 'v'");
    replace_first(&text, "[[initial]]\nkind = 'uniform'\nfield = 'v'\namplitude = 0.1\n", "")
}

#[test]
fn case_is_parsed_as_written() {
    let run = parse_flow_run(FLOW_CASE);
    assert_eq!(
        (run.grid.points, run.grid.lengths, run.rotation),
        ([32, 24], [0.2, 0.1], RotationKind::IntrinsicSpin)
    );
    assert_eq!((run.time.tolerance, run.time.pressure_tolerance), (1e-4, 1e-9));
    let FlowPerturbation::Mode(wave) = &run.perturbation_terms[0] else { panic!() };
    assert_eq!((wave.mode, wave.field, wave.phase_deg), ([2, -1], PerturbedField::Velocity, 0.0));
    assert!(matches!(
        run.perturbation_terms[1],
        FlowPerturbation::Packet { carrier: own, centre: [0.1, 0.05], radius: 0.02 } if own.phase_deg == 90.0
    ));
    assert!(matches!(
        run.perturbation_terms[2],
        FlowPerturbation::Noise { max_wave_number: 6.5, seed: 12, .. }
    ));
    // Positions on both boundaries of the box are valid; the nearest point is a point of the box.
    assert_eq!(run.grid.nearest_point(&run.receivers[0].position), 31);
    let names: Vec<&str> = run.receivers[0].fields.iter().map(|quantity| quantity.name()).collect();
    assert_eq!(names, ["v1", "v2", "w", "psi_deg", "p", "shear_rate"]);
    assert_eq!(run.receivers[1].fields, [FlowQuantity::StressAngle, FlowQuantity::Velocity(1)]);
    assert_eq!(run.output.plotted_field, Some(FlowQuantity::StressAngle));
    let text = format_case_without_spin("double-shearing", "field = 'psi_deg'");
    assert_eq!(parse_flow_run(&text).rotation, RotationKind::StressAxes);
    let run = parse_flow_run(&(format_plastic_potential_case() + "[limits]\nshear_rate = 0.01\n"));
    assert_eq!(run.min_shear_rate, 0.01);
    let equal = replace_first(FLOW_CASE, "length = [0.2, 0.1]", "length = 0.2");
    assert_eq!(parse_flow_run(&equal).grid.lengths, [0.2, 0.2]);
}

#[test]
fn resolved_case_parses_to_equal_case() {
    for text in [
        FLOW_CASE.to_owned(),
        format_case_without_spin("double-shearing", "field = 'psi_deg'"),
        format_plastic_potential_case(),
    ] {
        let case = parse_case(&text).unwrap();
        let resolved = case.to_toml();
        assert_eq!(
            parse_case(&resolved).unwrap_or_else(|error| panic!("{error}\n{resolved}")),
            case
        );
        assert!(resolved.contains("pressure_tolerance = 1e-9"), "{resolved}");
        assert_eq!(resolved.contains("[limits]"), text.contains("plastic"), "{resolved}");
        // Plot options do not change the results.
        let drawn =
            parse_case(&replace_first(&text, "picture = 'psi_deg'", "picture = 'v1'")).unwrap();
        assert_ne!(drawn, case);
        assert_eq!(drawn.without_plot_options(), case.without_plot_options());
        let other = parse_case(&replace_first(&text, "seed = 12", "seed = 13")).unwrap();
        assert_ne!(other.without_plot_options(), case.without_plot_options());
    }
}

/// Passage of the case text, its replacement, and the beginning of the message.
const INVALID_INPUTS: &[(&str, &str, &str)] = &[
    (
        "cells = [32, 24]",
        "cells = [32, 15]",
        "folder/x.toml:14: grid.cells: found [32, 15]; expected a list of 2 even whole numbers of at \
             least 8 (grid points along each axis)",
    ),
    (
        "cells = [32, 24]",
        "cells = [6, 16]",
        "folder/x.toml:14: grid.cells: found [6, 16]; expected",
    ),
    (
        "cells = [32, 24]",
        "cells = [8, 8, 8]",
        "folder/x.toml:14: grid.cells: found [8, 8, 8]; expected",
    ),
    (
        "cells = [32, 24]",
        "cells = [200000, 200000]",
        "folder/x.toml:14: grid.cells: 200000 × 200000 points; expected at most 268435456 in total",
    ),
    (
        "length = [0.2, 0.1]",
        "spacing = 0.01",
        "folder/x.toml:15: grid.spacing: not used by a flow; give length, the edge lengths of the box at t = 0 in m, instead",
    ),
    (
        "length = [0.2, 0.1]",
        "length = [0.2, -0.1]",
        "folder/x.toml:15: grid.length: found [0.2, -0.1]; expected a positive number or a list of 2",
    ),
    (
        "tolerance = 1e-4",
        "tolerance = 1",
        "folder/x.toml:18: time.tolerance: found 1; expected a number between 0 and 1",
    ),
    (
        "tolerance = 1e-4",
        "courant = 1",
        "folder/x.toml:18: time.courant: unknown key; allowed here: duration, tolerance, \
             pressure_tolerance",
    ),
    (
        "mode = [2, -1]",
        "mode = [0, 0]",
        "folder/x.toml:21: initial[0].mode: found [0, 0]; expected a list of 2 whole numbers, not both 0",
    ),
    (
        "mode = [2, -1]",
        "mode = [2, -8]",
        "folder/x.toml:21: initial[0].mode: found [2, -8] with 32 × 24 points; expected at most 10 and 7: use more grid points, or a longer wave",
    ),
    (
        "field = 'v'",
        "field = 'psi_deg'",
        "folder/x.toml:22: initial[0].field: found 'psi_deg'; allowed: v, w",
    ),
    (
        "at = [0.1, 0.05]",
        "at = [0.1, 0.5]",
        "folder/x.toml:30: initial[1].at: found [0.1, 0.5], outside the box; the box has x1 from 0 to \
             0.2 m, x2 from 0 to 0.1 m",
    ),
    (
        "to = 6.5",
        "to = 8",
        "folder/x.toml:36: initial[2].to: found 8 with 32 × 24 points; expected at most 7: use more grid points, or longer waves",
    ),
    (
        "to = 6.5",
        "to = 0.5",
        "folder/x.toml:36: initial[2].to: found 0.5 with from = 1; to must be",
    ),
    (
        "from = 1\nto = 6.5",
        "from = 1.1\nto = 1.2",
        "folder/x.toml:36: initial[2].to: no mode with √(m₁² + m₂²) between 1.1 and 1.2; use a wider band",
    ),
    (
        "seed = 12",
        "seed = -1",
        "folder/x.toml:38: initial[2].seed: found -1; expected a whole number of at least 0",
    ),
    (
        "kind = 'uniform'\nfield = 'w'",
        "kind = 'uniform'\nfield = 'v'",
        "folder/x.toml:41: initial[3].field: found 'v'; allowed: w",
    ),
    (
        "kind = 'uniform'",
        "kind = 'pulse'",
        "folder/x.toml:40: initial[3].kind: found 'pulse'; allowed: mode, packet, noise, uniform, file",
    ),
    (
        "fields = ['psi_deg', 'v2']",
        "fields = ['psi']",
        "folder/x.toml:48: receiver[1].fields: found 'psi'; did you mean 'psi_deg'? allowed: v1, v2, w, psi_deg, p, shear_rate",
    ),
    (
        "picture = 'psi_deg'",
        "picture = 'sigma11'",
        "folder/x.toml:51: output.picture: found 'sigma11'; allowed: speed, v1, v2, w, psi_deg, p, \
             shear_rate",
    ),
    (
        "[[receiver]]",
        "[gravity]\nacceleration = [0, -9.81]\n[[receiver]]",
        "folder/x.toml:43: gravity: not used by the model harris-grekova, a flow; leave it out: it belongs \
             to solids; a flow has grid, time, initial, receiver, output",
    ),
    (
        "[[receiver]]",
        "[limits]\nshear_rate = 0.1\n[[receiver]]",
        "folder/x.toml:43: limits: not used by the model harris-grekova, a flow; leave it out: it belongs to \
             plastic-potential",
    ),
];

#[test]
fn invalid_cases_are_refused_with_location_and_remedy() {
    for (old, new, message) in INVALID_INPUTS {
        let error = parse_case(&replace_first(FLOW_CASE, old, new)).expect_err(new);
        assert!(error.starts_with(message), "{new}:\n{message}\n{error}");
    }
}

#[test]
fn missing_and_misplaced_sections_are_refused() {
    let (head, rest) = FLOW_CASE.split_once("[[initial]]").unwrap();
    let (_, tail) = rest.split_once("[[receiver]]").unwrap();
    let error = parse_case(&format!("{head}[[receiver]]{tail}")).unwrap_err();
    let start =
        "folder/x.toml: initial: missing; add [[initial]] with kind = \"noise\", field = \"v\"";
    assert!(error.starts_with(start), "{error}");
    let (model, rest) = FLOW_CASE.split_once("[grid]").unwrap();
    let (_, time) = rest.split_once("[time]").unwrap();
    let error = parse_case(&format!("{model}[time]{time}")).unwrap_err();
    let start = "folder/x.toml:13: time: found [time], but no [grid]; add a section [grid] with cells and length";
    assert!(error.starts_with(start), "{error}");
    let error = parse_case(&replace_first(
        &format_plastic_potential_case(),
        "kind = 'mode'",
        "kind = 'uniform'",
    ))
    .unwrap_err();
    assert!(
        error.contains("initial[0].kind: found 'uniform' for the model plastic-potential;"),
        "{error}"
    );
    let free = new::generate_state_template(ModelKind::flow_kinds()[3])
        + "[grid]\ncells = [8, 8]\nlength = 1\n";
    let error = parse_case(&free).unwrap_err();
    assert!(
        error.contains("grid: not used by the model free-rotating, a flow; leave it out"),
        "{error}"
    );
    let solid = new::generate_state_template(ModelKind::solid_kinds()[0])
        + "[grid]\ncells = [8, 8]\nlength = 1\n";
    let error = parse_case(&solid).unwrap_err();
    assert!(error.contains("grid.length: not used by a solid; give spacing"), "{error}");
    let error = parse_case(&(solid.replace("length", "spacing") + "[limits]\nshear_rate = 0.1\n"))
        .unwrap_err();
    assert!(
        error.contains("limits: not used by the model classical, a solid; leave it out"),
        "{error}"
    );
}

fn execute_dry_run(folder: &Path, case: &str) -> Result<String, CommandError> {
    let file = folder.join("case.run.toml");
    fs::write(&file, case).unwrap();
    let out = Some(folder.join("out"));
    let options = Options {
        case_path: file,
        output_folder: out,
        is_dry_run: true,
        accept_ill_posed: true,
        ..Options::default()
    };
    let mut stdout = Vec::new();
    cli::run_simulation(&options, NO_CHECKPOINTS, &mut stdout)?;
    assert!(!folder.join("out").exists());
    Ok(String::from_utf8(stdout).unwrap())
}

/// Verifies that states are refused that are not uniform in the frame of the mean flow, not on yield, dilatant, out of
/// range, or on a grid larger than the free memory.
#[test]
fn states_without_solver_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str| {
        let error = execute_dry_run(folder.path(), text).expect_err(text);
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string().rsplit_once("case.run.toml").unwrap().1.to_owned()
    };
    for (extra, message) in [
        (
            "velocity = [1, 0]",
            ":13: background.velocity: found [1.0, 0.0]; leave it out: the box moves with the mean flow",
        ),
        (
            "pressure_gradient = [0, 1]",
            ":13: background.pressure_gradient: found [0.0, 1.0]; leave it out: simulated mean flows are uniform",
        ),
        ("stress_angle_gradient_deg = [1, 0]", ":13: background.stress_angle_gradient_deg: found"),
        ("spin_gradient = [1, 0]", ":13: background.spin_gradient: found"),
        ("inertia_rate = 1", ":13: background.inertia_rate: found 1.0; leave it out"),
        (
            "deviatoric_stress = 400",
            ":13: background.deviatoric_stress: found 400, inside yield; leave it out",
        ),
        (
            "deviatoric_stress = 600",
            ":13: background.deviatoric_stress: found 600, outside yield; leave it out",
        ),
        (
            "rotational_stress = 5",
            ":13: background.rotational_stress: found 5, outside yield; leave it out",
        ),
        ("body_moment = 1", ":13: background.body_moment: "),
    ] {
        let text = replace_first(FLOW_CASE, "[grid]", &format!("{extra}\n[grid]"));
        let error = refused(&text);
        assert!(error.starts_with(message), "{error}");
    }
    let dilatant = replace_first(
        FLOW_CASE,
        "moment_of_inertia",
        "dilatancy_angle_deg = 10\nmoment_of_inertia",
    );
    let error = refused(&dilatant);
    let message =
        ":5: model.dilatancy_angle_deg: found 10.0; expected 0: simulated flows are isochoric";
    assert_eq!(error, message);
    let error =
        refused(&replace_first(FLOW_CASE, "noncoaxiality_deg = 20", "noncoaxiality_deg = -45"));
    assert!(error.starts_with(":12: background.noncoaxiality_deg: found |Δ| = 45"), "{error}");
    // Parameters that the verb `point` refuses are refused by a run, too.
    let error =
        refused(&replace_first(FLOW_CASE, "friction_angle_deg = 30", "friction_angle_deg = 95"));
    assert!(error.starts_with(":4: model.friction_angle_deg: found 95"), "{error}");
    let error = refused(&replace_first(FLOW_CASE, "[grid]", "spin = 1\n[grid]"));
    assert!(error.contains("background.spin"), "{error}");
    let error = refused(&new::generate_state_template(ModelKind::flow_kinds()[3]));
    assert!(
        error.ends_with("this one does not determine the spin, so that it cannot be simulated")
    );
    if Path::new("/proc/meminfo").exists() {
        let large = replace_first(FLOW_CASE, "cells = [32, 24]", "cells = [16384, 16384]");
        let error = refused(&large);
        assert!(error.contains("GiB that are free; ask for fewer points"), "{error}");
    }
}

#[test]
fn dry_run_describes_computation() {
    let folder = tempfile::tempdir().unwrap();
    let text = execute_dry_run(folder.path(), FLOW_CASE).unwrap();
    let start = "would compute 32 × 24 points, Harris–Grekova, 0.001 s, wave numbers from 31.42 to 439.8 1/m, memory ";
    assert!(text.starts_with(start) && text.contains("run.png"), "{text}");
    for (path, text) in wellposed::CASES.iter().filter(|case| case.0.starts_with("cases/flow/")) {
        execute_dry_run(folder.path(), text).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}

/// Verifies that the fields of an archive must match the points of the case, and that the archive is part of the
/// case.
#[test]
fn initial_archives_are_read_relative_to_case() {
    let folder = tempfile::tempdir().unwrap();
    let archive = |names: &[&str], shape: [usize; 2]| {
        let mut archive = files::npz::NpzWriter::new(std::io::Cursor::new(Vec::new()));
        for name in names {
            archive.add_f64(name, &shape, &vec![0.5; shape[0] * shape[1]]).unwrap();
        }
        fs::write(folder.path().join("old.npz"), archive.finish().unwrap().into_inner()).unwrap();
    };
    let entry = "kind = 'file'\npath = 'old.npz'";
    let text = replace_first(FLOW_CASE, "kind = 'uniform'\nfield = 'w'\namplitude = 0.1", entry);
    let error = execute_dry_run(folder.path(), &text).unwrap_err().to_string();
    assert!(error.contains("initial[3].path: 'old.npz': No such file"), "{error}");
    archive(&["v1", "v2", "w"], [24, 32]);
    execute_dry_run(folder.path(), &text).unwrap();

    let file = folder.path().join("case.run.toml");
    let case = Case::load(&file, &[]).unwrap();
    let resolved = case.to_toml();
    // The resolved case is equal in any folder and does not read the archive.
    assert_eq!(parse_case(&resolved).unwrap(), case);
    archive(&["v1", "v2", "psi"], [24, 32]);
    assert_ne!(Case::load(&file, &[]).unwrap(), case);
    let error = execute_dry_run(folder.path(), &resolved).unwrap_err().to_string();
    assert!(error.contains("has changed since the case was read; bring it back"), "{error}");
    let refused = |text: &str| execute_dry_run(folder.path(), text).unwrap_err().to_string();
    assert!(refused(&text).contains("old.npz': no array w; an archive (NPZ) with v1, v2 and"));
    archive(&["v1", "v2", "w"], [32, 24]);
    let error = refused(&text);
    assert!(error.contains("v1 is of shape [32, 24], not [24, 32]"), "{error}");
    fs::write(folder.path().join("old.npz"), "no archive").unwrap();
    assert!(refused(&text).contains("initial[3].path: '"));
    let odd = replace_first(&text, entry, "kind = 'file'\npath = 'old.npz'\nchecksum = 'xyz'");
    assert!(refused(&odd).contains("initial[3].checksum: found the text 'xyz'; expected eight"));
}

/// Verifies that the template contains every key of a flow, and that every entry of it is valid.
#[test]
fn run_templates_contain_every_key() {
    let folder = tempfile::tempdir().unwrap();
    for kind in &ModelKind::flow_kinds()[..3] {
        let text = new::generate_template((*kind).into(), TemplateKind::Simulation);
        execute_dry_run(folder.path(), &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let template = &text[text.find("\n[grid]\n").unwrap()..];
        let base = text.split("\n\n").filter(|block| !block.starts_with("[[initial]]"));
        let base = base.collect::<Vec<_>>().join("\n\n");
        for block in template.split("\n\n").map(str::trim) {
            let lines: Vec<&str> = block
                .lines()
                .map(|line| line.strip_prefix("# ").unwrap_or(line))
                .filter(|line| line.starts_with('[') || line.contains(" = "))
                .collect();
            let Some(header) = lines.first().filter(|line| line.starts_with('[')) else { continue };
            let is_file = block.contains("\"file\"");
            let section = lines.join("\n");
            let document = match header.starts_with("[[initial]]") {
                true => format!("{base}\n{section}\n"),
                false => text.replace(block, &section),
            };
            let found = Case::parse(&document, "x.toml", &[]);
            found.unwrap_or_else(|error| panic!("{error}\n{document}"));
            let odd = document.replace(&section, &format!("{section}\nodd = 0"));
            let error = Case::parse(&odd, "x.toml", &[]).unwrap_err().to_string();
            let (_, allowed) =
                error.split_once("allowed here: ").unwrap_or_else(|| panic!("{error}"));
            for key in allowed.split(", ") {
                // A receiver entry is a point, a line or a grid; the keys of the other forms are in other entries.
                let is_shown = match header.starts_with("[[receiver]]") {
                    true => template.contains(&format!("{key} = ")),
                    false => section.contains(&format!("{key} = ")),
                };
                assert!(is_shown, "{key} is missing in {block} {is_file}");
            }
        }
        for name in FlowPerturbation::NAMES
            .iter()
            .filter(|name| text.contains("psi_deg") || **name != "uniform")
        {
            let is_shown = template.contains(&format!("kind = \"{name}\""));
            let is_coaxial = *name == "uniform" && kind.name() == "plastic-potential";
            assert!(is_shown != is_coaxial, "{name}");
        }
        for quantity in FlowQuantity::all_fields(kind.simulation_rotation().unwrap()) {
            assert!(template.contains(quantity.name()), "{quantity}");
        }
        for word in ["EVOLVES", "INNER", "NAMES"] {
            assert!(!text.contains(word), "{text}");
        }
    }
    let other = folder.path().join("other.toml");
    let error = new::write_template(
        ModelKind::flow_kinds()[3].into(),
        TemplateKind::Simulation,
        Some(&other),
        false,
    )
    .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("free-rotating cannot be run in time: it leaves the spin undetermined"),
        "{error}"
    );
}
