//! Random problems: the fused solver, with any instruction set and decomposition, interrupted or not, must be
//! bit-identical to the reference solver. Both solvers share the formulas of cells and faces; they differ in the loops
//! over cells and in the order of operations.
//!
//! `CONFIGURATIONS=20000 cargo test --release -p wellposed-dynamics --test solid configurations::` runs 20,000 problems
//! in each of the four tests.

use crate::support::interlayers::{random_interlayers, set_shear_interval};
use crate::support::media::{cubic_compliances, scaled_isotropic};
use crate::support::noise;
use crate::support::random::NoiseSequence;
use crate::wide_stencil::with_wide_stencil;
use models::rheology::relaxation::StandardLinearSolid;
use models::solid::parameters::Theory;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Signal, Source};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::ledger::Energy;
use wellposed_dynamics::line::{Slopes, WideOrder};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::InstructionSet;
use wellposed_dynamics::solid::metric::Metric;

/// Adds interlayers with random constants across each axis where the problem remains valid.
fn add_interlayers<const D: usize>(random: &mut NoiseSequence, problem: &mut Problem<D>) {
    for axis in 0..D {
        let (every, offset) = (1 + random.uniform_index(8), random.uniform_index(8));
        let interlayers = random_interlayers(
            random,
            (axis, &problem.grid.cells),
            [offset, every],
            &problem.media[0],
        );
        problem.interlayers.push(interlayers);
        if problem.validate().is_err() {
            problem.interlayers.pop();
        }
    }
}

pub fn random_media<const D: usize>(random: &mut NoiseSequence) -> Vec<Medium> {
    let theory = random.choose(&[Theory::Classical, Theory::Reduced, Theory::Cosserat]);
    let (can_yield, can_relax) = (!random.is_one_in(4), random.is_one_in(3));
    let medium = |random: &mut NoiseSequence| {
        let factor = random.choose(&[1.0, 1.0, 0.3, 2.3, 40.0]);
        if D == 2 && theory == Theory::Cosserat && random.is_one_in(6) {
            return Medium::new(cubic_compliances(), 2);
        }
        let solid = scaled_isotropic(theory, factor);
        let medium = match can_relax && random.is_one_in(2) {
            true => {
                let time = random.choose(&[1e-3, 0.05, 1.0]);
                let medium = StandardLinearSolid::from_unrelaxed(solid, 0.4 * factor, time);
                Medium::with_relaxation(medium.expect("sound constants"), D)
            }
            false => Medium::new(solid, D),
        };
        if !can_yield || random.is_one_in(5) {
            return medium;
        }
        let strength = random.choose(&[0.05, 0.05, 0.3, 0.3, 1.0, 100.0]);
        let friction = random.choose(&[0.0, 0.2, 0.5]);
        let mises = Mises::new_drucker_prager(strength, friction, friction);
        // Interlayer yield sets exist in the plane only.
        medium.with_yield_set(match (D == 2 && random.is_one_in(4), random.is_one_in(2)) {
            (true, _) => YieldSet::from(InterlayerYieldSet {
                shear_strength: strength,
                shear_friction: friction,
                shear_dilatancy: friction,
                couple: (theory == Theory::Cosserat).then_some(InterlayerCoupleLimits {
                    strength: 0.8 * strength,
                    friction: 0.3,
                    dilatancy: 0.3,
                }),
            }),
            (_, true) => YieldSet::from(mises),
            _ => YieldSet::from(Mises {
                antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
                symmetric_internal_length: (theory == Theory::Cosserat).then_some(0.9),
                antisymmetric_internal_length: (theory == Theory::Cosserat).then_some(0.7),
                ..mises
            }),
        })
    };
    (0..=random.uniform_index(3)).map(|_| medium(random)).collect()
}

