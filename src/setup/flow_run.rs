//! Solver problem and initial perturbation of a flow simulation from a case.

mod initial;

use crate::Error;
use crate::case::Case;
use crate::case::flow::{FlowRun, Grid};
use dynamics::flow::{Closure, Problem};
pub(crate) use initial::fields;

/// Least tolerance, about 450 ε of double precision.
const MIN_TOLERANCE: f64 = 1e-13;

/// Creates the solver problem of a flow simulation.
///
/// # Errors
/// A tolerance is below [`MIN_TOLERANCE`]; see [`flow_problem`].
pub(crate) fn problem(case: &Case, run: &FlowRun) -> Result<Problem, Error> {
    let time = &run.time;
    for (key, own) in
        [("tolerance", time.tolerance), ("pressure_tolerance", time.pressure_tolerance)]
    {
        if own < MIN_TOLERANCE {
            let allowed = format!("at least {MIN_TOLERANCE:e}: less is lost in rounding");
            return Err(run
                .locate(&format!("time.{key}"), format!("found {own:?}"), allowed)
                .into());
        }
    }
    Ok(Problem {
        tolerance: run.time.tolerance,
        pressure_tolerance: run.time.pressure_tolerance,
        least_shear_rate: run.least_shear_rate,
        ..flow_problem(case, run.grid.cells, run.grid.lengths)?
    })
}

/// Creates the solver problem of a case in a box of `lengths`, m, with default tolerances.
///
/// # Errors
/// The case is not a uniform flow that the solver supports.
pub(crate) fn flow_problem(
    case: &Case,
    points: [usize; 2],
    lengths: [f64; 2],
) -> Result<Problem, Error> {
    let mean = case.mean_flow()?;
    let model = case.model()?;
    let coulomb = *model.coulomb();
    let closure = Closure::from_rotation(case.rotation_in_time()?).expect("a determined rotation");
    Ok(Problem {
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
        least_shear_rate: 1e-3,
    })
}

/// Returns the perturbation of a case at the points of a problem: velocities, m/s, and spin ω, rad/s, or stress angle
/// ψ, rad.
///
/// # Errors
/// The archive named by a part of the perturbation is unusable.
pub(crate) fn perturbation(
    run: &FlowRun,
    problem: &Problem,
) -> Result<([Vec<f64>; 2], Vec<f64>), Error> {
    let grid = Grid { cells: problem.points, lengths: problem.lengths };
    let fields = initial::fields(&run.on(grid), problem)?;
    Ok((fields.velocity, fields.inner))
}
