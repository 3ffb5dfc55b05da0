//! Blocks separated by interlayers: the fused solver against the reference solver, with domain decomposition, resumed
//! from snapshots, with all instruction sets; energy and its ledger; rigid motions.
//!
//! `ROUGH=1000 cargo test --release -p wellposed-dynamics --test solid blocks::` runs 1000 random problems per
//! dimension.

use crate::support::interlayers::{
    count_saturated_junctions, elastic_component, random_interlayers, set_shear_interval,
};
use crate::support::media::{classical, cosserat};
use crate::support::noise;
use crate::support::random::NoiseSequence;
use models::interface::Interval;
use models::interface::elastic::{ElasticComponent, ElasticLayer, ElasticMaterial};
use models::interface::opening_line::LayerMass;
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::domain::{Domain, SolverReal};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::Splitting;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::InstructionSet;
use wellposed_dynamics::solid::interface::{Interlayer, LineState, sweep_with_interlayers};
use wellposed_dynamics::solid::interlayers::{
    InterlayerLaw, InterlayerPlane, Interlayers, MAX_PAIRS, PlaneLaws,
};
use wellposed_dynamics::solid::line::{CellConstants, GHOSTS, HALO, Slopes};

/// Returns the indices of the random problems of a test: `count` of them, or as many as the environment variable
/// `ROUGH` states; `first` distinguishes the tests.
fn problem_indices(first: usize, count: usize) -> std::ops::Range<usize> {
    let requested = std::env::var("ROUGH").ok().and_then(|count| count.parse().ok());
    first * 1_000_000..first * 1_000_000 + requested.unwrap_or(count)
}

fn random_media(random: &mut NoiseSequence, dimensions: usize) -> Vec<Medium> {
    let classical = |factor| Medium::new(classical(factor), dimensions);
    let cosserat = |factor| Medium::new(cosserat(factor), dimensions);
    match random.uniform_index(4) {
        0 => vec![classical(1.0)],
        1 => vec![classical(1.0), classical(20.0)],
        2 => vec![cosserat(1.0)],
        _ => vec![cosserat(1.0), cosserat(0.2)],
    }
}

fn random_boundary(random: &mut NoiseSequence, medium: &Medium, axis: usize) -> Boundary {
    match random.uniform_index(5) {
        0 => Boundary::Fixed,
        1 => Boundary::NonReflecting,
        2 => Boundary::new_symmetry(medium, axis),
        3 => Boundary::ByPair(
            medium.pairs[axis]
                .iter()
                .map(|_| {
                    [Condition::Velocity(0.0), Condition::Traction(0.0)][random.uniform_index(2)]
                })
                .collect(),
        ),
        _ => Boundary::Free,
    }
}

/// Returns the random problem of an index, with interlayers across at least one axis, and its description.
pub(crate) fn random_block_problem<const D: usize>(number: usize) -> (Problem<D>, String) {
    let mut random = NoiseSequence::new((number as u64) << 40);
    let media = random_media(&mut random, D);
    let cell_counts = if D == 2 { [40, 29, 33, 24, 16] } else { [18, 13, 17, 12, 16] };
    let cells: [usize; D] = std::array::from_fn(|_| cell_counts[random.uniform_index(5)]);
    let grid =
        Grid { cells, spacing: std::array::from_fn(|_| [0.1, 0.13][random.uniform_index(2)]) };
    let boundaries: [[Boundary; 2]; D] =
        std::array::from_fn(|axis| match random.uniform_index(3) {
            0 => [Boundary::Periodic, Boundary::Periodic],
            _ => [0, 1].map(|_| random_boundary(&mut random, &media[0], axis)),
        });
    let courant = [0.4, 0.8, 1.0][random.uniform_index(3)];
    let scheme = Scheme::new(
        [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder][random.uniform_index(3)],
        PlasticStep::ReturnMapping,
    );
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = 2.0 * courant * 0.1 / speed;
    let cell_media = (0..grid.count()).map(|_| random.uniform_index(media.len()) as u16).collect();
    let mut interlayers = Vec::new();
    for axis in 0..D {
        if random.uniform_index(3) == 0 && !(interlayers.is_empty() && axis + 1 == D) {
            continue;
        }
        let block_cells = [1, 2, 3, 4, 5, 8, 10][random.uniform_index(7)];
        let (min_offset, count) = match boundaries[axis][0] == Boundary::Periodic {
            true => (0, cells[axis]),
            false => (3, cells[axis] - 5),
        };
        let mut offset = min_offset + random.uniform_index(block_cells.min(count));
        // Leave at least three cells after the last interlayer.
        let mut block_cells = block_cells;
        while min_offset > 0 && (cells[axis] - offset - 1) % block_cells < 2 {
            match offset + 1 < cells[axis] - 3 {
                true => offset += 1,
                false => (offset, block_cells) = (3, cells[axis]),
            }
        }
        let offset_and_block_cells = [offset, block_cells];
        interlayers.push(random_interlayers(
            &mut random,
            (axis, &cells),
            offset_and_block_cells,
            &media[0],
        ));
    }
    let mut problem =
        Problem { interlayers, ..Problem::new(grid, media, cell_media, boundaries, step, scheme) };
    set_shear_interval(&mut random, &mut problem);
    let Problem { boundaries, interlayers, shear_interval, .. } = &problem;
    let description = format!(
        "{number}: {cells:?}, {boundaries:?}, courant {courant}, shear interval {shear_interval}, {scheme:?}, {interlayers:?}"
    );
    (problem, description)
}

