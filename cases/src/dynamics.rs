//! Sections of a time-domain simulation of a solid: grid, media, boundary conditions, loads, initial state, output.
//!
//! Each submodule has the schema, the reader and the writer of one section. SI units, angles in degrees, coordinates
//! and lengths in m. Axes are numbered from 0 in the code and from 1 in case files. In plane strain forces are per unit
//! thickness.

mod block;
mod blocks;
mod boundary;
mod component;
mod grid;
mod initial;
mod joint;
mod joint_checks;
mod joint_keys;
mod load;
pub(crate) mod output;
mod parallel;
mod plane_pulse;
mod profile;
mod reader;
mod region;
mod shape;
mod snapshot_options;
mod source;
pub(crate) mod stress;
mod tiling;
mod time;
mod time_function;

pub use crate::receivers::{Interpolation, ReceiverPoint};
pub use block::{BlockEntry, MAX_BLOCKS, MaterialPattern};
pub use blocks::Blocks;
pub use boundary::{BoundaryConditionKind, BoundaryFace, FaceCondition, FaceRectangle};
pub use component::StateComponent;
pub use grid::{MAX_CELLS, SolidGrid};
pub use initial::{InitialStateTerm, PulseCentre};
pub use joint::{JointEntry, JointLaw, JointSelector, MAX_JOINTS};
pub use load::{FaceLoad, LoadedArea};
pub use output::{FaceQuantity, PlottedQuantity, RecordedQuantity, SolidOutput};
pub use plane_pulse::{BodyWaveType, PlanePulseInput};
pub use profile::LoadProfile;
pub use region::{MAX_REGIONS, MaterialRegion};
pub use shape::RegionShape;
pub use snapshot_options::SnapshotOptions;
pub use source::{Kernel, PointSource, SourceKind};
pub use stress::Gravity;
pub use tiling::{BlockContact, PlacedBlock};
pub use time::{
    CourantWaves, DEFAULT_COURANT_NUMBER, DimensionalSplitting, LedgerDetail, Precision,
    ReconstructionScheme, ReturnMappingOrder, SchemeOptions, SolidTime,
};
pub use time_function::{Samples, TimeFunction};

use time::MIN_CELLS_OF_HIGH_ORDER;

use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::kind::ModelKind;
use crate::material::Material;
use crate::plane_wave::ContactMedium;
use crate::schema::TableSchema;
use crate::section::SectionReader;
use boundary::periodic_faces;
use models::common::decimal::ToPlainText;
use models::solid::parameters::Theory;
use reader::SolidReader;
use std::path::Path;

/// Schemas of the time-domain sections of a solid, in the order of writing.
pub(crate) const SOLID_SCHEMAS: &[&TableSchema] = &[
    &grid::SCHEMA,
    &block::SCHEMA,
    &joint::SCHEMA,
    &time::TIME_SCHEMA,
    &time::SCHEME_SCHEMA,
    &region::SCHEMA,
    &boundary::SCHEMA,
    &load::SCHEMA,
    &source::SCHEMA,
    &initial::SCHEMA,
    &stress::INITIAL_STRESS_SCHEMA,
    &stress::GRAVITY_SCHEMA,
    &output::RECEIVER_SCHEMA,
    &output::OUTPUT_SCHEMA,
    &parallel::SCHEMA,
];

/// Sections of a time-domain simulation of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidRun {
    /// Section `[grid]`: the grid of cells; in a blocky medium the bounding box of the blocks.
    pub grid: SolidGrid,
    /// Section `[time]`: duration and Courant number.
    pub time: SolidTime,
    /// Section `[scheme]`: options of the numerical scheme.
    pub scheme: SchemeOptions,
    /// Blocks and joints of a blocky medium, if present; then the case has no regions.
    pub blocks: Option<Blocks>,
    /// Regions of different media; without regions and blocks the medium of the case fills the whole grid.
    pub regions: Vec<MaterialRegion>,
    /// Boundary conditions. Faces without a condition are traction-free; where entries overlap, the last one applies.
    pub boundary_conditions: Vec<FaceCondition>,
    /// Boundary loads. Loads on the same component are summed; a load replaces the boundary condition of its component.
    pub loads: Vec<FaceLoad>,
    /// Sources inside the grid.
    pub sources: Vec<PointSource>,
    /// Terms of the initial state, which are summed.
    pub initial_terms: Vec<InitialStateTerm>,
    /// Components of the uniform initial stress (Pa) and couple stress (N/m).
    pub initial_stress: Vec<(StateComponent, f64)>,
    /// Section `[gravity]`, if present.
    pub gravity: Option<Gravity>,
    /// Receivers: points at which the state is recorded.
    pub receivers: Vec<ReceiverPoint<RecordedQuantity>>,
    /// Section `[output]`: ledger, snapshots and pictures.
    pub output: SolidOutput,
    /// Section `[parallel]`: numbers of parts along the axes for several processes; `None` to leave them to the program.
    pub part_counts: Option<Vec<usize>>,
    positions: KeyPositions,
}

