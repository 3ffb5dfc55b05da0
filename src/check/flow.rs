//! Flows: waves that the mean flow carries along, by the analysis and by the solver; and what finer grids
//! make of one perturbation.

use super::fit::{Rate, error_of_rate, rate};
use super::mean::MeanFlow;
use super::{digits, exponent, unmeasured_words};
use crate::Error;
use crate::case::flow::{Disturbed, FlowRun, Initial};
use crate::case::{Case, Converted, Kind};
use crate::frozen::{StateError, Workspace};
use crate::progress::Progress;
use crate::run::{flow_problem, perturbation};
use crate::words::{case_title, coaxial_words, order_words, short};
use analysis::growth::Verdict;
use analysis::kelvin::{Evolution, course, wave_vector, wave_vector_rate};
use analysis::newton::Order;
use dynamics::flow::spectral::{Mode, greatest_modes};
use dynamics::flow::{Closure, Flow as Solver, Problem};
use figures::{Line, SpectrumFigure};
use models::granular_flow::InputError;
use models::granular_flow::state::Flow;
use num_complex::Complex64;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Perturbations relative to the background.
const AMPLITUDE: f64 = 1e-6;
/// Times at which an amplitude is taken, after the beginning.
const TIMES: usize = 8;
/// Steps between two of them, on the coarsest of three sequences; each next one has twice as many. Where steps
/// are too long for the solver all three are halved, up to the second number.
const STEPS: [usize; 2] = [4, 64];
/// Points along each axis of a box of one wave.
const POINTS: usize = 8;
/// Powers of e by which other waves in the box may grow.
const FOLDS: f64 = 4.0;
/// What is left of a wave's amplitude at least, so that it is far above rounding.
const LEAST: f64 = 0.1;
/// Steps between two times by which the analysis follows a wave.
const COURSE: usize = 50;

/// A wave of one wave vector at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Wave number, 1/m.
    pub number: f64,
    /// Direction from x₁, anticlockwise, degrees.
    pub direction_deg: f64,
}

impl Wave {
    fn vector(&self) -> [f64; 2] {
        let angle = crate::case::radians(self.direction_deg);
        [self.number * angle.cos(), self.number * angle.sin()]
    }

    /// A box of one wave, and the mode that it is there.
    fn fitted(&self) -> ([f64; 2], Mode) {
        let [k1, k2] = self.vector();
        // Nearly along an axis it is along the axis.
        let is_along = |own: f64| own.abs() < 1e-9 * self.number;
        match [k1, k2].map(is_along) {
            [true, _] => ([TAU / self.number; 2], [0, k2.signum() as i32]),
            [_, true] => ([TAU / self.number; 2], [k1.signum() as i32, 0]),
            _ => ([TAU / k1.abs(), TAU / k2.abs()], [k1.signum() as i32, k2.signum() as i32]),
        }
    }
}

/// A wave that grows, decays or oscillates: predicted and measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its wave vector at the beginning.
    pub wave: Wave,
    /// Its place among those of this wave vector, by descending growth at the beginning, from 1.
    pub mode: usize,
    /// Over which it was followed, s.
    pub duration: f64,
    /// By the linearised equations along k(t).
    pub predicted: Rate,
    /// By the frozen pencil.
    pub frozen: Rate,
    /// By the solver, or why there is no measurement.
    pub measured: Result<Measured, String>,
}

/// What the solver makes of a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Rates by numbers of steps, ascending.
    pub sequences: Vec<(usize, Rate)>,
    /// In the limit of small steps.
    pub limit: Rate,
    /// By how much the limit may be off: the error of the extrapolation, and rounding, 1/s.
    pub tolerance: f64,
}

impl Row {
    /// What differences are parts of: the rate, or that of the mean flow where that is greater, 1/s.
    pub fn scale(&self, shear_rate: f64) -> f64 {
        self.predicted.size().max(shear_rate)
    }

    /// Measured less predicted rate; `None` where there is no measurement.
    pub fn difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| own.limit.less(self.predicted))
    }

    /// Whether measured and predicted rate agree; `None` where there is no measurement.
    pub fn agrees(&self) -> Option<bool> {
        let own = self.measured.as_ref().ok()?;
        Some(own.limit.less(self.predicted).size() <= own.tolerance)
    }

    /// By which power of the step the error falls; `None` where it is rounding.
    pub fn order(&self) -> Option<f64> {
        let own = self.measured.as_ref().ok()?;
        let [(few, coarse), .., (many, fine)] = own.sequences.as_slice() else { return None };
        let [first, last] = [coarse, fine].map(|own| own.less(self.predicted).size());
        (last > own.tolerance).then(|| (first / last).ln() / (*many as f64 / *few as f64).ln())
    }
}

