//! Analysis of the state of a solid.

use super::order_and_coefficient;
use crate::case::{Case, WaveNumbers};
use crate::setup::solid::wave_normal;
use crate::study::dispersion::WaveVector;
use crate::study::extremes::{FlutterWave, SlowestWave};
use crate::study::{ProgressCallback, report_progress};
use crate::{Error, setup};
use analysis::bound;
use analysis::energy;
use analysis::solids::{self, AcousticTensorCache, PlaneWaves, SolidAssessment, SolidAssessor};
use analysis::waves::DirectionalWaves;
use models::InputError;
use models::common::elementary::{Elementary, Modulus};
use models::elastoplastic::Solid;
use models::solid::stress::Stress;
use models::yield_set::tangent::NoResponse;
use num_complex::Complex64;
use serde::Serialize;

/// Number of intervals into which the directions from 0° to 180° are divided, in the curve of the growth rate by
/// direction.
const DIRECTION_INTERVALS: usize = 720;
/// Wave numbers per decade in the curves of the growth rate by wave number; these extend over [`DECADES_ON_EACH_SIDE`]
/// decades below and above the wave number of the case.
const WAVE_NUMBERS_PER_DECADE: i32 = 12;
const DECADES_ON_EACH_SIDE: i32 = 4;

/// Analysis of the state of a solid.
#[derive(Clone, Debug, Serialize)]
pub struct SolidAnalysis {
    /// Kind of the solid, as named in case files.
    pub model: &'static str,
    /// Name of the yield set; `None` for elastic solids.
    #[serde(rename = "yield")]
    pub yield_set: Option<&'static str>,
    /// Number of dimensions: 2 for plane strain, 3 in space.
    pub dimensions: usize,
    /// Part of the medium that is analysed: `blocks` of a blocky medium without its joints; `None` for other media.
    #[serde(rename = "part", skip_serializing_if = "Option::is_none")]
    pub analysed_part: Option<&'static str>,
    /// Name of the verdict on the well-posedness of the solid.
    pub verdict: &'static str,
    /// Order of growth in the wave number k as k → ∞; `None` unless ill-posed, or if growth is unbounded at finite wave
    /// numbers.
    #[serde(rename = "order")]
    pub growth_order: Option<f64>,
    /// Growth coefficient lim Re ς / k^order as k → ∞, m^order/s; `None` without `growth_order`.
    #[serde(rename = "coefficient")]
    pub growth_coefficient: Option<f64>,
    /// Direction of the wave vector of fastest growth if ill-posed, in the plane of x₁ and x₂, degrees.
    pub direction_deg: Option<f64>,
    /// Elevation of the wave vector of fastest growth above the plane of x₁ and x₂, degrees; `None` unless ill-posed.
    pub elevation_deg: Option<f64>,
    /// Supremum of the growth rate Re ς over all waves, 1/s; `None` if it is not known to be finite.
    #[serde(rename = "bound")]
    pub growth_bound: Option<f64>,
    /// Type of the characteristic speeds over all directions.
    pub hyperbolicity: &'static str,
    /// Strongest flutter; `None` without complex speeds.
    #[serde(rename = "flutter")]
    pub strongest_flutter: Option<FlutterWave>,
    /// Slowest wave over all directions among those with real c².
    #[serde(rename = "slowest")]
    pub slowest_wave: SlowestWave,
    /// Whether plastic flow is associated; true for elastic solids.
    #[serde(rename = "associated")]
    pub is_associated: bool,
    /// Names of the active conditions of the yield set; `None` for elastic solids.
    #[serde(rename = "active")]
    pub active_conditions: Option<Vec<&'static str>>,
    /// Stress on the yield surface; `None` for elastic solids, or if the case gives the active conditions instead.
    pub stress: Option<YieldStress>,
    /// Wave vector given in the case.
    pub wave: WaveVector,
    /// Dispersion roots at `wave`, without those that vanish at every wave number: Re ς and Im ς, 1/s.
    #[serde(rename = "roots")]
    pub dispersion_roots: Vec<[f64; 2]>,
    /// Squared characteristic speeds c² in the direction of `wave`, real and imaginary part, m²/s².
    pub squared_speeds: Vec<[f64; 2]>,
    /// Squared characteristic speeds c² of the elastic response in the direction of `wave`, real and imaginary part,
    /// m²/s².
    pub elastic_squared_speeds: Vec<[f64; 2]>,
    /// Defects of energy conservation, which are zero up to rounding if energy is conserved.
    #[serde(rename = "energy")]
    pub energy_defects: EnergyDefects,
    /// Number of unknowns of the linearised rate equations.
    #[serde(rename = "unknowns")]
    pub unknown_count: usize,
    /// Number of dispersion roots that vanish at every wave number.
    #[serde(rename = "zero_roots")]
    pub zero_root_count: usize,
    /// Method by which the verdict was obtained.
    pub route: &'static str,
    /// Analysed solid with its yield set and stress.
    #[serde(skip)]
    pub solid: Solid,
    /// Verdict with its evidence: wave normal of the fastest growth, extreme waves, hyperbolicity.
    #[serde(skip)]
    pub assessment: SolidAssessment,
    /// Largest Re ς at the wave number of the case by direction: degrees, 1/s.
    #[serde(skip)]
    pub growth_by_direction: Vec<[f64; 2]>,
    /// Largest Re ς in the direction of the case by wave number: 1/m, 1/s.
    #[serde(skip)]
    pub growth_by_wave_number: Vec<[f64; 2]>,
    /// Largest Re ς in the direction of fastest growth of short waves by wave number: 1/m, 1/s; empty unless
    /// ill-posed.
    #[serde(skip)]
    pub growth_in_fastest_direction: Vec<[f64; 2]>,
}

