//! Tests of pictures.

use super::geometry::{Point, Rectangle, clip, dashes};
use super::shapes::Picture;
use super::text::{Anchor, INK, Text, WHITE};
use crate::format::Format;

const AREA: Rectangle = Rectangle { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

#[test]
fn lines_are_cut_at_the_edges_and_at_gaps() {
    let through = clip(&[[-5.0, 5.0], [15.0, 5.0]], AREA);
    assert_eq!(through, [[[0.0, 5.0], [10.0, 5.0]]]);
    let inside = [[1.0, 1.0], [2.0, 2.0], [3.0, 1.0]];
    assert_eq!(clip(&inside, AREA), [inside]);
    let gap = [[1.0, 1.0], [2.0, 2.0], [f64::NAN, 3.0], [4.0, 4.0], [5.0, 4.0]];
    assert_eq!(clip(&gap, AREA), [[[1.0, 1.0], [2.0, 2.0]], [[4.0, 4.0], [5.0, 4.0]]]);
    let out_and_in = [[5.0, 5.0], [15.0, 5.0], [5.0, 6.0]];
    assert_eq!(clip(&out_and_in, AREA).len(), 2);
    assert!(clip(&[[-1.0, -1.0], [-2.0, 20.0]], AREA).is_empty());
}

#[test]
fn dashes_have_their_lengths_also_around_corners() {
    let dashes = dashes(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], &[4.0, 0.5]);
    let expected: [&[Point]; 3] = [
        &[[0.0, 0.0], [4.0, 0.0]],
        &[[4.5, 0.0], [5.0, 0.0], [5.0, 3.5]],
        &[[5.0, 4.0], [5.0, 5.0]],
    ];
    assert_eq!(dashes, expected);
}

#[test]
fn every_symbol_of_the_field_is_in_the_fonts() {
    // A missing glyph is drawn as an empty box; pictures are compared, since widths of glyphs may coincide.
    let drawn = |symbol: char| {
        let mut picture = Picture::new(40, 40);
        picture.text(Text::new([5.0, 30.0], Anchor::Start, 28.0, symbol));
        picture.render(Format::Png).unwrap()
    };
    let missing = drawn('\u{10fffd}');
    for symbol in "ΔφνςθκψσρλμαβγηΨΣΩω°²³⁻¹⁰⁴⁵⁶⁷⁸⁹₁₂₃−–×¼½⅓∞√∂≤≥|é".chars()
    {
        assert_ne!(drawn(symbol), missing, "{symbol}");
    }
}

/// Verifies that SVG texts have no characters that XML 1.0 does not allow; files with such characters cannot be read.
#[test]
fn texts_hold_what_xml_allows() {
    let odd = "\u{fffe}a\u{ffff}b\u{0}c\u{1b}d\u{7f}\u{e000}\u{1fffe}";
    let mut picture = Picture::new(200, 20);
    picture.text(Text::new([2.0, 18.0], Anchor::Start, 5.0, odd));
    let svg = String::from_utf8(picture.render(Format::Svg).unwrap()).unwrap();
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
    picture.text(Text::new([2.0, 18.0], Anchor::Start, 5.0, "points=\"-1000000,1 \"/>"));
    picture.patches(vec![at(3.0), at(7.0), Rectangle { right: 20.0, ..at(20.0) }], INK);
    picture.patches(vec![at(15.0)], WHITE);
    let svg = String::from_utf8(picture.render(Format::Svg).unwrap()).unwrap();
    assert!(svg.contains("fill=\"#191919\" d=\"M9 15h12v12h-12zM21 15h12v12h-12z\"/>"), "{svg}");
    assert!(svg.contains("fill=\"#FFFFFF\" d=\"M45 15h12v12h-12z\"/>"), "{svg}");
    assert!(!svg.contains("<polygon"));
    let (width, pixels) = crate::tests::pixels(&picture.render(Format::Png).unwrap());
    let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] == 25;
    for (x, y) in (0..30).flat_map(|x| (0..12).map(move |y| (x, y))) {
        assert_eq!(dark(x, y), (3..11).contains(&x) && (5..9).contains(&y), "{x} {y}");
    }
}

#[test]
fn text_lies_within_its_bounds() {
    for upwards in [false, true] {
        let mut picture = Picture::new(300, 300);
        let mut text = Text::new([150.0, 150.0], Anchor::Middle, 30.0, "Hxgpd|10⁴");
        text.upwards = upwards;
        let bounds = text.bounds();
        picture.text(text);
        let bytes = picture.render(Format::Png).unwrap();
        let (_, pixels) = crate::tests::pixels(&bytes);
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
