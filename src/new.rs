//! `wellposed new`: a commented case to start from.

use crate::case::flow::{Disturbed, Quantity, UNIFORM};
use crate::case::{Key, Kind, Medium, Presence, keys};
use crate::output::{OutputError, write_file};
use models::granular_flow::RotationKind;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What a case is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// One state: `point`, `map`, `dispersion`, `speeds`.
    State,
    /// A dynamic problem: `run`.
    Run,
}

/// A dynamic problem in plane strain, to be changed.
const RUN: &str = include_str!("new/run.toml");

/// A flow in time, to be changed.
const FLOW: &str = include_str!("new/flow.toml");

/// Keys of a state that follow from others, and are only checked.
const CHECKED: [&str; 5] = [
    "background.deviatoric_stress",
    "background.velocity_gradient",
    "background.acceleration",
    "background.body_moment",
    "background.stress_angle_rate_deg",
];

/// Whether nothing determines the spin of a flow.
fn is_free(kind: Kind) -> bool {
    matches!(kind, Kind::Flow(flow) if flow.rotation() == RotationKind::Free)
}

/// The sections that say how a flow is run in time.
fn flow_in_time(rotation: RotationKind) -> String {
    let inner = Disturbed::all(rotation).get(1).map_or("v", |field| field.name());
    let evolves = match rotation {
        RotationKind::IntrinsicSpin => "w, rad/s",
        RotationKind::StressAxes => "psi_deg, degrees",
        RotationKind::None | RotationKind::Free => "",
    };
    let names: Vec<&str> = Quantity::all(rotation).iter().map(|own| own.name()).collect();
    let is_coaxial = rotation == RotationKind::None;
    let is_used = |block: &&str| match block {
        block if block.starts_with("[limits]") => is_coaxial,
        block if block.contains("kind = \"uniform\"") => !is_coaxial,
        _ => true,
    };
    let blocks: Vec<&str> = FLOW.split("\n\n").filter(is_used).collect();
    let text = blocks.join("\n\n").replace("INNER", inner).replace("NAMES", &names.join(", "));
    match is_coaxial {
        true => text.replace("; or EVOLVES", "").replace("                # or EVOLVES", ""),
        false => text.replace("EVOLVES", evolves),
    }
}
/// What `wellposed check` sends; what is left out is chosen to suit the solid.
const CHECK: &str = "
[check]
# numbers = [0.5, 2.0]                          # 1/m: wave numbers that wellposed check sends; > 0
# directions_deg = [0.0, 30.0]                  # deg: directions of their wave vectors from x₁
# cells = [20, 30, 40]                          # cells to a period on two or three grids, ascending
";

/// Writes a case for that medium to `file`, or else to `<kind>.toml`; says where.
///
/// # Errors
/// The file exists and `force` is not given, or it cannot be written.
pub fn run(
    medium: Medium,
    purpose: Purpose,
    file: Option<&Path>,
    force: bool,
) -> Result<PathBuf, OutputError> {
    let path = file.map_or_else(|| format!("{}.toml", medium.kind.name()).into(), Path::to_owned);
    if !force && path.symlink_metadata().is_ok() {
        return Err(OutputError {
            path,
            cause: "exists already".into(),
            remedy: "name another file, or overwrite with --force",
        });
    }
    if purpose == Purpose::Run && is_free(medium.kind) {
        return Err(OutputError {
            path,
            cause: format!("nothing determines the spin of {}", medium.kind.name()),
            remedy: "name another model: this one cannot be run in time",
        });
    }
    write_file(&path, text_for(medium, purpose).as_bytes())?;
    Ok(path)
}

/// The text of a case of one state: every key that the medium uses, with unit and meaning.
pub fn text(medium: impl Into<Medium>) -> String {
    text_for(medium.into(), Purpose::State)
}

