//! Reading of sections of a flow in time.

use super::grid::Grid;
use models::flow::RotationKind;
use std::path::Path;

/// What all entries are read with.
pub(super) struct Reader<'a> {
    pub(super) rotation: RotationKind,
    pub(super) grid: Grid,
    /// The folder of the case file.
    pub(super) folder: &'a Path,
}
