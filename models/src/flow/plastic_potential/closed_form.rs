//! Closed-form growth rate of short waves in the plastic-potential model.

use super::parameters::PlasticPotential;
use crate::common::elementary::Elementary;
use crate::common::rounding::Rounded;
use crate::common::scalar::{Function, Scalar};
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::{ClosedFormVerdict, has_safe_magnitudes, is_below_right_angle};
use crate::flow::state::DeformingFlow;

/// Smallest |φ − ν|, rad, at which the formula decides. The leading growth rate is of order (φ − ν)²; closer to the
/// associated flow rule the numerical analysis does not resolve it to ten digits.
const MIN_ANGLE_DIFFERENCE: f64 = 1e-3;

/// Returns growth of order 2 (ill-posed) in every background; `None` if the flow rule is nearly associated, φ or ν too
/// close to a right angle, or a number of `flow` too close to overflow or underflow.
///
/// To leading order in the wave number k, with ς of order k², the gradients of the background and the density
/// perturbation drop out. The growth is largest in the direction of [`PlasticPotential::fastest_growth`],
/// `cos β = sin h/cos d` with h = (φ + ν)/2 and d = (φ − ν)/2, so `sin²β = cos φ cos ν/cos²d`; it is the same for ±β.
pub fn closed_form_verdict(
    model: &PlasticPotential,
    flow: &DeformingFlow,
) -> Option<ClosedFormVerdict> {
    let (phi, nu) = (model.coulomb.friction_angle, model.dilatancy_angle);
    let is_decidable = (phi - nu).abs() >= MIN_ANGLE_DIFFERENCE
        && is_below_right_angle(phi)
        && is_below_right_angle(nu)
        && has_safe_magnitudes(flow);
    if !is_decidable {
        return None;
    }
    let half_difference = 0.5 * (Rounded::from_angle(phi) - Rounded::from_angle(nu));
    let tangent = half_difference.sin() / half_difference.cos();
    let coefficient = flow.stress.deviator * tangent * tangent
        / (2.0 * Rounded::from_rounded(flow.density) * Rounded::from_rounded(flow.shear_rate));
    let beta = (phi.cr_cos() * nu.cr_cos()).sqrt().cr_atan2((0.5 * (phi + nu)).cr_sin());
    ClosedFormVerdict::from_growth(2, coefficient, flow, beta)
}

/// Conditions for well-posedness over a box: −|φ − ν|, negative but for associated flow. With cos β between sin ν and sin φ
/// the growth coefficient is positive.
pub fn box_conditions(constants: &[TaylorModel]) -> Option<Vec<(&'static str, TaylorModel)>> {
    let &[phi, nu, ..] = constants else { return None };
    Some(vec![("−|φ − ν|", -(phi - nu).apply(Function::Abs))])
}
