//! Verifies the exact solutions of `tests/reference` independently: equations of motion and free surfaces by finite
//! differences, momentum and energy balances, reciprocity, closed forms.

use crate::reference;

use reference::interface::{self, BodyWave};
use reference::oblique::LOWER_SOLID;
use reference::{
    IsotropicSolid, REFERENCE_SOLID, RICKER, full_plane, half_plane, half_space, lamb,
};
use std::f64::consts::PI;

/// Displacement (m) in the plane at a point (m) and a time (s).
type DisplacementField<'a> = &'a dyn Fn([f64; 2], f64) -> [f64; 2];

fn first_values(values: [Vec<f64>; 2]) -> [f64; 2] {
    values.map(|values| values[0])
}

/// Returns ∫₀ᵗ of the Ricker function, s: (t − delay) e^(−a), a = (π frequency (t − delay))², up to an error of e⁻²².
fn integrate_ricker(t: f64) -> f64 {
    let since = t - 1.5 / RICKER.frequency;
    since * (-(PI * RICKER.frequency * since).powi(2)).exp()
}

#[test]
fn ricker_derivatives_agree_with_finite_differences() {
    let step = 1e-6;
    for n in 0..3 {
        for t in [0.05, 0.07, 0.083, 0.11] {
            let [after, before] = [t + step, t - step].map(|t| RICKER.derivative_at(t, n));
            let exact = RICKER.derivative_at(t, n + 1);
            let error = ((after - before) / (2.0 * step) - exact).abs();
            assert!(error < 1e-6 * (PI * RICKER.frequency).powi(n as i32 + 1), "{n} {t}");
        }
    }
}

#[test]
fn rayleigh_speed_at_poisson_ratio_one_quarter_is_exact() {
    let ratio = REFERENCE_SOLID.rayleigh_speed() / REFERENCE_SOLID.shear_speed();
    assert!((ratio - 0.919402).abs() < 1e-6, "{ratio}");
}

/// Verifies that the weights of the default kernel have the moments 0 to 2 of a point.
#[test]
fn default_kernel_has_moments_of_a_point() {
    for (power, exact) in [(0, 1.0), (1, 0.0), (2, 0.0)] {
        let found: f64 = lamb::default_kernel().map(|(u, share)| share * u.powi(power)).sum();
        assert!((found - exact).abs() < 1e-14, "{found} of power {power}");
    }
}

/// Checks the equation of motion ρü = (λ + μ)∇∇·u + μΔu by central differences.
fn assert_equation_of_motion(u: DisplacementField, [x, z]: [f64; 2], t: f64) {
    let (h, dt) = (0.02, 2e-4);
    let at = |i: f64, j: f64| u([x + i * h, z + j * h], t);
    let c = at(0.0, 0.0);
    let [e, w, s, n] = [at(1., 0.), at(-1., 0.), at(0., 1.), at(0., -1.)];
    let [es, wn, en, ws] = [at(1., 1.), at(-1., -1.), at(1., -1.), at(-1., 1.)];
    let [after, before] = [t + dt, t - dt].map(|t| u([x, z], t));
    for k in 0..2 {
        let second = |a: [f64; 2], b: [f64; 2]| (a[k] - 2.0 * c[k] + b[k]) / (h * h);
        let along = [second(e, w), second(s, n)];
        let mixed = (es[1 - k] + wn[1 - k] - en[1 - k] - ws[1 - k]) / (4.0 * h * h);
        let elastic = REFERENCE_SOLID.mu * (along[0] + along[1])
            + (REFERENCE_SOLID.lambda + REFERENCE_SOLID.mu) * (along[k] + mixed);
        let inertia = REFERENCE_SOLID.density * (after[k] - 2.0 * c[k] + before[k]) / (dt * dt);
        let size = REFERENCE_SOLID.mu * (along[0].abs() + along[1].abs()) + inertia.abs();
        assert!((elastic - inertia).abs() < 1e-3 * size, "{k}: {elastic} {inertia} of {size}");
    }
}

