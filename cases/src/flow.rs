//! Sections of a time-domain simulation of a flow: periodic box, perturbation of the uniform mean flow and output.
//!
//! SI units, angles in degrees. The box is convected with the mean flow; positions are initial positions in the box,
//! from 0 to its edge lengths, m. Axes are numbered from 0.

mod grid;
mod initial;
mod output;
mod reader;

pub use grid::{FlowGrid, FlowTime, MAX_GRID_POINTS, MIN_POINTS_PER_AXIS};
pub use initial::{FlowPerturbation, HarmonicPerturbation, PerturbedField};
pub use output::{FlowOutput, FlowQuantity};

use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::kind::ModelKind;
use crate::receivers::ReceiverPoint;
use crate::schema::TableSchema;
use crate::section::SectionReader;
use models::flow::RotationKind;
use reader::FlowReader;
use std::path::Path;

/// Keys that must be 0 in a time-domain simulation of a flow, since the mean flow is uniform and isochoric and the box
/// moves with it.
pub const ZERO_IN_UNIFORM_FLOW: [&str; 9] = [
    "model.dilatancy_angle_deg",
    "background.velocity",
    "background.pressure_gradient",
    "background.stress_angle_gradient_deg",
    "background.density_gradient",
    "background.spin_gradient",
    "background.inertia_rate",
    "background.inertia_gradient",
    "background.acceleration",
];

/// Schemas of the time-domain sections of a flow, in the order of writing; the last schema is for coaxial flows only.
pub(crate) const FLOW_SCHEMAS: [&TableSchema; 6] = [
    &grid::GRID_SCHEMA,
    &grid::TIME_SCHEMA,
    &initial::SCHEMA,
    &output::RECEIVER_SCHEMA,
    &output::OUTPUT_SCHEMA,
    &grid::LIMITS_SCHEMA,
];

/// Returns the schemas of the time-domain sections of a kind of flow; empty if the kind has no time-domain solver.
pub(crate) fn schemas_for_kind(kind: ModelKind) -> Vec<&'static TableSchema> {
    match kind.simulation_rotation() {
        None => Vec::new(),
        Some(RotationKind::None) => FLOW_SCHEMAS.to_vec(),
        Some(_) => FLOW_SCHEMAS[..5].to_vec(),
    }
}

/// Sections of a time-domain simulation of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowRun {
    /// Kind of material rotation, which determines which field, if any, evolves with the velocity. Never
    /// [`RotationKind::Free`].
    pub rotation: RotationKind,
    /// Section `[grid]`: the periodic box.
    pub grid: FlowGrid,
    /// Section `[time]`: duration and tolerances.
    pub time: FlowTime,
    /// Lower limit of the shear rate Q_D (magnitude of the deviatoric deformation rate, 1/s), as a fraction of its
    /// value in the mean flow; a simulation stops at this limit (plastic potential only).
    pub min_shear_rate: f64,
    /// Terms of the initial perturbation, which are summed; at least one.
    pub perturbation_terms: Vec<FlowPerturbation>,
    /// Receivers: points of the box at which fields are recorded.
    pub receivers: Vec<ReceiverPoint<FlowQuantity>>,
    /// Section `[output]`: ledger, snapshots and pictures.
    pub output: FlowOutput,
    positions: KeyPositions,
}

impl FlowRun {
    /// Reads all time-domain sections in `root`; `folder` is the folder of the case file.
    ///
    /// # Errors
    /// A key is unknown or missing, a value is invalid, or an archive cannot be read.
    pub(crate) fn read(
        root: &SectionReader,
        rotation: RotationKind,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        let grid = FlowGrid::read(root)?;
        let reader = FlowReader { rotation, grid, case_folder: folder };
        Ok(Self {
            rotation,
            grid,
            time: FlowTime::read(root)?,
            min_shear_rate: grid::read_min_shear_rate(root)?,
            perturbation_terms: reader.read_perturbations(root)?,
            receivers: reader.read_receivers(root)?,
            output: reader.read_output(root)?,
            positions: root.positions().clone(),
        })
    }

    /// Formats the sections as TOML with all values, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let mut text = self.grid.to_toml() + &self.time.to_toml();
        if self.rotation == RotationKind::None {
            text += &grid::limits_to_toml(self.min_shear_rate);
        }
        text.extend(self.perturbation_terms.iter().map(initial::to_toml));
        text.extend(self.receivers.iter().map(ReceiverPoint::<FlowQuantity>::to_toml));
        text + &self.output.to_toml()
    }

    /// Returns this simulation on another grid.
    pub fn with_grid(&self, grid: FlowGrid) -> Self {
        Self { grid, ..self.clone() }
    }

    /// Returns an error at a key of these sections, e.g. `initial[0].amplitude`; list indices are counted from 0.
    pub fn key_error(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.positions.key_error(path, found, allowed)
    }
}
