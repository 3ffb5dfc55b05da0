//! Closed-form growth rate of short waves in the Harris–Grekova model.

use super::parameters::HarrisGrekova;
use crate::common::elementary::Elementary;
use crate::common::rounding::Rounded;
use crate::common::scalar::{Function, Scalar};
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::{
    ClosedFormVerdict, has_safe_magnitudes, is_below_right_angle, resolved_sign,
};
use crate::flow::state::DeformingFlow;
use std::f64::consts::PI;

/// Returns the verdict for ν = 0 in every background and for ν > 0 in a uniform, unaccelerated background without
/// rotational stress; otherwise `None`. Also `None` if the verdict is not certain: φ too close to a right angle,
/// numbers too close to overflow or underflow, or fewer than ten certain digits of a deciding quantity.
pub fn closed_form_verdict(
    model: &HarrisGrekova,
    flow: &DeformingFlow,
) -> Option<ClosedFormVerdict> {
    let is_decidable = is_below_right_angle(model.coulomb.friction_angle)
        && has_safe_magnitudes(flow)
        && (1e-30..1e30).contains(&model.moment_of_inertia);
    if !is_decidable {
        None
    } else if model.dilatancy_angle == 0.0 {
        assess_without_dilatancy(model, flow)
    } else if is_uniform(flow) && flow.stress.rotational_stress == 0.0 {
        assess_with_dilatancy(model, flow)
    } else {
        None
    }
}

/// Returns the verdict for ν = 0 and any gradients and accelerations of the background (Harris & Grekova 2005,
/// eqs 149–152, corrected).
///
/// The dispersion polynomial is a quadratic in ς. Its leading root is [`HarrisGrekova::growth_coefficient`] k²; its
/// other root, and both roots in the layers of directions around 𝒜 = cos β − sin φ = 0, are −ik·V + O(1). So the model
/// is well-posed for cos 2Δ > 0. For cos 2Δ < 0 the coefficient as a function of cos β has one minimum, 0 at
/// cos β = sin φ, and its maximum at β = π: (cos β − sin φ)²/(1 − sin φ cos β) is 1 + sin φ at β = π and 1 − sin φ at
/// β = 0. Then in the direction β = π
///
/// ```text
/// Re ς/k² → q (1 + sin φ) / (2 ρ Q_D |cos 2Δ|)
/// ```
fn assess_without_dilatancy(
    model: &HarrisGrekova,
    flow: &DeformingFlow,
) -> Option<ClosedFormVerdict> {
    let cosine = (2.0 * flow.rounded_noncoaxiality()).cos();
    if resolved_sign(cosine)? > 0 {
        return Some(ClosedFormVerdict::WellPosed);
    }
    let sin_phi = Rounded::from_angle(model.coulomb.friction_angle).sin();
    let rates =
        Rounded::from_rounded(flow.density) * Rounded::from_rounded(flow.shear_rate) * -cosine;
    let coefficient = flow.stress.deviator * (Rounded::ONE + sin_phi) / (2.0 * rates);
    ClosedFormVerdict::from_growth(2, coefficient, flow, PI)
}

