//! The sections `[[initial]]`: terms of the initial state of a solid.

use super::component::{StateComponent, component_names, components_in_scope};
use super::plane_pulse::{BodyWaveType, PlanePulseInput};
use super::reader::SolidReader;
use super::shape::{RegionShape, SHAPE_KEYS};
use super::time;
use super::time_function;
use crate::error::CaseError;
use crate::schema::{
    AllowedRange, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};
use crate::value::parse_count;

const NUMBER_TYPE: ValueType = ValueType::Number(AllowedRange::Finite);
const POSITIVE_TYPE: ValueType = ValueType::Number(AllowedRange::Positive);
const POINT_TYPE: ValueType = ValueType::Numbers(ListLength::GridAxes);
const SPACE_CONDITION: &[KeyCondition] = &[KeyCondition::Space];
const FIELD_UNIT: &str = "the unit of the field";

const FIELD_KEY: KeySchema = KeySchema::new_required(
    "field",
    ValueType::OneOf(|scope| component_names(&components_in_scope(scope))),
    "",
    "\"v1\"",
    "component of the state",
);
const AMPLITUDE_KEY: KeySchema = KeySchema::new_required(
    "amplitude",
    NUMBER_TYPE,
    FIELD_UNIT,
    "0.1",
    "uniform value, or maximum of the pulse",
);
const VELOCITY_KEY: KeySchema =
    KeySchema::new_required("amplitude", NUMBER_TYPE, "m/s", "0.1", "velocity amplitude");
const DIRECTION_KEY: KeySchema = KeySchema::new_with_default(
    "direction_deg",
    NUMBER_TYPE,
    "deg",
    "0.0",
    "propagation direction, anticlockwise from x₁",
);
const ELEVATION_KEY: KeySchema = KeySchema::new_with_default(
    "elevation_deg",
    NUMBER_TYPE,
    "deg",
    "0.0",
    "elevation of the propagation direction above the x₁x₂ plane",
)
.with_conditions(SPACE_CONDITION);