/// Returns a pseudo-random initial value of a field in a cell.
fn initial_value<T: SolverReal>(index: usize, cell: usize) -> T {
    T::from_f64(noise((index * 1_000_003 + cell) as u64))
}

fn build_fused_solver<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
) -> DecomposedDomain<T, D> {
    build_decomposed_solver(problem, [1; D])
}

fn build_decomposed_solver<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    subdomain_counts: [usize; D],
) -> DecomposedDomain<T, D> {
    let mut domain: DecomposedDomain<T, D> =
        DecomposedDomain::with_subdomains(0, problem, subdomain_counts).expect("sound");
    let cells = 0..problem.grid.count();
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        domain.set_field(
            field,
            &cells.clone().map(|cell| initial_value(index, cell)).collect::<Vec<T>>(),
        );
    }
    domain.initialise_interlayers();
    domain
}

/// Returns the reference solver in the initial state of [`build_fused_solver`].
fn build_reference_solver<T: SolverReal, const D: usize>(problem: &Problem<D>) -> Reference<T, D> {
    let mut solver: Reference<T, D> = Reference::new(problem).expect("sound");
    let cells = 0..problem.grid.count();
    for (index, field) in solver.fields().to_vec().into_iter().enumerate() {
        solver.set_field(
            field,
            &cells.clone().map(|cell| initial_value(index, cell)).collect::<Vec<T>>(),
        );
    }
    solver.initialise_interlayers();
    solver
}

fn snapshot_bits<T: SolverReal>(snapshot: &Snapshot<T>) -> Vec<u64> {
    let fields = snapshot.fields.iter().flatten().chain(&snapshot.interlayer_history);
    fields.map(|value| value.to_f64().to_bits()).collect()
}

fn domain_bits<T: SolverReal, const D: usize>(domain: &DecomposedDomain<T, D>) -> Vec<u64> {
    snapshot_bits(&domain.snapshot())
}

fn compare_fused_and_reference<T: SolverReal, const D: usize>(numbers: std::ops::Range<usize>) {
    for number in numbers {
        let (problem, description) = random_block_problem::<D>(number);
        let (mut fused, mut reference) =
            (build_fused_solver::<T, D>(&problem), build_reference_solver::<T, D>(&problem));
        assert!(!fused.interlayer_history().is_empty(), "{description}");
        let before = domain_bits(&fused);
        assert!(before == snapshot_bits(&reference.snapshot()), "{description}");
        for steps in [1, 2, 3] {
            fused.advance(steps).expect("threads");
            reference.advance(steps);
            assert!(domain_bits(&fused) == snapshot_bits(&reference.snapshot()), "{description}");
            assert_eq!(fused.energy(), reference.energy(), "{description}");
        }
        assert_eq!(fused.interlayer_history(), reference.interlayer_history());
        let history = fused.interlayer_history();
        assert!(history.iter().any(|value| value.to_f64() != 0.0), "{description}");
        assert!(domain_bits(&fused) != before);
        // Each solver resumes from a snapshot of the other.
        let mut resumed: Reference<T, D> = Reference::new(&problem).expect("sound");
        assert!(resumed.restore(&fused.snapshot()));
        assert!(fused.restore(&reference.snapshot()));
        fused.advance(2).expect("threads");
        resumed.advance(2);
        assert!(domain_bits(&fused) == snapshot_bits(&resumed.snapshot()), "{description}");
        let mut truncated = fused.snapshot();
        truncated.interlayer_history.pop();
        assert!(!resumed.restore(&truncated));
    }
}

