//! Errors of VTK image data and collections.

/// Error of image data or a collection.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VtiError {
    /// The grid has neither two nor three axes, or its fields have different numbers of axes.
    #[error(
        "image data has 2 or 3 axes: found {cells} numbers of cells, {origin} coordinates of the \
         origin and {spacing} spacings"
    )]
    Axes {
        /// Number of axes for which a number of cells is given.
        cells: usize,
        /// Number of coordinates of the origin.
        origin: usize,
        /// Number of spacings.
        spacing: usize,
    },
    /// An axis has no cells, or the number of cells exceeds the range of the format or of the machine.
    #[error("image data cannot have {cells:?} cells along its axes")]
    Size {
        /// Number of cells along each axis.
        cells: Vec<usize>,
    },
    /// A coordinate of the origin is not finite.
    #[error("the origin of image data cannot lie at {0}")]
    Origin(f64),
    /// A coordinate of a point is not finite.
    #[error("a point of a line cannot lie at {0}")]
    Point(f64),
    /// A spacing is not a positive, finite number.
    #[error("the spacing of image data cannot be {0}")]
    Spacing(f64),
    /// A deformation gradient is not finite, or the grid is not plane.
    #[error("image data of {axes} axes cannot be deformed by {found:?}")]
    Deformation {
        /// Number of axes of the grid.
        axes: usize,
        /// Deformation gradient.
        found: [[f64; 2]; 2],
    },
    /// A time is not finite.
    #[error("the time of image data cannot be {0}")]
    Time(f64),
    /// A name is empty or contains control characters, U+FFFE or U+FFFF.
    #[error("image data cannot hold the name {0:?}")]
    Name(String),
    /// An array of this name exists already.
    #[error("image data already has an array \"{0}\"")]
    DuplicateName(String),
    /// An array without components, or a vector with more than three.
    #[error("array \"{name}\" of image data cannot have {found} components")]
    Components {
        /// Name of the array.
        name: String,
        /// Requested number of components.
        found: usize,
    },
    /// The number of values differs from cells × components.
    #[error("array \"{name}\" of image data has {found} values where {expected} are needed")]
    Length {
        /// Name of the array.
        name: String,
        /// Number of values given.
        found: usize,
        /// Expected number of values: cells × components.
        expected: usize,
    },
}
