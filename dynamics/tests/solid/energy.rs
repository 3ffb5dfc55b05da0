//! Energy never grows without load: random states with all media, boundaries, orders, plastic steps, splittings and
//! Courant numbers; and a search for states in which a sweep next to a boundary or interface increases the energy.
//!
//! `ROUGH=20000 cargo test --release -p wellposed-dynamics --test solid energy::` makes 20,000 runs in each dimension.

use crate::support::media::{classical, cosserat, cubic_compliances};
use crate::support::random::NoiseSequence;
use crate::wide_stencil::with_wide_stencil;
use models::solid::parameters::{Isotropic, Microrotation};
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::{CellConstants, GHOSTS, Slopes, WideOrder, energy, sweep};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

/// Number of steps of a run.
const STEPS_PER_RUN: usize = 500;
/// Admissible relative growth of energy per step: rounding.
const MAX_GROWTH: f64 = 1e-13;
/// Admissible growth in single precision: some twenty sweeps and return mappings per step, each rounding to 6e-8.
const MAX_GROWTH_SINGLE_PRECISION: f64 = 1e-6;

/// Returns the number of runs in each dimension: the value of the environment variable `ROUGH`, else 50.
fn run_count() -> usize {
    std::env::var("ROUGH").ok().and_then(|count| count.parse().ok()).unwrap_or(50)
}

/// Returns a cone on which random states of order one yield.
fn cone_yield_set() -> YieldSet {
    YieldSet::from(Mises {
        strength: 0.3,
        friction: 0.2,
        dilatancy: 0.2,
        antisymmetric_weight: 1.0,
        symmetric_internal_length: None,
        antisymmetric_internal_length: None,
        hardening: 0.0,
    })
}

/// Returns an interlayer yield set in which layers slip and roll on each other.
fn interlayer_yield_set() -> YieldSet {
    YieldSet::from(InterlayerYieldSet {
        shear_strength: 0.3,
        shear_friction: 0.3,
        shear_dilatancy: 0.3,
        couple: Some(InterlayerCoupleLimits { strength: 0.2, friction: 0.3, dilatancy: 0.3 }),
    })
}

/// Returns a plane solid with cubic symmetry.
fn build_cubic_medium() -> Medium {
    Medium::new(cubic_compliances(), 2)
}

fn random_media(random: &mut NoiseSequence, dimensions: usize) -> Vec<Medium> {
    let classical = |factor| Medium::new(classical(factor), dimensions);
    let cosserat = |factor| Medium::new(cosserat(factor), dimensions);
    let reduced = Microrotation { alpha: 0.6, inertia: 0.37, couple: None };
    let reduced = Isotropic::new(1.1, 0.8, 1.3, Some(reduced)).expect("sound moduli");
    // Cubic solids and interlayer yield sets exist in the plane only.
    match random.uniform_index(if dimensions == 2 { 10 } else { 7 }) {
        0 => vec![classical(1.0)],
        1 => vec![cosserat(1.0)],
        2 => vec![classical(1.0), classical(30.0)],
        3 => vec![cosserat(1.0), cosserat(0.2).with_yield_set(cone_yield_set())],
        4 => vec![classical(1.0).with_yield_set(cone_yield_set())],
        5 => vec![cosserat(1.0).with_yield_set(cone_yield_set())],
        6 => vec![Medium::new(reduced, dimensions)],
        7 => vec![build_cubic_medium()],
        8 => vec![build_cubic_medium(), cosserat(1.0).with_yield_set(interlayer_yield_set())],
        _ => vec![cosserat(1.0).with_yield_set(interlayer_yield_set())],
    }
}

fn random_boundary(random: &mut NoiseSequence, medium: &Medium, axis: usize) -> Boundary {
    match random.uniform_index(6) {
        0 => Boundary::Fixed,
        1 => Boundary::NonReflecting,
        2 => Boundary::new_symmetry(medium, axis),
        3 => Boundary::new_antisymmetry(medium, axis),
        4 => Boundary::ByPair(
            medium.pairs[axis]
                .iter()
                .map(|_| match random.uniform_index(3) {
                    0 => Condition::Velocity(0.0),
                    1 => Condition::Traction(0.0),
                    _ => Condition::NonReflecting,
                })
                .collect(),
        ),
        _ => Boundary::Free,
    }
}

