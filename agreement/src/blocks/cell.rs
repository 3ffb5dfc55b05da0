//! Bloch waves of a doubly periodic medium: the solver starts from a mode of the analysis.
//!
//! Cell means of velocity and displacement gradient, and means over faces of the opening, come from the polynomials of
//! the mode by Gauss–Legendre quadrature. At Courant numbers below 1 the reconstruction next to a layer is not exact
//! for linear profiles, since it would then let some waves gain energy; errors fall between order 1 and 2. Three grids,
//! each twice as fine as the one before, bound the error of the extrapolated rate.

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
use models::common::elementary::{Modulus, cr_cis};
use models::interface::homogenised::BlockMaterial;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Wave vectors by their phase shifts 2π·m/n per period of the medium: m by axis, then n by axis.
pub(super) const PLANE_PHASE_SHIFTS: [[[usize; 2]; 2]; 3] =
    [[[1, 0], [4, 1]], [[1, 1], [4, 4]], [[1, 2], [4, 4]]];
/// Number of time intervals between the amplitudes of a measurement.
const SAMPLE_COUNT: usize = 16;
/// Largest number of unknowns of the Galerkin method that predicts frequencies.
const MAX_UNKNOWNS: usize = 400;
/// Requested relative accuracy of predicted frequencies.
const FREQUENCY_ACCURACY: f64 = 1e-6;
/// Largest degree of the Legendre polynomials of a predicted mode.
const MAX_POLYNOMIAL_DEGREE: usize = 10;
/// Degrees of the Legendre polynomials for viscous layers; frequencies are extrapolated from both.
const DAMPED_POLYNOMIAL_DEGREES: [usize; 2] = [4, 6];
/// Numbers of Gauss–Legendre points of means of a mode: along faces and edges of solver cells, and along each axis in
/// solver cells.
const QUADRATURE_POINTS: [usize; 2] = [4, 3];
/// Largest decay of the amplitude during a measurement, as the exponent γt.
const MAX_DECAY_EXPONENT: f64 = 2.0;
/// Bound on the rounding error of a step, in units of ε times the norm of the state.
const ROUNDINGS_PER_STEP: f64 = 64.0;
/// Number of steps of inverse iteration for the mode vector of a damped mode.
const INVERSE_ITERATIONS: usize = 3;

/// Comparison of Bloch waves in the plane: the medium as the analysis and as the solver describe it, and the settings.
pub(super) struct CellExperiment<'a> {
    pub medium: &'a BlockyCell,
    pub layers: [Option<super::LinearLayer>; 2],
    pub solver: &'a SolverBlocks,
    pub settings: &'a BlockSettings,
}

/// Bloch wave that the analysis predicts, with the polynomials of its displacement.
pub(super) struct PredictedMode {
    model: CellModel,
    mode_vector: DVector<Complex64>,
    /// Extrapolated angular frequency, rad/s.
    frequency: Complex64,
    /// Angular frequency that belongs to `mode_vector`, without extrapolation, rad/s.
    raw_frequency: Complex64,
    /// Estimate of the error of the frequency, rad/s.
    error: f64,
    wave_vector: [f64; 2],
    /// Numbers of blocks of a period of the wave along each axis.
    block_counts: [usize; 2],
}

