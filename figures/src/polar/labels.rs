//! Labels of spokes beside the disc, and angles around its rim.

use super::circles::{NEUTRAL, RING_LABEL, at};
use super::figure::Spoke;
use super::numbers::backing;
use crate::directions::spread;
use crate::page::{self, NUMBER};
use crate::picture::{Anchor, PALE_INK, Picture, Point, Rectangle, Text, clip, text_width};

pub(crate) const ROW: f64 = 1.4 * NUMBER;

/// Distance from the rim to the centre of the angles around it, pixels.
pub(crate) const DEGREES: f64 = 32.0;

/// Label of all spokes with the same angle.
pub(crate) struct Label {
    pub(super) angle_deg: f64,
    /// Formatted angle, followed by the labels of its spokes.
    pub(super) words: Vec<String>,
}

impl Label {
    pub(super) fn text(&self) -> String {
        match self.words.split_first() {
            Some((angle, names)) => format!("{angle} {}", names.join(", ")).trim_end().to_owned(),
            None => String::new(),
        }
    }
}

/// Builds the labels on the right and on the left of the disc, from top to bottom, at the upper ends of the spokes;
/// spokes with the same angle share a label.
pub(crate) fn labels<'a>(spokes: impl Iterator<Item = &'a Spoke>) -> [Vec<Label>; 2] {
    let mut labels: Vec<Label> = Vec::new();
    let mut spokes: Vec<&Spoke> = spokes.collect();
    spokes.sort_by(|a, b| a.upper_angle().total_cmp(&b.upper_angle()));
    for spoke in spokes {
        let angle = spoke.words();
        let known = labels.iter().position(|label| label.words[0] == angle);
        let index = known.unwrap_or_else(|| {
            let angle_deg = spoke.upper_angle();
            labels.push(Label { angle_deg, words: vec![angle] });
            labels.len() - 1
        });
        let words = &mut labels[index].words;
        if !spoke.label.is_empty() && !words.contains(&spoke.label) {
            words.push(spoke.label.clone());
        }
    }
    let (mut right, mut left): (Vec<Label>, Vec<Label>) =
        labels.into_iter().partition(|label| label.angle_deg <= 90.0);
    for side in [&mut right, &mut left] {
        side.sort_by(|a, b| {
            let height = |label: &Label| label.angle_deg.to_radians().sin();
            height(b).total_cmp(&height(a))
        });
    }
    [right, left]
}

/// Writes the angles around the rim, except where a leader line passes.
pub(crate) fn draw_degrees(
    picture: &mut Picture,
    centre: Point,
    radius: f64,
    leaders: &[[Point; 2]],
) {
    for step in 0..24 {
        let angle = 15.0 * f64::from(step);
        let length = if step % 2 == 0 { 11.0 } else { 6.0 };
        let ends = [at(centre, angle, radius), at(centre, angle, radius + length)];
        picture.line(ends, 1.8, NEUTRAL);
        let words = format!("{angle}°");
        // The distance of the text's nearest point from the rim is about the same at all angles.
        let (sin, cos) = angle.to_radians().sin_cos();
        let half = 0.5 * text_width(&words, RING_LABEL, false);
        let away = radius + 18.0 + half * cos.abs() + 0.38 * RING_LABEL * sin.abs();
        let [x, y] = at(centre, angle, away);
        let text = Text::new([x, y + 0.36 * RING_LABEL], Anchor::Middle, RING_LABEL, words);
        let is_free = leaders.iter().all(|leader| clip(leader, backing(&text)).is_empty());
        if step % 2 == 0 && is_free {
            picture.text(Text { colour: PALE_INK, ..text });
        }
    }
}

/// Writes the labels beside the disc, with leader lines to the ends of their spokes; returns the leader lines.
pub(crate) fn draw_labels(
    picture: &mut Picture,
    area: Rectangle,
    centre: Point,
    radius: f64,
    labels: &[Label],
    right: bool,
) -> Vec<[Point; 2]> {
    let mut leaders = Vec::new();
    let sign = if right { 1.0 } else { -1.0 };
    // Labels are outside the angles around the rim.
    let away = radius + 2.0 * DEGREES + 12.0;
    let wanted: Vec<f64> =
        labels.iter().map(|label| at(centre, label.angle_deg, away)[1]).collect();
    let heights = spread(&wanted, ROW, [area.top + 0.5 * ROW, area.bottom - 0.5 * ROW]);
    for (label, y) in labels.iter().zip(heights) {
        let inner = ((y - centre[1]).abs() - 0.5 * ROW).max(0.0);
        let end = at(centre, label.angle_deg, radius + 4.0);
        let reach = (away * away - inner * inner).max(0.0).sqrt();
        let x = centre[0] + sign * reach.max(sign * (end[0] - centre[0]) + 34.0);
        let leader = [end, [x - sign * 8.0, y]];
        picture.line(leader, 1.4, PALE_INK);
        leaders.push(leader);
        let room = if right { area.right - x } else { x - area.left };
        let anchor = if right { Anchor::Start } else { Anchor::End };
        let (words, size) = page::fit(&label.text(), NUMBER - 2.0, room);
        let text = Text::new([x, y + 0.36 * size], anchor, size, words);
        picture.text(text);
    }
    leaders
}
