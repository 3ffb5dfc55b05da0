//! Linear differential-algebraic equations E ẏ + A y = 0 with constant complex coefficients: reduction of the index by
//! differentiation of constraints, consistent states, and the Radau IIA method of order 5.
//!
//! Rows of A whose rows of E vanish are constraints. Those that involve no algebraic unknown, such as incompressibility,
//! are differentiated once, as often as needed, until the equations have index 1 (shuffle algorithm, Luenberger 1978).
//! Singular pencils, det(sE + A) ≡ 0, leave a row without any entry. Radau IIA with three stages is stiffly accurate:
//! it satisfies the constraints of equations of index 1 at the end of each step (Hairer & Wanner 1996, IV.5, VI.1).

use nalgebra::{DMatrix, DVector, Dyn, LU};
use num_complex::Complex64;

/// Singular values of equilibrated matrices below this one count as zero: between the error of coefficients that are
/// differences, about 1e-10, and the smallest coefficients that matter.
const RANK_TOLERANCE: f64 = 1e-8;

type Matrix = DMatrix<Complex64>;
type Vector = DVector<Complex64>;

/// Equations E ẏ + A y = 0 of index 0 or 1 with the constraints of the equations from which they were obtained.
#[derive(Clone, Debug)]
pub struct ReducedEquations {
    e: Matrix,
    a: Matrix,
    /// Undifferentiated constraints that were differentiated, as rows of unit length.
    pub differentiated: Matrix,
    /// Orthonormal basis of the consistent states, as columns.
    pub consistent_states: Matrix,
}

/// Orthonormal bases of the range of the adjoint of `matrix` and of its null space, as columns, by the singular value
/// decomposition.
fn split_domain(matrix: &Matrix) -> [Matrix; 2] {
    let columns = matrix.ncols();
    // Rows of zeros complete the decomposition, which else omits part of the null space.
    let rows = matrix.nrows().max(columns);
    let square = matrix.clone().resize(rows, columns, Complex64::ZERO);
    let svd = square.svd(false, true);
    let adjoint = svd.v_t.unwrap_or_else(|| Matrix::identity(columns, columns)).adjoint();
    let is_range = |index: &usize| svd.singular_values[*index] > RANK_TOLERANCE;
    let (range, kernel): (Vec<usize>, Vec<usize>) = (0..columns).partition(is_range);
    [range, kernel].map(|own| adjoint.select_columns(&own))
}

/// The rows of several matrices of the same width below one another.
fn stack(parts: &[&Matrix]) -> Matrix {
    let columns = parts.first().map_or(0, |own| own.ncols());
    let rows: Vec<_> = parts.iter().flat_map(|own| own.row_iter()).collect();
    Matrix::from_fn(rows.len(), columns, |i, j| rows[i][j])
}

/// Divides each row by its norm; `None` if one vanishes.
fn normalise_rows(mut matrix: Matrix) -> Option<Matrix> {
    for mut row in matrix.row_iter_mut() {
        let norm = row.norm();
        if norm <= RANK_TOLERANCE {
            return None;
        }
        row.scale_mut(1.0 / norm);
    }
    Some(matrix)
}

impl ReducedEquations {
    /// Reduces equilibrated square equations, whose entries are at most of order one, to index 1; `None` if the pencil
    /// is singular.
    pub fn new(mut e: Matrix, mut a: Matrix) -> Option<Self> {
        let size = e.ncols();
        let mut differentiated = Matrix::zeros(0, size);
        // Each pass that differentiates raises the rank of E, or finds a row without entries.
        for _ in 0..=size {
            let [range, kernel] = split_domain(&e.adjoint());
            let (dynamic_e, dynamic_a) = (range.adjoint() * &e, range.adjoint() * &a);
            if kernel.ncols() == 0 {
                return Some(Self::from_index_one(e, a, differentiated, &Matrix::zeros(0, size)));
            }
            let constraints = normalise_rows(kernel.adjoint() * &a)?;
            let [_, algebraic] = split_domain(&dynamic_e);
            // Combinations of constraints that do not involve algebraic unknowns.
            let [index_one, higher] = split_domain(&(&constraints * algebraic).adjoint());
            let remaining = index_one.adjoint() * &constraints;
            let zero = |rows: usize| Matrix::zeros(rows, size);
            if higher.ncols() == 0 {
                e = stack(&[&dynamic_e, &zero(remaining.nrows())]);
                a = stack(&[&dynamic_a, &remaining]);
                return Some(Self::from_index_one(e, a, differentiated, &remaining));
            }
            let own = normalise_rows(higher.adjoint() * &constraints)?;
            e = stack(&[&dynamic_e, &own, &zero(remaining.nrows())]);
            a = stack(&[&dynamic_a, &zero(own.nrows()), &remaining]);
            differentiated = stack(&[&differentiated, &own]);
        }
        None
    }

