//! Common context for reading the time-domain sections of a flow.

use super::grid::FlowGrid;
use models::flow::RotationKind;
use std::path::Path;

/// Context for reading the time-domain sections of a flow.
pub(super) struct FlowReader<'a> {
    pub(super) rotation: RotationKind,
    pub(super) grid: FlowGrid,
    /// Folder of the case file.
    pub(super) case_folder: &'a Path,
}