/// Creates a random problem with a random state on a few cells, and its description; of one medium if the stencil is
/// wide.
fn random_domain<T: SolverReal, const D: usize>(
    number: usize,
    wide: Option<WideOrder>,
) -> (Domain<T, D>, String) {
    let mut random = NoiseSequence::new((number as u64) << 40);
    let mut media = random_media(&mut random, D);
    let max_cells = if D == 2 { 24 } else { 12 };
    let mut lengths = [1, 2, 3, 5, max_cells];
    if wide.is_some() {
        media.truncate(1);
        lengths = [4, 5, 6, 7, max_cells];
    }
    let cells = std::array::from_fn(|_| lengths[random.uniform_index(5)]);
    let grid =
        Grid { cells, spacing: std::array::from_fn(|_| [0.1, 0.13][random.uniform_index(2)]) };
    let boundaries = std::array::from_fn(|axis| match random.uniform_index(6) {
        0 => [Boundary::Periodic, Boundary::Periodic],
        _ => [0, 1].map(|_| random_boundary(&mut random, &media[0], axis)),
    });
    let courant = [0.3, 0.7, 0.9, 1.0][random.uniform_index(4)];
    let scheme = Scheme {
        splitting: [Splitting::TwoCyclic, Splitting::Alternating][random.uniform_index(2)],
        ..Scheme::new(
            [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder][random.uniform_index(3)],
            [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection][random.uniform_index(2)],
        )
    };
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = 2.0 * courant * 0.1 / speed;
    let cell_media = (0..grid.count()).map(|_| random.uniform_index(media.len()) as u16).collect();
    let (kind, size) = (random.uniform_index(3), [1e-6, 1.0, 1e6][random.uniform_index(3)]);
    let mut problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
    if let Some(order) = wide {
        problem = with_wide_stencil(problem, order);
    }
    let (boundaries, scheme) = (&problem.boundaries, problem.scheme);
    let description =
        format!("{number}: {cells:?}, {boundaries:?}, courant {courant}, {scheme:?}, kind {kind}");
    let mut domain = Domain::new(&problem).expect("sound");
    for field in domain.fields().to_vec() {
        let values: Vec<T> = (0..grid.count())
            .map(|cell| match kind {
                // Initial values by `kind`: noise, sawtooth, spikes.
                0 => size * random.uniform_symmetric(),
                1 => size * if cell % 2 == 0 { 1.0 } else { -1.0 },
                _ if random.uniform_index(10) == 0 => size * random.uniform_symmetric(),
                _ => 0.0,
            })
            .map(T::from_f64)
            .collect();
        domain.set_field(field, &values);
    }
    (domain, description)
}

fn check_energy_never_grows<T: SolverReal, const D: usize>(
    runs: impl Iterator<Item = usize>,
    steps: usize,
    growth: f64,
) {
    for number in runs {
        check_energy_of::<T, D>(random_domain(number, None), steps, growth);
    }
}

/// Verifies for a domain, given with its description, that no step increases the energy.
fn check_energy_of<T: SolverReal, const D: usize>(
    (mut domain, description): (Domain<T, D>, String),
    steps: usize,
    growth: f64,
) {
    // Stresses beyond the yield set are mapped back onto it in the first step.
    let mut before = domain.energy().total();
    let max_energy = before * (1.0 + growth);
    for step in 0..steps {
        domain.advance();
        let now = domain.energy().total();
        assert!(
            now <= before * (1.0 + growth),
            "{description}: {now:e} after {before:e} in step {step}"
        );
        assert!(now <= max_energy, "{description}: {now:e} of {max_energy:e} in step {step}");
        before = now;
        // Below this limit the admissible growth is subnormal: the run ends.
        if now < f64::MIN_POSITIVE / growth {
            break;
        }
    }
}

