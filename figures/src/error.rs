//! Errors of figures.

/// Error: a figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// A list of the figure does not have one value per cell or grid point.
    #[error("the figure's {field} has {found} values for {columns} × {rows} cells")]
    CellCount {
        /// Name of the list.
        field: &'static str,
        /// Number of values in the list.
        found: usize,
        /// Number of points or cells along the x axis.
        columns: usize,
        /// Number of points or cells along the y axis.
        rows: usize,
    },
    /// An axis has invalid values, e.g. it is not a uniform grid.
    #[error("the axis \"{label}\" {problem}")]
    Axis {
        /// Label of the axis.
        label: String,
        /// Problem, as a phrase that follows the label in the message.
        problem: &'static str,
    },
    /// A cell refers to a category that is not in the list.
    #[error("a cell of the map has category {found}, but only {known} categories are described")]
    UnknownCategory {
        /// Category index of the cell.
        found: u8,
        /// Number of categories in the list.
        known: usize,
    },
    /// The limit of the colour scale is invalid.
    #[error("the limit of the colours is {found}, which is not a positive finite number")]
    Limit {
        /// Limit found.
        found: f64,
    },
    /// A record does not have one value per time.
    #[error("the record \"{name}\" has {found} values for {times} times")]
    RecordLength {
        /// Name of the record, or the label of its panel if it has none.
        name: String,
        /// Number of values in the record.
        found: usize,
        /// Number of times of the figure.
        times: usize,
    },
    /// The frames of an animation are inconsistent, or an option is invalid.
    #[error("the animation {0}")]
    Animation(String),
    /// The animation could not be written.
    #[error("the animation could not be written: {0}")]
    Gif(#[from] gif::EncodingError),
    /// A PNG would have more than [`FigureOptions::MAX_PIXELS`](crate::FigureOptions::MAX_PIXELS).
    #[error(
        "a picture of {width} × {height} pixels is too large: at most 100 million pixels are drawn"
    )]
    TooManyPixels {
        /// Width, pixels.
        width: f64,
        /// Height, pixels.
        height: f64,
    },
    /// The drawing library reports an error.
    #[error("drawing failed: {0}")]
    Drawing(String),
    /// PNG compression fails.
    #[error("drawing failed: {0}")]
    Encoding(#[from] png::EncodingError),
}
