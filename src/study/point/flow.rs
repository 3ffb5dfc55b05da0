//! Analysis of the state of a flow in the model of the case and in compared models.

use super::background::{FlowStress, PlaneWave};
use super::flow_state::YieldingState;
use crate::case::{Case, Kind, radians};
use crate::study::{OnProgress, report_progress};
use crate::{Error, setup};
use analysis::bound;
use analysis::characteristics;
use analysis::flows::growth_curves::{self as curves, FittedOrder};
use analysis::flows::{FrozenState, Workspace};
use analysis::growth::Assessment;
use analysis::pencil::Roots;
use models::InputError;
use models::flow::Model;
use models::flow::state::{Background, Flow};
use serde::{Serialize, Serializer};

/// Analysis of the state of a flow.
#[derive(Clone, Debug, Serialize)]
pub struct FlowPoint {
    /// Result of the model of the case.
    #[serde(flatten)]
    pub own: FlowAnalysis,
    /// Results of the models in `[compare]`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub compare: Vec<FlowAnalysis>,
}

/// Result of one model on the state.
#[derive(Clone, Debug, Serialize)]
pub struct FlowAnalysis {
    /// Kind of the model.
    #[serde(rename = "model", serialize_with = "kind_name")]
    pub kind: Kind,
    /// State and its analysis.
    #[serde(flatten)]
    pub state: FlowState,
    /// Non-coaxiality Δ of the case, degrees, if this model is coaxial and uses Δ = 0.
    #[serde(skip)]
    pub lost_noncoaxiality_deg: Option<f64>,
}

fn kind_name<S: Serializer>(kind: &Kind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

impl FlowAnalysis {
    /// Returns the state if it is fully deforming.
    pub fn yielding(&self) -> Option<&YieldingState> {
        match &self.state {
            FlowState::Yielding(state) => Some(state),
            FlowState::NotYielding(_) => None,
        }
    }
}

/// State of a flow and its analysis.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum FlowState {
    /// Fully deforming and analysed.
    Yielding(Box<YieldingState>),
    /// Not fully deforming: there are no equations to analyse.
    NotYielding(NotYieldingState),
}

/// State that is not fully deforming.
#[derive(Clone, Debug, Serialize)]
pub struct NotYieldingState {
    /// Position of the state relative to the yield conditions.
    pub region: &'static str,
    #[serde(flatten)]
    nothing: NoAnalysis,
    /// Wave of the case.
    pub wave: PlaneWave,
    /// Stress of the state.
    pub stress: FlowStress,
    words: &'static str,
}

/// Quantities of yielding states only, null in JSON.
#[derive(Clone, Debug)]
struct NoAnalysis;

impl Serialize for NoAnalysis {
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
    fn new(background: &Background, wave: PlaneWave) -> Self {
        Self {
            region: background.region().name(),
            nothing: NoAnalysis,
            wave,
            stress: background.stress().into(),
            words: "the state is not fully deforming: nothing to analyse",
        }
    }
}

/// Analyses the state of a flow. Progress counts two parts per model: verdict and growth rate curves.
///
/// # Errors
/// The case is out of range of its model, or cannot be analysed; [`Error::Cancelled`].
pub fn flow(case: &Case, on_progress: OnProgress) -> Result<FlowPoint, Error> {
    let models = 1 + case.compare.as_ref().map_or(0, Vec::len);
    let mut done = 0;
    let mut part_is_done = || {
        done += 1;
        report_progress(on_progress, done, 2 * models)
    };
    // Keys used by compared models only are ignored for this model.
    let mut own = Analysed::new(&case.for_kind(case.material.kind))?;
    part_is_done()?;
    let noncoaxiality = own.analysis.yielding().map(|state| state.flow.noncoaxiality.to_degrees());
    let mut compared = Vec::new();
    for &kind in case.compare.iter().flatten() {
        let converted = case.for_kind_with(kind, noncoaxiality);
        let mut other = Analysed::new(&converted.case)?;
        other.analysis.lost_noncoaxiality_deg = converted.lost_noncoaxiality_deg;
        compared.push(other);
        part_is_done()?;
    }
    add_curves(case, &mut own, &mut compared, &mut part_is_done)?;
    Ok(FlowPoint {
        own: own.analysis,
        compare: compared.into_iter().map(|other| other.analysis).collect(),
    })
}

