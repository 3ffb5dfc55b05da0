//! Energy ledger with all loads, over many steps; errors that the ledger detects; energy without load.

use crate::support::media::{THEORIES, isotropic};
use crate::support::noise;
use crate::wide_stencil::with_wide_stencil;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances, Theory};
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Source};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::{Slopes, WideOrder};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;

/// Returns the isotropic solid of a theory with λ multiplied by `factor`.
fn scaled_solid(theory: Theory, factor: f64) -> Isotropic {
    Isotropic { lambda: 1.4 * factor, ..isotropic(theory, 1.0) }
}

fn cone_yield_set(friction: f64) -> YieldSet {
    YieldSet::from(Mises {
        antisymmetric_weight: 0.8,
        symmetric_internal_length: Some(0.9),
        antisymmetric_internal_length: Some(0.7),
        ..Mises::new_drucker_prager(0.2, friction, friction)
    })
}

fn interlayer_yield_set(theory: Theory) -> YieldSet {
    let couple = InterlayerCoupleLimits { strength: 0.16, friction: 0.3, dilatancy: 0.3 };
    YieldSet::from(InterlayerYieldSet {
        shear_strength: 0.2,
        shear_friction: 0.5,
        shear_dilatancy: 0.5,
        couple: (theory == Theory::Cosserat).then_some(couple),
    })
}

/// Returns pseudo-random values of each field in all cells.
fn noise_fields(fields: &[SolidField], cells: usize) -> Vec<(SolidField, Vec<f64>)> {
    let values = |index: usize| (0..cells).map(move |cell| noise((1000 * index + cell) as u64));
    fields.iter().enumerate().map(|(index, field)| (*field, values(index).collect())).collect()
}

fn fill_with_noise<const D: usize>(domain: &mut Domain<f64, D>) {
    for (field, values) in noise_fields(domain.fields(), domain.grid().count()) {
        domain.set_field(field, &values);
    }
}

/// Returns a problem with all loads: two media, one of them yielding, initial stress, a mixed loaded boundary, a
/// non-reflecting, a fixed and a free boundary, an internal force, couple and moment, and gravity.
fn problem_with_all_loads(theory: Theory, set: YieldSet, plastic_step: PlasticStep) -> Problem<2> {
    let media = [1.0, 2.0].map(|factor| Medium::new(scaled_solid(theory, factor), 2));
    let [soft, stiff] = media;
    let media = vec![soft.with_yield_set(set), stiff];
    let grid = Grid { cells: [12, 10], spacing: [0.1, 0.12] };
    let cell_media = (0..120).map(|i| u16::from(noise(i) > 0.3)).collect();
    let pairs = media[0].pairs[0].len();
    let mixed = |face: usize| match face {
        0..4 => Condition::Velocity(0.0),
        4..8 => Condition::Traction(0.0),
        _ => Condition::NonReflecting,
    };
    let left = Boundary::ByFace((0..pairs).map(|_| (0..10).map(mixed).collect()).collect());
    let boundaries = [[left, Boundary::NonReflecting], [Boundary::Fixed, Boundary::Free]];
    let step = 2.0 * 0.1 / media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let scheme = Scheme::new(Slopes::Limited, plastic_step);
    let load = |axis: usize, end: usize, pair: usize, frequency: f64| Load {
        axis,
        end,
        pair,
        faces: (0..9).map(|face| (face, 0.05)).collect(),
        signal: Arc::new(move |time: f64| (frequency * time).sin()),
    };
    let mut amplitudes = vec![
        (SolidField::Velocity(1), 0.01),
        (SolidField::Stress(0, 0), 0.002),
        (SolidField::Stress(0, 1), 0.001),
    ];
    if theory != Theory::Classical {
        amplitudes.push((SolidField::Spin(2), 0.01));
    }
    let source = Source {
        cells: vec![(51, 0.6), (52, 0.4)],
        amplitudes,
        signal: Arc::new(|time: f64| (3.0 * time).cos()),
    };
    let pressure = |layer: usize| Stress {
        force: [[-0.02 * layer as f64, 0.01, 0.0], [0.01, -0.03 * layer as f64, 0.0], [0.0; 3]],
        couple: [[0.0; 3]; 3],
    };
    Problem {
        loads: vec![load(0, 0, 0, 2.0), load(0, 0, 1, 3.1), load(1, 1, 1, 1.3)],
        sources: vec![source],
        acceleration: [0.0, -0.05],
        initial_stress: Some((1, (0..10).map(pressure).collect())),
        ..Problem::new(grid, media, cell_media, boundaries, step, scheme)
    }
}

