//! The sections `[[initial]]` of a flow: terms of its initial perturbation.

use super::reader::FlowReader;
use crate::error::{CaseError, escape};
use crate::kind::ModelKind;
use crate::position_checks::{PositionDomain, check_position};
use crate::schema::{
    AllowedRange, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};
use crate::value::parse_number;
use files::FileDigest;
use models::common::decimal::ToPlainText;
use models::common::decimal::format_rounded;
use models::flow::RotationKind;
use std::path::Path;

const NUMBER_TYPE: ValueType = ValueType::Number(AllowedRange::Finite);
const POSITIVE_TYPE: ValueType = ValueType::Number(AllowedRange::Positive);
const FIELD_UNIT: &str = "the unit of the field";

/// Error text for an invalid archive.
const ARCHIVE_REQUIREMENT: &str = "name an NPZ archive such as fields.npz of a run, by its path relative to the folder of the case file";

const FIELD_KEY: KeySchema = KeySchema::new_required(
    "field",
    ValueType::OneOf(|scope| {
        PerturbedField::allowed_names(scope.kind.and_then(ModelKind::simulation_rotation))
    }),
    "",
    "\"v\"",
    "perturbed field: v, velocity normal to the wave vector, m/s; w, spin, rad/s; psi_deg, stress angle, deg",
);

const AMPLITUDE_KEY: KeySchema =
    KeySchema::new_required("amplitude", NUMBER_TYPE, FIELD_UNIT, "1e-6", "amplitude");

/// Schema of the sections `[[initial]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "initial",
    "term of the initial perturbation; the terms are summed; at least one is required",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "kind",
            ValueType::OneOf(|_| FlowPerturbation::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"noise\"",
            "mode: Fourier mode A cos(k·x + phase) with k = 2π(m₁/L₁, m₂/L₂); packet: Fourier mode times the Gaussian exp(−(r/radius)²); noise: all Fourier modes of a band, with equal amplitudes and random phases; uniform: constant spin or stress angle; file: fields of an archive",
        )]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["mode", "packet"])],
            &[
                KeySchema::new_required("mode", ValueType::ModeNumbers, "", "[2, 1]", "mode numbers m₁, m₂: wavelengths per box edge; may be negative")
                    .with_note("mode numbers m₁, m₂"),
                FIELD_KEY,
                AMPLITUDE_KEY,
                KeySchema::new_with_default("phase_deg", NUMBER_TYPE, "deg", "0.0", "phase at the corner of the box"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["packet"])],
            &[
                KeySchema::new_required("at", ValueType::Numbers(ListLength::Two), "m", "[0.05, 0.05]", "centre of the Gaussian")
                    .with_note("centre of the Gaussian"),
                KeySchema::new_required("radius", POSITIVE_TYPE, "m", "0.02", "radius of the Gaussian"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["noise"])],
            &[
                FIELD_KEY,
                KeySchema::new_required("from", POSITIVE_TYPE, "", "1", "lower limit of the mode number √(m₁² + m₂²)")
                    .with_note("lower limit of √(m₁² + m₂²)"),
                KeySchema::new_required("to", POSITIVE_TYPE, "", "16", "upper limit of the mode number √(m₁² + m₂²)")
                    .with_note("upper limit of √(m₁² + m₂²)"),
                KeySchema::new_required("amplitude", NUMBER_TYPE, FIELD_UNIT, "1e-6", "root-mean-square amplitude"),
                KeySchema::new_required("seed", ValueType::WholeNumber(0), "", "1", "seed of the random phases, which do not depend on the grid")
                    .with_note("seed of the random phases"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["uniform"])],
            &[
                KeySchema::new_required(
                    "field",
                    ValueType::OneOf(|scope| {
                        let rotation = scope.kind.and_then(ModelKind::simulation_rotation);
                        PerturbedField::allowed_names(rotation).into_iter().skip(1).collect()
                    }),
                    "",
                    "\"w\"",
                    "perturbed field: w, spin, rad/s; psi_deg, stress angle, deg",
                ),
                KeySchema::new_required("amplitude", NUMBER_TYPE, FIELD_UNIT, "1e-3", "uniform value"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["file"])],
            &[
                KeySchema::new_required(
                    "path",
                    ValueType::Text,
                    "",
                    "\"fields.npz\"",
                    "NPZ archive with v1, v2 and the other evolving fields on the same grid points, such as fields.npz of an earlier run; path relative to the folder of the case file",
                )
                .with_note(ARCHIVE_REQUIREMENT),
                KeySchema::new_optional(
                    "checksum",
                    ValueType::Hexadecimal,
                    "",
                    "\"00000000\"",
                    "CRC-32 checksum that the file must have; default: not checked",
                )
                .with_note("CRC-32 checksum of the file")
                .with_remark(", or leave it out"),
            ],
        ),
    ],
);

