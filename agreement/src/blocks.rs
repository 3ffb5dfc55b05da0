//! Bloch waves of blocky media: predicted by the analysis ([`analysis::bloch`]), measured in the solver.
//!
//! - **Chain**: layers across one axis alone, with blocks at Courant number 1, for both polarisations. The initial state
//!   is the exact eigenvector of the discrete scheme, so that measured and expected rates agree within rounding errors;
//!   the expected rate is that of [`Chain::with_time_step`](analysis::bloch::chain::Chain::with_time_step). This holds
//!   the law of the layers, all of its factors and signs, against the analysis.
//! - **Cell**: layers across both axes, with the Courant number of the case. The initial state is a mode of
//!   [`analysis::bloch::cell`]; the frequency is extrapolated from three grids.
//!
//! Layers are linearised about the initial stress-free state ([`Layer::linearise`]): waves are so weak that plastic
//! layers do not slip, and pores remain open.

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

/// Periodic blocky medium as described to the analysis: equal rectangular blocks, of which two neighbours along an axis
/// are separated by the layer of this axis.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockyCell {
    /// Sides of a block, m.
    pub sides: [f64; 2],
    /// Blocks of a period along each axis; an even number of rows if rows are shifted.
    pub blocks: [usize; 2],
    /// Shift of every second row along x₁, as a fraction of a block.
    pub row_shift: f64,
    /// Materials of the blocks of a period, row by row.
    pub materials: Vec<BlockMaterial>,
    /// Layers across each axis; `None`: welded.
    pub layers: [Option<Layer>; 2],
}

/// The same medium as described to the solver.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverBlocks {
    /// Media of the blocks of a period, row by row.
    pub media: Vec<Medium>,
    /// Laws of the layers across each axis; `None`: welded.
    pub laws: [Option<LayerLaw<f64>>; 2],
}

/// Waves to be compared, and settings of the solver.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockSettings {
    /// Number of lowest branches at each wave vector.
    pub branches: usize,
    /// Number of phase shifts of chains, in the order π/2, π/4, 3π/4, π; at most 4.
    pub phase_shifts: usize,
    /// Number of wave vectors in the plane, in the directions (1, 0), (1, 1) and (1, 2) of phase shifts; at most 3.
    pub wave_vectors: usize,
    /// Cells of a block along each axis, each number twice the one before.
    pub cells: Vec<usize>,
    /// Courant number of waves in the plane; chains run at 1.
    pub courant_number: f64,
}

/// Kind of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockWave {
    /// Wave across layers normal to one axis, the only layers.
    Chain {
        /// Axis of propagation.
        axis: usize,
        /// Polarisation.
        polarisation: ChainPolarisation,
    },
    /// Wave in the plane.
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
    /// Index of the block whose material fills a chain.
    pub block: usize,
    /// Predicted rate.
    pub predicted_rate: Rate,
    /// Measured rates, or the reason why they are missing.
    pub measurement: Result<Measurement, MeasurementError>,
}

impl BlochResult {
    /// Whether measured and expected rates agree on every grid and in the limit; `None` without measurement. Amplitudes
    /// that vanish or overflow disagree, since the solver is stable for waves that the analysis predicts.
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

    /// Order of convergence of the measured rate between the two finest grids; `None` without measurement, with one grid
    /// only, or if an error is not well above its tolerance, in the plane above that of the limit.
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
    if settings.cells.is_empty() {
        return Err(AgreementError::NoGrids);
    }
    let mut layers = [None; 2];
    for (own, layer) in layers.iter_mut().zip(predicted.layers) {
        *own =
            layer.map(|layer| layer.linearise()).transpose().map_err(AgreementError::NotLinear)?;
    }
    let chains = chain_waves(predicted, measured, layers, settings);
    let cell = CellExperiment { medium: predicted, layers, solver: measured, settings };
    let wave_vectors = match layers {
        [Some(_), Some(_)] => settings.wave_vectors.min(cell::PHASES.len()),
        _ => 0,
    };
    let grids = settings.cells.len();
    let total = chains.len() + wave_vectors * (1 + settings.branches * grids);
    let progress = TaskProgress::new(on_progress, total)?;
    let modes: Vec<Vec<PredictedMode>> = (0..wave_vectors)
        .into_par_iter()
        .map(|index| {
            let modes = cell.predict(index)?;
            progress.advance()?;
            Ok(modes)
        })
        .collect::<Result<_, AgreementError>>()?;
    let mut results: Vec<BlochResult> = chains
        .into_par_iter()
        .map(|(chain, branch, turns)| {
            let result = chain.compare(branch, turns);
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
            let found = cell.measure(&modes[mode].1, settings.cells[grid]);
            progress.advance()?;
            Ok(found)
        })
        .collect::<Result<_, AgreementError>>()?;
    for (index, (branch, mode)) in modes.iter().enumerate() {
        let place = |grid: usize| (grids - 1 - grid) * modes.len() + index;
        let own = (0..grids).map(|grid| found[place(grid)].clone()).collect();
        results.push(cell.collect(mode, *branch, own));
    }
    Ok(results)
}

/// Waves across layers normal to one axis: experiment, branch and phase shift in turns; by axis, phase shift,
/// polarisation and branch, once for each material.
fn chain_waves<'a>(
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
            for shift in chain::PHASE_SHIFTS.iter().take(settings.phase_shifts) {
                for polarisation in [ChainPolarisation::Longitudinal, ChainPolarisation::Transverse]
                {
                    for branch in 0..settings.branches.min(chain::MAX_BRANCHES) {
                        let chain = ChainExperiment {
                            axis,
                            polarisation,
                            side: predicted.sides[axis],
                            material: *material,
                            layers,
                            solver,
                            block,
                        };
                        waves.push((chain, branch, chain::turns_of_phase_shift(*shift)));
                    }
                }
            }
        }
    }
    waves
}
