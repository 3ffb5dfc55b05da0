//! Elements shared by all figures: titles, axes and legends.

use crate::picture::{Anchor, INK, PALE_INK, Picture, Rectangle, Text, text_width};
use crate::scale::Tick;

/// Width of every figure, pixels.
pub(crate) const WIDTH: f64 = 1600.0;
/// Usual height of a figure, pixels; a large legend increases it.
pub(crate) const HEIGHT: f64 = 1100.0;
/// Margin along the edges of the figure, pixels.
pub(crate) const MARGIN: f64 = 44.0;

const TITLE: f64 = 38.0;
const SUBTITLE: f64 = 26.0;
/// Font size of axis names, pixels.
pub(crate) const NAME: f64 = 28.0;
/// Font size of tick labels and legends, pixels.
pub(crate) const NUMBER: f64 = 26.0;
const TICK: f64 = 9.0;
/// Line width of frames and ticks, pixels.
pub(crate) const RULE: f64 = 2.0;

/// Breaks a text into at most `most` lines of `width` pixels; a truncated text ends in an ellipsis.
pub(crate) fn wrap(text: &str, size: f64, bold: bool, width: f64, most: usize) -> Vec<String> {
    let fits = |line: &str| text_width(line, size, bold) <= width;
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
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
        if lines.len() > most {
            break;
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    if lines.len() > most {
        lines.truncate(most);
        if let Some(last) = lines.last_mut() {
            last.push('…');
            while !fits(last) && last.chars().count() > 1 {
                last.pop();
                last.pop();
                last.push('…');
            }
        }
    }
    lines
}

/// Fits a text into one line of `width` pixels: the font size is reduced by up to a third, then the text is truncated.
/// Returns text and size.
pub(crate) fn fit(text: &str, size: f64, width: f64) -> (String, f64) {
    let natural = text_width(text, size, false);
    if natural <= width {
        return (text.to_owned(), size);
    }
    let smaller = (size * width / natural).max(size / 1.5);
    let line = wrap(text, smaller, false, width * 1.0001, 1).pop().unwrap_or_default();
    (line, smaller)
}

/// Writes title and subtitle; returns the y position below them.
pub(crate) fn heading(picture: &mut Picture, title: &str, subtitle: &str) -> f64 {
    let width = f64::from(picture.width) - 2.0 * MARGIN;
    let mut bottom = MARGIN;
    for (text, size, bold, colour) in
        [(title, TITLE, true, INK), (subtitle, SUBTITLE, false, PALE_INK)]
    {
        for line in wrap(text, size, bold, width, 2) {
            let at = [MARGIN, bottom + 0.76 * size];
            picture.text(Text { bold, colour, ..Text::new(at, Anchor::Start, size, line) });
            bottom += 1.3 * size;
        }
        bottom += 0.2 * size;
    }
    bottom + 12.0
}

/// Height below the frame needed by [`bottom_axis`], pixels.
pub(crate) const BOTTOM_AXIS: f64 = TICK + 1.5 * NUMBER + 1.4 * NAME;

/// Draws ticks and axis name below a frame; ticks are located in pixels.
pub(crate) fn bottom_axis(picture: &mut Picture, frame: Rectangle, ticks: &[Tick], name: &str) {
    let Rectangle { left, right, bottom, .. } = frame;
    for (x, label) in ticks {
        let length = if label.is_empty() { 0.6 * TICK } else { TICK };
        picture.line([[*x, bottom], [*x, bottom + length]], RULE, INK);
        let at = [*x, bottom + TICK + 0.3 * NUMBER + 0.76 * NUMBER];
        if !label.is_empty() {
            picture.text(Text::new(at, Anchor::Middle, NUMBER, label));
        }
    }
    if !name.is_empty() {
        let (name, size) = fit(name, NAME, frame.width());
        let at = [0.5 * (left + right), bottom + TICK + 1.4 * NUMBER + NAME];
        picture.text(Text::new(at, Anchor::Middle, size, name));
    }
}

/// Computes the width to the left of the frame needed by [`left_axis`], pixels.
pub(crate) fn left_axis_width(ticks: &[Tick]) -> f64 {
    1.4 * NAME + widest(ticks) + 10.0 + TICK
}

/// Draws ticks and axis name to the left of a frame; ticks are located in pixels.
pub(crate) fn left_axis(picture: &mut Picture, frame: Rectangle, ticks: &[Tick], name: &str) {
    let Rectangle { left, top, bottom, .. } = frame;
    for (y, label) in ticks {
        let length = if label.is_empty() { 0.6 * TICK } else { TICK };
        picture.line([[left, *y], [left - length, *y]], RULE, INK);
        if !label.is_empty() {
            let at = [left - TICK - 6.0, y + 0.36 * NUMBER];
            picture.text(Text::new(at, Anchor::End, NUMBER, label));
        }
    }
    if name.is_empty() {
        return;
    }
    let (name, size) = fit(name, NAME, frame.height());
    let at = [left - TICK - 10.0 - widest(ticks) - 0.4 * NAME, 0.5 * (top + bottom)];
    let text = Text::new(at, Anchor::Middle, size, name);
    picture.text(Text { upwards: true, ..text });
}

/// Returns the width of the widest tick label, pixels.
pub(crate) fn widest(ticks: &[Tick]) -> f64 {
    ticks.iter().map(|(_, label)| text_width(label, NUMBER, false)).fold(0.0, f64::max)
}

/// Returns the largest set of ticks whose labels do not overlap along `length` pixels; `scale` computes the ticks for a
/// maximum number.
pub(crate) fn spaced(length: f64, upright: bool, scale: impl Fn(usize) -> Vec<Tick>) -> Vec<Tick> {
    let most = if upright { (length / 65.0) as usize } else { (length / 70.0) as usize };
    let fits = |ticks: &Vec<Tick>| {
        let room = if upright { 1.5 * NUMBER } else { widest(ticks) + 0.8 * NUMBER };
        let labelled = ticks.iter().filter(|(_, label)| !label.is_empty()).count();
        labelled as f64 * room <= length
    };
    (2..=most).rev().map(&scale).find(fits).unwrap_or_else(|| scale(2))
}

/// Function that draws the sample of a legend entry in an area.
pub(crate) type Swatch = Box<dyn Fn(&mut Picture, Rectangle)>;

/// Legend entry: text and sample.
pub(crate) type Entry = (String, Swatch);

/// Legend: samples with their texts, row by row in aligned columns.
pub(crate) struct Legend {
    entries: Vec<(Vec<String>, Swatch)>,
    column_widths: Vec<f64>,
}

impl Legend {
    const SWATCH: f64 = 70.0;
    const GAP: f64 = 16.0;
    const BETWEEN: f64 = 40.0;
    const LINE: f64 = 1.3 * NUMBER;
    const ROW: f64 = 1.7 * NUMBER;

    pub fn new(entries: Vec<Entry>, width: f64) -> Self {
        let words: Vec<String> = entries.iter().map(|(words, _)| words.clone()).collect();
        Self::with_room(entries, &words, width)
    }

    /// Creates a legend with columns wide enough for the texts `room` in place of the texts of the entries.
    pub fn with_room(entries: Vec<Entry>, room: &[String], width: f64) -> Self {
        let beside = Self::SWATCH + Self::GAP + Self::BETWEEN;
        let natural: Vec<f64> = room
            .iter()
            .map(|words| text_width(words, NUMBER, false).ceil() + 1.0 + beside)
            .collect();
        let widths = |columns: usize| -> Vec<f64> {
            (0..columns)
                .map(|column| {
                    natural.iter().skip(column).step_by(columns).fold(0.0, |a, &b| b.max(a))
                })
                .collect()
        };
        let fits = |widths: &Vec<f64>| widths.iter().sum::<f64>() <= width + Self::BETWEEN;
        let column_widths =
            (2..=5).rev().map(widths).find(fits).unwrap_or_else(|| vec![width + Self::BETWEEN]);
        let columns = column_widths.len();
        let entries = entries
            .into_iter()
            .enumerate()
            .map(|(index, (label, swatch))| {
                (wrap(&label, NUMBER, false, column_widths[index % columns] - beside, 2), swatch)
            })
            .collect();
        Self { entries, column_widths }
    }

    fn row_heights(&self) -> impl Iterator<Item = f64> {
        self.entries.chunks(self.column_widths.len()).map(|row| {
            let lines = row.iter().map(|(lines, _)| lines.len()).max().unwrap_or(1).max(1);
            Self::ROW + (lines - 1) as f64 * Self::LINE
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
                    right: x + Self::SWATCH,
                    bottom: y + 2.0 + 1.3 * NUMBER,
                };
                swatch(picture, area);
                let x = area.right + Self::GAP;
                for (index, line) in lines.iter().enumerate() {
                    let baseline = y + 2.0 + NUMBER + index as f64 * Self::LINE;
                    picture.text(Text::new([x, baseline], Anchor::Start, NUMBER, line));
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
        let lines = wrap(text, 28.0, false, 300.0, 10);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| text_width(line, 28.0, false) <= 300.0));
        assert_eq!(lines.join(" "), text);
        let cut = wrap(text, 28.0, false, 300.0, 2);
        assert_eq!(cut.len(), 2);
        assert!(cut[1].ends_with('…') && text_width(&cut[1], 28.0, false) <= 300.0);
        let broken = wrap(&"x".repeat(5000), 28.0, false, 300.0, 3);
        assert_eq!(broken.len(), 3);
        assert!(wrap("  ", 28.0, false, 300.0, 3).is_empty());
    }

    #[test]
    fn fitted_lines_fit() {
        for repeat in [1, 4, 20, 400] {
            let (line, size) = fit(&"pressure ".repeat(repeat), 28.0, 400.0);
            assert!(text_width(&line, size, false) <= 401.0);
            assert!((18.6..=28.0).contains(&size));
        }
    }
}
