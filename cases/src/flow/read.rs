//! From the sections of a case to what it says of a flow in time.

use super::{
    Disturbed, FlowRun, Grid, Initial, LEAST_POINTS, MOST_POINTS, Output, Quantity, Time, Wave,
};
use crate::CaseError;
use crate::dynamics::read::{check_inside, intervals};
use crate::error::shown;
use crate::read::Entries;
use crate::receivers::{Domain, receivers};
use crate::section::{
    Node, Section, any_numbers, cells, joined, number, numbers, positive, spacing, text, whole,
    whole_pair,
};
use models::granular_flow::RotationKind;
use std::path::Path;

/// What the sections of the case say.
///
/// # Errors
/// What is wrong, where, and what is allowed.
pub(crate) fn read(
    rotation: RotationKind,
    entries: &Entries,
    folder: &Path,
) -> Result<FlowRun, CaseError> {
    let mut root = entries.structured();
    let grid = grid(&mut root)?;
    let reader = Reader { rotation, grid, folder };
    Ok(FlowRun {
        rotation,
        grid,
        time: time(&mut root)?,
        least_shear_rate: limits(&mut root)?,
        initial: reader.initial(&mut root)?,
        receivers: {
            let all = Quantity::all(rotation);
            let extents = grid.lengths.map(|length| [0.0, length]).to_vec();
            let domain = Domain { extents, whole: "box", interpolates: false };
            receivers(&mut root, &all, |name| named(&all, name), &domain)?
        },
        output: reader.output(&mut root)?,
        places: entries.places.clone(),
    })
}

fn named(among: &[Quantity], name: &str) -> Option<Quantity> {
    among.iter().copied().find(|own| own.name() == name)
}

fn grid(root: &mut Section) -> Result<Grid, CaseError> {
    let mut section = root.required_table("grid", "a section [grid] with cells and length")?;
    if section.node("spacing").is_some() {
        let allowed = "give length, the edges of the box at the beginning in m, in its place";
        return Err(section.error("spacing", "found for a flow", allowed));
    }
    let expected = format!(
        "a list of 2 even whole numbers of at least {LEAST_POINTS} (points along each axis)"
    );
    let even = |node: &Node| -> Option<[usize; 2]> {
        let cells = <[usize; 2]>::try_from(cells(node)?).ok()?;
        let is_usable = |count: &usize| count.is_multiple_of(2) && *count >= LEAST_POINTS;
        cells.iter().all(is_usable).then_some(cells)
    };
    let cells = section.required("cells", &expected, even)?;
    if cells[0].checked_mul(cells[1]).is_none_or(|count| count > MOST_POINTS) {
        let found = format!("{} × {} points", cells[0], cells[1]);
        let allowed = format!("expected at most {MOST_POINTS} in all");
        return Err(section.error("cells", found, allowed));
    }
    let expected = "a positive number or a list of 2 positive numbers in m (edges of the box at \
                    the beginning)";
    let edges = |node: &Node| <[f64; 2]>::try_from(spacing(2)(node)?).ok();
    let lengths = section.required("length", expected, edges)?;
    section.finish()?;
    Ok(Grid { cells, lengths })
}

fn time(root: &mut Section) -> Result<Time, CaseError> {
    let mut section = root.required_table("time", "a section [time] with duration in s")?;
    let duration = section.required("duration", "a positive number in s", positive)?;
    let share = |node: &Node| positive(node).filter(|share| *share < 1.0);
    let expected = "a number between 0 and 1 (error of a step relative to the perturbation)";
    let tolerance = section.optional("tolerance", expected, share)?.unwrap_or(1e-5);
    let expected = "a number between 0 and 1 (residual of the equation of the pressure relative \
                    to its right-hand side)";
    let pressure_tolerance = section.optional("pressure_tolerance", expected, share)?;
    section.finish()?;
    Ok(Time { duration, tolerance, pressure_tolerance: pressure_tolerance.unwrap_or(1e-9) })
}

/// The section `[limits]`, which only the plastic potential is let have.
fn limits(root: &mut Section) -> Result<f64, CaseError> {
    const DEFAULT: f64 = 1e-3;
    let Some(mut section) = root.table("limits")? else { return Ok(DEFAULT) };
    let share = |node: &Node| positive(node).filter(|share| *share < 1.0);
    let expected = "a number between 0 and 1 (least Q_D relative to that of the mean flow)";
    let least = section.optional("shear_rate", expected, share)?;
    section.finish()?;
    Ok(least.unwrap_or(DEFAULT))
}

