//! Random states of the dilatant Harris–Grekova model with given properties of the background and a given range of the
//! non-coaxiality |Δ|.

use crate::support::states::{
    DilatancyKind, FlowSample, RandomNumbers, sample_order_one, sample_wide_range,
};
use models::flow::state::MaterialState;
use models::registry;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use testkit::flows::FlowParameters;

/// Set of flags: properties of a background that are not zero, besides a constant deformation rate.
pub type BackgroundFlags = u8;
pub const ROTATIONAL_STRESS: BackgroundFlags = 1;
pub const PRESSURE_GRADIENT: BackgroundFlags = 2;
pub const STRESS_ANGLE_GRADIENT: BackgroundFlags = 4;
pub const DENSITY_GRADIENT: BackgroundFlags = 8;
pub const SPIN_GRADIENT: BackgroundFlags = 16;
pub const INERTIA_GRADIENT: BackgroundFlags = 32;
pub const UNIFORM: BackgroundFlags = 0;
pub const ALL_FLAGS: BackgroundFlags = 63;
/// Gradients of pressure and of stress angle: each accelerates the material, except in a set of states of measure zero.
pub const ACCELERATING_FLAGS: BackgroundFlags = PRESSURE_GRADIENT | STRESS_ANGLE_GRADIENT;

/// Returns `state` with only the given `flags` non-zero; the rotational stress is unchanged.
pub fn restrict_background(flags: BackgroundFlags, state: MaterialState) -> MaterialState {
    let gradient =
        |flag: BackgroundFlags, given: [f64; 2]| if flags & flag == 0 { [0.0; 2] } else { given };
    MaterialState {
        pressure_gradient: gradient(PRESSURE_GRADIENT, state.pressure_gradient),
        stress_angle_gradient: gradient(STRESS_ANGLE_GRADIENT, state.stress_angle_gradient),
        density_gradient: gradient(DENSITY_GRADIENT, state.density_gradient),
        spin_gradient: gradient(SPIN_GRADIENT, state.spin_gradient),
        inertia_gradient: gradient(INERTIA_GRADIENT, state.inertia_gradient),
        inertia_rate: if flags & INERTIA_GRADIENT == 0 { 0.0 } else { state.inertia_rate },
        ..state
    }
}

/// Range of |Δ| in [0, 90°], by the bound of the model on the non-coaxiality Δ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoncoaxialityZone {
    /// |Δ| below the bound: the coefficient of the highest power of ς has one sign.
    Inside,
    /// |Δ| between the bound and 90° − bound: the coefficient changes sign.
    Outside,
    /// |Δ| above 90° − bound: the coefficient has one sign, opposite to the sign inside.
    Reversed,
}
pub use NoncoaxialityZone::{Inside, Outside, Reversed};

/// Name of the expected verdict on the dilatant Harris–Grekova model.
///
/// Inside, acceleration makes layers grow at order 1/2, and a rotational stress at order 2/5. Outside, growth is
/// unbounded at finite k where the coefficient of the highest power of ς vanishes. A gradient of the stress angle gives
/// that coefficient an imaginary part of lower order in k, so that it has no real zero and growth is finite, of
/// order 3. Reversed, all roots that decay inside grow.
pub fn expected_verdict(flags: BackgroundFlags, zone: NoncoaxialityZone) -> &'static str {
    match zone {
        Inside if flags & ACCELERATING_FLAGS != 0 => "order 1/2",
        Inside if flags & ROTATIONAL_STRESS != 0 => "order 2/5",
        Inside => "well-posed",
        Outside if flags & STRESS_ANGLE_GRADIENT != 0 => "order 3/1",
        Outside => "unbounded at finite k",
        Reversed => "order 2/1",
    }
}

/// Random state, and the distance of its |Δ| from the bound of its zone, relative to the width of the zone (half width
/// outside).
pub struct ZoneSample {
    pub sample: FlowSample,
    pub distance: f64,
}

/// Draws a random state: four of five at log-uniform distances of 1e-9 to 0.3, the others at uniform distances.
pub fn sample_harris_grekova(
    random: &mut RandomNumbers,
    flags: BackgroundFlags,
    zone: NoncoaxialityZone,
    is_of_order_one: bool,
) -> ZoneSample {
    let kind = registry::HARRIS_GREKOVA;
    let base = loop {
        let base = if is_of_order_one {
            sample_order_one(random, kind, DilatancyKind::Positive, true)
        } else {
            sample_wide_range(random, kind, DilatancyKind::Positive)
        };
        let MaterialState { pressure_gradient, inertia_gradient, .. } = base.state;
        if pressure_gradient != [0.0; 2] && inertia_gradient != [0.0; 2] {
            break base;
        }
    };
    let bound = base.model.noncoaxiality_bound().expect("the model has one");
    let distance = if random.bernoulli(0.8) {
        random.log_uniform(1e-9, 0.3)
    } else {
        random.uniform(1e-9, 1.0)
    };
    let size = match zone {
        Inside => bound * (1.0 - distance),
        Outside => {
            let size = bound + distance * (FRAC_PI_4 - bound);
            if random.bernoulli(0.5) { size } else { FRAC_PI_2 - size }
        }
        Reversed => FRAC_PI_2 - bound * (1.0 - distance),
    };
    let strength = base.state.pressure * random.uniform(0.1, 1.0);
    let (strength, rotational_stress) = match flags & ROTATIONAL_STRESS {
        0 => (0.0, None),
        _ if random.bernoulli(0.5) => (strength, Some(strength)),
        _ => (strength, Some(-strength)),
    };
    let parameters = FlowParameters { rotational_strength: Some(strength), ..base.parameters };
    let noncoaxiality = Some(if random.bernoulli(0.5) { size } else { -size });
    let state = MaterialState {
        noncoaxiality,
        rotational_stress,
        ..restrict_background(flags, base.state)
    };
    ZoneSample { sample: FlowSample::new(kind, parameters, state), distance }
}