/// The fastest growing wave of one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Fastest {
    /// Points along each axis.
    pub points: [usize; 2],
    /// The mode.
    pub mode: Mode,
    /// Its wave number at the beginning, 1/m.
    pub number: f64,
    /// Its rate by the linearised equations along k(t), 1/s.
    pub predicted: f64,
    /// Its rate in the solver, 1/s.
    pub measured: f64,
}

/// What finer grids make of one perturbation in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// The model.
    pub kind: Kind,
    /// Its verdict's order; 0 where it is well-posed.
    pub limit: f64,
    /// Grid by grid.
    pub grids: Vec<Fastest>,
    /// |Γ|, in the sense of Q_D, 1/s.
    pub shear_rate: f64,
    /// The case's Δ, degrees, where this model can have none but 0.
    pub lost_noncoaxiality_deg: Option<f64>,
}

impl Refinement {
    /// Parts of the rate that measured and predicted ones may differ by.
    pub const TOLERANCE: f64 = 0.01;

    /// By how much the order on these grids may differ from that of the verdict, as k → ∞: less than half of what
    /// lies between orders of 1 and ½.
    pub const NEAR: f64 = 0.25;

    /// Whether this grid's rates agree.
    pub fn grid_agrees(&self, own: &Fastest) -> bool {
        let scale = own.predicted.abs().max(self.shear_rate);
        (own.measured - own.predicted).abs() <= Self::TOLERANCE * scale
    }

    /// Orders in the points of predicted and measured rates, by a fit to all grids; `None` where nothing grows
    /// faster than the mean flow deforms.
    pub fn orders(&self) -> Option<[f64; 2]> {
        let grows = |own: &Fastest| own.predicted.min(own.measured) > 3.0 * self.shear_rate;
        if self.grids.len() < 2 || !self.grids.iter().all(grows) {
            return None;
        }
        let points: Vec<f64> = self.grids.iter().map(|own| own.number.ln()).collect();
        let slope = |value: fn(&Fastest) -> f64| {
            let values: Vec<f64> = self.grids.iter().map(|own| value(own).ln()).collect();
            super::fit::slope(&points, &values)
        };
        Some([slope(|own| own.predicted), slope(|own| own.measured)])
    }

    /// Whether rates and orders agree, and the order is next to that of the verdict.
    pub fn agrees(&self) -> bool {
        let orders = match self.orders() {
            // On grids too coarse for growth there is no order.
            None => true,
            Some([predicted, measured]) => {
                (predicted - self.limit).abs() < Self::NEAR
                    && (measured - predicted).abs() <= Self::TOLERANCE * predicted
            }
        };
        orders && self.grids.iter().all(|own| self.grid_agrees(own))
    }
}

/// What was found of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// |Γ|, in the sense of Q_D, 1/s.
    pub shear_rate: f64,
    /// Waves.
    pub rows: Vec<Row>,
    /// What finer grids make of one perturbation, model by model.
    pub refinements: Vec<Refinement>,
}

impl Checked {
    /// Whether everything that was measured agrees; `None` where nothing was.
    pub fn agrees(&self) -> Option<bool> {
        let is_anything = self.rows.iter().any(|row| row.measured.is_ok());
        let [_, failed] = self.counts();
        (is_anything || !self.refinements.is_empty()).then_some(failed == 0)
    }

    /// Waves without a measurement, and why the first of them has none.
    pub fn unmeasured(&self) -> Option<(usize, &str)> {
        let mut reasons = self.rows.iter().filter_map(|row| row.measured.as_ref().err());
        reasons.next().map(|first| (1 + reasons.count(), first.as_str()))
    }

    /// Rows and refinements, and those that disagree.
    pub fn counts(&self) -> [usize; 2] {
        let failed = self.rows.iter().filter(|row| row.agrees() == Some(false)).count()
            + self.refinements.iter().filter(|own| !own.agrees()).count();
        [self.rows.len() + self.refinements.len(), failed]
    }

    /// The greatest difference of the rates of a measured wave, as part of the rate.
    pub fn worst(&self) -> f64 {
        let part = |row: &Row| Some(row.difference()?.size() / row.scale(self.shear_rate));
        super::greatest(self.rows.iter().filter_map(part))
    }
}

