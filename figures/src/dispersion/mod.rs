//! Dispersion diagrams: frequencies and speeds of waves against the wave number.

mod axes;
mod draw;
mod figure;
mod labels;
mod legend;
mod plot;
mod styles;
mod tags;
#[cfg(test)]
mod tests;

pub use figure::{DispersionBranch, DispersionFigure, FrequencyBand, ReferenceLevel};
pub(crate) use tags::{TAG_RADIUS, draw_ring, draw_tag, tag_area};
