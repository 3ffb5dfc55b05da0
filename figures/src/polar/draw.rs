//! Drawing of a polar diagram.

use super::circles::{NEUTRAL_COLOUR, RING_COLOUR, draw_circle, polar_to_point};
use super::curves::{draw_curve, full_circle_points};
use super::disc_page::DiscPage;
use super::figure::{PolarFigure, Spoke, SpokeStyle};
use super::labels::build_labels;
use super::radial_scale::{HOLE_FRACTION, RadialScale};
use super::radius_axis::max_ring_numbers;
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::growth::LINEAR_RANGE_COLOUR;
use crate::picture::{Picture, Point, WHITE, circle_points};
use crate::scale::{Tick, format_power_of_ten};

impl PolarFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    pub(super) fn finite_spokes(&self) -> impl Iterator<Item = &Spoke> {
        self.spokes.iter().filter(|spoke| spoke.angle_deg.is_finite())
    }

    pub(super) fn to_picture(&self) -> Picture {
        let labels = build_labels(self.finite_spokes());
        let mut page = DiscPage::new([&self.title, &self.subtitle], self.legend_entries(), labels);
        self.draw_disc(&mut page);
        page.into_picture()
    }

    fn draw_disc(&self, page: &mut DiscPage) {
        let (centre, radius) = (page.centre, page.radius);
        let picture = &mut page.picture;
        let radial = RadialScale::from_curves(&self.curves, radius);

        let disc = |picture: &mut Picture, place: f64, colour| {
            picture.fill_polygon(circle_points(centre, radial.position_radius(place), 360), colour);
        };
        disc(picture, 1.0, LINEAR_RANGE_COLOUR);
        disc(picture, -1.0, WHITE);
        for spoke in SpokeStyle::ALL
            .iter()
            .flat_map(|style| self.finite_spokes().filter(move |spoke| spoke.style == *style))
        {
            // Each half is drawn from the rim inwards, so that the dashes are symmetric about the centre.
            for end in [spoke.angle_deg, spoke.angle_deg + 180.0] {
                let points = [
                    polar_to_point(centre, end, radius),
                    polar_to_point(centre, end, HOLE_FRACTION * radius),
                ];
                spoke.style.draw(picture, &points);
            }
        }
        let max_count = max_ring_numbers((1.0 - HOLE_FRACTION) * radius);
        let rings: Vec<Tick> = radial
            .scale
            .ticks(radial.low, radial.high, max_count)
            .into_iter()
            .filter(|(place, _)| (radial.low..=radial.high).contains(place))
            .collect();
        for (place, label) in rings.iter().filter(|(place, _)| *place != 0.0) {
            let width = if label.is_empty() { 0.8 } else { 1.6 };
            draw_circle(picture, centre, radial.position_radius(*place), width, RING_COLOUR);
        }
        draw_circle(picture, centre, HOLE_FRACTION * radius, 1.6, RING_COLOUR);
        draw_circle(picture, centre, radius, 1.8, NEUTRAL_COLOUR);
        draw_circle(picture, centre, radial.position_radius(0.0), 3.4, NEUTRAL_COLOUR);
        page.draw_labels();

        let lines: Vec<Vec<(f64, Point)>> = self
            .curves
            .iter()
            .map(|line| {
                full_circle_points(&line.points, centre, |growth| radial.growth_radius(growth))
            })
            .collect();
        for (index, points) in lines.iter().enumerate() {
            draw_curve(&mut page.picture, index, points);
        }
        let mut rings: Vec<Tick> = rings
            .into_iter()
            .map(|(place, label)| match place == -1.0 {
                // The innermost ring is always labelled.
                true => (place, format_power_of_ten(true, radial.scale.threshold_exponent)),
                false => (place, label),
            })
            .map(|(place, label)| (radial.position_radius(place), label))
            .collect();
        rings.sort_by(|one, other| one.0.total_cmp(&other.0));
        let name = format!("{} ({})", self.symbol, self.unit);
        page.draw_radius_axis(&rings, &name, HOLE_FRACTION * radius);
    }
}
