//! The sections `[[initial]]`: parts of the initial state of a solid.

use super::component::{Component, components, names};
use super::function;
use super::plane_pulse::{PlanePulse, Polarization};
use super::reader::Reader;
use super::shape::{ITEMS, Shape};
use super::time;
use crate::error::CaseError;
use crate::schema::{Condition, Form, Group, Item, Length, Range, Type};
use crate::section::{Resolved, Section};
use crate::value::count;

const NUMBER: Type = Type::Number(Range::Finite);
const POSITIVE: Type = Type::Number(Range::Positive);
const POINT: Type = Type::Numbers(Length::Axes);
const SPACE: &[Condition] = &[Condition::Space];
const UNIT_OF_FIELD: &str = "the unit of the field";

const FIELD: Item = Item::required(
    "field",
    Type::OneOf(|scope| names(&components(scope))),
    "",
    "\"v1\"",
    "any component of the state",
);
const AMPLITUDE: Item =
    Item::required("amplitude", NUMBER, UNIT_OF_FIELD, "0.1", "the value, of a bell the greatest");
const VELOCITY: Item = Item::required("amplitude", NUMBER, "m/s", "0.1", "greatest velocity");
const DIRECTION: Item = Item::with_default(
    "direction_deg",
    NUMBER,
    "deg",
    "0.0",
    "direction in which it travels, from x₁ anticlockwise",
);
const ELEVATION: Item = Item::with_default(
    "elevation_deg",
    NUMBER,
    "deg",
    "0.0",
    "its angle above the plane of x₁ and x₂",
)
.when(SPACE);

/// Schema of the sections `[[initial]]`.
pub(super) const FORM: Form = Form::list(
    "initial",
    "a part of the initial state; the parts add up",
    &[
        Group::always(&[Item::required(
            "kind",
            Type::OneOf(|_| Initial::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"pulse\"",
            "pulse: a bell exp(−(r/radius)²) of one field; plane-wave: of the case's own medium; plane-pulse: a plane wave of finite length, in classical solids; rotation: a microrotation, in Cosserat solids; uniform: one value of one field",
        )]),
        Group::when(
            &[Condition::Is("kind", &["pulse"])],
            &[
                FIELD,
                AMPLITUDE,
                Item::optional("axis", Type::Axis, "", "2", "the bell is about a plane normal to this axis, not about a point")
                    .note("an axis"),
                Item::required("at", POINT, "m", "[0.0, -60.0]", "where it is greatest")
                    .note("where it is greatest")
                    .when(&[Condition::Absent("axis")]),
                Item::required("at", NUMBER, "m", "-60.0", "the coordinate of the plane along the axis")
                    .note("the plane, along the axis")
                    .when(&[Condition::Present("axis")]),
                Item::required("radius", POSITIVE, "m", "5.0", "radius"),
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["plane-wave"])],
            &[
                Item::required("branch", Type::Whole(1), "", "1", "which wave: 1 has the greatest frequency"),
                DIRECTION,
                ELEVATION,
                Item::required("wavelength", POSITIVE, "m", "20.0", "wavelength"),
                VELOCITY,
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["plane-pulse"])],
            &[
                Item::required(
                    "wave",
                    Type::OneOf(|_| time::names(Polarization::ALL, Polarization::name)),
                    "",
                    "\"S\"",
                    "longitudinal or transverse",
                ),
                DIRECTION,
                ELEVATION,
                Item::with_default(
                    "polarization_deg",
                    NUMBER,
                    "deg",
                    "0.0",
                    "of S waves the angle of the velocity from the direction of growing azimuth to that of growing elevation",
                )
                .when(&[Condition::Space, Condition::Is("wave", &["S"])]),
                Item::required("at", POINT, "m", "[0.0, -20.0]", "where the velocity is amplitude × time; inside the grid")
                    .note("a point of the grid"),
                VELOCITY,
                Item::optional("width", POSITIVE, "m", "20.0", "of the full amplitude across the direction; it falls to 0 over half of it on either side; default: without end"),
                function::TIME,
            ],
        ),
        Group::when(
            &[Condition::Is("kind", &["rotation", "uniform"])],
            &[Item::required(
                "shape",
                Type::OneOf(|scope| Shape::words(scope.dimensions, &Shape::Everywhere)),
                "",
                "\"box\"",
                "where, as in [[region]] and with the same keys, or everywhere",
            )],
        ),
        Group::when(&[Condition::Is("kind", &["rotation", "uniform"])], ITEMS),
        Group::when(
            &[Condition::Is("kind", &["rotation"])],
            &[
                Item::required("angle_deg", NUMBER, "deg", "1.0", "the angle, anticlockwise about the axis"),
                Item::optional("about", Type::AxisOfSpace, "", "3", "the axis, from 1; default 3")
                    .note("axis of the rotation")
                    .when(SPACE),
            ],
        ),
        Group::when(&[Condition::Is("kind", &["uniform"])], &[FIELD, AMPLITUDE]),
    ],
);

