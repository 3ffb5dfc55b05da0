//! Input of a field figure, and its validation.

use super::arrows::FieldArrows;
use super::body::FieldBody;
use super::lines::{FieldLineSet, FieldLineStyle};
use super::outlines::FieldOutline;
use crate::error::FigureError;

/// Axis of a field: name and extent of the domain.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldAxis {
    /// Name, symbol and unit.
    pub label: String,
    /// Coordinate of the left or lower edge of the first cell, in the unit of the label.
    pub start: f64,
    /// Coordinate of the right or upper edge of the last cell; may be less than `start`.
    pub end: f64,
}

/// Kind of a marked point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldMarkKind {
    /// Source, drawn as a star.
    Source,
    /// Receiver, drawn as a triangle pointing downwards.
    Receiver,
}

/// A marked point in the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMark {
    /// Coordinates, in the units of the axes. Marks outside the domain are not drawn, but counted in the legend.
    pub position: [f64; 2],
    /// Name written beside the mark, a word or two; may be empty.
    pub name: String,
    /// Kind of the mark.
    pub kind: FieldMarkKind,
}

/// Field of one quantity over a plane domain, or over a plane section of space, at one time.
///
/// The domain is drawn to scale, so that both axes must have the same unit; a domain with an aspect ratio above about
/// 15 is stretched, which is stated in the axis name. If there are more cells than pixels, in an SVG than 400 along an
/// axis, the value of largest magnitude of several cells is drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: fixed quantities, e.g. time and plane.
    pub subtitle: String,
    /// Horizontal axis, to the right.
    pub x: FieldAxis,
    /// Vertical axis, upwards.
    pub y: FieldAxis,
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// Value of each cell, in the unit of `label`; x varies fastest, the first row is the lowest. Cells with non-finite
    /// values have a distinct style.
    pub values: Vec<f64>,
    /// Name, symbol and unit of the quantity.
    pub label: String,
    /// Whether the quantity is signed: the colour scale is then symmetric about zero, negative values have fine
    /// horizontal lines, and contour lines are solid at positive and dashed at negative levels. The colour scale of an unsigned quantity starts at zero; without
    /// `fixed_limit`, negative values beyond round-off make it signed.
    pub is_signed: bool,
    /// Limit of the colour scale, in the unit of `label`; `None` for the largest magnitude. Values beyond are clipped,
    /// which the colour bar indicates. Without effect if above the largest magnitude.
    pub limit: Option<f64>,
    /// Fixed limit of the colour scale, in the unit of `label`, independent of the values; overrides `limit`. Figures
    /// with the same fixed scale have the same colours, colour bar and layout, as required for the frames of an
    /// [`crate::Animation`]; negative values of an unsigned quantity then count as beyond the scale.
    pub fixed_limit: Option<f64>,
    /// Whether colours follow the square root of the magnitude, so that waves a tenth as strong as the strongest are
    /// visible; stated at the colour bar.
    pub is_root_scaled: bool,
    /// Levels of contour lines, in the unit of `label`, which are drawn with their numbers; `None` for two round levels
    /// of either sign of a signed quantity, which the legend states; an unsigned quantity then has no lines. Levels that
    /// are non-finite or not attained have no line.
    pub contour_levels: Option<Vec<f64>>,
    /// Part of the domain that the body fills; `None` for all of it.
    pub body: Option<FieldBody>,
    /// Material index of each cell, in the order of `values`; lines are drawn between different materials. Empty for a
    /// single material.
    pub material_indices: Vec<u16>,
    /// Legend of these lines; empty for "border between materials".
    pub border_label: String,
    /// Whether each cell has yielded, in the order of `values`; the yielded zone has a dotted outline and sparse dots.
    /// Empty if none.
    pub has_yielded: Vec<bool>,
    /// Parts of the domain with dash-dotted outlines.
    pub outlines: Vec<FieldOutline>,
    /// Sets of lines, e.g. joints; later sets cover earlier ones.
    pub line_sets: Vec<FieldLineSet>,
    /// Vector field, drawn as arrows.
    pub arrows: Option<FieldArrows>,
    /// Marked sources and receivers.
    pub marks: Vec<FieldMark>,
    /// Loaded parts of the boundary, each the points of a line in the units of the axes; drawn as wide lines.
    pub loaded_lines: Vec<Vec<[f64; 2]>>,
}

impl FieldFigure {
    /// Iterates over the values of coloured lines.
    pub(super) fn coloured_values(&self) -> impl Iterator<Item = f64> {
        let sets = self.line_sets.iter().filter(|set| set.style == FieldLineStyle::Coloured);
        sets.flat_map(|set| set.lines.iter().map(|line| line.value))
    }

    pub(super) fn validate(&self) -> Result<(), FigureError> {
        for (axis, cells) in [(&self.x, self.columns), (&self.y, self.rows)] {
            let refuse = |problem| FigureError::Axis { label: axis.label.clone(), problem };
            if cells == 0 {
                return Err(refuse("has no cells"));
            }
            let length = (axis.end - axis.start).abs();
            if !(axis.start.is_finite() && axis.end.is_finite()) {
                return Err(refuse("has an end that is not a finite number"));
            }
            if !(length > 0.0 && length.is_finite()) {
                return Err(refuse("does not extend from a first to a different last value"));
            }
        }
        let (columns, rows) = (self.columns, self.rows);
        let magnitudes = self.arrows.as_ref().map_or(0, |own| own.magnitudes.len());
        let outside = self.body.as_ref().map_or(0, |own| own.is_outside.len());
        let lists = [
            ("body", outside, self.body.is_none()),
            ("values", self.values.len(), false),
            ("outlines", self.material_indices.len(), self.material_indices.is_empty()),
            ("plastic", self.has_yielded.len(), self.has_yielded.is_empty()),
            ("magnitudes", magnitudes, magnitudes == 0),
        ];
        let outlined =
            self.outlines.iter().map(|own| ("outlined cells", own.is_inside.len(), false));
        for (field, found, is_absent) in lists.into_iter().chain(outlined) {
            if !is_absent && columns.checked_mul(rows) != Some(found) {
                return Err(FigureError::CellCount { field, found, columns, rows });
            }
        }
        match [self.limit, self.fixed_limit].into_iter().flatten().find(|end| !is_valid_limit(*end))
        {
            Some(found) => Err(FigureError::Limit { found }),
            None => Ok(()),
        }
    }
}

/// Returns whether a number is a valid limit of the colour scale.
fn is_valid_limit(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}
