//! The sections `[[joint]]`: layers between the blocks of a blocky medium.

use super::block::{BlockTiling, round_coordinate};
use super::grid::SolidGrid;
use super::joint_checks::{check_foreign_keys, constant_error, layer_end_name, read_open_ends};
use super::joint_keys as groups;
use super::reader::SolidReader;
use super::shape::{RegionShape, SHAPE_KEYS};
use super::tiling::BlockContact;
use crate::error::CaseError;
use crate::schema::{KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter, join_with_commas};
use models::common::decimal::ToPlainText;
use models::common::parameter::Presence;
use models::interface::kinds::{
    LayerKind, MASS_OPTION, NORMAL_COMPONENT_NAMES, TANGENTIAL_COMPONENT_NAMES,
};
use models::interface::parameters::{LayerMaterial, MassDistribution};
use models::registry;

/// Maximum number of joints of a case.
pub const MAX_JOINTS: usize = u16::MAX as usize;

/// Minimum number of cells of a block along an axis with joints.
const MIN_CELLS_WITH_JOINTS: usize = 3;

/// Tolerance for the distance of a point from the plane of a face, relative to the spacing.
const POINT_TOLERANCE: f64 = 1e-6;

/// Allowed values of the key `every`, and whether each selects faces normal to x₁ and to x₂.
const AXIS_SELECTIONS: [(&str, [bool; 2]); 3] =
    [("x1", [true, false]), ("x2", [false, true]), ("all", [true, true])];

const EVERY_KEY_TYPE: ValueType =
    ValueType::OneOf(|_| AXIS_SELECTIONS.iter().map(|(word, _)| (*word).to_owned()).collect());
const EVERY_KEY_MEANING: &str = "all faces between blocks normal to this axis, or all; with inside those whose centre is in the shape";

/// Schema of the value of `inside`.
const INSIDE_SCHEMA: TableSchema = TableSchema::new_inline_table(
    "inside",
    "shape that selects the faces between blocks",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "shape",
            ValueType::OneOf(|scope| {
                RegionShape::allowed_names_in_scope(scope.dimensions, &RegionShape::WholeGrid)
            }),
            "",
            "\"box\"",
            "shape, with the keys of [[region]]; everywhere: the whole grid",
        )]),
        KeyGroup::new(SHAPE_KEYS),
    ],
);

/// Schema of the sections `[[joint]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "joint",
    "thin layer with mass between blocks, selected by every, between, inside or at; the faces of a layer coincide; of several entries for one face the last one applies; blocks without a joint are welded",
    &[
        KeyGroup::new(&[
            KeySchema::new_required("every", EVERY_KEY_TYPE, "", "\"all\"", EVERY_KEY_MEANING)
                .with_note("or give between, inside or at")
                .with_conditions(&[
                    KeyCondition::Absent("between"),
                    KeyCondition::Absent("inside"),
                    KeyCondition::Absent("at"),
                ]),
            KeySchema::new_optional("every", EVERY_KEY_TYPE, "", "\"all\"", EVERY_KEY_MEANING)
                .with_conditions(&[
                    KeyCondition::Present("inside"),
                    KeyCondition::Absent("between"),
                    KeyCondition::Absent("at"),
                ]),
            KeySchema::new_optional(
                "between",
                ValueType::TextList,
                "",
                "[\"rock\", \"rock\"]",
                "all faces between blocks of these two names",
            )
            .with_note("names of two blocks")
            .with_conditions(&[KeyCondition::Absent("inside"), KeyCondition::Absent("at")]),
            KeySchema::new_optional(
                "inside",
                ValueType::Table(&INSIDE_SCHEMA),
                "",
                "{ shape = \"circle\", center = [0.25, 0.25], radius = 0.1 }",
                "all common faces of two blocks whose centre is in the shape",
            ),
            KeySchema::new_optional(
                "at",
                ValueType::Numbers(ListLength::Two),
                "m",
                "[0.05, 0.025]",
                "the common face of two blocks that contains this point",
            )
            .with_note("a point on the common face of two blocks")
            .with_conditions(&[KeyCondition::Absent("inside")]),
            KeySchema::new_required(
                "kind",
                ValueType::OneOf(|_| {
                    registry::LAYERS.iter().map(|layer| layer.name.to_owned()).collect()
                }),
                "",
                "\"elastic\"",
                "law of the layer",
            )
            .with_note("or give normal and tangential")
            .with_conditions(&[KeyCondition::Absent("normal")]),
            KeySchema::new_optional(
                "normal",
                ValueType::OneOf(|_| NORMAL_COMPONENT_NAMES.map(str::to_owned).to_vec()),
                "",
                "\"porous\"",
                "law of the normal component; replaces kind",
            ),
            KeySchema::new_required(
                "tangential",
                ValueType::OneOf(|_| TANGENTIAL_COMPONENT_NAMES.map(str::to_owned).to_vec()),
                "",
                "\"viscous\"",
                "law of the tangential component",
            )
            .with_conditions(&[KeyCondition::Present("normal")]),
            groups::THICKNESS_KEY,
        ]),
        groups::ELASTIC_GROUP,
        groups::PLASTIC_GROUP,
        groups::FRICTION_GROUP,
        groups::CONTACT_FRICTION_GROUP,
        groups::VISCOUS_GROUP,
        groups::PORES_GROUP,
        groups::SATURATED_GROUP,
        groups::BREAKING_GROUP,
        groups::COMPONENTS_GROUP,
        groups::POROUS_COMPONENT_GROUP,
        groups::VISCOUS_COMPONENT_GROUP,
        groups::PLASTIC_COMPONENT_GROUP,
        groups::FRICTION_COMPONENT_GROUP,
        KeyGroup::new(&[KeySchema::new_with_default(
            MASS_OPTION.name,
            ValueType::OneOf(|_| {
                MASS_OPTION.allowed_values.iter().map(|word| (*word).to_owned()).collect()
            }),
            "",
            "\"box\"",
            MASS_OPTION.meaning,
        )]),
    ],
);

