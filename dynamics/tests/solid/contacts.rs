//! Granular and porous media: fused solver against the reference solver, energy, ledger, symmetry.

use crate::configurations::{
    FLUSHED_MAGNITUDES, compare_problems, make_polar, random_problem_with_media,
};
use crate::support::media::classical;
use crate::support::noise;
use crate::support::random::NoiseSequence;
use models::granular_medium::{
    GranularContact, GranularMedium, GranularParameters, KelvinVoigtParticles, MaxwellParticles,
};
use models::porous::{PoreContact, PorousMedium, PorousParameters};
use models::solid::waves::SolidField;
use models::yield_set::parameters::Mises;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::contact_law::{ContactLaw, ViscousParticles};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;

/// Yield stress τ_s of plastic particles and skeletons.
const YIELD_STRESS: f64 = 0.1;

/// Returns a granular medium with constants of order one.
pub fn granular(friction: f64, yield_stress: Option<f64>, dimensions: usize) -> Medium {
    let parameters = GranularParameters {
        density: 1.2,
        bulk_modulus: 1.5,
        shear_modulus: 0.9,
        friction,
        yield_stress,
        intensity_coefficient: 0.375,
    };
    let medium = GranularMedium::new(parameters).expect("sound constants");
    Medium::with_contact(ContactLaw::from(&medium), dimensions)
}

/// Returns a porous medium with constants of order one; a plastic skeleton has the yield stress [`YIELD_STRESS`].
pub fn porous(contact_modulus: f64, porosity: f64, is_plastic: bool, dimensions: usize) -> Medium {
    let parameters = PorousParameters {
        density: 1.2,
        bulk_modulus: 1.5,
        shear_modulus: 0.9,
        yield_stress: None,
        intensity_coefficient: 0.375,
        contact_bulk_modulus: contact_modulus,
        porosity,
        contact: PoreContact::Spherical,
    };
    let medium = PorousMedium::new(parameters).expect("sound constants");
    let law = ContactLaw::from_porous(&medium);
    let medium = Medium::with_contact(law, dimensions);
    match is_plastic {
        true => medium.with_yield_set(Mises::new_von_mises(YIELD_STRESS)),
        false => medium,
    }
}

/// Returns a porous medium whose pore walls transmit stresses in a friction cone; without pores and plastic flow it is a
/// heteromodular solid.
pub fn porous_cone(
    friction: f64,
    porosity: f64,
    yield_stress: Option<f64>,
    dimensions: usize,
) -> Medium {
    let parameters = PorousParameters {
        density: 1.2,
        bulk_modulus: 1.5,
        shear_modulus: 0.9,
        yield_stress,
        intensity_coefficient: 0.375,
        contact_bulk_modulus: 4.0,
        porosity,
        contact: PoreContact::Frictional { shear_modulus: 1.7, friction },
    };
    let medium = PorousMedium::new(parameters).expect("sound constants");
    let law = ContactLaw::from_porous(&medium);
    Medium::with_contact(law, dimensions)
}

/// Returns a granular medium with viscous particles.
pub fn viscous_granular(yield_stress: Option<f64>, dimensions: usize) -> Medium {
    let medium = soft_granular(yield_stress);
    let law = GranularContact::new(&medium);
    let particles = MaxwellParticles::new(&law, 0.9, [Some(2.0), Some(5.0)]);
    let contact = ContactLaw::from_viscous(&medium, particles.expect("sound viscosities"));
    Medium::with_contact(contact, dimensions)
}

/// Returns a granular medium with parallel dashpots, which are springs of the modulus 1.6 for shear and `bulk_modulus` for
/// volume in a step of any size; see [`set_steps`].
pub fn damped_granular(
    bulk_modulus: Option<f64>,
    yield_stress: Option<f64>,
    dimensions: usize,
) -> Medium {
    let viscosities = [Some(0.8), bulk_modulus.map(|modulus| 0.5 * modulus)];
    let particles = KelvinVoigtParticles::new(viscosities).expect("sound viscosities");
    let contact = ContactLaw::from_damped(&soft_granular(yield_stress), particles, 1.0);
    Medium::with_contact(contact, dimensions)
}

