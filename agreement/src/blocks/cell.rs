//! Bloch waves of a doubly periodic medium: the solver starts from a mode of the analysis.
//!
//! Cell means of velocity and displacement gradient, and means over faces of the opening, come from the polynomials of
//! the mode by Gauss–Legendre quadrature. At Courant numbers below 1 the reconstruction beside a layer is not exact for
//! linear profiles, since it would then let some waves gain energy; errors fall between order 1 and 2. Three grids, each
//! twice as fine as the one before, bound the error of the extrapolated rate.

use super::chain::to_rate;
use super::grid::{BlockGrid, CellMode, FaceMode, WaveState};
use super::{BlochResult, BlockSettings, BlockWave, BlockyCell, SolverBlocks};
use crate::MeasurementError;
use crate::fit::{Rate, fit_rate, max_rate_error};
use crate::solids::{GridResult, Measurement};
use analysis::bloch::BlochError;
use analysis::bloch::cell::legendre::gauss_legendre;
use analysis::bloch::cell::{BlockRow, Cell, CellBlock, CellModel, DegreeControl};
use dynamics::boundary::Boundary;
use dynamics::line::Slopes;
use dynamics::medium::Medium;
use dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use dynamics::solid::interlayers::InterlayerFace;
use models::common::elementary::cr_cis;
use models::interface::homogenised::BlockMaterial;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Phase shifts per block along both axes in units of 2π, with the numbers of blocks of their periods.
pub(super) const PHASES: [[[usize; 2]; 2]; 3] =
    [[[1, 0], [4, 1]], [[1, 1], [4, 4]], [[1, 2], [4, 4]]];
/// Number of amplitudes of a measurement.
const SAMPLES: usize = 16;
/// Largest number of unknowns of the analysis.
const MAX_UNKNOWNS: usize = 400;
/// Requested accuracy of predicted frequencies.
const ACCURACY: f64 = 1e-6;
/// Largest degree of the polynomials.
const MAX_DEGREE: usize = 10;
/// Degrees of the polynomials for viscous layers.
const DAMPED_DEGREES: [usize; 2] = [4, 6];
/// Quadrature points along faces and edges of cells, and along each axis in cells.
const POINTS: [usize; 2] = [4, 3];
/// Largest decay of the amplitude during a measurement, as the exponent γt.
const MAX_DECAY: f64 = 2.0;
/// Bound on the rounding error of a step, in units of ε times the norm of the state.
const ROUNDINGS_PER_STEP: f64 = 64.0;
/// Steps of inverse iteration for the vector of a damped mode.
const INVERSE_ITERATIONS: usize = 3;

/// Waves in the plane, and the medium as described to the analysis and to the solver.
pub(super) struct CellExperiment<'a> {
    pub medium: &'a BlockyCell,
    pub layers: [Option<super::LinearLayer>; 2],
    pub solver: &'a SolverBlocks,
    pub settings: &'a BlockSettings,
}

/// Mode of the analysis.
pub(super) struct PredictedMode {
    model: CellModel,
    vector: DVector<Complex64>,
    /// Extrapolated angular frequency, rad/s.
    frequency: Complex64,
    /// Angular frequency of the polynomials of the vector, rad/s.
    raw_frequency: Complex64,
    /// Estimate of the error of the frequency, rad/s.
    error: f64,
    wave_vector: [f64; 2],
    blocks: [usize; 2],
}

