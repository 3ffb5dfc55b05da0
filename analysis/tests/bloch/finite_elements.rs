//! Reference: Bloch frequencies of one block per cell by bilinear finite elements, on a lattice (h, 0), (s, h). It
//! shares no code with the crate.

use models::interface::homogenised::BlockyMedium;
use nalgebra::{Cholesky, DMatrix};
use num_complex::Complex64;

/// Number of vectors of the subspace iteration.
const SUBSPACE_VECTORS: usize = 12;
/// Number of steps of the subspace iteration.
const SUBSPACE_STEPS: usize = 24;

/// Squared frequencies of the lowest `count` modes on a mesh of n × n squares; `shear` s in elements of this mesh.
pub fn squared_frequencies(
    medium: &BlockyMedium,
    wave_vector: [f64; 2],
    (n, shear): (usize, usize),
    opening_share: f64,
    count: usize,
) -> Vec<f64> {
    let size = medium.period / n as f64;
    let nodes = n + 1;
    let dof = |i: usize, j: usize, component: usize| 2 * (i * nodes + j) + component;
    let total = 2 * nodes * nodes;
    let mut stiffness = DMatrix::<Complex64>::zeros(total, total);
    let mut mass = DMatrix::<Complex64>::zeros(total, total);
    let (lambda, mu) = (medium.block.lame_modulus(), medium.block.shear_modulus());
    let gauss = [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()];
    let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
    for element in 0..n * n {
        let (i, j) = (element / n, element % n);
        for (x, y) in [0, 1, 2, 3].map(|q| (gauss[q / 2], gauss[q % 2])) {
            // Shape functions, and strains (11, 22, 2·12) of their displacements.
            let hat = |corner: usize, x: f64| if corner == 1 { x } else { 1.0 - x };
            let slope = |corner: usize| if corner == 1 { 1.0 } else { -1.0 } / size;
            let mut columns = Vec::new();
            for [a, b] in corners {
                let (dx, dy) = (slope(a) * hat(b, y), slope(b) * hat(a, x));
                let value = hat(a, x) * hat(b, y);
                columns.push((dof(i + a, j + b, 0), 0, value, [dx, 0.0, dy]));
                columns.push((dof(i + a, j + b, 1), 1, value, [0.0, dy, dx]));
            }
            let weight = 0.25 * size * size;
            for &(row, first, value, strain) in &columns {
                let [s11, s22, s12] = [
                    (lambda + 2.0 * mu) * strain[0] + lambda * strain[1],
                    (lambda + 2.0 * mu) * strain[1] + lambda * strain[0],
                    mu * strain[2],
                ];
                for &(column, second, other, [e11, e22, e12]) in &columns {
                    stiffness[(row, column)] += weight * (s11 * e11 + s22 * e22 + s12 * e12);
                    if first == second {
                        mass[(row, column)] += weight * medium.block.density * value * other;
                    }
                }
            }
        }
    }
    // Joints: linear openings between nodes, integrals (1/3, 1/6) of products of hat functions.
    let [normal, tangential] = medium.layer_stiffness();
    let (m, opening_mass) = (medium.layer.mass(), opening_share * medium.layer.mass());
    let phase = |x: f64| Complex64::from_polar(1.0, -x * medium.period);
    let [first, second] = wave_vector;
    let image = Complex64::from_polar(1.0, -second * medium.period - first * shear as f64 * size);
    for segment in 0..n {
        // Pairs of nodes at both ends of the segment: before, after and the phase of after.
        let horizontal = |k: usize| {
            // The block above lies s to the right of this one; its image one period to the left covers the rest.
            match segment >= shear {
                true => ([k, n], [k - shear, 0], image),
                false => ([k, n], [k + n - shear, 0], image * phase(-first)),
            }
        };
        let vertical = |k: usize| ([n, k], [0, k], phase(first));
        for axis in 0..2 {
            let ends = match axis {
                0 => [vertical(segment), vertical(segment + 1)],
                _ => [horizontal(segment), horizontal(segment + 1)],
            };
            for component in 0..2 {
                let k = if component == axis { normal } else { tangential };
                for p in 0..2 {
                    for q in 0..2 {
                        let weight = size * if p == q { 1.0 / 3.0 } else { 1.0 / 6.0 };
                        let values =
                            |(before, after, phase): ([usize; 2], [usize; 2], Complex64)| {
                                [
                                    (
                                        dof(before[0], before[1], component),
                                        Complex64::from(1.0),
                                        -1.0,
                                    ),
                                    (dof(after[0], after[1], component), phase, 1.0),
                                ]
                            };
                        for (row, left, left_sign) in values(ends[p]) {
                            for (column, right, right_sign) in values(ends[q]) {
                                let product = left.conj() * right * weight;
                                let sign = left_sign * right_sign;
                                stiffness[(row, column)] += product * (k * sign);
                                mass[(row, column)] += product * (0.25 * m + opening_mass * sign);
                            }
                        }
                    }
                }
            }
        }
    }
    lowest_eigenvalues(stiffness, &mass, (medium.block.shear_speed / medium.period).powi(2), count)
}

/// Lowest eigenvalues of K x = ω² M x by subspace iteration with the shift −σ and Rayleigh–Ritz.
fn lowest_eigenvalues(
    stiffness: DMatrix<Complex64>,
    mass: &DMatrix<Complex64>,
    shift: f64,
    count: usize,
) -> Vec<f64> {
    let n = mass.nrows();
    let factors = (&stiffness + mass * Complex64::from(shift)).lu();
    let mut basis = DMatrix::from_fn(n, SUBSPACE_VECTORS, |i, j| {
        Complex64::from(((i + 1) as f64 * (j + 1) as f64 * 0.7).sin())
    });
    for _ in 0..SUBSPACE_STEPS {
        basis = factors.solve(&(mass * basis)).expect("regular").qr().q();
    }
    let [k, m] = [&stiffness, mass].map(|matrix| basis.adjoint() * matrix * &basis);
    let lower = Cholesky::new(m).expect("positive definite").unpack();
    let half = lower.solve_lower_triangular(&k).expect("regular");
    let symbol = lower.solve_lower_triangular(&half.adjoint()).expect("regular");
    let mut values: Vec<f64> = symbol.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values.truncate(count);
    values
}

/// Values extrapolated to vanishing mesh width from four meshes, with errors h², h² log h (corners of blocks) and h⁴.
pub fn extrapolate(meshes: [usize; 4], values: [f64; 4]) -> f64 {
    let matrix = DMatrix::from_fn(4, 4, |row, column| {
        let h = 1.0 / meshes[row] as f64;
        [1.0, h * h, h * h * h.ln(), h.powi(4)][column]
    });
    let right = DMatrix::from_column_slice(4, 1, &values);
    matrix.lu().solve(&right).expect("regular")[0]
}
