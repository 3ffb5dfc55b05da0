//! Bloch waves of blocky media: predicted by the analysis ([`analysis::bloch`]), measured in the solver.
//!
//! - **Chain**: layers across one axis alone, with blocks at Courant number 1, for both polarisations. The initial
//!   state is the exact eigenvector of the discrete scheme, so that measured and expected rates agree within rounding
//!   errors; the expected rate is that of [`Chain::with_time_step`](analysis::bloch::chain::Chain::with_time_step).
//!   This tests all factors and signs in the laws of the layers.
//! - **Cell**: layers across both axes, with the Courant number of the case. The initial state is a mode of
//!   [`analysis::bloch::cell`]; the frequency is extrapolated from three grids.
//!
//! Layers are linearised about the initial stress-free state ([`Layer::linearise`]): amplitudes of waves are so small
//! that plastic layers do not slip and pores remain open.

mod cell;
mod chain;
mod grid;
mod layer;

pub use layer::{Layer, LinearComponent, LinearLayer};

use crate::fit::Rate;
use crate::solids::{GridResult, Measurement};
use crate::{AgreementError, MeasurementError, ProgressCallback, TaskProgress};
use analysis::bloch::chain::ChainPolarisation;
use cell::{CellExperiment, PredictedMode};
use chain::ChainExperiment;
use dynamics::medium::Medium;
use models::common::elementary::Elementary;
use models::interface::homogenised::BlockMaterial;
use models::interface::layer::LayerLaw;
use rayon::prelude::*;

/// Periodic blocky medium as the analysis describes it: equal rectangular blocks; the layer of an axis separates each
/// two neighbours along this axis.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockyCell {
    /// Sides of a block, m.
    pub sides: [f64; 2],
    /// Numbers of blocks of a period along each axis; an even number of rows if rows are shifted.
    pub blocks: [usize; 2],
    /// Shift of every second row along x₁, as a fraction of a block.
    pub row_shift: f64,
    /// Materials of the blocks of a period, row by row.
    pub materials: Vec<BlockMaterial>,
    /// Layers normal to each axis; `None` if blocks are welded along this axis.
    pub layers: [Option<Layer>; 2],
}

/// Periodic blocky medium as the solver describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverBlocks {
    /// Media of the blocks of a period, row by row.
    pub media: Vec<Medium>,
    /// Laws of the layers normal to each axis; `None` if blocks are welded along this axis.
    pub laws: [Option<LayerLaw<f64>>; 2],
}

/// Numbers of the Bloch waves to be compared, and settings of the solver.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockSettings {
    /// Number of lowest branches at each wave vector.
    pub branch_count: usize,
    /// Number of phase shifts of chains, in the order π/2, π/4, 3π/4, π; at most 4.
    pub phase_shift_count: usize,
    /// Number of wave vectors in the plane, in the directions (1, 0), (1, 1) and (1, 2) of phase shifts; at most 3.
    pub wave_vector_count: usize,
    /// Numbers of cells of a block along each axis, by grid; each twice the one before.
    pub cells_per_block: Vec<usize>,
    /// Courant number of waves in the plane; that of chains is 1.
    pub courant_number: f64,
}

/// Kind of a compared Bloch wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockWave {
    /// Wave along an axis in a chain of blocks and the layers normal to this axis.
    Chain {
        /// Axis of propagation.
        axis: usize,
        /// Polarisation.
        polarisation: ChainPolarisation,
    },
    /// Wave in a medium with layers normal to both axes.
    Cell,
}

/// Predicted and measured rate of a Bloch wave.
#[derive(Clone, Debug, PartialEq)]
pub struct BlochResult {
    /// Kind of wave.
    pub wave: BlockWave,
    /// Wave vector κ, 1/m.
    pub wave_vector: [f64; 2],
    /// Index of the branch, from 0.
    pub branch: usize,
    /// Index of the block whose material all blocks of a chain have; 0 for waves in the plane.
    pub block: usize,
    /// Rate predicted by the analysis.
    pub predicted_rate: Rate,
    /// Measured rates, or the reason why they are missing.
    pub measurement: Result<Measurement, MeasurementError>,
}

impl BlochResult {
    /// Whether measured and expected rates agree on every grid and in the limit; `None` without measurement. Vanishing
    /// and overflowing amplitudes count as disagreement, since the analysis predicts stable waves.
    pub fn is_within_tolerance(&self) -> Option<bool> {
        match &self.measurement {
            Ok(own) => {
                Some(own.grids.iter().chain([&own.limit]).all(GridResult::is_within_tolerance))
            }
            Err(MeasurementError::VanishingAmplitude) => Some(false),
            Err(_) => None,
        }
    }

    /// Difference of a rate from the predicted one, relative to the predicted frequency.
    pub fn relative_difference(&self, rate: Rate) -> Rate {
        let difference = rate - self.predicted_rate;
        let frequency = self.predicted_rate.frequency;
        Rate {
            frequency: difference.frequency / frequency,
            growth_rate: difference.growth_rate / frequency,
        }
    }

