//! Plans of flow checks: waves to be measured, and grids for the refinement of a perturbation.

use super::CheckExtent;
use crate::case::flow::{FlowPerturbation, FlowRun, PerturbedField};
use crate::case::{Case, ModelKind, WaveNumbers};
use crate::setup::flow_run::{create_flow_problem, create_perturbation};
use crate::{Error, setup};
use agreement::PlaneWave;
use agreement::flows::{Perturbation, UniformFlow};
use analysis::flows::FlowWorkspace;
use analysis::growth::Verdict;
use dynamics::flow::FlowProblem;
use models::InputError;
use models::common::elementary::Elementary;
use serde::Serialize;

/// Maximum number of points along each axis of a refined grid.
const MAX_POINTS_PER_AXIS: usize = 4096;

/// Wave vector in the plane of a flow; in time-domain checks, where the mean flow changes it, its initial value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlowWave {
    /// Wave number, 1/m.
    #[serde(rename = "number")]
    pub wave_number: f64,
    /// Direction from x₁, anticlockwise, degrees.
    pub direction_deg: f64,
}

impl From<&WaveNumbers> for FlowWave {
    fn from(wave: &WaveNumbers) -> Self {
        Self { wave_number: wave.wave_number, direction_deg: wave.direction_deg }
    }
}

impl FlowWave {
    /// Converts the wave to a plane wave with wave number and unit normal.
    pub fn to_plane_wave(&self) -> PlaneWave<2> {
        let angle = crate::case::degrees_to_radians(self.direction_deg);
        PlaneWave { wave_number: self.wave_number, normal: [angle.cr_cos(), angle.cr_sin()] }
    }
}

/// Plan of the check of a flow: waves to be measured, and grids on which a perturbation is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowCheckPlan {
    /// Initial wave vectors of the waves to be measured.
    pub waves: Vec<FlowWave>,
    /// Models in which the perturbation of the case is simulated on refined grids; empty if `refined_point_counts` is
    /// empty.
    pub refined_models: Vec<ModelKind>,
    /// Numbers of points per axis of the refined grids, ascending; empty without refinement.
    pub refined_point_counts: Vec<usize>,
}

impl FlowCheckPlan {
    /// Creates the plan of the flow check of a case.
    ///
    /// # Errors
    /// The case is invalid, or its state cannot be analysed.
    pub(super) fn new(case: &Case, extent: CheckExtent) -> Result<Self, Error> {
        let (wave, asked) =
            (case.material.numbers.wave, case.check_options.clone().unwrap_or_default());
        let mut numbers = asked
            .wave_numbers
            .unwrap_or_else(|| [1.0, 4.0, 16.0].map(|n| n * wave.wave_number).to_vec());
        let mut directions = match asked.directions_deg {
            Some(directions) => directions,
            None => choose_default_directions(case)?,
        };
        if extent == CheckExtent::Short {
            numbers.truncate(1);
            directions.truncate(2);
        }
        let waves = directions.iter().flat_map(|&direction_deg| {
            numbers.iter().map(move |&wave_number| FlowWave { wave_number, direction_deg })
        });
        let grids = asked.grid_sizes.unwrap_or_default();
        check_grids(case, &grids)?;
        let grids = if extent == CheckExtent::Full { grids } else { Vec::new() };
        let kinds = if grids.is_empty() { Vec::new() } else { select_refined_kinds(case)? };
        Ok(Self { waves: waves.collect(), refined_models: kinds, refined_point_counts: grids })
    }
}

/// Returns the default directions, degrees: that of the case, the most unstable one if the flow is ill-posed, 30° and
/// 105°; a direction within 10⁻⁶ degrees of an earlier one is left out.
fn choose_default_directions(case: &Case) -> Result<Vec<f64>, Error> {
    let worst = match compute_verdict(case, &create_uniform_flow(case)?)? {
        Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
        _ => None,
    };
    let mut all = vec![case.material.numbers.wave.direction_deg];
    // The order matters: `CheckExtent::Short` takes the first two directions.
    for other in worst.into_iter().chain([30.0, 105.0]) {
        if all.iter().all(|own| (own - other).abs() > 1e-6) {
            all.push(other);
        }
    }
    Ok(all)
}

