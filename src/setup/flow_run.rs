//! From a case to a flow in time: the problem that the solver takes, and the perturbation at its beginning.

mod initial;

use crate::Error;
use crate::case::Case;
use crate::case::flow::{FlowRun, Grid};
use dynamics::flow::{Closure, Problem};
pub(crate) use initial::fields;

/// Least tolerance: numbers have 53 binary digits.
const LEAST_TOLERANCE: f64 = 1e-13;

/// The problem of a case that is run in time.
///
/// # Errors
/// A tolerance is below the rounding of the numbers; see [`flow_problem`].
pub(crate) fn problem(case: &Case, run: &FlowRun) -> Result<Problem, Error> {
    let time = &run.time;
    for (key, own) in
        [("tolerance", time.tolerance), ("pressure_tolerance", time.pressure_tolerance)]
    {
        if own < LEAST_TOLERANCE {
            let allowed = format!("at least {LEAST_TOLERANCE:e}: less is lost in rounding");
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

/// The problem of a case in a box, with the tolerances that are the default.
///
/// # Errors
/// The case is none of a uniform flow that a solver takes.
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

/// Velocities and ω or ψ of a case's perturbation at the points of a problem.
///
/// # Errors
/// The archive that a part names is not what it should be.
pub(crate) fn perturbation(
    run: &FlowRun,
    problem: &Problem,
) -> Result<([Vec<f64>; 2], Vec<f64>), Error> {
    let grid = Grid { cells: problem.points, lengths: problem.lengths };
    let fields = initial::fields(&run.on(grid), problem)?;
    Ok((fields.velocity, fields.inner))
}