/// Sets the time step of parallel dashpots, whose moduli in a step it does not change.
fn set_steps(media: &mut [Medium], time_step: f64) {
    for medium in media {
        if let Some(ContactLaw::Granular {
            particles: Some(ViscousParticles::KelvinVoigt { step, .. }),
            ..
        }) = &mut medium.contact
        {
            *step = time_step;
        }
    }
}

fn soft_granular(yield_stress: Option<f64>) -> GranularMedium {
    let parameters = GranularParameters {
        density: 1.2,
        bulk_modulus: 1.5,
        shear_modulus: 0.9,
        friction: 0.5,
        yield_stress,
        intensity_coefficient: 0.375,
    };
    GranularMedium::new(parameters).expect("sound constants")
}

fn random_media<const D: usize>(random: &mut NoiseSequence) -> Vec<Medium> {
    let medium = |random: &mut NoiseSequence| match random.uniform_index(9) {
        0 | 1 => {
            let friction = random.choose(&[0.0, 0.5, 0.5, 1.2]);
            granular(friction, random.choose(&[None, Some(YIELD_STRESS)]), D)
        }
        2 | 3 => {
            let medium = porous(
                random.choose(&[0.0, 0.8, 12.0]),
                random.choose(&[0.0, 0.02, 0.2]),
                random.is_one_in(2),
                D,
            );
            match random.is_one_in(4) {
                true => medium.with_overstress_time(0.3),
                false => medium,
            }
        }
        5 => viscous_granular(random.choose(&[None, Some(YIELD_STRESS)]), D),
        4 => porous_cone(random.choose(&[0.0, 0.5, 1.2]), random.choose(&[0.0, 0.02]), None, D),
        6 => {
            let (friction, porosity) =
                (random.choose(&[0.0, 0.5, 1.2]), random.choose(&[0.0, 0.02]));
            porous_cone(friction, porosity, Some(YIELD_STRESS), D)
        }
        7 => {
            let modulus = random.choose(&[None, Some(4.0)]);
            damped_granular(modulus, random.choose(&[None, Some(YIELD_STRESS)]), D)
        }
        _ => {
            let medium = Medium::new(classical(random.choose(&[0.3, 2.3])), D);
            match random.is_one_in(2) {
                true => medium.with_yield_set(Mises::new_von_mises(YIELD_STRESS)),
                false => medium,
            }
        }
    };
    let mut media: Vec<_> = (0..=random.uniform_index(3)).map(|_| medium(random)).collect();
    if media.iter().all(|own| own.contact.is_none()) {
        media[0] = granular(0.5, None, D);
    }
    media
}

/// Returns a random problem with contacts.
fn random_problem<const D: usize>(random: &mut NoiseSequence) -> Problem<D> {
    let media = random_media::<D>(random);
    let mut problem = random_problem_with_media::<D>(random, media);
    let slopes = match problem.scheme.slopes {
        Slopes::Godunov => Slopes::Godunov,
        _ => Slopes::Limited,
    };
    problem.scheme = Scheme {
        splitting: Splitting::TwoCyclic,
        ..Scheme::new(slopes, PlasticStep::ReturnMapping)
    };
    problem.initial_stress = None;
    problem.interlayers.clear();
    problem.shear_interval = 1;
    for source in &mut problem.sources {
        source.amplitudes.retain(|(field, _)| matches!(field, SolidField::Velocity(_)));
    }
    if D == 2 && random.is_one_in(2) {
        make_polar(random, &mut problem);
    }
    set_steps(&mut problem.media, problem.step);
    problem
}

#[test]
fn fused_solver_equals_the_reference_in_the_plane() {
    let counts = compare_problems::<f64, 2>((0, 24), FLUSHED_MAGNITUDES[0], random_problem);
    assert!(counts[0] >= 6 && counts[1] >= 6, "{counts:?}");
}

#[test]
fn fused_solver_equals_the_reference_in_space() {
    let counts = compare_problems::<f64, 3>((1_000_000, 12), FLUSHED_MAGNITUDES[0], random_problem);
    assert!(counts[0] >= 3 && counts[1] >= 3, "{counts:?}");
}