/// Perturbed field of a flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PerturbedField {
    /// Velocity component normal to the wave vector, m/s.
    Velocity,
    /// Spin ω, rad/s (Harris–Grekova only).
    Spin,
    /// Stress angle ψ, degrees (double shearing only).
    StressAngle,
}

impl PerturbedField {
    /// Returns the evolving fields of a flow with the material rotation `rotation`.
    pub const fn evolving_fields(rotation: RotationKind) -> &'static [Self] {
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

    /// Returns the names of the evolving fields of a flow with the material rotation `rotation`; for `None` of all
    /// flows.
    pub(crate) fn allowed_names(rotation: Option<RotationKind>) -> Vec<String> {
        let all: &[Self] = match rotation {
            Some(rotation) => Self::evolving_fields(rotation),
            None => &[Self::Velocity, Self::Spin, Self::StressAngle],
        };
        all.iter().map(|own| own.name().to_owned()).collect()
    }
}

/// A Fourier mode A cos(k·y + phase) with k = 2π(m₁/L₁, m₂/L₂), at the initial position y in the box with the initial
/// edge lengths L₁ and L₂, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HarmonicPerturbation {
    /// Mode numbers m₁ and m₂ (wavelengths per edge); not both 0.
    pub mode: [i64; 2],
    /// Perturbed field.
    pub field: PerturbedField,
    /// Amplitude A, in the unit of the field.
    pub amplitude: f64,
    /// Phase at the corner y = 0 of the box, degrees.
    pub phase_deg: f64,
}

/// A term of the initial perturbation; the terms are summed.
#[derive(Clone, Debug, PartialEq)]
pub enum FlowPerturbation {
    /// A single Fourier mode.
    Mode(HarmonicPerturbation),
    /// A wave packet with a Gaussian envelope exp(−(r/radius)²), at the distance r from the centre.
    Packet {
        /// Carrier wave.
        carrier: HarmonicPerturbation,
        /// Centre of the envelope, m.
        centre: [f64; 2],
        /// Radius of the envelope, m; positive.
        radius: f64,
    },
    /// Noise: all modes of a band of mode numbers, with equal amplitudes and random phases; the phases depend on the
    /// seed, not on the grid.
    Noise {
        /// Perturbed field.
        field: PerturbedField,
        /// Lower limit of √(m₁² + m₂²), inclusive; positive.
        min_wave_number: f64,
        /// Upper limit of √(m₁² + m₂²), inclusive.
        max_wave_number: f64,
        /// Root mean square of the noise, in the unit of the field.
        amplitude: f64,
        /// Seed of the random phases.
        seed: u64,
    },
    /// Uniform value of one field.
    Uniform {
        /// Perturbed field; not the velocity.
        field: PerturbedField,
        /// Value, in the unit of the field.
        amplitude: f64,
    },
    /// Fields from an NPZ archive, e.g. from an earlier simulation.
    File {
        /// Absolute path of the archive.
        path: String,
        /// CRC-32 checksum of the archive.
        checksum: u32,
    },
}

