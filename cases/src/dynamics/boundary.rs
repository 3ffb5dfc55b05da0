//! The sections `[[boundary]]`: boundary conditions on the faces of the grid.

use super::component::{StateComponent, component_names, components_in_scope};
use super::reader::SolidReader;
use crate::error::CaseError;
use crate::position_checks::check_order;
use crate::schema::{
    KeyCondition as When, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter, join_with_commas};

/// Key `side`: name of a boundary face of the grid.
pub(super) const FACE_KEY: KeySchema = KeySchema::new_required(
    "side",
    ValueType::OneOf(|scope| {
        let dimensions = scope.dimensions.unwrap_or(3);
        BoundaryFace::all_faces(dimensions).into_iter().map(BoundaryFace::name).collect()
    }),
    "",
    "\"x2+\"",
    "the side: the axis of its normal, and at which end",
);

const CORNER_TYPE: ValueType = ValueType::Numbers(ListLength::FaceAxes);

/// Key `from`: lower corner of a rectangular part of a face.
pub(super) const LOWER_CORNER_KEY: KeySchema = KeySchema::new_optional(
    "from",
    CORNER_TYPE,
    "m",
    "-5.0",
    "with to: a part of the side, of which this is the first end, which is in it; in space two numbers; default all of it",
)
.with_note("an end of the part");

/// Key `to`: upper corner of a rectangular part of a face.
pub(super) const UPPER_CORNER_KEY: KeySchema = KeySchema::new_optional(
    "to",
    CORNER_TYPE,
    "m",
    "5.0",
    "last end of the part, which is not in it",
)
.with_note("an end of the part");

/// Schema of the sections `[[boundary]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "boundary",
    "boundary condition on a side of the grid; sides without an entry are traction-free, and later entries override earlier ones",
    &[
        KeyGroup::new(&[
            FACE_KEY,
            KeySchema::new_required(
                "kind",
                ValueType::OneOf(|_| BoundaryConditionKind::NAMES.map(str::to_owned).to_vec()),
                "",
                "\"non-reflecting\"",
                "free: no traction; fixed: no velocity; symmetry, antisymmetry: a mirror plane; periodic: joined to the opposite side; non-reflecting: waves along the normal leave; mixed: fixed components",
            ),
        ]),
        KeyGroup::with_conditions(
            &[When::HasValue("kind", &["mixed"])],
            &[KeySchema::new_required(
                "fixed_components",
                ValueType::AnyOf(|scope| {
                    let mut all = components_in_scope(scope);
                    all.retain(|component| component.is_velocity());
                    component_names(&all)
                }),
                "",
                "[\"v2\"]",
                "velocities and spins that vanish; the tractions and couples of the others do",
            )
            .with_former_name("held")],
        ),
        KeyGroup::with_conditions(
            &[When::HasValue(
                "kind",
                &["free", "fixed", "symmetry", "antisymmetry", "non-reflecting", "mixed"],
            )],
            &[LOWER_CORNER_KEY, UPPER_CORNER_KEY],
        ),
    ],
)
.with_former_name("side");

/// A boundary face of the grid, normal to an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BoundaryFace {
    /// Axis of the normal, numbered from 0.
    pub axis: usize,
    /// Whether the face is at the upper end of the axis.
    pub is_upper: bool,
}

impl BoundaryFace {
    /// Returns all boundary faces of a grid in 2 or 3 dimensions.
    pub fn all_faces(dimensions: usize) -> Vec<Self> {
        let both = |axis| [false, true].map(|is_upper| Self { axis, is_upper });
        (0..dimensions).flat_map(both).collect()
    }

    /// Returns the name in case files, e.g. `x1-`.
    pub fn name(self) -> String {
        format!("x{}{}", self.axis + 1, if self.is_upper { '+' } else { '-' })
    }

    /// Returns the opposite face.
    pub fn opposite_face(self) -> Self {
        Self { is_upper: !self.is_upper, ..self }
    }

    /// Returns the tangential axes of the face, ascending; positions on the face are given along these axes.
    pub fn tangential_axes(self, dimensions: usize) -> Vec<usize> {
        (0..dimensions).filter(|&axis| axis != self.axis).collect()
    }
}

/// A rectangular part of a boundary face: lower corner ≤ x < upper corner along each tangential axis.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceRectangle {
    /// Lower coordinates along the tangential axes, m.
    pub lower_corner: Vec<f64>,
    /// Upper coordinates along the tangential axes, m.
    pub upper_corner: Vec<f64>,
}

