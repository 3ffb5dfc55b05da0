//! Release waves and overtaking.

use super::media::{FOAM_YIELD_STRESS, aluminium_foam, assert_close};
use super::scheme::Scheme;
use models::porous::{PorousMedium, PorousParameters};
use wellposed_analysis::plane_shocks::{PistonLoad, PistonSolution, Release};

/// Elastic foam with θ₀ = 0.1 %, in which pores collapse.
fn elastic_foam() -> PorousParameters {
    PorousParameters { yield_stress: None, ..aluminium_foam(0.001) }
}

fn solve(own: PorousParameters, pressure: f64, duration: f64) -> (PistonSolution, Release) {
    let medium = PorousMedium::new(own).unwrap();
    let load = PistonLoad::Pressure(pressure);
    let loading = PistonSolution::new(&medium.loading_diagram(), own.density, 0.0, load).unwrap();
    let unloading = medium.unloading_diagram(loading.piston.strain);
    let release = Release::new(&loading, &unloading, duration).unwrap();
    (loading, release)
}

/// In an elastic skeleton: two waves, √(E₁/ρ) down to p_θ = E₀θ₀ and √(E₀/ρ) to 0; overtaking at
/// t₀c_pc_θ/(c_p − c_θ); the pressure after it is the greater root of p/(ρD(p)) = v_l − (p − p_θ)/(ρc_p).
#[test]
fn elastic_release_is_a_fan_of_two_and_overtakes_the_shock() {
    let own = elastic_foam();
    let (pressure, duration) = (5.0 * FOAM_YIELD_STRESS, 1e-5);
    let (loading, release) = solve(own, pressure, duration);
    let open = own.bulk_modulus + 4.0 / 3.0 * own.shear_modulus;
    let closed = open + own.contact_bulk_modulus;
    let rho = own.density;
    let [c1, c0] = [(closed / rho).sqrt(), (open / rho).sqrt()];
    let speeds: Vec<f64> = release.waves.iter().map(|own| own.speed).collect();
    assert_eq!(speeds.len(), 2);
    assert_close(speeds[0], c1, 1e-12);
    assert_close(speeds[1], c0, 1e-12);
    let collapse = open * own.porosity;
    assert_close(release.waves[0].behind.pressure, collapse, 1e-13);
    assert!(release.piston.pressure == 0.0 && release.piston.strain.abs() < 1e-17);
    let offset = own.contact_bulk_modulus * own.porosity;
    let shock = |p: f64| (closed * p / (rho * (p + offset))).sqrt();
    let d = shock(pressure);
    let overtaking = release.overtaking.unwrap();
    assert_close(overtaking.position, duration * c1 * d / (c1 - d), 1e-11);
    let left = pressure / (rho * d) - (pressure - collapse) / (rho * c1);
    let residual = |p: f64| p / (rho * shock(p)) - left + (p - collapse) / (rho * c1);
    let (mut low, mut high) = (collapse, pressure);
    assert!(residual(low) < 0.0 && residual(high) > 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if residual(middle) > 0.0 { high = middle } else { low = middle }
    }
    assert_close(overtaking.pressure.unwrap(), high, 1e-11);
    assert_eq!(loading.waves.len(), 1);
}

/// The elastic medium is reversible, so that the scheme can follow the pulse beyond the overtaking.
#[test]
fn pressure_after_overtaking_agrees_with_the_scheme() {
    // A porosity with a great difference of both speeds shortens the way to the overtaking.
    let own = PorousParameters { contact_bulk_modulus: 200e9, ..elastic_foam() };
    let (pressure, duration) = (3e8, 1e-5);
    let (_, release) = solve(own, pressure, duration);
    let overtaking = release.overtaking.unwrap();
    let expected = overtaking.pressure.unwrap();
    let diagram = PorousMedium::new(own).unwrap().loading_diagram();
    let error = |cells: f64| {
        let length = 1.5 * overtaking.position;
        let mut scheme =
            Scheme::new(&diagram, own.density, 0.0, [overtaking.position / cells, length]);
        scheme.advance(duration, PistonLoad::Pressure(pressure));
        scheme.advance(1.1 * overtaking.time - duration, PistonLoad::Pressure(0.0));
        // The state between the shock and the wave that runs back from the overtaking.
        (diagram.pressure(scheme.strain[cells as usize]) / expected - 1.0).abs()
    };
    let [coarse, fine] = [error(1000.0), error(4000.0)];
    assert!(fine < 0.6 * coarse && fine < 0.01, "{coarse:e} {fine:e}");
}

/// After the release of an elastic-plastic foam a strain remains, and mass, momentum and energy balance: the energy of
/// the collapsed state is returned along the unloading diagram, front losses and plastic work remain.
#[test]
fn plastic_release_conserves_mass_and_momentum_and_balances_energy() {
    let own = aluminium_foam(0.01);
    let (pressure, duration) = (25.0 * FOAM_YIELD_STRESS, 2e-5);
    let (loading, release) = solve(own, pressure, duration);
    let medium = PorousMedium::new(own).unwrap();
    let (up, down) = (medium.loading_diagram(), medium.unloading_diagram(loading.piston.strain));
    assert!(release.piston.strain > 1e-4);
    let time = 0.5 * (duration + release.overtaking.unwrap().time);
    let profile = loading.profile_with_release(&release, time).unwrap();
    assert!(loading.profile_with_release(&release, 2.0 * time).is_none());
    let released = release.piston.velocity * (time - duration);
    let work = pressure * loading.piston.velocity * duration;
    let peak = loading.piston.strain;
    let [mut length, mut momentum, mut energy] = [0.0; 3];
    let first_release = release.waves[0].speed * (time - duration);
    for piece in profile.pieces.iter().filter(|own| own.range[1].is_finite()) {
        let width = piece.range[1] - piece.range[0];
        length += width * piece.state.strain;
        momentum += width * own.density * piece.state.velocity;
        let density = match piece.range[1] <= first_release {
            true => up.work(0.0, peak) - down.work(piece.state.strain, peak),
            false => up.work(0.0, piece.state.strain),
        };
        energy += width * (0.5 * own.density * piece.state.velocity.powi(2) + density);
    }
    energy += loading.waves.iter().map(|own| own.dissipation * own.speed * time).sum::<f64>();
    let since = time - duration;
    energy += release.waves.iter().map(|own| own.dissipation * own.speed * since).sum::<f64>();
    assert_close(length, loading.piston.velocity * duration + released, 1e-12);
    assert_close(momentum, pressure * duration, 1e-12);
    assert_close(energy, work, 1e-12);
}

#[test]
fn release_needs_a_positive_duration() {
    let own = elastic_foam();
    let medium = PorousMedium::new(own).unwrap();
    let diagram = medium.loading_diagram();
    let loading =
        PistonSolution::new(&diagram, own.density, 0.0, PistonLoad::Pressure(1e8)).unwrap();
    for duration in [0.0, -1.0, f64::NAN] {
        assert!(Release::new(&loading, &diagram, duration).is_err());
    }
}
