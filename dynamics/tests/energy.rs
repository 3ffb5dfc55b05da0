//! Energy never grows without load: rough states of all media, sides, orders, corrections, splittings and Courant
//! numbers; and states searched for in which a sweep beside a side might let it.

mod support;

use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::plasticity::parameters::{Mises, YieldSet};
use support::noise;
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, Placement, Problem, Scheme, Splitting};

/// Steps of a run.
const STEPS: usize = 500;
/// By what part of itself the energy may grow in a step: rounding.
const GROWTH: f64 = 1e-13;
/// The same where media meet: there the limited slopes on both sides of a joint may give back what an earlier step
/// took. Found once in 1200 runs, 1e-4, with images at all sides, too; never by [`Slopes::Godunov`].
const GROWTH_AT_JOINTS: f64 = 1e-3;
/// Runs in each dimension.
const RUNS: usize = 500;

/// Numbers by chance, the same every time.
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

fn cosserat(factor: f64) -> Isotropic {
    let couple = CoupleModuli { beta: 0.3 * factor, gamma: 0.7 * factor, eta: 0.45 * factor };
    let rotation = Microrotation { alpha: 0.6 * factor, inertia: 0.37, couple: Some(couple) };
    Isotropic::new(1.1 * factor, 0.8 * factor, 1.3, Some(rotation)).expect("sound moduli")
}

fn classical(factor: f64) -> Isotropic {
    Isotropic::new(1.1 * factor, 0.8 * factor, 1.3, None).expect("sound moduli")
}

/// A cone that rough states of order one yield on.
fn cone() -> YieldSet {
    YieldSet::Mises(Mises {
        strength: 0.3,
        friction: 0.2,
        dilatancy: 0.2,
        antisymmetric_weight: 1.0,
        symmetric_length: None,
        antisymmetric_length: None,
        hardening: 0.0,
    })
}

fn media(chance: &mut Chance, dimensions: usize) -> Vec<Medium> {
    let classical = |factor| Medium::isotropic(&classical(factor), dimensions);
    let cosserat = |factor| Medium::isotropic(&cosserat(factor), dimensions);
    match chance.below(6) {
        0 => vec![classical(1.0)],
        1 => vec![cosserat(1.0)],
        2 => vec![classical(1.0), classical(30.0)],
        3 => vec![cosserat(1.0), cosserat(0.2).yielding(cone())],
        4 => vec![classical(1.0).yielding(cone())],
        _ => vec![cosserat(1.0).yielding(cone())],
    }
}

fn side(chance: &mut Chance, medium: &Medium, axis: usize) -> Boundary {
    match chance.below(6) {
        0 => Boundary::Fixed,
        1 => Boundary::NonReflecting,
        2 => Boundary::symmetry(medium, axis),
        3 => Boundary::antisymmetry(medium, axis),
        4 => Boundary::Given(
            medium.pairs[axis]
                .iter()
                .map(|_| match chance.below(3) {
                    0 => Condition::Velocity(0.0),
                    1 => Condition::Traction(0.0),
                    _ => Condition::NonReflecting,
                })
                .collect(),
        ),
        _ => Boundary::Free,
    }
}

/// A rough state on a few cells.
fn rough<const D: usize>(number: usize) -> (Domain<f64, D>, f64, String) {
    let mut chance = Chance((number as u64) << 40);
    let media = media(&mut chance, D);
    let most = if D == 2 { 24 } else { 12 };
    let cells = std::array::from_fn(|_| [1, 2, 3, 5, most][chance.below(5)]);
    let grid = Grid { cells, spacing: std::array::from_fn(|_| [0.1, 0.13][chance.below(2)]) };
    let boundaries = std::array::from_fn(|axis| match chance.below(6) {
        0 => [Boundary::Periodic, Boundary::Periodic],
        _ => [0, 1].map(|_| side(&mut chance, &media[0], axis)),
    });
    let courant = [0.3, 0.7, 0.9, 1.0][chance.below(4)];
    let scheme = Scheme {
        splitting: [Splitting::TwoCyclic, Splitting::Alternating][chance.below(2)],
        ..Scheme::new(
            [Slopes::Godunov, Slopes::Limited, Slopes::Limited][chance.below(3)],
            [Placement::Last, Placement::Middle][chance.below(2)],
        )
    };
    let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
    let step = 2.0 * courant * 0.1 / speed;
    let of_cell = (0..grid.count()).map(|_| chance.below(media.len()) as u16).collect();
    let (kind, size) = (chance.below(3), [1e-6, 1.0, 1e6][chance.below(3)]);
    let growth = if media.len() == 1 { GROWTH } else { GROWTH_AT_JOINTS };
    let words =
        format!("{number}: {cells:?}, {boundaries:?}, courant {courant}, {scheme:?}, kind {kind}");
    let problem = Problem::new(grid, media, of_cell, boundaries, step, scheme);
    let mut domain = Domain::new(&problem).expect("sound");
    for field in domain.fields().to_vec() {
        let values: Vec<f64> = (0..grid.count())
            .map(|cell| match kind {
                // Noise, sawtooth, spikes.
                0 => size * chance.number(),
                1 => size * if cell % 2 == 0 { 1.0 } else { -1.0 },
                _ if chance.below(10) == 0 => size * chance.number(),
                _ => 0.0,
            })
            .collect();
        domain.set(field, &values);
    }
    (domain, growth, words)
}

