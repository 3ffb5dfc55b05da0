//! Page with a note in place of a figure.

use crate::dispersion::DISAGREEMENT_COLOUR;
use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::page::{self, MARGIN};
use crate::picture::{Anchor, INK, Picture, Text};

/// A note in place of a figure, e.g. the reason why there is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoteFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: subject of the note.
    pub subtitle: String,
    /// Text of the note; at most twelve lines are written.
    pub text: String,
    /// Whether the note states a disagreement and is written in red.
    pub is_disagreement: bool,
}

/// Font size, pixels.
const FONT_SIZE: f64 = 30.0;
/// Maximum number of lines.
const MAX_LINES: usize = 12;

impl NoteFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        output.lay_out(|| self.to_picture()).render(output)
    }

    fn to_picture(&self) -> Picture {
        let lines =
            page::wrap_text(&self.text, FONT_SIZE, false, page::width() - 2.0 * MARGIN, MAX_LINES);
        let top = page::heading_bottom(&self.title, &self.subtitle);
        let height = top + 1.4 * FONT_SIZE * lines.len() as f64 + MARGIN;
        let mut picture = page::create_page(height.ceil(), &self.title, &self.subtitle);
        let colour = if self.is_disagreement { DISAGREEMENT_COLOUR } else { INK };
        for (index, line) in lines.into_iter().enumerate() {
            let at = [MARGIN, top + (0.76 + 1.4 * index as f64) * FONT_SIZE];
            picture.draw_text(Text { colour, ..Text::new(at, Anchor::Start, FONT_SIZE, line) });
        }
        picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FigureFormat;
    use crate::tests::png_size;

    #[test]
    fn page_height_follows_the_text() {
        let figure = |text: String| NoteFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            text,
            is_disagreement: false,
        };
        let height = |label_text: usize| {
            let figure = figure("no measurement ".repeat(label_text));
            let picture = figure.to_picture();
            picture.assert_texts_do_not_overlap();
            png_size(&figure.draw(FigureFormat::Png).unwrap())[1]
        };
        assert!(height(1) < height(40));
        let svg = figure("not measurable: why".to_owned()).draw(FigureFormat::Svg).unwrap();
        assert!(String::from_utf8(svg).unwrap().contains("not measurable: why"));
    }
}