/// Stress on the yield surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct YieldStress {
    /// Force stress σ, Pa; second index: face normal.
    pub force: [[f64; 3]; 3],
    /// Couple stress m, N/m; second index: face normal.
    pub couple: [[f64; 3]; 3],
}

impl From<Stress> for YieldStress {
    fn from(Stress { force, couple }: Stress) -> Self {
        Self { force, couple }
    }
}

/// Defects of energy conservation, dimensionless: asymmetries relative to the largest entry of the matrix, growth rates
/// relative to the largest |ς| at the same wave vector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EnergyDefects {
    /// Smallest eigenvalue of the symmetriser of the elastic equations, scaled to unit diagonal.
    #[serde(rename = "definiteness")]
    pub min_symmetriser_eigenvalue: f64,
    /// Asymmetry, relative: the greater of ‖A − Aᵀ‖ of the symmetriser A and ‖B − Bᵀ‖ of the symmetrised elastic flux
    /// matrices B.
    pub asymmetry: f64,
    /// Deviation ‖Q + Qᵀ‖ of the symmetrised elastic zero-order matrix Q from antisymmetry, relative.
    #[serde(rename = "antisymmetry")]
    pub antisymmetry_defect: f64,
    /// Largest ratio max |Re ς| / max |ς| of the dispersion roots ς of the elastic response at one wave vector, over
    /// many wavelengths and directions.
    pub elastic_growth: f64,
    /// Largest ratio max |Re ς| / max |ς| of the dispersion roots ς of the yielding response, at the same wave vectors
    /// as `elastic_growth`.
    #[serde(rename = "growth")]
    pub yielding_growth: f64,
}

impl From<&energy::EnergyConservation> for EnergyDefects {
    fn from(found: &energy::EnergyConservation) -> Self {
        let energy::EnergyConservation {
            definiteness,
            asymmetry,
            antisymmetry_defect,
            elastic_growth,
            yielding_growth,
            ..
        } = *found;
        Self {
            min_symmetriser_eigenvalue: definiteness,
            asymmetry,
            antisymmetry_defect,
            elastic_growth,
            yielding_growth,
        }
    }
}

/// Number of progress steps of the analysis: verdict, growth rate curves, energy defects, waves.
const PROGRESS_STEP_COUNT: usize = 4;

