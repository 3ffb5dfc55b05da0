//! The sections `[output]` and `[[receiver]]` of a solid.

use super::blocks::Blocks;
use super::component::{StateComponent, component_names, components_in_scope};
use super::reader::SolidReader;
use super::snapshot_options::{self, SnapshotOptions};
use super::time;
use crate::error::CaseError;
use crate::receivers::{self, Interpolation, ReceiverDomain, ReceiverPoint, read_receivers};
use crate::schema::{AllowedRange, KeyGroup, KeySchema, SchemaScope, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter, join_with_commas};
use models::interface::parameters::{LayerMaterial, TangentialConstants};
use models::solid::waves::SolidField;
use std::fmt;

/// Builds the key `ledger_interval`, the time between two rows of the energy ledger; `zero` describes the meaning of 0
/// in messages.
pub(crate) const fn new_ledger_interval_key(
    zero: &'static str,
    meaning: &'static str,
) -> KeySchema {
    KeySchema::new_with_default(
        "ledger_interval",
        ValueType::Number(AllowedRange::NotNegative),
        "s",
        "0.0",
        meaning,
    )
    .with_note(zero)
}

/// Key `snapshot_interval`: time between two snapshots.
pub(crate) const SNAPSHOT_INTERVAL_KEY: KeySchema = KeySchema::new_with_default(
    "snapshot_interval",
    ValueType::Number(AllowedRange::NotNegative),
    "s",
    "0.0",
    "time between two snapshots of all fields, for ParaView and the animation; 0: no snapshots",
)
.with_note("0: no snapshots");

/// Key `contours`: contour levels of a picture.
pub(crate) const CONTOURS_KEY: KeySchema = KeySchema::new_optional(
    "contours",
    ValueType::NumberList(0, AllowedRange::Finite),
    "the unit of the picture",
    "[0.01, 0.02]",
    "contour levels; default: ±¼ and ±½ of the largest magnitude for signed fields, otherwise none; []: none",
)
.with_note("contour levels");

/// Schema of the sections `[[receiver]]`.
pub(super) const RECEIVER_SCHEMA: TableSchema = TableSchema::new_list(
    "receiver",
    "receivers: a point, line or grid of points at which the state is recorded",
    &[KeyGroup::new(&[
        receivers::NAME_KEY,
        receivers::new_position_key(
            "point inside the grid",
            "[40.0, 0.0]",
            "point inside the grid or on its boundary",
        ),
        receivers::FIRST_POINT_KEY,
        receivers::LAST_POINT_KEY,
        receivers::POINT_COUNT_KEY,
        KeySchema::new_optional(
            "fields",
            ValueType::AnyOf(|scope| {
                let mut names = component_names(&components_in_scope(scope));
                names.extend(component_names(&StateComponent::CONTACT_COMPONENTS));
                names.extend(integral_names(scope));
                names
            }),
            "",
            "[\"v1\", \"v2\"]",
            "recorded fields; default: all components, and the integrals of [output]",
        ),
        KeySchema::new_with_default(
            "interpolation",
            ValueType::OneOf(|_| time::variant_names(Interpolation::ALL, Interpolation::name)),
            "",
            "\"cubic\"",
            "interpolation between cells: cubic, polynomials of degree 3 along each axis; none, value of the cell that contains the point",
        ),
    ])],
);

/// Schema of the section `[output]`.
pub(super) const OUTPUT_SCHEMA: TableSchema = TableSchema::new_section(
    "output",
    "energy ledger, snapshots and pictures",
    &[KeyGroup::new(&[
        new_ledger_interval_key(
            "0: at most 1000 rows",
            "time between two rows of the energy ledger; 0: at most 1000 rows",
        ),
        SNAPSHOT_INTERVAL_KEY,
        snapshot_options::FIELDS_KEY,
        snapshot_options::PRECISION_KEY,
        snapshot_options::DIGITS_KEY,
        KeySchema::new_optional(
            "integrals",
            ValueType::AnyOf(integral_names),
            "",
            "[]",
            "recorded displacements and rotations (time integrals of velocities and spins), e.g. \"u1\", \"phi3\"; default: none",
        ),
        KeySchema::new_with_default(
            "picture",
            ValueType::OneOf(|scope| {
                let mut names = vec!["speed".to_owned()];
                names.extend(component_names(&components_in_scope(scope)));
                names.extend(component_names(&StateComponent::CONTACT_COMPONENTS));
                names.push("porosity".to_owned());
                names.extend(integral_names(scope));
                names.push("dissipation".to_owned());
                // Joints exist in plane strain only.
                if scope.dimensions != Some(3) {
                    names.extend(FaceQuantity::ALL.map(|own| own.name().to_owned()));
                }
                names
            }),
            "",
            "\"speed\"",
            "plotted quantity: speed, a component, one of integrals, or dissipation; volumetric_strain of a porous medium; pore_closure or porosity of one with spherical contact; slip, opening or pressure of the fluid: of the faces of joints, drawn as lines",
        ),
        CONTOURS_KEY,
    ])],
);