/// Selector of the faces between blocks on which a joint lies.
#[derive(Clone, Debug, PartialEq)]
pub enum JointSelector {
    /// Faces normal to one or both axes; with a shape only those whose centre is inside it.
    FacesNormalTo {
        /// Whether faces normal to each axis are selected.
        axes: [bool; 2],
        /// Shape inside which the centres of the faces lie; `None` for no restriction.
        inside: Option<RegionShape>,
    },
    /// Faces between blocks of these two names.
    BetweenNamedBlocks([String; 2]),
    /// The face that contains a point, m.
    FaceContaining([f64; 2]),
}

/// Law of a joint: kind of layer, constants and options.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLaw {
    /// Kind of layer.
    pub kind: LayerKind,
    /// Constants in the order of the registry entry of the kind, in SI units; `None` if absent.
    pub constants: Vec<Option<f64>>,
    /// Distribution of the mass of the layer.
    pub mass: MassDistribution,
    /// Whether a breaking layer breaks; true for other kinds.
    pub fracture: bool,
    /// Whether the fluid of a saturated layer flows out freely where the layer ends at a boundary of the domain; false for
    /// other kinds.
    pub has_open_ends: bool,
    /// Constants of the layer, checked, with the options applied.
    pub material: LayerMaterial,
}

/// A section `[[joint]]`: a law and the faces to which it applies.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEntry {
    /// Selector of the faces.
    pub selector: JointSelector,
    /// Law of the layer.
    pub law: JointLaw,
}

impl JointLaw {
    fn read(section: &SectionReader) -> Result<Self, CaseError> {
        if section.has_key("normal") && section.has_key("kind") {
            let found = format!("found beside kind ({})", section.locate("kind"));
            let allowed = "give either kind, or normal and tangential";
            return Err(section.key_error("normal", found, allowed));
        }
        let normal =
            section.read_optional_choice("normal", &NORMAL_COMPONENT_NAMES, |word| word)?;
        let kind = match normal {
            Some(normal) => {
                let tangential =
                    section.read_choice("tangential", &TANGENTIAL_COMPONENT_NAMES, |word| word)?;
                registry::find_layer_by_components(normal, tangential).ok_or_else(|| {
                    let found = format!("found '{tangential}' with normal = '{normal}'");
                    section.key_error("tangential", found, "no layer has these components")
                })?
            }
            None => section.read_choice("kind", &registry::LAYERS, |layer| layer.name)?,
        };
        check_foreign_keys(section, kind)?;
        let mut constants = Vec::new();
        for own in kind.parameters {
            constants.push(match own.presence {
                Presence::Required(_) => Some(section.read_required::<f64>(own.name)?),
                Presence::Default(_) => Some(section.read_or_default(own.name)?),
                Presence::Optional => section.read_optional(own.name)?,
            });
        }
        let masses = [MassDistribution::Box, MassDistribution::Lumped];
        let mass =
            section.read_optional_choice(MASS_OPTION.name, &masses, mass_distribution_name)?;
        let fracture = match kind.name {
            "breaking" => section.read_or_default("fracture")?,
            _ => true,
        };
        let given: Vec<f64> = constants.iter().map(|own| own.unwrap_or(f64::NAN)).collect();
        let material =
            kind.build(&given).map_err(|error| constant_error(section, kind, &constants, error))?;
        let material = if fracture { material } else { material.without_fracture() };
        let has_open_ends = read_open_ends(section)?;
        let mass = mass.unwrap_or_default();
        Ok(Self { kind, constants, mass, fracture, has_open_ends, material })
    }

