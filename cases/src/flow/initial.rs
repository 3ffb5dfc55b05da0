//! The sections `[[initial]]` of a flow: parts of its initial perturbation.

use super::reader::Reader;
use crate::error::{CaseError, escape};
use crate::kind::Kind;
use crate::position::check_inside;
use crate::schema::{Condition, Form, Group, Item, Length, Range, Type};
use crate::section::{Resolved, Section};
use crate::value::number;
use files::Written;
use models::flow::RotationKind;
use std::path::Path;

const NUMBER: Type = Type::Number(Range::Finite);
const POSITIVE: Type = Type::Number(Range::Positive);
const UNIT_OF_FIELD: &str = "the unit of the field";

/// Error text for an invalid archive.
const NEEDS: &str =
    "name an archive (NPZ) such as fields.npz of a run, in a folder as seen from that of the case";

const FIELD: Item = Item::required(
    "field",
    Type::OneOf(|scope| Disturbed::words(scope.kind.and_then(Kind::rotation_in_time))),
    "",
    "\"v\"",
    "v: the velocity across the wave vector, m/s; w: the spin, rad/s; psi_deg: the stress angle, deg",
);

const AMPLITUDE: Item = Item::required("amplitude", NUMBER, UNIT_OF_FIELD, "1e-6", "amplitude");

/// Schema of the sections `[[initial]]`.
pub(super) const FORM: Form = Form::list(
    "initial",
    "a part of the perturbation; the parts add up, and there is at least one",
    &[
        Group::always(&[Item::required(
            "kind",
            Type::OneOf(|_| Initial::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"noise\"",
            "mode: a wave A cos(k·x + phase) with k = 2π(m₁/L₁, m₂/L₂); packet: the same under a bell exp(−(r/radius)²); noise: all waves of a band, of equal amplitude and with random phases; uniform: one value of what evolves beside the velocity; file: fields of an archive",
        )]),
        Group::when(
            &[Condition::Is("kind", &["mode", "packet"])],
            &[
                Item::required("mode", Type::Mode, "", "[2, 1]", "wavelengths along each axis; may be negative")
                    .note("wavelengths along each axis"),
                FIELD,
                AMPLITUDE,
                Item::with_default("phase_deg", NUMBER, "deg", "0.0", "phase at the corner of the box"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["packet"])],
            &[
                Item::required("at", Type::Numbers(Length::Two), "m", "[0.05, 0.05]", "the middle of the bell")
                    .note("the middle of the bell"),
                Item::required("radius", POSITIVE, "m", "0.02", "radius of the bell"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["noise"])],
            &[
                FIELD,
                Item::required("from", POSITIVE, "", "1", "least number of wavelengths in the box, √(m₁² + m₂²)")
                    .note("least √(m₁² + m₂²)"),
                Item::required("to", POSITIVE, "", "16", "greatest number of wavelengths in the box")
                    .note("greatest √(m₁² + m₂²)"),
                Item::required("amplitude", NUMBER, UNIT_OF_FIELD, "1e-6", "root mean square"),
                Item::required("seed", Type::Whole(0), "", "1", "of the random phases, which are the same on all grids")
                    .note("what the random phases follow from"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["uniform"])],
            &[
                Item::required(
                    "field",
                    Type::OneOf(|scope| {
                        let rotation = scope.kind.and_then(Kind::rotation_in_time);
                        Disturbed::words(rotation).into_iter().skip(1).collect()
                    }),
                    "",
                    "\"w\"",
                    "w: the spin, rad/s; psi_deg: the stress angle, deg",
                ),
                Item::required("amplitude", NUMBER, UNIT_OF_FIELD, "1e-3", "the value"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["file"])],
            &[
                Item::required(
                    "path",
                    Type::Text,
                    "",
                    "\"fields.npz\"",
                    "an archive with v1, v2 and what evolves beside them on the same points, such as that of an earlier run; from a folder beside this file",
                )
                .note(NEEDS),
                Item::optional(
                    "checksum",
                    Type::Hexadecimal,
                    "",
                    "\"00000000\"",
                    "of the file, where it must be a certain one",
                )
                .note("of the file's bytes")
                .remark("; leave it out"),
            ],
        ),
    ],
);

/// Perturbed field of a flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbed {
    /// Velocity component normal to the wave vector, m/s.
    Velocity,
    /// Spin ω, rad/s (Harris–Grekova only).
    Spin,
    /// Stress angle ψ, degrees (double shearing only).
    StressAngle,
}

