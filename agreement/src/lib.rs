//! Agreement of analysis and solvers: rates of plane waves predicted by the analysis, measured in the time-domain
//! solvers, and expected from the discretisation. The input is independent of case files and reports.
//!
//! - **Predicted** from the linearised equations ([`analysis`]): for solids the frequencies of every branch, for
//!   flows the evolution along the wave vector k(t), which is rotated and stretched by the mean flow.
//! - **Measured** in a solver ([`dynamics`]) with the wave as initial state in a periodic box: a complex frequency is
//!   fitted to the amplitudes ([`fit`]).
//! - **Expected** (solids): the exact symbol of the time step ([`scheme`]) gives the amplitudes including the
//!   discretisation error; they are fitted and extrapolated to zero cell size like the measured amplitudes.
//!
//! Prediction and measurement share only the parameters of the problem. No tolerance is tuned. Measured and expected
//! rates may differ by rounding errors, and on curved yield surfaces by the rotation of the normal in the wave,
//! amplified by fit and extrapolation; the zero-step limit of a flow may differ by the extrapolation error and
//! rounding errors. Only grid refinement, whose perturbation consists of many waves, has fixed bounds
//! ([`RATE_TOLERANCE`](flows::GridRefinement::RATE_TOLERANCE),
//! [`ORDER_TOLERANCE`](flows::GridRefinement::ORDER_TOLERANCE)).
//!
//! ```
//! use dynamics::medium::Medium;
//! use dynamics::problem::{PlasticStep, Splitting};
//! use models::solid::parameters::Isotropic;
//! use models::elastoplastic::Solid;
//! use models::solid::ElasticLaw;
//! use std::ops::ControlFlow;
//! use wellposed_agreement::PlaneWave;
//! use wellposed_agreement::solids::{SolverSettings, compare_branches};
//!
//! let law = ElasticLaw::from(Isotropic::new(8.1e9, 8.1e9, 2700.0, None)?);
//! let waves = [PlaneWave { wave_number: 2.0, normal: [0.6, 0.8, 0.0] }];
//! let settings = SolverSettings {
//!     cells_per_wavelength: vec![12, 16],
//!     courant_number: 0.9,
//!     max_rotation: 0.5,
//!     plastic_step: PlasticStep::ReturnMapping,
//!     splitting: Splitting::Alternating,
//! };
//! let (solid, medium) = (Solid::new(law.clone(), 2, None), Medium::new(law, 2));
//! let results =
//!     compare_branches(&solid, &medium, &waves, &settings, &|_, _| ControlFlow::Continue(()))?;
//! assert_eq!(results.len(), 2);
//! assert!(results.iter().all(|branch| branch.is_within_tolerance() == Some(true)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`solids`] compares all branches of solids (elastic, loading and unloading), [`blocks`] Bloch waves of blocky media,
//! [`flows`] waves and perturbations of uniform flows, [`equations`] the linearised equations of models given as text with
//! differences of the equations themselves. All use the threads of the current rayon pool; results do not
//! depend on their number.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod blocks;
pub mod equations;
pub mod fit;
pub mod flows;
pub mod scheme;
pub mod shocks;
pub mod solids;

