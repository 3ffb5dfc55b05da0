//! Checks of blocky media: Bloch waves predicted by the analysis and measured by the solver.

use super::max_with_nan_largest;
use super::solid::{BranchCheck, ComplexFrequency, GridCheck};
use crate::Error;
use crate::case::Material;
use crate::setup::check::blocks::{BlockyMediumExperiment, BlockyMediumPlan};
use crate::setup::check::locate_agreement_error;
use crate::study::ProgressCallback;
use crate::study::dispersion::WaveVector;
use agreement::blocks::{BlochResult, BlockWave, compare_blocks};
use agreement::fit::Rate;
use agreement::solids::{GridResult, WaveResponse};
use analysis::bloch::chain::ChainPolarisation;
use models::common::elementary::Elementary;
use serde::Serialize;

/// Check result of one periodic blocky medium.
#[derive(Clone, Debug, Serialize)]
pub struct BlockyMediumCheck {
    /// Key of the section in the case that describes the blocks, such as `block[0]`.
    #[serde(rename = "place")]
    pub section_key: String,
    /// Description of the blocks and of the layers in their joints.
    #[serde(rename = "model")]
    pub medium_title: String,
    /// Whether all measured branches agree; `None` without measurement.
    #[serde(rename = "agrees")]
    pub is_in_agreement: Option<bool>,
    /// Check of each branch of each wave: first those of chains, by axis and wave number, then those of waves in the
    /// plane.
    #[serde(rename = "rows")]
    pub branch_checks: Vec<BranchCheck>,
    /// Reason why no wave of this medium is measured; `None` if waves are measured.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
}

impl BlockyMediumCheck {
    pub(super) fn new(
        plan: BlockyMediumPlan,
        material: &Material,
        on_progress: ProgressCallback,
    ) -> Result<Self, Error> {
        let BlockyMediumPlan { section_key: region_key, medium_title: title, experiment } = plan;
        let (rows, unmeasured_reason) = match experiment {
            Err(reason) => (Vec::new(), Some(reason)),
            Ok(own) => {
                let BlockyMediumExperiment {
                    analysis_medium: predicted,
                    solver_medium: measured,
                    settings,
                } = own;
                let found = compare_blocks(&predicted, &measured, &settings, on_progress)
                    .map_err(|error| locate_agreement_error(material, error))?;
                let materials = predicted.materials.len();
                (found.iter().map(|own| create_branch_check(own, materials)).collect(), None)
            }
        };
        let measured: Vec<bool> =
            rows.iter().filter_map(|row: &BranchCheck| row.is_in_agreement).collect();
        let is_in_agreement =
            (!measured.is_empty()).then(|| measured.iter().all(|is_in_agreement| *is_in_agreement));
        Ok(Self {
            section_key: region_key,
            medium_title: title,
            is_in_agreement,
            branch_checks: rows,
            unmeasured_reason,
        })
    }

    /// Returns the number of branches without measurement; 1 if no wave of the medium is measured at all.
    pub fn unmeasured_count(&self) -> usize {
        let rows = self.branch_checks.iter().filter(|row| row.unmeasured_reason.is_some()).count();
        rows + usize::from(self.unmeasured_reason.is_some())
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

fn create_branch_check(result: &BlochResult, materials: usize) -> BranchCheck {
    let measured = result.measurement.as_ref().ok();
    let limit = measured.map(|own| create_grid_check(result, &own.limit));
    let grids = measured.iter().flat_map(|own| &own.grids);
    let difference = |rate: fn(&GridResult) -> Rate| {
        measured.map(|own| result.relative_difference(rate(&own.limit)))
    };
    let [x, y] = result.wave_vector;
    BranchCheck {
        response: WaveResponse::Elastic,
        branch_label: format_branch_label(result, materials),
        wave: WaveVector {
            wave_number: x.root_sum_square(y),
            direction_deg: y.cr_atan2(x).to_degrees(),
            elevation_deg: 0.0,
        },
        predicted_frequency: ComplexFrequency {
            angular_frequency: result.predicted_rate.frequency,
            growth_rate: result.predicted_rate.growth_rate,
        },
        extrapolated_result: limit.map(|limit| GridCheck { cells_per_period: None, ..limit }),
        grid_results: grids.map(|grid| create_grid_check(result, grid)).collect(),
        unmeasured_reason: result.measurement.as_ref().err().map(ToString::to_string),
        convergence_order: result.convergence_order(),
        is_in_agreement: result.is_within_tolerance(),
        measured_difference: difference(|limit| limit.measured_rate),
        expected_difference: difference(|limit| limit.expected_rate),
    }
}

fn create_grid_check(result: &BlochResult, grid: &GridResult) -> GridCheck {
    GridCheck {
        cells_per_period: Some(grid.cells),
        frequency: grid.measured_rate.frequency,
        growth_rate: grid.measured_rate.growth_rate,
        expected_frequency: grid.expected_rate.frequency,
        expected_growth_rate: grid.expected_rate.growth_rate,
        relative_frequency_error: result.relative_difference(grid.measured_rate).frequency,
        tolerance: grid.tolerance,
        is_in_agreement: grid.is_within_tolerance(),
    }
}

/// Formats the name of a branch, counted from 1, with the number of the block if the blocks have several materials.
fn format_branch_label(result: &BlochResult, materials: usize) -> String {
    let branch = result.branch + 1;
    match result.wave {
        BlockWave::Cell => format!("blocks, branch {branch}"),
        BlockWave::Chain { polarisation, .. } => {
            let wave = match polarisation {
                ChainPolarisation::Longitudinal => "longitudinal",
                ChainPolarisation::Transverse => "transverse",
            };
            let block =
                if materials > 1 { format!(", block {}", result.block + 1) } else { "".into() };
            format!("chain{block}, {wave}, branch {branch}")
        }
    }
}
