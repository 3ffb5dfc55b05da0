//! The sections `[[load]]`: loads on the boundary faces of the grid.

use super::boundary::{BoundaryFace, FACE_KEY, FaceRectangle, LOWER_CORNER_KEY, UPPER_CORNER_KEY};
use super::component::{StateComponent, component_names, components_in_scope};
use super::profile::{self, LoadProfile};
use super::reader::SolidReader;
use super::source::{KERNEL_KEY, Kernel, RADIUS_KEY};
use super::time_function::{self, TimeFunction};
use crate::error::CaseError;
use crate::schema::{
    AllowedRange, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};

const NO_POINT_CONDITION: &[KeyCondition] = &[KeyCondition::Absent("at")];

/// Schema of the sections `[[load]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "load",
    "boundary load: stress or velocity prescribed on a boundary face; it replaces the boundary condition there; loads on the same component are summed",
    &[
        KeyGroup::new(&[
            FACE_KEY,
            KeySchema::new_required(
                "field",
                ValueType::OneOf(|scope| component_names(&components_in_scope(scope))),
                "",
                "\"sigma22\"",
                "loaded component: stress or couple stress on the face (tension positive), or velocity or spin of the face",
            ),
            KeySchema::new_required(
                "amplitude",
                ValueType::Number(AllowedRange::Finite),
                "m/s, rad/s, Pa or N/m",
                "-1e3",
                "amplitude, multiplied by the time function; for a point load in N or N·m, in plane strain per m of thickness",
            )
            .with_note("amplitude of the time function"),
        ]),
        KeyGroup::with_conditions(NO_POINT_CONDITION, &[LOWER_CORNER_KEY, UPPER_CORNER_KEY]),
        KeyGroup::new(&[KeySchema::new_optional(
            "at",
            ValueType::Numbers(ListLength::FaceAxes),
            "m",
            "0.0",
            "position of a point load: tangential coordinates on the face, two in 3D; replaces from and to",
        )
        .with_note("point on the face")
        .with_conditions(&[KeyCondition::Absent("from"), KeyCondition::Absent("to")])]),
        KeyGroup::with_conditions(&[KeyCondition::Present("at")], &[KERNEL_KEY, RADIUS_KEY]),
        KeyGroup::with_conditions(
            NO_POINT_CONDITION,
            &[KeySchema::new_optional(
                "profile",
                ValueType::Table(&profile::SCHEMA),
                "",
                "{ kind = \"bell\", at = 0.0, radius = 5.0 }",
                "spatial profile along the face; default: 1",
            )],
        ),
        KeyGroup::new(&[time_function::TIME_KEY]),
    ],
);

/// A boundary load.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceLoad {
    /// Boundary face of the grid.
    pub face: BoundaryFace,
    /// Loaded component: a velocity or spin of the face, or a stress or couple stress on it. Stresses are tensor
    /// components, tension-positive on the lower and the upper face.
    pub component: StateComponent,
    /// Amplitude, multiplied by the time function: m/s, rad/s, Pa or N/m. For a point load the integral over the face:
    /// N or N·m, in plane strain per unit thickness.
    pub amplitude: f64,
    /// Loaded part of the face.
    pub loaded_area: LoadedArea,
    /// Spatial profile along the face; `None` for a uniform load and for point loads.
    pub profile: Option<LoadProfile>,
    /// Dimensionless time function that multiplies the amplitude.
    pub time_function: TimeFunction,
}

/// Part of a boundary face on which a load acts.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadedArea {
    /// The whole face.
    WholeFace,
    /// A rectangular part of the face.
    Rectangle(FaceRectangle),
    /// A point load.
    Point {
        /// Coordinates along the tangential axes of the face, m.
        position: Vec<f64>,
        /// Kernel over which the load is distributed.
        kernel: Kernel,
    },
}

