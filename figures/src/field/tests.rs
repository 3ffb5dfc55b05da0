//! Tests of field figures.

use plotters::style::RGBColor;

use super::colour_map::{NEGATIVE, POSITIVE, SHADES, Scale, UNKNOWN_GROUND};
use super::contours::Levels;
use super::draw::Arrangement;
use super::figure::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use crate::format::Format;
use crate::picture::{Colour, INK, Rectangle};

fn figure(columns: usize, rows: usize, value: impl Fn(f64, f64) -> f64) -> FieldFigure {
    let axis = |label: &str, cells: usize| FieldAxis {
        label: label.to_owned(),
        from: 0.0,
        to: 0.1 * cells as f64,
    };
    let centre = |cell: usize| {
        [(cell % columns) as f64 + 0.5, (cell / columns) as f64 + 0.5].map(|place| 0.1 * place)
    };
    FieldFigure {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        x: axis("x (m)", columns),
        y: axis("height y (m)", rows),
        columns,
        rows,
        values: (0..columns * rows)
            .map(|cell| {
                let [x, y] = centre(cell);
                value(x, y)
            })
            .collect(),
        label: "velocity v₂ (m/s)".to_owned(),
        is_signed: true,
        limit: None,
        scale: None,
        curves: None,
        outlines: Vec::new(),
        plastic: Vec::new(),
        marks: Vec::new(),
    }
}

fn mark(x: f64, y: f64, name: &str, kind: FieldMarkKind) -> FieldMark {
    FieldMark { at: [x, y], name: name.to_owned(), kind }
}

fn texts(figure: &FieldFigure) -> Vec<String> {
    let picture = figure.picture(Format::Png).unwrap();
    picture.texts().map(|text| text.content.clone()).collect()
}

fn says(figure: &FieldFigure, words: &str) -> bool {
    texts(figure).iter().any(|text| text.contains(words))
}

/// Verifies in both formats that texts do not overlap, the width of the PNG, and that the SVG is complete and has no
/// NaN.
fn check(figure: &FieldFigure) {
    for format in [Format::Png, Format::Svg] {
        figure.picture(format).unwrap().assert_texts_are_apart();
    }
    let png = figure.draw(Format::Png).unwrap();
    assert_eq!(crate::tests::png_size(&png)[0], 1600);
    let svg = String::from_utf8(figure.draw(Format::Svg).unwrap()).unwrap();
    assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
    assert!(!svg.contains("-1000000,"));
}

fn arranged(figure: &FieldFigure) -> (Scale, Arrangement) {
    let scale = Scale::of(figure);
    let arrangement = figure.arrange(&scale, Format::Png);
    (scale, arrangement)
}

/// Pixels of a rendered picture.
struct Drawn {
    width: usize,
    pixels: Vec<u8>,
    frame: Rectangle,
}

impl Drawn {
    fn new(figure: &FieldFigure) -> Self {
        let (width, pixels) = crate::tests::pixels(&figure.draw(Format::Png).unwrap());
        Self { width, pixels, frame: arranged(figure).1.layout.frame }
    }

    fn pixel(&self, x: f64, y: f64) -> [u8; 3] {
        let start = 3 * (y as usize * self.width + x as usize);
        [0, 1, 2].map(|channel| self.pixels[start + channel])
    }

    /// Returns the colour at shares of the frame's width and height from its lower left corner.
    fn at(&self, right: f64, up: f64) -> [u8; 3] {
        let frame = self.frame;
        self.pixel(frame.left + right * frame.width(), frame.bottom - up * frame.height())
    }

    fn count(&self, chosen: impl Fn([u8; 3]) -> bool) -> usize {
        let Rectangle { left, top, right, bottom } = self.frame;
        let rows = top as usize + 3..bottom as usize - 3;
        rows.flat_map(|y| (left as usize + 3..right as usize - 3).map(move |x| (x, y)))
            .filter(|&(x, y)| chosen(self.pixel(x as f64, y as f64)))
            .count()
    }
}

const fn channels(RGBColor(red, green, blue): Colour) -> [u8; 3] {
    [red, green, blue]
}