    fn write_keys(&self, table: TableWriter) -> TableWriter {
        let table = table.with_text("kind", self.kind.name);
        let constants = self.kind.parameters.iter().zip(&self.constants);
        let constants = constants.filter_map(|(own, value)| Some((own.name, (*value)?)));
        let table = constants.fold(table, |table, (name, value)| table.with_number(name, value));
        let table = table.with_text(MASS_OPTION.name, mass_distribution_name(self.mass));
        match self.kind.name {
            "breaking" => table.with_number("fracture", self.fracture),
            "saturated" => table.with_text(groups::LAYER_ENDS, layer_end_name(self.has_open_ends)),
            _ => table,
        }
    }
}

/// Returns the name of a distribution of mass in case files.
const fn mass_distribution_name(mass: MassDistribution) -> &'static str {
    match mass {
        MassDistribution::Box => "box",
        MassDistribution::Lumped => "lumped",
    }
}

impl JointSelector {
    fn read(reader: &SolidReader, section: &SectionReader) -> Result<Self, CaseError> {
        let given: Vec<&str> = ["every", "between", "inside", "at"]
            .into_iter()
            .filter(|key| section.has_key(key))
            .collect();
        match given[..] {
            [] | [_] | ["every", "inside"] => {}
            [first, .., last] => {
                let found = format!("found beside {first} ({})", section.locate(first));
                let allowed = "select the faces by one of every, between, inside, at, or by \
                               every and inside";
                return Err(section.key_error(last, found, allowed));
            }
        }
        if let Some(at) = section.read_optional::<Vec<f64>>("at")? {
            reader.check_position(section, &at, &[0, 1])?;
            return Ok(Self::FaceContaining([at[0], at[1]]));
        }
        if let Some(names) = section.read_optional::<Vec<String>>("between")? {
            let count = names.len();
            let names: Result<[String; 2], _> = names.try_into();
            return names.map(Self::BetweenNamedBlocks).map_err(|_| {
                let found = format!("found {count} names");
                section.key_error("between", found, "expected the names of two blocks")
            });
        }
        let inside = match section.open_table("inside")? {
            Some(table) => {
                let shape = reader.read_shape(&table, &RegionShape::WholeGrid)?;
                table.finish()?;
                Some(shape)
            }
            None => None,
        };
        let every = section.read_optional_choice("every", &AXIS_SELECTIONS, |(word, _)| word)?;
        if every.is_none() && inside.is_none() {
            let allowed = "select the faces: add every = \"x1\", \"x2\" or \"all\", or between, \
                           inside or at";
            return Err(section.key_error("every", "missing", allowed));
        }
        Ok(Self::FacesNormalTo { axes: every.map_or([true; 2], |(_, axes)| axes), inside })
    }

    fn write_keys(&self, table: TableWriter) -> TableWriter {
        match self {
            Self::FacesNormalTo { axes, inside } => {
                let word = AXIS_SELECTIONS.iter().find(|(_, own)| own == axes);
                let table = table.with_text("every", word.map_or("all", |(word, _)| word));
                match inside {
                    Some(shape) => {
                        table.with_table("inside", &shape.write_keys(TableWriter::default(), 2))
                    }
                    None => table,
                }
            }
            Self::BetweenNamedBlocks([one, other]) => {
                table.with_text_list("between", &[one, other])
            }
            Self::FaceContaining(at) => table.with_number("at", at),
        }
    }

    /// Returns whether the selector selects the common face `contact` of two blocks.
    fn selects(&self, contact: &BlockContact, grid: &SolidGrid, tiling: &BlockTiling) -> bool {
        match self {
            Self::FacesNormalTo { axes, inside } => {
                axes[contact.axis]
                    && inside
                        .as_ref()
                        .is_none_or(|shape| shape.contains(&contact_centre(contact, grid)))
            }
            Self::BetweenNamedBlocks([one, other]) => {
                let [below, above] = contact.block_indices.map(|block| tiling.block_name(block));
                let (one, other) = (Some(one.as_str()), Some(other.as_str()));
                (below == one && above == other) || (below == other && above == one)
            }
            Self::FaceContaining(point) => {
                let (axis, other) = (contact.axis, 1 - contact.axis);
                let tolerance = [0, 1].map(|axis| POINT_TOLERANCE * grid.spacing[axis]);
                let plane = lower_edge(grid, axis, contact.plane_index);
                let [from, to] = [contact.tangential_cells.start, contact.tangential_cells.end];
                (point[axis] - plane).abs() <= tolerance[axis]
                    && point[other] >= lower_edge(grid, other, from) - tolerance[other]
                    && point[other] <= lower_edge(grid, other, to) + tolerance[other]
            }
        }
    }
}

