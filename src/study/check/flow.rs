//! Checks of flows: waves advected by the mean flow, and a perturbation on refined grids.

use super::max_or_nan;
use super::refinement::{RefinementCheck, check_refinement};
use crate::Error;
use crate::case::Case;
use crate::setup::check::flow::{FlowPlan, FlowWave, compute_verdict, create_uniform_flow};
use crate::setup::check::locate_agreement_error;
use crate::study::ProgressCallback;
use agreement::fit::Rate;
use agreement::flows::{ModeResult, UniformFlow, compare_waves};
use agreement::{AgreementError, PlaneWave};
use models::common::elementary::Elementary;
use serde::Serialize;

/// Check result of a flow.
#[derive(Clone, Debug, Serialize)]
pub struct FlowCheck {
    /// Check of each mode of each wave.
    pub rows: Vec<ModeCheck>,
    /// Grid refinement of the perturbation of the case, one entry per model; empty without refined grids.
    pub refinements: Vec<RefinementCheck>,
    /// Shear rate Q_D of the mean flow: magnitude of the deviatoric deformation rate, 1/s.
    #[serde(skip)]
    pub shear_rate: f64,
    /// Growth and decay rates against the wave number, by direction and mode. Omitted are modes whose predicted |γ| is
    /// below three times the shear rate for all waves, and modes whose frozen-coefficient rate differs from the
    /// predicted rate by more than 10 % for any wave, as near degenerate directions.
    #[serde(skip)]
    pub curves: Vec<RateCurve>,
}

/// Check of one mode of a wave: predicted and measured rate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeCheck {
    /// Initial wave vector.
    pub wave: FlowWave,
    /// Number of the mode, from 1, by descending initial growth rate.
    pub mode: usize,
    /// Duration of the measurement, s.
    pub duration: f64,
    /// Rate predicted by the linearised equations along the wave vector k(t), which the mean flow changes.
    pub predicted: ComplexRate,
    /// Frozen-coefficient rate at the initial wave vector, from the matrix pencil.
    #[serde(rename = "frozen")]
    pub frozen_rate: ComplexRate,
    /// Rates measured by the solver for decreasing time steps; empty without measurement.
    pub measured: Vec<SequenceRate>,
    /// Measured rate extrapolated to zero time step; `None` without measurement.
    pub limit: Option<ComplexRate>,
    /// Bound on the error of the limit by extrapolation and rounding, 1/s; `None` without measurement.
    pub tolerance: Option<f64>,
    /// Reason why there is no measurement; `None` if there is one.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
    /// Order of convergence in the time step; `None` if the error is at the level of rounding, or without measurement.
    pub order: Option<f64>,
    /// Whether measured and predicted rate agree; `None` without measurement.
    pub agrees: Option<bool>,
    /// Measured minus predicted rate; `None` without measurement.
    #[serde(skip)]
    pub difference: Option<Rate>,
    /// Scale of relative differences, 1/s: the greater of the magnitude of the predicted rate and the shear rate.
    #[serde(skip)]
    pub scale: f64,
}

/// Complex rate: growth rate and angular frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComplexRate {
    /// Growth rate γ, 1/s.
    pub growth_rate: f64,
    /// Angular frequency ω, rad/s.
    pub frequency: f64,
}

impl From<Rate> for ComplexRate {
    fn from(Rate { frequency, growth_rate: growth }: Rate) -> Self {
        Self { growth_rate: growth, frequency }
    }
}

/// Rate measured in a simulation with a given number of time steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SequenceRate {
    /// Measured rate.
    #[serde(flatten)]
    pub rate: ComplexRate,
    /// Number of time steps of the simulation.
    pub steps: usize,
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
    pub predicted: Vec<[f64; 2]>,
    /// Initial wave numbers, 1/m, and measured |γ|, 1/s.
    pub measured: Vec<[f64; 2]>,
}

/// Number of increments of the progress of one wave, or of one grid in one model.
const TASK_INCREMENTS: usize = 1000;

/// Checks the waves of a flow, and a perturbation on refined grids if requested.
pub(super) fn check_flow(
    case: &Case,
    plan: &FlowPlan,
    on_progress: ProgressCallback,
) -> Result<FlowCheck, Error> {
    let FlowPlan { waves, kinds, grids } = plan;
    let problem = create_uniform_flow(case)?;
    compute_verdict(case, &problem)?;
    // Each wave, and each grid in one model, counts the same number of increments.
    let all = TASK_INCREMENTS * (waves.len() + kinds.len() * grids.len());
    let plane_waves: Vec<PlaneWave<2>> = waves.iter().map(FlowWave::to_plane_wave).collect();
    let results =
        compare_waves(&problem, &plane_waves, &|done, _| on_progress(TASK_INCREMENTS * done, all))
            .map_err(|error| locate_agreement_error(&case.material, error))?;
    let noncoaxiality_deg = problem.flow.noncoaxiality.to_degrees();
    let mut refinements = Vec::new();
    for (index, kind) in kinds.iter().enumerate() {
        let own = case.convert_with_noncoaxiality(*kind, Some(noncoaxiality_deg));
        if let Some(run) = &case.flow_run {
            let first = waves.len() + index * grids.len();
            let on_grid_progress = |grid: usize, [done, total]: [usize; 2]| {
                on_progress(TASK_INCREMENTS * (first + grid) + TASK_INCREMENTS * done / total, all)
            };
            refinements.push(check_refinement(own, run, grids, &on_grid_progress)?);
        }
    }
    let shear_rate = problem.flow.shear_rate;
    let curves = compute_curves(&problem, waves, &results, shear_rate)
        .map_err(|error| locate_agreement_error(&case.material, error))?;
    let row = |result: &ModeResult| ModeCheck::new(waves[result.wave_index], result, shear_rate);
    Ok(FlowCheck { rows: results.iter().map(row).collect(), refinements, shear_rate, curves })
}

