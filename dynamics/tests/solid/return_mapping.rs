//! Vectorised return mapping of total stresses: bit-identical to the scalar projection, and equal to the closest stress
//! of the yield set as computed by a conic solver.

use crate::support::media::{isotropic, scaled_isotropic};
use crate::support::noise;
use crate::support::random::NoiseSequence;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SecondOrderConeT, SolverStatus,
};
use models::solid::parameters::{Isotropic, Theory};
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::simd::InstructionSet;

/// Returns a medium with a yield set given by `kind`: 0 none, 1 a Drucker–Prager cone, 2 a Mises-type cone that depends
/// on antisymmetric and couple stresses where the theory has them, otherwise an interlayer set.
fn random_medium<const D: usize>(
    random: &mut NoiseSequence,
    theory: Theory,
    kind: usize,
) -> Medium {
    let factor = random.choose(&[1.0, 0.3, 2.3]);
    let strength = random.choose(&[0.02, 0.1, 0.1, 0.5]);
    let friction = random.choose(&[0.0, 0.2, 0.5, 1.5]);
    let medium = Medium::new(scaled_isotropic(theory, factor), D);
    let cone = Mises::new_drucker_prager(strength, friction, friction);
    let is_cosserat = theory == Theory::Cosserat;
    medium.clone().with_yield_set(match kind {
        0 => return medium,
        1 => YieldSet::from(cone),
        2 => YieldSet::from(Mises {
            antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
            symmetric_internal_length: is_cosserat.then_some(0.9),
            antisymmetric_internal_length: is_cosserat.then_some(0.7),
            ..cone
        }),
        _ => YieldSet::from(InterlayerYieldSet {
            shear_strength: strength,
            shear_friction: friction,
            shear_dilatancy: friction,
            couple: is_cosserat.then_some(InterlayerCoupleLimits {
                strength: 0.8 * strength,
                friction: 0.3,
                dilatancy: 0.3,
            }),
        }),
    })
}

/// Returns a random problem with yielding media; three of four problems have an initial stress.
fn random_problem<const D: usize>(random: &mut NoiseSequence) -> Problem<D> {
    let theory = random.choose(&[Theory::Classical, Theory::Reduced, Theory::Cosserat]);
    let kinds: &[usize] = match (D, random.uniform_index(3)) {
        (2, 0) => &[1, 3],
        (2, 1) => &[0, 1, 2, 3],
        _ => &[2, 0],
    };
    let media: Vec<Medium> =
        kinds.iter().map(|kind| random_medium::<D>(random, theory, *kind)).collect();
    let cells: [usize; D] = std::array::from_fn(|axis| match axis {
        0 => random.choose(&[1, 7, 15, 16, 30, 47, 130]),
        _ => random.choose(&[3, 5, 8]),
    });
    let grid = Grid { cells, spacing: [0.1; D] };
    // Media by layers normal to the last axis, by stripes of five cells across the first axis, or at random.
    let (kind, count) = (random.uniform_index(3), media.len());
    let medium_index = |cell: usize| match kind {
        0 => cell / (grid.count() / cells[D - 1]) % count,
        1 => cell % cells[0] / 5 % count,
        _ => ((0.5 * noise(77 + cell as u64) + 0.5) * count as f64) as usize,
    };
    let cell_media = (0..grid.count()).map(|cell| medium_index(cell) as u16).collect();
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let mut plastic_step =
        random.choose(&[PlasticStep::ReturnMapping, PlasticStep::MidpointReflection]);
    let stress = random.uniform_index(4);
    if stress == 0 && !kinds.contains(&3) {
        plastic_step = PlasticStep::MidpointReflection;
    }
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::Limited, plastic_step);
    let mut problem = Problem::new(grid, media, cell_media, boundaries, 1.8 * 0.1 / speed, scheme);
    let axis = [0, D - 1, 1][stress % 3];
    let layers = |layer: usize| {
        let mut layer_stress = Stress::default();
        for i in 0..3 {
            layer_stress.force[i][i] = -0.05 * layer as f64 - 0.01 * i as f64;
        }
        if stress == 2 {
            layer_stress.force[0][1] = 0.01;
            layer_stress.force[1][0] = if theory == Theory::Classical { 0.01 } else { 0.015 };
            layer_stress.force[0][2] = 0.005;
            layer_stress.force[2][0] = 0.005;
        }
        layer_stress
    };
    if stress > 0 {
        problem.initial_stress = Some((axis, (0..cells[axis]).map(layers).collect()));
    }
    problem
}

