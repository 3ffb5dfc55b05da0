//! Generator of the commented case templates of `wellposed new` from the schema.

mod section_templates;

use super::keys::{Key, Presence, keys};
use super::kind::{MediumKind, ModelKind};
use super::{check, flow, rheology};
use crate::plane_wave::{
    ELASTIC_KIND, GRANULAR_SCHEMA, PISTON_SCHEMA, POROUS_SCHEMA, SPALL_SCHEMA,
};
use crate::section_schemas::simulation_schemas;
use section_templates::{ExampleSection, SectionTemplates, format_comment};
use std::fmt::Write;

/// Purpose of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateKind {
    /// Analysis of one state, for the commands `point`, `map`, `dispersion` and `speeds`.
    SingleState,
    /// Time-domain simulation, for the command `run`.
    Simulation,
    /// Time-domain simulation of a blocky medium of a solid; for a flow the same as [`Simulation`](Self::Simulation).
    BlockySimulation,
    /// Plane waves in a granular medium, for the command `shocks`; for all but the elastic classical solid the same as
    /// [`SingleState`](Self::SingleState).
    GranularPlaneWave,
    /// Plane waves in a porous medium; for other solids as [`GranularPlaneWave`](Self::GranularPlaneWave).
    PorousPlaneWave,
}

impl TemplateKind {
    /// Returns the name of the file of a template without extension.
    pub fn file_stem(self, medium: MediumKind) -> &'static str {
        match self {
            Self::GranularPlaneWave => "granular",
            Self::PorousPlaneWave => "porous",
            Self::SingleState | Self::Simulation | Self::BlockySimulation => medium.kind.name(),
        }
    }
}

/// Columns at which comments start: in templates of states, and in time-domain sections.
const COMMENT_COLUMNS: [usize; 2] = [48, 29];

/// Example time-domain simulation of a solid in plane strain.
const EXAMPLE_SOLID_RUN: &[ExampleSection] = &[
    ("grid", &[("cells", "[200, 100]"), ("spacing", "1.0"), ("origin", "[-100.0, -100.0]")]),
    ("time", &[("duration", "0.05")]),
    ("scheme", &[]),
    ("boundary", &[("side", "\"x1-\""), ("kind", "\"non-reflecting\"")]),
    ("boundary", &[("side", "\"x1+\""), ("kind", "\"non-reflecting\"")]),
    ("boundary", &[("side", "\"x2-\""), ("kind", "\"non-reflecting\"")]),
    (
        "load",
        &[
            ("side", "\"x2+\""),
            ("field", "\"sigma22\""),
            ("amplitude", "-1e3"),
            ("from", "-5.0"),
            ("to", "5.0"),
            ("time", "{ kind = \"pulse\", start = 0.0, duration = 0.02 }"),
        ],
    ),
    (
        "source",
        &[
            ("kind", "\"force\""),
            ("amplitude", "[1e4, 0.0]"),
            ("at", "[0.0, -40.0]"),
            ("radius", "4.0"),
            ("time", "{ kind = \"ricker\", frequency = 50.0, delay = 0.03 }"),
        ],
    ),
    ("receiver", &[("name", "\"surface\""), ("at", "[40.0, 0.0]")]),
    ("output", &[("picture", "\"speed\"")]),
];

/// Example time-domain simulation of a blocky medium.
const EXAMPLE_BLOCKY_RUN: &[ExampleSection] = &[
    (
        "block",
        &[
            ("name", "\"rock\""),
            ("cells", "[10, 10]"),
            ("spacing", "0.005"),
            ("origin", "[-1.0, -1.0]"),
            ("repeat", "[40, 20]"),
        ],
    ),
    ("joint", &[("every", "\"all\""), ("kind", "\"elastic\"")]),
    ("time", &[("duration", "1e-3")]),
    ("scheme", &[]),
    ("boundary", &[("side", "\"x1-\""), ("kind", "\"non-reflecting\"")]),
    ("boundary", &[("side", "\"x1+\""), ("kind", "\"non-reflecting\"")]),
    ("boundary", &[("side", "\"x2-\""), ("kind", "\"non-reflecting\"")]),
    (
        "load",
        &[
            ("side", "\"x2+\""),
            ("field", "\"sigma22\""),
            ("amplitude", "-1e6"),
            ("from", "-0.2"),
            ("to", "0.2"),
            ("time", "{ kind = \"pulse\", start = 0.0, duration = 2e-4 }"),
        ],
    ),
    (
        "receiver",
        &[("name", "\"below\""), ("at", "[0.025, -0.475]"), ("interpolation", "\"none\"")],
    ),
    ("output", &[("picture", "\"speed\"")]),
];

