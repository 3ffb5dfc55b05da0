//! From a linearised system to its roots, characteristics, growth and verdict.
//!
//! The engine works on [`models::LinearisedSystem`] as data and knows no model:
//!
//! - [`scaling`]: units in which all coefficients are of comparable size;
//! - [`polynomial`]: the exact dispersion polynomial det(ςA + κ₁B¹ + κ₂B² + C), κ = ik;
//! - [`pencil`]: the roots ς at a given wave, by generalised eigenvalues and that polynomial;
//! - [`characteristics`]: characteristic directions of the steady equations;
//! - [`qz`], [`roots`], [`extended`]: small generalised eigenproblems, zeros of polynomials, twice the
//!   working precision;
//! - [`form`], [`newton`]: zeros of homogeneous forms in the direction, orders of growth;
//! - [`growth`]: how fast short waves grow, in every direction: the verdict;
//! - [`bound`]: the supremum of the growth rate, where it is finite;
//! - [`circle`], [`sphere`]: flutter and shear bands of a yielding solid over all directions in the plane
//!   and in space;
//! - [`energy`]: what the symmetriser of a solid's equations shows;
//! - [`kelvin`]: waves that a homogeneous flow carries along;
//! - [`waves`]: speeds, dispersion curves and forbidden bands of solids.
//!
//! On top of it stand the assessments of what [`models`] describes: [`flows`] and [`solids`].
//!
//! It knows no solver in time, no case and no file: what solvers show is held against it elsewhere.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod bound;
pub mod characteristics;
pub mod circle;
mod dense;
pub mod energy;
pub mod extended;
mod face;
pub mod flows;
pub mod form;
pub mod growth;
pub mod kelvin;
mod layers;
mod leading;
pub mod list;
pub mod newton;
pub mod pencil;
pub mod polynomial;
mod puiseux;
pub mod qz;
pub mod roots;
pub mod scaling;
mod search;
pub mod solids;
pub mod sphere;
mod value;
pub mod waves;
mod worst;

use models::InputError;
use models::yield_set::tangent::NoResponse;
use sphere::SphereError;

/// A system that cannot be analysed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// Some coefficient overflowed.
    #[error(
        "a coefficient of the linearised equations is not finite (equation \"{equation}\"): the \
         numbers of the case are too large or too small"
    )]
    NotFinite {
        /// The equation it stands in.
        equation: &'static str,
    },
    /// Too many equations for the exact polynomial.
    #[error("{0} equations: the exact dispersion polynomial takes at most {max}", max = polynomial::MAX_SIZE)]
    TooLarge(usize),
}

/// A state that cannot be assessed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateError {
    /// The model does not take it.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Its linearised equations cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A yielding solid has no rate of response.
    #[error(transparent)]
    NoResponse(#[from] NoResponse),
    /// A solid in space cannot be searched.
    #[error(transparent)]
    Sphere(#[from] SphereError),
}
