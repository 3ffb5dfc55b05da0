//! Plane waves in a homogeneous flow that carries them along (Kelvin 1887).
//!
//! In v = Γx a wave exp(ik·x) of a uniform background stays one while its wave vector moves,
//! k̇ = −Γᵀk, so that z(t) exp(ik(t)·x) solves the linearised equations exactly. Equations without time
//! derivatives fall into two kinds: those that determine unknowns which do not evolve, and constraints on
//! those which do, such as k·v = 0. A constraint is differentiated, k·v̇ = −k̇·v: the motion of k enters the
//! evolution, which the frozen pencil does not see.

use models::LinearisedSystem;
use models::common::elementary::Elementary;
use models::common::rounding::Rounded;
use nalgebra::DMatrix;
use num_complex::Complex64;

/// The evolution of a wave: ż = Gz of the unknowns that have time derivatives.
#[derive(Clone, Debug)]
pub struct Evolution {
    /// Their columns in the system.
    pub evolving: Vec<usize>,
    /// G, 1/s.
    pub rates: DMatrix<Complex64>,
    /// Orthonormal columns: what the constraints leave.
    admissible: DMatrix<Complex64>,
}

/// The wave vector of a wave in v = Γx after a time: exp(−Γᵀt) k, 1/m.
pub fn wave_vector(gradient: [[f64; 2]; 2], wave: [f64; 2], time: f64) -> [f64; 2] {
    let matrix = nalgebra::Matrix2::from_fn(|i, j| -gradient[j][i] * time);
    (matrix.exp() * nalgebra::Vector2::from(wave)).into()
}

/// −Γᵀk, 1/(m·s).
pub fn wave_vector_rate(gradient: [[f64; 2]; 2], wave: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|i| -(0..2).map(|j| gradient[j][i] * wave[j]).sum::<f64>())
}

impl Evolution {
    /// Of a wave of vector k, 1/m, that changes at the rate k̇, 1/(m·s); with k̇ = 0 its eigenvalues on
    /// what is admissible are the finite roots of the frozen pencil, less −ik·V.
    ///
    /// `None` if the equations do not determine the evolution.
    pub fn new(system: &LinearisedSystem<2>, wave: [f64; 2], rate: [f64; 2]) -> Option<Self> {
        let columns = system.unknowns.len();
        let is_zero = |entry: &Rounded| entry.value == 0.0;
        let (evolving, others): (Vec<usize>, Vec<usize>) =
            (0..columns).partition(|&column| !system.a.column(column).iter().all(is_zero));
        let size = evolving.len() + others.len();
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
        // Rates of what evolves, then the other unknowns: left × them = right × what evolves.
        let mut left = DMatrix::from_element(size, size, Complex64::ZERO);
        let mut right = DMatrix::from_element(size, evolving.len(), Complex64::ZERO);
        let mut constraints = Vec::new();
        for row in 0..size {
            let is_constraint = system.a.row(row).iter().all(is_zero)
                && others.iter().all(|&column| symbol(row, column) == Complex64::ZERO);
            for (place, &column) in evolving.iter().enumerate() {
                if is_constraint {
                    left[(row, place)] = symbol(row, column);
                    right[(row, place)] = -moving(row, column);
                } else {
                    left[(row, place)] = system.a[(row, column)].value.into();
                    right[(row, place)] = -symbol(row, column);
                }
            }
            for (place, &column) in others.iter().enumerate() {
                left[(row, evolving.len() + place)] = symbol(row, column);
            }
            if is_constraint {
                constraints.push(row);
            }
        }
        // In units in which all rows and columns are of comparable size.
        let scale = |matrix: &mut DMatrix<Complex64>, row: usize, factor: f64| {
            matrix.row_mut(row).iter_mut().for_each(|entry| *entry *= factor);
        };
        for row in 0..size {
            let greatest = left.row(row).iter().map(|entry| entry.norm()).fold(0.0, f64::max);
            scale(&mut left, row, 1.0 / greatest);
            scale(&mut right, row, 1.0 / greatest);
        }
        let solution = left.clone().lu().solve(&right)?;
        let rates = solution.rows(0, evolving.len()).into_owned();
        let own = |row: usize| left.row(row).columns(0, evolving.len()).into_owned();
        let admissible =
            complement(&constraints.into_iter().map(own).collect::<Vec<_>>(), evolving.len())?;
        rates.iter().all(|entry| entry.is_finite()).then_some(Self { evolving, rates, admissible })
    }

    /// The evolution on what the constraints leave, in an orthonormal basis that turns no more than they do.
    pub fn reduced(&self) -> DMatrix<Complex64> {
        self.admissible.adjoint() * &self.rates * &self.admissible
    }

