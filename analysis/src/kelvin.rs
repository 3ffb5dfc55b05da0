//! Kelvin waves: plane waves advected by a homogeneous flow (Kelvin 1887).
//!
//! In v = Γx a plane wave exp(ik·x) of a uniform background stays plane while its wave vector evolves by
//! k̇ = −Γᵀk, so z(t) exp(ik(t)·x) solves the linearised equations exactly. The system is differential-algebraic:
//! equations without time derivatives either determine algebraic unknowns or constrain differential ones, such as
//! k·v = 0. Constraints are differentiated, k·v̇ = −k̇·v, so the rate of k enters the evolution, unlike in the frozen
//! pencil.

use models::LinearisedSystem;
use models::common::elementary::{Elementary, Modulus};
use models::common::rounding::Rounded;
use nalgebra::DMatrix;
use num_complex::Complex64;

/// Evolution ż = Gz of a Kelvin wave in the unknowns that have time derivatives.
#[derive(Clone, Debug)]
pub struct KelvinEvolution {
    /// Columns of the evolving unknowns in the system.
    pub evolving_columns: Vec<usize>,
    /// Rate matrix G, 1/s.
    pub rate_matrix: DMatrix<Complex64>,
    /// Orthonormal basis of the subspace admitted by the constraints.
    admissible_basis: DMatrix<Complex64>,
}

/// Wave vector exp(−Γᵀt) k, 1/m, of a wave in v = Γx after the time t (s).
pub fn wave_vector(gradient: [[f64; 2]; 2], wave: [f64; 2], time: f64) -> [f64; 2] {
    let matrix = nalgebra::Matrix2::from_fn(|i, j| -gradient[j][i] * time);
    (matrix.exp() * nalgebra::Vector2::from(wave)).into()
}

/// Rate of the wave vector k̇ = −Γᵀk, 1/(m·s).
pub fn wave_vector_rate(gradient: [[f64; 2]; 2], wave: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|i| -(0..2).map(|j| gradient[j][i] * wave[j]).sum::<f64>())
}

impl KelvinEvolution {
    /// Evolution of a wave whose wave vector k = `wave` (1/m) changes at the `rate` k̇ (1/(m·s)). With k̇ = 0 the
    /// eigenvalues of [`reduced_rate_matrix`](Self::reduced_rate_matrix) are the finite roots of the frozen pencil
    /// without the convection term −ik·V.
    ///
    /// `None` if the equations do not determine the evolution.
    pub fn new(system: &LinearisedSystem<2>, wave: [f64; 2], rate: [f64; 2]) -> Option<Self> {
        let columns = system.unknowns.len();
        let is_zero = |entry: &Rounded| entry.value == 0.0;
        let (evolving_columns, others): (Vec<usize>, Vec<usize>) =
            (0..columns).partition(|&column| !system.a.column(column).iter().all(is_zero));
        let size = evolving_columns.len() + others.len();
        if system.equations.len() != size {
            return None;
        }
        let i = Complex64::I;
        let symbol = |row: usize, column: usize| {
            let [b1, b2] = system.b.each_ref().map(|b| b[(row, column)].value);
            system.c[(row, column)].value + i * (wave[0] * b1 + wave[1] * b2)
        };
        let moving = |row: usize, column: usize| {
            let [b1, b2] = system.b.each_ref().map(|b| b[(row, column)].value);
            i * (rate[0] * b1 + rate[1] * b2)
        };
        // Solve left (ż, w) = right z for the rates of the evolving unknowns z and the other unknowns w.
        let mut left = DMatrix::from_element(size, size, Complex64::ZERO);
        let mut right = DMatrix::from_element(size, evolving_columns.len(), Complex64::ZERO);
        let mut constraints = Vec::new();
        for row in 0..size {
            let is_constraint = system.a.row(row).iter().all(is_zero)
                && others.iter().all(|&column| symbol(row, column) == Complex64::ZERO);
            for (place, &column) in evolving_columns.iter().enumerate() {
                if is_constraint {
                    left[(row, place)] = symbol(row, column);
                    right[(row, place)] = -moving(row, column);
                } else {
                    left[(row, place)] = system.a[(row, column)].value.into();
                    right[(row, place)] = -symbol(row, column);
                }
            }
            for (place, &column) in others.iter().enumerate() {
                left[(row, evolving_columns.len() + place)] = symbol(row, column);
            }
            if is_constraint {
                constraints.push(row);
            }
        }
        // Scale each row to a largest entry of modulus one.
        let scale = |matrix: &mut DMatrix<Complex64>, row: usize, factor: f64| {
            matrix.row_mut(row).iter_mut().for_each(|entry| *entry *= factor);
        };
        for row in 0..size {
            let greatest = left.row(row).iter().map(|entry| entry.modulus()).fold(0.0, f64::max);
            scale(&mut left, row, 1.0 / greatest);
            scale(&mut right, row, 1.0 / greatest);
        }
        let solution = left.clone().lu().solve(&right)?;
        let rate_matrix = solution.rows(0, evolving_columns.len()).into_owned();
        let own = |row: usize| left.row(row).columns(0, evolving_columns.len()).into_owned();
        let admissible_basis = orthogonal_complement(
            &constraints.into_iter().map(own).collect::<Vec<_>>(),
            evolving_columns.len(),
        )?;
        rate_matrix.iter().all(|entry| entry.is_finite()).then_some(Self {
            evolving_columns,
            rate_matrix,
            admissible_basis,
        })
    }