impl FaceRectangle {
    /// Returns whether the rectangle contains a position on the face, given by its tangential coordinates, m.
    pub fn contains(&self, position: &[f64]) -> bool {
        let ends = self.lower_corner.iter().zip(&self.upper_corner);
        position.iter().zip(ends).all(|(x, (from, to))| (from..to).contains(&x))
    }

    /// Adds the keys `from` and `to` of the rectangle to a table.
    pub(super) fn write_keys(&self, resolved: TableWriter) -> TableWriter {
        resolved.with_number("from", &self.lower_corner).with_number("to", &self.upper_corner)
    }
}

/// Boundary condition on a face or on a rectangular part of a face. Faces without a condition are traction-free; where
/// entries overlap, the last one applies.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceCondition {
    /// Boundary face of the grid.
    pub face: BoundaryFace,
    /// Boundary condition.
    pub condition: BoundaryConditionKind,
    /// Rectangular part of the face; `None` for the whole face.
    pub rectangle: Option<FaceRectangle>,
}

/// Boundary condition.
#[derive(Clone, Debug, PartialEq)]
pub enum BoundaryConditionKind {
    /// Traction-free: zero traction and couple traction.
    Free,
    /// Fixed: zero velocity and spin.
    Fixed,
    /// Mirror symmetry: the normal velocity, the tangential spins, and the tractions and couple tractions of all other
    /// components are zero.
    Symmetry,
    /// Mirror antisymmetry: the tangential velocities, the normal spin, and the tractions and couple tractions of all
    /// other components are zero.
    Antisymmetry,
    /// Periodic: connected to the opposite face.
    Periodic,
    /// Non-reflecting: waves along the normal leave the grid without reflection.
    NonReflecting,
    /// Mixed: the velocities and spins in `fixed_components` are zero; for all other components the traction or couple
    /// traction is zero.
    Mixed {
        /// Velocities and spins that are zero.
        fixed_components: Vec<StateComponent>,
    },
}

impl BoundaryConditionKind {
    /// Names of all boundary conditions in case files.
    pub const NAMES: [&str; 7] =
        ["free", "fixed", "symmetry", "antisymmetry", "periodic", "non-reflecting", "mixed"];

    /// Returns the name of the boundary condition in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Fixed => "fixed",
            Self::Symmetry => "symmetry",
            Self::Antisymmetry => "antisymmetry",
            Self::Periodic => "periodic",
            Self::NonReflecting => "non-reflecting",
            Self::Mixed { .. } => "mixed",
        }
    }
}

/// Returns the faces whose last condition on the whole face is periodic, each with the index of this condition in the
/// list.
pub(super) fn periodic_faces(
    conditions: &[FaceCondition],
) -> impl Iterator<Item = (usize, BoundaryFace)> {
    let is_last_whole = |index: usize, face: BoundaryFace| {
        !conditions[index + 1..].iter().any(|later| later.face == face && later.rectangle.is_none())
    };
    conditions
        .iter()
        .enumerate()
        .filter(move |(index, entry)| {
            entry.condition == BoundaryConditionKind::Periodic && is_last_whole(*index, entry.face)
        })
        .map(|(index, entry)| (index, entry.face))
}

impl FaceCondition {
    /// Formats the section `[[boundary]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let mut resolved = TableWriter::default()
            .with_text("side", self.face.name())
            .with_text("kind", self.condition.name());
        if let BoundaryConditionKind::Mixed { fixed_components } = &self.condition {
            resolved = resolved.with_text_list("fixed_components", fixed_components);
        }
        let resolved = match &self.rectangle {
            Some(part) => part.write_keys(resolved),
            None => resolved,
        };
        resolved.to_section_toml(&SCHEMA)
    }
}

