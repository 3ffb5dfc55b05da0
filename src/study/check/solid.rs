//! Checks of solids: predicted, expected and measured branches of all waves.

use super::greatest;
use crate::case::{Material, Wave};
use crate::setup::check::locate;
use crate::setup::check::solid::{MediumPlan, WavePlan};
use crate::study::OnProgress;
use crate::study::dispersion::WaveVector;
use crate::{Error, setup};
use agreement::fit::Rate;
use agreement::solids::{BandGap, BranchResult, GridResult, Response, band_gaps, branch_results};
use analysis::solids::{BranchGroup, branches};
use models::elastoplastic::Solid;
use serde::{Serialize, Serializer};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Check result of a solid.
#[derive(Clone, Debug, Serialize)]
pub struct SolidCheck {
    /// Check results by medium.
    pub media: Vec<MediumCheck>,
}

/// Check result of a medium.
#[derive(Clone, Debug, Serialize)]
pub struct MediumCheck {
    /// Position in the case; empty if everywhere.
    pub place: String,
    /// Description of the medium.
    pub model: String,
    /// Whether all measurements agree; `None` without any.
    pub agrees: Option<bool>,
    /// Check results by branch, for all waves.
    pub rows: Vec<BranchCheck>,
    /// Check results of the forbidden bands of an elastic solid.
    pub forbidden_bands: Vec<ForbiddenBandCheck>,
    /// Solid with its yield state.
    #[serde(skip)]
    pub solid: Solid,
    /// Predicted branches in the direction of the first wave, by response.
    #[serde(skip)]
    pub branches: Vec<(Response, Vec<BranchGroup>)>,
}

/// Check of a branch at one wave vector.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BranchCheck {
    /// Elastic, loading or unloading response.
    #[serde(serialize_with = "name")]
    pub response: Response,
    /// Name of the branch.
    pub branch: String,
    /// Wave vector.
    pub wave: WaveVector,
    /// Frequency predicted by the analysis.
    pub predicted: ComplexFrequency,
    /// Measurement extrapolated to zero cell size.
    pub limit: Option<GridCheck>,
    /// Measurements by grid, coarsest first.
    pub grids: Vec<GridCheck>,
    /// Reason why there is no measurement.
    pub not_measurable: Option<String>,
    /// Order of convergence in the cell size; `None` if the error is rounding.
    pub order: Option<f64>,
    /// Whether the measured rate agrees on every grid and in the limit; `None` without measurement.
    pub agrees: Option<bool>,
    /// Measured minus predicted rate in the limit of zero cell size, relative to the predicted frequency.
    #[serde(skip)]
    pub difference: Option<Rate>,
    /// Expected minus predicted rate in the limit, by the symbol of the scheme, relative to the predicted frequency.
    #[serde(skip)]
    pub expected_difference: Option<Rate>,
}

/// Complex frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComplexFrequency {
    /// Angular frequency ω, rad/s.
    pub frequency: f64,
    /// Growth rate γ, 1/s.
    pub growth_rate: f64,
}

/// Rate measured on a grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GridCheck {
    /// Cells per period along each axis; `None` in the limit of zero cell size.
    pub cells: Option<usize>,
    /// Measured angular frequency ω, rad/s.
    pub frequency: f64,
    /// Measured growth rate γ, 1/s.
    pub growth_rate: f64,
    /// Expected ω by the symbol of the scheme, rad/s.
    pub expected_frequency: f64,
    /// Expected γ by the symbol of the scheme, 1/s.
    pub expected_growth_rate: f64,
    /// Measured minus predicted frequency, relative to the predicted one.
    pub difference: f64,
    /// Bound on the difference of measured and expected rates, 1/s.
    pub tolerance: f64,
    /// Whether measured and expected rates agree.
    pub agrees: bool,
}

/// Check of a frequency band in which no wave of a polarisation propagates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForbiddenBandCheck {
    /// Polarisation of the waves.
    pub polarisation: &'static str,
    /// Lower edge of the band, rad/s.
    pub from: f64,
    /// Upper edge of the band, rad/s.
    pub to: f64,
    /// Nearest measured frequencies below and above the band, rad/s.
    pub nearest: [Option<f64>; 2],
    /// Whether no frequency was measured inside the band.
    pub agrees: bool,
}

fn name<S: Serializer>(response: &Response, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(response.name())
}

/// Checks all media of a solid.
pub(super) fn check(media: Vec<MediumPlan>, on_progress: OnProgress) -> Result<SolidCheck, Error> {
    let (mut checked, mut before) = (Vec::new(), 0);
    let mut left = media.len();
    for medium in media {
        let own = AtomicUsize::new(0);
        // The number of runs of the remaining media is not yet known; each is estimated by that of this medium.
        let on_progress = |done: usize, all: usize| {
            own.store(all, Ordering::Relaxed);
            on_progress(before + done, before + all * left)
        };
        checked.push(MediumCheck::new(medium, &on_progress)?);
        before += own.into_inner();
        left -= 1;
    }
    Ok(SolidCheck { media: checked })
}

