//! Random states of the dilatant Harris–Grekova model with given properties of the background and range of |Δ|.

use crate::support::states::{Dilatancy, Random, Sample, tame, wild};
use models::flow::state::State;
use models::registry;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use testkit::flows::Parameters;

/// Properties of a background besides a constant deformation rate, combined as flags.
pub type Parts = u8;
pub const ROTATIONAL_STRESS: Parts = 1;
pub const PRESSURE_GRADIENT: Parts = 2;
pub const STRESS_ANGLE_GRADIENT: Parts = 4;
pub const DENSITY_GRADIENT: Parts = 8;
pub const SPIN_GRADIENT: Parts = 16;
pub const INERTIA_GRADIENT: Parts = 32;
pub const UNIFORM: Parts = 0;
pub const ALL: Parts = 63;
/// Each accelerates the material, except for a set of states of measure zero.
pub const ACCELERATED: Parts = PRESSURE_GRADIENT | STRESS_ANGLE_GRADIENT;

/// Returns `state` with only the given `parts` non-zero; the rotational stress is unchanged.
pub fn with(parts: Parts, state: State) -> State {
    let gradient = |part: Parts, given: [f64; 2]| if parts & part == 0 { [0.0; 2] } else { given };
    State {
        pressure_gradient: gradient(PRESSURE_GRADIENT, state.pressure_gradient),
        stress_angle_gradient: gradient(STRESS_ANGLE_GRADIENT, state.stress_angle_gradient),
        density_gradient: gradient(DENSITY_GRADIENT, state.density_gradient),
        spin_gradient: gradient(SPIN_GRADIENT, state.spin_gradient),
        inertia_gradient: gradient(INERTIA_GRADIENT, state.inertia_gradient),
        inertia_rate: if parts & INERTIA_GRADIENT == 0 { 0.0 } else { state.inertia_rate },
        ..state
    }
}

/// Range of |Δ| in [0, 90°].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    /// Below the bound: the coefficient of the highest power of ς has one sign.
    Inside,
    /// Between the bound and 90° − bound: the coefficient changes sign.
    Outside,
    /// Above 90° − bound: the coefficient has one sign, opposite to the sign inside.
    Reversed,
}
pub use Zone::{Inside, Outside, Reversed};

/// Expected verdict on the dilatant Harris–Grekova model.
///
/// Inside, acceleration makes layers grow at order 1/2, and a rotational stress at order 2/5. Outside, growth is
/// unbounded at finite k where the coefficient of the highest power of ς vanishes. A gradient of the stress angle gives
/// that coefficient an imaginary part of lower order in k, so that it has no real zero and growth is finite, of
/// order 3. Reversed, all roots that decay inside grow.
pub fn wanted(parts: Parts, zone: Zone) -> &'static str {
    match zone {
        Inside if parts & ACCELERATED != 0 => "order 1/2",
        Inside if parts & ROTATIONAL_STRESS != 0 => "order 2/5",
        Inside => "well-posed",
        Outside if parts & STRESS_ANGLE_GRADIENT != 0 => "order 3/1",
        Outside => "unbounded at finite k",
        Reversed => "order 2/1",
    }
}

/// A sample, and the distance of its |Δ| from the bound of its zone, relative to the width of the zone (half width
/// outside).
pub struct Drawn {
    pub sample: Sample,
    pub distance: f64,
}

/// Draws a random state: four of five at log-uniform distances of 1e-9 to 0.3, the others at uniform distances.
pub fn harris_grekova(random: &mut Random, parts: Parts, zone: Zone, is_tame: bool) -> Drawn {
    let kind = registry::HARRIS_GREKOVA;
    let base = loop {
        let base = if is_tame {
            tame(random, kind, Dilatancy::Positive, true)
        } else {
            wild(random, kind, Dilatancy::Positive)
        };
        let State { pressure_gradient, inertia_gradient, .. } = base.state;
        if pressure_gradient != [0.0; 2] && inertia_gradient != [0.0; 2] {
            break base;
        }
    };
    let bound = base.model.noncoaxiality_bound().expect("the model has one");
    let distance =
        if random.chance(0.8) { random.decades(1e-9, 0.3) } else { random.within(1e-9, 1.0) };
    let size = match zone {
        Inside => bound * (1.0 - distance),
        Outside => {
            let size = bound + distance * (FRAC_PI_4 - bound);
            if random.chance(0.5) { size } else { FRAC_PI_2 - size }
        }
        Reversed => FRAC_PI_2 - bound * (1.0 - distance),
    };
    let strength = base.state.pressure * random.within(0.1, 1.0);
    let (strength, rotational_stress) = match parts & ROTATIONAL_STRESS {
        0 => (0.0, None),
        _ if random.chance(0.5) => (strength, Some(strength)),
        _ => (strength, Some(-strength)),
    };
    let parameters = Parameters { rotational_strength: Some(strength), ..base.parameters };
    let noncoaxiality = Some(if random.chance(0.5) { size } else { -size });
    let state = State { noncoaxiality, rotational_stress, ..with(parts, base.state) };
    Drawn { sample: Sample::new(kind, parameters, state), distance }
}
