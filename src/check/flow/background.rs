//! A uniform flow, and how waves evolve in it by the analysis.

use super::waves::{COURSE, POINTS, TIMES};
use crate::Error;
use crate::case::Case;
use crate::check::mean::MeanFlow;
use crate::setup;
use analysis::StateError;
use analysis::flows::Workspace;
use analysis::growth::Verdict;
use analysis::kelvin::{Evolution, course, wave_vector, wave_vector_rate};
use dynamics::flow::spectral::greatest_modes;
use models::elementary::Elementary;
use models::granular_flow::InputError;
use models::granular_flow::state::Flow;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// A background and its linearised equations.
pub(super) struct Background<'a> {
    pub(super) case: &'a Case,
    pub(super) flow: Flow,
    pub(super) mean: MeanFlow,
    pub(super) gradient: [[f64; 2]; 2],
    pub(super) verdict: Verdict,
}

impl<'a> Background<'a> {
    pub(super) fn new(case: &'a Case) -> Result<Self, Error> {
        let located = |error: StateError| setup::locate(case, error);
        let flow = case.mean_flow()?;
        let model = case.flow_model().map_err(|error| located(error.into()))?;
        let (verdict, _) =
            Workspace::default().decide(&model, &flow).map_err(|error| located(error.into()))?;
        let mean = MeanFlow::new(case, model, &flow);
        let gradient = flow.velocity_gradient.map(|row| row.map(|entry| entry.value));
        Ok(Self { case, flow, mean, gradient, verdict })
    }

    pub(super) fn evolution(&self, wave: [f64; 2], rate: [f64; 2]) -> Result<Evolution, Error> {
        Evolution::new(self.mean.system(), wave, rate).ok_or_else(|| undetermined(self.case))
    }

    /// Evolution along k(t), at its beginning.
    pub(super) fn moving(&self, wave: [f64; 2]) -> Result<Evolution, Error> {
        self.evolution(wave, wave_vector_rate(self.gradient, wave))
    }

    /// Unknowns of a wave from the velocity across it and ω or ψ.
    pub(super) fn unknowns(
        &self,
        wave: [f64; 2],
        [across, inner]: [Complex64; 2],
        count: usize,
    ) -> Vec<Complex64> {
        let number = wave[0].root_sum_square(wave[1]);
        let all = [-across * (wave[1] / number), across * (wave[0] / number), inner];
        all[..count].to_vec()
    }

    /// The other way.
    pub(super) fn across(&self, wave: [f64; 2], unknowns: &[Complex64]) -> [Complex64; 2] {
        let number = wave[0].root_sum_square(wave[1]);
        let across = (unknowns[1] * wave[0] - unknowns[0] * wave[1]) / number;
        [across, unknowns.get(2).copied().unwrap_or_default()]
    }

    /// Of the velocity across a wave and of ω or ψ the greater one, in units of the mean flow, and that unit.
    pub(super) fn greater(&self, number: f64, all: [Complex64; 2]) -> (usize, f64) {
        let size = |field: usize| all[field].norm() / self.unit(number, field);
        let greater = usize::from(size(1) > size(0));
        (greater, self.unit(number, greater))
    }

    /// What the mean flow has of the velocity across a wave of that number (0), or of ω or ψ (1).
    pub(super) fn unit(&self, number: f64, field: usize) -> f64 {
        let rate = 2.0 * self.flow.shear_rate;
        match (field, self.flow.spin) {
            (0, _) => rate / number,
            (_, Some(_)) => rate,
            (_, None) => 1.0,
        }
    }

    /// q/(ρ(Q_D/k)²): of what a wave takes of the mean flow's velocity gradient its pressure takes as much less of q.
    pub(super) fn inertial_part(&self, number: f64) -> f64 {
        let (coulomb, velocity) = (self.mean.coulomb(), self.flow.shear_rate / number);
        let (sin, cos) = coulomb.friction_angle.cr_sin_cos();
        let deviator = self.flow.stress.pressure * sin + coulomb.cohesion * cos;
        deviator / self.flow.density / velocity / velocity
    }

    /// The greatest growth rate of the waves in a box of one wave at a time, 1/s; 0 where none grows.
    pub(super) fn fastest_growth(&self, lengths: [f64; 2], time: f64) -> Result<f64, Error> {
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
    pub(super) fn predicted(
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

pub(super) fn refused(case: &Case, found: impl ToString) -> Error {
    let allowed = "a state further from the border of the fully deforming region".to_owned();
    case.locate(InputError { key: "background", found: found.to_string(), allowed }).into()
}

pub(super) fn undetermined(case: &Case) -> Error {
    refused(case, "a state in which the equations do not determine how waves evolve")
}
