//! Constants shared by all flow models.

use crate::common::parameter::{ANGLE_UNIT, Parameter};
use crate::common::range::AllowedRange;

/// Parameter: angle of internal friction φ, shared by all flow models.
pub const FRICTION_ANGLE: Parameter = Parameter::new_required(
    ["friction_angle", "friction angle φ", ANGLE_UNIT],
    "angle of internal friction φ; 0 < φ < 90",
    30.0,
)
.with_range(AllowedRange::PositiveBelow(90.0));

/// Parameter: dilatancy angle ν, shared by all flow models.
pub const DILATANCY_ANGLE: Parameter = Parameter::with_default(
    ["dilatancy_angle", "dilatancy angle ν", ANGLE_UNIT],
    "angle of dilatancy ν; 0 ≤ ν < φ, for plastic-potential 0 ≤ ν < 90",
    0.0,
)
.with_range(AllowedRange::NotNegativeBelow(90.0));

/// Parameter: cohesion c, shared by all flow models.
pub const COHESION: Parameter =
    Parameter::with_default(["cohesion", "cohesion c", "Pa"], "cohesion c; ≥ 0", 0.0)
        .with_range(AllowedRange::NotNegative);

/// Constants shared by all flow models, in order: the complete parameter list of a model without further constants.
pub const SHARED_PARAMETERS: &[Parameter] = &[FRICTION_ANGLE, DILATANCY_ANGLE, COHESION];
