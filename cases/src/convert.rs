//! Conversion of a case to the units and types of the models, and to another kind of model.

use super::case::Case;
use super::error::CaseError;
use super::flow::ZERO_IN_UNIFORM_FLOW;
use super::keys::{Key, keys};
use super::kind::{ModelKind, join_names};
use super::material::Material;
use super::value::CaseValue;
use models::InputError;
use models::common::decimal::{format_exact, format_rounded};
use models::flow::state::{Background, DeformingFlow, MaterialState, YieldRegion};
use models::flow::{FlowKind, Model, RotationKind};

/// Result of converting the state of a case to another kind of model.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertedCase {
    /// The case of the new kind of model; quantities not used by this kind have been dropped.
    pub case: Case,
    /// Non-coaxiality of the state, degrees, if it was lost because the new kind of model is coaxial by definition.
    pub lost_noncoaxiality_deg: Option<f64>,
}

/// Converts an angle from degrees to radians. Full turns are removed in degrees, where the remainder is exact; the
/// rounding error of 1e308° in radians would exceed a full turn. The reduction does not change angles of magnitude
/// below a full turn.
pub fn degrees_to_radians(degrees: f64) -> f64 {
    (degrees % 360.0).to_radians()
}

impl Case {
    /// Returns the same state for another kind of model. Dropped are quantities not used by `kind`, a yield set that
    /// `kind` does not admit, the section `[compare]` and, if the kind changes, the simulation.
    pub fn convert_to_kind(&self, kind: ModelKind) -> Self {
        let yields =
            self.material.yield_set.filter(|set| kind.admissible_yield_sets().contains(set));
        let mut case = self.clone();
        (case.material.kind, case.material.yield_set, case.compared_kinds) = (kind, yields, None);
        if kind != self.material.kind {
            (case.solid_run, case.flow_run) = (None, None);
        }
        let medium = case.medium();
        for key in keys().iter().filter(|key| !key.is_used_by(medium)) {
            key.reset_value(&mut case.material.numbers);
        }
        case
    }

    /// Returns the same state for another kind of model. A given spin that `kind` does not use is replaced by the
    /// non-coaxiality `noncoaxiality_deg` (degrees), which the model of this case derived from the spin.
    ///
    /// Without the replacement a kind without spin would be given a different, coaxial state. If `kind` is coaxial by
    /// definition, the non-coaxiality is set to 0; a lost value other than a multiple of 180° is returned for a
    /// warning.
    pub fn convert_with_noncoaxiality(
        &self,
        kind: ModelKind,
        noncoaxiality_deg: Option<f64>,
    ) -> ConvertedCase {
        let mut case = self.convert_to_kind(kind);
        let mut lost_noncoaxiality_deg = None;
        let state = self.material.numbers.background.noncoaxiality_deg.or(noncoaxiality_deg);
        let other = &mut case.material.numbers.background;
        if matches!(kind, ModelKind::Flow(flow) if flow.is_coaxial()) && kind != self.material.kind
        {
            // Principal axes are defined modulo 180°.
            lost_noncoaxiality_deg = state.filter(|delta| delta % 180.0 != 0.0);
            other.noncoaxiality_deg = Some(0.0);
        } else if self.material.numbers.background.spin.is_some() && other.spin.is_none() {
            other.noncoaxiality_deg = state;
        }
        ConvertedCase { case, lost_noncoaxiality_deg }
    }