/// A background and its linearised equations.
struct Background<'a> {
    case: &'a Case,
    flow: Flow,
    mean: MeanFlow,
    gradient: [[f64; 2]; 2],
    verdict: Verdict,
}

impl<'a> Background<'a> {
    fn new(case: &'a Case) -> Result<Self, Error> {
        let located = |error: StateError| error.locate(case);
        let flow = case.mean_flow()?;
        let model = case.flow_model().map_err(|error| located(error.into()))?;
        let (verdict, _) =
            Workspace::default().decide(&model, &flow).map_err(|error| located(error.into()))?;
        let mean = MeanFlow::new(case, model, &flow);
        let gradient = flow.velocity_gradient.map(|row| row.map(|entry| entry.value));
        Ok(Self { case, flow, mean, gradient, verdict })
    }

    fn evolution(&self, wave: [f64; 2], rate: [f64; 2]) -> Result<Evolution, Error> {
        Evolution::new(self.mean.system(), wave, rate).ok_or_else(|| undetermined(self.case))
    }

    /// Evolution along k(t), at its beginning.
    fn moving(&self, wave: [f64; 2]) -> Result<Evolution, Error> {
        self.evolution(wave, wave_vector_rate(self.gradient, wave))
    }

    /// Unknowns of a wave from the velocity across it and ω or ψ.
    fn unknowns(
        &self,
        wave: [f64; 2],
        [across, inner]: [Complex64; 2],
        count: usize,
    ) -> Vec<Complex64> {
        let number = wave[0].hypot(wave[1]);
        let all = [-across * (wave[1] / number), across * (wave[0] / number), inner];
        all[..count].to_vec()
    }

    /// The other way.
    fn across(&self, wave: [f64; 2], unknowns: &[Complex64]) -> [Complex64; 2] {
        let number = wave[0].hypot(wave[1]);
        let across = (unknowns[1] * wave[0] - unknowns[0] * wave[1]) / number;
        [across, unknowns.get(2).copied().unwrap_or_default()]
    }

    /// Of the velocity across a wave and of ω or ψ the greater one, in units of the mean flow, and that unit.
    fn greater(&self, number: f64, all: [Complex64; 2]) -> (usize, f64) {
        let size = |field: usize| all[field].norm() / self.unit(number, field);
        let greater = usize::from(size(1) > size(0));
        (greater, self.unit(number, greater))
    }

    /// What the mean flow has of the velocity across a wave of that number (0), or of ω or ψ (1).
    fn unit(&self, number: f64, field: usize) -> f64 {
        let rate = 2.0 * self.flow.shear_rate;
        match (field, self.flow.spin) {
            (0, _) => rate / number,
            (_, Some(_)) => rate,
            (_, None) => 1.0,
        }
    }

    /// The greatest growth rate of the waves in a box of one wave at a time, 1/s; 0 where none grows.
    fn fastest_growth(&self, lengths: [f64; 2], time: f64) -> Result<f64, Error> {
        let [most, across] = greatest_modes([POINTS; 2]).map(|greatest| greatest as i32);
        let mut fastest = 0.0f64;
        let system = self.mean.system_at(time).ok_or_else(|| undetermined(self.case))?;
        for first in 0..=most {
            for second in (-across..=across).filter(|second| [first, *second] > [0, 0]) {
                let mode = [f64::from(first), f64::from(second)];
                let start = [0, 1].map(|axis| TAU * mode[axis] / lengths[axis]);
                let wave = wave_vector(self.gradient, start, time);
                let rate = wave_vector_rate(self.gradient, wave);
                let evolution = Evolution::new(&system, wave, rate);
                let modes = evolution.ok_or_else(|| undetermined(self.case))?.modes();
                fastest = modes.iter().fold(fastest, |sum, own| sum.max(own.0.re));
            }
        }
        Ok(fastest)
    }

    /// Amplitudes of a wave by the linearised equations.
    fn predicted(
        &self,
        wave: [f64; 2],
        start: [Complex64; 2],
        count: usize,
        duration: f64,
    ) -> Result<Vec<[Complex64; 2]>, Error> {
        let start = self.unknowns(wave, start, count);
        let all = course(
            &|time| self.mean.system_at(time),
            self.gradient,
            wave,
            &start,
            duration,
            [TIMES, COURSE],
        );
        let all = all.ok_or_else(|| undetermined(self.case))?;
        let time = |index: usize| duration * index as f64 / TIMES as f64;
        let of = |(index, own): (usize, &Vec<Complex64>)| {
            self.across(wave_vector(self.gradient, wave, time(index)), own)
        };
        Ok(all.iter().enumerate().map(of).collect())
    }
}