impl CellExperiment<'_> {
    /// Builds a period of the medium for the analysis.
    fn build_cell(&self) -> Result<Cell, BlochError> {
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
                    right_joint: right,
                    top_joint: top,
                })
                .collect(),
        };
        Cell::new((0..blocks[1]).map(row).collect())
    }

    /// Predicts the modes of the lowest branches at the wave vector of index `phases` in [`PLANE_PHASE_SHIFTS`].
    pub(super) fn predict_modes(&self, phases: usize) -> Result<Vec<PredictedMode>, BlochError> {
        let [turns, periods] = PLANE_PHASE_SHIFTS[phases];
        let period = self.medium.blocks;
        let sides = self.medium.sides;
        let blocks = [0, 1].map(|axis| periods[axis] * period[axis]);
        // Phase shift of 2π·turns/periods per period of the medium.
        let wave_vector = [0, 1].map(|axis| {
            TAU * turns[axis] as f64 / (periods[axis] as f64 * period[axis] as f64 * sides[axis])
        });
        let cell = self.build_cell()?;
        let count = self.settings.branch_count;
        let new_mode =
            |model: &CellModel, mode_vector, frequency, raw_frequency, error| PredictedMode {
                model: model.clone(),
                mode_vector,
                frequency,
                raw_frequency,
                error,
                wave_vector,
                block_counts: blocks,
            };
        let is_viscous = |layer: &super::LinearLayer| layer.components[1].is_viscous();
        if self.layers.iter().flatten().any(is_viscous) {
            let models = DAMPED_POLYNOMIAL_DEGREES.map(|degree| CellModel::new(&cell, degree));
            let [coarse, fine] = [&models[0], &models[1]].map(|own| own.damped_modes(wave_vector));
            let (coarse, fine) = (coarse?.frequencies, fine?.frequencies);
            let order = models[1].convergence_order();
            let [low, high] = DAMPED_POLYNOMIAL_DEGREES.map(|degree| degree as f64 + 0.5);
            let ratio = (high / low).powi(order) - 1.0;
            let mut modes = Vec::new();
            for &raw in fine.iter().take(count) {
                let distance = |other: &Complex64| (other - raw).modulus();
                let nearest =
                    coarse.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let correction = (raw - nearest.unwrap_or(raw)) / ratio;
                let vector = self.solve_damped_vector(&models[1], wave_vector, raw)?;
                modes.push(new_mode(
                    &models[1],
                    vector,
                    raw + correction,
                    raw,
                    correction.modulus(),
                ));
            }
            return Ok(modes);
        }
        let unknowns = 2 * period[0] * period[1];
        let largest = ((MAX_UNKNOWNS / unknowns) as f64).sqrt() as usize - 1;
        let control = DegreeControl {
            tolerance: FREQUENCY_ACCURACY,
            first_degree: 4,
            largest_degree: largest.clamp(4, MAX_POLYNOMIAL_DEGREE),
        };
        let converged = cell.solve(wave_vector, count, &control)?;
        let model = CellModel::new(&cell, converged.degree);
        let found = model.modes(wave_vector, count, true)?;
        let frequencies = converged.frequencies();
        let raw = found.frequencies();
        let modes = frequencies.iter().zip(raw).enumerate().map(|(index, (&frequency, raw))| {
            let vector = found.eigenvectors.column(index).into_owned();
            // The change of the extrapolated value, or all of the extrapolation if it has not been repeated.
            let error = match converged.frequency_error.is_finite() {
                true => converged.frequency_error * frequency,
                false => (frequency - raw).abs(),
            };
            let [frequency, raw] = [frequency, raw].map(Complex64::from);
            new_mode(&model, vector, frequency, raw, error)
        });
        Ok(modes.collect())
    }

    /// Solves (K(ω) − ω²M)u = 0 for the mode vector u of a damped mode of complex frequency ω, rad/s, by inverse
    /// iteration. K(ω) is the stiffness matrix with the tangential stiffness 1/C(ω) of viscous layers.
    fn solve_damped_vector(
        &self,
        model: &CellModel,
        wave_vector: [f64; 2],
        frequency: Complex64,
    ) -> Result<DVector<Complex64>, BlochError> {
        let not_converged = BlochError::NotConverged { iteration: "the vector of a damped mode" };
        let [mut matrix, mass] = model.matrices(wave_vector);
        let base = matrix.clone();
        for axis in 0..2 {
            let Some(layer) = self.layers[axis].filter(|own| own.components[1].is_viscous()) else {
                continue;
            };
            let mut stiffer_medium = CellExperiment { layers: self.layers, ..*self };
            let mut stiffer_layer = layer;
            stiffer_layer.components[1].compliance.elastic *= 0.5;
            stiffer_medium.layers[axis] = Some(stiffer_layer);
            let [changed, _] =
                CellModel::new(&stiffer_medium.build_cell()?, model.degree()).matrices(wave_vector);
            let law = layer.components[1].compliance;
            let delayed = Complex64::from(law.delayed)
                / (Complex64::ONE + Complex64::I * frequency * law.retardation_time);
            let stiffness_change = law.elastic / (delayed + law.elastic) - 1.0;
            matrix += (changed - &base) * stiffness_change;
        }
        matrix -= mass.map(|value| value * frequency * frequency);
        let size = matrix.nrows();
        let scale = matrix.norm();
        let shift = DMatrix::<Complex64>::identity(size, size) * Complex64::from(1e-14 * scale);
        let factors = (matrix + shift).lu();
        let start = |index: usize| Complex64::from(1.0 + ((index * index + 1) % 7) as f64);
        let mut vector = DVector::from_fn(size, |index, _| start(index));
        for _ in 0..INVERSE_ITERATIONS {
            vector = factors.solve(&vector).ok_or(not_converged.clone())?;
            let norm = vector.norm();
            vector /= Complex64::from(norm);
        }
        match vector.iter().all(|value| value.is_finite()) {
            true => Ok(vector),
            false => Err(not_converged),
        }
    }

    /// Collects the rates of a predicted mode on all grids in a result.
    pub(super) fn collect_result(
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

    /// Measures the rate of a mode in the solver with `cells` cells per block along each axis.
    pub(super) fn measure_mode(
        &self,
        mode: &PredictedMode,
        cells: usize,
    ) -> Result<GridResult, MeasurementError> {
        let shift = (self.medium.row_shift * cells as f64).round() as usize;
        let grid = BlockGrid {
            cells_per_block: [cells; 2],
            block_counts: mode.block_counts,
            row_shift: shift,
        };
        let spacing = self.medium.sides.map(|side| side / cells as f64);
        let frequency = mode.frequency;
        let duration =
            (TAU / frequency.re).min(MAX_DECAY_EXPONENT / frequency.im.max(f64::MIN_POSITIVE));
        // The step is in the same proportion to the cells of all grids.
        let coarsest = self.settings.cells_per_block[0];
        let speed = self.solver.media.iter().map(Medium::max_speed).fold(0.0, f64::max);
        let edge = spacing[0].min(spacing[1]) * (cells as f64 / coarsest as f64);
        let limit = 2.0 * self.settings.courant_number * edge / speed;
        let coarse_steps =
            (duration / (SAMPLE_COUNT as f64 * limit) * (1.0 - 1e-12)).ceil().max(1.0);
        let per_sample = coarse_steps as usize * cells / coarsest;
        let step = duration / (SAMPLE_COUNT * per_sample) as f64;
        let period = self.medium.blocks;
        let material_index = |index: usize| {
            let [column, row] = grid.locate_cell(index).block;
            let column = column.rem_euclid(period[0] as i64) as usize;
            column + period[0] * (row.rem_euclid(period[1] as i64) as usize)
        };
        let mut problem = Problem::new(
            Grid { cells: grid.cells_per_axis(), spacing },
            self.solver.media.clone(),
            (0..grid.cell_count()).map(|index| material_index(index) as u16).collect(),
            std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
            step,
            Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping),
        );
        problem.interlayers = grid.build_interlayers(&self.solver.laws);
        let wave = self.build_wave_state(&problem, &grid, mode);
        let amplitudes = wave.measure_amplitudes(&problem, SAMPLE_COUNT, per_sample)?;
        let measured: Vec<Complex64> = amplitudes.iter().map(|own| own.conj()).collect();
        let times: Vec<f64> =
            (0..=SAMPLE_COUNT).map(|index| (index * per_sample) as f64 * step).collect();
        let rounding = ROUNDINGS_PER_STEP * f64::EPSILON * (SAMPLE_COUNT * per_sample) as f64;
        Ok(GridResult {
            cells,
            measured_rate: fit_rate(&times, &measured),
            expected_rate: to_rate(mode.frequency),
            tolerance: max_rate_error(rounding, duration),
        })
    }

    /// Builds the initial state of a mode on a grid: cell means and face means of its polynomials.
    fn build_wave_state(
        &self,
        problem: &Problem<2>,
        grid: &BlockGrid,
        mode: &PredictedMode,
    ) -> WaveState {
        let [columns, rows] = self.medium.blocks;
        let [n1, n2] = grid.cells_per_block;
        let sampler = ModeSampler::new(self, mode, grid.cells_per_block);
        let count = columns * rows;
        let cells: Vec<CellMode> = (0..count * n1 * n2)
            .map(|index| sampler.sample_cell(index / (n1 * n2), index % (n1 * n2)))
            .collect();
        // Mean displacements at faces; indices: block, axis, end, cell along the face.
        let faces: Vec<[[Vec<[Complex64; 2]>; 2]; 2]> =
            (0..count).map(|block| sampler.sample_faces(block)).collect();
        let sides = self.medium.sides;
        let locate = |index: usize| {
            let place = grid.locate_cell(index);
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
                energy_gradient: own.energy_gradient.map(|value| value * phase),
            }
        };
        let rate = Complex64::I * mode.raw_frequency;
        let face = |own: &InterlayerFace| {
            let axis = own.axis;
            // Displacement of the mode at a face of a cell.
            let face_displacement = |index: usize, end: usize| {
                let (block, at, phase) = locate(index);
                faces[block][axis][end][at[1 - axis]].map(|value| value * phase)
            };
            // Phases of the whole grid are multiples of 2π.
            let (below, _) = grid.lower_neighbour(own.cell, axis);
            let (before, after) = (face_displacement(below, 1), face_displacement(own.cell, 0));
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

/// Evaluator of the means of a mode over the cells and faces of a block.
struct ModeSampler<'a> {
    mode: &'a PredictedMode,
    materials: &'a [BlockMaterial],
    sides: [f64; 2],
    cells: [usize; 2],
    /// Quadrature nodes and weights along edges.
    edge_nodes: Vec<[f64; 2]>,
    /// Quadrature nodes and weights along each axis of a cell.
    cell_nodes: Vec<[f64; 2]>,
}

