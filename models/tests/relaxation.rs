//! Standard linear solid against closed forms, numerical integration of its rate equations and quadrature.

use nalgebra::Complex;
use testkit::random::RandomNumbers;
use wellposed_models::common::number::Number;
use wellposed_models::rheology::relaxation::{Relaxation, StandardLinearSolid, SymmetricTensor};
use wellposed_models::solid::parameters::{Isotropic, Microrotation};
use wellposed_models::solid::stress::Stress;

type Tensor = [[f64; 3]; 3];

/// Relaxed Lamé modulus λ and shear modulus μ_R; [`BRANCH_MODULUS`] is the modulus μ₁ of the Maxwell branch and
/// [`RELAXATION_TIME`] is τ.
const RELAXED_MODULI: [f64; 2] = [1.3, 0.7];
const BRANCH_MODULUS: f64 = 0.45;
const RELAXATION_TIME: f64 = 0.8;

fn standard_solid() -> StandardLinearSolid {
    let [lambda, mu] = RELAXED_MODULI;
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple: None };
    let relaxed = Isotropic::new(lambda, mu, 1.2, Some(rotation)).expect("sound moduli");
    StandardLinearSolid::from_relaxed(relaxed, BRANCH_MODULUS, RELAXATION_TIME)
        .expect("sound constants")
}

fn tensor_from_entries(entry: impl Fn(usize, usize) -> f64) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn trace(t: &Tensor) -> f64 {
    t[0][0] + t[1][1] + t[2][2]
}

/// Random symmetric deviator.
fn random_deviator(random: &mut RandomNumbers) -> Tensor {
    let t =
        tensor_from_entries(|_, _| 0.0).map(|row| row.map(|_| random.signed_log_uniform(0.1, 1.0)));
    let mean = trace(&t) / 3.0;
    tensor_from_entries(|i, j| 0.5 * (t[i][j] + t[j][i]) - if i == j { mean } else { 0.0 })
}

fn double_product(a: &Tensor, b: &Tensor) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

/// Force stress from the strain deviator `e`, the volumetric strain, the viscous strain `a` and the antisymmetric
/// stress, by the relaxed moduli and the Maxwell branch.
fn force_stress(e: &Tensor, volume: f64, a: &Tensor, antisymmetric: &Tensor) -> Tensor {
    let bulk = RELAXED_MODULI[0] + 2.0 / 3.0 * RELAXED_MODULI[1];
    tensor_from_entries(|i, j| {
        let mean = if i == j { bulk * volume } else { 0.0 };
        let branch = 2.0 * BRANCH_MODULUS * (e[i][j] - a[i][j]);
        mean + 2.0 * RELAXED_MODULI[1] * e[i][j] + branch + antisymmetric[i][j]
    })
}

fn shear_stress(value: f64) -> Stress {
    Stress { force: [[0.0, value, 0.0], [value, 0.0, 0.0], [0.0; 3]], ..Stress::default() }
}

fn random_antisymmetric(random: &mut RandomNumbers) -> Tensor {
    let [x, y, z] = [0; 3].map(|_| random.signed_log_uniform(0.1, 1.0));
    [[0.0, x, y], [-x, 0.0, z], [-y, -z, 0.0]]
}

fn assert_close(found: &Tensor, expected: &Tensor, tolerance: f64) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < tolerance, "{found} {expected}");
    }
}

/// After a step of strain with the deviator e the deviatoric stress relaxes as s(t) = 2μ_R e + 2μ₁e exp(−t/τ), for
/// random time steps; mean stress, antisymmetric stress and couple stress are constant.
#[test]
fn stress_relaxes_at_constant_strain() {
    let (solid, mut random) = (standard_solid(), RandomNumbers::new(1));
    let [e, spin] = [random_deviator(&mut random), random_antisymmetric(&mut random)];
    let couple = [[0.3, -0.2, 0.1], [0.7, 0.5, -0.6], [0.9, -0.4, 0.8]];
    let mut stress = Stress { force: force_stress(&e, 0.31, &[[0.0; 3]; 3], &spin), couple };
    let (mut strain, mut time) = ([[0.0; 3]; 3], 0.0);
    for _ in 0..40 {
        let step = random.log_uniform(1e-4, 1.0);
        solid.relax(&mut stress, &mut strain, step);
        time += step;
        let decay = (-time / RELAXATION_TIME).exp();
        let bulk = RELAXED_MODULI[0] + 2.0 / 3.0 * RELAXED_MODULI[1];
        let expected = tensor_from_entries(|i, j| {
            let mean = if i == j { bulk * 0.31 } else { 0.0 };
            mean + (2.0 * RELAXED_MODULI[1] + 2.0 * BRANCH_MODULUS * decay) * e[i][j] + spin[i][j]
        });
        assert_close(&stress.force, &expected, 4e-15);
        assert_close(&strain, &e.map(|row| row.map(|e| (1.0 - decay) * e)), 4e-15);
        assert_eq!(stress.couple, couple);
    }
    assert!(time > 3.0 * RELAXATION_TIME);
}

