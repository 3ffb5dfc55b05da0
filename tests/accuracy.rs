//! Exact solutions against what is independent of them, and runs with defaults against exact solutions.

#[path = "reference/lamb.rs"]
mod lamb;
#[path = "reference/mod.rs"]
mod reference;

use lamb::{HALF_PLANE, Place, RICKER};
use std::path::Path;

/// Displacement at a point and a time, s.
fn displacement(force: [f64; 2], at: [f64; 2], t: f64) -> [f64; 2] {
    HALF_PLANE.lamb(force, at, &[t], RICKER, 0).map(|values| values[0])
}

#[test]
fn the_rayleigh_speed_at_a_quarter() {
    let ratio = HALF_PLANE.rayleigh_speed() / HALF_PLANE.shear_speed();
    assert!((ratio - 0.919402).abs() < 1e-6, "{ratio}");
}

/// λ tr ε + 2μ ε and the balance of momentum, by central differences of displacements.
#[test]
fn lamb_obeys_the_equations_inside_and_is_free_at_the_surface() {
    let [lambda, mu] = [HALF_PLANE.lambda, HALF_PLANE.mu];
    for force in [[1e5, 0.0], [0.0, 1e5]] {
        for t in [0.1, 0.14, 0.17] {
            let (x, z, h, dt) = (12.0, 4.0, 0.02, 2e-4);
            let u = |i: f64, j: f64| displacement(force, [x + i * h, z + j * h], t);
            let c = u(0.0, 0.0);
            let [e, w, s, n] = [u(1., 0.), u(-1., 0.), u(0., 1.), u(0., -1.)];
            let [es, wn, en, ws] = [u(1., 1.), u(-1., -1.), u(1., -1.), u(-1., 1.)];
            let [after, before] = [t + dt, t - dt].map(|t| displacement(force, [x, z], t));
            for k in 0..2 {
                let second = |a: [f64; 2], b: [f64; 2]| (a[k] - 2.0 * c[k] + b[k]) / (h * h);
                let along = [second(e, w), second(s, n)];
                let mixed = 1.0 / (4.0 * h * h);
                let mixed = mixed * (es[1 - k] + wn[1 - k] - en[1 - k] - ws[1 - k]);
                let elastic = mu * (along[0] + along[1]) + (lambda + mu) * (along[k] + mixed);
                let inertia = HALF_PLANE.density * (after[k] - 2.0 * c[k] + before[k]) / (dt * dt);
                let size = mu * (along[0].abs() + along[1].abs()) + inertia.abs();
                assert!((elastic - inertia).abs() < 1e-3 * size, "{k}: {elastic} {inertia}");
            }
            let at = |i: f64, j: f64| displacement(force, [x + i * h, j * h], t);
            let [e, w, c, one, two] = [at(1., 0.), at(-1., 0.), at(0., 0.), at(0., 1.), at(0., 2.)];
            let dx = [0, 1].map(|k| (e[k] - w[k]) / (2.0 * h));
            let dz = [0, 1].map(|k| (4.0 * one[k] - 3.0 * c[k] - two[k]) / (2.0 * h));
            let stress = [mu * (dz[0] + dx[1]), lambda * dx[0] + (lambda + 2.0 * mu) * dz[1]];
            let size = mu * dx.iter().chain(&dz).map(|d| d.abs()).sum::<f64>();
            assert!(stress.iter().all(|s| s.abs() < 1e-3 * size), "{stress:?} of {size}");
        }
    }
}

/// The momentum of the half-plane is the impulse of the force.
#[test]
fn lamb_has_the_impulse_of_the_force() {
    let t = 1.55 / RICKER.frequency; // where the integral of the Ricker function is (t − delay) e⁻ᵃ
    let since = t - 1.5 / RICKER.frequency;
    let a = (std::f64::consts::PI * RICKER.frequency * since).powi(2);
    let impulse = 1e5 * since * (-a).exp();
    let h = 0.4;
    for k in 0..2 {
        let force = if k == 0 { [1e5, 0.0] } else { [0.0, 1e5] };
        let mut momentum = 0.0;
        for i in 0..70 {
            for j in 0..70 {
                let at = [(f64::from(i) + 0.5) * h, (f64::from(j) + 0.5) * h];
                momentum += 2.0
                    * h
                    * h
                    * HALF_PLANE.density
                    * HALF_PLANE.lamb(force, at, &[t], RICKER, 1)[k][0];
            }
        }
        let error = momentum / impulse - 1.0;
        assert!(error.abs() < 0.02, "{momentum} and {impulse}");
    }
}

/// No more than a bound on gross faults: along the surface, three wavelengths away, a fifth of the record is missed.
#[test]
fn lamb_at_twenty_cells_to_the_wavelength() {
    let program = Path::new(env!("CARGO_BIN_EXE_wellposed"));
    for is_vertical in [true, false] {
        for (name, error) in lamb::errors(program, is_vertical, 20.0, Place::Point, &[]) {
            println!("{is_vertical} {name}: {error:?}");
            assert!(error.l2 < 0.3, "{name}: {error:?}");
        }
    }
}
