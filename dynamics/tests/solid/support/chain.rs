//! Bloch waves of a chain of blocks and elastic interlayers at Courant number 1, from the discrete equations.

use models::interface::elastic::ElasticComponent;
use nalgebra::Matrix4;
use num_complex::Complex;
use std::f64::consts::PI;

/// A periodic chain of `block_count` blocks with `cells_per_block` cells of impedance z each, separated by interlayers;
/// the Courant number is 1.
pub struct BlockChain {
    /// Number of cells of a block.
    pub cells_per_block: usize,
    /// Number of blocks of the chain.
    pub block_count: usize,
    /// Impedance z of the cells.
    pub z: f64,
    /// Law of the interlayers, of the box scheme.
    pub law: ElasticComponent<f64>,
    /// Duration of a sweep.
    pub step: f64,
}

/// Mode e^{i(ωt − κx)} of a chain.
pub struct ChainMode<'a> {
    chain: &'a BlockChain,
    frequency: f64,
    phase: f64,
    amplitudes: [Complex<f64>; 4],
}

/// State of a chain: velocity and stress by cell, velocity V and stress S of each interlayer.
pub struct ChainState {
    pub velocity: Vec<f64>,
    pub stress: Vec<f64>,
    pub layers: Vec<[f64; 2]>,
}

impl BlockChain {
    /// Computes the phase changes across a block, θ = ωh/c, and across an interlayer, ψ = 2 arctan ½ω√(mC), rad, at a
    /// frequency ω of the scheme. θ is exact at Courant number 1; in ψ the frequency is replaced by (2/Δt) tan ½ωΔt.
    pub fn phase_angles(&self, frequency: f64) -> [f64; 2] {
        let discrete = 2.0 / self.step * (0.5 * frequency * self.step).tan();
        let rate = (self.law.mass.mass * self.law.compliance).sqrt();
        [self.cells_per_block as f64 * self.step * frequency, 2.0 * (0.5 * discrete * rate).atan()]
    }

    /// Computes cos κh = cos θ cos ψ − ½(z/z′ + z′/z) sin θ sin ψ, with the Bloch wave number κ, the block length h and
    /// the interlayer impedance z′ = √(m/C).
    fn bloch_cosine(&self, frequency: f64) -> f64 {
        let [theta, psi] = self.phase_angles(frequency);
        let layer_impedance = (self.law.mass.mass / self.law.compliance).sqrt();
        let ratio = 0.5 * (self.z / layer_impedance + layer_impedance / self.z);
        theta.cos() * psi.cos() - ratio * theta.sin() * psi.sin()
    }

