//! Closed-form growth rate of short waves in the double-shearing model (Spencer 1964; Mehrabadi & Cowin 1978).

use super::parameters::DoubleShearing;
use crate::common::rounding::Rounded;
use crate::common::scalar::{Function, Scalar};
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::{ClosedFormVerdict, has_safe_magnitudes, is_below_right_angle};
use crate::flow::state::DeformingFlow;

/// Returns growth of order 1 (ill-posed) in every background; `None` if φ is too close to a right angle, a number of
/// `flow` too close to overflow or underflow, or ten digits of the coefficient are not certain, as for ν close to φ.
///
/// With the friction angle φ, the dilatancy angle ν, e = φ − ν, β = 2(Ψ_Σ − ψ_K) (stress angle Ψ_Σ, angle ψ_K of the
/// wave vector **k**) and 𝒜 = cos β − sin φ, let n be the unit vector at the angle β from ξ = **k**/k; n⊥ and ξ⊥ are n
/// and ξ rotated by a right angle. To leading order in k, with ς of order k, the gradients and rates of the
/// background and the density perturbation drop out; the equations of momentum, volume and rotation become
///
/// ```text
/// ρς v + ik (G p + H ψ) = 0,   ik N·v = 0,   ik L·v + 2 sin e ς ψ = 0,
/// G = ξ − sin φ n,   H = −2q n⊥,   N = cos e ξ − sin ν n,   L = −sin e ξ⊥ + cos ν n⊥.
/// ```
///
/// Elimination of v and p gives `ς² = −k² (L×N)(H×G) / (2ρ sin e N·G)` with `H×G = 2q𝒜`,
/// `L×N = −cos(φ − 2ν) 𝒜` and `N·G = cos e + sin ν sin φ − (cos e sin φ + sin ν) cos β > 0`:
///
/// ```text
/// ς = ±k |𝒜| √(q cos(φ − 2ν) / {ρ sin e [cos e + sin ν sin φ − (cos e sin φ + sin ν) cos β]})
/// ```
///
/// As a function of cos β, ς² has one minimum, 0 at cos β = sin φ, so its maximum is at an end of [−1, 1]; it is larger
/// at β = π than at β = 0 because `sin φ cos e − sin ν = cos φ sin e > 0`. At β = π
///
/// ```text
/// Re ς/k → √(q cos(φ − 2ν) (1 + sin φ) / [ρ sin e (cos e + sin ν)]).
/// ```
pub fn closed_form_verdict(
    model: &DoubleShearing,
    flow: &DeformingFlow,
) -> Option<ClosedFormVerdict> {
    if !is_below_right_angle(model.coulomb.friction_angle) || !has_safe_magnitudes(flow) {
        return None;
    }
    let coefficient = max_growth_coefficient(model, flow.stress.deviator, flow.density);
    ClosedFormVerdict::from_growth(1, coefficient, flow, std::f64::consts::PI)
}

/// Computes the limit of Re ς/k as k → ∞ in the direction of largest growth, m/s; `deviator` q in Pa, `density` in
/// kg/m³.
pub fn max_growth_coefficient(model: &DoubleShearing, deviator: Rounded, density: f64) -> Rounded {
    let rule = model.flow_rule();
    let phi = Rounded::from_angle(model.coulomb.friction_angle);
    let nu = Rounded::from_angle(model.dilatancy_angle);
    let numerator = deviator * (phi - 2.0 * nu).cos() * (Rounded::ONE + phi.sin());
    let denominator = Rounded::from_rounded(density)
        * rule.rotation_coefficient
        * (rule.volume_coefficient + rule.dilatancy_coefficient);
    (numerator / denominator).sqrt()
}

/// Conditions for well-posedness over a box: −cos(φ − 2ν)/(sin e [cos e + sin ν]) with e = φ − ν, always negative: the
/// square of [`max_growth_coefficient`] is a positive multiple of its magnitude.
pub fn box_conditions(constants: &[TaylorModel]) -> Option<Vec<(&'static str, TaylorModel)>> {
    let &[phi, nu, ..] = constants else { return None };
    let (cos, sin) =
        (|x: TaylorModel| x.apply(Function::Cos), |x: TaylorModel| x.apply(Function::Sin));
    let difference = phi - nu;
    let divisor = sin(difference) * (cos(difference) + sin(nu));
    let condition = -(cos(difference - nu) / divisor);
    Some(vec![("−cos(φ − 2ν)/(sin(φ − ν) (cos(φ − ν) + sin ν))", condition)])
}
