//! Tests of pictures.

use super::fonts::{split_into_runs, text_width};
use super::geometry::{Point, Rectangle, clip_polyline, split_into_dashes};
use super::shapes::Picture;
use super::text::{Anchor, INK, Text, WHITE};
use crate::format::FigureFormat;

mod output;

const CLIP_AREA: Rectangle = Rectangle { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

#[test]
fn polylines_are_clipped_at_edges_and_gaps() {
    let through = clip_polyline(&[[-5.0, 5.0], [15.0, 5.0]], CLIP_AREA);
    assert_eq!(through, [[[0.0, 5.0], [10.0, 5.0]]]);
    let inside = [[1.0, 1.0], [2.0, 2.0], [3.0, 1.0]];
    assert_eq!(clip_polyline(&inside, CLIP_AREA), [inside]);
    let gap = [[1.0, 1.0], [2.0, 2.0], [f64::NAN, 3.0], [4.0, 4.0], [5.0, 4.0]];
    assert_eq!(
        clip_polyline(&gap, CLIP_AREA),
        [[[1.0, 1.0], [2.0, 2.0]], [[4.0, 4.0], [5.0, 4.0]]]
    );
    let out_and_in = [[5.0, 5.0], [15.0, 5.0], [5.0, 6.0]];
    assert_eq!(clip_polyline(&out_and_in, CLIP_AREA).len(), 2);
    assert!(clip_polyline(&[[-1.0, -1.0], [-2.0, 20.0]], CLIP_AREA).is_empty());
}

#[test]
fn dashes_keep_their_lengths_around_corners() {
    let dashes = split_into_dashes(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], &[4.0, 0.5]);
    let expected: [&[Point]; 3] = [
        &[[0.0, 0.0], [4.0, 0.0]],
        &[[4.5, 0.0], [5.0, 0.0], [5.0, 3.5]],
        &[[5.0, 4.0], [5.0, 5.0]],
    ];
    assert_eq!(dashes, expected);
}

#[test]
fn fonts_contain_all_used_symbols() {
    // A missing glyph is drawn as an empty box; pictures are compared, since widths of glyphs may coincide.
    let drawn = |symbol: char| {
        let mut picture = Picture::new(40, 40);
        picture.draw_text(Text::new([5.0, 30.0], Anchor::Start, 28.0, symbol));
        picture.render(FigureFormat::Png).unwrap()
    };
    let missing = drawn('\u{10fffd}');
    for symbol in "ΔφνςθκψσρλμαβγηΨΣΩω°²³⁻¹⁰⁴⁵⁶⁷⁸⁹₁₂₃−–×¼½⅓∞√∂≤≥|é".chars()
    {
        assert_ne!(drawn(symbol), missing, "{symbol}");
    }
}

/// Verifies that SVG texts have no characters that XML 1.0 does not allow; files with such characters cannot be read.
#[test]
fn svg_texts_contain_only_valid_xml_characters() {
    let odd = "\u{fffe}a\u{ffff}b\u{0}c\u{1b}d\u{7f}\u{e000}\u{1fffe}";
    let mut picture = Picture::new(200, 20);
    picture.draw_text(Text::new([2.0, 18.0], Anchor::Start, 5.0, odd));
    let svg = String::from_utf8(picture.render(FigureFormat::Svg).unwrap()).unwrap();
    // Production 2 of XML 1.0: `Char ::= #x9 | #xA | #xD | [#x20-#xD7FF] | [#xE000-#xFFFD] | [#x10000-#x10FFFF]`.
    let is_char = |c: char| {
        let point = u32::from(c);
        [0x9, 0xa, 0xd].contains(&point) || (point >= 0x20 && ![0xfffe, 0xffff].contains(&point))
    };
    assert!(svg.chars().all(is_char), "{svg:?}");
    assert!(svg.contains("\u{fffd}a\u{fffd}b\u{fffd}c\u{fffd}d\u{7f}\u{e000}\u{1fffe}"), "{svg:?}");
}

