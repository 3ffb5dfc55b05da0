//! Labels of spokes beside the disc, and angles around its rim.

use super::circles::{NEUTRAL_COLOUR, RING_LABEL_SIZE, polar_to_point};
use super::figure::Spoke;
use super::radius_axis::text_background;
use crate::directions::spread_heights;
use crate::page::{self, TICK_LABEL_SIZE};
use crate::picture::{
    Anchor, PALE_INK, Picture, Point, Rectangle, Text, WHITE, clip_polyline, text_width,
};

pub(crate) const LABEL_ROW_HEIGHT: f64 = 1.4 * TICK_LABEL_SIZE;

/// Approximate distance from the rim to the centres of the angles written around it, pixels.
pub(crate) const ANGLE_LABEL_DISTANCE: f64 = 32.0;

/// Distance from the rim to the labels of spokes, which lie outside the angles written around the rim, pixels.
pub(super) const SPOKE_LABEL_DISTANCE: f64 = 2.0 * ANGLE_LABEL_DISTANCE + 12.0;
/// Distance along the rim from an angle within which the start of a leader line takes its place, pixels.
const MIN_START_DISTANCE: f64 = 24.0;
/// Font size of the labels of spokes, pixels.
const SPOKE_LABEL_SIZE: f64 = TICK_LABEL_SIZE - 2.0;

/// Label of all spokes with the same angle, rounded to 0.01°.
pub(crate) struct SpokeLabel {
    pub(super) angle_deg: f64,
    /// Formatted angle, followed by the labels of its spokes.
    pub(super) texts: Vec<String>,
}

impl SpokeLabel {
    pub(super) fn to_text(&self) -> String {
        match self.texts.split_first() {
            Some((angle, names)) => format!("{angle} {}", names.join(", ")).trim_end().to_owned(),
            None => String::new(),
        }
    }

    /// Returns the text beside the disc: on a narrow page the angle.
    fn to_text_beside_disc(&self) -> String {
        match self.texts.first() {
            Some(angle) if page::is_narrow() => angle.clone(),
            _ => self.to_text(),
        }
    }
}

/// Lists the names of spokes, each with its angles, in ascending order of the first: `30°, 150° stationary discontinuity`.
pub(super) fn list_names(labels: &[Vec<SpokeLabel>; 2]) -> Vec<String> {
    let mut named: Vec<&SpokeLabel> =
        labels.iter().flatten().filter(|label| label.texts.len() > 1).collect();
    named.sort_by(|one, other| one.angle_deg.total_cmp(&other.angle_deg));
    let mut angles_by_name: Vec<(String, Vec<&str>)> = Vec::new();
    for label in named {
        let (angle, name) = (label.texts[0].as_str(), label.texts[1..].join(", "));
        match angles_by_name.iter_mut().find(|own| own.0 == name) {
            Some((_, angles)) => angles.push(angle),
            None => angles_by_name.push((name, vec![angle])),
        }
    }
    angles_by_name
        .into_iter()
        .map(|(name, angles)| format!("{} {name}", angles.join(", ")))
        .collect()
}

/// Returns the width of the widest label beside the disc, pixels.
pub(super) fn max_label_width(labels: &[Vec<SpokeLabel>; 2]) -> f64 {
    let widths = labels
        .iter()
        .flatten()
        .map(|label| text_width(&label.to_text_beside_disc(), SPOKE_LABEL_SIZE, false));
    widths.fold(0.0, f64::max)
}

/// Builds the labels on the right and on the left of the disc, from top to bottom, at the upper ends of the spokes;
/// spokes with the same angle share a label.
pub(crate) fn build_labels<'a>(spokes: impl Iterator<Item = &'a Spoke>) -> [Vec<SpokeLabel>; 2] {
    let mut labels: Vec<SpokeLabel> = Vec::new();
    let mut spokes: Vec<&Spoke> = spokes.collect();
    spokes.sort_by(|a, b| a.upper_angle().total_cmp(&b.upper_angle()));
    for spoke in spokes {
        let angle = spoke.format_angle();
        let known = labels.iter().position(|label| label.texts[0] == angle);
        let index = known.unwrap_or_else(|| {
            let angle_deg = spoke.upper_angle();
            labels.push(SpokeLabel { angle_deg, texts: vec![angle] });
            labels.len() - 1
        });
        let label_text = &mut labels[index].texts;
        if !spoke.label.is_empty() && !label_text.contains(&spoke.label) {
            label_text.push(spoke.label.clone());
        }
    }
    let (mut right, mut left): (Vec<SpokeLabel>, Vec<SpokeLabel>) =
        labels.into_iter().partition(|label| label.angle_deg <= 90.0);
    for side in [&mut right, &mut left] {
        side.sort_by(|a, b| {
            let height = |label: &SpokeLabel| label.angle_deg.to_radians().sin();
            height(b).total_cmp(&height(a))
        });
    }
    [right, left]
}