/// Result of one model before sampling of growth rates.
struct Analysed {
    analysis: FlowAnalysis,
    workspace: Workspace,
}

impl Analysed {
    fn new(case: &Case) -> Result<Self, Error> {
        let mut workspace = Workspace::default();
        let (model, frozen) = setup::flow::assess(case, &mut workspace)
            .map_err(|error| setup::locate(&case.material, error))?;
        let state = match frozen {
            FrozenState::NotYielding(background) => {
                let wave = (&case.material.numbers.wave).into();
                FlowState::NotYielding(NotYieldingState::new(&background, wave))
            }
            FrozenState::Yielding { flow, assessment } => {
                let state = analyse(case, &model, flow, assessment, &workspace)?;
                FlowState::Yielding(Box::new(state))
            }
        };
        let analysis =
            FlowAnalysis { kind: case.material.kind, state, lost_noncoaxiality_deg: None };
        Ok(Self { analysis, workspace })
    }

    /// Returns the assessment if the equations determine their unknowns (regular pencil).
    fn regular(&self) -> Option<&Assessment> {
        let state = self.analysis.yielding().filter(|_| !self.workspace.pencil.is_singular())?;
        Some(&state.assessment)
    }
}

fn analyse(
    case: &Case,
    model: &Model,
    flow: Flow,
    assessment: Assessment,
    workspace: &Workspace,
) -> Result<YieldingState, Error> {
    let wave = &case.material.numbers.wave;
    let pencil = &workspace.pencil;
    let out_of_reach = |key, found: f64, allowed: &str| {
        case.locate(InputError { input: key, found: format!("{found:?}"), allowed: allowed.into() })
    };
    if !pencil.is_singular() && !workspace.reaches(wave.number) {
        let allowed =
            "a wave number that far from the state's own scale leaves the range of doubles";
        return Err(out_of_reach("wave.number", wave.number, allowed).into());
    }
    let roots = pencil.roots(wave.number, radians(wave.direction_deg));
    if let Roots::Regular { finite, .. } = &roots
        && finite.iter().any(|root| !root.is_finite())
    {
        let allowed = "k·V leaves the range of doubles";
        return Err(out_of_reach("background.velocity", flow.velocity[0], allowed).into());
    }
    let found = characteristics::characteristics(&workspace.system).ok();
    let supremum = bound::supremum(pencil, &assessment, model.gradient_wave_number(&flow));
    Ok(YieldingState::new(wave.into(), model, flow, assessment)
        .with_roots(&roots)
        .with_characteristics(found)
        .with_supremum(supremum))
}

/// Samples the growth rates of all models at the same wave numbers.
fn add_curves(
    case: &Case,
    own: &mut Analysed,
    compared: &mut [Analysed],
    model_is_done: &mut dyn FnMut() -> Result<(), Error>,
) -> Result<(), Error> {
    let wave = case.material.numbers.wave;
    let direction = radians(wave.direction_deg);
    let decades = std::iter::once(&*own)
        .chain(&*compared)
        .filter_map(|a| Some(curves::decades(&a.workspace, a.regular()?, wave.number)))
        .max();
    for a in std::iter::once(own).chain(compared) {
        let (Some(decades), Some(assessment)) = (decades, a.regular()) else {
            model_is_done()?;
            continue;
        };
        let by_direction = curves::by_direction(&a.workspace, assessment, wave.number);
        let by_wave_number =
            curves::by_wave_number(&a.workspace, assessment, wave.number, direction, decades);
        let fitted = curves::fitted_order(&by_wave_number);
        if let FlowState::Yielding(state) = &mut a.analysis.state {
            state.fitted_order = fitted.map(|FittedOrder { order, .. }| order);
            state.fitted_wave_numbers = fitted.map(|FittedOrder { numbers, .. }| numbers);
            (state.by_direction, state.by_wave_number) = (by_direction, by_wave_number);
        }
        model_is_done()?;
    }
    Ok(())
}
