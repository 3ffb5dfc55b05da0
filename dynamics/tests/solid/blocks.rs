//! Blocks separated by interlayers: the fused solver against the reference solver, with domain decomposition, resumed
//! from snapshots, with all instruction sets; energy and its ledger; rigid motions.
//!
//! `ROUGH=1000 cargo test --release -p wellposed-dynamics --test solid blocks::` runs 1000 random problems per
//! dimension.

use crate::support::noise;
use models::interface::elastic::{ElasticInterlayer, ElasticMaterial};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::domain::{Domain, SolverReal};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::Splitting;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::Instructions;
use wellposed_dynamics::solid::interface::{Interlayer, sweep_with_interlayers};
use wellposed_dynamics::solid::interlayers::Interlayers;
use wellposed_dynamics::solid::line::{CellConstants, GHOSTS, HALO, Slopes};

/// Reproducible generator of random numbers.
struct Chance(u64);

impl Chance {
    fn number(&mut self) -> f64 {
        self.0 += 1;
        noise(self.0)
    }

    fn below(&mut self, count: usize) -> usize {
        ((0.5 * self.number() + 0.5) * count as f64) as usize % count
    }
}

/// Returns the numbers of the random problems of a test: `count` of them, or as many as the environment sets.
fn runs(first: usize, count: usize) -> std::ops::Range<usize> {
    let asked = std::env::var("ROUGH").ok().and_then(|count| count.parse().ok());
    first * 1_000_000..first * 1_000_000 + asked.unwrap_or(count)
}

fn classical(factor: f64) -> Isotropic {
    Isotropic::new(1.1 * factor, 0.8 * factor, 1.3, None).expect("sound moduli")
}

fn cosserat(factor: f64) -> Isotropic {
    let couple = CoupleModuli { beta: 0.3 * factor, gamma: 0.7 * factor, eta: 0.45 * factor };
    let rotation = Microrotation { alpha: 0.6 * factor, inertia: 0.37, couple: Some(couple) };
    Isotropic::new(1.1 * factor, 0.8 * factor, 1.3, Some(rotation)).expect("sound moduli")
}

fn media(chance: &mut Chance, dimensions: usize) -> Vec<Medium> {
    let classical = |factor| Medium::new(classical(factor), dimensions);
    let cosserat = |factor| Medium::new(cosserat(factor), dimensions);
    match chance.below(4) {
        0 => vec![classical(1.0)],
        1 => vec![classical(1.0), classical(20.0)],
        2 => vec![cosserat(1.0)],
        _ => vec![cosserat(1.0), cosserat(0.2)],
    }
}

fn side(chance: &mut Chance, medium: &Medium, axis: usize) -> Boundary {
    match chance.below(5) {
        0 => Boundary::Fixed,
        1 => Boundary::NonReflecting,
        2 => Boundary::symmetry(medium, axis),
        3 => Boundary::Given(
            medium.pairs[axis]
                .iter()
                .map(|_| [Condition::Velocity(0.0), Condition::Traction(0.0)][chance.below(2)])
                .collect(),
        ),
        _ => Boundary::Free,
    }
}

/// Returns a random problem with interlayers across at least one axis, and its description.
fn blocks<const D: usize>(number: usize) -> (Problem<D>, String) {
    let mut chance = Chance((number as u64) << 40);
    let media = media(&mut chance, D);
    let most = if D == 2 { [40, 29, 33, 24, 16] } else { [18, 13, 17, 12, 16] };
    let cells: [usize; D] = std::array::from_fn(|_| most[chance.below(5)]);
    let grid = Grid { cells, spacing: std::array::from_fn(|_| [0.1, 0.13][chance.below(2)]) };
    let boundaries: [[Boundary; 2]; D] = std::array::from_fn(|axis| match chance.below(3) {
        0 => [Boundary::Periodic, Boundary::Periodic],
        _ => [0, 1].map(|_| side(&mut chance, &media[0], axis)),
    });
    let courant = [0.4, 0.8, 1.0][chance.below(3)];
    let scheme = Scheme::new(
        [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder][chance.below(3)],
        PlasticStep::ReturnMapping,
    );
    let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
    let step = 2.0 * courant * 0.1 / speed;
    let of_cell = (0..grid.count()).map(|_| chance.below(media.len()) as u16).collect();
    let mut interlayers = Vec::new();
    for axis in 0..D {
        if chance.below(3) == 0 && !(interlayers.is_empty() && axis + 1 == D) {
            continue;
        }
        let every = [1, 2, 3, 4, 5, 8, 10][chance.below(7)];
        let (least, count) = match boundaries[axis][0] == Boundary::Periodic {
            true => (0, cells[axis]),
            false => (3, cells[axis] - 5),
        };
        let mut offset = least + chance.below(every.min(count));
        // Leave at least three cells after the last interlayer.
        let mut every = every;
        while least > 0 && (cells[axis] - offset - 1) % every < 2 {
            match offset + 1 < cells[axis] - 3 {
                true => offset += 1,
                false => (offset, every) = (3, cells[axis]),
            }
        }
        let laws = media[0].pairs[axis].iter().map(|_| {
            let mut size = || 0.2 * 10f64.powf(1.5 * chance.number());
            ElasticInterlayer { mass: size(), compliance: size() }
        });
        interlayers.push(Interlayers { axis, offset, every, laws: laws.collect() });
    }
    let words = format!(
        "{number}: {cells:?}, {boundaries:?}, courant {courant}, {scheme:?}, {interlayers:?}"
    );
    let problem =
        Problem { interlayers, ..Problem::new(grid, media, of_cell, boundaries, step, scheme) };
    (problem, words)
}

