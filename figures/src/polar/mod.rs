//! Polar diagram of growth rates against the direction of the wave vector.

mod circles;
mod curves;
mod draw;
mod figure;
mod labels;
mod legend;
mod numbers;
mod radial;
#[cfg(test)]
mod tests;

pub(crate) use circles::{NEUTRAL, RING, RING_LABEL, at, ring};
pub(crate) use curves::{draw_markers, parts, places};
pub use figure::{PolarFigure, Spoke, SpokeStyle};
pub(crate) use labels::{DEGREES, Label, ROW, draw_degrees, draw_labels, labels};
pub(crate) use numbers::{backing, best_numbers, most_numbers};