#[test]
fn fused_solver_equals_the_reference_bit_by_bit() {
    compare_fused_and_reference::<f64, 2>(problem_indices(0, 15));
    compare_fused_and_reference::<f32, 2>(problem_indices(1, 6));
    compare_fused_and_reference::<f64, 3>(problem_indices(2, 4));
    compare_fused_and_reference::<f32, 3>(problem_indices(3, 2));
}

/// Compares decompositions of random problems; returns the number of junctions of saturated layers.
fn compare_decompositions<const D: usize>(numbers: std::ops::Range<usize>) -> usize {
    let mut junctions = 0;
    for number in numbers {
        let (problem, description) = random_block_problem::<D>(number);
        junctions += if D == 2 { count_saturated_junctions(&problem) } else { 0 };
        let mut whole = build_fused_solver::<f64, D>(&problem);
        let extra_halo = problem.pass_limits().first_axis_halo;
        let max_counts: [usize; D] = std::array::from_fn(|axis| {
            let halo = if axis == 0 { HALO + extra_halo } else { HALO };
            (problem.grid.cells[axis] / halo).max(1)
        });
        let cuts = [[1, 1, 2], [1, 1, 3], [2, 1, 1], [3, 1, 2], [2, 2, 1], [2, 2, 2]];
        let cuts = cuts.map(|[first, middle, last]| -> [usize; D] {
            std::array::from_fn(|axis| match axis {
                0 => first,
                _ if axis + 1 == D => last,
                _ => middle,
            })
        });
        let is_possible =
            |cut: &[usize; D]| cut.iter().zip(max_counts).all(|(own, max)| *own <= max);
        let cuts = cuts.into_iter().filter(is_possible);
        let mut decomposed: Vec<_> =
            cuts.map(|cut| build_decomposed_solver(&problem, cut)).collect();
        // Solvers in one subdomain with other instruction sets.
        let mut other_sets: Vec<_> = InstructionSet::available_sets()
            .map(|own| (own, build_fused_solver::<f64, D>(&problem)))
            .collect();
        // For odd indices, a pulse in a domain at rest: values of all magnitudes occur, and subnormals are flushed
        // during the run.
        let pulse = |own: &mut DecomposedDomain<f64, D>| {
            if number % 2 == 1 {
                for field in own.fields().to_vec() {
                    let initial_value = |cell: usize| if cell == 7 { 1.0 } else { 0.0 };
                    own.set_field(
                        field,
                        &(0..problem.grid.count()).map(initial_value).collect::<Vec<f64>>(),
                    );
                }
                own.initialise_interlayers();
            }
        };
        pulse(&mut whole);
        decomposed.iter_mut().for_each(pulse);
        other_sets.iter_mut().for_each(|own| pulse(&mut own.1));
        whole.advance(13).expect("threads");
        let snapshot = whole.snapshot();
        whole.advance(6).expect("threads");
        let (expected, ledger) = (domain_bits(&whole), whole.ledger());
        for own in &mut decomposed {
            own.advance(19).expect("threads");
            assert!(domain_bits(own) == expected, "{description}");
            assert_eq!(own.ledger(), ledger, "{description}");
            assert_eq!(own.energy(), whole.energy(), "{description}");
            own.initialise_interlayers();
            assert!(own.restore(&snapshot));
            own.advance(6).expect("threads");
            assert!(domain_bits(own) == expected, "{description}");
            assert_eq!(own.snapshot(), whole.snapshot());
        }
        for (instructions, own) in &mut other_sets {
            own.set_instructions(*instructions);
            own.advance(19).expect("threads");
            assert!(domain_bits(own) == expected, "{instructions:?}: {description}");
        }
    }
    junctions
}

