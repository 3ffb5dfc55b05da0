//! The section `[parallel]` of a solid.

use super::grid::SolidGrid;
use crate::error::CaseError;
use crate::schema::{CountConstraint, KeyGroup, KeySchema, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};

/// Schema of the section `[parallel]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_section(
    "parallel",
    "distribution of the cells over the processes of an MPI launcher; results do not depend on it",
    &[KeyGroup::new(&[KeySchema::new_required(
        "parts",
        ValueType::CountList {
            length: [2, 3],
            minimum: 1,
            order: CountConstraint::Unconstrained,
        },
        "",
        "[4, 2]",
        "numbers of parts along the axes, which multiply to the number of processes; without the section those with the least surface of all cuts. A single process does not use them, nor a resumed run with another number of processes",
    )
    .with_note("parts along each axis")])],
);

/// Reads the section `[parallel]`: the numbers of parts along the axes of a grid; `None` without it.
///
/// # Errors
/// A key is unknown or missing, or there are more or fewer numbers than axes.
pub(super) fn read_part_counts(
    root: &SectionReader,
    grid: &SolidGrid,
) -> Result<Option<Vec<usize>>, CaseError> {
    let Some(section) = root.open_section(&SCHEMA)? else { return Ok(None) };
    let counts: Vec<usize> = section.read_required("parts")?;
    if counts.len() != grid.dimensions() {
        let found = format!("found {} numbers", counts.len());
        let allowed = format!("expected {}, one per axis of the grid", grid.dimensions());
        return Err(section.key_error("parts", found, allowed));
    }
    section.finish()?;
    Ok(Some(counts))
}

/// Formats the section `[parallel]`.
pub(super) fn to_toml(part_counts: &[usize]) -> String {
    TableWriter::default().with_number("parts", part_counts).to_section_toml(&SCHEMA)
}
