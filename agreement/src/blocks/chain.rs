//! Waves across layers normal to one axis, with blocks at Courant number 1: exact eigenvectors of the scheme.
//!
//! At Courant number 1 a sweep of τ = Δt/2 shifts the Riemann invariants w± = zv ∓ σ by one cell. With g = e^{iωτ}, a
//! mode of the time step has w⁺ᵢ = A g⁻ⁱ and w⁻ᵢ = B gⁱ in cell i of a block of n cells, so that
//!
//! ```text
//! z v⁻ − σ⁻ = A g^{1−n},   z v⁻ + σ⁻ = B gⁿ,   z v⁺ + σ⁺ = q B,   z v⁺ − σ⁺ = q g A,    q = e^{−iκh},
//! ```
//!
//! at the face between two blocks, and the layer by the midpoint rule, with ω̃ = (2/τ) tan ½ωτ,
//!
//! ```text
//! iω̃ m ½(v⁺ + v⁻) = σ⁺ − σ⁻,    v⁺ − v⁻ = iω̃ C(ω̃) [½(σ⁺ + σ⁻) − iω̃ n (v⁺ − v⁻)],
//! ```
//!
//! determines A : B. Variables of the layer at the beginning of the sweep are those at its middle times 2/(1 + g).

use super::grid::{BlockGrid, CellMode, FaceMode, PLANE_FIELDS, WaveState};
use super::layer::{LinearComponent, LinearLayer};
use super::{BlochResult, BlockWave, SolverBlocks};
use crate::MeasurementError;
use crate::fit::{
    ErrorExponents, Rate, extrapolate, fit_rate, max_extrapolation_error, max_rate_error,
};
use crate::solids::{GridResult, Measurement};
use analysis::bloch::BlochError;
use analysis::bloch::chain::{Chain, ChainElement, ChainPolarisation};
use dynamics::boundary::Boundary;
use dynamics::line::Slopes;
use dynamics::medium::Medium;
use dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use dynamics::solid::interlayers::InterlayerFace;
use models::common::elementary::{Elementary, Modulus, cr_cis};
use models::interface::homogenised::BlockMaterial;
use models::solid::waves::SolidField;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Number of blocks of the periodic grid: phase shifts κh are multiples of 2π/8.
pub(super) const CHAIN_BLOCKS: usize = 8;
/// Numbers of cells of a block along the axis of propagation, by grid.
const CELLS_PER_BLOCK: [usize; 2] = [8, 16];
/// Smallest number of measured amplitudes in a period of the wave.
const MIN_SAMPLES_PER_PERIOD: usize = 12;
/// Bound on the rounding error of a time step, in units of ε times the norm of the state; as for plane waves.
const ROUNDINGS_PER_STEP: f64 = 64.0;
/// Largest decay of the amplitude during a measurement, as the exponent γt.
const MAX_DECAY_EXPONENT: f64 = 2.0;
/// Ratio of longitudinal to shear speed in the solver for transverse waves. Longitudinal waves are absent, and at their
/// true speed they would limit the time step.
const LONGITUDINAL_SPEED_RATIO: f64 = 0.5;

/// Comparison of waves of one polarisation across layers normal to an axis.
pub(super) struct ChainExperiment<'a> {
    pub axis: usize,
    pub polarisation: ChainPolarisation,
    /// Side of the blocks along the axis, m.
    pub side: f64,
    pub material: BlockMaterial,
    pub layers: [Option<LinearLayer>; 2],
    pub solver: &'a SolverBlocks,
    /// Index of the block whose medium fills the chain.
    pub block: usize,
}

/// Fields of a mode in a block and in the layer before it.
struct ChainMode {
    /// Velocity (m/s) and stress (Pa) of each cell.
    cells: Vec<[Complex64; 2]>,
    face: FaceMode,
}