impl CellExperiment<'_> {
    /// The cell of the analysis; the error is the reason why there is none.
    fn cell(&self) -> Result<Cell, BlochError> {
        let joint = |axis: usize| self.layers[axis].map(super::LinearLayer::to_joint);
        let (Some(right), Some(top)) = (joint(0), joint(1)) else {
            return Err(BlochError::NotConverged { iteration: "a cell of welded blocks" });
        };
        let BlockyCell { sides, blocks, row_shift, materials, .. } = self.medium;
        let row = |row: usize| BlockRow {
            height: sides[1],
            offset: if row % 2 == 1 { row_shift * sides[0] } else { 0.0 },
            blocks: (0..blocks[0])
                .map(|column| CellBlock {
                    width: sides[0],
                    material: materials[column + blocks[0] * row],
                    right,
                    top,
                })
                .collect(),
        };
        Cell::new((0..blocks[1]).map(row).collect())
    }

    /// Modes of the lowest branches at a wave vector, of which [`PHASES`] has the index.
    pub(super) fn predict(&self, phases: usize) -> Result<Vec<PredictedMode>, BlochError> {
        let [turns, periods] = PHASES[phases];
        let period = self.medium.blocks;
        let sides = self.medium.sides;
        let blocks = [0, 1].map(|axis| periods[axis] * period[axis]);
        // Phase shift of 2π·turns/periods per period of the medium.
        let wave_vector = [0, 1].map(|axis| {
            TAU * turns[axis] as f64 / (periods[axis] as f64 * period[axis] as f64 * sides[axis])
        });
        let cell = self.cell()?;
        let count = self.settings.branches;
        let new_mode = |model: &CellModel, vector, frequency, raw_frequency, error| PredictedMode {
            model: model.clone(),
            vector,
            frequency,
            raw_frequency,
            error,
            wave_vector,
            blocks,
        };
        let is_viscous = |layer: &super::LinearLayer| layer.components[1].is_viscous();
        if self.layers.iter().flatten().any(is_viscous) {
            let models = DAMPED_DEGREES.map(|degree| CellModel::new(&cell, degree));
            let [coarse, fine] = [&models[0], &models[1]].map(|own| own.damped_modes(wave_vector));
            let (coarse, fine) = (coarse?.frequencies, fine?.frequencies);
            let order = models[1].convergence_order();
            let [low, high] = DAMPED_DEGREES.map(|degree| degree as f64 + 0.5);
            let ratio = (high / low).powi(order) - 1.0;
            let mut modes = Vec::new();
            for &raw in fine.iter().take(count) {
                let distance = |other: &Complex64| (other - raw).norm();
                let nearest =
                    coarse.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let correction = (raw - nearest.unwrap_or(raw)) / ratio;
                let vector = self.damped_vector(&models[1], wave_vector, raw)?;
                modes.push(new_mode(&models[1], vector, raw + correction, raw, correction.norm()));
            }
            return Ok(modes);
        }
        let unknowns = 2 * period[0] * period[1];
        let largest = ((MAX_UNKNOWNS / unknowns) as f64).sqrt() as usize - 1;
        let control =
            DegreeControl { tolerance: ACCURACY, first: 4, largest: largest.clamp(4, MAX_DEGREE) };
        let converged = cell.solve(wave_vector, count, &control)?;
        let model = CellModel::new(&cell, converged.degree);
        let found = model.modes(wave_vector, count, true)?;
        let frequencies = converged.frequencies();
        let raw = found.frequencies();
        let modes = frequencies.iter().zip(raw).enumerate().map(|(index, (&frequency, raw))| {
            let vector = found.vectors.column(index).into_owned();
            // The change of the extrapolated value, or all of the extrapolation if it has not been repeated.
            let error = match converged.achieved.is_finite() {
                true => converged.achieved * frequency,
                false => (frequency - raw).abs(),
            };
            let [frequency, raw] = [frequency, raw].map(Complex64::from);
            new_mode(&model, vector, frequency, raw, error)
        });
        Ok(modes.collect())
    }

    /// Vector of a damped mode of complex frequency ω: (K(ω) − ω²M)u = 0 by inverse iteration. K(ω) is that of the
    /// instantaneous stiffness, with the tangential stiffness of layers changed to 1/C(ω).
    fn damped_vector(
        &self,
        model: &CellModel,
        wave_vector: [f64; 2],
        frequency: Complex64,
    ) -> Result<DVector<Complex64>, BlochError> {
        let failed = BlochError::NotConverged { iteration: "the vector of a damped mode" };
        let [mut matrix, mass] = model.matrices(wave_vector);
        let base = matrix.clone();
        for axis in 0..2 {
            let Some(layer) = self.layers[axis].filter(|own| own.components[1].is_viscous()) else {
                continue;
            };
            let mut stiffer = CellExperiment { layers: self.layers, ..*self };
            let mut double = layer;
            double.components[1].compliance.elastic *= 0.5;
            stiffer.layers[axis] = Some(double);
            let [changed, _] =
                CellModel::new(&stiffer.cell()?, model.degree()).matrices(wave_vector);
            let law = layer.components[1].compliance;
            let delayed = Complex64::from(law.delayed)
                / (Complex64::ONE + Complex64::I * frequency * law.retardation_time);
            let share = law.elastic / (delayed + law.elastic) - 1.0;
            matrix += (changed - &base) * share;
        }
        matrix -= mass.map(|value| value * frequency * frequency);
        let size = matrix.nrows();
        let scale = matrix.norm();
        let shift = DMatrix::<Complex64>::identity(size, size) * Complex64::from(1e-14 * scale);
        let factors = (matrix + shift).lu();
        let start = |index: usize| Complex64::from(1.0 + ((index * index + 1) % 7) as f64);
        let mut vector = DVector::from_fn(size, |index, _| start(index));
        for _ in 0..INVERSE_ITERATIONS {
            vector = factors.solve(&vector).ok_or(failed.clone())?;
            let norm = vector.norm();
            vector /= Complex64::from(norm);
        }
        match vector.iter().all(|value| value.is_finite()) {
            true => Ok(vector),
            false => Err(failed),
        }
    }

    /// Result of a predicted mode from its rates on all grids.
    pub(super) fn collect(
        &self,
        mode: &PredictedMode,
        branch: usize,
        grids: Vec<Result<GridResult, MeasurementError>>,
    ) -> BlochResult {
        let grids: Result<Vec<GridResult>, MeasurementError> = grids.into_iter().collect();
        BlochResult {
            wave: BlockWave::Cell,
            wave_vector: mode.wave_vector,
            branch,
            block: 0,
            predicted_rate: to_rate(mode.frequency),
            measurement: grids.map(|grids| extrapolate_doubled(mode, grids)),
        }
    }

    /// Measures a mode with `cells` cells per block along each axis.
    pub(super) fn measure(
        &self,
        mode: &PredictedMode,
        cells: usize,
    ) -> Result<GridResult, MeasurementError> {
        let shift = (self.medium.row_shift * cells as f64).round() as usize;
        let grid = BlockGrid { block_cells: [cells; 2], blocks: mode.blocks, row_shift: shift };
        let spacing = self.medium.sides.map(|side| side / cells as f64);
        let frequency = mode.frequency;
        let duration = (TAU / frequency.re).min(MAX_DECAY / frequency.im.max(f64::MIN_POSITIVE));
        // The step is in the same proportion to the cells of all grids.
        let coarsest = self.settings.cells[0];
        let speed = self.solver.media.iter().map(Medium::max_speed).fold(0.0, f64::max);
        let edge = spacing[0].min(spacing[1]) * (cells as f64 / coarsest as f64);
        let limit = 2.0 * self.settings.courant_number * edge / speed;
        let coarse_steps = (duration / (SAMPLES as f64 * limit) * (1.0 - 1e-12)).ceil().max(1.0);
        let per_sample = coarse_steps as usize * cells / coarsest;
        let step = duration / (SAMPLES * per_sample) as f64;
        let period = self.medium.blocks;
        let block_of = |index: usize| {
            let [column, row] = grid.place(index).block;
            let column = column.rem_euclid(period[0] as i64) as usize;
            column + period[0] * (row.rem_euclid(period[1] as i64) as usize)
        };
        let mut problem = Problem::new(
            Grid { cells: grid.cells(), spacing },
            self.solver.media.clone(),
            (0..grid.count()).map(|index| block_of(index) as u16).collect(),
            std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
            step,
            Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping),
        );
        problem.interlayers = grid.interlayers(&self.solver.laws);
        let wave = self.wave_state(&problem, &grid, mode);
        let amplitudes = wave.measure(&problem, SAMPLES, per_sample)?;
        let measured: Vec<Complex64> = amplitudes.iter().map(|own| own.conj()).collect();
        let times: Vec<f64> =
            (0..=SAMPLES).map(|index| (index * per_sample) as f64 * step).collect();
        let rounding = ROUNDINGS_PER_STEP * f64::EPSILON * (SAMPLES * per_sample) as f64;
        Ok(GridResult {
            cells,
            measured_rate: fit_rate(&times, &measured),
            expected_rate: to_rate(mode.frequency),
            tolerance: max_rate_error(rounding, duration),
        })
    }

    fn wave_state(
        &self,
        problem: &Problem<2>,
        grid: &BlockGrid,
        mode: &PredictedMode,
    ) -> WaveState {
        let [columns, rows] = self.medium.blocks;
        let [n1, n2] = grid.block_cells;
        let sampler = ModeSampler::new(self, mode, grid.block_cells);
        let count = columns * rows;
        let cells: Vec<CellMode> = (0..count * n1 * n2)
            .map(|index| sampler.cell(index / (n1 * n2), index % (n1 * n2)))
            .collect();
        // Displacement at the ends of each axis of a block: block, axis, end, cell along the face.
        let faces: Vec<[[Vec<[Complex64; 2]>; 2]; 2]> =
            (0..count).map(|block| sampler.faces(block)).collect();
        let sides = self.medium.sides;
        let locate = |index: usize| {
            let place = grid.place(index);
            let [column, row] = place.block;
            let periods = [column.div_euclid(columns as i64), row.div_euclid(rows as i64)];
            let block = column.rem_euclid(columns as i64) as usize
                + columns * row.rem_euclid(rows as i64) as usize;
            let angle: f64 = [0, 1]
                .map(|axis| {
                    let period = [columns, rows][axis] as f64 * sides[axis];
                    mode.wave_vector[axis] * period * periods[axis] as f64
                })
                .iter()
                .sum();
            (block, place.cell, cr_cis(-angle))
        };
        let cell = |index: usize| {
            let (block, [i, j], phase) = locate(index);
            let own = cells[block * n1 * n2 + i + n1 * j];
            CellMode {
                values: own.values.map(|value| value * phase),
                dual: own.dual.map(|value| value * phase),
            }
        };
        let rate = Complex64::I * mode.raw_frequency;
        let face = |own: &InterlayerFace| {
            let axis = own.axis;
            let trace = |index: usize, end: usize| {
                let (block, at, phase) = locate(index);
                faces[block][axis][end][at[1 - axis]].map(|value| value * phase)
            };
            // Phases of the whole grid are multiples of 2π.
            let (below, _) = grid.lower_neighbour(own.cell, axis);
            let (before, after) = (trace(below, 1), trace(own.cell, 0));
            let component = |index: usize| {
                let direction = if index == 0 { axis } else { 1 - axis };
                let opening = after[direction] - before[direction];
                let law = self.layers[axis].map(|layer| layer.components[index].compliance);
                let Some(law) = law else { return FaceMode::default() };
                let delay = Complex64::ONE / (Complex64::ONE + rate * law.retardation_time);
                let stress = opening / (delay * law.delayed + law.elastic);
                FaceMode {
                    velocity: rate * (after[direction] + before[direction]) * 0.5,
                    opening_rate: rate * opening,
                    stress,
                    delayed_stress: stress * delay,
                }
            };
            [component(0), component(1)]
        };
        WaveState::new(problem, &self.layers, cell, face)
    }
}

