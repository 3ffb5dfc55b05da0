//! Vectorised return mapping of total stresses: bits of the scalar projection, and the closest stress of the yield set
//! as computed by a conic solver.

use crate::support::noise;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SecondOrderConeT, SolverStatus,
};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::solid::stress::Stress;
use models::solid::waves::Field;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{Interlayer, InterlayerCouple, Mises};
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::simd::Instructions;

/// Reproducible generator of random choices.
struct Chance(u64);

impl Chance {
    /// Returns a random number in [0, 1).
    fn number(&mut self) -> f64 {
        self.0 += 1;
        0.5 * noise(self.0) + 0.5
    }

    fn below(&mut self, count: usize) -> usize {
        (self.number() * count as f64) as usize
    }

    fn one_of<N: Copy>(&mut self, all: &[N]) -> N {
        all[self.below(all.len())]
    }
}

fn solid(theory: Theory, factor: f64) -> Isotropic {
    let couple = CoupleModuli { beta: 0.3 * factor, gamma: 0.7 * factor, eta: 0.45 * factor };
    let couple = (theory == Theory::Cosserat).then_some(couple);
    let rotation = Microrotation { alpha: 0.6 * factor, inertia: 0.37, couple };
    let rotation = (theory != Theory::Classical).then_some(rotation);
    Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, rotation).expect("sound moduli")
}

/// Returns a medium with a yield set of a kind, or without one (kind 0).
fn medium<const D: usize>(chance: &mut Chance, theory: Theory, kind: usize) -> Medium {
    let factor = chance.one_of(&[1.0, 0.3, 2.3]);
    let strength = chance.one_of(&[0.02, 0.1, 0.1, 0.5]);
    let friction = chance.one_of(&[0.0, 0.2, 0.5, 1.5]);
    let own = Medium::new(solid(theory, factor), D);
    let cone = Mises::drucker_prager(strength, friction, friction);
    let is_cosserat = theory == Theory::Cosserat;
    own.clone().yielding(match kind {
        0 => return own,
        1 => YieldSet::from(cone),
        2 => YieldSet::from(Mises {
            antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
            symmetric_length: is_cosserat.then_some(0.9),
            antisymmetric_length: is_cosserat.then_some(0.7),
            ..cone
        }),
        _ => YieldSet::from(Interlayer {
            shear_strength: strength,
            shear_friction: friction,
            shear_dilatancy: friction,
            couple: is_cosserat.then_some(InterlayerCouple {
                strength: 0.8 * strength,
                friction: 0.3,
                dilatancy: 0.3,
            }),
        }),
    })
}

/// Returns a random problem in which total stresses are mapped.
fn problem<const D: usize>(chance: &mut Chance) -> Problem<D> {
    let theory = chance.one_of(&[Theory::Classical, Theory::Reduced, Theory::Cosserat]);
    let kinds: &[usize] = match (D, chance.below(3)) {
        (2, 0) => &[1, 3],
        (2, 1) => &[0, 1, 2, 3],
        _ => &[2, 0],
    };
    let media: Vec<Medium> = kinds.iter().map(|kind| medium::<D>(chance, theory, *kind)).collect();
    let cells: [usize; D] = std::array::from_fn(|axis| match axis {
        0 => chance.one_of(&[1, 7, 15, 16, 30, 47, 130]),
        _ => chance.one_of(&[3, 5, 8]),
    });
    let grid = Grid { cells, spacing: [0.1; D] };
    // Media by layers normal to the last axis, by stripes of five cells across the first axis, or at random.
    let (kind, count) = (chance.below(3), media.len());
    let of = |cell: usize| match kind {
        0 => cell / (grid.count() / cells[D - 1]) % count,
        1 => cell % cells[0] / 5 % count,
        _ => ((0.5 * noise(77 + cell as u64) + 0.5) * count as f64) as usize,
    };
    let of_cell = (0..grid.count()).map(|cell| of(cell) as u16).collect();
    let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
    let mut plastic_step =
        chance.one_of(&[PlasticStep::ReturnMapping, PlasticStep::MidpointReflection]);
    let stress = chance.below(4);
    if stress == 0 && !kinds.contains(&3) {
        plastic_step = PlasticStep::MidpointReflection;
    }
    let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::Limited, plastic_step);
    let mut problem = Problem::new(grid, media, of_cell, sides, 1.8 * 0.1 / speed, scheme);
    let axis = [0, D - 1, 1][stress % 3];
    let layers = |layer: usize| {
        let mut own = Stress::default();
        for i in 0..3 {
            own.force[i][i] = -0.05 * layer as f64 - 0.01 * i as f64;
        }
        if stress == 2 {
            own.force[0][1] = 0.01;
            own.force[1][0] = if theory == Theory::Classical { 0.01 } else { 0.015 };
            own.force[0][2] = 0.005;
            own.force[2][0] = 0.005;
        }
        own
    };
    if stress > 0 {
        problem.initial_stress = Some((axis, (0..cells[axis]).map(layers).collect()));
    }
    problem
}

