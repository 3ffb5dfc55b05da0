//! Tests of field figures.

mod overlays;

use plotters::style::RGBColor;

use super::colour_map::{
    ColourScale, NEGATIVE_STOPS, NON_FINITE_COLOUR, POSITIVE_STOPS, SHADE_COUNT,
};
use super::contours::Contours;
use super::draw::Arrangement;
use super::figure::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use crate::format::FigureFormat;
use crate::picture::{Colour, INK, Rectangle};

fn sample_figure(columns: usize, rows: usize, value: impl Fn(f64, f64) -> f64) -> FieldFigure {
    let axis = |label: &str, cells: usize| FieldAxis {
        label: label.to_owned(),
        start: 0.0,
        end: 0.1 * cells as f64,
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
        ..FieldFigure::default()
    }
}

fn sample_mark(x: f64, y: f64, name: &str, kind: FieldMarkKind) -> FieldMark {
    FieldMark { position: [x, y], name: name.to_owned(), kind }
}

fn picture_texts(figure: &FieldFigure) -> Vec<String> {
    let picture = figure.to_picture(FigureFormat::Png).unwrap();
    picture.texts().map(|text| text.content.clone()).collect()
}

fn has_text(figure: &FieldFigure, label_text: &str) -> bool {
    picture_texts(figure).iter().any(|text| text.contains(label_text))
}

/// Verifies in both formats that texts do not overlap, the width of the PNG, and that the SVG is complete and has no
/// NaN.
fn check_figure(figure: &FieldFigure) {
    for format in [FigureFormat::Png, FigureFormat::Svg] {
        figure.to_picture(format).unwrap().assert_texts_do_not_overlap();
    }
    let png = figure.draw(FigureFormat::Png).unwrap();
    assert_eq!(crate::tests::png_size(&png)[0], 1600);
    let svg = String::from_utf8(figure.draw(FigureFormat::Svg).unwrap()).unwrap();
    assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
    assert!(!svg.contains("-1000000,"));
}

fn arrange_figure(figure: &FieldFigure) -> (ColourScale, Arrangement) {
    let scale = ColourScale::from_figure(figure);
    let arrangement = figure.compute_arrangement(&scale, FigureFormat::Png);
    (scale, arrangement)
}

/// Pixels of a rendered picture.
struct RenderedField {
    width: usize,
    pixels: Vec<u8>,
    frame: Rectangle,
}

impl RenderedField {
    fn new(figure: &FieldFigure) -> Self {
        let (width, pixels) = crate::tests::decode_png(&figure.draw(FigureFormat::Png).unwrap());
        Self { width, pixels, frame: arrange_figure(figure).1.layout.frame }
    }

    fn pixel(&self, x: f64, y: f64) -> [u8; 3] {
        let start = 3 * (y as usize * self.width + x as usize);
        [0, 1, 2].map(|channel| self.pixels[start + channel])
    }

    /// Returns the colour at the fractions `right` of the width and `up` of the height of the frame from its lower left
    /// corner.
    fn colour_at(&self, right: f64, up: f64) -> [u8; 3] {
        let frame = self.frame;
        self.pixel(frame.left + right * frame.width(), frame.bottom - up * frame.height())
    }

    fn count_pixels(&self, is_selected: impl Fn([u8; 3]) -> bool) -> usize {
        let Rectangle { left, top, right, bottom } = self.frame;
        let rows = top as usize + 3..bottom as usize - 3;
        rows.flat_map(|y| (left as usize + 3..right as usize - 3).map(move |x| (x, y)))
            .filter(|&(x, y)| is_selected(self.pixel(x as f64, y as f64)))
            .count()
    }
}

const fn channels(RGBColor(red, green, blue): Colour) -> [u8; 3] {
    [red, green, blue]
}

