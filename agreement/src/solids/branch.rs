//! Input of a measurement: a solid for analysis and solver, and a branch of a plane wave in it.

use super::{SolverSettings, WaveResponse};
use crate::scheme::EnergyForm;
use dynamics::medium::Medium;
use models::elastoplastic::Solid;
use nalgebra::DVector;
use num_complex::Complex64;

/// Safety factor of the distance of the background from the yield surface (unloading) and of the loading rate of the
/// background (loading), relative to the bounds on the effect of the wave.
pub(super) const SAFETY_FACTOR: f64 = 2.0;

/// A solid as described to the analysis and to the solver, with the solver settings.
pub(super) struct SolidExperiment<'a, const D: usize> {
    pub(super) solid: &'a Solid,
    pub(super) medium: &'a Medium,
    pub(super) settings: &'a SolverSettings,
}

/// Branch of a plane wave to be measured.
pub(super) struct PredictedBranch<'a, const D: usize> {
    /// Index of the wave in the list of waves.
    pub(super) wave_index: usize,
    /// Wave number, 1/m.
    pub(super) wave_number: f64,
    /// Wave vector, 1/m.
    pub(super) wave_vector: [f64; D],
    pub(super) response: WaveResponse,
    pub(super) label: String,
    /// Predicted frequency, rad/s.
    pub(super) predicted_frequency: f64,
    /// Largest predicted frequency at this wave vector, rad/s.
    pub(super) max_frequency: f64,
    /// Frequency in the energy form, rad/s: equal to the predicted one within rounding.
    pub(super) energy_form_frequency: f64,
    /// Unit amplitude in energy coordinates; `None` if the energy form has no such wave.
    pub(super) amplitude: Option<DVector<Complex64>>,
    pub(super) energy_form: &'a EnergyForm<D>,
    /// [`EnergyForm::bounds`] of the amplitude: value and rate of an active condition; 0 without amplitude.
    pub(super) bounds: [f64; 2],
}
