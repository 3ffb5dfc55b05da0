//! Checks of solids: rates of all wave branches as predicted by the analysis, as expected of the numerical scheme, and
//! as measured by the solver.

use super::blocks::BlockyMediumCheck;
use super::max_with_nan_largest;
use crate::case::{Material, WaveNumbers};
use crate::setup::check::blocks::BlockyMediumPlan;
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

/// Check result of a solid: all its media, and the blocky media that its joints form.
#[derive(Clone, Debug, Serialize)]
pub struct SolidCheck {
    /// Check result of each homogeneous medium of the solid.
    #[serde(rename = "media")]
    pub medium_checks: Vec<MediumCheck>,
    /// Check result of each periodic medium of blocks and joints; empty without joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[serde(rename = "blocks")]
    pub blocky_medium_checks: Vec<BlockyMediumCheck>,
}

/// Check result of one homogeneous medium.
#[derive(Clone, Debug, Serialize)]
pub struct MediumCheck {
    /// Key of the region in the case, such as `region[0]`; empty if the case has no regions.
    #[serde(rename = "place")]
    pub region_key: String,
    /// Title of the medium in reports.
    #[serde(rename = "model")]
    pub medium_title: String,
    /// Whether all measured branches agree and all band gaps are confirmed; `None` without measurement.
    #[serde(rename = "agrees")]
    pub is_in_agreement: Option<bool>,
    /// Check of each branch of each wave.
    #[serde(rename = "rows")]
    pub branch_checks: Vec<BranchCheck>,
    /// Check results of the band gaps of an elastic solid between two nonzero frequencies, in the direction of the
    /// first wave; empty for yielding solids.
    #[serde(rename = "forbidden_bands")]
    pub band_gaps: Vec<BandGapCheck>,
    /// Solid of this medium with its yield set and stress.
    #[serde(skip)]
    pub solid: Solid,
    /// Predicted branches in the direction of the first wave, one entry per response.
    #[serde(skip)]
    pub predicted_branches: Vec<(WaveResponse, Vec<BranchGroup>)>,
}

/// Check of one branch of the dispersion relation at one wave vector.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BranchCheck {
    /// Response of the solid: elastic, loading or unloading.
    #[serde(serialize_with = "serialize_response_name")]
    pub response: WaveResponse,
    /// Name of the branch: polarisation and number.
    #[serde(rename = "branch")]
    pub branch_label: String,
    /// Wave vector at which the branch is checked.
    pub wave: WaveVector,
    /// Frequency and growth rate predicted by the analysis.
    #[serde(rename = "predicted")]
    pub predicted_frequency: ComplexFrequency,
    /// Measured rate, extrapolated to zero cell size; `None` without measurement.
    #[serde(rename = "limit")]
    pub extrapolated_result: Option<GridCheck>,
    /// Measured rates on each grid, coarsest grid first; empty without measurement.
    #[serde(rename = "grids")]
    pub grid_results: Vec<GridCheck>,
    /// Reason why there is no measurement; `None` if there is one.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
    /// Order of convergence in the cell size; `None` if the error is at the level of rounding, or without measurement.
    #[serde(rename = "order")]
    pub convergence_order: Option<f64>,
    /// Whether measured and expected rates agree on every grid and in the limit of zero cell size; `None` without
    /// measurement.
    #[serde(rename = "agrees")]
    pub is_in_agreement: Option<bool>,
    /// Measured minus predicted rate in the limit of zero cell size, relative to the predicted frequency; `None`
    /// without measurement.
    #[serde(skip)]
    pub measured_difference: Option<Rate>,
    /// Expected minus predicted rate in the limit of zero cell size, relative to the predicted frequency; the expected
    /// rate follows from the amplification matrix of the scheme. `None` without measurement.
    #[serde(skip)]
    pub expected_difference: Option<Rate>,
}