#[test]
fn fused_solver_equals_the_reference_in_single_precision() {
    compare_problems::<f32, 2>((2_000_000, 8), FLUSHED_MAGNITUDES[1], random_problem);
    compare_problems::<f32, 3>((3_000_000, 4), FLUSHED_MAGNITUDES[1], random_problem);
}

/// Verifies that a medium which does not separate, and fills the grid, is not swept like the sand that is also among the
/// media of the problem.
#[test]
fn fused_solver_equals_the_reference_where_the_sand_of_a_problem_is_absent() {
    fn problem<const D: usize>(random: &mut NoiseSequence) -> Problem<D> {
        let sand = granular(0.5, None, D);
        let medium = match random.is_one_in(2) {
            true => porous_cone(1.2, 0.0, None, D),
            false => Medium::new(classical(0.8), D),
        };
        let grid = Grid { cells: std::array::from_fn(|axis| [20, 5, 2][axis]), spacing: [0.1; D] };
        let step = 0.16 / medium.max_speed().max(sand.max_speed());
        let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::NonReflecting]);
        let scheme = Scheme {
            splitting: Splitting::TwoCyclic,
            ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping)
        };
        Problem::new(grid, vec![medium, sand], vec![0; grid.count()], boundaries, step, scheme)
    }
    compare_problems::<f64, 2>((4_000_000, 2), FLUSHED_MAGNITUDES[0], problem);
    compare_problems::<f32, 3>((5_000_000, 2), FLUSHED_MAGNITUDES[1], problem);
}

/// Runs a problem with random initial velocities and no loads; returns the energies after each step, relative to that at
/// the start, and the greatest normal stress, relative to the greatest magnitude of a stress.
fn run_random_pulses<const D: usize>(
    mut media: Vec<Medium>,
    cells: [usize; D],
    (boundary, seed, steps): (&Boundary, u64, usize),
) -> (Vec<f64>, f64) {
    let mut random = NoiseSequence::new(seed << 32);
    let count: usize = cells.iter().product();
    let patch = 3 + random.uniform_index(5);
    let of_cell = (0..count).map(|cell| (cell % cells[0] / patch % media.len()) as u16).collect();
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = random.choose(&[2.0, 1.6]) * 0.1 / speed;
    set_steps(&mut media, step);
    let scheme = Scheme {
        splitting: Splitting::TwoCyclic,
        ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping)
    };
    let grid = Grid { cells, spacing: [0.1; D] };
    let boundaries = std::array::from_fn(|_| [boundary.clone(), boundary.clone()]);
    let problem = Problem::new(grid, media, of_cell, boundaries, step, scheme);
    let mut domain: Domain<f64, D> = Domain::new(&problem).expect("a sound problem");
    let width = 2 + random.uniform_index(6);
    for axis in 0..D {
        let amplitudes: Vec<f64> = (0..count).map(|_| random.uniform_symmetric()).collect();
        let values: Vec<f64> = (0..count).map(|cell| amplitudes[cell / width * width]).collect();
        domain.set_field(SolidField::Velocity(axis), &values);
    }
    let start = domain.energy().total();
    let mut energies = Vec::with_capacity(steps);
    let (mut tension, mut magnitude) = (0.0f64, 0.0f64);
    for _ in 0..steps {
        domain.advance();
        energies.push(domain.energy().total() / start);
        for axis in 0..3 {
            for value in domain.values(SolidField::Stress(axis, axis)).unwrap_or_default() {
                tension = tension.max(value);
                magnitude = magnitude.max(value.abs());
            }
        }
    }
    (energies, tension / magnitude)
}

