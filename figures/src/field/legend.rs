//! Legend of a field figure.

use super::borders::draw_borders;
use super::colour_map::{SHADES, Scale, UNKNOWN_GROUND, UNKNOWN_HATCH};
use super::contours::{Levels, draw_level, draw_ruled};
use super::figure::{FieldFigure, FieldMarkKind};
use super::marks::draw_mark;
use super::plastic::{DOTS, draw_dots};
use crate::page::{self};
use crate::picture::{INK, Picture, Point, Rectangle};
use crate::scale::plain;
use crate::verdict_map::percent;

/// Legend entry, with the widest text that the entry may have in other figures with the same scale.
pub(super) struct FieldEntry {
    pub(super) words: String,
    pub(super) widest: String,
    pub(super) swatch: page::Swatch,
}

/// Widest text of a share of cells; in figures with a fixed scale the entries of varying text are short.
const WIDEST_SHARE: &str = ">99.9 %";

impl FieldFigure {
    /// Builds the legend entries. The entry of non-finite values is the last, so that it does not shift the other
    /// entries between frames.
    pub(super) fn legend(
        &self,
        scale: &Scale,
        levels: &Levels,
        has_borders: bool,
        names_left_out: usize,
    ) -> Vec<FieldEntry> {
        let mut entries: Vec<FieldEntry> = Vec::new();
        entries.extend(self.constant_entry(scale));
        entries.extend(self.clipped_entry(scale));
        entries.extend(self.level_entries(scale, levels));
        entries.extend(self.border_entry(has_borders));
        entries.extend(self.plastic_entry(scale));
        entries.extend(self.mark_entries());
        if names_left_out > 0 {
            let words = match names_left_out {
                1 => "1 name left out for want of room".to_owned(),
                count => format!("{count} names left out for want of room"),
            };
            entries.push(entry(words, |_, _| {}));
        }
        entries.extend(self.unknown_entry(scale));
        if !scale.is_fixed {
            for FieldEntry { words, widest, .. } in &mut entries {
                widest.clone_from(words);
            }
        }
        entries
    }