/// Returns a pseudo-random initial value of a field in a cell.
fn value<T: SolverReal>(index: usize, cell: usize) -> T {
    T::from_f64(noise((index * 1_000_003 + cell) as u64))
}

fn rough<T: SolverReal, const D: usize>(problem: &Problem<D>) -> DecomposedDomain<T, D> {
    rough_in(problem, [1; D])
}

fn rough_in<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    parts: [usize; D],
) -> DecomposedDomain<T, D> {
    let mut domain: DecomposedDomain<T, D> =
        DecomposedDomain::in_box(0, problem, parts).expect("sound");
    let cells = 0..problem.grid.count();
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        domain.set(field, &cells.clone().map(|cell| value(index, cell)).collect::<Vec<T>>());
    }
    domain.initialise_interlayers();
    domain
}

/// Returns the reference solver with the same random state.
fn rough_reference<T: SolverReal, const D: usize>(problem: &Problem<D>) -> Reference<T, D> {
    let mut solver: Reference<T, D> = Reference::new(problem).expect("sound");
    let cells = 0..problem.grid.count();
    for (index, field) in solver.fields().to_vec().into_iter().enumerate() {
        solver.set(field, &cells.clone().map(|cell| value(index, cell)).collect::<Vec<T>>());
    }
    solver.initialise_interlayers();
    solver
}

fn bits_of<T: SolverReal>(snapshot: &Snapshot<T>) -> Vec<u64> {
    let fields = snapshot.fields.iter().flatten().chain(snapshot.interlayers.as_flattened());
    fields.map(|value| value.to_f64().to_bits()).collect()
}

fn bits<T: SolverReal, const D: usize>(domain: &DecomposedDomain<T, D>) -> Vec<u64> {
    bits_of(&domain.snapshot())
}

fn fused_as_reference<T: SolverReal, const D: usize>(numbers: std::ops::Range<usize>) {
    for number in numbers {
        let (problem, words) = blocks::<D>(number);
        let (mut one, mut other) = (rough::<T, D>(&problem), rough_reference::<T, D>(&problem));
        assert!(!one.interlayer_memory().is_empty(), "{words}");
        let before = bits(&one);
        assert!(before == bits_of(&other.snapshot()), "{words}");
        for steps in [1, 2, 3] {
            one.advance(steps);
            other.advance(steps);
            assert!(bits(&one) == bits_of(&other.snapshot()), "{words}");
            assert_eq!(one.energy(), other.energy(), "{words}");
        }
        assert_eq!(one.interlayer_memory(), other.interlayer_memory());
        let memory = one.interlayer_memory();
        assert!(memory.iter().flatten().all(|value| value.to_f64() != 0.0), "{words}");
        assert!(bits(&one) != before);
        // Each solver resumes from a snapshot of the other.
        let mut resumed: Reference<T, D> = Reference::new(&problem).expect("sound");
        assert!(resumed.restore(&one.snapshot()));
        assert!(one.restore(&other.snapshot()));
        one.advance(2);
        resumed.advance(2);
        assert!(bits(&one) == bits_of(&resumed.snapshot()), "{words}");
        let mut short = one.snapshot();
        short.interlayers.pop();
        assert!(!resumed.restore(&short));
    }
}

#[test]
fn fused_sweeps_have_the_bits_of_the_reference() {
    fused_as_reference::<f64, 2>(runs(0, 40));
    fused_as_reference::<f32, 2>(runs(1, 15));
    fused_as_reference::<f64, 3>(runs(2, 10));
    fused_as_reference::<f32, 3>(runs(3, 5));
}

