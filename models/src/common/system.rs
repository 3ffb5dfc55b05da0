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
/// Terms with derivatives of higher order, such as ∂₁∂₁z or ∂ₜ∂ₜz, are listed in `higher_terms`, which is empty for
/// first-order equations. All entries of the symbol are polynomials in ς and κ = ik.
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
    /// Terms of second and higher order, in the frame of velocity V.
    pub higher_terms: Vec<HigherTerm<D>>,
}

/// A term `coefficient` (∂ₜ + V·∇)^a ∂₁^b₁ … z of second or higher order in one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HigherTerm<const D: usize> {
    /// Equation.
    pub row: usize,
    /// Unknown.
    pub column: usize,
    /// Order a of the material time derivative: power of ς.
    pub time_power: u8,
    /// Orders bᵢ of the space derivatives: powers of κᵢ.
    pub space_powers: [u8; D],
    /// Coefficient.
    pub coefficient: Rounded,
}

impl<const D: usize> HigherTerm<D> {
    /// Total order of the space derivatives: the power of k.
    pub fn wave_number_power(&self) -> u8 {
        self.space_powers.iter().sum()
    }
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
            higher_terms: Vec::new(),
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
        self.higher_terms.clear();
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

impl LinearisedSystem<3> {
    /// Writes the system for waves in a plane into `plane`: wave vectors κ = κ₁ a + κ₂ b with the orthogonal unit vectors
    /// a and b of `axes`, which are taken as exact.
    pub fn restrict_to_plane(&self, axes: &[[f64; 3]; 2], plane: &mut LinearisedSystem<2>) {
        let velocity = axes.map(|axis| (0..3).map(|i| axis[i] * self.velocity[i]).sum());
        plane.reset(self.unknowns, self.equations, velocity);
        plane.a.copy_from(&self.a);
        plane.c.copy_from(&self.c);
        for (own, axis) in plane.b.iter_mut().zip(axes) {
            for (matrix, &component) in self.b.iter().zip(axis) {
                own.zip_apply(matrix, |sum, entry| *sum += component * entry);
            }
        }
        for term in &self.higher_terms {
            // Π (κ₁ aᵢ + κ₂ bᵢ)^nᵢ as a polynomial: entry l multiplies κ₁^(n−l) κ₂^l.
            let mut product = vec![term.coefficient];
            for (i, &power) in term.space_powers.iter().enumerate() {
                for _ in 0..power {
                    let mut next = vec![Rounded::ZERO; product.len() + 1];
                    for (l, &own) in product.iter().enumerate() {
                        next[l] += axes[0][i] * own;
                        next[l + 1] += axes[1][i] * own;
                    }
                    product = next;
                }
            }
            let degree = term.wave_number_power();
            for (l, coefficient) in product.into_iter().enumerate() {
                if !coefficient.is_structural_zero() {
                    plane.higher_terms.push(HigherTerm {
                        row: term.row,
                        column: term.column,
                        time_power: term.time_power,
                        space_powers: [degree - l as u8, l as u8],
                        coefficient,
                    });
                }
            }
        }
    }
}