    /// Finds the frequency of a branch, counted from 0, at the Bloch phase κh in [0, π], by bisection.
    fn branch_frequency(&self, phase: f64, branch: usize) -> f64 {
        let target = phase.cos();
        let mut found = Vec::new();
        let end = 0.9 * PI / (self.cells_per_block as f64 * self.step) * (branch as f64 + 2.0);
        let points = 200_000;
        let difference = |frequency: f64| self.bloch_cosine(frequency) - target;
        for i in 0..points {
            let [mut low, mut high] = [i, i + 1].map(|i| end * f64::from(i) / f64::from(points));
            if difference(low).signum() == difference(high).signum() {
                continue;
            }
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                match difference(middle).signum() == difference(low).signum() {
                    true => low = middle,
                    false => high = middle,
                }
            }
            found.push(0.5 * (low + high));
        }
        found[branch]
    }

    /// Finds the frequency of a branch, counted from 0, at the Bloch phase κh in (0, π], band edge included.
    pub fn mode_frequency(&self, phase: f64, branch: usize) -> f64 {
        let frequency = self.branch_frequency(phase.min(PI - 1e-9), branch);
        if phase < PI { frequency } else { self.find_band_edge(frequency) }
    }

    /// Finds the frequency of the band edge κh = π next to a frequency just inside the band. There the Bloch relation
    /// factorises into tan ½θ tan ½ψ = z/z′ and tan ½θ tan ½ψ = z′/z, z′ = √(m/C), which have simple roots.
    fn find_band_edge(&self, guess: f64) -> f64 {
        let layer_impedance = (self.law.mass.mass / self.law.compliance).sqrt();
        let find_factor_root = |ratio: f64| {
            // Root of cos ½θ cos ½ψ − r sin ½θ sin ½ψ, with r = `ratio`, by Newton's method with a difference quotient.
            let factor = |frequency: f64| {
                let [theta, psi] = self.phase_angles(frequency).map(|angle| 0.5 * angle);
                theta.cos() * psi.cos() - ratio * theta.sin() * psi.sin()
            };
            let mut frequency = guess;
            for _ in 0..20 {
                let small = 1e-6 * frequency;
                let slope = (factor(frequency + small) - factor(frequency - small)) / (2.0 * small);
                frequency -= factor(frequency) / slope;
            }
            frequency
        };
        let candidates = [
            find_factor_root(layer_impedance / self.z),
            find_factor_root(self.z / layer_impedance),
        ];
        let nearer = |a: f64, b: f64| if (a - guess).abs() < (b - guess).abs() { a } else { b };
        nearer(candidates[0], candidates[1])
    }

    /// Computes the amplitudes of the right- and left-going waves in the first cell of a block, and of the velocity V
    /// and stress S of the interlayer at its lower face, for modes exp(i(ωt − κx)): the null vector of the interlayer
    /// equations with Bloch phases.
    fn mode_amplitudes(&self, frequency: f64, phase: f64) -> [Complex<f64>; 4] {
        let phase_factor = |angle: f64| Complex::from_polar(1.0, angle);
        let step_factor = phase_factor(frequency * self.step);
        let (z, m, c) = (self.z, self.law.mass.mass / self.step, self.law.compliance / self.step);
        let half = Complex::new(0.5, 0.0);
        // After n steps the right-going wave in cell j of a block is a exp(iω(n − j)Δt), the left-going one b
        // exp(iω(n + j)Δt), with the amplitudes a and b. The last cell of the previous block differs from that of this
        // block by the factor e^{iκh}:
        let block_phase = frequency * self.step * (self.cells_per_block as f64 - 1.0);
        let [right_before, left_before] =
            [phase_factor(phase - block_phase), phase_factor(phase + block_phase)];
        // Incoming waves: cell means before the step; outgoing waves: cell means after it.
        // v⁻ = (left − right)/2z with the left-going wave of the last cell after the step.
        let left = left_before * step_factor;
        let velocity_before = [-right_before / (2.0 * z), left / (2.0 * z)];
        let stress_before = [right_before * half, left * half];
        let velocity_after = [-step_factor / (2.0 * z), Complex::from(1.0 / (2.0 * z))];
        let stress_after = [step_factor * half, half];
        let (sum, change) = (half * (step_factor + 1.0), step_factor - 1.0);
        let zero = Complex::ZERO;
        let matrix = Matrix4::from_rows(&[
            [
                half * (velocity_before[0] + velocity_after[0]),
                half * (velocity_before[1] + velocity_after[1]),
                -sum,
                zero,
            ]
            .into(),
            [
                half * (stress_before[0] + stress_after[0]),
                half * (stress_before[1] + stress_after[1]),
                zero,
                -sum,
            ]
            .into(),
            [
                stress_after[0] - stress_before[0],
                stress_after[1] - stress_before[1],
                -change * m,
                zero,
            ]
            .into(),
            [
                velocity_after[0] - velocity_before[0],
                velocity_after[1] - velocity_before[1],
                zero,
                -change * c,
            ]
            .into(),
        ]);
        let decomposition = matrix.svd(false, true);
        let values = decomposition.singular_values;
        assert!(values[3] < 1e-12 * values[0], "no mode there: {values}");
        let null = decomposition.v_t.expect("asked for").row(3).adjoint();
        [null[0], null[1], null[2], null[3]]
    }

    /// Returns the mode of a frequency and a Bloch phase κh of the chain.
    pub fn mode(&self, frequency: f64, phase: f64) -> ChainMode<'_> {
        let amplitudes = self.mode_amplitudes(frequency, phase);
        ChainMode { chain: self, frequency, phase, amplitudes }
    }
}

impl ChainMode<'_> {
    /// Returns the amplitude of the larger wave. A standing wave may have zero initial stress.
    pub fn amplitude(&self) -> f64 {
        self.amplitudes[0].norm().max(self.amplitudes[1].norm())
    }

    /// Computes the state after `number` sweeps.
    pub fn state(&self, number: usize) -> ChainState {
        let (chain, mode) = (self.chain, self.amplitudes);
        let phase_factor = |angle: f64| Complex::from_polar(1.0, angle);
        let time_factor = phase_factor(self.frequency * chain.step * number as f64);
        let mut state = ChainState { velocity: Vec::new(), stress: Vec::new(), layers: Vec::new() };
        for block in 0..chain.block_count {
            let block_factor = time_factor * phase_factor(-self.phase * block as f64);
            for j in 0..chain.cells_per_block {
                let cell_phase = self.frequency * chain.step * j as f64;
                let (right, left) = (
                    block_factor * mode[0] * phase_factor(-cell_phase),
                    block_factor * mode[1] * phase_factor(cell_phase),
                );
                state.velocity.push(((left - right) / (2.0 * chain.z)).re);
                state.stress.push((0.5 * (left + right)).re);
            }
            state.layers.push([(block_factor * mode[2]).re, (block_factor * mode[3]).re]);
        }
        state
    }
}
