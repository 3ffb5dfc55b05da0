//! Figures that are frames of an animation.

use crate::colour::CURVE_COLOURS;
use crate::error::FigureError;
use crate::field::FieldFigure;
use crate::format::FigureFormat;
use crate::panels::PanelsFigure;
use crate::picture::{Colour, Picture};
use std::fmt;

/// Figure that is a frame of an animation.
#[derive(Clone, Copy)]
pub enum FrameFigure<'a> {
    /// Field over a plane domain.
    Field(&'a FieldFigure),
    /// Panels of curves, such as a field along a line.
    Curves(&'a PanelsFigure),
}

impl<'a> From<&'a FieldFigure> for FrameFigure<'a> {
    fn from(figure: &'a FieldFigure) -> Self {
        Self::Field(figure)
    }
}

impl<'a> From<&'a PanelsFigure> for FrameFigure<'a> {
    fn from(figure: &'a PanelsFigure) -> Self {
        Self::Curves(figure)
    }
}

/// Scales that all frames have in common.
#[derive(PartialEq)]
pub(super) enum FrameScale {
    Field {
        limit: f64,
        is_signed: bool,
        /// Whether colours follow the square root.
        is_root: bool,
    },
    /// Least and greatest value of each panel.
    Curves(Vec<[f64; 2]>),
}

impl fmt::Display for FrameScale {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Field { limit, is_signed, is_root } => {
                let sign = if *is_signed { "±" } else { "" };
                let root = if *is_root { " by square root" } else { "" };
                write!(formatter, "{sign}{limit}{root}")
            }
            Self::Curves(ranges) => {
                let texts: Vec<String> = ranges
                    .iter()
                    .map(|[least, greatest]| format!("{least} to {greatest}"))
                    .collect();
                formatter.write_str(&texts.join(", "))
            }
        }
    }
}

impl FrameFigure<'_> {
    /// Returns the fixed scales of the figure; `None` if a scale follows from its values.
    pub(super) fn scale(self) -> Option<FrameScale> {
        match self {
            Self::Field(figure) => Some(FrameScale::Field {
                limit: figure.fixed_limit?,
                is_signed: figure.is_signed,
                is_root: figure.is_root_scaled,
            }),
            Self::Curves(figure) => {
                let ranges = figure.panels.iter().map(|panel| panel.y_values);
                Some(FrameScale::Curves(ranges.collect::<Option<_>>()?))
            }
        }
    }

    pub(super) fn to_picture(self) -> Result<Picture, FigureError> {
        match self {
            Self::Field(figure) => figure.to_picture(FigureFormat::Png),
            Self::Curves(figure) => Ok(figure.to_picture()),
        }
    }

    /// Returns the colours besides shades of grey.
    pub(super) fn colours(self) -> Vec<Colour> {
        match self {
            Self::Field(figure) => figure.cell_colours(),
            Self::Curves(_) => CURVE_COLOURS.to_vec(),
        }
    }
}
