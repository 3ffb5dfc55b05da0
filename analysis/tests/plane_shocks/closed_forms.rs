//! Speeds of the waves in closed form, and their conditions of existence.

use super::media::{FOAM_YIELD_STRESS, aluminium_foam, assert_close, diagram, strong_foam};
use models::porous::PorousParameters;
use wellposed_analysis::plane_shocks::{
    PistonLoad, PistonSolution, Wave, WaveKind, find_solitary_threshold,
};

const TOLERANCE: f64 = 1e-13;

/// Closed forms of Sadovskii & Sadovskaya (2019) for the spherical contact and c² = 3/8.
struct ClosedForms {
    density: f64,
    skeleton: f64,
    bulk: f64,
    collapsed: f64,
    porosity: f64,
    yield_strain: f64,
    frozen: f64,
}

impl ClosedForms {
    fn new(own: &PorousParameters) -> Self {
        let limit = own.yield_stress.unwrap();
        Self {
            density: own.density,
            skeleton: own.bulk_modulus + 4.0 * own.shear_modulus / 3.0,
            bulk: own.bulk_modulus,
            collapsed: own.contact_bulk_modulus,
            porosity: own.porosity,
            yield_strain: limit / own.shear_modulus,
            frozen: 4.0 * limit / 3.0,
        }
    }

    fn speed(&self, modulus: f64) -> f64 {
        (modulus / self.density).sqrt()
    }

    fn plastic_pressure(&self) -> f64 {
        self.skeleton * self.yield_strain
    }

    fn compaction(&self, pressure: f64) -> f64 {
        let limit = self.plastic_pressure() + self.collapsed * (self.yield_strain - self.porosity);
        let p = pressure.min(limit);
        self.speed(self.skeleton + self.collapsed)
            * (p / (p + self.collapsed * self.porosity)).sqrt()
    }

    fn plastic_compaction(&self, pressure: f64) -> f64 {
        let rise = pressure - self.plastic_pressure();
        self.speed(self.bulk + self.collapsed)
            * (rise / (rise + self.collapsed * (self.porosity - self.yield_strain))).sqrt()
    }

    fn solitary(&self, pressure: f64) -> f64 {
        let offset = self.collapsed * self.porosity - self.frozen;
        self.speed(self.bulk + self.collapsed) * (pressure / (pressure + offset)).sqrt()
    }

    fn solitary_threshold(&self) -> f64 {
        let shear = self.skeleton - self.bulk;
        self.skeleton * (self.collapsed * self.porosity - self.frozen) / (self.collapsed - shear)
    }
}

fn waves(own: PorousParameters, pressure: f64) -> Vec<Wave> {
    let load = PistonLoad::Pressure(pressure);
    PistonSolution::new(&diagram(own), own.density, 0.0, load).unwrap().waves
}

fn kinds(waves: &[Wave]) -> Vec<WaveKind> {
    waves.iter().map(|own| own.kind).collect()
}

#[test]
fn low_porosity_has_a_compaction_shock_and_a_plastic_wave() {
    let own = aluminium_foam(0.001);
    let (exact, pressure) = (ClosedForms::new(&own), 5.0 * FOAM_YIELD_STRESS);
    let waves = waves(own, pressure);
    assert_eq!(kinds(&waves), [WaveKind::Compaction, WaveKind::Plastic]);
    assert_close(waves[0].speed, exact.compaction(pressure), TOLERANCE);
    assert_close(waves[1].speed, exact.speed(exact.bulk + exact.collapsed), TOLERANCE);
    // Below the plastic limit the shock is alone and slower.
    let weak = 0.9 * exact.plastic_pressure();
    let waves = self::waves(own, weak);
    assert_eq!(kinds(&waves), [WaveKind::Compaction]);
    assert_close(waves[0].speed, exact.compaction(weak), TOLERANCE);
    // With open pores the wave is the elastic one.
    let waves = self::waves(own, 0.5 * exact.skeleton * own.porosity);
    assert_eq!(kinds(&waves), [WaveKind::Elastic]);
    assert_close(waves[0].speed, exact.speed(exact.skeleton), TOLERANCE);
}

