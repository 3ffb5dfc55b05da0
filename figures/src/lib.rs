//! Pictures of verdicts, growth rates, directions and motions, ready for print.
//!
//! Plain structs go in, the bytes of a PNG, SVG or GIF file come out. This crate knows no solver
//! and no physics: names, units and symbols arrive as labels. The same struct gives the same bytes.
//! Everything stays readable in grey: what colour tells, lightness, hatching, dashes or markers
//! tell too. The fonts are part of the program; nothing is taken from the system.

#![deny(missing_docs)]

mod animation;
mod contour;
mod directions;
mod dispersion;
mod field;
mod growth;
mod ledger;
mod note;
mod page;
mod picture;
mod polar;
mod record;
mod scale;
mod seismogram;
mod spectrum;
mod speeds;
mod sphere;
mod verdict_map;

pub use animation::{Animation, animate};
pub use directions::{Direction, DirectionsFigure, Style};
pub use dispersion::{Band, Branch, DispersionFigure, Level};
pub use field::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
pub use growth::{GrowthFigure, Line, Mark, Panel};
pub use ledger::{LedgerFigure, LedgerTerm};
pub use note::NoteFigure;
pub use polar::{PolarFigure, Spoke, SpokeStyle};
pub use seismogram::{SeismogramFigure, SeismogramPanel, Trace};
pub use spectrum::SpectrumFigure;
pub use speeds::{Response, SpeedCurve, SpeedsFigure, Vanishing};
pub use sphere::{SphereFigure, SphereMark};
pub use verdict_map::{Axis, Category, Curve, Look, VerdictMap};

/// The kind of file a figure is drawn into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Pixels, 1600 wide and 1100 high; higher where a legend or many panels need the
    /// room, lower where a field is wide.
    Png,
    /// Shapes and text, of the same size in pixels and to be scaled at will.
    Svg,
}

/// A figure that could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// A list of a figure does not have one value per cell.
    #[error("the figure's {field} has {found} values for {columns} × {rows} cells")]
    CellCount {
        /// Name of the list.
        field: &'static str,
        /// Number of values in the list.
        found: usize,
        /// Points or cells along the x axis.
        columns: usize,
        /// Points or cells along the y axis.
        rows: usize,
    },
    /// An axis is not a uniform grid.
    #[error("the axis \"{label}\" {problem}")]
    Axis {
        /// The axis's label.
        label: String,
        /// What is wrong, as a phrase that follows the label.
        problem: &'static str,
    },
    /// A cell points at a category that is not in the list.
    #[error("a cell of the map has category {found}, but only {known} categories are described")]
    UnknownCategory {
        /// Index found in the cell.
        found: u8,
        /// Number of categories described.
        known: usize,
    },
    /// Values cannot be clipped at such a number.
    #[error("the limit of the colours is {found}, which is not a positive finite number")]
    Limit {
        /// The number given.
        found: f64,
    },
    /// A record does not have one value per time.
    #[error("the record \"{name}\" has {found} values for {times} times")]
    RecordLength {
        /// Name of the record.
        name: String,
        /// Number of values in the record.
        found: usize,
        /// Number of times.
        times: usize,
    },
    /// The frames of an animation do not go together, or cannot be shown.
    #[error("the animation {0}")]
    Animation(String),
    /// The animation could not be written.
    #[error("the animation could not be written: {0}")]
    Gif(#[from] gif::EncodingError),
    /// The drawing library refused.
    #[error("drawing failed: {0}")]
    Drawing(String),
    /// The image could not be compressed.
    #[error("drawing failed: {0}")]
    Encoding(#[from] png::EncodingError),
}

#[cfg(test)]
mod tests {
    /// Width and height from the header of a PNG file.
    pub(crate) fn png_size(bytes: &[u8]) -> [u32; 2] {
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        [reader.info().width, reader.info().height]
    }

    /// Width and pixels of a PNG file, three bytes each.
    pub(crate) fn pixels(bytes: &[u8]) -> (usize, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (reader.info().width as usize, pixels)
    }
}
