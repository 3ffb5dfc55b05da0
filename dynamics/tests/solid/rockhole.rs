//! Waves from a cylindrical cavity in a polar block: elastic, plastic, granular and porous media under a pressure on the
//! wall of the cavity.

use crate::contacts::{granular, porous};
use crate::support::media::classical;
use crate::support::noise;
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use models::yield_set::parameters::Mises;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Load, Signal};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::solid::metric::Metric;

/// Radius a of the cavity and outer radius of the block, m.
const CAVITY_RADIUS: f64 = 0.1;
const OUTER_RADIUS: f64 = 1.0;

/// An annulus around a cavity with a pressure on its wall.
struct Cavity {
    problem: Problem<2>,
    /// Radii of the layers, m.
    radii: Vec<f64>,
}

impl Cavity {
    /// Creates an annulus with free boundaries; the pressure, Pa, is the product of its functions of the face and of
    /// the time. `courant`: Courant number of sweeps of half a step.
    fn new(
        medium: Medium,
        cells: [usize; 2],
        courant: f64,
        pressure_of_face: impl Fn(usize) -> f64,
        signal: Signal,
    ) -> Self {
        let width = (OUTER_RADIUS - CAVITY_RADIUS) / cells[1] as f64;
        let spacing = [TAU / cells[0] as f64, width];
        let metric = Metric::new_polar(CAVITY_RADIUS, cells[1], spacing);
        let least = metric.spacing[0].min(width);
        let step = 2.0 * courant * least / medium.max_speed();
        let periodic = [Boundary::Periodic, Boundary::Periodic];
        let boundaries = [periodic, [Boundary::Free, Boundary::Free]];
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let grid = Grid { cells, spacing };
        let mut problem =
            Problem::new(grid, vec![medium], vec![0; grid.count()], boundaries, step, scheme);
        problem.metric = Some(metric);
        let pair = find_longitudinal(&problem);
        // Fields are √r times the physical ones, and so are tractions.
        let traction = |face| (face, -CAVITY_RADIUS.sqrt() * pressure_of_face(face));
        let faces = (0..cells[0]).map(traction).collect();
        problem.loads.push(Load { axis: 1, end: 0, pair, faces, signal });
        let radii = (0..cells[1]).map(|layer| CAVITY_RADIUS + (layer as f64 + 0.5) * width);
        Self { radii: radii.collect(), problem }
    }

    /// Creates an annulus under a uniform pressure that acts from t = 0.
    fn with_step_pressure(medium: Medium, cells: [usize; 2], courant: f64, pressure: f64) -> Self {
        Self::new(medium, cells, courant, |_| pressure, Arc::new(|_| 1.0))
    }

    /// Returns the physical values of a field in a column of cells, by layer.
    fn column(&self, domain: &Domain<f64, 2>, field: SolidField, column: usize) -> Vec<f64> {
        let (values, width) = (domain.values(field).expect("a field"), self.problem.grid.cells[0]);
        let value = |(layer, radius): (usize, &f64)| values[layer * width + column] / radius.sqrt();
        self.radii.iter().enumerate().map(value).collect()
    }
}

/// Returns the index of the longitudinal pair of waves along the radius.
fn find_longitudinal(problem: &Problem<2>) -> usize {
    let mut pairs = problem.media[0].pairs[1].iter();
    pairs.position(|pair| pair.is_longitudinal()).expect("a longitudinal pair")
}

/// Computes e^z K₀(z) and e^z K₁(z) of the modified Bessel functions for |arg z| < π, by the trapezoidal rule for
/// e^z K_ν(z) = 2(2z)^(−½) ∫ e^(−x²) {(1 + x²/2z)^(−½), 2x²(1 + x²/2z)^½} dx over x > 0 (DLMF 10.32.8
/// with t = 1 + x²/z).
fn scaled_bessel_k(z: Complex64) -> [Complex64; 2] {
    const SPACING: f64 = 0.05;
    let (mut zero, mut one) = (Complex64::new(0.5, 0.0), Complex64::new(0.0, 0.0));
    for index in 1..140 {
        let square = (SPACING * f64::from(index)).powi(2);
        let root = (1.0 + square / (2.0 * z)).sqrt();
        zero += (-square).exp() / root;
        one += 2.0 * square * (-square).exp() * root;
    }
    let factor = 2.0 * SPACING / (2.0 * z).sqrt();
    [factor * zero, factor * one]
}

