//! Grid refinement: the fastest growing mode of a perturbation on a sequence of grids.

use super::UniformFlow;
use super::linearised::LinearisedFlow;
use super::linearised::SAMPLE_COUNT;
use super::waves::{MIN_RELATIVE_AMPLITUDE, measure_amplitudes, sample_times};
use crate::fit::{fit_rate, fit_slope};
use crate::{AgreementError, ProgressCallback, TaskProgress};
use dynamics::flow::spectral::ModeNumbers;
use dynamics::flow::{Closure, FlowProblem, FlowSolver as Solver};
use models::common::elementary::{Elementary, Modulus};
use num_complex::Complex64;
use rayon::prelude::*;

/// Perturbation of a uniform flow, sampled at the points of a box, first axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Perturbation {
    /// Points along each axis; even, at least 4.
    pub points: [usize; 2],
    /// Initial edge lengths of the box, m.
    pub lengths: [f64; 2],
    /// Velocity perturbation, m/s.
    pub velocity: [Vec<f64>; 2],
    /// Perturbation of the internal variable: spin ω (rad/s) or stress angle ψ (rad); zero if the model has none.
    pub internal_variable: Vec<f64>,
}

/// The fastest growing mode on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct FastestMode {
    /// Points along each axis.
    pub points: [usize; 2],
    /// Mode numbers of the Fourier mode.
    pub mode: ModeNumbers,
    /// Initial wave number of the mode, 1/m.
    pub wave_number: f64,
    /// Growth rate over the last half of the measurement, predicted by the linearised equations along the wave vector
    /// k(t), which the mean flow advects, 1/s.
    pub predicted_growth: f64,
    /// Growth rate measured in the solver over the same time, 1/s.
    pub measured_growth: f64,
}

/// Fastest growing modes of one perturbation under grid refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct GridRefinement {
    /// Order of growth in k as k → ∞ according to the analysis; 0 if the flow is well-posed.
    pub verdict_order: f64,
    /// Result of each grid.
    pub grids: Vec<FastestMode>,
    /// Shear rate Q_D of the mean flow, 1/s.
    pub shear_rate: f64,
}

impl GridRefinement {
    /// Tolerance of measured against predicted rates, relative to the larger of the predicted rate and the shear rate,
    /// and of measured against predicted orders, relative to the predicted order.
    pub const RATE_TOLERANCE: f64 = 0.01;

    /// Tolerance of the order on finite grids against the asymptotic order of the analysis: half of the difference
    /// between the orders 1 and ½.
    pub const ORDER_TOLERANCE: f64 = 0.25;

    /// Whether measured and predicted rates on `grid` agree.
    pub fn is_grid_within_tolerance(&self, grid: &FastestMode) -> bool {
        let scale = grid.predicted_growth.abs().max(self.shear_rate);
        (grid.measured_growth - grid.predicted_growth).abs() <= Self::RATE_TOLERANCE * scale
    }

    /// Whether the fastest mode of each grid grows at more than three times the shear rate of the mean flow.
    pub fn is_growing(&self) -> bool {
        let grows = |own: &FastestMode| {
            own.predicted_growth.min(own.measured_growth) > 3.0 * self.shear_rate
        };
        !self.grids.is_empty() && self.grids.iter().all(grows)
    }

