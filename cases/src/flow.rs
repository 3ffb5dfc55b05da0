//! Sections of a time-domain simulation of a flow: periodic box, perturbation of the uniform mean flow and output.
//!
//! SI units, angles in degrees. The box is convected with the mean flow; positions are initial positions in the box,
//! from 0 to its edge lengths, m. Axes are numbered from 0.

mod grid;
mod initial;
mod output;
mod reader;

pub use grid::{Grid, MAX_POINTS, MIN_POINTS, Time};
pub use initial::{Disturbed, Initial, Wave};
pub use output::{Output, Quantity};

use crate::error::CaseError;
use crate::kind::Kind;
use crate::place::Places;
use crate::receivers::Receiver;
use crate::schema::Form;
use crate::section::Section;
use models::flow::RotationKind;
use reader::Reader;
use std::path::Path;

/// Keys of the state that must be 0, since the mean flow is uniform and the box moves with it.
pub const UNIFORM: [&str; 9] = [
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

/// Schemas of the sections, in the order of writing; the last schema is for coaxial flows only.
pub(crate) const FORMS: [&Form; 6] =
    [&grid::GRID, &grid::TIME, &initial::FORM, &output::RECEIVER, &output::OUTPUT, &grid::LIMITS];

/// Returns the schemas of the sections of a kind of flow; empty if the kind has no time-domain solver.
pub(crate) fn forms(kind: Kind) -> Vec<&'static Form> {
    match kind.rotation_in_time() {
        None => Vec::new(),
        Some(RotationKind::None) => FORMS.to_vec(),
        Some(_) => FORMS[..5].to_vec(),
    }
}

/// Sections of a time-domain simulation of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowRun {
    /// Kind of material rotation, which determines the field that evolves with the velocity. Never
    /// [`RotationKind::Free`].
    pub rotation: RotationKind,
    /// Section `[grid]`: the periodic box.
    pub grid: Grid,
    /// Section `[time]`: duration and tolerances.
    pub time: Time,
    /// Lower limit of the shear rate Q_D relative to the mean flow, at which a simulation stops (plastic potential
    /// only).
    pub least_shear_rate: f64,
    /// Parts of the initial perturbation, which are summed; at least one.
    pub initial: Vec<Initial>,
    /// Receivers: points of the box at which fields are recorded.
    pub receivers: Vec<Receiver<Quantity>>,
    /// Section `[output]`: ledger, snapshots and pictures.
    pub output: Output,
    places: Places,
}

impl FlowRun {
    /// Reads all sections in `root`.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value is invalid.
    pub(crate) fn read(
        root: &Section,
        rotation: RotationKind,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        let grid = Grid::read(root)?;
        let reader = Reader { rotation, grid, folder };
        Ok(Self {
            rotation,
            grid,
            time: Time::read(root)?,
            least_shear_rate: grid::least_shear_rate(root)?,
            initial: reader.initial(root)?,
            receivers: reader.receivers(root)?,
            output: reader.output(root)?,
            places: root.places().clone(),
        })
    }

    /// Formats the sections as TOML with all values, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let mut text = self.grid.to_toml() + &self.time.to_toml();
        if self.rotation == RotationKind::None {
            text += &grid::limits_to_toml(self.least_shear_rate);
        }
        text.extend(self.initial.iter().map(initial::to_toml));
        text.extend(self.receivers.iter().map(Receiver::<Quantity>::to_toml));
        text + &self.output.to_toml()
    }

    /// Returns this simulation on another grid.
    pub fn on(&self, grid: Grid) -> Self {
        Self { grid, ..self.clone() }
    }

    /// Returns an error at a key of these sections, e.g. `initial[0].amplitude`; list indices are counted from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }
}