fn run<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    seed: u64,
    instructions: Instructions,
    one_by_one: bool,
) -> Snapshot<T> {
    let mut split: DecomposedDomain<T, D> =
        DecomposedDomain::new(problem, 1).expect("a sound problem");
    split.set_instructions(instructions);
    if one_by_one {
        split.map_stresses_one_by_one();
    }
    let count = problem.grid.count();
    for (index, field) in split.fields().to_vec().into_iter().enumerate() {
        // Some values are zeros, of either sign.
        let value = |cell: usize| {
            let own = noise(seed + (index * count + cell) as u64);
            T::from_f64(if own.abs() < 0.2 { 0.0 * own } else { 0.7 * own })
        };
        split.set(field, &(0..count).map(value).collect::<Vec<_>>());
    }
    split.advance(5);
    split.snapshot()
}

fn same<T: SolverReal, const D: usize>(first: u64) {
    let bits = |all: &[Vec<T>]| -> Vec<u64> {
        all.iter().flatten().map(|value| value.to_f64().to_bits()).collect()
    };
    let (mut yielding, mut released) = (0, 0);
    for number in first..first + 40 {
        let mut chance = Chance(number << 32);
        let problem = problem::<D>(&mut chance);
        let seed = chance.0 + (1 << 30);
        let expected: Snapshot<T> = run(&problem, seed, Instructions::Baseline, true);
        let lost = expected.sums[0].iter().filter(|lost| **lost > 0.0).count();
        yielding += usize::from(4 * lost > expected.sums[0].len());
        released += usize::from(expected.sums[1].iter().any(|own| *own != 0.0));
        for instructions in Instructions::available() {
            let found: Snapshot<T> = run(&problem, seed, instructions, false);
            let what = format!("problem {number}, {instructions:?}");
            assert!(bits(&expected.fields) == bits(&found.fields), "{what}: fields");
            assert_eq!(expected.sums, found.sums, "{what}");
            assert_eq!(expected.work, found.work, "{what}");
        }
    }
    assert!(yielding > 10 && released > 5, "{yielding} yield, {released} have initial stress");
}

#[test]
fn lanes_have_the_bits_of_single_stresses_in_the_plane() {
    same::<f64, 2>(0);
}

#[test]
fn lanes_have_the_bits_of_single_stresses_in_space() {
    same::<f64, 3>(1000);
}

#[test]
fn lanes_have_the_bits_of_single_stresses_in_single_precision() {
    same::<f32, 2>(2000);
}

/// Stress components σ₁₁, σ₂₂, σ₃₃, σ₁₂, Pa.
type Plane = [f64; 4];

