//! The sections `[grid]`, `[time]` and `[limits]` of a flow.

use crate::error::CaseError;
use crate::schema::{
    AllowedRange, CountConstraint, KeyGroup, KeySchema, ListLength, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};
use models::common::fourier::max_dealiased_modes;

/// Maximum number of grid points of a box.
pub const MAX_GRID_POINTS: usize = 1 << 28;

/// Minimum number of grid points along an axis.
pub const MIN_POINTS_PER_AXIS: usize = 8;

/// Schema of the section `[grid]`.
pub(super) const GRID_SCHEMA: TableSchema = TableSchema::new_section(
    "grid",
    "periodic box that is convected with the mean flow, and its grid points",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "cells",
            ValueType::CountList {
                length: [2, 2],
                minimum: MIN_POINTS_PER_AXIS,
                order: CountConstraint::Even,
            },
            "",
            "[64, 64]",
            "grid points along each axis; even, at least 8",
        )
        .with_note("grid points along each axis"),
        KeySchema::new_required(
            "length",
            ValueType::PerAxis(ListLength::Two),
            "m",
            "0.1",
            "edge lengths of the box at t = 0; one number, or one per axis",
        )
        .with_note("edge lengths of the box at t = 0"),
    ])],
)
.with_remedy("a section [grid] with cells and length");

/// Schema of the section `[time]`.
pub(super) const TIME_SCHEMA: TableSchema = TableSchema::new_section(
    "time",
    "duration and tolerances of the time steps",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "duration",
            ValueType::Number(AllowedRange::Positive),
            "s",
            "1e-3",
            "duration of the simulation",
        ),
        KeySchema::new_with_default(
            "tolerance",
            ValueType::Number(AllowedRange::PositiveBelow(1.0)),
            "",
            "1e-5",
            "tolerated error per time step, relative to the perturbation",
        )
        .with_note("tolerated error per time step, relative to the perturbation"),
        KeySchema::new_with_default(
            "pressure_tolerance",
            ValueType::Number(AllowedRange::PositiveBelow(1.0)),
            "",
            "1e-9",
            "tolerated residual of the pressure equation, relative to its right-hand side",
        )
        .with_note("tolerated residual of the pressure equation, relative to its right-hand side"),
    ])],
)
.with_remedy("a section [time] with duration in s");

/// Schema of the section `[limits]`, allowed for coaxial flows only.
pub(super) const LIMITS_SCHEMA: TableSchema = TableSchema::new_section(
    "limits",
    "stop criterion of the simulation",
    &[KeyGroup::new(&[KeySchema::new_with_default(
        "shear_rate",
        ValueType::Number(AllowedRange::PositiveBelow(1.0)),
        "",
        "1e-3",
        "lower limit of Q_D relative to the mean flow; the simulation stops at this limit",
    )
    .with_note("lower limit of Q_D relative to the mean flow")])],
);

/// Grid of a periodic box that is convected with the mean flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowGrid {
    /// Number of grid points along each axis; even, at least [`MIN_POINTS_PER_AXIS`].
    pub points: [usize; 2],
    /// Initial edge lengths, m; positive.
    pub lengths: [f64; 2],
}

impl FlowGrid {
    /// Returns the number of grid points.
    pub fn point_count(&self) -> usize {
        self.points[0] * self.points[1]
    }

    /// Computes the largest mode numbers m₁ and m₂ of the Fourier modes exp(2πi(m₁y₁/L₁ + m₂y₂/L₂)) whose products are
    /// free of aliasing (two-thirds rule); y is the initial position, L₁ and L₂ are the initial edge lengths, m.
    pub fn max_mode_numbers(&self) -> [usize; 2] {
        max_dealiased_modes(self.points)
    }

    /// Returns the initial coordinate along `axis` of grid point `index`, m.
    pub fn point_coordinate(&self, axis: usize, index: usize) -> f64 {
        (index as f64 + 0.5) * self.lengths[axis] / self.points[axis] as f64
    }