#[test]
fn cells_lie_where_the_axes_say_and_have_their_colours() {
    let mut figure = figure(10, 8, |_, _| 0.0);
    figure.is_signed = false;
    figure.values[10 + 2] = 4.0;
    figure.values[7 * 10 + 9] = 2.0;
    figure.values[50] = f64::NAN;
    let scale = Scale::of(&figure);
    let drawn = Drawn::new(&figure);
    assert_eq!(drawn.at(0.25, 1.5 / 8.0), channels(scale.colour(SHADES)));
    assert_eq!(drawn.at(0.95, 7.5 / 8.0), channels(scale.colour(SHADES / 2)));
    assert_eq!(drawn.at(0.55, 0.55), channels(scale.colour(0)));
    // The NaN cell has its background colour between the hatching lines.
    let unknown = drawn.count(|colour| colour == channels(UNKNOWN_GROUND));
    let cell = drawn.frame.width() * drawn.frame.height() / 80.0;
    assert!(unknown as f64 > 0.5 * cell && (unknown as f64) < cell, "{unknown}");
    assert!(says(&figure, "not a finite number (1.2 % of the cells)"));

    // Negative values have the colours of the negative branch, also on a descending axis.
    figure.is_signed = true;
    figure.values[10 + 2] = -4.0;
    (figure.y.from, figure.y.to) = (figure.y.to, figure.y.from);
    let drawn = Drawn::new(&figure);
    assert_eq!(drawn.at(0.25, 1.5 / 8.0), NEGATIVE[5].map(|part| part as u8));
}

#[test]
fn the_domain_keeps_its_shape() {
    for (columns, rows) in [(40, 40), (100, 30), (20, 90), (150, 15), (7, 5)] {
        let figure = figure(columns, rows, |x, y| x - y);
        let layout = arranged(&figure).1.layout;
        let ratio = layout.frame.width() / layout.frame.height();
        let expected = columns as f64 / rows as f64;
        assert!((ratio / expected - 1.0).abs() < 0.02, "{ratio} {expected}");
        assert!(!says(&figure, "stretched"));
        check(&figure);
    }
    assert_eq!(
        crate::tests::png_size(&figure(40, 40, |x, _| x).draw(Format::Png).unwrap())[1],
        1100
    );
    assert!(says(&figure(900, 1, |x, _| x), "height y (m), stretched ×"));
    // A short axis has at least its ends labelled.
    assert!(texts(&figure(900, 4, |x, _| x)).contains(&"0.4".to_owned()));
    assert!(says(&figure(1, 900, |_, y| y), "x (m), stretched ×"));
}

#[test]
fn a_single_cell_among_many_is_not_lost() {
    let mut figure = figure(3000, 2500, |_, _| 0.0);
    figure.values[1701 * 3000 + 1234] = -7.0;
    figure.values[1700 * 3000 + 1234] = 1.0;
    let darkest = channels(Scale::of(&figure).colour(-SHADES));
    let drawn = Drawn::new(&figure);
    let near = (-4..=4).flat_map(|x| (-4..=4).map(move |y| (f64::from(x), f64::from(y))));
    let found = near
        .filter(|(x, y)| drawn.at((1234.5 + x) / 3000.0, (1701.5 + y) / 2500.0) == darkest)
        .count();
    assert!(found > 0);
    let svg = String::from_utf8(figure.draw(Format::Svg).unwrap()).unwrap();
    assert!(svg.matches("fill=\"#072158\"").count() >= 2);
}

#[test]
fn borders_are_drawn_unless_they_would_cover_the_field() {
    let mut figure = figure(100, 80, |_, _| 1.0);
    figure.is_signed = false;
    figure.outlines = (0..8000).map(|cell| u16::from(cell % 100 >= 50)).collect();
    let drawn = Drawn::new(&figure);
    assert_eq!(drawn.at(0.5, 0.3), channels(INK));
    assert_eq!(drawn.at(0.25, 0.3), channels(Scale::of(&figure).colour(SHADES)));
    assert!(says(&figure, "border between materials"));
    check(&figure);
    figure.outlines.fill(3);
    assert!(!says(&figure, "border"));
    figure.outlines = (0..8000).map(|cell| (cell * 7919 % 13) as u16).collect();
    assert!(says(&figure, "borders between materials not drawn"));
    check(&figure);
}

#[test]
fn every_yielded_cell_is_near_a_dot() {
    for size in [12, 400] {
        let mut figure = figure(size, size, |_, _| 0.0);
        figure.plastic = vec![false; size * size];
        assert!(!says(&figure, "yielded"));
        figure.plastic[(size / 3) * size + size / 2] = true;
        let drawn = Drawn::new(&figure);
        let half = 0.5 / size as f64;
        let [x, y] = [size / 2, size / 3].map(|index| index as f64 / size as f64 + half);
        assert_eq!(drawn.at(x, y), channels(INK));
        assert!((4..40).contains(&drawn.count(|colour| colour == channels(INK))));
        assert!(says(&figure, "yielded"));
        figure.plastic.fill(true);
        assert!(Drawn::new(&figure).count(|colour| colour == channels(INK)) > 500);
        check(&figure);
    }
}