    /// Converts the state of the flow to SI units and rad.
    pub fn to_flow_state(&self) -> MaterialState {
        let given = &self.material.numbers.background;
        MaterialState {
            density: given.density,
            pressure: given.pressure,
            deviatoric_stress: given.deviatoric_stress,
            rotational_stress: given.rotational_stress,
            stress_angle: degrees_to_radians(given.stress_angle_deg),
            shear_rate: given.shear_rate,
            velocity: given.velocity,
            half_vorticity: given.half_vorticity,
            noncoaxiality: given.noncoaxiality_deg.map(degrees_to_radians),
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

    /// Builds the flow model with checked constants.
    ///
    /// # Errors
    /// A constant is out of range; the error gives its position in the case file.
    pub fn build_located_model(&self) -> Result<Model, CaseError> {
        self.build_model().map_err(|error| self.locate_error(error))
    }

    /// Builds the flow model with checked constants; errors carry no position in the case file.
    ///
    /// # Errors
    /// A constant is out of range, or the case describes a solid.
    pub fn build_model(&self) -> Result<Model, InputError> {
        Model::new(self.flow_kind()?, &self.model_constants())
    }

    /// Returns the constants of the model in the order of its registry entry, in SI units and rad; NaN for absent
    /// constants.
    pub fn model_constants(&self) -> Vec<f64> {
        let mut constants = Vec::new();
        let Material { kind, numbers, .. } = &self.material;
        numbers.model_constants.collect_si_values(kind.parameters(), &mut constants);
        constants
    }

    fn flow_kind(&self) -> Result<FlowKind, InputError> {
        match self.material.kind {
            ModelKind::Flow(flow) => Ok(flow),
            ModelKind::Solid(_) => Err(InputError {
                input: "kind",
                rejected_value: format!("{}, a solid", self.material.kind.name()),
                allowed_values: format!(
                    "expected a flow ({}); for solids see wellposed dispersion and speeds",
                    join_names(&ModelKind::flow_kinds())
                ),
            }),
            ModelKind::Rheology | ModelKind::Equations => {
                Err(self.material.unsuitable_kind_error())
            }
        }
    }
    /// Returns the kind of material rotation of a time-domain flow; it determines the equation of the stress angle.
    ///
    /// # Errors
    /// The model is a solid, or a flow without time-domain solver.
    pub fn simulation_rotation(&self) -> Result<RotationKind, CaseError> {
        self.material.kind.simulation_rotation().ok_or_else(|| {
            let found = format!("found {}", self.material.kind.name());
            let allowed = "use a flow model that determines the stress angle";
            self.material.positions.key_error("model.kind", found, allowed)
        })
    }

    /// Returns the uniform mean flow of a time-domain simulation.
    ///
    /// # Errors
    /// The case describes a solid, a constant or the state is invalid, a quantity of [`ZERO_IN_UNIFORM_FLOW`] is not 0,
    /// the flow is not fully deforming, or the spin does not determine the stress angle.
    pub fn solve_mean_flow(&self) -> Result<DeformingFlow, CaseError> {
        for name in ZERO_IN_UNIFORM_FLOW {
            let Some(value) = Key::find_by_name(name)
                .and_then(|key| key.storage.load_value(&self.material.numbers))
            else {
                continue;
            };
            if matches!(value, CaseValue::Number(0.0) | CaseValue::Pair([0.0, 0.0])) {
                continue;
            }
            let allowed = match name {
                "model.dilatancy_angle_deg" => "expected 0: simulated flows are isochoric",
                "background.velocity" => "leave it out: the box moves with the mean flow",
                _ => "leave it out: simulated mean flows are uniform",
            };
            return Err(self.material.positions.key_error(name, format!("found {value}"), allowed));
        }
        let state = self.to_flow_state();
        let background = self
            .build_located_model()?
            .background(&state)
            .map_err(|error| self.locate_error(error))?;
        let flow = match background {
            Background::FullyDeforming(flow) => flow,
            Background::NotDeforming { region, stress } => {
                let (q, r) = (stress.deviator.value, stress.rotational_stress);
                let on_yield =
                    self.build_located_model()?.coulomb().yield_deviator(state.pressure).value;
                let is_on_yield = (q - on_yield).abs() <= 1e-9 * on_yield;
                let (key, value) = match is_on_yield {
                    true => ("background.rotational_stress", r),
                    false => ("background.deviatoric_stress", q),
                };
                let location =
                    if region == YieldRegion::OutsideYield { "outside" } else { "inside" };
                let found = format!("found {}, {location} yield", format_exact(value));
                let allowed = "leave it out: simulated flows are at yield";
                return Err(self.material.positions.key_error(key, found, allowed));
            }
        };
        let is_undecided = (2.0 * flow.rounded_noncoaxiality()).cos().sign().is_none();
        if flow.spin.is_some() && is_undecided {
            let found =
                format!("found |Δ| = {}°", format_rounded(flow.noncoaxiality.abs().to_degrees()));
            let allowed =
                "use another value: at the bound the spin does not determine the stress angle";
            return Err(self.material.positions.key_error(
                "background.noncoaxiality_deg",
                found,
                allowed,
            ));
        }
        Ok(flow)
    }
}
