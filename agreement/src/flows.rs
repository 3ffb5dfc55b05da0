//! Comparison for uniform flows: Kelvin waves advected by the mean flow, and the fastest growing wave of a perturbation
//! under grid refinement.

mod linearised;
mod mean_flow;
mod refinement;
mod waves;

pub use refinement::{FastestMode, GridRefinement, Perturbation, compare_fastest_mode};
pub use waves::compare_waves;

use crate::fit::Rate;
use crate::{AgreementError, MeasurementError, PlaneWave};
use dynamics::flow::FlowProblem;
use linearised::LinearisedFlow;
use models::common::elementary::Elementary;
use models::flow::Model;
use models::flow::state::{DeformingFlow, MaterialState};
use num_complex::Complex64;

/// A uniform flow v = Γx with velocity gradient Γ (1/s), as described to the analysis and to the solver.
#[derive(Clone, Debug)]
pub struct UniformFlow {
    /// Model whose linearised equations the analysis uses.
    pub model: Model,
    /// Initial state, as given.
    pub state: MaterialState,
    /// Initial state completed by the model ([`background`](Model::background)).
    pub flow: DeformingFlow,
    /// Solver problem of the flow; each measurement replaces box, points and tolerances.
    pub solver_problem: FlowProblem,
}

impl UniformFlow {
    /// Initial rates ς (1/s) of the modes of a wave advected by the flow, by descending growth.
    ///
    /// # Errors
    /// The equations do not determine the evolution.
    pub fn initial_rates(&self, wave: &PlaneWave<2>) -> Result<Vec<Complex64>, AgreementError> {
        let modes =
            LinearisedFlow::new(self).linearise_moving_evolution(wave.to_wave_vector())?.modes();
        Ok(modes.into_iter().map(|(rate, _)| rate).collect())
    }
}

/// Predicted and measured rate of one mode of a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeResult {
    /// Index of the wave in the list of waves.
    pub wave_index: usize,
    /// Number of the mode by descending initial growth, starting at 1.
    pub mode_number: usize,
    /// Duration of the measurement, s.
    pub duration: f64,
    /// Rate predicted by the linearised equations along the wave vector k(t), which the mean flow advects.
    pub predicted_rate: Rate,
    /// Rate predicted by the pencil of the frozen wave vector.
    pub frozen_rate: Rate,
    /// Rate measured in the solver, or the reason why it is missing.
    pub measurement: Result<TimeStepRefinement, MeasurementError>,
}

/// Rates measured in the solver for a sequence of decreasing time steps.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeStepRefinement {
    /// Number of steps, ascending, and the rate measured with it (1/s).
    pub rates_by_steps: Vec<(usize, Rate)>,
    /// Rate extrapolated to zero time step, 1/s.
    pub limit: Rate,
    /// Tolerance of the limit, 1/s: estimated error of the extrapolation plus a bound on rounding errors and on the
    /// nonlinear self-interaction of the wave.
    pub tolerance: f64,
}

impl ModeResult {
    /// Scale of relative differences, 1/s: the larger of the norm of the predicted rate and the shear rate Q_D of the
    /// mean flow, `shear_rate` (1/s).
    pub fn rate_scale(&self, shear_rate: f64) -> f64 {
        self.predicted_rate.max_norm().max(shear_rate)
    }

    /// Measured minus predicted rate; `None` without measurement.
    pub fn rate_difference(&self) -> Option<Rate> {
        self.measurement.as_ref().ok().map(|own| own.limit - self.predicted_rate)
    }

    /// Whether measured and predicted rate agree within the tolerance; `None` without measurement.
    pub fn is_within_tolerance(&self) -> Option<bool> {
        let own = self.measurement.as_ref().ok()?;
        Some((own.limit - self.predicted_rate).max_norm() <= own.tolerance)
    }

    /// Order of convergence in the time step, from the differences between measured and predicted rate at the largest
    /// and at the smallest step; `None` without measurement, or if the difference at the smallest step is within the
    /// tolerance.
    pub fn convergence_order(&self) -> Option<f64> {
        let own = self.measurement.as_ref().ok()?;
        let [(few, coarse), .., (many, fine)] = own.rates_by_steps.as_slice() else { return None };
        let [first, last] = [coarse, fine].map(|own| (*own - self.predicted_rate).max_norm());
        (last > own.tolerance)
            .then(|| (first / last).cr_ln() / (*many as f64 / *few as f64).cr_ln())
    }
}