/// Analyses the state of a solid.
///
/// # Errors
/// The material is invalid (see [`create_solid`](setup::solid::create_solid)), or the state cannot be analysed;
/// [`Error::Cancelled`].
///
/// In a blocky medium the solid is that of the first block; its joints are not part of the analysis.
pub fn analyse_solid(case: &Case, on_progress: ProgressCallback) -> Result<SolidAnalysis, Error> {
    let analysed_part = case.has_joints().then_some("blocks");
    let case = &case.with_block_material();
    let part_is_done = |part: usize| report_progress(on_progress, part, PROGRESS_STEP_COUNT);
    let locate_error = |error: NoResponse| setup::locate_state_error(&case.material, error.into());
    let wave = case.material.numbers.wave;
    let solid =
        setup::solid::create_solid(&case.material).map_err(|error| case.locate_error(error))?;
    let cache = AcousticTensorCache::default();
    let mut assessor = SolidAssessor::new(&cache);
    let (assessment, of_polynomial) = assessor
        .assess(&solid)
        .map_err(|error| setup::locate_state_error(&case.material, error))?;
    let supremum = of_polynomial
        .and_then(|found| bound::locate_supremum(&assessor.plane_workspace.pencil, &found, 0.0));
    let bound = match supremum {
        Some(supremum) => Some(supremum.growth_rate),
        None => solid.is_symmetric_hyperbolic().then_some(0.0),
    };
    part_is_done(1)?;
    let waves = PlaneWaves::new(&solid).map_err(locate_error)?;
    let curves = GrowthCurves::new(&waves, wave, &assessment);
    part_is_done(2)?;
    let energy = compute_energy_defects(&solid, wave.wave_number).map_err(locate_error)?;
    part_is_done(3)?;
    let squared_speeds = |elastic: bool| {
        let waves =
            solids::directional_waves(&solid, wave_normal(&wave), elastic).map_err(locate_error)?;
        Ok::<_, Error>(to_pairs(&squared_speeds(&waves)))
    };
    let squared_speeds = [squared_speeds(false)?, squared_speeds(true)?];
    let roots = to_pairs(&waves.roots(wave_normal(&wave), wave.wave_number));
    part_is_done(PROGRESS_STEP_COUNT)?;
    if !has_finite_values(&energy, &roots, &squared_speeds) {
        let error = InputError {
            input: "model",
            rejected_value: "numbers whose energy or waves at wave.number cannot be computed"
                .into(),
            allowed_values:
                "expected moduli, inertias and wave numbers whose products and quotients are finite"
                    .into(),
        };
        return Err(case.locate_error(error).into());
    }
    let [order, coefficient] = order_and_coefficient(&assessment.verdict);
    let normal_deg = assessment.direction_deg();
    let [squared_speeds, elastic_squared_speeds] = squared_speeds;
    let plastic = solid.plastic_state.as_ref();
    Ok(SolidAnalysis {
        model: case.material.kind.name(),
        yield_set: case.material.yield_set.map(|set| set.name),
        dimensions: solid.dimensions,
        analysed_part,
        verdict: assessment.verdict.name(),
        growth_order: order,
        growth_coefficient: coefficient,
        direction_deg: normal_deg.map(|angles| angles[0]),
        elevation_deg: normal_deg.map(|angles| angles[1]),
        growth_bound: bound,
        hyperbolicity: assessment.hyperbolicity.name(),
        strongest_flutter: assessment.extremes.flutter.map(FlutterWave::from),
        slowest_wave: assessment.extremes.slowest.into(),
        is_associated: solid.is_associated(),
        active_conditions: plastic
            .map(|plastic| plastic.active_conditions.iter().map(|active| active.name).collect()),
        stress: plastic.and_then(|plastic| plastic.stress).map(YieldStress::from),
        wave: wave.into(),
        squared_speeds,
        dispersion_roots: roots,
        elastic_squared_speeds,
        energy_defects: EnergyDefects::from(&energy),
        unknown_count: energy.unknown_count,
        zero_root_count: energy.zero_root_count,
        route: assessment.route,
        growth_by_direction: curves.growth_by_direction,
        growth_by_wave_number: curves.growth_by_wave_number,
        growth_in_fastest_direction: curves.growth_in_fastest_direction,
        solid,
        assessment,
    })
}

