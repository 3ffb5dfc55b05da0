//! Checks of flows: waves advected by the mean flow, and growth of a perturbation on refined grids.

use super::max_with_nan_largest;
use super::refinement::{RefinementCheck, check_refinement};
use crate::Error;
use crate::case::Case;
use crate::setup::check::flow::{FlowCheckPlan, FlowWave, compute_verdict, create_uniform_flow};
use crate::setup::check::locate_agreement_error;
use crate::study::ProgressCallback;
use agreement::fit::Rate;
use agreement::flows::{ModeResult, UniformFlow, compare_waves};
use agreement::{AgreementError, PlaneWave};
use models::common::elementary::Elementary;
use serde::Serialize;

/// Check result of a flow: measured and predicted rates of its waves, and grid refinement of its perturbation.
#[derive(Clone, Debug, Serialize)]
pub struct FlowCheck {
    /// Check of each mode (eigenvector) of each wave.
    #[serde(rename = "rows")]
    pub mode_checks: Vec<ModeCheck>,
    /// Grid refinement of the perturbation of the case, with one entry per model; empty if the case has no refined
    /// grids.
    pub refinements: Vec<RefinementCheck>,
    /// Shear rate Q_D of the mean flow: magnitude of the deviatoric deformation rate, 1/s.
    #[serde(skip)]
    pub shear_rate: f64,
    /// Growth and decay rates against the wave number, by direction and mode. Omitted are modes whose predicted |γ| is
    /// below three times the shear rate for all waves, and modes whose frozen-coefficient rate differs from the
    /// predicted rate by more than 10 % for any wave, as near degenerate directions.
    #[serde(skip)]
    pub rate_curves: Vec<RateCurve>,
}

/// Check of one mode of a wave: its rate as predicted by the analysis and as measured by the solver.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeCheck {
    /// Initial wave vector of the wave, as wave number and direction.
    pub wave: FlowWave,
    /// Number of the mode, from 1, by descending initial growth rate.
    #[serde(rename = "mode")]
    pub mode_number: usize,
    /// Simulated duration of the measurement, s.
    pub duration: f64,
    /// Rate predicted by the linearised equations along the wave vector k(t), which the mean flow changes.
    #[serde(rename = "predicted")]
    pub predicted_rate: ComplexRate,
    /// Frozen-coefficient rate at the initial wave vector, from the matrix pencil.
    #[serde(rename = "frozen")]
    pub frozen_rate: ComplexRate,
    /// Rates measured by the solver with increasing numbers of time steps; empty without measurement.
    #[serde(rename = "measured")]
    pub measured_rates: Vec<RateByStepCount>,
    /// Measured rate, extrapolated to zero time step; `None` without measurement.
    #[serde(rename = "limit")]
    pub extrapolated_rate: Option<ComplexRate>,
    /// Bound on the error of `extrapolated_rate` by extrapolation and rounding, 1/s; `None` without measurement.
    pub tolerance: Option<f64>,
    /// Reason why there is no measurement; `None` if there is one.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
    /// Order of convergence in the time step; `None` if the error is at the level of rounding, or without measurement.
    #[serde(rename = "order")]
    pub convergence_order: Option<f64>,
    /// Whether measured and predicted rate agree; `None` without measurement.
    #[serde(rename = "agrees")]
    pub is_in_agreement: Option<bool>,
    /// Measured minus predicted rate; `None` without measurement.
    #[serde(skip)]
    pub rate_difference: Option<Rate>,
    /// Reference for relative differences, 1/s: the greater of the magnitude of the predicted rate and the shear rate.
    #[serde(skip)]
    pub rate_scale: f64,
}

/// Complex rate: growth rate and angular frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComplexRate {
    /// Growth rate γ of the wave, 1/s.
    pub growth_rate: f64,
    /// Angular frequency ω of the wave, rad/s.
    #[serde(rename = "frequency")]
    pub angular_frequency: f64,
}

impl From<Rate> for ComplexRate {
    fn from(Rate { frequency, growth_rate: growth }: Rate) -> Self {
        Self { growth_rate: growth, angular_frequency: frequency }
    }
}

