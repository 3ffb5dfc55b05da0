//! Characteristic speeds of a solid against the direction, elastic and yielding.

use super::extremes::{FlutterWave, SlowestWave};
use super::{OnProgress, report_progress};
use crate::case::{Case, radians};
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

/// Speeds that differ by less than this part of the greatest elastic one are the same.
pub const EQUAL: f64 = 1e-6;

/// Degrees between the directions on the hemisphere.
const STEP_DEG: usize = 1;

/// The characteristic speeds of a solid.
#[derive(Clone, Debug, Serialize)]
pub struct Speeds {
    /// Kind of the solid.
    pub model: &'static str,
    /// Its yield set.
    #[serde(rename = "yield")]
    pub yield_set: Option<&'static str>,
    /// 2 for plane strain, 3 for space.
    pub dimensions: usize,
    /// The verdict.
    pub verdict: &'static str,
    /// Type of the speeds.
    pub hyperbolicity: &'static str,
    /// The strongest flutter, if there is any.
    pub flutter: Option<FlutterWave>,
    /// The slowest wave.
    pub slowest: SlowestWave,
    /// Sectors of complex speeds, degrees.
    pub flutter_sectors_deg: Vec<[f64; 2]>,
    /// Sectors of imaginary speeds, degrees.
    pub imaginary_sectors_deg: Vec<[f64; 2]>,
    /// Whether a speed vanishes in all directions.
    pub always_still: bool,
    /// Single directions in which a speed vanishes.
    pub vanishing: Vec<VanishingSpeed>,
    /// Angle of the directions above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
    /// The method of the verdict.
    pub route: &'static str,
    /// The solid.
    #[serde(skip)]
    pub solid: Solid,
    /// The verdict with what it rests on.
    #[serde(skip)]
    pub assessment: SolidAssessment,
    /// The squared speeds by direction.
    #[serde(skip)]
    pub by_direction: DirectionalSpeeds,
    /// The slowest speeds over all directions, in space alone.
    #[serde(skip)]
    pub hemisphere: Option<Hemisphere>,
}

/// A direction in which a speed vanishes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VanishingSpeed {
    /// The direction of the normal, degrees.
    pub direction_deg: f64,
    /// The cause.
    pub what: &'static str,
}

/// Speeds on a grid of directions on the upper half of the sphere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hemisphere {
    /// Angles from x₃, degrees.
    pub polar_deg: Vec<f64>,
    /// Angles about x₃ from x₁, degrees.
    pub azimuth_deg: Vec<f64>,
    /// The slowest real speed, m/s, NaN where one is complex or imaginary; azimuth running fastest.
    pub slowest: Vec<f64>,
}

/// Finds the characteristic speeds of a solid, on the threads of the surrounding rayon pool.
///
/// ```
/// use wellposed::case::Case;
/// use wellposed::study::unwatched;
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
/// let found = wellposed::speeds(&case, &unwatched)?;
/// assert_eq!((found.verdict, found.hyperbolicity), ("well-posed", "hyperbolic"));
/// // Shear waves: c² = μ/ρ.
/// assert!((found.slowest.squared_speed - 0.5).abs() < 1e-12);
/// # Ok::<(), wellposed::Error>(())
/// ```
///
/// # Errors
/// The case is none of a solid, its constants are out of range, it cannot be analysed, or the study was cancelled.
pub fn speeds(case: &Case, on_progress: OnProgress) -> Result<Speeds, Error> {
    let located = |error| setup::locate(&case.material, error);
    let solid = setup::solid::solid(&case.material).map_err(|error| case.locate(error))?;
    let hemisphere = Hemisphere::new();
    let all = 1 + if solid.dimensions == 2 { 0 } else { hemisphere.polar_deg.len() };
    report_progress(on_progress, 0, all)?;
    let cache = AcousticTensorCache::default();
    let (assessment, _) = SolidAssessor::new(&cache).assess(&solid).map_err(located)?;
    let elevation = radians(case.material.numbers.wave.elevation_deg);
    let by_direction =
        DirectionalSpeeds::new(&solid, elevation).map_err(|error| located(error.into()))?;
    report_progress(on_progress, 1, all)?;
    let hemisphere = match solid.dimensions {
        2 => None,
        _ => {
            let rates = solid.rates().map_err(|error| located(error.into()))?;
            let done = AtomicUsize::new(1);
            Some(hemisphere.fill(&rates, &|| {
                report_progress(on_progress, done.fetch_add(1, Ordering::Relaxed) + 1, all)
            })?)
        }
    };
    let extremes = &assessment.extremes;
    Ok(Speeds {
        model: case.material.kind.name(),
        yield_set: case.material.yields.map(|set| set.name),
        dimensions: solid.dimensions,
        verdict: assessment.verdict.name(),
        hyperbolicity: assessment.hyperbolicity.name(),
        flutter: extremes.flutter.map(FlutterWave::from),
        slowest: extremes.slowest.into(),
        flutter_sectors_deg: by_direction.flutter.clone(),
        imaginary_sectors_deg: by_direction.imaginary.clone(),
        always_still: by_direction.is_always_stationary,
        vanishing: by_direction
            .vanishing
            .iter()
            .map(|&(direction_deg, cause)| VanishingSpeed { direction_deg, what: cause.name() })
            .collect(),
        elevation_deg: case.material.numbers.wave.elevation_deg,
        route: assessment.route,
        solid,
        assessment,
        by_direction,
        hemisphere,
    })
}

impl Speeds {
    /// Whether the slowest wave is as slow in every direction, but for differences below [`EQUAL`].
    pub fn slowest_is_everywhere(&self) -> bool {
        let slowest = self.assessment.extremes.slowest.speed_squared.max(0.0).sqrt();
        let is_same = |c: f64| (c - slowest).abs() <= EQUAL * self.by_direction.largest.sqrt();
        match &self.hemisphere {
            Some(hemisphere) => hemisphere.slowest.iter().all(|&c| is_same(c)),
            None => self.by_direction.curves.iter().all(|(_, _, yielding)| {
                let least = yielding.iter().map(|c| c.re).fold(f64::INFINITY, f64::min);
                is_same(least.max(0.0).sqrt())
            }),
        }
    }
}

impl Hemisphere {
    /// The directions, without speeds.
    fn new() -> Self {
        let list =
            |to: usize| (0..to).step_by(STEP_DEG).map(|degrees| degrees as f64).collect::<Vec<_>>();
        Self { polar_deg: list(91), azimuth_deg: list(360), slowest: Vec::new() }
    }

    /// Adds the speeds; `row_is_done` is called after each polar angle.
    fn fill(
        self,
        rates: &RateEquations<3>,
        row_is_done: &(dyn Fn() -> Result<(), Error> + Sync),
    ) -> Result<Self, Error> {
        let row = |polar: &f64| {
            let (sin, cos) = polar.to_radians().cr_sin_cos();
            let speed = |azimuth: &f64| {
                let (y, x) = azimuth.to_radians().cr_sin_cos();
                slowest_speed(rates, [sin * x, sin * y, cos])
            };
            let row: Vec<f64> = self.azimuth_deg.iter().map(speed).collect();
            row_is_done()?;
            Ok(row)
        };
        let rows = self.polar_deg.par_iter().map(row).collect::<Result<Vec<_>, Error>>()?;
        Ok(Self { slowest: rows.concat(), ..self })
    }
}
