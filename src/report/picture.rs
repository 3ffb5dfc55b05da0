//! Pictures of a report, and the options with which they are drawn.

use super::page::{PagePicture, embed_picture};
use crate::Error;
use figures::{AnimationFormat, FigureError, FigureFormat, FigureOptions, FigureOutput};

/// Function that draws a picture.
type DrawFunction = Box<dyn Fn(FigureOutput) -> Result<Vec<u8>, FigureError> + Send + Sync>;

/// Picture of a report.
pub struct ReportPicture {
    /// Name of the picture's files without extension.
    file_stem: &'static str,
    draw_function: DrawFunction,
}

impl ReportPicture {
    /// Creates a picture with the file name `stem` from the drawing method of a figure.
    pub fn new(
        stem: &'static str,
        draw: impl Fn(FigureOutput) -> Result<Vec<u8>, FigureError> + Send + Sync + 'static,
    ) -> Self {
        Self { file_stem: stem, draw_function: Box::new(draw) }
    }

    /// Returns the name of the picture's files without extension.
    pub fn file_stem(&self) -> &'static str {
        self.file_stem
    }
}

/// File formats, size and heading of the pictures that a verb draws.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// File formats, each drawn once.
    pub formats: Vec<FigureFormat>,
    /// Whether the page of the results folder is written, with pictures of the default size.
    pub has_page: bool,
    /// Size and heading of all pictures; animations do not follow them.
    pub figure: FigureOptions,
    /// File formats of animations, each drawn once; without effect if neither pictures nor the page are drawn.
    pub animations: Vec<AnimationFormat>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            formats: vec![FigureFormat::Png, FigureFormat::Svg],
            has_page: true,
            figure: FigureOptions::default(),
            animations: vec![AnimationFormat::Gif],
        }
    }
}

impl PictureOptions {
    /// Returns options with which nothing is drawn.
    pub fn no_pictures() -> Self {
        Self { formats: Vec::new(), has_page: false, ..Self::default() }
    }

    /// Returns the file formats of the animations that are drawn.
    pub fn animation_formats(&self) -> &[AnimationFormat] {
        if self.formats.is_empty() && !self.has_page { &[] } else { &self.animations }
    }

    /// Iterates over the names of the files of a picture with the file name `stem`.
    pub fn file_names(&self, stem: &str) -> impl Iterator<Item = String> {
        self.formats.iter().map(move |format| format!("{stem}.{}", format.extension()))
    }
}

/// Draws pictures and passes the files to `put` by name; returns the pictures of the page, none if there is no page.
///
/// # Errors
/// A picture cannot be drawn, or `put` fails.
pub fn draw_pictures<E: From<Error>>(
    pictures: &[ReportPicture],
    options: &PictureOptions,
    mut put: impl FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<Vec<PagePicture>, E> {
    let mut of_page = Vec::new();
    for ReportPicture { file_stem: stem, draw_function: draw } in pictures {
        // Files of the default size are drawn once for both.
        let mut reusable = Vec::new();
        for (format, name) in options.formats.iter().zip(options.file_names(stem)) {
            let output = FigureOutput { format: *format, options: options.figure };
            let bytes = draw(output).map_err(Error::from)?;
            put(&name, &bytes)?;
            if options.has_page && options.figure == FigureOptions::default() {
                reusable.push((*format, bytes));
            }
        }
        if options.has_page {
            let draw = |format: FigureFormat| -> Result<Vec<u8>, Error> {
                match reusable.iter().find(|own| own.0 == format) {
                    Some((_, bytes)) => Ok(bytes.clone()),
                    None => Ok(draw(format.into())?),
                }
            };
            let svg = draw(FigureFormat::Svg)?;
            let element = embed_picture(stem, &svg, || draw(FigureFormat::Png))?;
            of_page.push(PagePicture { file_stem: stem, element });
        }
    }
    Ok(of_page)
}