impl FaceLoad {
    /// Formats the section `[[load]]` as TOML with all values.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = TableWriter::default()
            .with_text("side", self.face.name())
            .with_text("field", self.component.to_string())
            .with_number("amplitude", self.amplitude);
        let resolved = match &self.loaded_area {
            LoadedArea::WholeFace => resolved,
            LoadedArea::Rectangle(part) => part.write_keys(resolved),
            LoadedArea::Point { position: at, kernel } => {
                kernel.write_keys(resolved.with_number("at", at))
            }
        };
        let resolved = match &self.profile {
            Some(profile) => resolved.with_table("profile", &profile.to_table(dimensions)),
            None => resolved,
        };
        resolved.with_table("time", &self.time_function.to_table()).to_section_toml(&SCHEMA)
    }
}

impl SolidReader<'_> {
    /// Reads all sections `[[load]]`; `periodic` are the periodic faces, which carry no load.
    pub(super) fn read_loads(
        &self,
        root: &SectionReader,
        periodic: &[BoundaryFace],
    ) -> Result<Vec<FaceLoad>, CaseError> {
        let mut loads = Vec::new();
        for mut section in root.open_list(&SCHEMA)? {
            let face = self.read_face(&mut section)?;
            if periodic.contains(&face) {
                let found = format!("found {}, which is periodic", face.name());
                let allowed = "periodic faces carry no load; use [[source]], or load another face";
                return Err(section.key_error("side", found, allowed));
            }
            let among = StateComponent::face_components(self.theory, self.dimensions(), face.axis);
            let field = self.read_component(&section, &among)?;
            let amplitude = section.read_required("amplitude")?;
            let action = self.read_loaded_area(&section, field)?;
            let profile = match action {
                LoadedArea::Point { .. } if section.has_key("profile") => {
                    let allowed = "leave it out: what acts at a point has a kernel; a profile goes \
                                   with from and to, or with all of the side";
                    return Err(section.key_error("profile", "found beside at", allowed));
                }
                LoadedArea::Point { .. } => None,
                _ => LoadProfile::read(&section)?,
            };
            let time = self.read_time_function(&section)?;
            section.finish()?;
            loads.push(FaceLoad {
                face,
                component: field,
                amplitude,
                loaded_area: action,
                profile,
                time_function: time,
            });
        }
        Ok(loads)
    }

    /// Reads the part of the face on which a load of the component `field` acts.
    fn read_loaded_area(
        &self,
        section: &SectionReader,
        field: StateComponent,
    ) -> Result<LoadedArea, CaseError> {
        let part = self.read_rectangle(section)?;
        let at: Option<Vec<f64>> = section.read_optional("at")?;
        let kernel = Kernel::read(section)?;
        match (part, at) {
            (Some(_), Some(_)) => {
                let allowed =
                    "give either at (a point) or from and to (a part of the face), not both";
                Err(section.key_error("at", "found beside from and to", allowed))
            }
            (_, Some(_)) if self.grid.is_polar() => {
                let allowed = "give from and to, the ends of an arc, instead of at";
                Err(section.key_error("at", "found a point load on a polar grid", allowed))
            }
            (_, Some(_)) if field.is_velocity() => {
                let allowed = "give a stress or couple stress, or from and to instead of at";
                Err(section.key_error("at", format!("found for the velocity {field}"), allowed))
            }
            (None, Some(at)) => {
                self.check_position(section, &at, &section.scope.face_axes)?;
                Ok(LoadedArea::Point { position: at, kernel: kernel.unwrap_or_default() })
            }
            (_, None) if kernel.is_some() => {
                let key = if section.has_key("radius") { "radius" } else { "kernel" };
                let allowed = "add at, the centre of the kernel, or leave it out";
                Err(section.key_error(key, "found without at", allowed))
            }
            (Some(part), None) => Ok(LoadedArea::Rectangle(part)),
            (None, None) => Ok(LoadedArea::WholeFace),
        }
    }
}
