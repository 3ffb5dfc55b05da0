//! Input of a measurement: a solid for analysis and solver, and a branch of a plane wave in it.

use super::{Response, SolverSettings};
use crate::scheme::Equations;
use dynamics::medium::Medium;
use models::elastoplastic::Solid;
use nalgebra::DVector;
use num_complex::Complex64;

/// Safety factor of the distance of the background from the yield surface, relative to the bound on the effect of the
/// wave.
pub(super) const MARGIN: f64 = 2.0;

/// A solid for analysis and solver.
pub(super) struct Experiment<'a, const D: usize> {
    pub(super) solid: &'a Solid,
    pub(super) medium: &'a Medium,
    pub(super) settings: &'a SolverSettings,
}

/// Branch of a plane wave to be measured.
pub(super) struct Branch<'a, const D: usize> {
    /// Index of the wave in the list of waves.
    pub(super) wave: usize,
    /// Wave number, 1/m.
    pub(super) number: f64,
    /// Wave vector, 1/m.
    pub(super) vector: [f64; D],
    pub(super) response: Response,
    pub(super) label: String,
    /// Predicted frequency, rad/s.
    pub(super) predicted: f64,
    /// Largest predicted frequency at this wave vector, rad/s.
    pub(super) greatest: f64,
    /// Frequency in `equations`, rad/s: equal to the predicted one within rounding.
    pub(super) frequency: f64,
    /// Unit amplitude in energy coordinates; `None` if `equations` have no such wave.
    pub(super) amplitude: Option<DVector<Complex64>>,
    pub(super) equations: &'a Equations<D>,
    /// [`Equations::bounds`] of the amplitude: value and rate of an active condition; 0 without amplitude.
    pub(super) bounds: [f64; 2],
}
