//! Figure of a field over a plane domain, e.g. the final state of a simulation.

mod arrows;
mod axes;
mod body;
mod borders;
mod cells;
mod colour_bar;
mod colour_map;
mod contour_labels;
mod contours;
mod draw;
mod figure;
mod layout;
mod legend;
mod lines;
mod marks;
mod outlines;
mod pair;
mod raster;
mod signs;
#[cfg(test)]
mod tests;
mod ticks;
mod yielded_cells;

pub use arrows::{FieldArrow, FieldArrows};
pub use body::FieldBody;
pub use figure::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
pub use lines::{FieldLine, FieldLineSet, FieldLineStyle};
pub(crate) use marks::{LOADED_LINE_TEXT, LOADED_LINE_WIDTH, draw_loaded_line, draw_mark};
pub use outlines::FieldOutline;
pub use pair::FieldPairFigure;
