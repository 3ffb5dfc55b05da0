//! Analysis of one state of a model given as equations.

use super::flow_state::{Evidence, SupremumLocation};
use super::order_and_coefficient;
use crate::Error;
use crate::case::{Case, degrees_to_radians, derivative_name};
use crate::setup;
use crate::study::format::{describe_evidence_for, format_short};
use crate::study::{ProgressCallback, report_progress};
use analysis::bound::{self, Supremum};
use analysis::equations::{EquationsAssessment, EquationsWorkspace};
use analysis::growth::{Assessment, Verdict};
use analysis::pencil::PencilRoots;
use analysis::space::PLANE_STEP_DEG;
use models::Rounded;
use models::common::elementary::Elementary;
use models::common::system::{LinearisedSystem, RoundedMatrix};
use models::equations::{JetVariable, TextModel, TextState, TextWorkspace};
use serde::Serialize;
use std::f64::consts::PI;

/// Analysis of one state of a model given as equations.
#[derive(Clone, Debug, Serialize)]
pub struct EquationsAnalysis {
    /// Kind of the model, as named in case files.
    pub model: &'static str,
    /// Number of space dimensions.
    pub dimensions: usize,
    /// Name of the verdict.
    pub verdict: &'static str,
    /// Order of growth in the wave number k as k → ∞; `None` unless ill-posed, or if growth is unbounded at finite wave
    /// numbers.
    #[serde(rename = "order")]
    pub growth_order: Option<f64>,
    /// Growth coefficient lim Re ς / k^order as k → ∞, m^order/s; `None` without `growth_order`.
    #[serde(rename = "coefficient")]
    pub growth_coefficient: Option<f64>,
    /// Direction of the wave vector of fastest or unbounded growth, from x₁, degrees; `None` unless ill-posed, and
    /// except in two dimensions.
    pub direction_deg: Option<f64>,
    /// Unit wave vector of fastest or unbounded growth, one component per dimension; `None` unless ill-posed.
    pub direction: Option<Vec<f64>>,
    /// Angle between the planes of wave vectors that were searched in three dimensions, degrees; `None` in fewer.
    pub resolution_deg: Option<f64>,
    /// Supremum of the growth rate Re ς over all waves, 1/s; `None` unless well-posed.
    #[serde(rename = "bound")]
    pub growth_bound: Option<f64>,
    /// Wave vector at which the supremum is attained or approached; in three dimensions with the direction of its
    /// projection on the plane of x₁ and x₂.
    #[serde(rename = "bound_at")]
    pub supremum_location: Option<SupremumLocation>,
    /// Unit wave vector at which the supremum is attained or approached, one component per dimension; `None` without it.
    #[serde(rename = "bound_direction")]
    pub supremum_direction: Option<Vec<f64>>,
    /// Relative tolerance of `growth_bound`; `None` without it.
    pub bound_tolerance: Option<f64>,
    /// Wave vector given in the case.
    pub wave: EquationsWave,
    /// Finite dispersion roots at `wave`, Re ς and Im ς, 1/s; `None` if every ς is a root.
    #[serde(rename = "roots")]
    pub dispersion_roots: Option<Vec<[f64; 2]>>,
    /// Number of infinite dispersion roots, which are due to algebraic equations; `None` if every ς is a root.
    #[serde(rename = "infinite_roots")]
    pub infinite_root_count: Option<usize>,
    /// Evidence on which the verdict is based.
    pub evidence: Evidence,
    /// Background: given values and derivatives, and those determined from the equations.
    pub background: Vec<BackgroundNumber>,
    /// Residual of each equation at the background.
    pub residuals: Vec<EquationResidual>,
    /// Linearised equations.
    pub linearised: LinearisedEquations,
    /// Names of parameters that no equation uses.
    pub unused_parameters: Vec<String>,
    /// Verdict with its evidence.
    #[serde(skip)]
    pub assessment: Assessment,
}

/// Wave vector given in the case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EquationsWave {
    /// Wave number, 1/m.
    #[serde(rename = "number")]
    pub wave_number: f64,
    /// Direction from x₁, degrees.
    pub direction_deg: f64,
    /// Elevation above the x₁x₂ plane, degrees.
    pub elevation_deg: f64,
}

/// A value or derivative of an unknown at the background.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BackgroundNumber {
    /// Unknown.
    pub unknown: &'static str,
    /// `value`, or the derivative as in case files.
    pub derivative: String,
    /// Value in SI units.
    pub value: f64,
    /// Bound on the error of the value.
    pub rounding: f64,
    /// Whether the value was determined from the equations.
    pub is_solved: bool,
}

