//! Verdict maps: verdicts over two parameters of a case.

mod axes;
mod boundaries;
mod cells;
mod colour_bar;
mod colour_map;
mod curves;
mod draw;
mod figure;
mod hatching;
mod legend;
mod levels;
mod raster;
mod shares;
#[cfg(test)]
mod tests;

pub(crate) use boundaries::is_inside;
pub(crate) use colour_map::{
    ARROW_LENGTH, BAR_GAP, BAR_WIDTH, MISSING_LEVEL_COLOUR, contrast_colour, draw_shades,
    shade_colour,
};
pub use figure::{
    FillStyle, Hatching, MapCurve, STEP_PARTS, VerdictCategory, VerdictMap, VerdictMapAxis,
};
#[cfg(test)]
pub(crate) use hatching::category_fill;
pub(crate) use hatching::{HatchLines, VERTICAL_DIRECTION, draw_hatch};
pub(crate) use raster::find_runs;
pub(crate) use shares::format_percent;