/// A part of the initial state; parts are summed.
#[derive(Clone, Debug, PartialEq)]
pub enum Initial {
    /// Gaussian pulse amplitude·exp(−(r/radius)²) of one component.
    Pulse {
        /// Perturbed component.
        field: Component,
        /// Maximum value, in the unit of the component.
        amplitude: f64,
        /// Centre of the pulse.
        centre: Centre,
        /// Radius, m; positive.
        radius: f64,
    },
    /// Plane wave of the medium of the case.
    PlaneWave {
        /// Branch of the dispersion relation, numbered from 1 for the highest frequency.
        branch: usize,
        /// Propagation direction, degrees anticlockwise from x₁.
        direction_deg: f64,
        /// Elevation of the propagation direction above the plane of x₁ and x₂, degrees; 0 in plane strain.
        elevation_deg: f64,
        /// Wavelength, m; positive.
        wavelength: f64,
        /// Velocity amplitude, m/s.
        amplitude: f64,
    },
    /// Plane wave with a time function as waveform.
    PlanePulse(PlanePulse),
    /// Microrotation.
    Rotation {
        /// Shape of the rotated part of the grid.
        shape: Shape,
        /// Angle, degrees, anticlockwise about the axis.
        angle_deg: f64,
        /// Rotation axis, numbered from 0; 2 in plane strain.
        axis: usize,
    },
    /// Uniform value of one component.
    Uniform {
        /// Shape of the part of the grid with this value.
        shape: Shape,
        /// Perturbed component.
        field: Component,
        /// Value, in the unit of the component.
        amplitude: f64,
    },
}

/// Centre of a pulse, from which the distance r is measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Centre {
    /// A point, m.
    Point(Vec<f64>),
    /// A plane normal to a coordinate axis.
    Plane {
        /// Axis of the normal, numbered from 0.
        axis: usize,
        /// Coordinate of the plane along the axis, m.
        at: f64,
    },
}

impl Initial {
    /// Names of all kinds of initial state in case files.
    pub const NAMES: [&str; 5] = ["pulse", "plane-wave", "plane-pulse", "rotation", "uniform"];

