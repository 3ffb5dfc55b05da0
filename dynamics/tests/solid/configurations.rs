//! Random problems: the fused solver, with any instruction set and decomposition, interrupted or not, must give the
//! bits of the reference solver. Both share the formulas of cells and faces; they differ in the cells to which the
//! formulas are applied, and in the order.
//!
//! `CONFIGURATIONS=20000 cargo test --release -p wellposed-dynamics --test solid configurations::` runs 20,000 problems
//! in each of the four tests.

use crate::support::noise;
use models::interface::elastic::ElasticInterlayer;
use models::rheology::relaxation::StandardLinearSolid;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances, Theory};
use models::solid::stress::Stress;
use models::solid::waves::Field;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{Interlayer, InterlayerCouple, Mises};
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Signal, Source};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::ledger::Energy;
use wellposed_dynamics::line::{HALO, Slopes};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::Instructions;
use wellposed_dynamics::solid::interlayers::Interlayers;

/// Reproducible generator of random numbers: seed, and number of values drawn.
struct Chance {
    seed: u64,
    asked: u64,
}

impl Chance {
    /// Creates the generator of a problem; seeds are 2³² apart, so that no value is drawn twice.
    fn new(number: usize) -> Self {
        Self { seed: (number as u64) << 32, asked: 0 }
    }

    /// Returns a random number in [−1, 1).
    fn number(&mut self) -> f64 {
        self.asked += 1;
        noise(self.seed + self.asked)
    }

