//! Common context for reading the time-domain sections of a flow.

use super::grid::Grid;
use models::flow::RotationKind;
use std::path::Path;

/// Context for reading the time-domain sections of a flow.
pub(super) struct Reader<'a> {
    pub(super) rotation: RotationKind,
    pub(super) grid: Grid,
    /// Folder of the case file.
    pub(super) folder: &'a Path,
}
