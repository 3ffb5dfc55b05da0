//! What is measured: a solid for both halves, and a branch of a wave in it.

use super::{Response, SolverSettings};
use crate::scheme::Equations;
use dynamics::medium::Medium;
use models::elastoplastic::Solid;
use nalgebra::DVector;
use num_complex::Complex64;

/// Distance of the background from where the wave could take it back over the yield surface, over the greatest
/// effect of a wave of its energy.
pub(super) const MARGIN: f64 = 2.0;

/// A solid for the analysis and for the solver.
pub(super) struct Experiment<'a, const D: usize> {
    pub(super) solid: &'a Solid,
    pub(super) medium: &'a Medium,
    pub(super) settings: &'a SolverSettings,
}

/// A wave to be measured.
pub(super) struct Branch<'a, const D: usize> {
    /// Index of the wave among those given.
    pub(super) wave: usize,
    /// 1/m.
    pub(super) number: f64,
    /// Wave vector, 1/m.
    pub(super) vector: [f64; D],
    pub(super) response: Response,
    pub(super) label: String,
    /// rad/s.
    pub(super) predicted: f64,
    /// The greatest predicted frequency at this wave vector, rad/s.
    pub(super) greatest: f64,
    /// The frequency in `equations`, rad/s: the predicted one but for rounding.
    pub(super) frequency: f64,
    /// In units of energy.
    pub(super) amplitude: Option<DVector<Complex64>>,
    pub(super) equations: &'a Equations<D>,
    /// [`Equations::bounds`] of the amplitude; 0 where nothing yields.
    pub(super) bounds: [f64; 2],
}
