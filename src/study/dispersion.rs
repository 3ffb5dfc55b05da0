//! Dispersion relation of a solid: frequencies and speeds of its waves against the wave number.

use super::{ProgressCallback, report_progress};
use crate::case::{Case, WaveNumbers};
use crate::{Error, setup};
use analysis::solids::{BranchGroup, BranchPoint, group_branches};
use models::InputError;
use models::common::decimal::format_exact;
use models::elastoplastic::Solid;
use serde::Serialize;

/// Dispersion relation of a solid in one direction.
#[derive(Clone, Debug, Serialize)]
pub struct DispersionResult {
    /// Kind of the solid, as named in case files.
    pub model: &'static str,
    /// Wave vector of the case, for which the branches are listed.
    pub wave: WaveVector,
    /// Largest wave number of the curves, 1/m: that of the case, by default four times the characteristic wave number
    /// of the solid, or the wave number of the case if the solid has none.
    #[serde(rename = "greatest_number")]
    pub max_wave_number: f64,
    /// Families of branches by polarisation; families of equal dispersion are merged.
    pub families: Vec<BranchFamily>,
    /// Analysed solid with its yield set and stress.
    #[serde(skip)]
    pub solid: Solid,
}

/// Wave vector in space, as wave number and angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaveVector {
    /// Wave number k, the magnitude of the wave vector, 1/m.
    #[serde(rename = "number")]
    pub wave_number: f64,
    /// Direction in the plane of x₁ and x₂ from x₁, degrees.
    pub direction_deg: f64,
    /// Elevation above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
}

impl From<WaveNumbers> for WaveVector {
    fn from(wave: WaveNumbers) -> Self {
        let WaveNumbers { wave_number, direction_deg, elevation_deg, .. } = wave;
        Self { wave_number, direction_deg, elevation_deg }
    }
}

/// Waves of one polarisation, merged with those of other polarisations that have equal dispersion.
#[derive(Clone, Debug, Serialize)]
pub struct BranchFamily {
    /// Polarisation of the waves of the family.
    pub polarisation: &'static str,
    /// Number of families of equal dispersion that are merged into this one.
    #[serde(rename = "count")]
    pub family_count: usize,
    /// Real parts of the characteristic speeds (phase speeds as k → ∞), m/s.
    pub characteristic_speeds: Vec<f64>,
    /// Magnitudes of the imaginary parts of the characteristic speeds, m/s, in the order of `characteristic_speeds`; 0
    /// for real speeds.
    #[serde(rename = "characteristic_growth")]
    pub imaginary_characteristic_speeds: Vec<f64>,
    /// Cut-off frequencies: nonzero angular frequencies at k = 0, rad/s.
    pub cut_off_frequencies: Vec<f64>,
    /// Limits as k → ∞ of the angular frequencies of branches with zero characteristic speed, rad/s.
    pub short_wave_limits: Vec<f64>,
    /// Band gaps, in which no such wave propagates: lower and upper frequency, rad/s; the upper one is infinite
    /// if no wave propagates above (null in JSON).
    #[serde(rename = "forbidden_bands")]
    pub band_gaps: Vec<[f64; 2]>,
    /// Branches at the wave number of the case.
    #[serde(rename = "at_wave")]
    pub branches: Vec<BranchAtWave>,
    /// Names of the branches, in the order of `curves`.
    #[serde(skip)]
    pub labels: Vec<String>,
    /// Curves of the branches up to the largest wave number, one list of points per branch.
    #[serde(skip)]
    pub curves: Vec<Vec<BranchPoint>>,
}

/// Frequency, growth rate and speeds of a branch at the wave number of the case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BranchAtWave {
    /// Angular frequency Re ω, rad/s.
    pub frequency: f64,
    /// Growth rate |Im ω|, 1/s; the waves of a branch with complex ω² come in pairs, of which one grows and one decays.
    pub growth_rate: f64,
    /// Phase speed Re ω/k, m/s.
    pub phase_speed: f64,
    /// Group speed Re dω/dk, m/s; 0 if Re ω = 0.
    pub group_speed: f64,
}

