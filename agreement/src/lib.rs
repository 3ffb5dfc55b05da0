//! The two halves held against each other: rates of plane waves that the analysis predicts, that the solvers show,
//! and that the solvers should show. It takes plain problems, and knows no case and no report.
//!
//! - **Predicted** from the linearised equations ([`analysis`]): of solids the frequencies of every branch, of flows the
//!   evolution along the wave vector k(t) that the mean flow turns and stretches.
//! - **Measured** by a solver ([`dynamics`]) that is given the wave as its initial state in a periodic box: a complex
//!   frequency fitted to the amplitudes that the solver shows ([`fit`]).
//! - **Expected** (solids): the exact symbol of the time step ([`scheme`]) gives the amplitudes that the solver must
//!   show, its discretisation error included; they are fitted and extrapolated to small cells as the measured ones are.
//!
//! Prediction and measurement share nothing but the constants that both are given. No tolerance is tuned: measured and
//! expected rates may differ by rounding, and on curved yield surfaces by what the wave turns their normal, amplified by
//! fit and extrapolation; the limit of small steps of a flow by the error of its extrapolation, and rounding. Only a
//! refinement of grids, whose perturbation is a whole of many waves, has fixed bounds
//! ([`RATE_TOLERANCE`](flows::Refinement::RATE_TOLERANCE), [`ORDER_TOLERANCE`](flows::Refinement::ORDER_TOLERANCE)).
//!
//! ```
//! use dynamics::medium::Medium;
//! use dynamics::problem::{PlasticStep, Splitting};
//! use models::solid::parameters::Isotropic;
//! use models::elastoplastic::Solid;
//! use models::solid::ElasticLaw;
//! use std::ops::ControlFlow;
//! use wellposed_agreement::PlaneWave;
//! use wellposed_agreement::solids::{SolverSettings, branch_results};
//!
//! let law = ElasticLaw::from(Isotropic::new(8.1e9, 8.1e9, 2700.0, None)?);
//! let waves = [PlaneWave { number: 2.0, normal: [0.6, 0.8, 0.0] }];
//! let settings = SolverSettings {
//!     cells: vec![12, 16],
//!     courant: 0.9,
//!     rotation: 0.5,
//!     plastic_step: PlasticStep::ReturnMapping,
//!     splitting: Splitting::Alternating,
//! };
//! let (solid, medium) = (Solid::new(law.clone(), 2, None), Medium::new(law, 2));
//! let results =
//!     branch_results(&solid, &medium, &waves, &settings, &|_, _| ControlFlow::Continue(()))?;
//! assert_eq!(results.len(), 2);
//! assert!(results.iter().all(|branch| branch.agrees() == Some(true)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`solids`] compares all branches of solids, elastic, loading and unloading; [`flows`] waves and perturbations of
//! uniform flows. Both run on the threads of the surrounding rayon pool; results do not depend on their number.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod fit;
pub mod flows;
pub mod scheme;
pub mod solids;

use models::yield_set::tangent::NoResponse;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A wave exp(ik·x) by its wave vector k = `number` × `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWave<const D: usize> {
    /// Wave number, 1/m; positive.
    pub number: f64,
    /// Unit vector.
    pub normal: [f64; D],
}

/// Why nothing can be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AgreementError {
    /// A solid cannot be put into units of energy.
    #[error("a solid without positive energy, or dependent active conditions")]
    Energy,
    /// The background of a yielding solid is not where the active conditions are.
    #[error("active conditions that no stress meets alone")]
    ActiveConditions,
    /// Some plastic multiplier is not positive.
    #[error("active conditions of which flow leaves one")]
    PlasticFlow,
    /// A yielding solid has no rate of response.
    #[error(transparent)]
    NoResponse(#[from] NoResponse),
    /// The solver's medium is of another dimension.
    #[error("a medium in {medium} dimensions for a solid in {solid}")]
    Dimensions {
        /// Of the solid.
        solid: usize,
        /// Of the medium.
        medium: usize,
    },
    /// No numbers of cells are given.
    #[error("no grids to measure on")]
    NoGrids,
    /// A run of more cell-updates than allowed.
    #[error("a wave of {updates:.1e} cell-updates at {number} 1/m")]
    TooLong {
        /// Cells times steps.
        updates: f64,
        /// The wave number, 1/m.
        number: f64,
        /// The allowed number of cell-updates.
        most: f64,
    },
    /// A constraint or the pencil of a flow is singular.
    #[error("a state in which the equations do not determine how waves evolve")]
    Undetermined,
    /// The solver does not take the flow.
    #[error(transparent)]
    Flow(#[from] dynamics::flow::FlowError),
    /// The solver does not bring a perturbation of the flow to its end.
    #[error(transparent)]
    Left(#[from] dynamics::flow::Left),
    /// A perturbation without a value at each point.
    #[error("{found:?} values of velocities and internal variable for {points:?} points")]
    Points {
        /// Numbers of values.
        found: [usize; 3],
        /// Points along each axis.
        points: [usize; 2],
    },
    /// No mode of the grid has a velocity.
    #[error("a perturbation that moves nothing on these grids")]
    NothingMoves,
    /// The callback asked to end.
    #[error("cancelled")]
    Cancelled,
}

/// Why a wave has no measurement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotMeasurable {
    /// The equations in units of energy have fewer waves than the analysis.
    #[error("the equations in units of energy have no such wave")]
    NoSuchWave,
    /// A wave that meets no yield condition but the active ones is below the rounding of the background.
    #[error("the background's stress, rounded, hides any wave that meets no other yield condition")]
    Hidden,
    /// The solver does not take the solid on this grid.
    #[error(transparent)]
    Domain(#[from] dynamics::problem::DomainError),
    /// Amplitudes of a wave in a solid vanish or overflow.
    #[error("amplitudes that vanish or are not finite")]
    Vanishing,
    /// The solver does not take the flow in the box of the wave.
    #[error("the solver does not take it: {0}")]
    Flow(#[from] dynamics::flow::FlowError),
    /// The solver does not take the wave as its initial state.
    #[error("the solver does not begin: {0}")]
    Initial(dynamics::flow::Left),
    /// The solver does not bring the wave to its end.
    #[error("the solver stops at {:.3e} s: {}", .0.time, .0)]
    Stopped(dynamics::flow::Left),
    /// Amplitudes of a wave in a flow overflow.
    #[error("amplitudes that are not finite")]
    NotFinite,
}

/// Called with the parts that are done and their number: at the beginning, and after each part, from any thread;
/// [`Break`](ControlFlow::Break) ends the work as [`AgreementError::Cancelled`].
pub type OnProgress<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// Counts the parts that are done.
struct Progress<'a> {
    on_progress: OnProgress<'a>,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Progress<'a> {
    fn begin(on_progress: OnProgress<'a>, total: usize) -> Result<Self, AgreementError> {
        let progress = Self { on_progress, done: AtomicUsize::new(0), total };
        progress.report(0)?;
        Ok(progress)
    }

    fn advance(&self) -> Result<(), AgreementError> {
        self.report(self.done.fetch_add(1, Ordering::Relaxed) + 1)
    }

    fn report(&self, done: usize) -> Result<(), AgreementError> {
        match (self.on_progress)(done, self.total) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(AgreementError::Cancelled),
        }
    }
}