/// Creep under constant stress, restored after each relaxation by an elastic strain at constant viscous strain,
/// converges with order 1 to the closed form e = s/(2μ_R) [1 − (μ₁/μ_U) exp(−t μ_R/(μ_U τ))].
#[test]
fn creep_at_constant_stress_converges_at_first_order() {
    let solid = standard_solid();
    let unrelaxed = RELAXED_MODULI[1] + BRANCH_MODULUS;
    let exact = |time: f64| {
        let decay = (-time * RELAXED_MODULI[1] / (unrelaxed * RELAXATION_TIME)).exp();
        0.5 / RELAXED_MODULI[1] * (1.0 - BRANCH_MODULUS / unrelaxed * decay)
    };
    let error = |steps: usize| {
        let step = 2.0 * RELAXATION_TIME / steps as f64;
        let (mut strain, mut viscous) = (0.5 / unrelaxed, [[0.0; 3]; 3]);
        let mut worst = 0.0f64;
        for index in 1..=steps {
            let mut stress = shear_stress(1.0);
            solid.relax(&mut stress, &mut viscous, step);
            strain += (1.0 - stress.force[0][1]) / (2.0 * unrelaxed);
            worst = worst.max((strain - exact(index as f64 * step)).abs());
        }
        worst
    };
    let errors = [100, 200, 400].map(error);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((0.98..1.02).contains(&order), "{errors:?}");
    }
    // Richardson extrapolation of the error to zero step length.
    assert!((2.0 * errors[2] - errors[1]).abs() < 2e-6, "{errors:?}");
}

/// The viscous strain a and the dissipated energy agree with the rate equation τȧ = e − a integrated by the classical
/// Runge–Kutta method in 4000 steps.
#[test]
fn viscous_strain_agrees_with_runge_kutta_integration() {
    let (solid, mut random) = (standard_solid(), RandomNumbers::new(2));
    for duration in [0.05, 0.8, 3.0] {
        let [e, start, spin] = [
            random_deviator(&mut random),
            random_deviator(&mut random),
            random_antisymmetric(&mut random),
        ];
        let mut stress =
            Stress { force: force_stress(&e, -0.7, &start, &spin), ..Stress::default() };
        let mut strain = start;
        let dissipated = solid.relax(&mut stress, &mut strain, duration);

        let (steps, mut a, mut dissipated_reference) = (4000, start, 0.0);
        let h = duration / f64::from(steps);
        let rate = |a: &Tensor| tensor_from_entries(|i, j| (e[i][j] - a[i][j]) / RELAXATION_TIME);
        let power = |a: &Tensor| {
            let spring = tensor_from_entries(|i, j| 2.0 * BRANCH_MODULUS * (e[i][j] - a[i][j]));
            double_product(&spring, &rate(a))
        };
        for _ in 0..steps {
            let k1 = rate(&a);
            let second = tensor_from_entries(|i, j| a[i][j] + 0.5 * h * k1[i][j]);
            let k2 = rate(&second);
            let third = tensor_from_entries(|i, j| a[i][j] + 0.5 * h * k2[i][j]);
            let k3 = rate(&third);
            let fourth = tensor_from_entries(|i, j| a[i][j] + h * k3[i][j]);
            let k4 = rate(&fourth);
            dissipated_reference +=
                h / 6.0 * (power(&a) + 2.0 * power(&second) + 2.0 * power(&third) + power(&fourth));
            a = tensor_from_entries(|i, j| {
                a[i][j] + h / 6.0 * (k1[i][j] + 2.0 * (k2[i][j] + k3[i][j]) + k4[i][j])
            });
        }
        assert_close(&strain, &a, 1e-12);
        assert_close(&stress.force, &force_stress(&e, -0.7, &a, &spin), 1e-12);
        assert!(
            (dissipated - dissipated_reference).abs() < 1e-12,
            "{dissipated} {dissipated_reference}"
        );
    }
}

