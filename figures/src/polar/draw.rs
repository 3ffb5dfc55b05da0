//! Drawing of a polar diagram.

use super::circles::{NEUTRAL, RING, RING_LABEL, at, ring};
use super::curves::{draw_curve, places};
use super::figure::{PolarFigure, Spoke, SpokeStyle};
use super::labels::{DEGREES, Label, ROW, draw_degrees, draw_labels, labels};
use super::numbers::{backing, best_numbers, most_numbers};
use super::radial::{HOLE, Radial};
use crate::error::FigureError;
use crate::format::Format;
use crate::growth::LINEAR;
use crate::page::{self, Legend, MARGIN};
use crate::picture::{Picture, Point, Rectangle, WHITE, circle};
use crate::scale::Tick;

impl PolarFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    pub(super) fn drawn(&self) -> impl Iterator<Item = &Spoke> {
        self.spokes.iter().filter(|spoke| spoke.angle_deg.is_finite())
    }

    pub(super) fn picture(&self) -> Picture {
        let legend = Legend::new(self.legend(), page::WIDTH - 2.0 * MARGIN);
        let mut sheet = Picture::new(page::WIDTH as u32, 1);
        let top = page::heading(&mut sheet, &self.title, &self.subtitle);
        let below = 16.0 + legend.height() + MARGIN - 12.0;
        let sides = labels(self.drawn());
        let count = sides.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let plane = (count * ROW + 20.0).max(780.0);
        let height = (page::HEIGHT + 60.0).max(top + plane + below).ceil();
        let mut picture = Picture::new(page::WIDTH as u32, height as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        let area =
            Rectangle { left: MARGIN, top, right: page::WIDTH - MARGIN, bottom: height - below };
        self.draw_disc(&mut picture, area, &sides);
        legend.draw(&mut picture, MARGIN, area.bottom + 16.0);
        picture
    }

    fn draw_disc(&self, picture: &mut Picture, area: Rectangle, sides: &[Vec<Label>; 2]) {
        let radius = (0.5 * area.height() - DEGREES - 0.7 * RING_LABEL).min(440.0);
        let centre = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
        let radial = Radial::of(&self.curves, radius);

        let disc = |picture: &mut Picture, place: f64, colour| {
            picture.polygon(circle(centre, radial.at_place(place), 360), colour);
        };
        disc(picture, 1.0, LINEAR);
        disc(picture, -1.0, WHITE);
        for spoke in SpokeStyle::ALL
            .iter()
            .flat_map(|style| self.drawn().filter(move |spoke| spoke.style == *style))
        {
            // From the rim inwards, so that the dashes are symmetric.
            for end in [spoke.angle_deg, spoke.angle_deg + 180.0] {
                let points = [at(centre, end, radius), at(centre, end, HOLE * radius)];
                spoke.style.draw(picture, &points);
            }
        }
        let most = most_numbers((1.0 - HOLE) * radius);
        let rings: Vec<Tick> = radial
            .scale
            .ticks(radial.low, radial.high, most)
            .into_iter()
            .filter(|(place, _)| (radial.low..=radial.high).contains(place))
            .collect();
        for (place, label) in rings.iter().filter(|(place, _)| *place != 0.0) {
            let width = if label.is_empty() { 0.8 } else { 1.6 };
            ring(picture, centre, radial.at_place(*place), width, RING);
        }
        ring(picture, centre, HOLE * radius, 1.6, RING);
        ring(picture, centre, radius, 1.8, NEUTRAL);
        ring(picture, centre, radial.at_place(0.0), 3.4, NEUTRAL);
        let leaders: Vec<[Point; 2]> = sides
            .iter()
            .enumerate()
            .flat_map(|(side, labels)| {
                draw_labels(picture, area, centre, radius, labels, side == 0)
            })
            .collect();
        draw_degrees(picture, centre, radius, &leaders);

        let lines: Vec<Vec<(f64, Point)>> = self
            .curves
            .iter()
            .map(|line| places(&line.points, centre, |growth| radial.at(growth)))
            .collect();
        for (index, places) in lines.iter().enumerate() {
            draw_curve(picture, centre, index, places);
        }
        let rings: Vec<Tick> =
            rings.into_iter().map(|(place, label)| (radial.at_place(place), label)).collect();
        let spokes: Vec<f64> = self.drawn().map(|spoke| spoke.angle_deg).collect();
        for text in best_numbers(&rings, &self.unit, &spokes, centre, radius, &lines) {
            picture.fill(backing(&text), WHITE);
            picture.text(text);
        }
    }
}
