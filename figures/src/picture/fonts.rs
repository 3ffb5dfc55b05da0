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

/// Computes the width of a line of text, pixels; `size` is the size of the em square, pixels.
pub(crate) fn text_width(content: &str, size: f64, bold: bool) -> f64 {
    // Measured at a large size, since the library rounds to whole pixels.
    const MEASURING_SIZE: f64 = 200.0;
    register_fonts();
    let layout = font(MEASURING_SIZE * BITMAP_SIZE_PER_EM, bold).layout_box(content);
    layout.map_or(0.0, |((left, _), (right, _))| f64::from(right - left) * size / MEASURING_SIZE)
}