/// Returns the problem with the alternating splitting and nine tenths of the step, as by default in case files.
fn with_default_time_steps(mut problem: Problem<2>) -> Problem<2> {
    problem.step *= 0.9;
    problem.scheme.splitting = Splitting::Alternating;
    problem
}

/// Computes the largest residual of the ledger in every tenth of `steps` steps, relative to the largest energy in them.
fn max_ledger_residual<T: SolverReal>(problem: &Problem<2>, steps: usize) -> f64 {
    let mut domain: Reference<T, 2> = Reference::new(problem).expect("sound");
    let (mut max_energy, mut max_residual) = (0.0f64, 0.0f64);
    for index in 0..steps {
        domain.advance(1);
        if index % 10 == 0 {
            let energy = domain.energy().total();
            max_energy = max_energy.max(energy);
            max_residual = max_residual.max((energy - domain.ledger().energy_change()).abs());
        }
    }
    let ledger = domain.ledger();
    assert!(
        ledger.min_dissipation_ratio >= if size_of::<T>() == 8 { -1e-14 } else { -1e-5 },
        "{:e}",
        ledger.min_dissipation_ratio
    );
    assert!(
        ledger.plastic_dissipation > 0.0
            && ledger.source_work != 0.0
            && ledger.initial_stress_work != 0.0,
        "{ledger:?}"
    );
    max_residual / max_energy
}

/// Verifies the ledger over 2500 steps in Cosserat solids and over 1000 in simpler ones.
#[test]
fn ledger_closes_over_thousands_of_steps() {
    check_ledger(|theory| if theory == Theory::Cosserat { 2500 } else { 1000 });
}

#[test]
#[ignore = "takes half a minute"]
fn ledger_closes_over_many_steps_in_every_theory() {
    check_ledger(|_| 10_000);
}

/// Checks the ledger in solids of every theory after `steps` of the theory.
fn check_ledger(steps: fn(Theory) -> usize) {
    let mut configurations = Vec::new();
    for theory in THEORIES {
        configurations.push((theory, cone_yield_set(0.4), PlasticStep::MidpointReflection));
        configurations.push((theory, cone_yield_set(0.0), PlasticStep::ReturnMapping));
        configurations.push((
            theory,
            interlayer_yield_set(theory),
            PlasticStep::MidpointReflection,
        ));
    }
    for (theory, set, plastic_step) in configurations {
        let problem = problem_with_all_loads(theory, set, plastic_step);
        let mut problems = vec![problem.clone()];
        if plastic_step == PlasticStep::ReturnMapping {
            problems.push(with_default_time_steps(problem));
        }
        for problem in problems {
            let found = max_ledger_residual::<f64>(&problem, steps(theory));
            println!("{theory:?} {:?}: {found:e}", problem.scheme);
            assert!(found < 1e-12, "{theory:?} {:?}: {found:e}", problem.scheme);
        }
    }
}

/// Verifies the ledger with sixth and eighth order, in one yielding solid between sides that are not non-reflecting.
#[test]
fn ledger_closes_with_wide_stencils() {
    for order in [WideOrder::Sixth, WideOrder::Eighth] {
        for plastic_step in [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection] {
            let own = problem_with_all_loads(Theory::Cosserat, cone_yield_set(0.0), plastic_step);
            let problem = with_default_time_steps(with_wide_stencil(own, order));
            let found = max_ledger_residual::<f64>(&problem, 1000);
            println!("{order:?} {plastic_step:?}: {found:e}");
            assert!(found < 1e-12, "{order:?} {plastic_step:?}: {found:e}");
        }
    }
}

/// Verifies the ledger in single precision: each step changes the energy by rounding errors of some 1e-7, which the
/// ledger does not contain.
#[test]
fn ledger_closes_in_single_precision() {
    let problem = with_default_time_steps(problem_with_all_loads(
        Theory::Cosserat,
        cone_yield_set(0.0),
        PlasticStep::ReturnMapping,
    ));
    let found = max_ledger_residual::<f32>(&problem, 4000);
    println!("{found:e}");
    assert!(found < 1e-4, "{found:e}");
}