/// The stored energy equals the energy of the springs, and in a relaxation of any duration it decreases by the
/// dissipated energy to rounding.
#[test]
fn stored_energy_decreases_by_the_dissipated_energy() {
    let (solid, mut random) = (standard_solid(), RandomNumbers::new(3));
    for _ in 0..2000 {
        let [e, a, spin] = [
            random_deviator(&mut random),
            random_deviator(&mut random),
            random_antisymmetric(&mut random),
        ];
        let volume = random.signed_log_uniform(0.1, 1.0);
        let mut stress = Stress { force: force_stress(&e, volume, &a, &spin), ..Stress::default() };
        let bulk = RELAXED_MODULI[0] + 2.0 / 3.0 * RELAXED_MODULI[1];
        let branch = tensor_from_entries(|i, j| e[i][j] - a[i][j]);
        let springs = RELAXED_MODULI[1] * double_product(&e, &e)
            + BRANCH_MODULUS * double_product(&branch, &branch)
            + 0.5 * bulk * volume * volume
            + double_product(&spin, &spin) / (4.0 * 0.6);
        let mut strain = a;
        let before = solid.stored_energy(&stress, &strain);
        assert!((before - springs).abs() < 1e-14 * springs, "{before} {springs}");
        let duration = RELAXATION_TIME * random.log_uniform(1e-8, 1e4);
        let dissipated = solid.relax(&mut stress, &mut strain, duration);
        let after = solid.stored_energy(&stress, &strain);
        assert!(dissipated >= 0.0);
        assert!((after - before + dissipated).abs() < 4e-15 * before, "{before} {after}");
    }
}

/// Relaxation over zero or negligible time changes nothing; over a very long time it reaches the relaxed state.
#[test]
fn steps_of_extreme_length_are_exact() {
    let solid = standard_solid();
    let mut random = RandomNumbers::new(4);
    let [e, a] = [random_deviator(&mut random), random_deviator(&mut random)];
    let start = force_stress(&e, 0.0, &a, &[[0.0; 3]; 3]);
    for duration in [0.0, 5e-324, 1e-300] {
        let (mut stress, mut strain) = (Stress { force: start, ..Stress::default() }, a);
        let dissipated = solid.relax(&mut stress, &mut strain, duration);
        assert_eq!((stress.force, strain), (start, a));
        assert!(dissipated < 1e-299);
    }
    for duration in [1e3, 1e300, f64::MAX] {
        let (mut stress, mut strain) = (Stress { force: start, ..Stress::default() }, a);
        let dissipated = solid.relax(&mut stress, &mut strain, duration);
        assert_close(&strain, &e, 1e-15);
        assert_close(&stress.force, &e.map(|row| row.map(|e| 2.0 * RELAXED_MODULI[1] * e)), 1e-15);
        let spring = tensor_from_entries(|i, j| e[i][j] - a[i][j]);
        assert!((dissipated - BRANCH_MODULUS * double_product(&spring, &spring)).abs() < 1e-15);
    }
}

/// The complex modulus is ς times the Laplace transform of the stress relaxation after a unit step of strain,
/// 2μ(ς) = ς∫exp(−ςt) s(t) dt, evaluated by Simpson's rule.
#[test]
fn complex_modulus_is_the_laplace_transform_of_the_relaxation() {
    let solid = standard_solid();
    let (steps, end) = (40_000, 40.0 * RELAXATION_TIME);
    let h = end / f64::from(steps);
    for rate in [(0.0, 0.3), (0.0, 1.25), (0.0, 9.0), (0.4, 2.0), (-0.2, 3.0)] {
        let rate = Complex::new(rate.0, rate.1);
        let mut stress = shear_stress(2.0 * (RELAXED_MODULI[1] + BRANCH_MODULUS));
        let mut strain = [[0.0; 3]; 3];
        let mut sum = Complex::new(0.0, 0.0);
        for index in 0..=steps {
            let weight = match index {
                0 => 1.0,
                _ if index == steps => 1.0,
                _ if index % 2 == 1 => 4.0,
                _ => 2.0,
            };
            // The constant stress 2μ_R, whose transform is 2μ_R/ς, is subtracted here and added in closed form below.
            let relaxing = stress.force[0][1] - 2.0 * RELAXED_MODULI[1];
            sum += (-rate * (f64::from(index) * h)).exp() * (weight * relaxing * h / 3.0);
            solid.relax(&mut stress, &mut strain, h);
        }
        let expected = (sum * rate + 2.0 * RELAXED_MODULI[1]) * 0.5;
        let found = solid.shear_modulus(rate);
        assert!((found - expected).norm() < 1e-9, "{rate}: {found} {expected}");
        let bulk = RELAXED_MODULI[0] + 2.0 / 3.0 * RELAXED_MODULI[1];
        let difference = solid.longitudinal_modulus(rate) - expected * (4.0 / 3.0) - bulk;
        assert!(difference.norm() < 2e-9);
    }
    // At low and high frequency the moduli tend to the relaxed and the unrelaxed moduli.
    for (frequency, limit) in [(1e-9, solid.relaxed()), (1e9, solid.unrelaxed())] {
        let rate = Complex::new(0.0, frequency);
        assert!((solid.shear_modulus(rate) - limit.mu).norm() < 1e-8);
        let modulus = limit.lambda + 2.0 * limit.mu;
        assert!((solid.longitudinal_modulus(rate) - modulus).norm() < 1e-8);
    }
}