    /// Rates of [`reduced`](Self::reduced), 1/s, and the admissible waves that have them, of unit length; the
    /// fastest growing one first. Empty if the iteration does not converge.
    pub fn modes(&self) -> Vec<(Complex64, Vec<Complex64>)> {
        let (reduced, scales, unit) = balanced(self.reduced());
        let size = reduced.nrows();
        let mut rates = crate::dense::eigenvalues(reduced.clone()).unwrap_or_default();
        rates.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        let vector = |rate: Complex64| {
            // What the shifted matrix all but annihilates.
            let shifted = &reduced - DMatrix::identity(size, size) * rate;
            let decomposition = shifted.svd(false, true);
            let least = decomposition.singular_values.imin();
            let mut vector = decomposition.v_t?.row(least).adjoint();
            vector.iter_mut().zip(&scales).for_each(|(own, scale)| *own *= *scale);
            let vector = (&self.admissible * vector).normalize();
            Some((rate * unit, vector.iter().copied().collect()))
        };
        rates.into_iter().filter_map(vector).collect()
    }
}

/// The course of a wave of vector `wave` (1/m) in v = Γx from its beginning: its unknowns that evolve at
/// `count` even intervals of a time, s, the beginning included. By collocation of fifth order (Radau IIA;
/// Hairer & Wanner 1996, IV.5), which takes decay however fast, in `steps` steps an interval.
///
/// `system` gives the linearised equations at a time, s: a uniform mean flow may change while it goes on.
/// Coefficients of constraints are taken as constant in time, as those of k·v = 0 are.
///
/// `None` if the equations do not determine the evolution, or there are none at some time.
pub fn course(
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
        // zᵢ = z + h Σ wᵢⱼ G(tⱼ) zⱼ, the last of which is the next z.
        let mut left = DMatrix::<Complex64>::identity(3 * size, 3 * size);
        for (j, time) in times.into_iter().enumerate() {
            let time = (index as f64 + time) * step;
            let now = wave_vector(gradient, wave, time);
            let rates = Evolution::new(&system(time)?, now, wave_vector_rate(gradient, now))?.rates;
            for (i, weights) in weights.iter().enumerate() {
                let mut block = left.view_mut((i * size, j * size), (size, size));
                block -= rates.scale(step * weights[j]);
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

/// A square matrix A as D⁻¹AD/u with powers of two on the diagonal of D and for u, such that rows and columns of the
/// result are of comparable size (Parlett & Reinsch 1969) and its greatest entry is about one; D and u. What A maps may
/// have components of different units, which decide over no bit of the result.
fn balanced(mut matrix: DMatrix<Complex64>) -> (DMatrix<Complex64>, Vec<f64>, f64) {
    const ROUNDS: usize = 100;
    let size = matrix.nrows();
    let mut scales = vec![1.0; size];
    for _ in 0..ROUNDS {
        let mut is_settled = true;
        for i in 0..size {
            let others = || (0..size).filter(|j| *j != i);
            let column = others().map(|j| matrix[(j, i)].norm()).fold(0.0, f64::max);
            let row = others().map(|j| matrix[(i, j)].norm()).fold(0.0, f64::max);
            // Where one of them is zero, the other becomes as great as the diagonal.
            let diagonal = (0..size).map(|j| matrix[(j, j)].norm()).fold(0.0, f64::max).cr_log2();
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
    let greatest = matrix.iter().map(|entry| entry.norm()).fold(0.0, f64::max);
    let unit = if greatest > 0.0 { greatest.cr_log2().round().cr_exp2() } else { 1.0 };
    (matrix.unscale(unit), scales, unit)
}

/// Orthonormal columns orthogonal to rows (Gram and Schmidt, twice), if there are any.
fn complement(rows: &[nalgebra::RowDVector<Complex64>], size: usize) -> Option<DMatrix<Complex64>> {
    let mut taken: Vec<nalgebra::DVector<Complex64>> = Vec::new();
    let mut left = Vec::new();
    let axes = (0..size).map(|axis| {
        let mut unit = nalgebra::DVector::from_element(size, Complex64::ZERO);
        unit[axis] = Complex64::ONE;
        unit
    });
    let constraints = rows.iter().map(|row| (row.adjoint(), true));
    for (mut vector, is_constraint) in constraints.chain(axes.map(|axis| (axis, false))) {
        for _ in 0..2 {
            for own in &taken {
                let part = own.dotc(&vector);
                vector -= own * part;
            }
        }
        let norm = vector.norm();
        // Of unit vectors no more than are needed: those that constraints have not used up.
        if norm > 0.5 / (size as f64).sqrt() || is_constraint {
            vector.unscale_mut(norm);
            taken.push(vector.clone());
            if !is_constraint {
                left.push(vector);
            }
        }
    }
    (!left.is_empty()).then(|| DMatrix::from_columns(&left))
}
