//! The section `[check]`: what `wellposed check` sends, and on which grids.

use super::error::CaseError;
use super::read::Entries;
use super::section::{Node, Resolved, any_numbers};
use super::value;

/// What a case asks of `wellposed check`; what it leaves open is chosen to suit the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Check {
    /// Wave numbers, 1/m; positive.
    pub numbers: Option<Vec<f64>>,
    /// Directions of the wave vector, degrees anticlockwise from x₁, with the elevation of `[wave]`.
    pub directions_deg: Option<Vec<f64>>,
    /// Ascending: of a solid cells to a period along each axis of the grids; of a flow points along each axis
    /// of the grids that its perturbation is refined on.
    pub cells: Option<Vec<usize>>,
}

/// Most grids.
pub const MOST_GRIDS: usize = 5;

/// Fewest cells to a period: fewer hold no wave.
pub const FEWEST_CELLS: usize = 8;

/// Reads the section; absent: nothing is asked for.
///
/// # Errors
/// What is wrong, where, and what is allowed.
pub(super) fn read(entries: &Entries) -> Result<Option<Check>, CaseError> {
    let mut root = entries.structured();
    let Some(mut section) = root.table("check")? else { return Ok(None) };
    let some = |list: Vec<f64>| (!list.is_empty()).then_some(list);
    let positive = |node: &Node| {
        any_numbers(node).and_then(some).filter(|list| list.iter().all(|number| *number > 0.0))
    };
    let cells = |node: &Node| {
        let value = node.value()?;
        let list = value::list(value, value.as_array()?.len(), value::count)?;
        let is_ascending = list.windows(2).all(|pair| pair[0] < pair[1]);
        ((2..=MOST_GRIDS).contains(&list.len()) && is_ascending && list[0] >= FEWEST_CELLS)
            .then_some(list)
    };
    let check = Check {
        numbers: section.optional(
            "numbers",
            "a list of positive numbers in 1/m (wave numbers)",
            positive,
        )?,
        directions_deg: section.optional(
            "directions_deg",
            "a list of finite numbers in degrees (directions of the wave vector from x1)",
            |node| any_numbers(node).and_then(some),
        )?,
        cells: section.optional(
            "cells",
            &format!(
                "two to {MOST_GRIDS} ascending whole numbers of at least {FEWEST_CELLS} (cells to a period)"
            ),
            cells,
        )?,
    };
    section.finish()?;
    Ok(Some(check))
}

impl Check {
    /// The section as TOML: what it says, and no more.
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
        text.under("[check]")
    }
}