/// Schema of the sections `[[initial]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "initial",
    "term of the initial state; the terms are summed",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "kind",
            ValueType::OneOf(|_| InitialStateTerm::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"pulse\"",
            "pulse: Gaussian exp(−(r/radius)²) of one component; plane-wave: eigenmode of the homogeneous medium; plane-pulse: plane P or S wave with a given time function, classical solids only; rotation: microrotation, Cosserat solids only; rigid-rotation: velocity (and spin) of a rigid body that rotates about a point; uniform: constant value of one component; loosening: contacts opened by an extension, without stress, granular media only",
        )]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["pulse"])],
            &[
                FIELD_KEY,
                AMPLITUDE_KEY,
                KeySchema::new_optional("axis", ValueType::Axis, "", "2", "axis (numbered from 1) normal to the central plane of the pulse; r is then the distance from this plane, not from a point")
                    .with_note("an axis"),
                KeySchema::new_required("at", POINT_TYPE, "m", "[0.0, -60.0]", "centre of the pulse")
                    .with_note("centre of the pulse")
                    .with_conditions(&[KeyCondition::Absent("axis")]),
                KeySchema::new_required("at", NUMBER_TYPE, "m", "-60.0", "coordinate of the central plane along the axis")
                    .with_note("coordinate of the central plane")
                    .with_conditions(&[KeyCondition::Present("axis")]),
                KeySchema::new_required("radius", POSITIVE_TYPE, "m", "5.0", "radius of the pulse"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["plane-wave"])],
            &[
                KeySchema::new_required("branch", ValueType::WholeNumber(1), "", "1", "branch number, from 1, in order of decreasing frequency"),
                DIRECTION_KEY,
                ELEVATION_KEY,
                KeySchema::new_required("wavelength", POSITIVE_TYPE, "m", "20.0", "wavelength"),
                VELOCITY_KEY,
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["plane-pulse"])],
            &[
                KeySchema::new_required(
                    "wave",
                    ValueType::OneOf(|_| time::variant_names(BodyWaveType::ALL, BodyWaveType::name)),
                    "",
                    "\"S\"",
                    "P: longitudinal wave; S: transverse wave",
                ),
                DIRECTION_KEY,
                ELEVATION_KEY,
                KeySchema::new_with_default(
                    "polarization_deg",
                    NUMBER_TYPE,
                    "deg",
                    "0.0",
                    "polarisation angle of the S wave, from the azimuthal towards the elevation direction",
                )
                .with_conditions(&[KeyCondition::Space, KeyCondition::HasValue("wave", &["S"])]),
                KeySchema::new_required("at", POINT_TYPE, "m", "[0.0, -20.0]", "reference point inside the grid, at which the velocity is amplitude × time function")
                    .with_note("point inside the grid"),
                VELOCITY_KEY,
                KeySchema::new_optional("width", POSITIVE_TYPE, "m", "20.0", "transverse width of full amplitude, with cosine tapers of half this width on either side; default: unbounded"),
                time_function::TIME_KEY,
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["rotation", "rigid-rotation", "uniform", "loosening"])],
            &[KeySchema::new_required(
                "shape",
                ValueType::OneOf(|scope| RegionShape::allowed_names_in_scope(scope.dimensions, &RegionShape::WholeGrid)),
                "",
                "\"box\"",
                "shape, with the keys of [[region]]; everywhere: the whole grid",
            )],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["rotation", "rigid-rotation", "uniform", "loosening"])],
            SHAPE_KEYS,
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["rotation"])],
            &[KeySchema::new_required("angle_deg", NUMBER_TYPE, "deg", "1.0", "rotation angle, anticlockwise about the axis")],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["rigid-rotation"])],
            &[
                KeySchema::new_required("at", POINT_TYPE, "m", "[0.0, -60.0]", "point of the rotation axis")
                    .with_note("point of the rotation axis"),
                KeySchema::new_required("rate", NUMBER_TYPE, "1/s", "1.0", "angular velocity, anticlockwise about the axis"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["rotation", "rigid-rotation"])],
            &[KeySchema::new_optional("about", ValueType::SpaceAxis, "", "3", "rotation axis, numbered from 1; default: 3")
                .with_note("rotation axis")
                .with_conditions(SPACE_CONDITION)],
        ),
        KeyGroup::with_conditions(&[KeyCondition::HasValue("kind", &["uniform"])], &[FIELD_KEY, AMPLITUDE_KEY]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["loosening"])],
            &[
                KeySchema::new_required("extension", POSITIVE_TYPE, "", "0.01", "strain by which the contacts are open"),
                KeySchema::new_optional("along", ValueType::Axis, "", "1", "axis of the extension, numbered from 1; default: all axes"),
            ],
        ),
    ],
);

/// A term of the initial state; the terms are summed.
#[derive(Clone, Debug, PartialEq)]
pub enum InitialStateTerm {
    /// Gaussian pulse amplitude·exp(−(r/radius)²) of one component, at the distance r from the centre.
    Pulse {
        /// Perturbed component.
        component: StateComponent,
        /// Maximum value, in the unit of the component.
        amplitude: f64,
        /// Centre of the pulse.
        centre: PulseCentre,
        /// Distance from the centre at which the pulse has 1/e of its maximum, m; positive.
        radius: f64,
    },
    /// Plane harmonic wave: one branch of the dispersion relation of the medium of the case.
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
    /// Plane P or S wave with a time function as waveform.
    PlanePulse(PlanePulseInput),
    /// Uniform microrotation inside a shape.
    Rotation {
        /// Shape inside which the microrotation differs from zero.
        shape: RegionShape,
        /// Angle, degrees, anticlockwise about the axis.
        angle_deg: f64,
        /// Rotation axis, numbered from 0; 2 in plane strain.
        axis: usize,
    },
    /// Velocity of a rigid body inside a shape, v = Ω e × (x − centre); in Cosserat solids also the spin Ω e.
    RigidRotation {
        /// Shape that rotates.
        shape: RegionShape,
        /// Point of the rotation axis, m.
        center: Vec<f64>,
        /// Angular velocity Ω, 1/s, anticlockwise about the axis.
        rate: f64,
        /// Direction e of the rotation axis, numbered from 0; 2 in plane strain.
        axis: usize,
    },
    /// Uniform value of one component inside a shape.
    Uniform {
        /// Shape inside which the component has this value.
        shape: RegionShape,
        /// Perturbed component.
        component: StateComponent,
        /// Value, in the unit of the component.
        amplitude: f64,
    },
    /// Contacts of a granular medium that are open by a strain inside a shape, without stress.
    Loosening {
        /// Shape inside which the contacts are open.
        shape: RegionShape,
        /// Extension by which they are open; positive.
        extension: f64,
        /// Axis of the extension, numbered from 0; `None` for all axes.
        axis: Option<usize>,
    },
}