/// Checks that the surface z = 0 is traction-free, σ_xz = σ_zz = 0, by one-sided differences.
fn assert_traction_free_surface(u: DisplacementField, x: f64, t: f64) {
    let h = 0.02;
    let at = |i: f64, j: f64| u([x + i * h, j * h], t);
    let [e, w, c, one, two] = [at(1., 0.), at(-1., 0.), at(0., 0.), at(0., 1.), at(0., 2.)];
    let dx = [0, 1].map(|k| (e[k] - w[k]) / (2.0 * h));
    let dz = [0, 1].map(|k| (4.0 * one[k] - 3.0 * c[k] - two[k]) / (2.0 * h));
    let IsotropicSolid { lambda, mu, .. } = REFERENCE_SOLID;
    let stress = [mu * (dz[0] + dx[1]), lambda * dx[0] + (lambda + 2.0 * mu) * dz[1]];
    let size = mu * dx.iter().chain(&dz).map(|d| d.abs()).sum::<f64>();
    assert!(stress.iter().all(|s| s.abs() < 1e-3 * size), "{stress:?} of {size}");
}

#[test]
fn plane_fields_satisfy_equations_and_free_surface() {
    for t in [0.1, 0.14, 0.17] {
        for force in [[1e5, 0.0], [0.0, 1e5]] {
            let on_surface = |at: [f64; 2], t: f64| {
                first_values(half_plane::lamb_motion(&REFERENCE_SOLID, force, at, &[t], RICKER, 0))
            };
            assert_equation_of_motion(&on_surface, [12.0, 4.0], t);
            assert_traction_free_surface(&on_surface, 12.0, t);
            let inside = |at: [f64; 2], t: f64| {
                first_values(full_plane::force_motion(&REFERENCE_SOLID, force, at, &[t], RICKER, 0))
            };
            assert_equation_of_motion(&inside, [9.0, -7.0], t);
        }
        let garvin = |at: [f64; 2], t: f64| {
            first_values(half_plane::garvin_motion(&REFERENCE_SOLID, 1e5, 5.0, at, &[t], RICKER, 0))
        };
        assert_equation_of_motion(&garvin, [12.0, 4.0], t);
        assert_equation_of_motion(&garvin, [3.0, 11.0], t);
        assert_traction_free_surface(&garvin, 12.0, t);
        let explosion = |at: [f64; 2], t: f64| {
            first_values(full_plane::explosion_motion(&REFERENCE_SOLID, 1e5, at, &[t], RICKER, 0))
        };
        assert_equation_of_motion(&explosion, [9.0, -7.0], t);
    }
}

/// Verifies that momentum equals the impulse of the force, in the half-plane and in the plane, and that ∫ ρ x·v over
/// the plane equals the impulse of an isotropic moment, 2M ∫ f dt.
#[test]
fn plane_fields_have_impulse_of_source() {
    let t = 1.55 / RICKER.frequency;
    let h = 0.4;
    let sum = |value: &dyn Fn([f64; 2]) -> f64| {
        let places = (0..70).flat_map(|i| (0..70).map(move |j| [i, j]));
        let centres = places.map(|place| place.map(|i| (f64::from(i) + 0.5) * h));
        centres.map(|at| h * h * REFERENCE_SOLID.density * value(at)).sum::<f64>()
            / integrate_ricker(t)
    };
    for k in 0..2 {
        let force = if k == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
        let half = 2.0
            * sum(&|at| {
                half_plane::lamb_motion(&REFERENCE_SOLID, force, at, &[t], RICKER, 1)[k][0]
            });
        assert!((half - 1.0).abs() < 0.02, "{half}");
        let whole = 4.0
            * sum(&|at| {
                full_plane::force_motion(&REFERENCE_SOLID, force, at, &[t], RICKER, 1)[k][0]
            });
        assert!((whole - 1.0).abs() < 0.02, "{whole}");
    }
    let moment = 4.0
        * sum(&|at| {
            let v = first_values(full_plane::explosion_motion(
                &REFERENCE_SOLID,
                1.0,
                at,
                &[t],
                RICKER,
                1,
            ));
            at[0] * v[0] + at[1] * v[1]
        });
    assert!((moment - 2.0).abs() < 0.04, "{moment}");
}

