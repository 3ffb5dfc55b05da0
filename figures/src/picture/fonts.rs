//! Embedded fonts, and the width of texts.

use std::sync::Once;

use plotters::style::{FontDesc, FontFamily, FontStyle, IntoFont, register_font};

/// Font size of the bitmap backend for an em square of one pixel: the height from ascender to descender, 1.164 em in
/// DejaVu Sans.
pub(super) const BITMAP_SIZE_PER_EM: f64 = 1.164;

/// Name under which the fonts are registered; SVG viewers interpret it as a list of fallbacks.
const FONT_FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

pub(super) fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let fonts =
            [(FontStyle::Normal, dejavu::sans::regular()), (FontStyle::Bold, dejavu::sans::bold())];
        for (style, bytes) in fonts {
            // The fonts are embedded, so that an error here is a build error; drawing text would then return an error.
            let _ = register_font(FONT_FAMILY, style, bytes);
        }
    });
}

pub(super) fn font(size: f64, bold: bool) -> FontDesc<'static> {
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    (FontFamily::Name(FONT_FAMILY), size, style).into_font()
}

/// Part of a text with one size and baseline.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TextRun {
    pub content: String,
    /// Size in units of that of the text.
    pub scale: f64,
    /// Height of the baseline above that of the text, in units of the size of the text.
    pub rise: f64,
}

/// Splits a text into its runs: `c_p` gives an index, `k^order` an exponent. An index follows a single letter.
pub(super) fn split_into_runs(content: &str) -> Vec<TextRun> {
    let mut runs: Vec<TextRun> = Vec::new();
    let mut base = String::new();
    let letters: Vec<char> = content.chars().collect();
    // A subscript digit ends the symbol before: of ∂₂ρ_s, ρ is a single letter.
    let is_of_word = |c: char| c.is_alphabetic() || c.is_ascii_digit() || c == '_';
    let mut index = 0;
    while index < letters.len() {
        let is_single_letter = index > 0
            && letters[index - 1].is_alphabetic()
            && (index < 2 || !is_of_word(letters[index - 2]));
        let (scale, rise) = match letters[index] {
            '_' if is_single_letter => (0.72, -0.13),
            '^' if is_single_letter => (0.72, 0.34),
            _ => (1.0, 0.0),
        };
        let raised: String = match scale == 1.0 {
            true => String::new(),
            false => letters[index + 1..].iter().take_while(|c| c.is_alphanumeric()).collect(),
        };
        if raised.is_empty() {
            base.push(letters[index]);
            index += 1;
            continue;
        }
        index += 1 + raised.chars().count();
        runs.push(TextRun { content: std::mem::take(&mut base), scale: 1.0, rise: 0.0 });
        runs.push(TextRun { content: raised, scale, rise });
    }
    if !base.is_empty() || runs.is_empty() {
        runs.push(TextRun { content: base, scale: 1.0, rise: 0.0 });
    }
    runs
}

/// Computes the width of a line of text with its indices and exponents, pixels; `size` is the size of the em square,
/// pixels.
pub(crate) fn text_width(content: &str, size: f64, bold: bool) -> f64 {
    let runs = split_into_runs(content);
    runs.iter().map(|run| run_width(&run.content, size * run.scale, bold)).sum()
}

/// Computes the width of a text without indices and exponents, pixels.
pub(super) fn run_width(content: &str, size: f64, bold: bool) -> f64 {
    // Measured at a large size, since the library rounds to whole pixels.
    const MEASURING_SIZE: f64 = 200.0;
    register_fonts();
    let layout = font(MEASURING_SIZE * BITMAP_SIZE_PER_EM, bold).layout_box(content);
    layout.map_or(0.0, |((left, _), (right, _))| f64::from(right - left) * size / MEASURING_SIZE)
}
