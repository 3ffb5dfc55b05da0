//! Branches, band edges and gaps of a chain without viscosity, by bisection on the Bloch phase.

use super::{Chain, ChainElement, Transfer, TransferFactor};
use crate::bloch::{BlochError, ensure};
use models::common::elementary::Elementary;
use std::f64::consts::{PI, TAU};

/// Bloch phase Φ of a chain at a real frequency ω: in a band waves propagate, in a gap they decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlochPhase {
    /// The frequency is in a band: a wave propagates.
    Band {
        /// Index j of the branch, from 0.
        band: usize,
        /// Φ − jπ in (0, π): κh for even j, π − κh for odd j.
        phase: f64,
    },
    /// The frequency is in a gap: waves decay exponentially.
    Gap {
        /// Number of branches below the gap.
        bands_below: usize,
        /// Decay −h Im κ ≥ 0 of the logarithm of the amplitude per period.
        attenuation: f64,
    },
}

/// Band gap of a chain: an interval of angular frequencies without propagating wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainGap {
    /// Number of branches below the gap.
    pub bands_below: usize,
    /// Lower edge of the gap, rad/s.
    pub lower: f64,
    /// Upper edge of the gap, rad/s.
    pub upper: f64,
}

/// Relative width below which a gap counts as closed: a few thousand rounding errors.
const CLOSED_GAP_WIDTH: f64 = 1e-12;

impl Chain {
    /// Bloch phase at the angular frequency ω ≥ 0, rad/s.
    ///
    /// # Errors
    /// The frequency is negative, not finite or, with a time step, at least π/Δt; a layer is viscous.
    pub fn bloch_phase(&self, frequency: f64) -> Result<BlochPhase, BlochError> {
        self.ensure_elastic()?;
        let is_valid = frequency >= 0.0 && frequency.is_finite() && self.is_resolved(frequency);
        ensure(is_valid, "frequency", frequency, "at least 0, finite and below π/Δt")?;
        Ok(self.compute_bloch_phase(frequency))
    }

    /// Angular frequency of branch `branch` at the phase shift κh, rad/s. At κh = 0 and ±π it is the band edge.
    ///
    /// # Errors
    /// κh is not finite; a layer is viscous; the scheme has no such branch.
    pub fn frequency(&self, branch: usize, phase_shift: f64) -> Result<f64, BlochError> {
        self.ensure_elastic()?;
        ensure(phase_shift.is_finite(), "phase_shift", phase_shift, "a finite number")?;
        let reduced = phase_shift.rem_euclid(TAU);
        let reduced = reduced.min(TAU - reduced);
        let target = if branch.is_multiple_of(2) { reduced } else { PI - reduced };
        self.locate_frequency(branch, target)
    }

    /// The angular frequencies of all branches at the phase shift κh up to `max_frequency`, rad/s, ascending.
    ///
    /// # Errors
    /// See [`frequency`](Self::frequency); `max_frequency` is not finite.
    pub fn frequencies_below(
        &self,
        phase_shift: f64,
        max_frequency: f64,
    ) -> Result<Vec<f64>, BlochError> {
        ensure(max_frequency.is_finite(), "max_frequency", max_frequency, "a finite number")?;
        self.collect_branches(max_frequency, |branch| self.frequency(branch, phase_shift))
    }

    /// Lower and upper edge of the band of branch `branch`, rad/s.
    ///
    /// # Errors
    /// A layer is viscous; the scheme has no such branch.
    pub fn band_edges(&self, branch: usize) -> Result<[f64; 2], BlochError> {
        self.ensure_elastic()?;
        Ok([self.locate_frequency(branch, 0.0)?, self.locate_frequency(branch, PI)?])
    }