    fn below(&mut self, count: usize) -> usize {
        ((0.5 * self.number() + 0.5) * count as f64) as usize
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
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

/// Adds interlayers with random constants across each axis where the problem remains valid.
fn add_interlayers<const D: usize>(chance: &mut Chance, problem: &mut Problem<D>) {
    for axis in 0..D {
        let (every, offset) = (1 + chance.below(8), chance.below(8));
        let laws = problem.media[0].pairs[axis].iter().map(|_| {
            let mut size = || 0.2 * 10f64.powf(1.5 * chance.number());
            ElasticInterlayer { mass: size(), compliance: size() }
        });
        problem.interlayers.push(Interlayers { axis, offset, every, laws: laws.collect() });
        if problem.check().is_err() {
            problem.interlayers.pop();
        }
    }
}

fn media<const D: usize>(chance: &mut Chance) -> Vec<Medium> {
    let theory = chance.one_of(&[Theory::Classical, Theory::Reduced, Theory::Cosserat]);
    let (yields, relaxes) = (!chance.one_in(4), chance.one_in(3));
    let medium = |chance: &mut Chance| {
        let factor = chance.one_of(&[1.0, 1.0, 0.3, 2.3, 40.0]);
        if D == 2 && theory == Theory::Cosserat && chance.one_in(6) {
            return Medium::new(
                PlaneCompliances {
                    a1: 0.5,
                    b1: -0.1,
                    a2: 0.8,
                    b2: 0.1,
                    alpha2: 0.9,
                    density: 1.1,
                    inertia: 0.4,
                },
                2,
            );
        }
        let solid = solid(theory, factor);
        let own = match relaxes && chance.one_in(2) {
            true => {
                let time = chance.one_of(&[1e-3, 0.05, 1.0]);
                let own = StandardLinearSolid::from_unrelaxed(solid, 0.4 * factor, time);
                Medium::relaxing(own.expect("sound constants"), D)
            }
            false => Medium::new(solid, D),
        };
        if !yields || chance.one_in(5) {
            return own;
        }
        let strength = chance.one_of(&[0.05, 0.05, 0.3, 0.3, 1.0, 100.0]);
        let friction = chance.one_of(&[0.0, 0.2, 0.5]);
        let mises = Mises::drucker_prager(strength, friction, friction);
        // Interlayer sets exist in the plane only.
        own.yielding(match (D == 2 && chance.one_in(4), chance.one_in(2)) {
            (true, _) => YieldSet::from(Interlayer {
                shear_strength: strength,
                shear_friction: friction,
                shear_dilatancy: friction,
                couple: (theory == Theory::Cosserat).then_some(InterlayerCouple {
                    strength: 0.8 * strength,
                    friction: 0.3,
                    dilatancy: 0.3,
                }),
            }),
            (_, true) => YieldSet::from(mises),
            _ => YieldSet::from(Mises {
                antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
                symmetric_length: (theory == Theory::Cosserat).then_some(0.9),
                antisymmetric_length: (theory == Theory::Cosserat).then_some(0.7),
                ..mises
            }),
        })
    };
    (0..=chance.below(3)).map(|_| medium(chance)).collect()
}

/// Returns the medium of each cell: uniform, layered, in stripes, or random.
fn of_cell<const D: usize>(chance: &mut Chance, cells: [usize; D], media: usize) -> Vec<u16> {
    let count: usize = cells.iter().product();
    let (kind, width, seed) = (chance.below(4), 1 + chance.below(9), chance.seed + (1 << 31));
    let of = |number: usize| ((0.5 * noise(seed + number as u64) + 0.5) * media as f64) as u16;
    let medium = |cell: usize| match kind {
        0 => of(0),
        1 => of(cell / (count / cells[D - 1]) / width),
        2 => of(cell % cells[0] / width + 1000 * (cell / cells[0] / width)),
        _ => of(cell),
    };
    (0..count).map(medium).collect()
}

fn side<const D: usize>(
    chance: &mut Chance,
    media: &[Medium],
    grid: &Grid<D>,
    axis: usize,
) -> Boundary {
    let condition = |chance: &mut Chance| match chance.below(3) {
        0 => Condition::Velocity(chance.one_of(&[0.0, 0.1])),
        1 => Condition::Traction(chance.one_of(&[0.0, -0.2])),
        _ => Condition::NonReflecting,
    };
    let pairs = media[0].pairs[axis].len();
    match chance.below(7) {
        0 => Boundary::Fixed,
        1 => Boundary::Free,
        2 => Boundary::NonReflecting,
        3 => Boundary::symmetry(&media[0], axis),
        4 => Boundary::antisymmetry(&media[0], axis),
        5 => Boundary::Given((0..pairs).map(|_| condition(chance)).collect()),
        _ => {
            let mut faces = || (0..grid.faces(axis)).map(|_| condition(chance)).collect();
            Boundary::ByFace((0..pairs).map(|_| faces()).collect())
        }
    }
}

fn problem<const D: usize>(chance: &mut Chance) -> Problem<D> {
    let media = media::<D>(chance);
    // Numbers of cells around the limits of SIMD groups and of tiles of rows and layers.
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
    let is_wide = D == 3 && chance.one_in(20);
    let lengths = |axis: usize| if is_wide { wide[axis] } else { lengths[axis] };
    let grid = Grid {
        cells: std::array::from_fn(|axis| chance.one_of(lengths(axis))),
        spacing: std::array::from_fn(|_| chance.one_of(&[0.1, 0.1, 0.13])),
    };
    let count = grid.count();
    let medium_of_cell = of_cell(chance, grid.cells, media.len());
    let sides = std::array::from_fn(|axis| match chance.one_in(3) {
        true => [Boundary::Periodic, Boundary::Periodic],
        false => [0, 1].map(|_| side(chance, &media, &grid, axis)),
    });
    let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
    let step = chance.one_of(&[2.0, 1.9, 0.7]) * 0.1 / speed;
    let slopes =
        chance.one_of(&[Slopes::Godunov, Slopes::Limited, Slopes::Limited, Slopes::FourthOrder]);
    let scheme = Scheme {
        splitting: chance.one_of(&[Splitting::TwoCyclic, Splitting::Alternating]),
        ..Scheme::new(
            slopes,
            chance.one_of(&[PlasticStep::ReturnMapping, PlasticStep::MidpointReflection]),
        )
    };
    let fields = media[0].fields.clone();
    let pairs: Vec<usize> = media[0].pairs.iter().map(Vec::len).collect();
    let mut problem = Problem::new(grid, media, medium_of_cell, sides, step, scheme);
    let signal: Signal = Arc::new(move |time: f64| 0.3 * (0.7 * time / step).sin());
    for _ in 0..chance.below(3) {
        let (axis, end) = (chance.below(D), chance.below(2));
        if problem.boundaries[axis][end] != Boundary::Periodic {
            let (all, every) = (grid.faces(axis), 1 + chance.below(3));
            let faces = (chance.below(all)..all).step_by(every).map(|face| (face, 0.4)).collect();
            let pair = chance.below(pairs[axis]);
            problem.loads.push(Load { axis, end, pair, faces, signal: signal.clone() });
        }
    }
    for _ in 0..chance.below(3) {
        let cells = (0..=chance.below(3)).map(|_| (chance.below(count), 0.5)).collect();
        let amplitudes = (0..2).map(|_| (fields[chance.below(fields.len())], 1e-3)).collect();
        problem.sources.push(Source { cells, amplitudes, signal: signal.clone() });
    }
    if chance.one_in(4) {
        problem.acceleration[chance.below(D)] = 0.3;
    }
    if chance.one_in(6) {
        let axis = chance.below(D);
        let stress = |layer: usize| {
            let pressure = -0.1 * layer as f64;
            let force = std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == j { pressure } else { 0.02 * (i + j) as f64 })
            });
            Stress { force, ..Stress::default() }
        };
        problem.initial_stress = Some((axis, (0..grid.cells[axis]).map(stress).collect()));
    }
    if chance.one_in(3) {
        let moves = |field: &Field| matches!(field, Field::Velocity(_) | Field::Spin(_));
        let all: Vec<Field> = fields.iter().copied().filter(moves).collect();
        problem.integrals = (0..=chance.below(2)).map(|_| chance.one_of(&all)).collect();
    }
    if chance.one_in(2) {
        add_interlayers(chance, &mut problem);
    }
    problem
}

