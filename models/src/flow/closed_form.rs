//! Verdicts that follow from a formula.
//!
//! For some models and backgrounds the growth of short waves is known in closed form. A formula is
//! used only where rounding leaves no doubt of what it says: every quantity that it rests on carries
//! a rounding bound, and where that is not far below the quantity itself, or the numbers approach
//! the range of doubles, the formula says nothing and the linearised equations have to be looked
//! at. So a formula never says *marginal*, and never decides beside a boundary.

use crate::common::elementary::Elementary;
use crate::common::rounding::Rounded;
use crate::flow::state::Flow;
use std::f64::consts::PI;

/// Growth of short waves as a formula gives it; the terms are those of the analysis of a linearised
/// system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosedForm {
    /// The growth rate is bounded uniformly over short waves of all directions.
    WellPosed,
    /// Re ς ≈ `coefficient` k^`order` in the worst direction.
    Grows {
        /// Order in k.
        order: u8,
        /// Limit of Re ς / k^order, m^order/s; positive.
        coefficient: f64,
        /// Angle of the wave vector, rad, in [0, π); one of them where several are equally bad.
        direction: f64,
    },
    /// The coefficient of the highest power of ς changes sign in a direction, so that the growth
    /// rate is unbounded at finite wave numbers already.
    UnboundedAtFiniteWaveNumber {
        /// Angle of the wave vector, rad, in [0, π); one of them where there are several.
        direction: f64,
    },
    /// The equations do not determine their unknowns.
    Indeterminate {
        /// Generic rank of the pencil.
        rank: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

/// Largest rounding bound of a quantity that a formula rests on, relative to the quantity: ten
/// digits stand, and every coefficient agrees with another correct one to 1e-9.
const RESOLUTION: f64 = 1e-10;

/// Sizes between which the products of a few numbers stay far inside the range of doubles.
const SIZES: std::ops::Range<f64> = 1e-30..1e30;

/// Least cosine of an angle of friction or dilatancy: 0.57° from a right angle. As φ → 90° the
/// degenerate directions β = ±(90° − φ) merge with each other and with the one in which the highest
/// coefficient is least, (1 − sin φ)² or smaller: the linearised equations themselves no longer
/// know them apart to ten digits, and soon not at all.
const LEAST_COSINE: f64 = 1e-2;

impl ClosedForm {
    /// Growth of this order with this coefficient, if rounding leaves ten digits of it; `beta` is
    /// β = 2(Ψ_Σ − ψ_K) in the worst direction.
    pub(crate) fn grows(order: u8, coefficient: Rounded, flow: &Flow, beta: f64) -> Option<Self> {
        let is_clear = clear_sign(coefficient) == Some(1) && coefficient.value.is_finite();
        let direction = direction(flow, beta);
        is_clear.then_some(Self::Grows { order, coefficient: coefficient.value, direction })
    }

    /// Growth that is unbounded at finite wave numbers, in the direction of `beta`.
    pub(crate) fn unbounded(flow: &Flow, beta: f64) -> Self {
        Self::UnboundedAtFiniteWaveNumber { direction: direction(flow, beta) }
    }
}

/// Angle of the wave vector with β = 2(Ψ_Σ − ψ_K), rad, in [0, π).
fn direction(flow: &Flow, beta: f64) -> f64 {
    let angle = (flow.stress.angle - 0.5 * beta).rem_euclid(PI);
    // A negative angle of rounding size becomes π itself.
    if angle < PI { angle } else { 0.0 }
}

/// The sign of a quantity, where ten digits of it stand: 1 or −1.
pub(crate) fn clear_sign(x: Rounded) -> Option<i8> {
    (x.bound < RESOLUTION * x.value.abs()).then_some(if x.value > 0.0 { 1 } else { -1 })
}

/// Whether an angle of friction or dilatancy (rad) is clear of a right angle.
pub(crate) fn is_below_right_angle(angle: f64) -> bool {
    angle.cr_cos() >= LEAST_COSINE
}

/// Whether all numbers of a flow are zero or of a size of which products can be formed.
pub(crate) fn is_of_moderate_size(flow: &Flow) -> bool {
    let [[g11, g12], [g21, g22]] = flow.velocity_gradient;
    let single = [
        flow.density,
        flow.stress.pressure,
        flow.stress.deviator.value,
        flow.stress.rotational,
        flow.shear_rate,
        flow.half_vorticity,
        flow.spin.unwrap_or_default().value,
        flow.inertia_rate,
        flow.acceleration[0].value,
        flow.acceleration[1].value,
    ];
    let gradients = [
        [g11.value, g12.value],
        [g21.value, g22.value],
        flow.velocity,
        flow.pressure_gradient,
        flow.stress_angle_gradient,
        flow.spin_gradient,
        flow.density_gradient,
        flow.inertia_gradient,
    ];
    let is_moderate = |x: f64| x == 0.0 || SIZES.contains(&x.abs());
    single.into_iter().all(is_moderate) && gradients.as_flattened().iter().copied().all(is_moderate)
}
