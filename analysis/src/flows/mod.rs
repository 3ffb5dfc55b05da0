//! Analysis of granular flows: verdict on a frozen state, and growth rates against direction and wave number.

pub mod growth_curves;

use crate::growth::{self, Assessment, Growth, Verdict};
use crate::newton_polygon::GrowthOrder;
use crate::pencil::Pencil;
use crate::{AnalysisError, StateError};
use models::flow::Model;
use models::flow::state::{Background, DeformingFlow, MaterialState};
use models::{ClosedFormVerdict, LinearisedSystem};

/// Description of the model-blind method of assessment, for output.
pub const FLOW_ROUTE: &str = "exact dispersion polynomial of the linearised equations, all directions (no model's closed form)";

/// Reusable memory for assessing states one after another; use one per thread.
#[derive(Clone, Debug, Default)]
pub struct FlowWorkspace {
    /// The linearised equations of the last state.
    pub system: LinearisedSystem<2>,
    /// Pencil and dispersion polynomial of the last state.
    pub pencil: Pencil,
}

/// Method by which a verdict is obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Closed-form formula of the model.
    ClosedForm,
    /// Numerical analysis of the linearised equations, independent of the model.
    ModelBlind,
}

impl Route {
    /// Both methods, in the order in which they are tried.
    pub const ALL: [Self; 2] = [Self::ClosedForm, Self::ModelBlind];

    /// Name of the method in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "closed-form",
            Self::ModelBlind => "model-blind",
        }
    }
}

impl From<ClosedFormVerdict> for Verdict {
    /// Converts the result of a closed-form formula.
    fn from(closed_form: ClosedFormVerdict) -> Self {
        match closed_form {
            ClosedFormVerdict::WellPosed => Self::WellPosed,
            ClosedFormVerdict::PowerLawGrowth { order, coefficient, direction } => {
                let order = GrowthOrder { numerator: order.into(), denominator: 1 };
                Self::IllPosed { growth: Some(Growth { order, coefficient }), direction }
            }
            ClosedFormVerdict::UnboundedAtFiniteWaveNumber { direction } => {
                Self::IllPosed { growth: None, direction }
            }
            ClosedFormVerdict::Indeterminate { rank, unknowns } => {
                Self::Indeterminate { rank, unknowns }
            }
        }
    }
}

/// Result of assessing a frozen state of a flow.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "never kept in numbers")]
pub enum FrozenState {
    /// The state yields (is fully deforming) and was assessed.
    Yielding {
        /// The background flow.
        flow: DeformingFlow,
        /// The verdict with its evidence.
        assessment: Assessment,
    },
    /// The state does not yield: there are no equations to assess.
    NotYielding(Background),
}

impl FlowWorkspace {
    /// Assesses a state from its linearised equations.
    ///
    /// # Errors
    /// See [`StateError`].
    pub fn assess_state(
        &mut self,
        model: &Model,
        state: &MaterialState,
    ) -> Result<FrozenState, StateError> {
        let background = model.background(state)?;
        let Background::FullyDeforming(flow) = background else {
            return Ok(FrozenState::NotYielding(background));
        };
        let assessment = self.assess(model, &flow)?;
        Ok(FrozenState::Yielding { flow, assessment })
    }

    /// Assesses a flow from its linearised equations, independent of the model.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn assess(
        &mut self,
        model: &Model,
        flow: &DeformingFlow,
    ) -> Result<Assessment, AnalysisError> {
        self.linearise(model, flow)?;
        Ok(growth::assess(&self.pencil))
    }

    /// Linearises the equations about a flow and computes their dispersion pencil.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn linearise(&mut self, model: &Model, flow: &DeformingFlow) -> Result<(), AnalysisError> {
        model.write_symbol(flow, &mut self.system);
        self.pencil.update(&self.system)
    }

    /// Verdict on a flow by the closed form of the model if it decides, else from the linearised equations.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn decide_verdict(
        &mut self,
        model: &Model,
        flow: &DeformingFlow,
    ) -> Result<(Verdict, Route), AnalysisError> {
        match model.closed_form_verdict(flow) {
            Some(closed_form) => Ok((closed_form.into(), Route::ClosedForm)),
            None => Ok((self.assess(model, flow)?.verdict, Route::ModelBlind)),
        }
    }

    /// Whether the powers of the wave number k (1/m) in the dispersion polynomial of the last state are far from
    /// overflow and underflow.
    pub fn is_in_range(&self, k: f64) -> bool {
        (1e-30..1e30).contains(&(k / self.pencil.polynomial.wave_number_unit))
    }

    /// Largest Re ς of the last state, 1/s, at the wave number `k` (1/m) and `direction` (rad); NaN if there is no
    /// finite root, or if [`is_in_range`](Self::is_in_range) is false for `k`.
    pub fn growth_rate(&self, k: f64, direction: f64) -> f64 {
        if !self.is_in_range(k) {
            return f64::NAN;
        }
        let roots = self.pencil.polynomial.roots(k, direction, &[]);
        roots.iter().map(|root| root.re).fold(f64::NAN, f64::max)
    }
}
