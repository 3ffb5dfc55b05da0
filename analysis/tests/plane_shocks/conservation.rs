//! Jump conditions, admissibility, and conservation of mass, momentum and energy of whole profiles.

use super::media::{
    FOAM_YIELD_STRESS, aluminium_foam, assert_close, diagram, random_diagram, sand, strong_foam,
};
use models::granular_medium::{GranularMedium, GranularParameters};
use models::uniaxial::UniaxialDiagram;
use testkit::random::RandomNumbers;
use wellposed_analysis::plane_shocks::{PistonLoad, PistonSolution, plastic_work};

/// Asserts jump conditions ρc[v] = [p], c[ε] = [v], the order of the waves, the conditions of Lax and Oleinik, and that
/// the whole profile conserves length, momentum and energy at several times.
fn assert_is_solution(diagram: &UniaxialDiagram, solution: &PistonSolution) {
    let (density, piston) = (solution.density, solution.piston);
    let mut ahead = solution.initial;
    let mut before = f64::INFINITY;
    for wave in &solution.waves {
        assert_eq!(wave.ahead, ahead);
        assert!(wave.speed < before, "{:?}", solution.waves);
        (ahead, before) = (wave.behind, wave.speed);
        let [v, p, e] = [
            wave.behind.velocity - wave.ahead.velocity,
            wave.behind.pressure - wave.ahead.pressure,
            wave.behind.strain - wave.ahead.strain,
        ];
        // Differences of the states lose digits, relative to the state at the piston.
        assert!((density * wave.speed * v - p).abs() <= 1e-13 * piston.pressure);
        assert!((wave.speed * e - v).abs() <= 1e-13 * piston.velocity.abs());
        let [c0, c1] = wave.sound_speeds;
        let rounding = 1e-10 * wave.speed;
        assert!(c0 <= wave.speed + rounding && wave.speed <= c1 + rounding, "{wave:?}");
        assert!(wave.dissipation >= 0.0 && (wave.is_shock || wave.dissipation == 0.0));
        // Oleinik: the diagram lies nowhere above the chord.
        for step in 0..=200 {
            let s = f64::from(step) / 200.0;
            let chord = wave.ahead.pressure + s * p;
            let excess = diagram.pressure(wave.ahead.strain + s * e) - chord;
            assert!(excess <= 1e-11 * piston.pressure, "{excess:e}");
        }
    }
    assert_eq!(ahead, piston);
    for time in [0.3, 1.7] {
        let profile = solution.profile(time);
        let rest = solution.initial;
        let sum = |value: &dyn Fn(&wellposed_analysis::plane_shocks::PlaneState) -> f64| {
            let pieces = profile.pieces.iter().filter(|own| own.range[1].is_finite());
            pieces.map(|own| (own.range[1] - own.range[0]) * value(&own.state)).sum::<f64>()
        };
        assert_close(sum(&|own| own.strain - rest.strain), piston.velocity * time, 1e-12);
        let impulse = (piston.pressure - rest.pressure) * time;
        assert_close(sum(&|own| density * own.velocity), impulse, 1e-12);
        let stored = sum(&|own| {
            0.5 * density * own.velocity * own.velocity + diagram.work(rest.strain, own.strain)
        });
        let lost: f64 =
            solution.waves.iter().map(|wave| wave.dissipation * wave.speed * time).sum();
        assert_close(stored + lost, piston.pressure * piston.velocity * time, 1e-12);
    }
}

#[test]
fn random_diagrams_have_admissible_conservative_solutions() {
    let mut random = RandomNumbers::new(11);
    let (mut shocks, mut fans) = (0, 0);
    for index in 0..3000 {
        let diagram = random_diagram(&mut random, 1 + index % 7);
        let top = diagram.corners().last().unwrap().pressure;
        let pressure = random.uniform(0.05, 1.6) * top.max(0.1);
        let load = match index % 2 {
            0 => PistonLoad::Pressure(pressure),
            _ => PistonLoad::Speed(random.uniform(0.05, 3.0)),
        };
        let solution = PistonSolution::new(&diagram, 1.3, 0.0, load).unwrap();
        match load {
            PistonLoad::Pressure(pressure) => assert_eq!(solution.piston.pressure, pressure),
            PistonLoad::Speed(speed) => assert_close(solution.piston.velocity, speed, 1e-13),
        }
        assert_is_solution(&diagram, &solution);
        shocks += solution.waves.iter().filter(|own| own.is_shock).count();
        fans += usize::from(solution.waves.len() > 2);
    }
    assert!(shocks > 1000 && fans > 300, "{shocks} {fans}");
}

#[test]
fn media_have_admissible_conservative_solutions() {
    for own in [aluminium_foam(0.001), aluminium_foam(0.01), aluminium_foam(0.05), strong_foam()] {
        let diagram = diagram(own);
        for pressure in [1e7, 1e8, 1.5e8, 9e8, 4e9] {
            let load = PistonLoad::Pressure(pressure);
            let solution = PistonSolution::new(&diagram, own.density, 0.0, load).unwrap();
            assert_is_solution(&diagram, &solution);
        }
    }
    let diagram = sand().loading_diagram();
    let solution = PistonSolution::new(&diagram, 1800.0, -0.02, PistonLoad::Speed(3.0)).unwrap();
    assert_is_solution(&diagram, &solution);
}

/// Energy balance ∫p dε = stored energy + plastic work along the diagram, with the stored energies of mean stress,
/// deviator and collapsed pores in closed form.
#[test]
fn plastic_work_is_the_work_that_is_not_stored() {
    let foam = aluminium_foam(0.01);
    let (limit, strain) = (FOAM_YIELD_STRESS, 0.013);
    let closed = strain - foam.porosity;
    let stored = 0.5 * foam.bulk_modulus * strain * strain
        + 0.5 * foam.contact_bulk_modulus * closed * closed
        + limit * limit / (2.0 * 0.75 * foam.shear_modulus);
    let own = diagram(foam);
    let found = plastic_work(&own, [strain, 0.0], 4.0 / 3.0 * limit);
    assert_close(found, own.work(0.0, strain) - stored, 1e-12);

    // Sand that yields on the cone, at a constant pressure, and then with closed contacts.
    let sand = *sand().parameters();
    let sand = GranularParameters { yield_stress: Some(5e6), ..sand };
    let own = GranularMedium::new(sand).unwrap().loading_diagram();
    assert!(
        own.segments().iter().any(|segment| segment.state.is_plastic() && segment.slope == 0.0)
    );
    let strain = 0.02;
    let stored =
        0.5 * sand.bulk_modulus * strain * strain + 25e12 / (2.0 * 0.75 * sand.shear_modulus);
    let found = plastic_work(&own, [-0.01, strain], 4.0 / 3.0 * 5e6);
    assert_close(found, own.work(0.0, strain) - stored, 1e-12);
}