/// Returns the coordinate of the lower edge of a cell along an axis, m.
fn lower_edge(grid: &SolidGrid, axis: usize, cell: usize) -> f64 {
    grid.origin[axis] + cell as f64 * grid.spacing[axis]
}

/// Returns the centre of the common face `contact` of two blocks, m.
fn contact_centre(contact: &BlockContact, grid: &SolidGrid) -> [f64; 2] {
    let (axis, other) = (contact.axis, 1 - contact.axis);
    let middle = 0.5 * (contact.tangential_cells.start + contact.tangential_cells.end) as f64;
    let mut point = [0.0; 2];
    point[axis] = lower_edge(grid, axis, contact.plane_index);
    point[other] = grid.origin[other] + middle * grid.spacing[other];
    point
}

impl JointEntry {
    /// Formats the section `[[joint]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let table = self.selector.write_keys(TableWriter::default());
        self.law.write_keys(table).to_section_toml(&SCHEMA)
    }
}

impl SolidReader<'_> {
    /// Reads the sections `[[joint]]` and assigns the joints to the faces between blocks in `tiling`.
    pub(super) fn read_joints(
        &self,
        root: &SectionReader,
        tiling: &mut BlockTiling,
    ) -> Result<Vec<JointEntry>, CaseError> {
        let sections = root.open_list(&SCHEMA)?;
        if sections.len() > MAX_JOINTS {
            let found = format!("{} joints", sections.len());
            return Err(root.key_error("joint", found, format!("expected at most {MAX_JOINTS}")));
        }
        let mut entries = Vec::new();
        for (index, section) in sections.into_iter().enumerate() {
            let selector = JointSelector::read(self, &section)?;
            if let JointSelector::BetweenNamedBlocks(names) = &selector {
                check_names(&section, names, tiling)?;
            }
            let law = JointLaw::read(&section)?;
            assign_joint(&selector, self.grid, tiling, &section, index)?;
            section.finish()?;
            entries.push(JointEntry { selector, law });
        }
        self.check_block_lengths(root, tiling)?;
        Ok(entries)
    }

    /// Checks that blocks with joints normal to an axis have at least [`MIN_CELLS_WITH_JOINTS`] cells along it.
    fn check_block_lengths(
        &self,
        root: &SectionReader,
        tiling: &BlockTiling,
    ) -> Result<(), CaseError> {
        for contact in &tiling.contacts {
            let Some(joint) = contact.joint_index else { continue };
            for block in contact.block_indices {
                let length = tiling.blocks[block].cells[contact.axis].len();
                if length >= MIN_CELLS_WITH_JOINTS {
                    continue;
                }
                let entry = tiling.blocks[block].entry_index;
                let is_part = length < tiling.entries[entry].cells[contact.axis];
                let name = if is_part { "row_shift" } else { "cells" };
                let at = contact_centre(contact, self.grid).map(round_coordinate);
                let found = format!(
                    "a {} of {length} cells along x{} beside the joint at {} (joint[{joint}], {})",
                    if is_part { "part of a block" } else { "block" },
                    contact.axis + 1,
                    at.to_plain_text(),
                    root.locate(&format!("joint[{joint}]")),
                );
                let allowed = format!(
                    "expected at least {MIN_CELLS_WITH_JOINTS} cells between joints, and between a \
                     joint and the boundary"
                );
                return Err(root.key_error(&format!("block[{entry}].{name}"), found, allowed));
            }
        }
        Ok(())
    }
}

/// Checks that blocks of both names given by the key `between` exist.
fn check_names(
    section: &SectionReader,
    names: &[String; 2],
    tiling: &BlockTiling,
) -> Result<(), CaseError> {
    let mut known: Vec<&str> = Vec::new();
    for name in tiling.entries.iter().filter_map(|entry| entry.name.as_deref()) {
        if !known.contains(&name) {
            known.push(name);
        }
    }
    match names.iter().find(|name| !known.contains(&name.as_str())) {
        Some(name) if known.is_empty() => {
            let allowed = "no block has a name: add name = \"...\" to [[block]]";
            Err(section.key_error("between", format!("found '{name}'"), allowed))
        }
        Some(name) => Err(section.unknown_name_error("between", name, &known)),
        None => Ok(()),
    }
}

