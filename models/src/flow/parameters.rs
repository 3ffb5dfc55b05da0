//! Constants shared by all flow models.

use crate::common::parameter::{ANGLE_UNIT, Parameter, define_parameters};

define_parameters! {
    /// Parameter: angle of internal friction φ, shared by all flow models.
    pub FRICTION_ANGLE = "friction_angle": "friction angle φ" [ANGLE_UNIT], Required(30.0), PositiveBelow(90.0),
        "angle of internal friction φ; 0 < φ < 90";
    /// Parameter: dilatancy angle ν, shared by all flow models.
    pub DILATANCY_ANGLE = "dilatancy_angle": "dilatancy angle ν" [ANGLE_UNIT], Default(0.0), NotNegativeBelow(90.0),
        "angle of dilatancy ν; 0 ≤ ν < φ, for plastic-potential 0 ≤ ν < 90";
    /// Parameter: cohesion c, shared by all flow models.
    pub COHESION = "cohesion": "cohesion c" ["Pa"], Default(0.0), NotNegative,
        "cohesion c; ≥ 0";
}

/// Constants shared by all flow models, in order: the complete parameter list of a model without further constants.
pub const SHARED_PARAMETERS: &[Parameter] = &[FRICTION_ANGLE, DILATANCY_ANGLE, COHESION];
