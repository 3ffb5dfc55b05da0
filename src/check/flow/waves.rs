//! Waves of one wave vector in a uniform flow, predicted and measured.

use super::background::{Background, undetermined};
use super::{Measured, Row, Wave};
use crate::Error;
use crate::check::fit::{Rate, error_of_rate, rate};
use crate::run::flow_problem;
use dynamics::flow::spectral::Mode;
use dynamics::flow::{Flow as Solver, Problem};
use models::elementary::{Elementary, cr_cis};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Perturbations relative to the background.
const AMPLITUDE: f64 = 1e-6;
/// Times at which an amplitude is taken, after the beginning.
pub(super) const TIMES: usize = 8;
/// Steps between two of them, on the coarsest of three sequences; each next one has twice as many. Where steps
/// are too long for the solver all three are halved, up to the second number.
const STEPS: [usize; 2] = [4, 64];
/// Points along each axis of a box of one wave: no shorter wave is in it, which would only make steps stiffer.
pub(super) const POINTS: usize = 4;
/// Powers of e by which other waves in the box may grow.
const FOLDS: f64 = 4.0;
/// What is left of a wave's amplitude at least, so that it is far above rounding.
pub(super) const LEAST: f64 = 0.1;
/// Steps between two times by which the analysis follows a wave.
pub(super) const COURSE: usize = 50;

/// The velocity across a mode and ω or ψ, in the solver.
pub(super) fn amplitudes(solver: &Solver, mode: Mode) -> [Complex64; 2] {
    let [k1, k2] = solver.wave_vector(mode);
    let [[vorticity, inner], _] = solver.mode(mode).unwrap_or_default();
    // ζ = ikV
    [vorticity / (Complex64::I * k1.root_sum_square(k2)), inner]
}

/// Times at which amplitudes are taken.
pub(super) fn times(duration: f64) -> Vec<f64> {
    (0..=TIMES).map(|index| duration * index as f64 / TIMES as f64).collect()
}

/// All waves of a wave vector.
pub(super) fn rows(background: &Background, wave: Wave) -> Result<Vec<Row>, Error> {
    let (lengths, mode) = wave.fitted();
    let vector = [0, 1].map(|axis| TAU * f64::from(mode[axis]) / lengths[axis]);
    let moving = background.moving(vector)?;
    let frozen = background.evolution(vector, [0.0; 2])?;
    let (modes, frozen) = (moving.modes(), frozen.modes());
    if modes.is_empty() || frozen.is_empty() {
        return Err(undetermined(background.case));
    }
    let shear_rate = background.flow.shear_rate;
    let amplitude = AMPLITUDE * background.inertial_part(wave.number).min(1.0);
    let problem = Problem {
        tolerance: 1e-9,
        pressure_tolerance: 1e-13,
        ..flow_problem(background.case, [POINTS; 2], lengths)?
    };
    let of = |(index, (eigenvalue, unknowns)): (usize, &(Complex64, Vec<Complex64>))| {
        // An e-fold, while the wave vector does not turn by much, and before what rounding makes of faster
        // waves in the box is seen.
        let duration = (1.0 / eigenvalue.norm()).min(0.2 / shear_rate);
        let mut growth = 0.0f64;
        for part in [0.0, 0.5, 1.0] {
            growth = growth.max(background.fastest_growth(lengths, part * duration)?);
        }
        let duration = duration.min(FOLDS / growth);
        let unit = background.across(vector, unknowns);
        let (greater, size) = background.greater(wave.number, unit);
        let start = unit.map(|own| own * (amplitude * size / unit[greater].norm()));
        let (duration, predicted, leading) = {
            let mut duration = duration;
            loop {
                let predicted = background.predicted(vector, start, unknowns.len(), duration)?;
                // Of both fields the one that varies less: the other may pass through zero.
                let least = |field: usize| {
                    let sizes = || predicted.iter().map(|own| own[field].norm());
                    sizes().fold(f64::MAX, f64::min) / sizes().fold(f64::MIN_POSITIVE, f64::max)
                };
                let leading = usize::from(least(1) > least(0));
                // A rate that is small at the beginning may not stay so.
                if least(leading) > LEAST || duration < 1e-9 / shear_rate {
                    break (duration, predicted, leading);
                }
                duration *= 0.5;
            }
        };
        let of_rate = |all: &[[Complex64; 2]]| {
            rate(&times(duration), &all.iter().map(|own| own[leading]).collect::<Vec<_>>())
        };
        let amplitude_of_course = predicted;
        let predicted = of_rate(&amplitude_of_course);
        // As many stages in all steps: the limit is that of one method.
        let sent = |steps: usize, stages: usize| {
            measured(&problem, mode, start, [steps, stages], duration)
        };
        let sequences = |steps: usize| -> Result<Vec<_>, String> {
            let (_, stages) = sent(steps, 0)?;
            let of = |times: usize| {
                let found = sent(steps * times, stages)?;
                Ok((steps * times * TIMES, of_rate(&found.0)))
            };
            [1, 2, 4].into_iter().map(of).collect()
        };
        let [mut steps, most] = STEPS;
        let sequences = loop {
            match sequences(steps) {
                Err(_) if steps < most => steps *= 2,
                found => break found,
            }
        };
        // Fields are rounded as parts of the background, which weighs more next to the bound; what a wave
        // makes of itself is of third order.
        let inverse = 1.0 / (2.0 * background.flow.noncoaxiality).cr_cos().abs();
        let unit = background.unit(wave.number, leading);
        let least = amplitude_of_course.iter().map(|own| own[leading].norm() / unit);
        let least = least.fold(amplitude, f64::min);
        let noise = inverse * (64.0 * f64::EPSILON / least + (AMPLITUDE * inverse).powi(2));
        let measured = sequences.map(|sequences| {
            let (limit, error) = in_the_limit(&sequences);
            let tolerance = error + error_of_rate(noise, duration);
            Measured { sequences, limit, tolerance }
        });
        let frozen = nearest(&frozen, *eigenvalue);
        Ok(Row { wave, mode: index + 1, duration, predicted, frozen, measured })
    };
    modes.iter().enumerate().map(of).collect()
}

