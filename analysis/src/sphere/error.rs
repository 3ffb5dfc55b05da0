//! Errors of the search.

use super::eigenbasis::SIZE;

/// An elastic solid, or a change of its stiffness, that cannot be searched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SphereError {
    /// Too many velocities.
    #[error("{0} velocities: waves in space are searched for solids with at most {SIZE}")]
    TooLarge(usize),
    /// A number overflowed.
    #[error("a coefficient of the solid is not finite: its numbers are too large or too small")]
    NotFinite,
    /// Vectors and stiffness do not belong together.
    #[error("{given} components are given for {needed} stresses")]
    Mismatch {
        /// Components given.
        given: usize,
        /// Stresses of the solid.
        needed: usize,
    },
    /// The elastic stiffness does not make waves of every direction and polarisation.
    #[error(
        "the elastic solid has no waves with the normal ({}, {}, {}): its least c² is {speed_squared:e} \
         m²/s² and must be positive", normal[0], normal[1], normal[2]
    )]
    NotElastic {
        /// The wave normal.
        normal: [f64; 3],
        /// Least c², m²/s².
        speed_squared: f64,
    },
    /// The solid has no rate of response while it yields.
    #[error("no response while yielding: H + n·Dm = {0:e} Pa must be positive")]
    NoResponse(f64),
}
