//! Files of the parts of a run: each of several ranks writes the values of its own cells, and reads those that it needs.

mod archive;
mod boxes;
mod fields;
mod state;

pub(super) use archive::write_field_archive;
pub(super) use boxes::{BoxCopy, count_cells};
pub(super) use fields::{FieldParts, create_field_store, write_fields, write_joints};
pub(super) use state::{StateFile, StateFiles, write_state_sections};
