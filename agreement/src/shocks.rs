//! Plane waves in granular and porous media: fronts, plateaus and dissipation of the exact solution against those of the
//! time-domain solver, in a column of cells.
//!
//! The exact solution ([`analysis::plane_shocks`]) knows the uniaxial diagram and the jump conditions; the solver knows
//! the laws of tensors and the Riemann problems at faces. They share the constants of the medium only.
//!
//! A shock of the solver is a few cells wide, whatever their number, so that the errors are of first order in the cell
//! size. [`Tolerances`] are those on 2000 cells or more; on n < 2000 cells they are 2000/n times as large.

mod column;
mod piston;
mod spall;

pub use piston::{PistonColumn, compare_piston};
pub use spall::{SpallColumn, compare_spall};

/// Relative tolerances on a column of a number of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Of the speed of a wave.
    pub speed: f64,
    /// Of velocity, pressure and volumetric strain between two waves.
    pub plateau: f64,
    /// Of the energy dissipated.
    pub dissipation: f64,
    /// Of the mean error of a profile: a displacement of all fronts and an error of all plateaus.
    pub profile: f64,
}

impl Tolerances {
    /// Number of cells from which on the tolerances do not depend on it.
    pub const REFERENCE_CELLS: usize = 2000;

    /// Returns the tolerances on a column of `cells` cells.
    pub fn new(cells: usize) -> Self {
        let factor = (Self::REFERENCE_CELLS as f64 / cells as f64).max(1.0);
        let [speed, plateau, dissipation] = [0.003, 0.015, 0.02].map(|own| own * factor);
        Self { speed, plateau, dissipation, profile: speed + plateau }
    }
}

/// Comparison of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct ShockResult {
    /// Name of the quantity.
    pub quantity: String,
    /// Unit; empty for a quantity without dimension.
    pub unit: &'static str,
    /// Value of the exact solution.
    pub predicted: f64,
    /// Value of the solver, or the reason why it cannot be measured.
    pub measured: Result<f64, String>,
    /// Magnitude to which the difference is related.
    pub scale: f64,
    /// Tolerance of the relative difference.
    pub tolerance: f64,
}

impl ShockResult {
    /// Returns measured minus predicted value, relative to the scale.
    pub fn relative_difference(&self) -> Option<f64> {
        let measured = self.measured.as_ref().ok()?;
        Some((measured - self.predicted) / self.scale)
    }

    /// Returns whether the difference is within the tolerance; `None` without measurement.
    pub fn is_within_tolerance(&self) -> Option<bool> {
        Some(self.relative_difference()?.abs() <= self.tolerance)
    }
}

/// Results on a column of a number of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnResult {
    /// Number of cells.
    pub cells: usize,
    /// Number of time steps.
    pub steps: usize,
    /// Comparisons.
    pub rows: Vec<ShockResult>,
    /// Time of the profile, s.
    pub time: f64,
    /// Length of a cell, m.
    pub spacing: f64,
    /// Profile of the solver by cell: velocity (m/s) and pressure −σ₁₁ (Pa).
    pub profile: Vec<[f64; 2]>,
}
