//! Solver problem and initial perturbation of a flow simulation from a case.

mod initial;

use crate::Error;
use crate::case::Case;
use crate::case::flow::{FlowGrid, FlowRun};
use dynamics::flow::{Closure, FlowProblem};
pub(crate) use initial::assemble_perturbation;
use models::common::decimal::ToPlainText;

/// Smallest allowed tolerance, about 450 ε with the machine epsilon ε of double precision.
const MIN_TOLERANCE: f64 = 1e-13;

/// Creates the solver problem of a flow simulation.
///
/// # Errors
/// A tolerance is below [`MIN_TOLERANCE`], or [`create_flow_problem`] fails.
pub(crate) fn create_run_problem(case: &Case, run: &FlowRun) -> Result<FlowProblem, Error> {
    let time = &run.time;
    for (key, own) in
        [("tolerance", time.tolerance), ("pressure_tolerance", time.pressure_tolerance)]
    {
        if own < MIN_TOLERANCE {
            let allowed = format!("expected at least {MIN_TOLERANCE:e}: less is lost in rounding");
            return Err(run
                .key_error(
                    &format!("time.{key}"),
                    format!("found {own}", own = own.to_plain_text()),
                    allowed,
                )
                .into());
        }
    }
    Ok(FlowProblem {
        tolerance: run.time.tolerance,
        pressure_tolerance: run.time.pressure_tolerance,
        min_shear_rate: run.min_shear_rate,
        ..create_flow_problem(case, run.grid.points, run.grid.lengths)?
    })
}

/// Creates the solver problem of a case in a box of `lengths`, m, with `points` grid points along each axis, default
/// tolerances and the default smallest shear rate.
///
/// # Errors
/// A constant is out of range, or the case is not a uniform flow that the solver supports.
pub(crate) fn create_flow_problem(
    case: &Case,
    points: [usize; 2],
    lengths: [f64; 2],
) -> Result<FlowProblem, Error> {
    let mean = case.solve_mean_flow()?;
    let model = case.build_located_model()?;
    let coulomb = *model.coulomb();
    let closure =
        Closure::from_rotation(case.simulation_rotation()?).expect("a determined rotation");
    Ok(FlowProblem {
        closure,
        density: mean.density,
        friction_angle: coulomb.friction_angle,
        rotation_ratio: model.flow_rule().rotation_ratio(),
        cohesion: coulomb.cohesion,
        pressure: mean.stress.pressure,
        velocity_gradient: mean.velocity_gradient.map(|row| row.map(|entry| entry.value)),
        stress_angle: mean.stress.angle,
        spin: mean.spin.map_or(0.0, |spin| spin.value),
        spin_acceleration: case.material.numbers.background.spin_acceleration,
        points,
        lengths,
        tolerance: 1e-5,
        pressure_tolerance: 1e-9,
        min_shear_rate: 1e-3,
    })
}

/// Returns the perturbation of a case at the points of a problem: velocities, m/s, and spin ω, rad/s, or stress angle
/// ψ, rad (zero if neither evolves).
///
/// # Errors
/// The archive named by a term of the perturbation is unusable.
pub(crate) fn create_perturbation(
    run: &FlowRun,
    problem: &FlowProblem,
) -> Result<([Vec<f64>; 2], Vec<f64>), Error> {
    let grid = FlowGrid { points: problem.points, lengths: problem.lengths };
    let fields = initial::assemble_perturbation(&run.with_grid(grid), problem)?;
    Ok((fields.velocity, fields.internal_variable))
}