fn run_solver<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    seed: u64,
    instructions: InstructionSet,
    is_scalar: bool,
) -> Snapshot<T> {
    let mut decomposed: DecomposedDomain<T, D> =
        DecomposedDomain::new(problem, 1).expect("a sound problem");
    decomposed.set_instructions(instructions);
    if is_scalar {
        decomposed.use_scalar_mapping();
    }
    let count = problem.grid.count();
    for (index, field) in decomposed.fields().to_vec().into_iter().enumerate() {
        // Some values are zeros, of either sign.
        let value = |cell: usize| {
            let sample = noise(seed + (index * count + cell) as u64);
            T::from_f64(if sample.abs() < 0.2 { 0.0 * sample } else { 0.7 * sample })
        };
        decomposed.set_field(field, &(0..count).map(value).collect::<Vec<_>>());
    }
    decomposed.advance(5).expect("threads");
    decomposed.snapshot()
}

fn compare_vector_and_scalar_mapping<T: SolverReal, const D: usize>(first: u64) {
    let bits = |all: &[Vec<T>]| -> Vec<u64> {
        all.iter().flatten().map(|value| value.to_f64().to_bits()).collect()
    };
    let (mut yielding, mut with_initial_stress) = (0, 0);
    for number in first..first + 40 {
        let mut random = NoiseSequence::new(number << 32);
        let problem = random_problem::<D>(&mut random);
        let seed = random.seed() + random.drawn_count() + (1 << 30);
        let expected: Snapshot<T> = run_solver(&problem, seed, InstructionSet::Baseline, true);
        let yielded = expected.cell_sums[0].iter().filter(|own| **own > 0.0).count();
        yielding += usize::from(4 * yielded > expected.cell_sums[0].len());
        with_initial_stress += usize::from(expected.cell_sums[1].iter().any(|own| *own != 0.0));
        for instructions in InstructionSet::available_sets() {
            let found: Snapshot<T> = run_solver(&problem, seed, instructions, false);
            let label = format!("problem {number}, {instructions:?}");
            assert!(bits(&expected.fields) == bits(&found.fields), "{label}: fields");
            assert_eq!(expected.cell_sums, found.cell_sums, "{label}");
            assert_eq!(expected.work_sums, found.work_sums, "{label}");
        }
    }
    assert!(
        yielding > 10 && with_initial_stress > 5,
        "{yielding} yield, {with_initial_stress} have initial stress"
    );
}

#[test]
fn vectorised_return_mapping_equals_the_scalar_one_in_the_plane() {
    compare_vector_and_scalar_mapping::<f64, 2>(0);
}

#[test]
fn vectorised_return_mapping_equals_the_scalar_one_in_space() {
    compare_vector_and_scalar_mapping::<f64, 3>(1000);
}

#[test]
fn vectorised_return_mapping_equals_the_scalar_one_in_single_precision() {
    compare_vector_and_scalar_mapping::<f32, 2>(2000);
}

/// Stress components σ₁₁, σ₂₂, σ₃₃, σ₁₂, Pa.
type PlaneStrainStress = [f64; 4];

/// Computes the compliance C of an isotropic solid, 1/Pa. The energy density of the stress s is
/// ½s·Cs = (σ:σ − λ/(3λ + 2μ) (tr σ)²)/4μ.
fn compliance(solid: &Isotropic) -> [PlaneStrainStress; 4] {
    let share = solid.lambda / (3.0 * solid.lambda + 2.0 * solid.mu);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match (i, j) {
            (3, 3) => 1.0 / solid.mu,
            (3, _) | (_, 3) => 0.0,
            _ => (f64::from(u8::from(i == j)) - share) / (2.0 * solid.mu),
        })
    })
}

fn energy_density(compliance: &[PlaneStrainStress; 4], stress: &PlaneStrainStress) -> f64 {
    let rows = compliance.iter().zip(stress);
    0.5 * rows
        .map(|(row, s)| s * row.iter().zip(stress).map(|(c, t)| c * t).sum::<f64>())
        .sum::<f64>()
}

