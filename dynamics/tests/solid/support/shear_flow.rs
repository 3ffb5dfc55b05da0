//! Granular flow in simple shear.

use std::f64::consts::{FRAC_PI_6, TAU};
use wellposed_dynamics::flow::{Closure, FlowProblem};

/// Returns simple shear ∂₂v₁ = 50 1/s in a box of 10 cm, with the non-coaxiality angle Δ = ψ_D − ψ, rad, from the major
/// principal stress to the major principal deformation rate.
pub fn simple_shear(closure: Closure, points: usize, noncoaxiality: f64) -> FlowProblem {
    let rate = 25.0;
    FlowProblem {
        closure,
        density: 1600.0,
        friction_angle: FRAC_PI_6,
        rotation_ratio: FRAC_PI_6.sin(),
        cohesion: 100.0,
        pressure: 1000.0,
        velocity_gradient: [[0.0, 2.0 * rate], [0.0, 0.0]],
        stress_angle: TAU / 8.0 - noncoaxiality,
        // Spin ω from ω − s₂₁ = −Q_D sin 2Δ/sin φ, with the half-vorticity s₂₁, the deviatoric strain rate Q_D and the
        // friction angle φ.
        spin: -rate - rate * (2.0 * noncoaxiality).sin() / FRAC_PI_6.sin(),
        spin_acceleration: 0.0,
        points: [points; 2],
        lengths: [0.1, 0.1],
        tolerance: 1e-6,
        pressure_tolerance: 1e-11,
        min_shear_rate: 1e-3,
    }
}
