//! Fields on regular grids in VTK's XML format for image data (`.vti`), or on such grids after a
//! deformation for structured grids (`.vts`), which ParaView and VisIt open, and collections that give
//! each of several files its time (`.pvd`).
//!
//! Values belong to cells. They are appended as raw little-endian bytes, so that they keep every
//! bit and a reader finds its way by offsets; compression is optional. The format has no place
//! for units that viewers show: put them into the array's name, as in `sigma11 [Pa]`.

mod attributes;
mod collection;
mod encoding;
mod error;
mod grid;
mod image_data;
mod number;
mod reader;
#[cfg(test)]
mod tests;

pub use collection::{collected, collection};
pub use encoding::Storage;
pub use error::VtiError;
pub use grid::Grid;
pub use image_data::ImageData;
pub use number::Number;
pub use reader::{plain_time, plain_values};