impl SolidReader<'_> {
    /// Reads the boundary face of an entry and sets `face_axes` of its scope: positions in the entry are given along
    /// the tangential axes of the face.
    pub(super) fn read_face(&self, section: &mut SectionReader) -> Result<BoundaryFace, CaseError> {
        let face = section.read_choice(
            "side",
            &BoundaryFace::all_faces(self.dimensions()),
            BoundaryFace::name,
        )?;
        section.scope.face_axes = face.tangential_axes(self.dimensions());
        Ok(face)
    }

    /// Reads the rectangular part of a face between the keys `from` and `to`; `None` if both are absent, an error if
    /// one is.
    pub(super) fn read_rectangle(
        &self,
        section: &SectionReader,
    ) -> Result<Option<FaceRectangle>, CaseError> {
        let (from, to): (Option<Vec<f64>>, _) =
            (section.read_optional("from")?, section.read_optional::<Vec<f64>>("to")?);
        match (from, to) {
            (Some(from), Some(to)) => {
                check_order(section, &from, &to)?;
                Ok(Some(FaceRectangle { lower_corner: from, upper_corner: to }))
            }
            (None, None) => Ok(None),
            (from, _) => {
                let absent = if from.is_none() { "from" } else { "to" };
                Err(section.key_error(absent, "missing", "give both ends of a part, from and to"))
            }
        }
    }

    /// Reads all sections `[[boundary]]`.
    pub(super) fn read_boundary_conditions(
        &self,
        root: &SectionReader,
    ) -> Result<Vec<FaceCondition>, CaseError> {
        let mut conditions = Vec::new();
        for mut section in root.open_list(&SCHEMA)? {
            let face = self.read_face(&mut section)?;
            let condition =
                match section.read_choice("kind", &BoundaryConditionKind::NAMES, |name| name)? {
                    "free" => BoundaryConditionKind::Free,
                    "fixed" => BoundaryConditionKind::Fixed,
                    "symmetry" => BoundaryConditionKind::Symmetry,
                    "antisymmetry" => BoundaryConditionKind::Antisymmetry,
                    "periodic" => BoundaryConditionKind::Periodic,
                    "non-reflecting" => BoundaryConditionKind::NonReflecting,
                    _ => BoundaryConditionKind::Mixed {
                        fixed_components: self.read_fixed_components(&section, face)?,
                    },
                };
            let part = match condition {
                BoundaryConditionKind::Periodic => None,
                _ => self.read_rectangle(&section)?,
            };
            let is_periodic = condition == BoundaryConditionKind::Periodic;
            if self.grid.is_circle() && face.axis == 0 && !is_periodic {
                let found = format!("found {} on a polar grid of the whole circle", face.name());
                let allowed = "leave it out: this side is joined to the opposite one; a sector, with \
                               angles_deg of less than 360 degrees, has conditions there";
                return Err(section.key_error("side", found, allowed));
            }
            if self.grid.is_polar() && face.axis == 1 && is_periodic {
                let found = format!("found periodic on {}, a circle of a polar grid", face.name());
                let allowed = "expected another condition: the two circles are not joined";
                return Err(section.key_error("kind", found, allowed));
            }
            section.finish()?;
            // Added below for the whole circle.
            if !(self.grid.is_circle() && is_periodic) {
                conditions.push(FaceCondition { face, condition, rectangle: part });
            }
        }
        let given = conditions.len();
        if self.grid.is_circle() {
            let periodic = |is_upper| FaceCondition {
                face: BoundaryFace { axis: 0, is_upper },
                condition: BoundaryConditionKind::Periodic,
                rectangle: None,
            };
            conditions.extend([false, true].map(periodic));
        }
        let periodic: Vec<(usize, BoundaryFace)> = periodic_faces(&conditions).collect();
        let is_periodic = |face: BoundaryFace| periodic.iter().any(|(_, own)| *own == face);
        for (index, face) in periodic.iter().filter(|(index, _)| *index < given) {
            let (own, across) = (face.name(), face.opposite_face().name());
            if !is_periodic(face.opposite_face()) {
                let found = format!("found periodic on {own} alone");
                let allowed =
                    format!("add [[boundary]] with side = \"{across}\", kind = \"periodic\"");
                return Err(root.key_error(&format!("boundary[{index}].kind"), found, allowed));
            }
        }
        let is_part = |entry: &FaceCondition| entry.rectangle.is_some() && is_periodic(entry.face);
        if let Some(index) = conditions.iter().position(is_part) {
            let found =
                format!("found a part of {}, which is periodic", conditions[index].face.name());
            let allowed = "leave the part out: a side is periodic as a whole";
            return Err(root.key_error(&format!("boundary[{index}].side"), found, allowed));
        }
        Ok(conditions)
    }

    /// Reads the velocities and spins that are zero on a mixed face.
    fn read_fixed_components(
        &self,
        section: &SectionReader,
        face: BoundaryFace,
    ) -> Result<Vec<StateComponent>, CaseError> {
        let mut among = StateComponent::face_components(self.theory, self.dimensions(), face.axis);
        among.retain(|component| component.is_velocity());
        let names = component_names(&among);
        let find = |name: &str| StateComponent::find_by_name(name, self.theory, &among);
        section.read_distinct_list("fixed_components", &names, find)?.ok_or_else(|| {
            let allowed =
                format!("add fixed_components, a list with any of {}", join_with_commas(&names));
            section.key_error("fixed_components", "missing", allowed)
        })
    }
}