fn never_grows<const D: usize>(runs: impl Iterator<Item = usize>, steps: usize) {
    for number in runs {
        let (mut domain, growth, words) = rough::<D>(number);
        // A state beyond its yield set falls back onto it at once.
        let mut before = domain.energy().total();
        let most = before * (1.0 + GROWTH);
        for step in 0..steps {
            domain.advance();
            let now = domain.energy().total();
            assert!(
                now <= before * (1.0 + growth),
                "{words}: {now:e} after {before:e} in step {step}"
            );
            assert!(now <= most, "{words}: {now:e} of {most:e} in step {step}");
            before = now;
            if now == 0.0 {
                break;
            }
        }
    }
}

#[test]
fn rough_states_in_the_plane() {
    never_grows::<2>(0..RUNS, STEPS);
}

#[test]
fn rough_states_in_space() {
    never_grows::<3>((0..RUNS).map(|run| run + 1_000_000), STEPS);
}

#[test]
#[ignore = "an hour: cargo test --release -p wellposed-dynamics --test energy -- --ignored"]
fn rough_states_for_long() {
    never_grows::<2>((0..50).map(|run| run + 2_000_000), 100_000);
}

/// A line of cells of one pair with two sides: the ratio of its energy after a step to that before, less one. Only
/// one pair moves: in an elastic solid the others are zero.
struct Line {
    domain: Domain<f64, 2>,
    zeros: Vec<f64>,
}

impl Line {
    fn new(cells: usize, courant: f64, sides: [Boundary; 2]) -> Self {
        let medium = Medium::isotropic(&classical(1.0), 2);
        let step = 2.0 * courant * 0.1 / medium.greatest_speed();
        let grid = Grid { cells: [cells, 1], spacing: [0.1; 2] };
        let periodic = [Boundary::Periodic, Boundary::Periodic];
        let scheme = Scheme::new(Slopes::Limited, Placement::Last);
        let problem =
            Problem::new(grid, vec![medium], vec![0; cells], [sides, periodic], step, scheme);
        Self { domain: Domain::new(&problem).expect("sound"), zeros: vec![0.0; cells] }
    }

    /// Of the state with these velocities and stresses.
    fn growth(&mut self, state: &[f64]) -> f64 {
        let cells = self.zeros.len();
        for (index, field) in self.domain.fields().to_vec().into_iter().enumerate() {
            let own = match index {
                0 => &state[..cells],
                // σ₁₁ follows two velocities; σ₂₂ as in uniaxial strain, so that nothing else is stored.
                2 => &state[cells..2 * cells],
                _ => &self.zeros[..],
            };
            self.domain.set(field, own);
        }
        let before = self.domain.energy().total();
        self.domain.advance();
        self.domain.energy().total() / before - 1.0
    }
}

/// Stochastic ascent: the state that gains most, or loses least, of many, is changed by chance.
#[test]
fn no_state_beside_a_side_gains_energy() {
    let kinds = [Boundary::Free, Boundary::Fixed, Boundary::NonReflecting];
    let mut chance = Chance(77 << 40);
    for cells in [2, 3, 5, 8] {
        for courant in [0.1, 0.3, 0.5, 0.7, 0.9, 0.97] {
            for kind in &kinds {
                let mut line = Line::new(cells, courant, [kind.clone(), kind.clone()]);
                let mut most = f64::NEG_INFINITY;
                for _ in 0..3 {
                    let mut state: Vec<f64> = (0..2 * cells).map(|_| chance.number()).collect();
                    let mut best = line.growth(&state);
                    for _ in 0..1500 {
                        let size = 10f64.powf(-2.0 + 2.0 * chance.number());
                        let mut other = state.clone();
                        for value in &mut other {
                            if chance.below(3) == 0 {
                                *value += size * chance.number();
                            }
                        }
                        let own = line.growth(&other);
                        if own > best {
                            (state, best) = (other, own);
                        }
                    }
                    most = most.max(best);
                }
                assert!(most <= GROWTH, "{kind:?}, {cells} cells, Courant {courant}: {most:e}");
            }
        }
    }
}