    fn from_index_one(e: Matrix, a: Matrix, differentiated: Matrix, algebraic: &Matrix) -> Self {
        let [_, consistent_states] = split_domain(&stack(&[&differentiated, algebraic]));
        Self { e, a, differentiated, consistent_states }
    }

    /// Number of solutions that are independent of one another.
    pub fn dimension(&self) -> usize {
        self.consistent_states.ncols()
    }

    /// Orthogonal projection of a state on the consistent states.
    pub fn project(&self, state: &Vector) -> Vector {
        &self.consistent_states * (self.consistent_states.adjoint() * state)
    }

    /// Largest undifferentiated constraint at a state, relative to the state.
    pub fn constraint_residual(&self, state: &Vector) -> f64 {
        (&self.differentiated * state).camax() / state.norm()
    }
}

/// Radau IIA method with three stages, order 5, of constant step (Hairer & Wanner 1996, table IV.5.6).
#[derive(Clone, Debug)]
pub struct RadauStepper<'a> {
    equations: &'a ReducedEquations,
    time_step: f64,
    /// Factorised equations of the slopes of all stages.
    stages: LU<Complex64, Dyn, Dyn>,
}

/// Coefficients of the stages; the last row has the weights.
fn radau_coefficients() -> [[f64; 3]; 3] {
    let root = 6f64.sqrt();
    [
        [(88.0 - 7.0 * root) / 360.0, (296.0 - 169.0 * root) / 1800.0, (-2.0 + 3.0 * root) / 225.0],
        [(296.0 + 169.0 * root) / 1800.0, (88.0 + 7.0 * root) / 360.0, (-2.0 - 3.0 * root) / 225.0],
        [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0],
    ]
}

/// Stability function of the method: the factor by which a step multiplies a solution exp(st), z = s Δt.
pub fn radau_stability_function(z: Complex64) -> Complex64 {
    let (second, third) = (z * z, z * z * z);
    (1.0 + 0.4 * z + second / 20.0) / (1.0 - 0.6 * z + 0.15 * second - third / 60.0)
}

impl<'a> RadauStepper<'a> {
    /// Prepares steps of length `time_step` (s).
    pub fn new(equations: &'a ReducedEquations, time_step: f64) -> Self {
        let size = equations.e.ncols();
        let coefficients = radau_coefficients();
        let matrix = Matrix::from_fn(3 * size, 3 * size, |i, j| {
            let (stage, other, at) = (i / size, j / size, (i % size, j % size));
            let own = if stage == other { equations.e[at] } else { Complex64::ZERO };
            own + equations.a[at] * (time_step * coefficients[stage][other])
        });
        Self { equations, time_step, stages: matrix.lu() }
    }

