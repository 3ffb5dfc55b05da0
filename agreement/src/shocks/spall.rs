//! Reflection of a pulse at the free end of a granular column.

use super::column::{Column, ColumnGrid, ColumnState, EndCondition, TASKS};
use super::{ColumnResult, ShockResult, Tolerances};
use crate::{AgreementError, MeasurementError, ProgressCallback, TaskProgress};
use analysis::plane_shocks::column::{PulseShape, Spall};
use dynamics::boundary::Condition;
use dynamics::contact_law::ContactLaw;
use dynamics::medium::Medium;
use models::rheology::relaxation::SymmetricTensor;
use models::solid::waves::SolidField;

/// A pulse that meets the free end x₁ = 0 of a column at the time 0, exact and in the solver.
#[derive(Clone, Copy, Debug)]
pub struct SpallColumn<'a> {
    /// Granular medium of the solver, in the plane.
    pub medium: &'a Medium,
    /// Exact solution.
    pub spall: &'a Spall,
}

/// Length of the column relative to that of the pulse.
const LENGTH_FACTOR: f64 = 1.2;

/// Times at which fronts are measured, relative to the duration of the pulse: before the layer is complete.
const FRONT_TIMES: [f64; 2] = [0.15, 0.4];

/// Compares the reflection of a pulse at a free end on a column of `cells` cells.
///
/// # Errors
/// The inner error is the reason why the solver cannot measure; the outer one is that of a cancelled run.
pub fn compare_spall(
    own: &SpallColumn,
    cells: usize,
    on_progress: ProgressCallback,
) -> Result<Result<ColumnResult, MeasurementError>, AgreementError> {
    let progress = TaskProgress::new(on_progress, TASKS)?;
    let spall = own.spall;
    let duration = spall.duration();
    // The end of a rectangle is a front.
    let is_rectangle = spall.shape() == PulseShape::Rectangle;
    let (c, thickness) = (spall.sound_speed(), spall.thickness());
    let spacing = LENGTH_FACTOR * c * duration / cells as f64;
    let steps = (duration / (2.0 * spacing / own.medium.max_speed())).ceil();
    let grid = ColumnGrid { cells, spacing, step: duration / steps, steps: steps as usize };
    let mut column = match own.column(grid) {
        Ok(column) => column,
        Err(error) => return Ok(Err(error)),
    };
    let energy = column.energy();
    let mut states = Vec::new();
    for part in FRONT_TIMES {
        let step = (part * steps).round();
        column.advance_to(step as usize, &progress)?;
        states.push((column.state(), step * grid.step));
    }
    column.advance_to(grid.steps, &progress)?;
    let end = column.state();

    let tolerances = Tolerances::new(cells);
    let mut rows = Vec::new();
    let mut add_front = |name: &str, position: &dyn Fn(f64) -> f64| {
        let measure = |(state, time): &(ColumnState, f64)| {
            // The column moves with the velocities of both sides of the front.
            let here = position(*time);
            let sides = [0.9, 1.1].map(|factor| -spall.state(factor * here, *time).velocity);
            state.crossing(&state.velocity, 0.5 * (sides[0] + sides[1]), [0.8 * here, 1.2 * here])
        };
        let found = measure(&states[0]).zip(measure(&states[1]));
        let speed = found.map(|(first, last)| (last - first).abs() / (states[1].1 - states[0].1));
        rows.push(ShockResult {
            quantity: format!("speed of the {name}"),
            unit: "m/s",
            predicted: c,
            measured: Ok(speed.unwrap_or(f64::NAN)),
            scale: c,
            tolerance: tolerances.speed,
        });
    };
    add_front("release wave", &|time| c * time);
    if is_rectangle {
        add_front("end of the pulse", &|time| c * (duration - time));
    }
    let velocity: Vec<f64> = end.velocity.iter().map(|value| -value).collect();
    let greatest = spall.spall_velocity(0.0);
    let mut add_plateau = |name: &str, range: [f64; 2], predicted: f64| {
        let width = range[1] - range[0];
        let mean = end.mean(&velocity, [range[0] + 0.25 * width, range[1] - 0.25 * width]);
        rows.push(ShockResult {
            quantity: format!("velocity {name}"),
            unit: "m/s",
            predicted,
            measured: mean.ok_or_else(|| "too few cells".to_owned()),
            scale: greatest,
            tolerance: tolerances.plateau,
        });
    };
    add_plateau("of the layer", [0.0, thickness], spall.spall_velocity(0.5 * thickness));
    add_plateau("behind the layer", [thickness, 2.0 * thickness], 0.0);
    if is_rectangle {
        let found = end.crossing(&velocity, 0.5 * greatest, [0.5 * thickness, 1.5 * thickness]);
        rows.push(ShockResult {
            quantity: "thickness of the layer".into(),
            unit: "m",
            predicted: thickness,
            measured: Ok(found.unwrap_or(f64::NAN)),
            scale: thickness,
            tolerance: tolerances.speed,
        });
    }
    // v = 2f(2x/c): the integral over the layer from its end is that of f over twice the time.
    let layer_integral = |x: f64| {
        let part = (x / thickness).min(1.0);
        greatest * thickness * if is_rectangle { part } else { part * (1.0 - 0.5 * part) }
    };
    rows.push(ShockResult {
        quantity: "mean error of the velocity".into(),
        unit: "m/s",
        predicted: 0.0,
        measured: Ok(end.mean_error(&velocity, layer_integral) / thickness),
        scale: greatest,
        tolerance: tolerances.profile,
    });
    rows.push(ShockResult {
        quantity: "mean pressure that remains".into(),
        unit: "Pa",
        predicted: 0.0,
        measured: Ok(end.mean_error(&end.pressure, |_| 0.0) / thickness),
        scale: spall.pressure(),
        tolerance: tolerances.profile,
    });
    let [plastic, numerical] = column.dissipation();
    rows.push(ShockResult {
        quantity: "dissipation".into(),
        unit: "J/m²",
        predicted: 0.0,
        measured: Ok(plastic + numerical),
        scale: energy,
        tolerance: tolerances.dissipation,
    });
    let profile = end.velocity.iter().zip(&end.pressure).map(|(v, p)| [*v, *p]).collect();
    Ok(Ok(ColumnResult { cells, steps: grid.steps, rows, time: duration, spacing, profile }))
}