/// Verifies that the energy does not grow in any step, with open faces, closing and opening contacts and pores. With
/// friction below √(3c²/2) = ¾ a granular medium has no tension.
fn check_random_pulses(seeds: std::ops::Range<u64>, steps: usize) {
    for seed in seeds {
        let mut random = NoiseSequence::new((seed + 77) << 32);
        let friction = random.choose(&[0.0, 0.3, 0.65, 1.2]);
        let yield_stress = random.choose(&[None, Some(YIELD_STRESS)]);
        let boundary =
            [Boundary::Free, Boundary::Fixed, Boundary::Periodic][random.uniform_index(3)].clone();
        for kind in 0..8 {
            let media = |dimensions: usize| match kind {
                0 => vec![granular(friction, yield_stress, dimensions)],
                1 => vec![porous(5.0, 0.05, yield_stress.is_some(), dimensions)],
                4 => vec![porous(5.0, 0.05, true, dimensions).with_overstress_time(0.3)],
                3 => vec![viscous_granular(yield_stress, dimensions)],
                2 => vec![porous_cone(friction, 0.02, None, dimensions)],
                6 => vec![porous_cone(friction, 0.02, Some(YIELD_STRESS), dimensions)],
                7 => vec![damped_granular(Some(4.0), yield_stress, dimensions)],
                _ => vec![
                    granular(friction, yield_stress, dimensions),
                    Medium::new(classical(0.8), dimensions),
                    porous(5.0, 0.02, false, dimensions),
                    porous_cone(friction, 0.0, None, dimensions),
                ],
            };
            let run = (&boundary, seed, steps);
            let plane = run_random_pulses::<2>(media(2), [24, 19], run);
            let space = run_random_pulses::<3>(media(3), [9, 7, 6], run);
            for (energies, tension) in [plane, space] {
                let mut before = 1.0;
                for (step, energy) in energies.iter().enumerate() {
                    assert!(
                        *energy <= before + 1e-14,
                        "{kind} {seed}: step {step}: {energy} after {before}"
                    );
                    before = *energy;
                }
                assert!(kind > 0 || friction > 0.75 || tension <= 1e-15, "{seed}: {tension:e}");
            }
        }
    }
}

#[test]
fn energy_never_grows_under_random_pulses() {
    check_random_pulses(0..6, 60);
}

#[test]
fn energy_of_sand_does_not_grow_beside_free_boundaries() {
    for yield_stress in [None, Some(YIELD_STRESS)] {
        for seed in 0..12 {
            let media = vec![granular(0.5, yield_stress, 2)];
            let (energies, _) =
                run_random_pulses::<2>(media, [24, 19], (&Boundary::Free, seed, 60));
            let growth = energies.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
            assert!(growth <= 1e-14, "{seed}: {growth:e}");
        }
    }
}

#[test]
#[ignore = "100,000 steps of each medium, half an hour"]
fn energy_never_grows_in_long_runs() {
    check_random_pulses(0..1, 100_000);
}

#[test]
fn ledgers_of_media_with_contacts_close() {
    let media = [
        granular(0.5, Some(YIELD_STRESS), 2),
        porous(5.0, 0.05, true, 2),
        porous_cone(0.5, 0.02, None, 2),
        porous_cone(0.5, 0.02, Some(YIELD_STRESS), 2),
        viscous_granular(Some(YIELD_STRESS), 2),
        damped_granular(Some(4.0), None, 2),
        damped_granular(None, Some(YIELD_STRESS), 2),
        porous(5.0, 0.05, true, 2).with_overstress_time(0.2),
    ];
    for (index, medium) in media.into_iter().enumerate() {
        let (is_plastic, relaxes) = (medium.is_plastic(), medium.relaxes());
        let scheme = Scheme {
            splitting: Splitting::TwoCyclic,
            ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping)
        };
        let step = 0.18 / medium.max_speed();
        let boundaries =
            [[Boundary::Free, Boundary::Free], [Boundary::Fixed, Boundary::NonReflecting]];
        let mut problem = Problem::new(
            Grid { cells: [14, 11], spacing: [0.1; 2] },
            vec![medium],
            vec![0; 154],
            boundaries,
            step,
            scheme,
        );
        set_steps(&mut problem.media, step);
        problem.acceleration = [0.05, -0.02];
        let mut reference: Reference<f64, 2> = Reference::new(&problem).expect("a sound problem");
        let velocities: Vec<f64> = (0..154).map(|cell| noise(cell + 1000)).collect();
        reference.set_field(SolidField::Velocity(0), &velocities);
        let start = reference.energy().total();
        reference.advance(40);
        let ledger = reference.ledger();
        let dissipated =
            ledger.plastic_dissipation + ledger.viscous_dissipation + ledger.numerical_dissipation;
        let residual = start + ledger.boundary_work + ledger.source_work
            - dissipated
            - reference.energy().total();
        assert_eq!(ledger.plastic_dissipation > 0.01 * start, is_plastic, "{index}: {ledger:?}");
        assert_eq!(ledger.viscous_dissipation > 0.01 * start, relaxes, "{index}: {ledger:?}");
        assert!(residual.abs() < 1e-13 * start, "{index}: {residual:e} {ledger:?}");
    }
}