    /// Computes the linear index, first axis fastest, of the grid point nearest to a position in the box.
    pub fn nearest_point(&self, at: &[f64]) -> usize {
        let index = |axis: usize| {
            let index = (at[axis] / self.lengths[axis] * self.points[axis] as f64).floor();
            (index.max(0.0) as usize).min(self.points[axis] - 1)
        };
        index(1) * self.points[0] + index(0)
    }

    /// Reads the section `[grid]`.
    pub(super) fn read(root: &SectionReader) -> Result<Self, CaseError> {
        let section = root.open_required_section(&GRID_SCHEMA)?;
        if section.has_key("spacing") {
            let allowed = "give length, the edge lengths of the box at t = 0 in m, instead";
            return Err(section.key_error("spacing", "not used by a flow", allowed));
        }
        let cells: Vec<usize> = section.read_required("cells")?;
        let Ok(cells) = <[usize; 2]>::try_from(cells) else {
            return Err(section.invalid_value_error("cells"));
        };
        if cells[0].checked_mul(cells[1]).is_none_or(|count| count > MAX_GRID_POINTS) {
            let found = format!("{} × {} points", cells[0], cells[1]);
            let allowed = format!("expected at most {MAX_GRID_POINTS} in total");
            return Err(section.key_error("cells", found, allowed));
        }
        let lengths: Vec<f64> = section.read_required("length")?;
        let lengths =
            <[f64; 2]>::try_from(lengths).map_err(|_| section.invalid_value_error("length"))?;
        section.finish()?;
        Ok(Self { points: cells, lengths })
    }

    /// Formats the section `[grid]` as TOML with all values.
    pub(super) fn to_toml(self) -> String {
        TableWriter::default()
            .with_number("cells", self.points)
            .with_number("length", self.lengths)
            .to_section_toml(&GRID_SCHEMA)
    }
}

/// Duration and tolerances of a flow simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowTime {
    /// Duration, s; positive.
    pub duration: f64,
    /// Tolerance of the error per step relative to the perturbation; in (0, 1).
    pub tolerance: f64,
    /// Tolerance of the residual of the pressure equation relative to its right-hand side; in (0, 1).
    pub pressure_tolerance: f64,
}

impl FlowTime {
    /// Reads the section `[time]`.
    pub(super) fn read(root: &SectionReader) -> Result<Self, CaseError> {
        let section = root.open_required_section(&TIME_SCHEMA)?;
        let duration = section.read_required("duration")?;
        let tolerance = section.read_or_default("tolerance")?;
        let pressure_tolerance = section.read_or_default("pressure_tolerance")?;
        section.finish()?;
        Ok(Self { duration, tolerance, pressure_tolerance })
    }

    /// Formats the section `[time]` as TOML with all values.
    pub(super) fn to_toml(self) -> String {
        TableWriter::default()
            .with_number("duration", self.duration)
            .with_number("tolerance", self.tolerance)
            .with_number("pressure_tolerance", self.pressure_tolerance)
            .to_section_toml(&TIME_SCHEMA)
    }
}

/// Reads the lower limit of the shear rate from `[limits]`, relative to its value in the mean flow; 10⁻³ if absent.
pub(super) fn read_min_shear_rate(root: &SectionReader) -> Result<f64, CaseError> {
    const DEFAULT_MIN_SHEAR_RATE: f64 = 1e-3;
    let Some(section) = root.open_section(&LIMITS_SCHEMA)? else {
        return Ok(DEFAULT_MIN_SHEAR_RATE);
    };
    let least = section.read_or_default("shear_rate")?;
    section.finish()?;
    Ok(least)
}

/// Formats the section `[limits]` as TOML.
pub(super) fn limits_to_toml(least_shear_rate: f64) -> String {
    TableWriter::default()
        .with_number("shear_rate", least_shear_rate)
        .to_section_toml(&LIMITS_SCHEMA)
}
