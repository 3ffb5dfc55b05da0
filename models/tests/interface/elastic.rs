//! Face law of an elastic interlayer: dense solution of its equations, welded limit, energy balance, symmetry under
//! reflection.

use nalgebra::{DMatrix, DVector};
use testkit::random::RandomNumbers;
use wellposed_models::interface::elastic::{ElasticComponent, ElasticMaterial};
use wellposed_models::interface::opening_line::LayerMass;
use wellposed_models::interface::{RiemannData, power};

/// Random face law, incoming Riemann invariants and impedances, time step and history variables (V, S); mass,
/// compliance, impedances and time step over four decades.
fn random_face(
    random: &mut RandomNumbers,
) -> (ElasticComponent<f64>, RiemannData<f64>, f64, [f64; 3]) {
    let mut size = || 10f64.powf(random.uniform(-2.0, 2.0));
    let law = ElasticComponent { mass: LayerMass::new_box(size()), compliance: size() };
    let (impedance, step) = ([size(), size()], size());
    let invariant = [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
    let history = [random.uniform(-1.0, 1.0), 0.0, random.uniform(-1.0, 1.0)];
    (law, RiemannData { impedance, invariant }, step, history)
}

/// Solves the equations of the midpoint rule for v⁻, v⁺, σ⁻, σ⁺ and the new V and S.
fn solve_midpoint_rule(
    law: &ElasticComponent<f64>,
    incoming: &RiemannData<f64>,
    step: f64,
    [velocity, _, stress]: [f64; 3],
) -> DVector<f64> {
    let [z, y] = incoming.impedance;
    let (m, c) = (law.mass.mass / step, law.compliance / step);
    #[rustfmt::skip]
    let matrix = DMatrix::from_row_slice(6, 6, &[
        z,    0.0,  -1.0, 0.0,  0.0,  0.0,   // z⁻v⁻ − σ⁻ = R⁻
        0.0,  y,    0.0,  1.0,  0.0,  0.0,   // z⁺v⁺ + σ⁺ = R⁺
        0.5,  0.5,  0.0,  0.0,  -0.5, 0.0,   // ½(v⁺ + v⁻) = ½(V + V_old)
        0.0,  0.0,  0.5,  0.5,  0.0,  -0.5,  // ½(σ⁺ + σ⁻) = ½(S + S_old)
        0.0,  0.0,  1.0,  -1.0, m,    0.0,   // m (V − V_old)/Δt = σ⁺ − σ⁻
        1.0,  -1.0, 0.0,  0.0,  0.0,  c,     // C (S − S_old)/Δt = v⁺ − v⁻
    ]);
    let [before, after] = incoming.invariant;
    let right = [before, after, 0.5 * velocity, 0.5 * stress, m * velocity, c * stress];
    matrix.lu().solve(&DVector::from_row_slice(&right)).expect("regular")
}

/// A step of the face law agrees with the dense solution of the equations of both adjacent cells and of the layer.
#[test]
fn step_agrees_with_the_dense_solution_of_the_midpoint_rule() {
    let mut random = RandomNumbers::new(1);
    let mut worst = 0.0f64;
    for _ in 0..10_000 {
        let (law, incoming, step, mut history) = random_face(&mut random);
        let expected = solve_midpoint_rule(&law, &incoming, step, history);
        let found = law.advance(incoming, step, &mut history);
        let [before, after] = found;
        let [z, y] = incoming.impedance;
        // Magnitude of the results for these coefficients, to which the error is related.
        let scale = (history[2].abs() + 1.0) * (z.max(y) / z.min(y)) / z.min(y).min(1.0);
        for (found, expected) in [
            (before.velocity, expected[0]),
            (after.velocity, expected[1]),
            (before.stress, expected[2]),
            (after.stress, expected[3]),
            (history[0], expected[4]),
            (history[2], expected[5]),
        ] {
            worst = worst.max((found - expected).abs() / scale);
        }
    }
    println!("{worst:e}");
    // The tolerance allows for the condition number of the system, whose coefficients span four decades.
    assert!(worst < 1e-11, "{worst:e}");
}

/// Without mass and compliance the law gives the solution of the Riemann problem, v = (R⁻ + R⁺)/(z⁻ + z⁺),
/// σ = (z⁻R⁺ − z⁺R⁻)/(z⁻ + z⁺).
#[test]
fn interlayer_without_mass_and_compliance_is_a_welded_interface() {
    let mut random = RandomNumbers::new(2);
    for _ in 0..1000 {
        let (_, incoming, step, _) = random_face(&mut random);
        let found = ElasticComponent::WELDED.advance(incoming, step, &mut [0.0; 3]);
        let ([z, y], [before, after]) = (incoming.impedance, incoming.invariant);
        let velocity = (before + after) / (z + y);
        let stress = (z * after - y * before) / (z + y);
        for state in found {
            // The tolerance allows for cancellation in zv − R and in the opening rate (R⁺ − R⁻)/z̄.
            let size = 2.0 * (z.max(y) / z.min(y));
            assert!((state.velocity - velocity).abs() < 8.0 * f64::EPSILON * size / z.min(y));
            assert!((state.stress - stress).abs() < 8.0 * f64::EPSILON * size);
        }
    }
}

/// The energy balance of a step holds to rounding: the energy gained by the layer plus the dissipated energy equals the
/// work of both adjacent cells.
#[test]
fn energy_gain_of_the_interlayer_equals_the_work_of_both_cells() {
    let mut random = RandomNumbers::new(3);
    let (mut worst, mut energy_change) = (0.0f64, 0.0f64);
    let (mut law, mut incoming, mut step, mut history) = random_face(&mut random);
    for number in 0..20_000 {
        if number % 1000 == 0 {
            (law, incoming, step, history) = random_face(&mut random);
        }
        let energy = |[velocity, opening_rate, stress]: &[f64; 3]| {
            law.mass.kinetic_energy([*velocity, *opening_rate]) + law.stored_energy(*stress)
        };
        incoming.invariant = [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
        let before = energy(&history);
        let found = law.advance(incoming, step, &mut history);
        // The scale includes the power of incoming and outgoing waves, ½(zv² + σ²/z) on each side.
        let wave_power = |side: usize| {
            let (own, z) = (found[side], incoming.impedance[side]);
            0.5 * (z * own.velocity * own.velocity + own.stress * own.stress / z)
        };
        let size = before + energy(&history) + step * (wave_power(0) + wave_power(1));
        let residual = energy(&history) - before - step * power(&found);
        worst = worst.max(residual.abs() / size);
        energy_change = energy_change.max((energy(&history) - before).abs() / size);
    }
    println!("{worst:e}, energy change {energy_change}");
    assert!(worst < 20.0 * f64::EPSILON);
    assert!(energy_change > 0.01);
}

/// Under reflection of the axis, which exchanges the cells and reverses the velocities, the results are reflected
/// bitwise.
#[test]
fn mirrored_interlayer_gives_bitwise_mirrored_results() {
    let mut random = RandomNumbers::new(4);
    for _ in 0..1000 {
        let (law, incoming, step, mut history) = random_face(&mut random);
        let swap = |[a, b]: [f64; 2]| [b, a];
        let mirrored = RiemannData {
            impedance: swap(incoming.impedance),
            invariant: swap(incoming.invariant).map(|r| -r),
        };
        let mut mirrored_history = [-history[0], history[1], history[2]];
        let one = law.advance(incoming, step, &mut history);
        let other = law.advance(mirrored, step, &mut mirrored_history);
        for side in 0..2 {
            let (one, other) = (one[side], other[1 - side]);
            assert_eq!(one.velocity.to_bits(), (-other.velocity).to_bits());
            assert_eq!(one.stress.to_bits(), other.stress.to_bits());
        }
        assert_eq!([-mirrored_history[0], mirrored_history[1], mirrored_history[2]], history);
    }
}

/// The stiffness of the layer is K = ρ′c′²/δ, and √(mK) equals the impedance ρ′c′ of its material.
#[test]
fn interlayer_has_the_impedance_of_its_material() {
    let material = ElasticMaterial {
        thickness: 1e-3,
        density: 1500.0,
        longitudinal_speed: 1000.0,
        shear_speed: 500.0,
    };
    assert_eq!(material.check(), Ok(()));
    for (compliance, stiffness, impedance) in [
        (material.normal_compliance(), 1.5e12, 1.5e6),
        (material.tangential_compliance(), 3.75e11, 7.5e5),
    ] {
        assert!((compliance * stiffness - 1.0).abs() < 1e-15);
        assert!(((material.mass() / compliance).sqrt() / impedance - 1.0).abs() < 1e-15);
    }
    let refused = ElasticMaterial { density: 0.0, ..material }.check().expect_err("no density");
    assert_eq!(refused.input, "density");
}