    /// Order of convergence of the measured rate between the two finest grids; `None` without measurement, with one
    /// grid only, or if an error is not well above its tolerance (in the plane, above that of the limit).
    pub fn convergence_order(&self) -> Option<f64> {
        let own = self.measurement.as_ref().ok()?;
        let [.., coarse, fine] = own.grids.as_slice() else { return None };
        let floor = match self.wave {
            BlockWave::Chain { .. } => 10.0 * coarse.tolerance.max(fine.tolerance),
            BlockWave::Cell => own.limit.tolerance,
        };
        let error = |grid: &GridResult| (grid.measured_rate - self.predicted_rate).max_norm();
        let ratio = fine.cells as f64 / coarse.cells as f64;
        (error(coarse).min(error(fine)) > floor)
            .then(|| (error(coarse) / error(fine)).cr_ln() / ratio.cr_ln())
    }
}

/// Predicts Bloch waves of a blocky medium and measures them in the solver's description of the same medium.
///
/// # Errors
/// A layer has no linear state, no grids are given, or the progress callback cancels the comparison.
pub fn compare_blocks(
    predicted: &BlockyCell,
    measured: &SolverBlocks,
    settings: &BlockSettings,
    on_progress: ProgressCallback,
) -> Result<Vec<BlochResult>, AgreementError> {
    if settings.cells_per_block.is_empty() {
        return Err(AgreementError::NoGrids);
    }
    let mut layers = [None; 2];
    for (own, layer) in layers.iter_mut().zip(predicted.layers) {
        *own =
            layer.map(|layer| layer.linearise()).transpose().map_err(AgreementError::NotLinear)?;
    }
    let chains = list_chain_waves(predicted, measured, layers, settings);
    let cell = CellExperiment { medium: predicted, layers, solver: measured, settings };
    let wave_vectors = match layers {
        [Some(_), Some(_)] => settings.wave_vector_count.min(cell::PLANE_PHASE_SHIFTS.len()),
        _ => 0,
    };
    let grids = settings.cells_per_block.len();
    let total = chains.len() + wave_vectors * (1 + settings.branch_count * grids);
    let progress = TaskProgress::new(on_progress, total)?;
    let modes: Vec<Vec<PredictedMode>> = (0..wave_vectors)
        .into_par_iter()
        .map(|index| {
            let modes = cell.predict_modes(index)?;
            progress.advance()?;
            Ok(modes)
        })
        .collect::<Result<_, AgreementError>>()?;
    let mut results: Vec<BlochResult> = chains
        .into_par_iter()
        .map(|(chain, branch, phase_index)| {
            let result = chain.compare_branch(branch, phase_index);
            progress.advance()?;
            Ok(result)
        })
        .collect::<Result<_, AgreementError>>()?;
    let modes: Vec<(usize, PredictedMode)> =
        modes.into_iter().flat_map(|own| own.into_iter().enumerate()).collect();
    // Finest grids first: they take longest.
    let runs: Vec<(usize, usize)> =
        (0..grids).rev().flat_map(|grid| (0..modes.len()).map(move |mode| (mode, grid))).collect();
    let found: Vec<Result<GridResult, MeasurementError>> = runs
        .par_iter()
        .map(|&(mode, grid)| {
            let found = cell.measure_mode(&modes[mode].1, settings.cells_per_block[grid]);
            progress.advance()?;
            Ok(found)
        })
        .collect::<Result<_, AgreementError>>()?;
    for (index, (branch, mode)) in modes.iter().enumerate() {
        let run_index = |grid: usize| (grids - 1 - grid) * modes.len() + index;
        let own = (0..grids).map(|grid| found[run_index(grid)].clone()).collect();
        results.push(cell.collect_result(mode, *branch, own));
    }
    Ok(results)
}

/// Lists the waves across layers normal to one axis, for each material, axis, phase shift, polarisation and branch:
/// experiment, index of the branch, and index of the phase shift.
fn list_chain_waves<'a>(
    predicted: &BlockyCell,
    solver: &'a SolverBlocks,
    layers: [Option<LinearLayer>; 2],
    settings: &BlockSettings,
) -> Vec<(ChainExperiment<'a>, usize, usize)> {
    let mut waves = Vec::new();
    for (block, material) in predicted.materials.iter().enumerate() {
        if predicted.materials[..block].contains(material) {
            continue;
        }
        for axis in (0..2).filter(|axis| layers[*axis].is_some()) {
            for shift in chain::PHASE_SHIFTS.iter().take(settings.phase_shift_count) {
                for polarisation in [ChainPolarisation::Longitudinal, ChainPolarisation::Transverse]
                {
                    for branch in 0..settings.branch_count.min(chain::MAX_BRANCHES) {
                        let chain = ChainExperiment {
                            axis,
                            polarisation,
                            side: predicted.sides[axis],
                            material: *material,
                            layers,
                            solver,
                            block,
                        };
                        waves.push((chain, branch, chain::nearest_phase_index(*shift)));
                    }
                }
            }
        }
    }
    waves
}
