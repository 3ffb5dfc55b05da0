//! Flows: waves that the mean flow carries along, by the analysis and by the solver; and what finer grids
//! make of one perturbation.

mod background;
mod refinement;
mod report;
mod waves;

use super::fit::Rate;
use crate::Error;
use crate::case::flow::{Disturbed, Initial};
use crate::case::{Case, Kind};
use crate::progress::Progress;
use analysis::growth::Verdict;
use background::Background;
use dynamics::flow::spectral::Mode;
use models::elementary::Elementary;
use models::granular_flow::InputError;
use rayon::prelude::*;
use refinement::refinement;
use std::f64::consts::TAU;
use waves::rows;

/// A wave of one wave vector at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Wave number, 1/m.
    pub number: f64,
    /// Direction from x₁, anticlockwise, degrees.
    pub direction_deg: f64,
}

impl Wave {
    fn vector(&self) -> [f64; 2] {
        let angle = crate::case::radians(self.direction_deg);
        [self.number * angle.cr_cos(), self.number * angle.cr_sin()]
    }

    /// A box of one wave, and the mode that it is there.
    fn fitted(&self) -> ([f64; 2], Mode) {
        let [k1, k2] = self.vector();
        // Nearly along an axis it is along the axis.
        let is_along = |own: f64| own.abs() < 1e-9 * self.number;
        match [k1, k2].map(is_along) {
            [true, _] => ([TAU / self.number; 2], [0, k2.signum() as i32]),
            [_, true] => ([TAU / self.number; 2], [k1.signum() as i32, 0]),
            _ => ([TAU / k1.abs(), TAU / k2.abs()], [k1.signum() as i32, k2.signum() as i32]),
        }
    }
}

/// A wave that grows, decays or oscillates: predicted and measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its wave vector at the beginning.
    pub wave: Wave,
    /// Its place among those of this wave vector, by descending growth at the beginning, from 1.
    pub mode: usize,
    /// Over which it was followed, s.
    pub duration: f64,
    /// By the linearised equations along k(t).
    pub predicted: Rate,
    /// By the frozen pencil.
    pub frozen: Rate,
    /// By the solver, or why there is no measurement.
    pub measured: Result<Measured, String>,
}

/// What the solver makes of a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Rates by numbers of steps, ascending.
    pub sequences: Vec<(usize, Rate)>,
    /// In the limit of small steps.
    pub limit: Rate,
    /// By how much the limit may be off: the error of the extrapolation, and rounding, 1/s.
    pub tolerance: f64,
}

impl Row {
    /// What differences are parts of: the rate, or that of the mean flow where that is greater, 1/s.
    pub fn scale(&self, shear_rate: f64) -> f64 {
        self.predicted.size().max(shear_rate)
    }

    /// Measured less predicted rate; `None` where there is no measurement.
    pub fn difference(&self) -> Option<Rate> {
        self.measured.as_ref().ok().map(|own| own.limit.less(self.predicted))
    }

    /// Whether measured and predicted rate agree; `None` where there is no measurement.
    pub fn agrees(&self) -> Option<bool> {
        let own = self.measured.as_ref().ok()?;
        Some(own.limit.less(self.predicted).size() <= own.tolerance)
    }

    /// By which power of the step the error falls; `None` where it is rounding.
    pub fn order(&self) -> Option<f64> {
        let own = self.measured.as_ref().ok()?;
        let [(few, coarse), .., (many, fine)] = own.sequences.as_slice() else { return None };
        let [first, last] = [coarse, fine].map(|own| own.less(self.predicted).size());
        (last > own.tolerance)
            .then(|| (first / last).cr_ln() / (*many as f64 / *few as f64).cr_ln())
    }
}

/// The fastest growing wave of one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Fastest {
    /// Points along each axis.
    pub points: [usize; 2],
    /// The mode.
    pub mode: Mode,
    /// Its wave number at the beginning, 1/m.
    pub number: f64,
    /// Its rate by the linearised equations along k(t), 1/s.
    pub predicted: f64,
    /// Its rate in the solver, 1/s.
    pub measured: f64,
}

/// What finer grids make of one perturbation in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// The model.
    pub kind: Kind,
    /// Its verdict's order; 0 where it is well-posed.
    pub limit: f64,
    /// Grid by grid.
    pub grids: Vec<Fastest>,
    /// |Γ|, in the sense of Q_D, 1/s.
    pub shear_rate: f64,
    /// The case's Δ, degrees, where this model can have none but 0.
    pub lost_noncoaxiality_deg: Option<f64>,
}

impl Refinement {
    /// Parts of the rate that measured and predicted ones may differ by.
    pub const TOLERANCE: f64 = 0.01;

    /// By how much the order on these grids may differ from that of the verdict, as k → ∞: less than half of what
    /// lies between orders of 1 and ½.
    pub const NEAR: f64 = 0.25;

    /// Whether this grid's rates agree.
    pub fn grid_agrees(&self, own: &Fastest) -> bool {
        let scale = own.predicted.abs().max(self.shear_rate);
        (own.measured - own.predicted).abs() <= Self::TOLERANCE * scale
    }

