//! Checks of solids: branches of all waves as predicted by the analysis, expected of the scheme, and measured.

use super::blocks::BlocksCheck;
use super::max_or_nan;
use crate::case::{Material, WaveNumbers};
use crate::setup::check::blocks::BlocksPlan;
use crate::setup::check::locate_agreement_error;
use crate::setup::check::solid::{MediumPlan, WavePlan};
use crate::study::ProgressCallback;
use crate::study::dispersion::WaveVector;
use crate::{Error, setup};
use agreement::fit::Rate;
use agreement::solids::{
    BandGap, BranchResult, GridResult, WaveResponse, compare_band_gaps, compare_branches,
};
use analysis::solids::{BranchGroup, group_branches};
use models::elastoplastic::Solid;
use serde::{Serialize, Serializer};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Check result of a solid.
#[derive(Clone, Debug, Serialize)]
pub struct SolidCheck {
    /// Check of each medium.
    pub media: Vec<MediumCheck>,
    /// Check of each periodic medium of blocks and joints; empty without joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub blocks: Vec<BlocksCheck>,
}

/// Check result of a medium.
#[derive(Clone, Debug, Serialize)]
pub struct MediumCheck {
    /// Key of the region in the case, such as `region[0]`; empty if the case has no regions.
    #[serde(rename = "place")]
    pub region_key: String,
    /// Title of the medium.
    #[serde(rename = "model")]
    pub medium_title: String,
    /// Whether all measured branches agree and all forbidden bands are confirmed; `None` without measurement.
    pub agrees: Option<bool>,
    /// Check of each branch of each wave.
    pub rows: Vec<BranchCheck>,
    /// Check results of the forbidden bands of an elastic solid between two nonzero frequencies, in the direction of
    /// the first wave; empty for yielding solids.
    pub forbidden_bands: Vec<ForbiddenBandCheck>,
    /// Solid with its yield set and stress.
    #[serde(skip)]
    pub solid: Solid,
    /// Predicted branches in the direction of the first wave, one entry per response.
    #[serde(skip)]
    pub branches: Vec<(WaveResponse, Vec<BranchGroup>)>,
}

/// Check of a branch at one wave vector.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BranchCheck {
    /// Response of the solid: elastic, loading or unloading.
    #[serde(serialize_with = "serialize_response_name")]
    pub response: WaveResponse,
    /// Name of the branch.
    pub branch: String,
    /// Wave vector of the wave.
    pub wave: WaveVector,
    /// Complex frequency predicted by the analysis.
    pub predicted: ComplexFrequency,
    /// Measurement extrapolated to zero cell size; `None` without measurement.
    pub limit: Option<GridCheck>,
    /// Measurements by grid, coarsest first; empty without measurement.
    pub grids: Vec<GridCheck>,
    /// Reason why there is no measurement; `None` if there is one.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
    /// Order of convergence in the cell size; `None` if the error is at the level of rounding, or without measurement.
    pub order: Option<f64>,
    /// Whether measured and expected rates agree on every grid and in the limit of zero cell size; `None` without
    /// measurement.
    pub agrees: Option<bool>,
    /// Measured minus predicted rate in the limit of zero cell size, relative to the predicted frequency; `None`
    /// without measurement.
    #[serde(skip)]
    pub difference: Option<Rate>,
    /// Expected minus predicted rate in the limit of zero cell size, relative to the predicted frequency; the expected
    /// rate follows from the amplification matrix of the scheme. `None` without measurement.
    #[serde(skip)]
    pub expected_difference: Option<Rate>,
}

/// Complex frequency of a wave: angular frequency and growth rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComplexFrequency {
    /// Angular frequency ω, rad/s.
    pub frequency: f64,
    /// Growth rate γ, 1/s.
    pub growth_rate: f64,
}

