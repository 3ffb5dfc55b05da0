//! Well-posedness analysis: from a linearised system to its dispersion roots, characteristics, growth and verdict.
//!
//! Entry points are [`flows::FlowWorkspace`], [`solids::SolidAssessor`] and [`equations::EquationsWorkspace`]; programs call these. All other
//! modules are their algorithms. The analysis takes a [`models::LinearisedSystem`] as data and is independent of the
//! model:
//!
//! - [`scaling`]: units in which all coefficients are of comparable size;
//! - [`polynomial`]: the exact dispersion polynomial det(ςA + κ₁B¹ + κ₂B² + C), κ = ik;
//! - [`pencil`]: the roots ς at a given wave, by generalised eigenvalues and that polynomial;
//! - [`characteristics`]: characteristic directions of the steady equations;
//! - [`qz`], [`roots`], [`extended_precision`]: generalised eigenvalues of small pencils by the QZ algorithm, zeros of
//!   polynomials by Aberth's method, double-double arithmetic;
//! - [`form`], [`newton_polygon`]: zeros of binary forms in the direction, Newton polygons and orders of growth;
//! - [`growth`]: verdict by the Newton polygon, with Puiseux series in the layers around degenerate directions;
//! - [`mod@line`], [`space`]: the verdict in one and in three dimensions;
//! - [`certified`]: verdicts proved for all states of a box of two parameters;
//! - [`bound`]: the supremum of the growth rate, where it is finite;
//! - [`acoustic_tensor2`], [`acoustic_tensor3`]: acoustic tensor of a yielding solid over all directions in the plane
//!   and in space: flutter and shear bands;
//! - [`energy`]: symmetriser and energy conservation of the equations of a solid;
//! - [`kelvin`]: Kelvin waves, advected by a homogeneous flow;
//! - [`waves`]: speeds, dispersion curves and band gaps of solids;
//! - [`bloch`]: Bloch waves of blocky media: dispersion, band gaps, speeds of long waves;
//! - [`plane_shocks`]: exact plane waves behind a piston, for piecewise-linear diagrams.
//!
//! [`flows`] and [`solids`] assess the media of [`models`] with these tools, [`equations`] models given as text.
//!
//! The crate depends on no time-domain solver, case or file format; crate `agreement` compares solvers with it.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod acoustic_tensor2;
pub mod acoustic_tensor3;
pub mod bloch;
pub mod bound;
mod brute_force;
pub mod certified;
pub mod characteristics;
mod corner_factors;
mod dense;
pub mod direction_polynomial;
pub mod energy;
pub mod equations;
pub mod extended_precision;
mod face_polynomial;
mod finite_wave_number;
pub mod flows;
pub mod form;
pub mod growth;
mod growth_accumulator;
pub mod kelvin;
mod layers;
pub mod line;
mod line_search;
pub mod list;
pub mod newton_polygon;
pub mod pencil;
pub mod plane_shocks;
pub mod polynomial;
mod puiseux;
pub mod qz;
mod root_collisions;
pub mod roots;
mod rounded_complex;
pub mod scaling;
pub mod solids;
pub mod space;
pub mod waves;

use acoustic_tensor3::NormalSearchError;
use models::InputError;
use models::equations::EvaluationError;
use models::yield_set::tangent::NoResponse;

/// A system that cannot be analysed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// A coefficient is not finite.
    #[error(
        "a coefficient of the linearised equations is not finite (equation \"{equation}\"): the \
         numbers of the case are too large or too small"
    )]
    NotFinite {
        /// Equation of the coefficient.
        equation: &'static str,
    },
    /// Too many equations for the exact polynomial.
    #[error("{0} equations: the exact dispersion polynomial takes at most {max}", max = polynomial::MAX_EQUATIONS)]
    TooLarge(usize),
}

/// Error of assessing a state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateError {
    /// The model rejects the state.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The linearised equations cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A model given as equations is not defined at the state, or the state does not satisfy the equations.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// The rate response of a yielding solid is not defined.
    #[error(transparent)]
    NoResponse(#[from] NoResponse),
    /// The search over all directions in space failed.
    #[error(transparent)]
    NormalSearch(#[from] NormalSearchError),
}