/// Residual of an equation at the background.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EquationResidual {
    /// Equation.
    pub equation: &'static str,
    /// Left-hand side minus right-hand side.
    pub residual: f64,
    /// Magnitude of the largest term of the equation.
    pub largest_term: f64,
    /// Residual divided by the largest term.
    pub relative: f64,
    /// Whether a body force balances the equation.
    pub is_driven: bool,
}

/// Linearised equations: coefficients of ς and κ = ik by equation and unknown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinearisedEquations {
    /// Names of the equations, one per row.
    pub equations: Vec<&'static str>,
    /// Names of the unknowns, one per column.
    pub unknowns: Vec<&'static str>,
    /// Velocity of the frame to which time derivatives refer, m/s; zero without a declared velocity.
    pub velocity: Vec<f64>,
    /// Coefficients that are not zero.
    pub entries: Vec<LinearisedEntry>,
    /// Coefficients A of ς, by rows.
    pub a: Vec<Vec<f64>>,
    /// Coefficients Bⁱ of κᵢ, one matrix per dimension.
    pub b: Vec<Vec<Vec<f64>>>,
    /// Coefficients C of the unknowns, by rows.
    pub c: Vec<Vec<f64>>,
}

/// A coefficient of the linearised equations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinearisedEntry {
    /// Equation.
    pub equation: &'static str,
    /// Unknown.
    pub unknown: &'static str,
    /// Power of ς.
    pub time_power: u8,
    /// Powers of κ₁, κ₂, κ₃, one per dimension.
    pub space_powers: Vec<u8>,
    /// Value at the background.
    pub value: f64,
    /// Bound on the error of the value.
    pub rounding: f64,
    /// The coefficient as an expression in the names of the model.
    pub expression: String,
}

/// Analyses the state of a case whose model is given as equations. Progress counts two steps: the verdict, and the
/// supremum of the growth rates.
///
/// # Errors
/// The background does not satisfy the equations, or the state cannot be analysed; [`Error::Cancelled`].
pub fn analyse_equations(
    case: &Case,
    on_progress: ProgressCallback,
) -> Result<EquationsAnalysis, Error> {
    let equations = case.require_equations()?;
    let (model, numbers) = (&equations.model, &case.material.numbers);
    let locate = |error| setup::locate_map_point_error(case, error);
    let mut workspace = EquationsWorkspace::default();
    let mut state = equations.state(numbers);
    let found = workspace.assess(model, &mut state).map_err(locate)?;
    report_progress(on_progress, 1, 2)?;
    let located = workspace.locate_supremum(model, &found).map_err(|error| locate(error.into()))?;
    let (supremum, supremum_direction) = located.unzip();
    let supremum = supremum.map(|own| match supremum_direction.as_deref() {
        Some(&[x, y, _]) => Supremum { direction: y.cr_atan2(x).rem_euclid(PI), ..own },
        _ => own,
    });
    let wave = EquationsWave {
        wave_number: numbers.wave.wave_number,
        direction_deg: numbers.wave.direction_deg,
        elevation_deg: numbers.wave.elevation_deg,
    };
    let [direction, elevation] = [wave.direction_deg, wave.elevation_deg].map(degrees_to_radians);
    let roots = workspace
        .roots(model, wave.wave_number, direction, elevation)
        .map_err(|error| locate(error.into()))?;
    let (dispersion_roots, infinite_root_count) = match roots {
        PencilRoots::Regular { finite, infinite } => {
            (Some(finite.iter().map(|root| [root.re, root.im]).collect()), Some(infinite))
        }
        PencilRoots::Singular { .. } => (None, None),
    };
    report_progress(on_progress, 2, 2)?;
    let mut system = LinearisedSystem::default();
    let linearised = model
        .linearise(&state, &mut TextWorkspace::default(), &mut system)
        .map(|()| list_entries(model, &system))
        .map_err(|error| locate(error.into()))?;
    let evidence = Evidence {
        description: describe_verdict(&found, dispersion_roots.as_deref()),
        ..Evidence::from(&found.assessment)
    };
    let residuals = list_residuals(model, &state).map_err(|error| locate(error.into()))?;
    let [growth_order, growth_coefficient] = order_and_coefficient(&found.assessment.verdict);
    let direction_deg = match found.assessment.verdict {
        Verdict::IllPosed { direction, .. } if model.dimensions() == 2 => {
            Some(direction.to_degrees())
        }
        _ => None,
    };
    Ok(EquationsAnalysis {
        model: case.material.kind.name(),
        dimensions: model.dimensions(),
        verdict: found.assessment.verdict.name(),
        growth_order,
        growth_coefficient,
        direction_deg,
        direction: found.direction.clone(),
        resolution_deg: (model.dimensions() == 3).then_some(PLANE_STEP_DEG),
        growth_bound: supremum.map(|own| own.growth_rate),
        supremum_location: supremum.map(SupremumLocation::from),
        supremum_direction,
        bound_tolerance: supremum.map(|_| bound::SUPREMUM_TOLERANCE),
        wave,
        dispersion_roots,
        infinite_root_count,
        evidence,
        background: list_background(model, &state),
        residuals,
        linearised,
        unused_parameters: model.unused_parameters().to_vec(),
        assessment: found.assessment,
    })
}