/// Centre of a pulse, from which the distance r is measured.
#[derive(Clone, Debug, PartialEq)]
pub enum PulseCentre {
    /// Coordinates of a point, m.
    Point(Vec<f64>),
    /// A plane normal to a coordinate axis.
    Plane {
        /// Axis of the normal, numbered from 0.
        axis: usize,
        /// Coordinate of the plane along the axis, m.
        coordinate: f64,
    },
}

impl InitialStateTerm {
    /// Names of all kinds of initial state in case files.
    pub const NAMES: [&str; 7] = [
        "pulse",
        "plane-wave",
        "plane-pulse",
        "rotation",
        "rigid-rotation",
        "uniform",
        "loosening",
    ];

    /// Returns the shape inside which the term differs from zero; `None` for pulses and waves.
    pub const fn shape(&self) -> Option<&RegionShape> {
        match self {
            Self::Rotation { shape, .. }
            | Self::RigidRotation { shape, .. }
            | Self::Uniform { shape, .. }
            | Self::Loosening { shape, .. } => Some(shape),
            Self::Pulse { .. } | Self::PlaneWave { .. } | Self::PlanePulse(_) => None,
        }
    }

    /// Returns the name of the kind of initial state in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pulse { .. } => "pulse",
            Self::PlaneWave { .. } => "plane-wave",
            Self::PlanePulse(_) => "plane-pulse",
            Self::Rotation { .. } => "rotation",
            Self::RigidRotation { .. } => "rigid-rotation",
            Self::Uniform { .. } => "uniform",
            Self::Loosening { .. } => "loosening",
        }
    }

    /// Whether a medium with contacts can have the term: its velocities differ from zero, its stresses do not.
    pub(super) fn is_allowed_with_contacts(&self) -> bool {
        match self {
            Self::Pulse { component, .. } | Self::Uniform { component, .. } => {
                component.is_velocity()
            }
            Self::RigidRotation { .. } | Self::Loosening { .. } => true,
            Self::PlaneWave { .. } | Self::PlanePulse(_) | Self::Rotation { .. } => false,
        }
    }

    /// Formats the section `[[initial]]` as TOML with all values.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = TableWriter::default().with_text("kind", self.name());
        let resolved = match self {
            Self::Pulse { component: field, amplitude, centre, radius } => {
                let resolved = resolved
                    .with_text("field", field.to_string())
                    .with_number("amplitude", amplitude);
                match centre {
                    PulseCentre::Point(at) => resolved.with_number("at", at),
                    PulseCentre::Plane { axis, coordinate: at } => {
                        resolved.with_number("axis", axis + 1).with_number("at", at)
                    }
                }
                .with_number("radius", radius)
            }
            Self::PlaneWave { branch, direction_deg, elevation_deg, wavelength, amplitude } => {
                let resolved = resolved
                    .with_number("branch", branch)
                    .with_number("direction_deg", direction_deg);
                match dimensions {
                    2 => resolved,
                    _ => resolved.with_number("elevation_deg", elevation_deg),
                }
                .with_number("wavelength", wavelength)
                .with_number("amplitude", amplitude)
            }
            Self::PlanePulse(pulse) => pulse
                .write_keys(resolved, dimensions)
                .with_table("time", &pulse.waveform.to_table()),
            Self::Rotation { shape, angle_deg, axis } => {
                let resolved =
                    shape.write_keys(resolved, dimensions).with_number("angle_deg", angle_deg);
                write_axis(resolved, *axis, dimensions)
            }
            Self::RigidRotation { shape, center, rate, axis } => {
                let resolved = shape.write_keys(resolved, dimensions);
                let resolved = resolved.with_number("at", center).with_number("rate", rate);
                write_axis(resolved, *axis, dimensions)
            }
            Self::Uniform { shape, component: field, amplitude } => shape
                .write_keys(resolved, dimensions)
                .with_text("field", field.to_string())
                .with_number("amplitude", amplitude),
            Self::Loosening { shape, extension, axis } => {
                let resolved =
                    shape.write_keys(resolved, dimensions).with_number("extension", extension);
                match axis {
                    Some(axis) => resolved.with_number("along", axis + 1),
                    None => resolved,
                }
            }
        };
        resolved.to_section_toml(&SCHEMA)
    }
}