    /// Builds the entry that states the value of a constant field.
    fn constant_entry(&self, scale: &Scale) -> Option<FieldEntry> {
        let cells = self.values.len();
        let first = self.values[0];
        let is_constant = self.values.iter().all(|value| *value == first);
        let everywhere = if scale.end == 0.0 && scale.unknown == 0 {
            Some("zero everywhere".to_owned())
        } else if scale.end == 0.0 && scale.unknown < cells {
            Some("zero wherever it is finite".to_owned())
        } else {
            let is_said = is_constant && scale.unknown == 0;
            is_said.then(|| format!("{} everywhere", plain(first)))
        };
        // With a fixed scale the colours show the value.
        let words = everywhere.filter(|_| !scale.is_fixed)?;
        let colon = if self.label.is_empty() { "" } else { ": " };
        let ground = scale.colour(if scale.end == 0.0 { 0 } else { scale.step(first) });
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            picture.fill(area, ground);
            picture.frame(area, 1.5, INK);
        };
        Some(entry(format!("{}{colon}{words}", self.label), swatch))
    }

    /// Builds the entry that states the limits of the colour scale.
    fn clipped_entry(&self, scale: &Scale) -> Option<FieldEntry> {
        if scale.clipped == 0 && !scale.is_fixed {
            return None;
        }
        let sign = if scale.is_signed { "±" } else { "" };
        let share = percent(scale.clipped, self.values.len());
        let end = plain(scale.end);
        let beyond = |share: &str| format!("beyond {sign}{end} ({share})");
        let [words, widest] = if scale.is_fixed {
            [share.as_str(), WIDEST_SHARE].map(beyond)
        } else {
            let largest = plain(scale.extreme);
            let of_cells = of_cells(scale);
            let clipped = format!("clipped at {sign}{end} (largest {largest}; {share}{of_cells})");
            [clipped.clone(), clipped]
        };
        let (low, high) = (scale.step(-scale.end), SHADES);
        let colours =
            [if scale.is_signed { low } else { high }, high].map(|step| scale.colour(step));
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            let middle = 0.5 * (area.left + area.right);
            picture.fill(Rectangle { right: middle, ..area }, colours[0]);
            picture.fill(Rectangle { left: middle, ..area }, colours[1]);
            picture.frame(area, 1.5, INK);
        };
        Some(FieldEntry { words, widest, swatch: Box::new(swatch) })
    }

    /// Builds the entries of the contour lines, or of the hatching of negative values.
    fn level_entries(&self, scale: &Scale, levels: &Levels) -> Vec<FieldEntry> {
        let mut entries = Vec::new();
        match levels {
            Levels::Lines(_) if self.curves.is_some() => {
                let levels = self.level_shares(scale);
                for (sign, words) in
                    [(1.0, "equal value, as numbered"), (-1.0, "equal negative value")]
                {
                    if !levels.iter().any(|level| (*level < 0.0) == (sign < 0.0)) {
                        continue;
                    }
                    let swatch = move |picture: &mut Picture, area: Rectangle| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_level(picture, 0.5 * sign, &[[area.left, y], [area.right, y]]);
                    };
                    entries.push(entry(words.to_owned(), swatch));
                }
            }
            Levels::TooMany => {
                let words = "lines of equal value not drawn: too many";
                entries.push(entry(words.to_owned(), |_, _| {}));
            }
            Levels::Lines(_) => {
                for (sign, words) in [(1.0, "+¼ and +½"), (-1.0, "−¼ and −½")] {
                    let swatch = move |picture: &mut Picture, area: Rectangle| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_level(picture, 0.5 * sign, &[[area.left, y], [area.right, y]]);
                    };
                    entries.push(entry(format!("{words} of the scale"), swatch));
                }
            }
            Levels::Ruled => {
                let ground = scale.colour(-SHADES / 2);
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    picture.fill(area, ground);
                    draw_ruled(picture, area);
                    picture.frame(area, 1.5, INK);
                };
                entries.push(entry("below −¼ of the scale".to_owned(), swatch));
            }
            Levels::None => {}
        }
        entries
    }

    fn border_entry(&self, has_borders: bool) -> Option<FieldEntry> {
        if has_borders {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                draw_borders(picture, vec![Rectangle { top: y, bottom: y, ..area }]);
            };
            Some(entry("border between materials".to_owned(), swatch))
        } else if self.outlines.iter().any(|material| *material != self.outlines[0]) {
            let words = "borders between materials not drawn: too many";
            Some(entry(words.to_owned(), |_, _| {}))
        } else {
            None
        }
    }

    fn plastic_entry(&self, scale: &Scale) -> Option<FieldEntry> {
        let yielded = self.plastic.iter().filter(|yielded| **yielded).count();
        if yielded == 0 && (!scale.is_fixed || self.plastic.is_empty()) {
            return None;
        }
        let swatch = |picture: &mut Picture, area: Rectangle| {
            let y = 0.5 * (area.top + area.bottom);
            let place = |index: i32| [area.left + DOTS * (f64::from(index) + 0.5), y];
            let dots: Vec<Point> = (0..5)
                .flat_map(|index| {
                    [-0.5, 0.5].map(|row| {
                        let [x, y] = place(index);
                        [x, y + row * DOTS]
                    })
                })
                .collect();
            draw_dots(picture, &dots, area);
        };
        let of_cells = of_cells(scale);
        let words = |share: &str| format!("yielded ({share}{of_cells})");
        let share = percent(yielded, self.values.len());
        let [words, widest] = [share.as_str(), WIDEST_SHARE].map(words);
        Some(FieldEntry { words, widest, swatch: Box::new(swatch) })
    }

    /// Builds the entries of sources and receivers, with the number of marks outside the domain.
    fn mark_entries(&self) -> Vec<FieldEntry> {
        let mut entries = Vec::new();
        let frame = Rectangle { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };
        let inside = self.places(frame);
        for (kind, word) in
            [(FieldMarkKind::Source, "source"), (FieldMarkKind::Receiver, "receiver")]
        {
            let all = self.marks.iter().filter(|mark| mark.kind == kind).count();
            let shown = inside.iter().filter(|(_, mark)| mark.kind == kind).count();
            if all > 0 {
                let outside = all - shown;
                let words = match outside {
                    0 => word.to_owned(),
                    _ => format!("{word} ({outside} of {all} outside the picture)"),
                };
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let middle = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
                    draw_mark(picture, middle, kind);
                };
                entries.push(entry(words, swatch));
            }
        }
        entries
    }

    fn unknown_entry(&self, scale: &Scale) -> Option<FieldEntry> {
        if scale.unknown == 0 {
            return None;
        }
        let swatch = |picture: &mut Picture, area: Rectangle| {
            picture.fill(area, UNKNOWN_GROUND);
            let mut y = area.top + 3.0;
            let mut lines = Vec::new();
            while y < area.bottom {
                lines.push(Rectangle { top: y, bottom: y + 1.4, ..area });
                y += 6.0;
            }
            picture.patches(lines, UNKNOWN_HATCH);
            picture.frame(area, 1.5, INK);
        };
        let of_cells = of_cells(scale);
        let share = percent(scale.unknown, self.values.len());
        let words = |share: &str| format!("not a finite number ({share}{of_cells})");
        let [words, widest] = [share.as_str(), WIDEST_SHARE].map(words);
        Some(FieldEntry { words, widest, swatch: Box::new(swatch) })
    }
}

/// Returns the reference of a share of cells; empty with a fixed scale, for lack of space.
fn of_cells(scale: &Scale) -> &'static str {
    if scale.is_fixed { "" } else { " of the cells" }
}

fn entry(words: String, swatch: impl Fn(&mut Picture, Rectangle) + 'static) -> FieldEntry {
    FieldEntry { widest: words.clone(), words, swatch: Box::new(swatch) }
}