    /// Returns the name of the kind of initial state in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pulse { .. } => "pulse",
            Self::PlaneWave { .. } => "plane-wave",
            Self::PlanePulse(_) => "plane-pulse",
            Self::Rotation { .. } => "rotation",
            Self::Uniform { .. } => "uniform",
        }
    }

    /// Formats the section `[[initial]]` as TOML with all values.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = Resolved::default().text("kind", self.name());
        let resolved = match self {
            Self::Pulse { field, amplitude, centre, radius } => {
                let resolved =
                    resolved.text("field", field.to_string()).number("amplitude", amplitude);
                match centre {
                    Centre::Point(at) => resolved.number("at", at),
                    Centre::Plane { axis, at } => {
                        resolved.number("axis", axis + 1).number("at", at)
                    }
                }
                .number("radius", radius)
            }
            Self::PlaneWave { branch, direction_deg, elevation_deg, wavelength, amplitude } => {
                let resolved =
                    resolved.number("branch", branch).number("direction_deg", direction_deg);
                match dimensions {
                    2 => resolved,
                    _ => resolved.number("elevation_deg", elevation_deg),
                }
                .number("wavelength", wavelength)
                .number("amplitude", amplitude)
            }
            Self::PlanePulse(pulse) => {
                pulse.resolved(resolved, dimensions).table("time", &pulse.time.resolved())
            }
            Self::Rotation { shape, angle_deg, axis } => {
                let resolved = shape.resolved(resolved, dimensions).number("angle_deg", angle_deg);
                match dimensions {
                    2 => resolved,
                    _ => resolved.number("about", axis + 1),
                }
            }
            Self::Uniform { shape, field, amplitude } => shape
                .resolved(resolved, dimensions)
                .text("field", field.to_string())
                .number("amplitude", amplitude),
        };
        resolved.under(&FORM)
    }
}

impl Reader<'_> {
    /// Reads all sections `[[initial]]`.
    pub(super) fn initial(&self, root: &Section) -> Result<Vec<Initial>, CaseError> {
        let mut parts = Vec::new();
        for section in root.list(&FORM)? {
            let part = match section.choice("kind", &Initial::NAMES, |name| name)? {
                "pulse" => self.pulse(&section)?,
                "plane-wave" => self.plane_wave(&section)?,
                "plane-pulse" => {
                    let at = self.point_inside(&section)?;
                    let time = self.function(&section)?;
                    Initial::PlanePulse(PlanePulse::read(&section, at, time)?)
                }
                "rotation" => self.rotation(&section)?,
                _ => Initial::Uniform {
                    shape: self.shape(&section, &Shape::Everywhere)?,
                    field: self.component(&section, &self.components)?,
                    amplitude: section.required("amplitude")?,
                },
            };
            section.finish()?;
            parts.push(part);
        }
        Ok(parts)
    }

    fn pulse(&self, section: &Section) -> Result<Initial, CaseError> {
        let field = self.component(section, &self.components)?;
        let amplitude = section.required("amplitude")?;
        let centre = match section.optional::<usize>("axis")? {
            Some(axis) => Centre::Plane { axis: axis - 1, at: section.required("at")? },
            None => Centre::Point(section.required("at")?),
        };
        Ok(Initial::Pulse { field, amplitude, centre, radius: section.required("radius")? })
    }

    fn plane_wave(&self, section: &Section) -> Result<Initial, CaseError> {
        // The medium has as many branches as velocities and spins.
        let branches = self.components.iter().filter(|c| c.is_velocity()).count();
        let expected = format!("a whole number from 1 to {branches} (1 is the greatest frequency)");
        let branch = section.required_as("branch", &expected, |value| {
            count(value).filter(|branch| *branch <= branches)
        })?;
        let direction_deg = section.or_default("direction_deg")?;
        let elevation_deg = match self.dimensions() {
            2 => 0.0,
            _ => section.or_default("elevation_deg")?,
        };
        Ok(Initial::PlaneWave {
            branch,
            direction_deg,
            elevation_deg,
            wavelength: section.required("wavelength")?,
            amplitude: section.required("amplitude")?,
        })
    }

    fn rotation(&self, section: &Section) -> Result<Initial, CaseError> {
        self.need_spin(section, "kind", "a microrotation")?;
        let shape = self.shape(section, &Shape::Everywhere)?;
        let angle_deg = section.required("angle_deg")?;
        let axis = match self.dimensions() {
            2 => None,
            _ => section.optional::<usize>("about")?,
        };
        Ok(Initial::Rotation { shape, angle_deg, axis: axis.map_or(2, |axis| axis - 1) })
    }
}
