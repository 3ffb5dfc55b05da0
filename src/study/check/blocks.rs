//! Checks of blocky media: Bloch waves as predicted by the analysis, and measured.

use super::max_or_nan;
use super::solid::{BranchCheck, ComplexFrequency, GridCheck};
use crate::Error;
use crate::case::Material;
use crate::setup::check::blocks::{BlocksExperiment, BlocksPlan};
use crate::setup::check::locate_agreement_error;
use crate::study::ProgressCallback;
use crate::study::dispersion::WaveVector;
use agreement::blocks::{BlochResult, BlockWave, compare_blocks};
use agreement::fit::Rate;
use agreement::solids::{GridResult, WaveResponse};
use analysis::bloch::chain::ChainPolarisation;
use models::common::elementary::Elementary;
use serde::Serialize;

/// Check result of a periodic blocky medium.
#[derive(Clone, Debug, Serialize)]
pub struct BlocksCheck {
    /// Key of the blocks in the case, such as `block[0]`.
    #[serde(rename = "place")]
    pub region_key: String,
    /// Layers and blocks in words.
    #[serde(rename = "model")]
    pub title: String,
    /// Whether all measured branches agree; `None` without measurement.
    pub agrees: Option<bool>,
    /// Check of each branch of each wave: of chains by axis and wave number, then of waves in the plane.
    pub rows: Vec<BranchCheck>,
    /// Reason why waves are not measured; `None` if they are.
    #[serde(rename = "not_measurable")]
    pub unmeasured_reason: Option<String>,
}

impl BlocksCheck {
    pub(super) fn new(
        plan: BlocksPlan,
        material: &Material,
        on_progress: ProgressCallback,
    ) -> Result<Self, Error> {
        let BlocksPlan { region_key, title, experiment } = plan;
        let (rows, unmeasured_reason) = match experiment {
            Err(reason) => (Vec::new(), Some(reason)),
            Ok(own) => {
                let BlocksExperiment { predicted, measured, settings } = own;
                let found = compare_blocks(&predicted, &measured, &settings, on_progress)
                    .map_err(|error| locate_agreement_error(material, error))?;
                let materials = predicted.materials.len();
                (found.iter().map(|own| create_row(own, materials)).collect(), None)
            }
        };
        let measured: Vec<bool> = rows.iter().filter_map(|row: &BranchCheck| row.agrees).collect();
        let agrees = (!measured.is_empty()).then(|| measured.iter().all(|agrees| *agrees));
        Ok(Self { region_key, title, agrees, rows, unmeasured_reason })
    }

    /// Returns the number of rows without measurement; 1 if there is no row.
    pub fn unmeasured_count(&self) -> usize {
        let rows = self.rows.iter().filter(|row| row.unmeasured_reason.is_some()).count();
        rows + usize::from(self.unmeasured_reason.is_some())
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

fn create_row(result: &BlochResult, materials: usize) -> BranchCheck {
    let measured = result.measurement.as_ref().ok();
    let limit = measured.map(|own| create_grid(result, &own.limit));
    let grids = measured.iter().flat_map(|own| &own.grids);
    let difference = |rate: fn(&GridResult) -> Rate| {
        measured.map(|own| result.relative_difference(rate(&own.limit)))
    };
    let [x, y] = result.wave_vector;
    BranchCheck {
        response: WaveResponse::Elastic,
        branch: name_branch(result, materials),
        wave: WaveVector {
            wave_number: x.root_sum_square(y),
            direction_deg: y.cr_atan2(x).to_degrees(),
            elevation_deg: 0.0,
        },
        predicted: ComplexFrequency {
            frequency: result.predicted_rate.frequency,
            growth_rate: result.predicted_rate.growth_rate,
        },
        limit: limit.map(|limit| GridCheck { cells_per_period: None, ..limit }),
        grids: grids.map(|grid| create_grid(result, grid)).collect(),
        unmeasured_reason: result.measurement.as_ref().err().map(ToString::to_string),
        order: result.convergence_order(),
        agrees: result.is_within_tolerance(),
        difference: difference(|limit| limit.measured_rate),
        expected_difference: difference(|limit| limit.expected_rate),
    }
}

fn create_grid(result: &BlochResult, grid: &GridResult) -> GridCheck {
    GridCheck {
        cells_per_period: Some(grid.cells),
        frequency: grid.measured_rate.frequency,
        growth_rate: grid.measured_rate.growth_rate,
        expected_frequency: grid.expected_rate.frequency,
        expected_growth_rate: grid.expected_rate.growth_rate,
        difference: result.relative_difference(grid.measured_rate).frequency,
        tolerance: grid.tolerance,
        agrees: grid.is_within_tolerance(),
    }
}

/// Name of a branch, counted from 1; with the number of the block if the blocks have several materials.
fn name_branch(result: &BlochResult, materials: usize) -> String {
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