/// Computes the curves of the rates predicted at the initial wave vector against its wave number, from half the
/// smallest to twice the largest one of the waves, and collects the measured rates.
fn compute_curves(
    problem: &UniformFlow,
    waves: &[FlowWave],
    results: &[ModeResult],
    shear_rate: f64,
) -> Result<Vec<RateCurve>, AgreementError> {
    let numbers = || results.iter().map(|row| waves[row.wave_index].wave_number);
    let (least, most) =
        (0.5 * numbers().fold(f64::MAX, f64::min), 2.0 * numbers().fold(0.0, f64::max));
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
    let has_turned = |row: &&ModeResult| {
        (row.frozen_rate - row.predicted_rate).max_norm() > 0.1 * row.predicted_rate.max_norm()
    };
    let mut curves = Vec::new();
    for (direction_deg, mode) in directions.iter().flat_map(|own| [(*own, 1), (*own, 2)]) {
        let is_own = |row: &&ModeResult| {
            waves[row.wave_index].direction_deg == direction_deg && row.mode_number == mode
        };
        let own: Vec<&ModeResult> = results.iter().filter(is_own).collect();
        let Some(first) = own.first() else { continue };
        if own.iter().all(is_slow) || own.iter().any(has_turned) {
            continue;
        }
        let point = |index: u32| {
            let number = least * (most / least).cr_powf(f64::from(index) / 80.0);
            let rates = problem
                .initial_rates(&FlowWave { wave_number: number, direction_deg }.to_plane_wave())?;
            Ok([number, rates.get(mode - 1).map_or(f64::NAN, |own| own.re.abs())])
        };
        let ring = |row: &&ModeResult| {
            let own = row.measurement.as_ref().ok()?;
            Some([waves[row.wave_index].wave_number, own.limit.growth_rate.abs()])
        };
        curves.push(RateCurve {
            direction_deg,
            is_growing: first.predicted_rate.growth_rate > 0.0,
            predicted: (0..=80).map(point).collect::<Result<_, AgreementError>>()?,
            measured: own.iter().filter_map(ring).collect(),
        });
    }
    Ok(curves)
}

impl FlowCheck {
    /// Returns whether all measured modes and all grid refinements agree; `None` without any.
    pub fn agrees(&self) -> Option<bool> {
        let is_anything = self.rows.iter().any(|row| row.limit.is_some());
        let [_, failed] = self.row_counts();
        (is_anything || !self.refinements.is_empty()).then_some(failed == 0)
    }

    /// Returns the number of modes without measurement.
    pub fn unmeasured_count(&self) -> usize {
        self.rows.iter().filter(|row| row.unmeasured_reason.is_some()).count()
    }

    /// Returns the number of modes and refinements, and the number that disagree.
    pub fn row_counts(&self) -> [usize; 2] {
        let failed = self.rows.iter().filter(|row| row.agrees == Some(false)).count()
            + self.refinements.iter().filter(|own| !own.agrees).count();
        [self.rows.len() + self.refinements.len(), failed]
    }

    /// Returns the largest difference between measured and predicted rates of the modes, relative to
    /// [`ModeCheck::scale`]; `None` without measurement.
    pub fn max_relative_difference(&self) -> Option<f64> {
        let relative = |row: &ModeCheck| Some(row.difference?.max_norm() / row.scale);
        max_or_nan(self.rows.iter().filter_map(relative))
    }
}

impl ModeCheck {
    fn new(wave: FlowWave, result: &ModeResult, shear_rate: f64) -> Self {
        let measured = result.measurement.as_ref().ok();
        let sequences = measured.iter().flat_map(|own| &own.rates_by_steps);
        Self {
            wave,
            mode: result.mode_number,
            duration: result.duration,
            predicted: result.predicted_rate.into(),
            frozen_rate: result.frozen_rate.into(),
            measured: sequences
                .map(|&(steps, rate)| SequenceRate { rate: rate.into(), steps })
                .collect(),
            limit: measured.map(|own| own.limit.into()),
            tolerance: measured.map(|own| own.tolerance),
            unmeasured_reason: result.measurement.as_ref().err().map(ToString::to_string),
            order: result.convergence_order(),
            agrees: result.is_within_tolerance(),
            difference: result.rate_difference(),
            scale: result.rate_scale(shear_rate),
        }
    }
}