impl<'a> ModeSampler<'a> {
    fn new(experiment: &'a CellExperiment, mode: &'a PredictedMode, cells: [usize; 2]) -> Self {
        let [edge_nodes, cell_nodes] = QUADRATURE_POINTS.map(gauss_legendre);
        let BlockyCell { materials, sides, .. } = experiment.medium;
        Self { mode, materials, sides: *sides, cells, edge_nodes, cell_nodes }
    }

    fn displacement(&self, block: usize, at: [f64; 2]) -> [Complex64; 2] {
        self.mode.model.displacement(self.mode.mode_vector.as_slice(), block, at)
    }

    /// Coordinate in [−1, 1] in the block, along an axis, of the quadrature node ξ in [−1, 1] of cell `index`.
    fn local_coordinate(&self, axis: usize, index: usize, node: f64) -> f64 {
        (index as f64 + 0.5 * (node + 1.0)) / self.cells[axis] as f64 * 2.0 - 1.0
    }

    /// Mean displacement over the edge ξ = `node` = ±1, normal to `axis`, of the cell with the indices `at`.
    fn mean_edge_displacement(
        &self,
        block: usize,
        axis: usize,
        at: [usize; 2],
        node: f64,
    ) -> [Complex64; 2] {
        let mut mean = [Complex64::ZERO; 2];
        for [other, weight] in &self.edge_nodes {
            let nodes: [f64; 2] = std::array::from_fn(|i| if i == axis { node } else { *other });
            let local = [0, 1].map(|i| self.local_coordinate(i, at[i], nodes[i]));
            let value = self.displacement(block, local);
            mean = [0, 1].map(|i| mean[i] + value[i] * *weight);
        }
        mean
    }

