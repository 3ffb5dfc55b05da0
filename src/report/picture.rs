//! Pictures of a report, and the options with which they are drawn.

use super::page::{PagePicture, embed_picture};
use crate::Error;
use figures::{AnimationFormat, FigureError, FigureFormat, FigureOptions, FigureOutput};
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

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

/// File formats, size and heading of the pictures that a verb draws, and how many are drawn at the same time.
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
    /// Number of threads that draw pictures other than animations, each one picture at a time.
    pub thread_count: NonZero<usize>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            formats: vec![FigureFormat::Png, FigureFormat::Svg],
            has_page: true,
            figure: FigureOptions::default(),
            animations: vec![AnimationFormat::Gif],
            thread_count: NonZero::<usize>::MIN,
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

/// Draws pictures and passes the files to `put` by name, in order; returns the pictures of the page, none if there is no
/// page. Each thread draws one file at a time.
///
/// # Errors
/// A picture cannot be drawn, or `put` fails.
pub fn draw_pictures<E: From<Error>>(
    pictures: &[ReportPicture],
    options: &PictureOptions,
    mut put: impl FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<Vec<PagePicture>, E> {
    // The page has the vector format. Files of the default size are drawn once for both.
    let page_format = options.has_page.then_some(FigureFormat::Svg);
    let is_shared = options.figure == FigureOptions::default();
    let of_page = page_format.filter(|format| !(is_shared && options.formats.contains(format)));
    let outputs: Vec<FigureOutput> = options
        .formats
        .iter()
        .map(|format| FigureOutput { format: *format, options: options.figure })
        .chain(of_page.map(FigureOutput::from))
        .collect();
    let mut page_pictures = Vec::new();
    // A few pictures at a time, so that those that wait for being written take little memory.
    let group_length = options.thread_count.get().div_ceil(outputs.len().max(1));
    for group in pictures.chunks(group_length) {
        let jobs: Vec<(&ReportPicture, FigureOutput)> = group
            .iter()
            .flat_map(|picture| outputs.iter().map(move |output| (picture, *output)))
            .collect();
        let mut drawn = draw_concurrently(&jobs, options.thread_count).into_iter();
        for ReportPicture { file_stem: stem, draw_function: draw } in group {
            let mut of_default_size = Vec::new();
            for (index, output) in outputs.iter().enumerate() {
                let bytes = drawn.next().unwrap_or_else(|| draw(*output)).map_err(Error::from)?;
                if let Some(format) = options.formats.get(index) {
                    put(&format!("{stem}.{}", format.extension()), &bytes)?;
                }
                if options.has_page && output.options == FigureOptions::default() {
                    of_default_size.push((output.format, bytes));
                }
            }
            if !options.has_page {
                continue;
            }
            let draw = |format: FigureFormat| -> Result<Vec<u8>, Error> {
                match of_default_size.iter().find(|own| own.0 == format) {
                    Some((_, bytes)) => Ok(bytes.clone()),
                    None => Ok(draw(format.into())?),
                }
            };
            let svg = draw(FigureFormat::Svg)?;
            let element = embed_picture(stem, &svg, || draw(FigureFormat::Png))?;
            page_pictures.push(PagePicture { file_stem: stem, element });
        }
    }
    Ok(page_pictures)
}

/// Draws pictures on this thread and on others, as many as start; returns their bytes in order.
fn draw_concurrently(
    jobs: &[(&ReportPicture, FigureOutput)],
    thread_count: NonZero<usize>,
) -> Vec<Result<Vec<u8>, FigureError>> {
    let (next, drawn) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(jobs.len())));
    let work = || {
        while let Some((index, (picture, output))) = {
            let index = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(index).map(|job| (index, job))
        } {
            let bytes = (picture.draw_function)(*output);
            drawn.lock().unwrap_or_else(PoisonError::into_inner).push((index, bytes));
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..thread_count.get().min(jobs.len()) {
            // This thread draws all pictures if no other can be started.
            let _ = std::thread::Builder::new().spawn_scoped(scope, work);
        }
        work();
    });
    let mut drawn = drawn.into_inner().unwrap_or_else(PoisonError::into_inner);
    drawn.sort_by_key(|(index, _)| *index);
    drawn.into_iter().map(|(_, bytes)| bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verifies that order and bytes of the files do not depend on the number of threads, and that only the requested
    /// formats are drawn.
    #[test]
    fn pictures_do_not_depend_on_threads() {
        let count = std::sync::Arc::new(AtomicUsize::new(0));
        let pictures: Vec<ReportPicture> = ["a", "b", "c", "d", "e"]
            .into_iter()
            .map(|stem| {
                let count = std::sync::Arc::clone(&count);
                ReportPicture::new(stem, move |output| {
                    count.fetch_add(1, Ordering::Relaxed);
                    Ok(format!("<svg>{stem} {}</svg>", output.format.extension()).into_bytes())
                })
            })
            .collect();
        let draw = |thread_count: usize, formats: &[FigureFormat], has_page: bool| {
            let options = PictureOptions {
                formats: formats.to_vec(),
                has_page,
                thread_count: NonZero::new(thread_count).unwrap(),
                ..PictureOptions::default()
            };
            let mut files = Vec::new();
            let put = |name: &str, bytes: &[u8]| {
                files.push((name.to_owned(), bytes.to_vec()));
                Ok::<(), Error>(())
            };
            let of_page = draw_pictures(&pictures, &options, put).unwrap();
            let of_page = of_page.into_iter().map(|own| (own.file_stem, own.element));
            (files, of_page.collect::<Vec<_>>(), count.swap(0, Ordering::Relaxed))
        };
        let both = [FigureFormat::Png, FigureFormat::Svg];
        for (formats, has_page, expected) in [
            (&both[..], true, 10),
            (&both[..1], false, 5),
            (&both[..1], true, 10),
            (&[], true, 5),
            (&[], false, 0),
        ] {
            let one = draw(1, formats, has_page);
            assert_eq!((one.0.len(), one.2), (5 * formats.len(), expected));
            assert_eq!(one.1.len(), if has_page { 5 } else { 0 });
            for threads in [2, 3, 100] {
                assert!(draw(threads, formats, has_page) == one, "{threads} threads");
            }
        }
    }
}