impl SolidRun {
    /// Returns the materials of the regions or blocks, in the order of the indices of
    /// [`compute_cell_media`](Self::compute_cell_media); empty if the material of the case fills the whole grid.
    pub fn materials(&self) -> Vec<&Material> {
        match &self.blocks {
            Some(blocks) => blocks.materials.iter().collect(),
            None => self.regions.iter().map(|region| &region.material).collect(),
        }
    }

    /// Returns the section of the material with an index in [`materials`](Self::materials), as a key for messages:
    /// `region[0]`, `block[0]` or `block[0].materials[1]`; empty for the material of the case.
    pub fn material_section(&self, index: usize) -> String {
        match &self.blocks {
            Some(blocks) => blocks.material_section(index),
            None if self.regions.is_empty() => String::new(),
            None => format!("region[{index}]"),
        }
    }

    /// Returns all time functions: of loads, sources and initial plane pulses.
    pub(crate) fn time_functions(&self) -> impl Iterator<Item = &TimeFunction> {
        let initial = self.initial_terms.iter().filter_map(|part| match part {
            InitialStateTerm::PlanePulse(pulse) => Some(&pulse.waveform),
            _ => None,
        });
        let loads = self.loads.iter().map(|load| &load.time_function);
        loads.chain(self.sources.iter().map(|source| &source.time_function)).chain(initial)
    }

