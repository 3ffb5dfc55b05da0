//! Tests of size, resolution, heading and PDF of pictures.

use crate::NoteFigure;
use crate::error::FigureError;
use crate::format::{FigureFormat, FigureOptions, FigureOutput, FigureSize};
use crate::page;
use crate::picture::{Anchor, INK, Picture, Rectangle, Text};
use crate::seismogram::{SeismogramFigure, SeismogramPanel, Trace};

fn sample() -> Picture {
    let mut picture = page::create_page(600.0, "Title", "subtitle");
    let top = page::heading_bottom("Title", "subtitle");
    let area = Rectangle { left: 100.0, top, right: 900.0, bottom: top + 300.0 };
    picture.fill_rectangle(area, INK);
    picture.draw_curve(&[[50.0, 500.0], [800.0, 550.0], [1500.0, 450.0]], &[], 4.0, INK);
    picture.draw_text(Text::new([1000.0, 400.0], Anchor::Middle, 28.0, "wave number c_p, k^2"));
    picture
}

fn draw(picture: &Picture, format: FigureFormat, options: FigureOptions) -> Vec<u8> {
    picture.render(FigureOutput { format, options }).unwrap()
}

/// Returns size and pixels per metre of a PNG.
fn png_header(bytes: &[u8]) -> ([u32; 2], Option<u32>) {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let info = reader.info();
    ([info.width, info.height], info.pixel_dims.map(|own| own.xppu))
}

#[test]
fn pictures_have_the_requested_size_and_resolution() {
    let picture = sample();
    let header = |size, dpi| {
        let options = FigureOptions { size, dpi, ..FigureOptions::default() };
        png_header(&draw(&picture, FigureFormat::Png, options))
    };
    assert_eq!(header(None, None), ([1600, 600], None));
    // 100 dots per inch are half of the 200 at which a picture is 1600 pixels wide: 3937 per metre.
    assert_eq!(header(None, Some(100.0)), ([800, 300], Some(3937)));
    assert_eq!(
        header(Some(FigureSize::Pixels([500, 500])), Some(254.0)),
        ([500, 500], Some(10_000))
    );
    // 85 mm at 300 dots per inch: 85 / 25.4 × 300 = 1003.9.
    let in_mm = FigureSize::Millimetres([85.0, 50.8]);
    assert_eq!(header(Some(in_mm), None), ([1004, 600], Some(11_811)));
    let options = FigureOptions { size: Some(in_mm), ..FigureOptions::default() };
    let svg = String::from_utf8(draw(&picture, FigureFormat::Svg, options)).unwrap();
    assert!(
        svg.contains("width=\"85mm\" height=\"50.8mm\" viewBox=\"0 0 4800 1800\""),
        "{}",
        &svg[..200]
    );
    let huge = FigureOptions { size: Some(FigureSize::Pixels([20_000; 2])), ..options };
    let refused = picture.render(FigureOutput { format: FigureFormat::Png, options: huge });
    assert!(matches!(refused, Err(FigureError::TooManyPixels { .. })));
}

#[test]
fn scaled_pictures_show_the_same() {
    let picture = sample();
    let options = FigureOptions { dpi: Some(400.0), ..FigureOptions::default() };
    let (width, pixels) = crate::tests::decode_png(&draw(&picture, FigureFormat::Png, options));
    let (small_width, small) =
        crate::tests::decode_png(&draw(&picture, FigureFormat::Png, FigureOptions::default()));
    assert_eq!(width, 2 * small_width);
    // The mean of four pixels is the pixel of the natural size, but for rounding of edges.
    let mut difference = 0.0;
    for (index, value) in small.iter().enumerate().step_by(3) {
        let (row, column) = (index / 3 / small_width, index / 3 % small_width);
        let at = |dx: usize, dy: usize| {
            f64::from(pixels[3 * ((2 * row + dy) * width + 2 * column + dx)])
        };
        let mean = 0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
        difference += (mean - f64::from(*value)).abs() / 255.0;
    }
    assert!(difference < 0.002 * (small.len() / 3) as f64, "{difference}");
}

#[test]
fn bands_do_not_show() {
    let picture = sample();
    assert_eq!(picture.render_bands(37).unwrap(), picture.render_pixels().unwrap());
}

#[test]
fn pictures_without_heading_are_lower_and_otherwise_equal() {
    let without = FigureOptions { has_heading: false, ..FigureOptions::default() };
    let picture = sample();
    let (_, all) =
        crate::tests::decode_png(&draw(&picture, FigureFormat::Png, FigureOptions::default()));
    let (width, rest) = crate::tests::decode_png(&draw(&picture, FigureFormat::Png, without));
    let removed = page::heading_bottom("Title", "subtitle") - page::MARGIN;
    assert_eq!(rest.len(), 3 * width * (600.0 - removed).ceil() as usize);
    let dark = |pixels: &[u8]| pixels.iter().filter(|value| **value < 128).count();
    let heading = 3 * width * (removed + page::MARGIN) as usize;
    let share = dark(&rest) as f64 / dark(&all[heading..]) as f64;
    assert!((share - 1.0).abs() < 0.02, "{share}");
    let svg = String::from_utf8(draw(&picture, FigureFormat::Svg, without)).unwrap();
    assert!(!svg.contains("subtitle") && svg.contains("wave number"));
    // Both headings of a picture of two are removed.
    let mut two = sample();
    two.append_below(sample());
    let svg = String::from_utf8(draw(&two, FigureFormat::Svg, without)).unwrap();
    assert!(!svg.contains("subtitle") && svg.matches("wave number").count() == 2);
}

