//! Common context for reading the time-domain sections of a solid.

use super::component::{Component, names};
use super::grid::Grid;
use crate::error::CaseError;
use crate::position::check_inside;
use crate::section::Section;
use models::solid::parameters::Theory;
use std::path::Path;

/// Context for reading the time-domain sections of a solid.
pub(super) struct Reader<'a> {
    pub(super) grid: &'a Grid,
    pub(super) theory: Theory,
    /// State components of the solid of the case.
    pub(super) components: Vec<Component>,
    /// Folder of the case file.
    pub(super) folder: &'a Path,
}

impl Reader<'_> {
    pub(super) fn dimensions(&self) -> usize {
        self.grid.dimensions()
    }

    /// Reads the point `at` and checks that it is in the grid.
    pub(super) fn point_inside(&self, section: &Section) -> Result<Vec<f64>, CaseError> {
        let at: Vec<f64> = section.required("at")?;
        let axes: Vec<usize> = (0..self.dimensions()).collect();
        self.check_inside(section, &at, &axes)?;
        Ok(at)
    }

    /// Checks that a position, given along `axes`, is in the grid.
    pub(super) fn check_inside(
        &self,
        section: &Section,
        position: &[f64],
        axes: &[usize],
    ) -> Result<(), CaseError> {
        let extents: Vec<[f64; 2]> = axes.iter().map(|&axis| self.grid.extent(axis)).collect();
        check_inside(section, "at", position, axes, &extents, "grid")
    }

    /// Reads the component named by the key `field`, one of `among`.
    pub(super) fn component(
        &self,
        section: &Section,
        among: &[Component],
    ) -> Result<Component, CaseError> {
        let names = names(among);
        let name = section.required_text("field", &names)?;
        Component::find(&name, self.theory, among)
            .ok_or_else(|| section.no_such("field", &name, &names))
    }
}