/// Rate measured in a simulation with a given number of time steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RateByStepCount {
    /// Rate measured with this number of time steps.
    #[serde(flatten)]
    pub rate: ComplexRate,
    /// Number of time steps of the simulation.
    #[serde(rename = "steps")]
    pub step_count: usize,
}

/// Growth or decay rates |γ| of one mode in one direction against the wave number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RateCurve {
    /// Direction of the initial wave vectors from x₁, degrees.
    pub direction_deg: f64,
    /// Whether the predicted growth rate of the first wave is positive.
    #[serde(rename = "grows")]
    pub is_growing: bool,
    /// 81 initial wave numbers, 1/m, and |γ| of the rate predicted at the initial wave vector, 1/s.
    #[serde(rename = "predicted")]
    pub predicted_points: Vec<[f64; 2]>,
    /// Initial wave numbers, 1/m, and measured |γ|, 1/s.
    #[serde(rename = "measured")]
    pub measured_points: Vec<[f64; 2]>,
}

/// Number of progress increments of one wave, or of one grid in one model.
const INCREMENTS_PER_TASK: usize = 1000;

/// Checks the waves of a flow, and a perturbation on refined grids if requested.
pub(super) fn check_flow(
    case: &Case,
    plan: &FlowCheckPlan,
    on_progress: ProgressCallback,
) -> Result<FlowCheck, Error> {
    let FlowCheckPlan { waves, refined_models: kinds, refined_point_counts: grids } = plan;
    let problem = create_uniform_flow(case)?;
    compute_verdict(case, &problem)?;
    // Each wave, and each grid in one model, counts the same number of increments.
    let all = INCREMENTS_PER_TASK * (waves.len() + kinds.len() * grids.len());
    let plane_waves: Vec<PlaneWave<2>> = waves.iter().map(FlowWave::to_plane_wave).collect();
    let results = compare_waves(&problem, &plane_waves, &|done, _| {
        on_progress(INCREMENTS_PER_TASK * done, all)
    })
    .map_err(|error| locate_agreement_error(&case.material, error))?;
    let noncoaxiality_deg = problem.flow.noncoaxiality.to_degrees();
    let mut refinements = Vec::new();
    for (index, kind) in kinds.iter().enumerate() {
        let own = case.convert_with_noncoaxiality(*kind, Some(noncoaxiality_deg));
        if let Some(run) = &case.flow_run {
            let first = waves.len() + index * grids.len();
            let on_grid_progress = |grid: usize, [done, total]: [usize; 2]| {
                on_progress(
                    INCREMENTS_PER_TASK * (first + grid) + INCREMENTS_PER_TASK * done / total,
                    all,
                )
            };
            refinements.push(check_refinement(own, run, grids, &on_grid_progress)?);
        }
    }
    let shear_rate = problem.flow.shear_rate;
    let curves = compute_rate_curves(&problem, waves, &results, shear_rate)
        .map_err(|error| locate_agreement_error(&case.material, error))?;
    let row = |result: &ModeResult| ModeCheck::new(waves[result.wave_index], result, shear_rate);
    Ok(FlowCheck {
        mode_checks: results.iter().map(row).collect(),
        refinements,
        shear_rate,
        rate_curves: curves,
    })
}