impl FlowPerturbation {
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

impl FlowReader<'_> {
    /// Reads the point `at` and checks that it is in the box.
    fn read_position(&self, section: &SectionReader) -> Result<[f64; 2], CaseError> {
        let at: Vec<f64> = section.read_required("at")?;
        let extents = self.grid.lengths.map(|length| [0.0, length]);
        check_position(section, "at", &at, &[0, 1], &extents, PositionDomain::Box)?;
        <[f64; 2]>::try_from(at).map_err(|_| section.invalid_value_error("at"))
    }

    /// Reads all sections `[[initial]]`; at least one is required.
    pub(super) fn read_perturbations(
        &self,
        root: &SectionReader,
    ) -> Result<Vec<FlowPerturbation>, CaseError> {
        let mut parts = Vec::new();
        for section in root.open_list(&SCHEMA)? {
            let part = match section.read_choice("kind", &FlowPerturbation::NAMES, |name| name)? {
                "mode" => FlowPerturbation::Mode(self.read_harmonic(&section)?),
                "packet" => FlowPerturbation::Packet {
                    carrier: self.read_harmonic(&section)?,
                    centre: self.read_position(&section)?,
                    radius: section.read_required("radius")?,
                },
                "noise" => self.read_noise(&section)?,
                "uniform" => self.read_uniform(&section)?,
                _ => self.read_archive_entry(&section)?,
            };
            section.finish()?;
            parts.push(part);
        }
        if parts.is_empty() {
            let allowed = "add [[initial]] with kind = \"noise\", field = \"v\", from, to, amplitude \
                           and seed: an unperturbed flow does not change";
            return Err(root.key_error("initial", "missing", allowed));
        }
        Ok(parts)
    }

    fn read_field(&self, section: &SectionReader) -> Result<PerturbedField, CaseError> {
        section.read_choice(
            "field",
            PerturbedField::evolving_fields(self.rotation),
            PerturbedField::name,
        )
    }

    fn read_amplitude(section: &SectionReader, field: PerturbedField) -> Result<f64, CaseError> {
        let expected = format!("a finite number in {}", field.unit());
        section.read_required_with("amplitude", &expected, parse_number)
    }

    fn read_harmonic(&self, section: &SectionReader) -> Result<HarmonicPerturbation, CaseError> {
        let mode: [i64; 2] = section.read_required("mode")?;
        let greatest = self.grid.max_mode_numbers().map(|most| most as u64);
        if mode.iter().zip(greatest).any(|(m, greatest)| m.unsigned_abs() > greatest) {
            let found = format!(
                "found {mode:?} with {} × {} points",
                self.grid.points[0], self.grid.points[1]
            );
            let allowed = format!(
                "expected at most {} and {}: use more grid points, or a longer wave",
                greatest[0], greatest[1]
            );
            return Err(section.key_error("mode", found, allowed));
        }
        let field = self.read_field(section)?;
        let amplitude = Self::read_amplitude(section, field)?;
        Ok(HarmonicPerturbation {
            mode,
            field,
            amplitude,
            phase_deg: section.read_or_default("phase_deg")?,
        })
    }

    fn read_noise(&self, section: &SectionReader) -> Result<FlowPerturbation, CaseError> {
        let field = self.read_field(section)?;
        let (from, to): (f64, f64) = (section.read_required("from")?, section.read_required("to")?);
        if to < from {
            let found = format!(
                "found {to} with from = {from}",
                to = to.to_plain_text(),
                from = from.to_plain_text()
            );
            return Err(section.key_error("to", found, "to must be at least from"));
        }
        let [first, second] = self.grid.max_mode_numbers();
        let greatest = first.min(second) as f64;
        if to > greatest {
            let found = format!(
                "found {} with {} × {} points",
                to.to_plain_text(),
                self.grid.points[0],
                self.grid.points[1]
            );
            let allowed = format!(
                "expected at most {}: use more grid points, or longer waves",
                format_rounded(greatest)
            );
            return Err(section.key_error("to", found, allowed));
        }
        let first = |m1: i64| (from * from - (m1 * m1) as f64).max(0.0).sqrt().ceil();
        let holds = |m1: i64| first(m1).powi(2) + (m1 * m1) as f64 <= to * to;
        if !(0..=to as i64).any(holds) {
            let found = format!(
                "no mode with √(m₁² + m₂²) between {from} and {to}",
                from = from.to_plain_text(),
                to = to.to_plain_text()
            );
            return Err(section.key_error("to", found, "use a wider band, e.g. from = 1 to = 8"));
        }
        let amplitude = Self::read_amplitude(section, field)?;
        let seed = section.read_required("seed")?;
        Ok(FlowPerturbation::Noise {
            field,
            min_wave_number: from,
            max_wave_number: to,
            amplitude,
            seed,
        })
    }