/// At constant strain the overstress decays by exp(−t/τ), and the stress within the yield set does not change; what is
/// lost is plastic dissipation.
#[test]
fn overstress_relaxes_exponentially() {
    let (time, steps) = (0.4, 9);
    let medium = Medium::new(classical(0.8), 2)
        .with_yield_set(Mises::new_von_mises(YIELD_STRESS))
        .with_overstress_time(time);
    let step = 1.5 * 0.1 / medium.max_speed();
    let scheme = Scheme {
        splitting: Splitting::TwoCyclic,
        ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping)
    };
    let problem = Problem::new(
        Grid { cells: [9, 4], spacing: [0.1; 2] },
        vec![medium],
        vec![0; 36],
        std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
        step,
        scheme,
    );
    let mut domain: DecomposedDomain<f64, 2> =
        DecomposedDomain::new(&problem, 1).expect("a sound problem");
    // Pure shear: √(½ s:s) is the shear stress.
    domain.set_field(SolidField::Stress(0, 1), &[0.25; 36]);
    let start = domain.energy().total();
    domain.advance(steps).expect("one thread");
    let expected = YIELD_STRESS + (0.25 - YIELD_STRESS) * (-(steps as f64) * step / time).exp();
    for value in domain.values(SolidField::Stress(0, 1)).expect("a field") {
        assert!((value - expected).abs() < 1e-14, "{value} {expected}");
    }
    let lost = start - domain.energy().total();
    let dissipated = domain.ledger().plastic_dissipation;
    assert!((lost - dissipated).abs() < 1e-14 * start && lost > 0.1 * start, "{lost} {dissipated}");
}

/// Initial state of [`run_turned`].
#[derive(Clone, Copy)]
enum Phases {
    /// Without stress: parts open, others close and yield.
    Mixed,
    /// Under a pressure that keeps contacts closed, and without yielding.
    Closed,
    /// Open by so much that contacts stay open.
    Open,
}

