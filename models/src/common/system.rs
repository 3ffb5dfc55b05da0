//! A linearised system of equations as data: the form in which the analysis receives the equations of a model.

use crate::common::rounding::Rounded;
use nalgebra::DMatrix;

/// A matrix of coefficients, each with its rounding bound.
pub type RoundedMatrix = DMatrix<Rounded>;

/// Linearised equations with frozen coefficients in `D` space dimensions,
///
/// ```text
/// A (∂ₜ + V·∇) z + Σ Bⁱ ∂ᵢ z + C z = 0.
/// ```
///
/// `V` is the velocity of the frame of reference: for a flow the velocity of the material, so that all time derivatives
/// are material derivatives; for a solid zero. For modes exp(ςt + ik·x), V only shifts ς to ς − ik·V and leaves the
/// growth rate Re ς unchanged; storing V separately keeps Galilean invariance exact in floating point.
///
/// Rows are equations, columns are unknowns; a system may have fewer rows than columns. Fill with
/// [`reset`](Self::reset) and index assignments; refilling a system of the same size allocates nothing.
#[derive(Clone, Debug)]
pub struct LinearisedSystem<const D: usize> {
    /// Unknowns z, one per column.
    pub unknowns: &'static [Unknown],
    /// Names of the equations, one per row.
    pub equations: &'static [&'static str],
    /// Velocity V of the frame, m/s.
    pub velocity: [f64; D],
    /// Coefficients A of the material time derivatives.
    pub a: RoundedMatrix,
    /// Coefficients Bⁱ of the space derivatives, without the advection term `A V·∇`.
    pub b: [RoundedMatrix; D],
    /// Coefficients C of the unknowns themselves.
    pub c: RoundedMatrix,
}

/// An unknown of a linearised system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Name of the unknown in output.
    pub name: &'static str,
    /// Family of the unknown, by which characteristics are named: "velocity", "stress", …
    pub family: &'static str,
}

impl<const D: usize> Default for LinearisedSystem<D> {
    fn default() -> Self {
        let empty = || RoundedMatrix::from_element(0, 0, Rounded::ZERO);
        Self {
            unknowns: &[],
            equations: &[],
            velocity: [0.0; D],
            a: empty(),
            b: std::array::from_fn(|_| empty()),
            c: empty(),
        }
    }
}

impl<const D: usize> LinearisedSystem<D> {
    /// Sets unknowns, equations and frame velocity to the given ones and all coefficients to zero.
    pub fn reset(
        &mut self,
        unknowns: &'static [Unknown],
        equations: &'static [&'static str],
        velocity: [f64; D],
    ) {
        (self.unknowns, self.equations, self.velocity) = (unknowns, equations, velocity);
        let (rows, columns) = (equations.len(), unknowns.len());
        let matrices = [&mut self.a, &mut self.c].into_iter().chain(&mut self.b);
        for matrix in matrices {
            if matrix.shape() == (rows, columns) {
                matrix.fill(Rounded::ZERO);
            } else {
                *matrix = RoundedMatrix::from_element(rows, columns, Rounded::ZERO);
            }
        }
    }
}