/// Rate measured on a grid, compared with the rate expected of the scheme on that grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GridCheck {
    /// Cells per period along each axis; `None` in the limit of zero cell size.
    #[serde(rename = "cells")]
    pub cells_per_period: Option<usize>,
    /// Measured angular frequency ω, rad/s.
    pub frequency: f64,
    /// Measured growth rate γ, 1/s.
    pub growth_rate: f64,
    /// Angular frequency ω expected from the amplification matrix of the scheme, rad/s.
    pub expected_frequency: f64,
    /// Growth rate γ expected from the amplification matrix of the scheme, 1/s.
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
    #[serde(rename = "from")]
    pub lower_edge: f64,
    /// Upper edge of the band, rad/s.
    #[serde(rename = "to")]
    pub upper_edge: f64,
    /// Measured frequencies next to the band, rad/s: the largest one below its upper edge and the smallest one above
    /// its lower edge; `None` where there is no such frequency.
    #[serde(rename = "nearest")]
    pub nearest_frequencies: [Option<f64>; 2],
    /// Whether no measured frequency is inside the band, within discretisation error and tolerance.
    pub agrees: bool,
}

fn serialize_response_name<S: Serializer>(
    response: &WaveResponse,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(response.name())
}

/// Checks all media of a solid, and its periodic media of blocks and joints; `material`: material of the case.
pub(super) fn check_solid(
    (media, blocks): (Vec<MediumPlan>, Vec<BlocksPlan>),
    material: &Material,
    on_progress: ProgressCallback,
) -> Result<SolidCheck, Error> {
    let mut progress = SeriesProgress { on_progress, before: 0, left: media.len() + blocks.len() };
    let mut checked = SolidCheck { media: Vec::new(), blocks: Vec::new() };
    for medium in media {
        checked.media.push(progress.run(|own| MediumCheck::new(medium, own))?);
    }
    for plan in blocks {
        checked.blocks.push(progress.run(|own| BlocksCheck::new(plan, material, own))?);
    }
    Ok(checked)
}

/// Progress of a series of checks.
struct SeriesProgress<'a> {
    on_progress: ProgressCallback<'a>,
    /// Number of tasks of the checks before.
    before: usize,
    /// Number of checks that are left, with the present one.
    left: usize,
}

impl SeriesProgress<'_> {
    /// Runs a check. The number of tasks of the next checks is not known yet; for each it is assumed to be that of this
    /// one.
    fn run<T>(
        &mut self,
        check: impl FnOnce(ProgressCallback) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let tasks = AtomicUsize::new(0);
        let (before, left) = (self.before, self.left);
        let on_progress = |done: usize, all: usize| {
            tasks.store(all, Ordering::Relaxed);
            (self.on_progress)(before + done, before + all * left)
        };
        let found = check(&on_progress)?;
        self.before += tasks.into_inner();
        self.left -= 1;
        Ok(found)
    }
}

/// Compares the branches of the waves of a solid, predicted for the material `predicted` and measured for the material
/// `measured`. The two differ only in tests, which verify that the check detects a difference.
///
/// # Errors
/// A material is invalid, the solver does not support it, or the study was cancelled.
pub fn compute_branch_results(
    predicted: &Material,
    measured: &Material,
    plan: &WavePlan,
    on_progress: ProgressCallback,
) -> Result<Vec<BranchResult>, Error> {
    let solid =
        setup::solid::create_solid(predicted).map_err(|error| predicted.locate_error(error))?;
    let medium = setup::solid::create_medium(measured, solid.dimensions)
        .map_err(|error| measured.locate_error(error))?;
    compare_branches(&solid, &medium, &plan.plane_waves(), &plan.settings, on_progress)
        .map_err(|error| locate_agreement_error(predicted, error))
}

impl SolidCheck {
    /// Returns whether all measurements agree; `None` without any.
    pub fn agrees(&self) -> Option<bool> {
        let media = self.media.iter().filter_map(|own| own.agrees);
        let all: Vec<bool> = media.chain(self.blocks.iter().filter_map(|own| own.agrees)).collect();
        (!all.is_empty()).then(|| all.into_iter().all(|own| own))
    }

    /// Returns the number of branches and forbidden bands, and the number that disagree.
    pub fn row_counts(&self) -> [usize; 2] {
        let rows = || {
            let media = self.media.iter().flat_map(|own| &own.rows);
            media.chain(self.blocks.iter().flat_map(|own| &own.rows))
        };
        let bands = || self.media.iter().flat_map(|own| &own.forbidden_bands);
        let failed = rows().filter(|row| row.agrees == Some(false)).count()
            + bands().filter(|band| !band.agrees).count();
        [rows().count() + bands().count(), failed]
    }
}