/// Describes as text the evidence of the verdict; `roots` are the dispersion roots of one wave.
fn describe_verdict(found: &EquationsAssessment, roots: Option<&[[f64; 2]]>) -> String {
    let verdict = &found.assessment.verdict;
    if *verdict == Verdict::WellPosed && roots.is_some_and(<[_]>::is_empty) {
        return "no dispersion roots: no wave evolves in time".to_owned();
    }
    let waves = match found.direction.as_deref() {
        Some([_]) => "waves along x₁".to_owned(),
        Some(&[x, y]) => {
            format!("wave vectors at {}°", format_short(y.cr_atan2(x).to_degrees()))
        }
        Some(components) => format!("wave vectors along ({})", format_components(components)),
        None => "all waves".to_owned(),
    };
    describe_evidence_for(verdict, &waves)
}

/// Lists the components of a unit vector as text.
pub(crate) fn format_components(vector: &[f64]) -> String {
    // No rounding errors of components that are zero.
    let format = |own: &f64| format_short(if own.abs() < 1e-12 { 0.0 } else { *own });
    let components: Vec<String> = vector.iter().map(format).collect();
    components.join(", ")
}

fn list_background(model: &TextModel, state: &TextState) -> Vec<BackgroundNumber> {
    let mut numbers: Vec<(JetVariable, Rounded)> = state.background.clone();
    numbers.sort_by_key(|(variable, _)| *variable);
    let number = |(variable, value): (JetVariable, Rounded)| BackgroundNumber {
        unknown: model.unknowns()[variable.unknown].name,
        derivative: derivative_name(variable),
        value: value.value,
        rounding: value.bound,
        is_solved: state.solved.contains(&variable),
    };
    numbers.into_iter().map(number).collect()
}

fn list_residuals(
    model: &TextModel,
    state: &TextState,
) -> Result<Vec<EquationResidual>, models::equations::EvaluationError> {
    let found = model.residuals(state, &mut TextWorkspace::default())?;
    let residual =
        |(own, &equation): (models::equations::Residual, &&'static str)| EquationResidual {
            equation,
            residual: own.residual.value,
            largest_term: own.largest_term,
            relative: own.relative(),
            is_driven: own.is_driven,
        };
    Ok(found.into_iter().zip(model.equations()).map(residual).collect())
}

fn list_entries(model: &TextModel, system: &LinearisedSystem<3>) -> LinearisedEquations {
    let dimensions = model.dimensions();
    let value_of = |row: usize, variable: JetVariable| {
        let at = (row, variable.unknown);
        let [time, space @ ..] = variable.orders;
        match (time, space.iter().sum::<u8>()) {
            (0, 0) => system.c[at],
            (1, 0) => system.a[at],
            (0, 1) => {
                space.iter().position(|own| *own == 1).map_or(Rounded::ZERO, |i| system.b[i][at])
            }
            _ => system
                .higher_terms
                .iter()
                .find(|term| {
                    (term.row, term.column) == at
                        && term.time_power == time
                        && term.space_powers == space
                })
                .map_or(Rounded::ZERO, |term| term.coefficient),
        }
    };
    let entries = model
        .entries()
        .iter()
        .filter_map(|entry| {
            let value = value_of(entry.row, entry.variable);
            let [time_power, space @ ..] = entry.variable.orders;
            (!value.is_structural_zero()).then(|| LinearisedEntry {
                equation: model.equations()[entry.row],
                unknown: model.unknowns()[entry.variable.unknown].name,
                time_power,
                space_powers: space[..dimensions].to_vec(),
                value: value.value,
                rounding: value.bound,
                expression: entry.expression.clone(),
            })
        })
        .collect();
    let rows = |matrix: &RoundedMatrix| -> Vec<Vec<f64>> {
        matrix.row_iter().map(|row| row.iter().map(|own| own.value).collect()).collect()
    };
    LinearisedEquations {
        equations: model.equations().to_vec(),
        unknowns: model.unknowns().iter().map(|own| own.name).collect(),
        velocity: system.velocity[..dimensions].to_vec(),
        entries,
        a: rows(&system.a),
        b: system.b[..dimensions].iter().map(rows).collect(),
        c: rows(&system.c),
    }
}