fn parts_as_whole<const D: usize>(numbers: std::ops::Range<usize>) {
    for number in numbers {
        let (problem, words) = blocks::<D>(number);
        let mut whole = rough::<f64, D>(&problem);
        let most = problem.grid.cells.map(|cells| (cells / HALO).max(1));
        let cuts = [[1, 1, 2], [1, 1, 3], [2, 1, 1], [3, 1, 2], [2, 2, 1], [2, 2, 2]];
        let cuts = cuts.map(|[first, middle, last]| -> [usize; D] {
            std::array::from_fn(|axis| match axis {
                0 => first,
                _ if axis + 1 == D => last,
                _ => middle,
            })
        });
        let is_possible = |cut: &[usize; D]| cut.iter().zip(most).all(|(own, most)| *own <= most);
        let cuts = cuts.into_iter().filter(is_possible);
        let mut parts: Vec<_> = cuts.map(|cut| rough_in(&problem, cut)).collect();
        // Other instruction sets, and a run interrupted by reading a snapshot.
        let mut others: Vec<_> =
            Instructions::available().map(|own| (own, rough::<f64, D>(&problem))).collect();
        // A pulse in a domain at rest: values of all magnitudes, and a flush of subnormals during the run.
        let pulse = |own: &mut DecomposedDomain<f64, D>| {
            if number % 2 == 1 {
                for field in own.fields().to_vec() {
                    let at = |cell: usize| if cell == 7 { 1.0 } else { 0.0 };
                    own.set(field, &(0..problem.grid.count()).map(at).collect::<Vec<f64>>());
                }
                own.initialise_interlayers();
            }
        };
        pulse(&mut whole);
        parts.iter_mut().for_each(pulse);
        others.iter_mut().for_each(|own| pulse(&mut own.1));
        whole.advance(13);
        let snapshot = whole.snapshot();
        whole.advance(6);
        let (expected, ledger) = (bits(&whole), whole.ledger());
        for own in &mut parts {
            own.advance(19);
            assert!(bits(own) == expected, "{words}");
            assert_eq!(own.ledger(), ledger, "{words}");
            assert_eq!(own.energy(), whole.energy(), "{words}");
            own.initialise_interlayers();
            assert!(own.restore(&snapshot));
            own.advance(6);
            assert!(bits(own) == expected, "{words}");
            assert_eq!(own.snapshot(), whole.snapshot());
        }
        for (instructions, own) in &mut others {
            own.set_instructions(*instructions);
            own.advance(19);
            assert!(bits(own) == expected, "{instructions:?}: {words}");
        }
    }
}

#[test]
fn parts_snapshots_and_instructions_have_the_bits_of_the_whole() {
    parts_as_whole::<2>(runs(4, 30));
    parts_as_whole::<3>(runs(5, 6));
}

fn ledger_closes<const D: usize>(numbers: std::ops::Range<usize>) {
    let (mut worst, mut moved) = (0.0f64, 0.0f64);
    for number in numbers {
        let (problem, words) = blocks::<D>(number);
        let mut domain = rough_reference::<f64, D>(&problem);
        let start = domain.energy();
        let mut before = start.total();
        for _ in 0..10 {
            domain.advance(1);
            let now = domain.energy().total();
            assert!(now <= before * (1.0 + 1e-13), "{words}: {now:e} after {before:e}");
            before = now;
        }
        let now = domain.energy();
        let residual = (now.total() - start.total() - domain.ledger().change()) / start.total();
        assert!(residual.abs() < 1e-12, "{words}: {residual:e}");
        worst = worst.max(residual.abs());
        moved = moved.max(now.interlayer_kinetic + now.interlayer_stored);
    }
    println!("{worst:e}");
    assert!(moved > 0.01);
}

#[test]
fn the_ledger_of_blocks_closes() {
    ledger_closes::<2>(runs(6, 40));
    ledger_closes::<3>(runs(7, 6));
}

#[test]
fn energy_of_blocks_never_grows() {
    for number in runs(8, 100) {
        let (problem, words) = blocks::<2>(number);
        let mut domain = rough::<f64, 2>(&problem);
        let mut before = domain.energy().total();
        for _ in 0..100 {
            domain.advance(1);
            let now = domain.energy().total();
            assert!(now <= before * (1.0 + 1e-13), "{words}: {now:e} after {before:e}");
            before = now;
        }
    }
}