fn refused(case: &Case, found: impl ToString) -> Error {
    let allowed = "a state further from the border of the fully deforming region".to_owned();
    case.locate(InputError { key: "background", found: found.to_string(), allowed }).into()
}

fn undetermined(case: &Case) -> Error {
    refused(case, "a state in which the equations do not determine how waves evolve")
}

/// The velocity across a mode and ω or ψ, in the solver.
fn amplitudes(solver: &Solver, mode: Mode) -> [Complex64; 2] {
    let [k1, k2] = solver.wave_vector(mode);
    let [[vorticity, inner], _] = solver.mode(mode).unwrap_or_default();
    // ζ = ikV
    [vorticity / (Complex64::I * k1.hypot(k2)), inner]
}

/// Times at which amplitudes are taken.
fn times(duration: f64) -> Vec<f64> {
    (0..=TIMES).map(|index| duration * index as f64 / TIMES as f64).collect()
}

/// Checks the waves of a flow, and what grids make of a perturbation if the case asks for it.
///
/// # Errors
/// The case is none of a flow that is run in time, or a state cannot be analysed.
pub(super) fn check(case: &Case, waves: &[Wave], grids: &[usize]) -> Result<Checked, Error> {
    let background = Background::new(case)?;
    let kinds: Vec<Kind> = match (&case.flow, grids) {
        (None, _) | (_, []) => Vec::new(),
        _ => [case.kind].into_iter().chain(case.compare.iter().flatten().copied()).collect(),
    };
    let progress = Progress::new("check", (waves.len() + kinds.len() * grids.len()) as u64);
    let of_wave = |wave: &Wave| {
        let rows = rows(&background, *wave);
        progress.tick(1);
        rows
    };
    let all: Vec<Vec<Row>> = waves.par_iter().map(of_wave).collect::<Result<_, Error>>()?;
    let mut refinements = Vec::new();
    let is_velocity = |part: &Initial| match part {
        Initial::Mode(wave) | Initial::Packet { wave, .. } => wave.field == Disturbed::Velocity,
        Initial::Noise { field, .. } => *field == Disturbed::Velocity,
        Initial::Uniform { .. } | Initial::File { .. } => false,
    };
    if let (Some(run), true) = (&case.flow, kinds.len() > 1)
        && !run.initial.iter().all(is_velocity)
    {
        let found = "a perturbation of more than the velocity for several models".to_owned();
        let allowed = "parts with field = \"v\" alone, which all of them have".to_owned();
        return Err(case.locate(InputError { key: "initial", found, allowed }).into());
    }
    for kind in kinds {
        let noncoaxiality_deg = background.flow.noncoaxiality.to_degrees();
        let own = case.for_kind_with(kind, Some(noncoaxiality_deg));
        if let Some(run) = &case.flow {
            refinements.push(refinement(&own, run, grids, &progress)?);
        }
    }
    let shear_rate = background.flow.shear_rate;
    Ok(Checked { shear_rate, rows: all.into_iter().flatten().collect(), refinements })
}

/// The worst direction of an ill-posed state, degrees.
pub(super) fn worst_direction_deg(case: &Case) -> Result<Option<f64>, Error> {
    Ok(match Background::new(case)?.verdict {
        Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
        _ => None,
    })
}

