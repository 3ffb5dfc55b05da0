//! Closed-form verdicts on well-posedness.
//!
//! For some models and backgrounds the growth rate Re ς of short waves exp(ςt + ik·x) is known in closed form. A
//! formula decides only if its result is certain: the rounding bound of every quantity whose sign or value decides must
//! be far below the quantity itself, and all numbers must be far from overflow and underflow. Otherwise the formula
//! returns `None` and the linearised equations are analysed numerically. So a formula never returns *marginal* and
//! never decides near a stability boundary.

use crate::common::elementary::Elementary;
use crate::common::rounding::Rounded;
use crate::flow::state::DeformingFlow;
use std::f64::consts::PI;

/// Closed-form verdict on the growth of short waves, in the categories of the numerical analysis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosedFormVerdict {
    /// Well-posed: the growth rate is bounded uniformly over all wave vectors.
    WellPosed,
    /// Ill-posed: the growth rate is Re ς ≈ `coefficient` k^`order` in the direction of fastest growth.
    PowerLawGrowth {
        /// Exponent of the wave number k.
        order: u8,
        /// Limit of Re ς / k^order, m^order/s; positive.
        coefficient: f64,
        /// Angle of the wave vector with the largest growth, rad, in [0, π); one of them if several grow equally.
        direction: f64,
    },
    /// Ill-posed: the coefficient of the highest power of ς in the dispersion polynomial changes sign with the
    /// direction, so the growth rate is unbounded at finite wave numbers.
    UnboundedAtFiniteWaveNumber {
        /// Angle of a wave vector with unbounded growth, rad, in [0, π); one of them if there are several.
        direction: f64,
    },
    /// The matrix pencil ςA + i k·B + C of the linearised equations is singular: they do not determine their unknowns.
    Indeterminate {
        /// Rank of the pencil for generic ς and k.
        rank: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

/// Largest relative rounding bound at which a formula decides: ten correct digits, so that independent evaluations of
/// a coefficient agree to 1e-9.
const MAX_RELATIVE_BOUND: f64 = 1e-10;

/// Range of magnitudes whose products of a few factors are far from overflow and underflow.
const SAFE_MAGNITUDES: std::ops::Range<f64> = 1e-30..1e30;

/// Smallest cosine of a friction or dilatancy angle at which a formula decides: 0.57° from a right angle. As φ → 90°
/// the degenerate directions β = ±(90° − φ) merge with each other and with the direction in which the coefficient of
/// the highest power of ς has its minimum, and this minimum vanishes at least like 1 − sin φ: the numerical analysis no
/// longer separates these directions to ten digits.
const MIN_COSINE: f64 = 1e-2;

impl ClosedFormVerdict {
    /// Growth of order `order` with `coefficient` (m^order/s); `None` unless the coefficient is positive and finite and
    /// ten of its digits are certain.
    /// `beta` is β = 2(Ψ_Σ − ψ_K), rad, in the direction of largest growth, with the stress angle Ψ_Σ and the angle ψ_K
    /// of the wave vector.
    pub(crate) fn from_growth(
        order: u8,
        coefficient: Rounded,
        flow: &DeformingFlow,
        beta: f64,
    ) -> Option<Self> {
        let is_resolved = resolved_sign(coefficient) == Some(1) && coefficient.value.is_finite();
        let direction = wave_vector_angle(flow, beta);
        is_resolved.then_some(Self::PowerLawGrowth {
            order,
            coefficient: coefficient.value,
            direction,
        })
    }

    /// Unbounded growth at finite wave numbers in the direction with β = 2(Ψ_Σ − ψ_K) = `beta`, rad.
    pub(crate) fn from_unbounded_growth(flow: &DeformingFlow, beta: f64) -> Self {
        Self::UnboundedAtFiniteWaveNumber { direction: wave_vector_angle(flow, beta) }
    }
}

/// Computes the angle ψ_K of the wave vector, rad, in [0, π), from β = 2(Ψ_Σ − ψ_K) = `beta` with the stress angle Ψ_Σ
/// of `flow`.
fn wave_vector_angle(flow: &DeformingFlow, beta: f64) -> f64 {
    let angle = (flow.stress.angle - 0.5 * beta).rem_euclid(PI);
    // rem_euclid rounds a tiny negative angle up to π itself.
    if angle < PI { angle } else { 0.0 }
}

/// Sign ±1 of a quantity whose first ten digits are certain, else `None`.
pub(crate) fn resolved_sign(x: Rounded) -> Option<i8> {
    (x.bound < MAX_RELATIVE_BOUND * x.value.abs()).then_some(if x.value > 0.0 { 1 } else { -1 })
}

/// Whether the cosine of a friction or dilatancy angle (rad) is at least [`MIN_COSINE`]: closer to 90° the verdict in
/// closed form is not reliable.
pub(crate) fn is_below_right_angle(angle: f64) -> bool {
    angle.cr_cos() >= MIN_COSINE
}

/// Whether density, stresses, rates, velocity, acceleration and gradients of a flow are each zero or of a magnitude in
/// [`SAFE_MAGNITUDES`].
pub(crate) fn has_safe_magnitudes(flow: &DeformingFlow) -> bool {
    let [[g11, g12], [g21, g22]] = flow.velocity_gradient;
    let single = [
        flow.density,
        flow.stress.pressure,
        flow.stress.deviator.value,
        flow.stress.rotational_stress,
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
    let is_safe = |x: f64| x == 0.0 || SAFE_MAGNITUDES.contains(&x.abs());
    single.into_iter().all(is_safe) && gradients.as_flattened().iter().copied().all(is_safe)
}
