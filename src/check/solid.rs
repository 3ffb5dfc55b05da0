//! Solids: plane waves of every branch, by the analysis and by the solver.

mod send;

pub use send::rows;

use super::fit::Rate;
use crate::Error;
use crate::case::dynamics::{Correction, Splitting};
use crate::case::{Case, Wave};
use crate::dispersion::kinds;
use crate::setup;
use models::elementary::Elementary;

/// What a solid does under a wave.
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

/// What waves are sent, and on which grids.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The waves.
    pub waves: Vec<Wave>,
    /// Cells to a period along each axis, ascending.
    pub cells: Vec<usize>,
    /// c(Δt/2)/h of the fastest wave, at most.
    pub courant: f64,
    /// Turn of spins in a step at most, rad.
    pub rotation: f64,
    /// Where plastic flow stands in the step.
    pub correction: Correction,
    /// The order of sweeps.
    pub splitting: Splitting,
}

/// What was measured on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnGrid {
    /// Cells to a period along each axis.
    pub cells: usize,
    /// Measured.
    pub measured: Rate,
    /// What the scheme makes of the prediction: its discretisation error included.
    pub expected: Rate,
    /// By how much both may differ, rad/s: rounding, and on curved yield surfaces what the wave turns them.
    pub tolerance: f64,
}

/// A branch at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The wave vector.
    pub wave: Wave,
    /// Which equations hold.
    pub response: Response,
    /// Name of the branch.
    pub branch: String,
    /// Predicted frequency, rad/s; no wave grows.
    pub predicted: f64,
    /// By the solver, or why there is no measurement.
    pub measured: Result<Measured, String>,
}

/// What the solver makes of a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// By grid, the coarsest first.
    pub grids: Vec<OnGrid>,
    /// In the limit of small cells.
    pub limit: OnGrid,
}

impl OnGrid {
    /// Whether what was measured is what was to be expected.
    pub fn agrees(&self) -> bool {
        self.measured.less(self.expected).size() <= self.tolerance
    }
}

impl Row {
    /// Whether it agrees on every grid and in the limit; `None` where there is no measurement.
    pub fn agrees(&self) -> Option<bool> {
        let own = self.measured.as_ref().ok()?;
        Some(own.grids.iter().chain([&own.limit]).all(OnGrid::agrees))
    }

    /// Measured less predicted in the limit of small cells, as part of the predicted frequency; `None` where there is
    /// no measurement.
    pub fn difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| self.part(own.limit.measured))
    }

    /// The same as the scheme's symbol has it.
    pub fn expected_difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| self.part(own.limit.expected))
    }

    /// A rate less the predicted one, as part of the predicted frequency.
    pub fn part(&self, rate: Rate) -> Rate {
        let difference = rate.less(Rate { frequency: self.predicted, growth: 0.0 });
        Rate {
            frequency: difference.frequency / self.predicted,
            growth: difference.growth / self.predicted,
        }
    }

    /// By which power of the cell the measured error falls from the coarsest grid to the finest; `None` where
    /// it is rounding.
    pub fn order(&self) -> Option<f64> {
        let own = self.measured.as_ref().ok()?;
        let [first, .., last] = own.grids.as_slice() else { return None };
        let error = |grid: &OnGrid| self.part(grid.measured).size();
        let is_known = |grid: &OnGrid| {
            error(grid) * self.predicted > 10.0 * grid.tolerance && error(grid) > 0.0
        };
        (is_known(first) && is_known(last)).then(|| {
            (error(first) / error(last)).cr_ln() / (last.cells as f64 / first.cells as f64).cr_ln()
        })
    }
}

/// Frequencies at which no wave of some kind propagates, and whether that is what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// The kind of wave.
    pub polarisation: &'static str,
    /// Lower end, rad/s.
    pub from: f64,
    /// Upper end, rad/s.
    pub to: f64,
    /// The measured frequencies next to it, below and above, rad/s.
    pub nearest: [Option<f64>; 2],
    /// Whether none was measured inside.
    pub agrees: bool,
}

/// The forbidden bands of an elastic solid against what was measured.
///
/// # Errors
/// The case is wrong.
pub fn gaps(case: &Case, rows: &[Row]) -> Result<Vec<Gap>, Error> {
    let solid = setup::solid::solid(case).map_err(|error| case.locate(error))?;
    let Some(first) = rows.first().filter(|row| row.response == Response::Elastic) else {
        return Ok(Vec::new());
    };
    let kinds = kinds(&solid, &first.wave, first.wave.number, true)
        .map_err(|error| setup::locate(case, error))?;
    let bands = kinds.iter().flat_map(|kind| {
        let name = kind.family.polarisation.name();
        let inner = kind.bands.iter().filter(|band| band.from > 0.0 && band.to.is_finite());
        inner.map(move |band| (name, *band))
    });
    Ok(bands
        .map(|(name, band)| {
            let own = || {
                let named = rows.iter().filter(|row| row.branch.starts_with(name));
                named.filter_map(|row| Some((row.predicted, row.measured.as_ref().ok()?.limit)))
            };
            let measured = || own().map(|(_, limit)| limit.measured.frequency);
            let is_inside = |(predicted, limit): (f64, OnGrid)| {
                let off = (limit.expected.frequency - predicted).abs() + limit.tolerance;
                let found = limit.measured.frequency;
                !(found <= band.from + off || found >= band.to - off)
            };
            Gap {
                polarisation: name,
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
