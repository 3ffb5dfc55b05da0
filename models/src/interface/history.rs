//! History variables of a face of a layer: layout and compensated sums.
//!
//! All are zero in a face at rest before the first step. Times are ends of steps and positive, so a time of 0 means
//! "not yet". The first six are common to all layers; the others depend on the law.

use super::opening_line::{MOTION_VARIABLE_COUNT, initial_motion};
use crate::common::number::Number;

/// Index of the mean normal velocity V₁; the next variable is the opening rate d₁, m/s.
pub const NORMAL_MOTION: usize = 0;
/// Index of the normal traction S_n, Pa, or of the strain ε of a porous, saturated or cracked layer.
pub const NORMAL_STATE: usize = 2;
/// Index of the mean tangential velocity V₂; the next variable is the velocity jump d₂, m/s.
pub const SHEAR_MOTION: usize = 3;
/// Index of the tangential traction S_t, Pa.
pub const SHEAR_STRESS: usize = 5;

/// Index of the slip χ of an elastic-plastic, cracked or breaking layer, m.
pub const SLIP: usize = 6;
/// Index of the time of first slip, s; 0 before.
pub const SLIP_TIME: usize = 7;
/// Index of the plastic dissipation, J/m², a compensated sum of two variables.
pub const PLASTIC_DISSIPATION: usize = 8;
/// Index of the shear energy released by a cracked or broken layer, J/m², a compensated sum.
pub const RELEASED_ENERGY: usize = 10;
/// Index of the time of fracture of a breaking layer, s; 0 before.
pub const FRACTURE_TIME: usize = 12;
/// Index of the energy lost at fracture of a breaking layer, J/m², a compensated sum.
pub const FRACTURE_ENERGY: usize = 13;

/// Index of the traction s of the delayed spring of a viscous or saturated layer, Pa.
pub const DELAYED_STRESS: usize = 6;
/// Index of the viscous dissipation, J/m², a compensated sum.
pub const VISCOUS_DISSIPATION: usize = 7;
/// Index of the velocity w of the fluid along a saturated layer, m/s.
pub const FLUID_VELOCITY: usize = 9;
/// Index of the strain D of the fluid along a saturated layer, the time integral of w,₁.
pub const FLUID_STRAIN: usize = 10;
/// Index of the numerical dissipation of the fluid in a saturated layer, J/m², a compensated sum.
pub const FLUID_DISSIPATION: usize = 11;

/// Largest number of history variables of a layer.
pub const MAX_HISTORY_VARIABLES: usize = 15;

/// Adds `term` to the compensated sum at index `sum`: two variables, the sum and the sum of its rounding errors (error
/// of an addition after Knuth 1969). So small terms are not lost in single precision.
#[inline(always)]
pub fn accumulate<N: Number>(history: &mut [N], sum: usize, term: N) {
    let old = history[sum];
    let total = old + term;
    let added = total - old;
    let error = (old - (total - added)) + (term - added);
    history[sum] = total;
    history[sum + 1] = history[sum + 1] + error;
}

/// Returns the value of the compensated sum at index `sum`.
#[inline(always)]
pub fn sum_value<N: Number>(history: &[N], sum: usize) -> N {
    history[sum] + history[sum + 1]
}

/// Sets all history variables to those of a stress-free face at rest relative to the layer, from the velocities of both
/// sides by component, m/s.
pub fn initialise<N: Number>(velocities: &[[N; 2]; 2], history: &mut [N]) {
    history.fill(N::ZERO);
    for (start, velocities) in [NORMAL_MOTION, SHEAR_MOTION].into_iter().zip(velocities) {
        write_motion(history, start, initial_motion(*velocities));
    }
}

/// Reads the velocity V and the opening rate d, m/s, from index `start`.
#[inline(always)]
pub(super) fn read_motion<N: Number>(history: &[N], start: usize) -> [N; MOTION_VARIABLE_COUNT] {
    [history[start], history[start + 1]]
}

/// Writes the velocity V and the opening rate d, m/s, from index `start`.
#[inline(always)]
pub(super) fn write_motion<N: Number>(
    history: &mut [N],
    start: usize,
    [velocity, opening_rate]: [N; MOTION_VARIABLE_COUNT],
) {
    history[start] = velocity;
    history[start + 1] = opening_rate;
}

/// Writes the time `end`, s, at index `time` if `event` > 0 and no time was written there before.
#[inline(always)]
pub(super) fn record_time<N: Number>(history: &mut [N], time: usize, event: N, end: N) {
    let old = history[time];
    let set = old.select_gt(N::ZERO, old, end);
    history[time] = event.select_gt(N::ZERO, set, old);
}
