//! Shear waves that are swept in one of two or three steps: exact plane waves from a loaded side, order of accuracy for
//! oblique waves, refused problems. Bloch waves of blocks: `blocky_media`; random problems: `blocks`, `configurations`.

use crate::support::blocky::{BLOCK_LENGTH, blocky_problem};
use crate::support::interlayers::layers_of_all_kinds;
use crate::support::random::NoiseSequence;
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use std::f64::consts::{SQRT_2, TAU};
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Load};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};

/// Density of the solid, kg/m³; the speed of S waves is 1 m/s.
const DENSITY: f64 = 2.0;

/// Returns the solid whose P waves are `ratio` times as fast as its S waves.
fn solid(ratio: f64) -> Medium {
    let moduli = Isotropic::new(DENSITY * (ratio * ratio - 2.0), DENSITY, DENSITY, None);
    Medium::new(moduli.expect("sound moduli"), 2)
}

/// Returns a problem of the solid with shear waves swept in one of `interval` steps, both families at a Courant number.
fn problem(
    (cells, spacing): ([usize; 2], f64),
    boundaries: [[Boundary; 2]; 2],
    (interval, courant): (usize, f64),
) -> Problem<2> {
    let grid = Grid { cells, spacing: [spacing; 2] };
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let (media, step) = (vec![solid(interval as f64)], 2.0 * courant * spacing / interval as f64);
    Problem {
        shear_interval: interval,
        ..Problem::new(grid, media, vec![0; grid.count()], boundaries, step, scheme)
    }
}

/// Verifies that a side with normal and tangential traction emits P and S waves that move by one cell per sweep of
/// their own, with the traction in the middle of the sweep at the side.
#[test]
fn loaded_side_emits_exact_waves_of_both_families() {
    const LENGTH: usize = 40;
    for (interval, axis) in [(2, 0), (2, 1), (3, 0), (3, 1)] {
        let mut cells = [3; 2];
        cells[axis] = LENGTH;
        let mut boundaries = [0, 1].map(|_| [Boundary::Periodic, Boundary::Periodic]);
        boundaries[axis] = [Boundary::Free, Boundary::NonReflecting];
        let mut problem = problem((cells, 1.0), boundaries, (interval, 1.0));
        let signals: [fn(f64) -> f64; 2] =
            [|time| (0.3 * time).sin() + 0.1 * time, |time| (0.2 * time).cos() - 0.05 * time];
        for (component, signal) in signals.into_iter().enumerate() {
            let pair = [axis, 1 - axis][component];
            let faces = (0..3).map(|face| (face, 1.0)).collect();
            problem.loads.push(Load { axis, end: 0, pair, faces, signal: Arc::new(signal) });
        }
        let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
        for steps in 1..=15 {
            (0..interval).for_each(|_| domain.advance());
            let time = domain.time();
            for (component, signal) in signals.into_iter().enumerate() {
                let pair = &problem.media[0].pairs[axis][[axis, 1 - axis][component]];
                let sweep = 1.0 / pair.speed();
                let sweeps = (time / sweep).round() as usize;
                assert_eq!(sweeps, 2 * steps * [interval, 1][component]);
                let stress = domain.values(pair.stress).expect("a field");
                let velocity = domain.values(pair.velocity).expect("a field");
                for cell in 0..problem.grid.count() {
                    let place = [cell % cells[0], cell / cells[0]][axis];
                    let expected = match sweeps.checked_sub(place + 1) {
                        Some(emitted) => signal((emitted as f64 + 0.5) * sweep),
                        None => 0.0,
                    };
                    let errors =
                        [stress[cell] - expected, velocity[cell] * pair.impedance() + expected];
                    assert!(
                        errors.iter().all(|error| error.abs() < 1e-12),
                        "interval {interval}, axis {axis}, component {component}, cell {place}: {errors:?}"
                    );
                }
            }
        }
    }
}

