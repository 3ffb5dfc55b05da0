//! Dispersion diagrams: frequencies and speeds of waves against the wave number.

mod axes;
mod draw;
mod figure;
mod labels;
mod legend;
mod number_discs;
mod plot;
mod styles;
#[cfg(test)]
mod tests;

pub use figure::{DispersionBranch, DispersionFigure, FrequencyBand, ReferenceLevel};
pub(crate) use number_discs::{
    DISAGREEMENT_COLOUR, NUMBER_DISC_RADIUS, draw_disagreement, draw_number_disc, draw_ring,
    draw_rings, number_disc_area,
};
