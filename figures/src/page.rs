//! Elements shared by all figures: titles, axes and legends.

use crate::picture::{Anchor, INK, PALE_INK, Picture, Rectangle, Text, text_width};
use crate::scale::{self, Tick};
use std::cell::Cell;

/// Width of a figure for a full page or a screen, pixels.
pub(crate) const WIDTH: f64 = 1600.0;
/// Usual height of a figure of this width, pixels; a large legend increases it.
pub(crate) const HEIGHT: f64 = 1100.0;

thread_local! {
    /// Width and usual height of the page of the picture that this thread lays out, pixels.
    static PAGE_SIZE: Cell<[f64; 2]> = const { Cell::new([WIDTH, HEIGHT]) };
}

/// Returns the width of the page of the picture that is laid out, pixels.
pub(crate) fn width() -> f64 {
    PAGE_SIZE.get()[0]
}

/// Returns the usual height of the page of the picture that is laid out, pixels.
pub(crate) fn height() -> f64 {
    PAGE_SIZE.get()[1]
}

/// Returns whether the page has no space for two panels beside each other.
pub(crate) fn is_narrow() -> bool {
    width() < 0.75 * WIDTH
}

/// Returns the usual height of a page with a disc, pixels; of a narrow page, whose width limits the disc, at most
/// `max_height`.
pub(crate) fn disc_page_height(max_height: f64) -> f64 {
    if is_narrow() { height().min(max_height) } else { height() + 60.0 }
}

/// Returns the length that corresponds to `length` on a page of the usual height, pixels.
pub(crate) fn scale_height(length: f64) -> f64 {
    length * height() / HEIGHT
}

/// Lays out a picture on a page of `size`, pixels. Texts have the same size on all pages, so that on a small page they are
/// large beside the picture.
pub(crate) fn lay_out_on_page<T>(size: [f64; 2], lay_out: impl FnOnce() -> T) -> T {
    /// Restores the size of the page.
    struct Restored([f64; 2]);
    impl Drop for Restored {
        fn drop(&mut self) {
            PAGE_SIZE.set(self.0);
        }
    }
    let _restored = Restored(PAGE_SIZE.replace(size));
    lay_out()
}
/// Margin along the edges of the figure, pixels.
pub(crate) const MARGIN: f64 = 44.0;

/// Font sizes of title and subtitle, pixels, and of those of a narrow page.
const HEADING_SIZES: [f64; 2] = [38.0, 26.0];
const NARROW_HEADING_SIZES: [f64; 2] = [28.0, MIN_TEXT_SIZE];
/// Smallest font size, pixels; texts of a narrow page are not reduced below it.
pub(crate) const MIN_TEXT_SIZE: f64 = 22.0;
/// Font size of axis names, pixels.
pub(crate) const AXIS_NAME_SIZE: f64 = 28.0;
/// Font size of tick labels and legends, pixels.
pub(crate) const TICK_LABEL_SIZE: f64 = 26.0;
/// Length of labelled ticks, pixels.
const TICK_LENGTH: f64 = 9.0;
/// Line width of frames and ticks, pixels.
pub(crate) const FRAME_LINE_WIDTH: f64 = 2.0;

/// Space at which [`wrap_text`] does not break a line.
const NO_BREAK_SPACE: char = '\u{a0}';

