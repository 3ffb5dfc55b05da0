//! Analysis of the state of a flow in the model of the case and in compared models.

use super::background::FlowStress;
use super::flow_state::YieldingState;
use crate::case::{Case, ModelKind, SweepParameter, degrees_to_radians};
use crate::setup::check::flow::FlowWave;
use crate::study::{ProgressCallback, report_progress};
use crate::{Error, setup};
use analysis::bound;
use analysis::characteristics;
use analysis::flows::growth_curves::{self, FittedOrder};
use analysis::flows::{FlowWorkspace, FrozenState};
use analysis::growth::Assessment;
use analysis::pencil::PencilRoots;
use models::InputError;
use models::common::decimal::{format_exact, format_rounded};
use models::common::elementary::Elementary;
use models::flow::Model;
use models::flow::state::{Background, DeformingFlow};
use serde::{Serialize, Serializer};

/// Analysis of the state of a flow, in the model of the case and in the compared models.
#[derive(Clone, Debug, Serialize)]
pub struct FlowAnalysis {
    /// Analysis in the model of the case.
    #[serde(flatten)]
    pub analysis: FlowModelAnalysis,
    /// Analyses in the models that `[compare]` names.
    #[serde(rename = "compare", skip_serializing_if = "Vec::is_empty")]
    pub compared_analyses: Vec<FlowModelAnalysis>,
}

/// Analysis of the state of a case in one model.
#[derive(Clone, Debug, Serialize)]
pub struct FlowModelAnalysis {
    /// Kind of the model in which the state is analysed.
    #[serde(rename = "model", serialize_with = "serialize_kind")]
    pub kind: ModelKind,
    /// State of the flow according to the model, with its analysis if it is fully deforming.
    #[serde(flatten)]
    pub state: FlowState,
    /// Non-coaxiality Δ of the case, degrees, if this model is coaxial and uses Δ = 0.
    #[serde(skip)]
    pub replaced_noncoaxiality_deg: Option<f64>,
}

fn serialize_kind<S: Serializer>(kind: &ModelKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

impl FlowModelAnalysis {
    /// Returns the state if it is fully deforming.
    pub fn yielding_state(&self) -> Option<&YieldingState> {
        match &self.state {
            FlowState::Yielding(state) => Some(state),
            FlowState::NotYielding(_) => None,
        }
    }
}

/// State of a flow according to one model, with its analysis if it is fully deforming.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum FlowState {
    /// Fully deforming state and its analysis.
    Yielding(Box<YieldingState>),
    /// Not fully deforming: there are no equations to analyse.
    NotYielding(NotYieldingState),
}

/// State that is not fully deforming, which has no equations to analyse.
#[derive(Clone, Debug, Serialize)]
pub struct NotYieldingState {
    /// Name of the region of the yield conditions in which the state is.
    #[serde(rename = "region")]
    pub yield_region: &'static str,
    #[serde(flatten)]
    absent_analysis: AbsentAnalysis,
    /// Wave number and direction given in the case.
    pub wave: FlowWave,
    /// Stress of the state that is not fully deforming.
    pub stress: FlowStress,
    #[serde(rename = "words")]
    description: &'static str,
}

/// Serialises as `null` all quantities that only fully deforming states have.
#[derive(Clone, Debug)]
struct AbsentAnalysis;

impl Serialize for AbsentAnalysis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let keys = [
            "verdict",
            "order",
            "coefficient",
            "direction_deg",
            "fitted_order",
            "fitted_wave_numbers",
            "bound",
            "bound_at",
            "noncoaxiality_bound_deg",
            "power",
            "roots",
            "infinite_roots",
            "characteristics",
        ];
        serializer.collect_map(keys.map(|key| (key, ())))
    }
}

impl NotYieldingState {
    fn new(background: &Background, wave: FlowWave) -> Self {
        Self {
            yield_region: background.region().name(),
            absent_analysis: AbsentAnalysis,
            wave,
            stress: background.stress().into(),
            description: "the state is not fully deforming: nothing to analyse",
        }
    }
}

/// Analyses the state of a flow. Progress counts two steps per model: the verdict, and the growth rate curves.
///
/// # Errors
/// The case is out of range of its model, or cannot be analysed; [`Error::Cancelled`].
pub fn analyse_flow(case: &Case, on_progress: ProgressCallback) -> Result<FlowAnalysis, Error> {
    let models = 1 + case.compared_kinds.as_ref().map_or(0, Vec::len);
    let mut done = 0;
    let mut report_model_step = || {
        done += 1;
        report_progress(on_progress, done, 2 * models)
    };
    // The conversion drops keys that only compared models use.
    let mut case_model = AnalysisWithWorkspace::new(&case.convert_to_kind(case.material.kind))?;
    report_model_step()?;
    let noncoaxiality =
        case_model.analysis.yielding_state().map(|state| state.flow.noncoaxiality.to_degrees());
    let mut compared = Vec::new();
    for &kind in case.compared_kinds.iter().flatten() {
        let converted = case.convert_with_noncoaxiality(kind, noncoaxiality);
        let mut other = AnalysisWithWorkspace::new(&converted.case)?;
        other.analysis.replaced_noncoaxiality_deg = converted.lost_noncoaxiality_deg;
        compared.push(other);
        report_model_step()?;
    }
    add_growth_curves(case, &mut case_model, &mut compared, &mut report_model_step)?;
    Ok(FlowAnalysis {
        analysis: case_model.analysis,
        compared_analyses: compared.into_iter().map(|other| other.analysis).collect(),
    })
}