/// `from_relaxed` and `from_unrelaxed` give the same solid, and both reject invalid constants with their name.
#[test]
fn both_constructors_agree_and_reject_invalid_constants() {
    let own = standard_solid();
    let again =
        StandardLinearSolid::from_unrelaxed(own.unrelaxed(), BRANCH_MODULUS, RELAXATION_TIME)
            .expect("sound");
    assert_eq!(again, own);
    let [lambda, mu] = RELAXED_MODULI;
    let relaxed = again.relaxed();
    assert!((relaxed.lambda - lambda).abs() < 1e-15 && (relaxed.mu - mu).abs() < 1e-15);
    assert!((own.unrelaxed().mu - mu - BRANCH_MODULUS).abs() < 1e-15);
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let name = |branch: f64, time: f64| {
            let [one, other] = [own.relaxed(), own.unrelaxed()];
            let one = StandardLinearSolid::from_relaxed(one, branch, time).expect_err("wrong");
            let other =
                StandardLinearSolid::from_unrelaxed(other, branch, time).expect_err("wrong");
            assert_eq!(one.input, other.input);
            one.input
        };
        assert_eq!(name(wrong, RELAXATION_TIME), "branch_mu");
        assert_eq!(name(BRANCH_MODULUS, wrong), "relaxation_time");
    }
    for branch in [own.unrelaxed().mu, 2.0] {
        let refused = StandardLinearSolid::from_unrelaxed(own.unrelaxed(), branch, RELAXATION_TIME);
        let error = refused.expect_err("nothing elastic would be left");
        assert_eq!(error.input, "branch_mu");
        assert!(error.to_string().contains("must be positive"), "{error}");
    }
}

/// Relaxation increments in single precision agree with double precision to rounding; increments in plane strain equal
/// those in space, and increments do not depend on the mean stress and strain.
#[test]
fn increments_agree_in_single_precision_and_in_plane_strain() {
    let step = standard_solid().compute_relaxation(0.3);
    let narrow = Relaxation {
        strain_per_stress: f32::from_f64(step.strain_per_stress),
        strain_per_strain: f32::from_f64(step.strain_per_strain),
        relaxed_fraction: f32::from_f64(step.relaxed_fraction),
        stress_per_strain: f32::from_f64(step.stress_per_strain),
        dissipation: f32::from_f64(step.dissipation),
    };
    let stress = SymmetricTensor { normal: [0.7, -0.2, 1.1], shear: [0.4] };
    let strain = SymmetricTensor { normal: [0.1, 0.3, -0.4], shear: [-0.2] };
    let plane = step.compute_increments(stress, strain);
    // Increments do not depend on the mean stress and strain.
    let shifted = SymmetricTensor { normal: stress.normal.map(|x| x + 0.75), ..stress };
    let means = step.compute_increments(
        shifted,
        SymmetricTensor { normal: strain.normal.map(|x| x - 0.5), ..strain },
    );
    for (found, expected) in means.stress.normal.into_iter().zip(plane.stress.normal) {
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }
    let [a, b, c] = plane.stress.normal;
    assert!((a + b + c).abs() < 1e-16);
    let to_single_precision = |own: SymmetricTensor<f64, 1>| SymmetricTensor {
        normal: own.normal.map(f32::from_f64),
        shear: own.shear.map(f32::from_f64),
    };
    let found = narrow.compute_increments(to_single_precision(stress), to_single_precision(strain));
    for (found, expected) in found.stress.normal.into_iter().zip(plane.stress.normal) {
        assert!((f64::from(found) - expected).abs() < 1e-6);
    }
    assert!((f64::from(found.dissipated_energy) - plane.dissipated_energy).abs() < 1e-6);
    let to_space = |own: SymmetricTensor<f64, 1>| SymmetricTensor {
        normal: own.normal,
        shear: [own.shear[0], 0.0, 0.0],
    };
    let space = step.compute_increments(to_space(stress), to_space(strain));
    assert_eq!(space.viscous_strain, to_space(plane.viscous_strain));
    assert_eq!(space.dissipated_energy, plane.dissipated_energy);
}
