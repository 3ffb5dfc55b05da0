//! Evolution of waves in a uniform flow by the linearised equations.

use super::UniformFlow;
use super::mean_flow::MeanFlow;
use crate::{AgreementError, PlaneWave};
use analysis::kelvin::{Evolution, course, wave_vector, wave_vector_rate};
use dynamics::flow::spectral::{Mode, greatest_modes};
use models::common::elementary::Elementary;
use models::flow::state::Flow;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Number of sample times after the initial time.
pub(super) const TIMES: usize = 8;
/// Points along each axis of the box of a single wave; more points would resolve shorter waves and make the problem
/// stiffer.
pub(super) const POINTS: usize = 4;
/// Integration steps of the predicted evolution between two sample times.
const COURSE: usize = 50;

impl PlaneWave<2> {
    /// Wave vector k, 1/m.
    pub(super) fn vector(&self) -> [f64; 2] {
        let [n1, n2] = self.normal;
        [self.number * n1, self.number * n2]
    }

    /// Smallest periodic box of the wave (edge lengths, m) and the Fourier mode of the wave in it.
    pub(super) fn periodic_box(&self) -> ([f64; 2], Mode) {
        let [k1, k2] = self.vector();
        // Wave vectors almost parallel to an axis are treated as parallel.
        let is_negligible = |component: f64| component.abs() < 1e-9 * self.number;
        match [k1, k2].map(is_negligible) {
            [true, _] => ([TAU / self.number; 2], [0, k2.signum() as i32]),
            [_, true] => ([TAU / self.number; 2], [k1.signum() as i32, 0]),
            _ => ([TAU / k1.abs(), TAU / k2.abs()], [k1.signum() as i32, k2.signum() as i32]),
        }
    }
}

/// A uniform flow and its linearised equations at any time.
pub(super) struct LinearisedFlow<'a> {
    pub(super) problem: &'a UniformFlow,
    pub(super) flow: Flow,
    mean: MeanFlow,
    /// Velocity gradient Γ, 1/s.
    gradient: [[f64; 2]; 2],
}

impl<'a> LinearisedFlow<'a> {
    pub(super) fn new(problem: &'a UniformFlow) -> Self {
        let flow = problem.flow;
        let gradient = flow.velocity_gradient.map(|row| row.map(|entry| entry.value));
        let mean = MeanFlow::new(problem.model.clone(), problem.state, flow);
        Self { problem, flow, mean, gradient }
    }

    pub(super) fn evolution(
        &self,
        wave: [f64; 2],
        rate: [f64; 2],
    ) -> Result<Evolution, AgreementError> {
        Evolution::new(self.mean.system(), wave, rate).ok_or(AgreementError::Undetermined)
    }

    /// Evolution with the wave vector k(t), at the initial time.
    pub(super) fn moving(&self, wave: [f64; 2]) -> Result<Evolution, AgreementError> {
        self.evolution(wave, wave_vector_rate(self.gradient, wave))
    }

    /// The first `count` unknowns of a wave from its transverse velocity and its internal variable (ω or ψ).
    pub(super) fn unknowns(
        &self,
        wave: [f64; 2],
        [transverse, internal]: [Complex64; 2],
        count: usize,
    ) -> Vec<Complex64> {
        let number = wave[0].root_sum_square(wave[1]);
        let all = [-transverse * (wave[1] / number), transverse * (wave[0] / number), internal];
        all[..count].to_vec()
    }

    /// Transverse velocity and internal variable from the unknowns: the inverse of [`unknowns`](Self::unknowns).
    pub(super) fn transverse(&self, wave: [f64; 2], unknowns: &[Complex64]) -> [Complex64; 2] {
        let number = wave[0].root_sum_square(wave[1]);
        let transverse = (unknowns[1] * wave[0] - unknowns[0] * wave[1]) / number;
        [transverse, unknowns.get(2).copied().unwrap_or_default()]
    }

    /// Index of the field, transverse velocity (0) or internal variable (1), that is larger relative to its scale by
    /// the mean flow; and that scale.
    pub(super) fn greater(&self, number: f64, all: [Complex64; 2]) -> (usize, f64) {
        let size = |field: usize| all[field].norm() / self.unit(number, field);
        let greater = usize::from(size(1) > size(0));
        (greater, self.unit(number, greater))
    }

    /// Scale of the transverse velocity (`field` = 0) or internal variable (1) of a wave by the mean flow; wave
    /// number `number` (1/m).
    pub(super) fn unit(&self, number: f64, field: usize) -> f64 {
        let rate = 2.0 * self.flow.shear_rate;
        match (field, self.flow.spin) {
            (0, _) => rate / number,
            (_, Some(_)) => rate,
            (_, None) => 1.0,
        }
    }

    /// Inertial ratio q/(ρ(Q_D/k)²), q = p sin φ + c cos φ: relative velocity gradient of a wave over its relative
    /// pressure.
    pub(super) fn inertial_ratio(&self, number: f64) -> f64 {
        let (coulomb, velocity) = (self.problem.model.coulomb(), self.flow.shear_rate / number);
        let (sin, cos) = coulomb.friction_angle.cr_sin_cos();
        let deviator = self.flow.stress.pressure * sin + coulomb.cohesion * cos;
        deviator / self.flow.density / velocity / velocity
    }

    /// Largest growth rate of the modes of the box at a time (s), 1/s; 0 if no mode grows.
    pub(super) fn fastest_growth(
        &self,
        lengths: [f64; 2],
        time: f64,
    ) -> Result<f64, AgreementError> {
        let [most, across] = greatest_modes([POINTS; 2]).map(|greatest| greatest as i32);
        let mut fastest = 0.0f64;
        let system = self.mean.system_at(time).ok_or(AgreementError::Undetermined)?;
        for first in 0..=most {
            for second in (-across..=across).filter(|second| [first, *second] > [0, 0]) {
                let mode = [f64::from(first), f64::from(second)];
                let start = [0, 1].map(|axis| TAU * mode[axis] / lengths[axis]);
                let wave = wave_vector(self.gradient, start, time);
                let rate = wave_vector_rate(self.gradient, wave);
                let evolution = Evolution::new(&system, wave, rate);
                let modes = evolution.ok_or(AgreementError::Undetermined)?.modes();
                fastest = modes.iter().fold(fastest, |sum, own| sum.max(own.0.re));
            }
        }
        Ok(fastest)
    }

    /// Amplitudes of a wave at the sample times, predicted by the linearised equations.
    pub(super) fn predicted(
        &self,
        wave: [f64; 2],
        start: [Complex64; 2],
        count: usize,
        duration: f64,
    ) -> Result<Vec<[Complex64; 2]>, AgreementError> {
        let start = self.unknowns(wave, start, count);
        let all = course(
            &|time| self.mean.system_at(time),
            self.gradient,
            wave,
            &start,
            duration,
            [TIMES, COURSE],
        );
        let all = all.ok_or(AgreementError::Undetermined)?;
        let time = |index: usize| duration * index as f64 / TIMES as f64;
        let of = |(index, own): (usize, &Vec<Complex64>)| {
            self.transverse(wave_vector(self.gradient, wave, time(index)), own)
        };
        Ok(all.iter().enumerate().map(of).collect())
    }
}