impl Disturbed {
    /// Returns the evolving fields of a flow with the material rotation `rotation`.
    pub const fn all(rotation: RotationKind) -> &'static [Self] {
        match rotation {
            RotationKind::IntrinsicSpin => &[Self::Velocity, Self::Spin],
            RotationKind::StressAxes => &[Self::Velocity, Self::StressAngle],
            RotationKind::None | RotationKind::Free => &[Self::Velocity],
        }
    }

    /// Returns the name of the field in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "v",
            Self::Spin => "w",
            Self::StressAngle => "psi_deg",
        }
    }

    /// Returns the unit of the field in case files.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Velocity => "m/s",
            Self::Spin => "rad/s",
            Self::StressAngle => "degrees",
        }
    }

    /// Returns the names of the evolving fields of a flow with this material rotation; of all flows for `None`.
    pub(crate) fn words(rotation: Option<RotationKind>) -> Vec<String> {
        let all: &[Self] = match rotation {
            Some(rotation) => Self::all(rotation),
            None => &[Self::Velocity, Self::Spin, Self::StressAngle],
        };
        all.iter().map(|own| own.name().to_owned()).collect()
    }
}

/// A Fourier mode A cos(k·y + phase) with k = 2π(m₁/L₁, m₂/L₂).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Mode numbers m₁ and m₂ (wavelengths per edge); not both 0.
    pub mode: [i64; 2],
    /// Perturbed field.
    pub field: Disturbed,
    /// Amplitude A, in the unit of the field.
    pub amplitude: f64,
    /// Phase at the corner of the box, degrees.
    pub phase_deg: f64,
}

/// A part of the initial perturbation; parts are summed.
#[derive(Clone, Debug, PartialEq)]
pub enum Initial {
    /// A single Fourier mode.
    Mode(Wave),
    /// A wave packet with a Gaussian envelope exp(−(r/radius)²).
    Packet {
        /// Carrier wave.
        wave: Wave,
        /// Centre of the envelope, m.
        at: [f64; 2],
        /// Radius of the envelope, m; positive.
        radius: f64,
    },
    /// Noise: all modes of a wave-number band, with equal amplitudes and random phases; the phases depend on the seed,
    /// not on the grid.
    Noise {
        /// Perturbed field.
        field: Disturbed,
        /// Smallest √(m₁² + m₂²) of the band.
        from: f64,
        /// Largest √(m₁² + m₂²) of the band.
        to: f64,
        /// Root mean square of the noise, in the unit of the field.
        amplitude: f64,
        /// Seed of the random phases.
        seed: u64,
    },
    /// Uniform value of one field.
    Uniform {
        /// Perturbed field; not the velocity.
        field: Disturbed,
        /// Value, in the unit of the field.
        amplitude: f64,
    },
    /// Fields from an NPZ archive, e.g. from an earlier simulation.
    File {
        /// Absolute path of the archive.
        path: String,
        /// 32-bit checksum of the archive.
        checksum: u32,
    },
}

impl Initial {
    /// Names of all kinds of perturbation in case files.
    pub const NAMES: [&str; 5] = ["mode", "packet", "noise", "uniform", "file"];

    /// Returns the name of the kind of perturbation in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Mode(_) => "mode",
            Self::Packet { .. } => "packet",
            Self::Noise { .. } => "noise",
            Self::Uniform { .. } => "uniform",
            Self::File { .. } => "file",
        }
    }
}

