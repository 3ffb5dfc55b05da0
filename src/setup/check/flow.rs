//! Plans of flow checks: waves to be measured, and grids for the refinement of a perturbation.

use super::Extent;
use crate::case::flow::{Disturbed, FlowRun, Initial};
use crate::case::{Case, Kind};
use crate::setup::flow_run::{flow_problem, perturbation};
use crate::{Error, setup};
use agreement::PlaneWave;
use agreement::flows::{Perturbation, UniformFlow};
use analysis::flows::Workspace;
use analysis::growth::Verdict;
use dynamics::flow::Problem;
use models::InputError;
use models::common::elementary::Elementary;
use serde::Serialize;

/// Maximum number of points per axis in grid refinement.
const MAX_POINTS: usize = 4096;

/// Initial wave vector of a plane wave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlowWave {
    /// Wave number, 1/m.
    pub number: f64,
    /// Direction from x₁, anticlockwise, degrees.
    pub direction_deg: f64,
}

impl FlowWave {
    /// Converts to wave number and unit normal.
    pub fn plane_wave(&self) -> PlaneWave<2> {
        let angle = crate::case::radians(self.direction_deg);
        PlaneWave { number: self.number, normal: [angle.cr_cos(), angle.cr_sin()] }
    }
}

/// Plan of the check of a flow: waves and perturbations to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowPlan {
    /// Waves to be measured.
    pub waves: Vec<FlowWave>,
    /// Models in which the perturbation of the case is simulated on refined grids.
    pub kinds: Vec<Kind>,
    /// Numbers of points per axis of the refined grids, ascending.
    pub grids: Vec<usize>,
}

impl FlowPlan {
    /// Creates the plan of a case.
    ///
    /// # Errors
    /// The case is invalid, or its state cannot be analysed.
    pub(super) fn new(case: &Case, extent: Extent) -> Result<Self, Error> {
        let (wave, asked) = (case.material.numbers.wave, case.check.clone().unwrap_or_default());
        let mut numbers =
            asked.numbers.unwrap_or_else(|| [1.0, 4.0, 16.0].map(|n| n * wave.number).to_vec());
        let mut directions = match asked.directions_deg {
            Some(directions) => directions,
            None => directions(case)?,
        };
        if extent == Extent::Short {
            numbers.truncate(1);
            directions.truncate(2);
        }
        let waves = directions.iter().flat_map(|&direction_deg| {
            numbers.iter().map(move |&number| FlowWave { number, direction_deg })
        });
        let grids = asked.cells.unwrap_or_default();
        check_grids(case, &grids)?;
        let grids = if extent == Extent::Full { grids } else { Vec::new() };
        let kinds = if grids.is_empty() { Vec::new() } else { kinds(case)? };
        Ok(Self { waves: waves.collect(), kinds, grids })
    }
}

/// Returns the default directions, degrees: that of the case, the most unstable one, 30° and 105°.
fn directions(case: &Case) -> Result<Vec<f64>, Error> {
    let worst = match verdict(case, &uniform_flow(case)?)? {
        Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
        _ => None,
    };
    let mut all = vec![case.material.numbers.wave.direction_deg];
    // In this order: `Extent::Short` takes the first two.
    for other in worst.into_iter().chain([30.0, 105.0]) {
        if all.iter().all(|own| (own - other).abs() > 1e-6) {
            all.push(other);
        }
    }
    Ok(all)
}

/// Checks that the perturbation of a case can be refined on the grids in all its models.
fn check_grids(case: &Case, grids: &[usize]) -> Result<(), Error> {
    let refuse = |found: String, allowed: &str| {
        let allowed = allowed.to_owned();
        Err(case.locate(InputError { input: "check.cells", found, allowed }).into())
    };
    if !grids.is_empty() && case.flow.is_none() {
        let found = format!("{grids:?} without a perturbation");
        return refuse(found, "add [grid], [time] and [[initial]], or leave it out");
    }
    if let Some(odd) = grids.iter().find(|own| *own % 2 == 1 || **own > MAX_POINTS) {
        return refuse(odd.to_string(), "even numbers of points along each axis, up to 4096");
    }
    for kind in case.compare.iter().flatten().filter(|_| !grids.is_empty()) {
        case.for_kind(*kind).rotation_in_time()?;
    }
    Ok(())
}

/// Returns the models in which the perturbation of a case is refined.
fn kinds(case: &Case) -> Result<Vec<Kind>, Error> {
    let kinds: Vec<Kind> =
        [case.material.kind].into_iter().chain(case.compare.iter().flatten().copied()).collect();
    let is_velocity = |part: &Initial| match part {
        Initial::Mode(wave) | Initial::Packet { wave, .. } => wave.field == Disturbed::Velocity,
        Initial::Noise { field, .. } => *field == Disturbed::Velocity,
        Initial::Uniform { .. } | Initial::File { .. } => false,
    };
    let mut parts = case.flow.iter().flat_map(|run| &run.initial);
    if kinds.len() > 1 && !parts.all(is_velocity) {
        let found = "a perturbation of more than the velocity for several models".to_owned();
        let allowed = "parts with field = \"v\" alone, which all of them have".to_owned();
        return Err(case.locate(InputError { input: "initial", found, allowed }).into());
    }
    Ok(kinds)
}

/// Creates the uniform flow of a case, for analysis and solver.
///
/// # Errors
/// The case is not a uniform flow that the solver supports.
pub fn uniform_flow(case: &Case) -> Result<UniformFlow, Error> {
    let flow = case.mean_flow()?;
    // Placeholder grid and box: each measurement sets its own.
    let solver = flow_problem(case, [4; 2], [1.0; 2])?;
    Ok(UniformFlow { model: case.model()?, state: case.state(), flow, solver })
}

/// Determines the verdict on the uniform flow of a case.
///
/// # Errors
/// The state cannot be analysed.
pub fn verdict(case: &Case, problem: &UniformFlow) -> Result<Verdict, Error> {
    match Workspace::default().decide(&problem.model, &problem.flow) {
        Ok((verdict, _)) => Ok(verdict),
        Err(error) => Err(setup::locate(&case.material, error.into())),
    }
}

/// Creates the perturbation of a run on a grid of `points` points along each axis.
///
/// # Errors
/// The archive named by a part of the perturbation is unusable.
pub fn perturbation_on(
    run: &FlowRun,
    flow: &UniformFlow,
    points: usize,
) -> Result<Perturbation, Error> {
    let (points, lengths) = ([points; 2], run.grid.lengths);
    let solver = Problem { points, lengths, ..flow.solver.clone() };
    let (velocity, internal_variable) = perturbation(run, &solver)?;
    Ok(Perturbation { points, lengths, velocity, internal_variable })
}