#[test]
fn decompositions_snapshots_and_instruction_sets_give_the_same_bits() {
    check_decompositions([6, 2]);
}

#[test]
#[ignore = "takes half a minute"]
fn decompositions_of_many_problems_give_the_same_bits() {
    check_decompositions([30, 6]);
}

/// Checks `counts` random problems in the plane and in space.
fn check_decompositions(counts: [usize; 2]) {
    let junctions = compare_decompositions::<2>(problem_indices(4, counts[0]));
    // Rare in these problems: `saturated_cuts` cuts a medium with many junctions.
    println!("{junctions} junctions of saturated layers");
    compare_decompositions::<3>(problem_indices(5, counts[1]));
}

fn check_ledger<const D: usize>(numbers: std::ops::Range<usize>) {
    let (mut max_residual, mut max_change) = (0.0f64, 0.0f64);
    for number in numbers {
        let (problem, description) = random_block_problem::<D>(number);
        let mut domain = build_reference_solver::<f64, D>(&problem);
        let start = domain.energy();
        let mut before = start.total();
        for _ in 0..10 {
            domain.advance(1);
            let now = domain.energy().total();
            assert!(now <= before * (1.0 + 1e-13), "{description}: {now:e} after {before:e}");
            before = now;
        }
        let now = domain.energy();
        let residual =
            (now.total() - start.total() - domain.ledger().energy_change()) / start.total();
        assert!(residual.abs() < 1e-12, "{description}: {residual:e}");
        max_residual = max_residual.max(residual.abs());
        max_change = max_change.max(now.interlayer_kinetic + now.interlayer_stored);
    }
    println!("{max_residual:e}");
    assert!(max_change > 0.01);
}

#[test]
fn ledger_of_blocks_closes() {
    check_ledger::<2>(problem_indices(6, 20));
    check_ledger::<3>(problem_indices(7, 3));
}

#[test]
fn energy_of_blocks_never_grows() {
    check_energy(30);
}

/// Verifies more random problems: the fused solver, the ledger and the energy.
#[test]
#[ignore = "takes a quarter of a minute"]
fn many_blocks_have_equal_results_and_closed_ledgers() {
    compare_fused_and_reference::<f64, 2>(problem_indices(0, 40));
    compare_fused_and_reference::<f32, 2>(problem_indices(1, 15));
    compare_fused_and_reference::<f64, 3>(problem_indices(2, 10));
    compare_fused_and_reference::<f32, 3>(problem_indices(3, 5));
    check_ledger::<2>(problem_indices(6, 40));
    check_ledger::<3>(problem_indices(7, 6));
    check_energy(100);
}

/// Checks that the energy of `count` random problems never grows.
fn check_energy(count: usize) {
    for number in problem_indices(8, count) {
        let (problem, description) = random_block_problem::<2>(number);
        let mut domain = build_fused_solver::<f64, 2>(&problem);
        let mut before = domain.energy().total();
        for _ in 0..100 {
            domain.advance(1).expect("threads");
            let now = domain.energy().total();
            assert!(now <= before * (1.0 + 1e-13), "{description}: {now:e} after {before:e}");
            before = now;
        }
    }
}

