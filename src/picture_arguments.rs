//! Arguments of all verbs that draw pictures.

use clap::Args;
use figures::{AnimationFormat, FigureFormat, FigureOptions, FigureSize};
use wellposed::report::PictureOptions;

/// Which pictures are drawn, and how.
#[derive(Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct PictureArguments {
    /// File formats of the pictures: png, svg, pdf, and html for a page of all results; or none, without animations
    #[arg(long = "pictures", value_name = "FORMATS", default_value = "png,svg,html", value_parser = parse_formats)]
    formats: PictureFormats,
    /// Draw no pictures, animations and page, as --pictures none does
    #[arg(long = "no-pictures", conflicts_with = "formats")]
    has_no_pictures: bool,
    /// File formats of animations of snapshots: gif, apng, separated by commas; or none
    #[arg(long, value_name = "FORMATS", default_value = "gif", value_parser = parse_animations)]
    animations: AnimationFormats,
    /// Size of the pictures, e.g. 1200x800 in pixels, 170x120mm, or 85mm for a width with the height that text of 6 points
    /// needs [default: 1600 pixels wide]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    size: Option<FigureSize>,
    /// Resolution of PNG pictures, dots per inch [default: 200, with a size in mm 300]
    #[arg(long, value_name = "N", value_parser = parse_dpi)]
    dpi: Option<f64>,
    /// Draw no title and subtitle
    #[arg(long = "no-title")]
    has_no_title: bool,
}

/// File formats of pictures named by an argument, each once; empty for `none`. `None` is the page.
#[derive(Clone)]
struct PictureFormats(Vec<Option<FigureFormat>>);

/// File formats of animations named by an argument; empty for `none`.
#[derive(Clone)]
struct AnimationFormats(Vec<AnimationFormat>);

impl From<PictureArguments> for PictureOptions {
    fn from(arguments: PictureArguments) -> Self {
        let PictureArguments { formats, has_no_pictures, animations, size, dpi, has_no_title } =
            arguments;
        let formats = if has_no_pictures { Vec::new() } else { formats.0 };
        let figure =
            FigureOptions { size, dpi, has_heading: !has_no_title, ..FigureOptions::default() };
        let has_page = formats.contains(&None);
        let formats = formats.into_iter().flatten().collect();
        Self { formats, has_page, figure, animations: animations.0, ..Self::default() }
    }
}

fn parse_formats(text: &str) -> Result<PictureFormats, String> {
    let pictures = [FigureFormat::Png, FigureFormat::Svg, FigureFormat::Pdf];
    let [png, svg, pdf] = pictures.map(|format| (format.extension(), Some(format)));
    parse_list(text, &[png, svg, pdf, ("html", None)]).map(PictureFormats)
}

fn parse_animations(text: &str) -> Result<AnimationFormats, String> {
    let known = [AnimationFormat::Gif, AnimationFormat::Apng];
    parse_list(text, &known.map(|format| (format.extension(), format))).map(AnimationFormats)
}

/// Parses names of formats separated by commas; `none` gives an empty list.
fn parse_list<F: Copy + PartialEq>(text: &str, known: &[(&str, F)]) -> Result<Vec<F>, String> {
    let mut formats = Vec::new();
    if text == "none" {
        return Ok(formats);
    }
    for name in text.split(',') {
        let Some((_, format)) = known.iter().find(|own| own.0 == name) else {
            let names: Vec<&str> = known.iter().map(|own| own.0).collect();
            return Err(format!(
                "'{name}' is not a format: expected {}, or none",
                names.join(", ")
            ));
        };
        if !formats.contains(format) {
            formats.push(*format);
        }
    }
    Ok(formats)
}

/// Parses a width and a height: pixels from 100 to 10000, or with the suffix `mm` millimetres from 10 to 2000. A width in mm
/// needs no height.
fn parse_size(text: &str) -> Result<FigureSize, String> {
    let problem = "expected width and height in pixels from 100 to 10000, such as 1200x800, or in mm from 10 to 2000, such as \
                   170x120mm, or the width alone, such as 85mm";
    let (numbers, is_in_mm) = match text.strip_suffix("mm") {
        Some(numbers) => (numbers, true),
        None => (text.strip_suffix("px").unwrap_or(text), false),
    };
    let parse_mm =
        |text: &str| text.parse().ok().filter(|length: &f64| (10.0..=2000.0).contains(length));
    if is_in_mm && let Some(width) = parse_mm(numbers) {
        return Ok(FigureSize::MillimetresWide(width));
    }
    let size = numbers.split_once('x').and_then(|(width, height)| {
        if is_in_mm {
            return Some(FigureSize::Millimetres([parse_mm(width)?, parse_mm(height)?]));
        }
        let parse =
            |text: &str| text.parse().ok().filter(|length: &u32| (100..=10000).contains(length));
        Some(FigureSize::Pixels([parse(width)?, parse(height)?]))
    });
    size.ok_or_else(|| problem.to_owned())
}

fn parse_dpi(text: &str) -> Result<f64, String> {
    let dpi = text.parse().ok().filter(|dpi: &f64| (20.0..=1200.0).contains(dpi));
    dpi.ok_or_else(|| "expected a number from 20 to 1200".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_named_once_or_not_at_all() {
        let names = |text: &str| {
            let formats = parse_formats(text).map(|formats| formats.0);
            let name = |own: &Option<FigureFormat>| own.map_or("html", FigureFormat::extension);
            formats.map(|list| list.iter().map(name).collect::<Vec<_>>())
        };
        assert_eq!(names("pdf,html,png,pdf").unwrap(), ["pdf", "html", "png"]);
        assert!(names("none").unwrap().is_empty());
        for wrong in ["", "gif", "png,", "none,png", "PNG"] {
            assert!(names(wrong).unwrap_err().contains("expected png, svg, pdf, html"), "{wrong}");
        }
        let animations = |text: &str| parse_animations(text).map(|formats| formats.0);
        let both = [AnimationFormat::Apng, AnimationFormat::Gif];
        assert_eq!(animations("apng,gif,apng").unwrap(), both);
        assert!(animations("none").unwrap().is_empty());
        assert!(animations("mp4").unwrap_err().contains("expected gif, apng, or none"));
    }

    #[test]
    fn sizes_are_in_pixels_or_millimetres() {
        for text in ["1200x800", "1200x800px"] {
            assert_eq!(parse_size(text).unwrap(), FigureSize::Pixels([1200, 800]));
        }
        assert_eq!(parse_size("85.5x60mm").unwrap(), FigureSize::Millimetres([85.5, 60.0]));
        assert_eq!(parse_size("85mm").unwrap(), FigureSize::MillimetresWide(85.0));
        for wrong in
            ["1200", "5mm", "0x100", "1200.5x800", "85x60cm", "x", "1e9x1e9mm", "NaNx60mm", "-1x5"]
        {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_dpi("300"), Ok(300.0));
        assert!(parse_dpi("inf").is_err() && parse_dpi("0").is_err());
    }
}