/// Verifies reciprocity, for Garvin's problem against Lamb's problem and for the line sources in the unbounded plane: a
/// displacement component at a point due to an explosion equals the divergence, at the position of the explosion, of
/// the displacement due to a force at that point along that component.
#[test]
fn explosions_and_forces_are_reciprocal() {
    let (h, depth) = (0.01, 5.0);
    for t in [0.08, 0.11, 0.15, 0.19] {
        for (k, force) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            for x in [4.0, 12.0] {
                // Divergence, and the sum of the magnitudes of its terms.
                let divergence = |u: DisplacementField, [x, z]: [f64; 2]| {
                    let along = (u([x + h, z], t)[0] - u([x - h, z], t)[0]) / (2.0 * h);
                    let across = (u([x, z + h], t)[1] - u([x, z - h], t)[1]) / (2.0 * h);
                    [along + across, along.abs() + across.abs()]
                };
                // The force is at the origin, the explosion at −x: the reflection x → −x reverses the sign of the force
                // along x.
                let mirror = [-1.0, 1.0][k];
                let on_surface = |at: [f64; 2], t: f64| {
                    first_values(half_plane::lamb_motion(
                        &REFERENCE_SOLID,
                        force,
                        at,
                        &[t],
                        RICKER,
                        0,
                    ))
                };
                let [expected, size] = divergence(&on_surface, [x, depth]);
                let expected = mirror * expected;
                let garvin = half_plane::garvin_motion(
                    &REFERENCE_SOLID,
                    1.0,
                    depth,
                    [x, 0.0],
                    &[t],
                    RICKER,
                    0,
                )[k][0];
                assert!((garvin - expected).abs() < 1e-4 * size, "{garvin} {expected}");
                let inside = |at: [f64; 2], t: f64| {
                    first_values(full_plane::force_motion(
                        &REFERENCE_SOLID,
                        force,
                        at,
                        &[t],
                        RICKER,
                        0,
                    ))
                };
                let [expected, size] = divergence(&inside, [-x, depth]);
                let found = full_plane::explosion_motion(
                    &REFERENCE_SOLID,
                    1.0,
                    [x, -depth],
                    &[t],
                    RICKER,
                    0,
                )[k][0];
                assert!((found - expected).abs() < 1e-4 * size, "{found} {expected}");
            }
        }
    }
}

const INTERVAL_COUNTS: [usize; 2] = [80, 400];

/// Returns the displacement, m, at (x, y, depth z) in three dimensions, due to a unit vertical force.
fn point_force_displacement([x, y, z]: [f64; 3], t: f64, interval_counts: [usize; 2]) -> [f64; 3] {
    let r = x.hypot(y);
    let field = half_space::point_force_motion(
        &REFERENCE_SOLID,
        1.0,
        [r, z],
        &[t],
        (RICKER, 0),
        interval_counts,
    );
    let [radial, down] = first_values(field);
    [radial * x / r, radial * y / r, down]
}

#[test]
fn half_space_field_satisfies_equations_and_free_surface() {
    let (h, dt) = (0.02, 2e-4);
    for t in [0.1, 0.14, 0.17] {
        let at = |by: [f64; 3], t: f64| {
            let start = [8.0, 5.0, 4.0];
            point_force_displacement(
                std::array::from_fn(|i| start[i] + h * by[i]),
                t,
                INTERVAL_COUNTS,
            )
        };
        let unit = |axis: usize, by: f64| std::array::from_fn(|i| if i == axis { by } else { 0.0 });
        let c = at([0.0; 3], t);
        let [after, before] = [t + dt, t - dt].map(|t| at([0.0; 3], t));
        for k in 0..3 {
            let second = |axis: usize| {
                let [up, down] = [1.0, -1.0].map(|by| at(unit(axis, by), t)[k]);
                (up - 2.0 * c[k] + down) / (h * h)
            };
            let mut gradient = second(k);
            for axis in (0..3).filter(|axis| *axis != k) {
                let corner = |a: f64, b: f64| {
                    let mut by = unit(axis, a);
                    by[k] = b;
                    at(by, t)[axis]
                };
                let sum = corner(1., 1.) + corner(-1., -1.) - corner(1., -1.) - corner(-1., 1.);
                gradient += sum / (4.0 * h * h);
            }
            let along = [0, 1, 2].map(second);
            let elastic = REFERENCE_SOLID.mu * along.iter().sum::<f64>()
                + (REFERENCE_SOLID.lambda + REFERENCE_SOLID.mu) * gradient;
            let inertia = REFERENCE_SOLID.density * (after[k] - 2.0 * c[k] + before[k]) / (dt * dt);
            let size =
                REFERENCE_SOLID.mu * along.iter().map(|d| d.abs()).sum::<f64>() + inertia.abs();
            assert!((elastic - inertia).abs() < 2e-3 * size, "{k}: {elastic} {inertia} of {size}");
        }
        // At y = 0 the radius r is x, and ∇·u contains the term u_r/r in addition.
        let u = |x: f64, z: f64| point_force_displacement([x, 0.0, z], t, INTERVAL_COUNTS);
        let x = 9.0;
        let [e, w, c] = [u(x + h, 0.0), u(x - h, 0.0), u(x, 0.0)];
        let [one, two] = [u(x, h), u(x, 2.0 * h)];
        let dx = [0, 2].map(|k| (e[k] - w[k]) / (2.0 * h));
        let dz = [0, 2].map(|k| (4.0 * one[k] - 3.0 * c[k] - two[k]) / (2.0 * h));
        let normal = REFERENCE_SOLID.lambda * (dx[0] + c[0] / x)
            + (REFERENCE_SOLID.lambda + 2.0 * REFERENCE_SOLID.mu) * dz[1];
        let stress = [REFERENCE_SOLID.mu * (dz[0] + dx[1]), normal];
        let size = REFERENCE_SOLID.mu * dx.iter().chain(&dz).map(|d| d.abs()).sum::<f64>();
        assert!(stress.iter().all(|s| s.abs() < 2e-3 * size), "{stress:?} of {size}");
    }
}

