//! A case in the units and types of the models.

use super::case::Case;
use super::error::CaseError;
use super::keys::keys;
use super::kind::{Kind, names};
use models::InputError;
use models::flow::state::State;
use models::flow::{FlowKind as Flow, Model};

/// The state of a case for another kind of model.
#[derive(Clone, Debug, PartialEq)]
pub struct Converted {
    /// The state, as far as that kind can take it.
    pub case: Case,
    /// The non-coaxiality of the state, degrees, where that kind cannot take it and has 0 instead.
    pub lost_noncoaxiality_deg: Option<f64>,
}

/// An angle in radians. Whole turns are taken off in degrees, where that is exact: the sine of
/// 1e308° means something, that of 1.7e306 rad is noise. Angles below a turn keep every bit.
pub fn radians(degrees: f64) -> f64 {
    (degrees % 360.0).to_radians()
}

impl Case {
    /// The same state for another kind of model, without what that kind does not use.
    pub fn for_kind(&self, kind: Kind) -> Self {
        let yields = self.yields.filter(|set| kind.yield_sets().contains(set));
        let mut case = self.clone();
        (case.kind, case.yields, case.compare) = (kind, yields, None);
        if kind != self.kind {
            (case.dynamics, case.flow) = (None, None);
        }
        let medium = case.medium();
        for key in keys().iter().filter(|key| !key.is_used_by(medium)) {
            key.clear(&mut case.numbers);
        }
        case
    }

    /// The same state for another kind of model, with the non-coaxiality that a given spin stands
    /// for: `noncoaxiality_deg` is what the case's own model made of it, in degrees.
    ///
    /// A kind without spin would otherwise be given another state, coaxial by default. The plastic
    /// potential is coaxial by definition: what it loses is handed back, to be told the reader.
    pub fn for_kind_with(&self, kind: Kind, noncoaxiality_deg: Option<f64>) -> Converted {
        let mut case = self.for_kind(kind);
        let mut lost_noncoaxiality_deg = None;
        let state = self.numbers.background.noncoaxiality_deg.or(noncoaxiality_deg);
        let other = &mut case.numbers.background;
        if matches!(kind, Kind::Flow(flow) if flow.is_coaxial()) && kind != self.kind {
            // Axes have no sense: half a turn apart they are the same.
            lost_noncoaxiality_deg = state.filter(|delta| delta % 180.0 != 0.0);
            other.noncoaxiality_deg = Some(0.0);
        } else if self.numbers.background.spin.is_some() && other.spin.is_none() {
            other.noncoaxiality_deg = state;
        }
        Converted { case, lost_noncoaxiality_deg }
    }

    /// The state in the units of the models.
    pub fn state(&self) -> State {
        let given = &self.numbers.background;
        State {
            density: given.density,
            pressure: given.pressure,
            deviatoric_stress: given.deviatoric_stress,
            rotational_stress: given.rotational_stress,
            stress_angle: radians(given.stress_angle_deg),
            shear_rate: given.shear_rate,
            velocity: given.velocity,
            half_vorticity: given.half_vorticity,
            noncoaxiality: given.noncoaxiality_deg.map(radians),
            spin: given.spin,
            pressure_gradient: given.pressure_gradient,
            stress_angle_gradient: given.stress_angle_gradient_deg.map(f64::to_radians),
            spin_gradient: given.spin_gradient,
            density_gradient: given.density_gradient,
            spin_acceleration: given.spin_acceleration,
            inertia_rate: given.inertia_rate,
            inertia_gradient: given.inertia_gradient,
            velocity_gradient: given.velocity_gradient,
            acceleration: given.acceleration,
            body_moment: given.body_moment,
            stress_angle_rate: given.stress_angle_rate_deg.map(f64::to_radians),
        }
    }

    /// The model, with its constants checked.
    ///
    /// # Errors
    /// The constant that is out of range, and where it stands.
    pub fn model(&self) -> Result<Model, CaseError> {
        self.flow_model().map_err(|error| self.locate(error))
    }

    /// The same without the place.
    ///
    /// # Errors
    /// The constant that is out of range, or that the case is one of a solid.
    pub fn flow_model(&self) -> Result<Model, InputError> {
        let flow = self.flow_kind()?;
        let mut constants = Vec::new();
        self.numbers.model.in_order(flow.parameters(), &mut constants);
        Model::new(flow, &constants)
    }

    /// Gives the case's constants to a model of its kind, by way of a list that is kept; no memory is
    /// taken.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn set_constants(
        &self,
        model: &mut Model,
        constants: &mut Vec<f64>,
    ) -> Result<(), InputError> {
        self.numbers.model.in_order(model.kind().parameters(), constants);
        model.set(constants)
    }

    fn flow_kind(&self) -> Result<Flow, InputError> {
        match self.kind {
            Kind::Flow(flow) => Ok(flow),
            Kind::Solid(_) => Err(InputError {
                input: "kind",
                found: format!("{}, a solid", self.kind.name()),
                allowed: format!(
                    "this needs a flow ({}); for solids see wellposed dispersion and speeds",
                    names(&Kind::flows())
                ),
            }),
        }
    }
}
