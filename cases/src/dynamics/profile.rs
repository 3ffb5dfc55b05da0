//! Spatial profiles of boundary loads.

use super::time_function::Samples;
use crate::error::CaseError;
use crate::schema::{
    AllowedRange, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};
use crate::value::parse_count;
use models::common::elementary::Elementary;
use std::f64::consts::{PI, TAU};

const AXIS_KEY: KeySchema = KeySchema::new_optional(
    "axis",
    ValueType::SpaceAxis,
    "",
    "1",
    "tangential axis of the face, numbered from 1; required in 3D",
)
.with_conditions(&[KeyCondition::Space]);

/// Schema of the table `profile` of a load.
pub(super) const SCHEMA: TableSchema = TableSchema::new_inline_table(
    "profile",
    "spatial profile along the face, a dimensionless factor",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "kind",
            ValueType::OneOf(|_| LoadProfile::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"bell\"",
            "cos: cos(2πx/wavelength + phase); bell: ½(1 + cos(πr/radius)) for r < radius, 0 outside; table: linear interpolation of samples, 0 outside",
        )]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["cos"])],
            &[
                AXIS_KEY,
                KeySchema::new_required(
                    "wavelength",
                    ValueType::Number(AllowedRange::Positive),
                    "m",
                    "10.0",
                    "wavelength",
                ),
                KeySchema::new_with_default(
                    "phase_deg",
                    ValueType::Number(AllowedRange::Finite),
                    "deg",
                    "0.0",
                    "phase",
                ),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["bell"])],
            &[
                KeySchema::new_required(
                    "at",
                    ValueType::Numbers(ListLength::FaceAxes),
                    "m",
                    "0.0",
                    "centre of the bell: tangential coordinates on the face, two in 3D",
                )
                .with_note("centre of the bell"),
                KeySchema::new_required(
                    "radius",
                    ValueType::Number(AllowedRange::Positive),
                    "m",
                    "5.0",
                    "radius of the bell",
                ),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["table"])],
            &[
                AXIS_KEY,
                KeySchema::new_required(
                    "samples",
                    ValueType::Samples(["[coordinate in m, value]", "coordinates"]),
                    "",
                    "[[-5.0, 0.0], [5.0, 1.0]]",
                    "pairs of increasing coordinate (m) and factor",
                ),
            ],
        ),
    ],
);

/// Spatial profile of a boundary load: a factor that depends on the position on the face.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadProfile {
    /// Cosine cos(2πx/wavelength + phase) along a tangential axis.
    Cos {
        /// Tangential axis, numbered from 0.
        axis: usize,
        /// Wavelength, m; positive.
        wavelength: f64,
        /// Phase, degrees.
        phase_deg: f64,
    },
    /// Cosine bell ½(1 + cos(πr/radius)) about a point; 0 beyond the radius.
    Bell {
        /// Centre, coordinates along the tangential axes of the face, m.
        centre: Vec<f64>,
        /// Radius, m; positive.
        radius: f64,
    },
    /// Linear interpolation of samples along a tangential axis; 0 outside the sampled interval.
    Table {
        /// Tangential axis, numbered from 0.
        axis: usize,
        /// Pairs of coordinate (m) and factor.
        samples: Samples,
    },
}

impl LoadProfile {
    const NAMES: [&str; 3] = ["cos", "bell", "table"];

    /// Evaluates the factor at a position on the face, given along the tangential axes `axes`; `distance` computes the
    /// distance (m) between two positions on the face, e.g. across periodic faces.
    pub fn evaluate(
        &self,
        axes: &[usize],
        position: &[f64],
        distance: impl Fn(&[f64], &[f64]) -> f64,
    ) -> f64 {
        let coordinate = |axis: &usize| {
            let axis_index = axes.iter().position(|own| own == axis);
            axis_index.and_then(|axis_index| position.get(axis_index)).copied().unwrap_or(0.0)
        };
        match self {
            Self::Cos { axis, wavelength, phase_deg } => {
                (TAU * coordinate(axis) / wavelength + phase_deg.to_radians()).cr_cos()
            }
            Self::Bell { centre: at, radius } => match distance(position, at) / radius {
                part if part < 1.0 => 0.5 + 0.5 * (PI * part).cr_cos(),
                _ => 0.0,
            },
            Self::Table { axis, samples } => samples.interpolate(coordinate(axis)),
        }
    }

    /// Returns the samples of a tabulated profile; `None` for the others, whose magnitude is at most 1.
    pub const fn samples(&self) -> Option<&Samples> {
        match self {
            Self::Table { samples, .. } => Some(samples),
            Self::Cos { .. } | Self::Bell { .. } => None,
        }
    }

    /// Reads the table `profile` of a load; `None` if absent.
    pub(super) fn read(section: &SectionReader) -> Result<Option<Self>, CaseError> {
        let Some(section) = section.open_table("profile")? else { return Ok(None) };
        let axes = &section.scope.face_axes;
        let axis = || match axes[..] {
            [axis] => Ok(axis),
            _ => {
                let numbers: Vec<String> = axes.iter().map(|axis| (axis + 1).to_string()).collect();
                let expected = format!("{} (a tangential axis of the face)", numbers.join(" or "));
                section.read_required_with("axis", &expected, |value| {
                    parse_count(value)?.checked_sub(1).filter(|axis| axes.contains(axis))
                })
            }
        };
        let profile = match section.read_choice("kind", &Self::NAMES, |name| name)? {
            "cos" => {
                let phase_deg = section.read_or_default("phase_deg")?;
                Self::Cos {
                    axis: axis()?,
                    wavelength: section.read_required("wavelength")?,
                    phase_deg,
                }
            }
            "bell" => Self::Bell {
                centre: section.read_required("at")?,
                radius: section.read_required("radius")?,
            },
            _ => Self::Table {
                axis: axis()?,
                samples: Samples::new(section.read_required("samples")?)
                    .ok_or_else(|| section.invalid_value_error("samples"))?,
            },
        };
        section.finish()?;
        Ok(Some(profile))
    }

    /// Formats the profile as a TOML table; the axis is omitted on a face with one tangential axis.
    pub(super) fn to_table(&self, dimensions: usize) -> TableWriter {
        let with_axis = |resolved: TableWriter, axis: &usize| match dimensions {
            2 => resolved,
            _ => resolved.with_number("axis", axis + 1),
        };
        let resolved = TableWriter::default();
        match self {
            Self::Cos { axis, wavelength, phase_deg } => {
                with_axis(resolved.with_text("kind", "cos"), axis)
                    .with_number("wavelength", wavelength)
                    .with_number("phase_deg", phase_deg)
            }
            Self::Bell { centre: at, radius } => resolved
                .with_text("kind", "bell")
                .with_number("at", at)
                .with_number("radius", radius),
            Self::Table { axis, samples } => with_axis(resolved.with_text("kind", "table"), axis)
                .with_number("samples", samples.samples()),
        }
    }
}
