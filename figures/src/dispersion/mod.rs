//! Dispersion diagrams: frequencies and speeds of waves against the wave number.

mod axes;
mod draw;
mod figure;
mod labels;
mod legend;
mod looks;
mod plot;
mod tags;
#[cfg(test)]
mod tests;

pub use figure::{Band, Branch, DispersionFigure, Level};
pub(crate) use tags::{TAG, draw_ring, draw_tag, tag_area};
