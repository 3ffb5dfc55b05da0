//! A column of cells of a medium with contacts, and measurements of its state.

use crate::{AgreementError, MeasurementError, TaskProgress};
use dynamics::boundary::{Boundary, Condition, Load, Signal};
use dynamics::line::Slopes;
use dynamics::medium::Medium;
use dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use dynamics::reference::Reference;
use models::solid::waves::SolidField;
use std::ops::Range;

/// Greatest number of updates of a cell by a step.
const MAX_UPDATES: f64 = 1e9;

/// Number of tasks of a run, for the progress.
pub(super) const TASKS: usize = 100;

/// Grid and time step of a column.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnGrid {
    /// Number of cells.
    pub(super) cells: usize,
    /// Length of a cell, m.
    pub(super) spacing: f64,
    /// Time step, s.
    pub(super) step: f64,
    /// Number of time steps of the run.
    pub(super) steps: usize,
}

/// Condition of the longitudinal waves at the lower end, with a change of its value from a time on, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndCondition {
    /// Condition from the time 0 on.
    pub(super) condition: Condition,
    /// Time, s, and change of the value.
    pub(super) change: Option<(f64, f64)>,
}

/// Column along x₁, one cell wide and periodic along x₂.
pub(super) struct Column {
    solver: Reference<f64, 2>,
    grid: ColumnGrid,
    /// Field of the volumetric strain, in porous media.
    is_porous: bool,
    /// Number of steps done.
    steps: usize,
}

/// State of a column by cell.
#[derive(Clone, Debug)]
pub(super) struct ColumnState {
    /// Length of a cell, m.
    pub(super) spacing: f64,
    /// Velocity v₁, m/s.
    pub(super) velocity: Vec<f64>,
    /// Pressure −σ₁₁, Pa.
    pub(super) pressure: Vec<f64>,
    /// Compression −tr ε; empty in granular media.
    pub(super) compression: Vec<f64>,
}

impl Column {
    /// Creates a column at rest without stress. Its upper end, which no wave must reach, is a plane of symmetry.
    pub(super) fn new(
        medium: &Medium,
        grid: ColumnGrid,
        end: EndCondition,
    ) -> Result<Self, MeasurementError> {
        let updates = grid.cells as f64 * grid.steps as f64;
        if updates > MAX_UPDATES {
            return Err(MeasurementError::TooManyUpdates { updates, max_updates: MAX_UPDATES });
        }
        let symmetry = Boundary::new_symmetry(medium, 0);
        let pair = medium.pairs[0].iter().position(|pair| pair.is_longitudinal()).unwrap_or(0);
        let mut lower = symmetry.clone();
        if let Boundary::ByPair(conditions) = &mut lower {
            conditions[pair] = end.condition;
        }
        let mut problem = Problem::new(
            Grid { cells: [grid.cells, 1], spacing: [grid.spacing; 2] },
            vec![medium.clone()],
            vec![0; grid.cells],
            [[lower, symmetry], [Boundary::Periodic, Boundary::Periodic]],
            grid.step,
            Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping),
        );
        if let Some((start, change)) = end.change {
            let signal: Signal =
                std::sync::Arc::new(move |time| f64::from(u8::from(time >= start)));
            problem.loads = vec![Load { axis: 0, end: 0, pair, faces: vec![(0, change)], signal }];
        }
        let solver = Reference::new(&problem)?;
        let is_porous = solver.fields().contains(&SolidField::VolumetricStrain);
        Ok(Self { solver, grid, is_porous, steps: 0 })
    }

    /// Sets a field by cell.
    pub(super) fn set_field(&mut self, field: SolidField, value: impl Fn(usize) -> f64) {
        let values: Vec<f64> = (0..self.grid.cells).map(value).collect();
        self.solver.set_field(field, &values);
    }

    /// Returns the energy per unit area of the cross-section, J/m².
    pub(super) fn energy(&self) -> f64 {
        self.solver.energy().total() / self.grid.spacing
    }

    /// Returns the plastic and the numerical dissipation per unit area of the cross-section, J/m².
    pub(super) fn dissipation(&self) -> [f64; 2] {
        let ledger = self.solver.ledger();
        [ledger.plastic_dissipation, ledger.numerical_dissipation]
            .map(|own| own / self.grid.spacing)
    }

    /// Advances to the step `steps`, and reports the progress.
    pub(super) fn advance_to(
        &mut self,
        steps: usize,
        progress: &TaskProgress,
    ) -> Result<(), AgreementError> {
        while self.steps < steps {
            self.solver.advance(1);
            let before = TASKS * self.steps / self.grid.steps;
            self.steps += 1;
            for _ in before..TASKS * self.steps / self.grid.steps {
                progress.advance()?;
            }
        }
        Ok(())
    }

    /// Returns the state, in which stresses obey their laws.
    pub(super) fn state(&self) -> ColumnState {
        let values = |field| self.solver.values(field).unwrap_or_default();
        let negative = |field| values(field).into_iter().map(|value| -value).collect();
        ColumnState {
            spacing: self.grid.spacing,
            velocity: values(SolidField::Velocity(0)),
            pressure: negative(SolidField::Stress(0, 0)),
            compression: match self.is_porous {
                true => negative(SolidField::VolumetricStrain),
                false => Vec::new(),
            },
        }
    }
}

impl ColumnState {
    /// Returns the cells whose centres lie between two positions, m.
    fn cells_between(&self, from: f64, to: f64) -> Range<usize> {
        let cell = |position: f64| {
            (position / self.spacing - 0.5).ceil().clamp(0.0, self.velocity.len() as f64) as usize
        };
        cell(from)..cell(to)
    }

    /// Returns the position where `values` cross `level` between two positions, m: the last crossing, interpolated
    /// between the centres of two cells; `None` if there is none.
    pub(super) fn crossing(&self, values: &[f64], level: f64, range: [f64; 2]) -> Option<f64> {
        let cells = self.cells_between(range[0], range[1]);
        let is_crossing = |cell: &usize| {
            let [one, other] = [values[*cell] - level, values[cell + 1] - level];
            (one < 0.0) != (other < 0.0)
        };
        let cell = (cells.start..cells.end.checked_sub(1)?).rev().find(is_crossing)?;
        let fraction = (level - values[cell]) / (values[cell + 1] - values[cell]);
        Some((cell as f64 + 0.5 + fraction) * self.spacing)
    }

    /// Returns the mean of `values` in an interval, m; `None` if it has less than [`MIN_PLATEAU_CELLS`] cells.
    pub(super) fn mean(&self, values: &[f64], [from, to]: [f64; 2]) -> Option<f64> {
        let cells = self.cells_between(from, to.max(from));
        let count = cells.len();
        (count >= MIN_PLATEAU_CELLS).then(|| values[cells].iter().sum::<f64>() / count as f64)
    }

    /// Returns the integral over x of |value − exact mean of the cell|; `exact_integral` is the exact integral from 0.
    pub(super) fn mean_error(&self, values: &[f64], exact_integral: impl Fn(f64) -> f64) -> f64 {
        let error = |(cell, value): (usize, &f64)| {
            let [from, to] = [cell, cell + 1].map(|own| own as f64 * self.spacing);
            (value * self.spacing - (exact_integral(to) - exact_integral(from))).abs()
        };
        values.iter().enumerate().map(error).sum()
    }
}

/// Least number of cells of a plateau.
const MIN_PLATEAU_CELLS: usize = 4;
