//! Plane waves in a uniform flow: prediction and measurement of their modes.

use super::linearised::{BOX_POINTS, LinearisedFlow, SAMPLE_COUNT};
use super::{ModeResult, TimeStepRefinement, UniformFlow};
use crate::fit::{Rate, fit_rate, max_rate_error};
use crate::{AgreementError, MeasurementError, PlaneWave, ProgressCallback, TaskProgress};
use dynamics::flow::spectral::ModeNumbers;
use dynamics::flow::{FlowProblem, FlowSolver as Solver};
use models::common::elementary::{Elementary, Modulus, cr_cis};
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Amplitude of perturbations relative to the mean flow.
const RELATIVE_AMPLITUDE: f64 = 1e-6;
/// First and largest number of steps between two sample times in the coarsest of three measurements; each further
/// measurement doubles the number of steps. If the solver fails, the steps of all three are doubled, up to the largest
/// number.
const STEPS_PER_SAMPLE_RANGE: [usize; 2] = [4, 64];
/// Maximum number of e-folds by which other waves in the box may grow during a measurement.
const MAX_E_FOLDS: f64 = 4.0;
/// Smallest admissible amplitude of a wave relative to its initial amplitude, far above rounding.
pub(super) const MIN_RELATIVE_AMPLITUDE: f64 = 0.1;

/// Measured amplitudes of a mode: transverse velocity V (m/s) and internal variable, spin ω (rad/s) or stress angle ψ
/// (rad).
pub(super) fn measure_amplitudes(solver: &Solver, mode: ModeNumbers) -> [Complex64; 2] {
    let [k1, k2] = solver.wave_vector(mode);
    let [[vorticity, internal], _] = solver.mode_amplitudes(mode).unwrap_or_default();
    // The vorticity is ζ = ikV for the transverse velocity V.
    [vorticity / (Complex64::I * k1.root_sum_square(k2)), internal]
}

/// Sample times, s: 0 to `duration` in equal intervals.
pub(super) fn sample_times(duration: f64) -> Vec<f64> {
    (0..=SAMPLE_COUNT).map(|index| duration * index as f64 / SAMPLE_COUNT as f64).collect()
}

/// Predicts and measures all modes of all waves; results in the order of the waves.
///
/// # Errors
/// The equations do not determine the evolution of a wave; the progress callback cancels the comparison.
pub fn compare_waves(
    problem: &UniformFlow,
    waves: &[PlaneWave<2>],
    on_progress: ProgressCallback,
) -> Result<Vec<ModeResult>, AgreementError> {
    let flow = LinearisedFlow::new(problem);
    let progress = TaskProgress::new(on_progress, waves.len())?;
    let of_wave = |(index, wave): (usize, &PlaneWave<2>)| {
        let results = compare_modes(&flow, index, wave)?;
        progress.advance()?;
        Ok(results)
    };
    let all: Vec<Vec<ModeResult>> =
        waves.par_iter().enumerate().map(of_wave).collect::<Result<_, AgreementError>>()?;
    Ok(all.into_iter().flatten().collect())
}

/// An eigenvalue (1/s) and the unknowns of its mode.
type Eigenmode = (Complex64, Vec<Complex64>);

/// A wave of one wave vector in its periodic box.
struct WaveExperiment<'a> {
    flow: &'a LinearisedFlow<'a>,
    wave_index: usize,
    /// Wave number, 1/m.
    wave_number: f64,
    /// Initial wave vector k, 1/m.
    wave_vector: [f64; 2],
    /// Edge lengths of the box, m.
    lengths: [f64; 2],
    mode: ModeNumbers,
    problem: FlowProblem,
    /// Initial amplitude of the larger field, relative to its scale by the mean flow.
    relative_amplitude: f64,
    frozen_modes: Vec<Eigenmode>,
}

/// Predicts and measures all modes of a wave.
fn compare_modes(
    flow: &LinearisedFlow,
    index: usize,
    wave: &PlaneWave<2>,
) -> Result<Vec<ModeResult>, AgreementError> {
    let (lengths, mode) = wave.periodic_box();
    let vector = [0, 1].map(|axis| TAU * f64::from(mode[axis]) / lengths[axis]);
    let moving = flow.linearise_moving_evolution(vector)?;
    let frozen = flow.linearise_evolution(vector, [0.0; 2])?;
    let (modes, frozen) = (moving.modes(), frozen.modes());
    if modes.is_empty() || frozen.is_empty() {
        return Err(AgreementError::SingularEquations);
    }
    let experiment = WaveExperiment {
        flow,
        wave_index: index,
        wave_number: wave.wave_number,
        wave_vector: vector,
        lengths,
        mode,
        problem: FlowProblem {
            points: [BOX_POINTS; 2],
            lengths,
            tolerance: 1e-9,
            pressure_tolerance: 1e-13,
            ..flow.uniform_flow.solver_problem.clone()
        },
        relative_amplitude: RELATIVE_AMPLITUDE * flow.inertial_ratio(wave.wave_number).min(1.0),
        frozen_modes: frozen,
    };
    modes.iter().enumerate().map(|(index, own)| experiment.compare_mode(index + 1, own)).collect()
}