/// Analysis in one model with its workspace, which is needed to sample growth rates.
struct AnalysisWithWorkspace {
    analysis: FlowModelAnalysis,
    workspace: FlowWorkspace,
}

impl AnalysisWithWorkspace {
    fn new(case: &Case) -> Result<Self, Error> {
        let mut workspace = FlowWorkspace::default();
        let (model, frozen) = setup::flow::assess_flow_state(case, &mut workspace)
            .map_err(|error| setup::locate_state_error(&case.material, error))?;
        let state = match frozen {
            FrozenState::NotYielding(background) => {
                let wave = (&case.material.numbers.wave).into();
                FlowState::NotYielding(NotYieldingState::new(&background, wave))
            }
            FrozenState::Yielding { flow, assessment } => {
                let state = analyse_yielding_state(case, &model, flow, assessment, &workspace)?;
                FlowState::Yielding(Box::new(state))
            }
        };
        let analysis =
            FlowModelAnalysis { kind: case.material.kind, state, replaced_noncoaxiality_deg: None };
        Ok(Self { analysis, workspace })
    }

    /// Returns the assessment of a fully deforming state whose equations determine their unknowns (regular pencil);
    /// `None` for other states.
    fn regular_assessment(&self) -> Option<&Assessment> {
        let state =
            self.analysis.yielding_state().filter(|_| !self.workspace.pencil.is_singular())?;
        Some(&state.assessment)
    }
}

/// Returns the key and the value of the number of the case whose decimal exponent is largest in magnitude.
fn find_extreme_number(case: &Case) -> (&'static str, f64) {
    let numbers = SweepParameter::all_parameters()
        .filter_map(|own| Some((own.key().name, own.value(&case.material.numbers)?)))
        .filter(|(_, value)| *value != 0.0);
    let exponent = |value: f64| value.abs().cr_log10().abs();
    let most = numbers.max_by(|one, other| exponent(one.1).total_cmp(&exponent(other.1)));
    most.unwrap_or(("wave.number", case.material.numbers.wave.wave_number))
}

fn analyse_yielding_state(
    case: &Case,
    model: &Model,
    flow: DeformingFlow,
    assessment: Assessment,
    workspace: &FlowWorkspace,
) -> Result<YieldingState, Error> {
    let wave = &case.material.numbers.wave;
    let pencil = &workspace.pencil;
    let create_range_error = |key, found: f64, allowed: &str| {
        case.locate_error(InputError {
            input: key,
            rejected_value: format_exact(found),
            allowed_values: allowed.into(),
        })
    };
    if !pencil.is_singular() && !workspace.is_in_range(wave.wave_number) {
        let (key, found) = find_extreme_number(case);
        let number = format_rounded(wave.wave_number);
        let allowed = format!(
            "with it the growth rates at wave.number = {number} are too large or too small for a computer; expected a \
             realistic value, such as those of bundled cases"
        );
        return Err(create_range_error(key, found, &allowed).into());
    }
    let roots = pencil.roots(wave.wave_number, degrees_to_radians(wave.direction_deg));
    if let PencilRoots::Regular { finite, .. } = &roots
        && finite.iter().any(|root| !root.is_finite())
    {
        let allowed = "expected a velocity for which k·V is in the range of doubles";
        return Err(create_range_error("background.velocity", flow.velocity[0], allowed).into());
    }
    let found = characteristics::characteristics(&workspace.system).ok();
    let supremum = bound::locate_supremum(pencil, &assessment, model.gradient_wave_number(&flow));
    Ok(YieldingState::new(wave.into(), model, flow, assessment)
        .with_roots(&roots)
        .with_characteristics(found)
        .with_supremum(supremum))
}

/// Samples the growth rates of all models with a fully deforming state and a regular pencil, by direction and by wave
/// number; the curves by wave number of all models have the same wave numbers.
fn add_growth_curves(
    case: &Case,
    case_model: &mut AnalysisWithWorkspace,
    compared: &mut [AnalysisWithWorkspace],
    report_model_done: &mut dyn FnMut() -> Result<(), Error>,
) -> Result<(), Error> {
    let wave = case.material.numbers.wave;
    let direction = degrees_to_radians(wave.direction_deg);
    let decades = std::iter::once(&*case_model)
        .chain(&*compared)
        .filter_map(|a| {
            Some(growth_curves::decades_to_asymptote(
                &a.workspace,
                a.regular_assessment()?,
                wave.wave_number,
            ))
        })
        .max();
    for a in std::iter::once(case_model).chain(compared) {
        let (Some(decades), Some(assessment)) = (decades, a.regular_assessment()) else {
            report_model_done()?;
            continue;
        };
        let by_direction =
            growth_curves::growth_by_direction(&a.workspace, assessment, wave.wave_number);
        let by_wave_number = growth_curves::growth_by_wave_number(
            &a.workspace,
            assessment,
            wave.wave_number,
            direction,
            decades,
        );
        let fitted = growth_curves::fit_order(&by_wave_number);
        if let FlowState::Yielding(state) = &mut a.analysis.state {
            state.fitted_order = fitted.map(|FittedOrder { order, .. }| order);
            state.fitted_wave_numbers = fitted.map(|FittedOrder { wave_numbers, .. }| wave_numbers);
            (state.growth_by_direction, state.growth_by_wave_number) =
                (by_direction, by_wave_number);
        }
        report_model_done()?;
    }
    Ok(())
}