    /// Orders in the wave number of predicted and measured rates, fitted to all grids; `None` for fewer than two
    /// grids, if [`is_growing`](Self::is_growing) is false, or if the fastest modes of all grids have the same wave
    /// number.
    pub fn fit_orders(&self) -> Option<[f64; 2]> {
        let ends = self.grids.iter().fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], own| {
            [low.min(own.wave_number), high.max(own.wave_number)]
        });
        // Wave numbers that are equal within rounding count as one.
        let is_one_number = ends[1] - ends[0] <= 1e-9 * ends[1];
        if self.grids.len() < 2 || is_one_number || !self.is_growing() {
            return None;
        }
        let numbers: Vec<f64> = self.grids.iter().map(|own| own.wave_number.cr_ln()).collect();
        let order = |value: fn(&FastestMode) -> f64| {
            let values: Vec<f64> = self.grids.iter().map(|own| value(own).cr_ln()).collect();
            fit_slope(&numbers, &values)
        };
        Some([order(|own| own.predicted_growth), order(|own| own.measured_growth)])
    }

    /// Whether on all grids measured and predicted rates agree ([`RATE_TOLERANCE`](Self::RATE_TOLERANCE)), and their
    /// orders, if defined, agree with each other and with the order of the verdict
    /// ([`ORDER_TOLERANCE`](Self::ORDER_TOLERANCE)).
    pub fn is_within_tolerance(&self) -> bool {
        let orders = match self.fit_orders() {
            // No order is defined if the grids are too coarse for growth, or if they share the fastest mode.
            None => true,
            Some([predicted, measured]) => {
                (predicted - self.verdict_order).abs() < Self::ORDER_TOLERANCE
                    && (measured - predicted).abs() <= Self::RATE_TOLERANCE * predicted
            }
        };
        orders && self.grids.iter().all(|own| self.is_grid_within_tolerance(own))
    }
}

/// Number of progress increments of the comparison on a grid.
const PROGRESS_STEPS: usize = 1000;

/// Number of progress increments until all rates are predicted; the others are proportional to the simulated time.
const PREDICTION_STEPS: usize = 100;

/// Rates (1/s) of one Fourier mode, by descending growth.
type ModeRates = (ModeNumbers, Vec<Complex64>);

/// Predicts and measures the fastest growing mode of a perturbation. Progress counts thousandths; the callback is
/// called for each predicted mode, and before each evaluation of the right-hand side of the solver.
///
/// # Errors
/// The solver rejects the flow or stops before the end time; the perturbation has no velocity, or not one value per
/// point; the equations do not determine the evolution; the progress callback cancels the comparison, which then ends
/// after the current time step.
pub fn compare_fastest_mode(
    problem: &UniformFlow,
    perturbation: &Perturbation,
    on_progress: ProgressCallback,
) -> Result<FastestMode, AgreementError> {
    let flow = LinearisedFlow::new(problem);
    let (points, lengths) = (perturbation.points, perturbation.lengths);
    // The solver tolerances are looser than for a single wave, since they apply to the entire perturbation, which contains
    // many waves: errors of the rates of about 0.1 %, a tenth of their tolerance.
    let solver_problem = FlowProblem {
        tolerance: 3e-5,
        pressure_tolerance: 1e-6,
        points,
        lengths,
        ..problem.solver_problem.clone()
    };
    let mut solver = Solver::new(&solver_problem)?;
    let ([v1, v2], internal) = (&perturbation.velocity, &perturbation.internal_variable);
    let found = [v1.len(), v2.len(), internal.len()];
    if found != [points[0] * points[1]; 3] {
        return Err(AgreementError::PointCount { found, points });
    }
    solver.perturb([v1, v2], internal)?;
    let all = predict_mode_rates(&flow, &solver, on_progress)?;
    let growth = |own: &ModeRates| own.1.first().map_or(f64::MIN, |rate| rate.re);
    let fastest = all.iter().max_by(|a, b| growth(a).total_cmp(&growth(b)));
    let (mode, rates) = fastest.ok_or(AgreementError::NoVelocity)?;
    let stiffest = all.iter().flat_map(|own| &own.1).map(|rate| rate.modulus()).fold(0.0, f64::max);
    let shear_rate = flow.flow.shear_rate;
    // Three e-folds of the fastest mode, but at most a shear strain of 0.1 and 2000 time constants of the stiffest
    // mode, which take a few hundred stages of the solver.
    let duration = (3.0 / rates.first().map_or(0.0, |rate| rate.re).max(0.0))
        .min(0.1 / shear_rate)
        .min(2e3 / stiffest);
    let wave = solver.wave_vector(*mode);
    let mut measured = vec![measure_amplitudes(&solver, *mode)];
    let count = if solver_problem.closure == Closure::PlasticPotential { 2 } else { 3 };
    let (duration, predicted) = {
        let mut duration = duration;
        loop {
            let predicted = flow.predict_amplitudes(wave, measured[0], count, duration)?;
            // The duration of a decaying mode is halved until its amplitude stays far above rounding.
            let least = predicted.iter().map(|own| own[0].modulus()).fold(f64::MAX, f64::min);
            if least > MIN_RELATIVE_AMPLITUDE * predicted[0][0].modulus()
                || duration < 1e-9 / shear_rate
            {
                break (duration, predicted);
            }
            duration *= 0.5;
        }
    };
    let mut progress = MeasurementProgress::new(on_progress, duration);
    for time in sample_times(duration).into_iter().skip(1) {
        while solver.time() < time {
            solver.advance_with(time, &mut |time| progress.report(time))?;
            progress.ensure_not_cancelled()?;
        }
        measured.push(measure_amplitudes(&solver, *mode));
    }
    // Fit the rate to the last half of the samples, after the other modes have decayed.
    let half = SAMPLE_COUNT / 2;
    let growth = |all: &[[Complex64; 2]]| {
        let transverse: Vec<Complex64> = all[half..].iter().map(|own| own[0]).collect();
        fit_rate(&sample_times(duration)[half..], &transverse).growth_rate
    };
    Ok(FastestMode {
        points,
        mode: *mode,
        wave_number: wave[0].root_sum_square(wave[1]),
        predicted_growth: growth(&predicted),
        measured_growth: growth(&measured),
    })
}