    /// Reads all time-domain sections in `root` except `[grid]`, for a case of material `material`; `read_material`
    /// reads the material of a region, `folder` is the folder of the case file.
    ///
    /// # Errors
    /// A key is unknown or missing, a value is invalid, or a sample file cannot be read.
    pub(crate) fn read(
        root: &SectionReader,
        grid: SolidGrid,
        material: &Material,
        read_material: impl Fn(&SectionReader) -> Result<Material, CaseError>,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        let theory = match material.kind {
            ModelKind::Solid(solid) => solid.theory,
            ModelKind::Flow(_) | ModelKind::Rheology | ModelKind::Equations => Theory::Classical, // unreachable: this function reads solids only
        };
        let components = StateComponent::all_components(theory, grid.dimensions());
        let history = match material.contacts {
            Some(ContactMedium::Porous { contact_cone: None, .. }) => {
                StateComponent::CONTACT_COMPONENTS.to_vec()
            }
            _ => Vec::new(),
        };
        let has_pore_cones =
            matches!(material.contacts, Some(ContactMedium::Porous { contact_cone: Some(_), .. }));
        let reader = SolidReader {
            grid: &grid,
            theory,
            state_components: components,
            history_components: history,
            has_pore_cones,
            case_folder: folder,
        };
        let regions = reader.read_regions(root, &read_material)?;
        let blocks = reader.read_blocky_medium(root, &read_material)?;
        let conditions = reader.read_boundary_conditions(root)?;
        let periodic: Vec<BoundaryFace> =
            periodic_faces(&conditions).map(|(_, face)| face).collect();
        if let Some(blocks) = &blocks {
            let is_periodic = [0, 1].map(|axis| periodic.iter().any(|face| face.axis == axis));
            blocks.check_layer_ends(is_periodic)?;
        }
        let (loads, sources) = (reader.read_loads(root, &periodic)?, reader.read_sources(root)?);
        let of_regions = regions.iter().map(|region| &region.material);
        let of_blocks = blocks.iter().flat_map(|blocks| &blocks.materials);
        let mut own = of_regions.chain(of_blocks).peekable();
        let media: Vec<&Material> = match own.peek() {
            None => vec![material],
            Some(_) => own.collect(),
        };
        let yields = media.iter().any(|own| own.is_plastic());
        let has_contacts = media.iter().any(|own| own.contacts.is_some());
        let output = reader.read_output(root, yields, blocks.as_ref())?;
        let time = SolidTime::read(root)?;
        let has_joints = blocks.as_ref().is_some_and(Blocks::has_joints);
        let initial_terms = reader.read_initial_terms(root)?;
        let initial_stress = reader.read_initial_stress(root)?;
        let gravity = Gravity::read(root)?;
        if has_contacts {
            let excluded = [
                ("joint", has_joints),
                ("time.courant_of", time.courant_waves != CourantWaves::Fastest),
                ("initial_stress", initial_stress.iter().any(|own| own.1 != 0.0)),
                ("gravity.balanced", gravity.as_ref().is_some_and(|own| own.is_balanced)),
            ];
            if let Some((key, _)) = excluded.into_iter().find(|own| own.1) {
                let allowed = "leave it out: runs of granular and porous media have none";
                let found = "found beside a granular or porous medium";
                return Err(root.key_error(key, found, allowed));
            }
        }
        for (index, term) in initial_terms.iter().enumerate() {
            let is_loosening = matches!(term, InitialStateTerm::Loosening { .. });
            let (found, allowed) = match (has_contacts, is_loosening) {
                (true, _) if !term.is_allowed_with_contacts() => (
                    "an initial stress beside a granular or porous medium",
                    "a velocity, by uniform, pulse or rigid-rotation, or loosening",
                ),
                (false, true) => {
                    ("loosening without a granular medium", "add a section [granular]")
                }
                _ => continue,
            };
            let key = format!("initial[{index}].kind");
            return Err(root.key_error(&key, found, allowed));
        }
        if grid.is_polar() {
            let excluded = [
                ("time.courant_of", time.courant_waves != CourantWaves::Fastest),
                ("source", !sources.is_empty()),
                ("initial", !initial_terms.is_empty()),
                ("initial_stress", initial_stress.iter().any(|own| own.1 != 0.0)),
                ("gravity", gravity.is_some()),
            ];
            if let Some((key, _)) = excluded.into_iter().find(|own| own.1) {
                let allowed = "leave it out: loads on the sides drive runs on polar grids";
                return Err(root.key_error(key, "found beside a polar grid", allowed));
            }
        }
        let two_cyclic_cause = match has_joints {
            true => Some("joints between blocks"),
            false => grid.is_polar().then_some("polar grids"),
        };
        let is_narrow = grid.cells.iter().any(|cells| *cells < MIN_CELLS_OF_HIGH_ORDER);
        let is_open =
            conditions.iter().any(|own| own.condition == BoundaryConditionKind::NonReflecting);
        let narrow_cause = match grid.is_polar() {
            true => Some("polar grids"),
            false if blocks.is_some() => Some("grids of blocks"),
            false if !regions.is_empty() => Some("regions of other solids"),
            false if is_open => Some("non-reflecting sides, which would return short waves,"),
            false => is_narrow.then_some("grids of fewer than 4 cells along an axis"),
        };
        let causes = (yields, two_cyclic_cause, has_contacts, narrow_cause);
        Ok(Self {
            scheme: SchemeOptions::read(root, &time, causes)?,
            time,
            blocks,
            regions,
            boundary_conditions: conditions,
            loads,
            sources,
            initial_terms,
            initial_stress,
            gravity,
            receivers: reader.read_receivers(root, &output.integrated_components)?,
            output,
            part_counts: parallel::read_part_counts(root, &grid)?,
            grid: grid.clone(),
            positions: root.positions().clone(),
        })
    }

