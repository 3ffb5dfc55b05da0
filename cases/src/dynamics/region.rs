//! The sections `[[region]]`: subdomains of the grid with different media.

use super::reader::Reader;
use super::shape::{ITEMS, Shape};
use crate::error::CaseError;
use crate::kind::NO_YIELD;
use crate::material::Material;
use crate::schema::{Form, Group, Item, Type};
use crate::section::{Resolved, Section};

/// Maximum number of regions of a case.
pub const MAX_REGIONS: usize = u16::MAX as usize;

/// Schema of the sections `[[region]]`.
pub(super) const FORM: Form = Form::list(
    "region",
    "a part of the grid with its own medium: every cell is in just one, by its centre; without any [model] and [yield] hold everywhere",
    &[
        Group::always(&[Item::required(
            "shape",
            Type::OneOf(|scope| Shape::words(scope.dimensions, &Shape::Rest)),
            "",
            "\"layer\"",
            "where it is; rest is what no other region holds",
        )]),
        Group::always(ITEMS),
        Group::always(&[
            Item::optional(
                "model",
                Type::Part("model"),
                "",
                "{ mu = 2e10 }",
                "what differs from [model]",
            ),
            Item::optional(
                "yield",
                Type::Part("yield"),
                "",
                "{ kind = \"none\" }",
                "what differs from [yield]; none stays elastic",
            ),
        ]),
    ],
);

/// A subdomain of the grid with its own medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Shape of the region; a cell belongs to the region if its centre is inside the shape.
    pub shape: Shape,
    /// Material of the region.
    pub material: Material,
}

impl Region {
    /// Formats the section `[[region]]` as TOML with all values.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = self.shape.resolved(Resolved::default(), dimensions);
        let resolved = resolved.table("model", &part(&self.material, "model"));
        let resolved = match self.material.yields {
            Some(_) => resolved.table("yield", &part(&self.material, "yield")),
            None => resolved.table("yield", &Resolved::default().text("kind", NO_YIELD)),
        };
        resolved.under(&FORM)
    }
}

/// Formats the keys of one section of a material as a TOML table.
fn part(material: &Material, section: &str) -> Resolved {
    let own = material.values(&[]).filter(|(key, _)| key.split().0 == section);
    own.fold(Resolved::default(), |all, (key, value)| all.literal(key.split().1, value))
}

impl Reader<'_> {
    /// Reads the sections `[[region]]`; `material` reads the material of a region.
    pub(super) fn regions(
        &self,
        root: &Section,
        material: impl Fn(&Section) -> Result<Material, CaseError>,
    ) -> Result<Vec<Region>, CaseError> {
        let sections = root.list(&FORM)?;
        if sections.len() > MAX_REGIONS {
            let allowed = format!("expected at most {MAX_REGIONS}");
            return Err(root.error("region", format!("{} regions", sections.len()), allowed));
        }
        let mut regions: Vec<Region> = Vec::new();
        let mut rest: Option<usize> = None;
        for (index, section) in sections.into_iter().enumerate() {
            let shape = self.shape(&section, &Shape::Rest)?;
            if shape == Shape::Rest
                && let Some(first) = rest.replace(index)
            {
                let place = root.place(&format!("region[{first}]"));
                let found = format!("a second rest besides region[{first}] ({place})");
                return Err(section.error("shape", found, "give one region the rest"));
            }
            let material = material(&section)?;
            section.finish()?;
            regions.push(Region { shape, material });
        }
        Ok(regions)
    }
}
