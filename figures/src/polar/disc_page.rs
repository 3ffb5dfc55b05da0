//! Page with a disc, the labels of its spokes beside it, the axis of the radius below it, and a legend.

use super::circles::RING_LABEL_SIZE;
use super::labels::{
    ANGLE_LABEL_DISTANCE, LABEL_ROW_HEIGHT, SpokeLabel, draw_angle_labels, draw_spoke_labels,
};
use super::radius_axis::{RADIUS_AXIS_HEIGHT, draw_radius_axis};
use crate::page::{self, Legend, LegendEntry, MARGIN};
use crate::picture::{Picture, Point, Rectangle};
use crate::scale::Tick;

/// Page of a polar figure; the figure draws its disc, circles and curves into `picture`.
pub(crate) struct DiscPage {
    pub(crate) picture: Picture,
    /// Centre of the disc.
    pub(crate) centre: Point,
    /// Radius of the disc, pixels.
    pub(crate) radius: f64,
    /// Area of the disc with its labels.
    area: Rectangle,
    /// Labels on the right and on the left of the disc.
    labels: [Vec<SpokeLabel>; 2],
    legend: Legend,
}

impl DiscPage {
    /// Creates a page with heading; the disc is as large as its labels and the legend permit.
    pub(crate) fn new(
        [title, subtitle]: [&str; 2],
        entries: Vec<LegendEntry>,
        labels: [Vec<SpokeLabel>; 2],
    ) -> Self {
        let legend = Legend::new(entries, page::WIDTH - 2.0 * MARGIN);
        let top = page::heading_bottom(title, subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let count = labels.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let min_height = (count * LABEL_ROW_HEIGHT + 20.0).max(780.0);
        let below = below + RADIUS_AXIS_HEIGHT;
        let height = (page::HEIGHT + 60.0).max(top + min_height + below).ceil();
        let area =
            Rectangle { left: MARGIN, top, right: page::WIDTH - MARGIN, bottom: height - below };
        let radius =
            (0.5 * area.height() - ANGLE_LABEL_DISTANCE - 0.7 * RING_LABEL_SIZE).min(440.0);
        let centre = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let picture = page::create_page(height, title, subtitle);
        Self { picture, centre, radius, area, labels, legend }
    }

    /// Draws the labels of the spokes with their leader lines, and the angles around the rim.
    pub(crate) fn draw_labels(&mut self) {
        let Self { picture, area, centre, radius, labels, .. } = self;
        let mut leaders: Vec<[Point; 2]> = Vec::new();
        for (side, labels) in labels.iter().enumerate() {
            leaders.extend(draw_spoke_labels(picture, *area, *centre, *radius, labels, side == 0));
        }
        draw_angle_labels(picture, *centre, *radius, &leaders);
    }

    /// Draws the axis of the radius below the disc, with numbers at the rings, given by their radii.
    pub(crate) fn draw_radius_axis(&mut self, rings: &[Tick], name: &str) {
        let place = [self.centre[0], self.area.bottom];
        draw_radius_axis(&mut self.picture, rings, name, place, self.radius, self.area.left);
    }

    /// Draws the legend and returns the finished picture.
    pub(crate) fn into_picture(mut self) -> Picture {
        let top = self.area.bottom + RADIUS_AXIS_HEIGHT + 16.0;
        self.legend.draw(&mut self.picture, MARGIN, top);
        self.picture
    }
}