/// Verifies a periodic row of blocks along either axis against one-dimensional sweeps of each pair of fields.
#[test]
fn row_of_blocks_equals_a_one_dimensional_line() {
    let medium = Medium::new(classical(1.0), 2);
    let material = ElasticMaterial {
        thickness: 0.05,
        density: 0.9,
        longitudinal_speed: 0.6,
        shear_speed: 0.3,
    };
    let (count, block_cells, offset) = (30, 10, 4);
    for (axis, slopes) in [(0, Slopes::FourthOrder), (1, Slopes::FourthOrder), (0, Slopes::Limited)]
    {
        let law = InterlayerLaw::from_material(axis, &material, &medium);
        let interlayers = Interlayers::new_regular(axis, count, [offset, block_cells], law);
        let mut cells = [1; 2];
        cells[axis] = count;
        let step = 2.0 * 0.9 * 0.1 / medium.max_speed();
        let boundaries = [0, 1].map(|_| [Boundary::Periodic, Boundary::Periodic]);
        let problem = Problem {
            interlayers: vec![interlayers],
            ..Problem::new(
                Grid { cells, spacing: [0.1; 2] },
                vec![medium.clone()],
                vec![0; count],
                boundaries,
                step,
                Scheme::new(slopes, PlasticStep::ReturnMapping),
            )
        };
        let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
        for (pair, own) in medium.pairs[axis].iter().enumerate() {
            let velocity: Vec<f64> = (0..count).map(|i| noise((50 * pair + i) as u64)).collect();
            let stress: Vec<f64> =
                (0..count).map(|i| noise((50 * pair + i + 999) as u64)).collect();
            domain.set_field(own.velocity, &velocity);
            domain.set_field(own.stress, &stress);
        }
        let before = domain.clone();
        domain.initialise_interlayers();
        (0..5).for_each(|_| domain.advance());
        for (pair, own) in medium.pairs[axis].iter().enumerate() {
            let compliance = [material.tangential_compliance(), material.normal_compliance()]
                [usize::from(pair == axis)];
            let mass = LayerMass::new_box(material.mass());
            let law = ElasticLayer { components: [ElasticComponent { mass, compliance }] };
            let mut v = before.values(own.velocity).expect("a field");
            let mut s = before.values(own.stress).expect("a field");
            let cell =
                CellConstants::with_interfaces(own.impedance(), own.speed() * 0.5 * step / 0.1);
            let periodic_index = |i: usize| (i + count - GHOSTS) % count;
            let mut layers: Vec<_> = (0..count + 2 * GHOSTS)
                .filter(|&i| periodic_index(i) % block_cells == offset)
                .map(|upper_cell| Interlayer { upper_cell, law, history: vec![0.0; 3] })
                .collect();
            for own in &mut layers {
                let i = periodic_index(own.upper_cell);
                own.history[0] = 0.5 * (v[(i + count - 1) % count] + v[i]);
            }
            for _ in 0..10 {
                let with_ghosts = |own: &[f64]| -> Vec<f64> {
                    (0..count + 2 * GHOSTS).map(|i| own[periodic_index(i)]).collect()
                };
                let (mut line_velocity, mut line_stress) = (with_ghosts(&v), with_ghosts(&s));
                let cells = vec![cell; count + 2 * GHOSTS];
                let line = LineState {
                    velocity: &mut line_velocity,
                    stress: &mut line_stress,
                    cells: &cells,
                    accounts: None,
                };
                let interval = Interval::new(1.0, 0.5 * step);
                sweep_with_interlayers([line], slopes, &mut layers, &interval);
                v = line_velocity[GHOSTS..GHOSTS + count].to_vec();
                s = line_stress[GHOSTS..GHOSTS + count].to_vec();
            }
            // Sweeps along the other axis leave the fields unchanged; results differ by rounding only.
            let found = [domain.values(own.velocity), domain.values(own.stress)];
            for (found, expected) in found.into_iter().zip([v, s]) {
                for (found, expected) in found.expect("a field").iter().zip(expected) {
                    assert!((found - expected).abs() < 1e-14, "{axis} {pair} {found} {expected}");
                }
            }
        }
    }
}

/// Verifies that a uniform velocity of all cells and interlayers stays constant up to rounding.
#[test]
fn rigid_motion_stays_uniform() {
    let (mut problem, _) = random_block_problem::<2>(3);
    problem.boundaries = [0, 1].map(|_| [Boundary::Free, Boundary::Free]);
    problem.interlayers.truncate(1);
    let mut domain = DecomposedDomain::<f64, 2>::new(&problem, 1).expect("sound");
    let field = problem.media[0].pairs[0][0].velocity;
    domain.set_field(field, &vec![1.0; problem.grid.count()]);
    domain.initialise_interlayers();
    domain.advance(50).expect("threads");
    for value in domain.values(field).expect("a field") {
        assert!((value - 1.0).abs() < 1e-12, "{value}");
    }
    assert!(domain.energy().interlayer_kinetic > 0.0);
}