/// Verifies that an impedance error of one percent, or omitted plastic dissipation, leaves a residual in the ledger.
#[test]
fn ledger_detects_wrong_impedance_and_missing_dissipation() {
    let sound = problem_with_all_loads(
        Theory::Cosserat,
        cone_yield_set(0.4),
        PlasticStep::MidpointReflection,
    );
    for (axis, pair) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
        let mut wrong = sound.clone();
        // The impedance z = √(mM), with the inertia m, is 1.01 times as large.
        wrong.media[1].pairs[axis][pair].modulus *= 1.01 * 1.01;
        wrong.step *= 0.98;
        let found = max_ledger_residual::<f64>(&wrong, 300);
        assert!(found > 1e-6, "pair {pair} along {axis}: {found:e}");
    }
    let mut domain: Reference<f64, 2> = Reference::new(&sound).expect("sound");
    domain.advance(300);
    let ledger = domain.ledger();
    let energy = domain.energy().total();
    let gap = energy - (ledger.energy_change() + ledger.plastic_dissipation);
    assert!(gap.abs() > 1e-3 * energy, "{gap:e} of {energy:e}");
}

/// Returns boundaries that supply no energy.
fn passive_boundaries(medium: &Medium, which: usize) -> [[Boundary; 2]; 2] {
    let side = |axis: usize| match which {
        0 => Boundary::Periodic,
        1 => Boundary::Fixed,
        2 => Boundary::Free,
        3 => Boundary::NonReflecting,
        4 => Boundary::new_symmetry(medium, axis),
        _ => Boundary::new_antisymmetry(medium, axis),
    };
    [0, 1].map(|axis| [side(axis), side(axis)])
}

fn build_all_media() -> Vec<Medium> {
    let couple = CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 };
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple: Some(couple) };
    let isotropic = Isotropic::new(1.4, 0.9, 1.2, Some(rotation)).expect("sound moduli");
    let compliances = PlaneCompliances::from_isotropic(&isotropic).expect("with couple stress");
    let cubic = PlaneCompliances { a2: 1.3 * compliances.a2, ..compliances };
    let mut media = vec![
        Medium::new(cubic, 2),
        Medium::new(cubic, 2).with_yield_set(interlayer_yield_set(Theory::Cosserat)),
    ];
    for theory in THEORIES {
        let medium = Medium::new(scaled_solid(theory, 1.0), 2);
        media.extend([medium.clone(), medium.clone().with_yield_set(cone_yield_set(0.4))]);
        media.push(medium.with_yield_set(interlayer_yield_set(theory)));
    }
    media
}

/// Verifies that the energy, checked after every 1000 of `thousands` × 1000 steps, does not grow. The initial state is
/// noise, the Courant number is 1; all media and all kinds of passive boundaries are tested.
fn check_stability(thousands: usize) {
    for medium in build_all_media() {
        for which in 0..6 {
            let boundaries = passive_boundaries(&medium, which);
            let step = 2.0 * 0.1 / medium.max_speed();
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let grid = Grid { cells: [6, 5], spacing: [0.1, 0.1] };
            let media = vec![medium.clone()];
            let problem = Problem::new(grid, media, vec![0; 30], boundaries, step, scheme);
            let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
            fill_with_noise(&mut domain);
            let mut last = domain.energy().total();
            for _ in 0..thousands {
                for _ in 0..1000 {
                    domain.advance();
                }
                let now = domain.energy().total();
                assert!(now <= last * (1.0 + 1e-12), "{medium:?} {which}: {now} after {last}");
                last = now;
            }
            assert_eq!(domain.first_non_finite(), None);
        }
    }
}

#[test]
fn energy_does_not_grow_over_two_thousand_steps() {
    check_stability(2);
}

#[test]
#[ignore = "a minute: cargo test --release -p wellposed-dynamics --test solid ledger:: -- --ignored"]
fn energy_does_not_grow_over_a_hundred_thousand_steps() {
    check_stability(100);
}