/// Compares the branches of the waves of a solid, predicted for the material `predicted` and measured for `measured`;
/// they differ only in tests of the check itself.
///
/// # Errors
/// A material is invalid, the solver does not support it, or the study was cancelled.
pub fn rows(
    predicted: &Material,
    measured: &Material,
    plan: &WavePlan,
    on_progress: OnProgress,
) -> Result<Vec<BranchResult>, Error> {
    let solid = setup::solid::solid(predicted).map_err(|error| predicted.locate(error))?;
    let medium =
        setup::solid::medium(measured, solid.dimensions).map_err(|error| measured.locate(error))?;
    branch_results(&solid, &medium, &plan.plane_waves(), &plan.settings, on_progress)
        .map_err(|error| locate(predicted, error))
}

impl SolidCheck {
    /// Returns whether all measurements agree; `None` without any.
    pub fn agrees(&self) -> Option<bool> {
        let all: Vec<bool> = self.media.iter().filter_map(|own| own.agrees).collect();
        (!all.is_empty()).then(|| all.into_iter().all(|own| own))
    }

    /// Returns the number of branches and forbidden bands, and the number that disagree.
    pub fn counts(&self) -> [usize; 2] {
        let rows = || self.media.iter().flat_map(|own| &own.rows);
        let bands = || self.media.iter().flat_map(|own| &own.forbidden_bands);
        let failed = rows().filter(|row| row.agrees == Some(false)).count()
            + bands().filter(|band| !band.agrees).count();
        [rows().count() + bands().count(), failed]
    }
}

impl MediumCheck {
    fn new(medium: MediumPlan, on_progress: OnProgress) -> Result<Self, Error> {
        let MediumPlan { place, material, waves: plan } = medium;
        let results = rows(&material, &material, &plan, on_progress)?;
        let solid = setup::solid::solid(&material).map_err(|error| material.locate(error))?;
        let bands = band_gaps(&solid, &plan.plane_waves(), &results)
            .map_err(|error| locate(&material, error))?;
        let rows: Vec<BranchCheck> = results
            .iter()
            .map(|result| BranchCheck::new(plan.waves[result.wave], result))
            .collect();
        let first = results.first().map_or(material.numbers.wave, |result| plan.waves[result.wave]);
        let greatest = rows.iter().map(|row| row.wave.number).fold(0.0, f64::max);
        let responses: &[(Response, bool)] = match solid.plastic {
            None => &[(Response::Elastic, true)],
            Some(_) => &[(Response::Unloading, true), (Response::Loading, false)],
        };
        let mut predicted = Vec::new();
        for &(response, stays_elastic) in responses {
            let groups = branches(&solid, setup::solid::normal(&first), greatest, stays_elastic)
                .map_err(|error| setup::locate(&material, error.into()))?;
            predicted.push((response, groups));
        }
        let measured: Vec<bool> = rows.iter().filter_map(|row| row.agrees).collect();
        let all_agree =
            bands.iter().all(|band| band.agrees) && measured.iter().all(|agrees| *agrees);
        Ok(Self {
            place,
            model: material.medium().title(),
            agrees: (!measured.is_empty()).then_some(all_agree),
            rows,
            forbidden_bands: bands.iter().map(ForbiddenBandCheck::from).collect(),
            solid,
            branches: predicted,
        })
    }

    /// Returns the number of rows without measurement.
    pub fn unmeasured(&self) -> usize {
        self.rows.iter().filter(|row| row.not_measurable.is_some()).count()
    }

    /// Returns the greatest difference of a measured rate in the limit of zero cell size, relative to the predicted
    /// frequency; `None` without measurement.
    pub fn greatest_difference(&self) -> Option<f64> {
        greatest(self.differences())
    }

    /// Returns the differences of measured rates, relative to the predicted frequencies.
    pub(super) fn differences(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().filter_map(|row| Some(row.difference?.max_norm()))
    }
}

impl BranchCheck {
    fn new(wave: Wave, result: &BranchResult) -> Self {
        let measured = result.measured.as_ref().ok();
        let limit = measured.map(|own| GridCheck::new(result, &own.limit));
        let grids = measured.iter().flat_map(|own| &own.grids);
        Self {
            response: result.response,
            branch: result.branch.clone(),
            wave: wave.into(),
            predicted: ComplexFrequency { frequency: result.predicted, growth_rate: 0.0 },
            limit: limit.map(|limit| GridCheck { cells: None, ..limit }),
            grids: grids.map(|grid| GridCheck::new(result, grid)).collect(),
            not_measurable: result.measured.as_ref().err().map(ToString::to_string),
            order: result.order(),
            agrees: result.agrees(),
            difference: result.difference(),
            expected_difference: result.expected_difference(),
        }
    }
}

impl GridCheck {
    fn new(row: &BranchResult, grid: &GridResult) -> Self {
        Self {
            cells: Some(grid.cells),
            frequency: grid.measured.frequency,
            growth_rate: grid.measured.growth,
            expected_frequency: grid.expected.frequency,
            expected_growth_rate: grid.expected.growth,
            difference: row.relative(grid.measured).frequency,
            tolerance: grid.tolerance,
            agrees: grid.agrees(),
        }
    }
}

impl From<&BandGap> for ForbiddenBandCheck {
    fn from(gap: &BandGap) -> Self {
        let BandGap { polarisation, from, to, nearest, agrees } = *gap;
        Self { polarisation: polarisation.name(), from, to, nearest, agrees }
    }
}
