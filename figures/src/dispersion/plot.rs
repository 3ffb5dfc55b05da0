//! One panel of a dispersion figure: lines of all branches, levels and bands.

use plotters::style::RGBColor;

use super::axes::{Kind, Scale};
use super::figure::{Band, Level};
use super::labels::{LABEL, densified, free_text, tag_place};
use super::looks::{BAND, COLOURS, GROUP, LEVEL_WIDTH};
use super::tags::{RING, draw_ring, draw_tag, tag_area};
use crate::growth::{GRID, LINE_WIDTH, LINEAR};
use crate::page::{self, RULE};
use crate::picture::{INK, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip};
use crate::scale::Tick;

/// Content of one panel.
pub(super) struct Plot<'a> {
    pub(super) frame: Rectangle,
    pub(super) x: Scale,
    pub(super) y: Scale,
    /// Points of the solid and of the dashed line of each branch.
    pub(super) solid: Vec<Vec<Point>>,
    pub(super) dashed: Vec<Vec<Point>>,
    /// Measured points of each branch, drawn as rings.
    pub(super) rings: Vec<Vec<Point>>,
    pub(super) levels: &'a [Level],
    pub(super) pattern: &'static [f64],
    pub(super) bands: &'a [Band],
}

impl Plot<'_> {
    pub(super) fn place(&self, [x, y]: Point) -> Point {
        let Rectangle { left, bottom, .. } = self.frame;
        let (x, y) = (self.x.share(x), self.y.share(y));
        [left + x * self.frame.width(), bottom - y * self.frame.height()]
    }

    fn height_of(&self, value: f64) -> f64 {
        self.frame.bottom - self.y.share(value) * self.frame.height()
    }

    pub(super) fn inside(&self, lines: &[Vec<Point>]) -> Vec<Vec<Vec<Point>>> {
        let parts = |line: &Vec<Point>| {
            let points: Vec<Point> = line.iter().map(|&point| self.place(point)).collect();
            clip(&points, self.frame)
        };
        lines.iter().map(parts).collect()
    }

    /// Computes the area of a band, clamped to the frame; `None` if empty.
    pub(super) fn band(&self, band: &Band) -> Option<Rectangle> {
        let frame = self.frame;
        let least = if matches!(self.y.kind, Kind::Log) { 0.0 } else { f64::NEG_INFINITY };
        let [bottom, top] = [band.from, band.to]
            .map(|value| self.height_of(value.max(least)).clamp(frame.top, frame.bottom));
        let known = !band.from.is_nan() && !band.to.is_nan() && top < bottom;
        known.then_some(Rectangle { top, bottom, ..frame })
    }

    pub(super) fn draw(&self, picture: &mut Picture, x_label: Option<&str>, y_label: &str) {
        let frame = self.frame;
        let bands: Vec<(Rectangle, &Band)> =
            self.bands.iter().filter_map(|band| Some((self.band(band)?, band))).collect();
        let x_ticks: Vec<Tick> = self
            .x
            .ticks(frame.width(), false)
            .into_iter()
            .map(|(share, label)| (frame.left + share * frame.width(), label))
            .collect();
        let y_ticks: Vec<Tick> = self
            .y
            .ticks(frame.height(), true)
            .into_iter()
            .map(|(share, label)| (frame.bottom - share * frame.height(), label))
            .collect();
        let levels: Vec<(f64, &str)> = self
            .levels
            .iter()
            .map(|level| (self.height_of(level.value), level.label.as_str()))
            .filter(|(y, _)| *y >= frame.top && *y <= frame.bottom)
            .collect();
        let (solid, dashed) = (self.inside(&self.solid), self.inside(&self.dashed));
        self.draw_ground(picture, &bands, &x_ticks, &y_ticks);
        for (y, _) in &levels {
            let ends = [[frame.left, *y], [frame.right, *y]];
            picture.dashed(&ends, self.pattern, LEVEL_WIDTH, PALE_INK);
        }
        self.draw_lines(picture, &solid, &dashed);
        picture.frame(frame, RULE, INK);
        self.draw_words(picture, &levels, &bands, &solid, &dashed);
        match x_label {
            Some(name) => page::bottom_axis(picture, frame, &x_ticks, name),
            None => {
                let bare: Vec<Tick> = x_ticks.iter().map(|(x, _)| (*x, String::new())).collect();
                page::bottom_axis(picture, frame, &bare, "");
            }
        }
        page::left_axis(picture, frame, &y_ticks, y_label);
    }

    /// Draws the bands, the linear part of a symmetric logarithmic axis and the grid lines.
    fn draw_ground(
        &self,
        picture: &mut Picture,
        bands: &[(Rectangle, &Band)],
        x_ticks: &[Tick],
        y_ticks: &[Tick],
    ) {
        let frame = self.frame;
        if let Kind::Symmetric(_) = self.y.kind {
            let [bottom, top] = [-1.0, 1.0].map(|place: f64| {
                let share = (place - self.y.low) / (self.y.high - self.y.low);
                (frame.bottom - share * frame.height()).clamp(frame.top, frame.bottom)
            });
            picture.fill(Rectangle { top, bottom, ..frame }, LINEAR);
        }
        for (area, _) in bands {
            picture.fill(*area, BAND);
        }
        for (x, _) in x_ticks.iter().filter(|(_, label)| !label.is_empty()) {
            picture.line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID);
        }
        for (y, _) in y_ticks.iter().filter(|(_, label)| !label.is_empty()) {
            picture.line([[frame.left, *y], [frame.right, *y]], 1.2, GRID);
        }
        let zero = self.height_of(0.0);
        if zero > frame.top + 1.0 && zero < frame.bottom - 1.0 {
            picture.line([[frame.left, zero], [frame.right, zero]], 2.0, RGBColor(110, 110, 110));
        }
    }

    /// Draws the lines and the rings of all branches.
    fn draw_lines(
        &self,
        picture: &mut Picture,
        solid: &[Vec<Vec<Point>>],
        dashed: &[Vec<Vec<Point>>],
    ) {
        let frame = self.frame;
        for (lines, pattern) in [(dashed, GROUP), (solid, &[])] {
            for (branch, parts) in lines.iter().enumerate() {
                for part in parts {
                    picture.dashed(part, pattern, LINE_WIDTH, COLOURS[branch % COLOURS.len()]);
                }
            }
        }
        for (branch, points) in self.rings.iter().enumerate() {
            for place in points.iter().map(|&point| self.place(point)) {
                let [x, y] = place;
                // Rings that the frame would clip are omitted.
                if x > frame.left + RING
                    && x < frame.right - RING
                    && y > frame.top + RING
                    && y < frame.bottom - RING
                {
                    draw_ring(picture, place, COLOURS[branch % COLOURS.len()]);
                }
            }
        }
    }

    /// Draws the labels of levels and bands, then the branch numbers; each is placed clear of lines and of earlier
    /// labels.
    fn draw_words(
        &self,
        picture: &mut Picture,
        levels: &[(f64, &str)],
        bands: &[(Rectangle, &Band)],
        solid: &[Vec<Vec<Point>>],
        dashed: &[Vec<Vec<Point>>],
    ) {
        let frame = self.frame;
        let mut lines: Vec<Vec<Point>> =
            solid.iter().chain(dashed).flatten().map(|part| densified(part)).collect();
        let places = self.rings.iter().flatten().map(|&point| self.place(point));
        let mut taken: Vec<Rectangle> = places.map(tag_area).collect();
        let level_lines =
            levels.iter().map(|(y, _)| vec![[frame.left, *y], [frame.right, *y]]).collect();
        lines.extend::<Vec<Vec<Point>>>(level_lines);
        for (y, label) in levels {
            let baselines = [y - 0.24 * LABEL - 5.0, y + 0.76 * LABEL + 6.0];
            if let Some((hits, text)) = free_text(label, &baselines, frame, &lines, &taken) {
                if hits > 0.0 {
                    picture.fill(text.bounds(), WHITE);
                }
                taken.push(text.bounds());
                picture.text(Text { colour: PALE_INK, ..text });
            }
        }
        for (area, band) in bands {
            let middle = 0.5 * (area.top + area.bottom) + 0.26 * LABEL;
            if area.height() < 1.2 * LABEL {
                continue;
            }
            // Omitted if it would cover lines, since the legend has the label as well.
            let text = free_text(&band.label, &[middle], frame, &lines, &taken);
            if let Some((_, text)) = text.filter(|(hits, _)| *hits == 0.0) {
                taken.push(text.bounds());
                picture.text(text);
            }
        }
        for (branch, parts) in solid.iter().enumerate() {
            // Dashed lines of the other branches count like solid lines.
            let others: Vec<Point> = [solid, dashed]
                .into_iter()
                .flat_map(|lines| lines.iter().enumerate())
                .filter(|(other, _)| *other != branch)
                .flat_map(|(_, parts)| parts.iter())
                .flat_map(|part| densified(part))
                .collect();
            if let Some(at) = tag_place(parts, &others, frame, &taken) {
                taken.push(tag_area(at));
                draw_tag(picture, at, branch + 1, COLOURS[branch % COLOURS.len()]);
            }
        }
    }
}
