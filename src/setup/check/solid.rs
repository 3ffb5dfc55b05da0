//! Plans of solid checks: media of a case and waves to be measured in each.

use super::Extent;
use crate::case::{Case, Check, Material, Wave};
use crate::setup;
use agreement::PlaneWave;
use agreement::solids::SolverSettings;
use models::InputError;

/// Medium of a solid and its waves.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumPlan {
    /// Position in the case; empty if everywhere.
    pub place: String,
    /// Material of the medium.
    pub material: Material,
    /// Waves to be measured in the medium.
    pub waves: WavePlan,
}

/// Waves of a medium and solver settings of their measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct WavePlan {
    /// Waves to be measured.
    pub waves: Vec<Wave>,
    /// Grids and time step.
    pub settings: SolverSettings,
}

/// Plans the checks of the distinct media of a solid; the inner error is the reason why no solver supports one of them.
///
/// # Errors
/// The case is invalid.
pub(super) fn media(
    case: &Case,
    extent: Extent,
) -> Result<Result<Vec<MediumPlan>, InputError>, InputError> {
    let regions = case.dynamics.iter().flat_map(|dynamics| &dynamics.regions);
    let mut media: Vec<(String, Material)> = Vec::new();
    for (index, region) in regions.enumerate() {
        let own = &region.material;
        let is_same = |(_, other): &(String, Material)| {
            (own.medium(), &own.numbers) == (other.medium(), &other.numbers)
        };
        if !media.iter().any(is_same) {
            media.push((format!("region[{index}]"), own.clone()));
        }
    }
    if media.is_empty() {
        media.push((String::new(), case.material.clone()));
    }
    for (_, own) in &media {
        let solid = setup::solid::solid(own)?;
        if let Err(error) = setup::solid::medium(own, solid.dimensions) {
            return Ok(Err(error));
        }
        if let Some(plastic) = solid.plastic.filter(|plastic| plastic.rate > 0.0) {
            return Ok(Err(InputError {
                input: "yield.plastic_rate",
                found: format!("{:?}", plastic.rate),
                allowed: "waves are sent through backgrounds at rest: 0".to_owned(),
            }));
        }
    }
    let plan = |(place, own): (String, Material)| MediumPlan {
        waves: WavePlan::new(case, &own, extent),
        place,
        material: own,
    };
    Ok(Ok(media.into_iter().map(plan).collect()))
}

impl WavePlan {
    /// Plans the waves of the medium `own` of a case; time step and scheme are those of the case.
    pub fn new(case: &Case, own: &Material, extent: Extent) -> Self {
        let solid = setup::solid::solid(own);
        let dimensions = solid.as_ref().map_or(2, |solid| solid.dimensions);
        let yields = solid.as_ref().is_ok_and(|solid| solid.plastic.is_some());
        let natural = solid.ok().and_then(|solid| solid.elastic.characteristic_wave_number());
        let asked = case.check.clone().unwrap_or_default();
        let Check { numbers, directions_deg, cells } = asked;
        let mut numbers =
            numbers.unwrap_or_else(|| wave_numbers(natural, yields, own.numbers.wave.number));
        let mut directions = directions(directions_deg, dimensions == 2, yields, own.numbers.wave);
        if extent == Extent::Short {
            numbers.truncate(1);
            directions.truncate(2);
        }
        let waves = numbers.iter().flat_map(|&number| {
            directions.iter().map(move |&[direction_deg, elevation_deg]| Wave {
                number,
                direction_deg,
                elevation_deg,
                ..own.numbers.wave
            })
        });
        let default = if dimensions == 2 { vec![20, 30, 40] } else { vec![20, 25, 30] };
        Self { waves: waves.collect(), settings: settings(case, cells.unwrap_or(default)) }
    }

    /// Converts the waves to wave numbers and unit normals.
    pub fn plane_waves(&self) -> Vec<PlaneWave<3>> {
        self.waves.iter().map(plane_wave).collect()
    }
}

/// Converts a wave to wave number and unit normal.
fn plane_wave(wave: &Wave) -> PlaneWave<3> {
    PlaneWave { number: wave.number, normal: setup::solid::normal(wave) }
}

/// Returns the default wave numbers, 1/m: multiples of the characteristic wave number of the solid, or that of the case
/// if the solid has none.
fn wave_numbers(natural: Option<f64>, yields: bool, given: f64) -> Vec<f64> {
    match natural {
        // Long and short waves have different dispersion, hence five wave numbers.
        Some(own) if !yields => [1.0, 0.25, 0.5, 2.0, 4.0].map(|part| part * own).to_vec(),
        Some(own) => vec![own],
        None => vec![given],
    }
}

/// Returns directions and elevations, degrees: the given ones, or that of the case and a few oblique ones.
fn directions(
    asked_deg: Option<Vec<f64>>,
    is_plane: bool,
    yields: bool,
    wave: Wave,
) -> Vec<[f64; 2]> {
    if let Some(asked) = asked_deg {
        return asked.into_iter().map(|own| [own, wave.elevation_deg]).collect();
    }
    let oblique: &[[f64; 2]] = match (is_plane, yields) {
        (true, false) => &[[30.0, 0.0], [0.0, 0.0], [105.0, 0.0]],
        (true, true) => &[[30.0, 0.0], [0.0, 0.0]],
        (false, false) => &[[30.0, 35.0], [0.0, 0.0], [105.0, -20.0]],
        (false, true) => &[[30.0, 0.0], [0.0, 0.0]],
    };
    let own = [wave.direction_deg, wave.elevation_deg];
    let others = oblique.iter().copied().filter(|other| *other != own);
    [own].into_iter().chain(others).collect()
}

/// Returns the solver settings of a run of the case on the grids of `cells` cells per period.
fn settings(case: &Case, cells: Vec<usize>) -> SolverSettings {
    let time = case.dynamics.as_ref().map(|dynamics| &dynamics.time);
    let chosen = case.dynamics.as_ref().map(|dynamics| dynamics.scheme).unwrap_or_default();
    let scheme = setup::solid_run::scheme(chosen);
    SolverSettings {
        cells,
        courant: time.map_or(crate::case::dynamics::COURANT, |time| time.courant),
        rotation: time.map_or(30.0, |time| time.rotation_deg).to_radians(),
        plastic_step: scheme.plastic_step,
        splitting: scheme.splitting,
    }
}