/// Computes the compliance of an isotropic solid, 1/Pa: the energy density ½s·Cs is (σ:σ − λ/(3λ + 2μ) tr²)/4μ.
fn compliance(solid: &Isotropic) -> [Plane; 4] {
    let share = solid.lambda / (3.0 * solid.lambda + 2.0 * solid.mu);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match (i, j) {
            (3, 3) => 1.0 / solid.mu,
            (3, _) | (_, 3) => 0.0,
            _ => (f64::from(u8::from(i == j)) - share) / (2.0 * solid.mu),
        })
    })
}

fn energy(compliance: &[Plane; 4], stress: &Plane) -> f64 {
    let rows = compliance.iter().zip(stress);
    0.5 * rows
        .map(|(row, s)| s * row.iter().zip(stress).map(|(c, t)| c * t).sum::<f64>())
        .sum::<f64>()
}

/// Computes the stress of a cone closest to a trial stress in the energy norm, with a conic solver.
fn nearest(solid: &Isotropic, set: &Mises, trial: &Plane) -> Plane {
    let own = compliance(solid);
    let matrix: Vec<Vec<f64>> = own
        .iter()
        .enumerate()
        .map(|(i, row)| {
            row.iter().enumerate().map(|(j, c)| if i <= j { *c } else { 0.0 }).collect()
        })
        .collect();
    let q: Vec<f64> =
        own.iter().map(|row| -row.iter().zip(trial).map(|(c, s)| c * s).sum::<f64>()).collect();
    // b − A s = (k − κσ_m, terms of τ̄) in the second-order cone.
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
fn mapped_whole_stresses_are_the_nearest_of_a_conic_solver() {
    let solid = solid(Theory::Classical, 1.0);
    let compliance = compliance(&solid);
    let (mut mapped, mut apex) = (0, 0);
    for friction in [0.0, 0.4, 1.2] {
        let set = Mises::drucker_prager(0.3, friction, friction);
        let medium = Medium::new(solid, 2).yielding(YieldSet::from(set));
        let grid = Grid { cells: [17, 6], spacing: [0.1; 2] };
        let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let step = 0.1 / medium.greatest_speed();
        let mut problem =
            Problem::new(grid, vec![medium], vec![0; grid.count()], sides, step, scheme);
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
            let is_normal = matches!(field, Field::Stress(i, j) if i == j);
            let value = |cell: usize| {
                let tension = if is_normal && cell.is_multiple_of(3) { 2.0 } else { 0.0 };
                tension + 1.5 * noise((1000 * index + cell) as u64)
            };
            domain.set(field, &(0..grid.count()).map(value).collect::<Vec<_>>());
        }
        let plane = |stress: &Stress| -> Plane {
            [stress.force[0][0], stress.force[1][1], stress.force[2][2], stress.force[0][1]]
        };
        let after = domain.admissible();
        for cell in 0..grid.count() {
            let trial = plane(&domain.total_stress(cell));
            let own = plane(&after.total_stress(cell));
            let distance =
                |s: &Plane| energy(&compliance, &std::array::from_fn(|i| s[i] - trial[i]));
            let theirs = nearest(&solid, &set, &trial);
            let scale = energy(&compliance, &trial);
            // As close as the solution of the conic solver, and in the set: the closest stress is unique.
            let excess = (distance(&own) - distance(&theirs)) / scale;
            assert!(excess <= 1e-9, "{excess:e} at {trial:?}");
            let mean = (own[0] + own[1] + own[2]) / 3.0;
            let squares = [own[0] - own[1], own[1] - own[2], own[2] - own[0]];
            let shear = squares.map(|d| d * d / 6.0).iter().sum::<f64>() + own[3] * own[3];
            let value = shear.sqrt() + friction * mean - set.strength;
            assert!(value <= 1e-13 * (1.0 + trial[0].abs()), "{value:e} beyond at {trial:?}");
            mapped += usize::from(own != trial);
            apex += usize::from(own != trial && shear < 1e-20);
        }
    }
    assert!(mapped > 100 && apex > 3, "{mapped} mapped, {apex} to the apex");
}