/// Computes the stress of a yield cone closest to a trial stress in the energy norm, with a conic solver.
fn find_closest_stress(
    solid: &Isotropic,
    set: &Mises,
    trial: &PlaneStrainStress,
) -> PlaneStrainStress {
    let stress_compliance = compliance(solid);
    let matrix: Vec<Vec<f64>> = stress_compliance
        .iter()
        .enumerate()
        .map(|(i, row)| {
            row.iter().enumerate().map(|(j, c)| if i <= j { *c } else { 0.0 }).collect()
        })
        .collect();
    let q: Vec<f64> = stress_compliance
        .iter()
        .map(|row| -row.iter().zip(trial).map(|(c, s)| c * s).sum::<f64>())
        .collect();
    // b − A s = (k − κσ_m, components of the shear intensity τ̄) lies in the second-order cone: τ̄ ≤ k − κσ_m, with the
    // strength k, the friction κ and the mean stress σ_m.
    let (third, sixth) = (set.friction / 3.0, (1.0f64 / 6.0).sqrt());
    let a = CscMatrix::from(&[
        [third, third, third, 0.0],
        [-sixth, sixth, 0.0, 0.0],
        [0.0, -sixth, sixth, 0.0],
        [sixth, 0.0, -sixth, 0.0],
        [0.0, 0.0, 0.0, -1.0],
    ]);
    let b = [set.strength, 0.0, 0.0, 0.0, 0.0];
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-11)
        .tol_gap_rel(1e-11)
        .tol_feas(1e-11)
        .build()
        .expect("sound settings");
    let p = CscMatrix::from(&matrix);
    let mut solver = DefaultSolver::new(&p, &q, &a, &b, &[SecondOrderConeT(5)], settings)
        .expect("a sound problem");
    solver.solve();
    let status = solver.solution.status;
    assert!(matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved), "{status:?}");
    std::array::from_fn(|i| solver.solution.x[i])
}

#[test]
fn mapped_total_stresses_are_the_closest_by_a_conic_solver() {
    let solid = isotropic(Theory::Classical, 1.0);
    let compliance = compliance(&solid);
    let (mut mapped_count, mut apex_count) = (0, 0);
    for friction in [0.0, 0.4, 1.2] {
        let set = Mises::new_drucker_prager(0.3, friction, friction);
        let medium = Medium::new(solid, 2).with_yield_set(YieldSet::from(set));
        let grid = Grid { cells: [17, 6], spacing: [0.1; 2] };
        let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let step = 0.1 / medium.max_speed();
        let mut problem =
            Problem::new(grid, vec![medium], vec![0; grid.count()], boundaries, step, scheme);
        let stress = |layer: usize| {
            let mut stress = Stress::default();
            for i in 0..3 {
                stress.force[i][i] = -0.2 * layer as f64 - 0.02 * i as f64;
            }
            stress
        };
        problem.initial_stress = Some((1, (0..6).map(stress).collect()));
        let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("a sound problem");
        for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
            // A third of the cells is in tension; some of them return to the apex.
            let is_normal = matches!(field, SolidField::Stress(i, j) if i == j);
            let value = |cell: usize| {
                let tension = if is_normal && cell.is_multiple_of(3) { 2.0 } else { 0.0 };
                tension + 1.5 * noise((1000 * index + cell) as u64)
            };
            domain.set_field(field, &(0..grid.count()).map(value).collect::<Vec<_>>());
        }
        let plane = |stress: &Stress| -> PlaneStrainStress {
            [stress.force[0][0], stress.force[1][1], stress.force[2][2], stress.force[0][1]]
        };
        let after = domain.to_admissible();
        for cell in 0..grid.count() {
            let trial = plane(&domain.total_stress(cell));
            let mapped_stress = plane(&after.total_stress(cell));
            let distance = |s: &PlaneStrainStress| {
                energy_density(&compliance, &std::array::from_fn(|i| s[i] - trial[i]))
            };
            let conic_stress = find_closest_stress(&solid, &set, &trial);
            let scale = energy_density(&compliance, &trial);
            // The mapped stress is as close as that of the conic solver, and in the yield set: the closest stress is
            // unique.
            let excess = (distance(&mapped_stress) - distance(&conic_stress)) / scale;
            assert!(excess <= 1e-9, "{excess:e} at {trial:?}");
            let mean = (mapped_stress[0] + mapped_stress[1] + mapped_stress[2]) / 3.0;
            let squares = [
                mapped_stress[0] - mapped_stress[1],
                mapped_stress[1] - mapped_stress[2],
                mapped_stress[2] - mapped_stress[0],
            ];
            let shear = squares.map(|d| d * d / 6.0).iter().sum::<f64>()
                + mapped_stress[3] * mapped_stress[3];
            let value = shear.sqrt() + friction * mean - set.strength;
            assert!(value <= 1e-13 * (1.0 + trial[0].abs()), "{value:e} beyond at {trial:?}");
            mapped_count += usize::from(mapped_stress != trial);
            apex_count += usize::from(mapped_stress != trial && shear < 1e-20);
        }
    }
    assert!(
        mapped_count > 100 && apex_count > 3,
        "{mapped_count} mapped, {apex_count} to the apex"
    );
}