    /// Means of the fields of a mode over the cell of index `index` in a block.
    fn sample_cell(&self, block: usize, index: usize) -> CellMode {
        let at = [index % self.cells[0], index / self.cells[0]];
        let mut mean = [Complex64::ZERO; 2];
        for [x, first] in &self.cell_nodes {
            for [y, second] in &self.cell_nodes {
                let local =
                    [self.local_coordinate(0, at[0], *x), self.local_coordinate(1, at[1], *y)];
                let value = self.displacement(block, local);
                mean = [0, 1].map(|i| mean[i] + value[i] * (first * second));
            }
        }
        // Mean of ∂u/∂x by the divergence theorem.
        let gradient = [0, 1].map(|axis| {
            let [low, high] =
                [-1.0, 1.0].map(|node| self.mean_edge_displacement(block, axis, at, node));
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
            energy_gradient: [
                velocity[0] * density,
                velocity[1] * density,
                strain[0],
                strain[1],
                strain[2],
            ],
        }
    }

    /// Mean displacements at the faces of a block; indices: axis, end, cell along the face.
    fn sample_faces(&self, block: usize) -> [[Vec<[Complex64; 2]>; 2]; 2] {
        [0, 1].map(|axis| {
            [0, 1].map(|end| {
                let node = if end == 0 { -1.0 } else { 1.0 };
                let along = 0..self.cells[1 - axis];
                let at = |index: usize| {
                    let last = if end == 0 { 0 } else { self.cells[axis] - 1 };
                    std::array::from_fn(|i| if i == axis { last } else { index })
                };
                along
                    .map(|index| self.mean_edge_displacement(block, axis, at(index), node))
                    .collect()
            })
        })
    }
}

/// Extrapolates rates on grids, each twice as fine as the one before, to cell size h → 0: the mean of the limits for
/// errors in h and in h², since the scheme has both at layers (`extrapolate_pair`). The bound on the error of the limit
/// is half the difference of both, plus the change of the mean since the two coarser grids, plus the errors of
/// prediction and rounding; the bound on a grid also includes the distance from the limit.
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

/// Mean of the two extrapolations to cell size h → 0 from the rates c and f on grids of size h and h/2: f + (f − c) for
/// errors in h, and f + ⅓(f − c) for errors in h².
fn extrapolate_pair(coarse: Rate, fine: Rate) -> Rate {
    let extrapolate = |coarse: f64, fine: f64| fine + (fine - coarse) * (2.0 / 3.0);
    Rate {
        frequency: extrapolate(coarse.frequency, fine.frequency),
        growth_rate: extrapolate(coarse.growth_rate, fine.growth_rate),
    }
}
