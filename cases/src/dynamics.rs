//! What a case says of a run in time: grid, media, sides, loads, initial state and what is recorded.
//!
//! Each file has the form, the reader and the writer of one section. SI units, angles in degrees; coordinates
//! and lengths in m. Axes are counted from 0 here and from 1 in case files. In plane strain forces are per
//! unit thickness.

mod boundary;
mod component;
mod function;
mod grid;
mod initial;
mod load;
pub(crate) mod output;
mod plane_pulse;
mod profile;
mod reader;
mod region;
mod shape;
mod source;
pub(crate) mod stress;
mod time;

pub use crate::receivers::{Interpolation, Receiver};
pub use boundary::{Condition, Part, Side, SideCondition};
pub use component::Component;
pub use function::{Samples, TimeFunction};
pub use grid::{Grid, MOST_CELLS};
pub use initial::{Centre, Initial};
pub use load::{Action, Load};
pub use output::{Output, Picture, Recorded};
pub use plane_pulse::{PlanePulse, Polarization};
pub use profile::Profile;
pub use region::{MOST_REGIONS, Region};
pub use shape::Shape;
pub use source::{Kernel, Source, SourceKind};
pub use stress::Gravity;
pub use time::{COURANT, Correction, Ledger, Order, Precision, Scheme, Splitting, Time};

use crate::error::CaseError;
use crate::kind::Kind;
use crate::material::Material;
use crate::place::Places;
use crate::schema::Form;
use crate::section::Section;
use boundary::periodic_sides;
use models::solid::parameters::Theory;
use reader::Reader;
use std::path::Path;

/// The sections, in the order in which they are written.
pub(crate) const FORMS: &[&Form] = &[
    &grid::FORM,
    &time::TIME,
    &time::SCHEME,
    &region::FORM,
    &boundary::FORM,
    &load::FORM,
    &source::FORM,
    &initial::FORM,
    &stress::INITIAL_STRESS,
    &stress::GRAVITY,
    &output::RECEIVER,
    &output::OUTPUT,
];

/// The sections of a case that say how it is run in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// The cells.
    pub grid: Grid,
    /// How long, and in which steps.
    pub time: Time,
    /// The choices of the scheme.
    pub scheme: Scheme,
    /// Parts of other media; empty: the case's own is everywhere.
    pub regions: Vec<Region>,
    /// Conditions on sides. What no entry names is free; of two that overlap the later one holds.
    pub sides: Vec<SideCondition>,
    /// Loads on sides; they add up, over the conditions.
    pub loads: Vec<Load>,
    /// Loads inside.
    pub sources: Vec<Source>,
    /// What the initial state is made of; the parts add up.
    pub initial: Vec<Initial>,
    /// Uniform initial stress: all stresses of the case, Pa and N/m.
    pub initial_stress: Vec<(Component, f64)>,
    /// Weight.
    pub gravity: Option<Gravity>,
    /// Points at which the state is recorded.
    pub receivers: Vec<Receiver<Recorded>>,
    /// What else is recorded.
    pub output: Output,
    places: Places,
}

impl Dynamics {
    /// All functions of time.
    pub(crate) fn times(&self) -> impl Iterator<Item = &TimeFunction> {
        let initial = self.initial.iter().filter_map(|part| match part {
            Initial::PlanePulse(pulse) => Some(&pulse.time),
            _ => None,
        });
        let loads = self.loads.iter().map(|load| &load.time);
        loads.chain(self.sources.iter().map(|source| &source.time)).chain(initial)
    }

    /// What the sections around `root` say besides `[grid]`, of a case of that material; `material_of` reads the
    /// tables of a region that say what it is made of.
    ///
    /// # Errors
    /// What is wrong, where, and what is allowed.
    pub(crate) fn read(
        root: &Section,
        grid: Grid,
        material: &Material,
        material_of: impl Fn(&Section) -> Result<Material, CaseError>,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        let theory = match material.kind {
            Kind::Solid(solid) => solid.theory,
            Kind::Flow(_) => Theory::Classical, // refused with its grid
        };
        let components = Component::all(theory, grid.dimensions());
        let reader = Reader { grid: &grid, theory, components, folder };
        let regions = reader.regions(root, material_of)?;
        let sides = reader.sides(root)?;
        let periodic: Vec<Side> = periodic_sides(&sides).map(|(_, side)| side).collect();
        let (loads, sources) = (reader.loads(root, &periodic)?, reader.sources(root)?);
        let yields = match regions.as_slice() {
            [] => material.yields.is_some(),
            regions => regions.iter().any(|region| region.material.yields.is_some()),
        };
        let output = reader.output(root, yields)?;
        let time = Time::read(root)?;
        Ok(Self {
            scheme: Scheme::read(root, time.courant, yields)?,
            time,
            regions,
            sides,
            loads,
            sources,
            initial: reader.initial(root)?,
            initial_stress: reader.initial_stress(root)?,
            gravity: Gravity::read(root)?,
            receivers: reader.receivers(root, &output.integrals)?,
            output,
            grid: grid.clone(),
            places: root.places().clone(),
        })
    }

    /// The sections as TOML: every value, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let d = self.grid.dimensions();
        let mut text = self.grid.to_toml() + &self.time.to_toml() + &self.scheme.to_toml();
        text.extend(self.regions.iter().map(|region| region.to_toml(d)));
        text.extend(self.sides.iter().map(SideCondition::to_toml));
        text.extend(self.loads.iter().map(|load| load.to_toml(d)));
        text.extend(self.sources.iter().map(Source::to_toml));
        text.extend(self.initial.iter().map(|part| part.to_toml(d)));
        text += &stress::to_toml(&self.initial_stress);
        text.extend(self.gravity.iter().map(Gravity::to_toml));
        text.extend(self.receivers.iter().map(Receiver::to_toml));
        text + &self.output.to_toml()
    }

    /// An error at a key of these sections, as in `load[0].amplitude`; indices from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }
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
