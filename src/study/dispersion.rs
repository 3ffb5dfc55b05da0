//! Dispersion relation of a solid: frequencies and speeds of its waves against the wave number.

use super::{OnProgress, report_progress};
use crate::case::{Case, Wave};
use crate::{Error, setup};
use analysis::solids::{BranchGroup, BranchPoint, branches};
use models::InputError;
use models::elastoplastic::Solid;
use serde::Serialize;

/// Dispersion relation of a solid in one direction.
#[derive(Clone, Debug, Serialize)]
pub struct Dispersion {
    /// Kind of the solid.
    pub model: &'static str,
    /// Wave vector at which branches are listed.
    pub wave: WaveVector,
    /// Greatest wave number of the curves, 1/m.
    pub greatest_number: f64,
    /// Branch families, those of equal dispersion merged.
    pub families: Vec<BranchFamily>,
    /// Solid with its yield state.
    #[serde(skip)]
    pub solid: Solid,
}

/// Wave vector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaveVector {
    /// Wave number k, 1/m.
    pub number: f64,
    /// Direction in the plane of x₁ and x₂ from x₁, degrees.
    pub direction_deg: f64,
    /// Elevation above that plane, degrees.
    pub elevation_deg: f64,
}

impl From<Wave> for WaveVector {
    fn from(wave: Wave) -> Self {
        let Wave { number, direction_deg, elevation_deg, .. } = wave;
        Self { number, direction_deg, elevation_deg }
    }
}

/// Waves of one polarisation, merged with those of equal dispersion.
#[derive(Clone, Debug, Serialize)]
pub struct BranchFamily {
    /// Polarisation of the waves.
    pub polarisation: &'static str,
    /// Number of merged families.
    pub count: usize,
    /// Characteristic speeds, m/s.
    pub characteristic_speeds: Vec<f64>,
    /// Imaginary parts of complex characteristic speeds, m/s.
    pub characteristic_growth: Vec<f64>,
    /// Nonzero frequencies at k = 0, rad/s.
    pub cut_off_frequencies: Vec<f64>,
    /// Frequencies as k → ∞ of branches with zero characteristic speed, rad/s.
    pub short_wave_limits: Vec<f64>,
    /// Forbidden bands, in which no such wave propagates: lower and upper frequency, rad/s; the upper one is infinite
    /// if no wave propagates above (null in JSON).
    pub forbidden_bands: Vec<[f64; 2]>,
    /// Branches at the wave of the case.
    pub at_wave: Vec<Branch>,
    /// Names of the branches.
    #[serde(skip)]
    pub labels: Vec<String>,
    /// Curves of the branches up to the greatest wave number.
    #[serde(skip)]
    pub curves: Vec<Vec<BranchPoint>>,
}

/// Branch at the wave of the case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Branch {
    /// Frequency Re ω, rad/s.
    pub frequency: f64,
    /// Growth rate |Im ω|, 1/s.
    pub growth_rate: f64,
    /// Phase speed Re ω/k, m/s.
    pub phase_speed: f64,
    /// Group speed Re dω/dk, m/s.
    pub group_speed: f64,
}

/// Computes the dispersion relation of a solid. Progress counts families of waves.
///
/// # Errors
/// The case is not a solid, its constants are out of range, its background flows plastically, or frequencies are not
/// finite; [`Error::Cancelled`].
///
/// # Examples
/// ```
/// use wellposed::study::unwatched;
///
/// let case = wellposed::load("cases/cosserat/forbidden-band.toml", wellposed::NO_SETTINGS)?;
/// let found = wellposed::dispersion(&case, &unwatched)?;
/// assert!(found.families.iter().any(|family| !family.forbidden_bands.is_empty()));
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn dispersion(case: &Case, on_progress: OnProgress) -> Result<Dispersion, Error> {
    let solid = setup::solid::solid(&case.material).map_err(|error| case.locate(error))?;
    if solid.plastic.as_ref().is_some_and(|plastic| plastic.rate > 0.0) {
        let error = InputError {
            input: "plastic_rate",
            found: format!("{:?}", case.material.numbers.plastic_rate),
            allowed: "0: branches are followed of waves that nothing damps; wellposed point has \
                      the roots of damped ones"
                .into(),
        };
        return Err(case.locate(error).into());
    }
    let wave = case.material.numbers.wave;
    let greatest_number = match wave.greatest_number {
        0.0 => solid.elastic.characteristic_wave_number().map_or(wave.number, |own| 4.0 * own),
        given => given,
    };
    let groups = branches(&solid, setup::solid::normal(&wave), greatest_number, false)
        .map_err(|error| setup::locate(&case.material, error.into()))?;
    let is_finite = |p: &BranchPoint| p.frequency.is_finite() && p.growth_rate.is_finite();
    let ends = [wave.number, greatest_number];
    if !ends.iter().all(|&k| groups.iter().all(|group| group.at(k).iter().all(is_finite))) {
        let error = InputError {
            input: "model",
            found: "numbers whose waves cannot be followed".into(),
            allowed: "moduli, inertias and wave numbers whose frequencies are finite".into(),
        };
        return Err(case.locate(error).into());
    }
    let all = groups.len();
    report_progress(on_progress, 0, all)?;
    let family = |(index, group): (usize, &BranchGroup)| {
        let family = BranchFamily::new(group, wave.number, greatest_number);
        report_progress(on_progress, index + 1, all)?;
        Ok(family)
    };
    Ok(Dispersion {
        families: groups.iter().enumerate().map(family).collect::<Result<_, Error>>()?,
        model: case.material.kind.name(),
        wave: wave.into(),
        greatest_number,
        solid,
    })
}

impl BranchFamily {
    fn new(group: &BranchGroup, number: f64, greatest: f64) -> Self {
        let curves = group.curves(greatest);
        let speeds = group.speeds();
        let at_wave = group.at(number);
        Self {
            polarisation: group.family.polarisation.name(),
            count: group.count,
            characteristic_speeds: speeds.iter().map(|speed| speed[0]).collect(),
            characteristic_growth: speeds.iter().map(|speed| speed[1]).collect(),
            cut_off_frequencies: group.cut_offs(),
            short_wave_limits: group.short_wave_limits(),
            forbidden_bands: group.bands.iter().map(|band| [band.from, band.to]).collect(),
            at_wave: at_wave.iter().map(Branch::from).collect(),
            labels: (0..curves.len()).map(|branch| group.label(branch)).collect(),
            curves,
        }
    }
}

impl From<&BranchPoint> for Branch {
    fn from(point: &BranchPoint) -> Self {
        let BranchPoint { frequency, growth_rate, phase_speed, group_speed, .. } = *point;
        Self { frequency, growth_rate, phase_speed, group_speed }
    }
}