impl ChainExperiment<'_> {
    fn layer_component(&self) -> Option<LinearComponent> {
        let index = usize::from(self.polarisation == ChainPolarisation::Transverse);
        self.layers[self.axis].map(|layer| layer.components[index])
    }

    fn build_chain(&self) -> Result<Chain, BlochError> {
        let block = ChainElement::from_block(&self.material, self.side, self.polarisation);
        let layer = self
            .layer_component()
            .map(|LinearComponent { mass, compliance }| ChainElement::Layer { mass, compliance });
        Chain::new([block].into_iter().chain(layer).collect())
    }

    fn wave_speed(&self) -> f64 {
        match self.polarisation {
            ChainPolarisation::Longitudinal => self.material.longitudinal_speed,
            ChainPolarisation::Transverse => self.material.shear_speed,
        }
    }

    /// Compares predicted and measured rate of a branch at the phase shift κh = 2π `phase_index`/[`CHAIN_BLOCKS`].
    pub(super) fn compare_branch(&self, branch: usize, phase_index: usize) -> BlochResult {
        let shift = TAU * phase_index as f64 / CHAIN_BLOCKS as f64;
        let predicted = self.build_chain().and_then(|chain| chain.damped_frequency(branch, shift));
        let measurement = predicted.clone().map_err(MeasurementError::from).and_then(|_| {
            let grids: Result<Vec<GridResult>, MeasurementError> = CELLS_PER_BLOCK
                .iter()
                .map(|&cells| self.compare_on_grid(branch, shift, cells))
                .collect();
            Ok(extrapolate_grids(grids?, ErrorExponents::SYMMETRIC))
        });
        let mut wave_vector = [0.0; 2];
        wave_vector[self.axis] = shift / self.side;
        let wave = BlockWave::Chain { axis: self.axis, polarisation: self.polarisation };
        BlochResult {
            wave,
            wave_vector,
            branch,
            block: self.block,
            predicted_rate: predicted.map_or(Rate::default(), to_rate),
            measurement,
        }
    }

    fn compare_on_grid(
        &self,
        branch: usize,
        shift: f64,
        cells: usize,
    ) -> Result<GridResult, MeasurementError> {
        let component = self.layer_component().unwrap_or(LinearComponent::WELDED);
        let problem = self.build_problem(cells)?;
        let sweep = 0.5 * problem.step;
        let chain = self.build_chain()?.with_time_step(sweep)?;
        let frequency = chain.damped_frequency(branch, shift)?;
        let mode = self.solve_mode(&component, frequency, shift, [cells as f64, sweep]);
        let wave = self.build_wave_state(&problem, &mode, shift, cells);
        // A period, or less if the wave decays.
        let duration =
            (TAU / frequency.re).min(MAX_DECAY_EXPONENT / frequency.im.max(f64::MIN_POSITIVE));
        let steps = (duration / problem.step).ceil().max(4.0);
        let per_sample = (steps / MIN_SAMPLES_PER_PERIOD as f64).floor().max(1.0) as usize;
        let samples = (steps / per_sample as f64).ceil() as usize;
        let measured: Vec<Complex64> = wave
            .measure_amplitudes(&problem, samples, per_sample)?
            .into_iter()
            .map(|amplitude| amplitude.conj())
            .collect();
        let times: Vec<f64> =
            (0..=samples).map(|index| (index * per_sample) as f64 * problem.step).collect();
        let last = times[samples];
        let decay = (frequency.im.max(0.0) * last).cr_exp();
        let rounding = ROUNDINGS_PER_STEP * f64::EPSILON * (samples * per_sample) as f64 * decay;
        Ok(GridResult {
            cells,
            measured_rate: fit_rate(&times, &measured),
            expected_rate: to_rate(frequency),
            tolerance: max_rate_error(rounding, last) + self.max_root_error(&chain, frequency),
        })
    }

    /// Bound on the rounding error of a root ω of cos κh = Δ(ω), rad/s: the terms of Δ have sizes up to
    /// 1 + ½(z/z′ + z′/z), z′ = √(m/C), and their error is divided by Δ′.
    fn max_root_error(&self, chain: &Chain, frequency: Complex64) -> f64 {
        let [_, slope] = chain.half_trace(frequency);
        let impedance_contrast =
            self.layer_component().map_or(1.0, |LinearComponent { mass, compliance }| {
                let impedance = (mass.mass / compliance.relaxed()).sqrt();
                let ratio = self.material.density * self.wave_speed() / impedance;
                0.5 * (ratio + 1.0 / ratio)
            });
        ROUNDINGS_PER_STEP * f64::EPSILON * (1.0 + impedance_contrast) / slope.modulus()
    }

    /// Builds the medium of the solver; for transverse waves with a smaller longitudinal modulus, which does not affect
    /// them, so that their Courant number is 1.
    fn build_medium(&self) -> Medium {
        let mut medium = self.solver.media[self.block].clone();
        if self.polarisation == ChainPolarisation::Transverse {
            for (axis, pairs) in medium.pairs.iter_mut().enumerate() {
                let is_normal = |field: SolidField| field == SolidField::Velocity(axis);
                let shear = pairs.iter().find(|pair| !is_normal(pair.velocity));
                let modulus = shear.map_or(0.0, |pair| pair.modulus);
                for pair in pairs.iter_mut().filter(|pair| is_normal(pair.velocity)) {
                    pair.modulus = LONGITUDINAL_SPEED_RATIO * LONGITUDINAL_SPEED_RATIO * modulus;
                }
            }
        }
        medium
    }

    fn build_problem(&self, cells: usize) -> Result<Problem<2>, MeasurementError> {
        let grid = self.build_grid(cells);
        let edge = self.side / cells as f64;
        let medium = self.build_medium();
        let step = 2.0 * edge / medium.max_speed();
        // The wave is uniform along the transverse axis, so layers across it have no effect.
        let mut laws = [None; 2];
        laws[self.axis] = self.solver.laws[self.axis];
        let mut problem = Problem::new(
            Grid { cells: grid.cells_per_axis(), spacing: [edge; 2] },
            vec![medium],
            vec![0; grid.cell_count()],
            std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
            step,
            Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping),
        );
        problem.interlayers = grid.build_interlayers(&laws);
        Ok(problem)
    }

    fn build_grid(&self, cells: usize) -> BlockGrid {
        let by_axis = |own: usize, other: usize| {
            std::array::from_fn(|axis| if axis == self.axis { own } else { other })
        };
        BlockGrid {
            cells_per_block: by_axis(cells, 1),
            block_counts: by_axis(CHAIN_BLOCKS, 1),
            row_shift: 0,
        }
    }

    /// Solves for A : B, and evaluates the mode of frequency ω (rad/s) and phase shift κh; the last argument is the
    /// number of cells of a block and the time τ of a sweep, s.
    fn solve_mode(
        &self,
        component: &LinearComponent,
        frequency: Complex64,
        shift: f64,
        [cells, sweep]: [f64; 2],
    ) -> ChainMode {
        let z = self.material.density * self.wave_speed();
        let power = |exponent: f64| exponential(Complex64::I * frequency * (sweep * exponent));
        let (g, q) = (power(1.0), cr_cis(-shift));
        let [one, two] = [Complex64::ONE, Complex64::from(2.0)];
        // iω̃ = (2/τ)(g − 1)/(g + 1).
        let rate = (g - one) / (g + one) * (2.0 / sweep);
        let law = component.compliance;
        let delay = one / (one + rate * law.retardation_time);
        let compliance = delay * law.delayed + law.elastic;
        // Coefficients of A and B in the states of both faces of the layer.
        let [before, after] = [[power(1.0 - cells), power(cells)], [q * g, q]];
        let velocity = |own: [Complex64; 2]| own.map(|value| value / (2.0 * z));
        let stress = |own: [Complex64; 2]| [-own[0] * 0.5, own[1] * 0.5];
        let combine = |sign: f64, pair: &dyn Fn([Complex64; 2]) -> [Complex64; 2]| {
            let [low, high] = [pair(before), pair(after)];
            [0, 1].map(|i| high[i] + low[i] * sign)
        };
        let (sum, opening) = (combine(1.0, &velocity), combine(-1.0, &velocity));
        let (tractions, difference) = (combine(1.0, &stress), combine(-1.0, &stress));
        let mean = [0, 1].map(|i| sum[i] * 0.5);
        let layer_stress =
            [0, 1].map(|i| tractions[i] * 0.5 - rate * component.mass.opening_mass * opening[i]);
        let momentum = [0, 1].map(|i| rate * component.mass.mass * mean[i] - difference[i]);
        let deformation = [0, 1].map(|i| (opening[i] - rate * compliance * layer_stress[i]) * z);
        let size = |row: [Complex64; 2]| row[0].modulus() + row[1].modulus();
        let row = if size(momentum) > size(deformation) { momentum } else { deformation };
        let [a, b] = [-row[1] / size(row), row[0] / size(row)];
        let value = |pair: [Complex64; 2]| pair[0] * a + pair[1] * b;
        let begin = two / (one + g);
        let face = FaceMode {
            velocity: value(mean),
            opening_rate: value(opening),
            stress: value(layer_stress),
            delayed_stress: value(layer_stress) * delay,
        };
        // The face computed here is after the block; the face before it has the amplitude of the previous period.
        let cell = |index: usize| {
            let (right, left) = (a * power(-(index as f64)), b * power(index as f64));
            [(right + left) / (2.0 * z), (left - right) * 0.5]
        };
        ChainMode {
            cells: (0..cells as usize).map(cell).collect(),
            face: face.scale(begin * q.conj()),
        }
    }

    fn build_wave_state(
        &self,
        problem: &Problem<2>,
        mode: &ChainMode,
        shift: f64,
        cells: usize,
    ) -> WaveState {
        let grid = self.build_grid(cells);
        let (axis, transverse) =
            (self.axis, usize::from(self.polarisation == ChainPolarisation::Transverse));
        let velocity = SolidField::Velocity(if transverse == 0 { axis } else { 1 - axis });
        let stress =
            if transverse == 0 { SolidField::Stress(axis, axis) } else { SolidField::Stress(0, 1) };
        let field_indices =
            [velocity, stress].map(|field| PLANE_FIELDS.iter().position(|own| *own == field));
        let density = self.material.density;
        let weights = [density, 1.0 / (density * self.wave_speed() * self.wave_speed())];
        let phase = |block: i64| cr_cis(-shift * block as f64);
        let cell = |index: usize| {
            let place = grid.locate_cell(index);
            let factor = phase(place.block[axis]);
            let mut own = CellMode::default();
            for (field, at) in field_indices.iter().enumerate() {
                let Some(at) = *at else { continue };
                let value = mode.cells[place.cell[axis]][field] * factor;
                own.values[at] = value;
                own.energy_gradient[at] = value * weights[field];
            }
            own
        };
        let face = |own: &InterlayerFace| {
            let factor = phase(grid.locate_cell(own.cell).block[axis]);
            let mut modes = [FaceMode::default(); 2];
            modes[transverse] = mode.face.scale(factor);
            modes
        };
        WaveState::new(problem, &self.layers, cell, face)
    }
}