/// Computes the defects of energy conservation for wave numbers near `number`, 1/m, or, if their growth is not finite,
/// near the characteristic wave number of the solid if it has one.
fn compute_energy_defects(
    solid: &Solid,
    number: f64,
) -> Result<energy::EnergyConservation, NoResponse> {
    let about = |number: f64| {
        Ok(match solid.dimensions {
            2 => energy::measure_energy_conservation::<2>(
                &solid.elastic_rates(),
                &solid.rates()?,
                number,
            ),
            _ => energy::measure_energy_conservation::<3>(
                &solid.elastic_rates(),
                &solid.rates()?,
                number,
            ),
        })
    };
    let found = about(number)?;
    match solid.elastic_law.characteristic_wave_number() {
        Some(own) if !(found.elastic_growth + found.yielding_growth).is_finite() => about(own),
        _ => Ok(found),
    }
}

/// Returns whether energy defects, roots and squared speeds are finite.
fn has_finite_values(
    energy: &energy::EnergyConservation,
    roots: &[[f64; 2]],
    squared_speeds: &[Vec<[f64; 2]>; 2],
) -> bool {
    let energy::EnergyConservation {
        definiteness,
        asymmetry,
        antisymmetry_defect,
        elastic_growth,
        yielding_growth,
        ..
    } = *energy;
    let waves = squared_speeds.iter().flatten().chain(roots).flatten().copied();
    [definiteness, asymmetry, antisymmetry_defect, elastic_growth, yielding_growth]
        .into_iter()
        .chain(waves)
        .all(f64::is_finite)
}

fn to_pairs(list: &[Complex64]) -> Vec<[f64; 2]> {
    list.iter().map(|z| [z.re, z.im]).collect()
}

/// Returns the squared speeds c², by descending real part; values of magnitude up to 10⁻¹³ of the largest one are set
/// to zero.
fn squared_speeds(waves: &DirectionalWaves) -> Vec<Complex64> {
    let mut all: Vec<Complex64> =
        waves.families.iter().flat_map(|family| family.squared_speeds()).collect();
    let largest = all.iter().map(|c| c.modulus()).fold(0.0, f64::max);
    for square in &mut all {
        if square.modulus() <= 1e-13 * largest {
            *square = Complex64::from(0.0);
        }
    }
    all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    all
}

/// Curves of the growth rate of a solid, 1/s, against direction, degrees, and wave number, 1/m.
struct GrowthCurves {
    growth_by_direction: Vec<[f64; 2]>,
    growth_by_wave_number: Vec<[f64; 2]>,
    growth_in_fastest_direction: Vec<[f64; 2]>,
}

impl GrowthCurves {
    fn new(waves: &PlaneWaves, wave: WaveNumbers, assessment: &SolidAssessment) -> Self {
        let rate = |wave: WaveNumbers| waves.growth_rate(wave_normal(&wave), wave.wave_number);
        let growth_by_direction = (0..=DIRECTION_INTERVALS)
            .map(|i| {
                let direction_deg = 180.0 * i as f64 / DIRECTION_INTERVALS as f64;
                [direction_deg, rate(WaveNumbers { direction_deg, ..wave })]
            })
            .collect();
        let along = |wave: WaveNumbers| {
            (-DECADES_ON_EACH_SIDE * WAVE_NUMBERS_PER_DECADE
                ..=DECADES_ON_EACH_SIDE * WAVE_NUMBERS_PER_DECADE)
                .map(|step| {
                    let decades = f64::from(step) / f64::from(WAVE_NUMBERS_PER_DECADE);
                    let number = wave.wave_number * 10f64.cr_powf(decades);
                    [number, rate(WaveNumbers { wave_number: number, ..wave })]
                })
                .collect()
        };
        let growth_in_worst_direction = match assessment.direction_deg() {
            Some([direction_deg, elevation_deg]) => {
                along(WaveNumbers { direction_deg, elevation_deg, ..wave })
            }
            None => Vec::new(),
        };
        Self {
            growth_by_direction,
            growth_by_wave_number: along(wave),
            growth_in_fastest_direction: growth_in_worst_direction,
        }
    }
}