#[test]
fn bessel_functions_have_their_tabulated_values() {
    // K₀ and K₁ at 1 and 2 (Abramowitz & Stegun, table 9.8).
    for (z, expected) in [
        (1.0, [0.421_024_438_240_708_3, 0.601_907_230_197_234_6]),
        (2.0, [0.113_893_872_749_533_44, 0.139_865_881_816_522_43]),
    ] {
        let found = scaled_bessel_k(Complex64::new(z, 0.0));
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found * (-z).exp() - expected).norm() < 1e-13, "{z}: {found}");
        }
    }
}

/// Inverts a Laplace transform at t > 0 by Talbot's contour with fixed parameters (Abate & Valkó 2004).
fn invert_laplace(transform: impl Fn(Complex64) -> Complex64, time: f64) -> f64 {
    const POINTS: usize = 26;
    let r = 2.0 * POINTS as f64 / (5.0 * time);
    let mut sum = 0.5 * (r * time).exp() * transform(Complex64::new(r, 0.0)).re;
    for index in 1..POINTS {
        let angle = index as f64 * PI / POINTS as f64;
        let cotangent = 1.0 / angle.tan();
        let s = r * angle * Complex64::new(cotangent, 1.0);
        let slope = Complex64::new(1.0, angle + (angle * cotangent - 1.0) * cotangent);
        sum += ((s * time).exp() * transform(s) * slope).re;
    }
    r / POINTS as f64 * sum
}

/// Fields that the exact solution gives.
#[derive(Clone, Copy)]
enum Quantity {
    RadialVelocity,
    HoopStress,
}

/// Computes the response of an elastic cavity, at the radius r and the time t, to a pressure whose Laplace transform is
/// `pressure`: potential φ̂ = B K₀(sr/c), with B = −p̂/[ρs²K₀(sa/c) + (2μs/(ca))K₁(sa/c)], v̂ = sφ̂′, σ̂_θθ = λs²φ̂/c² +
/// 2μφ̂′/r. The factor e^(−s(r − a)/c) is a delay.
fn exact_response(
    solid: &Isotropic,
    pressure: impl Fn(Complex64) -> Complex64,
    quantity: Quantity,
    [radius, time]: [f64; 2],
) -> f64 {
    let Isotropic { lambda, mu, density, .. } = *solid;
    let speed = ((lambda + 2.0 * mu) / density).sqrt();
    let delayed = time - (radius - CAVITY_RADIUS) / speed;
    if delayed <= 0.0 {
        return 0.0;
    }
    let transform = |s: Complex64| {
        let [wall_zero, wall_one] = scaled_bessel_k(s * CAVITY_RADIUS / speed);
        let [zero, one] = scaled_bessel_k(s * radius / speed);
        let wall = density * s * s * wall_zero + 2.0 * mu * s / (speed * CAVITY_RADIUS) * wall_one;
        let amplitude = -pressure(s) / wall;
        let slope = -amplitude * s / speed * one;
        match quantity {
            Quantity::RadialVelocity => s * slope,
            Quantity::HoopStress => {
                lambda * s * s * amplitude * zero / (speed * speed) + 2.0 * mu * slope / radius
            }
        }
    };
    invert_laplace(transform, delayed)
}

#[test]
fn exact_cavity_has_the_limits_of_early_and_late_times() {
    let solid = classical(1.0);
    let speed = ((solid.lambda + 2.0 * solid.mu) / solid.density).sqrt();
    let step = |s: Complex64| 1.0 / s;
    // Behind the front the velocity is that of a plane wave, reduced by √(a/r).
    let radius = 0.2;
    let time = (radius - CAVITY_RADIUS + 1e-5) / speed;
    let velocity = exact_response(&solid, step, Quantity::RadialVelocity, [radius, time]);
    let expected = (CAVITY_RADIUS / radius).sqrt() / (solid.density * speed);
    assert!((velocity / expected - 1.0).abs() < 1e-3, "{velocity} {expected}");
    // At late times σ_θθ = p a²/r².
    let stress = exact_response(&solid, step, Quantity::HoopStress, [radius, 40.0]);
    assert!((stress - 0.25).abs() < 2e-3, "{stress}");
}