#[test]
fn colours_end_at_the_limit_and_say_so() {
    let mut figure = figure(60, 40, |x, _| x - 3.0);
    figure.limit = Some(1.5);
    for words in ["≥ 1.5", "≤ −1.5", "clipped at ±1.5", "50.0 %"] {
        assert!(says(&figure, words), "{words}: {:?}", texts(&figure));
    }
    assert_eq!(Drawn::new(&figure).at(0.9, 0.5), POSITIVE[5].map(|part| part as u8));
    check(&figure);
    figure.limit = Some(1e9);
    assert!(!says(&figure, "clipped"));
    assert_eq!(Scale::of(&figure).end, 2.95);
    figure.values.iter_mut().for_each(|value| *value = value.abs());
    (figure.is_signed, figure.limit) = (false, Some(0.7));
    assert!(says(&figure, "≥ 0.7") && !says(&figure, "≤") && says(&figure, "clipped at 0.7"));
    check(&figure);
}

#[test]
fn a_fixed_scale_gives_all_fields_the_same_colours_and_places() {
    let fixed = |is_signed: bool, value: &dyn Fn(f64) -> f64| {
        let mut figure = figure(60, 40, |x, _| value(x));
        figure.values[0] = 0.8;
        (figure.is_signed, figure.scale, figure.limit) = (is_signed, Some(2.0), Some(0.1));
        figure.plastic = figure.values.iter().map(|value| *value > 1.0).collect();
        figure
    };
    let values: [&dyn Fn(f64) -> f64; 5] =
        [&|_| 0.0, &|x| x, &|x| -0.3 * x, &|_| f64::NAN, &|x| (40.0 * x).sin()];
    for is_signed in [false, true] {
        let first = arranged(&fixed(is_signed, values[0]));
        for value in values {
            let figure = fixed(is_signed, value);
            let (scale, arrangement) = arranged(&figure);
            assert_eq!(scale.end, 2.0);
            let own = &arrangement.layout;
            assert_eq!(own.frame, first.1.layout.frame);
            assert_eq!(own.bar, first.1.layout.bar);
            assert_eq!(own.height, first.1.layout.height);
            assert_eq!(
                channels(scale.colour(scale.step(0.8))),
                Drawn::new(&figure).at(0.5 / 60.0, 0.5 / 40.0)
            );
            assert!(says(&figure, "≥ 2") && !says(&figure, "everywhere"));
            assert_eq!(says(&figure, "≤ −2"), is_signed);
            check(&figure);
        }
    }
    assert!(says(&fixed(true, &|x| x), "beyond ±2 (66.7 %)"));
    assert!(says(&fixed(true, &|_| 0.0), "beyond ±2 (0 %)"));
    // Negative values of an unsigned quantity are counted as beyond the scale, not drawn as positive.
    assert!(says(&fixed(false, &|x| -0.3 * x), "≤ 0"));
    assert!(says(&fixed(false, &|x| -0.3 * x), "beyond 2 (>99.9 %)"));
}

#[test]
fn lines_asked_for_carry_their_numbers() {
    let mut wave = figure(120, 80, |x, y| 10.0 * (0.6 * x).sin() * (0.5 * y).cos());
    wave.curves = Some(vec![-7.5, -2.5, 0.0, 5.0, 5.0, f64::NAN, f64::INFINITY, 77.0]);
    let said = texts(&wave);
    let number = |words: &str| said.iter().filter(|text| *text == words).count();
    for words in ["−7.5", "−2.5"] {
        assert!(number(words) >= 1, "{words} {said:?}");
    }
    assert!(says(&wave, "equal value, as numbered") && says(&wave, "equal negative value"));
    assert!(!says(&wave, "of the scale") && !says(&wave, "77"));
    check(&wave);
    // Many marks and lines.
    wave.marks = (0..80)
        .map(|index| {
            let place = f64::from(index);
            mark(0.15 * place, 4.0 + 3.0 * place.sin(), "name", FieldMarkKind::Receiver)
        })
        .collect();
    wave.curves = Some((-40..40).map(|level| 0.25 * f64::from(level)).collect());
    check(&wave);
    // An unsigned quantity has contour lines only if requested.
    let mut hill = figure(90, 90, |x, y| 9.0 * (-0.1 * (x - 4.0).hypot(y - 4.0)).exp());
    hill.is_signed = false;
    assert!(matches!(arranged(&hill).1.levels, Levels::None));
    hill.curves = Some(vec![8.0, 7.0]);
    assert!(matches!(arranged(&hill).1.levels, Levels::Lines(_)));
    assert!(!says(&hill, "negative"));
    check(&hill);
    for curves in [Vec::new(), vec![0.0], vec![1e-320, -1e300]] {
        hill.curves = Some(curves);
        check(&hill);
    }
    let mut noise = figure(400, 400, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract().abs());
    (noise.is_signed, noise.curves) = (false, Some(vec![0.5]));
    assert!(says(&noise, "not drawn: too many"));
    check(&noise);
    let mut zero = figure(20, 10, |_, _| 0.0);
    zero.curves = Some(vec![0.0, 1.0]);
    check(&zero);
}