impl LinearComponent {
    const WELDED: Self = Self {
        mass: models::interface::opening_line::LayerMass { mass: 0.0, opening_mass: 0.0 },
        compliance: analysis::bloch::chain::LayerCompliance::new_elastic(0.0),
    };
}

/// Complex exponential e^x, from correctly rounded real functions.
fn exponential(x: Complex64) -> Complex64 {
    cr_cis(x.im) * x.re.cr_exp()
}

/// Converts the complex frequency ω of e^{iωt} to a rate: Re ω and the growth rate γ = −Im ω.
pub(super) fn to_rate(frequency: Complex64) -> Rate {
    Rate { frequency: frequency.re, growth_rate: -frequency.im }
}

/// Extrapolates rates to zero cell size, with the bound on the error of the limit.
fn extrapolate_grids(grids: Vec<GridResult>, powers: ErrorExponents) -> Measurement {
    let cells: Vec<usize> = grids.iter().map(|grid| grid.cells).collect();
    let limit = |rate: &dyn Fn(&GridResult) -> Rate| {
        extrapolate(&cells, &grids.iter().map(rate).collect::<Vec<_>>(), powers)
    };
    let errors: Vec<f64> = grids.iter().map(|grid| grid.tolerance).collect();
    let limit = GridResult {
        cells: 0,
        measured_rate: limit(&|grid| grid.measured_rate),
        expected_rate: limit(&|grid| grid.expected_rate),
        tolerance: max_extrapolation_error(&cells, &errors, powers),
    };
    Measurement { grids, limit }
}

/// Index n ≥ 1 of the phase shift 2πn/[`CHAIN_BLOCKS`] nearest to `shift`, rad; at most half a turn.
pub(super) fn nearest_phase_index(shift: f64) -> usize {
    (shift * CHAIN_BLOCKS as f64 / TAU).round().clamp(1.0, CHAIN_BLOCKS as f64 * 0.5) as usize
}

/// Largest number of branches of a chain: on the coarsest grid the phase of higher ones advances by more than π in a
/// step.
pub(super) const MAX_BRANCHES: usize = 2;
/// Phase shifts κh of the compared waves, rad, in the order of selection.
pub(super) const PHASE_SHIFTS: [f64; 4] = [0.5 * PI, 0.25 * PI, 0.75 * PI, PI];
