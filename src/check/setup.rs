//! From a case to the problems that are checked, and their errors with the place in the case file.

use super::Extent;
use super::solid::Plan;
use crate::Error;
use crate::case::dynamics::{Correction, Scheme, Splitting as Sweeps};
use crate::case::{Case, CaseError, Check, Parameter, Wave};
use crate::setup;
use crate::setup::flow_run::flow_problem;
use agreement::flows::UniformFlow;
use agreement::solids::SolverSettings;
use agreement::{AgreementError, PlaneWave};
use analysis::flows::Workspace;
use analysis::growth::Verdict;
use dynamics::problem::{Placement, Splitting};
use models::granular_flow::InputError;

/// The uniform flow of a case, for the analysis and for the solver.
///
/// # Errors
/// The case is none of a uniform flow that a solver takes.
pub(super) fn uniform_flow(case: &Case) -> Result<UniformFlow, Error> {
    let flow = case.mean_flow()?;
    // Each measurement has its own box.
    let solver = flow_problem(case, [4; 2], [1.0; 2])?;
    Ok(UniformFlow { model: case.model()?, state: case.state(), flow, solver })
}

/// The verdict on the uniform flow of a case.
///
/// # Errors
/// The state cannot be analysed.
pub(super) fn verdict(case: &Case, problem: &UniformFlow) -> Result<Verdict, Error> {
    match Workspace::default().decide(&problem.model, &problem.flow) {
        Ok((verdict, _)) => Ok(verdict),
        Err(error) => Err(setup::locate(case, error.into())),
    }
}

/// A wave of a solid by its unit vector.
pub(super) fn plane_wave(wave: &Wave) -> PlaneWave<3> {
    PlaneWave { number: wave.number, normal: setup::solid::normal(wave) }
}