/// Random initial values.
#[derive(Clone, Copy)]
struct Start {
    seed: u64,
    /// Magnitude of the values.
    scale: f64,
    /// Fraction of cells with non-zero values; the others have zeros of either sign.
    share: f64,
}

impl Start {
    /// Returns the initial values by field and cell.
    fn values<T: SolverReal, const D: usize>(self, problem: &Problem<D>) -> Vec<Vec<T>> {
        let Self { seed, scale, share } = self;
        let value = |number: usize| {
            let number = seed + number as u64;
            let is_zero = 0.5 * noise(number + (1 << 29)) + 0.5 >= share;
            T::from_f64(scale * noise(number) * if is_zero { 0.0 } else { 1.0 })
        };
        let count = problem.grid.count();
        let of_field = |index: usize| (index * count..(index + 1) * count).map(value).collect();
        (0..problem.fields().len()).map(of_field).collect()
    }
}

/// Runs the reference solver for `steps` steps.
fn reference<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    start: Start,
    steps: usize,
) -> Reference<T, D> {
    let mut reference: Reference<T, D> = Reference::new(problem).expect("a sound problem");
    let fields = reference.fields().to_vec();
    fields.iter().zip(start.values(problem)).for_each(|(f, own)| reference.set(*f, &own));
    reference.initialise_interlayers();
    reference.advance(steps);
    reference
}

/// Runs the fused solver and returns its snapshot, output fields and energy. `ways`: numbers of parts along each axis,
/// and steps with this decomposition; each following run resumes from the snapshot of the previous one.
fn after<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    start: Start,
    instructions: Instructions,
    ways: &[([usize; D], usize)],
) -> (Snapshot<T>, Vec<Vec<f64>>, Energy) {
    let mut last: Option<(Snapshot<T>, Vec<Vec<f64>>, Energy)> = None;
    for &(parts, steps) in ways {
        let mut split: DecomposedDomain<T, D> =
            DecomposedDomain::in_box(0, problem, parts).expect("a sound problem");
        split.set_instructions(instructions);
        match &last {
            Some((snapshot, ..)) => assert!(split.restore(snapshot)),
            None => {
                let fields = split.fields().to_vec();
                fields.iter().zip(start.values(problem)).for_each(|(f, own)| split.set(*f, &own));
                split.initialise_interlayers();
            }
        }
        split.advance(steps);
        last = Some((split.snapshot(), split.output_fields(), split.energy()));
    }
    last.expect("a way")
}

fn bits<T: SolverReal>(all: &[Vec<T>]) -> Vec<Vec<u64>> {
    all.iter().map(|own| own.iter().map(|value| value.to_f64().to_bits()).collect()).collect()
}

fn numbers<T: SolverReal>(memory: &[[T; 2]]) -> [Vec<T>; 1] {
    [memory.as_flattened().to_vec()]
}