    /// Orders in the points of predicted and measured rates, by a fit to all grids; `None` where nothing grows
    /// faster than the mean flow deforms.
    pub fn orders(&self) -> Option<[f64; 2]> {
        let grows = |own: &Fastest| own.predicted.min(own.measured) > 3.0 * self.shear_rate;
        if self.grids.len() < 2 || !self.grids.iter().all(grows) {
            return None;
        }
        let points: Vec<f64> = self.grids.iter().map(|own| own.number.cr_ln()).collect();
        let slope = |value: fn(&Fastest) -> f64| {
            let values: Vec<f64> = self.grids.iter().map(|own| value(own).cr_ln()).collect();
            super::fit::slope(&points, &values)
        };
        Some([slope(|own| own.predicted), slope(|own| own.measured)])
    }

    /// Whether rates and orders agree, and the order is next to that of the verdict.
    pub fn agrees(&self) -> bool {
        let orders = match self.orders() {
            // On grids too coarse for growth there is no order.
            None => true,
            Some([predicted, measured]) => {
                (predicted - self.limit).abs() < Self::NEAR
                    && (measured - predicted).abs() <= Self::TOLERANCE * predicted
            }
        };
        orders && self.grids.iter().all(|own| self.grid_agrees(own))
    }
}

/// What was found of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// |Γ|, in the sense of Q_D, 1/s.
    pub shear_rate: f64,
    /// Waves.
    pub rows: Vec<Row>,
    /// What finer grids make of one perturbation, model by model.
    pub refinements: Vec<Refinement>,
}

impl Checked {
    /// Whether everything that was measured agrees; `None` where nothing was.
    pub fn agrees(&self) -> Option<bool> {
        let is_anything = self.rows.iter().any(|row| row.measured.is_ok());
        let [_, failed] = self.counts();
        (is_anything || !self.refinements.is_empty()).then_some(failed == 0)
    }

    /// Waves without a measurement, and why the first of them has none.
    pub fn unmeasured(&self) -> Option<(usize, &str)> {
        let mut reasons = self.rows.iter().filter_map(|row| row.measured.as_ref().err());
        reasons.next().map(|first| (1 + reasons.count(), first.as_str()))
    }

    /// Rows and refinements, and those that disagree.
    pub fn counts(&self) -> [usize; 2] {
        let failed = self.rows.iter().filter(|row| row.agrees() == Some(false)).count()
            + self.refinements.iter().filter(|own| !own.agrees()).count();
        [self.rows.len() + self.refinements.len(), failed]
    }

    /// The greatest difference of the rates of a measured wave, as part of the rate; `None` where none was measured.
    pub fn worst(&self) -> Option<f64> {
        let part = |row: &Row| Some(row.difference()?.size() / row.scale(self.shear_rate));
        super::greatest(self.rows.iter().filter_map(part))
    }
}

/// Checks the waves of a flow, and what grids make of a perturbation if the case asks for it.
///
/// # Errors
/// The case is none of a flow that is run in time, or a state cannot be analysed.
pub(super) fn check(case: &Case, waves: &[Wave], grids: &[usize]) -> Result<Checked, Error> {
    let background = Background::new(case)?;
    let kinds: Vec<Kind> = match (&case.flow, grids) {
        (None, _) | (_, []) => Vec::new(),
        _ => [case.kind].into_iter().chain(case.compare.iter().flatten().copied()).collect(),
    };
    let progress = Progress::new("check", (waves.len() + kinds.len() * grids.len()) as u64);
    let of_wave = |wave: &Wave| {
        let rows = rows(&background, *wave);
        progress.tick(1);
        rows
    };
    let all: Vec<Vec<Row>> = waves.par_iter().map(of_wave).collect::<Result<_, Error>>()?;
    let mut refinements = Vec::new();
    let is_velocity = |part: &Initial| match part {
        Initial::Mode(wave) | Initial::Packet { wave, .. } => wave.field == Disturbed::Velocity,
        Initial::Noise { field, .. } => *field == Disturbed::Velocity,
        Initial::Uniform { .. } | Initial::File { .. } => false,
    };
    if let (Some(run), true) = (&case.flow, kinds.len() > 1)
        && !run.initial.iter().all(is_velocity)
    {
        let found = "a perturbation of more than the velocity for several models".to_owned();
        let allowed = "parts with field = \"v\" alone, which all of them have".to_owned();
        return Err(case.locate(InputError { key: "initial", found, allowed }).into());
    }
    for kind in kinds {
        let noncoaxiality_deg = background.flow.noncoaxiality.to_degrees();
        let own = case.for_kind_with(kind, Some(noncoaxiality_deg));
        if let Some(run) = &case.flow {
            refinements.push(refinement(&own, run, grids, &progress)?);
        }
    }
    let shear_rate = background.flow.shear_rate;
    Ok(Checked { shear_rate, rows: all.into_iter().flatten().collect(), refinements })
}

/// The worst direction of an ill-posed state, degrees.
pub(super) fn worst_direction_deg(case: &Case) -> Result<Option<f64>, Error> {
    Ok(match Background::new(case)?.verdict {
        Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
        _ => None,
    })
}
