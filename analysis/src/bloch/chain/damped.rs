//! Attenuated waves at real frequencies, and damped waves at real wave numbers, of a chain with viscous layers.

use super::{BlochPhase, Chain, ChainElement, TransferFactor};
use crate::bloch::{BlochError, ensure};
use models::common::elementary::{Elementary, Modulus, cr_arg};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Largest number of steps of Newton's method.
const NEWTON_STEPS: usize = 50;
/// Relative change of the frequency at which Newton's method ends.
const NEWTON_TOLERANCE: f64 = 1e-14;
/// First and smallest step of the continuation in the factor of the delayed compliance, from 0 to 1.
const CONTINUATION_STEP_RANGE: [f64; 2] = [1.0 / 16.0, 1e-6];
/// Largest relative change of a frequency in a step of the continuation.
const MAX_RELATIVE_CHANGE: f64 = 0.1;

impl Chain {
    /// Half the trace Δ(ω) of the transfer matrix of a period at the complex angular frequency ω, rad/s, and Δ′(ω), s.
    /// Bloch waves e^{i(ωt − κx)} satisfy cos κh = Δ(ω).
    pub fn half_trace(&self, frequency: Complex64) -> [Complex64; 2] {
        self.transfer(frequency, 1.0).half_trace()
    }

    /// Complex phase shift κh of the wave e^{i(ωt − κx)} that decays with increasing x, Im κ ≤ 0, at the real angular
    /// frequency ω > 0, rad/s; Re κh in (−π, π]. In a band without viscosity Im κ = 0 and Re κh is in [0, π].
    ///
    /// # Errors
    /// The frequency is not positive and finite; without viscosity also if it is at least π/Δt.
    pub fn complex_phase_shift(&self, frequency: f64) -> Result<Complex64, BlochError> {
        let is_valid = frequency > 0.0 && frequency.is_finite();
        ensure(is_valid, "frequency", frequency, "a positive number")?;
        if self.ensure_elastic().is_ok() {
            return Ok(match self.bloch_phase(frequency)? {
                BlochPhase::Band { band, phase } => {
                    Complex64::from(if band % 2 == 0 { phase } else { PI - phase })
                }
                BlochPhase::Gap { bands_below, attenuation } => {
                    Complex64::new(if bands_below % 2 == 0 { 0.0 } else { PI }, -attenuation)
                }
            });
        }
        let transfer = self.transfer(Complex64::from(frequency), 1.0);
        let [half_trace, _] = transfer.half_trace();
        let root = transfer.discriminant().sqrt();
        let candidates = [half_trace + root, half_trace - root];
        let larger = candidates.into_iter().max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr()));
        let larger = larger.unwrap_or(half_trace);
        // e^(−iκh) = 1/larger.
        Ok(Complex64::new(cr_arg(larger), -larger.modulus().cr_ln().max(0.0)))
    }

    /// Complex angular frequency ω of the damped wave e^{i(ωt − κx)} of branch `branch` at the real phase shift κh,
    /// rad/s; Im ω ≥ 0. The branch is continued from the chain without delayed compliance, by Newton's method on
    /// cos κh = Δ(ω). Roots on the imaginary axis that do not continue a wave (pure relaxation) are not found.
    ///
    /// # Errors
    /// κh is not finite; the scheme has no such branch; the continuation does not converge, for instance at closed
    /// gaps.
    pub fn damped_frequency(
        &self,
        branch: usize,
        phase_shift: f64,
    ) -> Result<Complex64, BlochError> {
        ensure(phase_shift.is_finite(), "phase_shift", phase_shift, "a finite number")?;
        let start = self.to_elastic().frequency(branch, phase_shift)?;
        if start == 0.0 || self.ensure_elastic().is_ok() {
            return Ok(Complex64::from(start));
        }
        let reduced = phase_shift.rem_euclid(TAU);
        let target = if reduced == PI { -1.0 } else { reduced.cr_cos() };
        let failed = BlochError::NotConverged { iteration: "the continuation of a damped wave" };
        let (mut delayed_share, mut step) = (0.0, CONTINUATION_STEP_RANGE[0]);
        let mut frequency = Complex64::from(start);
        while delayed_share < 1.0 {
            let next = f64::min(delayed_share + step, 1.0);
            match self.solve_newton(frequency, target, next) {
                Some(root)
                    if (root - frequency).modulus()
                        <= MAX_RELATIVE_CHANGE * frequency.modulus() =>
                {
                    (delayed_share, frequency) = (next, root);
                    step *= 1.5;
                }
                _ if step > CONTINUATION_STEP_RANGE[1] => step *= 0.5,
                _ => return Err(failed),
            }
        }
        Ok(frequency)
    }

    fn to_elastic(&self) -> Self {
        let mut chain = self.clone();
        for element in &mut chain.elements {
            if let ChainElement::Layer { compliance, .. } = element {
                compliance.delayed = 0.0;
            }
        }
        for factor in &mut chain.factors {
            if let TransferFactor::Box { delayed, .. } = factor {
                *delayed = 0.0;
            }
        }
        chain
    }

    fn solve_newton(&self, start: Complex64, target: f64, delayed_share: f64) -> Option<Complex64> {
        let mut frequency = start;
        for _ in 0..NEWTON_STEPS {
            let [half_trace, slope] = self.transfer(frequency, delayed_share).half_trace();
            let change = (half_trace - target) / slope;
            frequency -= change;
            if !frequency.is_finite() {
                return None;
            }
            if change.modulus() <= NEWTON_TOLERANCE * frequency.modulus() {
                return Some(frequency);
            }
        }
        None
    }
}
