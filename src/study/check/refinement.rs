//! Grid refinement of a perturbation of a flow.

use crate::Error;
use crate::case::Converted;
use crate::case::flow::FlowRun;
use crate::setup::check::flow::{perturbation_on, uniform_flow, verdict};
use crate::setup::check::locate;
use agreement::flows::{FastestMode, Refinement, fastest_mode};
use analysis::growth::Verdict;
use analysis::newton::Order;
use serde::Serialize;

/// Grid refinement of a perturbation in one model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RefinementCheck {
    /// Name of the model.
    pub model: &'static str,
    /// Non-coaxiality Δ of the case, degrees, if this model is coaxial and uses Δ = 0.
    pub lost_noncoaxiality_deg: Option<f64>,
    /// Order of growth in k as k → ∞ by the verdict; 0 if well-posed.
    pub limit_of_the_order: f64,
    /// Orders over these grids; `None` if no mode grows faster than the shear rate, or if the fastest modes of all
    /// grids have equal wave numbers.
    pub orders: Option<Orders>,
    /// Results by grid.
    pub grids: Vec<FastestModeCheck>,
    /// Whether rates and orders agree, and the order is close to that of the verdict.
    pub agrees: bool,
    /// Whether the fastest mode of each grid grows faster than the shear rate.
    #[serde(skip)]
    pub grows: bool,
    /// Title of the model.
    #[serde(skip)]
    pub title: &'static str,
    /// Q_D of the mean flow in this model, 1/s.
    #[serde(skip)]
    pub shear_rate: f64,
}

/// Orders of growth in the wave number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Orders {
    /// Order of the predicted rates.
    pub predicted: f64,
    /// Order of the measured rates.
    pub measured: f64,
}

/// Check of the fastest growing mode of one grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FastestModeCheck {
    /// Points along each axis.
    pub points: [usize; 2],
    /// Periods of the mode along each axis.
    pub mode: [i32; 2],
    /// Initial wave number, 1/m.
    pub number: f64,
    /// Growth rate predicted by the linearised equations, 1/s.
    pub predicted: f64,
    /// Growth rate measured by the solver, 1/s.
    pub measured: f64,
    /// Whether measured and predicted rate agree.
    pub agrees: bool,
}

/// Simulates the perturbation of `run` in the model of a case on each of `grids`, given as points per axis, and
/// compares the growth rate of the fastest mode with the prediction.
pub(super) fn refine(
    Converted { case, lost_noncoaxiality_deg }: Converted,
    run: &FlowRun,
    grids: &[usize],
    grid_is_done: &mut dyn FnMut() -> Result<(), Error>,
) -> Result<RefinementCheck, Error> {
    let problem = uniform_flow(&case)?;
    let verdict_order = match verdict(&case, &problem)? {
        Verdict::IllPosed { growth: Some(growth), .. } => Order::value(growth.order),
        _ => 0.0,
    };
    let mut fastest = |&points: &usize| {
        let perturbation = perturbation_on(run, &problem, points)?;
        let found =
            fastest_mode(&problem, &perturbation).map_err(|error| locate(&case.material, error))?;
        grid_is_done()?;
        Ok(found)
    };
    let grids = grids.iter().map(&mut fastest).collect::<Result<_, Error>>()?;
    let own = Refinement { verdict_order, grids, shear_rate: problem.flow.shear_rate };
    let grid = |grid: &FastestMode| FastestModeCheck {
        points: grid.points,
        mode: grid.mode,
        number: grid.number,
        predicted: grid.predicted,
        measured: grid.measured,
        agrees: own.grid_agrees(grid),
    };
    Ok(RefinementCheck {
        model: case.material.kind.name(),
        lost_noncoaxiality_deg,
        limit_of_the_order: verdict_order,
        orders: own.orders().map(|[predicted, measured]| Orders { predicted, measured }),
        grids: own.grids.iter().map(grid).collect(),
        agrees: own.agrees(),
        grows: own.grows(),
        title: case.material.kind.title(),
        shear_rate: own.shear_rate,
    })
}