    fn read_uniform(&self, section: &SectionReader) -> Result<FlowPerturbation, CaseError> {
        let fields = &PerturbedField::evolving_fields(self.rotation)[1..];
        if fields.is_empty() {
            let found = "found 'uniform' for the model plastic-potential";
            let allowed = "use another kind: this model evolves the velocity only, and a uniform velocity is part of the mean flow";
            return Err(section.key_error("kind", found, allowed));
        }
        let field = section.read_choice("field", fields, PerturbedField::name)?;
        Ok(FlowPerturbation::Uniform { field, amplitude: Self::read_amplitude(section, field)? })
    }

    /// Reads the entry of an archive. Its content is read when the simulation starts; the checksum in the resolved case
    /// detects changes of the archive.
    fn read_archive_entry(&self, section: &SectionReader) -> Result<FlowPerturbation, CaseError> {
        let file: String = section.read_required("path")?;
        let unreadable = |cause: &str| {
            section.key_error("path", format!("'{}': {cause}", escape(&file)), ARCHIVE_REQUIREMENT)
        };
        let path = std::path::absolute(self.case_folder.join(&file))
            .map_err(|error| unreadable(&error.to_string()))?;
        let path =
            path.to_str().ok_or_else(|| unreadable("the path of its folder is not UTF-8 text"))?;
        let path = path.to_owned();
        let checksum = match section.read_optional::<u64>("checksum")? {
            // Eight hexadecimal digits: at most 32 bits.
            Some(checksum) => checksum as u32,
            None => {
                let found = FileDigest::from_file(Path::new(&path));
                found.map_err(|error| unreadable(&error.to_string()))?.checksum
            }
        };
        Ok(FlowPerturbation::File { path, checksum })
    }
}

fn write_harmonic_keys(resolved: TableWriter, wave: &HarmonicPerturbation) -> TableWriter {
    resolved
        .with_number("mode", wave.mode)
        .with_text("field", wave.field.name())
        .with_number("amplitude", wave.amplitude)
        .with_number("phase_deg", wave.phase_deg)
}

/// Formats the section `[[initial]]` as TOML with all values.
pub(super) fn to_toml(part: &FlowPerturbation) -> String {
    let resolved = TableWriter::default().with_text("kind", part.name());
    let resolved = match part {
        FlowPerturbation::Mode(own) => write_harmonic_keys(resolved, own),
        FlowPerturbation::Packet { carrier: own, centre: at, radius } => {
            write_harmonic_keys(resolved, own).with_number("at", at).with_number("radius", radius)
        }
        FlowPerturbation::Noise {
            field,
            min_wave_number: from,
            max_wave_number: to,
            amplitude,
            seed,
        } => resolved
            .with_text("field", field.name())
            .with_number("from", from)
            .with_number("to", to)
            .with_number("amplitude", amplitude)
            .with_number("seed", seed),
        FlowPerturbation::Uniform { field, amplitude } => {
            resolved.with_text("field", field.name()).with_number("amplitude", amplitude)
        }
        FlowPerturbation::File { path, checksum } => {
            resolved.with_text("path", path).with_text("checksum", format!("{checksum:08x}"))
        }
    };
    resolved.to_section_toml(&SCHEMA)
}
