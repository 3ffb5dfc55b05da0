//! The data of a field figure, and their checks.

use crate::error::FigureError;

/// An axis of a field: the extent of the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldAxis {
    /// Name, symbol and unit.
    pub label: String,
    /// Place of the left or lower edge of the first cell, in the unit of the label.
    pub from: f64,
    /// Place of the right or upper edge of the last cell; it may be the smaller one.
    pub to: f64,
}

/// Kind of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldMarkKind {
    /// Source, drawn as a star.
    Source,
    /// Receiver, drawn as a triangle on its tip.
    Receiver,
}

/// A marked point in the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMark {
    /// Position, in the units of the axes. A mark outside the domain is counted in the legend.
    pub at: [f64; 2],
    /// A word or two, written beside the mark; may be empty.
    pub name: String,
    /// Kind of the mark.
    pub kind: FieldMarkKind,
}

/// One quantity over a plane domain, or over a plane section of space, at one time.
///
/// The domain is drawn as it is, one unit to the right as long as one unit upwards, so that both
/// axes must be in the same unit; only a domain more than about fifteen times longer than wide is
/// stretched, and the name of the axis says so. Where there are more cells than can be shown, the
/// value of greatest magnitude stands for its neighbours.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: fixed quantities such as time and plane.
    pub subtitle: String,
    /// The axis drawn to the right.
    pub x: FieldAxis,
    /// The axis drawn upwards.
    pub y: FieldAxis,
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// The value of each cell, in the unit of `label`. x runs fastest, the first row is the lowest.
    /// Numbers that are not finite have a distinct style.
    pub values: Vec<f64>,
    /// Name, symbol and unit of the quantity.
    pub label: String,
    /// Whether the quantity has a sign: the colours then are symmetric about zero, and lines of
    /// equal value are solid where it is positive and dashed where it is negative. Without a sign
    /// the colours start at zero. Values that are negative beyond round-off are shown as such in
    /// any case.
    pub is_signed: bool,
    /// The magnitude at which colours end, in the unit of `label`, where it is below the largest;
    /// values beyond are clipped, and the colour bar says so. The largest magnitude without.
    pub limit: Option<f64>,
    /// The magnitude at which colours end, in the unit of `label`, whatever the values are; `limit`
    /// does not matter then. Figures of one kind with the same scale have the same colours, colour
    /// bar and arrangement, as the frames of an [`crate::Animation`] must: without a sign, negative
    /// values then count as beyond the scale.
    pub scale: Option<f64>,
    /// Values on which contour lines are drawn, in the unit of `label`, with their numbers
    /// on them, in place of those at ¼ and ½ of the colours of a quantity with a sign. Values that
    /// are not finite or nowhere attained have no line.
    pub curves: Option<Vec<f64>>,
    /// Index of the material of each cell, ordered as the values; lines are drawn between
    /// different ones. Empty for a single material.
    pub outlines: Vec<u16>,
    /// Whether a cell has yielded, ordered as the values; such cells are dotted. Empty for none.
    pub plastic: Vec<bool>,
    /// Sources and receivers.
    pub marks: Vec<FieldMark>,
}

/// Magnitude above which numbers are treated as infinite, since differences would overflow.
pub(super) const FINITE: f64 = 1e300;

impl FieldFigure {
    pub(super) fn check(&self) -> Result<(), FigureError> {
        for (axis, cells) in [(&self.x, self.columns), (&self.y, self.rows)] {
            let refuse = |problem| FigureError::Axis { label: axis.label.clone(), problem };
            if cells == 0 {
                return Err(refuse("has no cells"));
            }
            let length = (axis.to - axis.from).abs();
            if !(axis.from.is_finite() && axis.to.is_finite()) {
                return Err(refuse("has an end that is not a finite number"));
            }
            if !(length > 0.0 && length.is_finite()) {
                return Err(refuse("does not extend from a first to a different last value"));
            }
        }
        let (columns, rows) = (self.columns, self.rows);
        let lists = [
            ("values", self.values.len(), false),
            ("outlines", self.outlines.len(), self.outlines.is_empty()),
            ("plastic", self.plastic.len(), self.plastic.is_empty()),
        ];
        for (field, found, is_absent) in lists {
            if !is_absent && columns.checked_mul(rows) != Some(found) {
                return Err(FigureError::CellCount { field, found, columns, rows });
            }
        }
        match [self.limit, self.scale].into_iter().flatten().find(|end| !is_end(*end)) {
            Some(found) => Err(FigureError::Limit { found }),
            None => Ok(()),
        }
    }
}

/// Whether colours can end at a number.
fn is_end(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}
