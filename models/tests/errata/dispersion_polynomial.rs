//! Errata of the dispersion polynomial in Harris & Grekova (2005): eqs (121), (131), (138).

use crate::errata::comparison::{Comparison, EXACT_TOLERANCE};
use crate::errata::elimination::Elimination;
use crate::errata::system::{for_random_flows, random_wave};
use crate::support::{
    Complex, evaluate_polynomial, multiply_polynomials, polynomial_determinant, quadratic_roots,
    states,
};
use wellposed_models::registry;

/// The scaled coefficient A₁/k⁸ of eq. (138) is printed with ē₅₂ in place of ē₄₂ in the first brace and ē₂₅ in place of
/// ē₂₄ in the second, where ē = e/k. Reference: the coefficient of (ρς)³ of the expanded determinant of F (eq. 110).
/// Each misprint alone makes the formula wrong.
#[test]
fn eq_138_scaled_coefficient_has_two_misprints() {
    let mut comparisons: [Comparison; 3] = Default::default();
    for_random_flows(10, |random, system| {
        let wave = random_wave(random);
        let own = Elimination::new(&system, wave);
        let k = Complex::from((wave[0] * wave[0] + wave[1] * wave[1]).sqrt());
        let bar = own.e.map(|row| row.map(|x| x / k));
        let k2 = k * k;
        let (f, g) = (own.f / (k2 * k2), own.g / k2);
        let inertia = Complex::from(system.inertia());
        let [c12, c21, c31, c32] = [bar[0][1], bar[1][0], bar[2][0], bar[2][1]];
        let [c53, c55] = [bar[4][2], bar[4][4]];
        let stress = bar[0][3] * bar[1][4] - bar[0][4] * bar[1][3];
        let value = |e42: Complex, e24: Complex| {
            let bracket = |e42: Complex, e24: Complex| {
                e42 * (bar[0][0] * bar[1][3] - bar[0][3] * c21)
                    + bar[3][0] * (bar[1][1] * bar[0][3] - e24 * c12)
            };
            let e33 = bar[2][2];
            inertia * f * f
                + (inertia * c55 * bracket(e42, bar[1][3]) + (e33 + e33) / k * g) * f
                + (c55 * e33 * bracket(bar[3][1], e24)
                    - c53 * (c31 * bar[3][1] - c32 * bar[3][0]) * stress)
                    / k
                    * g
        };
        let rho = own.density;
        let expanded = polynomial_determinant(&own.reduced_matrix(system.inertia()));
        let truth = expanded[3] / (rho * rho * rho) / (k2 * k2 * k2 * k2);
        let corrected = value(bar[3][1], bar[1][3]);
        let printed =
            [value(bar[4][1], bar[1][4]), value(bar[4][1], bar[1][3]), value(bar[3][1], bar[1][4])];
        for (comparison, printed) in comparisons.iter_mut().zip(printed) {
            // The misprinted terms are small relative to I f² but far above rounding: an error of a million times the
            // tolerance counts as wrong.
            let size = truth.abs();
            let off = (corrected - truth).abs();
            assert!(off <= EXACT_TOLERANCE * size, "corrected (138) is off by {off:e} of {size:e}");
            comparison.comparisons += 1;
            comparison.misprints +=
                usize::from((printed - truth).abs() > 1e6 * EXACT_TOLERANCE * size);
        }
    });
    comparisons.into_iter().for_each(Comparison::assert_mostly_misprinted);
}

/// Eq. (121): det F (110) is a quintic, but its factor ς²(f + gρς) is introduced by the elimination. Reference:
/// det(Aς + E) expanded in 31 digits. No permutation contributes to ς³, ς⁴ and ς⁵, so this determinant is quadratic,
/// and det F is a constant times the factor times this determinant.
#[test]
fn eq_121_elimination_introduces_a_spurious_factor() {
    for_random_flows(14, |random, system| {
        let wave = random_wave(random);
        let exact = system.dispersion_polynomial(wave);
        assert_eq!(exact.len(), 3, "det(Aς + E) has degree 2");
        let own = Elimination::new(&system, wave);
        let quintic = polynomial_determinant(&own.reduced_matrix(system.inertia()));
        assert_eq!(quintic.len(), 6, "det F is a quintic");

        let zero = Complex::default();
        let spurious = [zero, zero, own.f, own.g * own.density];
        let expected = multiply_polynomials(&spurious, &exact);
        // Both polynomials are equal up to a constant factor (from the scaling of the momentum rows, ρ² and signs).
        let factor = quintic[5] / expected[5];
        for (degree, (&q, &x)) in quintic.iter().zip(&expected).enumerate() {
            let size = quintic.iter().map(|c| c.abs()).fold(0.0, f64::max);
            assert!((q - factor * x).abs() <= 1e-20 * size, "coefficient of ς^{degree}");
        }
        // The determinant of the crate's linearised system has the same degree.
        let model = states::build_model(registry::HARRIS_GREKOVA, &system.parameters);
        let own = states::assemble_symbol(&model, &system.flow);
        assert_eq!(states::dispersion_polynomial(&own, wave).len(), 3);
    });
}

/// Eq. (131): the root −f/(gρ) of the cubic is not a root of the system, nor is the "neutral" ς = 0 of the text before
/// the equation: the determinant does not vanish there.
#[test]
fn eq_131_printed_roots_are_not_roots() {
    for_random_flows(15, |random, system| {
        let wave = random_wave(random);
        let exact = system.dispersion_polynomial(wave);
        let own = Elimination::new(&system, wave);
        let claimed = -(own.f / (own.g * own.density));
        let cubic = polynomial_determinant(&own.reduced_matrix(system.inertia()));
        let relative = |polynomial: &[Complex], x: Complex| {
            let size: f64 =
                polynomial.iter().enumerate().map(|(n, c)| c.abs() * x.abs().powi(n as i32)).sum();
            evaluate_polynomial(polynomial, x).abs() / size
        };
        assert!(relative(&cubic[2..], claimed) < 1e-20, "a root of the printed cubic");
        assert!(relative(&exact, claimed) > 1e-6, "but not of the system");
        assert!(relative(&exact, 0.0.into()) > 1e-9, "ς = 0 is no root");
        for root in quadratic_roots(&exact) {
            assert!(relative(&exact, root) < 1e-25);
            assert!(relative(&cubic, root) < 1e-18, "the system's roots are among the quintic's");
        }
    });
}