/// Breaks a text into at most `max_lines` lines of `width` pixels; a truncated text ends in an ellipsis.
pub(crate) fn wrap_text(
    text: &str,
    size: f64,
    is_bold: bool,
    width: f64,
    max_lines: usize,
) -> Vec<String> {
    let fits = |line: &str| text_width(line, size, is_bold) <= width;
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    let is_break = |c: char| c.is_whitespace() && c != NO_BREAK_SPACE;
    for word in text.split(is_break).filter(|word| !word.is_empty()) {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if fits(&longer) {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        // A word wider than a line is broken at any character.
        for letter in word.chars() {
            line.push(letter);
            if !fits(&line) && line.chars().count() > 1 {
                line.pop();
                lines.push(std::mem::replace(&mut line, letter.to_string()));
            }
        }
        // The remaining text is truncated, which bounds the run time for long texts.
        if lines.len() > max_lines {
            break;
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    if lines.len() > max_lines {
        lines.truncate(max_lines);
        if let Some(last) = lines.last_mut() {
            last.push('…');
            while !fits(last) && last.chars().count() > 1 {
                last.pop();
                last.pop();
                last.push('…');
            }
        }
    }
    lines.into_iter().map(|line| line.replace(NO_BREAK_SPACE, " ")).collect()
}

/// Sets the numbers of a heading as in print: `1.250e-7 m²` as 1.25×10⁻⁷ m², `2 1/s` as 2 s⁻¹. A quantity with its value
/// is kept on one line.
fn typeset_heading(text: &str) -> String {
    text.split("; ").map(typeset_list).collect::<Vec<_>>().join("; ")
}

/// Sets the numbers of a list whose parts are separated by commas.
fn typeset_list(text: &str) -> String {
    const MAX_KEPT: usize = 30;
    let parts = text.split(", ").map(|part| {
        let words: Vec<String> = part.split(' ').map(typeset_number).collect();
        let is_number = |word: &str| word.chars().next_back().is_some_and(|c| c.is_numeric());
        let mut whole = String::new();
        for (index, word) in words.iter().enumerate() {
            let unit = word.strip_prefix("1/").filter(|unit| unit.chars().all(char::is_alphabetic));
            whole += if index > 0 { " " } else { "" };
            match unit.filter(|_| index > 0 && is_number(&words[index - 1])) {
                Some(unit) => whole += &format!("{unit}⁻¹"),
                None => whole += word,
            }
        }
        match whole.contains(" = ") && whole.chars().count() <= MAX_KEPT {
            true => whole.replace(' ', "\u{a0}"),
            false => whole,
        }
    });
    parts.collect::<Vec<_>>().join(", ")
}

/// Writes a number in scientific notation with a power of ten; returns other words unchanged.
fn typeset_number(word: &str) -> String {
    let number = word.trim_end_matches([';', '.', ')', '°']);
    let Some((mantissa, exponent)) = number.split_once('e') else { return word.to_owned() };
    let is_decimal = |text: &str| text.chars().all(|c| c.is_ascii_digit() || "+-.".contains(c));
    match number.parse::<f64>() {
        Ok(value) if is_decimal(mantissa) && is_decimal(exponent) && value != 0.0 => {
            let digits = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
            scale::format_scientific(value, digits) + &word[number.len()..]
        }
        _ => word.to_owned(),
    }
}

/// Fits a text into one line of `width` pixels: the font size is reduced by up to a third, on a narrow page to
/// [`MIN_TEXT_SIZE`], then the text is truncated. Returns text and size.
pub(crate) fn fit_text(text: &str, size: f64, width: f64) -> (String, f64) {
    let natural = text_width(text, size, false);
    if natural <= width {
        return (text.to_owned(), size);
    }
    let smallest = if is_narrow() { MIN_TEXT_SIZE.min(size) } else { size / 1.5 };
    let smaller = (size * width / natural).max(smallest);
    let line = wrap_text(text, smaller, false, width * 1.0001, 1).pop().unwrap_or_default();
    (line, smaller)
}

/// Creates a picture of figure width and `height` pixels with title and subtitle.
pub(crate) fn create_page(height: f64, title: &str, subtitle: &str) -> Picture {
    let mut picture = Picture::new(width() as u32, height as u32);
    let bottom = draw_heading(&mut picture, title, subtitle);
    picture.end_heading(bottom - MARGIN);
    picture
}

/// Computes the y position below title and subtitle, pixels.
pub(crate) fn heading_bottom(title: &str, subtitle: &str) -> f64 {
    draw_heading(&mut Picture::new(width() as u32, 1), title, subtitle)
}

/// Writes title and subtitle; returns the y position below them.
fn draw_heading(picture: &mut Picture, title: &str, subtitle: &str) -> f64 {
    let width = f64::from(picture.width) - 2.0 * MARGIN;
    let mut bottom = MARGIN;
    let [title_size, subtitle_size] =
        if is_narrow() { NARROW_HEADING_SIZES } else { HEADING_SIZES };
    for (text, size, is_bold, colour, max_lines) in
        [(title, title_size, true, INK, 2), (subtitle, subtitle_size, false, PALE_INK, 3)]
    {
        for line in wrap_text(&typeset_heading(text), size, is_bold, width, max_lines) {
            let at = [MARGIN, bottom + 0.76 * size];
            picture.draw_text(Text { is_bold, colour, ..Text::new(at, Anchor::Start, size, line) });
            bottom += 1.3 * size;
        }
        bottom += 0.2 * size;
    }
    bottom + 12.0
}

/// Height below the frame needed by [`draw_bottom_axis`], pixels.
pub(crate) const BOTTOM_AXIS_HEIGHT: f64 =
    TICK_LENGTH + 1.5 * TICK_LABEL_SIZE + 1.4 * AXIS_NAME_SIZE;

/// Draws ticks and axis name below a frame; ticks are located in pixels.
pub(crate) fn draw_bottom_axis(
    picture: &mut Picture,
    frame: Rectangle,
    ticks: &[Tick],
    name: &str,
) {
    let Rectangle { left, right, bottom, .. } = frame;
    for (x, label) in ticks {
        let length = if label.is_empty() { 0.6 * TICK_LENGTH } else { TICK_LENGTH };
        picture.draw_line([[*x, bottom], [*x, bottom + length]], FRAME_LINE_WIDTH, INK);
        let at = [*x, bottom + TICK_LENGTH + 0.3 * TICK_LABEL_SIZE + 0.76 * TICK_LABEL_SIZE];
        if !label.is_empty() {
            picture.draw_text(Text::new(at, Anchor::Middle, TICK_LABEL_SIZE, label));
        }
    }
    if !name.is_empty() {
        let (name, size) = fit_text(name, AXIS_NAME_SIZE, frame.width());
        let at =
            [0.5 * (left + right), bottom + TICK_LENGTH + 1.4 * TICK_LABEL_SIZE + AXIS_NAME_SIZE];
        picture.draw_text(Text::new(at, Anchor::Middle, size, name));
    }
}

/// Computes the width to the left of the frame needed by [`draw_left_axis`], pixels.
pub(crate) fn left_axis_width(ticks: &[Tick]) -> f64 {
    1.4 * AXIS_NAME_SIZE + max_label_width(ticks) + 10.0 + TICK_LENGTH
}

/// Draws ticks and axis name to the left of a frame; ticks are located in pixels.
pub(crate) fn draw_left_axis(picture: &mut Picture, frame: Rectangle, ticks: &[Tick], name: &str) {
    let Rectangle { left, top, bottom, .. } = frame;
    for (y, label) in ticks {
        let length = if label.is_empty() { 0.6 * TICK_LENGTH } else { TICK_LENGTH };
        picture.draw_line([[left, *y], [left - length, *y]], FRAME_LINE_WIDTH, INK);
        if !label.is_empty() {
            let at = [left - TICK_LENGTH - 6.0, y + 0.36 * TICK_LABEL_SIZE];
            picture.draw_text(Text::new(at, Anchor::End, TICK_LABEL_SIZE, label));
        }
    }
    if name.is_empty() {
        return;
    }
    let x = left - TICK_LENGTH - 10.0 - max_label_width(ticks) - 0.4 * AXIS_NAME_SIZE;
    draw_vertical_name(picture, x, [top, bottom], name);
}

/// Writes the name of a vertical axis or colour bar beside it. On a narrow page, where frames are low, a long name extends
/// beside the axis below the frame.
pub(crate) fn draw_vertical_name(
    picture: &mut Picture,
    x: f64,
    [top, bottom]: [f64; 2],
    name: &str,
) {
    let space_below = if is_narrow() { BOTTOM_AXIS_HEIGHT - 20.0 } else { 0.0 };
    let (name, size) = fit_text(name, AXIS_NAME_SIZE, bottom - top + space_below);
    let excess = (text_width(&name, size, false) - (bottom - top)).max(0.0);
    let at = [x, 0.5 * (top + bottom + excess)];
    picture.draw_text(Text { is_vertical: true, ..Text::new(at, Anchor::Middle, size, name) });
}

/// Returns the width of the widest tick label, pixels.
pub(crate) fn max_label_width(ticks: &[Tick]) -> f64 {
    ticks.iter().map(|(_, label)| text_width(label, TICK_LABEL_SIZE, false)).fold(0.0, f64::max)
}

/// Returns the largest set of ticks whose labels do not overlap along `length` pixels; `compute_ticks` computes the
/// ticks for a maximum number. If none fits, returns the ticks for the maximum number 2.
pub(crate) fn choose_ticks(
    length: f64,
    is_vertical: bool,
    compute_ticks: impl Fn(usize) -> Vec<Tick>,
) -> Vec<Tick> {
    let with_empty_text = |max_count| (compute_ticks(max_count), String::new());
    choose_ticks_with_multiplier(length, is_vertical, with_empty_text).0
}

/// Returns the ticks of [`choose_ticks`] with the text that `compute_ticks` returns beside them, such as a common factor
/// of their numbers.
pub(crate) fn choose_ticks_with_multiplier(
    length: f64,
    is_vertical: bool,
    compute_ticks: impl Fn(usize) -> (Vec<Tick>, String),
) -> (Vec<Tick>, String) {
    let max_count = if is_vertical { (length / 65.0) as usize } else { (length / 70.0) as usize };
    let fits = |(ticks, _): &(Vec<Tick>, String)| {
        let label_extent = if is_vertical {
            1.5 * TICK_LABEL_SIZE
        } else {
            max_label_width(ticks) + 0.8 * TICK_LABEL_SIZE
        };
        let labelled = ticks.iter().filter(|(_, label)| !label.is_empty()).count();
        labelled as f64 * label_extent <= length
    };
    (2..=max_count).rev().map(&compute_ticks).find(fits).unwrap_or_else(|| compute_ticks(2))
}

/// Function that draws the swatch of a legend entry (sample of its line, marker or fill) in an area.
pub(crate) type Swatch = Box<dyn Fn(&mut Picture, Rectangle)>;

/// Legend entry: text and swatch.
pub(crate) type LegendEntry = (String, Swatch);

/// Legend: swatches with their texts, row by row in aligned columns.
pub(crate) struct Legend {
    entries: Vec<(Vec<String>, Swatch)>,
    column_widths: Vec<f64>,
}

impl Legend {
    const LINE_HEIGHT: f64 = 1.3 * TICK_LABEL_SIZE;
    const ROW_HEIGHT: f64 = 1.7 * TICK_LABEL_SIZE;

    /// Width of swatches, pixels; narrow pages have little space for legends.
    fn swatch_width() -> f64 {
        if is_narrow() { 54.0 } else { 70.0 }
    }

    fn swatch_gap() -> f64 {
        if is_narrow() { 12.0 } else { 16.0 }
    }

    fn column_gap() -> f64 {
        if is_narrow() { 24.0 } else { 40.0 }
    }

    pub fn new(entries: Vec<LegendEntry>, width: f64) -> Self {
        let label_text: Vec<String> =
            entries.iter().map(|(label_text, _)| label_text.clone()).collect();
        Self::with_reserved_texts(entries, &label_text, width)
    }

    /// Creates a legend with columns wide enough for the texts `reserved_texts` in place of the texts of the entries.
    pub fn with_reserved_texts(
        entries: Vec<LegendEntry>,
        reserved_texts: &[String],
        width: f64,
    ) -> Self {
        let beside = Self::swatch_width() + Self::swatch_gap() + Self::column_gap();
        let natural: Vec<f64> = reserved_texts
            .iter()
            .map(|label_text| text_width(label_text, TICK_LABEL_SIZE, false).ceil() + 1.0 + beside)
            .collect();
        let widths = |columns: usize| -> Vec<f64> {
            (0..columns)
                .map(|column| {
                    natural.iter().skip(column).step_by(columns).fold(0.0, |a, &b| b.max(a))
                })
                .collect()
        };
        let fits = |widths: &Vec<f64>| widths.iter().sum::<f64>() <= width + Self::column_gap();
        let column_widths = (2..=5)
            .rev()
            .map(widths)
            .find(fits)
            .unwrap_or_else(|| vec![width + Self::column_gap()]);
        let columns = column_widths.len();
        let entries = entries
            .into_iter()
            .enumerate()
            .map(|(index, (label, swatch))| {
                (
                    wrap_text(
                        &label,
                        TICK_LABEL_SIZE,
                        false,
                        column_widths[index % columns] - beside,
                        2,
                    ),
                    swatch,
                )
            })
            .collect();
        Self { entries, column_widths }
    }

    fn row_heights(&self) -> impl Iterator<Item = f64> {
        self.entries.chunks(self.column_widths.len()).map(|row| {
            let lines = row.iter().map(|(lines, _)| lines.len()).max().unwrap_or(1).max(1);
            Self::ROW_HEIGHT + (lines - 1) as f64 * Self::LINE_HEIGHT
        })
    }

    pub fn height(&self) -> f64 {
        self.row_heights().sum()
    }

    pub fn draw(&self, picture: &mut Picture, left: f64, top: f64) {
        let mut y = top;
        for (row, height) in self.entries.chunks(self.column_widths.len()).zip(self.row_heights()) {
            let mut column_left = left;
            for ((lines, swatch), width) in row.iter().zip(&self.column_widths) {
                let x = column_left;
                column_left += width;
                let area = Rectangle {
                    left: x,
                    top: y + 2.0,
                    right: x + Self::swatch_width(),
                    bottom: y + 2.0 + 1.3 * TICK_LABEL_SIZE,
                };
                swatch(picture, area);
                let x = area.right + Self::swatch_gap();
                for (index, line) in lines.iter().enumerate() {
                    let baseline = y + 2.0 + TICK_LABEL_SIZE + index as f64 * Self::LINE_HEIGHT;
                    picture.draw_text(Text::new(
                        [x, baseline],
                        Anchor::Start,
                        TICK_LABEL_SIZE,
                        line,
                    ));
                }
            }
            y += height;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        let text = "growth rate of the fastest wave over all directions of propagation";
        let lines = wrap_text(text, 28.0, false, 300.0, 10);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| text_width(line, 28.0, false) <= 300.0));
        assert_eq!(lines.join(" "), text);
        let cut = wrap_text(text, 28.0, false, 300.0, 2);
        assert_eq!(cut.len(), 2);
        assert!(cut[1].ends_with('…') && text_width(&cut[1], 28.0, false) <= 300.0);
        let broken = wrap_text(&"x".repeat(5000), 28.0, false, 300.0, 3);
        assert_eq!(broken.len(), 3);
        assert!(wrap_text("  ", 28.0, false, 300.0, 3).is_empty());
    }

    #[test]
    fn numbers_of_headings_are_set_as_in_print() {
        for (text, expected) in [
            ("I = 1.250e-7 m², Q_D = 1 1/s", "I = 1.25×10⁻⁷ m², Q_D = 1 s⁻¹"),
            ("p = 1.000e5 Pa; a = -2.5e-3", "p = 10⁵ Pa; a = −2.5×10⁻³"),
            ("cone e5, 3 of 4 1/s-units, ρ = inf", "cone e5, 3 of 4 1/s-units, ρ = inf"),
        ] {
            assert_eq!(typeset_heading(text).replace(NO_BREAK_SPACE, " "), expected);
        }
        let subtitle = typeset_heading("density ρ = 1600 kg/m³, pressure p = 1000 Pa");
        let lines = wrap_text(&subtitle, 26.0, false, 330.0, 3);
        assert_eq!(lines, ["density ρ = 1600 kg/m³,", "pressure p = 1000 Pa"]);
    }

    #[test]
    fn fitted_text_is_within_the_width() {
        for repeat in [1, 4, 20, 400] {
            let (line, size) = fit_text(&"pressure ".repeat(repeat), 28.0, 400.0);
            assert!(text_width(&line, size, false) <= 401.0);
            assert!((18.6..=28.0).contains(&size));
        }
    }
}
