//! Kinds of files.

/// The kind of file a figure is drawn into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Pixels, 1600 wide and 1100 high; higher where a legend or many panels need the
    /// room, lower where a field is wide.
    Png,
    /// Shapes and text, of the same size in pixels and to be scaled at will.
    Svg,
}