/// Verifies the response to a step at r = a, 2a and 4a, in the time 3a/c after the arrival of the wave.
///
/// In the first step the curvature acts on the first cell for Δt with the velocity that the first sweep gives it, the
/// fraction C (the Courant number) of that behind the front, though the wave reaches the centre of the cell at h/2c. For
/// a jump in time this leaves an error of first order in σ_θθ of the first cell, about 2(C − ½)²(h/a)·4μ(λ + μ)/(λ + 2μ)²
/// of the pressure: in the norm of the test 1.2 % at C = 0.95, 0.24 % at C = 0.7.
#[test]
fn elastic_cavity_under_step_pressure_agrees_with_the_laplace_transform() {
    let solid = classical(1.0);
    let medium = Medium::new(solid, 2);
    let speed = medium.max_speed();
    let cavity = Cavity::with_step_pressure(medium, [4, 400], 0.7, 1.0);
    let (step, width) = (cavity.problem.step, cavity.problem.grid.spacing[1]);
    let mut domain: Domain<f64, 2> = Domain::new(&cavity.problem).expect("sound");
    let layer = |radius: f64| (((radius - CAVITY_RADIUS) / width) as usize).min(399);
    let layers = [1.0, 2.0, 4.0].map(|multiple| layer(multiple * CAVITY_RADIUS));
    let duration = 3.0 * CAVITY_RADIUS / speed;
    let mut sums = [[[0.0; 2]; 3]; 2];
    let arrival = |layer: usize| (cavity.radii[layer] - CAVITY_RADIUS) / speed;
    let last = arrival(layers[2]) + duration;
    let mut steps = 0;
    while f64::from(steps) * step < last {
        domain.advance();
        steps += 1;
        let time = f64::from(steps) * step;
        // One step in four: the exact values cost more than the others.
        if steps % 4 != 0 {
            continue;
        }
        let quantities = [
            (Quantity::RadialVelocity, SolidField::Velocity(1)),
            (Quantity::HoopStress, SolidField::Stress(0, 0)),
        ];
        for (of_quantity, (quantity, field)) in sums.iter_mut().zip(quantities) {
            let found = cavity.column(&domain, field, 0);
            for ([error, size], layer) in of_quantity.iter_mut().zip(layers) {
                let since = time - arrival(layer);
                // Five cells about the front are left out.
                if since <= 2.5 * width / speed || since > duration {
                    continue;
                }
                let position = [cavity.radii[layer], time];
                let exact = exact_response(&solid, |s| 1.0 / s, quantity, position);
                *error += (found[layer] - exact).powi(2);
                *size += exact * exact;
            }
        }
    }
    let errors = sums.map(|own| own.map(|[error, size]| f64::sqrt(error / size)));
    println!("{errors:?}");
    assert!(errors.as_flattened().iter().all(|error| *error <= 0.01), "{errors:?}");
}

#[test]
fn smooth_loads_on_a_cavity_are_second_order() {
    let solid = classical(1.0);
    let speed = Medium::new(solid, 2).max_speed();
    // p = (t/τ)⁴ e^(4 − t/τ)/256, with the transform 24 (e/4)⁴ τ/(1 + sτ)⁵.
    let scale = 0.06 / speed;
    let factor = (1f64.exp() / 4.0).powi(4);
    let transform = |s: Complex64| 24.0 * factor * scale / (1.0 + s * scale).powi(5);
    let time = 7.0 * scale;
    let errors = [200, 400, 800].map(|cells: usize| {
        let signal: Signal =
            Arc::new(move |time: f64| factor * (time / scale).powi(4) * (-time / scale).exp());
        let medium = Medium::new(solid, 2);
        let mut cavity = Cavity::new(medium, [4, cells], 0.95, |_| 1.0, signal);
        let steps = (time / cavity.problem.step).ceil();
        cavity.problem.step = time / steps;
        let mut domain: Domain<f64, 2> = Domain::new(&cavity.problem).expect("sound");
        (0..steps as usize).for_each(|_| domain.advance());
        let found = cavity.column(&domain, SolidField::Velocity(1), 1);
        let (mut error, mut size) = (0.0, 0.0);
        for (layer, found) in found.into_iter().enumerate().step_by(cells / 100) {
            let position = [cavity.radii[layer], time];
            let exact = exact_response(&solid, transform, Quantity::RadialVelocity, position);
            error += (found - exact).abs();
            size += exact.abs();
        }
        error / size
    });
    let orders = [0, 1].map(|index| (errors[index] / errors[index + 1]).log2());
    println!("{errors:?} {orders:?}");
    assert!(orders.iter().all(|order| *order >= 1.8), "{errors:?} {orders:?}");
}

