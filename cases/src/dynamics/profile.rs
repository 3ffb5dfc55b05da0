//! Spatial profiles of boundary loads.

use super::function::Samples;
use crate::error::CaseError;
use crate::schema::{Condition, Form, Group, Item, Length, Range, Type};
use crate::section::{Resolved, Section};
use crate::value::count;
use models::common::elementary::Elementary;
use std::f64::consts::{PI, TAU};

const AXIS: Item = Item::optional(
    "axis",
    Type::AxisOfSpace,
    "",
    "1",
    "an axis of the side, from 1, where it must be there",
)
.when(&[Condition::Space]);

/// Schema of the table `profile` of a load.
pub(super) const FORM: Form = Form::braces(
    "profile",
    "a factor along the side",
    &[
        Group::always(&[Item::required(
            "kind",
            Type::OneOf(|_| Profile::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"bell\"",
            "cos: cos(2πx/wavelength + phase); bell: ½(1 + cos(πr/radius)), 0 beyond; table: straight lines between samples, 0 outside",
        )]),
        Group::when(
            &[Condition::Is("kind", &["cos"])],
            &[
                AXIS,
                Item::required(
                    "wavelength",
                    Type::Number(Range::Positive),
                    "m",
                    "10.0",
                    "wavelength",
                ),
                Item::with_default("phase_deg", Type::Number(Range::Finite), "deg", "0.0", "phase"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["bell"])],
            &[
                Item::required(
                    "at",
                    Type::Numbers(Length::SideAxes),
                    "m",
                    "0.0",
                    "where it is 1; in space two numbers",
                )
                .note("where it is 1"),
                Item::required("radius", Type::Number(Range::Positive), "m", "5.0", "radius"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["table"])],
            &[
                AXIS,
                Item::required(
                    "samples",
                    Type::Samples(["[coordinate in m, value]", "coordinates"]),
                    "",
                    "[[-5.0, 0.0], [5.0, 1.0]]",
                    "coordinates, m, which increase, and factors",
                ),
            ],
        ),
    ],
);

/// Spatial profile of a boundary load: a factor that depends on the position on the face.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// Cosine cos(2πx/wavelength + phase) along a tangential axis.
    Cos {
        /// Axis, numbered from 0.
        axis: usize,
        /// Wavelength, m; positive.
        wavelength: f64,
        /// Phase, degrees.
        phase_deg: f64,
    },
    /// Cosine bell ½(1 + cos(πr/radius)) about a point; 0 beyond the radius.
    Bell {
        /// Centre, coordinates along the tangential axes of the face, m.
        at: Vec<f64>,
        /// Radius, m; positive.
        radius: f64,
    },
    /// Linear interpolation of samples along a tangential axis; 0 outside.
    Table {
        /// Axis, numbered from 0.
        axis: usize,
        /// Pairs of coordinate (m) and factor.
        samples: Samples,
    },
}

impl Profile {
    const NAMES: [&str; 3] = ["cos", "bell", "table"];

    /// Evaluates the factor at a position on the face; `distance` computes the distance (m) of two positions, e.g.
    /// across periodic faces.
    pub fn value(
        &self,
        axes: &[usize],
        position: &[f64],
        distance: impl Fn(&[f64], &[f64]) -> f64,
    ) -> f64 {
        let coordinate = |axis: &usize| {
            let place = axes.iter().position(|own| own == axis);
            place.and_then(|place| position.get(place)).copied().unwrap_or(0.0)
        };
        match self {
            Self::Cos { axis, wavelength, phase_deg } => {
                (TAU * coordinate(axis) / wavelength + phase_deg.to_radians()).cr_cos()
            }
            Self::Bell { at, radius } => match distance(position, at) / radius {
                part if part < 1.0 => 0.5 + 0.5 * (PI * part).cr_cos(),
                _ => 0.0,
            },
            Self::Table { axis, samples } => samples.value(coordinate(axis)),
        }
    }

    /// Reads the table `profile` of a load; `None` if absent.
    pub(super) fn read(section: &Section) -> Result<Option<Self>, CaseError> {
        let Some(section) = section.table("profile")? else { return Ok(None) };
        let axes = &section.scope.axes;
        let axis = || match axes[..] {
            [axis] => Ok(axis),
            _ => {
                let numbers: Vec<String> = axes.iter().map(|axis| (axis + 1).to_string()).collect();
                let expected = format!("{} (an axis of the side)", numbers.join(" or "));
                section.required_as("axis", &expected, |value| {
                    count(value)?.checked_sub(1).filter(|axis| axes.contains(axis))
                })
            }
        };
        let profile = match section.choice("kind", &Self::NAMES, |name| name)? {
            "cos" => {
                let phase_deg = section.or_default("phase_deg")?;
                Self::Cos { axis: axis()?, wavelength: section.required("wavelength")?, phase_deg }
            }
            "bell" => {
                Self::Bell { at: section.required("at")?, radius: section.required("radius")? }
            }
            _ => Self::Table {
                axis: axis()?,
                samples: Samples::new(section.required("samples")?)
                    .ok_or_else(|| section.wrong("samples"))?,
            },
        };
        section.finish()?;
        Ok(Some(profile))
    }

    /// Formats the profile as a TOML table; the axis is omitted on a face with one tangential axis.
    pub(super) fn resolved(&self, dimensions: usize) -> Resolved {
        let with_axis = |resolved: Resolved, axis: &usize| match dimensions {
            2 => resolved,
            _ => resolved.number("axis", axis + 1),
        };
        let resolved = Resolved::default();
        match self {
            Self::Cos { axis, wavelength, phase_deg } => {
                with_axis(resolved.text("kind", "cos"), axis)
                    .number("wavelength", wavelength)
                    .number("phase_deg", phase_deg)
            }
            Self::Bell { at, radius } => {
                resolved.text("kind", "bell").number("at", at).number("radius", radius)
            }
            Self::Table { axis, samples } => {
                with_axis(resolved.text("kind", "table"), axis).number("samples", samples.samples())
            }
        }
    }
}