/// Verifies the vertical displacement on the surface against Pekeris (1955), whose last branch is the static value
/// 3F/8πμr, and the convergence of the quadrature, also below the surface.
#[test]
fn half_space_surface_field_agrees_with_pekeris() {
    let max_displacement = 1.0 / (REFERENCE_SOLID.mu * 9.0);
    for r in [9.0, 27.0] {
        for step in 0..12 {
            let t = 0.07 + 0.012 * f64::from(step) + r / 400.0;
            let exact = half_space::pekeris_displacement(&REFERENCE_SOLID, 1.0, r, t, RICKER);
            let found = point_force_displacement([r, 0.0, 0.0], t, INTERVAL_COUNTS)[2];
            assert!(
                (found - exact).abs() < 1e-4 * max_displacement * 9.0 / r,
                "{r} {t}: {found} {exact}"
            );
        }
        for t in [0.1, 0.15, 0.21] {
            for z in [0.0, 5.0] {
                let [coarse, fine] = [INTERVAL_COUNTS, [160, 900]].map(|interval_counts| {
                    point_force_displacement([r, 0.0, z], t, interval_counts)
                });
                for (coarse, fine) in coarse.iter().zip(fine) {
                    assert!((coarse - fine).abs() < 1e-6 * max_displacement, "{r} {z} {t}");
                }
            }
        }
    }
}