use models::common::decimal::format_exact;
use models::yield_set::tangent::NoResponse;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A plane wave exp(ik·x) by its wave vector k = `wave_number` × `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWave<const D: usize> {
    /// Wave number, 1/m; positive.
    pub wave_number: f64,
    /// Unit vector in the direction of the wave vector.
    pub normal: [f64; D],
}

/// Error of a comparison.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AgreementError {
    /// The energy of the solid is not positive definite, or the normals of its active conditions are linearly
    /// dependent.
    #[error("a solid without positive energy, or dependent active conditions")]
    IndefiniteEnergy,
    /// The background stress does not satisfy the active yield conditions with equality.
    #[error(
        "active conditions that no stress satisfies with equality without violating another condition"
    )]
    UnattainableConditions,
    /// Flow satisfying the active conditions has a plastic multiplier that is not positive.
    #[error(
        "active conditions of which plastic flow unloads one (its plastic multiplier is not positive)"
    )]
    NonPositiveMultiplier,
    /// The rate response of the yielding solid is not defined.
    #[error(transparent)]
    NoResponse(#[from] NoResponse),
    /// Solid and solver medium have different dimensions.
    #[error("a medium in {medium} dimensions for a solid in {solid}")]
    DimensionMismatch {
        /// Number of space dimensions of the solid.
        solid: usize,
        /// Number of space dimensions of the medium.
        medium: usize,
    },
    /// The list of cells per wavelength is empty.
    #[error("no grids to measure on")]
    NoGrids,
    /// A simulation exceeds the allowed number of cell updates.
    #[error("a wave of {updates:.1e} cell-updates at {} 1/m", format_exact(*.wave_number))]
    TooManyCellUpdates {
        /// Number of cell updates: cells times steps.
        updates: f64,
        /// The wave number, 1/m.
        wave_number: f64,
        /// Allowed number of cell updates.
        max_updates: f64,
    },
    /// The evolution of a wave is not determined: the constraint or the matrix pencil of the flow is singular, or the
    /// mean flow is no longer fully deforming.
    #[error("a state in which the equations do not determine how waves evolve")]
    SingularEquations,
    /// The solver rejects the flow.
    #[error(transparent)]
    Flow(#[from] dynamics::flow::FlowError),
    /// The solver stops before the end time of a perturbation.
    #[error(transparent)]
    SolverStopped(#[from] dynamics::flow::LeftDomain),
    /// A field of the perturbation does not have one value per point.
    #[error("{found:?} values of velocities and internal variable for {points:?} points")]
    PointCount {
        /// Numbers of values of the two velocity components and of the internal variable.
        found: [usize; 3],
        /// Points along each axis.
        points: [usize; 2],
    },
    /// No Fourier mode of the perturbation has a non-zero velocity.
    #[error("a perturbation that moves nothing on these grids")]
    NoVelocity,
    /// The analysis of a blocky medium fails.
    #[error(transparent)]
    Bloch(#[from] analysis::bloch::BlochError),
    /// A layer between blocks is not linear about its initial state.
    #[error("{0}")]
    NotLinear(&'static str),
    /// Cancelled by the progress callback.
    #[error("cancelled")]
    Cancelled,
}

/// Reason why a wave has no measurement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasurementError {
    /// The equations in energy coordinates have fewer propagating waves than the analysis predicts.
    #[error("the equations in units of energy have no such wave")]
    MissingWave,
    /// An amplitude small enough to activate no further yield condition is below the rounding of the background.
    #[error("the background's stress, rounded, hides any wave that meets no other yield condition")]
    BelowRounding,
    /// The solver rejects the solid on this grid.
    #[error(transparent)]
    Domain(#[from] dynamics::problem::DomainError),
    /// The analysis finds no such Bloch wave.
    #[error("the analysis: {0}")]
    Bloch(#[from] analysis::bloch::BlochError),
    /// A simulation exceeds the allowed number of cell updates.
    #[error("{updates:.1e} cell-updates, more than {max_updates:.0e}")]
    TooManyUpdates {
        /// Number of cell updates: cells times steps.
        updates: f64,
        /// Allowed number of cell updates.
        max_updates: f64,
    },
    /// Amplitudes of a wave in a solid vanish, overflow or are NaN.
    #[error("amplitudes that vanish or are not finite")]
    VanishingAmplitude,
    /// The solver rejects the flow in the box of the wave.
    #[error("the solver does not take it: {0}")]
    Flow(#[from] dynamics::flow::FlowError),
    /// The solver rejects the wave as initial state.
    #[error("the solver does not begin: {0}")]
    InitialState(dynamics::flow::LeftDomain),
    /// The solver stops before the end of the measurement.
    #[error("the solver stops at {:.3e} s: {}", .0.time, .0)]
    SolverStopped(dynamics::flow::LeftDomain),
    /// Amplitudes of a wave in a flow overflow or are NaN.
    #[error("amplitudes that are not finite")]
    NonFiniteAmplitude,
}

/// Progress callback, called with (tasks done, total tasks) at the beginning and after each task, from any thread;
/// [`Break`](ControlFlow::Break) ends the work with [`AgreementError::Cancelled`].
pub type ProgressCallback<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// Counter of finished tasks that reports each to the progress callback.
struct TaskProgress<'a> {
    on_progress: ProgressCallback<'a>,
    finished_tasks: AtomicUsize,
    total_tasks: usize,
}

impl<'a> TaskProgress<'a> {
    fn new(on_progress: ProgressCallback<'a>, total: usize) -> Result<Self, AgreementError> {
        let progress =
            Self { on_progress, finished_tasks: AtomicUsize::new(0), total_tasks: total };
        progress.report(0)?;
        Ok(progress)
    }

    fn advance(&self) -> Result<(), AgreementError> {
        self.report(self.finished_tasks.fetch_add(1, Ordering::Relaxed) + 1)
    }

    fn report(&self, done: usize) -> Result<(), AgreementError> {
        match (self.on_progress)(done, self.total_tasks) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(AgreementError::Cancelled),
        }
    }
}