    /// The gaps whose lower end is below `max_frequency`, rad/s, ascending.
    ///
    /// # Errors
    /// A layer is viscous; `max_frequency` is not finite.
    pub fn gaps_below(&self, max_frequency: f64) -> Result<Vec<ChainGap>, BlochError> {
        ensure(max_frequency.is_finite(), "max_frequency", max_frequency, "a finite number")?;
        let upper_edges =
            self.collect_branches(max_frequency, |branch| self.locate_frequency(branch, PI))?;
        let mut gaps = Vec::new();
        for (branch, lower) in upper_edges.into_iter().enumerate() {
            let upper = match self.locate_frequency(branch + 1, 0.0) {
                Err(BlochError::NoSuchBranch { .. }) => break,
                upper => upper?,
            };
            if upper - lower > CLOSED_GAP_WIDTH * upper {
                gaps.push(ChainGap { bands_below: branch + 1, lower, upper });
            }
        }
        Ok(gaps)
    }

    /// Phase speed ω/|κ| of branch `branch` at the phase shift κh, m/s. It depends on the choice of κ among the wave
    /// numbers of the same Bloch wave. At κ = 0 that of long waves for branch 0, infinite for the others.
    ///
    /// # Errors
    /// See [`frequency`](Self::frequency).
    pub fn phase_speed(&self, branch: usize, phase_shift: f64) -> Result<f64, BlochError> {
        let frequency = self.frequency(branch, phase_shift)?;
        match branch == 0 && phase_shift == 0.0 {
            true => Ok(self.long_wave_speed()),
            false => Ok(frequency * self.period() / phase_shift.abs()),
        }
    }

    /// Group speed |dω/dκ| = h|sin κh/Δ′(ω)| at the angular frequency ω, rad/s, in m/s; zero in gaps.
    ///
    /// # Errors
    /// See [`bloch_phase`](Self::bloch_phase).
    pub fn group_speed(&self, frequency: f64) -> Result<f64, BlochError> {
        match self.bloch_phase(frequency)? {
            BlochPhase::Band { phase, .. } => {
                let [_, slope] = self.transfer(frequency, 1.0).half_trace();
                Ok(self.period() * (phase.cr_sin() / slope).abs())
            }
            BlochPhase::Gap { .. } if frequency == 0.0 => Ok(self.long_wave_speed()),
            BlochPhase::Gap { .. } => Ok(0.0),
        }
    }

    pub(super) fn ensure_elastic(&self) -> Result<(), BlochError> {
        let is_viscous = |element: &ChainElement| matches!(element, ChainElement::Layer { compliance, .. } if compliance.delayed > 0.0);
        match self.elements.iter().position(is_viscous) {
            Some(element) => Err(BlochError::ViscousLayer { element }),
            None => Ok(()),
        }
    }

    /// Whether the frequency is below the limit π/Δt of the discrete scheme.
    fn is_resolved(&self, frequency: f64) -> bool {
        self.time_step.is_none_or(|step| frequency * step < PI)
    }

    /// Collects `value(branch)`, which ascends, for branches 0, 1, … while it is at most `max`.
    fn collect_branches(
        &self,
        max: f64,
        value: impl Fn(usize) -> Result<f64, BlochError>,
    ) -> Result<Vec<f64>, BlochError> {
        let mut all = Vec::new();
        loop {
            match value(all.len()) {
                Ok(found) if found <= max => all.push(found),
                Ok(_) | Err(BlochError::NoSuchBranch { .. }) => return Ok(all),
                Err(error) => return Err(error),
            }
        }
    }

    /// Locates the angular frequency, rad/s, at which the Bloch phase is Φ = jπ + `target`, j = `branch`; if Φ has this
    /// value in a whole gap, the edge of the gap that belongs to branch j.
    pub(super) fn locate_frequency(&self, branch: usize, target: f64) -> Result<f64, BlochError> {
        if branch == 0 && target == 0.0 {
            return Ok(0.0);
        }
        let is_below = |frequency: f64| match self.compute_bloch_phase(frequency) {
            BlochPhase::Band { band, phase } => band < branch || (band == branch && phase < target),
            BlochPhase::Gap { bands_below, .. } => bands_below <= branch,
        };
        let wave_number = (branch as f64 * PI + target) / self.period();
        let limit = self.time_step.map_or(f64::INFINITY, |step| (PI / step).next_down());
        let (mut lower, mut upper) = (0.0, (self.long_wave_speed() * wave_number).min(limit));
        while is_below(upper) {
            if upper == limit {
                return Err(BlochError::NoSuchBranch {
                    branch,
                    branches: self.count_branches_below(limit),
                });
            }
            (lower, upper) = (upper, (2.0 * upper).min(limit));
            if !upper.is_finite() {
                return Err(BlochError::NotConverged { iteration: "the bracketing of a branch" });
            }
        }
        loop {
            let middle = lower + 0.5 * (upper - lower);
            if middle <= lower || middle >= upper {
                return Ok(middle);
            }
            match is_below(middle) {
                true => lower = middle,
                false => upper = middle,
            }
        }
    }

