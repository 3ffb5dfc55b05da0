//! Comparison for solids: plane waves of every branch.
//!
//! Each wave propagates in a periodic box of one wavelength along each axis, on two or more grids, over one period.
//! Elastic waves propagate in a stress-free solid. In a yielding solid the uniform background is on the yield surface
//! and flows faster than the wave can unload it ([`WaveResponse::Loading`]), or is slightly inside the yield surface
//! ([`WaveResponse::Unloading`]).

mod background;
mod branch;
mod experiment;
mod simulation;

pub use experiment::compare_branches;

use crate::fit::Rate;
use crate::{AgreementError, MeasurementError, PlaneWave};
use analysis::solids::group_branches;
use analysis::waves::Polarisation;
use dynamics::problem::{PlasticStep, Splitting};
use models::common::elementary::Elementary;
use models::elastoplastic::Solid;

/// Response of a solid to a wave; selects the linearised equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveResponse {
    /// Elastic solid without yield set.
    Elastic,
    /// Elastic unloading: the background is slightly inside the yield surface.
    Unloading,
    /// Plastic loading: plastic flow of the background continues.
    Loading,
}

impl WaveResponse {
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
    pub cells_per_wavelength: Vec<usize>,
    /// Maximum Courant number (CFL number) c(Δt/2)/h of the fastest wave.
    pub courant_number: f64,
    /// Maximum rotation angle of the spins per step, rad.
    pub max_rotation: f64,
    /// Plastic step: return mapping or midpoint reflection.
    pub plastic_step: PlasticStep,
    /// Dimensional splitting: order of the sweeps.
    pub splitting: Splitting,
}

/// Predicted and measured frequency of a branch at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchResult {
    /// Index of the wave in the list of waves.
    pub wave_index: usize,
    /// Response of the solid.
    pub response: WaveResponse,
    /// Name of the branch.
    pub branch_label: String,
    /// Predicted frequency, rad/s; the predicted growth rate is zero.
    pub predicted_frequency: f64,
    /// Rate measured in the solver, or the reason why it is missing.
    pub measurement: Result<Measurement, MeasurementError>,
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
    pub measured_rate: Rate,
    /// Rate expected from the amplification matrix: the prediction including the discretisation error.
    pub expected_rate: Rate,
    /// Bound on the difference of measured and expected rate, 1/s: rounding, and on curved yield surfaces the
    /// rotation of the normal in the wave.
    pub tolerance: f64,
}

impl GridResult {
    /// Whether measured and expected rate agree within the tolerance.
    pub fn is_within_tolerance(&self) -> bool {
        (self.measured_rate - self.expected_rate).max_norm() <= self.tolerance
    }
}

impl BranchResult {
    /// Whether measured and expected rates agree on every grid and in the limit; `None` without measurement.
    pub fn is_within_tolerance(&self) -> Option<bool> {
        let own = self.measurement.as_ref().ok()?;
        Some(own.grids.iter().chain([&own.limit]).all(GridResult::is_within_tolerance))
    }

    /// Extrapolated measured minus predicted rate, relative to the predicted frequency; `None` without measurement.
    pub fn measured_difference(&self) -> Option<Rate> {
        self.measurement.as_ref().ok().map(|own| self.relative_difference(own.limit.measured_rate))
    }

    /// Extrapolated expected minus predicted rate, relative to the predicted frequency; `None` without measurement.
    pub fn expected_difference(&self) -> Option<Rate> {
        self.measurement.as_ref().ok().map(|own| self.relative_difference(own.limit.expected_rate))
    }

    /// Difference of a rate from the predicted one, relative to the predicted frequency.
    pub fn relative_difference(&self, rate: Rate) -> Rate {
        let difference = rate - Rate { frequency: self.predicted_frequency, growth_rate: 0.0 };
        Rate {
            frequency: difference.frequency / self.predicted_frequency,
            growth_rate: difference.growth_rate / self.predicted_frequency,
        }
    }

    /// Order of convergence of the measured rate between the coarsest and the finest grid; `None` without measurement,
    /// with one grid only, or if the error on one of the two is at most ten times its tolerance.
    pub fn convergence_order(&self) -> Option<f64> {
        let own = self.measurement.as_ref().ok()?;
        let [first, .., last] = own.grids.as_slice() else { return None };
        let error = |grid: &GridResult| self.relative_difference(grid.measured_rate).max_norm();
        let is_known = |grid: &GridResult| {
            error(grid) * self.predicted_frequency > 10.0 * grid.tolerance && error(grid) > 0.0
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
    pub lower_frequency: f64,
    /// Upper end, rad/s.
    pub upper_frequency: f64,
    /// Measured frequencies next to the gap: the largest below its upper end and the smallest above its lower end,
    /// rad/s; `None` if there is no such frequency.
    pub nearest_frequencies: [Option<f64>; 2],
    /// Whether no measured frequency is in the gap, within the discretisation error and the tolerance.
    pub is_confirmed: bool,
}

/// Band gaps of an elastic solid in the direction of the first wave of `results`, compared with these results of
/// [`compare_branches`]; empty if the results are not those of an elastic solid.
///
/// # Errors
/// The rate response of the solid is not defined.
pub fn compare_band_gaps(
    solid: &Solid,
    waves: &[PlaneWave<3>],
    results: &[BranchResult],
) -> Result<Vec<BandGap>, AgreementError> {
    let first = results.first().filter(|result| result.response == WaveResponse::Elastic);
    let Some(wave) = first.and_then(|result| waves.get(result.wave_index)) else {
        return Ok(Vec::new());
    };
    let groups = group_branches(solid, wave.normal, wave.wave_number, true)?;
    let bands = groups.iter().flat_map(|group| {
        let inner =
            group.band_gaps.iter().filter(|band| band.lower > 0.0 && band.upper.is_finite());
        inner.map(move |band| (group.family.polarisation, *band))
    });
    Ok(bands
        .map(|(polarisation, band)| {
            let own = || {
                let named =
                    results.iter().filter(|own| own.branch_label.starts_with(polarisation.name()));
                named.filter_map(|own| {
                    Some((own.predicted_frequency, own.measurement.as_ref().ok()?.limit))
                })
            };
            let measured = || own().map(|(_, limit)| limit.measured_rate.frequency);
            let is_inside = |(predicted, limit): (f64, GridResult)| {
                let off = (limit.expected_rate.frequency - predicted).abs() + limit.tolerance;
                let found = limit.measured_rate.frequency;
                !(found <= band.lower + off || found >= band.upper - off)
            };
            BandGap {
                polarisation,
                lower_frequency: band.lower,
                upper_frequency: band.upper,
                nearest_frequencies: [
                    measured().filter(|f| *f < band.upper).max_by(f64::total_cmp),
                    measured().filter(|f| *f > band.lower).min_by(f64::total_cmp),
                ],
                is_confirmed: !own().any(is_inside),
            }
        })
        .collect())
}
