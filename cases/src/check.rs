//! The section `[check]`: waves and grids of `wellposed check`.

use super::error::CaseError;
use super::section::{Resolved, Section};
use crate::schema::{Form, Group, Item, Order, Range, Type};

/// Options of `wellposed check`; absent options are chosen by the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Check {
    /// Wave numbers, 1/m; positive.
    pub numbers: Option<Vec<f64>>,
    /// Directions of the wave vector, degrees anticlockwise from x₁, with the elevation of `[wave]`.
    pub directions_deg: Option<Vec<f64>>,
    /// Grid sizes, ascending. Solid: cells per period along each axis. Flow: points along each axis of the grids on
    /// which the perturbation is refined.
    pub cells: Option<Vec<usize>>,
}

/// Maximum number of grids of a convergence study.
pub const MAX_GRIDS: usize = 5;

/// Minimum number of cells per period: fewer do not resolve a wave.
pub const FEWEST_CELLS: usize = 8;

/// Schema of the section `[check]`.
pub(super) const FORM: Form = Form::section(
    "check",
    "what wellposed check sends; what is left out is chosen to suit the model",
    &[Group::always(&[
        Item::optional(
            "numbers",
            Type::List(1, Range::Positive),
            "1/m",
            "[0.5, 2.0]",
            "wave numbers; default: the solid's own wave number times 1, ¼, ½, 2, 4, where it yields times 1; of a classical solid that of [wave]; of a flow that of [wave] times 1, 4 and 16",
        )
        .note("wave numbers"),
        Item::optional(
            "directions_deg",
            Type::List(1, Range::Finite),
            "deg",
            "[0.0, 30.0]",
            "directions of the wave vector from x₁, with the elevation of [wave]; default: that of [wave], and oblique ones",
        )
        .note("directions of the wave vector from x1"),
        Item::optional(
            "cells",
            Type::Counts { length: [2, MAX_GRIDS], least: FEWEST_CELLS, order: Order::Ascending },
            "",
            "[20, 30, 40]",
            "cells to a period along each axis of two or three grids, ascending; of a flow points along each axis of the grids that its perturbation is refined on",
        )
        .note("cells to a period"),
    ])],
);

/// Reads the section `[check]`; `None` if absent.
///
/// # Errors
/// A key is unknown, or a value is invalid.
pub(super) fn read(root: &Section) -> Result<Option<Check>, CaseError> {
    let Some(section) = root.section(&FORM)? else { return Ok(None) };
    let check = Check {
        numbers: section.optional("numbers")?,
        directions_deg: section.optional("directions_deg")?,
        cells: section.optional("cells")?,
    };
    section.finish()?;
    Ok(Some(check))
}

impl Check {
    /// Formats the section `[check]` as TOML, with the given keys only.
    pub(super) fn to_toml(&self) -> String {
        let mut text = Resolved::default();
        if let Some(numbers) = &self.numbers {
            text = text.number("numbers", numbers);
        }
        if let Some(directions) = &self.directions_deg {
            text = text.number("directions_deg", directions);
        }
        if let Some(cells) = &self.cells {
            text = text.number("cells", cells);
        }
        text.under(&FORM)
    }
}
