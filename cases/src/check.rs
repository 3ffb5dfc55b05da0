//! The section `[check]`: waves and grids of `wellposed check`.

use super::error::CaseError;
use super::section::{SectionReader, TableWriter};
use crate::schema::{AllowedRange, CountConstraint, KeyGroup, KeySchema, TableSchema, ValueType};

/// Options of `wellposed check`; `None` for values that the program chooses to suit the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckOptions {
    /// Wave numbers, 1/m; positive.
    pub wave_numbers: Option<Vec<f64>>,
    /// Directions of the wave vector, degrees anticlockwise from x₁, with the elevation of `[wave]`.
    pub directions_deg: Option<Vec<f64>>,
    /// Grid sizes, ascending. Solid: cells per period along each axis. Flow: grid points along each axis, for the
    /// convergence study of the perturbation.
    pub grid_sizes: Option<Vec<usize>>,
}

/// Maximum number of grids of a convergence study.
pub const MAX_GRIDS: usize = 5;

/// Minimum of the grid sizes: with fewer cells per period a wave is not resolved.
pub const MIN_CELLS: usize = 8;

/// Schema of the section `[check]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_section(
    "check",
    "waves and grids of wellposed check; omitted keys are chosen to suit the model",
    &[KeyGroup::new(&[
        KeySchema::new_optional(
            "numbers",
            ValueType::NumberList(1, AllowedRange::Positive),
            "1/m",
            "[0.5, 2.0]",
            "wave numbers; default for Cosserat solids: the characteristic wave number of the solid times 1, ¼, ½, 2, 4, or times 1 only if it yields; for classical solids: wave.number; for flows: wave.number times 1, 4 and 16",
        )
        .with_note("wave numbers"),
        KeySchema::new_optional(
            "directions_deg",
            ValueType::NumberList(1, AllowedRange::Finite),
            "deg",
            "[0.0, 30.0]",
            "directions of the wave vector from x₁, with the elevation of [wave]; default: direction of [wave], and oblique directions",
        )
        .with_note("directions of the wave vector from x1"),
        KeySchema::new_optional(
            "cells",
            ValueType::CountList { length: [2, MAX_GRIDS], minimum: MIN_CELLS, order: CountConstraint::Ascending },
            "",
            "[20, 30, 40]",
            "grid sizes, ascending; solids: cells per period along each axis of two or three grids; plane waves: cells of the columns, in two to five; flows: points along each axis of two to five grids of the convergence study",
        )
        .with_note("one number per grid, such as [20, 40]: cells per period of a solid, cells of a column, or points along an axis of a flow"),
    ])],
);

/// Reads the section `[check]`; `None` if absent.
///
/// # Errors
/// A key is unknown, or a value is invalid.
pub(super) fn read_check(root: &SectionReader) -> Result<Option<CheckOptions>, CaseError> {
    let Some(section) = root.open_section(&SCHEMA)? else { return Ok(None) };
    let check = CheckOptions {
        wave_numbers: section.read_optional("numbers")?,
        directions_deg: section.read_optional("directions_deg")?,
        grid_sizes: section.read_optional("cells")?,
    };
    section.finish()?;
    Ok(Some(check))
}

impl CheckOptions {
    /// Formats the section `[check]` as TOML, with the given keys only.
    pub(super) fn to_toml(&self) -> String {
        let mut text = TableWriter::default();
        if let Some(numbers) = &self.wave_numbers {
            text = text.with_number("numbers", numbers);
        }
        if let Some(directions) = &self.directions_deg {
            text = text.with_number("directions_deg", directions);
        }
        if let Some(cells) = &self.grid_sizes {
            text = text.with_number("cells", cells);
        }
        text.to_section_toml(&SCHEMA)
    }
}