/// Computes curves of the rate predicted at the initial wave vector, from half the smallest to twice the largest wave
/// number of the waves, and collects the measured rates as points.
fn compute_rate_curves(
    problem: &UniformFlow,
    waves: &[FlowWave],
    results: &[ModeResult],
    shear_rate: f64,
) -> Result<Vec<RateCurve>, AgreementError> {
    let wave_numbers = || results.iter().map(|row| waves[row.wave_index].wave_number);
    let (least, most) =
        (0.5 * wave_numbers().fold(f64::MAX, f64::min), 2.0 * wave_numbers().fold(0.0, f64::max));
    let mut directions: Vec<f64> = Vec::new();
    for row in results {
        let direction_deg = waves[row.wave_index].direction_deg;
        if !directions.contains(&direction_deg) {
            directions.push(direction_deg);
        }
    }
    // Omitted are modes with rates below three times the shear rate, for which the short-wave behaviour is not
    // decisive, and modes near degenerate directions, whose rate at the initial wave vector differs from that along
    // k(t).
    let is_slow = |row: &&ModeResult| row.predicted_rate.growth_rate.abs() < 3.0 * shear_rate;
    let is_near_degenerate_direction = |row: &&ModeResult| {
        (row.frozen_rate - row.predicted_rate).max_norm() > 0.1 * row.predicted_rate.max_norm()
    };
    let mut curves = Vec::new();
    for (direction_deg, mode) in directions.iter().flat_map(|own| [(*own, 1), (*own, 2)]) {
        let is_in_curve = |row: &&ModeResult| {
            waves[row.wave_index].direction_deg == direction_deg && row.mode_number == mode
        };
        let own: Vec<&ModeResult> = results.iter().filter(is_in_curve).collect();
        let Some(first) = own.first() else { continue };
        if own.iter().all(is_slow) || own.iter().any(is_near_degenerate_direction) {
            continue;
        }
        let point = |index: u32| {
            let number = least * (most / least).cr_powf(f64::from(index) / 80.0);
            let rates = problem
                .initial_rates(&FlowWave { wave_number: number, direction_deg }.to_plane_wave())?;
            Ok([number, rates.get(mode - 1).map_or(f64::NAN, |own| own.re.abs())])
        };
        let measured_point = |row: &&ModeResult| {
            let own = row.measurement.as_ref().ok()?;
            Some([waves[row.wave_index].wave_number, own.limit.growth_rate.abs()])
        };
        curves.push(RateCurve {
            direction_deg,
            is_growing: first.predicted_rate.growth_rate > 0.0,
            predicted_points: (0..=80).map(point).collect::<Result<_, AgreementError>>()?,
            measured_points: own.iter().filter_map(measured_point).collect(),
        });
    }
    Ok(curves)
}

impl FlowCheck {
    /// Returns whether all measured modes and all grid refinements agree; `None` without any.
    pub fn is_in_agreement(&self) -> Option<bool> {
        let is_anything = self.mode_checks.iter().any(|row| row.extrapolated_rate.is_some());
        let [_, failed] = self.item_and_failure_counts();
        (is_anything || !self.refinements.is_empty()).then_some(failed == 0)
    }

    /// Returns the number of modes without measurement.
    pub fn unmeasured_count(&self) -> usize {
        self.mode_checks.iter().filter(|row| row.unmeasured_reason.is_some()).count()
    }

    /// Returns the number of checked modes and grid refinements, and the number of those that disagree.
    pub fn item_and_failure_counts(&self) -> [usize; 2] {
        let failed =
            self.mode_checks.iter().filter(|row| row.is_in_agreement == Some(false)).count()
                + self.refinements.iter().filter(|own| !own.is_in_agreement).count();
        [self.mode_checks.len() + self.refinements.len(), failed]
    }

    /// Returns the largest difference between measured and predicted rates of the modes, relative to
    /// [`ModeCheck::rate_scale`]; `None` without measurement.
    pub fn max_relative_difference(&self) -> Option<f64> {
        let relative = |row: &ModeCheck| Some(row.rate_difference?.max_norm() / row.rate_scale);
        max_with_nan_largest(self.mode_checks.iter().filter_map(relative))
    }
}

impl ModeCheck {
    fn new(wave: FlowWave, result: &ModeResult, shear_rate: f64) -> Self {
        let measured = result.measurement.as_ref().ok();
        let sequences = measured.iter().flat_map(|own| &own.rates_by_steps);
        Self {
            wave,
            mode_number: result.mode_number,
            duration: result.duration,
            predicted_rate: result.predicted_rate.into(),
            frozen_rate: result.frozen_rate.into(),
            measured_rates: sequences
                .map(|&(steps, rate)| RateByStepCount { rate: rate.into(), step_count: steps })
                .collect(),
            extrapolated_rate: measured.map(|own| own.limit.into()),
            tolerance: measured.map(|own| own.tolerance),
            unmeasured_reason: result.measurement.as_ref().err().map(ToString::to_string),
            convergence_order: result.convergence_order(),
            is_in_agreement: result.is_within_tolerance(),
            rate_difference: result.rate_difference(),
            rate_scale: result.rate_scale(shear_rate),
        }
    }
}
