//! Comparison for solids: plane waves of every branch.
//!
//! Each wave propagates in a periodic box of one wavelength along each axis, on two or more grids, over one period.
//! Elastic waves propagate in a stress-free solid. In a yielding solid the uniform background is on the yield surface
//! and flows faster than the wave can unload it ([`Response::Loading`]), or is slightly inside the yield surface
//! ([`Response::Unloading`]).

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

/// Response of a solid to a wave; selects the linearised equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Elastic solid without yield set.
    Elastic,
    /// Elastic unloading: the background is slightly inside the yield surface.
    Unloading,
    /// Plastic loading: plastic flow of the background continues.
    Loading,
}

impl Response {
    /// Name of the response in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Unloading => "unloading",
            Self::Loading => "loading",
        }
    }
}

/// Solver settings of the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverSettings {
    /// Numbers of cells per wavelength of the grids, ascending.
    pub cells: Vec<usize>,
    /// Maximum Courant number (CFL number) c(Δt/2)/h of the fastest wave.
    pub courant: f64,
    /// Maximum rotation angle of the spins per step, rad.
    pub rotation: f64,
    /// Plastic step: return mapping or midpoint reflection.
    pub plastic_step: PlasticStep,
    /// Dimensional splitting: order of the sweeps.
    pub splitting: Splitting,
}

/// Predicted and measured frequency of a branch at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchResult {
    /// Index of the wave in the list of waves.
    pub wave: usize,
    /// Response of the solid.
    pub response: Response,
    /// Name of the branch.
    pub branch: String,
    /// Predicted frequency, rad/s; the predicted growth rate is zero.
    pub predicted: f64,
    /// Rate measured in the solver, or the reason why it is missing.
    pub measured: Result<Measurement, NotMeasurable>,
}

/// Measured rates of a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Results by grid, coarsest first.
    pub grids: Vec<GridResult>,
    /// Result extrapolated to zero cell size.
    pub limit: GridResult,
}

/// Measured and expected rates on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridResult {
    /// Cells per wavelength; 0 for the extrapolated result.
    pub cells: usize,
    /// Measured rate.
    pub measured: Rate,
    /// Rate expected from the amplification matrix: the prediction including the discretisation error.
    pub expected: Rate,
    /// Bound on the difference of measured and expected rate, 1/s: rounding, and on curved yield surfaces the
    /// rotation of the normal in the wave.
    pub tolerance: f64,
}

impl GridResult {
    /// Whether measured and expected rate agree within the tolerance.
    pub fn agrees(&self) -> bool {
        (self.measured - self.expected).max_norm() <= self.tolerance
    }
}

impl BranchResult {
    /// Whether measured and expected rates agree on every grid and in the limit; `None` without measurement.
    pub fn agrees(&self) -> Option<bool> {
        let own = self.measured.as_ref().ok()?;
        Some(own.grids.iter().chain([&own.limit]).all(GridResult::agrees))
    }

    /// Extrapolated measured minus predicted rate, relative to the predicted frequency; `None` without measurement.
    pub fn difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| self.relative(own.limit.measured))
    }

    /// Extrapolated expected minus predicted rate, relative to the predicted frequency; `None` without measurement.
    pub fn expected_difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| self.relative(own.limit.expected))
    }

    /// Difference of a rate from the predicted one, relative to the predicted frequency.
    pub fn relative(&self, rate: Rate) -> Rate {
        let difference = rate - Rate { frequency: self.predicted, growth: 0.0 };
        Rate {
            frequency: difference.frequency / self.predicted,
            growth: difference.growth / self.predicted,
        }
    }

    /// Order of convergence of the measured rate between the coarsest and the finest grid; `None` if the error is at
    /// the level of rounding.
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

/// Band gap: frequencies at which no wave of a polarisation propagates, compared with the measured frequencies.
#[derive(Clone, Debug, PartialEq)]
pub struct BandGap {
    /// Polarisation of the waves.
    pub polarisation: Polarisation,
    /// Lower end, rad/s.
    pub from: f64,
    /// Upper end, rad/s.
    pub to: f64,
    /// Measured frequencies next to the gap: the largest below its upper end and the smallest above its lower end,
    /// rad/s.
    pub nearest: [Option<f64>; 2],
    /// Whether no measured frequency is in the gap, within the discretisation error and the tolerance.
    pub agrees: bool,
}

/// Band gaps of an elastic solid, compared with the results of [`branch_results`].
///
/// # Errors
/// The rate response of the solid is not defined.
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