/// Largest error of the velocities of an oblique P wave and an oblique S wave, which cross a periodic square of `cells`
/// cells along each axis, after a period of the S wave; P waves are `ratio` times as fast as S waves.
fn oblique_wave_error(cells: usize, ratio: usize, interval: usize) -> f64 {
    let periodic = [0, 1].map(|_| [Boundary::Periodic, Boundary::Periodic]);
    let problem = Problem {
        shear_interval: interval,
        ..problem(([cells; 2], 1.0 / cells as f64), periodic, (ratio, 1.0))
    };
    let [longitudinal, shear] = [ratio as f64, 1.0];
    let modulus = |speed: f64| DENSITY * speed * speed;
    let lambda = modulus(longitudinal) - 2.0 * modulus(shear);
    let number = TAU * SQRT_2;
    // By wave: direction of motion, speed and phase along the common wave vector (1, 1)/√2.
    let waves = [([1.0, 1.0], longitudinal, 0.4), ([1.0, -1.0], shear, 1.1)];
    let value = |field: SolidField, position: [f64; 2], time: f64| -> f64 {
        let of_wave = |&(motion, speed, phase): &([f64; 2], f64, f64)| {
            let place = TAU * (position[0] + position[1]);
            let shape = (place - number * speed * time + phase).cos();
            let divergence = if speed == longitudinal { SQRT_2 } else { 0.0 };
            let stress = |i: usize, j: usize| {
                let isotropic = if i == j { lambda * divergence } else { 0.0 };
                let gradient = if i == 2 { 0.0 } else { (motion[i] + motion[j]) / SQRT_2 };
                -(isotropic + modulus(shear) * gradient) / speed
            };
            shape
                * match field {
                    SolidField::Velocity(i) => motion[i],
                    SolidField::Stress(i, j) => stress(i, j),
                    _ => 0.0,
                }
        };
        waves.iter().map(of_wave).sum()
    };
    let centre =
        |cell: usize| [cell % cells, cell / cells].map(|index| (index as f64 + 0.5) / cells as f64);
    let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
    for field in domain.fields().to_vec() {
        let values: Vec<f64> =
            (0..problem.grid.count()).map(|cell| value(field, centre(cell), 0.0)).collect();
        domain.set_field(field, &values);
    }
    // The S wave needs 1/√2 for a period; the steps end at a multiple of the order of the steps, beside it.
    let steps = (0.7 / problem.step / (2 * ratio) as f64).round() as usize * 2 * ratio;
    (0..steps).for_each(|_| domain.advance());
    let mut error = 0.0f64;
    for field in [SolidField::Velocity(0), SolidField::Velocity(1)] {
        let found = domain.values(field).expect("a field");
        for (cell, found) in found.into_iter().enumerate() {
            error = error.max((found - value(field, centre(cell), domain.time())).abs());
        }
    }
    error
}

/// Verifies that the scheme is of second order for oblique waves; prints the error by that with the same step for all
/// waves.
#[test]
fn oblique_waves_have_second_order() {
    for ratio in [2, 3] {
        let errors = [20, 40, 80].map(|cells| oblique_wave_error(cells, ratio, ratio));
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        let error_ratio = errors[2] / oblique_wave_error(80, ratio, 1);
        println!("{ratio}: {errors:?} {orders:?} {error_ratio}");
        assert!(orders.iter().all(|order| (1.9..2.6).contains(order)), "{orders:?}");
    }
}

/// Verifies that problems for which shear waves cannot have steps of their own are refused.
#[test]
fn impossible_shear_intervals_are_refused() {
    let periodic = || [0, 1].map(|_| [Boundary::Periodic, Boundary::Periodic]);
    let sound = || problem(([6; 2], 1.0), periodic(), (2, 1.0));
    assert_eq!(sound().validate(), Ok(()));
    for shear_interval in [0, 4] {
        let refused = Problem { shear_interval, ..sound() }.validate();
        assert!(matches!(refused, Err(DomainError::ShearInterval(_))), "{refused:?}");
    }
    let mut alternating = sound();
    alternating.scheme.splitting = Splitting::Alternating;
    let refused = alternating.validate();
    assert!(matches!(refused, Err(DomainError::ShearInterval(_))), "{refused:?}");
    // S waves faster than half the speed of P waves would exceed the Courant number 1.
    let mut fast = sound();
    fast.media = vec![solid(1.9)];
    fast.step /= 1.9 / 2.0;
    let refused = fast.validate();
    assert!(matches!(refused, Err(DomainError::Courant { courant, .. }) if courant > 1.05));
    let mut random = NoiseSequence::new(3 << 40);
    let mut refused_count = 0;
    for law in layers_of_all_kinds(&mut random) {
        let mut blocky = blocky_problem([2; 2], 3, law, periodic());
        blocky.media = vec![solid(2.0)];
        (blocky.step, blocky.shear_interval) = (BLOCK_LENGTH / 3.0, 2);
        match blocky.validate() {
            Err(DomainError::ShearInterval(_)) => refused_count += 1,
            other => assert!(law.normal_variable_count().is_some(), "{other:?}"),
        }
    }
    // Plastic with and without friction, two cracked, saturated, breaking; with the mass in a box and lumped.
    assert_eq!(refused_count, 12);
}
