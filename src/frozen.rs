//! A frozen state: from the numbers of a case to an assessed system. What all verbs share.

use crate::Error;
use crate::case::{Case, Kind};
use analysis::AnalysisError;
use analysis::growth::{self, Assessment, Growth, Verdict};
use analysis::newton::Order;
use analysis::pencil::Pencil;
use analysis::sphere::SphereError;
use models::granular_flow::state::{Background, Flow};
use models::granular_flow::{InputError, Model};
use models::plasticity::symbol::NoResponse;
use models::{ClosedForm, LinearisedSystem};

/// Memory for one state after another; one per thread.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// The linearised equations of the last state.
    pub system: LinearisedSystem<2>,
    /// What the analysis made of them.
    pub pencil: Pencil,
}

/// Why a state cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateError {
    /// The model does not take it.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The analysis does not.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A yielding solid has no rate of response.
    #[error(transparent)]
    NoResponse(#[from] NoResponse),
    /// A solid in space cannot be searched.
    #[error(transparent)]
    Sphere(#[from] SphereError),
}

impl StateError {
    /// With the place in the case file.
    pub fn locate(self, case: &Case) -> Error {
        case.locate(self.into_input(case)).into()
    }

    /// The same for a state of the case's map, whose swept numbers stand in \[map\].
    pub fn locate_in_map(self, case: &Case) -> Error {
        case.locate_in_map(self.into_input(case)).into()
    }

    fn into_input(self, case: &Case) -> InputError {
        let state = if let Kind::Solid(_) = case.kind { "model" } else { "background" };
        let (key, allowed) = match self {
            Self::Input(error) => return error,
            Self::Analysis(error) => (state, error.to_string()),
            Self::NoResponse(error) => ("yield", error.to_string()),
            Self::Sphere(error) => ("model", error.to_string()),
        };
        InputError { key, found: "a state that cannot be analysed".into(), allowed }
    }
}

/// How a verdict came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// By a formula of the model.
    ClosedForm,
    /// From the linearised equations as data.
    ModelBlind,
}

impl Route {
    /// Both, in the order in which they are tried.
    pub const ALL: [Self; 2] = [Self::ClosedForm, Self::ModelBlind];

    /// Name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "closed-form",
            Self::ModelBlind => "model-blind",
        }
    }
}

/// A formula's answer as a verdict.
pub fn verdict(closed_form: ClosedForm) -> Verdict {
    match closed_form {
        ClosedForm::WellPosed => Verdict::WellPosed,
        ClosedForm::Grows { order, coefficient, direction } => {
            let order = Order { numerator: order.into(), denominator: 1 };
            Verdict::IllPosed { growth: Some(Growth { order, coefficient }), direction }
        }
        ClosedForm::UnboundedAtFiniteWaveNumber { direction } => {
            Verdict::IllPosed { growth: None, direction }
        }
        ClosedForm::Indeterminate { rank, unknowns } => Verdict::Indeterminate { rank, unknowns },
    }
}

/// A state that was looked at.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "never kept in numbers")]
pub enum Frozen {
    /// Fully deforming, and judged.
    Flowing {
        /// The background.
        flow: Flow,
        /// The verdict with its evidence.
        assessment: Assessment,
    },
    /// Not fully deforming: nothing to judge.
    Elsewhere(Background),
}

impl Workspace {
    /// Judges the state of a case from its linearised equations.
    ///
    /// # Errors
    /// See [`StateError`].
    pub fn judge(&mut self, case: &Case) -> Result<(Model, Frozen), StateError> {
        let model = case.flow_model()?;
        let background = model.background(&case.state())?;
        let Background::FullyDeforming(flow) = background else {
            return Ok((model, Frozen::Elsewhere(background)));
        };
        let assessment = self.assess(&model, &flow)?;
        Ok((model, Frozen::Flowing { flow, assessment }))
    }

    /// Judges a flow from its linearised equations, whatever the model.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn assess(&mut self, model: &Model, flow: &Flow) -> Result<Assessment, AnalysisError> {
        model.symbol(flow, &mut self.system);
        self.pencil.update(&self.system)?;
        Ok(growth::assess(&self.pencil))
    }

    /// The verdict on a flow by a formula where one answers, else from the linearised equations.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn decide(
        &mut self,
        model: &Model,
        flow: &Flow,
    ) -> Result<(Verdict, Route), AnalysisError> {
        match model.closed_form(flow) {
            Some(closed_form) => Ok((verdict(closed_form), Route::ClosedForm)),
            None => Ok((self.assess(model, flow)?.verdict, Route::ModelBlind)),
        }
    }

    /// Whether the powers of a wave number (1/m) in the dispersion polynomial of the last state hold
    /// in doubles with room to spare.
    pub fn reaches(&self, k: f64) -> bool {
        (1e-30..1e30).contains(&(k / self.pencil.polynomial.wave_number))
    }

    /// Greatest Re ς of the last state, 1/s, at the wave number `k` (1/m) and direction (rad); NaN
    /// where there is no finite root, or where the wave is out of reach.
    pub fn growth(&self, k: f64, direction: f64) -> f64 {
        if !self.reaches(k) {
            return f64::NAN;
        }
        let roots = self.pencil.polynomial.roots(k, direction, &[]);
        roots.iter().map(|root| root.re).fold(f64::NAN, f64::max)
    }
}