    /// Number of branches that begin below a frequency.
    fn count_branches_below(&self, frequency: f64) -> usize {
        match self.compute_bloch_phase(frequency) {
            BlochPhase::Band { band, .. } => band + 1,
            BlochPhase::Gap { bands_below, .. } => bands_below,
        }
    }

    /// Computes the Bloch phase of a chain without viscosity at a valid frequency, rad/s.
    fn compute_bloch_phase(&self, frequency: f64) -> BlochPhase {
        let transfer = self.transfer(frequency, 1.0);
        let [half_trace, _] = transfer.half_trace();
        let [a, b, c, d] = transfer.matrix;
        let discriminant = transfer.discriminant();
        if discriminant < 0.0 {
            // Elliptic: conjugate to a rotation by 2πn ± y, with the sign of T₂₁. Every vector turns by an angle in
            // the same interval of length π.
            let phase = (-discriminant).sqrt().cr_atan2(half_trace);
            let angle = self.rotation_angle(frequency, [1.0, 0.0]);
            let half_turns = |shift: f64| 2.0 * ((angle + shift) / TAU).round();
            return match c > 0.0 {
                true => {
                    let band = half_turns(-0.5 * PI).max(0.0) as usize;
                    BlochPhase::Band { band, phase }
                }
                false => {
                    let band = (half_turns(0.5 * PI) - 1.0).max(0.0) as usize;
                    BlochPhase::Band { band, phase: PI - phase }
                }
            };
        }
        // Hyperbolic: the expanding eigenvector turns by exactly kπ.
        let eigenvalue = half_trace + discriminant.sqrt().copysign(half_trace);
        let [first, second] = [[-b, a - eigenvalue], [eigenvalue - d, c]];
        let size = |[x, y]: [f64; 2]| x.abs().max(y.abs());
        let vector = if size(first) > size(second) { first } else { second };
        let vector = if size(vector) > 0.0 { vector } else { [1.0, 0.0] };
        let bands_below = (self.rotation_angle(frequency, vector) / PI).round() as usize;
        BlochPhase::Gap { bands_below, attenuation: eigenvalue.abs().cr_ln().max(0.0) }
    }

    /// Angle, rad, by which a period rotates the vector (Zv, s), not reduced modulo 2π: continuous in ω, and zero at ω
    /// = 0. All factors rotate every vector anticlockwise, by an angle in [0, π) plus the half turns of a block.
    fn rotation_angle(&self, frequency: f64, mut vector: [f64; 2]) -> f64 {
        let layer = self.layer_frequency(frequency);
        let mut angle = 0.0;
        for factor in &self.factors {
            let Transfer { matrix: [a, b, c, d], .. } = factor.transfer(frequency, layer, 1.0);
            let half_turns = match *factor {
                TransferFactor::Block { time, .. } => (frequency * time / PI).floor(),
                TransferFactor::Mass(_) | TransferFactor::Box { .. } => 0.0,
            };
            let sign = if half_turns % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let [x, y] = vector;
            let rotated = [a * x + b * y, c * x + d * y];
            let [cross, dot] = [x * rotated[1] - y * rotated[0], x * rotated[0] + y * rotated[1]];
            angle += half_turns * PI + (sign * cross).max(0.0).cr_atan2(sign * dot);
            let size = rotated[0].root_sum_square(rotated[1]);
            vector = rotated.map(|component| component / size);
        }
        angle
    }
}