/// What all entries are read with.
struct Reader<'a> {
    rotation: RotationKind,
    grid: Grid,
    /// The folder of the case file.
    folder: &'a Path,
}

impl Reader<'_> {
    /// The point `at`, which must be in the box.
    fn at(&self, section: &mut Section, meaning: &str) -> Result<[f64; 2], CaseError> {
        let expected = format!("a list of 2 finite numbers in m ({meaning})");
        let pair = |node: &Node| <[f64; 2]>::try_from(numbers(2)(node)?).ok();
        let at = section.required("at", &expected, pair)?;
        let extents = self.grid.lengths.map(|length| [0.0, length]);
        check_inside(section, "at", &at, &[0, 1], &extents, "box")?;
        Ok(at)
    }

    fn initial(&self, root: &mut Section) -> Result<Vec<Initial>, CaseError> {
        let mut parts = Vec::new();
        for mut section in root.tables("initial")? {
            let part = match section.choice("kind", &Initial::NAMES, |name| name)? {
                "mode" => Initial::Mode(self.wave(&mut section)?),
                "packet" => Initial::Packet {
                    wave: self.wave(&mut section)?,
                    at: self.at(&mut section, "the middle of the bell")?,
                    radius: section.required("radius", "a positive number in m", positive)?,
                },
                "noise" => self.noise(&mut section)?,
                "uniform" => self.uniform(&mut section)?,
                _ => self.file(&mut section)?,
            };
            section.finish()?;
            parts.push(part);
        }
        if parts.is_empty() {
            let allowed = "add [[initial]] with kind = \"noise\", field = \"v\", from, to, amplitude \
                           and seed: an unperturbed flow stays as it is";
            return Err(root.error("initial", "missing", allowed));
        }
        Ok(parts)
    }

    fn field(&self, section: &mut Section) -> Result<Disturbed, CaseError> {
        section.choice("field", Disturbed::all(self.rotation), Disturbed::name)
    }

    fn amplitude(section: &mut Section, field: Disturbed) -> Result<f64, CaseError> {
        let unit = match field {
            Disturbed::Velocity => "m/s",
            Disturbed::Spin => "rad/s",
            Disturbed::StressAngle => "degrees",
        };
        section.required("amplitude", &format!("a finite number in {unit}"), number)
    }

    fn wave(&self, section: &mut Section) -> Result<Wave, CaseError> {
        let expected = "a list of 2 whole numbers, not both 0 (wavelengths along each axis)";
        let not_zero = |node: &Node| whole_pair(node).filter(|mode| *mode != [0, 0]);
        let mode = section.required("mode", expected, not_zero)?;
        let greatest = self.grid.greatest_modes().map(|most| most as u64);
        if mode.iter().zip(greatest).any(|(m, greatest)| m.unsigned_abs() > greatest) {
            let found = format!(
                "found {mode:?} with {} × {} points",
                self.grid.cells[0], self.grid.cells[1]
            );
            let allowed = format!(
                "at most {} and {}: add points, or a longer wave",
                greatest[0], greatest[1]
            );
            return Err(section.error("mode", found, allowed));
        }
        let field = self.field(section)?;
        let amplitude = Self::amplitude(section, field)?;
        let phase_deg = section.optional("phase_deg", "a finite number in degrees", number)?;
        Ok(Wave { mode, field, amplitude, phase_deg: phase_deg.unwrap_or(0.0) })
    }

    fn noise(&self, section: &mut Section) -> Result<Initial, CaseError> {
        let field = self.field(section)?;
        let expected = |which: &str| format!("a positive number ({which} √(m₁² + m₂²))");
        let from = section.required("from", &expected("least"), positive)?;
        let to = section.required("to", &expected("greatest"), positive)?;
        if to < from {
            let found = format!("found {to:?} with from = {from:?}");
            return Err(section.error("to", found, "to must be at least from"));
        }
        let [first, second] = self.grid.greatest_modes();
        let greatest = first.min(second) as f64;
        if to > greatest {
            let found =
                format!("found {to:?} with {} × {} points", self.grid.cells[0], self.grid.cells[1]);
            let allowed = format!("at most {greatest:?}: add points, or take longer waves");
            return Err(section.error("to", found, allowed));
        }
        let first = |m1: i64| (from * from - (m1 * m1) as f64).max(0.0).sqrt().ceil();
        let holds = |m1: i64| first(m1).powi(2) + (m1 * m1) as f64 <= to * to;
        if !(0..=to as i64).any(holds) {
            let found = format!("no whole numbers m₁, m₂ between {from:?} and {to:?}");
            return Err(section.error("to", found, "a wider band, such as from = 1 to = 8"));
        }
        let amplitude = Self::amplitude(section, field)?;
        let expected = "a whole number of at least 0 (what the random phases follow from)";
        let seed = section.required("seed", expected, whole)?;
        Ok(Initial::Noise { field, from, to, amplitude, seed })
    }

    fn uniform(&self, section: &mut Section) -> Result<Initial, CaseError> {
        let fields = &Disturbed::all(self.rotation)[1..];
        if fields.is_empty() {
            let found = "found 'uniform' for the model plastic-potential";
            let allowed =
                "another kind: of a velocity that is uniform the mean flow takes the place";
            return Err(section.error("kind", found, allowed));
        }
        let field = section.choice("field", fields, Disturbed::name)?;
        Ok(Initial::Uniform { field, amplitude: Self::amplitude(section, field)? })
    }

    /// The file is read when the run begins; that it is the same then is known by its checksum, which a
    /// resolved case holds.
    fn file(&self, section: &mut Section) -> Result<Initial, CaseError> {
        const NEEDS: &str = "name an archive (NPZ) such as fields.npz of a run, in a folder as seen from that of the case";
        let file = section.required("path", &format!("text in quotes ({NEEDS})"), text)?;
        let unreadable =
            |cause: &str| section.error("path", format!("'{}': {cause}", shown(&file)), NEEDS);
        let path = std::path::absolute(self.folder.join(&file))
            .map_err(|error| unreadable(&error.to_string()))?;
        let path =
            path.to_str().ok_or_else(|| unreadable("its folder's name is not UTF-8 text"))?;
        let path = path.to_owned();
        let hexadecimal = |node: &Node| {
            let digits = text(node).filter(|digits| digits.len() == 8)?;
            u32::from_str_radix(&digits, 16).ok()
        };
        let expected = "eight hexadecimal digits in quotes (of the file's bytes); leave it out";
        let checksum = match section.optional("checksum", expected, hexadecimal)? {
            Some(checksum) => checksum,
            None => {
                let section = &*section;
                let unreadable = |cause: &str| {
                    section.error("path", format!("'{}': {cause}", shown(&file)), NEEDS)
                };
                // A pipe that nobody writes to would be waited for.
                if Path::new(&path).metadata().is_ok_and(|metadata| !metadata.is_file()) {
                    return Err(unreadable("not a regular file"));
                }
                let bytes = std::fs::read(&path).map_err(|error| unreadable(&error.to_string()))?;
                files::checksum(&bytes)
            }
        };
        Ok(Initial::File { path, checksum })
    }

    fn output(&self, root: &mut Section) -> Result<Output, CaseError> {
        const SPEED: &str = "speed";
        let mut output =
            Output { ledger_interval: 0.0, snapshot_interval: 0.0, picture: None, contours: None };
        let Some(mut section) = root.table("output")? else { return Ok(output) };
        [output.ledger_interval, output.snapshot_interval] =
            intervals(&mut section, "0: a two-hundredth of the duration")?;
        let all = Quantity::all(self.rotation);
        let words: Vec<&str> =
            [SPEED].into_iter().chain(all.iter().map(|own| own.name())).collect();
        let expected = format!("one of {}", joined(&words));
        if let Some(name) = section.optional("picture", &expected, text)? {
            output.picture = named(&all, &name);
            if output.picture.is_none() && name != SPEED {
                return Err(section.no_such("picture", &name, &words));
            }
        }
        let expected = "a list of finite numbers in the unit of the picture (lines of equal value)";
        output.contours = section.optional("contours", expected, any_numbers)?;
        section.finish()?;
        Ok(output)
    }
}
