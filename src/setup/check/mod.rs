//! Plans of checks from a case: waves, grids and solver settings.

pub mod flow;
pub mod solid;

use crate::case::{Case, CaseError, Kind, Material, Parameter};
use crate::{Error, setup};
use agreement::AgreementError;
use flow::FlowPlan;
use models::InputError;
use solid::MediumPlan;

/// Thoroughness of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All waves of the case, given or by default.
    Full,
    /// Quick: one wave number in two directions, for series of cases.
    Short,
}

/// Checks of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum CheckPlan {
    /// Checks of the media of a solid.
    Solid(Vec<MediumPlan>),
    /// Check of the waves and perturbations of a flow.
    Flow(FlowPlan),
    /// No check, since no solver supports the case; holds the reason.
    NotMeasurable(String),
}

impl CheckPlan {
    /// Creates the plan of a case.
    ///
    /// # Errors
    /// The case is invalid.
    pub fn new(case: &Case, extent: Extent) -> Result<Self, Error> {
        check_range(case)?;
        if let Kind::Solid(_) = case.material.kind {
            return Ok(match solid::media(case, extent).map_err(|error| case.locate(error))? {
                Ok(media) => Self::Solid(media),
                Err(error) => Self::NotMeasurable(reason(case.locate(error))),
            });
        }
        case.model()?.background(&case.state()).map_err(|error| case.locate(error))?;
        match case.rotation_in_time().and(case.mean_flow()) {
            Ok(_) => FlowPlan::new(case, extent).map(Self::Flow),
            Err(error) => Ok(Self::NotMeasurable(reason(error))),
        }
    }
}

/// Formats the reason why no solver supports a case.
fn reason(error: CaseError) -> String {
    match error {
        CaseError::Key { key, found, allowed, .. } => {
            format!("{key}: {found}; analysis alone ({allowed})")
        }
        other => other.to_string(),
    }
}

/// Checks that the numbers of a case are 0 or of magnitude 10⁻⁶⁰ to 10⁶⁰, so that products of a few neither overflow
/// nor underflow.
fn check_range(case: &Case) -> Result<(), CaseError> {
    const SIZES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
    let asked = case.check.iter().flat_map(|own| own.numbers.iter().flatten());
    let keys =
        Parameter::all().filter_map(|key| Some((key.key().name, key.get(&case.material.numbers)?)));
    let mut all = keys.chain(asked.map(|number| ("check.numbers", *number)));
    match all.find(|(_, value)| *value != 0.0 && !SIZES.contains(&value.abs())) {
        None => Ok(()),
        Some((key, value)) => {
            let (found, allowed) = (format!("{value:?}"), "0, or a size from 1e-60 to 1e60".into());
            Err(case.locate(InputError { input: key, found, allowed }))
        }
    }
}

/// Converts an error of the agreement crate to an error with the responsible key and a remedy.
pub fn locate(material: &Material, error: AgreementError) -> Error {
    let found = error.to_string();
    let (key, allowed) = match error {
        AgreementError::NoResponse(error) => return setup::locate(material, error.into()),
        AgreementError::Cancelled => return Error::Cancelled,
        AgreementError::TooLong { most, .. } => {
            let allowed = format!("at most {most:.0e}: a greater wave number, or fewer cells");
            return material.locate(InputError { input: "check.numbers", found, allowed }).into();
        }
        AgreementError::Energy => {
            ("model", "moduli, and conditions that hold independently of each other")
        }
        AgreementError::ActiveConditions => {
            ("yield", "positive strengths, or a section [stress] that decides")
        }
        AgreementError::PlasticFlow => ("yield", "conditions that flow together"),
        AgreementError::Undetermined | AgreementError::Flow(_) | AgreementError::Left(_) => {
            ("background", "a state further from the border of the fully deforming region")
        }
        AgreementError::NothingMoves => {
            ("initial", "noise of v, say, up to the greatest mode number of the finest")
        }
        // Not reachable from a case.
        AgreementError::Dimensions { .. } => ("model.dimensions", "the same for both"),
        AgreementError::NoGrids => ("check.cells", "at least one grid"),
        AgreementError::Points { .. } => ("initial", "a value at each point"),
    };
    material.locate(InputError { input: key, found, allowed: allowed.to_owned() }).into()
}