/// Adds the rotation axis in three dimensions.
fn write_axis(table: TableWriter, axis: usize, dimensions: usize) -> TableWriter {
    match dimensions {
        2 => table,
        _ => table.with_number("about", axis + 1),
    }
}

impl SolidReader<'_> {
    /// Reads all sections `[[initial]]`.
    pub(super) fn read_initial_terms(
        &self,
        root: &SectionReader,
    ) -> Result<Vec<InitialStateTerm>, CaseError> {
        let mut parts = Vec::new();
        for section in root.open_list(&SCHEMA)? {
            let part = match section.read_choice("kind", &InitialStateTerm::NAMES, |name| name)? {
                "pulse" => self.read_pulse(&section)?,
                "plane-wave" => self.read_plane_wave(&section)?,
                "plane-pulse" => {
                    let at = self.read_point(&section)?;
                    let time = self.read_time_function(&section)?;
                    InitialStateTerm::PlanePulse(PlanePulseInput::read(&section, at, time)?)
                }
                "rotation" => self.read_rotation(&section)?,
                "rigid-rotation" => InitialStateTerm::RigidRotation {
                    shape: self.read_shape(&section, &RegionShape::WholeGrid)?,
                    center: section.read_required("at")?,
                    rate: section.read_required("rate")?,
                    axis: self.read_rotation_axis(&section)?,
                },
                "loosening" => InitialStateTerm::Loosening {
                    shape: self.read_shape(&section, &RegionShape::WholeGrid)?,
                    extension: section.read_required("extension")?,
                    axis: section.read_optional::<usize>("along")?.map(|axis| axis - 1),
                },
                _ => InitialStateTerm::Uniform {
                    shape: self.read_shape(&section, &RegionShape::WholeGrid)?,
                    component: self.read_component(&section, &self.state_components)?,
                    amplitude: section.read_required("amplitude")?,
                },
            };
            section.finish()?;
            parts.push(part);
        }
        Ok(parts)
    }

    fn read_pulse(&self, section: &SectionReader) -> Result<InitialStateTerm, CaseError> {
        let field = self.read_component(section, &self.state_components)?;
        let amplitude = section.read_required("amplitude")?;
        let centre = match section.read_optional::<usize>("axis")? {
            Some(axis) => {
                PulseCentre::Plane { axis: axis - 1, coordinate: section.read_required("at")? }
            }
            None => PulseCentre::Point(section.read_required("at")?),
        };
        Ok(InitialStateTerm::Pulse {
            component: field,
            amplitude,
            centre,
            radius: section.read_required("radius")?,
        })
    }

    fn read_plane_wave(&self, section: &SectionReader) -> Result<InitialStateTerm, CaseError> {
        // The medium has as many branches as velocities and spins.
        let branches = self.state_components.iter().filter(|c| c.is_velocity()).count();
        let expected =
            format!("a whole number from 1 to {branches} (1 is the branch of highest frequency)");
        let branch = section.read_required_with("branch", &expected, |value| {
            parse_count(value).filter(|branch| *branch <= branches)
        })?;
        let direction_deg = section.read_or_default("direction_deg")?;
        let elevation_deg = match self.dimensions() {
            2 => 0.0,
            _ => section.read_or_default("elevation_deg")?,
        };
        Ok(InitialStateTerm::PlaneWave {
            branch,
            direction_deg,
            elevation_deg,
            wavelength: section.read_required("wavelength")?,
            amplitude: section.read_required("amplitude")?,
        })
    }

    fn read_rotation(&self, section: &SectionReader) -> Result<InitialStateTerm, CaseError> {
        self.check_spin(section, "kind", "a microrotation")?;
        let shape = self.read_shape(section, &RegionShape::WholeGrid)?;
        let angle_deg = section.read_required("angle_deg")?;
        let axis = self.read_rotation_axis(section)?;
        Ok(InitialStateTerm::Rotation { shape, angle_deg, axis })
    }

    /// Reads the rotation axis, numbered from 0; x₃ in plane strain.
    fn read_rotation_axis(&self, section: &SectionReader) -> Result<usize, CaseError> {
        let axis = match self.dimensions() {
            2 => None,
            _ => section.read_optional::<usize>("about")?,
        };
        Ok(axis.map_or(2, |axis| axis - 1))
    }
}