/// All waves of a wave vector.
fn rows(background: &Background, wave: Wave) -> Result<Vec<Row>, Error> {
    let (lengths, mode) = wave.fitted();
    let vector = [0, 1].map(|axis| TAU * f64::from(mode[axis]) / lengths[axis]);
    let moving = background.moving(vector)?;
    let frozen = background.evolution(vector, [0.0; 2])?;
    let (modes, frozen) = (moving.modes(), frozen.modes());
    if modes.is_empty() || frozen.is_empty() {
        return Err(undetermined(background.case));
    }
    let shear_rate = background.flow.shear_rate;
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
        let start = unit.map(|own| own * (AMPLITUDE * size / unit[greater].norm()));
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
            measured(background, &problem, mode, start, [steps, stages], duration)
        };
        let sequences = |steps: usize| -> Result<Result<Vec<_>, String>, Error> {
            let stages = match sent(steps, 0)? {
                Ok((_, stages)) => stages,
                Err(reason) => return Ok(Err(reason)),
            };
            [1, 2, 4]
                .map(|times| {
                    let found = sent(steps * times, stages)?;
                    Ok(found.map(|own| (steps * times * TIMES, of_rate(&own.0))))
                })
                .into_iter()
                .collect()
        };
        let [mut steps, most] = STEPS;
        let sequences = loop {
            match sequences(steps)? {
                Err(_) if steps < most => steps *= 2,
                found => break found,
            }
        };
        // Fields are rounded as parts of the background, which weighs more next to the bound; what a wave
        // makes of itself is of third order.
        let inverse = 1.0 / (2.0 * background.flow.noncoaxiality).cos().abs();
        let unit = background.unit(wave.number, leading);
        let least = amplitude_of_course.iter().map(|own| own[leading].norm() / unit);
        let least = least.fold(AMPLITUDE, f64::min);
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
    background: &Background,
    problem: &Problem,
    mode: Mode,
    start: [Complex64; 2],
    [steps, least_stages]: [usize; 2],
    duration: f64,
) -> Result<Result<(Amplitudes, usize), String>, Error> {
    let case = background.case;
    let mut solver = Solver::new(problem).map_err(|error| refused(case, error))?;
    let [k1, k2] = solver.wave_vector(mode);
    let number = k1.hypot(k2);
    // Re z exp(ik·y), counted from the first point: of it the mode is a half.
    let value = |z: Complex64| -> Vec<f64> {
        (0..POINTS * POINTS)
            .map(|point| {
                let [i, j] = [point % POINTS, point / POINTS].map(|index| index as f64);
                let turns = (f64::from(mode[0]) * i + f64::from(mode[1]) * j) / POINTS as f64;
                2.0 * (z * Complex64::cis(TAU * turns)).re
            })
            .collect()
    };
    let [across, inner] = start;
    let velocity = [value(-across * (k2 / number)), value(across * (k1 / number))];
    solver
        .perturb([&velocity[0], &velocity[1]], &value(inner))
        .map_err(|error| refused(case, error))?;
    let step = duration / (TIMES * steps) as f64;
    let (mut all, mut stages) = (vec![amplitudes(&solver, mode)], least_stages);
    for _ in 0..TIMES {
        for _ in 0..steps {
            if let Err(error) = solver.advance_by(step, least_stages) {
                return Ok(Err(format!("the solver stops at {:.3e} s: {error}", error.time)));
            }
            stages = stages.max(solver.stages());
        }
        all.push(amplitudes(&solver, mode));
    }
    let is_sound = all.iter().flatten().all(|own| own.is_finite());
    Ok(if is_sound { Ok((all, stages)) } else { Err("amplitudes that are not finite".to_owned()) })
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

/// What grids make of the perturbation of a case in its model.
fn refinement(
    converted: &Converted,
    run: &FlowRun,
    grids: &[usize],
    progress: &Progress,
) -> Result<Refinement, Error> {
    let Converted { case, lost_noncoaxiality_deg } = converted;
    let background = Background::new(case)?;
    let limit = match &background.verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => Order::value(growth.order),
        _ => 0.0,
    };
    let fastest = |points: &usize| {
        let found = fastest(&background, run, [*points; 2]);
        progress.tick(1);
        found
    };
    let grids = grids.iter().map(fastest).collect::<Result<_, _>>()?;
    Ok(Refinement {
        kind: case.kind,
        limit,
        grids,
        shear_rate: background.flow.shear_rate,
        lost_noncoaxiality_deg: *lost_noncoaxiality_deg,
    })
}