#[test]
fn cells_have_expected_positions_and_colours() {
    let mut figure = sample_figure(10, 8, |_, _| 0.0);
    figure.is_signed = false;
    figure.values[10 + 2] = 4.0;
    figure.values[7 * 10 + 9] = 2.0;
    figure.values[50] = f64::NAN;
    let scale = ColourScale::from_figure(&figure);
    let drawn = RenderedField::new(&figure);
    assert_eq!(drawn.colour_at(0.25, 1.5 / 8.0), channels(scale.step_colour(SHADE_COUNT)));
    assert_eq!(drawn.colour_at(0.95, 7.5 / 8.0), channels(scale.step_colour(SHADE_COUNT / 2)));
    assert_eq!(drawn.colour_at(0.55, 0.55), channels(scale.step_colour(0)));
    // The NaN cell has its background colour between the hatching lines.
    let unknown = drawn.count_pixels(|colour| colour == channels(NON_FINITE_COLOUR));
    let cell = drawn.frame.width() * drawn.frame.height() / 80.0;
    assert!(unknown as f64 > 0.5 * cell && (unknown as f64) < cell, "{unknown}");
    assert!(has_text(&figure, "not a finite number (1.2 % of the cells)"));

    // Negative values have the colours of the negative branch, also on a descending axis.
    figure.is_signed = true;
    figure.values[10 + 2] = -4.0;
    (figure.y.start, figure.y.end) = (figure.y.end, figure.y.start);
    let drawn = RenderedField::new(&figure);
    assert_eq!(drawn.colour_at(0.25, 1.5 / 8.0), NEGATIVE_STOPS[5].map(|part| part as u8));
}

#[test]
fn aspect_ratio_of_the_domain_is_preserved() {
    for (columns, rows) in [(40, 40), (100, 30), (20, 90), (150, 15), (7, 5)] {
        let figure = sample_figure(columns, rows, |x, y| x - y);
        let layout = arrange_figure(&figure).1.layout;
        let ratio = layout.frame.width() / layout.frame.height();
        let expected = columns as f64 / rows as f64;
        assert!((ratio / expected - 1.0).abs() < 0.02, "{ratio} {expected}");
        assert!(!has_text(&figure, "stretched"));
        check_figure(&figure);
    }
    assert_eq!(
        crate::tests::png_size(&sample_figure(40, 40, |x, _| x).draw(FigureFormat::Png).unwrap())
            [1],
        1100
    );
    assert!(has_text(&sample_figure(900, 1, |x, _| x), "height y (m), stretched ×"));
    // A short axis has at least its ends labelled.
    assert!(picture_texts(&sample_figure(900, 4, |x, _| x)).contains(&"0.4".to_owned()));
    assert!(has_text(&sample_figure(1, 900, |_, y| y), "x (m), stretched ×"));
}

#[test]
fn single_extreme_cell_is_drawn() {
    let mut figure = sample_figure(3000, 2500, |_, _| 0.0);
    figure.values[1701 * 3000 + 1234] = -7.0;
    figure.values[1700 * 3000 + 1234] = 1.0;
    let darkest = channels(ColourScale::from_figure(&figure).step_colour(-SHADE_COUNT));
    let drawn = RenderedField::new(&figure);
    let near = (-4..=4).flat_map(|x| (-4..=4).map(move |y| (f64::from(x), f64::from(y))));
    let found = near
        .filter(|(x, y)| drawn.colour_at((1234.5 + x) / 3000.0, (1701.5 + y) / 2500.0) == darkest)
        .count();
    assert!(found > 0);
    let svg = String::from_utf8(figure.draw(FigureFormat::Svg).unwrap()).unwrap();
    assert!(svg.matches("fill=\"#072158\"").count() >= 2);
}

#[test]
fn borders_are_drawn_unless_they_would_cover_the_field() {
    let mut figure = sample_figure(100, 80, |_, _| 1.0);
    figure.is_signed = false;
    figure.material_indices = (0..8000).map(|cell| u16::from(cell % 100 >= 50)).collect();
    let drawn = RenderedField::new(&figure);
    assert_eq!(drawn.colour_at(0.5, 0.3), channels(INK));
    assert_eq!(
        drawn.colour_at(0.25, 0.3),
        channels(ColourScale::from_figure(&figure).step_colour(SHADE_COUNT))
    );
    assert!(has_text(&figure, "border between materials"));
    check_figure(&figure);
    figure.material_indices.fill(3);
    assert!(!has_text(&figure, "border"));
    figure.material_indices = (0..8000).map(|cell| (cell * 7919 % 13) as u16).collect();
    assert!(has_text(&figure, "borders between materials not drawn"));
    check_figure(&figure);
}

