//! Closed-form verdict on the double-sliding free-rotating model: indeterminate.

use crate::flow::closed_form::ClosedFormVerdict;
use crate::flow::double_shearing::parameters::DoubleShearing;

/// Returns *indeterminate* in every background: the model has one equation fewer than unknowns. The equations are
/// independent, since with a prescribed spin they form a determinate model.
pub fn closed_form_verdict(model: &DoubleShearing) -> ClosedFormVerdict {
    // Two velocity components, spin, pressure and stress angle; with dilatancy also the density.
    let unknowns = 5 + usize::from(model.flow_rule().is_dilatant);
    ClosedFormVerdict::Indeterminate { rank: unknowns - 1, unknowns }
}