/// Complex frequency of a wave, as angular frequency and growth rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComplexFrequency {
    /// Angular frequency ω of the wave, rad/s.
    #[serde(rename = "frequency")]
    pub angular_frequency: f64,
    /// Growth rate γ of the wave, 1/s.
    pub growth_rate: f64,
}

/// Rate measured on a grid, compared with the rate expected of the scheme on that grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GridCheck {
    /// Cells per period along each axis; `None` in the limit of zero cell size.
    #[serde(rename = "cells")]
    pub cells_per_period: Option<usize>,
    /// Angular frequency ω measured by the solver, rad/s.
    pub frequency: f64,
    /// Growth rate γ measured by the solver, 1/s.
    pub growth_rate: f64,
    /// Angular frequency ω expected from the amplification matrix of the scheme, rad/s.
    pub expected_frequency: f64,
    /// Growth rate γ expected from the amplification matrix of the scheme, 1/s.
    pub expected_growth_rate: f64,
    /// Measured minus predicted frequency, relative to the predicted one.
    #[serde(rename = "difference")]
    pub relative_frequency_error: f64,
    /// Bound on the difference of measured and expected rates, 1/s.
    pub tolerance: f64,
    /// Whether measured and expected rates on this grid agree within `tolerance`.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
}

/// Check of a band gap: a frequency interval in which no wave of a polarisation propagates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BandGapCheck {
    /// Polarisation of the waves that do not propagate in the band gap.
    pub polarisation: &'static str,
    /// Lower edge of the band gap, rad/s.
    #[serde(rename = "from")]
    pub lower_edge: f64,
    /// Upper edge of the band gap, rad/s.
    #[serde(rename = "to")]
    pub upper_edge: f64,
    /// Measured frequencies nearest to the band gap, rad/s: the largest one below its upper edge and the smallest one
    /// above its lower edge; `None` where there is no such frequency.
    #[serde(rename = "nearest")]
    pub nearest_frequencies: [Option<f64>; 2],
    /// Whether no measured frequency is inside the band gap, within discretisation error and tolerance.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
}

fn serialize_response_name<S: Serializer>(
    response: &WaveResponse,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(response.name())
}

/// Checks all media of a solid, and the periodic media of its blocks and joints; `material` is the material of the
/// case, named in errors.
pub(super) fn check_solid(
    (media, blocks): (Vec<MediumPlan>, Vec<BlockyMediumPlan>),
    material: &Material,
    on_progress: ProgressCallback,
) -> Result<SolidCheck, Error> {
    let mut progress = CheckSeriesProgress {
        on_progress,
        completed_tasks: 0,
        remaining_checks: media.len() + blocks.len(),
    };
    let mut checked = SolidCheck { medium_checks: Vec::new(), blocky_medium_checks: Vec::new() };
    for medium in media {
        checked.medium_checks.push(progress.run(|own| MediumCheck::new(medium, own))?);
    }
    for plan in blocks {
        checked
            .blocky_medium_checks
            .push(progress.run(|own| BlockyMediumCheck::new(plan, material, own))?);
    }
    Ok(checked)
}

/// Progress of a series of checks that are run one after another.
struct CheckSeriesProgress<'a> {
    on_progress: ProgressCallback<'a>,
    /// Number of tasks of all checks that are complete.
    completed_tasks: usize,
    /// Number of checks that are not complete, including the one in progress.
    remaining_checks: usize,
}