impl WaveExperiment<'_> {
    fn compare_mode(
        &self,
        mode: usize,
        (eigenvalue, unknowns): &Eigenmode,
    ) -> Result<ModeResult, AgreementError> {
        let flow = self.flow;
        let unit = flow.to_wave_amplitudes(self.wave_vector, unknowns);
        let (greater, size) = flow.dominant_field(self.wave_number, unit);
        let start =
            unit.map(|own| own * (self.relative_amplitude * size / unit[greater].modulus()));
        let duration = self.choose_duration(*eigenvalue)?;
        let (duration, course, leading) =
            self.predict_resolvable_amplitudes(start, unknowns.len(), duration)?;
        let fit = |all: &[[Complex64; 2]]| {
            fit_rate(
                &sample_times(duration),
                &all.iter().map(|own| own[leading]).collect::<Vec<_>>(),
            )
        };
        // A fixed number of stages for all step sizes, so that the extrapolation applies to one method.
        let measure = |steps: usize, stages: usize| {
            simulate_wave(&self.problem, self.mode, start, [steps, stages], duration)
        };
        let sequences = |steps: usize| -> Result<Vec<_>, MeasurementError> {
            let (_, stages) = measure(steps, 0)?;
            let of = |times: usize| {
                let found = measure(steps * times, stages)?;
                Ok((steps * times * SAMPLE_COUNT, fit(&found.0)))
            };
            [1, 2, 4].into_iter().map(of).collect()
        };
        let [mut steps, most] = STEPS_PER_SAMPLE_RANGE;
        let sequences = loop {
            match sequences(steps) {
                Err(_) if steps < most => steps *= 2,
                found => break found,
            }
        };
        // Field values are rounded relative to the background; rounding errors are amplified by 1/|cos 2Δ| for a
        // non-coaxiality Δ (rad). Nonlinear self-interaction of the wave is of third order in its amplitude.
        let inverse = 1.0 / (2.0 * flow.flow.noncoaxiality).cr_cos().abs();
        let unit = flow.field_scale(self.wave_number, leading);
        let least = course.iter().map(|own| own[leading].modulus() / unit);
        let least = least.fold(self.relative_amplitude, f64::min);
        let noise =
            inverse * (64.0 * f64::EPSILON / least + (RELATIVE_AMPLITUDE * inverse).powi(2));
        let measured = sequences.map(|sequences| {
            let (limit, error) = extrapolate_to_zero_step(&sequences);
            let tolerance = error + max_rate_error(noise, duration);
            TimeStepRefinement { rates_by_steps: sequences, limit, tolerance }
        });
        let (predicted, frozen) = (fit(&course), nearest_rate(&self.frozen_modes, *eigenvalue));
        Ok(ModeResult {
            wave_index: self.wave_index,
            mode_number: mode,
            duration,
            predicted_rate: predicted,
            frozen_rate: frozen,
            measurement: measured,
        })
    }

    /// Duration of a measurement, s: 1/|ς| of the eigenvalue ς (1/s), at most a shear strain of 0.2, so that the wave
    /// vector changes little, and at most [`MAX_E_FOLDS`] e-folds of the fastest mode of the box, so that rounding
    /// errors stay small.
    fn choose_duration(&self, eigenvalue: Complex64) -> Result<f64, AgreementError> {
        let duration = (1.0 / eigenvalue.modulus()).min(0.2 / self.flow.flow.shear_rate);
        let mut growth = 0.0f64;
        for part in [0.0, 0.5, 1.0] {
            growth = growth.max(self.flow.max_growth_rate(self.lengths, part * duration)?);
        }
        Ok(duration.min(MAX_E_FOLDS / growth))
    }

    /// Predicted amplitudes over a duration (s), which is halved until they stay far above rounding, and the index of
    /// the field with the smaller relative variation: the other field may pass through zero.
    fn predict_resolvable_amplitudes(
        &self,
        start: [Complex64; 2],
        count: usize,
        mut duration: f64,
    ) -> Result<(f64, Vec<[Complex64; 2]>, usize), AgreementError> {
        loop {
            let predicted =
                self.flow.predict_amplitudes(self.wave_vector, start, count, duration)?;
            let least = |field: usize| {
                let sizes = || predicted.iter().map(|own| own[field].modulus());
                sizes().fold(f64::MAX, f64::min) / sizes().fold(f64::MIN_POSITIVE, f64::max)
            };
            let leading = usize::from(least(1) > least(0));
            // The growth rate may change along k(t): limit the decay by the predicted amplitudes, not by the initial
            // rate.
            if least(leading) > MIN_RELATIVE_AMPLITUDE
                || duration < 1e-9 / self.flow.flow.shear_rate
            {
                return Ok((duration, predicted, leading));
            }
            duration *= 0.5;
        }
    }
}

