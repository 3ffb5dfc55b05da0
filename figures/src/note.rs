//! Page with a note in place of a figure.

use crate::error::FigureError;
use crate::format::Format;
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
}

/// Font size, pixels.
const SIZE: f64 = 30.0;
/// Maximum number of lines.
const LINES: usize = 12;

impl NoteFigure {
    /// Renders the figure in a file format and returns the bytes of the file.
    ///
    /// # Errors
    /// Rendering or encoding fails.
    pub fn draw(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        self.picture().render(format)
    }

    fn picture(&self) -> Picture {
        let lines = page::wrap(&self.text, SIZE, false, page::WIDTH - 2.0 * MARGIN, LINES);
        let width = page::WIDTH as u32;
        let top = page::heading(&mut Picture::new(width, 1), &self.title, &self.subtitle);
        let height = top + 1.4 * SIZE * lines.len() as f64 + MARGIN;
        let mut picture = Picture::new(width, height.ceil() as u32);
        page::heading(&mut picture, &self.title, &self.subtitle);
        for (index, line) in lines.into_iter().enumerate() {
            let at = [MARGIN, top + (0.76 + 1.4 * index as f64) * SIZE];
            picture.text(Text { colour: INK, ..Text::new(at, Anchor::Start, SIZE, line) });
        }
        picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::png_size;

    #[test]
    fn the_page_is_as_high_as_the_text() {
        let figure = |text: String| NoteFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            text,
        };
        let height = |words: usize| {
            let figure = figure("no measurement ".repeat(words));
            let picture = figure.picture();
            picture.assert_texts_are_apart();
            png_size(&figure.draw(Format::Png).unwrap())[1]
        };
        assert!(height(1) < height(40));
        let svg = figure("not measurable: why".to_owned()).draw(Format::Svg).unwrap();
        assert!(String::from_utf8(svg).unwrap().contains("not measurable: why"));
    }
}