/// Verifies a periodic row of blocks in either axis against one-dimensional sweeps of each pair of fields.
#[test]
fn a_row_of_blocks_moves_as_a_line() {
    let medium = Medium::new(classical(1.0), 2);
    let material = ElasticMaterial {
        thickness: 0.05,
        density: 0.9,
        longitudinal_speed: 0.6,
        shear_speed: 0.3,
    };
    let (count, every, offset) = (30, 10, 4);
    for (axis, slopes) in [(0, Slopes::FourthOrder), (1, Slopes::FourthOrder), (0, Slopes::Limited)]
    {
        let interlayers = Interlayers::of_material(axis, [offset, every], &material, &medium);
        let mut cells = [1; 2];
        cells[axis] = count;
        let step = 2.0 * 0.9 * 0.1 / medium.greatest_speed();
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
            domain.set(own.velocity, &velocity);
            domain.set(own.stress, &stress);
        }
        let before = domain.clone();
        domain.initialise_interlayers();
        (0..5).for_each(|_| domain.advance());
        for (pair, own) in medium.pairs[axis].iter().enumerate() {
            let law = [material.tangential(), material.normal()][usize::from(pair == axis)];
            let mut v = before.values(own.velocity).expect("a field");
            let mut s = before.values(own.stress).expect("a field");
            let cell = CellConstants::among_others(own.impedance(), own.speed() * 0.5 * step / 0.1);
            let place = |i: usize| (i + count - GHOSTS) % count;
            let mut layers: Vec<_> = (0..count + 2 * GHOSTS)
                .filter(|&i| place(i) % every == offset)
                .map(|i| Interlayer::new(i, law))
                .collect();
            for own in &mut layers {
                let i = place(own.place);
                own.memory[0] = 0.5 * (v[(i + count - 1) % count] + v[i]);
            }
            for _ in 0..10 {
                let around = |own: &[f64]| -> Vec<f64> {
                    (0..count + 2 * GHOSTS).map(|i| own[place(i)]).collect()
                };
                let (mut all_v, mut all_s) = (around(&v), around(&s));
                let cells = vec![cell; count + 2 * GHOSTS];
                sweep_with_interlayers(
                    &mut all_v,
                    &mut all_s,
                    &cells,
                    slopes,
                    &mut layers,
                    0.5 * step,
                    None,
                );
                v = all_v[GHOSTS..GHOSTS + count].to_vec();
                s = all_s[GHOSTS..GHOSTS + count].to_vec();
            }
            // Sweeps across the row leave the fields unchanged, and constants are rounded alike.
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
fn a_rigid_motion_stays_one() {
    let (mut problem, _) = blocks::<2>(3);
    problem.boundaries = [0, 1].map(|_| [Boundary::Free, Boundary::Free]);
    problem.interlayers.truncate(1);
    let mut domain = DecomposedDomain::<f64, 2>::new(&problem, 1).expect("sound");
    let field = problem.media[0].pairs[0][0].velocity;
    domain.set(field, &vec![1.0; problem.grid.count()]);
    domain.initialise_interlayers();
    domain.advance(50);
    for value in domain.values(field).expect("a field") {
        assert!((value - 1.0).abs() < 1e-12, "{value}");
    }
    assert!(domain.energy().interlayer_kinetic > 0.0);
}

#[test]
fn a_number_that_is_not_finite_is_found_in_interlayers() {
    let (problem, _) = blocks::<2>(5);
    let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
    assert_eq!(domain.first_non_finite(), None);
    let count = domain.interlayer_memory().len();
    let memory = (0..count).map(|i| [0.0, if i + 1 == count { f64::NAN } else { 0.0 }]);
    domain.set_interlayer_memory(&mut memory.into_iter());
    assert!(domain.first_non_finite().is_some());
    let mut reference = Reference::<f64, 2>::new(&problem).expect("sound");
    assert_eq!(reference.first_non_finite(), None);
    let mut snapshot = reference.snapshot();
    if let Some(last) = snapshot.interlayers.last_mut() {
        last[1] = f64::NAN;
    }
    assert!(reference.restore(&snapshot));
    assert_eq!(reference.first_non_finite(), domain.first_non_finite());
}

#[test]
fn interlayers_that_cannot_be_are_refused() {
    let (sound, _) = blocks::<2>(7);
    let refused = |change: fn(&mut Problem<2>)| {
        let mut problem = sound.clone();
        problem.boundaries = [0, 1].map(|_| [Boundary::Free, Boundary::Free]);
        problem.interlayers.truncate(1);
        problem.interlayers[0].offset = 3;
        problem.interlayers[0].every = problem.grid.cells[problem.interlayers[0].axis];
        assert!(problem.check().is_ok());
        change(&mut problem);
        let found = problem.check();
        assert_eq!(Reference::<f64, 2>::new(&problem).err(), found.clone().err());
        matches!(found, Err(DomainError::Interlayers { .. }))
    };
    assert!(refused(|own| own.interlayers[0].axis = 2));
    assert!(refused(|own| own.interlayers.push(own.interlayers[0].clone())));
    assert!(refused(|own| own.interlayers[0].laws[0].mass = -1.0));
    assert!(refused(|own| own.interlayers[0].laws[0].compliance = f64::NAN));
    assert!(refused(|own| own.interlayers[0].laws.clear()));
    assert!(refused(|own| own.interlayers[0].offset = 2));
    assert!(refused(|own| own.interlayers[0].every = 0));
    assert!(refused(|own| own.scheme.splitting = Splitting::Alternating));
}