/// Rate of the frozen wave vector that is closest to the given rate of the moving wave vector.
fn nearest_rate(frozen: &[Eigenmode], rate: Complex64) -> Rate {
    let distance = |own: &&Eigenmode| (own.0 - rate).modulus();
    let nearest = frozen.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(Rate::default(), |own| Rate { frequency: -own.0.im, growth_rate: own.0.re })
}

/// Amplitudes (transverse velocity, internal variable) of a wave in the solver, by sample time.
type AmplitudeSeries = Vec<[Complex64; 2]>;

/// Measures the amplitudes of a wave with the given number of steps between samples and minimum number of stages;
/// returns them with the largest number of stages used, or the reason why the solver stops.
fn simulate_wave(
    problem: &FlowProblem,
    mode: ModeNumbers,
    start: [Complex64; 2],
    [steps, least_stages]: [usize; 2],
    duration: f64,
) -> Result<(AmplitudeSeries, usize), MeasurementError> {
    let mut solver = Solver::new(problem)?;
    let [k1, k2] = solver.wave_vector(mode);
    let number = k1.root_sum_square(k2);
    // Real field 2 Re(z exp(ik·y)) with Fourier coefficient z, where y is the position relative to the first grid
    // point.
    let value = |z: Complex64| -> Vec<f64> {
        (0..BOX_POINTS * BOX_POINTS)
            .map(|point| {
                let [i, j] = [point % BOX_POINTS, point / BOX_POINTS].map(|index| index as f64);
                let turns = (f64::from(mode[0]) * i + f64::from(mode[1]) * j) / BOX_POINTS as f64;
                2.0 * (z * cr_cis(TAU * turns)).re
            })
            .collect()
    };
    let [transverse, internal] = start;
    let velocity = [value(-transverse * (k2 / number)), value(transverse * (k1 / number))];
    solver
        .perturb([&velocity[0], &velocity[1]], &value(internal))
        .map_err(MeasurementError::InitialState)?;
    let step = duration / (SAMPLE_COUNT * steps) as f64;
    let (mut all, mut stages) = (vec![measure_amplitudes(&solver, mode)], least_stages);
    for _ in 0..SAMPLE_COUNT {
        for _ in 0..steps {
            solver.advance_by(step, least_stages).map_err(MeasurementError::SolverStopped)?;
            stages = stages.max(solver.stage_count());
        }
        all.push(measure_amplitudes(&solver, mode));
    }
    let is_sound = all.iter().flatten().all(|own| own.is_finite());
    if is_sound { Ok((all, stages)) } else { Err(MeasurementError::NonFiniteAmplitude) }
}

/// Richardson extrapolation of the rates of three step sizes to zero, with errors of second and third order in the
/// step; and its distance from the second-order extrapolation of the two finest, which estimates its error (1/s).
fn extrapolate_to_zero_step(measured: &[(usize, Rate)]) -> (Rate, f64) {
    let [.., (_, one), (_, two), (_, four)] = measured else { return (Rate::default(), f64::NAN) };
    let combine = |weights: [f64; 3]| {
        let of = |part: fn(&Rate) -> f64| {
            weights[0] * part(one) + weights[1] * part(two) + weights[2] * part(four)
        };
        Rate { frequency: of(|own| own.frequency), growth_rate: of(|own| own.growth_rate) }
    };
    // Step sizes h, h/2 and h/4.
    let second = combine([0.0, -1.0 / 3.0, 4.0 / 3.0]);
    let third = combine([1.0 / 21.0, -12.0 / 21.0, 32.0 / 21.0]);
    (third, (third - second).max_norm())
}