/// Compares all runs of the random problems from number `first` on; `small`: magnitude of the initial values that are
/// flushed to zero.
fn same<T: SolverReal, const D: usize>(first: usize, small: f64) {
    let wanted = std::env::var("CONFIGURATIONS").ok();
    let wanted = wanted.map(|count| count.parse().expect("CONFIGURATIONS must be a number"));
    let (mut yielding, mut divided, mut relaxing, mut layered) = (0, 0, 0, 0);
    let count = wanted.unwrap_or(if D == 2 { 100 } else { 50 });
    for number in first..first + count {
        let mut chance = Chance::new(number);
        let problem = problem::<D>(&mut chance);
        let steps = [chance.below(4), chance.one_of(&[1, 1, 2, 7, 20, 20])];
        let start = Start {
            seed: chance.seed + (3 << 30),
            scale: chance.one_of(&[1.0, 1.0, 1.0, small]),
            share: chance.one_of(&[1.0, 1.0, 0.5, 0.05]),
        };
        // Along the first axis the stencil of output needs two more cells.
        let most = |axis: usize| {
            let cells = problem.grid.cells[axis];
            if axis == 0 { (cells / (HALO + 2)).clamp(1, 3) } else { (cells / HALO).clamp(1, 4) }
        };
        let mut some_parts = || std::array::from_fn(|axis| 1 + chance.below(most(axis)));
        let parts: [[[usize; D]; 2]; 2] = std::array::from_fn(|_| [0, 1].map(|_| some_parts()));
        let whole = [([1; D], steps[0] + steps[1])];
        let reference: Reference<T, D> = reference(&problem, start, steps[0] + steps[1]);
        let expected: Snapshot<T> = reference.snapshot();
        let (values, sums) = (bits(&expected.fields), bits(&expected.sums));
        let memory = bits(&numbers(&expected.interlayers));
        let energies = [reference.energy()];
        let all = expected.fields.iter().flatten().map(|value| value.to_f64());
        let mut all = all.chain(expected.sums.iter().flatten().copied());
        assert!(all.all(f64::is_finite), "problem {number}");
        let mut inflow = None;
        for instructions in Instructions::available() {
            let stops = parts.map(|[one, other]| [(one, steps[0]), (other, steps[1])]);
            for way in [whole.as_slice(), stops[0].as_slice(), stops[1].as_slice()] {
                let (found, shown, found_energy) =
                    after::<T, D>(&problem, start, instructions, way);
                let what = format!("problem {number}: {instructions:?}, {way:?}");
                assert!(values == bits(&found.fields), "{what}");
                assert!(sums == bits(&found.sums), "{what}");
                assert!(memory == bits(&numbers(&found.interlayers)), "{what}");
                assert!(bits(&reference.output_fields()) == bits(&shown), "{what}");
                assert_eq!(expected.work[1], found.work[1], "{what}");
                assert_eq!(expected.work[3], found.work[3], "{what}");
                let inflow = inflow.get_or_insert_with(|| found.work[0].clone());
                assert_eq!(*inflow, found.work[0], "{what}");
                assert!(energies == [found_energy], "{what}");
            }
        }
        yielding += usize::from(expected.sums[0].iter().any(|lost| *lost > 0.0));
        divided +=
            usize::from(parts.iter().flatten().any(|parts| parts[..D - 1] != [1; 2][..D - 1]));
        relaxing += usize::from(reference.ledger().viscous > 0.0);
        layered += usize::from(!expected.interlayers.is_empty());
    }
    // At least a quarter of the problems yield, a quarter are split along an axis other than the last, a tenth relax,
    // and a tenth have interlayers.
    let kinds = [4 * yielding, 4 * divided, 10 * relaxing, 10 * layered];
    assert!(count < 40 || kinds.iter().all(|own| *own > count), "{kinds:?}");
}

/// Initial magnitudes close to the flush threshold 2⁴⁰·MIN_POSITIVE, in double and single precision.
const SMALL: [f64; 2] = [f64::MIN_POSITIVE * 2e13, f32::MIN_POSITIVE as f64 * 2e13];

#[test]
fn in_the_plane() {
    same::<f64, 2>(0, SMALL[0]);
}

#[test]
fn in_space() {
    same::<f64, 3>(1_000_000, SMALL[0]);
}

#[test]
fn in_single_precision_in_the_plane() {
    same::<f32, 2>(2_000_000, SMALL[1]);
}

#[test]
fn in_single_precision_in_space() {
    same::<f32, 3>(3_000_000, SMALL[1]);
}
