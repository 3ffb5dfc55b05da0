//! The section `[grid]` of a solid.

use super::block;
use crate::error::CaseError;
use crate::schema::{CountConstraint, KeyGroup, KeySchema, ListLength, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};

/// Maximum number of cells of a grid.
pub const MAX_CELLS: usize = 4_000_000_000;

/// Schema of the section `[grid]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_section(
    "grid",
    "rectangular grid of cells, with two axes in plane strain or three axes in 3D; for blocky media see [[block]]",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "cells",
            ValueType::CountList { length: [2, 3], minimum: 1, order: CountConstraint::Unconstrained },
            "",
            "[200, 100]",
            "number of cells along each axis: two entries in plane strain, three in 3D; all points have as many coordinates",
        )
        .with_note("cells along each axis"),
        KeySchema::new_required(
            "spacing",
            ValueType::PerAxis(ListLength::GridAxes),
            "m",
            "1.0",
            "cell size; one number, or one per axis",
        )
        .with_note("cell size"),
        KeySchema::new_optional(
            "origin",
            ValueType::Numbers(ListLength::GridAxes),
            "m",
            "[0.0, 0.0]",
            "lower corner of the grid; default: 0",
        )
        .with_note("lower corner of the grid"),
    ])],
)
.with_remedy("a section [grid] with cells and spacing")
.with_alternative("block");

/// A uniform rectangular grid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidGrid {
    /// Number of cells along each axis; two axes in plane strain, three in space.
    pub cells: Vec<usize>,
    /// Cell spacing along each axis, m.
    pub spacing: Vec<f64>,
    /// Lower corner of the grid, m.
    pub origin: Vec<f64>,
}

impl SolidGrid {
    /// Returns the number of dimensions: 2 for plane strain, 3 for space.
    pub fn dimensions(&self) -> usize {
        self.cells.len()
    }

    /// Returns the number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Returns the lower and upper bound of the grid along `axis`, m.
    pub fn axis_bounds(&self, axis: usize) -> [f64; 2] {
        let first = self.origin[axis];
        [first, first + self.cells[axis] as f64 * self.spacing[axis]]
    }

    /// Returns the coordinate along `axis` of the centre of cell `index`, m.
    pub fn cell_centre(&self, axis: usize, index: usize) -> f64 {
        self.origin[axis] + (index as f64 + 0.5) * self.spacing[axis]
    }

    /// Returns whether a point is in the grid or on its boundary.
    pub fn contains(&self, point: &[f64]) -> bool {
        point.iter().enumerate().all(|(axis, x)| {
            let [first, last] = self.axis_bounds(axis);
            (first..=last).contains(x)
        })
    }

    /// Reads the section `[grid]`, or the bounding box of the sections `[[block]]`.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value is invalid.
    pub(crate) fn read(root: &SectionReader) -> Result<Self, CaseError> {
        if root.has_key("block") {
            return block::read_bounding_grid(root);
        }
        let mut section = root.open_required_section(&SCHEMA)?;
        if section.has_key("length") {
            let allowed = "give spacing, the cell size in m, instead";
            return Err(section.key_error("length", "found for a solid", allowed));
        }
        let cells: Vec<usize> = section.read_required("cells")?;
        let d = cells.len();
        section.scope.dimensions = Some(d);
        let total = cells.iter().try_fold(1usize, |total, &cells| total.checked_mul(cells));
        if total.is_none_or(|total| total > MAX_CELLS) {
            let numbers: Vec<String> = cells.iter().map(usize::to_string).collect();
            let found = format!("a grid of {}", numbers.join(" × "));
            let allowed = format!("expected at most {MAX_CELLS} cells in total");
            return Err(section.key_error("cells", found, allowed));
        }
        let spacing = section.read_required("spacing")?;
        let origin = section.read_optional("origin")?.unwrap_or(vec![0.0; d]);
        let grid = Self { cells, spacing, origin };
        grid.check_resolution(&section, "spacing")?;
        section.finish()?;
        Ok(grid)
    }

    /// Checks that centres and faces of neighbouring cells are distinct doubles; errors are reported at `key`.
    pub(super) fn check_resolution(
        &self,
        section: &SectionReader,
        key: &str,
    ) -> Result<(), CaseError> {
        for axis in 0..self.dimensions() {
            let [first, last] = self.axis_bounds(axis);
            let largest = first.abs().max(last.abs());
            if !largest.is_finite() || self.spacing[axis] <= 8.0 * f64::EPSILON * largest {
                let found =
                    format!("cells of {:?} m from {first:?} to {last:?}", self.spacing[axis]);
                let allowed = format!(
                    "expected a spacing at which cell coordinates along x{} differ in double precision",
                    axis + 1
                );
                return Err(section.key_error(key, found, allowed));
            }
        }
        Ok(())
    }

    /// Formats the section `[grid]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        TableWriter::default()
            .with_number("cells", &self.cells)
            .with_number("spacing", &self.spacing)
            .with_number("origin", &self.origin)
            .to_section_toml(&SCHEMA)
    }
}