/// Means of a mode over the cells and faces of a block.
struct ModeSampler<'a> {
    mode: &'a PredictedMode,
    materials: &'a [BlockMaterial],
    sides: [f64; 2],
    cells: [usize; 2],
    edge: Vec<[f64; 2]>,
    inner: Vec<[f64; 2]>,
}

impl<'a> ModeSampler<'a> {
    fn new(experiment: &'a CellExperiment, mode: &'a PredictedMode, cells: [usize; 2]) -> Self {
        let [edge, inner] = POINTS.map(gauss_legendre);
        let BlockyCell { materials, sides, .. } = experiment.medium;
        Self { mode, materials, sides: *sides, cells, edge, inner }
    }

    fn displacement(&self, block: usize, at: [f64; 2]) -> [Complex64; 2] {
        self.mode.model.displacement(self.mode.vector.as_slice(), block, at)
    }

    /// Local coordinate of the node ξ in [−1, 1] of cell `index` along an axis.
    fn local(&self, axis: usize, index: usize, node: f64) -> f64 {
        (index as f64 + 0.5 * (node + 1.0)) / self.cells[axis] as f64 * 2.0 - 1.0
    }

    /// Mean displacement along a line normal to `axis` at its node ξ = ±1, in the cell at `at`.
    fn edge_mean(&self, block: usize, axis: usize, at: [usize; 2], node: f64) -> [Complex64; 2] {
        let mut mean = [Complex64::ZERO; 2];
        for [other, weight] in &self.edge {
            let nodes: [f64; 2] = std::array::from_fn(|i| if i == axis { node } else { *other });
            let local = [0, 1].map(|i| self.local(i, at[i], nodes[i]));
            let value = self.displacement(block, local);
            mean = [0, 1].map(|i| mean[i] + value[i] * *weight);
        }
        mean
    }

