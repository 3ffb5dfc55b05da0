//! Verdict maps: verdicts over two parameters of a case.

mod axes;
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

#[cfg(test)]
pub(crate) use colour_map::luminance;
pub(crate) use colour_map::{
    ARROW, BAR, BAR_GAP, LEVEL_MISSING, colour_on_shade, draw_shades, shade,
};
pub use figure::{Axis, Category, Curve, Look, VerdictMap};
pub(crate) use raster::runs;
pub(crate) use shares::percent;