/// Returns the medium of each cell: uniform, layered, in patches of `width` × `width` cells, or random by cell.
fn random_cell_media<const D: usize>(
    random: &mut NoiseSequence,
    cells: [usize; D],
    media: usize,
) -> Vec<u16> {
    let count: usize = cells.iter().product();
    let (kind, width, seed) =
        (random.uniform_index(4), 1 + random.uniform_index(9), random.seed() + (1 << 31));
    let random_medium =
        |number: usize| ((0.5 * noise(seed + number as u64) + 0.5) * media as f64) as u16;
    let medium = |cell: usize| match kind {
        0 => random_medium(0),
        1 => random_medium(cell / (count / cells[D - 1]) / width),
        2 => random_medium(cell % cells[0] / width + 1000 * (cell / cells[0] / width)),
        _ => random_medium(cell),
    };
    (0..count).map(medium).collect()
}

fn random_boundary<const D: usize>(
    random: &mut NoiseSequence,
    media: &[Medium],
    grid: &Grid<D>,
    axis: usize,
) -> Boundary {
    let condition = |random: &mut NoiseSequence| match random.uniform_index(3) {
        0 => Condition::Velocity(random.choose(&[0.0, 0.1])),
        1 => Condition::Traction(random.choose(&[0.0, -0.2])),
        _ => Condition::NonReflecting,
    };
    let pairs = media[0].pairs[axis].len();
    match random.uniform_index(7) {
        0 => Boundary::Fixed,
        1 => Boundary::Free,
        2 => Boundary::NonReflecting,
        3 => Boundary::new_symmetry(&media[0], axis),
        4 => Boundary::new_antisymmetry(&media[0], axis),
        5 => Boundary::ByPair((0..pairs).map(|_| condition(random)).collect()),
        _ => {
            let mut faces = || (0..grid.faces(axis)).map(|_| condition(random)).collect();
            Boundary::ByFace((0..pairs).map(|_| faces()).collect())
        }
    }
}

fn random_problem<const D: usize>(random: &mut NoiseSequence) -> Problem<D> {
    let media = random_media::<D>(random);
    let mut problem = random_problem_with_media(random, media);
    if D == 2 && random.is_one_in(8) {
        make_polar(random, &mut problem);
    }
    problem
}

/// Turns a plane problem into that of a polar block; removes what such a block excludes.
pub fn make_polar<const D: usize>(random: &mut NoiseSequence, problem: &mut Problem<D>) {
    let Grid { cells, spacing } = problem.grid;
    // The ratio √r of the fields to the physical ones is below or above 1.
    let inner = random.choose(&[0.3, 2.0, 30.0]);
    let metric = Metric::new_polar(inner, cells[D - 1], [spacing[0], spacing[D - 1]]);
    problem.step *= (metric.spacing[0] / spacing[0]).min(1.0);
    problem.metric = Some(metric);
    problem.scheme.splitting = Splitting::TwoCyclic;
    problem.initial_stress = None;
    problem.interlayers.clear();
    problem.shear_interval = 1;
    problem.acceleration = [0.0; D];
    if problem.boundaries[D - 1][0] == Boundary::Periodic {
        problem.boundaries[D - 1] = [Boundary::Free, Boundary::NonReflecting];
    }
}

/// Returns a random problem with given media.
pub fn random_problem_with_media<const D: usize>(
    random: &mut NoiseSequence,
    media: Vec<Medium>,
) -> Problem<D> {
    // Numbers of cells next to the limits of SIMD groups and of tiles of rows and layers.
    let lengths: &[&[usize]] = match D {
        2 => &[
            &[1, 2, 3, 7, 13, 14, 15, 16, 17, 29, 30, 31, 32, 40, 62, 126, 254, 255, 300, 530],
            &[1, 2, 3, 4, 5, 7, 8, 9, 12, 13, 16, 17, 20, 24, 25, 33, 40],
        ],
        _ => &[
            &[1, 2, 5, 13, 14, 15, 16, 30, 31, 33],
            &[1, 2, 3, 4, 7, 8, 9, 11, 16, 17, 20],
            &[1, 2, 3, 4, 5, 7, 8, 9, 11, 12, 13, 16, 17],
        ],
    };
    // Wide grids, whose rows are processed in several tiles.
    let wide: [&[usize]; 3] = [&[126, 255, 300], &[17, 25, 41], &[1, 4, 9]];
    let is_wide = D == 3 && random.is_one_in(20);
    let lengths = |axis: usize| if is_wide { wide[axis] } else { lengths[axis] };
    let grid = Grid {
        cells: std::array::from_fn(|axis| random.choose(lengths(axis))),
        spacing: std::array::from_fn(|_| random.choose(&[0.1, 0.1, 0.13])),
    };
    random_problem_in_grid(random, media, grid, [false; D])
}