    fn cell(&self, block: usize, index: usize) -> CellMode {
        let at = [index % self.cells[0], index / self.cells[0]];
        let mut mean = [Complex64::ZERO; 2];
        for [x, first] in &self.inner {
            for [y, second] in &self.inner {
                let local = [self.local(0, at[0], *x), self.local(1, at[1], *y)];
                let value = self.displacement(block, local);
                mean = [0, 1].map(|i| mean[i] + value[i] * (first * second));
            }
        }
        // Mean of ∂u/∂x by the divergence theorem.
        let gradient = [0, 1].map(|axis| {
            let [low, high] = [-1.0, 1.0].map(|node| self.edge_mean(block, axis, at, node));
            let length = self.sides[axis] / self.cells[axis] as f64;
            [0, 1].map(|i| (high[i] - low[i]) / length)
        });
        let material = &self.materials[block];
        let (lambda, mu) = (material.lame_modulus(), material.shear_modulus());
        let strain = [gradient[0][0], gradient[1][1], gradient[0][1] + gradient[1][0]];
        let trace = (strain[0] + strain[1]) * lambda;
        let rate = Complex64::I * self.mode.raw_frequency;
        let velocity = mean.map(|value| rate * value);
        let stress =
            [trace + strain[0] * (2.0 * mu), trace + strain[1] * (2.0 * mu), strain[2] * mu];
        let density = material.density;
        CellMode {
            values: [velocity[0], velocity[1], stress[0], stress[1], stress[2]],
            dual: [velocity[0] * density, velocity[1] * density, strain[0], strain[1], strain[2]],
        }
    }

