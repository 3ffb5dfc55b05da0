//! Closed-form growth rate of short waves in the double-shearing model (Spencer 1964; Mehrabadi & Cowin 1978).

use super::parameters::DoubleShearing;
use crate::common::rounding::Rounded;
use crate::flow::closed_form::{ClosedForm, is_below_right_angle, is_of_moderate_size};
use crate::flow::state::Flow;

/// Ill-posed with growth of order 1 in every background.
///
/// With e = φ − ν, β = 2(Ψ_Σ − ψ_K) and 𝒜 = cos β − sin φ, let n be the unit vector at the angle β
/// from ξ = k/k, and n⊥ its turn by a right angle. To leading order in k, where ς is of order k and
/// all gradients of the background, the rates and the density drop out, momentum, volume and
/// rotation read
///
/// ```text
/// ρς v + ik (G p + H ψ) = 0,   ik N·v = 0,   ik L·v + 2 sin e ς ψ = 0,
/// G = ξ − sin φ n,   H = −2q n⊥,   N = cos e ξ − sin ν n,   L = −sin e ξ⊥ + cos ν n⊥.
/// ```
///
/// Eliminating v and p leaves `ς² = −k² (L×N)(H×G) / (2ρ sin e N·G)` with `H×G = 2q𝒜`,
/// `L×N = −cos(φ − 2ν) 𝒜` and `N·G = cos e + sin ν sin φ − (cos e sin φ + sin ν) cos β > 0`:
///
/// ```text
/// ς = ±k |𝒜| √(q cos(φ − 2ν) / {ρ sin e [cos e + sin ν sin φ − (cos e sin φ + sin ν) cos β]})
/// ```
///
/// As a function of cos β the square has one minimum, 0 at cos β = sin φ, so it is greatest at an
/// end; β = π beats β = 0 because `sin φ cos e − sin ν = cos φ sin e > 0`. There
///
/// ```text
/// Re ς/k → √(q cos(φ − 2ν) (1 + sin φ) / [ρ sin e (cos e + sin ν)]).
/// ```
pub fn closed_form(model: &DoubleShearing, flow: &Flow) -> Option<ClosedForm> {
    if !is_below_right_angle(model.coulomb.friction_angle) || !is_of_moderate_size(flow) {
        return None;
    }
    let coefficient = greatest_coefficient(model, flow.stress.deviator, flow.density);
    ClosedForm::grows(1, coefficient, flow, std::f64::consts::PI)
}

/// The limit of Re ς/k in the worst direction, m/s; `deviator` q in Pa, `density` in kg/m³.
pub fn greatest_coefficient(model: &DoubleShearing, deviator: Rounded, density: f64) -> Rounded {
    let rule = model.flow_rule();
    let phi = Rounded::angle(model.coulomb.friction_angle);
    let nu = Rounded::angle(model.dilatancy_angle);
    let above = deviator * (phi - 2.0 * nu).cos() * (Rounded::ONE + phi.sin());
    let below = Rounded::given(density) * rule.rotation * (rule.volume + rule.dilatancy);
    (above / below).sqrt()
}
