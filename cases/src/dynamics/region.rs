//! The sections `[[region]]`: parts of the grid with media of their own.

use super::shape::{ITEMS, Shape};
use super::{Dynamics, MOST_REGIONS, Reader};
use crate::entries::Entries;
use crate::error::CaseError;
use crate::schema::{Form, Group, Item};
use crate::section::{Resolved, Section};
use crate::types::Type;
use crate::{Case, NO_YIELD};

/// The sections.
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

/// A part of the grid with its own medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Where it is: the cells whose centres are in it.
    pub shape: Shape,
    /// Kind, yield set and numbers of its medium, with the places of the region; no dynamics.
    pub case: Case,
}

impl Region {
    /// The section as TOML.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = self.shape.resolved(Resolved::default(), dimensions);
        let resolved = resolved.table("model", &part(&self.case, "model"));
        let resolved = match self.case.yields {
            Some(_) => resolved.table("yield", &part(&self.case, "yield")),
            None => resolved.table("yield", &Resolved::default().text("kind", NO_YIELD)),
        };
        resolved.under(&FORM)
    }
}

/// What a case has in one section.
fn part(case: &Case, section: &str) -> Resolved {
    let own = case.values().filter(|(key, _)| key.split().0 == section);
    own.fold(Resolved::default(), |all, (key, value)| all.literal(key.split().1, value))
}

impl Reader<'_> {
    /// Reads the sections.
    pub(super) fn regions(
        &self,
        root: &Section,
        case: &Case,
        entries: &Entries,
    ) -> Result<Vec<Region>, CaseError> {
        let sections = root.list(&FORM)?;
        if sections.len() > MOST_REGIONS {
            let allowed = format!("expected at most {MOST_REGIONS}");
            return Err(root.error("region", format!("{} regions", sections.len()), allowed));
        }
        let mut regions: Vec<Region> = Vec::new();
        let mut rest: Option<usize> = None;
        for (index, section) in sections.into_iter().enumerate() {
            let shape = self.shape(&section, &Shape::Rest)?;
            if shape == Shape::Rest
                && let Some(first) = rest.replace(index)
            {
                let place = entries.places.of(&format!("region[{first}]"));
                let found = format!("a second rest besides region[{first}] ({place})");
                return Err(section.error("shape", found, "give one region the rest"));
            }
            let case = case.of_region(entries, &section, self.grid)?;
            section.finish()?;
            regions.push(Region { shape, case });
        }
        Ok(regions)
    }
}

impl Dynamics {
    /// The region of each cell, by its place in [`regions`](Self::regions), the first axis running
    /// fastest; all 0 without regions. A cell belongs to the region that holds its centre.
    ///
    /// # Errors
    /// Two regions hold the same cell, a cell is in none, a region holds none, or memory is short.
    pub fn media_of_cells(&self) -> Result<Vec<u16>, CaseError> {
        let count = self.grid.count();
        let mut media = Vec::new();
        if media.try_reserve_exact(count).is_err() {
            let found = format!("no memory for {count} cells");
            return Err(self.places.error("grid.cells", found, "ask for fewer"));
        }
        if self.regions.is_empty() {
            media.resize(count, 0);
            return Ok(media);
        }
        let mut is_used = vec![false; self.regions.len()];
        let rest = self.regions.iter().position(|region| region.shape == Shape::Rest);
        let mut index = vec![0; self.grid.dimensions()];
        let mut centre: Vec<f64> = (0..index.len()).map(|axis| self.grid.centre(axis, 0)).collect();
        for _ in 0..count {
            let medium = self.region_at(&centre)?.or(rest);
            let Some(medium) = medium else {
                return Err(self.places.error(
                    "region",
                    format!("no region holds the cell at {centre:?}"),
                    "add [[region]] with shape = \"rest\", or make the regions larger",
                ));
            };
            is_used[medium] = true;
            media.push(medium as u16); // at most MOST_REGIONS are read
            for axis in 0..index.len() {
                index[axis] = (index[axis] + 1) % self.grid.cells[axis];
                centre[axis] = self.grid.centre(axis, index[axis]);
                if index[axis] > 0 {
                    break;
                }
            }
        }
        match is_used.iter().position(|is_used| !is_used) {
            Some(unused) => Err(self.places.error(
                &format!("region[{unused}]"),
                "no cell has its centre in it",
                "make it larger than a cell, move it into the grid, or leave it out",
            )),
            None => Ok(media),
        }
    }

    /// The one region that holds a point, that of the rest aside.
    fn region_at(&self, x: &[f64]) -> Result<Option<usize>, CaseError> {
        let mut holders =
            (0..self.regions.len()).filter(|&region| self.regions[region].shape.contains(x));
        let first = holders.next();
        match (first, holders.next()) {
            (Some(first), Some(second)) => {
                let place = self.places.of(&format!("region[{first}]"));
                let found = format!("overlaps region[{first}] ({place}) in the cell at {x:?}");
                let allowed = "give every cell to one region: move or shrink one of the two";
                Err(self.places.error(&format!("region[{second}]"), found, allowed))
            }
            _ => Ok(first),
        }
    }
}