/// The mode of a grid that grows fastest, predicted and measured.
fn fastest(background: &Background, run: &FlowRun, points: [usize; 2]) -> Result<Fastest, Error> {
    let case = background.case;
    // Of a whole of which one wave is a small part.
    let problem = Problem { tolerance: 3e-7, ..flow_problem(case, points, run.grid.lengths)? };
    let initial = perturbation(run, &problem)?;
    let mut solver = Solver::new(&problem).map_err(|error| refused(case, error))?;
    let [v1, v2] = &initial.0;
    solver.perturb([v1, v2], &initial.1).map_err(|error| refused(case, error))?;
    let [most, across] = solver.greatest_modes().map(|greatest| greatest as i32);
    // Those that the perturbation holds, one of each pair of opposite ones.
    let all: Vec<(Mode, f64)> = (0..=most)
        .flat_map(|first| (-across..=across).map(move |second| [first, second]))
        .filter(|mode| *mode > [0, 0])
        .map(|mode| (mode, amplitudes(&solver, mode)[0].norm()))
        .collect();
    let greatest = all.iter().map(|own| own.1).fold(0.0, f64::max);
    let is_held = |own: &&(Mode, f64)| greatest > 0.0 && own.1 > 1e-3 * greatest;
    let modes: Vec<Mode> = all.iter().filter(is_held).map(|own| own.0).collect();
    let growth = |mode: &Mode| {
        let wave = solver.wave_vector(*mode);
        let modes = background.moving(wave).map(|own| own.modes());
        let rates = modes.map(|own| own.iter().map(|own| own.0).collect::<Vec<_>>());
        rates.map(|rates| (*mode, rates))
    };
    let all: Vec<(Mode, Vec<Complex64>)> =
        modes.par_iter().map(growth).collect::<Result<_, _>>()?;
    let growth_of = |own: &(Mode, Vec<Complex64>)| own.1.first().map_or(f64::MIN, |rate| rate.re);
    let (mode, rates) =
        all.iter().max_by(|a, b| growth_of(a).total_cmp(&growth_of(b))).ok_or_else(|| {
            let found = "a perturbation that moves nothing on these grids".to_owned();
            let allowed =
                "noise of v, say, up to the greatest mode number of the finest".to_owned();
            Error::from(case.locate(InputError { key: "initial", found, allowed }))
        })?;
    let stiffest = all.iter().flat_map(|own| &own.1).map(|rate| rate.norm()).fold(0.0, f64::max);
    let shear_rate = background.flow.shear_rate;
    // Three e-folds; where nothing grows, as long as hundreds of stages reach.
    let duration = (3.0 / rates.first().map_or(0.0, |rate| rate.re).max(0.0))
        .min(0.1 / shear_rate)
        .min(2e3 / stiffest);
    let wave = solver.wave_vector(*mode);
    let mut measured = vec![amplitudes(&solver, *mode)];
    let count = if problem.closure == Closure::PlasticPotential { 2 } else { 3 };
    let (duration, predicted) = {
        let mut duration = duration;
        loop {
            let predicted = background.predicted(wave, measured[0], count, duration)?;
            // What decays is followed while it is far above rounding.
            let left = predicted.iter().map(|own| own[0].norm()).fold(f64::MAX, f64::min);
            if left > LEAST * predicted[0][0].norm() || duration < 1e-9 / shear_rate {
                break (duration, predicted);
            }
            duration *= 0.5;
        }
    };
    for time in times(duration).into_iter().skip(1) {
        while solver.time() < time {
            solver.advance(time).map_err(|error| refused(case, error))?;
        }
        measured.push(amplitudes(&solver, *mode));
    }
    // Of the last half, when what decays is gone.
    let half = TIMES / 2;
    let of_rate = |all: &[[Complex64; 2]]| {
        rate(&times(duration)[half..], &all[half..].iter().map(|own| own[0]).collect::<Vec<_>>())
            .growth
    };
    Ok(Fastest {
        points,
        mode: *mode,
        number: wave[0].hypot(wave[1]),
        predicted: of_rate(&predicted),
        measured: of_rate(&measured),
    })
}

/// Names of a wave's modes, the fastest growing first.
const MODES: [&str; 2] = ["first", "second"];

impl Row {
    /// Which wave it is.
    fn name(&self) -> &'static str {
        MODES[(self.mode - 1).min(1)]
    }
}

/// A rate as γ and ω.
fn rate_json(rate: Rate) -> Value {
    json!({ "growth_rate": rate.growth, "frequency": rate.frequency })
}