#[test]
fn every_yielded_cell_is_near_a_dot() {
    for size in [12, 1000] {
        let mut figure = sample_figure(size, size, |_, _| 0.0);
        figure.has_yielded = vec![false; size * size];
        assert!(!has_text(&figure, "yielded"));
        figure.has_yielded[(size / 3) * size + size / 2] = true;
        let drawn = RenderedField::new(&figure);
        let half = 0.5 / size as f64;
        let [x, y] = [size / 2, size / 3].map(|index| index as f64 / size as f64 + half);
        assert_eq!(drawn.colour_at(x, y), channels(INK));
        assert!((4..900).contains(&drawn.count_pixels(|colour| colour == channels(INK))));
        assert!(has_text(&figure, "yielded"));
        figure.has_yielded.fill(true);
        // The zone leaves the field visible.
        let ink = RenderedField::new(&figure).count_pixels(|colour| colour == channels(INK));
        assert!((500..12_000).contains(&ink), "{ink}");
        check_figure(&figure);
    }
}

#[test]
fn clipping_at_the_limit_is_labelled() {
    let mut figure = sample_figure(60, 40, |x, _| x - 3.0);
    figure.limit = Some(1.5);
    for label_text in ["≥ 1.5", "≤ −1.5", "clipped at ±1.5", "50.0 %"] {
        assert!(has_text(&figure, label_text), "{label_text}: {:?}", picture_texts(&figure));
    }
    assert_eq!(
        RenderedField::new(&figure).colour_at(0.9, 0.5),
        POSITIVE_STOPS[5].map(|part| part as u8)
    );
    check_figure(&figure);
    figure.limit = Some(1e9);
    assert!(!has_text(&figure, "clipped"));
    assert_eq!(ColourScale::from_figure(&figure).limit, 2.95);
    figure.values.iter_mut().for_each(|value| *value = value.abs());
    (figure.is_signed, figure.limit) = (false, Some(0.7));
    assert!(
        has_text(&figure, "≥ 0.7")
            && !has_text(&figure, "≤")
            && has_text(&figure, "clipped at 0.7")
    );
    check_figure(&figure);
}

#[test]
fn fixed_scale_gives_equal_colours_and_layout() {
    let fixed = |is_signed: bool, value: &dyn Fn(f64) -> f64| {
        let mut figure = sample_figure(60, 40, |x, _| value(x));
        figure.values[0] = 0.8;
        (figure.is_signed, figure.fixed_limit, figure.limit) = (is_signed, Some(2.0), Some(0.1));
        figure.has_yielded = figure.values.iter().map(|value| *value > 1.0).collect();
        figure
    };
    let values: [&dyn Fn(f64) -> f64; 5] =
        [&|_| 0.0, &|x| x, &|x| -0.3 * x, &|_| f64::NAN, &|x| (40.0 * x).sin()];
    for is_signed in [false, true] {
        let first = arrange_figure(&fixed(is_signed, values[0]));
        for value in values {
            let figure = fixed(is_signed, value);
            let (scale, arrangement) = arrange_figure(&figure);
            assert_eq!(scale.limit, 2.0);
            let layout = &arrangement.layout;
            assert_eq!(layout.frame, first.1.layout.frame);
            assert_eq!(layout.bar_area, first.1.layout.bar_area);
            assert_eq!(layout.height, first.1.layout.height);
            assert_eq!(
                channels(scale.step_colour(scale.colour_step(0.8))),
                RenderedField::new(&figure).colour_at(0.5 / 60.0, 0.5 / 40.0)
            );
            assert!(has_text(&figure, "≥ 2") && !has_text(&figure, "everywhere"));
            assert_eq!(has_text(&figure, "≤ −2"), is_signed);
            check_figure(&figure);
        }
    }
    assert!(has_text(&fixed(true, &|x| x), "beyond ±2 (66.7 %)"));
    assert!(has_text(&fixed(true, &|_| 0.0), "beyond ±2 (0 %)"));
    // Negative values of an unsigned quantity are counted as beyond the scale, not drawn as positive.
    assert!(has_text(&fixed(false, &|x| -0.3 * x), "≤ 0"));
    assert!(has_text(&fixed(false, &|x| -0.3 * x), "beyond 2 (>99.9 %)"));
}