/// Example time-domain simulation of a flow.
const EXAMPLE_FLOW_RUN: &[ExampleSection] = &[
    ("grid", &[("cells", "[64, 64]"), ("length", "0.1")]),
    ("time", &[("duration", "1e-3")]),
    (
        "initial",
        &[
            ("kind", "\"noise\""),
            ("field", "\"v\""),
            ("from", "1"),
            ("to", "16"),
            ("amplitude", "1e-6"),
            ("seed", "1"),
        ],
    ),
    ("receiver", &[("name", "\"middle\""), ("at", "[0.05, 0.05]")]),
    ("output", &[("picture", "\"speed\"")]),
    ("limits", &[]),
];

/// Example of plane waves in a granular medium.
const EXAMPLE_GRANULAR_WAVE: &[ExampleSection] =
    &[("granular", &[("friction", "0.5")]), ("piston", &[("speed", "5.0"), ("loosening", "0.01")])];

/// Example of plane waves in a porous medium.
const EXAMPLE_POROUS_WAVE: &[ExampleSection] = &[
    ("porous", &[("porosity", "0.01"), ("contact_bulk_modulus", "4.256e9")]),
    ("piston", &[("pressure", "1e9")]),
];

/// Example of a rheological scheme with its load path.
const EXAMPLE_RHEOLOGY: &[ExampleSection] = &[
    ("rheology", &[("kind", "\"porous-plastic\"")]),
    ("load_path", &[("turning_values", "[-0.05, 0.01]"), ("cycles", "2"), ("rate", "0.01")]),
];

const RHEOLOGY_HEADER: &str = "\
# Rheological scheme: stress against strain. SI units; strains and stresses positive in tension.
# Keys that are commented out show the default, or an example if there is none; remove the '#' to
# set them.
#
# wellposed diagram FILE    diagram, energies of the elements

title = \"rheological scheme: a first case\"
# name = \"rheology\"  # name of the results folder; default: name of this file

";

/// Template of a model given as equations.
const EQUATIONS_TEMPLATE: &str = include_str!("template/equations.toml");

/// Section `[compare]`, commented out; its kinds of model use only keys that all flows use.
const COMPARE_COMMENT: &str = "\
# compare.kinds = [\"double-shearing\", \"plastic-potential\"]  # wellposed point: models compared at this state
";

/// Redundant keys of a state: derived from other keys, and checked where given.
const DERIVED_KEYS: [&str; 5] = [
    "background.deviatoric_stress",
    "background.velocity_gradient",
    "background.acceleration",
    "background.body_moment",
    "background.stress_angle_rate_deg",
];

/// Generates the template of a case of one state: the keys used by the medium, with unit and meaning.
pub fn generate_state_template(medium: impl Into<MediumKind>) -> String {
    generate_template(medium.into(), TemplateKind::SingleState)
}

/// Generates the template of a case for a purpose; of a rheological scheme it is the same for all purposes.
pub fn generate_template(medium: MediumKind, purpose: TemplateKind) -> String {
    if medium.kind == ModelKind::Equations {
        return EQUATIONS_TEMPLATE.to_owned();
    }
    if medium.kind == ModelKind::Rheology {
        let mut blocks = SectionTemplates::new(medium.kind, COMMENT_COLUMNS[1]);
        for table_schema in rheology::RHEOLOGY_SCHEMAS {
            blocks.add_section(table_schema, EXAMPLE_RHEOLOGY);
        }
        return RHEOLOGY_HEADER.to_owned() + &blocks.into_text();
    }
    let purpose = match purpose {
        TemplateKind::GranularPlaneWave | TemplateKind::PorousPlaneWave
            if medium.kind.name() != ELASTIC_KIND || medium.yield_set.is_some() =>
        {
            TemplateKind::SingleState
        }
        _ => purpose,
    };
    let mut text = format_header(medium, purpose);
    write_keys(&mut text, medium, purpose);
    let kind = medium.kind;
    let plane_wave = match purpose {
        TemplateKind::GranularPlaneWave => Some((
            EXAMPLE_GRANULAR_WAVE,
            [&GRANULAR_SCHEMA, &PISTON_SCHEMA, &SPALL_SCHEMA].as_slice(),
        )),
        TemplateKind::PorousPlaneWave => {
            Some((EXAMPLE_POROUS_WAVE, [&POROUS_SCHEMA, &PISTON_SCHEMA].as_slice()))
        }
        _ => None,
    };
    if let Some((start, table_schemas)) = plane_wave {
        let mut blocks = SectionTemplates::new(kind, COMMENT_COLUMNS[1]);
        for table_schema in table_schemas {
            blocks.add_section(table_schema, start);
        }
        return text + "\n" + &blocks.into_text();
    }
    let sets = kind.admissible_yield_sets();
    if medium.yield_set.is_none() && !sets.is_empty() {
        let names: Vec<&str> = sets.iter().map(|set| set.name).collect();
        let _ = write!(
            text,
            "\n# Template of a yielding solid: wellposed new {}{} --yield SET, with SET one of\n# {}.\n",
            kind.name(),
            if purpose != TemplateKind::SingleState { " --run" } else { "" },
            names.join(", ")
        );
    }
    if purpose != TemplateKind::SingleState {
        let mut blocks = SectionTemplates::new(kind, COMMENT_COLUMNS[1]);
        let start = match (kind, purpose) {
            (ModelKind::Flow(_), _) => EXAMPLE_FLOW_RUN,
            (_, TemplateKind::BlockySimulation) => EXAMPLE_BLOCKY_RUN,
            _ => EXAMPLE_SOLID_RUN,
        };
        for table_schema in simulation_schemas(kind) {
            blocks.add_section(table_schema, start);
        }
        return text + "\n" + &blocks.into_text();
    }
    if let ModelKind::Solid(_) = kind {
        let mut blocks = SectionTemplates::new(kind, COMMENT_COLUMNS[0]);
        blocks.add_section(&check::SCHEMA, &[("check", &[])]);
        text = text + "\n" + &blocks.into_text();
    }
    text + &format_map_section(medium)
}