#[test]
fn difference_of_principal_stresses_at_a_plastic_wall_is_twice_the_shear_strength() {
    let strength = 0.02;
    let medium = Medium::new(classical(1.0), 2).with_yield_set(Mises::new_von_mises(strength));
    let speed = medium.max_speed();
    // Between the first yield at p = k and the collapse of a cavity in an unbounded medium there is no limit load.
    let cavity = Cavity::with_step_pressure(medium, [4, 200], 0.95, 6.0 * strength);
    let mut domain: Domain<f64, 2> = Domain::new(&cavity.problem).expect("sound");
    let steps = (0.8 / speed / cavity.problem.step) as usize;
    (0..steps).for_each(|_| domain.advance());
    let [hoop, radial] = [0, 1].map(|i| cavity.column(&domain, SolidField::Stress(i, i), 0));
    for layer in 0..3 {
        let ratio = (radial[layer] - hoop[layer]).abs() / (2.0 * strength);
        println!("{ratio}");
        assert!((ratio - 1.0).abs() < 0.01, "{layer}: {ratio}");
    }
    let dissipated = domain.ledger().plastic_dissipation;
    assert!(dissipated > 0.0);
}

/// Media of the tests with contacts or yield sets.
fn create_media() -> [Medium; 3] {
    [
        porous(0.5, 0.01, true, 2),
        granular(0.5, Some(0.05), 2),
        Medium::new(classical(1.0), 2).with_yield_set(Mises::new_drucker_prager(0.03, 0.3, 0.3)),
    ]
}

#[test]
fn waves_of_a_uniform_pressure_do_not_depend_on_the_angle() {
    for (index, medium) in create_media().into_iter().enumerate() {
        let speed = medium.max_speed();
        let cavity = Cavity::with_step_pressure(medium, [37, 60], 0.9, 1.0);
        let mut domain: Domain<f64, 2> = Domain::new(&cavity.problem).expect("sound");
        let steps = (0.4 / speed / cavity.problem.step) as usize;
        (0..steps).for_each(|_| domain.advance());
        let mut size = 0.0f64;
        for field in [SolidField::Velocity(1), SolidField::Stress(0, 0), SolidField::Stress(1, 1)] {
            let first = cavity.column(&domain, field, 0);
            size = first.iter().fold(size, |size, value| size.max(value.abs()));
            for column in 1..37 {
                let other = cavity.column(&domain, field, column);
                let difference = first.iter().zip(other).map(|(a, b)| (a - b).abs());
                let difference = difference.fold(0.0, f64::max);
                assert!(difference <= 1e-12 * size, "{index} {field:?}: {difference:e}");
            }
        }
        assert!(size > 0.1, "{index}: {size}");
        for field in [SolidField::Velocity(0), SolidField::Stress(0, 1)] {
            let values = domain.values(field).expect("a field");
            let greatest = values.iter().fold(0.0f64, |greatest, value| greatest.max(value.abs()));
            assert!(greatest <= 1e-12 * size, "{index} {field:?}: {greatest:e}");
        }
        assert!(domain.ledger().plastic_dissipation > 0.0, "{index}");
    }
}

