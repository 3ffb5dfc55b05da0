//! Closest-point projections against the conic solver Clarabel.

use crate::projection::interlayer::{
    DegenerateKind, random_interlayer_set, random_plane_solid, strengths_and_frictions,
};
use crate::projection::mises::{
    YIELD_SET_CASES, bulk_modulus, eigenspace_stiffnesses, eigenspace_weights, mean_stress,
    random_mises_set, random_stress, scale_stress, twice_elastic_energy,
};
use crate::projection::random_solids::random_solid;
use crate::support::{RandomNumbers, draw_log_uniform};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT,
    SolverStatus, SupportedConeT,
};
use wellposed_models::solid::stress::Stress;

/// Solves min ½|w − w̄|² subject to Aw + t = b with t in the product of `cones`; `center` is w̄, `rows` holds the rows
/// of A.
fn solve_conic_program(
    center: &[f64],
    rows: &[Vec<f64>],
    b: &[f64],
    cones: &[SupportedConeT<f64>],
) -> Vec<f64> {
    let n = center.len();
    let a = CscMatrix::from(rows);
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-10)
        .tol_gap_rel(1e-10)
        .tol_feas(1e-10)
        .build()
        .unwrap();
    let q: Vec<f64> = center.iter().map(|x| -x).collect();
    let mut solver =
        DefaultSolver::new(&CscMatrix::identity(n), &q, &a, b, cones, settings).unwrap();
    solver.solve();
    assert!(
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
        "{:?}",
        solver.solution.status
    );
    solver.solution.x.clone()
}

fn half_squared_distance(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>()
}

/// Relative excess of the objective at `own` over the objective at `solver_solution`, and the distance between these
/// two points.
fn compare_solutions(own: &[f64], solver_solution: &[f64], center: &[f64]) -> (f64, f64) {
    let (objective, reference) =
        (half_squared_distance(own, center), half_squared_distance(solver_solution, center));
    (
        (objective - reference) / reference,
        (2.0 * half_squared_distance(own, solver_solution)).sqrt(),
    )
}

/// Orthonormal basis of 3×3 matrices: five symmetric deviators, three antisymmetric matrices, and δ/√3 with
/// the unit matrix δ.
fn matrix_basis() -> [[[f64; 3]; 3]; 9] {
    let mut basis = [[[0.0; 3]; 3]; 9];
    let half = 0.5f64.sqrt();
    for (number, (i, j)) in [(0, 1), (1, 2), (0, 2)].into_iter().enumerate() {
        (basis[number][i][j], basis[number][j][i]) = (half, half);
        (basis[5 + number][i][j], basis[5 + number][j][i]) = (half, -half);
    }
    (basis[3][0][0], basis[3][1][1]) = (half, -half);
    let sixth = 6f64.sqrt().recip();
    (basis[4][0][0], basis[4][1][1], basis[4][2][2]) = (sixth, sixth, -2.0 * sixth);
    for i in 0..3 {
        basis[8][i][i] = 3f64.sqrt().recip();
    }
    basis
}

/// Projections onto cones of Mises type agree with the solution of the second-order cone program.
#[test]
fn mises_projections_agree_with_a_conic_solver() {
    let basis = matrix_basis();
    let (mut max_objective, mut max_distance) = (f64::NEG_INFINITY, 0.0f64);
    let mut random = RandomNumbers::new(31);
    let mut compared = 0;
    while compared < 300 {
        let (_, theory, cone, micropolar) = YIELD_SET_CASES[compared % YIELD_SET_CASES.len()];
        let solid = random_solid(&mut random, theory);
        let set = random_mises_set(&mut random, cone, micropolar);
        let trial = random_stress(&mut random, &set, &solid);
        let trial = scale_stress(&trial, draw_log_uniform(&mut random, 0.0, 2.0));
        let value = set.equivalent_shear(&trial) + set.friction * mean_stress(&trial);
        if value < 1.5 * set.strength {
            continue;
        }
        let scale = twice_elastic_energy(&solid, &trial).sqrt();
        let (d, p) = (eigenspace_stiffnesses(&solid), eigenspace_weights(&set));
        // Coordinates w in which the energy is ½|w|²: s = √D w in each eigenspace with the stiffness D; below they are
        // divided by `scale`, the norm |w̄| of the trial stress.
        let eigenspace = |number: usize| match number {
            0..5 => Some(0),
            5..8 => Some(1),
            8 => None,
            9..14 => Some(2),
            17 => Some(3),
            _ => Some(4),
        };
        let stiffness =
            |number: usize| eigenspace(number).map_or(3.0 * bulk_modulus(&solid), |part| d[part]);
        let used: Vec<usize> = (0..18).filter(|&n| stiffness(n) > 0.0).collect();
        let coordinates = |stress: &Stress| -> Vec<f64> {
            let along = |&n: &usize| {
                let tensor = if n < 9 { &stress.force } else { &stress.couple };
                let matrix = &basis[n % 9];
                let sum: f64 = (0..9).map(|i| tensor[i / 3][i % 3] * matrix[i / 3][i % 3]).sum();
                sum / stiffness(n).sqrt() / scale
            };
            used.iter().map(along).collect()
        };
        let strength = set.strength / scale;
        let size = used
            .iter()
            .filter_map(|&n| eigenspace(n).map(|part| (0.5 * p[part] * d[part]).sqrt()))
            .fold(0.0, f64::max);
        // The vector (k − κσ_m, √(½p) s, …) must be in the second-order cone; its rows are divided by the largest
        // coefficient.
        let mut rows = vec![vec![0.0; used.len()]; 1 + used.len()];
        let mut b = vec![0.0; 1 + used.len()];
        b[0] = strength / size;
        for (column, &n) in used.iter().enumerate() {
            match eigenspace(n) {
                None => rows[0][column] = set.friction * bulk_modulus(&solid).sqrt() / size,
                Some(part) => rows[1 + column][column] = -(0.5 * p[part] * d[part]).sqrt() / size,
            }
        }
        let center = coordinates(&trial);
        let solver_solution =
            solve_conic_program(&center, &rows, &b, &[SecondOrderConeT(1 + used.len())]);
        let own = coordinates(&set.project(&solid, &trial).stress);
        let (objective, distance) = compare_solutions(&own, &solver_solution, &center);
        assert!(objective <= 1e-9, "{objective:e}: {set:?} {solid:?} {trial:?}");
        assert!(distance <= 1e-4, "{distance:e}: {set:?} {solid:?} {trial:?}");
        (max_objective, max_distance) = (max_objective.max(objective), max_distance.max(distance));
        compared += 1;
    }
    println!("Mises: objective at most {max_objective:e} above, stresses {max_distance:e} apart");
}

