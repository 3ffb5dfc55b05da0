//! History variables of a face of a layer: layout and compensated sums.
//!
//! All are zero in a face at rest before the first step. Times are ends of steps and positive, so a time of 0 means
//! "not yet". The first six are common to all layers; the others depend on the law.

use super::opening_line::{INERTIA_VARIABLES, initial_inertia};
use crate::common::number::Number;

/// V₁, d₁: normal velocity and opening rate, m/s.
pub const NORMAL_INERTIA: usize = 0;
/// Normal traction S_n, Pa, or strain ε of a porous, saturated or cracked layer.
pub const NORMAL_STATE: usize = 2;
/// V₂, d₂: tangential velocity and its jump, m/s.
pub const SHEAR_INERTIA: usize = 3;
/// Tangential traction S_t, Pa.
pub const SHEAR_STRESS: usize = 5;

/// Slip χ of an elastic-plastic, cracked or breaking layer, m.
pub const SLIP: usize = 6;
/// Time of first slip, s.
pub const SLIP_TIME: usize = 7;
/// Plastic dissipation, J/m²: compensated sum.
pub const PLASTIC: usize = 8;
/// Shear energy released by a cracked or broken layer, J/m²: compensated sum.
pub const RELEASED: usize = 10;
/// Time of fracture of a breaking layer, s.
pub const FRACTURE_TIME: usize = 12;
/// Energy lost at fracture of a breaking layer, J/m²: compensated sum.
pub const FRACTURE: usize = 13;

/// Traction s of the delayed spring of a viscous or saturated layer, Pa.
pub const DELAYED_STRESS: usize = 6;
/// Viscous dissipation, J/m²: compensated sum.
pub const VISCOUS: usize = 7;
/// Velocity w of the fluid along a saturated layer, m/s.
pub const FLUID_VELOCITY: usize = 9;
/// Strain D of the fluid along a saturated layer, the time integral of w,₁.
pub const FLUID_STRAIN: usize = 10;
/// Numerical dissipation of the fluid in a saturated layer, J/m²: compensated sum.
pub const FLUID_DISSIPATION: usize = 11;

/// Largest number of history variables of a layer.
pub const MAX_HISTORY_VARIABLES: usize = 15;

/// Adds `term` to the compensated sum of two variables from index `sum` on (sum and sum of rounding errors; error of
/// an addition after Knuth 1969), so that small terms count in single precision too.
#[inline(always)]
pub fn accumulate<N: Number>(history: &mut [N], sum: usize, term: N) {
    let old = history[sum];
    let total = old + term;
    let added = total - old;
    let error = (old - (total - added)) + (term - added);
    history[sum] = total;
    history[sum + 1] = history[sum + 1] + error;
}

/// Value of the compensated sum at index `sum`.
#[inline(always)]
pub fn sum_value<N: Number>(history: &[N], sum: usize) -> N {
    history[sum] + history[sum + 1]
}

/// Sets all history variables to those of a stress-free face at rest relative to the layer, from the velocities of both
/// sides by component, m/s.
pub fn initialise<N: Number>(velocities: &[[N; 2]; 2], history: &mut [N]) {
    history.fill(N::ZERO);
    for (start, velocities) in [NORMAL_INERTIA, SHEAR_INERTIA].into_iter().zip(velocities) {
        set_inertia(history, start, initial_inertia(*velocities));
    }
}

/// V and d at index `start`.
#[inline(always)]
pub(super) fn inertia<N: Number>(history: &[N], start: usize) -> [N; INERTIA_VARIABLES] {
    [history[start], history[start + 1]]
}

/// Sets V and d at index `start`.
#[inline(always)]
pub(super) fn set_inertia<N: Number>(
    history: &mut [N],
    start: usize,
    [velocity, opening_rate]: [N; INERTIA_VARIABLES],
) {
    history[start] = velocity;
    history[start + 1] = opening_rate;
}

/// Records `end` as the time at index `time` if it is not yet set and `event` > 0.
#[inline(always)]
pub(super) fn record_time<N: Number>(history: &mut [N], time: usize, event: N, end: N) {
    let old = history[time];
    let set = old.select_gt(N::ZERO, old, end);
    history[time] = event.select_gt(N::ZERO, set, old);
}