#[test]
fn requested_contour_lines_are_numbered() {
    let mut wave = sample_figure(120, 80, |x, y| 10.0 * (0.6 * x).sin() * (0.5 * y).cos());
    wave.contour_levels = Some(vec![-7.5, -2.5, 0.0, 5.0, 5.0, f64::NAN, f64::INFINITY, 77.0]);
    let texts = picture_texts(&wave);
    let number = |label_text: &str| texts.iter().filter(|text| *text == label_text).count();
    for label_text in ["−7.5", "−2.5"] {
        assert!(number(label_text) >= 1, "{label_text} {texts:?}");
    }
    assert!(has_text(&wave, "equal value, as numbered") && has_text(&wave, "equal negative value"));
    assert!(!has_text(&wave, "at −") && !has_text(&wave, "77"));
    check_figure(&wave);
    // Many marks and lines.
    wave.marks = (0..80)
        .map(|index| {
            let place = f64::from(index);
            sample_mark(0.15 * place, 4.0 + 3.0 * place.sin(), "name", FieldMarkKind::Receiver)
        })
        .collect();
    wave.contour_levels = Some((-40..40).map(|level| 0.25 * f64::from(level)).collect());
    check_figure(&wave);
    // An unsigned quantity has contour lines only if requested.
    let mut hill = sample_figure(90, 90, |x, y| 9.0 * (-0.1 * (x - 4.0).hypot(y - 4.0)).exp());
    hill.is_signed = false;
    assert!(matches!(arrange_figure(&hill).1.contours, Contours::None));
    hill.contour_levels = Some(vec![8.0, 7.0]);
    assert!(matches!(arrange_figure(&hill).1.contours, Contours::Lines(_)));
    assert!(!has_text(&hill, "negative"));
    check_figure(&hill);
    for curves in [Vec::new(), vec![0.0], vec![1e-320, -1e300]] {
        hill.contour_levels = Some(curves);
        check_figure(&hill);
    }
    let mut noise =
        sample_figure(400, 400, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract().abs());
    (noise.is_signed, noise.contour_levels) = (false, Some(vec![0.5]));
    assert!(has_text(&noise, "not drawn: too many"));
    check_figure(&noise);
    let mut zero = sample_figure(20, 10, |_, _| 0.0);
    zero.contour_levels = Some(vec![0.0, 1.0]);
    check_figure(&zero);
}

#[test]
fn constant_fields_are_labelled() {
    for is_signed in [false, true] {
        for (value, label_text) in [
            (0.0, "velocity v₂ (m/s): zero everywhere"),
            (-0.0, "zero everywhere"),
            (3.2, "velocity v₂ (m/s): 3.2 everywhere"),
            (f64::NAN, "not a finite number (100 % of the cells)"),
        ] {
            let mut figure = sample_figure(30, 20, |_, _| value);
            figure.is_signed = is_signed;
            assert!(has_text(&figure, label_text), "{value} {:?}", picture_texts(&figure));
            check_figure(&figure);
        }
    }
    let mut figure = sample_figure(30, 20, |_, _| 0.0);
    figure.values[0] = f64::INFINITY;
    assert!(has_text(&figure, "zero wherever it is finite"));
    check_figure(&figure);
}

#[test]
fn sign_is_visible_in_greyscale() {
    let wave = sample_figure(80, 60, |x, _| x.sin());
    assert!(matches!(arrange_figure(&wave).1.contours, Contours::Lines(_)));
    // The legend states round levels.
    for text in ["at 0.25 and 0.5 m/s", "at −0.5 and −0.25 m/s", "negative"] {
        assert!(has_text(&wave, text), "{text} {:?}", picture_texts(&wave));
    }
    // A constant field and noise have no usable contour lines.
    let constant = sample_figure(30, 20, |_, _| -1.0);
    let noise = sample_figure(400, 400, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract());
    for figure in [constant, noise] {
        assert!(matches!(arrange_figure(&figure).1.contours, Contours::None));
        assert!(has_text(&figure, "negative"));
        check_figure(&figure);
    }
    let positive = sample_figure(30, 20, |_, _| 1.0);
    assert!(matches!(arrange_figure(&positive).1.contours, Contours::None));
    assert!(!has_text(&positive, "negative"));
    // Weak values of both signs have one luminance: only the negative ones have lines, of another luminance.
    let luminances = |value: f64| {
        let mut figure = sample_figure(100, 80, |_, _| value);
        figure.values[0] = 1.0;
        let drawn = RenderedField::new(&figure);
        let rows = (100..130).map(|offset| {
            let [red, green, blue] = drawn.pixel(800.0, drawn.frame.top + f64::from(offset));
            crate::colour::luminance(RGBColor(red, green, blue))
        });
        rows.fold([f64::INFINITY, 0.0_f64], |[low, high], own| [low.min(own), high.max(own)])
    };
    for size in [0.05, 0.2, 0.9] {
        let [[low, high], positive] = [-size, size].map(luminances);
        assert!(high - low > 8.0 && positive[1] - positive[0] < 0.5, "{size} {low} {high}");
        assert!((high - positive[1]).abs() < 12.0 || (low - positive[0]).abs() < 12.0);
    }
}

