//! Constants of the double-sliding free-rotating model.

use crate::common::input::InputError;
use crate::common::parameter::to_constant_array;
use crate::flow::double_shearing::parameters::DoubleShearing;
use crate::flow::state::MohrCoulomb;

/// Double-sliding free-rotating model (de Josselin de Jong 1977) with checked constants, the same as in the
/// double-shearing model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRotating(pub DoubleShearing);

impl FreeRotating {
    /// Creates the model from its constants in the order of its registered parameters.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn from_constants(given: &[f64]) -> Result<Self, InputError> {
        let [friction_angle, dilatancy_angle, cohesion] = to_constant_array(given)?;
        let coulomb = MohrCoulomb::new(friction_angle, cohesion)?;
        Ok(Self(DoubleShearing::new(coulomb, dilatancy_angle)?))
    }
}