impl SpallColumn<'_> {
    /// Creates the column at the time 0, with the pulse in front of its free end.
    fn column(&self, grid: ColumnGrid) -> Result<Column, MeasurementError> {
        let end = EndCondition { condition: Condition::Traction(0.0), change: None };
        let mut column = Column::new(self.medium, grid, end)?;
        let Some(ContactLaw::Granular { law, closed, .. }) = &self.medium.contact else {
            return Ok(column);
        };
        let (spall, c) = (self.spall, self.spall.sound_speed());
        // Mean velocity of a cell: of a triangle that in its middle, but in the cell where the pulse ends.
        let velocity = |cell: usize| {
            let [from, to] = [cell, cell + 1].map(|own| own as f64 * grid.spacing);
            let end = (c * self.spall.duration()).min(to);
            let covered = (end - from).max(0.0) / grid.spacing;
            covered * spall.pulse_velocity(0.5 * (from + end).max(0.0) / c)
        };
        let state = |cell: usize| {
            let strain = -velocity(cell) / c;
            let moduli = [closed.lambda + 2.0 * closed.mu, closed.lambda, closed.lambda];
            let conditional =
                SymmetricTensor::<f64, 1> { normal: moduli.map(|own| own * strain), shear: [0.0] };
            law.complete_step(conditional, SymmetricTensor::ZERO)
        };
        column.set_field(SolidField::Velocity(0), |cell| -velocity(cell));
        for i in 0..3 {
            column.set_field(SolidField::Stress(i, i), |cell| state(cell).stress.normal[i]);
            column.set_field(SolidField::ExcessStress(i, i), |cell| state(cell).excess.normal[i]);
        }
        Ok(column)
    }
}
