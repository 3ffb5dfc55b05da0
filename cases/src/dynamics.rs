//! Sections of a time-domain simulation of a solid: grid, media, boundary conditions, loads, initial state, output.
//!
//! Each submodule has the schema, the reader and the writer of one section. SI units, angles in degrees, coordinates
//! and lengths in m. Axes are numbered from 0 in the code and from 1 in case files. In plane strain forces are per unit
//! thickness.

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
pub use grid::{Grid, MAX_CELLS};
pub use initial::{Centre, Initial};
pub use load::{Action, Load};
pub use output::{Output, Picture, Recorded};
pub use plane_pulse::{PlanePulse, Polarization};
pub use profile::Profile;
pub use region::{MAX_REGIONS, Region};
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

/// Schemas of the time-domain sections of a solid, in the order of writing.
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

/// Sections of a time-domain simulation of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// Section `[grid]`: the grid of cells.
    pub grid: Grid,
    /// Section `[time]`: duration and Courant number.
    pub time: Time,
    /// Section `[scheme]`: options of the numerical scheme.
    pub scheme: Scheme,
    /// Regions of different media; if empty, the medium of the case fills the whole grid.
    pub regions: Vec<Region>,
    /// Boundary conditions. Faces without a condition are traction-free; where entries overlap, the last one applies.
    pub sides: Vec<SideCondition>,
    /// Boundary loads; superposed on each other and on the boundary conditions.
    pub loads: Vec<Load>,
    /// Sources inside the grid.
    pub sources: Vec<Source>,
    /// Parts of the initial state; parts are summed.
    pub initial: Vec<Initial>,
    /// Components of the uniform initial stress (Pa) and couple stress (N/m).
    pub initial_stress: Vec<(Component, f64)>,
    /// Section `[gravity]`, if present.
    pub gravity: Option<Gravity>,
    /// Receivers: points at which the state is recorded.
    pub receivers: Vec<Receiver<Recorded>>,
    /// Section `[output]`: ledger, snapshots and pictures.
    pub output: Output,
    places: Places,
}

impl Dynamics {
    /// Returns all time functions: of loads, sources and initial pulses.
    pub(crate) fn times(&self) -> impl Iterator<Item = &TimeFunction> {
        let initial = self.initial.iter().filter_map(|part| match part {
            Initial::PlanePulse(pulse) => Some(&pulse.time),
            _ => None,
        });
        let loads = self.loads.iter().map(|load| &load.time);
        loads.chain(self.sources.iter().map(|source| &source.time)).chain(initial)
    }

    /// Reads all sections in `root` except `[grid]`, for a case of material `material`; `material_of` reads the
    /// material of a region.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value is invalid.
    pub(crate) fn read(
        root: &Section,
        grid: Grid,
        material: &Material,
        material_of: impl Fn(&Section) -> Result<Material, CaseError>,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        let theory = match material.kind {
            Kind::Solid(solid) => solid.theory,
            Kind::Flow(_) => Theory::Classical, // an error is reported with the grid of a flow
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

    /// Formats the sections as TOML with all values, defaults included.
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

    /// Returns an error at a key of these sections, e.g. `load[0].amplitude`; list indices are counted from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }
    /// Computes the region index of each cell, an index into [`regions`](Self::regions), with the first axis fastest; 0
    /// in all cells without regions. A cell belongs to the region that contains the cell centre.
    ///
    /// # Errors
    /// Regions overlap, a cell is in no region, a region contains no cell, or memory allocation fails.
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
            media.push(medium as u16); // fits u16: at most MAX_REGIONS regions are read
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

    /// Finds the region other than [`Shape::Rest`] that contains a point; `None` if there is no such region.
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
