//! Fonts, and the width of text.

use std::sync::Once;

use plotters::style::{FontDesc, FontFamily, FontStyle, IntoFont, register_font};

/// The font size for an em square of one pixel in bitmaps: the height from ascender to descender,
/// 1.164 em in DejaVu Sans.
pub(super) const BITMAP_SIZE_PER_EM: f64 = 1.164;

/// The name under which the fonts are registered. SVG viewers read it as a list of preferences.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

pub(super) fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let fonts =
            [(FontStyle::Normal, dejavu::sans::regular()), (FontStyle::Bold, dejavu::sans::bold())];
        for (style, bytes) in fonts {
            // Part of the program, so that a failure is one of the build; text would be refused
            // with a typed error at its first use.
            let _ = register_font(FAMILY, style, bytes);
        }
    });
}

pub(super) fn font(size: f64, bold: bool) -> FontDesc<'static> {
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    (FontFamily::Name(FAMILY), size, style).into_font()
}

/// Width of a line of text in pixels, `size` being that of the em square.
pub(crate) fn text_width(content: &str, size: f64, bold: bool) -> f64 {
    // Measured large: the library rounds to whole pixels.
    const LARGE: f64 = 200.0;
    register_fonts();
    let layout = font(LARGE * BITMAP_SIZE_PER_EM, bold).layout_box(content);
    layout.map_or(0.0, |((left, _), (right, _))| f64::from(right - left) * size / LARGE)
}