/// Generates the head of a template, before the first constant.
fn format_header(medium: MediumKind, purpose: TemplateKind) -> String {
    let kind = medium.kind;
    let is_flow = matches!(kind, ModelKind::Flow(_));
    let is_plane_wave =
        matches!(purpose, TemplateKind::GranularPlaneWave | TemplateKind::PorousPlaneWave);
    format!(
        "\
# {what}. SI units; angles in degrees, anticlockwise from x₁.
# Keys that are commented out show the default, or an example if there is none; remove the '#' to
# set them.
#
{verbs}

title = \"{title}: a first case\"
# name = \"{stem}\"  # name of the results folder; default: name of this file
{compare}
[model]
kind = \"{name}\"
",
        what = match purpose {
            TemplateKind::SingleState => "Analysis of one state of one material",
            TemplateKind::GranularPlaneWave => "Plane waves in a granular medium",
            TemplateKind::PorousPlaneWave => "Plane waves in a porous medium",
            TemplateKind::BlockySimulation if !is_flow =>
                "Time-domain simulation of a blocky medium in plane strain",
            _ if is_flow => "Time-domain simulation of a flow",
            _ => "Time-domain simulation of a solid in plane strain",
        },
        verbs = match kind {
            _ if is_plane_wave =>
                "# wellposed shocks FILE    waves behind a piston: speeds, states, dissipation",
            _ if purpose != TemplateKind::SingleState =>
                "# wellposed run FILE    fields, receiver records, energy ledger",
            ModelKind::Flow(_) => {
                "# wellposed point FILE    full report on this state
# wellposed map FILE      verdicts over the two parameters of [map]"
            }
            // Schemes and models given as equations have templates of their own.
            ModelKind::Solid(_) | ModelKind::Rheology | ModelKind::Equations => {
                "# wellposed dispersion FILE    dispersion relation: frequencies and speeds against wave number
# wellposed speeds FILE        characteristic speeds against direction
# wellposed check FILE         predicted frequencies compared with those of the solver
# wellposed point FILE         full report on this state
# wellposed map FILE           verdicts over the two parameters of [map]"
            }
        },
        title = match purpose {
            TemplateKind::GranularPlaneWave => "granular medium".to_owned(),
            TemplateKind::PorousPlaneWave => "porous medium".to_owned(),
            TemplateKind::BlockySimulation if !is_flow => "blocky medium".to_owned(),
            _ => medium.title(),
        },
        name = kind.name(),
        stem = purpose.file_stem(medium),
        compare =
            if is_flow && purpose == TemplateKind::SingleState { COMPARE_COMMENT } else { "" },
    )
}