impl MediumCheck {
    fn new(medium: MediumPlan, on_progress: ProgressCallback) -> Result<Self, Error> {
        let MediumPlan { region_key, material, waves: plan } = medium;
        let results = compute_branch_results(&material, &material, &plan, on_progress)?;
        let solid =
            setup::solid::create_solid(&material).map_err(|error| material.locate_error(error))?;
        let bands = compare_band_gaps(&solid, &plan.plane_waves(), &results)
            .map_err(|error| locate_agreement_error(&material, error))?;
        let rows: Vec<BranchCheck> = results
            .iter()
            .map(|result| BranchCheck::new(plan.waves[result.wave_index], result))
            .collect();
        let first =
            results.first().map_or(material.numbers.wave, |result| plan.waves[result.wave_index]);
        let greatest = rows.iter().map(|row| row.wave.wave_number).fold(0.0, f64::max);
        let responses: &[(WaveResponse, bool)] = match solid.plastic_state {
            None => &[(WaveResponse::Elastic, true)],
            Some(_) => &[(WaveResponse::Unloading, true), (WaveResponse::Loading, false)],
        };
        let mut predicted = Vec::new();
        for &(response, stays_elastic) in responses {
            let groups =
                group_branches(&solid, setup::solid::wave_normal(&first), greatest, stays_elastic)
                    .map_err(|error| setup::locate_state_error(&material, error.into()))?;
            predicted.push((response, groups));
        }
        let measured: Vec<bool> = rows.iter().filter_map(|row| row.agrees).collect();
        let all_agree =
            bands.iter().all(|band| band.is_confirmed) && measured.iter().all(|agrees| *agrees);
        Ok(Self {
            region_key,
            medium_title: material.medium().title(),
            agrees: (!measured.is_empty()).then_some(all_agree),
            rows,
            forbidden_bands: bands.iter().map(ForbiddenBandCheck::from).collect(),
            solid,
            branches: predicted,
        })
    }

    /// Returns the number of rows without measurement.
    pub fn unmeasured_count(&self) -> usize {
        self.rows.iter().filter(|row| row.unmeasured_reason.is_some()).count()
    }

    /// Returns the largest difference of a measured rate in the limit of zero cell size, relative to the predicted
    /// frequency; `None` without measurement.
    pub fn max_relative_difference(&self) -> Option<f64> {
        max_or_nan(self.relative_differences())
    }

    /// Returns the differences of measured rates, relative to the predicted frequencies.
    pub(super) fn relative_differences(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().filter_map(|row| Some(row.difference?.max_norm()))
    }
}

impl BranchCheck {
    fn new(wave: WaveNumbers, result: &BranchResult) -> Self {
        let measured = result.measurement.as_ref().ok();
        let limit = measured.map(|own| GridCheck::new(result, &own.limit));
        let grids = measured.iter().flat_map(|own| &own.grids);
        Self {
            response: result.response,
            branch: result.branch_label.clone(),
            wave: wave.into(),
            predicted: ComplexFrequency { frequency: result.predicted_frequency, growth_rate: 0.0 },
            limit: limit.map(|limit| GridCheck { cells_per_period: None, ..limit }),
            grids: grids.map(|grid| GridCheck::new(result, grid)).collect(),
            unmeasured_reason: result.measurement.as_ref().err().map(ToString::to_string),
            order: result.convergence_order(),
            agrees: result.is_within_tolerance(),
            difference: result.measured_difference(),
            expected_difference: result.expected_difference(),
        }
    }
}

impl GridCheck {
    fn new(row: &BranchResult, grid: &GridResult) -> Self {
        Self {
            cells_per_period: Some(grid.cells),
            frequency: grid.measured_rate.frequency,
            growth_rate: grid.measured_rate.growth_rate,
            expected_frequency: grid.expected_rate.frequency,
            expected_growth_rate: grid.expected_rate.growth_rate,
            difference: row.relative_difference(grid.measured_rate).frequency,
            tolerance: grid.tolerance,
            agrees: grid.is_within_tolerance(),
        }
    }
}

impl From<&BandGap> for ForbiddenBandCheck {
    fn from(gap: &BandGap) -> Self {
        Self {
            polarisation: gap.polarisation.name(),
            lower_edge: gap.lower_frequency,
            upper_edge: gap.upper_frequency,
            nearest_frequencies: gap.nearest_frequencies,
            agrees: gap.is_confirmed,
        }
    }
}