#[test]
fn constant_fields_say_so() {
    for is_signed in [false, true] {
        for (value, words) in [
            (0.0, "velocity v₂ (m/s): zero everywhere"),
            (-0.0, "zero everywhere"),
            (3.2, "velocity v₂ (m/s): 3.2 everywhere"),
            (f64::NAN, "not a finite number (100 % of the cells)"),
        ] {
            let mut figure = figure(30, 20, |_, _| value);
            figure.is_signed = is_signed;
            assert!(says(&figure, words), "{value} {:?}", texts(&figure));
            check(&figure);
        }
    }
    let mut figure = figure(30, 20, |_, _| 0.0);
    figure.values[0] = f64::INFINITY;
    assert!(says(&figure, "zero wherever it is finite"));
    check(&figure);
}

#[test]
fn the_sign_shows_in_grey() {
    let wave = figure(80, 60, |x, _| x.sin());
    assert!(matches!(arranged(&wave).1.levels, Levels::Lines(_)));
    assert!(says(&wave, "−¼ and −½ of the scale"));
    // A constant field and noise have no usable contour lines.
    let constant = figure(30, 20, |_, _| -1.0);
    let noise = figure(400, 400, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract());
    for figure in [constant, noise] {
        assert!(matches!(arranged(&figure).1.levels, Levels::Ruled));
        assert!(says(&figure, "below −¼ of the scale"));
        check(&figure);
    }
    assert!(matches!(arranged(&figure(30, 20, |_, _| 1.0)).1.levels, Levels::None));
}

#[test]
fn negative_values_are_shown_whatever_is_said_about_signs() {
    let mut figure = figure(20, 10, |x, _| 1.0 + x);
    figure.is_signed = false;
    figure.values[3] = -1e-14;
    assert!(!Scale::of(&figure).is_signed);
    check(&figure);
    figure.values[3] = -0.1;
    assert!(Scale::of(&figure).is_signed);
    check(&figure);
}

#[test]
fn shades_grow_darker_evenly_and_alike_on_both_sides() {
    for is_signed in [false, true] {
        let scale = Scale {
            is_signed,
            is_fixed: false,
            end: 1.0,
            extreme: 1.0,
            clipped: 0,
            open: [false; 2],
            unknown: 0,
        };
        let light = |step: i16| crate::verdict_map::luminance(scale.colour(step));
        for step in 1..=SHADES {
            let fall = light(step - 1) - light(step);
            assert!(fall > 0.5 && fall < 4.0, "{step} {fall}");
            if is_signed {
                assert!(light(1 - step) - light(-step) > 0.5);
                assert!((light(step) - light(-step)).abs() < 2.0, "{step}");
            }
        }
    }
}

#[test]
fn any_values_on_any_grid_are_drawn() {
    let values = [1e-3, f64::MAX, f64::MIN, 9e299, 5e-324, f64::NAN, f64::NEG_INFINITY, -1e12];
    for (columns, rows) in [(1, 1), (1, 2), (2, 1), (3, 40), (1700, 2), (2, 1700)] {
        for kinds in [0, 1, 4, 6, 8] {
            let mut figure = figure(columns, rows, |_, _| 5e-324);
            for (cell, value) in figure.values.iter_mut().enumerate().skip(usize::from(kinds < 4)) {
                *value = values[cell % kinds.max(1)];
            }
            figure.plastic = (0..columns * rows).map(|cell| cell % 3 == 0).collect();
            figure.outlines = (0..columns * rows).map(|cell| (cell / 7) as u16).collect();
            figure.marks = vec![mark(0.05, 0.05, "here", FieldMarkKind::Source)];
            for format in [Format::Png, Format::Svg] {
                figure.picture(format).unwrap().assert_texts_are_apart();
            }
            if kinds % 4 == 0 {
                check(&figure);
            }
        }
    }
}