/// Returns the value of a key in a template; `None` if the template omits the key.
fn template_value(key: &Key, medium: MediumKind, purpose: TemplateKind) -> Option<String> {
    let value = key.example_value_for(medium)?;
    let (section, name) = key.split_section();
    let has_active = !medium.yield_condition_names().is_empty();
    // Either `yield.active` or the section `[stress]` is written, not both.
    if section == "stress" && has_active {
        return None;
    }
    let is_plane = purpose != TemplateKind::SingleState || has_active;
    if key.name == "model.dimensions" && is_plane {
        return Some("2".into());
    }
    if purpose == TemplateKind::SingleState {
        return Some(value);
    }
    if let ModelKind::Flow(_) = medium.kind {
        let is_shown = ["model", "background"].contains(&section)
            && !flow::ZERO_IN_UNIFORM_FLOW.contains(&key.name)
            && !DERIVED_KEYS.contains(&key.name);
        return is_shown.then_some(value);
    }
    // A time-domain simulation needs no state; the example is ideally plastic with an associated flow rule.
    if !matches!(section, "model" | "yield") || matches!(name, "hardening" | "plastic_rate") {
        return None;
    }
    let friction = key.name.replace("dilatancy", "friction");
    let of_friction = || Key::find_by_name(&friction).and_then(|key| key.example_value_for(medium));
    Some(if name.ends_with("dilatancy") { of_friction().unwrap_or(value) } else { value })
}

/// Writes the sections of scalar keys.
fn write_keys(text: &mut String, medium: MediumKind, purpose: TemplateKind) {
    let mut section = "model";
    for key in keys().iter().filter(|key| key.is_used_by(medium)) {
        let Some(value) = template_value(key, medium, purpose) else { continue };
        let (own, name) = key.split_section();
        if own != section {
            let _ = write!(text, "\n[{own}]\n");
            section = own;
            if let ("yield", Some(set)) = (own, medium.yield_set) {
                let _ = writeln!(text, "kind = \"{}\"", set.name);
                let conditions = medium.yield_condition_names();
                if let (Some(first), TemplateKind::SingleState) = (conditions.first(), purpose) {
                    let _ = writeln!(
                        text,
                        "# Any of {}; alternatively a section [stress] with pressure, deviatoric_stress,\n\
                         # stress_angle_deg etc., which is scaled to the yield surface.\n\
                         active = [\"{first}\"]",
                        conditions.join(", "),
                    );
                }
            }
        }
        let is_required = matches!(key.presence_for(medium), Presence::Required(_));
        let mark = if is_required { "" } else { "# " };
        let comment = format_comment(key.unit, key.meaning);
        let _ = writeln!(text, "{:<46}  # {comment}", format!("{mark}{name} = {value}"));
    }
}

/// Generates the section `[map]`.
fn format_map_section(medium: MediumKind) -> String {
    // Ranges are written without their default spacing.
    let [x, y] =
        choose_example_axes(medium).map(|axis| axis.replace(" }", ", spacing = \"linear\" }"));
    format!("\n# spacing: linear or log\n[map]\nx = {x}\ny = {y}\n")
}

/// Returns example axes of a map.
pub(crate) fn choose_example_axes(medium: MediumKind) -> [String; 2] {
    let axis = |parameter: &str, from: f64, to: f64, points: usize| {
        format!(
            "{{ parameter = \"{parameter}\", from = {from:?}, to = {to:?}, points = {points} }}"
        )
    };
    let keys = || keys().iter().filter(move |key| key.is_used_by(medium));
    let named =
        |end: &str| keys().find(|key| key.name.starts_with("yield.") && key.name.ends_with(end));
    // Sweep of the first required constant with a unit in a section, about its example value.
    let around = |section: &str| {
        let constants = keys().filter(|key| key.name.starts_with(section));
        let example = |key: &Key| match key.presence_for(medium) {
            Presence::Required(value) if !key.unit.is_empty() => Some((key.name, value)),
            _ => None,
        };
        let (name, value) = constants.filter_map(example).next().unwrap_or(("wave.number", 1.0));
        axis(name, 0.5 * value, 1.5 * value, 11)
    };
    match (medium.kind, medium.yield_set, named("dilatancy"), named("friction")) {
        (ModelKind::Flow(_), ..) => [
            axis("model.dilatancy_angle_deg", 0.0, 25.0, 26),
            axis("model.friction_angle_deg", 30.0, 60.0, 31),
        ],
        (_, Some(_), Some(dilatancy), Some(friction)) => {
            [axis(dilatancy.name, 0.0, 1.0, 41), axis(friction.name, 0.0, 1.0, 41)]
        }
        (_, Some(_), ..) if keys().any(|key| key.name == "yield.hardening") => [
            axis("stress.out_of_plane_stress", -1.0, 1.0, 41),
            axis("yield.hardening", -1e9, 1e9, 41),
        ],
        (_, Some(_), ..) => [around("yield."), around("model.")],
        (_, None, ..) => [around("model."), axis("wave.number", 0.1, 10.0, 11)],
    }
}