impl Reader<'_> {
    /// Reads the point `at` and checks that it is in the box.
    fn at(&self, section: &Section) -> Result<[f64; 2], CaseError> {
        let at: Vec<f64> = section.required("at")?;
        let extents = self.grid.lengths.map(|length| [0.0, length]);
        check_inside(section, "at", &at, &[0, 1], &extents, "box")?;
        <[f64; 2]>::try_from(at).map_err(|_| section.wrong("at"))
    }

    /// Reads all sections `[[initial]]`; at least one is required.
    pub(super) fn initial(&self, root: &Section) -> Result<Vec<Initial>, CaseError> {
        let mut parts = Vec::new();
        for section in root.list(&FORM)? {
            let part = match section.choice("kind", &Initial::NAMES, |name| name)? {
                "mode" => Initial::Mode(self.wave(&section)?),
                "packet" => Initial::Packet {
                    wave: self.wave(&section)?,
                    at: self.at(&section)?,
                    radius: section.required("radius")?,
                },
                "noise" => self.noise(&section)?,
                "uniform" => self.uniform(&section)?,
                _ => self.file(&section)?,
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

    fn field(&self, section: &Section) -> Result<Disturbed, CaseError> {
        section.choice("field", Disturbed::all(self.rotation), Disturbed::name)
    }

    fn amplitude(section: &Section, field: Disturbed) -> Result<f64, CaseError> {
        let expected = format!("a finite number in {}", field.unit());
        section.required_as("amplitude", &expected, number)
    }

    fn wave(&self, section: &Section) -> Result<Wave, CaseError> {
        let mode: [i64; 2] = section.required("mode")?;
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
        Ok(Wave { mode, field, amplitude, phase_deg: section.or_default("phase_deg")? })
    }

    fn noise(&self, section: &Section) -> Result<Initial, CaseError> {
        let field = self.field(section)?;
        let (from, to): (f64, f64) = (section.required("from")?, section.required("to")?);
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
        let seed = section.required("seed")?;
        Ok(Initial::Noise { field, from, to, amplitude, seed })
    }

    fn uniform(&self, section: &Section) -> Result<Initial, CaseError> {
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

    /// Reads the entry of an archive. Its content is read when the simulation starts; the checksum in the resolved case
    /// detects changes of the archive.
    fn file(&self, section: &Section) -> Result<Initial, CaseError> {
        let file: String = section.required("path")?;
        let unreadable =
            |cause: &str| section.error("path", format!("'{}': {cause}", escape(&file)), NEEDS);
        let path = std::path::absolute(self.folder.join(&file))
            .map_err(|error| unreadable(&error.to_string()))?;
        let path =
            path.to_str().ok_or_else(|| unreadable("its folder's name is not UTF-8 text"))?;
        let path = path.to_owned();
        let checksum = match section.optional::<u64>("checksum")? {
            // Eight hexadecimal digits: at most 32 bits.
            Some(checksum) => checksum as u32,
            None => {
                let found = Written::of_file(Path::new(&path));
                found.map_err(|error| unreadable(&error.to_string()))?.checksum
            }
        };
        Ok(Initial::File { path, checksum })
    }
}

fn wave(resolved: Resolved, wave: &Wave) -> Resolved {
    resolved
        .number("mode", wave.mode)
        .text("field", wave.field.name())
        .number("amplitude", wave.amplitude)
        .number("phase_deg", wave.phase_deg)
}

/// Formats the section `[[initial]]` as TOML with all values.
pub(super) fn to_toml(part: &Initial) -> String {
    let resolved = Resolved::default().text("kind", part.name());
    let resolved = match part {
        Initial::Mode(own) => wave(resolved, own),
        Initial::Packet { wave: own, at, radius } => {
            wave(resolved, own).number("at", at).number("radius", radius)
        }
        Initial::Noise { field, from, to, amplitude, seed } => resolved
            .text("field", field.name())
            .number("from", from)
            .number("to", to)
            .number("amplitude", amplitude)
            .number("seed", seed),
        Initial::Uniform { field, amplitude } => {
            resolved.text("field", field.name()).number("amplitude", amplitude)
        }
        Initial::File { path, checksum } => {
            resolved.text("path", path).text("checksum", format!("{checksum:08x}"))
        }
    };
    resolved.under(&FORM)
}