    /// Rate matrix on the admissible subspace, in an orthonormal basis.
    pub fn reduced_rate_matrix(&self) -> DMatrix<Complex64> {
        self.admissible_basis.adjoint() * &self.rate_matrix * &self.admissible_basis
    }

    /// Eigenvalues (1/s) of [`reduced_rate_matrix`](Self::reduced_rate_matrix) by descending growth rate, each with its
    /// unit eigenvector in the evolving unknowns. Empty if the iteration does not converge.
    pub fn modes(&self) -> Vec<(Complex64, Vec<Complex64>)> {
        let (reduced, scales, unit) = balance_matrix(self.reduced_rate_matrix());
        let size = reduced.nrows();
        let mut rates = crate::dense::eigenvalues(reduced.clone()).unwrap_or_default();
        rates.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        let vector = |rate: Complex64| {
            // Eigenvector: right singular vector of the smallest singular value of G − ςI.
            let shifted = &reduced - DMatrix::identity(size, size) * rate;
            let decomposition = shifted.svd(false, true);
            let least = decomposition.singular_values.imin();
            let mut vector = decomposition.v_t?.row(least).adjoint();
            vector.iter_mut().zip(&scales).for_each(|(own, scale)| *own *= *scale);
            let vector = (&self.admissible_basis * vector).normalize();
            Some((rate * unit, vector.iter().copied().collect()))
        };
        rates.into_iter().filter_map(vector).collect()
    }
}

/// Integrates a Kelvin wave with initial wave vector `wave` (1/m) and evolving unknowns `start` in v = Γx; returns the
/// evolving unknowns at the beginning and at the ends of `count` equal intervals of the `duration` (s). Radau IIA
/// collocation of fifth order (Hairer & Wanner 1996, IV.5), L-stable, with `steps` steps per interval.
///
/// `system` returns the linearised equations at a time (s), so the uniform mean flow may depend on time. Coefficients
/// of constraints, as in k·v = 0, must not.
///
/// `None` if the equations do not determine the evolution, or if `system` returns `None` at some time.
pub fn integrate_kelvin_wave(
    system: &dyn Fn(f64) -> Option<LinearisedSystem<2>>,
    gradient: [[f64; 2]; 2],
    wave: [f64; 2],
    start: &[Complex64],
    duration: f64,
    [count, steps]: [usize; 2],
) -> Option<Vec<Vec<Complex64>>> {
    let root = 6f64.sqrt();
    let times = [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0];
    let weights = [
        [(88.0 - 7.0 * root) / 360.0, (296.0 - 169.0 * root) / 1800.0, (-2.0 + 3.0 * root) / 225.0],
        [(296.0 + 169.0 * root) / 1800.0, (88.0 + 7.0 * root) / 360.0, (-2.0 - 3.0 * root) / 225.0],
        [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0],
    ];
    let (step, size) = (duration / (count * steps) as f64, start.len());
    let mut state = nalgebra::DVector::from_column_slice(start);
    let mut all = vec![start.to_vec()];
    for index in 0..count * steps {
        // Stages zᵢ = z + h Σ wᵢⱼ G(tⱼ) zⱼ; the last stage is the next z.
        let mut left = DMatrix::<Complex64>::identity(3 * size, 3 * size);
        for (j, time) in times.into_iter().enumerate() {
            let time = (index as f64 + time) * step;
            let now = wave_vector(gradient, wave, time);
            let rate_matrix =
                KelvinEvolution::new(&system(time)?, now, wave_vector_rate(gradient, now))?
                    .rate_matrix;
            for (i, weights) in weights.iter().enumerate() {
                let mut block = left.view_mut((i * size, j * size), (size, size));
                block -= rate_matrix.scale(step * weights[j]);
            }
        }
        let right = nalgebra::DVector::from_fn(3 * size, |row, _| state[row % size]);
        state = left.lu().solve(&right)?.rows(2 * size, size).into_owned();
        if (index + 1) % steps == 0 {
            all.push(state.iter().copied().collect());
        }
    }
    Some(all)
}