#[test]
fn energy_never_grows_with_wide_stencils() {
    for number in 0..run_count() {
        for order in [WideOrder::Sixth, WideOrder::Eighth] {
            let wide = Some(order);
            check_energy_of::<f64, 2>(random_domain(number, wide), STEPS_PER_RUN, MAX_GROWTH);
        }
        let wide = Some(WideOrder::Eighth);
        check_energy_of::<f64, 3>(random_domain(number, wide), STEPS_PER_RUN / 4, MAX_GROWTH);
    }
}

#[test]
fn energy_never_grows_from_random_states_in_the_plane() {
    check_random_states_in_the_plane(run_count());
}

fn check_random_states_in_the_plane(runs: usize) {
    check_energy_never_grows::<f64, 2>(0..runs, STEPS_PER_RUN, MAX_GROWTH);
}

#[test]
fn energy_never_grows_from_random_states_in_space() {
    check_random_states_in_space(run_count());
}

fn check_random_states_in_space(runs: usize) {
    check_energy_never_grows::<f64, 3>(
        (0..runs).map(|run| run + 1_000_000),
        STEPS_PER_RUN,
        MAX_GROWTH,
    );
}

#[test]
fn energy_never_grows_from_random_states_in_single_precision() {
    check_random_states_in_single_precision(run_count());
}

fn check_random_states_in_single_precision(runs: usize) {
    check_energy_never_grows::<f32, 2>(
        (0..runs).map(|run| run + 3_000_000),
        STEPS_PER_RUN,
        MAX_GROWTH_SINGLE_PRECISION,
    );
}

#[test]
#[ignore = "takes minutes"]
fn energy_never_grows_from_many_random_states() {
    check_random_states_in_the_plane(500);
    check_random_states_in_space(500);
    check_random_states_in_single_precision(500);
}

#[test]
#[ignore = "minutes: cargo test --release -p wellposed-dynamics --test solid energy:: -- --ignored"]
fn energy_never_grows_over_long_runs() {
    check_energy_never_grows::<f64, 2>((0..25).map(|run| run + 2_000_000), 100_000, MAX_GROWTH);
    check_energy_never_grows::<f64, 3>((0..25).map(|run| run + 4_000_000), 100_000, MAX_GROWTH);
}

/// A line of elastic cells between two boundaries. Only one pair of fields is non-zero.
struct LineDomain {
    domain: Domain<f64, 2>,
    zero_values: Vec<f64>,
}

impl LineDomain {
    fn new(cells: usize, courant: f64, boundaries: [Boundary; 2]) -> Self {
        let medium = Medium::new(classical(1.0), 2);
        let step = 2.0 * courant * 0.1 / medium.max_speed();
        let grid = Grid { cells: [cells, 1], spacing: [0.1; 2] };
        let periodic = [Boundary::Periodic, Boundary::Periodic];
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let problem =
            Problem::new(grid, vec![medium], vec![0; cells], [boundaries, periodic], step, scheme);
        Self { domain: Domain::new(&problem).expect("sound"), zero_values: vec![0.0; cells] }
    }

    /// Computes the relative change of energy in one step from a state: the velocities of all cells, then their
    /// stresses.
    fn energy_growth(&mut self, state: &[f64]) -> f64 {
        let cells = self.zero_values.len();
        for (index, field) in self.domain.fields().to_vec().into_iter().enumerate() {
            let values = match index {
                0 => &state[..cells],
                // Field 2 is σ₁₁, after the two velocities; all fields other than v₁ and σ₁₁ are zero.
                2 => &state[cells..2 * cells],
                _ => &self.zero_values[..],
            };
            self.domain.set_field(field, values);
        }
        let before = self.domain.energy().total();
        self.domain.advance();
        self.domain.energy().total() / before - 1.0
    }
}

