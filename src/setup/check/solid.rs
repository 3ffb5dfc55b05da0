//! Plans of solid checks: media of a case, and waves to be measured in each.

use super::CheckExtent;
use crate::case::{Case, CheckOptions, Material, WaveNumbers};
use crate::setup;
use agreement::PlaneWave;
use agreement::solids::SolverSettings;
use models::InputError;
use models::common::decimal::format_exact;

/// Medium of a solid and the waves to be measured in it.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumPlan {
    /// Key of the region in the case, such as `region[0]`; empty if the case has no regions.
    pub region_key: String,
    /// Material of the medium, with its numbers.
    pub material: Material,
    /// Waves to be measured in the medium.
    pub waves: WavePlan,
}

/// Waves of a medium and solver settings of their measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct WavePlan {
    /// Wave numbers and directions of the waves to be measured.
    pub waves: Vec<WaveNumbers>,
    /// Settings of the solver: grids, time step and scheme.
    pub settings: SolverSettings,
}

/// Plans the checks of the distinct media of a solid; the inner error is the reason why waves in one of them cannot be
/// measured: the solver does not support its plastic flow, or its background flows plastically.
///
/// # Errors
/// A material is invalid, see [`create_solid`](setup::solid::create_solid).
pub(super) fn plan_media(
    case: &Case,
    extent: CheckExtent,
) -> Result<Result<Vec<MediumPlan>, InputError>, InputError> {
    let mut media: Vec<(String, Material)> = Vec::new();
    let materials = case.solid_run.iter().flat_map(|own| own.materials().into_iter().enumerate());
    for (index, own) in materials {
        let is_same = |(_, other): &(String, Material)| {
            (own.medium(), &own.numbers) == (other.medium(), &other.numbers)
        };
        if !media.iter().any(is_same) {
            let section = case.solid_run.as_ref().map(|own| own.material_section(index));
            media.push((section.unwrap_or_default(), own.clone()));
        }
    }
    if media.is_empty() {
        media.push((String::new(), case.material.clone()));
    }
    for (_, own) in &media {
        let solid = setup::solid::create_solid(own)?;
        if let Err(error) = setup::solid::create_medium(own, solid.dimensions) {
            return Ok(Err(error));
        }
        if let Some(plastic) = solid.plastic_state.filter(|plastic| plastic.multiplier_rate > 0.0) {
            return Ok(Err(InputError {
                input: "yield.plastic_rate",
                rejected_value: format_exact(plastic.multiplier_rate),
                allowed_values: "expected 0: the solver sends waves through backgrounds at rest"
                    .to_owned(),
            }));
        }
    }
    let plan = |(region_key, own): (String, Material)| MediumPlan {
        waves: WavePlan::new(case, &own, extent),
        region_key,
        material: own,
    };
    Ok(Ok(media.into_iter().map(plan).collect()))
}

impl WavePlan {
    /// Plans the waves of a medium with the material `own`. They are measured with the Courant number and the scheme of
    /// the simulation of the case, or with the default ones if the case has no simulation.
    pub fn new(case: &Case, own: &Material, extent: CheckExtent) -> Self {
        let solid = setup::solid::create_solid(own);
        let dimensions = solid.as_ref().map_or(2, |solid| solid.dimensions);
        let yields = solid.as_ref().is_ok_and(|solid| solid.plastic_state.is_some());
        let natural = solid.ok().and_then(|solid| solid.elastic_law.characteristic_wave_number());
        let asked = case.check_options.clone().unwrap_or_default();
        let CheckOptions { wave_numbers: numbers, directions_deg, grid_sizes: cells } = asked;
        let mut numbers = numbers.unwrap_or_else(|| {
            choose_default_wave_numbers(natural, yields, own.numbers.wave.wave_number)
        });
        let mut directions =
            choose_default_directions(directions_deg, dimensions == 2, yields, own.numbers.wave);
        if extent == CheckExtent::Short {
            numbers.truncate(1);
            directions.truncate(2);
        }
        let waves = numbers.iter().flat_map(|&number| {
            directions.iter().map(move |&[direction_deg, elevation_deg]| WaveNumbers {
                wave_number: number,
                direction_deg,
                elevation_deg,
                ..own.numbers.wave
            })
        });
        let default = if dimensions == 2 { vec![20, 30, 40] } else { vec![20, 25, 30] };
        Self {
            waves: waves.collect(),
            settings: create_solver_settings(case, cells.unwrap_or(default)),
        }
    }

    /// Converts the waves to wave numbers and unit normals.
    pub fn plane_waves(&self) -> Vec<PlaneWave<3>> {
        self.waves.iter().map(to_plane_wave).collect()
    }
}

/// Converts a wave to a plane wave with wave number and unit normal.
fn to_plane_wave(wave: &WaveNumbers) -> PlaneWave<3> {
    PlaneWave { wave_number: wave.wave_number, normal: setup::solid::wave_normal(wave) }
}

/// Returns the default wave numbers, 1/m: `natural`, the characteristic wave number of the solid, and for elastic
/// solids also multiples of it from ¼ to 4; the wave number `given` of the case if the solid has no characteristic wave
/// number.
fn choose_default_wave_numbers(natural: Option<f64>, yields: bool, given: f64) -> Vec<f64> {
    match natural {
        // Long and short waves have different dispersion, hence five wave numbers.
        Some(own) if !yields => [1.0, 0.25, 0.5, 2.0, 4.0].map(|part| part * own).to_vec(),
        Some(own) => vec![own],
        None => vec![given],
    }
}

/// Returns pairs of direction and elevation, degrees: the given directions at the elevation of `wave`, or without given
/// ones the direction of `wave` and up to three fixed directions, without repetition.
fn choose_default_directions(
    given_deg: Option<Vec<f64>>,
    is_plane: bool,
    yields: bool,
    wave: WaveNumbers,
) -> Vec<[f64; 2]> {
    if let Some(asked) = given_deg {
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

/// Returns the solver settings of the simulation of the case, or the default ones without simulation, for grids of
/// `cells` cells per wavelength.
fn create_solver_settings(case: &Case, cells: Vec<usize>) -> SolverSettings {
    let time = case.solid_run.as_ref().map(|solid_run| &solid_run.time);
    let chosen = case.solid_run.as_ref().map(|solid_run| solid_run.scheme).unwrap_or_default();
    let scheme = setup::solid_run::convert_scheme(chosen);
    SolverSettings {
        cells_per_wavelength: cells,
        courant_number: time
            .map_or(crate::case::dynamics::DEFAULT_COURANT_NUMBER, |time| time.courant_number),
        max_rotation: time.map_or(30.0, |time| time.max_rotation_deg).to_radians(),
        plastic_step: scheme.plastic_step,
        splitting: scheme.splitting,
    }
}
