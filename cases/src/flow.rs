//! What a case says of a flow in time: the box and its points, the perturbation of the uniform flow,
//! and what is recorded.
//!
//! SI units, angles in degrees. The box moves with the mean flow; positions are those that its points
//! have at the beginning, from 0 to its edges, m. Axes are counted from 0.

mod grid;
mod initial;
mod output;

pub use grid::{Grid, Time};
pub use initial::{Disturbed, Initial, Wave};
pub use output::{Output, Quantity};

use super::dynamics::Receiver;
use super::keys::Key;
use super::place::Places;
use super::value::Value;
use super::{Case, CaseError, Kind};
use crate::entries::Entries;
use crate::schema::{Form, Scope};
use models::flow::RotationKind;
use models::flow::state::{Background, Flow, Region};
use std::path::Path;

/// Most points of a box.
pub const MOST_POINTS: usize = 1 << 28;

/// Least number of points along an axis.
pub const LEAST_POINTS: usize = 8;

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

/// What all entries are read with.
struct Reader<'a> {
    rotation: RotationKind,
    grid: Grid,
    /// The folder of the case file.
    folder: &'a Path,
}

impl FlowRun {
    /// What the sections of the case say.
    ///
    /// # Errors
    /// What is wrong, where, and what is allowed.
    pub(crate) fn read(
        kind: Kind,
        rotation: RotationKind,
        entries: &Entries,
        folder: &Path,
    ) -> Result<Self, CaseError> {
        let scope = Scope { kind: Some(kind), dimensions: Some(2), axes: Vec::new() };
        let root = entries.structured(scope);
        let grid = Grid::read(&root)?;
        let reader = Reader { rotation, grid, folder };
        Ok(Self {
            rotation,
            grid,
            time: Time::read(&root)?,
            least_shear_rate: grid::least_shear_rate(&root)?,
            initial: reader.initial(&root)?,
            receivers: reader.receivers(&root)?,
            output: reader.output(&root)?,
            places: entries.places.clone(),
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

impl Case {
    /// What rotates in the case's flow in time, and with it what determines the stress angle.
    ///
    /// # Errors
    /// The model is none of a flow that can be run in time.
    pub fn rotation_in_time(&self) -> Result<RotationKind, CaseError> {
        self.kind.rotation_in_time().ok_or_else(|| {
            let found = format!("found {}", self.kind.name());
            let allowed = "a flow whose stress angle is determined: nothing determines it here";
            self.places.error("model.kind", found, allowed)
        })
    }

    /// The uniform flow that a run in time perturbs.
    ///
    /// # Errors
    /// The state is none of a uniform, fully deforming flow of constant volume in its own frame.
    pub fn mean_flow(&self) -> Result<Flow, CaseError> {
        for name in UNIFORM {
            let Some(value) = Key::find(name).and_then(|key| key.field.load(&self.numbers)) else {
                continue;
            };
            if matches!(value, Value::Number(0.0) | Value::Pair([0.0, 0.0])) {
                continue;
            }
            let allowed = match name {
                "model.dilatancy_angle_deg" => "flows are run in time at constant volume: 0",
                "background.velocity" => "leave it out: the box moves with the mean flow",
                _ => "leave it out: the flow that is run in time is uniform",
            };
            return Err(self.places.error(name, format!("found {value}"), allowed));
        }
        let state = self.state();
        let background = self.model()?.background(&state).map_err(|error| self.locate(error))?;
        let flow = match background {
            Background::FullyDeforming(flow) => flow,
            Background::Elsewhere { region, stress } => {
                let (q, r) = (stress.deviator.value, stress.rotational);
                let on_yield = self.model()?.coulomb().yield_deviator(state.pressure).value;
                let is_on_yield = (q - on_yield).abs() <= 1e-9 * on_yield;
                let (key, value) = match is_on_yield {
                    true => ("background.rotational_stress", r),
                    false => ("background.deviatoric_stress", q),
                };
                let place = if region == Region::OutsideYield { "outside" } else { "inside" };
                let found = format!("found {value:?}, {place} yield");
                let allowed = "leave it out: what is run in time deforms, on yield";
                return Err(self.places.error(key, found, allowed));
            }
        };
        let is_undecided = (2.0 * flow.rounded_noncoaxiality()).cos().sign().is_none();
        if flow.spin.is_some() && is_undecided {
            let found = format!("found |Δ| = {:?}°", flow.noncoaxiality.abs().to_degrees());
            let allowed = "another one: on the bound the spin determines no stress angle";
            return Err(self.places.error("background.noncoaxiality_deg", found, allowed));
        }
        Ok(flow)
    }
}
