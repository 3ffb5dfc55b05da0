//! The sections `[[region]]`: regions of the grid with different media.

use super::reader::SolidReader;
use super::shape::{RegionShape, SHAPE_KEYS};
use crate::error::CaseError;
use crate::kind::NO_YIELD_NAME;
use crate::material::Material;
use crate::named_enum::named_enum;
use crate::schema::{KeyGroup, KeySchema, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};

/// Maximum number of regions of a case.
pub const MAX_REGIONS: usize = u16::MAX as usize;

/// Schema of the sections `[[region]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "region",
    "subdomain of the grid with its own medium; each cell centre must lie in exactly one region; without regions [model] and [yield] apply to the whole grid",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "shape",
            ValueType::OneOf(|scope| {
                RegionShape::allowed_names_in_scope(scope.dimensions, &RegionShape::Complement)
            }),
            "",
            "\"layer\"",
            "shape of the region; rest: all cells outside the other regions",
        )]),
        KeyGroup::new(SHAPE_KEYS),
        KeyGroup::new(&[
            KeySchema::new_optional(
                "model",
                ValueType::SectionKeys("model"),
                "",
                "{ mu = 2e10 }",
                "keys that override [model]",
            ),
            KeySchema::new_optional(
                "yield",
                ValueType::SectionKeys("yield"),
                "",
                "{ kind = \"none\" }",
                "keys that override [yield]; kind none makes the region elastic",
            ),
            KeySchema::new_with_default(
                "contacts",
                ValueType::OneOf(|_| {
                    super::time::variant_names(RegionContacts::ALL, RegionContacts::name)
                }),
                "",
                "\"inherited\"",
                "contacts of [granular] or [porous]: inherited, or none, a solid without contacts",
            ),
        ]),
    ],
);

named_enum! {
    /// Contacts of the medium of a region.
    RegionContacts {
        /// Those of the case.
        Inherited = "inherited",
        /// None: a solid.
        None = "none"
    }
}

/// A region of the grid with its own medium.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialRegion {
    /// Shape of the region; a cell belongs to the region if its centre is inside the shape.
    pub shape: RegionShape,
    /// Material of the region.
    pub material: Material,
    /// Contacts of the medium.
    pub contacts: RegionContacts,
}

impl MaterialRegion {
    /// Formats the section `[[region]]` as TOML with all values.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = self.shape.write_keys(TableWriter::default(), dimensions);
        let resolved = resolved.with_table("model", &to_section_table(&self.material, "model"));
        let resolved = match self.material.yield_set {
            Some(_) => resolved.with_table("yield", &to_section_table(&self.material, "yield")),
            None => resolved
                .with_table("yield", &TableWriter::default().with_text("kind", NO_YIELD_NAME)),
        };
        let resolved = match self.contacts {
            RegionContacts::Inherited => resolved,
            RegionContacts::None => resolved.with_text("contacts", self.contacts.name()),
        };
        resolved.to_section_toml(&SCHEMA)
    }
}

/// Formats the keys of one section of a material as a TOML table.
pub(super) fn to_section_table(material: &Material, section: &str) -> TableWriter {
    let own = material.key_values(&[]).filter(|(key, _)| key.split_section().0 == section);
    own.fold(TableWriter::default(), |all, (key, value)| {
        all.with_toml(key.split_section().1, value)
    })
}

impl SolidReader<'_> {
    /// Reads the sections `[[region]]`; `material` reads the material of a region.
    pub(super) fn read_regions(
        &self,
        root: &SectionReader,
        material: impl Fn(&SectionReader) -> Result<Material, CaseError>,
    ) -> Result<Vec<MaterialRegion>, CaseError> {
        let sections = root.open_list(&SCHEMA)?;
        if sections.len() > MAX_REGIONS {
            let allowed = format!("expected at most {MAX_REGIONS}");
            return Err(root.key_error("region", format!("{} regions", sections.len()), allowed));
        }
        let mut regions: Vec<MaterialRegion> = Vec::new();
        let mut rest: Option<usize> = None;
        for (index, section) in sections.into_iter().enumerate() {
            let shape = self.read_shape(&section, &RegionShape::Complement)?;
            if shape == RegionShape::Complement
                && let Some(first) = rest.replace(index)
            {
                let position = root.locate(&format!("region[{first}]"));
                let found =
                    format!("a second region with shape rest, after region[{first}] ({position})");
                return Err(section.key_error("shape", found, "use shape = \"rest\" once"));
            }
            let mut material = material(&section)?;
            let contacts = section.read_optional_choice(
                "contacts",
                RegionContacts::ALL,
                RegionContacts::name,
            )?;
            let contacts = contacts.unwrap_or_default();
            if contacts == RegionContacts::None {
                material.contacts = None;
            }
            section.finish()?;
            regions.push(MaterialRegion { shape, material, contacts });
        }
        Ok(regions)
    }
}