/// Reads the decompressed streams of a PDF and checks its cross-reference table.
fn read_pdf_streams(bytes: &[u8]) -> Vec<Vec<u8>> {
    use std::io::Read as _;
    let find = |needle: &[u8], from: usize| {
        bytes[from..].windows(needle.len()).position(|own| own == needle).map(|at| from + at)
    };
    let table = find(b"\nxref\n", 0).unwrap() + 1;
    let text = String::from_utf8_lossy(&bytes[table..]);
    let count: usize = text.lines().nth(1).unwrap()[2..].trim().parse().unwrap();
    for (number, line) in text.lines().skip(2).take(count).enumerate().skip(1) {
        let at: usize = line[..10].parse().unwrap();
        assert!(bytes[at..].starts_with(format!("{number} 0 obj").as_bytes()), "{number}");
    }
    let mut streams = Vec::new();
    let mut from = 0;
    while let Some(at) = find(b"stream\n", from) {
        let end = find(b"endstream", at).unwrap();
        let mut stream = Vec::new();
        let mut decoder = flate2::read::ZlibDecoder::new(&bytes[at + 7..end]);
        match decoder.read_to_end(&mut stream) {
            Ok(_) => streams.push(stream),
            Err(_) => streams.push(bytes[at + 7..end].to_vec()),
        }
        from = end + 9;
    }
    streams
}

#[test]
fn pdf_has_the_page_size_the_shapes_and_the_texts() {
    let size = Some(FigureSize::Millimetres([254.0, 127.0]));
    let picture = sample();
    let bytes =
        draw(&picture, FigureFormat::Pdf, FigureOptions { size, ..FigureOptions::default() });
    assert_eq!(
        bytes,
        draw(&picture, FigureFormat::Pdf, FigureOptions { size, ..FigureOptions::default() })
    );
    let text = String::from_utf8_lossy(&bytes);
    // 254 mm are 10 inches of 72 units.
    assert!(text.contains("/MediaBox [0 0 720 360]"));
    let streams = read_pdf_streams(&bytes);
    let content = String::from_utf8_lossy(&streams[0]);
    // 1600 pixels on 720 units: 0.45; the 600 pixels take 270 of the 360 units, 45 above and below.
    assert!(content.starts_with("0.45 0 0 -0.45 0 315 cm"), "{}", &content[..60]);
    assert_eq!(content.matches("Tj").count(), picture.texts().count() + 3);
    // The characters of a copied text come from the maps of the fonts.
    let maps: String = streams.iter().map(|own| String::from_utf8_lossy(own)).collect();
    for letter in "wavenumbcpk2".chars() {
        assert!(maps.contains(&format!("<{:04X}>", u32::from(letter))), "{letter}");
    }
    assert!(bytes.len() < 40_000, "{}: the fonts are not reduced to the used glyphs", bytes.len());
}

#[test]
fn every_figure_takes_the_options() {
    let figure = NoteFigure {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        text: "reason".to_owned(),
        is_disagreement: false,
    };
    let options = FigureOptions { has_heading: false, ..FigureOptions::default() };
    let svg = figure.draw(FigureOutput { format: FigureFormat::Svg, options }).unwrap();
    assert!(!String::from_utf8(svg).unwrap().contains("subtitle"));
    assert!(figure.draw(FigureFormat::Pdf).unwrap().starts_with(b"%PDF-1.7"));
}

/// A figure of the width of a journal column is laid out so that its smallest text has 6 points; one of the width of a
/// page is the natural figure, scaled.
#[test]
fn figures_of_a_column_have_legible_texts() {
    let times: Vec<f64> = (0..100).map(|index| 0.01 * f64::from(index)).collect();
    let values: Vec<f64> = times.iter().map(|time| (9.0 * time).sin()).collect();
    let trace = |name: &str| Trace { name: name.to_owned(), values: values.clone() };
    let figure = SeismogramFigure {
        title: "Title".to_owned(),
        subtitle: String::new(),
        time_label: "time t, s".to_owned(),
        panels: vec![SeismogramPanel {
            label: "velocity v₁, m/s".to_owned(),
            traces: vec![trace("first"), trace("second")],
        }],
        times,
    };
    let smallest_points = |size: FigureSize| {
        let options = FigureOptions { size: Some(size), ..FigureOptions::default() };
        let output = FigureOutput { format: FigureFormat::Svg, options };
        let svg = String::from_utf8(figure.draw(output).unwrap()).unwrap();
        let number = |text: &str| text.split('"').next().unwrap().parse::<f64>().unwrap();
        let view_box = svg.split("viewBox=\"").nth(1).unwrap().split('"').next().unwrap();
        let sides: Vec<f64> = view_box.split(' ').map(|side| side.parse().unwrap()).collect();
        let [width, height] = options.printed_size([sides[2], sides[3]]);
        let millimetres = (width / sides[2]).min(height / sides[3]);
        let sizes = svg.split("font-size=\"").skip(1).map(number);
        sizes.fold(f64::INFINITY, f64::min) * millimetres * 72.0 / 25.4
    };
    // Tick labels have 26 pixels, the smallest text of all figures 22.
    for size in [FigureSize::Millimetres([85.0, 60.0]), FigureSize::MillimetresWide(85.0)] {
        let column = smallest_points(size);
        assert!((6.0..8.0).contains(&column), "{size:?} {column}");
    }
    let page = smallest_points(FigureSize::Millimetres([170.0, 120.0]));
    assert!((page - 26.0 * 170.0 / 1600.0 * 72.0 / 25.4).abs() < 0.4, "{page}");
}