/// The frozen rate that belongs to a moving wave's.
fn nearest(frozen: &[(Complex64, Vec<Complex64>)], rate: Complex64) -> Rate {
    let distance = |own: &&(Complex64, Vec<Complex64>)| (own.0 - rate).norm();
    let nearest = frozen.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(Rate::default(), |own| Rate { frequency: -own.0.im, growth: own.0.re })
}

/// Amplitudes of a wave in the solver.
type Amplitudes = Vec<[Complex64; 2]>;

/// Amplitudes of a wave in the solver, in so many steps between two of them and at least so many stages; and
/// the greatest number of stages. Or why the solver does not come to the end.
fn measured(
    problem: &Problem,
    mode: Mode,
    start: [Complex64; 2],
    [steps, least_stages]: [usize; 2],
    duration: f64,
) -> Result<(Amplitudes, usize), String> {
    let refused = |error| format!("the solver does not take it: {error}");
    let mut solver = Solver::new(problem).map_err(refused)?;
    let [k1, k2] = solver.wave_vector(mode);
    let number = k1.root_sum_square(k2);
    // Re z exp(ik·y), counted from the first point: of it the mode is a half.
    let value = |z: Complex64| -> Vec<f64> {
        (0..POINTS * POINTS)
            .map(|point| {
                let [i, j] = [point % POINTS, point / POINTS].map(|index| index as f64);
                let turns = (f64::from(mode[0]) * i + f64::from(mode[1]) * j) / POINTS as f64;
                2.0 * (z * cr_cis(TAU * turns)).re
            })
            .collect()
    };
    let [across, inner] = start;
    let velocity = [value(-across * (k2 / number)), value(across * (k1 / number))];
    if let Err(error) = solver.perturb([&velocity[0], &velocity[1]], &value(inner)) {
        return Err(format!("the solver does not begin: {error}"));
    }
    let step = duration / (TIMES * steps) as f64;
    let (mut all, mut stages) = (vec![amplitudes(&solver, mode)], least_stages);
    for _ in 0..TIMES {
        for _ in 0..steps {
            if let Err(error) = solver.advance_by(step, least_stages) {
                return Err(format!("the solver stops at {:.3e} s: {error}", error.time));
            }
            stages = stages.max(solver.stages());
        }
        all.push(amplitudes(&solver, mode));
    }
    let is_sound = all.iter().flatten().all(|own| own.is_finite());
    if is_sound { Ok((all, stages)) } else { Err("amplitudes that are not finite".to_owned()) }
}

/// Rates of three numbers of steps in the limit, errors being of second and third order in the step; and by
/// how much that differs from the limit of the two finest with second order alone: more than it is off.
fn in_the_limit(measured: &[(usize, Rate)]) -> (Rate, f64) {
    let [.., (_, one), (_, two), (_, four)] = measured else { return (Rate::default(), f64::NAN) };
    let combine = |weights: [f64; 3]| {
        let of = |part: fn(&Rate) -> f64| {
            weights[0] * part(one) + weights[1] * part(two) + weights[2] * part(four)
        };
        Rate { frequency: of(|own| own.frequency), growth: of(|own| own.growth) }
    };
    // Steps h, h/2 and h/4.
    let second = combine([0.0, -1.0 / 3.0, 4.0 / 3.0]);
    let third = combine([1.0 / 21.0, -12.0 / 21.0, 32.0 / 21.0]);
    (third, third.less(second).size())
}
