//! Constants that all flow models have.

use crate::common::parameter::{ANGLE, Parameter};
use crate::common::range::Range;

/// Angle of internal friction, which all flow models have.
pub const FRICTION_ANGLE: Parameter = Parameter::required(
    ["friction_angle", "friction angle φ", ANGLE],
    "angle of internal friction φ; 0 < φ < 90",
    30.0,
)
.within(Range::Below(90.0));

/// Angle of dilatancy, which all flow models have.
pub const DILATANCY_ANGLE: Parameter = Parameter::with_default(
    ["dilatancy_angle", "dilatancy angle ν", ANGLE],
    "angle of dilatancy ν; 0 ≤ ν < φ, for plastic-potential 0 ≤ ν < 90",
    0.0,
)
.within(Range::NotNegativeBelow(90.0));

/// Cohesion, which all flow models have.
pub const COHESION: Parameter =
    Parameter::with_default(["cohesion", "cohesion c", "Pa"], "cohesion c; ≥ 0", 0.0)
        .within(Range::NotNegative);

/// The constants of a model that has no others.
pub const FAMILY: &[Parameter] = &[FRICTION_ANGLE, DILATANCY_ANGLE, COHESION];
