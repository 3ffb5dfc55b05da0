//! Characteristic speeds of a solid by direction, elastic and yielding.

use super::extremes::{FlutterWave, SlowestWave};
use super::{ProgressCallback, report_progress};
use crate::case::{Case, degrees_to_radians};
use crate::{Error, setup};
use analysis::solids::{
    AcousticTensorCache, DirectionalSpeeds, SolidAssessment, SolidAssessor, slowest_speed,
};
use models::common::elementary::Elementary;
use models::common::rates::RateEquations;
use models::elastoplastic::Solid;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Tolerance within which speeds count as equal, relative to the largest elastic speed in the directions of the curves.
pub const EQUAL_SPEED_TOLERANCE: f64 = 1e-6;

/// Angular spacing of the directions on the hemisphere, degrees.
const ANGULAR_STEP_DEG: usize = 1;

/// Characteristic speeds of a solid by direction, with the verdict that they determine.
#[derive(Clone, Debug, Serialize)]
pub struct SpeedsResult {
    /// Kind of the solid, as named in case files.
    pub model: &'static str,
    /// Name of the yield set; `None` for elastic solids.
    #[serde(rename = "yield")]
    pub yield_set: Option<&'static str>,
    /// Number of dimensions: 2 for plane strain, 3 in space.
    pub dimensions: usize,
    /// Name of the verdict on the well-posedness of the solid.
    pub verdict: &'static str,
    /// Type of the characteristic speeds over all directions.
    pub hyperbolicity: &'static str,
    /// Strongest flutter; `None` without complex speeds.
    #[serde(rename = "flutter")]
    pub strongest_flutter: Option<FlutterWave>,
    /// Slowest wave over all directions among those with real c².
    #[serde(rename = "slowest")]
    pub slowest_wave: SlowestWave,
    /// Sectors of wave normals with complex speeds at the elevation `elevation_deg`, from and to, degrees.
    pub flutter_sectors_deg: Vec<[f64; 2]>,
    /// Sectors of wave normals with imaginary speeds (c² < 0) at the elevation `elevation_deg`, from and to, degrees.
    pub imaginary_sectors_deg: Vec<[f64; 2]>,
    /// Whether a speed vanishes in all directions at the elevation `elevation_deg`.
    #[serde(rename = "always_still")]
    pub is_always_stationary: bool,
    /// Isolated directions at the elevation `elevation_deg` in which a speed vanishes.
    #[serde(rename = "vanishing")]
    pub vanishing_speeds: Vec<VanishingSpeed>,
    /// Elevation of the directions of the curves above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
    /// Method by which the verdict was obtained.
    pub route: &'static str,
    /// Analysed solid with its yield set and stress.
    #[serde(skip)]
    pub solid: Solid,
    /// Verdict on the solid with its evidence.
    #[serde(skip)]
    pub assessment: SolidAssessment,
    /// Squared characteristic speeds of the elastic and the yielding response by direction, at the elevation
    /// `elevation_deg`.
    #[serde(skip)]
    pub directional_speeds: DirectionalSpeeds,
    /// Slowest nonzero speed in each direction; `None` in two dimensions.
    #[serde(skip)]
    pub hemisphere: Option<Hemisphere>,
}

/// Isolated direction in which a characteristic speed vanishes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VanishingSpeed {
    /// Direction of the wave normal in the plane of x₁ and x₂, degrees.
    pub direction_deg: f64,
    /// Cause for which the speed vanishes, such as slip along a layer.
    #[serde(rename = "what")]
    pub cause: &'static str,
}

/// Slowest nonzero speeds on a grid of directions on the upper half of the sphere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hemisphere {
    /// Polar angles from x₃, 0° to 90°, degrees.
    #[serde(rename = "polar_deg")]
    pub polar_angles_deg: Vec<f64>,
    /// Azimuths about x₃ from x₁, from 0° to below 360°, degrees.
    #[serde(rename = "azimuth_deg")]
    pub azimuth_angles_deg: Vec<f64>,
    /// Slowest nonzero speed by direction, m/s, azimuth fastest; NaN if a speed is complex or imaginary, infinite if
    /// all speeds vanish.
    #[serde(rename = "slowest")]
    pub slowest_speeds: Vec<f64>,
}