/// Projections onto interlayer sets agree with the solution of the quadratic program by the conic solver.
#[test]
fn interlayer_projections_agree_with_a_conic_solver() {
    let (mut max_objective, mut max_distance) = (f64::NEG_INFINITY, 0.0f64);
    let mut random = RandomNumbers::new(32);
    let mut compared = 0;
    while compared < 400 {
        let kind = compared % 4;
        let (solid, metric) = random_plane_solid(&mut random, kind);
        let degenerate =
            [DegenerateKind::Regular, DegenerateKind::CommonApex][random.uniform_index(2)];
        let set = random_interlayer_set(&mut random, degenerate, solid.couple_modulus.is_some());
        let mut trial: [f64; 6] = std::array::from_fn(|i| match i {
            0..4 => set.shear_strength * random.uniform(-1.0, 1.0),
            _ => set.couple.map_or(0.0, |c| c.strength * random.uniform(-1.0, 1.0)),
        });
        if solid.is_classical {
            trial[3] = trial[2];
        }
        let size = draw_log_uniform(&mut random, 0.0, 2.0);
        trial = trial.map(|x| x * size);
        let stress = set.project(&metric, &trial).stress;
        let scale = solid.energy_norm(&trial);
        if solid.energy_norm(&std::array::from_fn(|i| trial[i] - stress[i])) < 0.1 * scale {
            continue;
        }
        // Orthonormal coordinates in the energy norm: sums and differences of stresses times square roots of
        // compliances.
        let roots = |[a, b]: [f64; 2]| [(0.5 * (a - b)).sqrt(), (0.5 * (a + b)).sqrt()];
        let ([ns, nd], [ss, sd]) =
            (roots(solid.normal_compliances), roots(solid.shear_compliances));
        let couple = solid.couple_modulus.map_or(0.0, |a| a.recip().sqrt());
        let coordinates = |s: &[f64; 6]| -> Vec<f64> {
            let mut all = vec![ns * (s[0] + s[1]), nd * (s[0] - s[1]), ss * (s[2] + s[3])];
            if !solid.is_classical {
                all.push(sd * (s[2] - s[3]));
            }
            if solid.couple_modulus.is_some() {
                all.extend([couple * s[4], couple * s[5]]);
            }
            all.iter().map(|x| x / scale).collect()
        };
        // Rows of the conditions in these coordinates, from the stresses that correspond to the unit vectors.
        let n = coordinates(&trial).len();
        let stress_of = |coordinate: usize| -> [f64; 6] {
            let mut s = [0.0; 6];
            match (coordinate, solid.is_classical) {
                (0, _) => (s[0], s[1]) = (0.5 / ns, 0.5 / ns),
                (1, _) => (s[0], s[1]) = (0.5 / nd, -0.5 / nd),
                (2, _) => (s[2], s[3]) = (0.5 / ss, 0.5 / ss),
                (3, false) => (s[2], s[3]) = (0.5 / sd, -0.5 / sd),
                (other, _) => s[other] = couple.recip(),
            }
            s
        };
        let [[tau, kappa_tau], [m, kappa_m]] = strengths_and_frictions(&set);
        let (mut rows, mut b) = (Vec::new(), Vec::new());
        for face in 0..2 {
            for (strength, friction, own, limited) in
                [(tau, kappa_tau, 2 + face, true), (m, kappa_m, 4 + face, set.couple.is_some())]
            {
                for sign in [1.0, -1.0] {
                    if limited {
                        let row: Vec<f64> = (0..n)
                            .map(stress_of)
                            .map(|s| friction * s[face] + sign * s[own])
                            .collect();
                        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
                        rows.push(row.iter().map(|x| x / norm).collect::<Vec<f64>>());
                        b.push(strength / norm / scale);
                    }
                }
            }
        }
        let center = coordinates(&trial);
        let solver_solution = solve_conic_program(&center, &rows, &b, &[NonnegativeConeT(b.len())]);
        let own = coordinates(&stress);
        let (objective, distance) = compare_solutions(&own, &solver_solution, &center);
        assert!(objective <= 1e-9, "{objective:e}: {set:?} {solid:?} {trial:?}");
        assert!(distance <= 1e-4, "{distance:e}: {set:?} {solid:?} {trial:?}");
        (max_objective, max_distance) = (max_objective.max(objective), max_distance.max(distance));
        compared += 1;
    }
    println!(
        "interlayer: objective at most {max_objective:e} above, stresses {max_distance:e} apart"
    );
}
