//! Errors of figures.

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
        /// Problem, as a phrase that follows the label.
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
