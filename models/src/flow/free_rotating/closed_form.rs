//! The double-sliding free-rotating model determines nothing.

use crate::flow::closed_form::ClosedForm;
use crate::flow::double_shearing::parameters::DoubleShearing;

/// Indeterminate in every background: one equation fewer than unknowns, and those equations are
/// independent, being balances and flow rule of a model that is determinate once the spin is given.
pub fn closed_form(model: &DoubleShearing) -> ClosedForm {
    // Velocity, spin, pressure and stress angle; with dilatancy also the density.
    let unknowns = 5 + usize::from(model.flow_rule().dilatant);
    ClosedForm::Indeterminate { rank: unknowns - 1, unknowns }
}
