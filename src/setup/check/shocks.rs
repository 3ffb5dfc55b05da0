//! Plans of checks of plane waves in granular and porous media.

use super::{CheckExtent, CheckPlan, format_reason};
use crate::Error;
use crate::case::Case;
use crate::case::plane_wave::ContactMedium;
use crate::setup::plane_wave::{
    DashpotStep, check_without_viscosity, create_material_medium, create_solver_medium,
};
use dynamics::medium::Medium;

/// Plane waves to be measured in columns of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct ShockCheckPlan {
    /// Medium of the solver, in the plane.
    pub solver_medium: Medium,
    /// Numbers of cells of the columns.
    pub cell_counts: Vec<usize>,
}

/// Default number of cells.
const FULL_CELL_COUNT: usize = 2000;
/// Default number of cells of a short check.
const SHORT_CELL_COUNT: usize = 500;

/// Plans the check of a case with the medium `contacts`.
///
/// # Errors
/// A constant is out of range.
pub(super) fn plan_shocks(
    case: &Case,
    contacts: &ContactMedium,
    extent: CheckExtent,
) -> Result<CheckPlan, Error> {
    create_material_medium(&case.material, contacts)?;
    let solver_medium = case
        .require_plane_wave()
        .and_then(|_| check_without_viscosity(&case.material, contacts))
        .and_then(|()| {
            // There are no dashpots.
            create_solver_medium(&case.material, contacts, 2, DashpotStep::Longest(1.0))
        });
    let given = case.check_options.as_ref().and_then(|own| own.grid_sizes.clone());
    let cell_counts = match (given, extent) {
        (Some(given), CheckExtent::Full) => given,
        (Some(given), CheckExtent::Short) => given[..1].to_vec(),
        (None, CheckExtent::Full) => vec![FULL_CELL_COUNT],
        (None, CheckExtent::Short) => vec![SHORT_CELL_COUNT],
    };
    Ok(match solver_medium {
        Ok(solver_medium) => {
            CheckPlan::Shocks(Box::new(ShockCheckPlan { solver_medium, cell_counts }))
        }
        Err(error) => CheckPlan::NotMeasurable(format_reason(error)),
    })
}