/// Returns a random problem in a grid with given media; `is_periodic`: axes that must be periodic.
pub fn random_problem_in_grid<const D: usize>(
    random: &mut NoiseSequence,
    media: Vec<Medium>,
    grid: Grid<D>,
    is_periodic: [bool; D],
) -> Problem<D> {
    let count = grid.count();
    let medium_of_cell = random_cell_media(random, grid.cells, media.len());
    let boundaries = std::array::from_fn(|axis| match is_periodic[axis] || random.is_one_in(3) {
        true => [Boundary::Periodic, Boundary::Periodic],
        false => [0, 1].map(|_| random_boundary(random, &media, &grid, axis)),
    });
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = random.choose(&[2.0, 1.9, 0.7]) * 0.1 / speed;
    let slopes =
        random.choose(&[Slopes::Godunov, Slopes::Limited, Slopes::Limited, Slopes::FourthOrder]);
    let scheme = Scheme {
        splitting: random.choose(&[Splitting::TwoCyclic, Splitting::Alternating]),
        ..Scheme::new(
            slopes,
            random.choose(&[PlasticStep::ReturnMapping, PlasticStep::MidpointReflection]),
        )
    };
    let fields = media[0].fields.clone();
    let pairs: Vec<usize> = media[0].pairs.iter().map(Vec::len).collect();
    let mut problem = Problem::new(grid, media, medium_of_cell, boundaries, step, scheme);
    let signal: Signal = Arc::new(move |time: f64| 0.3 * (0.7 * time / step).sin());
    for _ in 0..random.uniform_index(3) {
        let (axis, end) = (random.uniform_index(D), random.uniform_index(2));
        if problem.boundaries[axis][end] != Boundary::Periodic {
            let (face_count, every) = (grid.faces(axis), 1 + random.uniform_index(3));
            let faces = (random.uniform_index(face_count)..face_count)
                .step_by(every)
                .map(|face| (face, 0.4))
                .collect();
            let pair = random.uniform_index(pairs[axis]);
            problem.loads.push(Load { axis, end, pair, faces, signal: signal.clone() });
        }
    }
    for _ in 0..random.uniform_index(3) {
        let cells =
            (0..=random.uniform_index(3)).map(|_| (random.uniform_index(count), 0.5)).collect();
        let amplitudes =
            (0..2).map(|_| (fields[random.uniform_index(fields.len())], 1e-3)).collect();
        problem.sources.push(Source { cells, amplitudes, signal: signal.clone() });
    }
    if random.is_one_in(4) {
        problem.acceleration[random.uniform_index(D)] = 0.3;
    }
    if random.is_one_in(6) {
        let axis = random.uniform_index(D);
        let stress = |layer: usize| {
            let pressure = -0.1 * layer as f64;
            let force = std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == j { pressure } else { 0.02 * (i + j) as f64 })
            });
            Stress { force, ..Stress::default() }
        };
        problem.initial_stress = Some((axis, (0..grid.cells[axis]).map(stress).collect()));
    }
    if random.is_one_in(3) {
        let is_velocity_or_spin =
            |field: &SolidField| matches!(field, SolidField::Velocity(_) | SolidField::Spin(_));
        let integrable_fields: Vec<SolidField> =
            fields.iter().copied().filter(is_velocity_or_spin).collect();
        problem.integrated_fields =
            (0..=random.uniform_index(2)).map(|_| random.choose(&integrable_fields)).collect();
    }
    if random.is_one_in(2) {
        add_interlayers(random, &mut problem);
    }
    set_shear_interval(random, &mut problem);
    problem
}

