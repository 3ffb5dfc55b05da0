//! Evolution of waves in a uniform flow by the linearised equations.

use super::UniformFlow;
use super::mean_flow::MeanFlow;
use crate::{AgreementError, PlaneWave};
use analysis::kelvin::{KelvinEvolution, integrate_kelvin_wave, wave_vector, wave_vector_rate};
use dynamics::flow::spectral::{ModeNumbers, max_dealiased_modes};
use models::common::elementary::{Elementary, Modulus};
use models::flow::state::DeformingFlow;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Number of sample times after the initial time.
pub(super) const SAMPLE_COUNT: usize = 8;
/// Points along each axis of the box of a single wave; more points would resolve shorter waves and make the problem
/// stiffer.
pub(super) const BOX_POINTS: usize = 4;
/// Integration steps of the predicted evolution between two sample times.
const PREDICTION_STEPS_PER_SAMPLE: usize = 50;

impl PlaneWave<2> {
    /// Wave vector k, 1/m.
    pub(super) fn to_wave_vector(self) -> [f64; 2] {
        let [n1, n2] = self.normal;
        [self.wave_number * n1, self.wave_number * n2]
    }

    /// Smallest periodic box of the wave (edge lengths, m) and the Fourier mode of the wave in it.
    pub(super) fn periodic_box(&self) -> ([f64; 2], ModeNumbers) {
        let [k1, k2] = self.to_wave_vector();
        // Wave vectors almost parallel to an axis are treated as parallel.
        let is_negligible = |component: f64| component.abs() < 1e-9 * self.wave_number;
        match [k1, k2].map(is_negligible) {
            [true, _] => ([TAU / self.wave_number; 2], [0, k2.signum() as i32]),
            [_, true] => ([TAU / self.wave_number; 2], [k1.signum() as i32, 0]),
            _ => ([TAU / k1.abs(), TAU / k2.abs()], [k1.signum() as i32, k2.signum() as i32]),
        }
    }
}

/// A uniform flow and its linearised equations at any time.
pub(super) struct LinearisedFlow<'a> {
    pub(super) uniform_flow: &'a UniformFlow,
    pub(super) flow: DeformingFlow,
    mean_flow: MeanFlow,
    /// Velocity gradient Γ, 1/s.
    velocity_gradient: [[f64; 2]; 2],
}

impl<'a> LinearisedFlow<'a> {
    pub(super) fn new(problem: &'a UniformFlow) -> Self {
        let flow = problem.flow;
        let gradient = flow.velocity_gradient.map(|row| row.map(|entry| entry.value));
        let mean = MeanFlow::new(problem.model.clone(), problem.state, flow);
        Self { uniform_flow: problem, flow, mean_flow: mean, velocity_gradient: gradient }
    }

    /// Linearised evolution at the initial time of a wave with the wave vector `wave` (1/m), which changes at the
    /// `rate` (1/(m·s)).
    pub(super) fn linearise_evolution(
        &self,
        wave: [f64; 2],
        rate: [f64; 2],
    ) -> Result<KelvinEvolution, AgreementError> {
        KelvinEvolution::new(self.mean_flow.system(), wave, rate)
            .ok_or(AgreementError::SingularEquations)
    }

    /// Linearised evolution at the initial time of a wave whose wave vector k(t) is rotated and stretched by the mean
    /// flow; initially k = `wave` (1/m).
    pub(super) fn linearise_moving_evolution(
        &self,
        wave: [f64; 2],
    ) -> Result<KelvinEvolution, AgreementError> {
        self.linearise_evolution(wave, wave_vector_rate(self.velocity_gradient, wave))
    }

    /// The first `count` unknowns (v₁, v₂, internal variable) of a wave from its transverse velocity (m/s) and its
    /// internal variable: spin ω (rad/s) or stress angle ψ (rad).
    pub(super) fn to_unknowns(
        &self,
        wave: [f64; 2],
        [transverse, internal]: [Complex64; 2],
        count: usize,
    ) -> Vec<Complex64> {
        let number = wave[0].root_sum_square(wave[1]);
        let all = [-transverse * (wave[1] / number), transverse * (wave[0] / number), internal];
        all[..count].to_vec()
    }

    /// Transverse velocity and internal variable from the unknowns: the inverse of [`to_unknowns`](Self::to_unknowns).
    pub(super) fn to_wave_amplitudes(
        &self,
        wave: [f64; 2],
        unknowns: &[Complex64],
    ) -> [Complex64; 2] {
        let number = wave[0].root_sum_square(wave[1]);
        let transverse = (unknowns[1] * wave[0] - unknowns[0] * wave[1]) / number;
        [transverse, unknowns.get(2).copied().unwrap_or_default()]
    }

