//! Common context for reading the time-domain sections of a solid.

use super::component::{StateComponent, component_names};
use super::grid::SolidGrid;
use crate::error::CaseError;
use crate::position_checks::check_position;
use crate::section::SectionReader;
use models::solid::parameters::Theory;
use std::path::Path;

/// Context for reading the time-domain sections of a solid.
pub(super) struct SolidReader<'a> {
    pub(super) grid: &'a SolidGrid,
    pub(super) theory: Theory,
    /// State components of the solid of the case.
    pub(super) state_components: Vec<StateComponent>,
    /// History variables of the media, which can be recorded and drawn.
    pub(super) history_components: Vec<StateComponent>,
    /// Whether pores have a contact by cone, for which outputs compute the volumetric strain.
    pub(super) has_pore_cones: bool,
    /// Folder of the case file.
    pub(super) case_folder: &'a Path,
}

impl SolidReader<'_> {
    pub(super) fn dimensions(&self) -> usize {
        self.grid.dimensions()
    }

    /// Reads the point `at` and checks that it is in the grid.
    pub(super) fn read_point(&self, section: &SectionReader) -> Result<Vec<f64>, CaseError> {
        let at: Vec<f64> = section.read_required("at")?;
        let axes: Vec<usize> = (0..self.dimensions()).collect();
        self.check_position(section, &at, &axes)?;
        Ok(at)
    }

    /// Checks that a position, given along `axes`, is in the grid.
    pub(super) fn check_position(
        &self,
        section: &SectionReader,
        position: &[f64],
        axes: &[usize],
    ) -> Result<(), CaseError> {
        let extents: Vec<[f64; 2]> = axes.iter().map(|&axis| self.grid.axis_bounds(axis)).collect();
        check_position(section, "at", position, axes, &extents, self.grid.position_domain())
    }

    /// Reads the component named by the key `field`, one of `among`.
    pub(super) fn read_component(
        &self,
        section: &SectionReader,
        among: &[StateComponent],
    ) -> Result<StateComponent, CaseError> {
        let names = component_names(among);
        let name = section.read_required_text("field", &names)?;
        StateComponent::find_by_name(&name, self.theory, among)
            .ok_or_else(|| section.unknown_name_error("field", &name, &names))
    }
}