#[test]
fn high_porosity_has_a_precursor_and_a_plastic_wave_or_shock() {
    for (porosity, factor, collapses) in
        [(0.01, 25.0, true), (0.05, 75.0, false), (0.05, 125.0, true)]
    {
        let own = aluminium_foam(porosity);
        let (exact, pressure) = (ClosedForms::new(&own), factor * FOAM_YIELD_STRESS);
        let waves = waves(own, pressure);
        let second = if collapses { WaveKind::PlasticCompaction } else { WaveKind::Plastic };
        assert_eq!(kinds(&waves), [WaveKind::Elastic, second], "{porosity}");
        assert_close(waves[0].speed, exact.speed(exact.skeleton), TOLERANCE);
        let speed = match collapses {
            true => exact.plastic_compaction(pressure),
            false => exact.speed(exact.bulk),
        };
        // The jumps of the second wave are differences of nearly equal strains.
        assert_close(waves[1].speed, speed, 1e-12);
        assert_close(waves[0].behind.pressure, exact.plastic_pressure(), TOLERANCE);
    }
}

/// The solitary wave needs k_b > 4μ_a/3 and a pressure above the threshold; at the threshold the precursor has the
/// speed of the shock.
#[test]
fn solitary_wave_exists_in_the_strong_foam_above_its_threshold_and_never_in_aluminium() {
    let own = strong_foam();
    let exact = ClosedForms::new(&own);
    let threshold = exact.solitary_threshold();
    // 2.8/3 · (1.8 − 0.016/3) / (12 − 1/3) GPa.
    assert_close(threshold, 2.8e9 * 5.384 / 3.0 / 35.0, TOLERANCE);
    assert_close(find_solitary_threshold(&diagram(own)).unwrap(), threshold, TOLERANCE);
    let above = waves(own, 1.001 * threshold);
    assert_eq!(kinds(&above), [WaveKind::Solitary]);
    assert_close(above[0].speed, exact.solitary(1.001 * threshold), TOLERANCE);
    assert!(above[0].speed > exact.speed(exact.skeleton));
    let below = waves(own, 0.999 * threshold);
    assert_eq!(kinds(&below), [WaveKind::Elastic, WaveKind::PlasticCompaction]);
    assert_close(below[1].speed, exact.plastic_compaction(0.999 * threshold), 1e-12);
    assert_close(exact.solitary(threshold), exact.speed(exact.skeleton), 1e-12);
    for porosity in [0.01, 0.05, 0.3] {
        assert_eq!(find_solitary_threshold(&diagram(aluminium_foam(porosity))), None);
        let waves = waves(aluminium_foam(porosity), 1e14);
        assert!(waves.iter().all(|wave| wave.kind != WaveKind::Solitary));
    }
}

/// The speed of a piston determines the same waves as the pressure that it causes.
#[test]
fn piston_speed_and_pressure_determine_the_same_waves() {
    for (own, pressure) in [
        (aluminium_foam(0.001), 5.0 * FOAM_YIELD_STRESS),
        (aluminium_foam(0.05), 125.0 * FOAM_YIELD_STRESS),
        (strong_foam(), 1e8),
        (strong_foam(), 3e8),
    ] {
        let diagram = diagram(own);
        let solve = |load| PistonSolution::new(&diagram, own.density, 0.0, load).unwrap();
        let by_pressure = solve(PistonLoad::Pressure(pressure));
        let by_speed = solve(PistonLoad::Speed(by_pressure.piston.velocity));
        assert_close(by_speed.piston.pressure, pressure, 1e-11);
        assert_eq!(kinds(&by_speed.waves), kinds(&by_pressure.waves));
    }
}

#[test]
fn loads_out_of_range_are_refused() {
    let own = aluminium_foam(0.01);
    let diagram = diagram(own);
    let solve = |density, strain, load| PistonSolution::new(&diagram, density, strain, load);
    for load in [
        PistonLoad::Pressure(0.0),
        PistonLoad::Pressure(-1.0),
        PistonLoad::Pressure(f64::NAN),
        PistonLoad::Speed(0.0),
        PistonLoad::Speed(f64::INFINITY),
    ] {
        assert!(solve(2673.0, 0.0, load).is_err(), "{load:?}");
    }
    assert!(solve(0.0, 0.0, PistonLoad::Pressure(1e6)).is_err());
    assert!(solve(2673.0, f64::NAN, PistonLoad::Pressure(1e6)).is_err());
    // A medium that is already compressed more.
    assert!(solve(2673.0, 0.01, PistonLoad::Pressure(1e6)).is_err());
}
