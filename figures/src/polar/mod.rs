//! Polar diagram of growth rates against the direction of the wave vector.

mod circles;
mod curves;
mod disc_page;
mod draw;
mod figure;
mod labels;
mod legend;
mod radial_scale;
mod radius_axis;
#[cfg(test)]
mod tests;

pub(crate) use circles::{
    NEUTRAL_COLOUR, RING_COLOUR, RING_LABEL_SIZE, draw_circle, polar_to_point,
};
pub(crate) use curves::{full_circle_points, split_at_gaps};
pub(crate) use disc_page::DiscPage;
pub use figure::{PolarFigure, Spoke, SpokeStyle};
pub(crate) use labels::{ANGLE_LABEL_DISTANCE, build_labels, draw_angle_labels};
pub(crate) use radius_axis::{max_ring_numbers, text_background};