#[test]
fn any_extent_is_drawn() {
    for (from, to) in
        [(0.0, 1e-300), (-1e300, 1e300), (5.0, -2.0), (1e9, 1e9 + 1.0), (0.0, 1e5), (0.0, 1e-9)]
    {
        let mut figure = figure(30, 20, |x, y| x - y);
        (figure.x.from, figure.x.to) = (from, to);
        check(&figure);
        std::mem::swap(&mut figure.x, &mut figure.y);
        figure.marks = vec![mark(1.0, from, "edge", FieldMarkKind::Receiver)];
        check(&figure);
    }
}

#[test]
fn marks_may_hold_anything_and_crowd() {
    use FieldMarkKind::{Receiver, Source};
    let mut figure = figure(60, 40, |x, y| (x * y).sin());
    figure.marks = (0..60)
        .map(|index| mark(0.1 * f64::from(index), 2.0, &format!("R{index}"), Receiver))
        .collect();
    check(&figure);
    figure.marks = vec![mark(3.0, 2.0, "a long name of a receiver", Receiver); 90];
    assert!(says(&figure, "names left out for want of room"));
    check(&figure);
    let long = "one name ".repeat(100);
    figure.marks = vec![
        mark(0.0, 0.0, &long, Source),
        mark(6.0, 4.0, "corner", Receiver),
        mark(f64::NAN, 1.0, "nowhere", Receiver),
        mark(1.0, f64::INFINITY, "far", Receiver),
        mark(7.0, 1.0, "outside", Receiver),
        mark(2.0, 2.0, "", Source),
    ];
    assert!(says(&figure, "receiver (3 of 4 outside the picture)"));
    assert!(says(&figure, "corner") && !says(&figure, "nowhere"));
    check(&figure);
    let mut only = self::figure(60, 40, |_, _| 0.0);
    only.marks = vec![mark(3.0, 2.0, "", Source)];
    let drawn = Drawn::new(&only);
    assert_eq!(drawn.at(0.5, 0.5), channels(INK));
}

#[test]
fn long_labels_stay_on_the_sheet() {
    let long = "a rather long description of what is meant ".repeat(40);
    for (columns, rows) in [(60, 40), (900, 10), (10, 900)] {
        let mut figure = figure(columns, rows, |x, y| (x + y).sin());
        figure.limit = Some(0.5);
        let empty = |figure: &mut FieldFigure, words: &str| {
            let FieldFigure { title, subtitle, label, x, y, .. } = figure;
            for text in [title, subtitle, label, &mut x.label, &mut y.label] {
                words.clone_into(text);
            }
        };
        empty(&mut figure, &long);
        check(&figure);
        empty(&mut figure, "");
        check(&figure);
    }
}

#[test]
fn files_stay_small_and_equal_figures_give_equal_bytes() {
    let mut noise = figure(1000, 1000, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract());
    noise.outlines = (0..1_000_000).map(|cell| (cell % 1000 / 10) as u16).collect();
    noise.plastic = noise.values.iter().map(|value| *value > 0.0).collect();
    for (format, most) in [(Format::Png, 2_500_000), (Format::Svg, 4_500_000)] {
        let bytes = noise.draw(format).unwrap();
        assert!(bytes.len() < most, "{format:?}: {}", bytes.len());
        assert_eq!(bytes, noise.draw(format).unwrap());
    }
    let wave = figure(1000, 1000, |x, y| (0.9 * (x - 50.0).hypot(y - 40.0)).sin());
    assert!(wave.draw(Format::Svg).unwrap().len() < 3_000_000);
}

#[test]
fn wrong_input_is_refused() {
    let refused = |change: &dyn Fn(&mut FieldFigure)| {
        let mut figure = figure(4, 3, |x, y| x - y);
        change(&mut figure);
        figure.draw(Format::Svg).unwrap_err().to_string()
    };
    assert!(
        refused(&|figure| {
            figure.values.pop();
        })
        .contains("values has 11 values for 4 × 3 cells")
    );
    assert!(refused(&|figure| figure.outlines = vec![0; 13]).contains("outlines has 13"));
    assert!(refused(&|figure| figure.plastic = vec![true]).contains("plastic has 1"));
    assert!(refused(&|figure| figure.columns = usize::MAX).contains("12 values for"));
    assert!(refused(&|figure| figure.rows = 0).contains("has no cells"));
    assert!(refused(&|figure| figure.x.to = f64::NAN).contains("not a finite number"));
    assert!(refused(&|figure| figure.x.to = figure.x.from).contains("does not extend"));
    assert!(
        refused(&|figure| (figure.y.from, figure.y.to) = (-1e308, 1e308))
            .contains("does not extend")
    );
    for limit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&|figure| figure.limit = Some(limit)).contains("limit of the colours"));
        assert!(refused(&|figure| figure.scale = Some(limit)).contains("limit of the colours"));
    }
}