/// Draws ticks around the rim every 15° and writes the angles every 30°, over leader lines that pass, except where a leader
/// line starts, whose label has the angle there.
pub(crate) fn draw_angle_labels(
    picture: &mut Picture,
    centre: Point,
    radius: f64,
    leaders: &[[Point; 2]],
) {
    for step in 0..24 {
        let angle = 15.0 * f64::from(step);
        let length = if step % 2 == 0 { 11.0 } else { 6.0 };
        let ends =
            [polar_to_point(centre, angle, radius), polar_to_point(centre, angle, radius + length)];
        picture.draw_line(ends, 1.8, NEUTRAL_COLOUR);
        let label_text = format!("{angle}°");
        // The distance of the text's nearest point from the rim is about the same at all angles.
        let (sin, cos) = angle.to_radians().sin_cos();
        let half = 0.5 * text_width(&label_text, RING_LABEL_SIZE, false);
        let away = radius + 18.0 + half * cos.abs() + 0.38 * RING_LABEL_SIZE * sin.abs();
        let [x, y] = polar_to_point(centre, angle, away);
        let text =
            Text::new([x, y + 0.36 * RING_LABEL_SIZE], Anchor::Middle, RING_LABEL_SIZE, label_text);
        let background = text_background(&text);
        let crossing = |leader: &&[Point; 2]| !clip_polyline(*leader, background).is_empty();
        let start_distance =
            |leader: &[Point; 2]| (leader[0][0] - ends[0][0]).hypot(leader[0][1] - ends[0][1]);
        let is_labelled = leaders
            .iter()
            .filter(crossing)
            .any(|leader| start_distance(leader) < MIN_START_DISTANCE);
        if step % 2 == 0 && !is_labelled {
            if leaders.iter().any(|leader| crossing(&leader)) {
                picture.fill_rectangle(background, WHITE);
            }
            picture.draw_text(Text { colour: PALE_INK, ..text });
        }
    }
}

/// Writes the labels beside the disc, with leader lines to the ends of their spokes; returns the leader lines.
pub(crate) fn draw_spoke_labels(
    picture: &mut Picture,
    area: Rectangle,
    centre: Point,
    radius: f64,
    labels: &[SpokeLabel],
    is_right: bool,
) -> Vec<[Point; 2]> {
    let mut leaders = Vec::new();
    let sign = if is_right { 1.0 } else { -1.0 };
    let away = radius + SPOKE_LABEL_DISTANCE;
    let preferred_heights: Vec<f64> =
        labels.iter().map(|label| polar_to_point(centre, label.angle_deg, away)[1]).collect();
    let heights = spread_heights(
        &preferred_heights,
        LABEL_ROW_HEIGHT,
        [area.top + 0.5 * LABEL_ROW_HEIGHT, area.bottom - 0.5 * LABEL_ROW_HEIGHT],
    );
    for (label, y) in labels.iter().zip(heights) {
        let inner = ((y - centre[1]).abs() - 0.5 * LABEL_ROW_HEIGHT).max(0.0);
        let end = polar_to_point(centre, label.angle_deg, radius + 4.0);
        let reach = (away * away - inner * inner).max(0.0).sqrt();
        let x = centre[0] + sign * reach.max(sign * (end[0] - centre[0]) + 34.0);
        let leader = [end, [x - sign * 8.0, y]];
        picture.draw_line(leader, 1.4, PALE_INK);
        leaders.push(leader);
        let free_width = if is_right { area.right - x } else { x - area.left };
        let anchor = if is_right { Anchor::Start } else { Anchor::End };
        let (label_text, size) =
            page::fit_text(&label.to_text_beside_disc(), SPOKE_LABEL_SIZE, free_width);
        let text = Text::new([x, y + 0.36 * size], anchor, size, label_text);
        picture.draw_text(text);
    }
    leaders
}
