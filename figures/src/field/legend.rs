//! Legend of a field figure.

use super::borders::draw_borders;
use super::colour_map::{ColourScale, NON_FINITE_COLOUR, NON_FINITE_HATCH_COLOUR, SHADE_COUNT};
use super::contours::{Contours, draw_contour_line};
use super::draw::Overlay;
use super::figure::{FieldFigure, FieldMarkKind};
use super::marks::{LOADED_LINE_TEXT, draw_loaded_line, draw_mark};
use super::outlines::{SHAPE_OUTLINE, draw_outline};
use super::signs::draw_sign_swatch;
use super::yielded_cells::draw_yielded_swatch;
use crate::page::{self};
use crate::picture::{INK, Picture, Rectangle};
use crate::scale::{format_number, format_scientific};
use crate::verdict_map::format_percent;

/// Legend entry, with the widest text that the entry may have in other figures with the same scale.
pub(super) struct FieldLegendEntry {
    /// Whether the entry is a remark on elements that are not drawn, which follows those of drawn elements.
    pub(super) is_note: bool,
    pub(super) text: String,
    pub(super) widest_text: String,
    pub(super) swatch: page::Swatch,
}

/// Widest text of a percentage of cells; in figures with a fixed scale only the percentages in the texts of entries
/// vary between frames.
const WIDEST_SHARE_TEXT: &str = ">99.9 %";

impl FieldFigure {
    /// Builds the legend entries. The entry of non-finite values is the last, so that it does not shift the other
    /// entries between frames.
    pub(super) fn legend_entries(
        &self,
        scale: &ColourScale,
        levels: &Contours,
        overlay: Overlay,
        omitted_names: usize,
    ) -> Vec<FieldLegendEntry> {
        let mut entries: Vec<FieldLegendEntry> = Vec::new();
        entries.extend(self.constant_entry(scale));
        entries.extend(self.clipped_entry(scale));
        entries.extend(self.sign_entry(scale));
        entries.extend(self.contour_entries(scale, levels));
        entries.extend(self.border_entry(overlay.has_borders));
        entries.extend(self.line_entries(scale, overlay.line_widths));
        entries.extend(self.arrow_entries(overlay.arrow_scale));
        entries.extend(self.yielded_entry(scale));
        entries.extend(self.outline_entries());
        entries.extend(self.mark_entries());
        if omitted_names > 0 {
            let label_text = match omitted_names {
                1 => "1 name left out for want of room".to_owned(),
                count => format!("{count} names left out for want of room"),
            };
            entries.push(build_note(label_text));
        }
        entries.sort_by_key(|entry| entry.is_note);
        entries.extend(self.non_finite_entry(scale));
        if !scale.is_fixed {
            for FieldLegendEntry { text: label_text, widest_text: widest, .. } in &mut entries {
                widest.clone_from(label_text);
            }
        }
        entries
    }