/// Checks that a case with refined grids has a perturbation, that the numbers of points of the grids are even and at
/// most [`MAX_POINTS_PER_AXIS`], and that the solver supports all compared models.
fn check_grids(case: &Case, grids: &[usize]) -> Result<(), Error> {
    let refuse = |found: String, allowed: &str| {
        let allowed = allowed.to_owned();
        Err(case
            .locate_error(InputError {
                input: "check.cells",
                rejected_value: found,
                allowed_values: allowed,
            })
            .into())
    };
    if !grids.is_empty() && case.flow_run.is_none() {
        let found = format!("{grids:?} without a perturbation");
        return refuse(found, "add [grid], [time] and [[initial]], or leave it out");
    }
    if let Some(odd) = grids.iter().find(|own| *own % 2 == 1 || **own > MAX_POINTS_PER_AXIS) {
        return refuse(odd.to_string(), "even numbers of points along each axis, up to 4096");
    }
    for kind in case.compared_kinds.iter().flatten().filter(|_| !grids.is_empty()) {
        case.convert_to_kind(*kind).simulation_rotation()?;
    }
    Ok(())
}

/// Returns the models in which the perturbation of a case is simulated on refined grids: the model of the case and the
/// compared models. With compared models only a perturbation of the velocity is accepted, since other fields do not
/// exist in all models.
fn select_refined_kinds(case: &Case) -> Result<Vec<ModelKind>, Error> {
    let kinds: Vec<ModelKind> = [case.material.kind]
        .into_iter()
        .chain(case.compared_kinds.iter().flatten().copied())
        .collect();
    let is_velocity = |part: &FlowPerturbation| match part {
        FlowPerturbation::Mode(wave) | FlowPerturbation::Packet { carrier: wave, .. } => {
            wave.field == PerturbedField::Velocity
        }
        FlowPerturbation::Noise { field, .. } => *field == PerturbedField::Velocity,
        FlowPerturbation::Uniform { .. } | FlowPerturbation::File { .. } => false,
    };
    let mut parts = case.flow_run.iter().flat_map(|run| &run.perturbation_terms);
    if kinds.len() > 1 && !parts.all(is_velocity) {
        let found = "a perturbation of more than the velocity for several models".to_owned();
        let allowed = "parts with field = \"v\" alone, which all of them have".to_owned();
        return Err(case
            .locate_error(InputError {
                input: "initial",
                rejected_value: found,
                allowed_values: allowed,
            })
            .into());
    }
    Ok(kinds)
}

/// Creates the uniform flow of a case, for analysis and solver.
///
/// # Errors
/// A constant is out of range, or the case is not a uniform flow that the solver supports.
pub fn create_uniform_flow(case: &Case) -> Result<UniformFlow, Error> {
    let flow = case.solve_mean_flow()?;
    // Grid and box are placeholders that each measurement replaces.
    let solver = create_flow_problem(case, [4; 2], [1.0; 2])?;
    Ok(UniformFlow {
        model: case.build_located_model()?,
        state: case.to_flow_state(),
        flow,
        solver_problem: solver,
    })
}

/// Determines the verdict on the uniform flow of a case.
///
/// # Errors
/// The state cannot be analysed.
pub fn compute_verdict(case: &Case, problem: &UniformFlow) -> Result<Verdict, Error> {
    match FlowWorkspace::default().decide_verdict(&problem.model, &problem.flow) {
        Ok((verdict, _)) => Ok(verdict),
        Err(error) => Err(setup::locate_state_error(&case.material, error.into())),
    }
}

/// Creates the perturbation of a run on a grid of `points` points along each axis.
///
/// # Errors
/// The archive named by a term of the perturbation is unusable.
pub fn create_perturbation_on_grid(
    run: &FlowRun,
    flow: &UniformFlow,
    points: usize,
) -> Result<Perturbation, Error> {
    let (points, lengths) = ([points; 2], run.grid.lengths);
    let solver = FlowProblem { points, lengths, ..flow.solver_problem.clone() };
    let (velocity, internal_variable) = create_perturbation(run, &solver)?;
    Ok(Perturbation { points, lengths, velocity, internal_variable })
}
