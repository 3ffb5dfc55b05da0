//! Solids: the waves that a case asks for, by the analysis and by the solver.

use super::setup::{locate, plane_wave};
use crate::case::{Case, Wave};
use crate::cli::progress::Progress;
use crate::{Error, setup};
use agreement::PlaneWave;
use agreement::solids::{BandGap, BranchResult, SolverSettings, band_gaps, branch_results};
use std::ops::ControlFlow;
use std::sync::OnceLock;

/// The waves of a medium, and how they are measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The waves.
    pub waves: Vec<Wave>,
    /// Grids and time step.
    pub settings: SolverSettings,
}

impl Plan {
    fn plane_waves(&self) -> Vec<PlaneWave<3>> {
        self.waves.iter().map(plane_wave).collect()
    }
}

/// The results of a solid, predicted by `predicted` and measured on `measured`, which is the same case but where
/// the check itself is tested.
///
/// # Errors
/// The case is wrong, or the solver does not take it.
pub fn rows(predicted: &Case, measured: &Case, plan: &Plan) -> Result<Vec<BranchResult>, Error> {
    let solid = setup::solid::solid(predicted).map_err(|error| predicted.locate(error))?;
    let medium =
        setup::solid::medium(measured, solid.dimensions).map_err(|error| measured.locate(error))?;
    let progress = OnceLock::new();
    let on_progress = |done: usize, total: usize| {
        let progress = progress.get_or_init(|| Progress::new("waves in time", total as u64));
        if done > 0 {
            progress.tick(1);
        }
        ControlFlow::Continue(())
    };
    branch_results(&solid, &medium, &plan.plane_waves(), &plan.settings, &on_progress)
        .map_err(|error| locate(predicted, error))
}

/// The forbidden bands of an elastic solid against the results.
///
/// # Errors
/// The case is wrong.
pub fn gaps(case: &Case, plan: &Plan, rows: &[BranchResult]) -> Result<Vec<BandGap>, Error> {
    let solid = setup::solid::solid(case).map_err(|error| case.locate(error))?;
    band_gaps(&solid, &plan.plane_waves(), rows).map_err(|error| locate(case, error))
}
