//! Page with a disc, the labels of its spokes beside it, the axis of the radius below it, and a legend.

use super::circles::RING_LABEL_SIZE;
use super::labels::{
    ANGLE_LABEL_DISTANCE, LABEL_ROW_HEIGHT, SPOKE_LABEL_DISTANCE, SpokeLabel, draw_angle_labels,
    draw_spoke_labels, list_names, max_label_width,
};
use super::radius_axis::{RADIUS_AXIS_HEIGHT, draw_radius_axis};
use crate::page::{self, Legend, LegendEntry, MARGIN};
use crate::picture::{PALE_INK, Picture, Point, Rectangle};
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
    /// Creates a page with heading; the disc is as large as its labels and the legend permit. On a narrow page, spokes are
    /// labelled by their angles, and their names are in the legend.
    pub(crate) fn new(
        [title, subtitle]: [&str; 2],
        mut entries: Vec<LegendEntry>,
        labels: [Vec<SpokeLabel>; 2],
    ) -> Self {
        let is_narrow = page::is_narrow();
        if is_narrow {
            let names = list_names(&labels).into_iter();
            entries.extend(names.map(|text| (text, Box::new(draw_leader_swatch) as _)));
        }
        let legend = Legend::new(entries, page::width() - 2.0 * MARGIN);
        let top = page::heading_bottom(title, subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let count = labels.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let min_height = (count * LABEL_ROW_HEIGHT + 20.0).max(page::scale_height(780.0));
        let below = below + RADIUS_AXIS_HEIGHT;
        let rim_height = ANGLE_LABEL_DISTANCE + 0.7 * RING_LABEL_SIZE;
        let max_radius = match is_narrow {
            true => {
                let beside = SPOKE_LABEL_DISTANCE + max_label_width(&labels);
                0.5 * page::width() - MARGIN - beside
            }
            false => 440.0,
        };
        let usual_height = page::disc_page_height(top + 2.0 * (max_radius + rim_height) + below);
        let height = usual_height.max(top + min_height + below).ceil();
        let area =
            Rectangle { left: MARGIN, top, right: page::width() - MARGIN, bottom: height - below };
        let radius = (0.5 * area.height() - rim_height).min(max_radius);
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

    /// Draws the axis of the radius below the disc, from the radius `start` to the rim, with numbers at the rings, given by
    /// their radii in ascending order.
    pub(crate) fn draw_radius_axis(&mut self, rings: &[Tick], name: &str, start: f64) {
        let place = [self.centre[0], self.area.bottom];
        let ends = [start, self.radius];
        draw_radius_axis(&mut self.picture, rings, name, place, ends, self.area.left);
    }

    /// Draws the legend and returns the finished picture.
    pub(crate) fn into_picture(mut self) -> Picture {
        let top = self.area.bottom + RADIUS_AXIS_HEIGHT + 16.0;
        self.legend.draw(&mut self.picture, MARGIN, top);
        self.picture
    }
}

/// Draws a leader line as the swatch of the name of a spoke.
fn draw_leader_swatch(picture: &mut Picture, area: Rectangle) {
    let y = 0.5 * (area.top + area.bottom);
    picture.draw_line([[area.left + 0.5 * area.width(), y], [area.right, y]], 1.4, PALE_INK);
}
