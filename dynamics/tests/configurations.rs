//! Problems made by chance: whatever they are, passes over the memory in any number of parts and any instructions have
//! the bits of sweeps line by line in one part and no wide instructions.
//!
//! `CONFIGURATIONS=20000 cargo test --release -p wellposed-dynamics --test configurations` tries as many of each kind.

mod support;

use models::cosserat::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances, Theory,
};
use models::cosserat::stress::Stress;
use models::cosserat::waves::Field;
use models::plasticity::parameters::{Interlayer, InterlayerCouple, Mises, YieldSet};
use std::sync::Arc;
use support::noise;
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Signal, Source};
use wellposed_dynamics::kernel::Instructions;
use wellposed_dynamics::line::{HALO, Slopes};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Detail, Grid, Placement, Problem, Scheme};
use wellposed_dynamics::real::Real;
use wellposed_dynamics::split::{Snapshot, Split};

/// Chance that is the same every time.
struct Chance(u64);

impl Chance {
    /// In [−1, 1).
    fn number(&mut self) -> f64 {
        self.0 += 1;
        noise(self.0)
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
    let yields = chance.one_in(2);
    let is_interlayer = chance.one_in(3);
    let medium = |chance: &mut Chance| {
        let factor = chance.one_of(&[1.0, 1.0, 0.3, 2.3, 40.0]);
        if D == 2 && theory == Theory::Cosserat && chance.one_in(6) {
            return Medium::compliances(&PlaneCompliances {
                a1: 0.5,
                b1: -0.1,
                a2: 0.8,
                b2: 0.1,
                alpha2: 0.9,
                density: 1.1,
                inertia: 0.4,
            });
        }
        let own = Medium::isotropic(&solid(theory, factor), D);
        if !yields || chance.one_in(4) {
            return own;
        }
        let strength = chance.one_of(&[0.05, 0.3, 1.0, 100.0]);
        let friction = chance.one_of(&[0.0, 0.2, 0.5]);
        let mises = Mises::drucker_prager(strength, friction, friction);
        own.yielding(match (is_interlayer, chance.one_in(3)) {
            (true, _) => YieldSet::Interlayer(Interlayer {
                shear_strength: strength,
                shear_friction: friction,
                shear_dilatancy: friction,
                couple: (theory == Theory::Cosserat).then_some(InterlayerCouple {
                    strength: 0.8 * strength,
                    friction: 0.3,
                    dilatancy: 0.3,
                }),
            }),
            (_, true) => YieldSet::Mises(mises),
            _ => YieldSet::Mises(Mises {
                antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
                symmetric_length: (theory == Theory::Cosserat).then_some(0.9),
                antisymmetric_length: (theory == Theory::Cosserat).then_some(0.7),
                ..mises
            }),
        })
    };
    (0..=chance.below(3)).map(|_| medium(chance)).collect()
}

/// Which medium each cell has: one, layers, blocks or any.
fn of_cell<const D: usize>(chance: &mut Chance, cells: [usize; D], media: usize) -> Vec<u16> {
    let count: usize = cells.iter().product();
    let (kind, width, seed) = (chance.below(4), 1 + chance.below(9), 1000 * chance.below(1000));
    let of = |number: usize| ((0.5 * noise((seed + number) as u64) + 0.5) * media as f64) as u16;
    let medium = |cell: usize| match kind {
        0 => 0,
        1 => of(cell / (count / cells[D - 1]) / width),
        2 => of(cell % cells[0] / width + 100 * (cell / cells[0] / width)),
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
            &[1, 2, 3, 7, 13, 14, 15, 16, 17, 29, 30, 31, 32, 40, 62, 126, 255, 300],
            &[1, 2, 3, 4, 5, 7, 8, 9, 12, 13, 16, 17, 20, 24, 25, 33, 40],
        ],
        _ => &[
            &[1, 2, 5, 13, 14, 15, 16, 30, 31, 33],
            &[1, 2, 3, 4, 7, 8, 9, 11, 16, 17, 20],
            &[1, 2, 3, 4, 5, 7, 8, 9, 11, 12, 13, 16, 17],
        ],
    };
    let grid = Grid {
        cells: std::array::from_fn(|axis| chance.one_of(lengths[axis])),
        spacing: std::array::from_fn(|_| chance.one_of(&[0.1, 0.1, 0.13])),
    };
    let count = grid.count();
    let of_cell = of_cell(chance, grid.cells, media.len());
    let sides = std::array::from_fn(|axis| match chance.one_in(3) {
        true => [Boundary::Periodic, Boundary::Periodic],
        false => [0, 1].map(|_| side(chance, &media, &grid, axis)),
    });
    let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
    let step = chance.one_of(&[2.0, 1.9, 0.7]) * 0.1 / speed;
    let slopes =
        chance.one_of(&[Slopes::Godunov, Slopes::Limited, Slopes::Limited, Slopes::Unlimited]);
    let scheme = Scheme::new(slopes, chance.one_of(&[Placement::Last, Placement::Middle]));
    let fields = media[0].fields.clone();
    let pairs: Vec<usize> = media[0].pairs.iter().map(Vec::len).collect();
    let mut problem = Problem::new(grid, media, of_cell, sides, step, scheme);
    let signal: Signal = Arc::new(move |time: f64| 0.3 * (0.7 * time / step).sin());
    for _ in 0..chance.below(3) {
        let (axis, end) = (chance.below(D), chance.below(2));
        if problem.boundaries[axis][end] != Boundary::Periodic {
            let (all, step) = (grid.faces(axis), 1 + chance.below(3));
            let faces = (chance.below(all)..all).step_by(step).map(|face| (face, 0.4)).collect();
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
                std::array::from_fn(|j| if i == j { pressure } else { 0.0 })
            });
            Stress { force, ..Stress::default() }
        };
        problem.initial_stress = Some((axis, (0..grid.cells[axis]).map(stress).collect()));
    }
    if chance.one_in(3) {
        problem.integrals = vec![Field::Velocity(chance.below(D))];
    }
    problem
}

