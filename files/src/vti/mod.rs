//! VTK XML files for ParaView and VisIt: cell fields on regular grids (image data, `.vti`) and on deformed grids
//! (structured grids, `.vts`), lines with values (poly data, `.vtp`), and collections of a time series (`.pvd`).
//!
//! Cell values are appended as raw little-endian bytes, bit for bit; compression is optional. The format has no
//! units: append them to the name of the array, as in `sigma11 [Pa]`.

mod array_pieces;
mod arrays;
mod attributes;
mod collection;
mod encoding;
mod error;
mod grid;
mod image_data;
mod number;
mod pieces;
mod poly_data;
mod reader;
mod rounding;
#[cfg(test)]
mod tests;

pub use array_pieces::ArrayPieces;
pub use arrays::ArrayDeclaration;
pub use collection::{format_collection, parse_collection};
pub use encoding::Storage;
pub(crate) use encoding::compress;
pub use error::VtiError;
pub use grid::ImageGrid;
pub use image_data::ImageData;
pub use number::VtkNumber;
pub use pieces::{PieceFile, parse_index};
pub use poly_data::{POINTS_ARRAY, PolyData};
pub use reader::{
    list_arrays, read_array_bytes, read_integers, read_plain_integers, read_plain_time,
    read_plain_values, read_values,
};
pub use rounding::{round_to_digits, rounding_error};