/// Verifies that the momentum of the half-space equals the impulse of the force.
#[test]
fn half_space_field_has_impulse_of_force() {
    let t = 1.55 / RICKER.frequency;
    let h = 0.4;
    let mut momentum = 0.0;
    for i in 0..70 {
        for j in 0..70 {
            let [r, z] = [i, j].map(|i| (f64::from(i) + 0.5) * h);
            let field = half_space::point_force_motion(
                &REFERENCE_SOLID,
                1.0,
                [r, z],
                &[t],
                (RICKER, 1),
                [40, 150],
            );
            momentum += 2.0 * PI * r * h * h * REFERENCE_SOLID.density * field[1][0];
        }
    }
    let ratio = momentum / integrate_ricker(t);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

/// Verifies that energy flux, velocities and tractions are continuous at the interface; amplitudes at normal
/// incidence against impedances; the free-surface limit for a nearly void lower solid; and that there is no solution
/// beyond a critical angle.
#[test]
fn interface_waves_are_continuous_and_conserve_energy() {
    for (incident, critical) in [(BodyWave::P, 43.8f64), (BodyWave::S, 23.5)] {
        for degrees in [0.0, 7.0, 15.0, 22.0] {
            let waves = interface::solve_interface_waves(
                &REFERENCE_SOLID,
                &LOWER_SOLID,
                incident,
                f64::to_radians(degrees),
            )
            .expect("a subcritical angle");
            let above: f64 = waves.above.iter().map(|wave| wave.energy_flux()).sum();
            let below: f64 = waves.below.iter().map(|wave| wave.energy_flux()).sum();
            assert!((above - below).abs() < 1e-12 * below.abs(), "{degrees}: {above} {below}");
            for i in 0..4 {
                let above: f64 =
                    waves.above.iter().map(|wave| wave.continuous_quantities()[i]).sum();
                let below: f64 =
                    waves.below.iter().map(|wave| wave.continuous_quantities()[i]).sum();
                assert!((above - below).abs() < 1e-12 * above.abs().max(1e-3), "{degrees}: {i}");
            }
        }
        let beyond = |degrees: f64| {
            interface::solve_interface_waves(
                &REFERENCE_SOLID,
                &LOWER_SOLID,
                incident,
                degrees.to_radians(),
            )
            .is_none()
        };
        assert!(!beyond(critical - 0.1) && beyond(critical + 0.1));
    }
    let waves = interface::solve_interface_waves(&REFERENCE_SOLID, &LOWER_SOLID, BodyWave::P, 0.0)
        .expect("a subcritical angle");
    let [one, other] =
        [&REFERENCE_SOLID, &LOWER_SOLID].map(|solid| solid.density * solid.pressure_speed());
    // A reflected P wave of positive amplitude has a velocity opposite to the incident wave.
    let found = [waves.above[1].amplitude, waves.above[2].amplitude, waves.below[0].amplitude];
    let expected = [(other - one) / (one + other), 0.0, 2.0 * one / (one + other)];
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }
    let nothing = IsotropicSolid { lambda: 1e-3, mu: 1e-3, density: 1e-8 };
    let angle = f64::to_radians(20.0);
    let waves = interface::solve_interface_waves(&REFERENCE_SOLID, &nothing, BodyWave::P, angle)
        .expect("a subcritical angle");
    let [slow_p, slow_s] =
        [REFERENCE_SOLID.pressure_speed(), REFERENCE_SOLID.shear_speed()].map(|c| 1.0 / c);
    let p = angle.sin() * slow_p;
    let [a, b] = [slow_p, slow_s].map(|slow| (slow * slow - p * p).sqrt());
    let (g, product) = (slow_s * slow_s - 2.0 * p * p, 4.0 * p * p * a * b);
    let expected = (product - g * g) / (product + g * g);
    let found = waves.above[1].amplitude;
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
}

/// Verifies that velocity and traction rate (by differences) of an oblique pulse are continuous at the interface.
#[test]
fn oblique_pulse_is_continuous_at_interface() {
    for incident in [BodyWave::P, BodyWave::S] {
        let waves = interface::solve_interface_waves(&REFERENCE_SOLID, &LOWER_SOLID, incident, 0.2)
            .expect("a subcritical angle");
        let g = |t: f64| RICKER.derivative_at(t, 0);
        let velocity = |planes: &[interface::InterfaceWave], x: [f64; 2], t: f64| {
            planes.iter().fold([0.0; 2], |sum, wave| {
                let v = wave.velocity(x, t, g);
                [sum[0] + v[0], sum[1] + v[1]]
            })
        };
        // Rate of the traction, by differences of velocities.
        let rate = |planes: &[interface::InterfaceWave], solid: &IsotropicSolid, x: f64, t: f64| {
            let h = 1e-3;
            let at = |dx: f64, dy: f64| velocity(planes, [x + dx, dy], t);
            let dx = [0, 1].map(|k| (at(h, 0.0)[k] - at(-h, 0.0)[k]) / (2.0 * h));
            let dy = [0, 1].map(|k| (at(0.0, h)[k] - at(0.0, -h)[k]) / (2.0 * h));
            let normal = solid.lambda * dx[0] + (solid.lambda + 2.0 * solid.mu) * dy[1];
            [solid.mu * (dy[0] + dx[1]), normal]
        };
        for (x, t) in [(0.0, 0.07), (3.0, 0.08), (-5.0, 0.075)] {
            let [above, below] =
                [&waves.above[..], &waves.below[..]].map(|planes| velocity(planes, [x, 0.0], t));
            let size = above[0].abs() + above[1].abs();
            assert!(above.iter().zip(below).all(|(a, b)| (a - b).abs() < 1e-12 * size));
            let above = rate(&waves.above, &REFERENCE_SOLID, x, t);
            let below = rate(&waves.below, &LOWER_SOLID, x, t);
            let size = above[0].abs() + above[1].abs();
            assert!(above.iter().zip(below).all(|(a, b)| (a - b).abs() < 1e-6 * size), "{above:?}");
        }
    }
}
