//! `wellposed new`: a commented case to start from.

use crate::case::{KEYS, Key, Kind, Presence};
use crate::output::{OutputError, write_file};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Writes a case for that kind of model to `file`, or else to `<kind>.toml`; says where.
///
/// # Errors
/// The file exists and `force` is not given, or it cannot be written.
pub fn run(kind: Kind, file: Option<&Path>, force: bool) -> Result<PathBuf, OutputError> {
    let path = file.map_or_else(|| format!("{}.toml", kind.name()).into(), Path::to_owned);
    if !force && path.symlink_metadata().is_ok() {
        return Err(OutputError {
            path,
            cause: "exists already".into(),
            remedy: "name another file, or overwrite with --force",
        });
    }
    write_file(&path, text(kind).as_bytes())?;
    Ok(path)
}

/// The text of the case: every key that the kind uses, with unit and meaning.
pub fn text(kind: Kind) -> String {
    let mut text = format!(
        "\
# One state of one material. SI units; angles in degrees, anticlockwise from x₁.
# A key behind a '#' shows its default, or an example where there is none: take away the '#' to
# set it.
#
{verbs}

title = \"{title}: a first case\"
# name = \"{name}\"  # names the folder of results; absent: the name of this file

[model]
kind = \"{name}\"
",
        verbs = match kind {
            Kind::Flow(_) => {
                "# wellposed point FILE    everything about this state
# wellposed map FILE      verdict over the two parameters of [map]"
            }
            Kind::Solid(_) => {
                "# wellposed dispersion FILE    frequencies and speeds of waves against wave number"
            }
        },
        title = kind.title(),
        name = kind.name(),
    );
    let mut section = "model";
    for key in KEYS.iter().filter(|key| key.is_used_by(kind)) {
        let Some(value) = key.example() else { continue };
        let (own, name) = key.split();
        if own != section {
            let _ = write!(text, "\n[{own}]\n");
            section = own;
        }
        let mark = if matches!(key.presence, Presence::Required(_)) { "" } else { "# " };
        let _ = writeln!(text, "{:<46}  # {}", format!("{mark}{name} = {value}"), comment(key));
    }
    if let Kind::Solid(_) = kind {
        return text;
    }
    text.push_str(
        "
[map]
x = { parameter = \"model.dilatancy_angle_deg\", from = 0.0, to = 25.0, points = 26 }
y = { parameter = \"model.friction_angle_deg\", from = 30.0, to = 60.0, points = 31 }
",
    );
    text
}

fn comment(key: &Key) -> String {
    format!("{}: {}", key.unit, key.meaning)
}