/// Returns the names of all displacements and rotations of a solid.
pub(super) fn integral_names(scope: &SchemaScope) -> Vec<String> {
    components_in_scope(scope).into_iter().filter_map(StateComponent::integral_name).collect()
}

/// A quantity recorded by a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RecordedQuantity {
    /// A component of the state.
    Component(StateComponent),
    /// Time integral of a velocity (displacement) or spin (rotation).
    TimeIntegral(StateComponent),
}

/// Formats the name in case files.
impl fmt::Display for RecordedQuantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Component(component) => component.fmt(formatter),
            Self::TimeIntegral(component) => {
                formatter.write_str(&component.integral_name().unwrap_or_default())
            }
        }
    }
}

/// Output options of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidOutput {
    /// Time between two rows of the energy ledger, s; 0 for at most 1000 rows.
    pub ledger_interval: f64,
    /// Time between two snapshots of all fields, s; 0 for none.
    pub snapshot_interval: f64,
    /// Content of the snapshots.
    pub snapshot_options: SnapshotOptions,
    /// Velocities and spins whose time integrals (displacements, rotations) are stored.
    pub integrated_components: Vec<StateComponent>,
    /// Quantity plotted in pictures.
    pub plotted_quantity: PlottedQuantity,
    /// Contour levels in the unit of the quantity, empty for no contours; `None` for automatic levels.
    pub contour_levels: Option<Vec<f64>>,
}

/// Quantity plotted in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlottedQuantity {
    /// Magnitude of the velocity, m/s.
    #[default]
    Speed,
    /// A component of the state.
    Component(StateComponent),
    /// Time integral of a velocity (displacement) or spin (rotation).
    TimeIntegral(StateComponent),
    /// Porosity of a porous medium.
    Porosity,
    /// Plastic dissipation per unit volume, J/m³.
    Dissipation,
    /// A quantity of the faces of joints, which are drawn as coloured lines.
    Face(FaceQuantity),
}

/// Plotted quantity of the faces of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceQuantity {
    /// Accumulated slip χ, m.
    Slip,
    /// Gap between the blocks, m.
    Opening,
    /// Pressure of the fluid, Pa.
    Pressure,
}

impl FaceQuantity {
    /// All quantities.
    pub const ALL: [Self; 3] = [Self::Slip, Self::Opening, Self::Pressure];

    /// Returns the name of the quantity in case files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::Opening => "opening",
            Self::Pressure => "pressure",
        }
    }

    /// Returns whether faces of a layer have the quantity.
    fn is_in(self, layer: &LayerMaterial) -> bool {
        match (self, layer) {
            (Self::Slip, LayerMaterial::Plastic(..) | LayerMaterial::Breaking(..)) => true,
            (Self::Slip, LayerMaterial::Cracked(_, friction)) => friction.is_some(),
            (Self::Slip, LayerMaterial::Porous(_, _, shear)) => {
                matches!(shear, TangentialConstants::Plastic { .. })
            }
            (Self::Opening, LayerMaterial::Cracked(..) | LayerMaterial::Breaking(..)) => true,
            (Self::Pressure, LayerMaterial::Saturated(_)) => true,
            _ => false,
        }
    }

    /// Returns the kinds of joints whose faces have the quantity, for messages.
    const fn describe_joint_kinds(self) -> &'static str {
        match self {
            Self::Slip => {
                "elastic-plastic, breaking, porous-plastic, or cracked with shear_friction"
            }
            Self::Opening => "cracked, or breaking without fracture = false",
            Self::Pressure => "saturated",
        }
    }
}