/// Runs a granular medium of `count`² cells on the periodic unit square from smooth velocities, a compression, an
/// extension and a shear side by side; if `is_turned`, turned by 90°. Returns velocities v₁, v₂ and stress σ₁₁ in the frame
/// without rotation, and the shares of open and of plastic cells.
fn run_turned(phases: Phases, count: usize, is_turned: bool) -> ([Vec<f64>; 3], [f64; 2]) {
    use std::f64::consts::TAU;
    let create: fn(usize, usize) -> SolidField = match phases {
        Phases::Open => SolidField::ExcessStress,
        Phases::Mixed | Phases::Closed => SolidField::Stress,
    };
    let (yield_stress, amplitude, initial) = match phases {
        Phases::Mixed => (Some(0.05), 1.0, 0.0),
        Phases::Closed => (None, 0.3, -1.0),
        Phases::Open => (None, 0.3, 1.0),
    };
    let medium = granular(0.5, yield_stress, 2);
    let scheme = Scheme {
        splitting: Splitting::TwoCyclic,
        ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping)
    };
    let spacing = 1.0 / count as f64;
    let steps = count / 12;
    let step = 1.6 * spacing / medium.max_speed();
    let problem = Problem::new(
        Grid { cells: [count; 2], spacing: [spacing; 2] },
        vec![medium],
        vec![0; count * count],
        std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
        step,
        scheme,
    );
    let mut domain: DecomposedDomain<f64, 2> =
        DecomposedDomain::new(&problem, 1).expect("a sound problem");
    // Cell (i, j) of the turned grid is cell (j, n − 1 − i) of the original one.
    let original = |cell: usize| match is_turned {
        true => (cell / count, count - 1 - cell % count),
        false => (cell % count, cell / count),
    };
    let velocity = |cell: usize| {
        let (i, j) = original(cell);
        let [x, y] = [i, j].map(|own| (own as f64 + 0.5) * spacing);
        let first = 0.2 * (TAU * x).sin() * (1.5 + (TAU * y).cos()) / 2.5;
        let second = 0.15 * (TAU * x + 0.7).cos() + 0.05 * (TAU * (x + y)).sin();
        let [first, second] = [amplitude * first, amplitude * second];
        if is_turned { [-second, first] } else { [first, second] }
    };
    for axis in 0..3 {
        domain.set_field(create(axis, axis), &vec![initial; count * count]);
    }
    for axis in 0..2 {
        let values: Vec<f64> = (0..count * count).map(|cell| velocity(cell)[axis]).collect();
        domain.set_field(SolidField::Velocity(axis), &values);
    }
    let mut largest_open = 0.0f64;
    for _ in 0..steps {
        domain.advance(1).expect("one thread");
        let excess = domain.values(SolidField::ExcessStress(0, 0)).expect("a field");
        let open = excess.iter().filter(|own| **own > 0.0).count();
        largest_open = largest_open.max(open as f64 / (count * count) as f64);
    }
    let take = |field: SolidField, sign: f64| {
        let mut values = vec![0.0; count * count];
        for (cell, value) in domain.values(field).expect("a field").into_iter().enumerate() {
            let (i, j) = original(cell);
            values[i + count * j] = sign * value;
        }
        values
    };
    let dissipation = domain.plastic_dissipation();
    let plastic = dissipation.iter().filter(|own| **own > 1e-9).count() as f64;
    let fields = match is_turned {
        true => [
            take(SolidField::Velocity(1), 1.0),
            take(SolidField::Velocity(0), -1.0),
            take(SolidField::Stress(1, 1), 1.0),
        ],
        false => [
            take(SolidField::Velocity(0), 1.0),
            take(SolidField::Velocity(1), 1.0),
            take(SolidField::Stress(0, 0), 1.0),
        ],
    };
    (fields, [largest_open, plastic / (count * count) as f64])
}

/// Mean differences of velocities and stress between a run and a turned one on four grids, and the orders between the
/// first and the last grid.
fn turned_differences(phases: Phases) -> ([[f64; 3]; 4], [f64; 3]) {
    let difference = |count: usize| {
        let (own, shares) = run_turned(phases, count, false);
        let (turned, _) = run_turned(phases, count, true);
        println!("{count}: open, plastic: {shares:?}");
        match phases {
            Phases::Mixed => assert!(shares.iter().all(|own| (0.1..0.9).contains(own))),
            Phases::Closed => assert_eq!(shares, [0.0, 0.0]),
            Phases::Open => assert_eq!(shares, [1.0, 0.0]),
        }
        let mean = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum::<f64>() / (count * count) as f64
        };
        [0, 1, 2].map(|index| mean(&own[index], &turned[index]))
    };
    let differences = [24, 48, 96, 192].map(difference);
    let orders = [0, 1, 2].map(|own| (differences[0][own] / differences[3][own]).log2() / 3.0);
    println!("{differences:?}, orders {orders:?}");
    (differences, orders)
}

/// The difference by the order of the sweeps vanishes with open and plastic cells beside elastic ones, at order 1.3 to 1.4.
/// Order 2 is out of reach: projections after sweeps that have the impedance of closed elastic contacts are of first order
/// where contacts open or particles yield, and so is the solution on one grid against that on the next finer one. The
/// greater part of these errors is the same in both runs. Once compaction shocks have formed, the order is 0.85.
#[test]
fn turned_runs_converge_to_each_other() {
    let (differences, orders) = turned_differences(Phases::Mixed);
    assert!(orders.iter().all(|order| *order > 1.25), "{orders:?}: {differences:?}");
}

/// Where all contacts stay closed, or all open, the difference is of second order, or rounding.
#[test]
fn turned_runs_of_one_phase_differ_at_second_order() {
    let (differences, orders) = turned_differences(Phases::Closed);
    assert!(orders.iter().all(|order| *order > 1.8), "{orders:?}: {differences:?}");
    let (differences, _) = turned_differences(Phases::Open);
    assert!(differences.as_flattened().iter().all(|own| *own < 1e-15), "{differences:?}");
}
