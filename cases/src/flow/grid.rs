//! The sections `[grid]`, `[time]` and `[limits]` of a flow.

use crate::error::CaseError;
use crate::schema::{Form, Group, Item, Length, Order, Range, Type};
use crate::section::{Resolved, Section};
use models::common::fourier::greatest_modes;

/// Maximum number of grid points of a box.
pub const MAX_POINTS: usize = 1 << 28;

/// Minimum number of grid points along an axis.
pub const MIN_POINTS: usize = 8;

/// Schema of the section `[grid]`.
pub(super) const GRID: Form = Form::section(
    "grid",
    "a periodic box that moves with the mean flow, and its points",
    &[Group::always(&[
        Item::required(
            "cells",
            Type::Counts { length: [2, 2], least: MIN_POINTS, order: Order::Even },
            "",
            "[64, 64]",
            "points along each axis: even, at least 8",
        )
        .note("points along each axis"),
        Item::required(
            "length",
            Type::PerAxis(Length::Two),
            "m",
            "0.1",
            "edges of the box at the beginning; one number, or one for each axis",
        )
        .note("edges of the box at the beginning"),
    ])],
)
.required("a section [grid] with cells and length");

/// Schema of the section `[time]`.
pub(super) const TIME: Form = Form::section(
    "time",
    "how long the run lasts, and how accurate its steps are",
    &[Group::always(&[
        Item::required(
            "duration",
            Type::Number(Range::Positive),
            "s",
            "1e-3",
            "how long the run lasts",
        ),
        Item::with_default(
            "tolerance",
            Type::Number(Range::Below(1.0)),
            "",
            "1e-5",
            "error of a step relative to the perturbation",
        )
        .note("error of a step relative to the perturbation"),
        Item::with_default(
            "pressure_tolerance",
            Type::Number(Range::Below(1.0)),
            "",
            "1e-9",
            "residual of the equation of the pressure relative to its right-hand side",
        )
        .note("residual of the equation of the pressure relative to its right-hand side"),
    ])],
)
.required("a section [time] with duration in s");

/// Schema of the section `[limits]`, allowed for coaxial flows only.
pub(super) const LIMITS: Form = Form::section(
    "limits",
    "where a run stops",
    &[Group::always(&[Item::with_default(
        "shear_rate",
        Type::Number(Range::Below(1.0)),
        "",
        "1e-3",
        "least Q_D relative to that of the mean flow: the run stops there",
    )
    .note("least Q_D relative to that of the mean flow")])],
);

/// Grid of a periodic box that is convected with the mean flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Grid points along each axis; even, at least [`MIN_POINTS`].
    pub cells: [usize; 2],
    /// Initial edge lengths, m; positive.
    pub lengths: [f64; 2],
}

impl Grid {
    /// Returns the number of grid points.
    pub fn count(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Computes the largest mode numbers m₁ and m₂ of the Fourier modes exp(2πi(m₁y₁/L₁ + m₂y₂/L₂)) whose products are
    /// free of aliasing (two-thirds rule).
    pub fn greatest_modes(&self) -> [usize; 2] {
        greatest_modes(self.cells)
    }

    /// Returns the initial coordinate along `axis` of grid point `index`, m.
    pub fn position(&self, axis: usize, index: usize) -> f64 {
        (index as f64 + 0.5) * self.lengths[axis] / self.cells[axis] as f64
    }

    /// Computes the linear index, first axis fastest, of the grid point nearest to a position in the box.
    pub fn nearest(&self, at: &[f64]) -> usize {
        let index = |axis: usize| {
            let index = (at[axis] / self.lengths[axis] * self.cells[axis] as f64).floor();
            (index.max(0.0) as usize).min(self.cells[axis] - 1)
        };
        index(1) * self.cells[0] + index(0)
    }

    /// Reads the section `[grid]`.
    pub(super) fn read(root: &Section) -> Result<Self, CaseError> {
        let section = root.required_section(&GRID)?;
        if section.has("spacing") {
            let allowed = "give length, the edges of the box at the beginning in m, in its place";
            return Err(section.error("spacing", "found for a flow", allowed));
        }
        let cells: Vec<usize> = section.required("cells")?;
        let Ok(cells) = <[usize; 2]>::try_from(cells) else { return Err(section.wrong("cells")) };
        if cells[0].checked_mul(cells[1]).is_none_or(|count| count > MAX_POINTS) {
            let found = format!("{} × {} points", cells[0], cells[1]);
            let allowed = format!("expected at most {MAX_POINTS} in all");
            return Err(section.error("cells", found, allowed));
        }
        let lengths: Vec<f64> = section.required("length")?;
        let lengths = <[f64; 2]>::try_from(lengths).map_err(|_| section.wrong("length"))?;
        section.finish()?;
        Ok(Self { cells, lengths })
    }

    /// Formats the section `[grid]` as TOML with all values.
    pub(super) fn to_toml(self) -> String {
        Resolved::default().number("cells", self.cells).number("length", self.lengths).under(&GRID)
    }
}

/// Duration and tolerances of a flow simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// Duration, s; positive.
    pub duration: f64,
    /// Tolerance of the error per step relative to the perturbation; in (0, 1).
    pub tolerance: f64,
    /// Tolerance of the residual of the pressure equation relative to its right-hand side; in (0, 1).
    pub pressure_tolerance: f64,
}

impl Time {
    /// Reads the section `[time]`.
    pub(super) fn read(root: &Section) -> Result<Self, CaseError> {
        let section = root.required_section(&TIME)?;
        let duration = section.required("duration")?;
        let tolerance = section.or_default("tolerance")?;
        let pressure_tolerance = section.or_default("pressure_tolerance")?;
        section.finish()?;
        Ok(Self { duration, tolerance, pressure_tolerance })
    }

    /// Formats the section `[time]` as TOML with all values.
    pub(super) fn to_toml(self) -> String {
        Resolved::default()
            .number("duration", self.duration)
            .number("tolerance", self.tolerance)
            .number("pressure_tolerance", self.pressure_tolerance)
            .under(&TIME)
    }
}

/// Reads the lower limit of the shear rate from `[limits]`; 10⁻³ if absent.
pub(super) fn least_shear_rate(root: &Section) -> Result<f64, CaseError> {
    const DEFAULT: f64 = 1e-3;
    let Some(section) = root.section(&LIMITS)? else { return Ok(DEFAULT) };
    let least = section.or_default("shear_rate")?;
    section.finish()?;
    Ok(least)
}

/// Formats the section `[limits]` as TOML.
pub(super) fn limits_to_toml(least_shear_rate: f64) -> String {
    Resolved::default().number("shear_rate", least_shear_rate).under(&LIMITS)
}