#[test]
fn non_finite_interlayer_values_are_detected() {
    let (problem, _) = random_block_problem::<2>(5);
    let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
    assert_eq!(domain.first_non_finite(), None);
    let count = domain.interlayer_history().len();
    let history = (0..count).map(|i| if i + 1 == count { f64::NAN } else { 0.0 });
    domain.set_interlayer_history(&mut history.into_iter());
    assert!(domain.first_non_finite().is_some());
    let mut reference = Reference::<f64, 2>::new(&problem).expect("sound");
    assert_eq!(reference.first_non_finite(), None);
    let mut snapshot = reference.snapshot();
    if let Some(last) = snapshot.interlayer_history.last_mut() {
        *last = f64::NAN;
    }
    assert!(reference.restore(&snapshot));
    assert_eq!(reference.first_non_finite(), domain.first_non_finite());
}

fn build_elastic_law(mass: f64, compliance: f64) -> InterlayerLaw<f64> {
    InterlayerLaw::Elastic([elastic_component(mass, compliance); MAX_PAIRS])
}

#[test]
fn invalid_interlayers_are_refused() {
    let (sound, _) = random_block_problem::<2>(7);
    let is_refused = |change: fn(&mut Problem<2>)| {
        let mut problem = sound.clone();
        problem.boundaries = [0, 1].map(|_| [Boundary::Free, Boundary::Free]);
        problem.interlayers.truncate(1);
        problem.interlayers[0].planes =
            vec![InterlayerPlane { cell: 3, laws: PlaneLaws::Uniform(0) }];
        assert!(problem.validate().is_ok());
        change(&mut problem);
        let found = problem.validate();
        assert_eq!(Reference::<f64, 2>::new(&problem).err(), found.clone().err());
        matches!(found, Err(DomainError::Interlayers { .. }))
    };
    assert!(is_refused(|own| own.interlayers[0].axis = 2));
    assert!(is_refused(|own| own.interlayers.push(own.interlayers[0].clone())));
    assert!(is_refused(|own| own.interlayers[0].laws[0] = build_elastic_law(-1.0, 1.0)));
    assert!(is_refused(|own| own.interlayers[0].laws[0] = build_elastic_law(1.0, f64::NAN)));
    assert!(is_refused(|own| own.interlayers[0].laws.clear()));
    assert!(is_refused(|own| own.interlayers[0].planes[0].cell = 2));
    assert!(is_refused(|own| own.interlayers[0].planes.clear()));
    assert!(is_refused(|own| {
        let duplicate = own.interlayers[0].planes[0].clone();
        own.interlayers[0].planes.push(duplicate);
    }));
    assert!(is_refused(|own| {
        own.interlayers[0].planes[0].laws = PlaneLaws::from_faces([Some(0), None]);
    }));
    assert!(is_refused(|own| {
        let faces = own.grid.faces(own.interlayers[0].axis);
        own.interlayers[0].planes[0].laws = PlaneLaws::from_runs([(faces, Some(9))]);
    }));
    // Ends of runs that do not ascend.
    assert!(is_refused(|own| {
        let faces = own.grid.faces(own.interlayers[0].axis);
        own.interlayers[0].planes[0].laws =
            PlaneLaws::Runs(vec![(faces + 1, None), (1, Some(0)), (faces, None)]);
    }));
    assert!(is_refused(|own| {
        let faces = own.grid.faces(own.interlayers[0].axis);
        own.interlayers[0].planes[0].laws =
            PlaneLaws::Runs(vec![(2, None), (2, Some(0)), (faces, None)]);
    }));
    assert!(is_refused(|own| {
        let faces = own.grid.faces(own.interlayers[0].axis);
        own.interlayers[0].planes[0].laws = PlaneLaws::Runs(vec![(0, Some(0)), (faces, None)]);
    }));
    assert!(is_refused(|own| own.scheme.splitting = Splitting::Alternating));
}