/// Creates a random problem with a wide stencil, where lines are long enough.
fn random_wide_problem<const D: usize>(random: &mut NoiseSequence) -> Problem<D> {
    let order = random.choose(&[WideOrder::Sixth, WideOrder::Eighth]);
    loop {
        let problem: Problem<D> = random_problem(random);
        if problem.grid.cells.iter().all(|cells| *cells >= 4) {
            return with_wide_stencil(problem, order);
        }
    }
}

/// Distribution of random initial values.
#[derive(Clone, Copy)]
struct InitialValues {
    seed: u64,
    /// Largest magnitude of the values.
    magnitude: f64,
    /// Probability that a value is not zero; the others are zeros of either sign.
    nonzero_fraction: f64,
}

impl InitialValues {
    /// Returns the initial values by field and cell.
    fn values<T: SolverReal, const D: usize>(self, problem: &Problem<D>) -> Vec<Vec<T>> {
        let Self { seed, magnitude, nonzero_fraction } = self;
        let value = |number: usize| {
            let number = seed + number as u64;
            let is_zero = 0.5 * noise(number + (1 << 29)) + 0.5 >= nonzero_fraction;
            T::from_f64(magnitude * noise(number) * if is_zero { 0.0 } else { 1.0 })
        };
        let count = problem.grid.count();
        let field_values = |index: usize| (index * count..(index + 1) * count).map(value).collect();
        (0..problem.fields().len()).map(field_values).collect()
    }
}

/// Runs the reference solver for `steps` steps.
fn run_reference<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    start: InitialValues,
    steps: usize,
) -> Reference<T, D> {
    let mut reference: Reference<T, D> =
        Reference::with_first_axis(problem.first_axis(), problem).expect("a sound problem");
    let fields = reference.fields().to_vec();
    fields.iter().zip(start.values(problem)).for_each(|(f, own)| reference.set_field(*f, &own));
    reference.initialise_interlayers();
    reference.advance(steps);
    reference
}

/// Runs the fused solver and returns its snapshot, output fields and energy. `runs`: numbers of subdomains along each
/// axis, and number of steps with this decomposition; each following run resumes from the snapshot of the previous one.
fn run_fused<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    start: InitialValues,
    instructions: InstructionSet,
    runs: &[([usize; D], usize)],
) -> (Snapshot<T>, Vec<Vec<f64>>, Energy) {
    let mut last: Option<(Snapshot<T>, Vec<Vec<f64>>, Energy)> = None;
    for &(parts, steps) in runs {
        let mut decomposed: DecomposedDomain<T, D> =
            DecomposedDomain::with_subdomains(problem.first_axis(), problem, parts)
                .expect("a sound problem");
        decomposed.set_instructions(instructions);
        match &last {
            Some((snapshot, ..)) => assert!(decomposed.restore(snapshot)),
            None => {
                let fields = decomposed.fields().to_vec();
                fields
                    .iter()
                    .zip(start.values(problem))
                    .for_each(|(f, own)| decomposed.set_field(*f, &own));
                decomposed.initialise_interlayers();
            }
        }
        decomposed.advance(steps).expect("threads");
        last = Some((decomposed.snapshot(), decomposed.output_values(), decomposed.energy()));
    }
    last.expect("a run")
}

fn to_bits<T: SolverReal>(all: &[Vec<T>]) -> Vec<Vec<u64>> {
    all.iter().map(|own| own.iter().map(|value| value.to_f64().to_bits()).collect()).collect()
}

