//! Checks of plane waves in granular and porous media: fronts, plateaus and dissipation of the exact solution, and those
//! of the solver.

use crate::Error;
use crate::case::plane_wave::ContactMedium;
use crate::case::{Case, CaseError};
use crate::setup::check::locate_agreement_error;
use crate::setup::check::shocks::ShockCheckPlan;
use crate::setup::plane_wave::{PlaneWaveMedium, create_medium};
use crate::study::ProgressCallback;
use crate::study::shocks::{
    PistonWaves, ProfilePoint, create_spall, list_profile_points, list_spall_points,
};
use agreement::shocks::{
    ColumnResult, PistonColumn, ShockResult, SpallColumn, compare_piston, compare_spall,
};
use agreement::{AgreementError, MeasurementError};
use analysis::plane_shocks::column::Spall;
use dynamics::medium::Medium;
use models::uniaxial::UniaxialDiagram;
use serde::Serialize;

use super::max_with_nan_largest;

/// Check result of plane waves in a granular or porous medium.
#[derive(Clone, Debug, Serialize)]
pub struct ShockCheck {
    /// Check of each problem of the case on each column.
    pub columns: Vec<ColumnCheck>,
}

/// Check of a problem on a column of a number of cells.
#[derive(Clone, Debug, Serialize)]
pub struct ColumnCheck {
    /// Section of the problem: `piston` or `spall`.
    pub problem: &'static str,
    /// Number of cells.
    pub cells: usize,
    /// Number of time steps; 0 without measurement.
    pub steps: usize,
    /// Time of the profile, s; 0 without measurement.
    pub time: f64,
    /// Reason why the solver cannot measure; `None` if it does.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
    /// Checks of quantities.
    #[serde(rename = "rows")]
    pub quantity_checks: Vec<QuantityCheck>,
    /// Exact profile: both sides of every front. Positions of a spall are distances from the free end.
    #[serde(skip)]
    pub exact_profile: Vec<ProfilePoint>,
    /// Measured profile: centre of a cell, m, velocity, m/s, and pressure −σ₁₁, Pa.
    #[serde(skip)]
    pub measured_profile: Vec<[f64; 3]>,
}

/// Check of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityCheck {
    /// Name of the quantity.
    pub quantity: String,
    /// Unit; empty for quantities without dimension.
    pub unit: &'static str,
    /// Value of the exact solution.
    pub predicted: f64,
    /// Value of the solver; `None` without measurement.
    pub measured: Option<f64>,
    /// Measured minus predicted value, relative to `scale`; `None` without measurement.
    #[serde(rename = "difference")]
    pub relative_difference: Option<f64>,
    /// Magnitude to which the difference is related: the predicted value unless that is 0.
    pub scale: f64,
    /// Tolerance of the relative difference.
    pub tolerance: f64,
    /// Reason why there is no measurement; `None` if there is one.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
    /// Whether the difference is within the tolerance; `None` without measurement.
    #[serde(rename = "agrees")]
    pub is_in_agreement: Option<bool>,
}

/// Exact problem of a case.
enum ExactProblem {
    Piston(Box<PistonWaves>),
    Spall(Spall),
}

/// Checks the plane waves of a case; the inner error is the reason why the exact solution does not cover the case. The medium
/// of the plan is that of the case except in tests, which verify that the check detects a difference.
///
/// # Errors
/// A constant is out of range, or the study was cancelled.
pub fn check_shocks(
    case: &Case,
    plan: &ShockCheckPlan,
    on_progress: ProgressCallback,
) -> Result<Result<ShockCheck, CaseError>, Error> {
    let medium = create_medium(case)?;
    let diagram = medium.loading_diagram();
    let problems = match create_problems(case, &medium, &diagram) {
        Ok(problems) => problems,
        Err(error) => return Ok(Err(error)),
    };
    let runs = problems.len() * plan.cell_counts.len();
    let mut columns = Vec::new();
    for problem in &problems {
        for &cells in &plan.cell_counts {
            let done_runs = columns.len();
            let on_run_progress =
                |done: usize, all: usize| on_progress(done_runs * all + done, runs * all);
            let compared = problem
                .compare(case, &diagram, &plan.solver_medium, cells, &on_run_progress)
                .map_err(|error| locate_agreement_error(&case.material, error))?;
            columns.push(problem.check(cells, compared));
        }
    }
    Ok(Ok(ShockCheck { columns }))
}

fn create_problems(
    case: &Case,
    medium: &PlaneWaveMedium,
    diagram: &UniaxialDiagram,
) -> Result<Vec<ExactProblem>, CaseError> {
    let options = case.require_plane_wave()?;
    let mut problems = Vec::new();
    if let Some(own) = &options.piston {
        let waves = PistonWaves::new(case, medium, diagram, own)?;
        problems.push(ExactProblem::Piston(Box::new(waves)));
    }
    if let Some(own) = &options.spall {
        let spall = create_spall(case, medium, diagram, own)?;
        problems.push(ExactProblem::Spall(spall));
    }
    Ok(problems)
}