/// The error with the key that it is due to, and a remedy.
pub(super) fn locate(case: &Case, error: AgreementError) -> Error {
    let found = error.to_string();
    let (key, allowed) = match error {
        AgreementError::NoResponse(error) => return setup::locate(case, error.into()),
        AgreementError::TooLong { most, .. } => {
            let allowed = format!("at most {most:.0e}: a greater wave number, or fewer cells");
            return case.locate(InputError { key: "check.numbers", found, allowed }).into();
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
        // No case leads to these.
        AgreementError::Dimensions { .. } => ("model.dimensions", "the same for both"),
        AgreementError::NoGrids => ("check.cells", "at least one grid"),
        AgreementError::Points { .. } => ("initial", "a value at each point"),
        AgreementError::Cancelled => ("check", "no cancellation"),
    };
    case.locate(InputError { key, found, allowed: allowed.to_owned() }).into()
}

/// Media of a solid, and where they are.
pub(super) type Media = Vec<(String, Case)>;

/// The media of a solid that a solver takes, and where they are; or why no solver takes one of them.
///
/// # Errors
/// The case is wrong.
pub(super) fn media(case: &Case) -> Result<Result<Media, InputError>, InputError> {
    let regions = case.dynamics.iter().flat_map(|dynamics| &dynamics.regions);
    let mut media: Vec<(String, Case)> = Vec::new();
    for (index, region) in regions.enumerate() {
        let own = &region.case;
        let is_same = |(_, other): &(String, Case)| {
            (own.medium(), &own.numbers) == (other.medium(), &other.numbers)
        };
        if !media.iter().any(is_same) {
            media.push((format!("region[{index}]"), own.clone()));
        }
    }
    if media.is_empty() {
        media.push((String::new(), case.clone()));
    }
    for (_, own) in &media {
        let solid = setup::solid::solid(own)?;
        if let Err(error) = setup::solid::medium(own, solid.dimensions) {
            return Ok(Err(error));
        }
        if let Some(plastic) = solid.plastic.filter(|plastic| plastic.rate > 0.0) {
            return Ok(Err(InputError {
                key: "yield.plastic_rate",
                found: format!("{:?}", plastic.rate),
                allowed: "waves are sent through backgrounds at rest: 0".to_owned(),
            }));
        }
    }
    Ok(Ok(media))
}

/// Why no solver takes a case.
pub(super) fn reason(error: CaseError) -> String {
    match error {
        CaseError::Key { key, found, allowed, .. } => {
            format!("{key}: {found}; analysis alone ({allowed})")
        }
        other => other.to_string(),
    }
}

/// That products of a few numbers of a flow neither overflow nor vanish.
pub(super) fn in_range(case: &Case) -> Result<(), CaseError> {
    const SIZES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
    let asked = case.check.iter().flat_map(|own| own.numbers.iter().flatten());
    let keys = Parameter::all().filter_map(|key| Some((key.key().name, key.get(&case.numbers)?)));
    let mut all = keys.chain(asked.map(|number| ("check.numbers", *number)));
    match all.find(|(_, value)| *value != 0.0 && !SIZES.contains(&value.abs())) {
        None => Ok(()),
        Some((key, value)) => {
            let (found, allowed) = (format!("{value:?}"), "0, or a size from 1e-60 to 1e60".into());
            Err(case.locate(InputError { key, found, allowed }))
        }
    }
}

/// The waves of a solid of one medium, the grids and the scheme.
pub fn plan(case: &Case, extent: Extent) -> Plan {
    plan_of(case, case, extent)
}

/// The same for one of the media of a case.
pub(super) fn plan_of(whole: &Case, case: &Case, extent: Extent) -> Plan {
    let wave = case.numbers.wave;
    let solid = setup::solid::solid(case);
    let own = solid.as_ref().ok().and_then(|solid| solid.elastic.characteristic_wave_number());
    let dimensions = solid.as_ref().map_or(2, |solid| solid.dimensions);
    let yields = solid.is_ok_and(|solid| solid.plastic.is_some());
    let asked = case.check.clone().unwrap_or_default();
    let Check { numbers, directions_deg, cells } = asked;
    let mut numbers = numbers.unwrap_or_else(|| match own {
        // Long waves see another solid than short ones.
        Some(own) if !yields => [1.0, 0.25, 0.5, 2.0, 4.0].map(|part| part * own).to_vec(),
        Some(own) => vec![own],
        None => vec![wave.number],
    });
    let asked = directions_deg
        .map(|all| all.into_iter().map(|own| [own, wave.elevation_deg]).collect::<Vec<_>>());
    let mut directions = asked.unwrap_or_else(|| {
        let oblique: &[[f64; 2]] = match (dimensions, yields) {
            (2, false) => &[[30.0, 0.0], [0.0, 0.0], [105.0, 0.0]],
            (2, true) => &[[30.0, 0.0], [0.0, 0.0]],
            (_, false) => &[[30.0, 35.0], [0.0, 0.0], [105.0, -20.0]],
            (_, true) => &[[30.0, 0.0], [0.0, 0.0]],
        };
        let own = [wave.direction_deg, wave.elevation_deg];
        let others = oblique.iter().copied().filter(|other| *other != own);
        [own].into_iter().chain(others).collect()
    });
    if extent == Extent::Short {
        numbers.truncate(1);
        directions.truncate(2);
    }
    let waves = numbers.iter().flat_map(|&number| {
        directions.iter().map(move |&[direction_deg, elevation_deg]| Wave {
            number,
            direction_deg,
            elevation_deg,
            ..wave
        })
    });
    let default = if dimensions == 2 { vec![20, 30, 40] } else { vec![20, 25, 30] };
    let time = whole.dynamics.as_ref().map(|dynamics| &dynamics.time);
    let scheme = whole.dynamics.as_ref().map_or_else(Scheme::default, |dynamics| dynamics.scheme);
    let settings = SolverSettings {
        cells: cells.unwrap_or(default),
        courant: time.map_or(crate::case::dynamics::COURANT, |time| time.courant),
        rotation: time.map_or(30.0, |time| time.rotation_deg).to_radians(),
        placement: match scheme.correction {
            Correction::FirstOrder => Placement::Last,
            Correction::SecondOrder => Placement::Middle,
        },
        splitting: match scheme.splitting {
            Sweeps::Alternating => Splitting::Alternating,
            Sweeps::TwoCyclic => Splitting::TwoCyclic,
        },
    };
    Plan { waves: waves.collect(), settings }
}