/// Verifies that two lists of values by field and cell are the same bit for bit.
fn assert_same_values<T: SolverReal>(
    [expected, found]: [&[Vec<T>]; 2],
    problem_fields: &[SolidField],
    label: &str,
) {
    let to_bits = |value: &T| value.to_f64().to_bits();
    assert_eq!(expected.len(), found.len(), "{label}");
    for (index, (expected, found)) in expected.iter().zip(found).enumerate() {
        assert_eq!(expected.len(), found.len(), "{label}");
        let differs = |cell: &usize| to_bits(&expected[*cell]) != to_bits(&found[*cell]);
        if let Some(cell) = (0..expected.len()).find(differs) {
            let (expected, found) = (expected[cell], found[cell]);
            let field = problem_fields.get(index);
            panic!("{label}: {field:?} in cell {cell} is {found:?} instead of {expected:?}");
        }
    }
}

/// Compares the fused solver with the reference solver for `count` random problems from the index `first` on.
/// `small_magnitude`: magnitude of initial values not far above the threshold below which values are flushed to zero.
fn compare_solvers<T: SolverReal, const D: usize>(
    first: usize,
    count: usize,
    small_magnitude: f64,
) {
    let [yielding, decomposed, relaxing, layered] =
        compare_problems::<T, D>((first, count), small_magnitude, random_problem);
    let kinds = [yielding, decomposed, relaxing, layered];
    assert!(kinds.iter().all(|own| *own > 0), "{kinds:?}");
    // Of many problems at least a quarter yield, a quarter are decomposed along an axis other than the last, a tenth
    // relax, and a tenth have interlayers.
    let kinds = [4 * yielding, 4 * decomposed, 10 * relaxing, 10 * layered];
    assert!(count < MANY_PROBLEMS[3 - D] || kinds.iter().all(|own| *own > count), "{kinds:?}");
}

/// Numbers of problems in space and in the plane of the long comparisons.
const MANY_PROBLEMS: [usize; 2] = [40, 100];

/// Numbers of problems in space and in the plane of the short comparisons.
const FEW_PROBLEMS: [usize; 2] = [20, 40];