/// Assigns the joint with the index `index` to the faces between blocks that the selector selects.
fn assign_joint(
    selector: &JointSelector,
    grid: &SolidGrid,
    tiling: &mut BlockTiling,
    section: &SectionReader,
    index: usize,
) -> Result<(), CaseError> {
    let mut contacts = std::mem::take(&mut tiling.contacts);
    let mut count = 0;
    for contact in &mut contacts {
        if selector.selects(contact, grid, tiling) {
            contact.joint_index = Some(index as u16); // fits u16: at most MAX_JOINTS joints are read
            count += 1;
        }
    }
    tiling.contacts = contacts;
    match (count, selector) {
        (0, _) => Err(no_face_error(selector, grid, tiling, section)),
        (2.., JointSelector::FaceContaining(at)) => {
            let found = format!(
                "found {at}, a point of {count} faces between blocks",
                at = at.to_plain_text()
            );
            Err(section.key_error("at", found, "name a point inside one face, not at its end"))
        }
        _ => Ok(()),
    }
}

/// Builds the error of a selector that selects no face.
fn no_face_error(
    selector: &JointSelector,
    grid: &SolidGrid,
    tiling: &BlockTiling,
    section: &SectionReader,
) -> CaseError {
    if tiling.contacts.is_empty() {
        let key = ["every", "between", "inside", "at"].into_iter().find(|key| section.has_key(key));
        let allowed = "there is only one block: give it repeat, add blocks, or leave the joint out";
        return section.key_error(key.unwrap_or("every"), "a joint without neighbours", allowed);
    }
    let planes = [0, 1].map(|axis| describe_planes(axis, grid, tiling)).join("; ");
    match selector {
        JointSelector::FacesNormalTo { inside: None, axes } => {
            let axis = if axes[0] { "x1" } else { "x2" };
            let found = format!("no two blocks are neighbours along {axis}");
            section.key_error("every", found, format!("faces between blocks: {planes}"))
        }
        JointSelector::FacesNormalTo { .. } => {
            let found = "no face between two blocks has its centre in the shape";
            section.key_error("inside", found, format!("faces between blocks: {planes}"))
        }
        JointSelector::BetweenNamedBlocks([one, other]) => {
            let found = format!("no block '{one}' is a neighbour of a block '{other}'");
            let allowed = format!("neighbours with names: {}", describe_neighbours(tiling));
            section.key_error("between", found, allowed)
        }
        JointSelector::FaceContaining(at) => {
            let found = format!(
                "found {at}, a point on no face between two blocks",
                at = at.to_plain_text()
            );
            section.key_error("at", found, format!("faces between blocks: {planes}"))
        }
    }
}

/// Maximum number of planes or pairs of names listed in messages.
const MAX_LISTED_ITEMS: usize = 8;

/// Lists the planes of the faces between blocks normal to an axis, for messages.
fn describe_planes(axis: usize, grid: &SolidGrid, tiling: &BlockTiling) -> String {
    let own = tiling.contacts.iter().filter(|contact| contact.axis == axis);
    let planes: std::collections::BTreeSet<usize> =
        own.map(|contact| contact.plane_index).collect();
    let mut descriptions: Vec<String> = planes
        .iter()
        .take(MAX_LISTED_ITEMS)
        .map(|plane| round_coordinate(lower_edge(grid, axis, *plane)).to_plain_text())
        .collect();
    if planes.len() > MAX_LISTED_ITEMS {
        descriptions.push("…".to_owned());
    }
    match descriptions.is_empty() {
        true => format!("none normal to x{}", axis + 1),
        false => format!("normal to x{0} at x{0} = {1}", axis + 1, join_with_commas(&descriptions)),
    }
}

/// Lists the pairs of names of neighbouring blocks, for messages.
fn describe_neighbours(tiling: &BlockTiling) -> String {
    let mut pairs = std::collections::BTreeSet::new();
    for contact in &tiling.contacts {
        let names = contact.block_indices.map(|block| tiling.block_name(block));
        if let [Some(one), Some(other)] = names {
            pairs.insert(if one <= other { (one, other) } else { (other, one) });
        }
    }
    let descriptions =
        pairs.iter().take(MAX_LISTED_ITEMS).map(|(one, other)| format!("{one} and {other}"));
    match pairs.is_empty() {
        true => "none".to_owned(),
        false => join_with_commas(&descriptions.collect::<Vec<_>>()),
    }
}