    /// Mean displacements at the faces of a block: axis, end, cell along the face.
    fn faces(&self, block: usize) -> [[Vec<[Complex64; 2]>; 2]; 2] {
        [0, 1].map(|axis| {
            [0, 1].map(|end| {
                let node = if end == 0 { -1.0 } else { 1.0 };
                let along = 0..self.cells[1 - axis];
                let at = |index: usize| {
                    let last = if end == 0 { 0 } else { self.cells[axis] - 1 };
                    std::array::from_fn(|i| if i == axis { last } else { index })
                };
                along.map(|index| self.edge_mean(block, axis, at(index), node)).collect()
            })
        })
    }
}

/// Extrapolates rates on grids each twice as fine as the one before: the mean of the values for errors in h and in h²,
/// since the scheme has both at joints (`extrapolate_pair`). The bound on the error is half the difference of both
/// values, plus the change of the mean since the coarser two grids, plus the error of the prediction and rounding; on a
/// grid also the distance from the limit. An error in h^q uses ½ of it for q = 1, ¼ for q = 2, and less between.
fn extrapolate_doubled(mode: &PredictedMode, mut grids: Vec<GridResult>) -> Measurement {
    let rates: Vec<Rate> = grids.iter().map(|grid| grid.measured_rate).collect();
    let limits: Vec<Rate> =
        rates.windows(2).map(|pair| extrapolate_pair(pair[0], pair[1])).collect();
    let limit = limits.last().or(rates.last()).copied().unwrap_or_default();
    let half_difference = match rates.as_slice() {
        [.., coarse, fine] => (*fine - *coarse).max_norm() / 3.0,
        _ => 0.0,
    };
    let change = match limits.as_slice() {
        [.., coarse, fine] => (*fine - *coarse).max_norm(),
        _ => 0.0,
    };
    let rounding = grids.iter().map(|grid| grid.tolerance).fold(0.0, f64::max);
    let tolerance = half_difference + change + mode.error + 3.0 * rounding;
    for grid in &mut grids {
        grid.tolerance = (grid.measured_rate - limit).max_norm() + tolerance;
    }
    let expected_rate = to_rate(mode.frequency);
    let limit = GridResult { cells: 0, measured_rate: limit, expected_rate, tolerance };
    Measurement { grids, limit }
}

/// Mean of f + (f − c), for errors in h, and f + ⅓(f − c), for errors in h², from the rates f and c on two grids.
fn extrapolate_pair(coarse: Rate, fine: Rate) -> Rate {
    let extrapolate = |coarse: f64, fine: f64| fine + (fine - coarse) * (2.0 / 3.0);
    Rate {
        frequency: extrapolate(coarse.frequency, fine.frequency),
        growth_rate: extrapolate(coarse.growth_rate, fine.growth_rate),
    }
}