#[test]
fn patches_are_drawn_alike_in_both_formats() {
    let mut picture = Picture::new(30, 20);
    let at = |left: f64| Rectangle { left, top: 5.0, right: left + 4.0, bottom: 9.0 };
    picture.draw_text(Text::new([2.0, 18.0], Anchor::Start, 5.0, "points=\"-1000000,1 \"/>"));
    picture.fill_patches(vec![at(3.0), at(7.0), Rectangle { right: 20.0, ..at(20.0) }], INK);
    picture.fill_patches(vec![at(15.0)], WHITE);
    let svg = String::from_utf8(picture.render(FigureFormat::Svg).unwrap()).unwrap();
    assert!(svg.contains("fill=\"#191919\" d=\"M9 15h12v12h-12zM21 15h12v12h-12z\"/>"), "{svg}");
    assert!(svg.contains("fill=\"#FFFFFF\" d=\"M45 15h12v12h-12z\"/>"), "{svg}");
    assert!(!svg.contains("<polygon"));
    let (width, pixels) = crate::tests::decode_png(&picture.render(FigureFormat::Png).unwrap());
    let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] == 25;
    for (x, y) in (0..30).flat_map(|x| (0..12).map(move |y| (x, y))) {
        assert_eq!(dark(x, y), (3..11).contains(&x) && (5..9).contains(&y), "{x} {y}");
    }
}

#[test]
fn indices_and_exponents_are_set_apart() {
    let runs = |text: &str| -> Vec<String> {
        split_into_runs(text).into_iter().map(|run| run.content).collect()
    };
    assert_eq!(runs("elastic c_ω, m/s"), ["elastic c", "ω", ", m/s"]);
    assert_eq!(runs("coefficient · k^order"), ["coefficient · k", "order"]);
    assert_eq!(runs("∂₂ρ_s"), ["∂₂ρ", "s"]);
    for plain in ["", "c_", "map_x.csv", "fields_final", "_a", "^2"] {
        assert_eq!(runs(plain), [plain]);
    }
    // An index is narrower than a letter on the line.
    let width = |text: &str| text_width(text, 30.0, false);
    assert!(width("c_p") < width("cp") && width("c_p") > width("c"));
}

#[test]
fn text_is_drawn_within_its_bounds() {
    for upwards in [false, true] {
        let mut picture = Picture::new(300, 300);
        let mut text = Text::new([150.0, 150.0], Anchor::Middle, 30.0, "Hxgpd|c_p10⁴");
        text.is_vertical = upwards;
        let bounds = text.bounds();
        picture.draw_text(text);
        let bytes = picture.render(FigureFormat::Png).unwrap();
        let (_, pixels) = crate::tests::decode_png(&bytes);
        let dark = |index: &usize| pixels[3 * index] < 128;
        let (mut ink, mut inside) = (0, 0);
        for index in (0..300 * 300).filter(dark) {
            let (x, y) = ((index % 300) as f64, (index / 300) as f64);
            ink += 1;
            let slack = 2.0;
            inside += usize::from(
                x > bounds.left - slack
                    && x < bounds.right + slack
                    && y > bounds.top - slack
                    && y < bounds.bottom + slack,
            );
        }
        assert!(ink > 300, "{ink} dark pixels");
        assert_eq!(ink, inside, "upwards: {upwards}");
    }
}

/// Verifies that texts over curves, marked points, texts and edges are listed, and that numbers on discs may cover curves.
#[test]
fn covering_texts_are_listed() {
    let place = |x: f64, y: f64, content: &str| Text::new([x, y], Anchor::Start, 20.0, content);
    let found = |texts: Vec<Text>| {
        let mut picture = Picture::new(300, 300);
        picture.draw_curve(&[[0.0, 100.0], [300.0, 100.0]], &[], 3.0, INK);
        picture.draw_line([[0.0, 200.0], [300.0, 200.0]], 3.0, INK);
        picture.mark_point([150.0, 250.0], 8.0);
        texts.into_iter().for_each(|text| picture.draw_text(text));
        picture.find_covering_texts()
    };
    assert!(found(vec![place(50.0, 80.0, "free"), place(50.0, 205.0, "grid")]).is_empty());
    assert_eq!(found(vec![place(50.0, 106.0, "label")]), ["'label' on a curve"]);
    assert_eq!(found(vec![place(140.0, 255.0, "label")]), ["'label' on a marked point"]);
    assert_eq!(found(vec![place(290.0, 50.0, "label")]), ["'label' beyond the picture"]);
    let two = vec![place(50.0, 50.0, "first"), place(60.0, 50.0, "second")];
    assert_eq!(found(two), ["'second' on 'first'"]);
    let number = Text { is_bold: true, ..place(50.0, 106.0, "3") };
    assert!(found(vec![number.clone()]).is_empty());
    let title = Text { font_size: 38.0, ..number };
    assert_eq!(found(vec![title]), ["'3' on a curve"]);
}