/// Compares the fused solver with the reference solver for `count` random problems from the index `first` on, or for
/// as many as the environment variable `CONFIGURATIONS` says. Returns the numbers of problems that yield, that are
/// decomposed along an axis other than the last, that relax, and that have interlayers. Each run is made with one of the
/// instruction sets, which change from problem to problem.
pub fn compare_problems<T: SolverReal, const D: usize>(
    (first, count): (usize, usize),
    small_magnitude: f64,
    random_problem: impl Fn(&mut NoiseSequence) -> Problem<D>,
) -> [usize; 4] {
    let requested = std::env::var("CONFIGURATIONS").ok();
    let requested = requested.map(|count| count.parse().expect("CONFIGURATIONS must be a number"));
    let (mut yielding, mut decomposed_count, mut relaxing, mut layered) = (0, 0, 0, 0);
    let count = requested.unwrap_or(count);
    for number in first..first + count {
        let mut random = NoiseSequence::new((number as u64) << 32);
        let problem = random_problem(&mut random);
        let steps = [random.uniform_index(4), random.choose(&[1, 1, 2, 7, 20, 20])];
        let start = InitialValues {
            seed: random.seed() + (3 << 30),
            magnitude: random.choose(&[1.0, 1.0, 1.0, small_magnitude]),
            nonzero_fraction: random.choose(&[1.0, 1.0, 0.5, 0.05]),
        };
        // Along the first axis the stencil of the output needs as many more cells than the halo as there are ghosts.
        let max_count = |axis: usize| {
            let (cells, ghosts) = (problem.grid.cells[axis], problem.scheme.slopes.ghosts());
            match axis == problem.first_axis() {
                true => (cells / (3 * ghosts)).clamp(1, 3),
                false => (cells / (2 * ghosts)).clamp(1, 4),
            }
        };
        let mut random_counts =
            || std::array::from_fn(|axis| 1 + random.uniform_index(max_count(axis)));
        let subdomain_counts: [[[usize; D]; 2]; 2] =
            std::array::from_fn(|_| [0, 1].map(|_| random_counts()));
        let uninterrupted = [([1; D], steps[0] + steps[1])];
        let reference: Reference<T, D> = run_reference(&problem, start, steps[0] + steps[1]);
        let expected: Snapshot<T> = reference.snapshot();
        let sums = to_bits(&expected.cell_sums);
        let history = to_bits(std::slice::from_ref(&expected.interlayer_history));
        let energies = [reference.energy()];
        let all = expected.fields.iter().flatten().map(|value| value.to_f64());
        let mut all = all.chain(expected.cell_sums.iter().flatten().copied());
        assert!(all.all(f64::is_finite), "problem {number}");
        let mut inflow = None;
        let sets = InstructionSet::available_sets().collect::<Vec<_>>();
        let resumed_runs =
            subdomain_counts.map(|[one, other]| [(one, steps[0]), (other, steps[1])]);
        let all_runs =
            [uninterrupted.as_slice(), resumed_runs[0].as_slice(), resumed_runs[1].as_slice()];
        for (index, runs) in all_runs.into_iter().enumerate() {
            let instructions = sets[(number + index) % sets.len()];
            let (found, output, found_energy) =
                run_fused::<T, D>(&problem, start, instructions, runs);
            let label = format!("problem {number}: {instructions:?}, {runs:?}");
            assert_same_values([&expected.fields, &found.fields], &problem.fields(), &label);
            assert!(sums == to_bits(&found.cell_sums), "{label}");
            assert!(history == to_bits(std::slice::from_ref(&found.interlayer_history)), "{label}");
            assert!(to_bits(&reference.output_values()) == to_bits(&output), "{label}");
            assert_eq!(expected.work_sums[1], found.work_sums[1], "{label}");
            assert_eq!(expected.work_sums[3], found.work_sums[3], "{label}");
            let inflow = inflow.get_or_insert_with(|| found.work_sums[0].clone());
            assert_eq!(*inflow, found.work_sums[0], "{label}");
            assert!(energies == [found_energy], "{label}");
        }
        yielding += usize::from(expected.cell_sums[0].iter().any(|lost| *lost > 0.0));
        decomposed_count += usize::from(
            subdomain_counts
                .iter()
                .flatten()
                .any(|subdomain_counts| subdomain_counts[..D - 1] != [1; 2][..D - 1]),
        );
        relaxing += usize::from(reference.ledger().viscous_dissipation > 0.0);
        layered += usize::from(!expected.interlayer_history.is_empty());
    }
    [yielding, decomposed_count, relaxing, layered]
}

/// Initial magnitudes of 18 times the flush threshold 2⁴⁰·MIN_POSITIVE, in double and single precision.
pub const FLUSHED_MAGNITUDES: [f64; 2] =
    [f64::MIN_POSITIVE * 2e13, f32::MIN_POSITIVE as f64 * 2e13];

#[test]
fn fused_solver_equals_the_reference_in_the_plane() {
    compare_solvers::<f64, 2>(0, FEW_PROBLEMS[1], FLUSHED_MAGNITUDES[0]);
}

#[test]
fn fused_solver_equals_the_reference_in_space() {
    compare_solvers::<f64, 3>(1_000_000, FEW_PROBLEMS[0], FLUSHED_MAGNITUDES[0]);
}

#[test]
fn fused_solver_equals_the_reference_in_single_precision_in_the_plane() {
    compare_solvers::<f32, 2>(2_000_000, FEW_PROBLEMS[1], FLUSHED_MAGNITUDES[1]);
}

