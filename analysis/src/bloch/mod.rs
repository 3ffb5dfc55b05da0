//! Bloch waves of periodic blocky media: elastic blocks separated by thin layers with mass and stiffness.
//!
//! In a periodic medium every wave is a superposition of Bloch waves u(x) = e^{i(ωt − κ·x)} p(x) with p of the period
//! of the medium (Floquet 1883, Bloch 1928; Brillouin 1946). The frequencies ω(κ) of the branches are periodic in κ
//! with the reciprocal lattice.
//!
//! - [`chain`]: waves at normal incidence on a stack of blocks and layers, by transfer matrices: exact;
//! - [`cell`]: waves of a doubly periodic medium in plane strain, by a Galerkin method with Legendre polynomials;
//! - [`zone`]: band structure on paths of the Brillouin zone, band gaps, speeds of long waves;
//! - [`bands`]: waves at a wave vector with their damping and polarisation;
//! - [`continuum`]: waves of the equivalent Cosserat continuum.
//!
//! An interlayer has no width; it has mass m per area, stiffness K and the opening mass n of [`LayerMass`]: n = 0 for
//! the box scheme (Preissmann 1961), n = ¼m for lumped masses.
//!
//! [`LayerMass`]: models::interface::opening_line::LayerMass

pub mod bands;
pub mod cell;
pub mod chain;
pub mod continuum;
mod laws;
pub mod zone;

use models::InputError;

/// Error of a computation of Bloch waves.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlochError {
    /// An input is rejected.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The time step Δt admits fewer branches than requested: frequencies are below π/Δt.
    #[error("branch {branch} does not exist: the scheme has {branches} branches up to π/Δt")]
    NoSuchBranch {
        /// Index of the branch, from 0.
        branch: usize,
        /// Number of branches of the discrete scheme.
        branches: usize,
    },
    /// Real frequencies of a chain are requested, but a layer is viscous.
    #[error("layer {element} is viscous: its waves are damped, with complex frequencies")]
    ViscousLayer {
        /// Index of the viscous layer among the elements of the chain.
        element: usize,
    },
    /// Real frequencies of a cell are requested, but a joint is viscous.
    #[error("a joint of the cell is viscous: its waves are damped, with complex frequencies")]
    ViscousJoint,
    /// An iteration did not converge.
    #[error("{iteration} did not converge")]
    NotConverged {
        /// Description of the iteration that failed.
        iteration: &'static str,
    },
}

/// Returns an [`InputError`] for the input `name` unless `is_valid`.
pub(crate) fn ensure(
    is_valid: bool,
    name: &'static str,
    value: impl std::fmt::Display,
    allowed: &str,
) -> Result<(), InputError> {
    if is_valid {
        return Ok(());
    }
    Err(InputError {
        input: name,
        rejected_value: value.to_string(),
        allowed_values: allowed.to_owned(),
    })
}