impl CheckSeriesProgress<'_> {
    /// Runs one check. The numbers of tasks of later checks are not known yet; each is assumed to equal that of this
    /// check.
    fn run<T>(
        &mut self,
        check: impl FnOnce(ProgressCallback) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let tasks = AtomicUsize::new(0);
        let (before, left) = (self.completed_tasks, self.remaining_checks);
        let on_progress = |done: usize, all: usize| {
            tasks.store(all, Ordering::Relaxed);
            (self.on_progress)(before + done, before + all * left)
        };
        let found = check(&on_progress)?;
        self.completed_tasks += tasks.into_inner();
        self.remaining_checks -= 1;
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
    pub fn is_in_agreement(&self) -> Option<bool> {
        let media = self.medium_checks.iter().filter_map(|own| own.is_in_agreement);
        let all: Vec<bool> = media
            .chain(self.blocky_medium_checks.iter().filter_map(|own| own.is_in_agreement))
            .collect();
        (!all.is_empty()).then(|| all.into_iter().all(|own| own))
    }

    /// Returns the number of checked branches and band gaps, and the number of those that disagree.
    pub fn item_and_failure_counts(&self) -> [usize; 2] {
        let rows = || {
            let media = self.medium_checks.iter().flat_map(|own| &own.branch_checks);
            media.chain(self.blocky_medium_checks.iter().flat_map(|own| &own.branch_checks))
        };
        let bands = || self.medium_checks.iter().flat_map(|own| &own.band_gaps);
        let failed = rows().filter(|row| row.is_in_agreement == Some(false)).count()
            + bands().filter(|band| !band.is_in_agreement).count();
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
        let measured: Vec<bool> = rows.iter().filter_map(|row| row.is_in_agreement).collect();
        let all_in_agreement = bands.iter().all(|band| band.is_confirmed)
            && measured.iter().all(|is_in_agreement| *is_in_agreement);
        Ok(Self {
            region_key,
            medium_title: material.medium().title(),
            is_in_agreement: (!measured.is_empty()).then_some(all_in_agreement),
            branch_checks: rows,
            band_gaps: bands.iter().map(BandGapCheck::from).collect(),
            solid,
            predicted_branches: predicted,
        })
    }

    /// Returns the number of branches without measurement.
    pub fn unmeasured_count(&self) -> usize {
        self.branch_checks.iter().filter(|row| row.unmeasured_reason.is_some()).count()
    }

    /// Returns the largest difference of a measured rate in the limit of zero cell size, relative to the predicted
    /// frequency; `None` without measurement.
    pub fn max_relative_difference(&self) -> Option<f64> {
        max_with_nan_largest(self.relative_differences())
    }

    /// Iterates over the differences of measured rates in the limit of zero cell size, relative to the predicted
    /// frequencies.
    pub(super) fn relative_differences(&self) -> impl Iterator<Item = f64> {
        self.branch_checks.iter().filter_map(|row| Some(row.measured_difference?.max_norm()))
    }
}

impl BranchCheck {
    fn new(wave: WaveNumbers, result: &BranchResult) -> Self {
        let measured = result.measurement.as_ref().ok();
        let limit = measured.map(|own| GridCheck::new(result, &own.limit));
        let grids = measured.iter().flat_map(|own| &own.grids);
        Self {
            response: result.response,
            branch_label: result.branch_label.clone(),
            wave: wave.into(),
            predicted_frequency: ComplexFrequency {
                angular_frequency: result.predicted_frequency,
                growth_rate: 0.0,
            },
            extrapolated_result: limit.map(|limit| GridCheck { cells_per_period: None, ..limit }),
            grid_results: grids.map(|grid| GridCheck::new(result, grid)).collect(),
            unmeasured_reason: result.measurement.as_ref().err().map(ToString::to_string),
            convergence_order: result.convergence_order(),
            is_in_agreement: result.is_within_tolerance(),
            measured_difference: result.measured_difference(),
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
            relative_frequency_error: row.relative_difference(grid.measured_rate).frequency,
            tolerance: grid.tolerance,
            is_in_agreement: grid.is_within_tolerance(),
        }
    }
}

impl From<&BandGap> for BandGapCheck {
    fn from(gap: &BandGap) -> Self {
        Self {
            polarisation: gap.polarisation.name(),
            lower_edge: gap.lower_frequency,
            upper_edge: gap.upper_frequency,
            nearest_frequencies: gap.nearest_frequencies,
            is_in_agreement: gap.is_confirmed,
        }
    }
}
