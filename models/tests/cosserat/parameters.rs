//! Moduli of elastic solids: checked inequalities, and conversion to compliances and back.

use crate::cosserat::random_solids::{random_cubic_solid, random_solid};
use crate::cosserat::waves::compute_frequencies;
use crate::support::{RandomNumbers, draw_log_uniform};
use wellposed_models::common::rates::SymmetricForm;
use wellposed_models::solid::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances,
};

/// A violated inequality (value zero, negative, NaN or infinite) is rejected with the inequality and the value in the
/// error.
#[test]
fn violated_inequalities_are_rejected() {
    type ModuliChange = fn(&mut Isotropic, f64);
    fn microrotation_mut(solid: &mut Isotropic) -> &mut Microrotation {
        solid.microrotation.as_mut().unwrap()
    }
    fn couple_moduli_mut(solid: &mut Isotropic) -> &mut CoupleModuli {
        microrotation_mut(solid).couple.as_mut().unwrap()
    }
    let couple_moduli = CoupleModuli { beta: 1.0, gamma: 1.5, eta: 2.0 };
    let microrotation = Microrotation { alpha: 1.0, inertia: 1.0, couple: Some(couple_moduli) };
    let sound = Isotropic::new(1.0, 1.5, 1.0, Some(microrotation)).unwrap();
    let cases: [(&str, &str, ModuliChange); 8] = [
        ("mu", "μ > 0", |s, x| s.mu = x),
        ("lambda", "3λ + 2μ > 0", |s, x| s.lambda = x - 1.0),
        ("density", "ρ > 0", |s, x| s.density = x),
        ("alpha", "α > 0", |s, x| microrotation_mut(s).alpha = x),
        ("inertia", "j > 0", |s, x| microrotation_mut(s).inertia = x),
        ("gamma", "γ > 0", |s, x| couple_moduli_mut(s).gamma = x),
        ("beta", "3β + 2γ > 0", |s, x| couple_moduli_mut(s).beta = x - 1.0),
        ("eta", "η > 0", |s, x| couple_moduli_mut(s).eta = x),
    ];
    for (key, inequality, set) in cases {
        for (value, sum) in
            [(0.0, "= 0"), (-0.25, "= -0.75"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")]
        {
            let mut broken = sound;
            set(&mut broken, value);
            let error =
                Isotropic::new(broken.lambda, broken.mu, broken.density, broken.microrotation)
                    .unwrap_err();
            assert_eq!(error.input, key);
            let text = error.to_string();
            assert!(text.contains(inequality), "{text}");
            let number =
                if inequality.starts_with('3') { sum.to_string() } else { value.to_string() };
            assert!(error.rejected_value.contains(&number), "{text}: {number}");
        }
    }
    let plane = PlaneCompliances {
        a1: 1.0,
        b1: 0.5,
        a2: 2.0,
        b2: 0.5,
        alpha2: 1.0,
        density: 1.0,
        inertia: 1.0,
    };
    assert!(plane.check().is_ok());
    type ComplianceChange = fn(&mut PlaneCompliances);
    let cases: [(&str, &str, &str, ComplianceChange); 9] = [
        ("a1", "a₁ > |b₁|", "= 0", |c| c.b1 = 1.0),
        ("a1", "a₁ > |b₁|", "= -0.5", |c| c.b1 = -1.5),
        ("a1", "a₁ > |b₁|", "NaN", |c| c.a1 = f64::NAN),
        ("a2", "a₂ > |b₂|", "= 0", |c| c.b2 = -2.0),
        ("a2", "a₂ > |b₂|", "= -1", |c| c.b2 = 3.0),
        ("alpha2", "α₂ > 0", "0", |c| c.alpha2 = 0.0),
        ("alpha2", "α₂ > 0", "-1", |c| c.alpha2 = -1.0),
        ("density", "ρ₀ > 0", "0", |c| c.density = 0.0),
        ("inertia", "J₀ > 0", "0", |c| c.inertia = 0.0),
    ];
    for (key, inequality, number, set) in cases {
        let mut broken = plane;
        set(&mut broken);
        let error = broken.check().unwrap_err();
        assert_eq!(error.input, key);
        assert!(error.allowed_values.contains(inequality), "{error}");
        assert!(error.rejected_value.contains(number), "{error}");
    }
    // Couple moduli with 3β + 2γ = 0 are rejected although the force moduli are valid.
    let dense_foam = CoupleModuli { beta: -1.0, gamma: 1.5, eta: 1.0 };
    let foam = Microrotation { couple: Some(dense_foam), ..microrotation };
    assert_eq!(Isotropic::new(1.0, 1.0, 1.0, Some(foam)).unwrap_err().input, "beta");
}

/// Conversion of moduli to compliances and back returns the moduli, and the compliances satisfy the published
/// relations. Compliances of a cubic solid are rejected, and only in cubic solids the wave speeds depend on the
/// direction.
#[test]
fn moduli_are_recovered_from_compliances() {
    let mut random = RandomNumbers::new(9);
    for _ in 0..1000 {
        let mut solid = random_solid(&mut random, 2);
        // λ and μ over eleven decades; α from 1e-3 to 1e3 times μ.
        let scale = draw_log_uniform(&mut random, 0.0, 11.0);
        (solid.lambda, solid.mu) = (solid.lambda * scale, solid.mu * scale);
        let alpha = solid.mu * draw_log_uniform(&mut random, -3.0, 3.0);
        solid.microrotation.as_mut().unwrap().alpha = alpha;
        let c = PlaneCompliances::from_isotropic(&solid).unwrap().check().unwrap();
        let couple = solid.couple().unwrap();
        assert_eq!(c.alpha2, couple.gamma + couple.eta);
        assert!(c.anisotropy().abs() <= 1e-12, "{:e}", c.anisotropy());
        let [lambda, mu, own_alpha] = c.isotropic_moduli().unwrap();
        // Cancellation in a₂ ± b₂ amplifies rounding errors by α/μ or μ/α.
        let close = |own: f64, exact: f64, size: f64| {
            assert!((own - exact).abs() <= 1e-13 * size, "{own:e} {exact:e} of {solid:?}");
        };
        close(lambda, solid.lambda, solid.lambda.abs() + solid.mu);
        close(mu, solid.mu, solid.mu);
        close(own_alpha, alpha, alpha + alpha * alpha / solid.mu);
        // Published relations between compliances and moduli.
        let inverse_entries = |a: f64, b: f64| [a, b].map(|x| x / ((a - b) * (a + b)));
        let size = solid.lambda.abs() + 2.0 * solid.mu + alpha;
        let [sum, cross] = inverse_entries(c.a1, c.b1);
        close(sum, solid.lambda + 2.0 * solid.mu, size);
        close(cross, solid.lambda, size);

        // Cubic compliances are rejected, even with a relative anisotropy of 1e-6.
        let mut cubic = c;
        cubic.a1 *= 1.0 + 1e-6;
        let error = cubic.isotropic_moduli().unwrap_err();
        assert!(error.allowed_values.contains("a₁ + b₁ = a₂ − b₂"), "{error}");
        let (_, sum) = error.rejected_value.split_once("a₁ + b₁ = ").expect("the sum");
        let sum: f64 = sum.split(',').next().and_then(|own| own.parse().ok()).expect("a number");
        assert!((sum / (cubic.a1 + cubic.b1) - 1.0).abs() < 1e-5, "{error}");
    }
    assert_eq!(PlaneCompliances::from_isotropic(&random_solid(&mut random, 1)), None);
    assert_eq!(PlaneCompliances::from_isotropic(&random_solid(&mut random, 0)), None);

    // Wave speeds depend on the direction in cubic solids only.
    let spread = |form: &SymmetricForm<2>| {
        let principal = SymmetricForm { q: form.q.clone() * 0.0, ..form.clone() };
        let [along, across] = [[1.0, 0.0], [0.6, 0.8]].map(|n| compute_frequencies(&principal, n));
        along.iter().zip(&across).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    assert!(spread(&random_cubic_solid(&mut random).rates().symmetric_form().unwrap()) > 1e-3);
    assert!(spread(&random_solid(&mut random, 2).rates::<2>().symmetric_form().unwrap()) < 1e-12);
}