/// Computes the characteristic speeds of a solid on the rayon thread pool in which it is called.
///
/// ```
/// use wellposed::case::Case;
/// use wellposed::study::ignore_progress;
///
/// let text = "
/// [model]
/// kind = 'classical'
/// dimensions = 2
/// lambda = 1.5
/// mu = 1
/// density = 2
/// ";
/// let case = Case::parse(text, "elastic.toml", &[])?;
/// let found = wellposed::compute_speeds(&case, &ignore_progress)?;
/// assert_eq!((found.verdict, found.hyperbolicity), ("well-posed", "hyperbolic"));
/// // Shear waves: c² = μ/ρ.
/// assert!((found.slowest_wave.squared_speed - 0.5).abs() < 1e-12);
/// # Ok::<(), wellposed::Error>(())
/// ```
///
/// # Errors
/// The case is not a valid solid, its state cannot be analysed, or the study was cancelled.
pub fn compute_speeds(case: &Case, on_progress: ProgressCallback) -> Result<SpeedsResult, Error> {
    case.check_without_contacts()?;
    let locate_error = |error| setup::locate_state_error(&case.material, error);
    let solid =
        setup::solid::create_solid(&case.material).map_err(|error| case.locate_error(error))?;
    let hemisphere = Hemisphere::new();
    let all = 1 + if solid.dimensions == 2 { 0 } else { hemisphere.polar_angles_deg.len() };
    report_progress(on_progress, 0, all)?;
    let cache = AcousticTensorCache::default();
    let (assessment, _) = SolidAssessor::new(&cache).assess(&solid).map_err(locate_error)?;
    let elevation = degrees_to_radians(case.material.numbers.wave.elevation_deg);
    let by_direction =
        DirectionalSpeeds::new(&solid, elevation).map_err(|error| locate_error(error.into()))?;
    report_progress(on_progress, 1, all)?;
    let hemisphere = match solid.dimensions {
        2 => None,
        _ => {
            let rates = solid.rates().map_err(|error| locate_error(error.into()))?;
            let done = AtomicUsize::new(1);
            Some(hemisphere.compute_slowest_speeds(&rates, &|| {
                report_progress(on_progress, done.fetch_add(1, Ordering::Relaxed) + 1, all)
            })?)
        }
    };
    let extremes = &assessment.extremes;
    Ok(SpeedsResult {
        model: case.material.kind.name(),
        yield_set: case.material.yield_set.map(|set| set.name),
        dimensions: solid.dimensions,
        verdict: assessment.verdict.name(),
        hyperbolicity: assessment.hyperbolicity.name(),
        strongest_flutter: extremes.flutter.map(FlutterWave::from),
        slowest_wave: extremes.slowest.into(),
        flutter_sectors_deg: by_direction.flutter_sectors.clone(),
        imaginary_sectors_deg: by_direction.imaginary_sectors.clone(),
        is_always_stationary: by_direction.is_always_stationary,
        vanishing_speeds: by_direction
            .zero_speeds
            .iter()
            .map(|&(direction_deg, cause)| VanishingSpeed { direction_deg, cause: cause.name() })
            .collect(),
        elevation_deg: case.material.numbers.wave.elevation_deg,
        route: assessment.route,
        solid,
        assessment,
        directional_speeds: by_direction,
        hemisphere,
    })
}

impl SpeedsResult {
    /// Returns whether the slowest speed is equal in all sampled directions, within [`EQUAL_SPEED_TOLERANCE`].
    pub fn has_uniform_slowest_speed(&self) -> bool {
        let slowest = self.assessment.extremes.slowest.squared_speed.max(0.0).sqrt();
        let is_same = |c: f64| {
            (c - slowest).abs()
                <= EQUAL_SPEED_TOLERANCE * self.directional_speeds.max_squared_speed.sqrt()
        };
        match &self.hemisphere {
            Some(hemisphere) => hemisphere.slowest_speeds.iter().all(|&c| is_same(c)),
            None => self.directional_speeds.curves.iter().all(|(_, _, yielding)| {
                let least = yielding.iter().map(|c| c.re).fold(f64::INFINITY, f64::min);
                is_same(least.max(0.0).sqrt())
            }),
        }
    }
}

impl Hemisphere {
    /// Creates the grid of directions, without speeds.
    fn new() -> Self {
        let angle_list = |to: usize| {
            (0..to).step_by(ANGULAR_STEP_DEG).map(|degrees| degrees as f64).collect::<Vec<_>>()
        };
        Self {
            polar_angles_deg: angle_list(91),
            azimuth_angles_deg: angle_list(360),
            slowest_speeds: Vec::new(),
        }
    }

    /// Computes the slowest nonzero speeds; `report_row_done` is called after each polar angle.
    fn compute_slowest_speeds(
        self,
        rates: &RateEquations<3>,
        report_row_done: &(dyn Fn() -> Result<(), Error> + Sync),
    ) -> Result<Self, Error> {
        let row = |polar: &f64| {
            let (sin, cos) = polar.to_radians().cr_sin_cos();
            let speed = |azimuth: &f64| {
                let (y, x) = azimuth.to_radians().cr_sin_cos();
                slowest_speed(rates, [sin * x, sin * y, cos])
            };
            let row: Vec<f64> = self.azimuth_angles_deg.iter().map(speed).collect();
            report_row_done()?;
            Ok(row)
        };
        let rows = self.polar_angles_deg.par_iter().map(row).collect::<Result<Vec<_>, Error>>()?;
        Ok(Self { slowest_speeds: rows.concat(), ..self })
    }
}