#[test]
fn negative_values_make_the_scale_signed() {
    let mut figure = sample_figure(20, 10, |x, _| 1.0 + x);
    figure.is_signed = false;
    figure.values[3] = -1e-14;
    assert!(!ColourScale::from_figure(&figure).is_signed);
    check_figure(&figure);
    figure.values[3] = -0.1;
    assert!(ColourScale::from_figure(&figure).is_signed);
    check_figure(&figure);
}

#[test]
fn luminance_decreases_evenly_and_symmetrically() {
    for is_signed in [false, true] {
        let scale = ColourScale {
            is_signed,
            is_root: false,
            is_fixed: false,
            limit: 1.0,
            extreme_value: 1.0,
            clipped_count: 0,
            has_clipped_values: [false; 2],
            non_finite_count: 0,
        };
        let light = |step: i16| crate::colour::luminance(scale.step_colour(step));
        for step in 1..=SHADE_COUNT {
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
            let mut figure = sample_figure(columns, rows, |_, _| 5e-324);
            for (cell, value) in figure.values.iter_mut().enumerate().skip(usize::from(kinds < 4)) {
                *value = values[cell % kinds.max(1)];
            }
            figure.has_yielded = (0..columns * rows).map(|cell| cell % 3 == 0).collect();
            figure.material_indices = (0..columns * rows).map(|cell| (cell / 7) as u16).collect();
            figure.marks = vec![sample_mark(0.05, 0.05, "here", FieldMarkKind::Source)];
            for format in [FigureFormat::Png, FigureFormat::Svg] {
                figure.to_picture(format).unwrap().assert_texts_do_not_overlap();
            }
            if kinds % 4 == 0 {
                check_figure(&figure);
            }
        }
    }
}

#[test]
fn any_extent_is_drawn() {
    for (from, to) in
        [(0.0, 1e-300), (-1e300, 1e300), (5.0, -2.0), (1e9, 1e9 + 1.0), (0.0, 1e5), (0.0, 1e-9)]
    {
        let mut figure = sample_figure(30, 20, |x, y| x - y);
        (figure.x.start, figure.x.end) = (from, to);
        check_figure(&figure);
        std::mem::swap(&mut figure.x, &mut figure.y);
        figure.marks = vec![sample_mark(1.0, from, "edge", FieldMarkKind::Receiver)];
        check_figure(&figure);
    }
}

#[test]
fn arbitrary_and_crowded_marks_are_drawn() {
    use FieldMarkKind::{Receiver, Source};
    let mut figure = sample_figure(60, 40, |x, y| (x * y).sin());
    figure.marks = (0..60)
        .map(|index| sample_mark(0.1 * f64::from(index), 2.0, &format!("R{index}"), Receiver))
        .collect();
    check_figure(&figure);
    figure.marks = vec![sample_mark(3.0, 2.0, "a long name of a receiver", Receiver); 90];
    assert!(has_text(&figure, "names left out for want of room"));
    check_figure(&figure);
    let long = "one name ".repeat(100);
    figure.marks = vec![
        sample_mark(0.0, 0.0, &long, Source),
        sample_mark(6.0, 4.0, "corner", Receiver),
        sample_mark(f64::NAN, 1.0, "nowhere", Receiver),
        sample_mark(1.0, f64::INFINITY, "far", Receiver),
        sample_mark(7.0, 1.0, "outside", Receiver),
        sample_mark(2.0, 2.0, "", Source),
    ];
    assert!(has_text(&figure, "receiver (3 of 4 outside the picture)"));
    assert!(has_text(&figure, "corner") && !has_text(&figure, "nowhere"));
    check_figure(&figure);
    let mut only = self::sample_figure(60, 40, |_, _| 0.0);
    only.marks = vec![sample_mark(3.0, 2.0, "", Source)];
    let drawn = RenderedField::new(&only);
    assert_eq!(drawn.colour_at(0.5, 0.5), channels(INK));
}

