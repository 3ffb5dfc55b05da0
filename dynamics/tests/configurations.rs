//! Problems made by chance: the fast way through them, in any instructions and a few parts, with a stop or without, has the
//! bits of the plain one, which sweeps line by line in one part. Both share what stands beside the sweeps: ghosts,
//! patterns, rotation, correction.
//!
//! `CONFIGURATIONS=20000 cargo test --release -p wellposed-dynamics --test configurations` makes so many problems in each of
//! the four tests.

mod support;

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances, Theory};
use models::solid::stress::Stress;
use models::solid::waves::Field;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{Interlayer, InterlayerCouple, Mises};
use std::sync::Arc;
use support::noise;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Signal, Source};
use wellposed_dynamics::line::{HALO, Slopes};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Detail, Grid, Placement, Problem, Scheme, Splitting};
use wellposed_dynamics::real::Instructions;
use wellposed_dynamics::split::{Snapshot, Split};

/// Chance that is the same every time: where it begins, and how often it was asked.
struct Chance {
    seed: u64,
    asked: u64,
}

impl Chance {
    /// Thousands of millions of numbers are between two beginnings: none is drawn twice.
    fn new(number: usize) -> Self {
        Self { seed: (number as u64) << 32, asked: 0 }
    }

    /// In [−1, 1).
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

fn media<const D: usize>(chance: &mut Chance) -> Vec<Medium> {
    let theory = chance.one_of(&[Theory::Classical, Theory::Reduced, Theory::Cosserat]);
    let yields = !chance.one_in(3);
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
        let own = Medium::new(solid(theory, factor), D);
        if !yields || chance.one_in(5) {
            return own;
        }
        let strength = chance.one_of(&[0.05, 0.05, 0.3, 0.3, 1.0, 100.0]);
        let friction = chance.one_of(&[0.0, 0.2, 0.5]);
        let mises = Mises::drucker_prager(strength, friction, friction);
        // Interlayer sets are of the plane.
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

/// Which medium each cell has: one, layers, stripes of rows, or any.
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
    // About where groups, and the rows and layers that come in together, end.
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
    // Wide ones, whose rows come in by several blocks.
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
        ..Scheme::new(slopes, chance.one_of(&[Placement::Last, Placement::Middle]))
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
    problem
}

/// Values at the beginning.
#[derive(Clone, Copy)]
struct Start {
    seed: u64,
    /// Of this size.
    scale: f64,
    /// The share of cells that have other values than zeros of either sign.
    share: f64,
}

/// All that comes of some steps, in so many parts, and in others after a stop if there is one.
fn after<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    start: Start,
    instructions: Instructions,
    ways: &[(usize, usize)],
) -> Snapshot<T> {
    let Start { seed, scale, share } = start;
    let value = |number: usize| {
        let number = seed + number as u64;
        let is_zero = 0.5 * noise(number + (1 << 29)) + 0.5 >= share;
        T::of(scale * noise(number) * if is_zero { 0.0 } else { 1.0 })
    };
    let mut last: Option<Snapshot<T>> = None;
    for &(parts, steps) in ways {
        let mut split: Split<T, D> = Split::new(problem, parts).expect("a sound problem");
        split.set_instructions(instructions);
        match &last {
            Some(snapshot) => assert!(split.restore(snapshot)),
            None => {
                let count = problem.grid.count();
                for (index, field) in split.fields().to_vec().into_iter().enumerate() {
                    let values = index * count..(index + 1) * count;
                    split.set(field, &values.map(value).collect::<Vec<_>>());
                }
            }
        }
        split.advance(steps);
        last = Some(split.snapshot());
    }
    last.expect("a way")
}

fn bits<T: SolverReal>(all: &[Vec<T>]) -> Vec<Vec<u64>> {
    all.iter().map(|own| own.iter().map(|value| value.wide().to_bits()).collect()).collect()
}

/// Makes problems from this number on, and takes all ways through them.
fn same<T: SolverReal, const D: usize>(first: usize, traces: f64) {
    let wanted = std::env::var("CONFIGURATIONS").ok();
    let wanted = wanted.map(|count| count.parse().expect("CONFIGURATIONS must be a number"));
    let (mut yielding, mut divided) = (0, 0);
    let count = wanted.unwrap_or(if D == 2 { 100 } else { 50 });
    for number in first..first + count {
        let mut chance = Chance::new(number);
        let light = problem::<D>(&mut chance);
        let full = Scheme { detail: Detail::Full, ..light.scheme };
        let plain = Problem { scheme: full, ..light.clone() };
        let steps = [chance.below(4), chance.one_of(&[1, 1, 2, 7, 20, 20])];
        let start = Start {
            seed: chance.seed + (3 << 30),
            scale: chance.one_of(&[1.0, 1.0, 1.0, traces]),
            share: chance.one_of(&[1.0, 1.0, 0.5, 0.05]),
        };
        let most = (light.grid.cells[D - 1] / HALO).clamp(1, 6);
        let parts: [[usize; 2]; 3] =
            std::array::from_fn(|_| [0, 1].map(|_| 1 + chance.below(most)));
        let whole = [(1, steps[0] + steps[1])];
        let expected: Snapshot<T> = after(&plain, start, Instructions::Baseline, &whole);
        let (values, sums) = (bits(&expected.fields), bits(&expected.sums));
        let all = expected.fields.iter().flatten().map(|value| value.wide());
        let mut all = all.chain(expected.sums.iter().flatten().copied());
        assert!(all.all(f64::is_finite), "problem {number}");
        let mut totals = None;
        for instructions in Instructions::available() {
            let stops = parts.map(|[one, other]| [(one, steps[0]), (other, steps[1])]);
            let ways = [
                (&light, whole.as_slice()),
                (&light, stops[0].as_slice()),
                (&light, stops[1].as_slice()),
                (&plain, stops[2].as_slice()),
            ];
            for (problem, way) in ways {
                let found: Snapshot<T> = after(problem, start, instructions, way);
                let detail = problem.scheme.detail;
                let what = format!("problem {number}: {instructions:?}, {detail:?}, {way:?}");
                assert!(values == bits(&found.fields), "{what}");
                assert!(sums == bits(&found.sums), "{what}");
                match detail {
                    Detail::Full => assert_eq!(expected.totals, found.totals, "{what}"),
                    Detail::Light => {
                        // What sources, initial stress and yielding add is the same line by line.
                        for (one, other) in expected.totals.iter().zip(&found.totals) {
                            assert_eq!(one[1..4], other[1..4], "{what}");
                        }
                        let totals = totals.get_or_insert_with(|| found.totals.clone());
                        assert_eq!(*totals, found.totals, "{what}");
                    }
                }
            }
        }
        yielding += usize::from(expected.sums[0].iter().any(|lost| *lost > 0.0));
        divided += usize::from(parts != [[1; 2]; 3]);
    }
    // A third of them at least yield, and a quarter are cut.
    assert!(count < 40 || (3 * yielding > count && 4 * divided > count), "{yielding}, {divided}");
}

/// Near the size that is forgotten.
const TRACES: [f64; 2] = [f64::MIN_POSITIVE * 2e13, f32::MIN_POSITIVE as f64 * 2e13];

#[test]
fn in_the_plane() {
    same::<f64, 2>(0, TRACES[0]);
}

#[test]
fn in_space() {
    same::<f64, 3>(1_000_000, TRACES[0]);
}

#[test]
fn in_single_precision_in_the_plane() {
    same::<f32, 2>(2_000_000, TRACES[1]);
}

#[test]
fn in_single_precision_in_space() {
    same::<f32, 3>(3_000_000, TRACES[1]);
}
