//! Flows: the waves and perturbations that a case asks for, by the analysis and by the solver.

use super::setup::{locate, uniform_flow, verdict};
use crate::Error;
use crate::case::flow::{Disturbed, FlowRun, Initial};
use crate::case::{Case, Converted, Kind};
use crate::cli::progress::Progress;
use crate::setup::flow_run::perturbation;
use agreement::PlaneWave;
use agreement::flows::{ModeResult, Perturbation, Refinement, fastest_mode, wave_results};
use analysis::growth::Verdict;
use analysis::newton::Order;
use dynamics::flow::Problem;
use models::elementary::Elementary;
use models::granular_flow::InputError;
use std::ops::ControlFlow;

/// A wave of one wave vector at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Wave number, 1/m.
    pub number: f64,
    /// Direction from x₁, anticlockwise, degrees.
    pub direction_deg: f64,
}

impl Wave {
    /// The same by its unit vector.
    pub(super) fn plane_wave(&self) -> PlaneWave<2> {
        let angle = crate::case::radians(self.direction_deg);
        PlaneWave { number: self.number, normal: [angle.cr_cos(), angle.cr_sin()] }
    }
}

/// One perturbation on finer and finer grids in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinedModel {
    /// The model.
    pub kind: Kind,
    /// Its rates.
    pub refinement: Refinement,
    /// The case's Δ, degrees, where this model can have none but 0.
    pub lost_noncoaxiality_deg: Option<f64>,
}

/// The results of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// Q_D of the mean flow, 1/s.
    pub shear_rate: f64,
    /// The waves that were followed.
    pub waves: Vec<Wave>,
    /// Their modes.
    pub rows: Vec<ModeResult>,
    /// One perturbation on finer grids, model by model.
    pub refinements: Vec<RefinedModel>,
}

impl Checked {
    /// Whether everything that was measured agrees; `None` where nothing was.
    pub fn agrees(&self) -> Option<bool> {
        let is_anything = self.rows.iter().any(|row| row.measured.is_ok());
        let [_, failed] = self.counts();
        (is_anything || !self.refinements.is_empty()).then_some(failed == 0)
    }

    /// Number of waves without a measurement.
    pub fn unmeasured(&self) -> usize {
        self.rows.iter().filter(|row| row.measured.is_err()).count()
    }

    /// Rows and refinements, and those that disagree.
    pub fn counts(&self) -> [usize; 2] {
        let failed = self.rows.iter().filter(|row| row.agrees() == Some(false)).count()
            + self.refinements.iter().filter(|own| !own.refinement.agrees()).count();
        [self.rows.len() + self.refinements.len(), failed]
    }

    /// The greatest relative difference of the rates of a measured wave; `None` where none was measured.
    pub fn worst(&self) -> Option<f64> {
        let relative =
            |row: &ModeResult| Some(row.difference()?.max_norm() / row.scale(self.shear_rate));
        super::greatest(self.rows.iter().filter_map(relative))
    }
}

/// Checks the waves of a flow, and a perturbation on finer and finer grids if the case asks for it.
///
/// # Errors
/// The case is none of a flow that is run in time, or a state cannot be analysed.
pub(super) fn check(case: &Case, waves: &[Wave], grids: &[usize]) -> Result<Checked, Error> {
    let problem = uniform_flow(case)?;
    verdict(case, &problem)?;
    let kinds: Vec<Kind> = match (&case.flow, grids) {
        (None, _) | (_, []) => Vec::new(),
        _ => [case.kind].into_iter().chain(case.compare.iter().flatten().copied()).collect(),
    };
    let progress = Progress::new("check", (waves.len() + kinds.len() * grids.len()) as u64);
    let on_progress = |done: usize, _: usize| {
        if done > 0 {
            progress.tick(1);
        }
        ControlFlow::Continue(())
    };
    let plane_waves: Vec<PlaneWave<2>> = waves.iter().map(Wave::plane_wave).collect();
    let rows =
        wave_results(&problem, &plane_waves, &on_progress).map_err(|error| locate(case, error))?;
    let is_velocity = |part: &Initial| match part {
        Initial::Mode(wave) | Initial::Packet { wave, .. } => wave.field == Disturbed::Velocity,
        Initial::Noise { field, .. } => *field == Disturbed::Velocity,
        Initial::Uniform { .. } | Initial::File { .. } => false,
    };
    if let (Some(run), true) = (&case.flow, kinds.len() > 1)
        && !run.initial.iter().all(is_velocity)
    {
        let found = "a perturbation of more than the velocity for several models".to_owned();
        let allowed = "parts with field = \"v\" alone, which all of them have".to_owned();
        return Err(case.locate(InputError { key: "initial", found, allowed }).into());
    }
    let mut refinements = Vec::new();
    for kind in kinds {
        let noncoaxiality_deg = problem.flow.noncoaxiality.to_degrees();
        let own = case.for_kind_with(kind, Some(noncoaxiality_deg));
        if let Some(run) = &case.flow {
            refinements.push(refine(own, run, grids, &progress)?);
        }
    }
    let shear_rate = problem.flow.shear_rate;
    Ok(Checked { shear_rate, waves: waves.to_vec(), rows, refinements })
}

/// The perturbation of a run on grids of so many points along each axis, in the model of a case.
fn refine(
    Converted { case, lost_noncoaxiality_deg }: Converted,
    run: &FlowRun,
    grids: &[usize],
    progress: &Progress,
) -> Result<RefinedModel, Error> {
    let problem = uniform_flow(&case)?;
    let verdict_order = match verdict(&case, &problem)? {
        Verdict::IllPosed { growth: Some(growth), .. } => Order::value(growth.order),
        _ => 0.0,
    };
    let fastest = |points: &usize| {
        let (points, lengths) = ([*points; 2], run.grid.lengths);
        let solver = Problem { points, lengths, ..problem.solver.clone() };
        let (velocity, internal_variable) = perturbation(run, &solver)?;
        let perturbation = Perturbation { points, lengths, velocity, internal_variable };
        let found = fastest_mode(&problem, &perturbation).map_err(|error| locate(&case, error));
        progress.tick(1);
        found
    };
    let grids = grids.iter().map(fastest).collect::<Result<_, _>>()?;
    let refinement = Refinement { verdict_order, grids, shear_rate: problem.flow.shear_rate };
    Ok(RefinedModel { kind: case.kind, refinement, lost_noncoaxiality_deg })
}

/// The worst direction of an ill-posed state, degrees.
pub(super) fn worst_direction_deg(case: &Case) -> Result<Option<f64>, Error> {
    Ok(match verdict(case, &uniform_flow(case)?)? {
        Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
        _ => None,
    })
}
