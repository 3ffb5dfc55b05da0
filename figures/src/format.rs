//! File formats of figures.

/// File format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFormat {
    /// PNG, 1600 pixels wide and usually 1100 pixels high; higher for a large legend or many panels, lower for a wide
    /// field.
    Png,
    /// SVG of the same size in pixels.
    Svg,
}