/// Maximises the growth of energy by stochastic ascent: perturbs a random state of `count` numbers `trials` times,
/// keeping the state of largest growth; returns that growth.
fn maximise_growth(
    random: &mut NoiseSequence,
    count: usize,
    trials: usize,
    mut growth: impl FnMut(&[f64]) -> f64,
) -> f64 {
    let mut state: Vec<f64> = (0..count).map(|_| random.uniform_symmetric()).collect();
    let mut max_growth = growth(&state);
    for _ in 0..trials {
        let size = 10f64.powf(-2.0 + 2.0 * random.uniform_symmetric());
        let mut candidate = state.clone();
        for value in &mut candidate {
            if random.uniform_index(3) == 0 {
                *value += size * random.uniform_symmetric();
            }
        }
        let candidate_growth = growth(&candidate);
        if candidate_growth > max_growth {
            (state, max_growth) = (candidate, candidate_growth);
        }
    }
    max_growth
}

#[test]
fn no_state_next_to_a_boundary_gains_energy() {
    let kinds = [Boundary::Free, Boundary::Fixed, Boundary::NonReflecting];
    let mut random = NoiseSequence::new(77 << 40);
    for cells in [2, 3, 5, 8] {
        for courant in [0.1, 0.3, 0.5, 0.7, 0.9, 0.97] {
            for kind in &kinds {
                let mut line = LineDomain::new(cells, courant, [kind.clone(), kind.clone()]);
                let max_growth = maximise_growth(&mut random, 2 * cells, 1500, |state| {
                    line.energy_growth(state)
                });
                assert!(
                    max_growth <= MAX_GROWTH,
                    "{kind:?}, {cells} cells, Courant {courant}: {max_growth:e}"
                );
            }
        }
    }
}

/// Verifies sweeps on lines of two media with a free and a fixed end (image ghosts): most cells are next to an
/// interface or a boundary.
#[test]
fn no_state_next_to_an_interface_gains_energy() {
    let mut random = NoiseSequence::new(78 << 40);
    let lines: [&[usize]; 6] =
        [&[0, 1], &[0, 0, 1], &[0, 0, 1, 1], &[0, 1, 0, 1], &[0, 1, 1, 0], &[0, 0, 0, 1, 1, 1]];
    for ratio in [0.18, 0.45, 1.0, 2.2, 5.5, 100.0] {
        for courant in [[0.9, 0.4], [0.9, 0.1], [0.4, 0.9], [0.97, 0.97], [0.6, 0.3], [1.0, 0.2]] {
            let media =
                [CellConstants::new(1.0, courant[0]), CellConstants::new(ratio, courant[1])];
            for line in lines {
                let count = line.len();
                let image_cell = |i: isize| {
                    let last = count as isize - 1;
                    // Index of the image cell, and signs of its velocity and stress.
                    match i {
                        i if i < 0 => ((-1 - i).min(last) as usize, 1.0, -1.0),
                        i if i > last => ((2 * last + 1 - i).max(0) as usize, -1.0, 1.0),
                        i => (i as usize, 1.0, 1.0),
                    }
                };
                let images: Vec<_> = (0..count + 2 * GHOSTS)
                    .map(|i| image_cell(i as isize - GHOSTS as isize))
                    .collect();
                let cells: Vec<CellConstants<f64>> =
                    images.iter().map(|own| media[line[own.0]]).collect();
                let growth = |state: &[f64]| {
                    let impedance = |place: usize| cells[GHOSTS + place].impedance;
                    // Amplitudes are scaled so that equal entries of `state` give all cells equal energies.
                    let size = |place: usize| cells[GHOSTS + place].courant().sqrt();
                    let mut velocity: Vec<f64> = images
                        .iter()
                        .map(|&(i, sign, _)| sign * size(i) * state[i] / impedance(i).sqrt())
                        .collect();
                    let mut stress: Vec<f64> = images
                        .iter()
                        .map(|&(i, _, sign)| {
                            sign * size(i) * state[count + i] * impedance(i).sqrt()
                        })
                        .collect();
                    let before = energy(&velocity, &stress, &cells);
                    sweep(&mut velocity, &mut stress, &cells, Slopes::Limited, None);
                    energy(&velocity, &stress, &cells) / before - 1.0
                };
                let max_growth = maximise_growth(&mut random, 2 * count, 3000, growth);
                assert!(
                    max_growth <= MAX_GROWTH,
                    "z {ratio}, Courant {courant:?}, {line:?}: {max_growth:e}"
                );
            }
        }
    }
}