/// All that comes of some steps from noise, of which so many parts of nine are zeros of either sign, with a stop in the
/// middle.
fn after<T: Real, const D: usize>(
    problem: &Problem<D>,
    zeros: u64,
    instructions: Instructions,
    parts: [usize; 2],
    steps: [usize; 2],
) -> Snapshot<T> {
    let count = problem.grid.count();
    let split = |parts: usize| {
        let mut split: Split<T, D> = Split::new(problem, parts).expect("a sound problem");
        split.set_instructions(instructions);
        split
    };
    let mut first = split(parts[0]);
    for (index, field) in first.fields().to_vec().into_iter().enumerate() {
        let value = |cell: usize| {
            let number = (10_000 * index + cell) as u64;
            let is_zero = number * number / 7 % 9 < zeros;
            T::of(if is_zero { 0.0_f64.copysign(noise(number)) } else { noise(number) })
        };
        first.set(field, &(0..count).map(value).collect::<Vec<_>>());
    }
    first.advance(steps[0]);
    let mut second = split(parts[1]);
    assert!(second.restore(&first.snapshot()));
    second.advance(steps[1]);
    second.snapshot()
}

fn bits<T: Real>(all: &[Vec<T>]) -> Vec<Vec<u64>> {
    all.iter().map(|own| own.iter().map(|value| value.wide().to_bits()).collect()).collect()
}

/// Tries so many.
fn same<T: Real, const D: usize>(first: usize) {
    let count = std::env::var("CONFIGURATIONS").ok().and_then(|count| count.parse().ok());
    let (mut yielded, mut divided) = (0, 0);
    let count = count.unwrap_or(if D == 2 { 100 } else { 40 });
    for index in first..first + count {
        let mut chance = Chance(1000 * index as u64);
        let light = problem::<D>(&mut chance);
        let full = Scheme { detail: Detail::Full, ..light.scheme };
        let plain = Problem { scheme: full, ..light.clone() };
        let steps = [chance.below(4), chance.one_of(&[1, 1, 2, 7, 20])];
        let zeros = chance.one_of(&[0, 5, 8, 9]);
        let expected: Snapshot<T> = after(&plain, zeros, Instructions::Baseline, [1; 2], steps);
        let sums = bits(&expected.sums);
        let values = bits(&expected.fields);
        let is_finite = expected.fields.iter().flatten().all(|value| value.wide().is_finite());
        assert!(is_finite, "configuration {index}");
        let most = (light.grid.cells[D - 1] / HALO).clamp(1, 4);
        let mut totals = None;
        for (is_light, set) in [true, false]
            .into_iter()
            .flat_map(|is_light| Instructions::available().map(move |set| (is_light, set)))
        {
            let problem = if is_light { &light } else { &plain };
            let parts = [1 + chance.below(most), 1 + chance.below(most)];
            let found: Snapshot<T> = after(problem, zeros, set, parts, steps);
            let what =
                format!("configuration {index}: {set:?}, {parts:?} parts, light: {is_light}");
            assert!(values == bits(&found.fields), "{what}");
            assert!(sums == bits(&found.sums), "{what}");
            if is_light {
                assert_eq!(*totals.get_or_insert(found.totals.clone()), found.totals, "{what}");
            } else {
                assert_eq!(expected.totals, found.totals, "{what}");
            }
            divided += usize::from(parts != [1; 2]);
        }
        yielded += usize::from(expected.sums[0].iter().any(|lost| *lost > 0.0));
    }
    // What is tried is what it is meant to be.
    assert!(5 * yielded > count && 2 * divided > count, "{yielded}, {divided} of {count}");
}

#[test]
fn in_the_plane() {
    same::<f64, 2>(0);
}

#[test]
fn in_space() {
    same::<f64, 3>(0);
}

#[test]
fn in_single_precision_in_the_plane() {
    same::<f32, 2>(1_000_000);
}

#[test]
fn in_single_precision_in_space() {
    same::<f32, 3>(1_000_000);
}