/// Balances a square matrix (Parlett & Reinsch 1969): returns D⁻¹AD/u, D and u, with powers of two in D and u, such
/// that rows and columns have comparable norms and the largest entry is about one. Hence the accuracy of the
/// eigenvectors hardly depends on the units of the unknowns.
fn balance_matrix(mut matrix: DMatrix<Complex64>) -> (DMatrix<Complex64>, Vec<f64>, f64) {
    const MAX_SWEEPS: usize = 100;
    let size = matrix.nrows();
    let mut scales = vec![1.0; size];
    for _ in 0..MAX_SWEEPS {
        let mut is_settled = true;
        for i in 0..size {
            let others = || (0..size).filter(|j| *j != i);
            let column = others().map(|j| matrix[(j, i)].modulus()).fold(0.0, f64::max);
            let row = others().map(|j| matrix[(i, j)].modulus()).fold(0.0, f64::max);
            // If one of the norms is zero, scale the other to the largest diagonal entry.
            let diagonal =
                (0..size).map(|j| matrix[(j, j)].modulus()).fold(0.0, f64::max).cr_log2();
            let power = match (row.cr_log2(), column.cr_log2()) {
                (row, f64::NEG_INFINITY) => row - diagonal,
                (f64::NEG_INFINITY, column) => diagonal - column,
                (row, column) => 0.5 * (row - column),
            };
            let power = power.round();
            if !power.is_finite() || power == 0.0 {
                continue;
            }
            let factor = power.cr_exp2();
            scales[i] *= factor;
            for j in others().collect::<Vec<_>>() {
                matrix[(j, i)] *= factor;
                matrix[(i, j)] /= factor;
            }
            is_settled = false;
        }
        if is_settled {
            break;
        }
    }
    let greatest = matrix.iter().map(|entry| entry.modulus()).fold(0.0, f64::max);
    let unit = if greatest > 0.0 { greatest.cr_log2().round().cr_exp2() } else { 1.0 };
    (matrix.unscale(unit), scales, unit)
}

/// Orthonormal basis of the vectors of length `size` that all `rows` map to zero (Gram–Schmidt with
/// reorthogonalisation); `None` if there are none.
fn orthogonal_complement(
    rows: &[nalgebra::RowDVector<Complex64>],
    size: usize,
) -> Option<DMatrix<Complex64>> {
    let mut accepted: Vec<nalgebra::DVector<Complex64>> = Vec::new();
    let mut basis = Vec::new();
    let axes = (0..size).map(|axis| {
        let mut unit = nalgebra::DVector::from_element(size, Complex64::ZERO);
        unit[axis] = Complex64::ONE;
        unit
    });
    let constraints = rows.iter().map(|row| (row.adjoint(), true));
    for (mut vector, is_constraint) in constraints.chain(axes.map(|axis| (axis, false))) {
        for _ in 0..2 {
            for own in &accepted {
                let part = own.dotc(&vector);
                vector -= own * part;
            }
        }
        let norm = vector.norm();
        // Accept only unit vectors that are not nearly in the span of the accepted vectors: as many as the dimension
        // requires.
        if norm > 0.5 / (size as f64).sqrt() || is_constraint {
            vector.unscale_mut(norm);
            accepted.push(vector.clone());
            if !is_constraint {
                basis.push(vector);
            }
        }
    }
    (!basis.is_empty()).then(|| DMatrix::from_columns(&basis))
}
