//! Solids: plane waves of every branch.
//!
//! Each wave is sent through a periodic box of one period along each axis, on two or more grids, over one period in
//! time. Elastic waves run through a solid without stress. Where a solid yields, they run over a uniform background on
//! its yield surface: one that goes on flowing faster than the wave can unload it ([`Response::Loading`]), and one that
//! has just left it ([`Response::Unloading`]).

mod background;
mod branch;
mod experiment;
mod run;

pub use experiment::branch_results;

use crate::fit::Rate;
use crate::{AgreementError, NotMeasurable, PlaneWave};
use analysis::solids::branches;
use analysis::waves::Polarisation;
use dynamics::problem::{PlasticStep, Splitting};
use models::common::elementary::Elementary;
use models::elastoplastic::Solid;

/// The linearised equations that a solid obeys under a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// It has no yield set.
    Elastic,
    /// Its background has just left the yield surface.
    Unloading,
    /// Its background flows, and goes on flowing.
    Loading,
}

impl Response {
    /// Name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Unloading => "unloading",
            Self::Loading => "loading",
        }
    }
}

/// The grids and the time step of the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverSettings {
    /// Cells to a period along each axis, ascending.
    pub cells: Vec<usize>,
    /// Greatest Courant number c(Δt/2)/h of the fastest wave.
    pub courant: f64,
    /// Greatest rotation of spins in a step, rad.
    pub rotation: f64,
    /// Place of the plastic correction in the step.
    pub plastic_step: PlasticStep,
    /// The order of sweeps.
    pub splitting: Splitting,
}

/// A branch at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchResult {
    /// Index of its wave among those given.
    pub wave: usize,
    /// Which equations hold.
    pub response: Response,
    /// Name of the branch.
    pub branch: String,
    /// Predicted frequency, rad/s; no wave grows.
    pub predicted: f64,
    /// By the solver, or why there is no measurement.
    pub measured: Result<Measurement, NotMeasurable>,
}

/// Rates of a wave in the solver.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// By grid, the coarsest first.
    pub grids: Vec<GridResult>,
    /// In the limit of small cells.
    pub limit: GridResult,
}

/// Rates on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridResult {
    /// Cells to a period along each axis; 0 in the limit of small cells.
    pub cells: usize,
    /// Measured.
    pub measured: Rate,
    /// By the symbol of the scheme: the prediction with its discretisation error.
    pub expected: Rate,
    /// Bound on their difference by rounding, and on curved yield surfaces by the turn of their normal in the wave, 1/s.
    pub tolerance: f64,
}

impl GridResult {
    /// Whether measured and expected rates agree.
    pub fn agrees(&self) -> bool {
        (self.measured - self.expected).max_norm() <= self.tolerance
    }
}

impl BranchResult {
    /// Whether it agrees on every grid and in the limit; `None` where there is no measurement.
    pub fn agrees(&self) -> Option<bool> {
        let own = self.measured.as_ref().ok()?;
        Some(own.grids.iter().chain([&own.limit]).all(GridResult::agrees))
    }

    /// Measured minus predicted rate in the limit of small cells, relative to the predicted frequency; `None` where
    /// there is no measurement.
    pub fn difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| self.relative(own.limit.measured))
    }

    /// The same by the symbol of the scheme.
    pub fn expected_difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| self.relative(own.limit.expected))
    }

    /// The difference of a rate from the predicted one, relative to the predicted frequency.
    pub fn relative(&self, rate: Rate) -> Rate {
        let difference = rate - Rate { frequency: self.predicted, growth: 0.0 };
        Rate {
            frequency: difference.frequency / self.predicted,
            growth: difference.growth / self.predicted,
        }
    }

    /// The order of convergence of the measured rate from the coarsest grid to the finest; `None` where the error is
    /// rounding.
    pub fn order(&self) -> Option<f64> {
        let own = self.measured.as_ref().ok()?;
        let [first, .., last] = own.grids.as_slice() else { return None };
        let error = |grid: &GridResult| self.relative(grid.measured).max_norm();
        let is_known = |grid: &GridResult| {
            error(grid) * self.predicted > 10.0 * grid.tolerance && error(grid) > 0.0
        };
        (is_known(first) && is_known(last)).then(|| {
            (error(first) / error(last)).cr_ln() / (last.cells as f64 / first.cells as f64).cr_ln()
        })
    }
}

/// Frequencies at which no wave of a polarisation propagates, and whether none was measured there.
#[derive(Clone, Debug, PartialEq)]
pub struct BandGap {
    /// The polarisation.
    pub polarisation: Polarisation,
    /// Lower end, rad/s.
    pub from: f64,
    /// Upper end, rad/s.
    pub to: f64,
    /// The measured frequencies next to it, below and above, rad/s.
    pub nearest: [Option<f64>; 2],
    /// Whether none was measured inside.
    pub agrees: bool,
}

/// The band gaps of an elastic solid, held against the results of [`branch_results`] for waves.
///
/// # Errors
/// There is no rate of response.
pub fn band_gaps(
    solid: &Solid,
    waves: &[PlaneWave<3>],
    results: &[BranchResult],
) -> Result<Vec<BandGap>, AgreementError> {
    let first = results.first().filter(|result| result.response == Response::Elastic);
    let Some(wave) = first.and_then(|result| waves.get(result.wave)) else {
        return Ok(Vec::new());
    };
    let groups = branches(solid, wave.normal, wave.number, true)?;
    let bands = groups.iter().flat_map(|group| {
        let inner = group.bands.iter().filter(|band| band.from > 0.0 && band.to.is_finite());
        inner.map(move |band| (group.family.polarisation, *band))
    });
    Ok(bands
        .map(|(polarisation, band)| {
            let own = || {
                let named =
                    results.iter().filter(|own| own.branch.starts_with(polarisation.name()));
                named.filter_map(|own| Some((own.predicted, own.measured.as_ref().ok()?.limit)))
            };
            let measured = || own().map(|(_, limit)| limit.measured.frequency);
            let is_inside = |(predicted, limit): (f64, GridResult)| {
                let off = (limit.expected.frequency - predicted).abs() + limit.tolerance;
                let found = limit.measured.frequency;
                !(found <= band.from + off || found >= band.to - off)
            };
            BandGap {
                polarisation,
                from: band.from,
                to: band.to,
                nearest: [
                    measured().filter(|f| *f < band.to).max_by(f64::total_cmp),
                    measured().filter(|f| *f > band.from).min_by(f64::total_cmp),
                ],
                agrees: !own().any(is_inside),
            }
        })
        .collect())
}