/// Computes the dispersion relation of a solid. Progress counts branch families.
///
/// # Errors
/// The case is not a valid solid, its background flows plastically, the rate response of the yielding solid is not
/// defined, or frequencies or speeds are not finite; [`Error::Cancelled`].
///
/// # Examples
/// ```
/// use wellposed::study::ignore_progress;
///
/// let case = wellposed::load("cases/cosserat/forbidden-band.toml", wellposed::NO_SETTINGS)?;
/// let found = wellposed::compute_dispersion(&case, &ignore_progress)?;
/// assert!(found.families.iter().any(|family| !family.band_gaps.is_empty()));
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn compute_dispersion(
    case: &Case,
    on_progress: ProgressCallback,
) -> Result<DispersionResult, Error> {
    case.check_without_contacts()?;
    let solid =
        setup::solid::create_solid(&case.material).map_err(|error| case.locate_error(error))?;
    if solid.plastic_state.as_ref().is_some_and(|plastic| plastic.multiplier_rate > 0.0) {
        let error = InputError {
            input: "plastic_rate",
            rejected_value: format_exact(case.material.numbers.plastic_rate),
            allowed_values: "expected 0: only undamped waves are followed; wellposed point has \
                      the roots of damped ones"
                .into(),
        };
        return Err(case.locate_error(error).into());
    }
    let wave = case.material.numbers.wave;
    let max_wave_number = match wave.max_wave_number {
        0.0 => {
            solid.elastic_law.characteristic_wave_number().map_or(wave.wave_number, |own| 4.0 * own)
        }
        given => given,
    };
    let groups = group_branches(&solid, setup::solid::wave_normal(&wave), max_wave_number, false)
        .map_err(|error| setup::locate_state_error(&case.material, error.into()))?;
    let is_finite = |p: &BranchPoint| {
        [p.frequency, p.growth_rate, p.phase_speed, p.group_speed].into_iter().all(f64::is_finite)
    };
    let ends = [wave.wave_number, max_wave_number];
    let is_group_finite = |group: &BranchGroup| {
        ends.iter().all(|&k| group.points_at(k).iter().all(is_finite))
            && group.speeds().iter().flatten().all(|speed| speed.is_finite())
            && group
                .cut_offs()
                .iter()
                .chain(&group.short_wave_limits())
                .all(|frequency| frequency.is_finite())
    };
    if !groups.iter().all(is_group_finite) {
        let error = InputError {
            input: "model",
            rejected_value: "numbers whose waves cannot be followed".into(),
            allowed_values:
                "expected moduli, inertias and wave numbers whose frequencies and speeds are finite"
                    .into(),
        };
        return Err(case.locate_error(error).into());
    }
    let all = groups.len();
    report_progress(on_progress, 0, all)?;
    let family = |(index, group): (usize, &BranchGroup)| {
        let family = BranchFamily::new(group, wave.wave_number, max_wave_number);
        report_progress(on_progress, index + 1, all)?;
        Ok(family)
    };
    Ok(DispersionResult {
        families: groups.iter().enumerate().map(family).collect::<Result<_, Error>>()?,
        model: case.material.kind.name(),
        wave: wave.into(),
        max_wave_number,
        solid,
    })
}

impl BranchFamily {
    fn new(group: &BranchGroup, number: f64, greatest: f64) -> Self {
        let curves = group.curves(greatest);
        let speeds = group.speeds();
        let at_wave = group.points_at(number);
        Self {
            polarisation: group.family.polarisation.name(),
            family_count: group.family_count,
            characteristic_speeds: speeds.iter().map(|speed| speed[0]).collect(),
            imaginary_characteristic_speeds: speeds.iter().map(|speed| speed[1]).collect(),
            cut_off_frequencies: group.cut_offs(),
            short_wave_limits: group.short_wave_limits(),
            band_gaps: group.band_gaps.iter().map(|band| [band.lower, band.upper]).collect(),
            branches: at_wave.iter().map(BranchAtWave::from).collect(),
            labels: (0..curves.len()).map(|branch| group.label(branch)).collect(),
            curves,
        }
    }
}

impl From<&BranchPoint> for BranchAtWave {
    fn from(point: &BranchPoint) -> Self {
        let BranchPoint { frequency, growth_rate, phase_speed, group_speed, .. } = *point;
        Self { frequency, growth_rate, phase_speed, group_speed }
    }
}