#[test]
fn fused_solver_equals_the_reference_in_single_precision_in_space() {
    compare_solvers::<f32, 3>(3_000_000, FEW_PROBLEMS[0], FLUSHED_MAGNITUDES[1]);
}

#[test]
fn fused_solver_equals_the_reference_with_wide_stencils() {
    compare_problems::<f64, 2>((4_000_000, 30), FLUSHED_MAGNITUDES[0], random_wide_problem);
    compare_problems::<f64, 3>((5_000_000, 10), FLUSHED_MAGNITUDES[0], random_wide_problem);
    compare_problems::<f32, 2>((6_000_000, 10), FLUSHED_MAGNITUDES[1], random_wide_problem);
}

/// A polar block of media of which only some couple a stress to the curvature: zeros of that stress in the others keep the
/// signs of the reference.
#[test]
fn signs_of_zeros_in_polar_blocks_of_several_media_are_those_of_the_reference() {
    let random_block = |random: &mut NoiseSequence| {
        let coupled = Medium::new(scaled_isotropic(Theory::Cosserat, 1.0), 2);
        let media = vec![Medium::new(cubic_compliances(), 2), coupled];
        let grid = Grid { cells: [13, 5], spacing: [0.13; 2] };
        let mut problem = random_problem_in_grid(random, media, grid, [false; 2]);
        problem.medium_function = None;
        problem.cell_media = (0..65).map(|cell| u16::from(noise(cell) > 0.0)).collect();
        make_polar(random, &mut problem);
        problem
    };
    compare_problems::<f32, 2>((7_000_000, 12), FLUSHED_MAGNITUDES[1], random_block);
    compare_problems::<f64, 2>((7_100_000, 12), FLUSHED_MAGNITUDES[0], random_block);
}

/// The first step sweeps longitudinal waves only: the sweeps of shear waves change nothing but signs of zeros.
#[test]
fn signs_of_zeros_in_steps_without_shear_waves_are_those_of_the_reference() {
    fn check<const D: usize>(lengths: [usize; D]) {
        for number in 0..8 {
            let mut random = NoiseSequence::new(number << 32);
            let media = vec![Medium::new(scaled_isotropic(Theory::Classical, 1.0), D)];
            let grid = Grid { cells: lengths, spacing: [0.1; D] };
            let mut problem = random_problem_in_grid(&mut random, media, grid, [false; D]);
            problem.scheme = Scheme::new(
                [Slopes::Limited, Slopes::FourthOrder][number as usize % 2],
                PlasticStep::default(),
            );
            problem.interlayers.clear();
            // The Courant number of the shear waves is below 1.
            problem.step = 0.07 / problem.media[0].max_speed();
            problem.shear_interval = 3;
            let start =
                InitialValues { seed: random.seed(), magnitude: 1.0, nonzero_fraction: 0.5 };
            let reference: Reference<f64, D> = run_reference(&problem, start, 1);
            let expected = reference.snapshot().fields;
            for set in InstructionSet::available_sets() {
                let (found, ..) = run_fused::<f64, D>(&problem, start, set, &[([1; D], 1)]);
                let label = format!("problem {number} in {D} dimensions: {set:?}");
                assert_same_values([&expected, &found.fields], &problem.fields(), &label);
            }
        }
    }
    check([13, 9]);
    check([9, 7, 5]);
}

#[test]
#[ignore = "takes half a minute"]
fn fused_solver_equals_the_reference_in_many_problems() {
    compare_solvers::<f64, 2>(0, MANY_PROBLEMS[1], FLUSHED_MAGNITUDES[0]);
    compare_solvers::<f64, 3>(1_000_000, MANY_PROBLEMS[0], FLUSHED_MAGNITUDES[0]);
    compare_solvers::<f32, 2>(2_000_000, MANY_PROBLEMS[1], FLUSHED_MAGNITUDES[1]);
    compare_solvers::<f32, 3>(3_000_000, MANY_PROBLEMS[0], FLUSHED_MAGNITUDES[1]);
}
