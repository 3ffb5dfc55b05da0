//! Errors of the search over all wave normals in space.

use super::eigenbasis::MAX_VELOCITIES;

/// Error of the search over all wave normals in space.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NormalSearchError {
    /// More velocities than the search supports.
    #[error("{0} velocities: waves in space are searched for solids with at most {MAX_VELOCITIES}")]
    TooLarge(usize),
    /// A coefficient of the solid or of the update is not finite.
    #[error("a coefficient of the solid is not finite: its numbers are too large or too small")]
    NotFinite,
    /// The length of the vectors of an update differs from the number of stresses.
    #[error("{given} components are given for {needed} stresses")]
    LengthMismatch {
        /// Number of components of the vectors of the update.
        given: usize,
        /// Number of stresses of the solid.
        needed: usize,
    },
    /// The elastic acoustic tensor is not positive definite in some direction.
    #[error(
        "the elastic solid has no waves with the normal ({}, {}, {}): its least c² is {squared_speed:e} \
         m²/s² and must be positive", normal[0], normal[1], normal[2]
    )]
    NotPositiveDefinite {
        /// The wave normal.
        normal: [f64; 3],
        /// An elastic c² in this direction that is not positive beyond rounding, m²/s²; may be NaN.
        squared_speed: f64,
    },
    /// The rate response of the yielding solid is not defined: H + n·Dm, Pa, is not positive.
    #[error("no response while yielding: H + n·Dm = {0:e} Pa must be positive")]
    NoResponse(f64),
}