impl ExactProblem {
    fn compare(
        &self,
        case: &Case,
        diagram: &UniaxialDiagram,
        medium: &Medium,
        cells: usize,
        on_progress: ProgressCallback,
    ) -> Result<Result<ColumnResult, MeasurementError>, AgreementError> {
        match self {
            Self::Piston(own) => {
                let problem = PistonColumn {
                    medium,
                    load: own.load,
                    solution: &own.solution,
                    release: own.release.as_ref(),
                    diagrams: [diagram, &own.unloading],
                    plastic_power: plastic_power(case),
                    time: own.profile.time,
                };
                compare_piston(&problem, cells, on_progress)
            }
            Self::Spall(spall) => compare_spall(&SpallColumn { medium, spall }, cells, on_progress),
        }
    }

    fn check(&self, cells: usize, compared: Result<ColumnResult, MeasurementError>) -> ColumnCheck {
        let problem = match self {
            Self::Piston(_) => "piston",
            Self::Spall(_) => "spall",
        };
        let found = match compared {
            Ok(found) => found,
            Err(error) => {
                return ColumnCheck {
                    problem,
                    cells,
                    steps: 0,
                    time: 0.0,
                    unmeasured_reason: Some(error.to_string()),
                    quantity_checks: Vec::new(),
                    exact_profile: Vec::new(),
                    measured_profile: Vec::new(),
                };
            }
        };
        // Velocities of a spall point to the free end, as in the exact solution.
        let (exact_profile, sign) = match self {
            Self::Piston(own) => {
                let fastest = own.solution.fastest_speed();
                let profile = match &own.release {
                    Some(release) => own.solution.profile_with_release(release, found.time),
                    None => Some(own.solution.profile(found.time)),
                };
                let points = profile.map(|own| list_profile_points(&own, fastest));
                (points.unwrap_or_default(), 1.0)
            }
            Self::Spall(spall) => (list_spall_points(spall, found.time), -1.0),
        };
        let cell = |(cell, [velocity, pressure]): (usize, &[f64; 2])| {
            [(cell as f64 + 0.5) * found.spacing, sign * velocity, *pressure]
        };
        ColumnCheck {
            problem,
            cells,
            steps: found.steps,
            time: found.time,
            unmeasured_reason: None,
            quantity_checks: found.rows.iter().map(QuantityCheck::from).collect(),
            exact_profile,
            measured_profile: found.profile.iter().enumerate().map(cell).collect(),
        }
    }
}

/// Plastic work per unit of uniaxial strain, Pa: τ_s √(2/3)/c, with the deviator of the magnitude τ_s/c.
fn plastic_power(case: &Case) -> f64 {
    match case.material.contacts {
        Some(
            ContactMedium::Granular { yield_stress, intensity_coefficient, .. }
            | ContactMedium::Porous { yield_stress, intensity_coefficient, .. },
        ) => yield_stress.map_or(0.0, |limit| limit * (2.0 / 3.0 / intensity_coefficient).sqrt()),
        None => 0.0,
    }
}

impl From<&ShockResult> for QuantityCheck {
    fn from(own: &ShockResult) -> Self {
        Self {
            quantity: own.quantity.clone(),
            unit: own.unit,
            predicted: own.predicted,
            measured: own.measured.as_ref().ok().copied(),
            relative_difference: own.relative_difference(),
            scale: own.scale,
            tolerance: own.tolerance,
            unmeasured_reason: own.measured.as_ref().err().cloned(),
            is_in_agreement: own.is_within_tolerance(),
        }
    }
}

impl ShockCheck {
    fn rows(&self) -> impl Iterator<Item = &QuantityCheck> {
        self.columns.iter().flat_map(|own| &own.quantity_checks)
    }

    /// Returns whether all measurements agree; `None` without any.
    pub fn is_in_agreement(&self) -> Option<bool> {
        let mut measured = self.rows().filter_map(|own| own.is_in_agreement).peekable();
        measured.peek()?;
        Some(measured.all(|own| own))
    }

    /// Returns the number of checked quantities and of those that disagree.
    pub fn item_and_failure_counts(&self) -> [usize; 2] {
        let failed = self.rows().filter(|own| own.is_in_agreement == Some(false)).count();
        [self.rows().count(), failed]
    }

    /// Returns the number of quantities without measurement, and of columns without any.
    pub fn unmeasured_count(&self) -> usize {
        let columns = self.columns.iter().filter(|own| own.unmeasured_reason.is_some()).count();
        columns + self.rows().filter(|own| own.unmeasured_reason.is_some()).count()
    }

    /// Returns the largest relative difference; `None` without measurement.
    pub fn max_relative_difference(&self) -> Option<f64> {
        let differences = self.rows().filter_map(|own| own.relative_difference);
        max_with_nan_largest(differences.map(f64::abs))
    }
}
