//! Uniform flows: waves that the mean flow carries along, and the fastest growing wave of a perturbation on finer and
//! finer grids.

mod linearised;
mod mean_flow;
mod refinement;
mod waves;

pub use refinement::{FastestMode, Perturbation, Refinement, fastest_mode};
pub use waves::wave_results;

use crate::fit::Rate;
use crate::{AgreementError, NotMeasurable, PlaneWave};
use dynamics::flow::Problem;
use linearised::LinearisedFlow;
use models::common::elementary::Elementary;
use models::flow::Model;
use models::flow::state::{Flow, State};
use num_complex::Complex64;

/// A uniform flow v = Γx, for the analysis and for the solver.
#[derive(Clone, Debug)]
pub struct UniformFlow {
    /// The model that is linearised.
    pub model: Model,
    /// The state at the beginning, as given.
    pub state: State,
    /// The same state with everything that the model makes of it: its [`background`](Model::background).
    pub flow: Flow,
    /// The solver's problem for that flow. Box, points and tolerances are those of each measurement.
    pub solver: Problem,
}

impl UniformFlow {
    /// Rates ς (1/s) at the beginning of the modes of a wave whose wave vector moves with the flow, by descending growth.
    ///
    /// # Errors
    /// The equations do not determine them.
    pub fn initial_rates(&self, wave: &PlaneWave<2>) -> Result<Vec<Complex64>, AgreementError> {
        let modes = LinearisedFlow::new(self).moving(wave.vector())?.modes();
        Ok(modes.into_iter().map(|(rate, _)| rate).collect())
    }
}

/// A mode of a wave: it grows, decays or oscillates.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeResult {
    /// Index of its wave among those given.
    pub wave: usize,
    /// Its place among the modes of this wave, by descending growth at the beginning, from 1.
    pub mode: usize,
    /// Duration over which it was followed, s.
    pub duration: f64,
    /// By the linearised equations along k(t).
    pub predicted: Rate,
    /// By the pencil of the frozen wave vector.
    pub frozen: Rate,
    /// By the solver, or why there is no measurement.
    pub measured: Result<StepSequences, NotMeasurable>,
}

/// Rates that the solver shows in sequences of ever shorter steps.
#[derive(Clone, Debug, PartialEq)]
pub struct StepSequences {
    /// Numbers of steps, ascending, and rates.
    pub sequences: Vec<(usize, Rate)>,
    /// The limit of short steps.
    pub limit: Rate,
    /// Bound on the error of the limit: that of the extrapolation, and rounding, 1/s.
    pub tolerance: f64,
}

impl ModeResult {
    /// The scale of relative differences: the predicted rate, or the shear rate Q_D (1/s) of the mean flow where that is
    /// greater, 1/s.
    pub fn scale(&self, shear_rate: f64) -> f64 {
        self.predicted.max_norm().max(shear_rate)
    }

    /// Measured minus predicted rate; `None` where there is no measurement.
    pub fn difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| own.limit - self.predicted)
    }

    /// Whether measured and predicted rate agree; `None` where there is no measurement.
    pub fn agrees(&self) -> Option<bool> {
        let own = self.measured.as_ref().ok()?;
        Some((own.limit - self.predicted).max_norm() <= own.tolerance)
    }

    /// The order of convergence in the step; `None` where the error is rounding.
    pub fn order(&self) -> Option<f64> {
        let own = self.measured.as_ref().ok()?;
        let [(few, coarse), .., (many, fine)] = own.sequences.as_slice() else { return None };
        let [first, last] = [coarse, fine].map(|own| (*own - self.predicted).max_norm());
        (last > own.tolerance)
            .then(|| (first / last).cr_ln() / (*many as f64 / *few as f64).cr_ln())
    }
}