    /// Formats the sections as TOML with all values, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let d = self.grid.dimensions();
        let grid = match &self.blocks {
            Some(blocks) => blocks.to_toml(),
            None => self.grid.to_toml(),
        };
        let mut text = grid + &self.time.to_toml() + &self.scheme.to_toml();
        text.extend(self.regions.iter().map(|region| region.to_toml(d)));
        text.extend(self.boundary_conditions.iter().map(FaceCondition::to_toml));
        text.extend(self.loads.iter().map(|load| load.to_toml(d)));
        text.extend(self.sources.iter().map(PointSource::to_toml));
        text.extend(self.initial_terms.iter().map(|part| part.to_toml(d)));
        text += &stress::to_toml(&self.initial_stress);
        text.extend(self.gravity.iter().map(Gravity::to_toml));
        text.extend(self.receivers.iter().map(ReceiverPoint::to_toml));
        text += &self.output.to_toml();
        text.extend(self.part_counts.iter().map(|own| parallel::to_toml(own)));
        text
    }

    /// Returns an error at a key of these sections, e.g. `load[0].amplitude`; list indices are counted from 0.
    pub fn key_error(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.positions.key_error(path, found, allowed)
    }
    /// Computes the region index of each cell, an index into [`regions`](Self::regions) or in a blocky medium into
    /// [`Blocks::materials`], with the first axis fastest; 0 in all cells without regions and blocks. A cell belongs to
    /// the region that contains the cell centre, else to the region of shape [`RegionShape::Complement`].
    ///
    /// # Errors
    /// Two regions contain the same cell centre, a cell is in no region, a region contains no cell, or memory
    /// allocation fails.
    pub fn compute_cell_media(&self) -> Result<Vec<u16>, CaseError> {
        if let Some(blocks) = &self.blocks {
            return blocks.compute_cell_materials();
        }
        let count = self.grid.cell_count();
        let mut media = Vec::new();
        if media.try_reserve_exact(count).is_err() {
            let found = format!("no memory for {count} cells");
            return Err(self.positions.key_error(
                "grid.cells",
                found,
                "reduce the number of cells",
            ));
        }
        if self.regions.is_empty() {
            media.resize(count, 0);
            return Ok(media);
        }
        let medium = self.medium_function();
        let mut is_used = vec![false; self.regions.len()];
        for cell in 0..count {
            let medium = medium(cell)?;
            is_used[usize::from(medium)] = true;
            media.push(medium);
        }
        self.check_all_used(&is_used)?;
        Ok(media)
    }

    /// Returns a function that computes the region index of a cell as
    /// [`compute_cell_media`](Self::compute_cell_media) does, without a list of all cells. Its error is that two regions
    /// contain the cell centre, or none.
    pub fn medium_function(
        &self,
    ) -> Box<dyn Fn(usize) -> Result<u16, CaseError> + Send + Sync + 'static> {
        if let Some(blocks) = &self.blocks {
            let material = blocks.material_function();
            return Box::new(move |cell| Ok(material(cell)));
        }
        if self.regions.is_empty() {
            return Box::new(|_| Ok(0));
        }
        let own = self.clone();
        let rest = own.regions.iter().position(|region| region.shape == RegionShape::Complement);
        Box::new(move |cell| {
            let mut remaining = cell;
            let mut centre = Vec::with_capacity(own.grid.dimensions());
            for (axis, count) in own.grid.cells.iter().enumerate() {
                centre.push(own.grid.cell_centre(axis, remaining % count));
                remaining /= count;
            }
            match own.find_region(&centre)?.or(rest) {
                Some(medium) => Ok(medium as u16), // fits u16: at most MAX_REGIONS regions are read
                None => Err(own.positions.key_error(
                    "region",
                    format!(
                        "no region contains the cell at {centre}",
                        centre = centre.to_plain_text()
                    ),
                    "add [[region]] with shape = \"rest\", or make the regions larger",
                )),
            }
        })
    }

    /// Checks that every region contains a cell; `is_used`: whether it does, by region.
    ///
    /// # Errors
    /// A region contains no cell.
    pub fn check_all_used(&self, is_used: &[bool]) -> Result<(), CaseError> {
        match is_used.iter().position(|is_used| !is_used) {
            Some(unused) => Err(self.positions.key_error(
                &format!("region[{unused}]"),
                "contains no cell centre",
                "make it larger than a cell, move it into the grid, or remove it",
            )),
            None => Ok(()),
        }
    }

    /// Finds the region other than [`RegionShape::Complement`] that contains a point; `None` if no region contains it,
    /// an error if two do.
    fn find_region(&self, x: &[f64]) -> Result<Option<usize>, CaseError> {
        let mut holders =
            (0..self.regions.len()).filter(|&region| self.regions[region].shape.contains(x));
        let first = holders.next();
        match (first, holders.next()) {
            (Some(first), Some(second)) => {
                let position = self.positions.locate(&format!("region[{first}]"));
                let found = format!(
                    "overlaps region[{first}] ({position}) in the cell at {x}",
                    x = x.to_plain_text()
                );
                let allowed = "regions must not overlap: move or shrink one of the two";
                Err(self.positions.key_error(&format!("region[{second}]"), found, allowed))
            }
            _ => Ok(first),
        }
    }
}