/// Verifies that free and fixed boundaries do no work, with any slopes, on a medium a hundred times slower than its
/// neighbour: its Courant numbers are below the range of the reconstruction next to interfaces.
#[test]
fn boundaries_of_slow_media_do_no_work() {
    let [slow, fast] = [1.0, 1e4].map(|factor| {
        let solid = Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, None).expect("sound moduli");
        Medium::new(solid, 2)
    });
    let step = 0.9 * 2.0 * 0.1 / fast.max_speed();
    for slopes in [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder] {
        let scheme = Scheme {
            splitting: Splitting::Alternating,
            ..Scheme::new(slopes, PlasticStep::ReturnMapping)
        };
        let grid = Grid { cells: [8, 12], spacing: [0.1, 0.1] };
        let cell_media = (0..96).map(|cell| u16::from(cell / 8 > 6)).collect();
        let boundaries = [[Boundary::Free, Boundary::Fixed], [Boundary::Free, Boundary::Fixed]];
        let media = vec![slow.clone(), fast.clone()];
        let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
        let mut domain: Reference<f64, 2> = Reference::new(&problem).expect("sound");
        for (field, values) in noise_fields(domain.fields(), 96) {
            domain.set_field(field, &values);
        }
        let start = domain.energy().total();
        domain.advance(2000);
        let ledger = domain.ledger();
        let residual = domain.energy().total() - start - ledger.energy_change();
        println!(
            "{slopes:?}: {:e} of {start:e} lost, {residual:e} left over",
            ledger.numerical_dissipation
        );
        assert_eq!(ledger.boundary_work, 0.0);
        assert!(
            ledger.numerical_dissipation > 0.0 && residual.abs() < 1e-12 * start,
            "{slopes:?}: {residual:e}"
        );
    }
}

/// Verifies the energies of a domain against the constitutive law, and against ½ρv² and ½s²/M of the pairs.
#[test]
fn energies_follow_from_the_constitutive_laws() {
    for medium in build_all_media() {
        let grid = Grid { cells: [4, 3], spacing: [0.1, 0.2] };
        let boundaries = passive_boundaries(&medium, 2);
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
        let problem =
            Problem::new(grid, vec![medium.clone()], vec![0; 12], boundaries, 1e-3, scheme);
        let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
        fill_with_noise(&mut domain);
        let stored: f64 =
            (0..12).map(|cell| 0.02 * medium.stored_energy(&domain.total_stress(cell))).sum();
        let kinetic: f64 = domain
            .fields()
            .iter()
            .flat_map(|f| domain.values(*f).expect("a field").into_iter().map(|v| (*f, v)))
            .map(|(field, v)| 0.01 * medium.inertia(field) * v * v)
            .sum();
        let energy = domain.energy();
        assert!((energy.stored - stored).abs() < 1e-13 * stored, "{medium:?}");
        assert!((energy.kinetic - kinetic).abs() < 1e-13 * kinetic, "{medium:?}");
        // A wave along an axis stores the energy ½s²/M per volume, with the stress s and the modulus M of its pair of
        // fields.
        for pair in &medium.pairs[0] {
            let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
            domain.set_field(pair.stress, &[1.0; 12]);
            for (follower, ratio) in &pair.passive_stresses {
                domain.set_field(*follower, &[*ratio; 12]);
            }
            let expected = 12.0 * 0.02 * 0.5 / pair.modulus;
            let found = domain.energy().stored;
            assert!((found - expected).abs() < 1e-13 * expected, "{pair:?}: {found} {expected}");
        }
    }
}

/// Verifies single precision against double precision, within rounding.
#[test]
fn single_precision_agrees_with_double_precision() {
    let problem = problem_with_all_loads(
        Theory::Cosserat,
        cone_yield_set(0.4),
        PlasticStep::MidpointReflection,
    );
    let mut double_precision: Domain<f64, 2> = Domain::new(&problem).expect("sound");
    let mut single_precision: Domain<f32, 2> = Domain::new(&problem).expect("sound");
    for _ in 0..200 {
        double_precision.advance();
        single_precision.advance();
    }
    for &field in double_precision.fields() {
        let (a, b) = (
            double_precision.values(field).expect("a field"),
            single_precision.values(field).expect("a field"),
        );
        let largest = a.iter().fold(0.0f64, |x, y| x.max(y.abs()));
        for (a, b) in a.iter().zip(b) {
            assert!((a - f64::from(b)).abs() < 2e-4 * largest, "{field:?} {a} {b}");
        }
    }
    let (a, b) = (double_precision.energy().total(), single_precision.energy().total());
    assert!((a - b).abs() < 1e-4 * a, "{a} {b}");
}