/// Verifies that a uniform pressure, with that pressure at both boundaries, is kept to second order: it is not a state of
/// rest of the scheme, whose fields are √r times the physical ones.
#[test]
fn uniform_pressure_is_kept_to_second_order() {
    let pressure = 0.3;
    let deviations = [50, 100, 200].map(|cells: usize| {
        let medium = Medium::new(classical(1.0), 2);
        let speed = medium.max_speed();
        let mut cavity = Cavity::with_step_pressure(medium, [4, cells], 0.95, pressure);
        let pair = find_longitudinal(&cavity.problem);
        let faces = (0..4).map(|face| (face, -OUTER_RADIUS.sqrt() * pressure)).collect();
        let signal: Signal = Arc::new(|_| 1.0);
        cavity.problem.loads.push(Load { axis: 1, end: 1, pair, faces, signal });
        let mut domain: Domain<f64, 2> = Domain::new(&cavity.problem).expect("sound");
        for i in 0..2 {
            let value = |cell: usize| -pressure * cavity.radii[cell / 4].sqrt();
            let values: Vec<f64> = (0..4 * cells).map(value).collect();
            domain.set_field(SolidField::Stress(i, i), &values);
        }
        let steps = (0.9 / speed / cavity.problem.step) as usize;
        (0..steps).for_each(|_| domain.advance());
        let radial = cavity.column(&domain, SolidField::Stress(1, 1), 0);
        let sum: f64 = radial.iter().map(|stress| (stress + pressure).abs()).sum();
        sum / cells as f64 / pressure
    });
    let orders = [0, 1].map(|index| (deviations[index] / deviations[index + 1]).log2());
    println!("{deviations:?} {orders:?}");
    assert!(deviations[1] < 5e-4, "{deviations:?}");
    assert!(orders.iter().all(|order| *order > 1.7), "{deviations:?} {orders:?}");
}

#[test]
fn ledger_of_plastic_media_around_a_cavity_closes() {
    for (index, medium) in create_media().into_iter().enumerate() {
        let pressure = |face: usize| if face < 3 { 0.5 } else { 0.0 };
        let cavity = Cavity::new(medium, [16, 24], 0.9, pressure, Arc::new(|_| 1.0));
        let mut reference: Reference<f64, 2> = Reference::new(&cavity.problem).expect("sound");
        let velocities: Vec<f64> = (0..16 * 24).map(|cell| 0.1 * noise(cell)).collect();
        reference.set_field(SolidField::Velocity(0), &velocities);
        let start = reference.energy().total();
        reference.advance(60);
        let ledger = reference.ledger();
        let residual = start + ledger.boundary_work + ledger.source_work
            - ledger.plastic_dissipation
            - ledger.numerical_dissipation
            - reference.energy().total();
        let size = start + ledger.boundary_work.abs();
        println!("{index}: {:e}, {ledger:?}", residual / size);
        assert!(ledger.plastic_dissipation > 1e-3 * size, "{index}: {ledger:?}");
        assert!(ledger.numerical_dissipation > 0.0, "{index}: {ledger:?}");
        assert!(residual.abs() < 1e-12 * size, "{index}: {residual:e} {ledger:?}");
    }
}

/// Verifies that the law of pores holds for the physical fields: everywhere, with the volumetric strain e and the closure
/// κ = min(θ₀ + e, 0), the mean stress is k_a e + k_b κ.
#[test]
fn mean_stress_of_a_porous_medium_follows_the_physical_law() {
    let (skeleton, contact, porosity) = (1.5, 0.5, 0.01);
    let medium = porous(contact, porosity, true, 2);
    let speed = medium.max_speed();
    let cavity = Cavity::with_step_pressure(medium, [5, 80], 0.9, 0.4);
    let mut domain: Domain<f64, 2> = Domain::new(&cavity.problem).expect("sound");
    let steps = (0.4 / speed / cavity.problem.step) as usize;
    (0..steps).for_each(|_| domain.advance());
    let column = |field| cavity.column(&domain, field, 2);
    let normal = [0, 1, 2].map(|i| column(SolidField::Stress(i, i)));
    let (strain, closure) = (column(SolidField::VolumetricStrain), column(SolidField::PoreClosure));
    let mut collapsed = 0;
    for layer in 0..80 {
        let expected = (porosity + strain[layer]).min(0.0);
        assert!((closure[layer] - expected).abs() < 1e-13, "{layer}");
        let mean = (normal[0][layer] + normal[1][layer] + normal[2][layer]) / 3.0;
        let law = skeleton * strain[layer] + contact * closure[layer];
        assert!((mean - law).abs() < 1e-13, "{layer}: {mean} {law}");
        collapsed += usize::from(closure[layer] < 0.0);
    }
    assert!((1..80).contains(&collapsed), "{collapsed}");
}