#[test]
fn long_labels_stay_within_the_picture() {
    let long = "a rather long description of what is meant ".repeat(40);
    for (columns, rows) in [(60, 40), (900, 10), (10, 900)] {
        let mut figure = sample_figure(columns, rows, |x, y| (x + y).sin());
        figure.limit = Some(0.5);
        let empty = |figure: &mut FieldFigure, label_text: &str| {
            let FieldFigure { title, subtitle, label, x, y, .. } = figure;
            for text in [title, subtitle, label, &mut x.label, &mut y.label] {
                label_text.clone_into(text);
            }
        };
        empty(&mut figure, &long);
        check_figure(&figure);
        empty(&mut figure, "");
        check_figure(&figure);
    }
}

#[test]
fn files_are_small_and_reproducible() {
    let mut noise =
        sample_figure(1000, 1000, |x, y| (1e4 * (12.9898 * x + 78.233 * y).sin()).fract());
    noise.material_indices = (0..1_000_000).map(|cell| (cell % 1000 / 10) as u16).collect();
    noise.has_yielded = noise.values.iter().map(|value| *value > 0.0).collect();
    for (format, max_length) in [(FigureFormat::Png, 2_500_000), (FigureFormat::Svg, 4_500_000)] {
        let bytes = noise.draw(format).unwrap();
        assert!(bytes.len() < max_length, "{format:?}: {}", bytes.len());
        assert_eq!(bytes, noise.draw(format).unwrap());
    }
    let wave = sample_figure(1000, 1000, |x, y| (0.9 * (x - 50.0).hypot(y - 40.0)).sin());
    assert!(wave.draw(FigureFormat::Svg).unwrap().len() < 3_000_000);
}

#[test]
fn wrong_input_is_refused() {
    let refused = |change: &dyn Fn(&mut FieldFigure)| {
        let mut figure = sample_figure(4, 3, |x, y| x - y);
        change(&mut figure);
        figure.draw(FigureFormat::Svg).unwrap_err().to_string()
    };
    assert!(
        refused(&|figure| {
            figure.values.pop();
        })
        .contains("values has 11 values for 4 × 3 cells")
    );
    assert!(refused(&|figure| figure.material_indices = vec![0; 13]).contains("outlines has 13"));
    assert!(refused(&|figure| figure.has_yielded = vec![true]).contains("plastic has 1"));
    assert!(refused(&|figure| figure.columns = usize::MAX).contains("12 values for"));
    assert!(refused(&|figure| figure.rows = 0).contains("has no cells"));
    assert!(refused(&|figure| figure.x.end = f64::NAN).contains("not a finite number"));
    assert!(refused(&|figure| figure.x.end = figure.x.start).contains("does not extend"));
    assert!(
        refused(&|figure| (figure.y.start, figure.y.end) = (-1e308, 1e308))
            .contains("does not extend")
    );
    for limit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&|figure| figure.limit = Some(limit)).contains("limit of the colours"));
        assert!(
            refused(&|figure| figure.fixed_limit = Some(limit)).contains("limit of the colours")
        );
    }
}

/// On a root scale a wave of a hundredth of the limit has the colour of a tenth, and the bar states the scale.
#[test]
fn root_scale_shows_weak_waves() {
    let mut figure = sample_figure(60, 40, |x, _| if x < 1.0 { 1.0 } else { -0.01 });
    let scale = |figure: &FieldFigure| ColourScale::from_figure(figure);
    assert_eq!(scale(&figure).colour_step(-0.01), -1);
    figure.is_root_scaled = true;
    let root = scale(&figure);
    assert_eq!(root.colour_step(-0.01), (-0.1 * f64::from(SHADE_COUNT)).round() as i16);
    assert_eq!([root.colour_step(1.0), root.colour_step(0.0)], [SHADE_COUNT, 0]);
    assert!((root.fraction(-0.25) - 0.25).abs() < 1e-15);
    check_figure(&figure);
    assert!(picture_texts(&figure).iter().any(|text| text.ends_with("square-root scale")));
}