    /// Index of the field, transverse velocity (0) or internal variable (1), that is larger relative to its
    /// [scale](Self::field_scale) at the wave number `number` (1/m); and that scale.
    pub(super) fn dominant_field(&self, number: f64, all: [Complex64; 2]) -> (usize, f64) {
        let size = |field: usize| all[field].modulus() / self.field_scale(number, field);
        let greater = usize::from(size(1) > size(0));
        (greater, self.field_scale(number, greater))
    }

    /// Scale, from the shear rate Q_D of the mean flow, of a field of a wave with wave number k = `number` (1/m):
    /// 2Q_D/k (m/s) for the transverse velocity (`field` = 0); for the internal variable (1) 2Q_D (rad/s) for a spin, 1
    /// rad for a stress angle.
    pub(super) fn field_scale(&self, number: f64, field: usize) -> f64 {
        let rate = 2.0 * self.flow.shear_rate;
        match (field, self.flow.spin) {
            (0, _) => rate / number,
            (_, Some(_)) => rate,
            (_, None) => 1.0,
        }
    }

    /// Inertial ratio q/(ρ(Q_D/k)²): scale of the velocity gradient of a wave relative to Q_D, over that of its
    /// pressure relative to q, with q = p sin φ + c cos φ (Pa), pressure p, cohesion c, friction angle φ, density ρ,
    /// shear rate Q_D and wave number k = `number` (1/m).
    pub(super) fn inertial_ratio(&self, number: f64) -> f64 {
        let (coulomb, velocity) =
            (self.uniform_flow.model.coulomb(), self.flow.shear_rate / number);
        let (sin, cos) = coulomb.friction_angle.cr_sin_cos();
        let deviator = self.flow.stress.pressure * sin + coulomb.cohesion * cos;
        deviator / self.flow.density / velocity / velocity
    }

    /// Largest growth rate, 1/s, at a time (s) of the Fourier modes of a periodic box with initial edge lengths
    /// `lengths` (m); 0 if no mode grows.
    pub(super) fn max_growth_rate(
        &self,
        lengths: [f64; 2],
        time: f64,
    ) -> Result<f64, AgreementError> {
        let [most, across] = max_dealiased_modes([BOX_POINTS; 2]).map(|greatest| greatest as i32);
        let mut fastest = 0.0f64;
        let system = self.mean_flow.system_at(time).ok_or(AgreementError::SingularEquations)?;
        for first in 0..=most {
            for second in (-across..=across).filter(|second| [first, *second] > [0, 0]) {
                let mode = [f64::from(first), f64::from(second)];
                let start = [0, 1].map(|axis| TAU * mode[axis] / lengths[axis]);
                let wave = wave_vector(self.velocity_gradient, start, time);
                let rate = wave_vector_rate(self.velocity_gradient, wave);
                let evolution = KelvinEvolution::new(&system, wave, rate);
                let modes = evolution.ok_or(AgreementError::SingularEquations)?.modes();
                fastest = modes.iter().fold(fastest, |sum, own| sum.max(own.0.re));
            }
        }
        Ok(fastest)
    }

    /// Amplitudes (transverse velocity, internal variable) of a wave at time 0 and at the sample times up to `duration`
    /// (s), predicted by the linearised equations in the first `count` unknowns from the amplitudes `start`.
    pub(super) fn predict_amplitudes(
        &self,
        wave: [f64; 2],
        start: [Complex64; 2],
        count: usize,
        duration: f64,
    ) -> Result<Vec<[Complex64; 2]>, AgreementError> {
        let start = self.to_unknowns(wave, start, count);
        let all = integrate_kelvin_wave(
            &|time| self.mean_flow.system_at(time),
            self.velocity_gradient,
            wave,
            &start,
            duration,
            [SAMPLE_COUNT, PREDICTION_STEPS_PER_SAMPLE],
        );
        let all = all.ok_or(AgreementError::SingularEquations)?;
        let time = |index: usize| duration * index as f64 / SAMPLE_COUNT as f64;
        let of = |(index, own): (usize, &Vec<Complex64>)| {
            self.to_wave_amplitudes(wave_vector(self.velocity_gradient, wave, time(index)), own)
        };
        Ok(all.iter().enumerate().map(of).collect())
    }
}
