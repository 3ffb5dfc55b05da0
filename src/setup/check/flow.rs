//! Flows: the waves that are followed, and the grids on which a perturbation is refined.

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

/// Most points along an axis of a grid on which a perturbation of a flow is refined.
const MOST_POINTS: usize = 4096;

/// A wave of one wave vector at the beginning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlowWave {
    /// Wave number, 1/m.
    pub number: f64,
    /// Direction from x₁, anticlockwise, degrees.
    pub direction_deg: f64,
}

impl FlowWave {
    /// The plane wave by its unit wave normal.
    pub fn plane_wave(&self) -> PlaneWave<2> {
        let angle = crate::case::radians(self.direction_deg);
        PlaneWave { number: self.number, normal: [angle.cr_cos(), angle.cr_sin()] }
    }
}

/// Checks of a flow: waves and perturbations to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowPlan {
    /// The waves.
    pub waves: Vec<FlowWave>,
    /// The models in which the perturbation of the case is refined.
    pub kinds: Vec<Kind>,
    /// Points along each axis of the grids for that; ascending.
    pub grids: Vec<usize>,
}

impl FlowPlan {
    /// The plan of a case.
    ///
    /// # Errors
    /// The case is wrong, or its state cannot be analysed.
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

/// Directions where none are asked for, degrees.
fn directions(case: &Case) -> Result<Vec<f64>, Error> {
    let worst = match verdict(case, &uniform_flow(case)?)? {
        Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
        _ => None,
    };
    let mut all = vec![case.material.numbers.wave.direction_deg];
    // The order of the short form.
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
    if let Some(odd) = grids.iter().find(|own| *own % 2 == 1 || **own > MOST_POINTS) {
        return refuse(odd.to_string(), "even numbers of points along each axis, up to 4096");
    }
    for kind in case.compare.iter().flatten().filter(|_| !grids.is_empty()) {
        case.for_kind(*kind).rotation_in_time()?;
    }
    Ok(())
}

/// The models in which the perturbation of a case is refined.
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

/// The uniform flow of a case, for the analysis and for the solver.
///
/// # Errors
/// The case is none of a uniform flow that a solver takes.
pub fn uniform_flow(case: &Case) -> Result<UniformFlow, Error> {
    let flow = case.mean_flow()?;
    // Each measurement has its own box.
    let solver = flow_problem(case, [4; 2], [1.0; 2])?;
    Ok(UniformFlow { model: case.model()?, state: case.state(), flow, solver })
}

/// The verdict on the uniform flow of a case.
///
/// # Errors
/// The state cannot be analysed.
pub fn verdict(case: &Case, problem: &UniformFlow) -> Result<Verdict, Error> {
    match Workspace::default().decide(&problem.model, &problem.flow) {
        Ok((verdict, _)) => Ok(verdict),
        Err(error) => Err(setup::locate(&case.material, error.into())),
    }
}

/// The perturbation of a run on a grid of so many points along each axis.
///
/// # Errors
/// The archive that a part names is not what it should be.
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
