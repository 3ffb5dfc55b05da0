//! What a case says of a flow in time: the box and its points, the perturbation of the uniform flow,
//! and what is recorded.
//!
//! SI units, angles in degrees. The box moves with the mean flow; positions are those that its points
//! have at the beginning, from 0 to its edges, m. Axes are counted from 0.

mod grid;
mod initial;
mod output;
mod reader;

pub use grid::{Grid, LEAST_POINTS, MOST_POINTS, Time};
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

/// Keys of a state that are 0 in a flow that is uniform and whose box moves with it.
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

/// The sections, in the order in which they are written; the last one is of coaxial flows alone.
pub(crate) const FORMS: [&Form; 6] =
    [&grid::GRID, &grid::TIME, &initial::FORM, &output::RECEIVER, &output::OUTPUT, &grid::LIMITS];

/// The sections of a kind of flow; none where it cannot be run in time.
pub(crate) fn forms(kind: Kind) -> Vec<&'static Form> {
    match kind.rotation_in_time() {
        None => Vec::new(),
        Some(RotationKind::None) => FORMS.to_vec(),
        Some(_) => FORMS[..5].to_vec(),
    }
}

/// The sections of a case that say how a flow is run in time.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowRun {
    /// What rotates: it says which field evolves beside the velocity. Never [`RotationKind::Free`].
    pub rotation: RotationKind,
    /// The box.
    pub grid: Grid,
    /// How long, and how accurately.
    pub time: Time,
    /// Least Q_D relative to that of the mean flow, at which a run is stopped (plastic potential alone).
    pub least_shear_rate: f64,
    /// What the perturbation is made of at the beginning; the parts add up. At least one.
    pub initial: Vec<Initial>,
    /// Points of the box at which fields are recorded.
    pub receivers: Vec<Receiver<Quantity>>,
    /// What else is recorded.
    pub output: Output,
    places: Places,
}

impl FlowRun {
    /// What the sections around `root` say.
    ///
    /// # Errors
    /// What is wrong, where, and what is allowed.
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

    /// The sections as TOML: every value, defaults included.
    pub(crate) fn to_toml(&self) -> String {
        let mut text = self.grid.to_toml() + &self.time.to_toml();
        if self.rotation == RotationKind::None {
            text += &grid::limits_to_toml(self.least_shear_rate);
        }
        text.extend(self.initial.iter().map(initial::to_toml));
        text.extend(self.receivers.iter().map(Receiver::<Quantity>::to_toml));
        text + &self.output.to_toml()
    }

    /// The same in another box.
    pub fn on(&self, grid: Grid) -> Self {
        Self { grid, ..self.clone() }
    }

    /// An error at a key of these sections, as in `initial[0].amplitude`; indices from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }
}