impl Checked {
    /// What was found, as JSON.
    pub(super) fn report(&self, case: &Case) -> Value {
        let row = |row: &Row| {
            json!({
                "wave": {
                    "number": row.wave.number,
                    "direction_deg": row.wave.direction_deg,
                },
                "mode": row.mode,
                "duration": row.duration,
                "predicted": rate_json(row.predicted),
                "frozen": rate_json(row.frozen),
                "measured": row.measured.iter().flat_map(|own| &own.sequences).map(|(steps, rate)| {
                    let mut own = rate_json(*rate);
                    own["steps"] = json!(steps);
                    own
                }).collect::<Vec<_>>(),
                "limit": row.measured.as_ref().ok().map(|own| rate_json(own.limit)),
                "tolerance": row.measured.as_ref().ok().map(|own| own.tolerance),
                "not_measurable": row.measured.as_ref().err(),
                "order": row.order(),
                "agrees": row.agrees(),
            })
        };
        let refinement = |own: &Refinement| {
            json!({
                "model": own.kind.name(),
                "lost_noncoaxiality_deg": own.lost_noncoaxiality_deg,
                "limit_of_the_order": own.limit,
                "orders": own.orders().map(|[predicted, measured]| {
                    json!({ "predicted": predicted, "measured": measured })
                }),
                "grids": own.grids.iter().map(|grid| json!({
                    "points": grid.points,
                    "mode": grid.mode,
                    "number": grid.number,
                    "predicted": grid.predicted,
                    "measured": grid.measured,
                    "agrees": own.grid_agrees(grid),
                })).collect::<Vec<_>>(),
                "agrees": own.agrees(),
            })
        };
        json!({
            "model": case.medium().title(),
            "agrees": self.agrees(),
            "rows": self.rows.iter().map(row).collect::<Vec<_>>(),
            "refinements": self.refinements.iter().map(refinement).collect::<Vec<_>>(),
            "units": {
                "growth_rate": "1/s", "frequency": "rad/s", "tolerance": "1/s", "number": "1/m",
                "duration": "s",
            },
        })
    }

    /// What was found, as tables.
    pub(super) fn words(&self, case: &Case) -> String {
        let mut text = format!("{}\n{}\n", case_title(case), case.medium().title());
        let signed = |x: f64| if x == 0.0 { "0".to_owned() } else { format!("{x:+.1e}") };
        text.push_str(
            "growth rates γ in 1/s of waves that the mean flow carries along; differences as parts of the \
             rate, or of the shear rate Q_D where that is greater\n\n",
        );
        let _ = writeln!(
            text,
            "{:<24}{:>13}{:>13}{:>10}{:>10}{:>7}{:>15}",
            "", "predicted", "measured", "differs", "within", "order", "frozen, in Q_D"
        );
        let mut last = None;
        for row in &self.rows {
            if last != Some(row.wave) {
                let (k, along) = (short(row.wave.number), short(row.wave.direction_deg));
                let _ = writeln!(text, "k = {k} 1/m at {along}°");
                last = Some(row.wave);
            }
            let scale = row.scale(self.shear_rate);
            let predicted = row.predicted;
            let Measured { limit, tolerance, .. } = match &row.measured {
                Ok(own) => own,
                Err(reason) => {
                    let (name, growth) = (row.name(), digits(predicted.growth));
                    let _ = writeln!(text, "  {name:<22}{growth:>13}  not measurable: {reason}");
                    continue;
                }
            };
            let difference = limit.less(predicted);
            let _ = writeln!(
                text,
                "  {:<22}{:>13}{:>13}{:>10}{:>10}{:>7}{:>15}  {}",
                row.name(),
                digits(predicted.growth),
                digits(limit.growth),
                signed(difference.growth / scale),
                exponent(tolerance / scale),
                row.order().map_or("–".into(), |order| format!("{order:.2}")),
                format!("{:+.3}", row.frozen.less(predicted).growth / self.shear_rate),
                verdict(row.agrees() == Some(true)),
            );
        }
        for own in &self.refinements {
            let _ = writeln!(
                text,
                "\n{}: the fastest growing wave of each grid, rates in 1/s",
                own.kind.title()
            );
            if let Some(delta) = own.lost_noncoaxiality_deg {
                let _ = writeln!(text, "  {}", coaxial_words(delta));
            }
            for grid in &own.grids {
                let [columns, rows] = grid.points;
                let scale = grid.predicted.abs().max(own.shear_rate);
                let _ = writeln!(
                    text,
                    "  {:<22}{:>13}{:>13}{:>10}  {}",
                    format!("{columns} × {rows} points"),
                    digits(grid.predicted),
                    digits(grid.measured),
                    signed((grid.measured - grid.predicted) / scale),
                    verdict(own.grid_agrees(grid)),
                );
            }
            let _ = match own.orders() {
                Some([predicted, measured]) => writeln!(
                    text,
                    "  order in k: predicted {predicted:.4}, measured {measured:.4}, as k → ∞ {}  {}",
                    order_words(own.limit),
                    verdict(own.agrees())
                ),
                None => writeln!(
                    text,
                    "  nothing grows faster than the mean flow deforms{}  {}",
                    if own.limit > 0.0 { ": too coarse for an order" } else { "" },
                    verdict(own.agrees())
                ),
            };
        }
        let [all, failed] = self.counts();
        let found = match (failed, self.agrees()) {
            (_, None) => "nothing measured".to_owned(),
            (0, _) => "all agree".to_owned(),
            (some, _) => format!("{some} of {all} DISAGREE"),
        };
        let left = unmeasured_words(self.unmeasured().map_or(0, |own| own.0));
        let _ = writeln!(text, "\n{} off at most: {found}{left}", exponent(self.worst()));
        text
    }