    /// The state after one step; `None` if the equations of the stages are singular.
    pub fn step(&self, state: &Vector) -> Option<Vector> {
        let size = state.len();
        let forcing = -(&self.equations.a * state);
        let mut slopes = Vector::from_fn(3 * size, |i, _| forcing[i % size]);
        if !self.stages.solve_mut(&mut slopes) {
            return None;
        }
        let weights = radau_coefficients()[2];
        Some(Vector::from_fn(size, |i, _| {
            let sum: Complex64 =
                (0..3).map(|stage| slopes[stage * size + i] * weights[stage]).sum();
            state[i] + sum * self.time_step
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real(rows: usize, values: &[f64]) -> Matrix {
        let columns = values.len() / rows;
        Matrix::from_fn(rows, columns, |i, j| values[i * columns + j].into())
    }

    /// A step of a decaying oscillation is that of the stability function, whose error is z⁶/7200.
    #[test]
    fn steps_have_fifth_order() {
        let rate = Complex64::new(-0.3, 2.0);
        let a = Matrix::from_element(1, 1, -rate);
        let equations = ReducedEquations::new(Matrix::identity(1, 1), a).expect("regular");
        let mut errors = Vec::new();
        for time_step in [0.4, 0.2, 0.1] {
            let stepper = RadauStepper::new(&equations, time_step);
            let found = stepper.step(&Vector::from_element(1, Complex64::ONE)).expect("regular")[0];
            let z = rate * time_step;
            assert!((found - radau_stability_function(z)).norm() < 1e-14);
            errors.push((found - z.exp()).norm() / (z.powu(6).norm() / 7200.0));
        }
        assert!((errors[2] - 1.0).abs() < 0.1, "{errors:?}");
        assert!((errors[2] - 1.0).abs() < (errors[0] - 1.0).abs(), "{errors:?}");
    }

    /// A mass m on two axes, bound to the line n·v = 0 by a force λ n (index 2), with drag: v = v₀ exp(−t/m) along the
    /// line, λ = 0.
    #[test]
    fn velocity_constraints_are_differentiated_once() {
        let (mass, normal) = (2.0, [0.6, 0.8]);
        let e = real(3, &[mass, 0.0, 0.0, 0.0, mass, 0.0, 0.0, 0.0, 0.0]);
        let a = real(3, &[1.0, 0.0, normal[0], 0.0, 1.0, normal[1], normal[0], normal[1], 0.0]);
        let equations = ReducedEquations::new(e, a).expect("regular");
        assert_eq!((equations.differentiated.nrows(), equations.dimension()), (1, 1));
        let raw = Vector::from_fn(3, |i, _| [3.0, -1.0, 7.0][i].into());
        let start = equations.project(&raw);
        assert!(equations.constraint_residual(&start) < 1e-14);
        let (stepper, mut state) = (RadauStepper::new(&equations, 0.1), start.clone());
        for _ in 0..20 {
            state = stepper.step(&state).expect("regular");
        }
        assert!((&state - &start * Complex64::from((-1.0f64).exp())).norm() < 1e-10);
        assert!(equations.constraint_residual(&state) < 1e-12);
    }

    /// A position bound to a line by a force (index 3) is differentiated twice: two of four states remain.
    #[test]
    fn position_constraints_are_differentiated_twice() {
        let n = [0.6, 0.8];
        // x' = v, v' = −x − λ n, n·x = 0.
        let mut e = Matrix::identity(5, 5);
        e[(4, 4)] = Complex64::ZERO;
        let mut a = Matrix::zeros(5, 5);
        for i in 0..2 {
            a[(i, 2 + i)] = (-1.0).into();
            a[(2 + i, i)] = 1.0.into();
            a[(2 + i, 4)] = n[i].into();
            a[(4, i)] = n[i].into();
        }
        let equations = ReducedEquations::new(e, a).expect("regular");
        assert_eq!((equations.differentiated.nrows(), equations.dimension()), (2, 2));
        // Along the line an oscillation of frequency 1.
        let start = Vector::from_fn(5, |i, _| [0.8, -0.6, 0.0, 0.0, 0.0][i].into());
        assert!((equations.project(&start) - &start).norm() < 1e-13);
        let (stepper, mut state) = (RadauStepper::new(&equations, 0.05), start.clone());
        for _ in 0..20 {
            state = stepper.step(&state).expect("regular");
        }
        assert!((state[0].re - 0.8 * 1f64.cos()).abs() < 1e-9, "{state}");
    }

    #[test]
    fn singular_pencils_are_found() {
        // Both equations are the same; a constraint that follows from the others; an unknown in no equation.
        let same = real(2, &[1.0, 2.0, 1.0, 2.0]);
        assert!(ReducedEquations::new(same.clone(), same).is_none());
        let (e, a) = (real(2, &[1.0, 0.0, 0.0, 0.0]), real(2, &[0.0, 0.0, 1.0, 0.0]));
        assert!(ReducedEquations::new(e, a).is_none());
        let (e, a) = (real(2, &[1.0, 0.0, 0.0, 0.0]), real(2, &[1.0, 0.0, 0.0, 0.0]));
        assert!(ReducedEquations::new(e, a).is_none());
    }
}