    /// Builds the entry that states the value of a constant field.
    fn constant_entry(&self, scale: &ColourScale) -> Option<FieldLegendEntry> {
        let cells = self.values.len();
        let first = self.values[0];
        let is_constant =
            self.values.iter().copied().chain(self.coloured_values()).all(|value| value == first);
        let everywhere = if scale.limit == 0.0 && scale.non_finite_count == 0 {
            Some("zero everywhere".to_owned())
        } else if scale.limit == 0.0 && scale.non_finite_count < cells {
            Some("zero wherever it is finite".to_owned())
        } else {
            let is_said = is_constant && scale.non_finite_count == 0;
            is_said.then(|| format!("{} everywhere", format_number(first)))
        };
        // With a fixed scale the colours show the value.
        let label_text = everywhere.filter(|_| !scale.is_fixed)?;
        let colon = if self.label.is_empty() { "" } else { ": " };
        let ground =
            scale.step_colour(if scale.limit == 0.0 { 0 } else { scale.colour_step(first) });
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            picture.fill_rectangle(area, ground);
            picture.draw_frame(area, 1.5, INK);
        };
        Some(build_entry(format!("{}{colon}{label_text}", self.label), swatch))
    }

    /// Builds the entry that states the limits of the colour scale.
    fn clipped_entry(&self, scale: &ColourScale) -> Option<FieldLegendEntry> {
        if scale.clipped_count == 0 && !scale.is_fixed {
            return None;
        }
        let sign = if scale.is_signed { "±" } else { "" };
        let share = format_percent(scale.clipped_count, self.values.len());
        let end = format_number(scale.limit);
        let beyond = |share: &str| format!("beyond {sign}{end} ({share})");
        let [label_text, widest_text] = if scale.is_fixed {
            [share.as_str(), WIDEST_SHARE_TEXT].map(beyond)
        } else {
            let largest = format_number(scale.extreme_value);
            let of_cells = cells_suffix(scale);
            let clipped = format!("clipped at {sign}{end} (largest {largest}; {share}{of_cells})");
            [clipped.clone(), clipped]
        };
        let (low, high) = (scale.colour_step(-scale.limit), SHADE_COUNT);
        let colours =
            [if scale.is_signed { low } else { high }, high].map(|step| scale.step_colour(step));
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            let middle = 0.5 * (area.left + area.right);
            picture.fill_rectangle(Rectangle { right: middle, ..area }, colours[0]);
            picture.fill_rectangle(Rectangle { left: middle, ..area }, colours[1]);
            picture.draw_frame(area, 1.5, INK);
        };
        Some(FieldLegendEntry { widest_text, ..build_entry(label_text, swatch) })
    }

    /// Builds the entry of the lines on negative values.
    fn sign_entry(&self, scale: &ColourScale) -> Option<FieldLegendEntry> {
        let is_drawn = self.has_sign_lines(scale) || (scale.is_signed && scale.is_fixed);
        let own = scale.clone();
        let swatch =
            move |picture: &mut Picture, area: Rectangle| draw_sign_swatch(picture, &own, area);
        is_drawn.then(|| build_entry("negative".to_owned(), swatch))
    }

    /// Builds the entries of the contour lines.
    fn contour_entries(&self, scale: &ColourScale, levels: &Contours) -> Vec<FieldLegendEntry> {
        let mut entries = Vec::new();
        match levels {
            Contours::Lines(lines) => {
                for (sign, requested) in
                    [(1.0, "equal value, as numbered"), (-1.0, "equal negative value")]
                {
                    // Other figures with the same fixed scale may have lines.
                    let is_drawn = |level: &f64| {
                        (*level < 0.0) == (sign < 0.0)
                            && (scale.is_fixed || lines.iter().any(|(own, _)| own == level))
                    };
                    let mut drawn = self.relative_levels(scale);
                    drawn.retain(is_drawn);
                    if drawn.is_empty() {
                        continue;
                    }
                    let swatch = move |picture: &mut Picture, area: Rectangle| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_contour_line(picture, 0.5 * sign, &[[area.left, y], [area.right, y]]);
                    };
                    let text = match self.contour_levels {
                        Some(_) => requested.to_owned(),
                        None => {
                            // One form for both numbers: 5×10⁻⁴ and 10⁻³.
                            let is_plain =
                                |share: &f64| (1e-3..1e5).contains(&(share * scale.limit).abs());
                            let format = match drawn.iter().all(is_plain) {
                                true => format_number,
                                false => |value: f64| format_scientific(value, 3),
                            };
                            let level = |share: &f64| format(share * scale.limit);
                            let levels: Vec<String> = drawn.iter().map(level).collect();
                            format!("at {}{}", levels.join(" and "), self.unit_suffix())
                        }
                    };
                    entries.push(build_entry(text, swatch));
                }
            }
            Contours::TooMany => {
                let label_text = "lines of equal value not drawn: too many";
                entries.push(build_note(label_text.to_owned()));
            }
            Contours::None => {}
        }
        entries
    }

    /// Returns the unit of the quantity after a space; empty without unit.
    pub(super) fn unit_suffix(&self) -> String {
        let unit = self.label.rsplit_once(" (").and_then(|(_, rest)| rest.split_once(')'));
        unit.map_or(String::new(), |(unit, _)| format!(" {unit}"))
    }

    /// Builds the entries of outlines of parts of the domain; parts of one label share an entry.
    fn outline_entries(&self) -> Vec<FieldLegendEntry> {
        let mut entries: Vec<FieldLegendEntry> = Vec::new();
        for outline in self.outlines.iter().filter(|own| own.is_inside.contains(&true)) {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                draw_outline(picture, &[[area.left, y], [area.right, y]], SHAPE_OUTLINE);
            };
            if entries.iter().all(|entry| entry.text != outline.label) {
                entries.push(build_entry(outline.label.clone(), swatch));
            }
        }
        entries
    }

    fn border_entry(&self, has_borders: bool) -> Option<FieldLegendEntry> {
        if has_borders {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                draw_borders(picture, vec![Rectangle { top: y, bottom: y, ..area }]);
            };
            let label = match self.border_label.as_str() {
                "" => "border between materials",
                own => own,
            };
            Some(build_entry(label.to_owned(), swatch))
        } else if self.material_indices.iter().any(|material| *material != self.material_indices[0])
        {
            let label_text = "borders between materials not drawn: too many";
            Some(build_note(label_text.to_owned()))
        } else {
            None
        }
    }

    fn yielded_entry(&self, scale: &ColourScale) -> Option<FieldLegendEntry> {
        let yielded = self.has_yielded.iter().filter(|yielded| **yielded).count();
        if yielded == 0 && (!scale.is_fixed || self.has_yielded.is_empty()) {
            return None;
        }
        let swatch = |picture: &mut Picture, area: Rectangle| draw_yielded_swatch(picture, area);
        let of_cells = cells_suffix(scale);
        let label_text = |share: &str| format!("yielded ({share}{of_cells})");
        let share = format_percent(yielded, self.values.len());
        let [label_text, widest] = [share.as_str(), WIDEST_SHARE_TEXT].map(label_text);
        Some(FieldLegendEntry { widest_text: widest, ..build_entry(label_text, swatch) })
    }

    /// Builds the entries of loads, sources and receivers, with the number of marks outside the domain.
    fn mark_entries(&self) -> Vec<FieldLegendEntry> {
        let mut entries = Vec::new();
        if !self.loaded_lines.is_empty() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                draw_loaded_line(picture, &[[area.left, y], [area.right, y]]);
            };
            entries.push(build_entry(LOADED_LINE_TEXT.to_owned(), swatch));
        }
        let frame = Rectangle { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };
        let inside = self.mark_positions(frame);
        for (kind, word) in
            [(FieldMarkKind::Source, "source or load"), (FieldMarkKind::Receiver, "receiver")]
        {
            let all = self.marks.iter().filter(|mark| mark.kind == kind).count();
            let shown = inside.iter().filter(|(_, mark)| mark.kind == kind).count();
            if all > 0 {
                let outside = all - shown;
                let label_text = match outside {
                    0 => word.to_owned(),
                    _ => format!("{word} ({outside} of {all} outside the picture)"),
                };
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let middle = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
                    draw_mark(picture, middle, kind);
                };
                entries.push(build_entry(label_text, swatch));
            }
        }
        entries
    }

    fn non_finite_entry(&self, scale: &ColourScale) -> Option<FieldLegendEntry> {
        if scale.non_finite_count == 0 {
            return None;
        }
        let swatch = |picture: &mut Picture, area: Rectangle| {
            picture.fill_rectangle(area, NON_FINITE_COLOUR);
            let mut y = area.top + 3.0;
            let mut lines = Vec::new();
            while y < area.bottom {
                lines.push(Rectangle { top: y, bottom: y + 1.4, ..area });
                y += 6.0;
            }
            picture.fill_patches(lines, NON_FINITE_HATCH_COLOUR);
            picture.draw_frame(area, 1.5, INK);
        };
        let of_cells = cells_suffix(scale);
        let share = format_percent(scale.non_finite_count, self.values.len());
        let label_text = |share: &str| format!("not a finite number ({share}{of_cells})");
        let [label_text, widest_text] = [share.as_str(), WIDEST_SHARE_TEXT].map(label_text);
        Some(FieldLegendEntry { widest_text, ..build_entry(label_text, swatch) })
    }
}

/// Returns the text that follows a percentage of cells; empty with a fixed scale, for lack of space.
fn cells_suffix(scale: &ColourScale) -> &'static str {
    if scale.is_fixed { "" } else { " of the cells" }
}

pub(super) fn build_entry(
    label_text: String,
    swatch: impl Fn(&mut Picture, Rectangle) + 'static,
) -> FieldLegendEntry {
    FieldLegendEntry {
        is_note: false,
        widest_text: label_text.clone(),
        text: label_text,
        swatch: Box::new(swatch),
    }
}

/// Builds the entry of a remark, in parentheses and without a sample.
pub(super) fn build_note(text: String) -> FieldLegendEntry {
    FieldLegendEntry { is_note: true, ..build_entry(format!("({text})"), |_, _| {}) }
}