/// The text of a case for that purpose.
pub fn text_for(medium: Medium, purpose: Purpose) -> String {
    let kind = medium.kind;
    let is_flow = matches!(kind, Kind::Flow(_));
    let mut text = format!(
        "\
# {what}. SI units; angles in degrees, anticlockwise from x₁.
# A key behind a '#' shows its default, or an example where there is none: take away the '#' to
# set it.
#
{verbs}

title = \"{title}: a first case\"
# name = \"{name}\"  # names the folder of results; absent: the name of this file

[model]
kind = \"{name}\"
",
        what = match purpose {
            Purpose::State => "One state of one material",
            Purpose::Run if is_flow => "A flow in time",
            Purpose::Run => "A dynamic problem in plane strain",
        },
        verbs = match kind {
            _ if purpose == Purpose::Run =>
                "# wellposed run FILE    fields, records of receivers, ledger of energy",
            Kind::Flow(_) => {
                "# wellposed point FILE    everything about this state
# wellposed map FILE      verdict over the two parameters of [map]"
            }
            Kind::Solid(_) => {
                "# wellposed dispersion FILE    frequencies and speeds of waves against wave number
# wellposed speeds FILE        characteristic speeds against direction
# wellposed check FILE         frequencies of the analysis held against those of the solver
# wellposed point FILE         everything about this state
# wellposed map FILE           verdict over the two parameters of [map]"
            }
        },
        title = medium.title(),
        name = kind.name(),
    );
    let mut section = "model";
    let conditions = medium.condition_names();
    let has_active = !conditions.is_empty();
    for key in keys().iter().filter(|key| key.is_used_by(medium)) {
        let Some(mut value) = key.example() else { continue };
        if has_active && key.name == "model.dimensions" {
            value = "2".into();
        }
        let (own, name) = key.split();
        if purpose == Purpose::Run && is_flow {
            let is_own = ["model", "background"].contains(&own);
            if !is_own || UNIFORM.contains(&key.name) || CHECKED.contains(&key.name) {
                continue;
            }
        } else if purpose == Purpose::Run {
            // A run needs no state, and its flow is ideal and associated.
            if !matches!(own, "model" | "yield") || matches!(name, "hardening" | "plastic_rate") {
                continue;
            }
            if name == "dimensions" {
                value = "2".into();
            }
            let friction = key.name.replace("dilatancy", "friction");
            if let Some(example) =
                Key::find(&friction).filter(|_| name.ends_with("dilatancy")).and_then(Key::example)
            {
                value = example;
            }
        }
        // Of the two ways to say what slips one is shown.
        if own == "stress" && has_active {
            continue;
        }
        if own != section {
            let _ = write!(text, "\n[{own}]\n");
            section = own;
            if let ("yield", Some(set)) = (own, medium.yields) {
                let _ = writeln!(text, "kind = \"{}\"", set.name);
            }
            if own == "yield" && has_active && purpose == Purpose::State {
                let _ = writeln!(
                    text,
                    "# Any of {}; or else a section [stress] with pressure, deviatoric_stress,\n\
                     # stress_angle_deg and so on, which is scaled until it yields.\n\
                     active = [\"{}\"]",
                    conditions.join(", "),
                    conditions[0]
                );
            }
        }
        let mark = if matches!(key.presence, Presence::Required(_)) { "" } else { "# " };
        let _ = writeln!(text, "{:<46}  # {}", format!("{mark}{name} = {value}"), comment(key));
    }
    let sets = kind.yield_sets();
    if medium.yields.is_none() && !sets.is_empty() {
        let names: Vec<&str> = sets.iter().map(|set| set.name).collect();
        let _ = write!(
            text,
            "\n# A solid that yields: wellposed new {}{} --yield SET, SET one of\n# {}.\n",
            kind.name(),
            if purpose == Purpose::Run { " --run" } else { "" },
            names.join(", ")
        );
    }
    if purpose == Purpose::Run {
        return match kind {
            Kind::Flow(_) => {
                text + "\n" + &kind.rotation_in_time().map_or(String::new(), flow_in_time)
            }
            Kind::Solid(_) => text + "\n" + RUN,
        };
    }
    let [x, y] = example_map(medium);
    if let Kind::Solid(_) = kind {
        text.push_str(CHECK);
    }
    let _ = write!(text, "\n[map]\n");
    for (axis, own) in [("x", x), ("y", y)] {
        let _ = writeln!(text, "{axis} = {own}");
    }
    text
}

/// The axes of a map to start from.
fn example_map(medium: Medium) -> [String; 2] {
    let axis = |parameter: &str, from: f64, to: f64, points: usize| {
        format!(
            "{{ parameter = \"{parameter}\", from = {from:?}, to = {to:?}, points = {points} }}"
        )
    };
    let keys = || keys().iter().filter(move |key| key.is_used_by(medium));
    let named =
        |end: &str| keys().find(|key| key.name.starts_with("yield.") && key.name.ends_with(end));
    match (medium.kind, medium.yields, named("dilatancy"), named("friction")) {
        (Kind::Flow(_), ..) => [
            axis("model.dilatancy_angle_deg", 0.0, 25.0, 26),
            axis("model.friction_angle_deg", 30.0, 60.0, 31),
        ],
        (_, Some(_), Some(dilatancy), Some(friction)) => {
            [axis(dilatancy.name, 0.0, 1.0, 41), axis(friction.name, 0.0, 1.0, 41)]
        }
        (_, Some(_), ..) => [
            axis("stress.out_of_plane_stress", -1.0, 1.0, 41),
            match Key::find("yield.hardening").filter(|key| key.is_used_by(medium)) {
                Some(hardening) => axis(hardening.name, -1e9, 1e9, 41),
                None => axis("stress.pressure", 0.0, 1e6, 41),
            },
        ],
        (Kind::Solid(solid), None, ..) => {
            // The first constant that may take any size.
            let first = solid.parameters.first().map_or("density", |own| own.name);
            let name = format!("model.{first}");
            let example = Key::find(&name).map_or(1.0, |key| match key.presence {
                Presence::Required(value) | Presence::Default(value) => value,
                Presence::Optional => 1.0,
            });
            [axis(&name, 0.5 * example, 1.5 * example, 11), axis("wave.number", 0.1, 10.0, 11)]
        }
    }
}

fn comment(key: &Key) -> String {
    match key.unit {
        "" => key.meaning.into(),
        unit => format!("{unit}: {}", key.meaning),
    }
}