impl PlottedQuantity {
    /// Returns the name of the quantity in case files.
    pub fn name(self) -> String {
        match self {
            Self::Speed => "speed".to_owned(),
            Self::Component(component) => component.to_string(),
            Self::TimeIntegral(component) => component.integral_name().unwrap_or_default(),
            Self::Porosity => "porosity".to_owned(),
            Self::Dissipation => "dissipation".to_owned(),
            Self::Face(quantity) => quantity.name().to_owned(),
        }
    }
}

impl SolidOutput {
    /// Formats the section `[output]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let integrals: Vec<String> =
            self.integrated_components.iter().filter_map(|own| own.integral_name()).collect();
        let resolved = TableWriter::default()
            .with_number("ledger_interval", self.ledger_interval)
            .with_number("snapshot_interval", self.snapshot_interval);
        let resolved = self
            .snapshot_options
            .append_to(resolved)
            .with_text_list("integrals", &integrals)
            .with_text("picture", self.plotted_quantity.name());
        let resolved = match &self.contour_levels {
            Some(contours) => resolved.with_number("contours", contours),
            None => resolved,
        };
        resolved.to_section_toml(&OUTPUT_SCHEMA)
    }
}

impl ReceiverPoint<RecordedQuantity> {
    /// Formats the section `[[receiver]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        self.to_table()
            .with_text("interpolation", self.interpolation.name())
            .to_section_toml(&RECEIVER_SCHEMA)
    }
}

