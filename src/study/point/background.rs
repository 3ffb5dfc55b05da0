//! Background flow and its stress, as reported by the analysis of a state.

use models::flow::state::{DeformingFlow, PlanarStress};
use serde::Serialize;

/// Homogeneous background of a flow: given and derived quantities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlowBackground {
    /// Bulk density, kg/m³.
    pub density: f64,
    /// Shear rate Q_D: magnitude of the deviatoric deformation rate, 1/s.
    pub shear_rate: f64,
    /// Non-coaxiality Δ, degrees.
    pub noncoaxiality_deg: f64,
    /// Velocity components V₁ and V₂, m/s.
    pub velocity: [f64; 2],
    /// Half the vorticity, 1/s.
    pub half_vorticity: f64,
    /// Velocity gradient ∂ⱼVᵢ, 1/s.
    pub velocity_gradient: [[f64; 2]; 2],
    /// Intrinsic spin, rad/s; `None` for models without spin.
    pub spin: Option<f64>,
    /// Material acceleration minus body force per unit mass, m/s².
    pub acceleration: [f64; 2],
    /// Body moment per unit mass, m²/s²; `None` for models without balance of spin.
    pub body_moment: Option<f64>,
    /// Material rate of the stress angle, °/s; `None` if the flow rule does not determine this rate.
    pub stress_angle_rate_deg: Option<f64>,
}

impl From<&DeformingFlow> for FlowBackground {
    fn from(flow: &DeformingFlow) -> Self {
        Self {
            density: flow.density,
            shear_rate: flow.shear_rate,
            noncoaxiality_deg: flow.noncoaxiality.to_degrees(),
            velocity: flow.velocity,
            half_vorticity: flow.half_vorticity,
            velocity_gradient: flow.velocity_gradient.map(|row| row.map(|x| x.value)),
            spin: flow.spin.map(|spin| spin.value),
            // Adding 0.0 removes the sign of a negative zero.
            acceleration: flow.acceleration.map(|a| a.value + 0.0),
            body_moment: flow.body_moment,
            stress_angle_rate_deg: flow.stress_angle_rate.map(f64::to_degrees),
        }
    }
}

/// Plane stress state of the background flow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlowStress {
    /// Pressure p, Pa.
    pub pressure: f64,
    /// Deviatoric stress q, Pa.
    pub deviatoric_stress: f64,
    /// Rotational stress r, Pa.
    pub rotational_stress: f64,
    /// Angle of the greater principal stress from x₁, degrees.
    pub stress_angle_deg: f64,
    /// Stress tensor, Pa; the second index is that of the face normal.
    pub tensor: [[f64; 2]; 2],
}

impl From<&PlanarStress> for FlowStress {
    fn from(stress: &PlanarStress) -> Self {
        Self {
            pressure: stress.pressure,
            deviatoric_stress: stress.deviator.value,
            rotational_stress: stress.rotational_stress,
            stress_angle_deg: stress.angle.to_degrees(),
            tensor: stress.to_tensor(),
        }
    }
}
