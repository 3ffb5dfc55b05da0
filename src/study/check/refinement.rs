//! Growth of a perturbation of a flow on successively refined grids.

use crate::Error;
use crate::case::ConvertedCase;
use crate::case::flow::FlowRun;
use crate::setup::check::flow::{
    compute_verdict, create_perturbation_on_grid, create_uniform_flow,
};
use crate::setup::check::locate_agreement_error;
use agreement::flows::{FastestMode, GridRefinement, compare_fastest_mode};
use analysis::growth::Verdict;
use analysis::newton_polygon::GrowthOrder;
use serde::Serialize;
use std::ops::ControlFlow;

/// Growth of a perturbation on successively refined grids in one model, compared with the prediction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RefinementCheck {
    /// Name of the model in case files.
    #[serde(rename = "model")]
    pub model_name: &'static str,
    /// Non-coaxiality Δ of the case, degrees, if this model is coaxial and uses Δ = 0.
    #[serde(rename = "lost_noncoaxiality_deg")]
    pub replaced_noncoaxiality_deg: Option<f64>,
    /// Order of growth in the wave number k as k → ∞ according to the verdict; 0 if well-posed.
    #[serde(rename = "limit_of_the_order")]
    pub verdict_order: f64,
    /// Orders of growth in the wave number, fitted over the refined grids; `None` for fewer than two grids, if
    /// `is_growing` is false, or if the fastest modes of all grids have equal wave numbers.
    #[serde(rename = "orders")]
    pub growth_orders: Option<GrowthOrders>,
    /// Check of the fastest growing mode on each grid.
    #[serde(rename = "grids")]
    pub fastest_modes: Vec<FastestModeCheck>,
    /// Whether measured and predicted rates agree on all grids. If `growth_orders` is not `None`, the measured order
    /// must also agree with the predicted one, and the latter must be close to `verdict_order`.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
    /// Whether the fastest mode of each grid grows at more than three times the shear rate of the mean flow.
    #[serde(skip)]
    pub is_growing: bool,
    /// Title of the model in reports.
    #[serde(skip)]
    pub model_title: &'static str,
    /// Shear rate Q_D of the mean flow in this model: magnitude of the deviatoric deformation rate, 1/s.
    #[serde(skip)]
    pub shear_rate: f64,
}

/// Orders of growth in the wave number, fitted over the refined grids.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GrowthOrders {
    /// Order of growth in the wave number of the predicted rates.
    #[serde(rename = "predicted")]
    pub predicted_order: f64,
    /// Order of growth in the wave number of the measured rates.
    #[serde(rename = "measured")]
    pub measured_order: f64,
}

/// Growth rate of the fastest growing mode of one grid, predicted and measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FastestModeCheck {
    /// Number of grid points along each axis.
    #[serde(rename = "points")]
    pub point_counts: [usize; 2],
    /// Number of periods of the mode in the box along each axis.
    #[serde(rename = "mode")]
    pub mode_numbers: [i32; 2],
    /// Initial wave number of the mode, 1/m.
    #[serde(rename = "number")]
    pub wave_number: f64,
    /// Growth rate predicted by the linearised equations, 1/s.
    #[serde(rename = "predicted")]
    pub predicted_growth: f64,
    /// Growth rate measured by the solver, 1/s.
    #[serde(rename = "measured")]
    pub measured_growth: f64,
    /// Whether measured and predicted growth rates of this mode agree.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
}

/// Progress callback, called with the index of the grid, and the number of done and of all increments of that grid.
pub(super) type GridProgressCallback<'a> =
    &'a (dyn Fn(usize, [usize; 2]) -> ControlFlow<()> + Sync);

/// Simulates the perturbation of `run` in the model of a case on each of the `grids`, given as points per axis, and
/// compares the growth rate of the fastest mode of each grid with the prediction.
pub(super) fn check_refinement(
    ConvertedCase { case, lost_noncoaxiality_deg }: ConvertedCase,
    run: &FlowRun,
    grids: &[usize],
    on_progress: GridProgressCallback,
) -> Result<RefinementCheck, Error> {
    let problem = create_uniform_flow(&case)?;
    let verdict_order = match compute_verdict(&case, &problem)? {
        Verdict::IllPosed { growth: Some(growth), .. } => GrowthOrder::to_f64(growth.order),
        _ => 0.0,
    };
    let fastest = |(index, &points): (usize, &usize)| {
        let perturbation = create_perturbation_on_grid(run, &problem, points)?;
        compare_fastest_mode(&problem, &perturbation, &|done, all| on_progress(index, [done, all]))
            .map_err(|error| locate_agreement_error(&case.material, error))
    };
    let grids = grids.iter().enumerate().map(fastest).collect::<Result<_, Error>>()?;
    let own = GridRefinement { verdict_order, grids, shear_rate: problem.flow.shear_rate };
    let grid = |grid: &FastestMode| FastestModeCheck {
        point_counts: grid.points,
        mode_numbers: grid.mode,
        wave_number: grid.wave_number,
        predicted_growth: grid.predicted_growth,
        measured_growth: grid.measured_growth,
        is_in_agreement: own.is_grid_within_tolerance(grid),
    };
    Ok(RefinementCheck {
        model_name: case.material.kind.name(),
        replaced_noncoaxiality_deg: lost_noncoaxiality_deg,
        verdict_order,
        growth_orders: own.fit_orders().map(|[predicted, measured]| GrowthOrders {
            predicted_order: predicted,
            measured_order: measured,
        }),
        fastest_modes: own.grids.iter().map(grid).collect(),
        is_in_agreement: own.is_within_tolerance(),
        is_growing: own.is_growing(),
        model_title: case.material.kind.title(),
        shear_rate: own.shear_rate,
    })
}
