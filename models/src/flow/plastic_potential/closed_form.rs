//! Closed-form growth rate of short waves in the plastic-potential model.

use super::parameters::PlasticPotential;
use crate::common::elementary::Elementary;
use crate::common::rounding::Rounded;
use crate::flow::closed_form::{ClosedForm, is_below_right_angle, is_of_moderate_size};
use crate::flow::state::Flow;

/// Smallest |φ − ν|, rad, at which the formula decides. The leading growth rate is of order (φ − ν)²; closer to the
/// associated flow rule the numerical analysis does not resolve it to ten digits.
const THINNEST: f64 = 1e-3;

/// Returns growth of order 2 (ill-posed) in every background; `None` if the flow rule is nearly associated, φ or ν too
/// close to a right angle, or a number of `flow` too close to overflow or underflow.
///
/// To leading order in k, with ς of order k², the gradients of the background and the density perturbation drop out.
/// The growth is largest in the direction of [`PlasticPotential::worst`],
/// `cos β = sin h/cos d` with h = (φ + ν)/2 and d = (φ − ν)/2, so `sin²β = cos φ cos ν/cos²d`; it is the same for ±β.
pub fn closed_form(model: &PlasticPotential, flow: &Flow) -> Option<ClosedForm> {
    let (phi, nu) = (model.coulomb.friction_angle, model.dilatancy_angle);
    let decides = (phi - nu).abs() >= THINNEST
        && is_below_right_angle(phi)
        && is_below_right_angle(nu)
        && is_of_moderate_size(flow);
    if !decides {
        return None;
    }
    let half_difference = 0.5 * (Rounded::angle(phi) - Rounded::angle(nu));
    let tangent = half_difference.sin() / half_difference.cos();
    let coefficient = flow.stress.deviator * tangent * tangent
        / (2.0 * Rounded::given(flow.density) * Rounded::given(flow.shear_rate));
    let beta = (phi.cr_cos() * nu.cr_cos()).sqrt().cr_atan2((0.5 * (phi + nu)).cr_sin());
    ClosedForm::grows(2, coefficient, flow, beta)
}