/// Returns the verdict for ν > 0 in a uniform, unaccelerated background without rotational stress.
///
/// In the notation of [the double-shearing model](crate::flow::double_shearing::closed_form), the spin
/// decouples, ς is of order k², and
///
/// ```text
/// ς ≈ −k² q cos(φ − 2ν) 𝒜² / (2 ρ Q_D D),
/// D = cos ν cos 2Δ [cos e + sin ν sin φ − (cos e sin φ + sin ν) cos β]
///     + sin ν cos φ cos e sin 2Δ sin β.
/// ```
///
/// D = a − b cos β + d sin β has the same sign in all directions if a² > b² + d², that is
///
/// ```text
/// cos²ν cos φ cos(φ − 2ν) cos²2Δ > sin²ν cos²e sin²2Δ
/// ```
///
/// ([`HarrisGrekova::noncoaxiality_bound`]). Then the model is well-posed for cos 2Δ > 0 and ill-posed for
/// cos 2Δ < 0, where the largest coefficient is the root of a quartic: the function returns `None` and the
/// linearised equations are analysed numerically. If the inequality fails, D vanishes in two directions and changes
/// sign there.
fn assess_with_dilatancy(model: &HarrisGrekova, flow: &DeformingFlow) -> Option<ClosedFormVerdict> {
    let phi = Rounded::from_angle(model.coulomb.friction_angle);
    let nu = Rounded::from_angle(model.dilatancy_angle);
    let twice_delta = 2.0 * flow.rounded_noncoaxiality();
    if resolved_sign(ellipticity(phi, nu, twice_delta))? > 0 {
        return (resolved_sign(twice_delta.cos())? > 0).then_some(ClosedFormVerdict::WellPosed);
    }
    let rule = model.flow_rule();
    let (cos_e, sin_nu) = (rule.volume_coefficient, rule.dilatancy_coefficient);
    let (sin_phi, cos_phi) = (phi.sin(), phi.cos());
    let cosine_term = rule.shear_coefficient * twice_delta.cos();
    let sine_term = sin_nu * cos_e * twice_delta.sin();
    // Of the two solutions β of b cos β − d sin β = a the one with the larger |𝒜| is taken: the other may be at 𝒜 = 0,
    // where ς has no pole.
    let a = (cosine_term * (cos_e + sin_nu * sin_phi)).value;
    let b = (cosine_term * (cos_e * sin_phi + sin_nu)).value;
    let d = (sine_term * cos_phi).value;
    let (shift, half_angle) = (d.cr_atan2(b), (a / b.root_sum_square(d)).cr_acos());
    let distance = |beta: f64| (beta.cr_cos() - sin_phi.value).abs();
    let (first, second) = (half_angle - shift, -half_angle - shift);
    let beta = if distance(first) >= distance(second) { first } else { second };
    Some(ClosedFormVerdict::from_unbounded_growth(flow, beta))
}

/// a² − b² − d² but for a positive factor, with the coefficients of [`assess_with_dilatancy`]: the expression
/// cos²ν cos φ cos(φ − 2ν) cos²2Δ − sin²ν cos²e sin²2Δ with e = φ − ν.
fn ellipticity<T: Scalar>(phi: T, nu: T, twice_delta: T) -> T {
    let (cos, sin) = (|x: T| x.apply(Function::Cos), |x: T| x.apply(Function::Sin));
    let cosine_term = cos(nu) * cos(twice_delta);
    let sine_term = sin(nu) * cos(phi - nu) * sin(twice_delta);
    cos(phi) * cos(phi - (nu + nu)) * cosine_term * cosine_term - sine_term * sine_term
}

/// Conditions for well-posedness over a box: cos 2Δ, and for ν > 0 in a uniform background without rotational stress also
/// the ellipticity of D in closed form.
///
/// That a negative one of them suffices for ill-posedness, whatever the other: with D = a − b cos β + d sin β as in
/// the verdict at a point, a has the sign of cos 2Δ. If cos 2Δ < 0, D is negative in some directions, and there
/// Re ς ~ k², but for the two in which 𝒜 vanishes. If the ellipticity is negative, D changes its sign.
pub fn box_conditions(
    flow: &DeformingFlow,
    constants: &[TaylorModel],
    noncoaxiality: TaylorModel,
) -> Option<Vec<(&'static str, TaylorModel)>> {
    let &[phi, nu, _, _, strength] = constants else { return None };
    let twice_delta = noncoaxiality + noncoaxiality;
    let cosine = twice_delta.apply(Function::Cos);
    if nu.is_structural_zero() {
        return Some(vec![("cos 2Δ", cosine)]);
    }
    let has_no_stress = strength.is_structural_zero() && flow.stress.rotational_stress == 0.0;
    let bound = ellipticity(phi, nu, twice_delta);
    (is_uniform(flow) && has_no_stress).then(|| vec![("cos 2Δ", cosine), ("ellipticity", bound)])
}

/// Whether the rate of the moment of inertia and all gradients except the velocity gradient are zero. Then DV/Dt = F by
/// the balance of momentum.
fn is_uniform(flow: &DeformingFlow) -> bool {
    let gradients = [
        flow.pressure_gradient,
        flow.stress_angle_gradient,
        flow.spin_gradient,
        flow.density_gradient,
        flow.inertia_gradient,
    ];
    flow.inertia_rate == 0.0 && gradients.as_flattened().iter().all(|&x| x == 0.0)
}