/// Progress of a measurement on one grid.
struct MeasurementProgress<'a> {
    on_progress: ProgressCallback<'a>,
    /// Duration of the measurement, s.
    duration: f64,
    reported_steps: usize,
    is_cancelled: bool,
}

impl<'a> MeasurementProgress<'a> {
    fn new(on_progress: ProgressCallback<'a>, duration: f64) -> Self {
        Self { on_progress, duration, reported_steps: PREDICTION_STEPS, is_cancelled: false }
    }

    /// Reports the simulated time, s; a repeated step does not reduce the progress.
    fn report(&mut self, time: f64) {
        let steps = (PROGRESS_STEPS - PREDICTION_STEPS) as f64 * (time / self.duration).min(1.0);
        self.reported_steps = self.reported_steps.max(PREDICTION_STEPS + steps as usize);
        if !self.is_cancelled {
            self.is_cancelled = (self.on_progress)(self.reported_steps, PROGRESS_STEPS).is_break();
        }
    }

    fn ensure_not_cancelled(&self) -> Result<(), AgreementError> {
        if self.is_cancelled { Err(AgreementError::Cancelled) } else { Ok(()) }
    }
}

/// Predicted rates of the modes whose velocity exceeds 1/1000 of the largest; one mode of each pair k, −k.
fn predict_mode_rates(
    flow: &LinearisedFlow,
    solver: &Solver,
    on_progress: ProgressCallback,
) -> Result<Vec<ModeRates>, AgreementError> {
    let [most, across] = solver.max_modes().map(|greatest| greatest as i32);
    let all: Vec<(ModeNumbers, f64)> = (0..=most)
        .flat_map(|first| (-across..=across).map(move |second| [first, second]))
        .filter(|mode| *mode > [0, 0])
        .map(|mode| (mode, measure_amplitudes(solver, mode)[0].modulus()))
        .collect();
    let greatest = all.iter().map(|own| own.1).fold(0.0, f64::max);
    let is_held = |own: &&(ModeNumbers, f64)| greatest > 0.0 && own.1 > 1e-3 * greatest;
    let modes: Vec<ModeNumbers> = all.iter().filter(is_held).map(|own| own.0).collect();
    let in_grid =
        |done: usize, all: usize| on_progress(PREDICTION_STEPS * done / all.max(1), PROGRESS_STEPS);
    let progress = TaskProgress::new(&in_grid, modes.len())?;
    let rates = |mode: &ModeNumbers| {
        let modes = flow.linearise_moving_evolution(solver.wave_vector(*mode))?.modes();
        progress.advance()?;
        Ok((*mode, modes.into_iter().map(|own| own.0).collect()))
    };
    modes.par_iter().map(rates).collect()
}