    /// Rates against the wave number: curves from the analysis, rings from the solver.
    pub(super) fn figure(&self, case: &Case) -> Result<SpectrumFigure, Error> {
        let background = Background::new(case)?;
        let numbers = || self.rows.iter().map(|row| row.wave.number);
        let (least, most) =
            (0.5 * numbers().fold(f64::MAX, f64::min), 2.0 * numbers().fold(0.0, f64::max));
        let mut directions: Vec<f64> = Vec::new();
        for row in &self.rows {
            if !directions.contains(&row.wave.direction_deg) {
                directions.push(row.wave.direction_deg);
            }
        }
        let (mut lines, mut rings) = (Vec::new(), Vec::new());
        for direction_deg in directions {
            let own = |mode: usize| {
                self.rows
                    .iter()
                    .filter(move |row| row.wave.direction_deg == direction_deg && row.mode == mode)
            };
            for mode in 1..=2 {
                let Some(first) = own(mode).next() else { continue };
                // What grows or decays no faster than the mean flow deforms is not short waves' doing; and next
                // to a degenerate direction the rate at the beginning is not that of the way.
                let is_slow = |row: &Row| row.predicted.growth.abs() < 3.0 * self.shear_rate;
                let has_turned =
                    |row: &Row| row.frozen.less(row.predicted).size() > 0.1 * row.predicted.size();
                if own(mode).all(is_slow) || own(mode).any(has_turned) {
                    continue;
                }
                let sign = if first.predicted.growth > 0.0 { "grows" } else { "decays" };
                let point = |index: u32| {
                    let number = least * (most / least).powf(f64::from(index) / 80.0);
                    let modes = background.moving(Wave { number, direction_deg }.vector())?.modes();
                    Ok([number, modes.get(mode - 1).map_or(f64::NAN, |own| own.0.re.abs())])
                };
                lines.push(Line {
                    label: format!("at {}°: {sign}", short(direction_deg)),
                    points: (0..=80).map(point).collect::<Result<_, Error>>()?,
                });
                let ring = |row: &Row| {
                    let own = row.measured.as_ref().ok()?;
                    Some([row.wave.number, own.limit.growth.abs()])
                };
                rings.push(own(mode).filter_map(ring).collect());
            }
        }
        Ok(SpectrumFigure {
            title: case_title(case),
            subtitle: format!(
                "{}: curves from the analysis, rings from the solver{}",
                case.medium().title(),
                unmeasured_words(self.unmeasured().map_or(0, |own| own.0)),
            ),
            x_label: "wave number k at the beginning, 1/m".to_owned(),
            y_label: "growth or decay rate |γ|, 1/s".to_owned(),
            lines,
            rings,
        })
    }

    /// Rates of the fastest growing wave of each grid, model by model.
    pub(super) fn refinement_figure(&self, case: &Case) -> Option<SpectrumFigure> {
        let points = |own: &Refinement, value: fn(&Fastest) -> f64| -> Vec<[f64; 2]> {
            let grids = own.grids.iter().filter(|_| own.orders().is_some());
            grids.map(|grid| [grid.number, value(grid)]).collect()
        };
        let grids = self.refinements.first().map_or(&[][..], |own| &own.grids);
        let counts: Vec<String> = grids.iter().map(|grid| format!("{}²", grid.points[0])).collect();
        (!self.refinements.is_empty()).then(|| SpectrumFigure {
            title: case_title(case),
            subtitle: "the fastest growing wave of each grid: lines from the analysis, rings from the solver"
                .to_owned(),
            x_label: format!("its wave number k on {} points, 1/m", counts.join(", ")),
            y_label: "growth rate γ, 1/s".to_owned(),
            lines: self
                .refinements
                .iter()
                .map(|own| Line {
                    label: match own.orders() {
                        Some(_) => own.kind.title().to_owned(),
                        None => format!("{}: nothing grows", own.kind.title()),
                    },
                    points: points(own, |grid| grid.predicted),
                })
                .collect(),
            rings: self.refinements.iter().map(|own| points(own, |grid| grid.measured)).collect(),
        })
    }
}

fn verdict(agrees: bool) -> &'static str {
    if agrees { "agrees" } else { "DISAGREES" }
}