impl SolidReader<'_> {
    /// Returns the components that can be recorded: those of the solid, then history variables.
    fn recorded_components(&self) -> impl Iterator<Item = StateComponent> {
        self.state_components.iter().chain(&self.history_components).copied()
    }

    /// Reads the sections `[[receiver]]`; `integrals` are the recorded displacements and rotations.
    pub(super) fn read_receivers(
        &self,
        root: &SectionReader,
        integrals: &[StateComponent],
    ) -> Result<Vec<ReceiverPoint<RecordedQuantity>>, CaseError> {
        let all: Vec<RecordedQuantity> =
            (self.recorded_components().map(RecordedQuantity::Component))
                .chain(integrals.iter().copied().map(RecordedQuantity::TimeIntegral))
                .collect();
        let find = |name: &str| {
            let components: Vec<StateComponent> = self.recorded_components().collect();
            let component = StateComponent::find_by_name(name, self.theory, &components);
            let integral = || all.iter().copied().find(|own| own.to_string() == name);
            component.map(RecordedQuantity::Component).or_else(integral)
        };
        let extents: Vec<[f64; 2]> =
            (0..self.dimensions()).map(|a| self.grid.axis_bounds(a)).collect();
        let domain = ReceiverDomain {
            schema: &RECEIVER_SCHEMA,
            bounds: extents,
            domain: self.grid.position_domain(),
            has_interpolation: true,
        };
        read_receivers(root, &all, find, &domain)
    }

    /// Reads the section `[output]`; `yields` states whether at least one medium yields, `blocks` is the blocky medium.
    pub(super) fn read_output(
        &self,
        root: &SectionReader,
        yields: bool,
        blocks: Option<&Blocks>,
    ) -> Result<SolidOutput, CaseError> {
        let mut output = SolidOutput {
            ledger_interval: 0.0,
            snapshot_interval: 0.0,
            snapshot_options: SnapshotOptions::default(),
            integrated_components: Vec::new(),
            plotted_quantity: PlottedQuantity::Speed,
            contour_levels: None,
        };
        let Some(section) = root.open_section(&OUTPUT_SCHEMA)? else { return Ok(output) };
        output.ledger_interval = section.read_or_default("ledger_interval")?;
        output.snapshot_interval = section.read_or_default("snapshot_interval")?;
        let possible: Vec<(String, StateComponent)> = self
            .state_components
            .iter()
            .filter_map(|component| Some((component.integral_name()?, *component)))
            .collect();
        let names: Vec<String> = possible.iter().map(|own| own.0.clone()).collect();
        let find = |name: &str| possible.iter().find(|own| own.0 == name).map(|own| own.1);
        output.integrated_components =
            section.read_distinct_list("integrals", &names, find)?.unwrap_or_default();
        let mut pictures = vec![PlottedQuantity::Speed];
        pictures.extend(self.recorded_components().map(PlottedQuantity::Component));
        if !self.history_components.is_empty() {
            pictures.push(PlottedQuantity::Porosity);
        }
        if self.has_pore_cones {
            let strain = StateComponent(SolidField::VolumetricStrain);
            pictures.push(PlottedQuantity::Component(strain));
        }
        pictures.extend(
            output.integrated_components.iter().copied().map(PlottedQuantity::TimeIntegral),
        );
        pictures.push(PlottedQuantity::Dissipation);
        if blocks.is_some_and(Blocks::has_joints) {
            pictures.extend(FaceQuantity::ALL.map(PlottedQuantity::Face));
        }
        let names: Vec<String> = pictures.iter().map(|picture| picture.name()).collect();
        if let Some(name) = section.read_optional_text("picture", &names)? {
            let own = pictures.iter().copied().find(|picture| picture.name() == name);
            let component =
                StateComponent::find_by_name(&name, self.theory, &self.state_components);
            let own = own.or(component.map(PlottedQuantity::Component));
            check_face_quantity(&section, &name, blocks)?;
            output.plotted_quantity =
                own.ok_or_else(|| section.unknown_name_error("picture", &name, &names))?;
        }
        if output.plotted_quantity == PlottedQuantity::Dissipation && !yields {
            let allowed = "another picture, or a section [yield]";
            return Err(section.key_error(
                "picture",
                "found 'dissipation' in elastic media",
                allowed,
            ));
        }
        let mut fields = component_names(&self.recorded_components().collect::<Vec<_>>());
        fields.extend(pictures.iter().filter_map(|picture| match picture {
            PlottedQuantity::Speed
            | PlottedQuantity::Face(_)
            | PlottedQuantity::Component(_)
            | PlottedQuantity::Dissipation => None,
            PlottedQuantity::TimeIntegral(_) | PlottedQuantity::Porosity => Some(picture.name()),
        }));
        if self.has_pore_cones {
            fields.push(StateComponent(SolidField::VolumetricStrain).to_string());
        }
        if yields {
            fields.push(PlottedQuantity::Dissipation.name());
        }
        let picture = (output.plotted_quantity, self.dimensions());
        output.snapshot_options = SnapshotOptions::read(&section, &fields, picture)?;
        output.contour_levels = section.read_optional("contours")?;
        if let (PlottedQuantity::Face(quantity), Some(levels)) =
            (output.plotted_quantity, &output.contour_levels)
            && !levels.is_empty()
        {
            let found = format!("found with picture = '{}'", quantity.name());
            let allowed = "leave it out: faces of joints are lines without contours";
            return Err(section.key_error("contours", found, allowed));
        }
        section.finish()?;
        Ok(output)
    }
}

/// Checks that faces of the joints have the quantity `name`, if it is one of joints.
fn check_face_quantity(
    section: &SectionReader,
    name: &str,
    blocks: Option<&Blocks>,
) -> Result<(), CaseError> {
    let Some(quantity) = FaceQuantity::ALL.into_iter().find(|own| own.name() == name) else {
        return Ok(());
    };
    let joints = || {
        let contacts = blocks.into_iter().flat_map(|blocks| &blocks.contacts);
        contacts.filter_map(|contact| blocks?.joints.get(usize::from(contact.joint_index?)))
    };
    if joints().any(|joint| quantity.is_in(&joint.law.material)) {
        return Ok(());
    }
    let mut kinds: Vec<&str> = joints().map(|joint| joint.law.kind.name).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let found = match kinds.is_empty() {
        true => format!("found '{name}', a quantity of joints, in a case without joints"),
        false => format!("found '{name}' with joints of kind {}", join_with_commas(&kinds)),
    };
    let allowed =
        format!("use another quantity, or a joint of kind {}", quantity.describe_joint_kinds());
    Err(section.key_error("picture", found, allowed))
}
