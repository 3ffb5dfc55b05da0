//! The section `[grid]` of a solid.

use super::block;
use crate::error::CaseError;
use crate::position_checks::PositionDomain;
use crate::schema::{
    AllowedRange, CountConstraint, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema,
    ValueType,
};
use crate::section::{SectionReader, TableWriter};
use models::common::decimal::ToPlainText;
use models::common::elementary::Elementary;

/// Maximum number of cells of a grid.
pub const MAX_CELLS: usize = 4_000_000_000;

const RECTANGULAR: &[KeyCondition] = &[KeyCondition::Absent("inner_radius")];
const POLAR: &[KeyCondition] = &[KeyCondition::Present("inner_radius")];

/// Angle of the whole circle, degrees.
const CIRCLE_DEG: f64 = 360.0;

/// Schema of the section `[grid]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_section(
    "grid",
    "grid of cells, with two axes in plane strain or three axes in 3D, or polar, with the angle along x1 and the radius along x2; for blocky media see [[block]]",
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
        .with_note("cell size")
        .with_conditions(RECTANGULAR),
        KeySchema::new_optional(
            "origin",
            ValueType::Numbers(ListLength::GridAxes),
            "m",
            "[0.0, 0.0]",
            "lower corner of the grid; default: 0",
        )
        .with_note("lower corner of the grid")
        .with_conditions(RECTANGULAR),
        KeySchema::new_optional(
            "inner_radius",
            ValueType::Number(AllowedRange::Positive),
            "m",
            "0.1",
            "radius of the lower side of a polar grid in plane strain; without it the grid is rectangular. Along x1 of a polar grid all coordinates and lengths are angles in degrees; components 1 and 2 are along the angle and the radius",
        )
        .with_note("radius of the lower side"),
        KeySchema::new_required(
            "outer_radius",
            ValueType::Number(AllowedRange::Positive),
            "m",
            "1.0",
            "radius of the upper side of a polar grid",
        )
        .with_note("radius of the upper side")
        .with_conditions(POLAR),
        KeySchema::new_with_default(
            "angles_deg",
            ValueType::Numbers(ListLength::Two),
            "deg",
            "[-90.0, 270.0]",
            "first and last angle of a polar grid; over 360 degrees it is periodic",
        )
        .with_conditions(POLAR),
    ])],
)
.with_remedy("a section [grid] with cells and spacing")
.with_alternative("block");

