//! Plans of checks from a case: waves, grids and solver settings.

pub mod blocks;
pub mod flow;
pub mod shocks;
pub mod solid;

use crate::case::{Case, CaseError, Material, ModelKind, SweepParameter};
use crate::{Error, setup};
use agreement::AgreementError;
use blocks::BlockyMediumPlan;
use flow::FlowCheckPlan;
use models::InputError;
use models::common::decimal::format_exact;
use shocks::ShockCheckPlan;
use solid::MediumPlan;

/// Thoroughness of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckExtent {
    /// All waves of the case, given or by default, and for flows all refined grids.
    Full,
    /// Quick, for series of cases: the first wave number in the first two directions, without refined grids of flows.
    Short,
}

/// Plan of the checks of a case, by kind of medium.
#[derive(Clone, Debug, PartialEq)]
pub enum CheckPlan {
    /// Plans for a solid: its media, and the periodic media of its blocks and joints.
    Solid {
        /// Plans for the distinct media of the solid, in the order of its regions or blocks.
        medium_plans: Vec<MediumPlan>,
        /// Plans for the periodic media of blocks and joints; empty without joints.
        blocky_medium_plans: Vec<BlockyMediumPlan>,
    },
    /// Check of the waves of a flow, and of a perturbation on refined grids.
    Flow(FlowCheckPlan),
    /// Comparison of the linearised equations of a model given as equations with differences of the equations, at this
    /// number of waves.
    Equations(usize),
    /// Check of the plane waves of a granular or porous medium.
    Shocks(Box<ShockCheckPlan>),
    /// No check, since no solver supports the case; contains the reason.
    NotMeasurable(String),
}

impl CheckPlan {
    /// Plans the checks of a case.
    ///
    /// # Errors
    /// The case is invalid, or its state cannot be analysed.
    pub fn new(case: &Case, extent: CheckExtent) -> Result<Self, Error> {
        if let Err(error) = case.require_model() {
            return Ok(Self::NotMeasurable(format_reason(error)));
        }
        if case.equations.is_some() {
            return Ok(Self::Equations(match extent {
                CheckExtent::Full => 24,
                CheckExtent::Short => 3,
            }));
        }
        check_magnitudes(case)?;
        if let Some(contacts) = &case.material.contacts {
            return shocks::plan_shocks(case, contacts, extent);
        }
        if let ModelKind::Solid(_) = case.material.kind {
            let media =
                solid::plan_media(case, extent).map_err(|error| case.locate_error(error))?;
            let blocks =
                blocks::plan_blocks(case, extent).map_err(|error| case.locate_error(error))?;
            return Ok(match media {
                Ok(media) => Self::Solid { medium_plans: media, blocky_medium_plans: blocks },
                Err(error) => Self::NotMeasurable(format_reason(case.locate_error(error))),
            });
        }
        case.build_located_model()?
            .background(&case.to_flow_state())
            .map_err(|error| case.locate_error(error))?;
        match case.simulation_rotation().and(case.solve_mean_flow()) {
            Ok(_) => FlowCheckPlan::new(case, extent).map(Self::Flow),
            Err(error) => Ok(Self::NotMeasurable(format_reason(error))),
        }
    }
}

/// Formats the reason why no solver supports a case.
pub(crate) fn format_reason(error: CaseError) -> String {
    match error {
        CaseError::Key { key, found, allowed, .. } => {
            format!("{key}: {found}; {allowed}")
        }
        other => other.to_string(),
    }
}

/// Checks that `check.numbers` and all numbers of a case that a map can sweep are 0 or of magnitude 10⁻⁶⁰ to 10⁶⁰, so
/// that products of a few numbers neither overflow nor underflow.
fn check_magnitudes(case: &Case) -> Result<(), CaseError> {
    const MAGNITUDES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
    let asked = case.check_options.iter().flat_map(|own| own.wave_numbers.iter().flatten());
    let keys = SweepParameter::all_parameters()
        .filter_map(|key| Some((key.key().name, key.value(&case.material.numbers)?)));
    let mut all = keys.chain(asked.map(|number| ("check.numbers", *number)));
    match all.find(|(_, value)| *value != 0.0 && !MAGNITUDES.contains(&value.abs())) {
        None => Ok(()),
        Some((key, value)) => {
            let (found, allowed) = (
                format_exact(value),
                "expected a magnitude from 1e-60 to 1e60, or 0 where the key allows it".into(),
            );
            Err(case.locate_error(InputError {
                input: key,
                rejected_value: found,
                allowed_values: allowed,
            }))
        }
    }
}

/// Converts an error of the crate `agreement` to an error that names the responsible key of the case and a remedy.
pub fn locate_agreement_error(material: &Material, error: AgreementError) -> Error {
    let found = error.to_string();
    let (key, allowed) = match error {
        AgreementError::NoResponse(error) => {
            return setup::locate_state_error(material, error.into());
        }
        AgreementError::Cancelled => return Error::Cancelled,
        AgreementError::TooManyCellUpdates { max_updates: most, .. } => {
            let allowed = format!(
                "expected at most {most:.0e} cell-updates: give a greater wave number, or fewer cells"
            );
            return material
                .locate_error(InputError {
                    input: "check.numbers",
                    rejected_value: found,
                    allowed_values: allowed,
                })
                .into();
        }
        AgreementError::IndefiniteEnergy => (
            "model",
            "expected moduli of a positive energy, and active conditions independent of each other",
        ),
        AgreementError::UnattainableConditions => {
            ("yield", "expected positive strengths, or a section [stress] in place of yield.active")
        }
        AgreementError::NonPositiveMultiplier => (
            "yield",
            "expected conditions that can be active together: leave one out of yield.active",
        ),
        AgreementError::SingularEquations
        | AgreementError::Flow(_)
        | AgreementError::SolverStopped(_) => {
            ("background", "expected a state further from the border of the fully deforming region")
        }
        AgreementError::Bloch(_) | AgreementError::NotLinear(_) => {
            ("joint", "expected layers and blocks for which the analysis finds waves")
        }
        AgreementError::NoVelocity => (
            "initial",
            "expected a perturbation of the velocity, such as noise of v up to the largest mode number of the finest grid",
        ),
        // The following errors cannot be caused by a case file.
        AgreementError::DimensionMismatch { .. } => {
            ("model.dimensions", "expected the same for both")
        }
        AgreementError::NoGrids => ("check.cells", "expected at least one grid"),
        AgreementError::PointCount { .. } => ("initial", "expected a value at each point"),
    };
    material
        .locate_error(InputError {
            input: key,
            rejected_value: found,
            allowed_values: allowed.to_owned(),
        })
        .into()
}