/// A uniform grid, rectangular or polar. Along the first axis of a polar grid, coordinates and spacing are angles in
/// degrees; the second axis is that of the radius, m.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidGrid {
    /// Number of cells along each axis; two axes in plane strain, three in space.
    pub cells: Vec<usize>,
    /// Cell spacing along each axis, m.
    pub spacing: Vec<f64>,
    /// Lower corner of the grid, m.
    pub origin: Vec<f64>,
    /// First and last angle, degrees, and radii, m, of a polar grid; `None` for a rectangular one.
    pub polar_bounds: Option<[[f64; 2]; 2]>,
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
        if let Some(bounds) = self.polar_bounds {
            return bounds[axis];
        }
        let first = self.origin[axis];
        [first, first + self.cells[axis] as f64 * self.spacing[axis]]
    }

    /// Returns the coordinate along `axis` of the centre of cell `index`, m.
    pub fn cell_centre(&self, axis: usize, index: usize) -> f64 {
        self.origin[axis] + (index as f64 + 0.5) * self.spacing[axis]
    }

    /// Returns whether the grid is polar.
    pub fn is_polar(&self) -> bool {
        self.polar_bounds.is_some()
    }

    /// Returns the domain of positions in messages.
    pub(crate) fn position_domain(&self) -> PositionDomain {
        match self.is_polar() {
            true => PositionDomain::PolarGrid,
            false => PositionDomain::Grid,
        }
    }

    /// Returns whether the grid is polar and goes round the whole circle.
    pub fn is_circle(&self) -> bool {
        let [from, to] = self.axis_bounds(0);
        self.is_polar() && (to - from - CIRCLE_DEG).abs() < 1e-9 * CIRCLE_DEG
    }

    /// Returns the smallest edge length of the cells along each axis, m.
    pub fn smallest_edges(&self) -> Vec<f64> {
        let mut edges = self.spacing.clone();
        if self.is_polar() {
            edges[0] = edges[0].to_radians() * self.cell_centre(1, 0);
        }
        edges
    }

    /// Returns the Cartesian coordinates, m, of a point of a polar grid: angle in degrees, and radius.
    pub fn to_cartesian(point: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = point[0].to_radians().cr_sin_cos();
        [point[1] * cos, point[1] * sin]
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
            return Err(section.key_error("length", "not used by a solid", allowed));
        }
        let cells: Vec<usize> = section.read_required("cells")?;
        let d = cells.len();
        section.scope.dimensions = Some(d);
        let total = cells.iter().try_fold(1usize, |total, &cells| total.checked_mul(cells));
        if total.is_none_or(|total| total > MAX_CELLS) {
            let numbers: Vec<String> = cells.iter().map(usize::to_string).collect();
            let found = format!("found a grid of {}", numbers.join(" × "));
            let allowed = format!("expected at most {MAX_CELLS} cells in total");
            return Err(section.key_error("cells", found, allowed));
        }
        let grid = match section.has_key("inner_radius") {
            true => Self::read_polar(&section, cells)?,
            false => {
                let polar_keys = ["outer_radius", "angles_deg"];
                if let Some(key) = polar_keys.into_iter().find(|key| section.has_key(key)) {
                    let allowed = "add inner_radius, the other radius of a polar grid";
                    return Err(section.key_error(key, "found without inner_radius", allowed));
                }
                let spacing = section.read_required("spacing")?;
                let origin = section.read_optional("origin")?.unwrap_or(vec![0.0; d]);
                let grid = Self { cells, spacing, origin, polar_bounds: None };
                grid.check_resolution(&section, "spacing")?;
                grid
            }
        };
        section.finish()?;
        Ok(grid)
    }

    fn read_polar(section: &SectionReader, cells: Vec<usize>) -> Result<Self, CaseError> {
        if cells.len() != 2 {
            let found = format!("found {} axes of a polar grid", cells.len());
            let allowed = "write two numbers, of cells along the angle and along the radius";
            return Err(section.key_error("cells", found, allowed));
        }
        if let Some(key) = ["spacing", "origin"].into_iter().find(|key| section.has_key(key)) {
            let allowed = "leave it out: the radii and angles_deg give the cells of a polar grid";
            return Err(section.key_error(key, "found beside inner_radius", allowed));
        }
        let inner: f64 = section.read_required("inner_radius")?;
        let outer: f64 = section.read_required("outer_radius")?;
        if outer <= inner {
            let found = format!(
                "found {outer} with inner_radius = {inner}",
                outer = outer.to_plain_text(),
                inner = inner.to_plain_text()
            );
            let allowed = "outer_radius must be greater than inner_radius";
            return Err(section.key_error("outer_radius", found, allowed));
        }
        let angles: Vec<f64> = section.read_or_default("angles_deg")?;
        let [first, last] = [angles[0], angles[1]];
        let angle = last - first;
        if angle.is_nan() || angle <= 0.0 || angle > CIRCLE_DEG * (1.0 + 1e-9) {
            let found = format!(
                "found [{first}, {last}]",
                first = first.to_plain_text(),
                last = last.to_plain_text()
            );
            let allowed = "the second angle must be greater than the first, by at most 360";
            return Err(section.key_error("angles_deg", found, allowed));
        }
        let spacing = vec![angle / cells[0] as f64, (outer - inner) / cells[1] as f64];
        let grid = Self {
            cells,
            spacing,
            origin: vec![first, inner],
            polar_bounds: Some([[first, last], [inner, outer]]),
        };
        grid.check_resolution(section, "cells")?;
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
                let found = format!(
                    "cells of {} m from {} to {}",
                    self.spacing[axis].to_plain_text(),
                    first.to_plain_text(),
                    last.to_plain_text()
                );
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
        let resolved = TableWriter::default().with_number("cells", &self.cells);
        let resolved = match self.polar_bounds {
            Some([angles, [inner, outer]]) => resolved
                .with_number("inner_radius", inner)
                .with_number("outer_radius", outer)
                .with_number("angles_deg", angles),
            None => {
                resolved.with_number("spacing", &self.spacing).with_number("origin", &self.origin)
            }
        };
        resolved.to_section_toml(&SCHEMA)
    }
}
